"""Landing of a snap in which three cells or more move: integration of the overdamped flow.

Only the moving cells are integrated. All others are one window of the common force λ: while λ stays
within it they are at rest, and the cell whose limit λ passes first joins the flow.
"""

from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import leaf, overspent
from stepwell.mechanism import BEFORE, BEYOND, FIRST, HIGH, LOW, beyond, law, smallest, summed
from stepwell.statics.following import state as st
from stepwell.statics.following.branch import smallest_eigenvalue
from stepwell.statics.following.pieces import Pieces, find_piece, stand_on
from stepwell.statics.following.state import DrivenChain, State

_STEPS = 30_000
# The L-stable pair of orders 4 and 3 with four stages (Hairer and Wanner 1996, IV.7): γ; where a
# stage is looked at, what it takes of those before, what the step is made of, and its error, the
# last four in parts of γ since stages are rates here.
_GAMMA = 0.57282
_A21, _A31, _A32 = 2.0 * _GAMMA, 1.867943637803922 * _GAMMA, 0.2344449711399156 * _GAMMA
_C21, _C31 = -7.137615036412310 * _GAMMA, 2.580708087951457 * _GAMMA
_C32, _C41 = 0.6515950076447975 * _GAMMA, -2.137148994382534 * _GAMMA
_C42, _C43 = -0.3214669691237626 * _GAMMA, -0.6949742501781779 * _GAMMA
_B1, _B2 = 2.255570073418735 * _GAMMA, 0.2870493262186792 * _GAMMA
_B3, _B4 = 0.4353179431840180 * _GAMMA, 1.093502252409163 * _GAMMA
_E1, _E2 = -0.2815431932141155 * _GAMMA, -0.07276199124934920 * _GAMMA
_E3, _E4 = -0.1082196201495311 * _GAMMA, -1.093502252409163 * _GAMMA
# An event ends a step. The step is repeated this number of times at most, until the error of its
# end time moves no cell by more than this fraction of the accuracy.
_TRIES, _LATE = 40, 1e-2
# Distance to the start, as a fraction of the travel, below which no other landing is searched.
_NEAR_START = 1e-3
# Rows of a cell in the flow: its travel, F and κ there, its friction, mobility and full travel, the
# ends of its sheet and the limits of its travel ...
_TRAVEL, _FORCE, _SLOPE, _FRICTION, _MOBILITY, _FULL, _LEAST, _MOST, _BEFORE, _BEYOND = range(10)
# ... ds/dt, room for the stages of a step, what it goes in it, the error of that; travel, F, κ and
# ds/dt after the step; and the error of its travel so far ...
_RATE, _STAGE, _LAST, _X1, _X2, _X3, _X4, _WAY, _ERROR, _TRIAL = range(10, 20)
_NEXT_FORCE, _NEXT_SLOPE, _NEXT_RATE, _OFF = range(20, 24)
# ... and 1 / (1 + γ h m κ) of the step.
_PIVOT = 24
# ... and, whole numbers, which cell it is, the piece of the last evaluation, and in which sense it
# moves within a step, 0 where it stays.
_CELL, _PIECE, _SENSE = range(3)
# Values of the cells at rest: the λ between which they rest, and the sum of travels.
_LOWEST, _HIGHEST, _STILL = range(3)


class Flow(NamedTuple):
    """State of the flow; N cells of the chain, m of them in the flow."""

    drive: float
    cell: Floats  # (25, N) see above, the first m columns
    where: Ints  # (3, N) likewise
    used: Ints  # (1,) m
    still: Floats  # (3,) _LOWEST, _HIGHEST, _STILL
    first: Ints  # (2,) the cells released at the highest and at the lowest λ, or -1


@leaf
def _begin(problem: DrivenChain, state: State, drive: float) -> Flow:
    spare, mode = problem.spare, state.mode
    counts = spare.counts
    cell, where = spare.number[st.OF_FLOW :], spare.whole[st.WHOLES_OF_FLOW :]
    at = Flow(drive, cell, where, counts[:1], spare.stack[2, :3], counts[1:])
    at.used[0] = 0
    for i in range(len(mode)):
        if mode[i] != st.HELD:
            _join(problem, state, at, i)
    _close(problem, state, at)
    return at


@leaf
def _join(problem: DrivenChain, state: State, at: Flow, i: int) -> None:
    j = at.used[0]
    at.used[0] += 1
    if state.mode[i] == st.HELD:
        state.mode[i] = st.LETS_GO
    cell, laws = at.cell, problem.laws
    cell[:, j], at.where[:, j] = 0.0, 0
    at.where[_CELL, j], cell[_TRAVEL, j] = i, state.travel[i]
    cell[_FRICTION, j], cell[_MOBILITY, j] = laws.friction[i], problem.mobility[i]
    cell[_FULL, j] = laws.full[i]
    _stand(problem, at, j)


@leaf
def _stand(problem: DrivenChain, at: Flow, j: int) -> None:
    i, cell, ends = at.where[_CELL, j], at.cell, problem.sheets.ends
    cell[_LEAST, j], cell[_MOST, j] = ends[i, LOW], ends[i, HIGH]
    cell[_BEFORE, j], cell[_BEYOND, j] = ends[i, BEFORE], ends[i, BEYOND]
    at.where[_PIECE, j] = find_piece(problem.pieces, i, cell[_TRAVEL, j], 0)
    cell[_FORCE, j], cell[_SLOPE, j] = _law_at(problem, at, j, cell[_TRAVEL, j])


