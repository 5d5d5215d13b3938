"""Where a snap lands when three cells or more move: overdamped flow, integrated.

Only the cells that move are integrated. All others are one window of the common force λ: while λ
stays within it they keep still, and the first whose side of it λ passes joins the flow.
"""

from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import kernel, leaf, overspent
from stepwell.mechanism import BEFORE, BEYOND, FIRST, HIGH, LOW, beyond, law
from stepwell.statics.following.branch import smallest_eigenvalue
from stepwell.statics.following.pieces import Pieces, find_piece, stand_on
from stepwell.statics.following.state import HELD, LETS_GO, Problem, State

_STEPS = 30_000
# The L-stable pair of orders 4 and 3 with four stages (Hairer and Wanner 1996, IV.7): γ; where a
# stage is looked at, what it takes of those before, what the step is made of, and its error, the
# last four in parts of γ since stages are rates here.
_GAMMA = 0.57282
_A21, _A31, _A32 = 2.0 * _GAMMA, 1.867943637803922 * _GAMMA, 0.2344449711399156 * _GAMMA
_C21, _C31, _C32 = (
    -7.137615036412310 * _GAMMA,
    2.580708087951457 * _GAMMA,
    0.6515950076447975 * _GAMMA,
)
_C41, _C42, _C43 = (
    -2.137148994382534 * _GAMMA,
    -0.3214669691237626 * _GAMMA,
    -0.6949742501781779 * _GAMMA,
)
_B1, _B2 = 2.255570073418735 * _GAMMA, 0.2870493262186792 * _GAMMA
_B3, _B4 = 0.4353179431840180 * _GAMMA, 1.093502252409163 * _GAMMA
_E1, _E2 = -0.2815431932141155 * _GAMMA, -0.07276199124934920 * _GAMMA
_E3, _E4 = -0.1082196201495311 * _GAMMA, -1.093502252409163 * _GAMMA
# A stop or a cell that joins ends a step; it is met by so many shorter ones at most.
_TRIES = 8
# What is known of a cell in the flow: where it is, F and κ there, its friction, mobility and full
# travel, between which travels it is on its sheet and between which it can go ...
_TRAVEL, _FORCE, _SLOPE, _FRICTION, _MOBILITY, _FULL, _LEAST, _MOST, _BEFORE, _BEYOND = range(10)
# ... ds/dt, room for the stages of a step, what it goes in it, by how much that may be off ...
_RATE, _STAGE, _LAST, _X1, _X2, _X3, _X4, _WAY, _ERROR, _TRIAL, _WAS = range(10, 21)
# ... and, whole numbers, which cell it is, on which piece, and in which sense it moves within a
# step and when that began; 0 where it stays.
_CELL, _PIECE, _SENSE, _BEGAN = range(4)
# What is known of the cells that keep still: the λ between which they do, and the sum of travels.
_LOWEST, _HIGHEST, _STILL = range(3)


class Flow(NamedTuple):
    """Where the flow is; N cells of the chain, m of them in the flow."""

    drive: float
    cell: Floats  # (21, N) see above, the first m columns
    where: Ints  # (4, N) likewise
    used: Ints  # (1,) m
    still: Floats  # (3,) _LOWEST, _HIGHEST, _STILL
    first: Ints  # (2,) the cells that let go at the highest and at the lowest, or -1


@kernel
def _begin(problem: Problem, state: State, drive: float) -> Flow:
    """The flow as it begins, with all cells in it that do not rest."""
    n = len(state.travel)
    at = Flow(
        drive,
        np.empty((21, n)),
        np.empty((4, n), np.int64),
        np.zeros(1, np.int64),
        np.zeros(3),
        np.empty(2, np.int64),
    )
    mode = state.mode
    for i in range(n):
        if mode[i] != HELD:
            _join(problem, state, at, i)
    _close(problem, state, at)
    return at


@leaf
def _join(problem: Problem, state: State, at: Flow, i: int) -> None:
    """Take cell i into the flow."""
    j = at.used[0]
    at.used[0] += 1
    if state.mode[i] == HELD:
        state.mode[i] = LETS_GO
    at.where[_CELL, j] = i
    at.cell[_TRAVEL, j] = state.travel[i]
    at.cell[_FRICTION, j] = problem.laws.friction[i]
    at.cell[_MOBILITY, j] = problem.mobility[i]
    at.cell[_FULL, j] = problem.laws.full[i]
    _stand(problem, at, j)


