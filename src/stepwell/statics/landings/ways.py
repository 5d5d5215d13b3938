"""Where the chain can come from the start of a snap: boxes that it can enter, on a grid.

A box is entered from its neighbour only through a face at which some point, some mobilities
within the ratio and the energy that there is allow it. Forces are bounded by their monotone pieces,
so nothing is stepped over (theory page, "By enclosure").
"""

from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import kernel
from stepwell.mechanism import stored
from stepwell.statics.following import Problem, find_piece
from stepwell.statics.landings.room import (
    CLOSE_FORCE,
    Room,
    force_at,
    forces_within,
)
from stepwell.statics.landings.start import Start

# The finest grid has so many steps on the longest travel.
_FINEST = 4096


class Axis(NamedTuple):
    """What a cell does between the nodes of its axis; n intervals."""

    node: Floats  # (n + 1,) travels
    force: Floats  # (n + 1,) F there
    energy: Floats  # (n + 1,) what it has stored since the start, less λ of the start times the way
    least: Floats  # (n,) F in between
    most: Floats  # (n,)


class Grid(NamedTuple):
    """A grid over the travels of D cells; under a stroke one more has what the others leave.

    The axes lie one after the other in arrays of M nodes.
    """

    cell: Ints  # (D,)
    count: Ints  # (D,) intervals
    begin: Ints  # (D,) where the nodes of its axis begin
    stride: Ints  # (D,) of the number of a box
    axes: Axis  # (M,)
    step: float
    last: int  # the cell that has what the others leave, or -1
    free: float  # what they leave it where all are at their first nodes
    rest: Axis  # the same of it, at nodes of falling travel
    wide: Floats  # (2, L) least and largest F over D intervals from a node of it on
    narrow: Floats  # (2, L) the same over D - 1


@kernel
def _steps(width: float, step: float) -> int:
    """How many steps a width takes, but for rounding; at least one."""
    return max(1, int(np.ceil(width / step - 1e-9)))


@kernel
def _energy_at(problem: Problem, start: Start, i: int, travel: float) -> float:
    """What cell i has stored since the start, less λ of the start times the way."""
    pieces, begun = problem.pieces, start.travel[i]
    picked = pieces.picked
    here = stored(problem.laws, i, picked[find_piece(pieces, i, travel, 0)], travel)
    there = stored(problem.laws, i, picked[find_piece(pieces, i, begun, 0)], begun)
    return here - there - start.force * (travel - begun)


@kernel
def energy_of(problem: Problem, start: Start, travel: Floats) -> float:
    """What the chain and its actuator have stored at `travel` (N,) since the start [J]."""
    total, way = 0.0, 0.0
    for i in range(len(travel)):
        total += _energy_at(problem, start, i, travel[i])
        way += travel[i] - start.travel[i]
    if problem.beta > 0.0:
        total += 0.5 * problem.alpha / problem.beta * way * way
    return total


@kernel
def _fill(problem: Problem, start: Start, i: int, axis: Axis, begin: int, end: int) -> None:
    """Fill in what cell i does on the nodes `begin` to `end` of an axis."""
    for k in range(begin, end + 1):
        axis.force[k] = force_at(problem, i, axis.node[k])
        axis.energy[k] = _energy_at(problem, start, i, axis.node[k])
    for k in range(begin, end):
        low, high = min(axis.node[k], axis.node[k + 1]), max(axis.node[k], axis.node[k + 1])
        axis.least[k], axis.most[k] = forces_within(problem, i, low, high)


@kernel
def _axis(nodes: int) -> Axis:
    """Room for an axis."""
    return Axis(np.empty(nodes), np.empty(nodes), np.empty(nodes), np.empty(nodes), np.empty(nodes))


@kernel
def grid_of(problem: Problem, room: Room, start: Start, most: int) -> Grid:
    """A grid of about `most` boxes, of one step for all cells, over the room of those that move."""
    rigid = problem.beta == 0.0
    width = room.high - room.low
    moving = np.flatnonzero(width > 0.0)
    last = int(np.argmax(width)) if rigid else -1
    cell = moving[moving != last]
    step = np.max(width) / _FINEST
    while True:
        boxes = 1.0
        for i in cell:
            boxes *= _steps(width[i], step)
        if boxes <= most:
            break
        step *= 1.05
    dims = len(cell)
    count, begin = np.empty(dims, np.int64), np.empty(dims, np.int64)
    stride = np.empty(dims, np.int64)
    nodes, boxes_before, longest = 0, 1, dims + 1
    for d in range(dims):
        count[d] = _steps(width[cell[d]], step)
        begin[d], stride[d] = nodes, boxes_before
        nodes += count[d] + 1
        boxes_before *= count[d]
        longest += count[d]
    axes = _axis(nodes)
    for d in range(dims):
        i = cell[d]
        for k in range(count[d] + 1):
            axes.node[begin[d] + k] = min(room.low[i] + k * step, room.high[i])
        axes.node[begin[d] + count[d]] = room.high[i]
        _fill(problem, start, i, axes, begin[d], begin[d] + count[d])
    rest = _axis(longest if rigid else 0)
    wide, narrow = np.empty((2, len(rest.node))), np.empty((2, len(rest.node)))
    free = start.drive
    if rigid:
        for i in range(len(width)):
            if i != last:
                free -= room.low[i]
        for k in range(longest):
            rest.node[k] = min(max(free - k * step, room.low[last]), room.high[last])
        _fill(problem, start, last, rest, 0, longest - 1)
        for k in range(longest):
            _window(rest, k, dims, wide)
            _window(rest, k, dims - 1, narrow)
    return Grid(cell, count, begin, stride, axes, step, last, free, rest, wide, narrow)


