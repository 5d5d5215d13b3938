"""Time integration of the inertial motion of a chain at a fixed drive, from contact to contact."""

from typing import NamedTuple

import numpy as np

from stepwell import mechanism as mech
from stepwell.base import Floats, Ints
from stepwell.kernels import entry, kernel
from stepwell.statics import inertia
from stepwell.statics.following.pieces import sheet_of, stand_on
from stepwell.statics.following.state import DrivenChain
from stepwell.statics.inertia import FreeCells

# Status of an integration: not finished, at rest, or failed.
GOES_ON, RESTS, STUCK = 0, 1, 2

# Quantities of the motion in addition to travels and speeds.
(TIME, STEP, PEAK, DAMPED, RUBBED, STRUCK, JUMPED) = range(7)

# Two forces closer than this fraction of the largest one are equal.
_SLIP = 1e-12
# A contact is located past its place by about this fraction of travel, speed or force.
_PAST = 5e-13
# Deviation of a law past a kink, in tolerances of the largest force, that ends a step.
_BENT = 1e-2
# Energies below this fraction of largest force times travel are zero: such an impact does not
# rebound, and a cell with less energy stays at its stop.
_NONE = 1e-9
# Largest speed of a block within a step, over that at its ends.
_OVER = 1.02
# Largest step of a moving drive, as a fraction of the motion.
_STRIDE = 1.0 / 128.0
# The motion ends where the remaining energy is this fraction of the dissipated energy.
_SPENT = 1e-10


class Inertias(NamedTuple):
    """Masses, dampers and the beginning of the motion; N cells."""

    mass: Floats  # (N,) of the block outside each cell [kg]
    loose: Floats  # (N,) 1/mass, 0 for a block that is held
    damping: Floats  # (N,) [N s/m]
    restitution: float
    begin: Floats  # (N,) travels [m]
    force: float  # λ there [N]
    leader: int  # the cell that sets it off, -1 if it is the drive
    push: float  # on the leader all along [N]
    tolerance: float  # of a step, as a fraction of travel and of speed
    crank: inertia.Crank


class MotionState(NamedTuple):
    """State of the motion; N cells."""

    travel: Floats  # (N,) [m]
    speed: Floats  # (N,) [m/s]
    moving: Ints  # (N,) 1 where a cell moves
    sense: Ints  # (N,) of friction on a cell that moves, else 0
    book: Floats  # (7,) TIME, STEP, PEAK and the energies [J]


@kernel
def ends_at(problem: DrivenChain, cell: int) -> tuple[float, float]:
    """Travels at which a cell meets a stop or another sheet; an open end is none."""
    row, ends = problem.sheets.table[problem.sheets.now[cell]], problem.sheets.ends[cell]
    low, high = ends[mech.LOW], ends[mech.HIGH]
    if row[mech.BELOW] < 0.0 and row[mech.LOW] < row[mech.CURVE_LOW]:
        low = -np.inf
    if row[mech.ABOVE] < 0.0 and row[mech.HIGH] > row[mech.CURVE_HIGH]:
        high = np.inf
    return low, high


@kernel
def _stops(problem: DrivenChain, cell: int, travel: float) -> int:
    """-1 or +1 where a cell is at a stop, 0 where it is not."""
    low, high = ends_at(problem, cell)
    row = problem.sheets.table[problem.sheets.now[cell]]
    if travel <= low and row[mech.BELOW] < 0.0:
        return -1
    return 1 if travel >= high and row[mech.ABOVE] < 0.0 else 0


@kernel
def _force(problem: DrivenChain, body: Inertias, cell: int, travel: float, rows: Ints) -> float:
    mech.pick_rows(problem.laws, cell, travel, rows)
    force = mech.law(problem.laws, cell, rows, travel)[0]
    return force - body.push if cell == body.leader else force


@kernel
def _lambda(problem: DrivenChain, body: Inertias, motion: MotionState) -> float:
    if problem.beta == 0.0:
        return 0.0
    force = body.force + inertia.crank_way(body.crank, 0.0, motion.book[TIME]) / problem.beta
    return force - problem.alpha / problem.beta * mech.summed(motion.travel - body.begin)


