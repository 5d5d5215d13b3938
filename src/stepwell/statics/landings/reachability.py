"""Grid of boxes that a chain can enter from the start of a snap.

A box is entered from its neighbour only through a face at which some point, some mobilities
within the ratio and the available energy allow it. Forces are bounded by their monotone pieces, so
no step size is involved (theory page, "Landings and mobility").
"""

from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import kernel
from stepwell.statics.following.state import DrivenChain, force_at
from stepwell.statics.landings import reachable_box
from stepwell.statics.landings.reachable_box import ReachableBox
from stepwell.statics.landings.start import Start

# The region next to the start decides which of two cells is ahead: the distance of nodes there is
# this fraction of the widest side, and it grows away from the start.
_NEAREST = 1e-5


class Grid(NamedTuple):
    """A grid over the travels of D cells, M nodes; under a stroke one more cell has the rest."""

    cell: Ints  # (D,)
    cuts: Ints  # (D,) intervals
    begin: Ints  # (D,) where the nodes of its axis begin
    stride: Ints  # (D,) of the number of a box
    node: Floats  # (M,) travels
    force: Floats  # (M,) F there
    energy: Floats  # (M,) see energy_at
    least: Floats  # (M,) F in between
    most: Floats  # (M,)
    last: int  # the cell that has the rest of the stroke, or -1
    free: float  # travel of all moving cells, under a stroke; else the drive less the resting cells


@kernel
def _nodes(low: float, high: float, far: float, out: Floats) -> int:
    """Fill nodes from `low` to `high`, densest at 0, at most `far` apart; returns their number."""
    used, growth = 0, 8.0 * far
    for toward, end in ((-1, low), (1, high)):
        way = 0.0
        while way < abs(end):
            if used == len(out):
                return used
            way += min(max(_NEAREST, way * growth), far)
            out[used] = end if way > abs(end) - 0.5 * _NEAREST else toward * way
            if out[used] == end:
                way = abs(end)
            used += 1
        if toward < 0:
            out[:used] = out[:used][::-1].copy()
            if used == len(out):
                return used
            out[used] = 0.0
            used += 1
    return used


@kernel
def grid_of(problem: DrivenChain, box: ReachableBox, start: Start, most: int) -> Grid:
    """A grid of at most `most` boxes over the box of the cells that move."""
    rigid = problem.beta == 0.0
    width = box.high - box.low
    last = int(np.argmax(width)) if rigid else -1
    cell = np.flatnonzero(width > 0.0)
    cell = cell[cell != last]
    dims, widest, fine = len(cell), np.max(width), 128.0
    nodes, count = np.empty((dims, 512)), np.empty(dims, np.int64)
    while True:
        boxes = 1.0
        for d in range(dims):
            i = int(cell[d])
            # As fractions of the widest side.
            low = (box.low[i] - start.travel[i]) / widest
            high = (box.high[i] - start.travel[i]) / widest
            count[d] = _nodes(low, high, 1.0 / fine, nodes[d]) - 1
            boxes *= count[d]
        if boxes <= most or fine < 4.0:
            break
        fine *= 0.9
    begin, stride = np.empty(dims, np.int64), np.empty(dims, np.int64)
    total, number = 0, 1
    for d in range(dims):
        begin[d], stride[d] = total, number
        total += count[d] + 1
        number *= count[d]
    out, free = np.empty((5, total)), start.drive
    for i in np.flatnonzero(width == 0.0):
        free -= start.travel[i]
    for d in range(dims):
        i = int(cell[d])
        for k in range(count[d] + 1):
            at = begin[d] + k
            travel = start.travel[i] + widest * nodes[d, k]
            travel = box.low[i] if k == 0 else box.high[i] if k == count[d] else travel
            out[0, at], out[1, at] = travel, force_at(problem, i, travel)
            out[2, at] = reachable_box.energy_at(problem, start, i, travel)
        for k in range(begin[d], begin[d] + count[d]):
            out[3, k], out[4, k] = reachable_box.forces_within(problem, i, out[0, k], out[0, k + 1])
    return Grid(cell, count, begin, stride, out[0], out[1], out[2], out[3], out[4], last, free)


