"""One step of the cells that move: linearly implicit Euler, extrapolated."""

from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import kernel
from stepwell.mechanism import law, pick_rows
from stepwell.statics.following import Problem

# A step is done once in 1, 2, … so many parts.
COLUMNS = 5


class Leg(NamedTuple):
    """The k cells that move between two contacts, with the blocks that each takes along."""

    cells: Ints  # (k,)
    mass: Floats  # (k,) [kg] of all blocks from each cell outwards to the next that moves
    damping: Floats  # (k,) [N s/m]
    offset: Floats  # (k,) friction in the sense of the motion, and the push on the leader [N]
    begin: Floats  # (k,) travels where the step begins [m]
    slope: Floats  # (k,) κ there [N/m]
    level: float  # λ there [N]
    stiff: float  # of the actuator [N/m]; 0 under a dead load
    free: int  # how many groups of blocks move: k, or k - 1 where the outermost is held
    rows: Ints  # (k, slots) of each law, the same all through a step: there the law is smooth
    room: Ints  # (slots,) for other rows


@kernel
def look(problem: Problem, leg: Leg) -> None:
    """Rows and slopes of the cells where the step begins."""
    for m in range(len(leg.cells)):
        pick_rows(problem.laws, leg.cells[m], leg.begin[m], leg.rows[m])
        leg.slope[m] = law(problem.laws, leg.cells[m], leg.rows[m], leg.begin[m])[1]


@kernel
def tensions(problem: Problem, leg: Leg, way: Floats, pace: Floats, out: Floats) -> float:
    """Forces across the moving cells, (k,) [N], and λ, where the groups are at `way` and `pace`."""
    before, fast = 0.0, 0.0
    for m in range(len(leg.cells)):
        travel, speed = leg.begin[m] + (way[m] - before), pace[m] - fast
        before, fast = way[m], pace[m]
        force = law(problem.laws, leg.cells[m], leg.rows[m], travel)[0]
        out[m] = force + leg.damping[m] * speed + leg.offset[m]
    return leg.level - leg.stiff * way[-1]


@kernel
def solve(leg: Leg, h: float, mass: float, pull: Floats) -> bool:
    """x of (mass M + h C + h² K) x = pull over the groups, in place; False if not positive.

    The matrix is tridiagonal: each cell couples two neighbours. Positive pivots are its being
    positive definite, so the step is short enough to resolve what grows; with h = 1 and no damping
    and no mass they are the stability of the equilibrium.
    """
    k, free = len(leg.cells), leg.free
    damped = h if mass > 0.0 else 0.0
    pivot = np.empty(k)
    for m in range(free):
        here = damped * leg.damping[m] + h * h * leg.slope[m]
        pivot[m] = mass * leg.mass[m] + here
        if m > 0:
            pivot[m] -= here * here / pivot[m - 1]
            pull[m] += here * pull[m - 1] / pivot[m - 1]
        if m + 1 < k:
            pivot[m] += damped * leg.damping[m + 1] + h * h * leg.slope[m + 1]
        else:
            pivot[m] += h * h * leg.stiff
        if not pivot[m] > 0.0:
            return False
    for m in range(free - 1, -1, -1):
        if m + 1 < free:
            beyond = damped * leg.damping[m + 1] + h * h * leg.slope[m + 1]
            pull[m] += beyond * pull[m + 1]
        pull[m] /= pivot[m]
    return True


@kernel
def _march(problem: Problem, leg: Leg, pace: Floats, h: float, parts: int, out: Floats) -> bool:
    """The step in so many equal parts; (2k + 1,) way, pace and energy damped at its end."""
    k, free = len(leg.cells), leg.free
    way, now, part = np.zeros(k), pace.copy(), h / parts
    force, pull, damped = np.empty(k), np.empty(k), 0.0
    for _ in range(parts):
        end = tensions(problem, leg, way, now, force) - part * leg.stiff * now[-1]
        fast = 0.0
        for m in range(k):
            # As it will be when the part ends, as far as the present speeds tell.
            force[m] += part * leg.slope[m] * (now[m] - fast)
            fast = now[m]
        for m in range(free):
            pull[m] = part * ((force[m + 1] if m + 1 < k else end) - force[m])
        if not solve(leg, part, 1.0, pull):
            return False
        fast = 0.0
        for m in range(k):
            if m < free:
                now[m] += pull[m]
                way[m] += part * now[m]
            damped += part * leg.damping[m] * (now[m] - fast) ** 2
            fast = now[m]
    out[:k], out[k : 2 * k], out[2 * k] = way, now, damped
    return True


@kernel
def stride(problem: Problem, leg: Leg, pace: Floats, h: float, out: Floats, error: Floats) -> bool:
    """A step of length h [s], extrapolated to order COLUMNS; False where it is too long.

    Args:
        problem, leg: what moves.
        pace: (k,) speeds of the groups where it begins [m/s].
        h: its length [s].
        out: (2k + 1,) how far the groups go [m], their speeds [m/s], what the dampers take [J].
        error: (2k + 1,) what the last column of the extrapolation added.

    Source: Deuflhard 1985; as an L-stable method it takes blocks without mass to speak of as well.
    """
    size = len(out)
    table = np.empty((COLUMNS, size))
    for j in range(COLUMNS):
        if not _march(problem, leg, pace, h, j + 1, table[j]):
            return False
        # Aitken and Neville, from the newest row back: table[i] becomes T_{j, j - i}.
        for i in range(j - 1, -1, -1):
            by = (j + 1.0) / (i + 1.0) - 1.0
            for q in range(size):
                table[i, q] = table[i + 1, q] + (table[i + 1, q] - table[i, q]) / by
    for q in range(size):
        out[q] = table[0, q]
        error[q] = abs(table[0, q] - table[1, q])
    return True