@leaf
def _stand(problem: Problem, at: Flow, j: int) -> None:
    """See on which sheet and piece a cell in the flow stands."""
    i, ends = at.where[_CELL, j], problem.sheets.ends
    at.cell[_LEAST, j], at.cell[_MOST, j] = ends[i, LOW], ends[i, HIGH]
    at.cell[_BEFORE, j], at.cell[_BEYOND, j] = ends[i, BEFORE], ends[i, BEYOND]
    piece = find_piece(problem.pieces, i, at.cell[_TRAVEL, j], 0)
    at.where[_PIECE, j] = piece
    picked, travel = problem.pieces.picked[piece], at.cell[_TRAVEL, j]
    at.cell[_FORCE, j], at.cell[_SLOPE, j], _ = law(problem.laws, i, picked, travel)


@leaf
def _close(problem: Problem, state: State, at: Flow) -> None:
    """See within which λ the cells that are not in the flow keep still."""
    friction, ends = problem.laws.friction, problem.sheets.ends
    travel, mode, at_rest = state.travel, state.mode, state.at_rest
    low, high, falls, rises, still = -np.inf, np.inf, -1, -1, 0.0
    for i in range(len(travel)):
        if mode[i] != HELD:
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
    """What drives a cell at λ [N]: stops and Coulomb friction may hold it."""
    force, friction = cell[_FORCE, j], cell[_FRICTION, j]
    if shared > force + friction and cell[_TRAVEL, j] < cell[_BEYOND, j]:
        return float(shared - force - friction)
    if shared < force - friction and cell[_TRAVEL, j] > cell[_BEFORE, j]:
        return float(shared - force + friction)
    return 0.0


@leaf
def _balance(cell: Floats, m: int, shared: float) -> float:
    """The λ at which the rates add up to zero: a fixed stroke. Exact, piece by linear piece."""
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
    """Σ s where the cells in the flow have the travels of that row."""
    total = still
    for j in range(m):
        total += cell[travel, j]
    return total


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
    """The piece of the same cell that holds a travel between its ends, from one not far off."""
    while travel > pieces.right[piece]:
        piece += 1
    while travel < pieces.left[piece]:
        piece -= 1
    return piece


@leaf
def _look(problem: Problem, at: Flow) -> None:
    """Pieces, forces and slopes of the cells where they are."""
    pieces, cell, where = problem.pieces, at.cell, at.where
    for j in range(at.used[0]):
        i, travel = where[_CELL, j], cell[_TRAVEL, j]
        piece = _piece_near(pieces, where[_PIECE, j], travel)
        where[_PIECE, j] = piece
        cell[_FORCE, j], cell[_SLOPE, j], _ = law(problem.laws, i, pieces.picked[piece], travel)


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


@leaf
def _smooth_rates(
    actuator: tuple[float, float, float, float], cell: Floats, where: Ints, m: int, row: int
) -> None:
    """Rates at the travels of `_TRIAL` into `row`, which holds the forces there.

    Those of the cells that move now, in their sense, as if there were no stops: within a step the
    field has to be smooth; stops and releases are looked at between steps. `actuator` is α, β, the
    drive, and Σ s of the cells that are not in the flow.
    """
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


@leaf
def _solve(
    alpha: float, beta: float, cell: Floats, where: Ints, m: int, h: float, row: int, out: int
) -> None:
    """x of (I - h J) x = `row`, where J is -diag(m κ) on the moving cells, coupled by the drive.

    One multiplier couples all of them, so the solution costs no more than `row` itself.
    """
    total, weight = 0.0, 0.0
    for j in range(m):
        if where[_SENSE, j] != 0:
            pivot = 1.0 + h * cell[_MOBILITY, j] * cell[_SLOPE, j]
            total += cell[row, j] / pivot
            weight += cell[_MOBILITY, j] / pivot
    if beta == 0.0:
        shared = -total / weight if weight != 0.0 else 0.0
    else:
        shared = -(h * alpha / beta) * total / (1.0 + (h * alpha / beta) * weight)
    for j in range(m):
        cell[out, j] = cell[row, j]
        if where[_SENSE, j] != 0:
            pivot = 1.0 + h * cell[_MOBILITY, j] * cell[_SLOPE, j]
            cell[out, j] = (cell[row, j] + cell[_MOBILITY, j] * shared) / pivot


