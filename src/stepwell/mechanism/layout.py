"""Layout of a chain in its drawing: the only one, for figures, animations and the studio."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from stepwell.base import Bools, Floats, bisected
from stepwell.mechanism.cell import Cell
from stepwell.mechanism.chain import Chain
from stepwell.mechanism.element import Element
from stepwell.mechanism.levers import Levers
from stepwell.mechanism.phase import Phase

_SAMPLES = 97
# Margin between curve and box, as a fraction of the box.
EDGE = 0.14
# Elements share a force scale if its range is at most this factor times that of each.
_FLAT = 4.0


class Symbol:
    """The force curve of an element in a square of side 1, travel to the right, force upwards.
    Travels [m] that are `reached` past an open end are included. `forces` are the least and the
    largest force of the square [N]; by default those of the curve.
    """

    def __init__(
        self,
        element: Element,
        reached: Sequence[float] | Floats = (),
        forces: tuple[float, float] | None = None,
    ):
        self.element = element
        ends = [element.low, element.high, *(float(s) for s in reached)]
        self.low, high = min(ends), max(ends)
        samples: list[tuple[Floats, Floats]] = []
        for number, sheet in enumerate(element.laws):
            first = self.low if sheet.below is None and sheet.begin == element.low else sheet.begin
            last = high if sheet.above is None and sheet.end == element.high else sheet.end
            travel = np.linspace(first, last, _SAMPLES)
            samples.append((travel, element.force_at(travel, number)))
        # Points past the ends of the curve do not set the scale.
        inside = [f[(s >= element.low) & (s <= element.high)] for s, f in samples]
        own = min(f.min() for f in inside), max(f.max() for f in inside)
        least, most = forces or own
        # Lower left corner of the curve and its size, as travel and force.
        self.origin = np.array([self.low, least])
        self.size = np.array([high - self.low, (most - least) or 1.0])
        self.curves = [self._inside(np.column_stack(curve)) for curve in samples]
        zero = float(self._inside(np.array([self.low, 0.0]))[1])
        # Height of zero force; NaN outside the square.
        self.zero = zero if 0.0 < zero < 1.0 else math.nan

    def at(self, travel: float, sheet: int | None = None) -> Floats:
        """(2,) position of the element: on this sheet, else on the first with this travel."""
        laws, within = self.element.laws, min(max(travel, self.element.low), self.element.high)
        holds = [k for k, one in enumerate(laws) if one.begin <= within <= one.end]
        if sheet not in holds:
            sheet = holds[0]
        return self._inside(np.array([travel, float(self.element.force_at(travel, sheet))]))

    def _inside(self, points: Floats) -> Floats:
        share = np.clip((points - self.origin) / self.size, -EDGE, 1.0 + EDGE)
        return EDGE + (1.0 - 2.0 * EDGE) * share


def rest_of(element: Element, phase: Phase) -> float:
    """Travel [m] of an element in a phase at zero, or the smallest possible, force."""
    if phase.force_high < 0.0:
        return phase.high
    if phase.force_low > 0.0:
        return phase.low

    def force(travel: float) -> float:
        return float(element.force_at(travel, phase.sheet))

    low, high = max(phase.low, element.low), min(phase.high, element.high)
    for end, limit, way in ((low, phase.low, -1.0), (high, phase.high, 1.0)):
        if way * force(end) < 0.0:
            if math.isfinite(limit):
                return end
            # Past an open end the curve is extrapolated as a straight line.
            further = way * element.full_travel
            return end - force(end) * further / (force(end + further) - force(end))
    return bisected(lambda travel: force(travel) <= 0.0, low, high, 60)[0]


# Drawn lever and longest travel of chains without levers, which have no size of their own [m].
_LEVER, _TRAVEL = 0.0141, 0.020


@dataclass(frozen=True, slots=True)
class Pose:
    """The parts of a chain at given travels, in metres on the page."""

    blocks: Floats  # (N + 1, 4) left, bottom, right, top of each, fixed one first
    levers: Floats  # (2 N, 2, 2) ends of each
    bands: Floats  # (B, 2, 2) ends of each, p then q, cell by cell
    posts: Floats  # (2 B, 2, 2) from a block's joint midpoint to an anchor on that block
    tension: Floats  # (B,) of each band [N]
    slack: Bools  # (B,) whether the band is
    boxes: Floats  # (E, 4) left, bottom, right, top of each element's symbol
    rods: Floats  # (2 E, 2, 2) from the blocks to the symbols
    dots: Floats  # (E, 2) where each element stands on the curve in its symbol

    @property
    def points(self) -> Floats:
        """(n, 2) corners of blocks and symbols, ends of bands and levers [m]."""
        parts = (self.blocks, self.bands, self.levers, self.boxes)
        return np.concatenate([part.reshape(-1, 2) for part in parts])


_SHAPES: dict[str, tuple[int, ...]] = {
    "blocks": (-1, 4),
    "boxes": (-1, 4),
    "dots": (-1, 2),
    **dict.fromkeys(("levers", "bands", "posts", "rods"), (-1, 2, 2)),
}


class ChainLayout:
    """Places a chain in its drawing: stroke to the right, fixed block at the left.

    Every second cell is mirrored across the stroke, which changes no band length and keeps a chain
    as slender as one cell. The length of the middle blocks is free in the model; here each clears
    its neighbours in every state. An element is a box on the rod between two blocks, to scale in
    its travel. Without levers the longest travel is drawn 20 mm long. `reached` are (n, N) travels
    [m] to be drawn, for elements that move past an open end.
    """

    def __init__(self, chain: Chain, reached: Sequence[Sequence[float] | Floats] = ()):
        self.chain = chain
        cells = [cell for cell in chain.cells if isinstance(cell, Cell)]
        lever = max((cell.lever for cell in cells), default=_LEVER)
        # Drawn metres by one of travel.
        self.unit = 1.0 if cells else _TRAVEL / max(chain.full_travels)
        # Half the distance of the two levers, and the reach of a block beyond its joint midpoint.
        self.half_pair = 0.30 * lever
        self.reach = 0.52 * lever
        self.half_block = 0.26 * min([lever, *(c.lever * math.cos(c.limit) * 1.4 for c in cells)])
        room = 2 * self.reach + 0.25 * lever
        levers = np.array([isinstance(cell, Cell) for cell in chain.cells])
        halves = np.where(levers, chain.full_travels, 0.0) / 2
        # Length of the block after each cell, between its joint midpoints; beside an element it
        # needs no room.
        spans = halves[:-1] + halves[1:] + room * (levers[:-1] & levers[1:])
        self.spans = [*spans.tolist(), 0.0]
        # Direction of x of each cell's anchors across the stroke: 1 up, -1 down.
        self.sides = np.where((levers.cumsum() - levers) % 2, -1.0, 1.0)
        bands = [len(cell.bands) if isinstance(cell, Cell) else 0 for cell in chain.cells]
        self.owner = np.repeat(range(len(chain)), bands)
        # The side of a symbol, and the shortest rods at it.
        self.box, self.rod = 1.5 * lever, 0.3 * lever
        self.symbols = self._symbols(reached)

    def _symbols(self, reached: Sequence[Sequence[float] | Floats]) -> dict[int, Symbol]:
        """The symbol of each element, by its cell.

        Cells in series carry one force: a common scale, unless a curve would be flat on it.
        """
        elements = [
            (i, cell) for i, cell in enumerate(self.chain.cells) if isinstance(cell, Element)
        ]
        if not elements:
            return {}
        travels = {i: [row[i] for row in reached] for i, _ in elements}
        symbols = {i: Symbol(element, travels[i]) for i, element in elements}
        scales = [(float(one.origin[1]), float(one.size[1])) for one in symbols.values()]
        low, high = min(least for least, _ in scales), max(least + size for least, size in scales)
        if high - low > _FLAT * min(size for _, size in scales):
            return symbols
        return {i: Symbol(element, travels[i], (low, high)) for i, element in elements}

    def pose(
        self, travels: Sequence[float] | Floats, sheets: Sequence[int | None] | None = None
    ) -> Pose:
        """Positions of all parts at these travels (N,) [m] on these sheets (N,) of the curves, by
        default the first sheets with these travels.
        """
        reach, half = self.reach, self.half_block
        inner, pair = np.zeros(2), np.array([self.half_pair, 0.0])
        left = -reach
        of: dict[str, list[Any]] = {name: [] for name in _SHAPES}
        for i, cell in enumerate(self.chain.cells):
            right, y, side = inner[0] + reach, inner[1], self.sides[i]
            of["blocks"].append([left, y - half, right, y + half])
            if isinstance(cell, Element):
                symbol, travel = self.symbols[i], float(travels[i])
                begin = right + self.rod
                end = begin + self.box
                left = end + self.rod + self.unit * (travel - symbol.low)
                of["boxes"].append([begin, y - self.box / 2, end, y + self.box / 2])
                of["rods"] += [[(right, y), (begin, y)], [(end, y), (left, y)]]
                on = symbol.at(travel, None if sheets is None else sheets[i])
                of["dots"].append(self.box * on + (begin, y - self.box / 2))
                outer = np.array([left + reach, y])
            else:
                theta = float(cell.angle(travels[i]))
                # Along the stroke is y of the cell, across it x.
                outer = inner + cell.lever * np.array([math.sin(theta), side * math.cos(theta)])
                ends = np.array([inner, outer])
                of["levers"] += [ends - pair, ends + pair]
                for band in cell.bands:
                    turned = np.array([band.p, band.q])[:, ::-1] * (1.0, side)
                    of["bands"].append(ends + turned)
                    of["posts"] += [
                        (joint, joint + off) for joint, off in zip(ends, turned, strict=True)
                    ]
                left = outer[0] - reach
            inner = outer + np.array([self.spans[i], 0.0])
        of["blocks"].append([left, inner[1] - half, inner[0] + reach, inner[1] + half])
        parts = {name: np.array(of[name], float).reshape(_SHAPES[name]) for name in _SHAPES}
        (tension,), (slack,) = self.tensions(np.array([travels], float))
        return Pose(**parts, tension=tension, slack=slack)

    def bounds(
        self, states: Iterable[Sequence[float] | Floats], room: float = 0.0
    ) -> tuple[float, float, float, float]:
        """left, bottom, right, top [m] of the chain at all these travels (N,), with a margin."""
        points = np.concatenate([self.pose(travels).points for travels in states])
        low, high = points.min(axis=0) - room, points.max(axis=0) + room
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])

    @property
    def wall(self) -> Floats:
        """(5, 2, 2) lines [m] of the wall that holds the fixed block, hatching last."""
        half = 1.2 * self.half_block
        x, y = -self.reach, np.linspace(-half, half, 6)
        depth = half / 2
        hatching = [[(x - depth, at - depth / 2), (x, at + depth / 2)] for at in y[1:-1]]
        return np.array([[(x, y[0]), (x, y[-1])], *hatching])

    def tensions(self, travel: Floats) -> tuple[Floats, Bools]:
        """Tension [N] of every band, and whether it is slack, (n, B), at travels (n, N) [m]."""
        levers = Levers(self.chain.cells, travel)
        return levers.tension(), levers.slack

    def greatest_tension(self) -> float:
        """The largest tension or compression [N] of any band between the stops."""
        return max(map(greatest_tension, self.chain.cells))


def greatest_tension(cell: Cell | Element) -> float:
    """The largest tension or compression [N] of the bands of a cell between the stops, or 0."""
    if not isinstance(cell, Cell):
        return 0.0
    theta = np.linspace(-cell.limit, cell.limit, 65)
    tensions = [band.tension(band.length(theta, cell.lever)) for band in cell.bands]
    return float(np.max(np.abs(tensions)))


def corners(boxes: Floats) -> Floats:
    """(n, 4, 2) of (n, 4) left, bottom, right, top."""
    return boxes[:, [0, 1, 2, 1, 2, 3, 0, 3]].reshape(-1, 4, 2)