@kernel
def _window(axis: Axis, k: int, length: int, out: Floats) -> None:
    """Least and largest F over so many intervals from node k on."""
    out[0, k] = out[1, k] = axis.force[k]
    for j in range(k, min(k + length, len(axis.node) - 1)):
        out[0, k] = min(out[0, k], axis.least[j])
        out[1, k] = max(out[1, k], axis.most[j])


@kernel
def _least_energy(axis: Axis, a: int, b: int, bounds: tuple[float, float], tilt: float) -> float:
    """A bound from below of energy less `tilt` times travel between two nodes of an axis.

    `bounds` are the least and the largest F there, less λ of the start.
    """
    width = axis.node[b] - axis.node[a]
    one, two = axis.energy[a] - tilt * axis.node[a], axis.energy[b] - tilt * axis.node[b]
    falls, rises = bounds[0] - tilt, bounds[1] - tilt
    if falls >= 0.0:
        return one
    if rises <= 0.0:
        return two
    way = min(max((one - two + rises * width) / (rises - falls), 0.0), width)
    return one + falls * way


@kernel
def _enough_energy(
    problem: Problem, room: Room, start: Start, grid: Grid, at: Ints, fixed: float
) -> bool:
    """Whether some point of a box takes no more energy than the start.

    What all cells store is bounded with a constant force taken off each of them and given to the
    drive, which changes nothing in the sum: one near to the λ there bounds it tightly.
    """
    axes, dims, level = grid.axes, len(at), start.force
    low, high, steps = fixed, fixed, 0
    for d in range(dims):
        k = grid.begin[d] + at[d]
        low += axes.node[k]
        high += axes.node[k + 1]
        steps += at[d]
    total, begun = 0.0, 0.0
    for i in range(len(start.travel)):
        begun += start.travel[i]
    if grid.last >= 0:
        rest, end = grid.rest, steps + dims
        bottom, top = grid.wide[0, steps] - level, grid.wide[1, steps] - level
        tilt = 0.5 * (bottom + top)
        # Its nodes run downwards.
        total += tilt * (start.drive - fixed) + _least_energy(rest, end, steps, (bottom, top), tilt)
    else:
        stiffness = problem.alpha / problem.beta
        way = 0.5 * (low + high) - begun
        tilt = -stiffness * way
        total += -0.5 * stiffness * way * way + tilt * (begun - fixed)
    for d in range(dims):
        k = grid.begin[d] + at[d]
        bounds = axes.least[k] - level, axes.most[k] - level
        total += _least_energy(axes, k, k + 1, bounds, tilt)
    return total <= CLOSE_FORCE * problem.scale * np.max(problem.laws.full)


@kernel
def _can_leave(
    problem: Problem,
    room: Room,
    start: Start,
    grid: Grid,
    at: Ints,
    axis: int,
    up: bool,
    ratio: float,
) -> bool:
    """Whether the flow can leave a box through its upper or lower face on an axis."""
    if grid.last >= 0:
        return _pulled(problem, room, grid, at, axis, up, ratio)
    axes, free = grid.axes, start.drive
    for i in range(len(start.travel)):
        if room.high[i] == room.low[i]:
            free -= start.travel[i]
    for d in range(len(at)):
        k = grid.begin[d] + at[d]
        # The largest λ is where all others have gone least.
        free -= axes.node[k + 1 if up == (d == axis) else k]
    level = problem.alpha / problem.beta * free
    own = axes.force[grid.begin[axis] + at[axis] + (1 if up else 0)]
    slip = CLOSE_FORCE * problem.scale
    return level > own - slip if up else level < own + slip


