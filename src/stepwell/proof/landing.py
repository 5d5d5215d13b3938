"""Landings of snaps, proved: along a line, behind rising cells, and of a race of falling cells."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import reduce

from stepwell.proof import balls
from stepwell.proof.balls import Ball, UndecidedError, ball, high, hull, low
from stepwell.proof.flow import follow
from stepwell.proof.leaving import leave
from stepwell.proof.walk import FOLD, FREE, HELD, SLIDES, TURN, Enclosed, EnclosedWalk, Stand, _root

LINE, RISING, RACE, FLOW = "line", "rising", "race", "flow"
# Part of a way in which a kink counts as one at its start.
_AT_START = ball(1e-9)
_NOTHING_KNOWN = ball(0.0, math.inf), ball(0.0, math.inf)


def snap(walk: EnclosedWalk, direction: int, leader: int) -> Enclosed:
    """Move a walk to the landing of its snap."""
    leader = _leader(walk, direction, leader)
    begun, force = {i: s.travel for i, s in enumerate(walk.stands)}, walk.force
    drive, stroke = walk.drive(), walk.stroke()
    active = walk.active()
    theorem = _land(walk, direction, leader, [i for i in active if i != leader])
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


def _leader(walk: EnclosedWalk, direction: int, falling: int) -> int:
    """The cell that moves with the drive: it has just come to its end, or it is the falling one."""
    cell, sense = walk.trigger
    if cell >= 0 and sense == direction:
        return cell
    others = [i for i in walk.active() if i != cell and walk.branch(i).sign < 0]
    if len(others) == 1:
        return others[0]
    if not walk.due or falling < 0:
        raise UndecidedError("cells of constant force share the motion")
    return falling


def _land(walk: EnclosedWalk, direction: int, leader: int, others: list[int]) -> str:
    """Put a walk at the landing, by the theorem whose name is returned."""
    if walk.dead or not others or (walk.rigid and len(others) == 1):
        partner = others[0] if others and walk.rigid else -1
        return _along_line(walk, direction, leader, partner)
    stands = [replace(stand) for stand in walk.stands]
    try:
        if all(walk.branch(i).sign > 0 for i in others):
            return _behind_rising(walk, direction, leader, others)
    except UndecidedError:
        if not walk.rigid:
            raise
    if not walk.rigid:
        raise UndecidedError(f"the landing of a snap in which {1 + len(others)} cells move")
    walk.stands = stands
    _without_range(walk)
    follow(walk, *leave(walk, direction, leader))
    _settle(walk, direction)
    return FLOW


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


class _Line:
    """The leader j moves by x with the drive, its partner p, or the actuator, against it."""

    def __init__(self, walk: EnclosedWalk, d: int, j: int, p: int):
        self.walk, self.d, self.j, self.p = walk, d, j, p
        self.cell, self.other = walk.cells[j], walk.cells[p] if p >= 0 else None
        self.begin, self.behind = walk.stands[j].travel, walk.stands[p].travel
        self.force = walk.force
        # A kink is at the start of a cell that stands at a turn of its force, or at a fold.
        fold = walk.due == FOLD
        self.turned = fold or walk.at_turn(j), fold or (p >= 0 and walk.at_turn(p))
        self.blur = max(_blur(walk, j), _blur(walk, p) if p >= 0 else ball(0.0))
        self.stiffness = ball(0.0) if walk.rigid or walk.dead else 1 / walk.beta
        self.rub = self.cell.friction + (self.other.friction if self.other else 0)
        self.share = _share(walk.mobility[p] if p >= 0 else 0.0, walk.mobility[j], walk.ratio)

    def pull(self, x: Ball, lean: int = 0) -> tuple[Ball, Ball, Ball]:
        """The force that drives the snap, and its first two slopes."""
        d, stiffness, rub = self.d, self.stiffness, self.rub
        own = self.cell.law(self.begin + d * x, lean if self.turned[0] else 0)
        if self.other is None:
            rest = d * (self.force - own[0]) - stiffness * x - rub
            return rest, -stiffness - own[1], -d * own[2]
        its = self.other.law(self.behind - d * x, -lean if self.turned[1] else 0)
        return d * (its[0] - own[0]) - rub, -(its[1] + own[1]), d * (its[2] - own[2])

    def level(self, x: Ball) -> tuple[Ball, Ball]:
        """λ and its slope."""
        d = self.d
        if self.other is None:
            return self.force - d * self.stiffness * x, -d * self.stiffness
        own, its = self.cell.law(self.begin + d * x), self.other.law(self.behind - d * x)
        own_force, its_force = own[0] + d * self.cell.friction, its[0] - d * self.other.friction
        force = self.share * its_force + (1 - self.share) * own_force
        return force, d * ((1 - self.share) * own[1] - self.share * its[1])

    def end(self) -> tuple[Ball, int]:
        """The way up to the first stop, and the cell that gets to it."""
        d, cell, other = self.d, self.cell, self.other
        room = d * ((cell.high if d > 0 else cell.low) - self.begin)
        if other is None:
            return room, self.j
        rest = d * (self.behind - (other.low if d > 0 else other.high))
        if rest < room:
            return rest, self.p
        if not rest > room:
            raise UndecidedError("which of two cells reaches its stop first")
        return room, self.j

    def others_hold(self, way: Ball) -> None:
        """Prove that λ stays in the windows of all held cells."""
        windows = [
            self.walk.window(i)
            for i, stand in enumerate(self.walk.stands)
            if i not in (self.j, self.p) and stand.mode == HELD
        ]
        end = high(way)
        for side, sign in ((0, 1), (1, -1)):
            bounds = [bound for one in windows if (bound := one[side]) is not None]
            if not bounds:
                continue
            nearest = reduce(lambda a, b, n=sign: b if n * (b - a) > 0 else a, bounds)

            def room(x: Ball, bound: Ball = nearest, sign: int = sign) -> tuple[Ball, Ball]:
                value, slope = self.level(x)
                return sign * (value - bound), sign * slope

            if not balls.positive(room, ball(0.0), end):
                raise UndecidedError("a third cell is released in the snap")

    def arrive(self, way: Ball, stops: int) -> None:
        """Put both cells behind a way; `stops` is the cell that is at its stop, or -1."""
        walk, d = self.walk, self.d
        if not walk.rigid and not walk.dead:
            walk.force = self.force - d * self.stiffness * way
        # Where none is at a stop, both slide up to the landing.
        sense = d if stops < 0 else 0
        _arrive(walk, self.j, self.begin + d * way, d if stops == self.j else 0, sense)
        if self.other is not None:
            _arrive(walk, self.p, self.behind - d * way, -d if stops == self.p else 0, -sense)


def _along_line(walk: EnclosedWalk, d: int, j: int, p: int) -> str:
    """The leader moves by x with the drive, its partner against it, while the pull is larger."""
    line = _Line(walk, d, j, p)
    ends, stops = line.end()
    limit = low(ends)
    flat = walk.due == FOLD or (walk.dead and walk.trigger[0] == j)
    begin = _leave(lambda x, lean: line.pull(x, d * lean)[1:], limit, flat, line.blur)
    zero = balls.first_zero(lambda x: line.pull(x)[:2], begin, limit)
    way = ends if zero is None else zero
    if not walk.dead:
        try:
            line.others_hold(way)
        except UndecidedError:
            if not walk.rigid:
                raise
            return _with_others(line, begin, ends if zero is None and stops == j else None)
    line.arrive(way, stops if zero is None else -1)
    last = p if stops == j else j
    try:
        _settle(walk, d)
    except UndecidedError:
        if zero is not None or not walk.rigid or last < 0:
            raise
        _without_range(walk)
        # The force of the one that is left releases other cells: the snap goes on.
        follow(walk, {last: walk.stands[last].travel})
        _settle(walk, d)
        return FLOW
    return LINE


def _with_others(line: _Line, begin: Ball, room: Ball | None) -> str:
    """The landing where other cells may be released; `room` is the leader's way to its stop."""
    if room is not None:
        try:
            return _race(line.walk, line.d, line.j, line.p, room)
        except UndecidedError:
            pass
    return _flow(line, begin)