@kernel
def _bounds(
    problem: DrivenChain, body: Inertias, motion: MotionState, i: int, rows: Ints
) -> tuple[float, float]:
    """Forces across a cell at rest between which it stays at rest [N]."""
    force, rub = _force(problem, body, i, motion.travel[i], rows), problem.laws.friction[i]
    stop = _stops(problem, i, motion.travel[i])
    return (-np.inf if stop < 0 else force - rub), (np.inf if stop > 0 else force + rub)


@kernel
def set_off(problem: DrivenChain, body: Inertias, motion: MotionState, rows: Ints) -> None:
    """Determine the moving cells, after cells at the end of their sheets have jumped."""
    # One function: bounds, forces and gains of a pass are in arrays made once.
    n, speed, friction = len(motion.travel), motion.speed, problem.laws.friction
    low, high, force, gain = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    end, jumps, extra = _lambda(problem, body, motion), True, np.zeros(n)
    if problem.beta == 0.0:
        extra[-1] = inertia.crank_gain(body.crank, motion.book[TIME])
    for _ in range(100):
        if not jumps:
            return
        for i in range(n):
            low[i], high[i] = _bounds(problem, body, motion, i, rows)
            if speed[i] != 0.0:
                value = _force(problem, body, i, motion.travel[i], rows)
                value += body.damping[i] * speed[i]
                low[i] = high[i] = value + np.sign(speed[i]) * friction[i]
        # A guess: the force at which a drive that begins to move sets off the first cell.
        guess = 0.0
        if extra[-1] != 0.0:
            guess = np.min(high) if extra[-1] > 0.0 else np.max(low)
        for i in range(n):
            force[i] = min(max(guess, low[i]), high[i])
        inertia.least_constraint(low, high, extra, body.loose, end, force)
        inertia.rates(force, body.loose, end, gain)
        gain[-1] += extra[-1]
        jumps = False
        for i in range(n):
            loose, heading = body.loose[i], int(np.sign(speed[i]))
            loose += body.loose[i - 1] if i > 0 else 0.0
            if heading == 0 and abs(gain[i]) > 0.1 * _SLIP * problem.scale * loose:
                heading = int(np.sign(gain[i]))
            if heading != 0 and _jump(problem, motion, i, heading, rows):
                jumps = True
            free = low[i] == high[i] and friction[i] == 0.0
            motion.moving[i] = heading != 0 or free
            motion.sense[i] = heading if friction[i] > 0.0 else 0


@kernel
def _jump(problem: DrivenChain, motion: MotionState, i: int, heading: int, rows: Ints) -> bool:
    """Move a cell that is driven past the end of its sheet to the next; whether it jumps."""
    laws, sheets = problem.laws, problem.sheets
    low, high = ends_at(problem, i)
    if not (motion.travel[i] >= high if heading > 0 else motion.travel[i] <= low):
        return False
    to = mech.beyond(sheets, i, motion.travel[i])
    if to < 0:
        return False
    mech.pick_rows(laws, i, motion.travel[i], rows)
    before = mech.stored(laws, i, rows, motion.travel[i])
    stand_on(laws, sheets, problem.pieces, i, to - int(sheets.table[to, mech.FIRST]))
    mech.pick_rows(laws, i, motion.travel[i], rows)
    motion.book[JUMPED] += before - mech.stored(laws, i, rows, motion.travel[i])
    return True


