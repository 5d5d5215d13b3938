"""Marks on parts, engraved in letters of single strokes."""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from stepwell.base import Vec2
from stepwell.build.contour import placed
from stepwell.build.part import Part

Line = tuple[Vec2, ...]
# Glyphs on a grid 4 wide and 6 high. Lines are separated by spaces; points are pairs of digits, x
# then y. Fonts of the machine are not used, so a file is the same everywhere.
_GLYPHS = {
    "0": "100105163645413010 1135",
    "1": "152620 1030",
    "2": "05163645440040",
    "3": "05163645443313 334241301001",
    "4": "360242 3630",
    "5": "460603334241301001",
    "6": "4536160501103041423303",
    "7": "064610",
    "8": "13334241301001021304051636454433",
    "9": "0110304145361605041343",
    "A": "002640 1333",
    "B": "000636454433 033342413000",
    "C": "4536160501103041",
    "D": "00062644422000",
    "E": "46060040 0333",
    "F": "460600 0333",
    "G": "45361605011030414323",
    "H": "0006 4046 0343",
    "I": "2026",
    "J": "3631201001",
    "K": "0006 4602 1340",
    "L": "060040",
    "M": "0006234640",
    "N": "00064046",
    "O": "100105163645413010",
    "P": "00063645443303",
    "Q": "100105163645413010 2240",
    "R": "00063645443303 2340",
    "S": "453616050413334241301001",
    "T": "0646 2620",
    "U": "060110304146",
    "V": "062046",
    "W": "0610233046",
    "X": "0046 0640",
    "Y": "062346 2320",
    "Z": "06460040",
    "-": "1333",
    ".": "2021",
    "/": "0046",
    "+": "2125 0343",
    " ": "",
}
_UNKNOWN = "0006464000"
_HIGH, _ADVANCE, _GAP = 6.0, 5.6, 1.6
# Heights that are tried [m], distance from edges and openings [m], and step of the places [m].
_HEIGHTS = 0.004, 0.003, 0.0025, 0.002, 0.0015
_CLEAR, _STEP, _CHUNK = 0.0006, 0.001, 256


def stroked(text: str, height: float) -> list[Line]:
    """Lines of a text [m] around the origin, `height` [m] high; small letters become capitals."""
    unit = height / _HIGH
    left, low = -width_of(text, height) / 2.0, -height / 2.0
    return [
        tuple(
            (left + unit * (place * _ADVANCE + int(x)), low + unit * int(y))
            for x, y in zip(line[::2], line[1::2], strict=True)
        )
        for place, letter in enumerate(text.upper())
        for line in _GLYPHS.get(letter, _UNKNOWN).split()
    ]


def width_of(text: str, height: float) -> float:
    """Width of a text [m]."""
    return height / _HIGH * (_ADVANCE * len(text) - _GAP)


class MarkPlace(NamedTuple):
    """Where a mark is on its part: centre [m], height [m], and angle [rad]."""

    centre: Vec2
    height: float
    angle: float


@lru_cache(maxsize=512)
def place_of(part: Part) -> MarkPlace | None:
    """The place of the part's mark, clear of edges and openings; None if there is none.

    The largest letters that fit, as near to the middle of the part as possible.
    """
    import shapely

    if not part.mark:
        return None
    room = part.polygon(2e-5).buffer(-_CLEAR)
    shapely.prepare(room)
    x0, y0, x1, y1 = part.outline.bounds
    xs, ys = np.arange(x0 + _STEP, x1, _STEP), np.arange(y0 + _STEP, y1, _STEP)
    x, y = (grid.ravel() for grid in np.meshgrid(xs, ys))
    order = np.argsort(np.hypot(x - (x0 + x1) / 2.0, y - (y0 + y1) / 2.0), kind="stable")
    x, y = x[order], y[order]
    for height in _HEIGHTS:
        for angle in (0.0, math.pi / 2):
            half = width_of(part.mark, height) / 2.0, height / 2.0
            across, up = half if angle == 0.0 else half[::-1]
            # The middle is usually free, so few places are tried at first.
            for at in range(0, len(x), _CHUNK):
                a, b = x[at : at + _CHUNK], y[at : at + _CHUNK]
                boxes = shapely.box(a - across, b - up, a + across, b + up)
                fits = shapely.contains(room, boxes)
                if fits.any():
                    first = int(np.argmax(fits))
                    return MarkPlace((float(a[first]), float(b[first])), height, angle)
    return None


def mark_lines(part: Part) -> tuple[Line, ...]:
    """Lines of the part's mark in its frame [m]; none if the mark does not fit."""
    place = place_of(part)
    if place is None:
        return ()
    lines = stroked(part.mark, place.height)
    return tuple(tuple(placed(line, *place.centre, place.angle)) for line in lines)
