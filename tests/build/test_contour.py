"""Promises about contours: exact area, bounds and moments, and the same shape in any place."""

import math

import pytest
import shapely
from hypothesis import given, settings

from build.shapes import contours
from facts import refuses
from stepwell.base import InputError
from stepwell.build import Contour


@given(contours())
@settings(max_examples=60, deadline=None)
def test_polygons_approach_the_exact_area_with_the_square_of_their_step(contour):
    exact = contour.area
    coarse, fine = (abs(contour.polygon(s).area - exact) for s in (4e-5, 1e-6))
    # An error of area is at most the sagitta times the length of the arcs.
    assert fine <= 1e-6 * contour.polygon().length + 1e-16
    assert fine <= 0.2 * coarse + 1e-14


@given(contours())
@settings(max_examples=60, deadline=None)
def test_bounds_are_those_of_a_fine_polygon(contour):
    assert contour.bounds == pytest.approx(contour.polygon(1e-8).bounds, abs=2e-8)


@given(contours())
@settings(max_examples=60, deadline=None)
def test_contours_are_simple_and_counter_clockwise(contour):
    polygon = contour.polygon()
    assert polygon.is_valid
    assert shapely.is_ccw(polygon.exterior)


@given(contours())
@settings(max_examples=60, deadline=None)
def test_a_mirror_image_has_the_same_area_and_the_mirrored_bounds(contour):
    x0, y0, x1, y1 = contour.bounds
    image = contour.mirrored()
    assert image.area == pytest.approx(contour.area, rel=1e-12)
    assert image.bounds == pytest.approx((-x1, y0, -x0, y1), abs=1e-15)
    assert image.mirrored().polygon().symmetric_difference(contour.polygon()).area < 1e-15


@given(contours())
@settings(max_examples=60, deadline=None)
def test_corners_of_the_ring_are_on_the_contour(contour):
    fine = contour.polygon(1e-9).exterior
    assert max(shapely.distance(fine, shapely.points(contour.ring(1e-4)))) < 2e-9


def test_shapes_have_the_areas_of_geometry():
    r, w = 0.010, 0.003
    assert Contour.circle((5.0, 2.0), r).area == pytest.approx(math.pi * r * r, rel=1e-13)
    slot = Contour.slot((0, 0), (0.03, 0.04), w)
    assert slot.area == pytest.approx(0.05 * w + math.pi * w * w / 4, rel=1e-13)
    curved = Contour.arc_slot((1, 1), r, -1.0, 2.0, w)
    assert curved.area == pytest.approx(3 * r * w + math.pi * w * w / 4, rel=1e-12)
    square = Contour.rounded([(0, 0), (0, r), (r, r), (r, 0)], 0.002)
    assert square.area == pytest.approx(r * r - (4 - math.pi) * 0.002**2, rel=1e-13)
    assert len(Contour.rounded([(0, 0), (r, 0), (r, r), (0, r)], r / 2).points) == 4


def test_invalid_contours_are_refused_with_the_reason():
    with refuses(InputError, "area", "> 0", "counter-clockwise"):
        Contour(((0, 0), (0, 1), (1, 1)), (0, 0, 0))
    with refuses(InputError, "points[1]", "0.1 µm"):
        Contour(((0, 0), (1, 0), (1, 0), (1, 1)), (0, 0, 0, 0))
    with refuses(InputError, "bulges", "3", "points", "must be equal"):
        Contour(((0, 0), (1, 0), (1, 1), (0, 1)), (0, 0, 0))
    with refuses(InputError, "edge", "10 mm", "smaller radii"):
        Contour.rounded([(0, 0), (0.01, 0), (0.01, 0.01), (0, 0.01)], 0.006)
    with refuses(InputError, "0 to 400 degrees", "less than 360"):
        Contour.arc_slot((0, 0), 0.01, 0.0, math.radians(400), 0.003)