@kernel
def _apply_impacts(problem: DrivenChain, body: Inertias, motion: MotionState) -> None:
    n, speed = len(motion.travel), motion.speed
    low, high, bounce, strikes = np.zeros(n), np.zeros(n), np.zeros(n), False
    energy = _NONE * problem.scale * np.min(problem.laws.full)
    little = np.sqrt(2.0 * energy / np.min(body.mass))
    for i in range(n):
        stop = _stops(problem, i, motion.travel[i])
        if stop != 0:
            low[i], high[i] = (-np.inf, 0.0) if stop < 0 else (0.0, np.inf)
            if stop * speed[i] > 0.0:
                strikes = True
                bounce[i] = body.restitution if abs(speed[i]) > little else 0.0
    if not strikes:
        return
    before, was, keeps = inertia.kinetic(body.mass, body.loose, speed), speed.copy(), False
    inertia.apply_impacts(low, high, bounce, body.loose, speed)
    for i in range(n):
        if low[i] < high[i] and abs(speed[i]) <= little:
            # Otherwise rounding errors would make stops rattle forever.
            low[i], high[i], bounce[i], keeps = -np.inf, np.inf, 0.0, True
    if keeps:
        first, total = speed.copy(), np.sum(was)
        speed[:] = was
        inertia.apply_impacts(low, high, bounce, body.loose, speed)
        driven = problem.beta == 0.0 and body.crank.swing != 0.0
        if driven and abs(np.sum(speed) - total) > 1e-9 * abs(total):
            # A rigid drive moves on, and so does a cell, however slowly.
            speed[:] = first
    motion.book[STRUCK] += before - inertia.kinetic(body.mass, body.loose, speed)


@kernel
def _free_cells(problem: DrivenChain, body: Inertias, motion: MotionState, rows: Ints) -> FreeCells:
    cells = np.flatnonzero(motion.moving)
    k, total = len(cells), 0.0
    mass, offset, pace = np.zeros(k), np.empty(k), np.empty(k)
    for m in range(k):
        i = cells[m]
        total += motion.speed[i]
        pace[m] = total
        after = cells[m + 1] if m + 1 < k else len(motion.travel)
        for j in range(i, after):
            mass[m] += body.mass[j]
        offset[m] = motion.sense[i] * problem.laws.friction[i]
        if i == body.leader:
            offset[m] -= body.push
    rigid, time = problem.beta == 0.0, motion.book[TIME]
    stiff = 0.0 if rigid else problem.alpha / problem.beta
    if rigid and k > 0:
        pace[-1] = inertia.crank_speed(body.crank, time)
    begin, level = motion.travel[cells], _lambda(problem, body, motion)
    picked, free, slope = np.full((k, len(rows)), -1), k - 1 if rigid else k, np.empty(k)
    driven, groups = (body.crank, time, problem.beta), (mass, body.damping[cells], offset)
    leg = FreeCells(cells, *groups, begin, pace, slope, level, stiff, free, *driven, picked, rows)
    inertia.update_slopes(problem, leg)
    return leg


@kernel
def _violation(
    problem: DrivenChain, body: Inertias, motion: MotionState, leg: FreeCells, h: float, out: Floats
) -> float:
    """Largest violation of the assumptions of a step of h [s] at its end; 0 or less if none."""
    # A cell past its end, over its travel; past a kink of its law; turning against friction, over
    # the largest speed; held although its force is out of bounds, over the largest force.
    k, worst, before, fast = len(leg.cells), -1.0, 0.0, 0.0
    force = np.empty(k)
    for m in range(k):
        i = leg.cells[m]
        travel, speed = leg.begin[m] + (out[m] - before), out[k + m] - fast
        before, fast = out[m], out[k + m]
        low, high = ends_at(problem, i)
        past = max(low - travel, travel - high)
        worst = max(worst, past / problem.laws.full[i])
        mech.pick_rows(problem.laws, i, travel, leg.spare)
        bent = mech.law(problem.laws, i, leg.spare, travel)[0]
        bent = abs(bent - mech.law(problem.laws, i, leg.rows[m], travel)[0]) / problem.scale
        worst = max(worst, _PAST * (bent / (_BENT * body.tolerance) - 1.0))
        if motion.sense[i] != 0 and speed != 0.0:
            worst = max(worst, -motion.sense[i] * speed / max(motion.book[PEAK], abs(speed)))
    end = inertia.tensions(problem, leg, h, out[:k], out[k : 2 * k], force)
    m, carried, gain = -1, 0.0, 0.0
    if leg.free < k:
        gain = inertia.crank_gain(leg.crank, leg.time + h)
    for i in range(len(motion.travel)):
        if motion.moving[i] == 1:
            m, carried = m + 1, body.mass[i]
            continue
        # Within a group the force goes from that of its inner cell to that of its outer one,
        # by the masses that it has passed; a group that is held has one force, but for its gain.
        here = end if k == 0 else force[0] if m < 0 else force[m]
        if m >= 0 and m < leg.free:
            outer = force[m + 1] if m + 1 < k else end
            here += (outer - here) * carried / leg.mass[m]
        elif m >= 0:
            here += gain * carried
        carried += body.mass[i]
        low, high = _bounds(problem, body, motion, i, leg.spare)
        past = max(low - here, here - high) / problem.scale - _SLIP
        worst = max(worst, past)
    return worst