@leaf
def _law_at(problem: DrivenChain, at: Flow, j: int, travel: float) -> tuple[float, float]:
    """F and κ of a cell in the flow at a travel."""
    pieces, where = problem.pieces, at.where
    piece = where[_PIECE, j] = _piece_near(pieces, where[_PIECE, j], travel)
    force, slope, _ = law(problem.laws, where[_CELL, j], pieces.picked[piece], travel)
    return force, slope


@leaf
def _close(problem: DrivenChain, state: State, at: Flow) -> None:
    """Set the window of λ within which the cells that are not in the flow rest."""
    friction, ends = problem.laws.friction, problem.sheets.ends
    travel, mode, at_rest = state.travel, state.mode, state.at_rest
    low, high, falls, rises, still = -np.inf, np.inf, -1, -1, 0.0
    for i in range(len(travel)):
        if mode[i] != st.HELD:
            continue
        still += travel[i]
        if travel[i] > ends[i, BEFORE] and at_rest[i] - friction[i] > low:
            low, falls = at_rest[i] - friction[i], i
        if travel[i] < ends[i, BEYOND] and at_rest[i] + friction[i] < high:
            high, rises = at_rest[i] + friction[i], i
    at.still[_LOWEST], at.still[_HIGHEST], at.still[_STILL] = low, high, still
    at.first[0], at.first[1] = rises, falls


@leaf
def _drives(cell: Floats, j: int, shared: float) -> float:
    """Driving force of a cell at λ [N]; zero if stops or Coulomb friction hold it."""
    force, friction = cell[_FORCE, j], cell[_FRICTION, j]
    if shared > force + friction and cell[_TRAVEL, j] < cell[_BEYOND, j]:
        return float(shared - force - friction)
    if shared < force - friction and cell[_TRAVEL, j] > cell[_BEFORE, j]:
        return float(shared - force + friction)
    return 0.0


@leaf
def _balance(cell: Floats, m: int, shared: float) -> float:
    """The λ at which the sum of the rates is zero (fixed stroke); exact, piecewise linear."""
    low, high = -np.inf, np.inf
    for _ in range(200):
        total, moving = 0.0, 0.0
        for j in range(m):
            drives = _drives(cell, j, shared)
            if drives != 0.0:
                total += cell[_MOBILITY, j] * drives
                moving += cell[_MOBILITY, j]
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


@leaf
def _stroke(cell: Floats, m: int, travel: int, still: float) -> float:
    """Σ s with the travels of one row for the cells in the flow."""
    total = 0.0
    for j in range(m):
        total += cell[travel, j]
    # Long chains: the sum of the resting cells is added last, or its rounding would affect each of
    # the others.
    return total + still


@leaf
def _rates(cell: Floats, m: int, shared: float) -> float:
    """All rates ds/dt at λ; the largest force that drives a cell."""
    largest = 0.0
    for j in range(m):
        drives = _drives(cell, j, shared)
        cell[_RATE, j] = cell[_MOBILITY, j] * drives
        largest = max(largest, abs(drives))
    return largest


@leaf
def _piece_near(pieces: Pieces, piece: int, travel: float) -> int:
    """The piece of the same cell that contains a travel, from a near piece."""
    while travel > pieces.right[piece]:
        piece += 1
    while travel < pieces.left[piece]:
        piece -= 1
    return piece


@leaf
def unstable_direction(
    slopes: Floats, mobility: Floats, alpha: float, beta: float, leader: int, out: Floats
) -> None:
    """The direction out of an equilibrium that has become unstable, largest entry 1, into `out`."""
    # Of several with the least rate κ m, `leader` moves one way and the rest the other way.
    rates, count = slopes, len(slopes)
    for i in range(count):
        rates[i] *= mobility[i]
    least = smallest_eigenvalue(rates, mobility, alpha, beta)
    biggest, alike, first = 0.0, 0, -1
    for i in range(count):
        gap = rates[i] - least
        out[i] = mobility[i] / gap if gap != 0.0 else 1e300
        biggest = max(biggest, abs(out[i]))
        if abs(gap) <= 1e-9 * abs(least):
            alike += 1
            first = i if first < 0 or i == leader else first
    for i in range(count):
        if alike > 1:
            same = abs(rates[i] - least) <= 1e-9 * abs(least)
            out[i] = 1.0 if i == first else (-1.0 / (alike - 1) if same else 0.0)
        else:
            out[i] /= biggest


