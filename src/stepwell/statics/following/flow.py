"""Where a snap lands when three cells or more move: overdamped flow, integrated."""

from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import kernel, overspent
from stepwell.mechanism import (
    BEFORE,
    BEYOND,
    FIRST,
    HIGH,
    LOW,
    Laws,
    beyond,
    law,
    pick_rows,
    summed,
)
from stepwell.statics.following.branch import smallest_eigenvalue
from stepwell.statics.following.pieces import stand_on
from stepwell.statics.following.state import Problem

_STEPS = 30_000


class Point(NamedTuple):
    """Where the flow is; N cells."""

    drive: float
    travel: Floats  # (N,)
    force: Floats  # (N,) there
    slope: Floats  # (N,) κ there
    sense: Ints  # (N,) in which a cell moves within the step; 0 where it stays
    rows: Ints  # room for pick_rows


@kernel
def _drives(
    travel: float, force: float, friction: float, least: float, most: float, shared: float
) -> float:
    """What drives a cell [N]: stops and Coulomb friction may hold it."""
    if shared > force + friction and travel < most:
        return shared - force - friction
    if shared < force - friction and travel > least:
        return shared - force + friction
    return 0.0


@kernel
def _balance(problem: Problem, travel: Floats, force: Floats, shared: float) -> float:
    """The λ at which the rates add up to zero: a fixed stroke. Exact, piece by linear piece."""
    # Taken out once, here: compiled, every later look into the record would count references.
    friction, ends, mobility = problem.laws.friction, problem.sheets.ends, problem.mobility
    low, high = -np.inf, np.inf
    for _ in range(200):
        total, moving = 0.0, 0.0
        for i in range(len(travel)):
            drives = _drives(
                travel[i], force[i], friction[i], ends[i, BEFORE], ends[i, BEYOND], shared
            )
            if drives != 0.0:
                total += mobility[i] * drives
                moving += mobility[i]
        if moving == 0.0 or total == 0.0:
            return shared
        if total > 0.0:
            high = shared
        else:
            low = shared
        following = shared - total / moving
        if not low < following < high:
            if not (np.isfinite(low) and np.isfinite(high)):
                return following
            following = 0.5 * (low + high)
        if following == shared or abs(total) <= 1e-15 * moving * (abs(shared) + 1e-300):
            return following
        shared = following
    return shared


@kernel
def _rates(problem: Problem, at: Point, shared: float, out: Floats) -> tuple[float, float]:
    """λ, the largest force that drives a cell, and all rates ds/dt into `out`."""
    alpha, beta, mobility = problem.alpha, problem.beta, problem.mobility
    drive, travel, force = at.drive, at.travel, at.force
    friction, ends = problem.laws.friction, problem.sheets.ends
    if beta == 0.0:
        shared = _balance(problem, travel, force, shared)
    else:
        shared = (drive - alpha * summed(travel)) / beta
    largest = 0.0
    for i in range(len(travel)):
        drives = _drives(travel[i], force[i], friction[i], ends[i, BEFORE], ends[i, BEYOND], shared)
        out[i] = mobility[i] * drives
        largest = max(largest, abs(drives))
    return shared, largest


@kernel
def _smooth_rates(problem: Problem, at: Point, travel: Floats, out: Floats) -> None:
    """Rates at `travel` of the cells that move now, in their sense, as if there were no stops.

    Within a step the field has to be smooth; stops and releases are looked at between steps.
    """
    laws, alpha, beta, mobility = problem.laws, problem.alpha, problem.beta, problem.mobility
    drive, sense, rows, ends = at.drive, at.sense, at.rows, problem.sheets.ends
    total, moving = 0.0, 0.0
    for i in range(len(travel)):
        if sense[i] != 0:
            place = min(max(travel[i], ends[i, LOW]), ends[i, HIGH])
            pick_rows(laws, i, place, rows)
            out[i] = law(laws, i, rows, place)[0] + sense[i] * laws.friction[i]
            total += mobility[i] * out[i]
            moving += mobility[i]
    if beta > 0.0:
        shared = (drive - alpha * summed(travel)) / beta
    else:
        shared = total / moving if moving > 0.0 else 0.0
    for i in range(len(travel)):
        out[i] = mobility[i] * (shared - out[i]) if sense[i] != 0 else 0.0


