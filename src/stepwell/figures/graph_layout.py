"""Reduction of a transition graph for a figure, and layout of its states."""

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from itertools import accumulate, combinations, pairwise, product
from typing import NamedTuple

import numpy as np
from matplotlib.bezier import BezierSegment

from stepwell.base import Bools, Floats, InputError, grouped
from stepwell.figures.common import style
from stepwell.figures.common.sheet import Point, page_width
from stepwell.sequences import Program, TransitionGraph, TransitionKind

_SWEEPS = 12
# Weight of the length of lines; a crossing has weight 1.
_LENGTH = 0.02


def heights(
    columns: Mapping[str, float],
    fixed: Sequence[str],
    lines: Sequence[tuple[str, str, float]],
    *,
    stay: bool = False,
) -> dict[str, float]:
    """Height of every node, between 0 and 1; deterministic.

    Nodes that are `fixed` divide the height of their column evenly, in the order that minimises
    crossings, or in the order of their names with `stay`. All others float between the nodes to
    which lines (with weights of their lengths) join them.
    """
    order = grouped((columns[name], name) for name in fixed)
    sheet = _Crossings(columns, fixed, lines)
    if stay:
        best = {column: sorted(names) for column, names in order.items()}
    else:
        best, cost = order, np.inf
        for sweep in range(_SWEEPS):
            now = sheet.cost(order)
            if now < cost:
                best, cost = {column: [*names] for column, names in order.items()}, now
            for column in sorted(order, reverse=bool(sweep % 2)):
                means = sheet.named(sheet.share @ sheet.heights(order))
                order[column].sort(key=means.__getitem__)
        # Exchange two nodes of a column as long as that helps.
        before = np.inf
        while cost < before:
            before = cost
            for names in best.values():
                for i, j in combinations(range(len(names)), 2):
                    names[i], names[j] = names[j], names[i]
                    now = sheet.cost(best)
                    if now < cost - 1e-9:
                        cost = now
                    else:
                        names[i], names[j] = names[j], names[i]
    return sheet.named(sheet.heights(best))


class _Crossings:
    """Nodes as arrays, so that the cost of an order is fast to compute."""

    def __init__(
        self,
        columns: Mapping[str, float],
        fixed: Sequence[str],
        lines: Sequence[tuple[str, str, float]],
    ):
        self.fixed = list(fixed)
        floating = sorted(set(columns) - set(fixed), key=lambda n: (columns[n], n))
        self.names = self.fixed + floating
        number = {name: k for k, name in enumerate(self.names)}
        self.x = np.array([columns[name] for name in self.names])
        self.ends = np.array([(number[a], number[b]) for a, b, _ in lines]).reshape(-1, 2)
        self.weights = np.array([weight for *_, weight in lines])
        joined = np.zeros((len(self.names),) * 2)
        np.add.at(joined, (self.ends[:, 0], self.ends[:, 1]), self.weights)
        joined += joined.T
        # A floating node joined to another one follows it: solve for all at once.
        n = len(self.fixed)
        share = joined / np.maximum(joined.sum(axis=1), 1e-12)[:, None]
        loose = np.eye(len(self.names) - n) - share[n:, n:]
        self.follow = np.linalg.lstsq(loose, share[n:, :n], rcond=None)[0]
        self.share = share
        first, second = np.triu_indices(len(self.ends), 1)
        a, b = self.ends[first], self.ends[second]
        apart = (a[:, :, None] != b[:, None, :]).all(axis=(1, 2))
        low_a, high_a = np.sort(self.x[a], axis=1).T
        low_b, high_b = np.sort(self.x[b], axis=1).T
        # Only lines that share a stretch of the page can cross.
        near = apart & (np.minimum(high_a, high_b) > np.maximum(low_a, low_b))
        self.pairs = a[near], b[near]

    def heights(self, order: Mapping[float, Sequence[str]]) -> Floats:
        """Heights of all nodes, with the fixed nodes in this order in their columns."""
        slots = {n: (k + 0.5) / len(names) for names in order.values() for k, n in enumerate(names)}
        own = np.array([slots[name] for name in self.fixed])
        return np.concatenate([own, self.follow @ own])

    def cost(self, order: Mapping[float, Sequence[str]]) -> float:
        """Number of crossings of straight lines, plus a small term for their length."""
        xy = np.column_stack([self.x, self.heights(order)])
        (p, q), (r, s) = ((xy[ends[:, 0]], xy[ends[:, 1]]) for ends in self.pairs)
        crossing = (_side(p, q, r) != _side(p, q, s)) & (_side(r, s, p) != _side(r, s, q))
        rise = np.abs(np.diff(xy[self.ends, 1], axis=1)[:, 0])
        return float(np.count_nonzero(crossing) + _LENGTH * (self.weights @ rise))

    def named(self, values: Floats) -> dict[str, float]:
        return dict(zip(self.names, values.tolist(), strict=True))


