"""Landings of snaps, proved: along a line, behind rising cells, and of a race of falling cells."""

import math
from collections.abc import Callable

from stepwell.proof import balls
from stepwell.proof.balls import Ball, UndecidedError, ball, high, hull, low
from stepwell.proof.flow import land
from stepwell.proof.walk import FOLD, FREE, HELD, TURN, Enclosed, EnclosedWalk, Stand, _root

LINE, RISING, RACE, FLOW = "line", "rising", "race", "flow"
# Part of a way in which a kink counts as one at its start.
_AT_START = ball(1e-9)
_NOTHING_KNOWN = ball(0.0, math.inf), ball(0.0, math.inf)


def snap(walk: EnclosedWalk, direction: int, leader: int) -> Enclosed:
    """Move a walk to the landing of its snap."""
    # The leader moves with the drive: the cell that has just come to its end, or the falling one.
    cell, sense = walk.trigger
    if cell >= 0 and sense == direction:
        leader = cell
    else:
        falling = [i for i in walk.active() if i != cell and walk.branch(i).sign < 0]
        leader = falling[0] if len(falling) == 1 else leader if walk.due else -1
    if leader < 0:
        raise UndecidedError("cells of constant force share the motion")
    begun, force = {i: s.travel for i, s in enumerate(walk.stands)}, walk.force
    drive, stroke = walk.drive(), walk.stroke()
    active = walk.active()
    others = [i for i in active if i != leader]
    if walk.dead or not others or (walk.rigid and len(others) == 1):
        partner = others[0] if others and walk.rigid else -1
        theorem = _along_line(walk, direction, leader, partner)
    elif all(walk.branch(i).sign > 0 for i in others):
        theorem = _behind_rising(walk, direction, leader, others, drive)
    else:
        raise UndecidedError(f"the landing of a snap in which {len(active)} cells move")
    # Two balls of one travel are equal for certain only where it is exact.
    moves = {
        i: (begun[i], stand.travel)
        for i, stand in enumerate(walk.stands)
        if i == walk.trigger[0]
        or i in active
        or not (stand.travel is begun[i] or bool(stand.travel == begun[i]))
    }
    # In a flow cells with friction may yield and come back.
    rubbed = theorem == FLOW and any(cell.rubs for cell in walk.cells)
    released = None if rubbed else _released(walk, moves, force, direction)
    if released is not None and not released > -walk.tie * walk.cells[leader].size:
        raise UndecidedError("a snap that sets no energy free")
    why = walk.due or TURN
    walk.trigger, walk.due = (-1, 0), ""
    forces = force, walk.force
    return Enclosed("snap", why, direction, drive, stroke, forces, moves, released, theorem)


def _released(walk: EnclosedWalk, moves, force, direction) -> Ball | None:
    if any(walk.cells[i].rubs for i in moves):
        return None
    total, shift = ball(0.0), ball(0.0)
    for i, (before, after) in moves.items():
        total = total + walk.cells[i].energy(before) - walk.cells[i].energy(after)
        shift = shift + after - before
    if not walk.rigid:
        total = total + (force + walk.force) * shift / 2
    return total


# A line: one cell and a partner, or one cell and the actuator.


def _along_line(walk: EnclosedWalk, d: int, j: int, p: int) -> str:
    """The leader moves by x with the drive, its partner against it, while the pull is larger."""
    cell, stand = walk.cells[j], walk.stands[j]
    other = walk.cells[p] if p >= 0 else None
    s0, p0, force = stand.travel, walk.stands[p].travel if other else None, walk.force
    stiffness = ball(0.0) if walk.rigid or walk.dead else 1 / walk.beta
    rub = cell.friction + (other.friction if other else 0)

    def pull(x: Ball, lean: int = 0) -> tuple[Ball, Ball, Ball]:
        own = cell.law(s0 + d * x, lean)
        if other is None:
            return d * (force - own[0]) - stiffness * x - rub, -stiffness - own[1], -d * own[2]
        its = other.law(p0 - d * x, -lean)
        return d * (its[0] - own[0]) - rub, -(its[1] + own[1]), d * (its[2] - own[2])

    room = d * ((cell.high if d > 0 else cell.low) - s0)
    ends, stops = room, j
    if other is not None:
        rest = d * (p0 - (other.low if d > 0 else other.high))
        if rest < room:
            ends, stops = rest, p
        elif not rest > room:
            raise UndecidedError("which of two cells reaches its stop first")
    limit = low(ends)
    flat = walk.due == FOLD or (walk.dead and walk.trigger[0] == j)
    begin = _leave(lambda x, lean: pull(x, d * lean)[1:], limit, flat)
    zero = balls.first_zero(lambda x: pull(x)[:2], begin, limit)
    try:
        if not walk.dead:
            _others_hold(walk, d, (j, p), (s0, p0), ends if zero is None else zero)
    except UndecidedError:
        if not walk.rigid:
            raise
        try:
            if zero is not None or stops != j:
                raise
            return _race(walk, d, j, p, ends)
        except UndecidedError:
            return _flow(walk, d, (j, p), (s0, p0), begin)
    way = ends if zero is None else zero
    if not walk.rigid and not walk.dead:
        walk.force = force - d * stiffness * way
    _arrive(walk, j, s0 + d * way, d if zero is None and stops == j else 0)
    if other is not None:
        _arrive(walk, p, p0 - d * way, -d if zero is None and stops == p else 0)
    try:
        _settle(walk)
    except UndecidedError:
        last = p if stops == j else j
        if zero is not None or not walk.rigid or last < 0:
            raise
        _without_range(walk)
        # The force of the one that is left releases other cells: the snap goes on.
        land(walk, {last: walk.stands[last].travel})
        _settle(walk)
        return FLOW
    return LINE