@kernel
def unstable_direction(slopes: Floats, mobility: Floats, alpha: float, beta: float) -> Floats:
    """The one way out of an equilibrium that has lost its stability, unit largest entry."""
    rates = mobility * slopes
    least = smallest_eigenvalue(rates, mobility, alpha, beta)
    out = np.empty(len(slopes))
    biggest = 0.0
    for i in range(len(slopes)):
        gap = rates[i] - least
        out[i] = mobility[i] / gap if gap != 0.0 else 1e300
        biggest = max(biggest, abs(out[i]))
    out /= biggest
    return out


@kernel
def _polish(
    problem: Problem, at: Point, rate: Floats, shared: float, out: Floats
) -> tuple[bool, float]:
    """Newton from a slow point of the flow to the equilibrium it creeps towards."""
    laws, alpha, beta = problem.laws, problem.alpha, problem.beta
    travel, rows, ends = at.travel, at.rows, problem.sheets.ends
    n = len(travel)
    out[:] = travel
    active = np.zeros(n, np.bool_)
    offset = np.zeros(n)
    for i in range(n):
        if laws.friction[i] == 0.0:
            active[i] = ends[i, BEFORE] < travel[i] < ends[i, BEYOND]
        elif rate[i] != 0.0:
            active[i] = True
            offset[i] = laws.friction[i] if rate[i] > 0.0 else -laws.friction[i]
    for _ in range(30):
        falling, compliance, lag, flat, flats, step = 0, beta, 0.0, -1, 0.0, 0.0
        miss = np.zeros(n)
        slopes = np.zeros(n)
        for i in range(n):
            if not active[i]:
                continue
            pick_rows(laws, i, out[i], rows)
            value, slope, _ = law(laws, i, rows, out[i])
            miss[i] = value + offset[i] - shared
            slopes[i] = slope
            if slope == 0.0:
                if flat >= 0 and abs(miss[i] - miss[flat]) > 1e-12 * abs(value):
                    return False, shared
                flat = i
                flats += problem.mobility[i]
                continue
            falling += slope < 0.0
            compliance += alpha / slope
            lag += alpha * miss[i] / slope
        if falling > 1 or (falling == 1 and (compliance >= 0.0 or flat >= 0)):
            return False, shared
        change = miss[flat] if flat >= 0 else (lag / compliance if compliance != 0.0 else 0.0)
        total = 0.0
        for i in range(n):
            if active[i] and slopes[i] != 0.0:
                move = (change - miss[i]) / slopes[i]
                out[i] += move
                total += move
                step = max(step, abs(move) / laws.full[i])
        if flat >= 0:
            if alpha == 0.0:
                return False, shared
            # Cells of constant force take what is left, by mobility.
            left = (-beta * change / alpha - total) / flats
            for i in range(n):
                if active[i] and slopes[i] == 0.0:
                    move = left * problem.mobility[i]
                    out[i] += move
                    step = max(step, abs(move) / laws.full[i])
        shared += change
        for i in range(n):
            if (
                out[i] < ends[i, LOW]
                or out[i] > ends[i, HIGH]
                or abs(out[i] - travel[i]) > 1e-3 * laws.full[i]
            ):
                return False, shared
        if step < 1e-15:
            break
    for i in range(n):
        pick_rows(laws, i, out[i], rows)
        value = law(laws, i, rows, out[i])[0]
        slack = laws.friction[i] + 1e-9 * (abs(value) + abs(shared))
        if not active[i]:
            if out[i] < ends[i, BEYOND] and shared > value + slack:
                return False, shared
            if out[i] > ends[i, BEFORE] and shared < value - slack:
                return False, shared
    return True, shared


@kernel
def _solve(problem: Problem, at: Point, h: float, b: Floats, out: Floats) -> None:
    """x of (I - h J) x = b, where J is -diag(m κ) on the moving cells, coupled by the drive.

    One multiplier couples all of them, so the solution costs no more than b itself.
    """
    sense, slope, alpha, beta = at.sense, at.slope, problem.alpha, problem.beta
    mobility = problem.mobility
    total, weight = 0.0, 0.0
    for i in range(len(b)):
        if sense[i] != 0:
            pivot = 1.0 + h * mobility[i] * slope[i]
            total += b[i] / pivot
            weight += mobility[i] / pivot
    if beta == 0.0:
        shared = -total / weight if weight != 0.0 else 0.0
    else:
        shared = -(h * alpha / beta) * total / (1.0 + (h * alpha / beta) * weight)
    for i in range(len(b)):
        pivot = 1.0 + h * mobility[i] * slope[i]
        out[i] = (b[i] + mobility[i] * shared) / pivot if sense[i] != 0 else b[i]


