"""Audits of cutting files and solids by other tools: ezdxf, shapely, trimesh, a browser."""

import io
import math
import re
import xml.etree.ElementTree as ET
import zipfile

import numpy as np
import pytest
import shapely
import trimesh
from ezdxf import bbox
from ezdxf.filemanagement import read as read_dxf

from build.shapes import block, lever
from facts import refuses
from stepwell.base import ExtraError, InputError, have
from stepwell.build import Contour, Hole, Part
from stepwell.build.exports.cutting import cutting, joined
from stepwell.build.exports.dxf import dxf_text
from stepwell.build.exports.marks import mark_lines, place_of, stroked
from stepwell.build.exports.solids import mesh_of, step_bytes, stl_bytes, threemf_bytes
from stepwell.build.exports.svg import svg_text

PARTS = [block(), lever()]
PLACES = [(0.0, 0.0, 0.0), (0.050, 0.0, math.pi / 2)]
MICROMETRE = 1e-3  # [mm]
every_part = pytest.mark.parametrize("part", PARTS, ids=lambda part: part.name)
every_version = pytest.mark.parametrize("version", ["R2010", "R12"])


def read(text: str):
    return read_dxf(io.StringIO(text))


def contour_of(entity) -> Contour:
    """A closed contour of a drawing [m]."""
    if entity.dxftype() == "CIRCLE":
        x, y, _ = entity.dxf.center
        return Contour.circle((x / 1e3, y / 1e3), entity.dxf.radius / 1e3)
    if entity.dxftype() == "LWPOLYLINE":
        assert entity.closed
        rows = entity.get_points("xyb")
    else:
        assert entity.dxftype() == "POLYLINE" and entity.is_closed
        rows = [
            (v.dxf.location.x, v.dxf.location.y, v.dxf.get("bulge", 0.0)) for v in entity.vertices
        ]
    return Contour(tuple((x / 1e3, y / 1e3) for x, y, _ in rows), tuple(b for *_, b in rows))


@every_version
@every_part
def test_the_audit_of_a_drawing_has_no_finding(part, version):
    document = read(dxf_text(cutting(part), version))
    audit = document.audit()
    assert (audit.errors, audit.fixes) == ([], [])
    kinds = {entity.dxftype() for entity in document.modelspace()}
    assert kinds <= {"CIRCLE", "LWPOLYLINE" if version == "R2010" else "POLYLINE"}
    assert {entity.dxf.layer for entity in document.modelspace()} == {"CUT"}
    assert document.dxfversion == {"R2010": "AC1024", "R12": "AC1009"}[version]
    if version == "R2010":
        assert document.header["$INSUNITS"] == 4  # millimetres


@every_version
@every_part
def test_contours_read_from_a_drawing_equal_the_part_within_a_micrometre(part, version):
    document = read(dxf_text(cutting(part), version))
    contours = [contour_of(entity) for entity in document.modelspace()]
    *openings, outline = contours  # inside first
    assert len(openings) == len(part.openings)
    for hole, entity in zip(part.holes, document.modelspace(), strict=False):
        assert entity.dxftype() == "CIRCLE"
        x, y, _ = entity.dxf.center
        assert math.dist((x, y), [1e3 * one for one in hole.centre]) < MICROMETRE
        assert 2 * entity.dxf.radius == pytest.approx(1e3 * hole.diameter, abs=MICROMETRE)
    assert outline.area == pytest.approx(part.outline.area, rel=1e-9)
    box = bbox.extents(document.modelspace(), fast=False)
    theirs = [box.extmin.x, box.extmin.y, box.extmax.x, box.extmax.y]
    # Their boxes of bulges are of polygons.
    assert theirs == pytest.approx([1e3 * one for one in part.outline.bounds], abs=2e-2)
    assert outline.bounds == pytest.approx(part.outline.bounds, abs=1e-9)


