"""The overdamped flow of a snap at a prescribed stroke, enclosed step by step to its landing.

Each step of time h encloses s(h) = s + h v + h²/2 s'' with s'' from a box that holds the whole step
(Moore 1966), and v from its mean value form. Where a cell may meet a stop or leave it, the step is
of first order, with all forces λ that either case gives.
"""

import math
from dataclasses import replace
from functools import reduce

from stepwell.proof import balls
from stepwell.proof.balls import Ball, UndecidedError, ball, high, hull, low
from stepwell.proof.tube import follow
from stepwell.proof.walk import FREE, HELD, EnclosedWalk, Stand

# Steps as a fraction of the shortest time scale 1/(m |κ|), one after the other where a flow is not
# enclosed, and the number of steps of the first one.
_STEPS, _MOST_STEPS = (0.04, 0.01), 600
# A box wider than this fraction of the travel leads nowhere.
_WIDE = 0.2


def land(walk: EnclosedWalk, places: dict[int, Ball]) -> None:
    """Follow the flow of a snap from enclosed travels, and put the walk at its landing.

    Raises:
        UndecidedError: its landing is not proved.
    """
    stands = [replace(stand) for stand in walk.stands]
    try:
        follow(walk, places)
        return
    except UndecidedError as why:
        walk.stands, cause = stands, why
        if not any(cell.rubs for cell in walk.cells):
            raise
    for step in _STEPS:
        stands = [replace(stand) for stand in walk.stands]
        try:
            EnclosedFlow(walk, dict(places), step).land()
            return
        except UndecidedError as why:
            walk.stands, cause = stands, why
    raise cause


