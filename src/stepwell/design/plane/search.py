"""Boundaries of anything that can be asked place by place, by bisection between grid nodes."""

import math
from collections.abc import Callable
from itertools import groupby

import numpy as np

from stepwell.base import Bools, Floats, Ints
from stepwell.design.plane.boundary import RESOLVED
from stepwell.design.plane.polyline import narrowed
from stepwell.design.plane.trace import trace


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

    Args:
        ask: the labels of (m, 2) places in the unit square.
        grid: (ny, nx, 2) nodes.
        label: (ny, nx) their labels.
        ignore: a label around which nothing is drawn.
        wanted: (ny, nx) bool; curves are followed where one end of the edge is wanted.
        known: which of (m, 2) points are on a curve that is there already.

    Returns:
        Pairs of labels with the (m, 2) points of the curve between them.
    """

    def centre(row: int, column: int) -> int:
        return int(ask((grid[row, column] + grid[row + 1, column + 1])[None] / 2)[0])

    edge = float(np.max(grid[-1, -1] - grid[0, 0])) / (min(grid.shape[:2]) - 1)
    steps = math.ceil(math.log2(edge / RESOLVED))
    found: list[tuple[tuple[int, int], Floats]] = []
    for line in trace(label, centre, ignore):
        near = np.ones(len(line.low), np.bool_)
        if wanted is not None:
            near = wanted[tuple(line.low.T)] | wanted[tuple(line.high.T)]
        for run in _runs(near):
            ends = tuple(line.low[run].T), tuple(line.high[run].T)
            at_a = label[ends[0]]
            a, b, at_b = narrowed(ask, grid[ends[0]], grid[ends[1]], at_a, label[ends[1]], steps)
            points = (a + b) / 2
            # Another label may have turned up on the way.
            pairs = np.sort(np.stack([at_a, at_b], axis=-1), axis=1)
            new = np.ones(len(points), np.bool_) if known is None else ~known(points)
            for part in _runs(new):
                found += _alike(pairs[part], points[part], ignore)
    return found


def _alike(pairs: Ints, points: Floats, ignore: int) -> list[tuple[tuple[int, int], Floats]]:
    found: list[tuple[tuple[int, int], Floats]] = []
    for (a, b), run in groupby(range(len(points)), lambda i: tuple(pairs[i].tolist())):
        piece = points[list(run)]
        if len(piece) > 1 and ignore not in (a, b):
            found.append(((a, b), piece))
    return found


def _runs(flags: Bools) -> list[slice]:
    # Each run takes one more point at either end, so that it meets the neighbouring curve.
    turns = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(int), [0]]))).tolist()
    return [slice(max(a - 1, 0), b + 1) for a, b in zip(turns[::2], turns[1::2], strict=True)]