@kernel
def _first_stage(problem: Problem, at: Point, h: float, rates: Floats, out: Floats) -> None:
    """The first implicit stage, without the cells that it would turn round.

    A stiff actuator can start a cell off its stop, or against its friction, and call it back
    within the step; stepping through that to and fro would take for ever. Such a cell stays.
    """
    laws, travel, sense, ends = problem.laws, at.travel, at.sense, problem.sheets.ends
    for _ in range(len(travel)):
        _solve(problem, at, h, rates, out)
        stays = False
        for i in range(len(travel)):
            at_end = travel[i] == ends[i, LOW] or travel[i] == ends[i, HIGH]
            bound = laws.friction[i] > 0.0 or at_end
            if sense[i] != 0 and bound and out[i] * sense[i] < 0.0:
                sense[i] = 0
                stays = True
        if not stays:
            return
        _smooth_rates(problem, at, travel, rates)
    out[:] = 0.0


@kernel
def _turned(ends: Floats, at: Point, step: Floats) -> int:
    """A cell that a step pushes into the stop that it was to leave, or -1."""
    for i in range(len(step)):
        bound = at.travel[i] == ends[i, LOW] or at.travel[i] == ends[i, HIGH]
        if at.sense[i] != 0 and bound and step[i] * at.sense[i] < 0.0:
            return i
    return -1


@kernel
def _longest_step(problem: Problem, slope: Floats, sense: Ints, d: float, wanted: float) -> float:
    """Longest step that still resolves growth; only decay may be stepped over."""
    falling, count, mobility = 0.0, 0, problem.mobility
    for i in range(len(sense)):
        if sense[i] != 0 and slope[i] < 0.0:
            falling = max(falling, -mobility[i] * slope[i])
            count += 1
    short = 0.7 / (d * falling) if falling > 0.0 else np.inf
    if wanted <= short or count > 1:
        return short
    # One falling cell among rising ones: what grows, the least eigenvalue tells, and in the
    # narrow place next to a fold that is almost nothing.
    moving = np.flatnonzero(sense)
    weights = mobility[moving]
    growth = -smallest_eigenvalue(weights * slope[moving], weights, problem.alpha, problem.beta)
    long = 0.7 / (d * growth) if growth > 0.0 else np.inf
    # In between, the pivot of the falling cell passes through zero.
    return short if min(wanted, long) < 1.3 / (d * falling) else long