@leaf
def _smooth_rates(
    actuator: tuple[float, float, float, float], cell: Floats, where: Ints, m: int, row: int
) -> float:
    """Rates at the travels of `_TRIAL` into `row`, which holds the forces there; λ."""
    # Without stops: a step needs a smooth field. `actuator` is α, β, drive and Σ s of all others.
    alpha, beta, drive, still = actuator
    for j in range(m):
        cell[row, j] += where[_SENSE, j] * cell[_FRICTION, j]
    total, moving = 0.0, 0.0
    if beta == 0.0:
        for j in range(m):
            if where[_SENSE, j] != 0:
                total += cell[_MOBILITY, j] * cell[row, j]
                moving += cell[_MOBILITY, j]
        shared = total / moving if moving > 0.0 else 0.0
    else:
        shared = (drive - alpha * _stroke(cell, m, _TRIAL, still)) / beta
    for j in range(m):
        moves = where[_SENSE, j] != 0
        cell[row, j] = cell[_MOBILITY, j] * (shared - cell[row, j]) if moves else 0.0
    return float(shared)


@leaf
def _solve(
    alpha: float, beta: float, cell: Floats, where: Ints, m: int, h: float, row: int, out: int
) -> None:
    """x of (I - h J) x = `row`, J being -diag(m κ) coupled by the drive through one multiplier."""
    total, weight = 0.0, 0.0
    for j in range(m):
        total += cell[row, j] * cell[_PIVOT, j]
        weight += cell[_MOBILITY, j] * cell[_PIVOT, j]
    if beta == 0.0:
        shared = -total / weight if weight != 0.0 else 0.0
    else:
        shared = -(h * alpha / beta) * total / (1.0 + (h * alpha / beta) * weight)
    for j in range(m):
        moved = (cell[row, j] + cell[_MOBILITY, j] * shared) * cell[_PIVOT, j]
        cell[out, j] = moved if where[_SENSE, j] != 0 else cell[row, j]


@leaf
def _forces(problem: DrivenChain, at: Flow, row: int) -> None:
    """Forces of the cells that move, at the travels of `_TRIAL`, into `row`."""
    cell, where = at.cell, at.where
    for j in range(at.used[0]):
        cell[row, j] = 0.0
        if where[_SENSE, j] != 0:
            place = min(max(cell[_TRIAL, j], cell[_LEAST, j]), cell[_MOST, j])
            cell[row, j], _ = _law_at(problem, at, j, place)


@leaf
def _step(problem: DrivenChain, at: Flow, h: float) -> None:
    """What a step of time h goes into `_WAY`, and its error into `_ERROR` [m]."""
    alpha, beta, cell, where, m = problem.alpha, problem.beta, at.cell, at.where, at.used[0]
    actuator = (alpha, beta, at.drive, at.still[_STILL])
    for j in range(m):
        pivot = 1.0 + _GAMMA * h * cell[_MOBILITY, j] * cell[_SLOPE, j]
        cell[_PIVOT, j] = 1.0 / pivot if where[_SENSE, j] != 0 else 0.0
    _solve(alpha, beta, cell, where, m, _GAMMA * h, _RATE, _X1)
    for j in range(m):
        cell[_TRIAL, j] = cell[_TRAVEL, j] + h * _A21 * cell[_X1, j]
    _forces(problem, at, _STAGE)
    _smooth_rates(actuator, cell, where, m, _STAGE)
    for j in range(m):
        cell[_STAGE, j] += _C21 * cell[_X1, j]
    _solve(alpha, beta, cell, where, m, _GAMMA * h, _STAGE, _X2)
    for j in range(m):
        cell[_TRIAL, j] = cell[_TRAVEL, j] + h * (_A31 * cell[_X1, j] + _A32 * cell[_X2, j])
    _forces(problem, at, _LAST)
    _smooth_rates(actuator, cell, where, m, _LAST)
    for j in range(m):
        x1, x2 = cell[_X1, j], cell[_X2, j]
        cell[_STAGE, j] = cell[_LAST, j] + _C31 * x1 + _C32 * x2
    _solve(alpha, beta, cell, where, m, _GAMMA * h, _STAGE, _X3)
    for j in range(m):
        x1, x2, x3 = cell[_X1, j], cell[_X2, j], cell[_X3, j]
        cell[_STAGE, j] = cell[_LAST, j] + _C41 * x1 + _C42 * x2 + _C43 * x3
    _solve(alpha, beta, cell, where, m, _GAMMA * h, _STAGE, _X4)
    for j in range(m):
        x1, x2, x3, x4 = cell[_X1, j], cell[_X2, j], cell[_X3, j], cell[_X4, j]
        cell[_WAY, j] = h * (_B1 * x1 + _B2 * x2 + _B3 * x3 + _B4 * x4)
        cell[_ERROR, j] = h * (_E1 * x1 + _E2 * x2 + _E3 * x3 + _E4 * x4)


@leaf
def _longest_step(
    alpha: float, beta: float, cell: Floats, where: Ints, m: int, wanted: float
) -> float:
    """Longest step that still resolves growth; only decay may be stepped over."""
    falling, moving = 0.0, 0
    for j in range(m):
        if where[_SENSE, j] != 0:
            moving += 1
            falling = max(falling, -cell[_MOBILITY, j] * cell[_SLOPE, j])
    if wanted * _GAMMA * falling <= 0.7:
        return wanted
    # The least eigenvalue decides growth, and next to a fold it is almost zero.
    weights, slopes = cell[_X1, :moving], cell[_X2, :moving]
    k = 0
    for j in range(m):
        if where[_SENSE, j] != 0:
            weights[k], slopes[k] = cell[_MOBILITY, j], cell[_MOBILITY, j] * cell[_SLOPE, j]
            k += 1
    growth = -smallest_eigenvalue(slopes, weights, alpha, beta)
    long = min(wanted, 0.7 / (_GAMMA * growth)) if growth > 0.0 else wanted
    # Where the pivot of a falling cell passes through zero the solution has no digits.
    k = 0
    while k < moving:
        if 0.7 < -long * _GAMMA * slopes[k] < 1.3:
            long = -0.69 / (_GAMMA * slopes[k])
            k = 0
        else:
            k += 1
    return long


