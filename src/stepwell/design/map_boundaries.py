"""Boundaries of a map as curves, with the change across each."""

from collections.abc import Callable, Iterable
from itertools import combinations
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from stepwell.base import Bools, Floats, InputError, Ints, Progress, join_first
from stepwell.concave import Simple, end_forces
from stepwell.design import plane
from stepwell.design.maps import Axis, anchor, axes_of, require_places
from stepwell.design.outcomes import IMPOSSIBLE, UNSOLVED, Outcomes, Stability
from stepwell.mechanism import Chain
from stepwell.sequences import Sequence

# Longest chain whose sequences are written out, and pairs of cells that are named.
_SHORT = 4
_NAMED = 3


def between(a: Sequence, b: Sequence, names: tuple[str, ...]) -> tuple[plane.BoundaryKind, str]:
    """The kind of boundary between two sequences of one chain, and what changes across it.

    Cells whose order is reversed are named; sequences of up to four cells are written out.
    """
    first, second = a.orders, b.orders
    both = f"{a} | {b}" if len(names) <= _SHORT else ""
    if first is None or second is None:
        return plane.BoundaryKind.PATHWAY, both or _parting(a, b)
    loading, unloading = (_swapped(first[k], second[k], names) for k in (0, 1))
    if loading == unloading:
        words = f"{loading} change order while loading and unloading"
    else:
        ways = (("loading", loading), ("unloading", unloading))
        words = ", ".join(f"{who} change order while {way}" for way, who in ways if who)
    kind = plane.BoundaryKind.PATHWAY
    if not (loading and unloading):
        kind = plane.BoundaryKind["LOADING_ORDER" if loading else "UNLOADING_ORDER"]
    return kind, f"{words}: {both}" if both else words


def _swapped(a: tuple[int, ...], b: tuple[int, ...], names: tuple[str, ...]) -> str:
    """Pairs of cells in another order in b, in words; empty if there are none."""
    place = {cell: k for k, cell in enumerate(b)}
    pairs = [(i, j) for i, j in combinations(a, 2) if place[i] > place[j]]
    words = [f"{names[min(i, j)]} and {names[max(i, j)]}" for i, j in pairs]
    return join_first(words, _NAMED, "more pairs")


def _parting(a: Sequence, b: Sequence) -> str:
    """The state after which two sequences differ, and the next state of each."""
    for k, state in enumerate(a.states):
        ahead = [s.states[k + 1] if k + 1 < len(s) else "its end" for s in (a, b)]
        if ahead[0] != ahead[1]:
            return f"from {state} to {ahead[0]} | to {ahead[1]}"
    return "nothing"


K = TypeVar("K")
Place = Callable[[Floats], Floats]

_GRID = 201  # nodes each way between which exact curves are looked for
_SMOOTH = 2e-5  # of the axes: farthest that a chord may be from its curve
_CUTS = 24  # halvings of a chord on which an exact curve ends
_ASIDE = 1e-9  # of the axes: distance from a curve at which its two sides are evaluated
_SHORTEST = 100 * _ASIDE  # shortest piece of a curve that is kept
_SQUARE = plane.Box(0.0, 1.0, 0.0, 1.0)
How = tuple[plane.Method, float]  # and largest distance of a point from its curve [of the axes]
_SEARCHED = plane.Method.SEARCH, plane.RESOLVED


def boundaries(
    chain: Chain,
    cell: int | str = 1,
    *,
    x: ArrayLike,
    y: ArrayLike,
    search: int = 61,
    progress: Progress = None,
) -> tuple[plane.Boundary, ...]:
    """The curves between the regions of a `transition_map`: `parameter_boundaries` of its anchor.

    Args:
        chain: any number of cells.
        cell: the cell of the anchor, 0 for the innermost, or its name.
        x, y: increasing coordinates of its anchor q [m].
        search: nodes each way of the grid for the general engine.
        progress: called with (done, total) while the general engine works.

    Raises:
        ValueError: no such cell, or axes that do not increase.
    """
    return parameter_boundaries(*anchor(chain, cell, x, y), search=search, progress=progress)