@kernel
def boxes_of(grid: Grid) -> int:
    """Number of boxes of a grid."""
    return int(np.prod(grid.cuts))


@kernel
def _left(box: ReachableBox, grid: Grid, low: float, high: float) -> tuple[float, float]:
    """Travels of the last cell where the others have gone from `low` to `high` together."""
    most, least = box.high[grid.last], box.low[grid.last]
    return min(max(grid.free - high, least), most), min(max(grid.free - low, least), most)


@kernel
def _enough_energy(
    problem: DrivenChain, box: ReachableBox, start: Start, grid: Grid, at: Ints
) -> bool:
    """Whether some point of a box takes no more energy than the start."""
    # A force taken off each cell and given to the drive changes no sum; one near λ bounds well.
    node, level = grid.node, start.force
    low, high = 0.0, 0.0
    for d in range(len(at)):
        k = int(grid.begin[d] + at[d])
        low += node[k]
        high += node[k + 1]
    if grid.last >= 0:
        a, b = _left(box, grid, low, high)
        least, most = reachable_box.forces_within(problem, grid.last, a, b)
        force = least - level, most - level
        tilt = 0.5 * (force[0] + force[1])
        energy = (
            reachable_box.energy_at(problem, start, grid.last, a),
            reachable_box.energy_at(problem, start, grid.last, b),
        )
        # Σ s is given.
        total = tilt * (grid.free - a - low) + reachable_box.least_energy(
            energy, b - a, force, tilt
        )
    else:
        stiffness, begun = problem.alpha / problem.beta, 0.0
        for i in grid.cell:
            begun += start.travel[i]
        way = float(0.5 * (low + high) - begun)
        tilt = -stiffness * way
        total = -0.5 * stiffness * way * way + tilt * (begun - low)
    for d in range(len(at)):
        k = int(grid.begin[d] + at[d])
        energy = grid.energy[k], grid.energy[k + 1]
        force = grid.least[k] - level, grid.most[k] - level
        total += reachable_box.least_energy(energy, node[k + 1] - node[k], force, tilt)
    return bool(total <= reachable_box.energy_slack(problem))


@kernel
def _can_leave(
    problem: DrivenChain, box: ReachableBox, grid: Grid, at: Ints, axis: int, up: bool, ratio: float
) -> bool:
    """Whether the flow can leave a box through its upper or lower face on an axis."""
    # Cell i rises where Σ m_j (F_i - F_j) < 0: take the largest F_j and mobilities that pull it.
    node, slip = grid.node, reachable_box.CLOSE_FORCE * problem.scale
    face = int(grid.begin[axis] + at[axis]) + (1 if up else 0)
    own, low, high, total = grid.force[face], node[face], node[face], 0.0
    for d in range(len(at)):
        if d == axis:
            continue
        k, cell = int(grid.begin[d] + at[d]), int(grid.cell[d])
        low += node[k]
        high += node[k + 1]
        gap = own - grid.most[k] if up else grid.least[k] - own
        pressed = box.stops[cell, int(up)] and at[d] == (grid.cuts[d] - 1 if up else 0)
        total += _weighed(gap - slip, pressed, problem.mobility[cell], ratio)
    if grid.last < 0:
        # λ is largest where all others have moved least.
        level = problem.alpha / problem.beta * (grid.free - (low if up else high))
        return level > own - slip if up else level < own + slip
    cell = grid.last
    a, b = _left(box, grid, low, high)
    least, most = reachable_box.forces_within(problem, cell, a, b)
    gap = own - most if up else least - own
    stopped = b >= box.high[cell] if up else a <= box.low[cell]
    pressed = box.stops[cell, int(up)] and stopped
    return total + _weighed(gap - slip, pressed, problem.mobility[cell], ratio) < 0.0