@leaf
def _stiffest(cell: Floats, m: int, least: float) -> float:
    """The largest rate of decay or growth in the flow, and at least some."""
    rate = 0.0
    for j in range(m):
        rate = max(rate, abs(cell[_MOBILITY, j] * cell[_SLOPE, j]))
    return rate + least


@leaf
def _worst(cell: Floats, m: int) -> float:
    """The largest error of a step as a fraction of the full travel."""
    worst = 0.0
    for j in range(m):
        worst = max(worst, abs(cell[_ERROR, j]) / cell[_FULL, j])
        if not np.isfinite(cell[_ERROR, j]):
            return 1e9
    return worst


@leaf
def _look_ahead(problem: DrivenChain, at: Flow) -> float:
    """Forces, slopes and rates where the last step ends, into the rows of the next; λ."""
    cell, where, m = at.cell, at.where, at.used[0]
    for j in range(m):
        cell[_NEXT_FORCE, j], cell[_NEXT_SLOPE, j] = cell[_FORCE, j], cell[_SLOPE, j]
        cell[_TRIAL, j] = cell[_TRAVEL, j]
        if where[_SENSE, j] != 0:
            cell[_TRIAL, j] += cell[_WAY, j]
            place = min(max(cell[_TRIAL, j], cell[_LEAST, j]), cell[_MOST, j])
            cell[_NEXT_FORCE, j], cell[_NEXT_SLOPE, j] = _law_at(problem, at, j, place)
        cell[_NEXT_RATE, j] = cell[_NEXT_FORCE, j]
    actuator = (problem.alpha, problem.beta, at.drive, at.still[_STILL])
    return _smooth_rates(actuator, cell, where, m, _NEXT_RATE)


@leaf
def _change_of_force(problem: DrivenChain, at: Flow, rate: int, slope: int) -> float:
    """dλ/dt where cells have the rates and slopes of these rows [N/s]."""
    cell, where, total, moving = at.cell, at.where, 0.0, 0.0
    for j in range(at.used[0]):
        if where[_SENSE, j] != 0:
            if problem.beta == 0.0:
                total += cell[_MOBILITY, j] * cell[slope, j] * cell[rate, j]
                moving += cell[_MOBILITY, j]
            else:
                total -= problem.alpha / problem.beta * cell[rate, j]
    return total / moving if moving > 0.0 else total


@leaf
def _first_root(begins: float, slope_0: float, ends: float, slope_1: float) -> float:
    """First zero in 0..1 of the cubic with these ends and slopes; 2 if there is none."""
    steep = 6.0 * max(abs(begins), abs(ends))
    if abs(slope_0) > steep or abs(slope_1) > steep:
        slope_0 = slope_1 = ends - begins
    if min(begins, begins + slope_0 / 3.0, ends - slope_1 / 3.0, ends) >= 0.0:
        # A cubic lies among these four (Bézier).
        return 2.0
    square = 3.0 * (ends - begins) - 2.0 * slope_0 - slope_1
    cube = slope_0 + slope_1 - 2.0 * (ends - begins)
    # Between its turns it is monotone.
    one, two = 1.0, 1.0
    inside = square * square - 3.0 * cube * slope_0
    if inside > 0.0:
        half = -(square + np.sqrt(inside)) if square > 0.0 else -square + np.sqrt(inside)
        turn = half / (3.0 * cube) if cube != 0.0 else 2.0
        other = slope_0 / half if half != 0.0 else 2.0
        one, two = min(turn, other), max(turn, other)
    early = 0.0
    for late in (one, two, 1.0):
        if not 0.0 < late <= 1.0:
            continue
        if begins + late * (slope_0 + late * (square + late * cube)) < 0.0:
            for _ in range(60):
                middle = 0.5 * (early + late)
                if begins + middle * (slope_0 + middle * (square + middle * cube)) < 0.0:
                    late = middle
                else:
                    early = middle
            return late
        early = late
    return 2.0


@leaf
def _meets_stop(cell: Floats, where: Ints, m: int, h: float) -> tuple[int, float, float]:
    """The cell first at an end of its sheet about when the last step ends, or -1; how long ago."""
    # Negative if soon after; and the error of going back along the rates as a fraction of travel.
    first, ago, bend = -1, -0.01 * h, 0.0
    for j in range(m):
        rate = cell[_NEXT_RATE, j]
        if where[_SENSE, j] == 0 or rate == 0.0:
            continue
        end = cell[_MOST, j] if rate > 0.0 else cell[_LEAST, j]
        since = (cell[_TRIAL, j] - end) / rate
        # A cell that leaves its stop does not arrive there.
        if since > ago and (since >= 0.0 or cell[_TRAVEL, j] != end):
            first, ago = j, since
    if first >= 0:
        for j in range(m):
            change = abs(cell[_NEXT_RATE, j] - cell[_RATE, j])
            bend = max(bend, change * abs(ago) / cell[_FULL, j])
    return first, ago, bend


