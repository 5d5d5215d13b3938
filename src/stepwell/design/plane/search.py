"""Boundaries of anything that can be asked point by point, by bisection between grid nodes."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from stepwell.design.plane.boundary import RESOLVED
from stepwell.design.plane.trace import trace

Floats = NDArray[np.float64]


def searched(
    ask: Callable[[Floats], int],
    grid: Floats,
    label: NDArray[np.int64],
    *,
    ignore: int,
    wanted: NDArray[np.bool_] | None = None,
    known: Callable[[Floats], NDArray[np.bool_]] | None = None,
) -> list[tuple[tuple[int, int], Floats]]:
    """Curves between unlike nodes, each point bisected to `RESOLVED` on an edge of the grid.

    Args:
        ask: the label of any place (2,).
        grid: (ny, nx, 2) nodes [m].
        label: (ny, nx) their labels.
        ignore: a label around which nothing is drawn.
        wanted: (ny, nx) bool; curves are followed where one end of the edge is wanted.
        known: which of (m, 2) points are on a curve that is there already.

    Returns:
        Pairs of labels with the (m, 2) points [m] of the curve between them.
    """

    def centre(row: int, column: int) -> int:
        return ask((grid[row, column] + grid[row + 1, column + 1]) / 2)

    found: list[tuple[tuple[int, int], Floats]] = []
    for line in trace(label, centre, ignore):
        near = np.ones(len(line.low), bool)
        if wanted is not None:
            near = wanted[tuple(line.low.T)] | wanted[tuple(line.high.T)]
        for run in _runs(near):
            ends = zip(grid[tuple(line.low[run].T)], grid[tuple(line.high[run].T)], strict=True)
            points = np.array([_bisected(ask, a, b) for a, b in ends])
            new = np.ones(len(points), bool) if known is None else ~known(points)
            for part in _runs(new):
                if len(points[part]) > 1:
                    found.append((line.labels, points[part]))
    return found


def _runs(flags: NDArray[np.bool_]) -> list[slice]:
    # Each run takes one more point at either end, so that it meets the neighbouring curve.
    turns = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(int), [0]]))).tolist()
    return [slice(max(a - 1, 0), b + 1) for a, b in zip(turns[::2], turns[1::2], strict=True)]


def _bisected(ask: Callable[[Floats], int], a: Floats, b: Floats) -> Floats:
    at_a = ask(a)
    while np.linalg.norm(b - a) > RESOLVED:
        middle = (a + b) / 2
        if ask(middle) == at_a:
            a = middle
        else:
            b = middle
    return (a + b) / 2