@leaf
def _forces(problem: Problem, at: Flow, row: int) -> None:
    """Forces of the cells that move, at the travels of `_TRIAL`, into `row`."""
    pieces, cell, where = problem.pieces, at.cell, at.where
    for j in range(at.used[0]):
        cell[row, j] = 0.0
        if where[_SENSE, j] != 0:
            place = min(max(cell[_TRIAL, j], cell[_LEAST, j]), cell[_MOST, j])
            picked = pieces.picked[_piece_near(pieces, where[_PIECE, j], place)]
            cell[row, j], _, _ = law(problem.laws, where[_CELL, j], picked, place)


@leaf
def _set_off(
    actuator: tuple[float, float, float, float], cell: Floats, where: Ints, m: int
) -> None:
    """The rates of the cells that have a sense, from where they are."""
    for j in range(m):
        cell[_TRIAL, j], cell[_RATE, j] = cell[_TRAVEL, j], cell[_FORCE, j]
    _smooth_rates(actuator, cell, where, m, _RATE)


@leaf
def _pushed_back(cell: Floats, where: Ints, m: int, row: int, rubs: bool) -> int:
    """The cell at a stop, or held by friction if it `rubs`, most against its sense; or -1."""
    back, most = -1, 0.0
    for j in range(m):
        travel = cell[_TRAVEL, j]
        bound = travel == cell[_LEAST, j] or travel == cell[_MOST, j]
        bound = bound or (rubs and cell[_FRICTION, j] > 0.0)
        if bound and cell[row, j] * where[_SENSE, j] < most:
            back, most = j, cell[row, j] * where[_SENSE, j]
    return back


@leaf
def _step(problem: Problem, at: Flow, h: float) -> None:
    """What a step of time h goes into `_WAY`, and its error into `_ERROR` [m].

    A stiff actuator can start a cell off its stop, or against its friction, and call it back
    within the step; stepping through that to and fro would take for ever. Such a cell stays.
    """
    alpha, beta, cell, where, m = problem.alpha, problem.beta, at.cell, at.where, at.used[0]
    actuator = (alpha, beta, at.drive, at.still[_STILL])
    _solve(alpha, beta, cell, where, m, _GAMMA * h, _RATE, _X1)
    back = _pushed_back(cell, where, m, _X1, True)
    while back >= 0:
        where[_SENSE, back] = 0
        _set_off(actuator, cell, where, m)
        _solve(alpha, beta, cell, where, m, _GAMMA * h, _RATE, _X1)
        back = _pushed_back(cell, where, m, _X1, True)
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


@kernel
def _longest_step(
    alpha: float, beta: float, cell: Floats, where: Ints, m: int, wanted: float
) -> float:
    """Longest step that still resolves growth; only decay may be stepped over."""
    falling, moving = 0.0, 0
    for j in range(m):
        if where[_BEGAN, j] != 0:
            moving += 1
            falling = max(falling, -cell[_MOBILITY, j] * cell[_SLOPE, j])
    if wanted * _GAMMA * falling <= 0.7:
        return wanted
    # What grows the least eigenvalue tells, and next to a fold that is almost nothing.
    weights, slopes = np.empty(moving), np.empty(moving)
    k = 0
    for j in range(m):
        if where[_BEGAN, j] != 0:
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
    """The largest error of a step as a share of the full travel."""
    worst = 0.0
    for j in range(m):
        worst = max(worst, abs(cell[_ERROR, j]) / cell[_FULL, j])
        if not np.isfinite(cell[_ERROR, j]):
            return 1e9
    return worst