# One kernel for speed: its steps share what each would get again as arguments.
@leaf
def _passed(
    problem: DrivenChain, at: Flow, h: float, levels: tuple[float, float], late: float, most: float
) -> tuple[float, int]:
    """Length of the last step that ends with its first event, or h; the cell, or -1."""
    # Events are ends of sheets, cells that start and cells that halt. A step may end after one
    # where that is at most `late` of a travel and no force above `most`; `levels` are λ at its
    # begin and end.
    # One function: every event narrows the same bracket, a handful of locals.
    cell, where, m = at.cell, at.where, at.used[0]
    level, following = levels
    change_0 = h * _change_of_force(problem, at, _RATE, _SLOPE)
    change_1 = h * _change_of_force(problem, at, _NEXT_RATE, _NEXT_SLOPE)
    short, who, stop = h, -1, 2.0
    for j in range(m):
        if where[_SENSE, j] == 0:
            continue
        for sign in (1.0, -1.0):
            end = cell[_MOST, j] if sign > 0.0 else cell[_LEAST, j]
            begins, ends = sign * (end - cell[_TRAVEL, j]), sign * (end - cell[_TRIAL, j])
            pace_0, pace_1 = -sign * h * cell[_RATE, j], -sign * h * cell[_NEXT_RATE, j]
            if begins == 0.0 and pace_0 < 0.0:
                continue
            root = _first_root(begins, pace_0, ends, pace_1)
            if root < stop:
                stop = root
                if root < 1.0:
                    short, who = root * h, j
    if who >= 0:
        first, ago, bend = _meets_stop(cell, where, m, h)
        if first >= 0 and ago >= 0.0 and bend <= late:
            short, who = h, -1
    for mark in range(2 * m + 2):
        j, sign = mark // 2 - 1, 1.0 if mark % 2 == 0 else -1.0
        if j < 0:
            # The window of the cells at rest.
            limit = at.still[_HIGHEST] if sign > 0.0 else at.still[_LOWEST]
            called = at.first[mark]
            if called < 0:
                continue
            begins, ends = sign * (limit - level), sign * (limit - following)
            slope_0, slope_1 = -sign * change_0, -sign * change_1
            mobility, full = problem.mobility[called], problem.laws.full[called]
        elif where[_SENSE, j] != 0:
            # A cell that slides this way; without friction it may go either way.
            if cell[_FRICTION, j] == 0.0 or where[_SENSE, j] != sign:
                continue
            mobility, full = cell[_MOBILITY, j], cell[_FULL, j]
            begins, ends = sign * cell[_RATE, j] / mobility, sign * cell[_NEXT_RATE, j] / mobility
            slope_0 = sign * (change_0 - h * cell[_SLOPE, j] * cell[_RATE, j])
            slope_1 = sign * (change_1 - h * cell[_NEXT_SLOPE, j] * cell[_NEXT_RATE, j])
        else:
            if cell[_TRAVEL, j] == (cell[_BEYOND, j] if sign > 0.0 else cell[_BEFORE, j]):
                continue
            mobility, full = cell[_MOBILITY, j], cell[_FULL, j]
            limit = sign * cell[_FORCE, j] + cell[_FRICTION, j]
            begins, ends = limit - sign * level, limit - sign * following
            slope_0, slope_1 = -sign * change_0, -sign * change_1
        root = _first_root(max(begins, 0.0), slope_0, ends, slope_1)
        if root >= min(stop, 1.0):
            continue
        # If λ only dips past a limit within the step, the depth bounds the error.
        deep = max(-ends, 0.25 * (1.0 - root) * min(max(begins, 0.0), abs(slope_0)))
        after = (1.0 - root) * h
        if 0.5 * mobility * deep * after > late * full or deep > most:
            steep = (max(begins, 0.0) + deep) / h
            allowed = min(np.sqrt(0.5 * late * full / (mobility * steep)), 0.5 * most / steep)
            until = root * h + min(allowed, 0.5 * after)
            if until < short:
                short, who = until, j
    return short, who