def _blur(walk: EnclosedWalk, i: int) -> Ball:
    """How well it is known where the kink is at which a cell stands."""
    return walk.stands[i].travel.rad() if walk.at_turn(i) else ball(0.0)


def _leave(
    slopes: Callable[[Ball, int], tuple[Ball, Ball]], limit: Ball, flat: bool, blur: Ball
) -> Ball:
    """A way up to which the pull has grown from 0, by its slope, or its second one from a fold.

    Args:
        slopes: the first and the second slope at a way; with 1, those behind a kink in it.
        limit: the longest way.
        flat: whether the slope is 0 at the start.
        blur: how well the place of a kink at the start is known.
    """
    way = limit
    for _ in range(60):
        way = balls.middle(way / 4)
        start = balls.middle(way * _AT_START + 4 * blur)
        if not start < way:
            break
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


def _flow(line: _Line, begin: Ball) -> str:
    """Follow the flow from a place on the line at which no other cell is released yet."""
    walk, way = line.walk, begin
    _without_range(walk)
    for _ in range(30):
        try:
            line.others_hold(way)
            break
        except UndecidedError:
            way = balls.middle(way / 4)
    else:
        raise UndecidedError("a third cell is released at the beginning of the snap")
    ahead, back = line.begin + line.d * way, line.behind - line.d * way
    follow(walk, {line.j: ahead, line.p: back})
    _settle(walk, line.d)
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
    _settle(walk, d)
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