@kernel
def _weighed(gap: float, pressed: bool, mobility: float, ratio: float) -> float:
    """The least contribution of a cell; zero where a stop can hold it."""
    if gap > 0.0:
        return 0.0 if pressed else mobility * gap
    return ratio * mobility * gap


@kernel
def _mark(
    problem: DrivenChain,
    box: ReachableBox,
    grid: Grid,
    low: Floats,
    high: Floats,
    value: int,
    out: Ints,
) -> None:
    """Mark all boxes that hold a point between travels `low` and `high`."""
    dims = len(grid.cell)
    begin, end = np.zeros(dims, np.int64), np.zeros(dims, np.int64)
    for d in range(dims):
        i, nodes = grid.cell[d], grid.node[grid.begin[d] : grid.begin[d] + grid.cuts[d] + 1]
        near = 1e-9 * problem.laws.full[i]
        if high[i] < box.low[i] - near or low[i] > box.high[i] + near:
            return
        begin[d] = max(0, np.searchsorted(nodes, low[i] - near) - 1)
        end[d] = min(grid.cuts[d], max(np.searchsorted(nodes, high[i] + near), 1))
    at = begin.copy()
    while True:
        out[np.sum(at * grid.stride)] = value
        d = 0
        while d < dims:
            at[d] += 1
            if at[d] < end[d]:
                break
            at[d] = begin[d]
            d += 1
        if d == dims:
            return


@kernel
def _exists(problem: DrivenChain, box: ReachableBox, grid: Grid, at: Ints) -> bool:
    """Whether a box contains points at which the last cell has the rest of the stroke."""
    if grid.last < 0:
        return True
    low, high = 0.0, 0.0
    for d in range(len(at)):
        k = int(grid.begin[d] + at[d])
        low += grid.node[k]
        high += grid.node[k + 1]
    near = 1e-9 * problem.laws.full[grid.last]
    most, least = box.high[grid.last], box.low[grid.last]
    return grid.free - low >= least - near and grid.free - high <= most + near


_SEEN, _ELSEWHERE, _CLOSED = 1, 2, 3


@kernel
def keeps_off(
    problem: DrivenChain, box: ReachableBox, start: Start, grid: Grid, others: Floats, ratio: float
) -> bool:
    """Whether no flow leads to (C, 2, N) places for mobilities within a ratio; inf: by energy."""
    # One function: boxes wait in one list, and marks are in one array.
    dims, boxes = len(grid.cell), boxes_of(grid)
    seen, begun = np.zeros(boxes, np.int64), np.zeros(boxes, np.int64)
    for c in range(len(others)):
        _mark(problem, box, grid, others[c, 0], others[c, 1], _ELSEWHERE, seen)
    _mark(problem, box, grid, start.travel, start.travel, _SEEN, begun)
    waiting, used = np.empty(boxes, np.int64), 0
    for number in np.flatnonzero(begun):
        if seen[number] == _ELSEWHERE:
            return False
        seen[number] = _SEEN
        waiting[used] = number
        used += 1
    at, first = np.empty(dims, np.int64), 0
    while first < used:
        number = waiting[first]
        first += 1
        for d in range(dims):
            at[d] = number // grid.stride[d] % grid.cuts[d]
        for d in range(dims):
            for step in (1, -1):
                if not 0 <= at[d] + step < grid.cuts[d]:
                    continue
                to = number + step * grid.stride[d]
                if seen[to] == _SEEN or seen[to] == _CLOSED:
                    continue
                if np.isfinite(ratio) and not _can_leave(
                    problem, box, grid, at, d, step > 0, ratio
                ):
                    continue
                at[d] += step
                enters = _exists(problem, box, grid, at)
                enters = enters and _enough_energy(problem, box, start, grid, at)
                at[d] -= step
                if not enters:
                    seen[to] = _CLOSED
                    continue
                if seen[to] == _ELSEWHERE:
                    return False
                seen[to] = _SEEN
                waiting[used] = to
                used += 1
    return True
