"""Boundary curves in a plane of two parameters: traced, bisected and cut."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from itertools import groupby
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepwell.base import Advised, Bools, ByValue, Floats, Ints


@dataclass(frozen=True, eq=False)
class Box(ByValue):
    """A rectangle in the plane of an anchor [m]."""

    left: float
    right: float
    bottom: float
    top: float

    def grid(self, nodes: int) -> Floats:
        """(nodes, nodes, 2) places, rows upward, columns to the right."""
        x = np.linspace(self.left, self.right, nodes)
        y = np.linspace(self.bottom, self.top, nodes)
        return np.stack(np.meshgrid(x, y), axis=-1)

    def holds(self, q: Floats) -> Bools:
        """Which of the (m, 2) places lie inside."""
        x, y = q[:, 0], q[:, 1]
        return (x >= self.left) & (x <= self.right) & (y >= self.bottom) & (y <= self.top)


# Part of the axes at which a search stops.
RESOLVED = 1e-8


class BoundaryKind(Enum):
    """Kind of change across a boundary of a map."""

    LOADING_ORDER = "the cells load in the other order on the other side"
    UNLOADING_ORDER = "the cells unload in the other order on the other side"
    PATHWAY = "the chain passes other states on the other side"
    BISTABLE = "a cell has two stable states on one side and one on the other"


class Method(Advised):
    """Method with which a boundary, or the nearest change of a chain, was computed."""

    EXACT = (
        "exact",
        "in closed form, to rounding, and proved: no nearer change and no other boundary exists",
    )
    SEARCH = (
        "search",
        "evaluated by the engine point by point, then bisected: changes between two points are "
        "missed. If `resolution` or `error` is too coarse, use a smaller reach or a finer search",
    )


@dataclass(frozen=True, eq=False)
class Boundary(ByValue):
    """A curve in the plane of two parameters, across which the behaviour changes.

    Attributes:
        kind, changes: the kind of change, and the change in words.
        points: (m, 2) along the curve, each column in the SI unit of its parameter.
        method: exact (the closed form's own curve, where two F0 or two F1 are equal or a stop
            is left) or a search (bisection along the edges of a grid).
        error: largest distance of a point from the curve, as a fraction of the axes.
        parameters, units: of both axes.
        sequences: the sequence on either side, or words if there is none.
    """

    kind: BoundaryKind
    points: Floats
    changes: str
    method: Method
    error: float
    parameters: tuple[str, str]
    units: tuple[str, str]
    sequences: tuple[str, str]

    def __repr__(self):
        return (
            f"Boundary({self.changes}; {len(self.points)} points, {self.method}, within "
            f"{self.error:.1g} of the axes)"
        )


Nodes = tuple[Ints, Ints]  # rows and columns, (m,) each


def trace(
    label: Ints, centre: Callable[[int, int], int], ignore: int | None = None
) -> list[tuple[Nodes, Nodes]]:
    """Both ends of the grid edges that curves between unlike nodes of label (ny, nx) cross.

    There is one curve for every pair of labels that meet along it; a closed one repeats its start.
    `centre` gives the label in the middle of the square whose lower corner is a node. It is used
    only if two curves enter it and could be joined both ways. Around `ignore` no curve is traced.
    Where three labels meet, curves end within that square.
    """
    columns = label.shape[1]
    across = _unlike(label[:, :-1], label[:, 1:], ignore)  # edge (row, column)-(row, column + 1)
    upward = _unlike(label[:-1], label[1:], ignore)  # edge (row, column)-(row + 1, column)
    # Edges by number: first all that go across, then all that go up.
    shift = across.size
    crossed = np.flatnonzero(np.concatenate([across.ravel(), upward.ravel()])).tolist()
    links: dict[int, list[int]] = {edge: [] for edge in crossed}
    r, c = np.nonzero(across[:-1] | across[1:] | upward[:, :-1] | upward[:, 1:])
    bottom, left = r * (columns - 1) + c, shift + r * columns + c
    edges = np.stack([bottom, left + 1, bottom + columns - 1, left], axis=1)
    corners = np.stack([label[r, c], label[r, c + 1], label[r + 1, c + 1], label[r + 1, c]], axis=1)
    codes = _codes(corners, np.roll(corners, -1, axis=1), ignore)
    squares = zip(edges.tolist(), codes.tolist(), r.tolist(), c.tolist(), strict=True)
    for around, code, row, column in squares:
        if code[0] and len(set(code)) == 1:
            # From the bottom to the right, or to the left.
            k = 1 if centre(row, column) == label[row, column] else -1
            joined = [(around[0], around[k]), (around[2], around[2 + k])]
        else:
            joined = [
                tuple(edge for edge, own in zip(around, code, strict=True) if own == one)
                for one in dict.fromkeys(code)
                if one and code.count(one) == 2
            ]
        for a, b in joined:
            links[a].append(b)
            links[b].append(a)

    lines: list[tuple[Nodes, Nodes]] = []
    for chain in _chains(links):
        edge = np.array(chain)
        goes_up = edge >= shift
        row, column = np.divmod(edge - shift * goes_up, np.where(goes_up, columns, columns - 1))
        lines.append(((row, column), (row + goes_up, column + ~goes_up)))
    return lines


def _unlike(a: Ints, b: Ints, ignore: int | None) -> Bools:
    unlike = a != b
    return unlike if ignore is None else unlike & (a != ignore) & (b != ignore)


def _codes(a: Ints, b: Ints, ignore: int | None) -> Ints:
    """A positive number for every pair of unlike labels, in either order; 0 for others."""
    low, high = np.minimum(a, b), np.maximum(a, b)
    least, most = np.min(low, initial=0), np.max(high, initial=0)
    code = 1 + (low - least) * (most - least + 1) + high - least
    return np.where(_unlike(a, b, ignore), code, 0)


def _chains(links: dict[int, list[int]]) -> list[list[int]]:
    # Open curves first, from an end; the remaining ones are closed.
    chains: list[list[int]] = []
    seen: set[int] = set()
    starts = sorted(e for e in links if len(links[e]) < 2) + sorted(links)
    for start in starts:
        if start in seen:
            continue
        chain: list[int] = []
        following = start
        while following is not None:
            chain.append(following)
            seen.add(following)
            following = next((e for e in links[following] if e not in seen), None)
        if len(chain) > 2 and len(links[start]) == 2:
            chain.append(start)
        chains.append(chain)
    return chains


Labels = NDArray[Any]


def narrowed(
    ask: Callable[[Floats], Labels], a: Floats, b: Floats, at_a: Labels, at_b: Labels, steps: int
) -> tuple[Floats, Floats, Labels]:
    """Both ends, (m, k), of m ways halved between unlike places, and the second one's label."""
    for _ in range(steps if len(a) else 0):
        middle = (a + b) / 2
        label = ask(middle)
        stays = label == at_a
        a, b = np.where(stays[:, None], middle, a), np.where(stays[:, None], b, middle)
        at_b = np.where(stays, at_b, label)
    return a, b, at_b