def _behind_rising(walk: EnclosedWalk, d: int, j: int, others: list[int]) -> str:
    cell, s0, force, drive = walk.cells[j], walk.stands[j].travel, walk.force, walk.drive()
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
    begin = _leave(slopes, limit, walk.due == FOLD, _blur(walk, j))
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
    _settle(walk, d)
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


def _arrive(walk: EnclosedWalk, i: int, travel: Ball, stop: int, sense: int = 0) -> None:
    """Put a cell where it lands: at a stop, or on a branch, up to which it slides in a sense."""
    cell = walk.cells[i]
    if stop:
        if cell.leads[stop > 0]:
            raise UndecidedError("a curve that folds back")
        walk.stands[i] = Stand(HELD, cell.high if stop > 0 else cell.low)
    elif cell.rubs and sense:
        walk.stands[i] = Stand(SLIDES, travel, walk.branch_at(cell, travel, 0), sense)
    elif cell.rubs:
        walk.stands[i] = Stand(HELD, travel)
    else:
        walk.stands[i] = Stand(FREE, travel, walk.branch_at(cell, travel, 0))


def _settle(walk: EnclosedWalk, d: int) -> None:
    """λ after a snap by a drive in a sense, and proof that all held cells stay."""
    free = [i for i, stand in enumerate(walk.stands) if stand.mode != HELD]
    if walk.rigid:
        walk.force = (
            walk.cells[free[0]].law(walk.stands[free[0]].travel)[0] + walk.offset(free[0])
            if free
            else None
        )
    held = [i for i, stand in enumerate(walk.stands) if stand.mode == HELD]
    stays = (
        walk.windows_meet() if walk.force is None else all(walk.stays(i, walk.force) for i in held)
    )
    if not stays:
        raise UndecidedError("whether a further snap follows at once")
    for i in free:
        # It has slid up to the landing against λ. As the drive goes on, λ goes with it, unless a
        # falling cell leads: then one whose force falls has stopped, and another one slides on.
        if walk.stands[i].sense == -d and walk.branch(i).sign <= 0:
            walk.hold(i)