@kernel
def _parabola(first: float, last: float, mean: float) -> tuple[float, float]:
    """Slope and bend of the speed over a step from its ends and its mean: v0 + b τ + c τ²."""
    return 6.0 * mean - 4.0 * first - 2.0 * last, 3.0 * (first + last) - 6.0 * mean


@kernel
def _turning_fraction(problem: DrivenChain, leg: FreeCells, h: float, out: Floats) -> float:
    """The fraction of a step after which a cell turns beyond its end; 1 where none does."""
    k, share = len(leg.cells), 1.0
    before, fast, faster = 0.0, 0.0, 0.0
    for m in range(k):
        first, last, way = leg.pace[m] - fast, out[k + m] - faster, out[m] - before
        fast, faster, before = leg.pace[m], out[k + m], out[m]
        if first * last >= 0.0:
            continue
        b, c = _parabola(first, last, way / h)
        low, high = ends_at(problem, leg.cells[m])
        # The one change of sign in the step, by bisection.
        near, far = 0.0, 1.0
        for _ in range(50):
            middle = 0.5 * (near + far)
            if (first + middle * (b + middle * c)) * first > 0.0:
                near = middle
            else:
                far = middle
        place = leg.begin[m] + h * near * (first + near * (b / 2.0 + near * c / 3.0))
        slip = 1e-12 * problem.laws.full[leg.cells[m]]
        if (place > high + slip or place < low - slip) and near < share:
            share = near
    return share


@kernel
def _peak(pace: Floats, h: float, out: Floats) -> float:
    """Largest speed of any block within a step [m/s]."""
    k, peak = len(pace), 0.0
    for m in range(k):
        first, last = pace[m], out[k + m]
        b, c = _parabola(first, last, out[m] / h)
        peak = max(peak, abs(last))
        # Between the ends a smooth peak is little higher; more is the parabola's own overshoot.
        ends = max(abs(first), abs(last))
        if c != 0.0 and 0.0 < -b / (2.0 * c) < 1.0:
            between = abs(first - b * b / (4.0 * c))
            peak = max(peak, between if between < _OVER * ends else ends)
    return peak


@kernel
def _relative_error(
    problem: DrivenChain, body: Inertias, book: Floats, leg: FreeCells, out: Floats, error: Floats
) -> float:
    """The error of a step over its tolerance: of travels, speeds and damped energy."""
    k, worst = len(leg.cells), 0.0
    # Speeds far below those that the largest force can make are rounding.
    scale, length = problem.scale, np.min(problem.laws.full)
    drag = np.max(body.damping) + np.sqrt(scale * np.max(body.mass) / length)
    fastest = max(1e-2 * book[PEAK], 1e-4 * scale / drag)
    for m in range(k):
        fastest = max(fastest, abs(leg.pace[m]), abs(out[k + m]))
    lost = _dissipated(book) + out[2 * k]
    if lost > 1e-12 * scale * length:
        worst = error[2 * k] / lost
    for m in range(k):
        worst = max(worst, error[m] / length, error[k + m] / fastest)
        if not (np.isfinite(out[m]) and np.isfinite(out[k + m])):
            return np.inf
    return worst / body.tolerance


@kernel
def _dissipated(book: Floats) -> float:
    return book[DAMPED] + book[RUBBED] + book[STRUCK] + book[JUMPED]


