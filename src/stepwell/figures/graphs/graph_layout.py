"""Where the states of a transition graph stand on the page, and how the ways run between them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product

import numpy as np

from stepwell.base import Floats
from stepwell.figures.common import COLUMN, PAGE, page_width
from stepwell.figures.graphs.columns import heights
from stepwell.figures.graphs.graph_reading import FoldedGraph, FoldedTransition

# Up to this many cells there is room for the names of half-way states.
NAMED = 3
# Half of the diameter of one without a name [mm].
DOT = 0.75
# A character and a line of 7 pt [mm].
_CHARACTER, _LINE = 1.58, 2.6
# Between the way up and the way down beside it [mm].
_APART = 1.0
_EDGE = 3.0
# How much of the distance of two columns a box may take.
_SHARE = 0.6
_SAMPLES = 41
# How far a way goes that comes round [mm].
_ROUND = 7.0
# How far a way past a whole column may be bent aside [mm].
_BOWS = (0.0, 8.0, -8.0, 16.0, -16.0, 24.0, -24.0)


class Layout:
    """Nodes in columns by the sum of their digits, in mm from the lower left corner.

    Args:
        reduced: what is to be seen of a graph.
        cells: how many its chain has.
        size: width and height [mm] of a sheet on which states stand where those of every graph
            of as many cells of two phases do; else few ways cross on a sheet of its own size.

    Attributes:
        width, height: of the sheet.
        at: (x, y) of the middle of every shown node.
        named: whether half-way states have their names.
    """

    def __init__(self, reduced: FoldedGraph, cells: int, size: tuple[float, float] | None = None):
        wide, high = size or (page_width(COLUMN if cells <= NAMED else PAGE), None)
        self.width, self.named = wide, size is None and cells <= NAMED
        self._cells, last = cells, reduced.last
        self._lines = self._count_lines(last)
        shown, self._column = reduced.shown, reduced.levels
        column = self._column
        # All but those between two columns need a place of their own.
        whole = [label for label in shown if column[label] % 1 == 0]
        if size is not None:
            whole = ["".join(digits) for digits in product("01", repeat=cells)]
            column = {label: label.count("1") for label in whole} | dict(column)
        # A smooth way is better short than a snap.
        joined = [(way.source, way.target, 1.0 if way.snaps else 2.0) for way in reduced.ways]
        y = heights(column, whole, joined, stay=size is not None)
        most = max(list(column.values()).count(k) for k in range(last + 1))
        tallest = max(2 * self.half(label)[1] for label in shown)
        pitch = max(tallest + 2.0, float(np.clip(130.0 / most, 6.4, 15.0)))
        if high is not None:
            pitch = (high - 2 * _EDGE) / most
        self.height = most * pitch + 2 * _EDGE
        side = max(self.half(label)[0] for label in shown) + _EDGE
        step = (self.width - 2 * side) / max(last, 1)
        self.at = {
            label: (side + step * column[label], _EDGE + most * pitch * y[label]) for label in shown
        }
        for k in range(last):
            self._spread([label for label in shown if column[label] == k + 0.5])

    def _count_lines(self, last: int) -> int:
        """In how many lines a name is written, so that boxes leave room between columns."""
        room = _SHARE * (self.width - 20.0) / max(last, 1)
        return math.ceil(self._cells / max(3, int((room - 1.8) / _CHARACTER)))

    def _spread(self, labels: list[str]) -> None:
        """Move nodes that stand above each other apart."""
        labels.sort(key=lambda label: self.at[label][1])
        gap = 2.4 + 2 * max((self.half(label)[1] for label in labels), default=0.0)
        moved = apart([self.at[label][1] for label in labels], gap)
        self.at |= {v: (self.at[v][0], y) for v, y in zip(labels, moved, strict=True)}

    def name(self, label: str) -> str:
        """The label in as many lines as it takes."""
        each = math.ceil(len(label) / self._lines)
        return "\n".join(label[k : k + each] for k in range(0, len(label), each))

    def half(self, label: str) -> tuple[float, float]:
        """Half of the width and of the height of what stands for a node [mm]."""
        lines = self.name(label).split("\n")
        wide, high = _CHARACTER * len(lines[0]) / 2, _LINE * len(lines) / 2
        if "-" not in label:
            return wide + 0.9, high + 0.7
        return (wide + 0.7, high + 0.2) if self.named else (DOT, DOT)

    def curve(self, way: FoldedTransition) -> Floats:
        """(n, 2) from the side of one node to the side of the next [mm]."""
        (x0, y0), (x1, y1) = self.at[way.source], self.at[way.target]
        shift = way.direction * _APART / 2
        a = np.array([x0 + way.direction * self.half(way.source)[0], y0 + shift])
        ahead = way.direction * (self._column[way.target] - self._column[way.source])
        # To a node of the same column, or of one behind, a way comes round to its far side.
        side = 1 if ahead > 0 else -1
        b = np.array([x1 - side * way.direction * self.half(way.target)[0], y1 + shift])
        far = max(0.45 * abs(b[0] - a[0]), 2.0 if ahead > 0 else _ROUND)
        reach = np.array([far * way.direction, 0.0])
        others = [label for label in self.at if label not in (way.source, way.target)]
        curves = [
            _bezier(a, a + reach + [0.0, bow], b - side * reach + [0.0, bow], b)
            for bow in (_BOWS if ahead > 1 else _BOWS[:1])
        ]
        # The flattest of those that run through the fewest other nodes.
        return min(curves, key=lambda curve: sum(self._meets(curve, v) for v in others))

    def _meets(self, curve: Floats, label: str) -> bool:
        """Whether a curve runs through a node."""
        return bool(np.any(np.all(np.abs(curve - self.at[label]) < self.half(label), axis=1)))


def apart(values: Sequence[float], gap: float) -> list[float]:
    """Rising values moved so that no two are closer than the gap."""
    moved: list[float] = []
    for value in values:
        moved.append(max(value, moved[-1] + gap) if moved else value)
    shift = (sum(moved) - sum(values)) / max(len(moved), 1)
    return [value - shift for value in moved]


def head(curve: Floats, size: float) -> Floats:
    """(3, 2) an arrow head at the end of a curve [mm]."""
    tip = curve[-1]
    far = np.hypot(*(curve - tip).T)
    tail = curve[np.flatnonzero(far >= size)[-1]] if (far >= size).any() else curve[0]
    along = (tip - tail) / max(float(np.hypot(*(tip - tail))), 1e-9)
    across = 0.38 * size * np.array([-along[1], along[0]])
    back = tip - size * along
    return np.array([tip, back + across, back - across])


def _bezier(a: Floats, b: Floats, c: Floats, d: Floats) -> Floats:
    t = np.linspace(0.0, 1.0, _SAMPLES)[:, None]
    return (1 - t) ** 3 * a + 3 * (1 - t) ** 2 * t * b + 3 * (1 - t) * t**2 * c + t**3 * d
