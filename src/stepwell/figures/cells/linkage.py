"""Where the blocks, levers, bands and elements of a chain are, drawn flat on the page."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from stepwell.base import Bools, Floats
from stepwell.figures.cells.symbol import Symbol
from stepwell.mechanism import Cell, Chain, Element

# Of chains without levers, which have no size of their own: a lever, and the longest travel [m].
_LEVER, _TRAVEL = 0.0141, 0.020


@dataclass(frozen=True, slots=True)
class Pose:
    """The parts of a chain at given travels, in metres on the page.

    Args:
        blocks: (N + 1, 4) left, bottom, right, top of each block, fixed one first.
        levers: (2 N, 2, 2) ends of each lever.
        bands: (B, 2, 2) ends of each band, p then q, cell by cell.
        posts: (2 B, 2, 2) from a block's joint midpoint to an anchor on that block.
        tension: (B,) of each band [N].
        slack: (B,) whether the band is slack.
        boxes: (E, 4) left, bottom, right, top of each element's symbol.
        rods: (2 E, 2, 2) from the blocks to the symbols.
        dots: (E, 2) where each element stands on the curve in its symbol.
    """

    blocks: Floats
    levers: Floats
    bands: Floats
    posts: Floats
    tension: Floats
    slack: Bools
    boxes: Floats
    rods: Floats
    dots: Floats

    @property
    def points(self) -> Floats:
        """(n, 2) corners of blocks and symbols, ends of all else but the posts [m]."""
        parts = (self.blocks, self.bands, self.levers, self.boxes)
        return np.concatenate([part.reshape(-1, 2) for part in parts])


class LinkageDrawing:
    """Places a chain on the page: stroke to the right, fixed block at the left.

    A cell's own drawing has the travel upwards and the outer block beside the inner one. Here
    the travel is turned to the right, and every second cell is mirrored across the stroke, which
    changes no band length: the blocks then lie in two rows that the levers zig-zag between, and
    a chain of any length stays as slender as one cell. The length of the middle blocks is free in
    the model; here each is as long as it must be to clear its neighbours in every state.

    An element is a box on the rod between two blocks, true in its travel. Without levers, so that
    nothing has a size that could be drawn, the longest travel is 20 mm.

    Args:
        chain: what to draw.
        reached: (n, N) travels [m] that will be drawn, for elements that go past an open end.
    """

    def __init__(self, chain: Chain, reached: Sequence[Sequence[float] | Floats] = ()):
        self.chain = chain
        cells = [cell for cell in chain.cells if isinstance(cell, Cell)]
        lever = max((cell.lever for cell in cells), default=_LEVER)
        # Drawn metres by one of travel.
        self.unit = 1.0 if cells else _TRAVEL / max(chain.full_travels)
        # Half the distance between the two levers, and what a block has beyond its joint midpoint.
        self.half_pair = 0.30 * lever
        self.reach = 0.52 * lever
        self.half_block = 0.26 * min([lever, *(c.lever * math.cos(c.limit) * 1.4 for c in cells)])
        room = 2 * self.reach + 0.25 * lever
        halves = [c.full_travel / 2 if isinstance(c, Cell) else 0.0 for c in chain.cells]
        # Nothing can come near a block beside an element.
        self.spans = [a + b + (room if a and b else 0.0) for a, b in pairwise(halves)]
        self.owner = np.array(
            [i for i, cell in enumerate(chain.cells) if isinstance(cell, Cell) for _ in cell.bands],
            int,
        )
        # The side of a symbol, and the shortest rods at it.
        self.box, self.rod = 1.5 * lever, 0.3 * lever
        columns = zip(*reached, strict=True) if len(reached) else ((),) * len(chain)
        self.symbols = {
            i: Symbol(cell, column)
            for i, (cell, column) in enumerate(zip(chain.cells, columns, strict=True))
            if isinstance(cell, Element)
        }

    def pose(
        self, travels: Sequence[float] | Floats, sheets: Sequence[int | None] | None = None
    ) -> Pose:
        """Everything in its place at these travels (N,) [m] on these sheets (N,) of the curves.

        By default an element is on the first sheet that has its travel.
        """
        reach, half = self.reach, self.half_block
        inner = np.zeros(2)
        left, side = -reach, 1.0
        blocks: list[list[float]] = []
        levers: list[Floats] = []
        bands: list[Floats] = []
        posts: list[Floats] = []
        tension: list[float] = []
        slack: list[bool] = []
        boxes: list[list[float]] = []
        rods: list[Floats] = []
        dots: list[Floats] = []
        for i, cell in enumerate(self.chain.cells):
            right, y = inner[0] + reach, inner[1]
            blocks.append([left, y - half, right, y + half])
            if isinstance(cell, Element):
                symbol, travel = self.symbols[i], float(travels[i])
                begin = right + self.rod
                end = begin + self.box
                left = end + self.rod + self.unit * (travel - symbol.low)
                boxes.append([begin, y - self.box / 2, end, y + self.box / 2])
                rods += [np.array([(a, y), (b, y)]) for a, b in ((right, begin), (end, left))]
                on = symbol.at(travel, None if sheets is None else sheets[i])
                dots.append(_xy(begin, y - self.box / 2) + self.box * on)
                outer = _xy(left + reach, y)
            else:
                theta = float(cell.angle(travels[i]))
                along, across = math.sin(theta), side * math.cos(theta)
                outer = inner + _xy(cell.lever * along, cell.lever * across)
                for along in (-self.half_pair, self.half_pair):
                    levers.append(np.array([inner, outer]) + _xy(along, 0.0))
                for band in cell.bands:
                    ends = np.array(
                        [
                            inner + _xy(band.p[1], side * band.p[0]),
                            outer + _xy(band.q[1], side * band.q[0]),
                        ]
                    )
                    length = float(band.length(theta, cell.lever))
                    bands.append(ends)
                    posts += [np.array([inner, ends[0]]), np.array([outer, ends[1]])]
                    tension.append(float(band.tension(length)))
                    slack.append(length <= band.rest_length and not band.two_sided)
                left, side = outer[0] - reach, -side
            span = self.spans[i] if i < len(self.spans) else 0.0
            inner = outer + _xy(span, 0.0)
        blocks.append([left, inner[1] - half, inner[0] + reach, inner[1] + half])
        return Pose(
            np.array(blocks),
            np.array(levers).reshape(-1, 2, 2),
            np.array(bands).reshape(-1, 2, 2),
            np.array(posts).reshape(-1, 2, 2),
            np.array(tension),
            np.array(slack, bool),
            np.array(boxes).reshape(-1, 4),
            np.array(rods).reshape(-1, 2, 2),
            np.array(dots).reshape(-1, 2),
        )

    def bounds(
        self, states: Iterable[Sequence[float] | Floats], room: float = 0.0
    ) -> tuple[float, float, float, float]:
        """left, bottom, right, top [m] of the chain at all these travels (N,), with room around."""
        points = np.concatenate([self.pose(travels).points for travels in states])
        low, high = points.min(axis=0) - room, points.max(axis=0) + room
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])

    def greatest_tension(self) -> float:
        """The largest tension or thrust [N] any band has between the stops."""
        found = 0.0
        for cell in self.chain.cells:
            if isinstance(cell, Element):
                continue
            theta = np.linspace(-cell.limit, cell.limit, 65)
            for band in cell.bands:
                tension = band.tension(band.length(theta, cell.lever))
                found = max(found, float(np.max(np.abs(tension))))
        return found


def _xy(x: float, y: float) -> Floats:
    return np.array([x, y])
