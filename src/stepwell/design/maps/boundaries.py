"""The boundaries of the transition map, as curves and not as edges of pixels."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stepwell.concave import end_forces
from stepwell.design.maps import bistable
from stepwell.design.maps.pathways import IMPOSSIBLE, Pathways
from stepwell.design.parameters import axis, refuse_far, require_places, which
from stepwell.design.plane import (
    RESOLVED,
    Boundary,
    BoundaryKind,
    Box,
    Level,
    curves,
    kept,
    searched,
    smoothed,
)
from stepwell.mechanism import Chain

Floats = NDArray[np.float64]

_GRID = 201  # nodes each way between which exact curves are looked for
_BYTES = 60  # of a node, on the way
_SMOOTH = 2e-5  # of the box diagonal: farthest that a chord may be from its curve


def boundaries(
    chain: Chain,
    cell: int | str = 1,
    *,
    x: ArrayLike,
    y: ArrayLike,
    search: int = 61,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[Boundary, ...]:
    """The curves between the regions of a transition map, in the same box.

    Where both cells are proved concave and the actuator is rigid, the pathway changes exactly
    where the cells' F0 or F1 are equal, and those curves are returned, cut where the proof
    ends. Elsewhere the general engine is asked on a coarser grid and every change between two
    neighbouring nodes is bisected; such curves end up to one grid step short of a point where
    three pathways meet, and features finer than that grid are not seen.

    Args:
        chain: two cells.
        cell: the one whose anchor moves, 0 or 1 or its name.
        x, y: rising places of its anchor q [m]; only the first and the last count.
        search: nodes each way of the grid for the general engine.
        progress: called with (done, total) while the general engine works.

    Returns:
        Pathway boundaries first, then the limits of bistability.

    Raises:
        ValueError: a chain that is no pair, or axes that do not rise.

    Source: Kamp et al. 2024, Fig. 2C and Eq. 3; curves: theory page, "Two cells".
    """
    cell = which(chain, cell)
    x, y = axis("x", x, 2), axis("y", y, 2)
    require_places(search, search, _BYTES)
    refuse_far(chain, cell, x, y)
    box = Box(float(x[0]), float(x[-1]), float(y[0]), float(y[-1]))
    pathways = Pathways(chain, cell)
    levels = _levels(pathways)
    sagitta = _SMOOTH * box.diagonal
    return (
        *_orders(pathways, levels, box, sagitta),
        *_searched(pathways, levels, box, search, progress),
        *bistable.limits(chain.cells[cell], chain.names[cell], box, search, sagitta),
    )


def _levels(pathways: Pathways) -> tuple[Level, ...]:
    if pathways.fixed is None or pathways.moving is None:
        return ()
    equal_0, equal_1 = end_forces(pathways.fixed)
    return Level(pathways.moving, -1, equal_0), Level(pathways.moving, +1, equal_1)


def _orders(
    pathways: Pathways, levels: tuple[Level, ...], box: Box, sagitta: float
) -> list[Boundary]:
    inner, outer = pathways.chain.names
    found: list[Boundary] = []
    for level in levels:
        if level.side < 0:
            kind, changes = BoundaryKind.LOADING_ORDER, f"{inner} or {outer} loads first: equal F0"
        else:
            kind = BoundaryKind.UNLOADING_ORDER
            changes = f"{inner} or {outer} unloads first: equal F1"
        for line in curves(level, box.grid(_GRID) - pathways.p):
            smooth = smoothed(line, level.project, sagitta)
            for d in kept(smooth, level.proved, level.project):
                error = float(np.max(level.distance(d)))
                found.append(Boundary(kind, d + pathways.p, changes, "exact", error))
    return found


def _searched(
    pathways: Pathways,
    levels: tuple[Level, ...],
    box: Box,
    nodes: int,
    progress: Callable[[int, int], None] | None,
) -> list[Boundary]:
    grid = box.grid(nodes)
    label = pathways.proved(grid.reshape(-1, 2)).reshape(nodes, nodes).astype(np.int64)
    unproved = label < 0
    waiting = np.argwhere(unproved)
    for done, (row, column) in enumerate(waiting):
        if progress is not None:
            progress(done, len(waiting))
        label[row, column] = pathways(grid[row, column])

    def known(q: Floats) -> NDArray[np.bool_]:
        d = q - pathways.p
        on = [level.proved(d) & (level.distance(d) < 10 * RESOLVED) for level in levels]
        return np.any(on, axis=0) if on else np.zeros(len(d), bool)

    found = searched(pathways, grid, label, ignore=IMPOSSIBLE, wanted=unproved, known=known)
    return [
        Boundary(
            BoundaryKind.PATHWAY,
            points,
            " | ".join(pathways.words(number) for number in labels),
            "search",
            RESOLVED,
        )
        for labels, points in found
    ]