@kernel
def flow(
    problem: Problem,
    travel: Floats,
    drive: float,
    shared: float,
    accuracy: float,
    rubbed: Floats,
) -> tuple[bool, float]:
    """Follow the flow from `travel` to rest, in place; False if it did not settle.

    The linearly implicit pair of Shampine & Reichelt (1997): a snap through a narrow place has
    one slow direction and many fast ones. The last stretch is Newton's, so the landing is an
    equilibrium to rounding and the integration only decides which. `rubbed` gathers the way
    every cell went, for friction.
    """
    laws, scale = problem.laws, problem.scale
    n = len(travel)
    slots = 1
    for i in range(n):
        slots = max(slots, laws.band_first[i + 1] - laws.band_first[i] + 1)
    rows, sense = np.full(slots, -1, np.int64), np.zeros(n, np.int64)
    at = Point(drive, travel, np.empty(n), np.empty(n), sense, rows)
    started = np.zeros(n, np.int64)
    f0, f1, f2 = np.empty(n), np.empty(n), np.empty(n)
    k1, k2, k3 = np.empty(n), np.empty(n), np.empty(n)
    polished = np.empty(n)
    d = 1.0 / (2.0 + np.sqrt(2.0))
    e32 = 6.0 + np.sqrt(2.0)
    for i in range(n):
        _look(laws, at, i)
    ends, folds = problem.sheets.ends, len(problem.sheets.table) > n
    stiffest = np.max(np.abs(problem.mobility * at.slope)) + scale / np.min(laws.full)
    h = 1e-2 / stiffest
    longest = 1e6 / (stiffest * np.min(problem.mobility))
    for step in range(_STEPS):
        if overspent(problem.effort, 4 * n):
            break
        shared, largest = _rates(problem, at, shared, f0)
        if folds and _jumps(problem, at, f0):
            continue
        # The longest step moves no cell by more than rounding: this is rest, whether or not
        # Newton can say so (two cells of constant force have no single place to be).
        resting = h == longest and largest <= 1e-11 * scale
        if largest <= 1e-14 * scale or resting:
            return True, shared
        if largest < 1e-2 * scale and step % 4 == 0:
            settled, level = _polish(problem, at, f0, shared, polished)
            if settled:
                rubbed += np.abs(polished - travel)
                travel[:] = polished
                return True, level
        for i in range(n):
            sense[i] = np.sign(f0[i])
        started[:] = sense
        while True:
            h = min(h, _longest_step(problem, at.slope, started, d, h))
            sense[:] = started
            _first_stage(problem, at, h * d, f0, k1)
            _smooth_rates(problem, at, travel + 0.5 * h * k1, f1)
            _solve(problem, at, h * d, f1 - k1, k2)
            k2 += k1
            turned = _turned(ends, at, k2)
            if turned >= 0:
                # It would leave its stop and be back there within the step, which then would
                # end before it began. A shorter step lets it go; in the shortest it stays.
                if h > 1e-6 / stiffest:
                    h *= 0.25
                else:
                    started[turned] = 0
                    sense[:] = started
                    _smooth_rates(problem, at, travel, f0)
                continue
            _smooth_rates(problem, at, travel + h * k2, f2)
            lag = f2 - e32 * (k2 - f1) - 2.0 * (k1 - f0)
            _solve(problem, at, h * d, lag, k3)
            worst = 0.0
            for i in range(n):
                error = h / 6.0 * (k1[i] - 2.0 * k2[i] + k3[i])
                worst = max(worst, abs(error) / (accuracy * laws.full[i]))
                if not np.isfinite(error):
                    worst = 1e9
                    break
            if worst <= 1.0 or h <= 1e-9 / stiffest:
                break
            h *= max(0.2, 0.8 * worst ** (-1.0 / 3.0))
        # The first stop on the way ends the step: what comes after it is another field.
        share, first = 1.0, -1
        for i in range(n):
            move = h * k2[i]
            room = ends[i, HIGH] - travel[i] if move > 0.0 else travel[i] - ends[i, LOW]
            if abs(move) * share > room:
                share, first = room / abs(move), i
        for i in range(n):
            if sense[i] != 0:
                move = share * h * k2[i]
                rubbed[i] += abs(move)
                travel[i] = min(max(travel[i] + move, ends[i, LOW]), ends[i, HIGH])
                if i == first:
                    # Not by the sign of `move`: a cell that was there already moves by zero.
                    travel[i] = ends[i, HIGH] if k2[i] > 0.0 else ends[i, LOW]
                _look(laws, at, i)
        h *= min(5.0, max(0.2, 0.8 * (worst + 1e-12) ** (-1.0 / 3.0)))
        h = min(max(h, 1e-9 / stiffest), longest)
    return False, shared


@kernel
def _jumps(problem: Problem, at: Point, rates: Floats) -> bool:
    """Let cells that are pushed past the end of their sheets jump to the next; whether any does."""
    laws, sheets, ends, some = problem.laws, problem.sheets, problem.sheets.ends, False
    for i in range(len(rates)):
        out = at.travel[i] >= ends[i, HIGH] if rates[i] > 0.0 else at.travel[i] <= ends[i, LOW]
        to = beyond(sheets, i, at.travel[i]) if rates[i] != 0.0 and out else -1
        if to >= 0:
            stand_on(laws, sheets, problem.pieces, i, to - int(sheets.table[to, FIRST]))
            _look(laws, at, i)
            some = True
    return some


@kernel
def _look(laws: Laws, at: Point, i: int) -> None:
    """Force and slope of cell i where it is."""
    travel, rows, force, slope = at.travel[i], at.rows, at.force, at.slope
    pick_rows(laws, i, travel, rows)
    force[i], slope[i], _ = law(laws, i, rows, travel)
