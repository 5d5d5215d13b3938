"""Contours and hand-made parts for tests of the build."""

import math

from hypothesis import strategies as st

from stepwell.build import Contour, Hole, Part

mm = 1e-3
sizes = st.floats(1.0, 60.0)
angles = st.floats(-math.pi, math.pi)


@st.composite
def stars(draw):
    """Star-shaped polygons, convex or not, with rounded corners."""
    count = draw(st.integers(3, 9))
    reaches = draw(st.lists(st.floats(20.0, 50.0), min_size=count, max_size=count))
    corners = [
        (mm * r * math.cos(math.tau * i / count), mm * r * math.sin(math.tau * i / count))
        for i, r in enumerate(reaches)
    ]
    return Contour.rounded(corners, mm * draw(st.sampled_from([0.0, 0.5, 1.0])))


@st.composite
def slots(draw):
    end = (mm * draw(sizes), mm * draw(sizes))
    return Contour.slot((0.0, 0.0), end, mm * draw(st.floats(1.0, 9.0)))


@st.composite
def arc_slots(draw):
    first = draw(angles)
    last = first + draw(st.floats(0.2, 5.0))
    return Contour.arc_slot((0.0, 0.0), 0.020, first, last, mm * draw(st.floats(1.0, 9.0)))


@st.composite
def contours(draw):
    """Any of the shapes, turned and shifted."""
    circles = st.builds(lambda r: Contour.circle((0.0, 0.0), mm * r), sizes)
    shape = draw(st.one_of(stars(), slots(), arc_slots(), circles))
    shape = shape.mirrored() if draw(st.booleans()) else shape
    return shape.moved(mm * draw(sizes), mm * draw(sizes), draw(angles))


def block() -> Part:
    """A plate with pins, a hole grid and a slot, like the top plate of a block."""
    pins = [Hole((0.010 * side, 0.0), 0.0031, f"P{i}") for i, side in enumerate((-1, 1), 1)]
    grid = [
        Hole((0.005 * i, 0.010 + 0.005 * j), 0.0031, f"{'ABCDE'[i + 2]}{j + 1}", "grid")
        for i in range(-2, 3)
        for j in range(3)
    ]
    outline = Contour.rounded(
        [(-0.016, -0.006), (0.016, -0.006), (0.016, 0.026), (-0.016, 0.026)], 0.002
    )
    slot = Contour.slot((-0.006, -0.0), (0.006, -0.0), 0.003)
    holes = (*pins, *grid)
    return Part("block-1-top", "acrylic", 0.003, outline, holes, (slot,), "B1", 2, 0.0066)


def lever() -> Part:
    """A lever with a pin hole and an arc slot."""
    outline = Contour.rounded(
        [
            (-0.012, -0.006),
            (0.022, -0.006),
            (0.022, 0.006),
            (0.008, 0.006),
            (0.0, 0.014),
            (-0.012, 0.014),
        ],
        [0.004, 0.0059, 0.0059, 0.002, 0.003, 0.004],
    )
    slot = Contour.arc_slot((0.0, 0.0), 0.007, math.radians(-30), math.radians(100), 0.0032)
    holes = (Hole((0.0, 0.0), 0.0031, "P1"), Hole((0.016, 0.0), 0.0031, "P2"))
    return Part("lever-1a", "acrylic", 0.003, outline, holes, (slot,), "L1a", 1, 0.0033)