def smoothed(points: Floats, project: Callable[[Floats], Floats], sagitta: float) -> Floats:
    """The polyline with points added on the curve until no chord deviates by over `sagitta`."""
    for _ in range(12 if len(points) > 1 else 0):
        chord = (points[:-1] + points[1:]) / 2
        middle = project(chord)
        off = np.linalg.norm(middle - chord, axis=1)
        # A distant projection lies on another strand of the curve; the chord is kept then.
        bent = (off > sagitta) & (off < np.linalg.norm(points[1:] - points[:-1], axis=1))
        if not np.any(bent):
            break
        points = np.insert(points, np.flatnonzero(bent) + 1, middle[bent], axis=0)
    return points


def parted(
    points: Floats, ask: Callable[[Floats], Ints], project: Callable[[Floats], Floats], steps: int
) -> list[tuple[int, Floats]]:
    """The pieces of a polyline with one label each, cut where the label changes.

    `ask` labels the curve's points near (n, 2) points.
    """
    label = ask(points)
    turns = np.flatnonzero(label[1:] != label[:-1])
    # From both sides: a third label may lie between.
    near, far = np.append(turns, turns + 1), np.append(turns + 1, turns)
    ends, _, _ = narrowed(ask, points[near], points[far], label[near], label[far], steps)
    before, after = np.split(project(ends), 2)
    bounds = [0, *(turns + 1).tolist(), len(points)]
    pieces: list[tuple[int, Floats]] = []
    for k in range(len(bounds) - 1):
        first, last = after[k - 1 : k] if k else after[:0], before[k : k + 1]
        piece = np.concatenate([first, points[bounds[k] : bounds[k + 1]], last])
        pieces.append((int(label[bounds[k]]), piece))
    return pieces


_STEP = 1e-6  # of the square, between which slopes are taken
_LAST_STEP = 1e-7  # of the square, after which Newton's method has converged
_SETTLED = 1e-13  # of an edge, tolerance of its crossing
_MOST_STEPS = 100
_AROUND = _STEP * np.array([(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)])


@dataclass(frozen=True)
class LevelCurve:
    """The curve along which `function`, of (m, 2) places in the unit square, is zero."""

    function: Callable[[Floats], Floats]

    def look(self, t: Floats) -> tuple[Floats, Floats]:
        """The function (m,) and its gradient (m, 2), by central differences."""
        # All in one call, since each call of the function is costly.
        around = self.function((t + _AROUND[:, None]).reshape(-1, 2)).reshape(5, -1)
        slope = np.stack([around[1] - around[2], around[3] - around[4]], axis=1) / (2 * _STEP)
        return around[0], slope

    def project(self, t: Floats) -> Floats:
        """The (m, 2) points moved onto the curve by Newton's method along the gradient."""
        return self.projected(t)[0]

    def projected(self, t: Floats) -> tuple[Floats, Floats]:
        """The same, and the gradients (m, 2) within the last step of them."""
        slope = t
        for _ in range(20):
            value, slope = self.look(t)
            step = (value / np.sum(slope**2, axis=1))[:, None] * slope
            t = t - step
            # The remaining error is of the order of the step's square.
            if np.max(np.abs(step), initial=0.0) <= _LAST_STEP:
                break
        return t, slope

    def distance(self, t: Floats) -> Floats:
        """Distance of (m, 2) places from the curve, to first order; (m,)."""
        value, slope = self.look(t)
        return np.abs(value) / np.linalg.norm(slope, axis=1)