def _side(p: Floats, q: Floats, r: Floats) -> Bools:
    """Whether r lies left of the line from p to q."""
    (ux, uy), (vx, vy) = (q - p).T, (r - p).T
    return ux * vy > uy * vx


# Drives closer than this fraction of their range are equal.
_SLIP = 1e-9


class FoldedTransition(NamedTuple):
    """Transition between two shown nodes under a rising (+1) or falling (-1) drive, and whether the
    chain snaps in it.
    """

    source: str
    target: str
    direction: int
    snaps: bool


class FoldedGraph(NamedTuple):
    """Vertices, half-way nodes with a choice of direction, and the transitions between them."""

    shown: tuple[str, ...]
    ways: tuple[FoldedTransition, ...]
    # Least number of switches from all cells at 0; a cell half-way counts half.
    levels: Mapping[str, float]
    # Level of the state with all cells in their last phases.
    last: int


def folded(graph: TransitionGraph, keep: Iterable[str] = ()) -> FoldedGraph:
    """Merge half-way nodes without a choice, except those to `keep`, into their transitions.

    A half-way node offers a choice if a reversal after a snap leads to a vertex other than the
    source.
    """
    keep = set(keep)
    landings = set(graph.nodes.labels(np.unique(graph.target[graph.snaps])))
    shown = [label for label in graph if "-" not in label or label in landings | keep]
    ways = _ways(graph, shown)
    shown = [v for v in shown if "-" not in v or v in keep or _offers_a_choice(v, ways)]
    levels = {label: _level(graph, label) for label in shown}
    last = graph.cells if graph.chain is None else sum(map(int, graph.chain.last_state))
    last = max([last, *(math.ceil(level) for level in levels.values())])
    return FoldedGraph(tuple(shown), tuple(_ways(graph, shown)), levels, last)


def _level(graph: TransitionGraph, label: str) -> float:
    """Sum of the digits of a state; a cell half-way between two phases counts half."""
    node, state = graph.node(label), label.partition("#")[0]
    total = float(sum(int(digit) for digit in state if digit != "-"))
    for i in (i for i, digit in enumerate(state) if digit == "-"):
        total += 0.5
        if graph.chain is not None:
            travel = (node.travel_low[i] + node.travel_high[i]) / 2
            total += sum(phase.high < travel for phase in graph.chain.phases[i]) - 1
    return total


def _offers_a_choice(label: str, ways: Sequence[FoldedTransition]) -> bool:
    """Whether a reversal at this node leads to another node than the previous one."""
    out = {way.direction: way.target for way in ways if way.source == label}
    return any(out.get(-way.direction) != way.source for way in ways if way.target == label)


def _ways(graph: TransitionGraph, shown: Sequence[str]) -> list[FoldedTransition]:
    known = set(shown)
    transitions: list[FoldedTransition] = []
    for source, direction in product(shown, (1, -1)):
        label, snaps = source, False
        while step := graph.transition(label, direction):
            label, transition = step
            snaps = snaps or transition.kind is TransitionKind.SNAP
            if label in known:
                transitions.append(FoldedTransition(source, label, direction, snaps))
                break
    return transitions


def followed(graph: TransitionGraph, program: Program) -> list[list[str]]:
    """Labels of the nodes visited on each stroke of a program, both ends included. A stroke that
    reverses after it has smoothly passed a vertex ends at that vertex.
    """
    another = graph.chain is not None and graph.chain != program.chain
    if another or program.start not in graph:
        raise InputError(
            f"program: it runs from {program.start} to {program.target} in another chain, or "
            f"begins in a state that this graph does not have. Draw the graph of its own chain: "
            f"program.chain.graph()."
        )
    points = program.turning_points
    slip = _SLIP * (max(points) - min(points))
    strokes: list[list[str]] = []
    label = program.start
    for before, after in pairwise(points):
        direction = 1 if after > before else -1
        stroke, snapped = [label], [True]
        while step := graph.transition(label, direction):
            left = direction * (after - step[1].drive)
            enters = abs(left) <= slip and "-" in label and "-" not in step[0]
            if left <= slip and not enters:
                break
            label = step[0]
            stroke.append(label)
            snapped.append(step[1].kind is TransitionKind.SNAP)
        while "-" in stroke[-1] and not snapped[-1]:
            stroke.pop()
            snapped.pop()
        strokes.append(stroke)
        label = stroke[-1]
    return strokes


# Largest number of cells with room for the names of half-way states.
NAMED = 3
# Radius of a half-way state without a name [mm].
DOT = 0.75
# A character and a line of 7 pt [mm].
_CHARACTER, _LINE = 1.58, 2.6
# Distance of the loading and the unloading transition between two nodes [mm].
_APART = 1.0
_EDGE = 3.0
# Largest width of a box, as a fraction of the distance of two columns.
_SHARE = 0.6
_SAMPLES = 41
# Extent of a transition that returns round a node [mm].
_ROUND = 7.0
# Offsets by which a transition past a whole column may be bent [mm].
_BOWS = (0.0, 8.0, -8.0, 16.0, -16.0, 24.0, -24.0)