def _leave(slopes: Callable[[Ball, int], tuple[Ball, Ball]], limit: Ball, flat: bool) -> Ball:
    """A way up to which the pull has grown from 0, by its slope, or its second one from a fold.

    Args:
        slopes: the first and the second slope at a way; with 1, those behind a kink in it.
        limit: the longest way.
        flat: whether the slope is 0 at the start.
    """
    way = limit
    for _ in range(60):
        way = balls.middle(way / 4)
        start = balls.middle(way * _AT_START)
        try:
            first, second = slopes(hull(ball(0.0), start), 1)
            # A kink may be at the start alone: further on the slope is positive with all its kinks.
            if (first > 0 or (flat and second > 0)) and balls.positive(
                lambda x: slopes(x, 0), start, way
            ):
                return way
        except UndecidedError:
            # Several joints in one box: a shorter one has fewer.
            continue
    raise UndecidedError("in which sense a snap begins")


def _others_hold(walk: EnclosedWalk, d: int, pair: tuple[int, int], begun, way: Ball) -> None:
    """Prove that λ stays in the windows of all held cells along a line."""
    j, p = pair
    s0, p0 = begun
    cell, other = walk.cells[j], walk.cells[p] if p >= 0 else None
    one, two = walk.mobility[j], walk.mobility[p] if p >= 0 else 0.0
    share = _share(two, one, walk.ratio)
    stiffness = ball(0.0) if walk.rigid else 1 / walk.beta

    def level(x: Ball) -> tuple[Ball, Ball]:
        if other is None:
            return walk.force - d * stiffness * x, -d * stiffness
        own, its = cell.law(s0 + d * x), other.law(p0 - d * x)
        own_force, its_force = own[0] + d * cell.friction, its[0] - d * other.friction
        force = share * its_force + (1 - share) * own_force
        return force, d * ((1 - share) * own[1] - share * its[1])

    least, most = None, None
    for i, stand in enumerate(walk.stands):
        if i in pair or stand.mode != HELD:
            continue
        down, up = walk.window(i)
        least = down if least is None or (down is not None and down > least) else least
        most = up if most is None or (up is not None and up < most) else most
    end = high(way)
    for bound, sign in ((least, 1), (most, -1)):
        if bound is None:
            continue

        def room(x: Ball, bound: Ball = bound, sign: int = sign) -> tuple[Ball, Ball]:
            value, slope = level(x)
            return sign * (value - bound), sign * slope

        if not balls.positive(room, ball(0.0), end):
            raise UndecidedError("a third cell is released in the snap")


def _flow(walk: EnclosedWalk, d: int, pair: tuple[int, int], begun, begin: Ball) -> str:
    """Follow the flow from a place on the line at which no other cell is released yet."""
    (j, p), (s0, p0), way = pair, begun, begin
    _without_range(walk)
    for _ in range(30):
        try:
            _others_hold(walk, d, pair, begun, way)
            break
        except UndecidedError:
            way = balls.middle(way / 4)
    else:
        raise UndecidedError("a third cell is released at the beginning of the snap")
    land(walk, {j: s0 + d * way, p: p0 - d * way})
    _settle(walk)
    return FLOW


def _without_range(walk: EnclosedWalk) -> None:
    if walk.ratio != 1.0:
        raise UndecidedError("the flow of a snap for a range of mobilities")