def curves(level: LevelCurve, grid: Floats, values: Floats) -> list[Floats]:
    """The curve as polylines (m, 2), from rim to rim of a grid or closed.

    The grid, (ny, nx, 2), must be so fine that no two strands share one of its edges.
    """

    def centre(row: int, column: int) -> int:
        middle = (grid[row, column] + grid[row + 1, column + 1])[None] / 2
        return int(level.function(middle)[0] > 0)

    return [
        _crossings(level, grid[low], grid[high], values[low], values[high])
        for low, high in trace((values > 0).astype(np.int64), centre)
    ]


def _crossings(level: LevelCurve, a: Floats, b: Floats, at_a: Floats, at_b: Floats) -> Floats:
    """Where (m,) edges from a to b, (m, 2) each, cross the level, between values of unlike sign.

    By false position after the Illinois rule (Dowell and Jarratt 1971): it cannot leave the edge,
    so the ends of a curve lie on the rim of the grid exactly.
    """
    low, high = np.zeros(len(a)), np.ones(len(a))
    side, at = np.zeros(len(a)), np.full(len(a), np.inf)
    for _ in range(_MOST_STEPS):
        before = at
        with np.errstate(invalid="ignore"):
            at = low + (high - low) * at_a / (at_a - at_b)
        # Next to an undefined value, halfway.
        at = np.where(np.isfinite(at), at, (low + high) / 2)
        if np.max(np.abs(at - before), initial=0.0) <= _SETTLED:
            break
        value = level.function(a + at[:, None] * (b - a))
        as_a = (value > 0) == (at_a > 0)
        # If the same end moves twice, the other's value counts half.
        at_b = np.where(as_a, np.where(side > 0, at_b / 2, at_b), value)
        at_a = np.where(as_a, value, np.where(side < 0, at_a / 2, at_a))
        low, high = np.where(as_a, at, low), np.where(as_a, high, at)
        side = np.where(as_a, 1.0, -1.0)
    return a + at[:, None] * (b - a)


def searched(
    ask: Callable[[Floats], Ints],
    grid: Floats,
    label: Ints,
    *,
    ignore: int,
    wanted: Bools | None = None,
    known: Callable[[Floats], Bools] | None = None,
) -> list[tuple[tuple[int, int], Floats]]:
    """Curves between unlike nodes, each point narrowed to `RESOLVED` on an edge of the grid.

    Only where an end of the edge is `wanted`, not around `ignore`, without points that are `known`.
    """

    def centre(row: int, column: int) -> int:
        return int(ask((grid[row, column] + grid[row + 1, column + 1])[None] / 2)[0])

    edge = float(np.max(grid[-1, -1] - grid[0, 0])) / (min(grid.shape[:2]) - 1)
    steps = math.ceil(math.log2(edge / RESOLVED))
    curves: list[tuple[tuple[int, int], Floats]] = []
    for low, high in trace(label, centre, ignore):
        near = np.ones(len(low[0]), np.bool_) if wanted is None else wanted[low] | wanted[high]
        for run in _runs(near):
            start, end = ((rows[run], columns[run]) for rows, columns in (low, high))
            at_a = label[start]
            a, b, at_b = narrowed(ask, grid[start], grid[end], at_a, label[end], steps)
            points = (a + b) / 2
            # Bisection may have reached another label.
            pairs = np.sort(np.stack([at_a, at_b], axis=-1), axis=1)
            new = np.ones(len(points), np.bool_) if known is None else ~known(points)
            for part in _runs(new):
                curves += _alike(pairs[part], points[part], ignore)
    return curves


def _alike(pairs: Ints, points: Floats, ignore: int) -> list[tuple[tuple[int, int], Floats]]:
    pieces: list[tuple[tuple[int, int], Floats]] = []
    for (a, b), run in groupby(range(len(points)), lambda i: tuple(pairs[i].tolist())):
        piece = points[list(run)]
        if len(piece) > 1 and ignore not in (a, b):
            pieces.append(((a, b), piece))
    return pieces


def _runs(flags: Bools) -> list[slice]:
    # Each run takes one more point at either end, so that it meets the neighbouring curve.
    turns = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(int), [0]]))).tolist()
    return [slice(max(a - 1, 0), b + 1) for a, b in zip(turns[::2], turns[1::2], strict=True)]