@every_part
def test_no_cutting_line_crosses_or_doubles_another(part):
    document = read(dxf_text(cutting(part)))
    rings = [contour_of(entity).polygon().exterior for entity in document.modelspace()]
    lines = shapely.union_all(rings)
    # Crossing or touching lines would be split, doubled ones lost.
    assert len(shapely.get_parts(shapely.line_merge(lines))) == len(rings)
    assert lines.length == pytest.approx(sum(ring.length for ring in rings), rel=1e-12)


def test_kerf_is_taken_from_openings_and_added_to_outlines():
    part, kerf = block(), (0.0002, 0.0003)
    document = read(dxf_text(cutting(part, kerf)))
    *openings, outline = [contour_of(entity) for entity in document.modelspace()]
    x0, y0, x1, y1 = part.outline.bounds
    grown = (x0 - 1e-4, y0 - 1.5e-4, x1 + 1e-4, y1 + 1.5e-4)
    assert outline.bounds == pytest.approx(grown, abs=1e-8)
    x0, y0, x1, y1 = openings[0].bounds
    diameter = part.holes[0].diameter
    assert (x1 - x0, y1 - y0) == pytest.approx((diameter - 2e-4, diameter - 3e-4), abs=1e-8)
    equal = read(dxf_text(cutting(part, (2e-4, 2e-4))))
    circles = [one for one in equal.modelspace() if one.dxftype() == "CIRCLE"]
    assert [2 * one.dxf.radius for one in circles] == pytest.approx([2.9] * len(part.holes))


def test_a_part_is_turned_before_its_kerf_is_compensated():
    part = lever()
    paths = cutting(part, (2e-4, 4e-4), (0.1, 0.0, math.pi / 2))
    x0, y0, x1, y1 = part.outline.bounds
    expected = (0.1 - y1 - 1e-4, x0 - 2e-4, 0.1 - y0 + 1e-4, x1 + 2e-4)
    assert paths.outside[0].bounds == pytest.approx(expected, abs=1e-8)


def test_a_kerf_that_no_opening_survives_names_the_part():
    with refuses(InputError, "lever-1a", "narrower than", "smaller kerf"):
        cutting(lever(), (0.0032, 0.0032))


def test_equal_parts_have_equal_files():
    assert dxf_text(cutting(block())) == dxf_text(cutting(block()))
    assert threemf_bytes(PARTS, PLACES, "pair") == threemf_bytes(PARTS, PLACES, "pair")


def test_layers_of_a_sheet_are_in_cutting_order():
    paths = joined(cutting(part, marked=True) for part in PARTS)
    document = read(dxf_text(paths, layered=True))
    layers = [entity.dxf.layer for entity in document.modelspace()]
    assert [*dict.fromkeys(layers)] == ["ENGRAVE", "CUT_INSIDE", "CUT_OUTSIDE"]
    assert document.audit().errors == []


@every_part
def test_marks_are_clear_of_edges_and_openings(part):
    lines = shapely.MultiLineString(mark_lines(part))
    place = place_of(part)
    assert place is not None and place.height >= 0.002
    assert part.polygon().contains(lines)
    assert part.polygon().boundary.distance(lines) > 0.0005


def test_a_mark_that_does_not_fit_is_left_out():
    washer = Part("washer", "pla", 0.001, Contour.circle((0, 0), 0.003), (), (), "WASHER")
    assert mark_lines(washer) == ()


def test_every_letter_of_a_mark_is_another_drawing():
    letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-./+"
    assert len({tuple(stroked(letter, 0.004)) for letter in letters}) == len(letters)
    assert stroked("b1", 0.003) == stroked("B1", 0.003)


@every_part
def test_meshes_are_watertight_with_the_volume_of_the_drawing(part):
    mesh = mesh_of(part)
    solid = trimesh.Trimesh(mesh.corners, mesh.triangles)
    assert solid.is_watertight and solid.is_winding_consistent
    assert solid.volume == pytest.approx(part.area * part.thickness, rel=3e-4)
    loaded = trimesh.load_mesh(io.BytesIO(stl_bytes(mesh, part.name)), file_type="stl")
    assert loaded.is_watertight
    assert loaded.volume == pytest.approx(1e9 * part.area * part.thickness, rel=3e-4)
    x0, y0, x1, y1 = (1e3 * one for one in part.outline.bounds)
    bounds = [[x0, y0, 0.0], [x1, y1, 1e3 * part.thickness]]
    assert loaded.bounds == pytest.approx(np.array(bounds), abs=0.006)