def _share(one: float, two: float, ratio: float) -> Ball:
    """Range of one/(one + two) where their ratio varies by a factor either way."""
    least, most = ball(one) / (ball(one) + two * ratio), ball(one) * ratio
    return hull(least, most / (most + two))


def _race(walk: EnclosedWalk, d: int, j: int, p: int, room: Ball) -> str:
    """The leader falls to its stop; of cells that yield at far stops the first stays ahead."""
    cell, first = walk.cells[j], walk.cells[p]
    branch = cell.branches[-1 if d > 0 else 0]
    falls = branch.sign < 0 and walk.branch_at(cell, walk.stands[j].travel, d) == (
        len(cell.branches) - 1 if d > 0 else 0
    )
    if not falls or any(walk.cells[i].rubs for i in range(len(walk.cells))):
        raise UndecidedError("a third cell is released in the snap")
    most = d * first.law(_back(walk, p, d, room))[0]
    _falls_back(walk, p, d, room)
    for k, stand in enumerate(walk.stands):
        if k in (j, p):
            continue
        if stand.mode != HELD:
            raise UndecidedError("a third cell moves in the snap")
        if not walk.at_end(k, d):
            # It waits at its near stop for more than any force in the snap.
            bound = walk.window(k)[1 if d > 0 else 0]
            if bound is None or not d * bound > most:
                raise UndecidedError("a third cell is released in the snap")
            continue
        _falls_back(walk, k, d, room)
        _stays_ahead(walk, d, (p, k), room)
    _arrive(walk, j, walk.stands[j].travel + d * room, d)
    _arrive(walk, p, _back(walk, p, d, room), 0)
    _settle(walk)
    return RACE


def _back(walk: EnclosedWalk, i: int, d: int, way: Ball) -> Ball:
    return (walk.cells[i].high if d > 0 else walk.cells[i].low) - d * way


def _falls_back(walk: EnclosedWalk, i: int, d: int, room: Ball) -> None:
    cell = walk.cells[i]
    branch = cell.branches[-1 if d > 0 else 0]
    far = branch.end(-d)[0]
    if not (branch.sign < 0 and d * (_back(walk, i, d, room) - far) > 0):
        raise UndecidedError("a third cell is released in the snap")


def _stays_ahead(walk: EnclosedWalk, d: int, pair: tuple[int, int], room: Ball) -> None:
    """Prove that the first of two cells has the larger force after equal ways back.

    The second one gives back at most as much as the first, so at most half of what the leader goes.
    """
    one, two = (walk.cells[i] for i in pair)
    if walk.mobility[pair[0]] != walk.mobility[pair[1]] or walk.ratio != 1.0:
        raise UndecidedError("a race of cells with unequal mobilities")

    def ahead(y: Ball) -> tuple[Ball, Ball]:
        a, b = one.law(_back(walk, pair[0], d, y)), two.law(_back(walk, pair[1], d, y))
        return d * (a[0] - b[0]), b[1] - a[1]

    if not balls.positive(ahead, ball(0.0), high(room / 2)):
        raise UndecidedError("which of two cells stays ahead in the snap")


# One cell falls, all others that move are on rising branches.


def _behind_rising(walk: EnclosedWalk, d: int, j: int, others: list[int], drive: Ball) -> str:
    cell, s0, force = walk.cells[j], walk.stands[j].travel, walk.force
    if any(walk.cells[i].rubs for i in (j, *others)):
        raise UndecidedError("the landing of a snap of several cells with friction")

    def miss(x: Ball) -> tuple[Ball, Ball]:
        try:
            there, gain = walk.drive_by_leader(j, others, s0 + d * x)
        except UndecidedError:
            return _NOTHING_KNOWN
        return d * (drive - there), -gain

    def slopes(x: Ball, lean: int) -> tuple[Ball, Ball]:
        try:
            gain, bend = walk.gain(j, others, s0 + d * x, d * lean)
        except UndecidedError:
            return _NOTHING_KNOWN
        return -gain, -d * bend

    limit, stops, valleys = _way_ahead(walk, d, j)
    begin = _leave(slopes, limit, walk.due == FOLD)
    zero = balls.first_zero(miss, begin, limit)
    if zero is None and not stops:
        raise UndecidedError("no landing before the force of the start")
    way = ball(0.0) + (limit if zero is None else zero)
    passed = [d * f for x, f in valleys if not x > way]
    if zero is None:
        end = cell.high if d > 0 else cell.low
        at_end = cell.law(end)[0]
        _arrive(walk, j, end, d)
        walk.force = _root(lambda f: _and_slope(walk, others, drive, f), at_end, force)
        passed.append(d * at_end)
    else:
        walk.force = cell.law(s0 + d * zero)[0]
    passed_all = [*passed, d * _known(walk)]
    floor = low(min(passed_all, key=balls.number))
    for f in passed:
        floor = low(hull(floor, f)) if f < floor else floor
    _hold_down_to(walk, d, (j, others), floor)
    if zero is not None:
        if passed:
            _single(walk, d, j, others, (s0, zero, limit))
        _arrive(walk, j, s0 + d * zero, 0)
    for i in others:
        walk._put(i, walk.force)
    _settle(walk)
    return RISING