@leaf
def _until_stop(cell: Floats, m: int, h: float) -> tuple[float, int, float, float]:
    """How a step of time h meets the first end of a sheet.

    The share of the step after which it does and which cell; how far from straight the step is, as
    a share of the full travel; and the share of h after which a parabola would be there. A cell
    just short of an end is there in a step a little longer than one.
    """
    share, first, bend = 1.01, -1, 0.0
    for j in range(m):
        way, travel = cell[_WAY, j], cell[_TRAVEL, j]
        bend = max(bend, abs(way - h * cell[_RATE, j]) / cell[_FULL, j])
        room = cell[_MOST, j] - travel if way > 0.0 else travel - cell[_LEAST, j]
        if abs(way) * share > room:
            share, first = room / abs(way), j
    if first < 0:
        return 1.0, first, bend, 1.0
    # With a straight part p and a bent part 1 - p of the way: p x + (1 - p) x² = share.
    straight = h * cell[_RATE, first] / cell[_WAY, first] if cell[_WAY, first] != 0.0 else 1.0
    root = straight * straight + 4.0 * (1.0 - straight) * share
    then = 2.0 * share / (straight + np.sqrt(root)) if straight > 0.0 and root > 0.0 else share
    return share, first, bend, min(max(then, 0.2 * share), 1.0)


@leaf
def _polish(problem: Problem, at: Flow, shared: float) -> tuple[bool, float]:
    """Newton from a slow point of the flow to the rest that it creeps towards, in `_TRIAL`."""
    laws, pieces, alpha, beta = problem.laws, problem.pieces, problem.alpha, problem.beta
    picked, cell, where, m = pieces.picked, at.cell, at.where, at.used[0]
    # Which cells can move, what friction adds to their force, their miss of λ and their κ.
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
            # Cells of constant force take what is left, by mobility.
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
        # Where it contracts no more it has arrived, but for rounding, or goes astray.
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
def _senses(cell: Floats, where: Ints, m: int, shared: float, h: float, near: float) -> None:
    """In which sense every cell moves in a step of time h from where it is, into `_BEGAN`.

    One that keeps still, but goes back by no more than `near` of its full travel if it is taken
    along, and soon within the step, is taken along; the step decides. Where a slow motion hands
    the lead from cell to cell it would else be followed from hand to hand.
    """
    for j in range(m):
        drives, slope = _drives(cell, j, shared), cell[_SLOPE, j]
        where[_BEGAN, j] = np.sign(drives)
        if drives == 0.0 and h * cell[_MOBILITY, j] * slope > 1.0:
            gap, travel = shared - cell[_FORCE, j], cell[_TRAVEL, j]
            close, friction = near * cell[_FULL, j] * slope, cell[_FRICTION, j]
            if abs(gap - friction) <= close and travel < cell[_BEYOND, j]:
                where[_BEGAN, j] = 1
            elif abs(gap + friction) <= close and travel > cell[_BEFORE, j]:
                where[_BEGAN, j] = -1


@leaf
def _excess(at: Flow, mark: int, level: float) -> float:
    """What drives a cell past what keeps it [N]: it changes sign where the event is.

    Marks 0 and 1 are the window of the cells that keep still, above and below; two more for each
    cell in the flow are its ways up and down.
    """
    if mark == 0:
        return float(level - at.still[_HIGHEST])
    if mark == 1:
        return float(at.still[_LOWEST] - level)
    j = mark // 2 - 1
    up = level - at.cell[_FORCE, j]
    return float((up if mark % 2 == 0 else -up) - at.cell[_FRICTION, j])


@leaf
def _excess_before(at: Flow, mark: int, shared: float) -> float:
    """The same where the last step began."""
    j = mark // 2 - 1
    if mark > 1 and at.where[_SENSE, j] != 0:
        return float(at.where[_SENSE, j] * at.cell[_RATE, j] / at.cell[_MOBILITY, j])
    return _excess(at, mark, shared)