@kernel
def _advance(problem: DrivenChain, body: Inertias, motion: MotionState, leg: FreeCells) -> int:
    """A step, or the part of it up to the first contact that changes."""
    # One function: a step and the root over its length use the same four arrays.
    k, book = len(leg.cells), motion.book
    out, error = np.empty(2 * k + 1), np.empty(2 * k + 1)
    h = min(book[STEP], body.crank.until * _STRIDE, body.crank.until - book[TIME])
    wanted = h
    while True:
        fine = inertia.advance(problem, leg, h, out, error)
        worst = _relative_error(problem, body, book, leg, out, error) if fine else np.inf
        if worst <= 1.0:
            graze = _turning_fraction(problem, leg, h, out)
            if graze == 1.0:
                wanted = h * min(4.0, max(0.2, 0.9 * (worst + 1e-9) ** (-1.0 / inertia.COLUMNS)))
                break
            h *= graze
        else:
            h *= max(0.1, 0.9 * worst ** (-1.0 / inertia.COLUMNS)) if np.isfinite(worst) else 0.1
        if not h > 1e-15 * (book[TIME] + book[STEP]):
            return STUCK
    past = _violation(problem, body, motion, leg, h, out)
    ended = past > 0.0
    if ended:
        # The first change, and just past it: the root over h, by false position (Illinois).
        low, high, at_high, side = 0.0, h, past - _PAST, 0
        out[:k], out[k : 2 * k] = 0.0, leg.pace
        at_low = min(_violation(problem, body, motion, leg, 0.0, out), 0.0) - _PAST
        for turn in range(100):
            share = at_low / (at_low - at_high) if turn % 4 != 3 else 0.5
            middle = low + share * (high - low)
            if not low < middle < high:
                break
            if not inertia.advance(problem, leg, middle, out, error):
                return STUCK
            past = _violation(problem, body, motion, leg, middle, out)
            if past > _PAST:
                at_low *= 0.5 if side > 0 else 1.0
                high, at_high, side = middle, past - _PAST, 1
            else:
                at_high *= 0.5 if side < 0 else 1.0
                low, at_low, side = middle, past - _PAST, -1
            if 0.0 < past <= 2.0 * _PAST:
                high = middle
                break
        h = high
        if not inertia.advance(problem, leg, h, out, error):
            return STUCK
    book[TIME] += h
    book[DAMPED] += out[2 * k]
    book[PEAK] = max(book[PEAK], _peak(leg.pace, h, out))
    book[STEP] = wanted
    before, fast = 0.0, 0.0
    for m in range(k):
        i, way = leg.cells[m], out[m] - before
        motion.travel[i] = leg.begin[m] + way
        motion.speed[i] = out[k + m] - fast
        before, fast = out[m], out[k + m]
        book[RUBBED] += problem.laws.friction[i] * motion.sense[i] * way
    if ended:
        _contact(problem, body, motion, leg)
    return GOES_ON


@kernel
def _contact(problem: DrivenChain, body: Inertias, motion: MotionState, leg: FreeCells) -> None:
    """Stop cells that turn against friction, compute impacts and jumps, and find moving cells."""
    for i in leg.cells:
        if motion.sense[i] != 0 and motion.sense[i] * motion.speed[i] <= 0.0:
            motion.speed[i] = 0.0
        low, high = ends_at(problem, i)
        slip = 1e-13 * problem.laws.full[i]
        if motion.travel[i] >= high - slip and motion.speed[i] >= 0.0:
            motion.travel[i] = high
        elif motion.travel[i] <= low + slip and motion.speed[i] <= 0.0:
            motion.travel[i] = low
    _apply_impacts(problem, body, motion)
    set_off(problem, body, motion, leg.spare)


@kernel
def _settle(problem: DrivenChain, leg: FreeCells, way: Floats) -> bool:
    """Newton to a near equilibrium of the moving cells; whether there is a stable one."""
    k = len(leg.cells)
    force, pull, still, place = np.empty(k), np.zeros(k), np.zeros(k), leg.begin.copy()
    way[:] = 0.0
    for _ in range(40):
        before = 0.0
        for m in range(k):
            i, travel = leg.cells[m], place[m] + (way[m] - before)
            before = way[m]
            low, high = ends_at(problem, i)
            if not low <= travel <= high or abs(travel - place[m]) > 1e-2 * problem.laws.full[i]:
                return False
            mech.pick_rows(problem.laws, i, travel, leg.rows[m])
            leg.slope[m] = mech.law(problem.laws, i, leg.rows[m], travel)[1]
        end = inertia.tensions(problem, leg, 0.0, way, still, force)
        for m in range(leg.free):
            pull[m] = (force[m + 1] if m + 1 < k else end) - force[m]
        if not inertia.solve(leg, 1.0, 0.0, pull):
            return False
        change = 0.0
        for m in range(leg.free):
            way[m] += pull[m]
            change = max(change, abs(pull[m]))
        if change <= 1e-15 * np.min(problem.laws.full):
            break
    return True


