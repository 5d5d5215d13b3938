"""Promises about nested sheets and the coupon."""

import io
import math

import pytest
import shapely
from ezdxf.filemanagement import read as read_dxf

from build.shapes import block, lever
from facts import refuses
from stepwell.base import InputError
from stepwell.build import Contour, Part
from stepwell.build.exports.coupon import WINDOW, coupon
from stepwell.build.exports.dxf import dxf_text
from stepwell.build.exports.sheets import MARGIN, CutSheet, sheets

MANY = [
    Part(f"{part.name}-{i}", part.material, part.thickness, part.outline, part.holes, part.cutouts)
    for part in (block(), lever())
    for i in range(6)
]


def areas(sheet: CutSheet) -> list[shapely.Polygon]:
    placed = zip(sheet.parts, sheet.places, strict=True)
    return [shapely.Polygon(part.outline.moved(*place).ring()) for part, place in placed]


def assert_good(made: tuple[CutSheet, ...], parts, bed):
    assert sorted(part.name for sheet in made for part in sheet.parts) == sorted(
        part.name for part in parts
    )
    inside = shapely.box(MARGIN, MARGIN, bed[0] - MARGIN, bed[1] - MARGIN).buffer(2e-6)
    for sheet in made:
        polygons = areas(sheet)
        assert all(inside.contains(one) for one in polygons)
        apart = [a.distance(b) for i, a in enumerate(polygons) for b in polygons[:i]]
        assert min(apart, default=1.0) > 0.0009


def test_parts_in_rows_are_inside_the_bed_and_apart_and_the_same_every_time():
    bed = (0.12, 0.10)
    made = sheets(MANY, bed, seconds=0)
    assert_good(made, MANY, bed)
    assert len(made) > 1
    assert made == sheets(MANY, bed, seconds=0)
    assert [sheet.name for sheet in made][:2] == ["acrylic-3mm-1", "acrylic-3mm-2"]


def test_nested_parts_are_inside_the_bed_and_apart_and_need_no_more_sheets_than_rows():
    bed, shown = (0.12, 0.12), []
    made = sheets(MANY, bed, seconds=1, progress=lambda *one: shown.append(one))
    assert_good(made, MANY, bed)
    assert len(made) <= len(sheets(MANY, bed, seconds=0))
    assert shown[-1] == (1.0, 1.0)


def test_a_failed_nester_leaves_parts_in_rows(monkeypatch):
    monkeypatch.setattr("stepwell.build.exports.nester.places", lambda *_: None)
    bed = (0.2, 0.2)
    assert sheets(MANY, bed, seconds=1) == sheets(MANY, bed, seconds=0)


def test_a_crash_of_the_nester_is_no_crash_of_the_caller(monkeypatch, tmp_path):
    broken = tmp_path / "nester.py"
    broken.write_text("import os\nos.abort()\n")
    monkeypatch.setattr("stepwell.build.exports.nester.__file__", str(broken))
    assert_good(sheets(MANY[:2], (0.2, 0.2), seconds=1), MANY[:2], (0.2, 0.2))


def test_materials_and_thicknesses_have_sheets_of_their_own():
    plates = [
        Part(f"{m}{t}", m, t, Contour.circle((0, 0), 0.01))
        for m, t in (("acrylic", 0.003), ("plywood", 0.003), ("acrylic", 0.005))
    ]
    names = [sheet.name for sheet in sheets(plates, (0.1, 0.1), seconds=0)]
    assert names == ["acrylic-3mm-1", "acrylic-5mm-1", "plywood-3mm-1"]


def test_a_part_larger_than_the_bed_is_refused_before_nesting():
    with refuses(InputError, "block-1-top-0", "32 x 32 mm", "30 x 200 mm", "bed_mm"):
        sheets(MANY, (0.030, 0.200), seconds=5)


def test_a_sheet_has_its_edge_and_a_bar_of_100_mm_as_guides():
    (sheet,) = sheets([block()], (0.3, 0.2), seconds=0)
    paths = sheet.cutting((2e-4, 2e-4))
    lengths = [
        math.dist(*line) for line in paths.guides if len(line) == 2 and line[0][1] == line[1][1]
    ]
    assert max(lengths) == pytest.approx(0.100, abs=1e-12)
    assert paths.guides[0][2] == (0.3, 0.2)
    assert sheet.place("block-1-top") is not None
    assert sheet.place("lever-1a") is None


def test_the_coupon_measures_the_kerf_of_x_and_y_apart():
    kerf_x, kerf_y = 0.00018, 0.00025
    made = coupon("acrylic", 0.003, (0.003, 0.003))
    (window,) = made.part.cutouts
    x0, y0, x1, y1 = window.bounds
    assert (x1 - x0, y1 - y0) == pytest.approx(WINDOW)
    # What a beam of this kerf leaves, by the formula that is printed.
    plug, hole = window.offset(-kerf_x / 2, -kerf_y / 2), window.offset(kerf_x / 2, kerf_y / 2)
    sizes = [(b[2] - b[0], b[3] - b[1]) for b in (hole.bounds, plug.bounds)]
    measured = [(big - small) / 2 for big, small in zip(*sizes, strict=True)]
    assert measured == pytest.approx([kerf_x, kerf_y], abs=1e-9)


def test_the_coupon_has_test_holes_around_the_pin_with_their_sizes_and_bridges_between():
    made = coupon("acrylic", 0.003, (0.003, 0.002))
    sizes = sorted(hole.diameter for hole in made.part.holes)
    assert sizes[0] == pytest.approx(0.0018) and sizes[-1] == pytest.approx(0.0032)
    assert {hole.name for hole in made.part.holes} >= {"280", "300", "320", "180"}
    area = made.part.polygon()
    assert area.is_valid and area.geom_type == "Polygon"
    labels = shapely.MultiLineString(made.labels)
    assert area.contains(labels)
    assert area.boundary.distance(labels) > 2e-4


@pytest.mark.parametrize("version", ["R2010", "R12"])
def test_no_path_of_a_nested_sheet_crosses_or_doubles_another(version):
    (sheet,) = sheets(MANY, (0.3, 0.2), seconds=1)
    text = dxf_text(sheet.cutting((2e-4, 2e-4)), version, layered=True)
    audit = read_dxf(io.StringIO(text)).audit()
    assert (audit.errors, audit.fixes) == ([], [])
    paths = sheet.cutting((2e-4, 2e-4))
    rings = [one.polygon().exterior for one in (*paths.inside, *paths.outside)]
    tree = shapely.STRtree(rings)
    one, two = tree.query(rings, predicate="intersects")
    assert set(zip(one, two, strict=True)) == {(i, i) for i in range(len(rings))}