def test_a_3mf_file_has_all_parts_by_name_side_by_side():
    content = threemf_bytes(PARTS, PLACES, "a <pair>")
    with zipfile.ZipFile(io.BytesIO(content)) as file:
        model = ET.fromstring(file.read("3D/3dmodel.model"))
    assert model.get("unit") == "millimeter"
    core = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
    boxes = []
    places = [
        np.array([float(one) for one in item.get("transform", "").split()]).reshape(4, 3).T
        for item in model.iter(f"{core}item")
    ]
    objects = [*model.iter(f"{core}object")]
    for part, found, place in zip(PARTS, objects, places, strict=True):
        assert found.get("name") == part.name
        corners, triangles = (
            np.array([[float(one.get(key, "")) for key in keys] for one in found.iter(core + name)])
            for name, keys in (("vertex", "xyz"), ("triangle", ("v1", "v2", "v3")))
        )
        solid = trimesh.Trimesh(corners, triangles.astype(int))
        assert solid.is_watertight
        assert solid.volume == pytest.approx(1e9 * part.area * part.thickness, rel=3e-4)
        solid.apply_transform(np.vstack([place, (0, 0, 0, 1)]))
        x0, y0, x1, y1 = part.outline.moved(*PLACES[len(boxes)]).bounds
        assert solid.bounds[:, :2].ravel() == pytest.approx(
            1e3 * np.array([x0, y0, x1, y1]), abs=5e-3
        )
        assert solid.bounds[0, 2] == 0.0
        boxes.append(shapely.box(*solid.bounds[:, :2].ravel()))
    assert not boxes[0].intersects(boxes[1])


def test_openings_that_meet_are_no_solid():
    holes = (Hole((0.0, 0.0), 0.004, "A1"), Hole((0.003, 0.0), 0.004, "A2"))
    part = Part("plate", "acrylic", 0.003, Contour.circle((0, 0), 0.02), holes)
    with refuses(InputError, "plate", "2 openings", "cross each other"):
        mesh_of(part)


@every_part
def test_an_svg_file_is_1_to_1_in_millimetres(part):
    root = ET.fromstring(svg_text(cutting(part, marked=True), part.name, margin=0.001))
    x0, y0, x1, y1 = part.outline.bounds
    assert float(root.get("width", "").removesuffix("mm")) == pytest.approx(1e3 * (x1 - x0) + 2)
    assert float(root.get("height", "").removesuffix("mm")) == pytest.approx(1e3 * (y1 - y0) + 2)
    assert root.get("viewBox", "").split()[2:] == [
        root.get(name, "").removesuffix("mm") for name in ("width", "height")
    ]
    groups = [one.get("id") for one in root.iter("{http://www.w3.org/2000/svg}g")]
    assert groups == ["ENGRAVE", "CUT_INSIDE", "CUT_OUTSIDE"]
    paths = [one.get("d", "") for one in root.iter("{http://www.w3.org/2000/svg}path")]
    assert all(re.fullmatch(r"[MLAZ0-9. -]+", one) for one in paths)


@pytest.mark.skipif(not have("step"), reason="build123d, the extra `step`, is not installed")
@every_part
def test_a_step_file_is_an_exact_solid(part, tmp_path):
    import build123d  # pyright: ignore[reportMissingImports]

    file = tmp_path / "part.step"
    file.write_bytes(step_bytes(part))
    solid = build123d.import_step(str(file))
    assert solid.volume == pytest.approx(1e9 * part.area * part.thickness, rel=1e-9)


@pytest.mark.skipif(have("step"), reason="build123d is installed")
def test_without_build123d_the_message_names_the_command():
    with refuses(ExtraError, "build123d", "pip install", "step", "STL"):
        step_bytes(block())