@leaf
def _missed(
    at: Flow, shared: float, level: float, pace: float, tolerance: float
) -> tuple[int, float]:
    """The first event that the last step passed by more than a tolerance, or -1; and its share.

    A cell that keeps still is called, one in the flow starts, or one that slides comes to a halt.
    `pace` is mobility over full travel of the cell that is called; the tolerance [1/s] is a share
    of the full travel over the time of the step.
    """
    cell, where = at.cell, at.where
    event, first = -1, 1.0
    for mark in range(2 * at.used[0] + 2):
        j, sign = mark // 2 - 1, 1.0
        if j >= 0:
            sense, began, heading = where[_SENSE, j], where[_BEGAN, j], 1 - 2 * (mark % 2)
            if sense != began or sense == -heading:
                continue
            if sense != 0:
                # It slides that way until nothing drives it.
                if cell[_FRICTION, j] == 0.0:
                    continue
                sign = -1.0
            elif (heading > 0 and cell[_TRAVEL, j] >= cell[_BEYOND, j]) or (
                heading < 0 and cell[_TRAVEL, j] <= cell[_BEFORE, j]
            ):
                continue
            pace = cell[_MOBILITY, j] / cell[_FULL, j]
        now = sign * _excess(at, mark, level)
        if now <= 0.0:
            continue
        was = sign * _excess_before(at, mark, shared)
        share = was / (was - now) if was < 0.0 else 0.0
        if 0.0 < share < first and now * (1.0 - share) * pace > tolerance:
            event, first = mark, share
    return event, first


@leaf
def _reached(excess: tuple[float, float, float], last: float, ahead: float) -> float:
    """When an event is, from now: on a parabola through its excess before, now and ahead."""
    was, now, over = excess
    slow, fast = (now - was) / last, (over - now) / ahead
    bend = (fast - slow) / (ahead + last)
    rate = slow + bend * last
    sign = 1.0 if now < 0.0 else -1.0
    below = sign * rate + np.sqrt(max(rate * rate - 4.0 * bend * now, 0.0))
    return min(-2.0 * sign * now / below, ahead) if below > 0.0 else ahead