@leaf
def _carry_error(problem: DrivenChain, at: Flow, h: float, stopped: int) -> float:
    """Take the error of the travels through a linearised step, adding its own; the largest [m]."""
    # A shift in time along the same way is no error: it is removed along the rates.
    alpha, beta, cell, where, m = problem.alpha, problem.beta, at.cell, at.where, at.used[0]
    total, moving, frozen, follows = 0.0, 0.0, 0.0, 0.0
    for j in range(m):
        if where[_SENSE, j] == 0:
            frozen += cell[_OFF, j]
            continue
        total += cell[_MOBILITY, j] * cell[_SLOPE, j] * cell[_OFF, j]
        moving += cell[_MOBILITY, j]
        follows += cell[_OFF, j]
    explicit = (1.0 - _GAMMA) * h
    level = total / moving if moving > 0.0 else 0.0
    held = 0.0
    if beta > 0.0:
        level, held = -alpha / beta * (follows + frozen), -alpha / beta * frozen
    for j in range(m):
        off, mobility = cell[_OFF, j], cell[_MOBILITY, j]
        moves = explicit * (level - cell[_SLOPE, j] * off) + _GAMMA * h * held
        cell[_X1, j] = off + mobility * moves if where[_SENSE, j] != 0 else 0.0
    _solve(alpha, beta, cell, where, m, _GAMMA * h, _X1, _X2)
    along, size = 0.0, 0.0
    for j in range(m):
        if where[_SENSE, j] != 0:
            cell[_OFF, j] = cell[_X2, j] + cell[_ERROR, j]
            along += cell[_OFF, j] * cell[_NEXT_RATE, j]
            size += cell[_NEXT_RATE, j] ** 2
    if stopped >= 0:
        along, size = cell[_OFF, stopped], cell[_NEXT_RATE, stopped]
    worst = 0.0
    for j in range(m):
        if where[_SENSE, j] != 0 and size != 0.0:
            cell[_OFF, j] -= along / size * cell[_NEXT_RATE, j]
        worst = max(worst, abs(cell[_OFF, j]))
    return worst


@leaf
def _has_left(state: State, at: Flow) -> bool:
    """Whether the flow has left the lost equilibrium, where all rates are small."""
    for j in range(at.used[0]):
        way = at.cell[_TRAVEL, j] - state.travel[at.where[_CELL, j]]
        if abs(way) > _NEAR_START * at.cell[_FULL, j]:
            return True
    return False


@leaf
def _barrier(problem: DrivenChain, at: Flow) -> float:
    """Largest resistance to a straight continuation of the last step [N]; inf at a stop."""
    pieces, cell, where, m = problem.pieces, at.cell, at.where, at.used[0]
    size, total, weight, room = 0.0, 0.0, 0.0, np.inf
    for j in range(m):
        if where[_SENSE, j] == 0:
            cell[_WAY, j] = 0.0
        size = max(size, abs(cell[_WAY, j]))
    if size == 0.0:
        return np.inf
    for j in range(m):
        cell[_WAY, j] /= size
        rate, travel = cell[_WAY, j], cell[_TRAVEL, j]
        total += rate
        weight += abs(rate)
        if abs(rate) > 1e-9:
            end = cell[_MOST, j] if rate > 0.0 else cell[_LEAST, j]
            room = min(room, (end - travel) / rate)
        picked = pieces.picked[_piece_near(pieces, where[_PIECE, j], travel)]
        cell[_NEXT_FORCE, j], _, _ = law(problem.laws, where[_CELL, j], picked, travel)
    spring = problem.alpha / problem.beta * total * total if problem.beta > 0.0 else 0.0
    way, most = 1e-4 * room, 0.0
    while way < room:
        resists = spring * way
        for j in range(m):
            travel = cell[_TRAVEL, j] + way * cell[_WAY, j]
            travel = min(max(travel, cell[_LEAST, j]), cell[_MOST, j])
            picked = pieces.picked[_piece_near(pieces, where[_PIECE, j], travel)]
            force, _, _ = law(problem.laws, where[_CELL, j], picked, travel)
            resists += cell[_WAY, j] * (force - cell[_NEXT_FORCE, j])
        if resists < 0.0:
            return most / weight
        most = max(most, resists)
        way *= 1.2
    return np.inf


