"""Dynamics of blocks with masses: accelerations, kinetic energy, impacts, and one time step."""

import math
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import kernel
from stepwell.mechanism import law, pick_rows
from stepwell.statics.following.state import DrivenChain

# Convergence tolerance, as a fraction of the largest number in the solution.
_CLOSE = 1e-15


@kernel
def least_constraint(
    low: Floats, high: Floats, extra: Floats, loose: Floats, end: float, out: Floats
) -> None:
    """Forces across cells, (N,) within their bounds, with the least constraint on the blocks."""
    # The force x_i accelerates the block inside cell i by +x_i/M and that outside by -x_i/M; Σ M ü²
    # is least (Gauss's principle), so a cell accelerates only at its bounds: a taut string through
    # them over the masses laid end to end. Impulses and jumps of speed obey the same. `extra` is
    # added to each acceleration [m/s²] or speed [m/s], `loose` is 1/M or 0, `out` begins as a
    # guess. Source: Gauss 1829; as contact problems, Moreau 1966.
    n = len(low)
    for i in range(n):
        out[i] = min(max(out[i], low[i]), high[i])
    # Sweeps from cell to cell: a run of n cells at rest needs about n² sweeps.
    for _ in range(100 + 40 * n * n):
        change, size = 0.0, abs(end)
        for i in range(n):
            inner, outer = loose[i - 1] if i > 0 else 0.0, loose[i]
            if inner + outer == 0.0:
                continue
            pull = extra[i] + (inner * out[i - 1] if i > 0 else 0.0)
            pull += outer * (out[i + 1] if i + 1 < n else end)
            value = min(max(pull / (inner + outer), low[i]), high[i])
            change = max(change, abs(value - out[i]))
            size = max(size, abs(value))
            out[i] = value
        if change <= _CLOSE * size:
            return


@kernel
def rates(force: Floats, loose: Floats, end: float, out: Floats) -> None:
    """Accelerations of the cells under the forces across them, (N,) [m/s²]; or jumps of speed."""
    n, before = len(force), 0.0
    for i in range(n):
        block = loose[i] * ((force[i + 1] if i + 1 < n else end) - force[i])
        out[i] = block - before
        before = block


@kernel
def kinetic(mass: Floats, loose: Floats, speed: Floats) -> float:
    """½ Σ M_j (v_1 + … + v_j)² of the blocks that can move [J]."""
    total, block = 0.0, 0.0
    for j in range(len(speed)):
        block += speed[j]
        if loose[j] > 0.0:
            total += 0.5 * mass[j] * block * block
    return total


@kernel
def apply_impacts(low: Floats, high: Floats, bounce: Floats, loose: Floats, speed: Floats) -> None:
    """Speeds (N,) after impacts at stops (infinite bounds), in place, by their `bounce`."""
    # Source: Newton's law of restitution; for simultaneous impacts Moreau 1988.
    impulse, jump = np.zeros(len(speed)), np.empty(len(speed))
    least_constraint(low, high, (1.0 + bounce) * speed, loose, 0.0, impulse)
    rates(impulse, loose, 0.0, jump)
    for i in range(len(speed)):
        held = low[i] < impulse[i] < high[i] and low[i] < high[i]
        speed[i] = -bounce[i] * speed[i] if held else speed[i] + jump[i]


class Crank(NamedTuple):
    """Motion of the drive from rest: its way is 2 `swing` sin²(ω t / 2)."""

    swing: float  # half of its way up to t = π/ω [m], or [N]; 0 where it stays
    omega: float  # ω [rad/s]
    until: float  # end of the motion [s]


# A drive that stays where it is, until the blocks rest.
STILL = Crank(0.0, 0.0, np.inf)


@kernel
def crank_way(crank: Crank, time: float, h: float) -> float:
    """Way of the drive within h [s] from a time [m], or [N]; of full precision for short h."""
    half = 0.5 * crank.omega * h
    return 2.0 * crank.swing * math.sin(crank.omega * time + half) * math.sin(half)


@kernel
def crank_speed(crank: Crank, time: float) -> float:
    """Speed of the drive [m/s], or [N/s]."""
    return crank.swing * crank.omega * math.sin(crank.omega * time)


@kernel
def crank_gain(crank: Crank, time: float) -> float:
    """Acceleration of the drive [m/s²], or [N/s²]."""
    return crank.swing * crank.omega * crank.omega * math.cos(crank.omega * time)