@kernel
def _settled(problem: DrivenChain, body: Inertias, motion: MotionState, leg: FreeCells) -> bool:
    """Set the cells to rest if the remaining energy is negligible; whether it is."""
    book, k = motion.book, len(leg.cells)
    lost, left = _dissipated(book), inertia.kinetic(body.mass, body.loose, motion.speed)
    if leg.free == 0:
        return True
    if left > _SPENT * lost or lost <= 0.0:
        return False
    way, begin = np.empty(k), leg.begin.copy()
    if not _settle(problem, leg, way):
        inertia.update_slopes(problem, leg)
        return False
    before, trifle = 0.0, left
    for m in range(k):
        i, at = leg.cells[m], begin[m]
        to, before = at + (way[m] - before), way[m]
        mech.pick_rows(problem.laws, i, at, leg.spare)
        trifle += mech.stored(problem.laws, i, leg.spare, at) + leg.offset[m] * (at - to)
        mech.pick_rows(problem.laws, i, to, leg.spare)
        trifle -= mech.stored(problem.laws, i, leg.spare, to)
    # Work of the actuator up to there.
    trifle += way[-1] * (leg.level - 0.5 * leg.stiff * way[-1]) if leg.free == k else 0.0
    if trifle > _SPENT * lost:
        inertia.update_slopes(problem, leg)
        return False
    exact = np.empty(k)
    for m in range(k):
        leg.offset[m] += body.push if leg.cells[m] == body.leader else 0.0
    if _settle(problem, leg, exact):
        way[:] = exact
    before = 0.0
    for m in range(k):
        i, here, before = leg.cells[m], way[m] - before, way[m]
        motion.travel[i], motion.speed[i] = begin[m] + here, 0.0
        book[RUBBED] += problem.laws.friction[i] * motion.sense[i] * here
    book[DAMPED] += max(trifle, 0.0)
    return True


@entry()
def integrate(problem: DrivenChain, body: Inertias, motion: MotionState, history: Floats) -> int:
    """Integrate the motion of the chain; returns GOES_ON, RESTS or STUCK."""
    # `history` (rows, 1 + 3N) gets time, travels, speeds and sheets after each step; the rest stays
    # NaN. A drive that moves ends the motion at its time, one that stays when the blocks rest.
    n, slots = len(motion.travel), 1
    for i in range(n):
        slots = max(slots, problem.laws.band_first[i + 1] - problem.laws.band_first[i] + 1)
    rows = np.full(slots, -1, np.int64)
    driven = body.leader < 0
    if motion.book[TIME] == 0.0:
        # The drive has brought the leader to the end of its sheet, even if friction holds others.
        if not driven:
            _jump(problem, motion, body.leader, 1 if body.push > 0.0 else -1, rows)
        set_off(problem, body, motion, rows)
    for row in range(len(history)):
        leg = _free_cells(problem, body, motion, rows)
        if driven and motion.book[TIME] >= (1.0 - 1e-14) * body.crank.until:
            return RESTS
        if driven and problem.beta == 0.0 and len(leg.cells) == 0:
            return STUCK
        if not driven and _settled(problem, body, motion, leg):
            return RESTS
        if _advance(problem, body, motion, leg) == STUCK:
            return STUCK
        history[row, 0] = motion.book[TIME]
        history[row, 1 : n + 1] = motion.travel
        history[row, n + 1 : 2 * n + 1] = motion.speed
        for i in range(n):
            history[row, 2 * n + 1 + i] = float(sheet_of(problem.sheets, i))
    return GOES_ON
