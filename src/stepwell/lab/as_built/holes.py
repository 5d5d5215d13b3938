"""Holes: where an anchor may be by mistake, one hole beside the one on the drawing."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from stepwell.base import ByValue, Floats, Vec2, percent
from stepwell.design import Parameter, parameters
from stepwell.mechanism import Chain

WAYS: tuple[Vec2, ...] = ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))
_COUNTS = {1: "one hole", 2: "two holes", 3: "three holes"}


@dataclass(frozen=True)
class Holes:
    """What is believed of the holes of a build before it is tried.

    Of anchors a motion knows d = q - p alone, so a cell has one shift, of its q; a wrong hole of p
    is the opposite one.

    Attributes:
        anchors: q of every cell that has one.
        apart: how far holes are apart [m].
        chance: that an anchor is one hole off, along x or y.
    """

    anchors: tuple[Parameter, ...]
    apart: float
    chance: float

    @property
    def columns(self) -> int:
        """How many random numbers tell the holes of one build."""
        return len(self.anchors) if self.chance else 0

    @property
    def _drawn(self) -> float:
        """The share of wrong holes among those drawn: of all cells about one."""
        return 1.0 / (1.0 + len(self.anchors))

    def shifts(self, even: Floats) -> Floats:
        """(cells, 2) by how much q of each cell is off [m], for numbers (cells,) from 0 to 1."""
        found = np.zeros((len(even), 2))
        wrong = even < self._drawn
        way = np.minimum((even[wrong] / self._drawn * len(WAYS)).astype(int), len(WAYS) - 1)
        found[wrong] = self.apart * np.array(WAYS)[way]
        return found

    def price(self, even: Floats) -> float:
        """By how much less likely these holes are than they are drawn: minus the logarithm."""
        off = 2.0 * self.chance  # of two anchors either
        wrong = int(np.sum(even < self._drawn))
        right = len(even) - wrong
        dear = math.log(self._drawn / off) if wrong else 0.0
        return wrong * dear + right * math.log((1.0 - self._drawn) / (1.0 - off))

    def moved(self, chain: Chain, shifts: Floats) -> Chain:
        """A chain with its anchors in other holes."""
        for anchor, (dx, dy) in zip(self.anchors, shifts.tolist(), strict=True):
            if dx or dy:
                chain = anchor.displaced(chain, (dx, dy))
        return chain


@dataclass(frozen=True, eq=False)
class WrongHole(ByValue):
    """An anchor that may be one hole off.

    Attributes:
        anchor: q of a cell; p the other way would do the same.
        was, to: where its first band has it on the drawing, and where it may be [m].
        share: of the builds that agree with what was seen, how many have it there.
    """

    anchor: Parameter
    was: Vec2
    to: Vec2
    share: float

    def __str__(self):
        return f"{named(self.anchor)} is {way_in_words(self.was, self.to, 1)}"

    def __repr__(self):
        return f"WrongHole({self}: {percent(self.share)})"


def outer_anchors(chain: Chain) -> tuple[Parameter, ...]:
    """q of every cell that has anchors."""
    return tuple(one for one in parameters(chain) if one.part == "q")


def place_of(anchor: Parameter, chain: Chain) -> Vec2:
    """Where the first band has an anchor [m]."""
    x, y = np.asarray(anchor.value(chain), float).tolist()
    return x, y


def named(anchor: Parameter) -> str:
    """An anchor in words."""
    cell, _, part = anchor.name.rpartition(".")
    return f"{part} of {cell}"


def way_in_words(was: Vec2, to: Vec2, holes: int) -> str:
    """How far from one place to another, in holes; along x q goes outwards, away from its block."""
    dx, dy = to[0] - was[0], to[1] - was[1]
    if abs(dx) > abs(dy):
        word = "outwards" if dx > 0 else "inwards"
    else:
        word = "along +y" if dy > 0 else "along -y"
    return f"{_COUNTS[holes]} {word}"