class EnclosedFlow:
    """Cells in a snap: those that move or may move, each with a ball of travel; others are held."""

    def __init__(self, walk: EnclosedWalk, places: dict[int, Ball], step: float):
        self.walk, self.s, self.step = walk, places, step
        self.total = ball(0.0)
        for i, stand in enumerate(walk.stands):
            self.total = self.total + places.get(i, stand.travel)
        self.mobility = {i: ball(m) for i, m in enumerate(walk.mobility)}

    def land(self) -> None:
        """Follow the flow until its landing is proved, and put the walk there."""
        for step in range(round(_MOST_STEPS * _STEPS[0] / self.step)):
            if len(self.s) == 1 and self._put_last():
                return
            if step % 8 == 7 and (self._is_trapped() or self._pair_ends()):
                return
            if len(self.s) > 1:
                self._step()
            widths = [float(s.rad()) / self.walk.cells[i].size for i, s in self.s.items()]
            if max(widths, default=0.0) > _WIDE:
                break
        raise UndecidedError("the flow of a snap is not enclosed narrowly enough")

    def _stops(self, i: int) -> tuple[Ball, Ball]:
        return self.walk.cells[i].low, self.walk.cells[i].high

    def _touches(self, i: int, s: Ball) -> bool:
        a, b = self._stops(i)
        return not (s > a and s < b)

    def _rates(self, at: dict[int, Ball]) -> tuple[dict[int, Ball], dict[int, Ball], Ball, bool]:
        """Velocities and slopes κ in a box, λ, and whether each cell moves for certain."""
        laws = {i: self.walk.cells[i].law(s) for i, s in at.items()}
        force, moving = self._level(at, {i: law[0] for i, law in laws.items()})
        rates = {i: self._rate(i, law[0], force, moving) for i, law in laws.items()}
        return rates, {i: law[1] for i, law in laws.items()}, force, len(moving) == len(at)

    def _rate(self, i: int, own: Ball, force: Ball, moving: dict[int, Ball]) -> Ball:
        m, rub = self.mobility[i], self.walk.cells[i].friction
        if i in moving:
            return m * (force - moving[i])
        up, down, still = m * (force - own - rub), m * (force - own + rub), ball(0.0)
        if up > 0 or down < 0:
            # One that is pressed against its stop moves up to it, and stays there.
            return up if up > 0 else down
        fast, slow = max(high(up), still), min(low(down), still)
        return hull(fast, slow)

    def _level(self, at: dict[int, Ball], own: dict[int, Ball]) -> tuple[Ball, dict[int, Ball]]:
        """λ in a box, and the forces with friction of the cells that move for certain."""
        moving = {
            i: own[i]
            for i, s in at.items()
            if not self.walk.cells[i].rubs and not self._touches(i, s)
        }
        ends = {i: own[i] + self.walk.cells[i].friction * ball(0.0, 1.0) for i in at}
        while (more := self._next_mover(at, own, ends, moving)) is not None:
            moving[more[0]] = more[1]
        unsure = [i for i in at if i not in moving]
        if not moving:
            # λ is a mean of the forces of those that move.
            return reduce(hull, ends.values()), moving
        mass = sum((self.mobility[i] for i in moving), ball(0.0))
        force = sum((self.mobility[i] * f for i, f in moving.items()), ball(0.0)) / mass
        for i in unsure:
            # λ with the cell lies between λ without it and the cell's own force.
            share = self.mobility[i] / (mass + self.mobility[i])
            force = hull(force, force + share * (ends[i] - force))
        return force, moving

    def _next_mover(self, at, own, ends, moving) -> tuple[int, Ball] | None:
        """A cell that moves whichever of the other ones do, with its force and friction."""
        for i, s in at.items():
            others = [moving.get(k, ends[k]) for k in at if k != i]
            if i in moving or not others:
                continue
            # λ without the cell is a mean of the forces of others.
            force, rub = reduce(hull, others), self.walk.cells[i].friction
            a, b = self._stops(i)
            if force > own[i] + rub and not s.overlaps(b):
                return i, own[i] + rub
            if force < own[i] - rub and not s.overlaps(a):
                return i, own[i] - rub
        return None

    def _step(self) -> None:
        rates, slopes, _, _ = self._rates(self.s)
        pace = 0.0
        for i in self.s:
            # Where forces are constant, the time scale is that of the way.
            way = float(high(abs(rates[i]))) / self.walk.cells[i].size
            pace = max(pace, float(high(abs(slopes[i] * self.mobility[i]))), way)
        if not 0.0 < pace < math.inf:
            raise UndecidedError("the pace of the flow of a snap")
        h = ball(self.step / pace)
        h = self._short_of_stops(h, rates)
        for _ in range(40):
            around = self._around(h)
            if around is not None and not self._released(around):
                break
            h = h if around is not None else h / 2
        else:
            raise UndecidedError("a step of the flow is not enclosed")
        rates, slopes, _, smooth = self._rates(around)
        self.s = self._second(h, rates, slopes) if smooth else self._first(h, rates)
        self._close()
        self._hold_arrived()
        self._hold_stuck(around)

    def _short_of_stops(self, h: Ball, rates: dict[int, Ball]) -> Ball:
        """A step that ends before a stop, or one that brings the whole box of a cell to it."""
        for i, s in self.s.items():
            a, b = self._stops(i)
            rate, size = rates[i], self.walk.cells[i].size
            if not (rate > 0 or rate < 0):
                continue
            stop, front, rear = (b, high(s), low(s)) if rate > 0 else (a, low(s), high(s))
            gap, speed = abs(stop - front), abs(rate)
            if s.overlaps(stop) or gap < 1e-6 * size + 4 * s.rad():
                need = high(abs(stop - rear) / low(speed)) * ball(1.02)
                h = min(h, balls.middle(need))
            else:
                h = min(h, balls.middle(ball(0.7) * gap / high(speed)))
        return balls.middle(h)

    def _around(self, h: Ball) -> dict[int, Ball] | None:
        """A box that holds the flow from every place of the present one for a time h."""
        time = hull(ball(0.0), h)
        guess = {i: self._clip(i, s) for i, s in self.s.items()}
        for _ in range(4):
            rates = self._rates(guess)[0]
            wider = {}
            for i, s in self.s.items():
                way = time * rates[i]
                wider[i] = self._clip(i, s + way + way * ball(0.0, 0.1))
            rates = self._rates(wider)[0]
            if all(
                wider[i].contains(self._clip(i, s + time * rates[i])) for i, s in self.s.items()
            ):
                return wider
            guess = wider
        return None

    def _clip(self, i: int, s: Ball) -> Ball:
        a, b = self._stops(i)
        left, right = low(s), high(s)
        return (
            hull(max(left, a), min(right, b))
            if left < b and right > a
            else hull(min(max(left, a), b), min(max(right, a), b))
        )

    def _released(self, around: dict[int, Ball]) -> bool:
        """Let held cells move that may be released in a box; whether there are any."""
        return self._release(self._rates(around)[2])

    def _release(self, force: Ball) -> bool:
        """Let held cells move that λ may release; whether there are any."""
        found = False
        for i, stand in enumerate(self.walk.stands):
            if i not in self.s and not self.walk.stays(i, force):
                self.s[i], found = stand.travel, True
        return found

    def _first(self, h: Ball, rates: dict[int, Ball]) -> dict[int, Ball]:
        return {i: self._clip(i, s + h * rates[i]) for i, s in self.s.items()}

    def _second(self, h: Ball, rates, slopes) -> dict[int, Ball]:
        """s + h v + h²/2 s'', with v in mean value form."""
        middles = {i: balls.middle(s) for i, s in self.s.items()}
        at_middle = self._rates(middles)[0]
        here = {i: self.walk.cells[i].law(s)[1] for i, s in self.s.items()}
        mass = sum((self.mobility[i] for i in self.s), ball(0.0))
        bend = sum((self.mobility[i] * slopes[i] * rates[i] for i in self.s), ball(0.0)) / mass
        out = {}
        for i, s in self.s.items():
            m = self.mobility[i]
            own = (s - middles[i]) * (1 - h * m * here[i] * (1 - m / mass))
            for k, other in self.s.items():
                if k != i:
                    own = own + h * m * self.mobility[k] * here[k] * (other - middles[k]) / mass
            second = m * (bend - slopes[i] * rates[i])
            out[i] = middles[i] + h * at_middle[i] + own + h * h * second / 2
        return {i: self._clip(i, s) for i, s in out.items()}

    def _close(self) -> None:
        """Use that the stroke is constant: each travel is the rest of the others."""
        held = sum(
            (stand.travel for i, stand in enumerate(self.walk.stands) if i not in self.s), ball(0.0)
        )
        for i, s in self.s.items():
            others = sum((t for k, t in self.s.items() if k != i), ball(0.0))
            rest = self.total - held - others
            if rest.overlaps(s):
                self.s[i] = rest.intersection(s)

    def _hold_stuck(self, around: dict[int, Ball]) -> None:
        """Hold cells whose friction is proved to hold them during a whole step."""
        force = self._rates(around)[2]
        for i, s in list(self.s.items()):
            own, rub = self.walk.cells[i].law(around[i])[0], self.walk.cells[i].friction
            if len(self.s) > 1 and own - rub < force and force < own + rub:
                self.walk.stands[i] = Stand(HELD, s)
                del self.s[i]

    def _hold_arrived(self) -> None:
        """Hold cells whose whole ball is at a stop, if λ presses them against it."""
        for i in list(self.s):
            a, b = self._stops(i)
            at = b if low(self.s[i]) >= b else a if high(self.s[i]) <= a else None
            if at is None:
                continue
            cell = self.walk.cells[i]
            force, own = self._rates(self.s)[2], cell.law(at)[0]
            if (at == b and force > own - cell.friction) or (
                at == a and force < own + cell.friction
            ):
                if self.walk.cells[i].leads[bool(at == b)]:
                    raise UndecidedError("a curve that folds back")
                del self.s[i]
                self.walk.stands[i] = Stand(HELD, at)

    def _put_last(self) -> bool:
        """The only cell that is not at a stop takes the rest of the stroke.

        False if its force may release another one: then the flow goes on with it.
        """
        (i,) = self.s
        cell = self.walk.cells[i]
        held = sum((t.travel for k, t in enumerate(self.walk.stands) if k != i), ball(0.0))
        travel = self.total - held
        self.s[i] = travel
        if cell.rubs:
            return self._rests_by_friction(i)
        if self._release(cell.law(travel)[0]):
            return False
        self.walk.stands[i] = Stand(FREE, travel, self.walk.branch_at(cell, travel, 0))
        return True

    def _rests_by_friction(self, last: int) -> bool:
        """Whether some λ holds all cells: then the last one rests; if not, others may leave."""
        walk = self.walk
        walk.stands[last] = Stand(HELD, self.s[last])
        if walk.windows_meet():
            return True
        own_down, own_up = walk.window(last)
        for i in range(len(walk.cells)):
            down, up = walk.window(i)
            if i != last and not (
                (down is None or down < own_up) and (up is None or up > own_down)
            ):
                self.s[i] = walk.stands[i].travel
        if len(self.s) == 1:
            raise UndecidedError("which cells are held by friction after a snap")
        return False

    def _is_trapped(self) -> bool:
        """Whether the flow is near a rest around which the energy is convex: put the walk there."""
        walk, cells = self.walk, self.walk.cells
        if any(self._touches(i, s) or cells[i].rubs for i, s in self.s.items()):
            return False
        before = {i: walk.stands[i] for i in self.s}
        try:
            for i, s in self.s.items():
                walk.stands[i] = Stand(FREE, balls.middle(s), walk.branch_at(cells[i], s, 0))
            rest = self._trap()
            for i, s in rest.items():
                walk.stands[i] = Stand(FREE, s, walk.branch_at(cells[i], s, 0))
        except UndecidedError:
            walk.stands = [before.get(i, stand) for i, stand in enumerate(walk.stands)]
            return False
        return True

    def _trap(self) -> dict[int, Ball]:
        """The rest, and proof that the energy is convex in a ball around it which holds the box."""
        walk, cells = self.walk, self.walk.cells
        if any(walk.branch(i).sign <= 0 for i in self.s):
            raise UndecidedError("a falling cell")
        rest = self._rest()
        radius = ball(0.0)
        for i, s in self.s.items():
            radius = radius + (s - rest[i]) * (s - rest[i]) / self.mobility[i]
        radius = high(high(radius).sqrt())
        near = {i: rest[i] + radius * self.mobility[i].sqrt() * ball(0.0, 1.0) for i in rest}
        if any(not cells[i].law(s)[1] > 0 or self._touches(i, s) for i, s in near.items()):
            raise UndecidedError("not convex")
        force = self._rates(near)[2]
        if not all(walk.stays(i, force) for i in range(len(cells)) if i not in self.s):
            raise UndecidedError("a release")
        return rest

    def _pair_ends(self) -> bool:
        """Whether two cells are proved to go on to a rest: put them there; or one to its stop."""
        pair = self._pair()
        if pair is None:
            return False
        walk, first = self.walk, pair.first
        try:
            zero = pair.rest()
            if not self._others_hold(pair, high(pair.end if zero is None else zero)):
                return False
            if zero is None:
                # The one that arrives is held; the other one may release more cells then.
                walk.stands[first] = Stand(HELD, self._stops(first)[first == pair.a])
                del self.s[first]
                return False
            stands = {
                i: Stand(HELD, s)
                if walk.cells[i].rubs
                else Stand(FREE, s, walk.branch_at(walk.cells[i], s, 0))
                for i, s in ((pair.a, zero), (pair.b, pair.total - zero))
            }
        except UndecidedError:
            return False
        for i, stand in stands.items():
            walk.stands[i] = stand
        return True

    def _pair(self) -> "_Pair | None":
        """Two cells that certainly move, one up and one down; None if it is not so."""
        if len(self.s) != 2 or any(self._touches(i, s) for i, s in self.s.items()):
            return None
        rates = self._rates(self.s)[0]
        ahead, behind = [i for i in self.s if rates[i] > 0], [i for i in self.s if rates[i] < 0]
        if len(ahead) != 1 or len(behind) != 1:
            return None
        pair = _Pair(self, ahead[0], behind[0])
        one, two = pair.ends
        return pair if one < two or one > two else None

    def _others_hold(self, pair: "_Pair", end: Ball) -> bool:
        """Whether λ stays in the windows of all cells that do not move."""
        for i in range(len(self.walk.cells)):
            if i in self.s:
                continue
            for bound, sign in zip(self.walk.window(i), (1, -1), strict=True):
                if bound is not None and not balls.positive(
                    lambda s, b=bound, n=sign: pair.room(s, b, n), pair.begin, end
                ):
                    return False
        return True

    def _rest(self) -> dict[int, Ball]:
        """Travels at rest of cells on rising branches: one force, and the present stroke."""
        walk, moving = self.walk, list(self.s)
        forces = [walk.cells[i].law(s)[0] for i, s in self.s.items()]
        least = min((low(f) for f in forces), key=float)
        most = max((high(f) for f in forces), key=float)

        def miss(force: Ball) -> tuple[Ball, Ball]:
            drive, soft = walk.drive_by_force(moving, force)
            return self.total - drive, -soft

        force = balls.first_zero(miss, least, most)
        if force is None:
            raise UndecidedError("no rest")
        return {i: walk.cells[i].invert(walk.branch(i), force) for i in moving}