# One kernel for speed: its steps share what each would get again as arguments.
@leaf
def _polish(problem: DrivenChain, at: Flow, shared: float) -> tuple[bool, float]:
    """Newton from a slow point of the flow to the equilibrium that it approaches, in `_TRIAL`."""
    # One function: an iteration works on eight rows of the flow, taken out once.
    laws, pieces, alpha, beta = problem.laws, problem.pieces, problem.alpha, problem.beta
    picked, cell, where, m = pieces.picked, at.cell, at.where, at.used[0]
    # The movable cells, the friction in addition to their force, their error of λ and their κ.
    active, offset, miss, slopes = cell[_X1], cell[_X2], cell[_X3], cell[_X4]
    out, travel, full = cell[_TRIAL], cell[_TRAVEL], cell[_FULL]
    for j in range(m):
        friction, rate = cell[_FRICTION, j], cell[_RATE, j]
        out[j], offset[j] = travel[j], friction * np.sign(rate)
        inside = cell[_BEFORE, j] < travel[j] < cell[_BEYOND, j]
        active[j] = 1.0 if (inside if friction == 0.0 else rate != 0.0) else 0.0
    last = np.inf
    for _ in range(30):
        falling, compliance, lag, flat, flats, step = 0, beta, 0.0, -1, 0.0, 0.0
        for j in range(m):
            if active[j] == 0.0:
                continue
            piece = _piece_near(pieces, where[_PIECE, j], out[j])
            value, slope, _ = law(laws, where[_CELL, j], picked[piece], out[j])
            miss[j], slopes[j] = value + offset[j] - shared, slope
            if slope == 0.0:
                if flat >= 0 and abs(miss[j] - miss[flat]) > 1e-12 * abs(value):
                    return False, shared
                flat = j
                flats += cell[_MOBILITY, j]
                continue
            falling += slope < 0.0
            compliance += alpha / slope
            lag += alpha * miss[j] / slope
        if falling > 1 or (falling == 1 and (compliance >= 0.0 or flat >= 0)):
            return False, shared
        change = miss[flat] if flat >= 0 else (lag / compliance if compliance != 0.0 else 0.0)
        total = 0.0
        for j in range(m):
            if active[j] != 0.0 and slopes[j] != 0.0:
                move = (change - miss[j]) / slopes[j]
                out[j] += move
                total += move
                step = max(step, abs(move) / full[j])
        if flat >= 0:
            if alpha == 0.0:
                return False, shared
            # Cells of constant force take the rest, by mobility.
            rest = (-beta * change / alpha - total) / flats
            for j in range(m):
                if active[j] != 0.0 and slopes[j] == 0.0:
                    move = rest * cell[_MOBILITY, j]
                    out[j] += move
                    step = max(step, abs(move) / full[j])
        shared += change
        for j in range(m):
            inside = cell[_LEAST, j] <= out[j] <= cell[_MOST, j]
            if not inside or abs(out[j] - travel[j]) > 1e-3 * full[j]:
                return False, shared
        # Without further contraction it has converged, to rounding, or diverges.
        if step < 1e-15 or (step >= last and step < 1e-12):
            break
        if step >= last:
            return False, shared
        last = step
    for j in range(m):
        if active[j] != 0.0:
            continue
        piece = _piece_near(pieces, where[_PIECE, j], out[j])
        value = law(laws, where[_CELL, j], picked[piece], out[j])[0]
        slack = cell[_FRICTION, j] + 1e-9 * (abs(value) + abs(shared))
        if out[j] < cell[_BEYOND, j] and shared > value + slack:
            return False, shared
        if out[j] > cell[_BEFORE, j] and shared < value - slack:
            return False, shared
    low, high = at.still[_LOWEST], at.still[_HIGHEST]
    if shared < low - 1e-9 * (abs(low) + abs(shared)):
        return False, shared
    return bool(shared <= high + 1e-9 * (abs(high) + abs(shared))), shared


@leaf
def _set_senses(at: Flow, shared: float) -> None:
    """Sense in which every cell moves; without friction, between its stops, it is free."""
    cell, where = at.cell, at.where
    for j in range(at.used[0]):
        where[_SENSE, j] = np.sign(_drives(cell, j, shared))
        inside = cell[_BEFORE, j] < cell[_TRAVEL, j] < cell[_BEYOND, j]
        if where[_SENSE, j] == 0 and cell[_FRICTION, j] == 0.0 and inside:
            where[_SENSE, j] = 1


