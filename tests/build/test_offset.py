"""Promises about offset contours: kerf compensation against shapely's buffer."""

import math

import pytest
import shapely
from hypothesis import given, settings, strategies as st

from build.shapes import contours, lever, mm
from facts import refuses
from stepwell.base import InputError
from stepwell.build import Contour

FINE = 1e-7
kerfs = st.floats(0.02, 0.20)


def furthest(one: shapely.Geometry, two: shapely.Geometry) -> float:
    """Distance of two closed lines, by the points of both."""
    return max(
        float(shapely.distance(b, shapely.points(shapely.get_coordinates(a))).max())
        for a, b in ((one, two), (two, one))
    )


def buffered(contour: Contour, dx: float, dy: float) -> shapely.Polygon:
    """The offset by shapely: an ellipse is a circle after scaling."""
    scaled = shapely.transform(contour.polygon(FINE), lambda xy: xy / (abs(dx), abs(dy)))
    moved = scaled.buffer(math.copysign(1.0, dx), quad_segs=128)
    return shapely.transform(moved, lambda xy: xy * (abs(dx), abs(dy)))


@given(contours(), kerfs, st.sampled_from([1, -1]))
@settings(max_examples=30, deadline=None)
def test_equal_offsets_are_those_of_a_buffer(contour, distance, sign):
    moved = contour.offset(sign * mm * distance, sign * mm * distance)
    theirs = buffered(contour, sign * mm * distance, sign * mm * distance)
    assert furthest(moved.polygon(FINE).exterior, theirs.exterior) < 4e-7


@given(contours(), st.floats(0.02, 0.10), st.floats(0.5, 2.0), st.sampled_from([1, -1]))
@settings(max_examples=30, deadline=None)
def test_unequal_offsets_deviate_by_less_than_5_micrometres_from_an_elliptical_buffer(
    contour, dx, ratio, sign
):
    dy = ratio * dx
    moved = contour.offset(sign * mm * dx, sign * mm * dy)
    theirs = buffered(contour, sign * mm * dx, sign * mm * dy)
    assert furthest(moved.polygon(FINE).exterior, theirs.exterior) < 2e-6


def test_an_equal_offset_of_a_circle_is_a_circle():
    moved = Contour.circle((0.01, 0.02), 0.005).offset(1e-4, 1e-4)
    assert (
        moved.polygon().symmetric_difference(Contour.circle((0.01, 0.02), 0.0051).polygon()).area
        < 1e-15
    )
    assert len(moved.points) == 2


def test_rounded_corners_stay_tangential_and_grow_or_shrink():
    square = Contour.rounded([(0, 0), (0.02, 0), (0.02, 0.02), (0, 0.02)], 0.002)
    for distance in (1e-4, -1e-4):
        moved = square.offset(distance, distance)
        radius = 0.002 + distance
        expected = (0.02 + 2 * distance) ** 2 - (4 - math.pi) * radius**2
        assert len(moved.points) == 8
        assert moved.area == pytest.approx(expected, rel=1e-12)


def test_a_rounding_smaller_than_an_inner_offset_becomes_a_sharp_corner():
    square = Contour.rounded([(0, 0), (0.02, 0), (0.02, 0.02), (0, 0.02)], 0.0001)
    moved = square.offset(-2e-4, -2e-4)
    assert len(moved.points) == 4
    assert moved.area == pytest.approx((0.02 - 4e-4) ** 2, rel=1e-12)


def test_an_offset_back_returns_the_contour_where_no_corner_is_lost():
    outline = lever().outline
    there = outline.offset(1e-4, 1e-4).offset(-1e-4, -1e-4)
    assert furthest(there.polygon(FINE).exterior, outline.polygon(FINE).exterior) < 3e-7


def test_impossible_offsets_are_refused_with_the_reason():
    slot = Contour.slot((0, 0), (0.01, 0), 0.003)
    with refuses(InputError, "0.1 mm in x", "-0.1 mm in y", "coupon"):
        slot.offset(1e-4, -1e-4)
    with refuses(InputError, "narrower than", "smaller kerf"):
        slot.offset(-2e-3, -2e-3)
    with refuses(InputError, "radius of 1.5 mm", "larger radius"):
        slot.offset(-1.4e-3, -1e-3)
