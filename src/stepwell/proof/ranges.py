"""Enclosed forces of lever cells, and of all cells with an anchor in a rectangle."""

import math

from stepwell.mechanism import Cell
from stepwell.proof import balls
from stepwell.proof.balls import ball, hull
from stepwell.proof.cell_boxes import ALL, CellBox, CellPart
from stepwell.proof.order_boxes import OrderedBox
from stepwell.sequences import Cycle

# The least and the largest value of a force [N], rounded outwards.
CriticalRange = tuple[float, float]
Around = tuple[float, float]


def force_range(cell: Cell, sine: float, around: Around = (0.0, 0.0)) -> CriticalRange:
    """The force at sin θ of a cell, for all anchors q within a rectangle around its own.

    Args:
        cell: a lever cell without friction.
        sine: sin θ [1].
        around: half width and half height of the rectangle [m].
    """
    box = _box(cell, around)
    at = ball(sine)
    value = box.force([hull(a, b) for a, b in box.spans], at)
    if not box.parts:
        return _outward(value)
    centre = box.force([balls.middle((a + b) / 2) for a, b in box.spans], at).value
    mean = centre
    for (a, b), slope in zip(box.spans, value.slopes, strict=True):
        mean = mean + slope * ((b - a) / 2) * balls.UNIT
    plain = value.value
    return _outward(plain.intersection(mean) if mean.is_finite() and plain.is_finite() else plain)


def critical_ranges(cell: Cell, around: Around = (0.0, 0.0)) -> tuple[CriticalRange, CriticalRange]:
    """F0 and F1 of a cell; all else as for `force_range`."""
    sine = cell.sin_limit
    return force_range(cell, -sine, around), force_range(cell, sine, around)


def falling(cell: Cell, around: Around = (0.0, 0.0)) -> bool:
    """Whether the force is proved to fall over the travel, for all anchors in a rectangle."""
    return _box(cell, around).falls()


def sorted_as(cycle: Cycle) -> bool:
    """Whether a cycle is proved by the order of its enclosed critical forces."""
    return OrderedBox(cycle, [()] * len(cycle.chain)).decide().proved


def _box(cell: Cell, around: Around) -> CellBox:
    x, y = around
    if not (x or y):
        return CellBox(cell)
    return CellBox(cell, (CellPart("x", ALL, -x, x), CellPart("y", ALL, -y, y)))


def _outward(value: balls.Ball) -> CriticalRange:
    low, high = float(balls.low(value)), float(balls.high(value))
    return math.nextafter(low, -math.inf), math.nextafter(high, math.inf)