class _Pair:
    """Two cells of a flow that move along a line: a upwards, b downwards, by equal ways."""

    def __init__(self, flow: EnclosedFlow, a: int, b: int):
        self.a, self.b = a, b
        self.one, self.two, self.begin = flow.walk.cells[a], flow.walk.cells[b], low(flow.s[a])
        self.total = flow.total - flow.walk.resting(set(flow.s))
        # Travels of a at which either one is at its stop.
        self.ends = self.one.high, self.total - self.two.low
        self.first, self.end = (a if self.ends[0] < self.ends[1] else b), min(*self.ends)
        self.share = flow.mobility[b] / (flow.mobility[a] + flow.mobility[b])

    def pull(self, s: Ball) -> tuple[Ball, Ball]:
        """The force that drives both, and its slope."""
        own, its = self.one.law(s), self.two.law(self.total - s)
        return its[0] - own[0] - self.one.friction - self.two.friction, -its[1] - own[1]

    def rest(self) -> Ball | None:
        """The first travel of a without a pull."""
        return balls.first_zero(self.pull, self.begin, low(self.end))

    def room(self, s: Ball, bound: Ball, sign: int) -> tuple[Ball, Ball]:
        """How far λ is from a bound, and the slope."""
        share, own, its = self.share, self.one.law(s), self.two.law(self.total - s)
        force = share * (its[0] - self.two.friction) + (1 - share) * (own[0] + self.one.friction)
        return sign * (force - bound), sign * ((1 - share) * own[1] - share * its[1])