class GraphLayout:
    """Nodes in columns by the sum of their digits, in mm from the lower left corner.

    On a sheet of a given size [mm], all graphs with this number of two-phase cells have the same
    state positions. Otherwise the layout minimises crossings on a sheet of its own size. Half-way
    states may be `named`.
    """

    def __init__(self, reduced: FoldedGraph, cells: int, size: Point | None = None):
        wide, high = size or (page_width(style.COLUMN if cells <= NAMED else style.PAGE), None)
        self.width, self.named, last = wide, size is None and cells <= NAMED, reduced.last
        # Lines per name, so that boxes leave room between columns.
        room = _SHARE * (wide - 20.0) / max(last, 1)
        self._lines = math.ceil(cells / max(3, int((room - 1.8) / _CHARACTER)))
        shown, self._column = reduced.shown, reduced.levels
        whole, column = _whole_columns(reduced, None if size is None else cells)
        # Smooth transitions have a larger weight of their length than snaps.
        joined = [(way.source, way.target, 1.0 if way.snaps else 2.0) for way in reduced.ways]
        y = heights(column, whole, joined, stay=size is not None)
        most = max(Counter(column.values())[k] for k in range(last + 1))
        tallest = max(2 * self.half(label)[1] for label in shown)
        if high is None:
            pitch = max(tallest + 2.0, float(np.clip(130.0 / most, 6.4, 15.0)))
        else:
            pitch = (high - 2 * _EDGE) / most
        self.height = most * pitch + 2 * _EDGE
        side = max(self.half(label)[0] for label in shown) + _EDGE
        step = (self.width - 2 * side) / max(last, 1)
        self.at = {
            label: (side + step * column[label], _EDGE + most * pitch * y[label]) for label in shown
        }
        for k in range(last):
            self._spread([label for label in shown if column[label] == k + 0.5])

    def _spread(self, labels: list[str]) -> None:
        """Separate nodes with the same x."""
        labels.sort(key=lambda label: self.at[label][1])
        gap = 2.4 + 2 * max((self.half(label)[1] for label in labels), default=0.0)
        heights = [self.at[label][1] for label in labels]
        moved = [*accumulate(heights, lambda last, y: max(y, last + gap))]
        shift = (sum(moved) - sum(heights)) / max(len(moved), 1)
        self.at |= {v: (self.at[v][0], y - shift) for v, y in zip(labels, moved, strict=True)}

    def name(self, label: str) -> str:
        """The label, wrapped to lines."""
        each = math.ceil(len(label) / self._lines)
        return "\n".join(label[k : k + each] for k in range(0, len(label), each))

    def half(self, label: str) -> Point:
        """Half width and half height of a node's symbol [mm]."""
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
        # A transition to the same or a previous column ends at the far side of the node.
        side = 1 if ahead > 0 else -1
        b = np.array([x1 - side * way.direction * self.half(way.target)[0], y1 + shift])
        far = max(0.45 * abs(b[0] - a[0]), 2.0 if ahead > 0 else _ROUND)
        reach, share = np.array([far * way.direction, 0.0]), np.linspace(0.0, 1.0, _SAMPLES)
        curves = [
            BezierSegment([a, a + reach + [0.0, bow], b - side * reach + [0.0, bow], b])(share)
            for bow in (_BOWS if ahead > 1 else _BOWS[:1])
        ]
        others = [label for label in self.at if label not in (way.source, way.target)]
        at = np.array([self.at[label] for label in others]).reshape(-1, 1, 2)
        half = np.array([self.half(label) for label in others]).reshape(-1, 1, 2)
        met = [np.all(np.abs(curve - at) < half, axis=2).any(axis=1).sum() for curve in curves]
        # The flattest of the curves through the fewest other nodes.
        return curves[int(np.argmin(met))]


def _whole_columns(
    reduced: FoldedGraph, cells: int | None
) -> tuple[list[str], Mapping[str, float]]:
    """States with a fixed position, those in whole columns, and the column of every state.

    With a number of cells, all states that these can have.
    """
    if cells is None:
        return [one for one in reduced.shown if reduced.levels[one] % 1 == 0], reduced.levels
    whole = ["".join(digits) for digits in product("01", repeat=cells)]
    return whole, {label: label.count("1") for label in whole} | dict(reduced.levels)


def head(curve: Floats, size: float) -> Floats:
    """(3, 2) corners of an arrow head at the end of a curve [mm]."""
    tip = curve[-1]
    far = np.hypot(*(curve - tip).T)
    tail = curve[np.flatnonzero(far >= size)[-1]] if (far >= size).any() else curve[0]
    along = (tip - tail) / max(float(np.hypot(*(tip - tail))), 1e-9)
    across = 0.38 * size * np.array([-along[1], along[0]])
    back = tip - size * along
    return np.array([tip, back + across, back - across])