# One kernel for speed: its steps share what each would get again as arguments.
@leaf
def flow(
    problem: DrivenChain, state: State, drive: float, shared: float, accuracy: float, rubbed: Floats
) -> tuple[bool, float, bool]:
    """Integrate the flow to rest, travels in place: whether it settled, λ, and whether by a tie."""
    # A linearly implicit pair of orders 4 and 3, for one slow direction among many fast ones; each
    # event ends a step. The last stretch is Newton's, so the integration only decides which
    # equilibrium it is. `rubbed` (N,) gathers the way of every cell.
    # One function: a step changes some fifteen locals of the integrator.
    laws, scale, effort = problem.laws, problem.scale, problem.effort
    alpha, beta = problem.alpha, problem.beta
    at, slowest = _begin(problem, state, drive), smallest(problem.mobility)
    cell, where, used, still = at.cell, at.where, at.used, at.still
    folds = len(problem.sheets.table) > len(state.travel)
    gentle, late = scale / smallest(laws.full), _LATE * accuracy
    # Behind a spring λ is the difference of two travels: rounding of these is a force.
    nothing = 1e-15 * (abs(drive) + alpha * summed(laws.full)) / beta if beta > 0.0 else 0.0
    nothing = min(max(nothing, 1e-11 * scale), st.TIE * scale)
    stiffest = _stiffest(cell, used[0], gentle)
    wanted, settled, off, stopped = 1e-2 / stiffest, False, 0.0, 0
    # The largest force that drives a cell, the most it was, whether it falls; the stiffest cell.
    before, peak, slows, steepest, close = np.inf, 0.0, False, 0.0, False
    left, level = False, shared
    for step in range(_STEPS):
        m = used[0]
        if overspent(effort, m):
            break
        while True:
            if beta == 0.0:
                shared = _balance(cell, m, shared)
            else:
                shared = (drive - alpha * _stroke(cell, m, _TRAVEL, still[_STILL])) / beta
            calls = 1 if shared < still[_LOWEST] else (0 if shared > still[_HIGHEST] else -1)
            if calls < 0 or at.first[calls] < 0:
                break
            _join(problem, state, at, at.first[calls])
            _close(problem, state, at)
            m, stiffest = used[0], _stiffest(cell, used[0], gentle)
        largest = _rates(cell, m, shared)
        if folds and _jumps(problem, at):
            continue
        longest, looks = 1e6 / (stiffest * slowest), largest < 1e-2 * scale and step % 2 == 0
        # Before it has left, rest would be the lost equilibrium.
        left = left or (looks and _has_left(state, at))
        gone = left or wanted >= longest or peak > 1e3 * nothing
        # Nothing moves but for rounding: this is rest, whether or not Newton can say so (two cells
        # of constant force have no single place to be, and alike cells meet at a saddle).
        settled = largest <= 1e-14 * scale or (gone and largest <= nothing)
        if looks and left and not settled:
            settled, level = _polish(problem, at, shared)
            if settled:
                shared = level
                for j in range(m):
                    rubbed[where[_CELL, j]] += abs(cell[_TRIAL, j] - cell[_TRAVEL, j])
                    cell[_TRAVEL, j] = cell[_TRIAL, j]
        if settled:
            break
        _set_senses(at, shared)
        if largest > before and slows:
            # The minimum of the driving force: with this much less it would have come to rest.
            left = left or _has_left(state, at)
            if before < 0.5 * peak and left:
                st.set_near(state.near, before, steepest)
                close = close or before <= max(2.0 * steepest * off, st.TIE * scale)
            slows = False
        elif largest < before:
            steepest, slows = 0.0, True
            for j in range(m):
                if where[_SENSE, j] != 0:
                    steepest = max(steepest, abs(cell[_SLOPE, j]))
        before, peak = largest, max(peak, largest)
        h, cut, stopped, worst = wanted, False, -1, 1.0
        for _ in range(_TRIES):
            for j in range(m):
                cell[_TRIAL, j], cell[_RATE, j] = cell[_TRAVEL, j], cell[_FORCE, j]
            level = _smooth_rates((alpha, beta, drive, still[_STILL]), cell, where, m, _RATE)
            h = min(h, _longest_step(alpha, beta, cell, where, m, h))
            if overspent(effort, 3 * m):
                break
            _step(problem, at, h)
            worst = _worst(cell, m) / accuracy
            if worst > 1.0 and h > 1e-9 / stiffest:
                h *= max(0.2, 0.8 * worst**-0.25)
                wanted = h
                continue
            following = _look_ahead(problem, at)
            short, who = _passed(problem, at, h, (level, following), late, 0.02 * largest)
            if short >= h:
                break
            cut = True
            if short > 1e-9 / stiffest:
                h = short
            elif who >= 0:
                # A stiff actuator, or rounding, can start a cell and call it back before a step
                # can end: it stays. One that is at its stop but for rounding is there.
                for end in (cell[_LEAST, who], cell[_MOST, who]):
                    if abs(cell[_TRAVEL, who] - end) <= 1e-10 * cell[_FULL, who]:
                        cell[_TRAVEL, who] = end
                where[_SENSE, who], h, cut = 0, wanted, False
            else:
                break
        first, ago, bend = _meets_stop(cell, where, m, h)
        if first >= 0 and (ago >= 0.0 or bend <= late):
            stopped = first
        off = _carry_error(problem, at, h, stopped)
        for j in range(m):
            if where[_SENSE, j] == 0:
                continue
            place = cell[_TRIAL, j]
            if stopped >= 0:
                place -= ago * cell[_NEXT_RATE, j]
                if j == stopped:
                    place = cell[_MOST, j] if cell[_NEXT_RATE, j] > 0.0 else cell[_LEAST, j]
            place = min(max(place, cell[_LEAST, j]), cell[_MOST, j])
            rubbed[where[_CELL, j]] += abs(place - cell[_TRAVEL, j])
            cell[_TRAVEL, j] = place
            cell[_FORCE, j], cell[_SLOPE, j] = cell[_NEXT_FORCE, j], cell[_NEXT_SLOPE, j]
        if stopped >= 0:
            for j in range(m):
                cell[_FORCE, j], cell[_SLOPE, j] = _law_at(problem, at, j, cell[_TRAVEL, j])
        longer = h * min(5.0, max(0.2, 0.8 * (worst + 1e-12) ** -0.25))
        wanted = max(wanted, longer) if cut else longer
        wanted = min(max(wanted, 1e-9 / stiffest), longest)
    if settled and stopped < 0:
        barrier = _barrier(problem, at)
        st.set_near(state.near, barrier, steepest)
        close = close or barrier <= max(2.0 * steepest * off, st.TIE * scale)
    # Steps are linearised, so twice the sum is the bound.
    state.near[2] = max(state.near[2], 2.0 * off)
    for j in range(used[0]):
        state.travel[where[_CELL, j]] = cell[_TRAVEL, j]
    return settled, shared, close


@leaf
def _jumps(problem: DrivenChain, at: Flow) -> bool:
    """Move cells that are pushed past the end of their sheets to the next; whether any jumps."""
    sheets, cell, some = problem.sheets, at.cell, False
    for j in range(at.used[0]):
        i, rate, travel = at.where[_CELL, j], cell[_RATE, j], cell[_TRAVEL, j]
        out = travel >= cell[_MOST, j] if rate > 0.0 else travel <= cell[_LEAST, j]
        to = beyond(sheets, i, travel) if rate != 0.0 and out else -1
        if to >= 0:
            stand_on(problem.laws, sheets, problem.pieces, i, to - int(sheets.table[to, FIRST]))
            _stand(problem, at, j)
            some = True
    return some
