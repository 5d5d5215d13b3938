"""Promises about flat parts: mass properties, holes, errors."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings, strategies as st

from build.shapes import block, contours, lever
from facts import refuses
from stepwell.base import InputError
from stepwell.build import Contour, Hole, Part

DENSITY = 1190.0  # acrylic


def extruded(part: Part) -> trimesh.Trimesh:
    import manifold3d

    rings = [part.outline.ring(1e-7), *(one.ring(1e-7)[::-1] for one in part.openings)]
    section = manifold3d.CrossSection([1e3 * ring for ring in rings])
    mesh = section.extrude(1e3 * part.thickness).to_mesh64()
    return trimesh.Trimesh(1e-3 * mesh.vert_properties, mesh.tri_verts)


def properties(part: Part) -> list[float]:
    return [part.mass(DENSITY), *part.centroid, *np.ravel(part.inertia(DENSITY))]


def of_mesh(part: Part) -> list[float]:
    mesh = extruded(part)
    mesh.density = DENSITY
    return [mesh.mass, *mesh.center_mass[:2], *np.ravel(mesh.moment_inertia)]


@pytest.mark.parametrize("part", [block(), lever()], ids=lambda part: part.name)
def test_mass_properties_equal_those_of_a_mesh_by_trimesh(part):
    ours, theirs = np.array(properties(part)), np.array(of_mesh(part))
    assert ours[:3] == pytest.approx(theirs[:3], rel=1e-4)
    assert ours[3:] == pytest.approx(theirs[3:], abs=1e-4 * ours[3:].max())


@given(contours(), st.floats(0.001, 0.006))
@settings(max_examples=15, deadline=None)
def test_mass_properties_of_any_outline_equal_those_of_a_mesh(outline, thickness):
    part = Part("any", "acrylic", thickness, outline)
    ours, theirs = np.array(properties(part)), np.array(of_mesh(part))
    assert ours[:3] == pytest.approx(theirs[:3], rel=3e-4, abs=1e-7)
    assert ours[3:] == pytest.approx(theirs[3:], abs=6e-4 * np.abs(ours[3:]).max())


def test_the_inertia_of_a_distant_part_loses_no_digits():
    near, far = (
        Part("p", "acrylic", 0.003, lever().outline.moved(x, 0.0)).inertia(DENSITY)
        for x in (0.0, 50.0)
    )
    assert far == pytest.approx(near, rel=1e-9, abs=1e-9 * near.max())


def test_the_polygon_of_a_part_has_its_area():
    for part in (block(), lever()):
        assert part.polygon(1e-8).area == pytest.approx(part.area, rel=1e-5)
        assert part.polygon().is_valid


def test_errors_name_the_part_and_the_hole():
    hole = Hole((0.0, 0.0), 0.003, "A1", "grid")
    with refuses(InputError, "plate", "A1", "rename one"):
        Part("plate", "acrylic", 0.003, Contour.circle((0, 0), 0.01), (hole, hole))
    with refuses(InputError, "use = 'nail'", "'grid'"):
        Hole((0.0, 0.0), 0.003, "A1", "nail")
    with refuses(InputError, "block-1-top", "Z9", "P1"):
        block().hole("Z9")