def parameter_boundaries(
    chain: Chain, x: Axis, y: Axis, *, search: int = 61, progress: Progress = None
) -> tuple[plane.Boundary, ...]:
    """The curves between the regions of a map over two parameters, then the limits of bistability.

    In the range of the closed form, the sequence changes exactly where two cells' F0 or F1 are
    equal. These curves are cut where they meet each other and at the limit of the proof. Elsewhere
    the general engine is evaluated on a coarser grid, and every change between two neighbouring
    nodes is bisected to 1e-9 of the axes. Such curves end up to one grid step before a point where
    three regions meet, and features finer than the grid are missed. The limits of bistability of
    cells with varied parameters are treated alike: exact for one linear band without a load.

    Args:
        chain: any number of cells.
        x, y: name and two or more increasing values of a parameter. The grid keeps their spacing:
            np.geomspace makes it logarithmic.
        search: nodes of that coarser grid each way.
        progress: called with (done, total) while the general engine works.

    Raises:
        ValueError: no such parameter, values that do not increase or are not allowed, or fewer
            than 2 nodes.

    Source: Kamp et al. 2024, Fig. 2C and Eq. 3; curves: theory page, "Two cells".
    """
    (first, xs), (second, ys) = axes_of(chain, x, y, 2)
    if search < 2:
        raise InputError(f"search = {search}: must be 2 or more nodes each way.")
    require_places(search, search)
    outcomes = Outcomes(chain, (first, second), np.array([np.ptp(xs), np.ptp(ys)]))
    names, units = (first.name, second.name), (first.unit, second.unit)

    axes = _extended(xs), _extended(ys)

    def place(t: Floats) -> Floats:
        # From the unit square to the parameters, with the spacing of the user's values.
        values = np.empty_like(t)
        for k in range(2):
            values[:, k] = np.interp(t[:, k], *axes[k])
        return values

    curves: list[plane.Boundary] = []
    grid = _SQUARE.grid(search)
    for (a, b), t, how in _orders(outcomes, place, grid, progress):
        sides = outcomes.meaning(a), outcomes.meaning(b)
        kind, changes = plane.BoundaryKind.PATHWAY, " | ".join(sides)
        if min(a, b) >= 0:
            kind, changes = between(outcomes.sequences[a], outcomes.sequences[b], chain.names)
        curves.append(plane.Boundary(kind, place(t), changes, *how, names, units, sides))
    for cell in outcomes.turned:
        kind, sides = plane.BoundaryKind.BISTABLE, ("one stable state", "two stable states")
        for t, changes, how in _limits(outcomes, cell, place, grid):
            curves.append(plane.Boundary(kind, place(t), changes, *how, names, units, sides))
    return tuple(curves)


def _orders(
    outcomes: Outcomes, place: Place, grid: Floats, progress: Progress
) -> list[tuple[tuple[int, int], Floats, How]]:
    """Changes of the sequence: its numbers on both sides, points, and method."""

    def proved(t: Floats) -> Ints:
        return outcomes.closed_form(place(t)).sequence.astype(np.int64)

    def ask(t: Floats) -> Ints:
        return outcomes.label(place(t)).astype(np.int64)

    curves: list[tuple[tuple[int, int], Floats, How]] = []
    known = None
    if outcomes.base is not None:
        pairs, difference = _differences(outcomes, outcomes.base)
        exact = _Exact(lambda t: outcomes.forces(place(t)), pairs, difference, proved)
        curves += [(sides, points, how) for _, sides, points, how in exact.curves()]
        known = exact.known
    nodes, shape = grid.reshape(-1, 2), grid.shape[:2]
    sure = outcomes.closed_form(place(nodes))
    unproved = (sure.sequence == UNSOLVED).reshape(shape)
    label = outcomes.label(place(nodes), progress, sure).astype(np.int64).reshape(shape)
    pieces = plane.searched(ask, grid, label, ignore=IMPOSSIBLE, wanted=unproved, known=known)
    return curves + [(sides, points, _SEARCHED) for sides, points in pieces]


def _differences(
    outcomes: Outcomes, base: Floats
) -> tuple[list[tuple[int, int, int]], Callable[[Floats, tuple[int, int, int]], Floats]]:
    """Pairs of forces that may become equal, and their difference (m,) [N] of (m, c, 2) forces.

    Pairs are (side, cell, other cell), first those of F0; cells that vary are counted first.
    """
    turned, n = outcomes.turned, len(outcomes.chain)
    stays = [i for i in range(n) if i not in turned]
    fixed = [end_forces(Simple(*base[i, :6])) for i in stays]
    vary = range(len(turned))
    cells = [(k, j) for k in vary for j in range(len(turned), n)] + list(combinations(vary, 2))

    def difference(forces: Floats, pair: tuple[int, int, int]) -> Floats:
        side, k, j = pair
        other = forces[:, j, side] if j < len(turned) else fixed[j - len(turned)][side]
        return forces[:, k, side] - other

    return [(side, *pair) for side in (0, 1) for pair in cells], difference