@kernel
def _pulled(
    problem: Problem, room: Room, grid: Grid, at: Ints, axis: int, up: bool, ratio: float
) -> bool:
    """Whether the flow can leave a box through a face under a prescribed stroke.

    Cell i rises where Σ m_j (F_i - F_j) < 0, over all that are not pressed against
    a stop: the least of it takes the largest F_j and gives those that pull it the most mobility.
    """
    axes, slip, dims = grid.axes, CLOSE_FORCE * problem.scale, len(at)
    face = grid.begin[axis] + at[axis] + (1 if up else 0)
    own = axes.force[face]
    total, steps = 0.0, 0
    for d in range(dims):
        steps += at[d]
        if d == axis:
            continue
        k = grid.begin[d] + at[d]
        cell = grid.cell[d]
        gap = own - axes.most[k] if up else axes.least[k] - own
        gap -= slip
        if gap > 0.0 and (
            room.stops[cell, 1] and at[d] == grid.count[d] - 1
            if up
            else room.stops[cell, 0] and at[d] == 0
        ):
            gap = 0.0
        total += problem.mobility[cell] * gap * (ratio if gap < 0.0 else 1.0)
    if up:
        steps += 1
    end = steps + dims - 1
    low, high = grid.rest.node[end], grid.rest.node[steps]
    cell = grid.last
    gap = own - grid.narrow[1, steps] if up else grid.narrow[0, steps] - own
    gap -= slip
    if gap > 0.0 and (
        room.stops[cell, 1] and high >= room.high[cell]
        if up
        else room.stops[cell, 0] and low <= room.low[cell]
    ):
        gap = 0.0
    total += problem.mobility[cell] * gap * (ratio if gap < 0.0 else 1.0)
    return total < 0.0


@kernel
def _mark(
    problem: Problem, room: Room, grid: Grid, low: Floats, high: Floats, value: int, out: Ints
) -> int:
    """Mark all boxes that hold a point between travels `low` and `high`; how many."""
    dims, marked = len(grid.cell), 0
    begin, end = np.zeros(dims, np.int64), np.zeros(dims, np.int64)
    for d in range(dims):
        i, nodes = grid.cell[d], grid.axes.node[grid.begin[d] : grid.begin[d] + grid.count[d] + 1]
        near = 1e-9 * problem.laws.full[i]
        if high[i] < room.low[i] - near or low[i] > room.high[i] + near:
            return 0
        begin[d] = max(0, np.searchsorted(nodes, low[i] - near) - 1)
        end[d] = min(grid.count[d], max(np.searchsorted(nodes, high[i] + near), 1))
    at = begin.copy()
    while True:
        number = 0
        for d in range(dims):
            number += at[d] * grid.stride[d]
        out[number] = value
        marked += 1
        d = 0
        while d < dims:
            at[d] += 1
            if at[d] < end[d]:
                break
            at[d] = begin[d]
            d += 1
        if d == dims:
            return marked


@kernel
def _exists(grid: Grid, room: Room, at: Ints) -> bool:
    """Whether a box holds points at which the last cell has what the others leave."""
    if grid.last < 0:
        return True
    steps = 0
    for d in range(len(at)):
        steps += at[d]
    near = 1e-9 * grid.step
    most = grid.free - steps * grid.step
    least = most - len(at) * grid.step
    return most >= room.low[grid.last] - near and least <= room.high[grid.last] + near


_SEEN, _ELSEWHERE = 1, 2


@kernel
def keeps_off(
    problem: Problem, room: Room, start: Start, grid: Grid, others: Floats, ratio: float
) -> bool:
    """Whether no way leads to the (C, 2, N) other places, for all mobilities within a ratio.

    A ratio of inf asks for energy alone.
    """
    dims, boxes = len(grid.cell), 1
    for d in range(dims):
        boxes *= grid.count[d]
    seen = np.zeros(boxes, np.int64)
    for c in range(len(others)):
        _mark(problem, room, grid, others[c, 0], others[c, 1], _ELSEWHERE, seen)
    begun = np.zeros(boxes, np.int64)
    _mark(problem, room, grid, start.travel, start.travel, _SEEN, begun)
    waiting = np.empty(boxes, np.int64)
    used = 0
    for number in np.flatnonzero(begun):
        if seen[number] == _ELSEWHERE:
            return False
        seen[number] = _SEEN
        waiting[used] = number
        used += 1
    fixed = 0.0
    for i in range(len(start.travel)):
        if room.high[i] == room.low[i]:
            fixed += start.travel[i]
    at, first = np.empty(dims, np.int64), 0
    while first < used:
        number = waiting[first]
        first += 1
        for d in range(dims):
            at[d] = number // grid.stride[d] % grid.count[d]
        for d in range(dims):
            for up in (True, False):
                step = 1 if up else -1
                if not 0 <= at[d] + step < grid.count[d]:
                    continue
                to = number + step * grid.stride[d]
                if seen[to] == _SEEN:
                    continue
                at[d] += step
                enters = _exists(grid, room, at) and _enough_energy(
                    problem, room, start, grid, at, fixed
                )
                at[d] -= step
                if not enters or (
                    np.isfinite(ratio)
                    and not _can_leave(problem, room, start, grid, at, d, up, ratio)
                ):
                    continue
                if seen[to] == _ELSEWHERE:
                    return False
                seen[to] = _SEEN
                waiting[used] = to
                used += 1
    return True