def _known(walk: EnclosedWalk) -> Ball:
    assert walk.force is not None
    return walk.force


def _and_slope(
    walk: EnclosedWalk, others: list[int], drive: Ball, force: Ball
) -> tuple[Ball, Ball]:
    there, soft = walk.drive_by_force(others, force)
    return drive - there, -soft


def _way_ahead(walk: EnclosedWalk, d: int, j: int) -> tuple[Ball, bool, list[tuple[Ball, Ball]]]:
    """How far j can go until its force is that of the start; if to a stop; turns on the way."""
    cell, s0, force = walk.cells[j], walk.stands[j].travel, walk.force
    k = walk.branch_at(cell, s0, d)
    valleys: list[tuple[Ball, Ball]] = []
    while True:
        branch = cell.branches[k]
        travel, at_end = branch.end(d)
        if branch.sign > 0 and d * (at_end - force) > 0:
            return low(d * (cell.invert(branch, force) - s0)), False, valleys
        k += d
        if not 0 <= k < len(cell.branches):
            if cell.leads[d > 0]:
                raise UndecidedError("a curve that folds back")
            return low(d * (travel - s0)), True, valleys
        if not d * (at_end - force) < 0:
            raise UndecidedError("a later peak of the force ties with the start")
        valleys.append((d * (travel - s0), at_end))


def _hold_down_to(walk: EnclosedWalk, d: int, who: tuple[int, list[int]], floor: Ball) -> None:
    """Prove that no other cell leaves its branch or its stop while d λ is at least the floor."""
    j, others = who
    for i in others:
        force = walk.branch(i).end(-d)[1]
        if not d * force < floor:
            raise UndecidedError("another cell may leave its branch in the snap")
    for i, stand in enumerate(walk.stands):
        if i != j and stand.mode == HELD:
            bound = walk.window(i)[0 if d > 0 else 1]
            if bound is not None and not d * bound < floor:
                raise UndecidedError("another cell may be released in the snap")


def _single(walk: EnclosedWalk, d: int, j: int, others: list[int], places) -> None:
    """Prove that no equilibrium follows the first one before the force of the start."""
    s0, zero, limit = places

    def gain(x: Ball) -> tuple[Ball, Ball]:
        try:
            value, slope = walk.gain(j, others, s0 + d * x)
        except UndecidedError:
            return _NOTHING_KNOWN
        return value, d * slope

    if not balls.positive(gain, low(zero), limit):
        raise UndecidedError("a second equilibrium follows the landing")


def _arrive(walk: EnclosedWalk, i: int, travel: Ball, stop: int) -> None:
    """Put a cell where it lands: at a stop, or on a branch."""
    cell = walk.cells[i]
    if stop:
        if cell.leads[stop > 0]:
            raise UndecidedError("a curve that folds back")
        walk.stands[i] = Stand(HELD, cell.high if stop > 0 else cell.low)
    elif cell.rubs:
        walk.stands[i] = Stand(HELD, travel)
    else:
        walk.stands[i] = Stand(FREE, travel, walk.branch_at(cell, travel, 0))


def _settle(walk: EnclosedWalk) -> None:
    """λ after a snap, and proof that all held cells stay."""
    free = [i for i, stand in enumerate(walk.stands) if stand.mode == FREE]
    if walk.rigid:
        walk.force = walk.cells[free[0]].law(walk.stands[free[0]].travel)[0] if free else None
    if walk.force is None:
        windows = [walk.window(i) for i in range(len(walk.cells))]
        lows, highs = (
            [a for a, _ in windows if a is not None],
            [b for _, b in windows if b is not None],
        )
        if any(not a < b for a in lows for b in highs):
            raise UndecidedError("whether a further snap follows at once")
        return
    for i, stand in enumerate(walk.stands):
        if stand.mode == HELD:
            down, up = walk.window(i)
            if (down is not None and not down < walk.force) or (
                up is not None and not up > walk.force
            ):
                raise UndecidedError("whether a further snap follows at once")