# Columns of the extrapolation: a step is computed in 1, 2, … COLUMNS parts.
COLUMNS = 5


class FreeCells(NamedTuple):
    """The k cells that move between two contacts, with the blocks that move with each."""

    cells: Ints  # (k,)
    mass: Floats  # (k,) [kg] of all blocks from each cell outwards to the next that moves
    damping: Floats  # (k,) [N s/m]
    offset: Floats  # (k,) friction in the sense of the motion, and the push on the leader [N]
    begin: Floats  # (k,) travels where the step begins [m]
    pace: Floats  # (k,) speeds of the groups of blocks there [m/s]
    slope: Floats  # (k,) κ there [N/m]
    level: float  # λ there [N]
    stiff: float  # of the actuator [N/m]; 0 under a dead load
    free: int  # number of moving groups of blocks: k, or k - 1 where the outermost is held
    crank: Crank
    time: float  # where the step begins [s]
    soft: float  # β: λ changes by the way of the drive over it; 0 where that moves the last group
    rows: Ints  # (k, slots) of each law, the same all through a step: there the law is smooth
    spare: Ints  # (slots,) memory for other rows


@kernel
def update_slopes(problem: DrivenChain, leg: FreeCells) -> None:
    """Rows and slopes of the cells where the step begins."""
    for m in range(len(leg.cells)):
        pick_rows(problem.laws, leg.cells[m], leg.begin[m], leg.rows[m])
        leg.slope[m] = law(problem.laws, leg.cells[m], leg.rows[m], leg.begin[m])[1]


@kernel
def tensions(
    problem: DrivenChain, leg: FreeCells, h: float, way: Floats, pace: Floats, out: Floats
) -> float:
    """Forces across the moving cells, (k,) [N], and λ after h [s], the groups at `way`, `pace`."""
    before, fast = 0.0, 0.0
    for m in range(len(leg.cells)):
        travel, speed = leg.begin[m] + (way[m] - before), pace[m] - fast
        before, fast = way[m], pace[m]
        force = law(problem.laws, leg.cells[m], leg.rows[m], travel)[0]
        out[m] = force + leg.damping[m] * speed + leg.offset[m]
    level = leg.level
    if leg.soft > 0.0:
        level += crank_way(leg.crank, leg.time, h) / leg.soft
    return level - leg.stiff * way[-1] if len(way) > 0 else level


@kernel
def solve(leg: FreeCells, h: float, mass: float, pull: Floats) -> bool:
    """x of (mass M + h C + h² K) x = pull, in place; False where that is not positive definite."""
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
def _substeps(problem: DrivenChain, leg: FreeCells, h: float, parts: int, out: Floats) -> bool:
    """The step in `parts` equal parts; (2k + 1,) way, pace and energy damped at its end."""
    k, free = len(leg.cells), leg.free
    way, now, part = np.zeros(k), leg.pace.copy(), h / parts
    force, pull, damped = np.empty(k), np.empty(k), 0.0
    for p in range(parts):
        then = leg.time + (p + 1) * part
        if free < k:
            now[-1] = crank_speed(leg.crank, then)
        end = tensions(problem, leg, (p + 1) * part, way, now, force) - part * leg.stiff * now[-1]
        fast = 0.0
        for m in range(k):
            # Linear prediction for the end of the part, from the present speeds.
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
        if free < k:
            way[-1] = crank_way(leg.crank, leg.time, (p + 1) * part)
    out[:k], out[k : 2 * k], out[2 * k] = way, now, damped
    return True


@kernel
def advance(problem: DrivenChain, leg: FreeCells, h: float, out: Floats, error: Floats) -> bool:
    """A step of length h [s], extrapolated to order COLUMNS; False where it is too long."""
    # `out` (2k + 1,) are ways, speeds and damped energy, `error` the change by the last column.
    # Source: Deuflhard 1985; an L-stable method also handles blocks of negligible mass.
    if len(leg.cells) == 0:
        out[:], error[:] = 0.0, 0.0
        return True
    table = np.empty((COLUMNS, len(out)))
    for j in range(COLUMNS):
        if not _substeps(problem, leg, h, j + 1, table[j]):
            return False
        # Aitken and Neville, from the newest row back: table[i] becomes T_{j, j - i}.
        for i in range(j - 1, -1, -1):
            by = (j + 1.0) / (i + 1.0) - 1.0
            table[i] = table[i + 1] + (table[i + 1] - table[i]) / by
    out[:], error[:] = table[0], np.abs(table[0] - table[1])
    return True
