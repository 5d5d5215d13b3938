"""Where in the plane of an anchor an end force has a given value: the nearest place, and bounds."""

import math

import numpy as np
from numpy.typing import NDArray

from stepwell.concave.cell import Simple
from stepwell.concave.certificate import concave_disc
from stepwell.concave.ends import end_force, steepest
from stepwell.kernels import entry, kernel
from stepwell.mechanism import band_length

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

_DIRECTIONS = 64
_STEPS = 400


@kernel
def first_crossing(
    cell: Simple, side: int, force: float, ux: float, uy: float, most: float
) -> float:
    """Distance [m] along a direction to the first anchor with that end force; inf beyond `most`.

    Every step is too short to reach the curve, by the bound on the slope around each point, so
    no crossing can be jumped over; the steps shrink towards it and Newton does the last bit.
    """
    close = 1e-6 * cell.stiffness * cell.lever
    away = 0.0
    for _ in range(_STEPS):
        dx, dy = cell.dx + away * ux, cell.dy + away * uy
        value, fx, fy = end_force(cell, side, dx, dy)
        miss = abs(value - force)
        if miss <= close:
            break
        if away >= most:
            return np.inf
        t = side * cell.sin_limit
        length = band_length(t, np.sqrt(1.0 - t * t), dx, dy, cell.lever)
        radius = min(0.5 * length, 2.0 * miss / (np.sqrt(fx * fx + fy * fy) + 1e-300))
        # The bound holds on the disc, hence on any smaller one.
        away += min(radius, miss / steepest(cell, side, dx, dy, radius))
    else:
        return np.inf
    for _ in range(20):
        value, fx, fy = end_force(cell, side, cell.dx + away * ux, cell.dy + away * uy)
        step = (force - value) / (fx * ux + fy * uy)
        away += step
        if abs(step) <= 1e-9 * cell.lever:
            break
    # A ray that grazes the curve has no crossing of its own; its neighbours do.
    return away if 0.0 <= away <= most else np.inf


@kernel
def nearest(
    cell: Simple, side: int, force: float, up: int, most: float
) -> tuple[float, float, float]:
    """Distance [m] and direction (x, y) from the cell's anchor to the curve F0 or F1 = force.

    `up` is +1 where the end force has to rise for it and -1 where it has to fall; at distance
    zero the direction is the one that goes on that way. Rays in all directions first, then the
    angle at which the distance stops falling, by bisection of its slope. Infinite where no ray
    meets the curve within `most` [m].
    """
    _, fx, fy = end_force(cell, side, cell.dx, cell.dy)
    # The steepest way first: it leaves the others little to search.
    heading = math.atan2(up * fy, up * fx)
    best, at = most, np.nan
    for i in range(_DIRECTIONS):
        angle = heading + 2.0 * np.pi * i / _DIRECTIONS
        away = first_crossing(cell, side, force, math.cos(angle), math.sin(angle), best)
        if away < np.inf and not away > best:
            best, at = away, angle
    if np.isnan(at):
        return np.inf, math.cos(heading), math.sin(heading)
    if best == 0.0:
        return 0.0, math.cos(heading), math.sin(heading)
    low, high = at - 2.0 * np.pi / _DIRECTIONS, at + 2.0 * np.pi / _DIRECTIONS
    for _ in range(42):
        angle = 0.5 * (low + high)
        ux, uy = math.cos(angle), math.sin(angle)
        # A little more room than the best so far, for the rays on either side of it.
        away = first_crossing(cell, side, force, ux, uy, 1.5 * best)
        if away < np.inf:
            _, fx, fy = end_force(cell, side, cell.dx + away * ux, cell.dy + away * uy)
            falling = (fy * ux - fx * uy) * (fx * ux + fy * uy) > 0.0
            if away < best:
                best, at = away, angle
        else:
            falling = angle < at
        if falling:
            low = angle
        else:
            high = angle
    # Near the nearest point all rays are as long but for rounding; the slope tells which it is.
    angle = 0.5 * (low + high)
    away = first_crossing(cell, side, force, math.cos(angle), math.sin(angle), 1.5 * best)
    if away <= best * (1.0 + 1e-12):
        best, at = min(best, away), angle
    return best, math.cos(at), math.sin(at)


@entry(1e-2, "side")
def nearest_of(cell: Simple, side: Ints, force: Floats, up: Ints, most: float, out: Floats) -> None:
    """The nearest of several curves: side, force and up are (m,); out is (3,), as `nearest`.

    Distance -1 where the proof does not reach that far and the closed form says nothing.
    """
    out[0], out[1], out[2] = np.inf, np.nan, np.nan
    for i in range(len(side)):
        away, ux, uy = nearest(cell, side[i], force[i], up[i], min(most, out[0]))
        if away < out[0]:
            out[0], out[1], out[2] = away, ux, uy
    if len(side) > 0 and not concave_disc(cell, min(most, out[0])):
        out[0] = -1.0


@entry(1e-5, "d", "side")
def sift(
    cell: Simple,
    d: Floats,
    radius: float,
    side: Ints,
    force: Floats,
    up: Ints,
    held: Bools,
    inside: Bools,
) -> None:
    """Look at discs around the differences d = q - p, (m, 2) [m], `radius` [m] wide.

    Args:
        cell: whose end forces they are; its own anchors are not looked at.
        d: middles of the discs.
        radius: of every disc.
        side, force, up: (c,) conditions: F0 (side -1) or F1 (side +1) is above (up +1) or below
            (up -1) a force [N].
        held: (m,) bool out: False where a bound on the slope proves that no anchor in the disc
            meets all conditions.
        inside: (m,) bool out: whether the middle of the disc meets them all.
    """
    for i in range(len(d)):
        held[i], inside[i] = True, True
        for k in range(len(side)):
            value, _, _ = end_force(cell, side[k], d[i, 0], d[i, 1])
            lack = up[k] * (force[k] - value)
            if lack >= 0.0:
                inside[i] = False
                if lack > radius * steepest(cell, side[k], d[i, 0], d[i, 1], radius):
                    held[i] = False
                    break