def _limits(
    outcomes: Outcomes, cell: int, place: Place, grid: Floats
) -> list[tuple[Floats, str, How]]:
    """Limits of bistability of a cell: points, change, and method."""
    nodes = place(grid.reshape(-1, 2))
    states = Stability(outcomes, cell, nodes)

    def ask(t: Floats) -> Ints:
        return states(place(t))

    if states.words:
        exact = _Exact(lambda t: states.limits(place(t)), range(3), lambda at, k: at[:, k], ask)
        return [(points, states.words[k], how) for k, _, points, how in exact.curves()]
    words = f"{outcomes.chain.names[cell]} has two stable states on one side, one on the other"
    label = states(nodes).reshape(grid.shape[:2])
    curves = plane.searched(ask, grid, label, ignore=IMPOSSIBLE)
    return [(points, words, _SEARCHED) for _, points in curves]


class _Exact(Generic[K]):
    """Curves on which one of several functions vanishes and across which a label changes.

    A function is one of `measure`, (m, ...) at (m, 2) places of the unit square; labels below zero
    are unknown.
    """

    def __init__(
        self,
        measure: Callable[[Floats], Floats],
        kinds: Iterable[K],
        function: Callable[[Floats, K], Floats],
        label: Callable[[Floats], Ints],
    ):
        self._measure, self._kinds, self._function = measure, kinds, function
        self._label = label
        self._levels: list[plane.LevelCurve] = []

    def curves(self) -> list[tuple[K, tuple[int, int], Floats, How]]:
        """Function, labels on both sides, points, and their largest distance from the curve.

        Each curve is cut where it meets another and where a label is not known.
        """
        cut: list[tuple[K, tuple[int, int], Floats, How]] = []
        grid = _SQUARE.grid(_GRID)
        at = self._measure(grid.reshape(-1, 2))
        for k in self._kinds:
            level = plane.LevelCurve(lambda t, k=k: self._function(self._measure(t), k))
            for line in plane.curves(level, grid, self._function(at, k).reshape(_GRID, _GRID)):
                smooth = plane.smoothed(line, level.project, _SMOOTH)

                def sides(t: Floats, level: plane.LevelCurve = level) -> Ints:
                    codes, t = self._sides(level, t)
                    # Pieces that coincide with an earlier curve are left out.
                    for other in self._levels:
                        codes[other.distance(t) < _ASIDE] = -1
                    return codes

                for code, points in plane.parted(smooth, sides, level.project, _CUTS):
                    if code >= 0 and np.max(np.ptp(points, axis=0)) > _SHORTEST:
                        how = plane.Method.EXACT, float(np.max(level.distance(points)))
                        cut.append((k, (code >> 32, code & 0xFFFFFFFF), points, how))
            self._levels.append(level)
        return cut

    def known(self, t: Floats) -> Bools:
        """Which of (m, 2) places are on one of these curves."""
        on = np.zeros(len(t), np.bool_)
        for level in self._levels:
            near = np.flatnonzero(level.distance(t) < 10 * plane.RESOLVED)
            on[near] |= self._sides(level, t[near])[0] >= 0
        return on

    def _sides(self, level: plane.LevelCurve, t: Floats) -> tuple[Ints, Floats]:
        """Labels on both sides of a level beside t as one number, -1 if alike, and t on it."""
        t, slope = level.projected(t)
        aside = _ASIDE * slope / np.linalg.norm(slope, axis=1, keepdims=True)
        both = self._label(np.concatenate([t + aside, t - aside])).reshape(2, -1)
        low, high = np.min(both, axis=0), np.max(both, axis=0)
        return np.where((low >= 0) & (low < high), (low << 32) + high, -1), t


def _extended(values: Floats) -> tuple[Floats, Floats]:
    """Places on an axis from 0 to 1 with their values, extended linearly beyond both ends."""
    first, last = (len(values) - 1) * np.diff(values)[[0, -1]]
    knots = np.concatenate([[-1.0], np.linspace(0.0, 1.0, len(values)), [2.0]])
    return knots, np.concatenate([[values[0] - first], values, [values[-1] + last]])
