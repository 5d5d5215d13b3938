"""The killer: the smallest change of one thing after which a design no longer does it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from stepwell.base import REACH, bisected
from stepwell.design.margins import Change, margin
from stepwell.design.plane import Method
from stepwell.design.tolerances import USUAL, Tolerances, ends_right
from stepwell.mechanism import Chain, Element
from stepwell.sequences import Program
from stepwell.statics import StaticsError

# How much is tried, in tolerances, until something breaks; and where bisection stops.
_TRIED = 0.125 * 1.5 ** np.arange(17)
_HALVINGS = 12
_WAYS = (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)
# Farthest that is looked at [m], and [1]: a number that is nearly taken away is no longer one.
_REACH = {"anchor": REACH, "stiffness": 0.95, "force_scale": 0.95, "travel_scale": 0.95}


class ProgramChange(Change):
    """A change after which a program ends in another state: no sequence describes that."""

    @cached_property
    def becomes(self) -> str:
        """Nothing."""
        return ""


class _Way(NamedTuple):
    """A direction in which one thing changes."""

    cell: int
    part: str
    along: tuple[float, float] | float


def killer_of_cycle(chain: Chain, tolerances: Tolerances) -> Change | None:
    """The change of a margin that is fewest tolerances away; None where there is none.

    Args:
        chain: a design that does what is wanted.
        tolerances: by which an anchor is compared with a number; the usual ones where it has none.

    Raises:
        StaticsError: as for `Chain.margin`.
    """
    near = min(
        margin(chain).changes, key=lambda one: one.distance / _size(one.parameter, tolerances)
    )
    return None if math.isinf(near.distance) else near


def killer_of_program(program: Program, tolerances: Tolerances) -> Change | None:
    """The same of a program that ends where it should; None where nothing within reach breaks it.

    Anchors are moved along x and y, numbers made more and less: of each the amounts tried are a
    geometric row, and the first that breaks it is bisected.
    """
    chain = program.chain
    ways = list(_ways(chain))

    def change(way: _Way, tried: float) -> Change:
        return _change(chain, way, tried * _size(way.part, tolerances))

    def holds(way: _Way, tried: float) -> bool:
        made = change(way, tried)
        if made.distance > _REACH[made.parameter]:
            return True
        try:
            assert made.design is not None
            return ends_right(made.design, program.turning_points, program.start, program.to)
        except (ValueError, StaticsError):
            return False

    for safe, tried in pairwise([0.0, *_TRIED.tolist()]):
        broken = [
            (bisected(lambda size, way=way: holds(way, size), safe, tried, _HALVINGS)[1], way)
            for way in ways
            if not holds(way, tried)
        ]
        if broken:
            least, way = min(broken, key=lambda one: one[0])
            return change(way, least)
    return None


def _ways(chain: Chain) -> Iterator[_Way]:
    for cell, one in enumerate(chain.cells):
        numbers = ("force_scale", "travel_scale") if isinstance(one, Element) else ("stiffness",)
        if not isinstance(one, Element):
            yield from (_Way(cell, "anchor", along) for along in _WAYS)
        for part in numbers:
            yield from (_Way(cell, part, along) for along in (1.0, -1.0))


def _change(chain: Chain, way: _Way, size: float) -> ProgramChange:
    along = way.along
    move = (along[0] * size, along[1] * size) if isinstance(along, tuple) else along * size
    return ProgramChange(chain, way.cell, way.part, size, move, move, Method.SEARCH)


def _size(part: str, tolerances: Tolerances) -> float:
    """The tolerance of a part [m] or [1], or the usual one where it has none."""
    if part == "anchor":
        return tolerances.anchor or USUAL.anchor
    own = tolerances.travel if part == "travel_scale" else tolerances.stiffness
    return own or USUAL.stiffness