@kernel
def flow(
    problem: Problem,
    state: State,
    drive: float,
    shared: float,
    accuracy: float,
    rubbed: Floats,
) -> tuple[bool, float]:
    """Follow the flow to rest, the travels of the state in place; False if it did not settle.

    A linearly implicit pair of orders 4 and 3 (Hairer and Wanner 1996): a snap through a narrow
    place has one slow direction and many fast ones. The last stretch is Newton's, so the landing is
    an equilibrium to rounding and the integration only decides which. `rubbed` (N,) gathers the
    way every cell went, for friction.
    """
    laws, scale, effort = problem.laws, problem.scale, problem.effort
    alpha, beta = problem.alpha, problem.beta
    at, slowest = _begin(problem, state, drive), np.min(problem.mobility)
    cell, where, used, still = at.cell, at.where, at.used, at.still
    folds = len(problem.sheets.table) > len(state.travel)
    gentle = scale / np.min(laws.full)
    stiffest = _stiffest(cell, used[0], gentle)
    # How long the next step should be, and how long it may be at most for an event on the way;
    # how long the last one was, 0 where there is none to take back.
    wanted, soon, last, tries = 1e-2 / stiffest, np.inf, 0.0, 0
    # An event that was seen too late: which, when from here, and its excess before and there.
    mark, ahead, was, over, settled = -1, 0.0, 0.0, 0.0, False
    for step in range(_STEPS):
        m = used[0]
        if overspent(effort, 4 * m):
            break
        level = shared
        while True:
            if beta == 0.0:
                level = _balance(cell, m, level)
            else:
                level = (drive - alpha * _stroke(cell, m, _TRAVEL, still[_STILL])) / beta
            calls = 1 if level < still[_LOWEST] else (0 if level > still[_HIGHEST] else -1)
            joins = at.first[calls] if calls >= 0 else -1
            if last > 0.0 and tries < _TRIES:
                pace = problem.mobility[joins] / laws.full[joins] if joins >= 0 else 0.0
                event, share = _missed(at, shared, level, pace, accuracy / last)
                if event >= 0:
                    # It was on the way. A step that ends just past it is short enough.
                    mark, ahead = event, last
                    over, was = _excess(at, mark, level), _excess_before(at, mark, shared)
                    for j in range(m):
                        rubbed[where[_CELL, j]] -= abs(cell[_TRAVEL, j] - cell[_WAS, j])
                        cell[_TRAVEL, j] = cell[_WAS, j]
                    _look(problem, at)
                    soon, last, tries, level = 1.01 * share * last, 0.0, tries + 1, shared
                    continue
            if joins < 0:
                break
            _join(problem, state, at, joins)
            _close(problem, state, at)
            m, last, stiffest = used[0], 0.0, _stiffest(cell, used[0], gentle)
        if last > 0.0 and ahead > 0.0:
            # Short of the event, which is between here and where it was too late; or past it.
            ahead, tries = ahead - last, tries + 1
            now = _excess(at, mark, level)
            if ahead > 0.0 and now * over < 0.0 and tries < _TRIES:
                soon, was = 1.01 * _reached((was, now, over), last, ahead), now
            else:
                ahead = 0.0
        elif last > 0.0:
            tries = 0
        shared = level
        largest = _rates(cell, m, shared)
        if folds and _jumps(problem, at):
            last = 0.0
            continue
        # The longest step moves no cell by more than rounding: this is rest, whether or not
        # Newton can say so (two cells of constant force have no single place to be).
        longest = 1e6 / (stiffest * slowest)
        resting = wanted >= longest and largest <= 1e-11 * scale
        settled = largest <= 1e-14 * scale or resting
        if not settled and largest < 1e-2 * scale and step % 2 == 0:
            settled, level = _polish(problem, at, shared)
            if settled:
                shared = level
                for j in range(m):
                    rubbed[where[_CELL, j]] += abs(cell[_TRIAL, j] - cell[_TRAVEL, j])
                    cell[_TRAVEL, j] = cell[_TRIAL, j]
        if settled:
            break
        for j in range(m):
            cell[_WAS, j] = cell[_TRAVEL, j]
        h, stops, cut = min(wanted, soon), 0, soon < wanted
        _senses(cell, where, m, shared, h, 0.1 * accuracy)
        while True:
            where[_SENSE, :m] = where[_BEGAN, :m]
            _set_off((alpha, beta, drive, still[_STILL]), cell, where, m)
            h = min(h, _longest_step(alpha, beta, cell, where, m, h))
            _step(problem, at, h)
            back, stays = _pushed_back(cell, where, m, _WAY, False), not np.any(cell[_WAY, :m])
            if (back >= 0 or stays) and h > 1e-6 / stiffest:
                # A cell would leave its stop and be back there within the step, which then would
                # end before it began; or all were called back. A shorter step lets them go ...
                h *= 0.25
                _senses(cell, where, m, shared, h, 0.1 * accuracy)
                continue
            if back >= 0:
                # ... and in the shortest it stays.
                where[_BEGAN, back] = 0
                continue
            worst = _worst(cell, m) / accuracy
            if worst > 1.0 and h > 1e-9 / stiffest:
                h *= max(0.2, 0.8 * worst**-0.25)
                continue
            # The first stop on the way ends the step: what comes after it is another field.
            share, first, bend, then = _until_stop(cell, m, h)
            if abs(1.0 - share) * bend <= accuracy or share * h <= 1e-9 / stiffest:
                break
            if share >= 1.0 or stops == _TRIES:
                share, first = min(share, 1.0), first if share < 1.0 else -1
                break
            h, cut, stops = then * h, True, stops + 1
        for j in range(m):
            if where[_SENSE, j] != 0:
                way = cell[_WAY, j]
                place = cell[_TRAVEL, j] + share * way
                place = min(max(place, cell[_LEAST, j]), cell[_MOST, j])
                if j == first:
                    # Not by how far it goes: a cell that was there already goes nowhere.
                    place = cell[_MOST, j] if way > 0.0 else cell[_LEAST, j]
                rubbed[where[_CELL, j]] += abs(place - cell[_TRAVEL, j])
                cell[_TRAVEL, j] = place
        _look(problem, at)
        following = h * min(5.0, max(0.2, 0.8 * (worst + 1e-12) ** -0.25))
        wanted = max(wanted, following) if cut else following
        wanted = min(max(wanted, 1e-9 / stiffest), longest)
        soon, last = np.inf, h if first < 0 else 0.0
        if first >= 0:
            ahead = 0.0
    for j in range(used[0]):
        state.travel[where[_CELL, j]] = cell[_TRAVEL, j]
    return settled, shared


@leaf
def _jumps(problem: Problem, at: Flow) -> bool:
    """Let cells that are pushed past the end of their sheets jump to the next; whether any does."""
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
