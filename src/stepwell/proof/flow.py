"""The flow of a snap with friction, enclosed in a tube too, and the choice of the tube.

Let P(a) be the velocities of the flow for the driving forces a: the least of Σ v²/2m - a v + f |v|
over all v with Σ v = 0. |P(a) - P(b)| is at most |a - b| in the metric of mobilities, so two flows
part at most at the largest m |κ|. While the tube shows in which sense each cell slides, or that it
rests, friction only shifts forces, and the rate is that of a flow without it.
"""

import math
from collections.abc import Iterator

import numpy as np

from stepwell.proof import balls
from stepwell.proof.balls import UNIT, Ball, UndecidedError, ball, high, hull, low
from stepwell.proof.leaving import Cone, SplitRadius, slowest
from stepwell.proof.motion import FlowMotion, derivative, value, when
from stepwell.proof.tube import MOST_STEPS, WIDE, Tube
from stepwell.proof.walk import HELD, EnclosedWalk, Stand, windows_meet

# A cell comes to rest, or lets go, for certain within a time of this many widths of the tube.
_MARGIN = 8.0
_CAUSE = "which cells friction holds in the flow of a snap"


def follow(
    walk: EnclosedWalk,
    places: dict[int, Ball],
    radius: Ball | None = None,
    box: dict[int, Ball] | None = None,
    parts: SplitRadius | None = None,
) -> None:
    """Follow the flow of a snap from enclosed travels, and put the walk at its landing.

    Args:
        walk: the chain; cells that are not in `places` are held.
        places: travels of the others.
        radius: of a ball around the places that holds the flow, in the metric of mobilities.
        box: travels within which each cell of `places` with friction slides on in its sense.
        parts: the radius in parts.

    Raises:
        UndecidedError: its landing is not proved.
    """
    tube = (RubbedTube if any(cell.rubs for cell in walk.cells) else Tube)(walk, places)
    if radius is not None:
        before, tube.radius = tube.radius, high(tube.radius + radius)
        if isinstance(tube, RubbedTube):
            tube.begin(before, box, parts)
    for step in range(MOST_STEPS):
        alone = tube.is_alone() and tube.put_last()
        if alone or tube.all_rest() or (step % 8 == 7 and tube.lands()):
            _away_from_stops(walk)
            return
        tube.step()
        if tube.width() > WIDE:
            break
    raise UndecidedError("the flow of a snap is not enclosed narrowly enough")


def _ratio(width: float, rate: float) -> float:
    """The time of some widths at a rate."""
    return _MARGIN * width / abs(rate) if rate else math.inf


def _away_from_stops(walk: EnclosedWalk) -> None:
    """Prove that each cell is exactly at a stop, or at none."""
    for cell, stand in zip(walk.cells, walk.stands, strict=True):
        for stop in (cell.low, cell.high):
            if stand.travel.overlaps(stop) and not stand.travel == stop:
                raise UndecidedError("whether a cell is at its stop after a snap")


class RubbedTube(Tube):
    """A tube of cells some of which have friction."""

    def __init__(self, walk: EnclosedWalk, places: dict[int, Ball]):
        super().__init__(walk, places)
        self.stuck = {i for i in self.middle if self.cells[i].rubs}
        # Cells that were let go in this step, and the longest step in which cells are let go.
        self.fresh: set[int] = set()
        self.least = math.inf
        # A bound of the speed of the middle in a step, and whether it crosses a joint or a stop.
        self.pace, self.crosses = ball(math.inf), False
        # Travels within which all senses are known, and whether the middle has those senses.
        self.box: dict[int, Ball] | None = None
        self.obeys = True
        # The radius in parts, if they are known, and those after a step.
        self.parts: SplitRadius | None = None
        self.later: SplitRadius | None = None
        # The radius whose parts these are; what is added to it counts in both.
        self.split_at = self.radius
        # The least speeds of the cells of the middle that slide, in a step.
        self.speeds: dict[int, Ball] = {}
        # λ of the middle in a step, if the middle obeys friction in it exactly.
        self.known: Ball | None = None

    def begin(self, before: Ball, box: dict[int, Ball] | None, parts: SplitRadius | None) -> None:
        """Begin in a box within which each cell with friction slides on in its sense.

        Args:
            before: the radius by rounding alone.
            box: the travels.
            parts: the rest of the radius, in parts.
        """
        self.parts, self.split_at = parts and parts.wider(before), self.radius
        if box is None:
            return
        self.box = box
        self.sense = {i: self.walk.stands[i].sense for i in self.stuck}
        self.stuck = set()

    def _in_box(self, tube: dict[int, Ball]) -> bool:
        """Whether all senses are known in a tube since the flow has not left the box."""
        return self.box is not None and all(
            i in self.box and self.box[i].contains(s) for i, s in tube.items()
        )

    def _pin(self, level: Ball, tube: dict[int, Ball], time: Ball) -> None:
        self.parts = self.later and self.later.wider(high(self.radius - self.later.radius()))
        self.split_at = self.radius
        super()._pin(level, tube, time)
        if not self._in_box(tube):
            self.box = None

    # Which cells slide in the middle of the tube: hints.

    def _at(self, i: int) -> float:
        return balls.number(self.cells[i].law(ball(self.middle[i]))[0])

    def _rub(self, i: int) -> float:
        return balls.number(self.cells[i].friction)

    def _mean(self) -> tuple[float, float]:
        """λ in the middle of the tube, and its rate."""
        laws = {i: self.cells[i].law(ball(self.middle[i])) for i in self._movers()}
        force = {i: balls.number(law[0] + self.shift(i)) for i, law in laws.items()}
        mass = sum(self.m[i] for i in laws)
        level = sum(self.m[i] * f for i, f in force.items()) / mass
        ways = {i: self.m[i] * (level - f) for i, f in force.items()}
        slopes = {i: balls.number(law[1]) for i, law in laws.items()}
        return level, sum(self.m[i] * slopes[i] * ways[i] for i in laws) / mass

    def _release(self) -> None:
        for _ in range(8 * len(self.cells)):
            if not self._movers() and not self._first_two():
                return
            if self.box is not None or not self._changed(*self._mean()):
                return
        raise UndecidedError(_CAUSE)

    def _first_two(self) -> bool:
        """Let the two cells slide whose forces are farthest apart; whether friction allows it."""
        force = {i: self._at(i) for i in self.middle}
        ups = {i: f + self._rub(i) for i, f in force.items() if not self._stops(i, 1)}
        downs = {i: f - self._rub(i) for i, f in force.items() if not self._stops(i, -1)}
        if not ups or not downs:
            return False
        up, down = min(ups, key=ups.__getitem__), max(downs, key=downs.__getitem__)
        if not downs[down] > ups[up]:
            return False
        for i, sense in ((up, 1), (down, -1)):
            self.rests.pop(i, None)
            self.gap.pop(i, None)
            if self.cells[i].rubs:
                self.stuck.remove(i)
                self.sense[i] = sense
        return True

    def _changed(self, level: float, rate: float) -> bool:
        """Change the state of one cell that contradicts λ; whether there is one."""
        for i, sense in list(self.rests.items()):
            if not sense * (level - self._at(i) - balls.number(self.shift(i))) > 0.0:
                if i in self.sense:
                    raise UndecidedError(_CAUSE)
                del self.rests[i], self.gap[i]
                return True
        # One cell alone does not move: whichever way it slides, it rests.
        sliding = list(self.sense.items()) if len(self._movers()) > 1 else []
        for i, sense in sliding:
            if i not in self.rests and sense * (level - self._at(i)) - self._rub(i) < 0.0:
                del self.sense[i]
                self.stuck.add(i)
                return True
        for i in list(self.stuck):
            gap = level - self._at(i)
            sense = 1 if gap > 0.0 else -1
            over = sense * gap - self._rub(i)
            # One that has just come to rest may be over by the width of a step, or of the tube.
            grows = sense * rate > 0.0 or over > 1e-9 * self._rub(i) + self._haze()
            if over > 0.0 and grows and not self._stops(i, sense):
                self.stuck.remove(i)
                self.sense[i] = sense
                return True
        return self._rest_again(level)

    def _haze(self) -> float:
        """About by how much forces vary in the tube."""
        slopes = ((i, self.cells[i].law(ball(s))[1]) for i, s in self.middle.items())
        return max(abs(balls.number(k)) * self._half(i) for i, k in slopes)

    # Steps up to the next change of a cell with friction.

    def step(self) -> None:
        """Go on up to the next joint, stop, or change of a cell with friction."""
        if self.box is not None:
            super().step()
            return
        motion = self._begin()
        level = self.levels(self._now())
        if level is not None and self._hold_certain(level):
            motion = self._begin()
        self.fresh.clear()
        h = self._length(motion)
        wide = float(level.rad()) if level is not None else 0.0
        self.least = _MARGIN * wide / abs(motion.force[1]) if motion.force[1] else h
        unsure = [] if level is None else list(self._unsure(motion, level, wide))
        h = min([h, *(max(time, 1e-6 * h) for time in unsure), *self._landing_times(motion)])
        change = self._change(motion, h, wide)
        event = self._event(motion, h if change is None else change[1])
        if change is None or (event is not None and event[1] <= change[1]):
            near = self._near(motion, event)
            if event is not None and event[1] > 2.0 * near:
                self._smooth(motion, event[1] - near)
            else:
                self._go(motion, h, event)
            return
        self._go_to_change(motion, *change)

    def _go_to_change(self, motion: FlowMotion, i: int, time: float, short: float) -> None:
        """Go on up to where a cell may come to rest or let go, or change its state there."""
        if time > 2.0 * short:
            self._smooth(motion, time - short)
        elif i in self.stuck:
            self._smooth(motion, time + 1e-3 * short)
        elif i not in self.middle:
            self._free(i)
        elif time > 2e-3 * short:
            self._smooth(motion, time - 1e-3 * short)
        else:
            del self.sense[i]
            self.stuck.add(i)

    def _landing_times(self, motion: FlowMotion) -> list[float]:
        """Times in which the tube is about as long at stops as it has to be."""
        out = []
        for i, sense in self.rests.items():
            speed = self.m[i] * sense * (motion.force[0] - balls.number(self._force_now(i)))
            if speed > 0.0 and self.gap[i] > 0:
                gap = max(float(self.gap[i]), 0.1 * self._half(i))
                out.append(1.5 * gap / speed)
        return out

    def _force_now(self, i: int) -> Ball:
        return self._force(i, ball(self.middle[i]))

    def _half(self, i: int) -> float:
        """Half the width of the tube along a travel."""
        return float(self.radius) * math.sqrt(self.m[i])

    def _near(self, motion: FlowMotion, event: tuple[int, float, int] | None) -> float:
        """The time before a stop at which the tube meets it."""
        if event is None or not event[2]:
            return math.inf
        i, time, _ = event
        speed = abs(sum(k * c * time ** (k - 1) for k, c in enumerate(motion.travel[i]) if k))
        return 2.0 * self._half(i) / speed if speed else math.inf

    def _now(self) -> dict[int, Ball]:
        here = {i: ball(x) for i, x in self.middle.items()}
        return self.around(here, high(self.radius + self._drift() * self._inverse_root))

    def _hold_certain(self, level: Ball) -> bool:
        """Hold cells that friction holds for certain; whether there are any."""
        found = False
        for i in list(self.stuck - self.fresh):
            if len(self.middle) > 1 and i != self.taker and self._surely_rests(i, level):
                wide = self.radius * ball(self.m[i]).sqrt()
                at = self.around({i: ball(self.middle[i])}, self.radius)[i]
                self.walk.stands[i] = Stand(HELD, at)
                self.radius = high(self.radius + wide * self._inverse_root)
                self.stuck.remove(i)
                del self.middle[i]
                found = True
        return found

    def _surely_rests(self, i: int, level: Ball) -> bool:
        cell, at = self.cells[i], self._now()[i]
        force, rub = cell.law(at)[0], cell.friction
        a, b = at == cell.low, at == cell.high
        return bool((b or level < force + rub) and (a or level > force - rub))

    def _unsure(self, motion: FlowMotion, level: Ball, wide: float) -> Iterator[float]:
        """For each cell that may slide or rest, the time after which it is known."""
        for i in self.stuck:
            yield _ratio(wide + self._blur(i), motion.force[1])
        for i in self.sense:
            if i in motion.travel and not self._surely_slides(i, level, self._now()):
                yield _ratio(wide + self._blur(i), 2.0 * motion.travel[i][2] / self.m[i])

    def _blur(self, i: int) -> float:
        return float(self.cells[i].law(self._now()[i])[0].rad())

    def _surely_slides(self, i: int, level: Ball, tube: dict[int, Ball]) -> bool:
        return bool(self.sense[i] * (level - self._force(i, tube[i])) > 0)

    def _change(self, motion: FlowMotion, h: float, wide: float) -> tuple[int, float, float] | None:
        """The next change of a cell with friction: the cell, the time, and its margin."""
        first: tuple[int, float, float] | None = None

        def look(i: int, row: list[float], mark: float, blur: float) -> None:
            nonlocal first
            time = when(row, mark, h if first is None else first[1])
            if time is not None:
                rate = abs(sum(k * c * time ** (k - 1) for k, c in enumerate(row) if k))
                first = i, time, _MARGIN * (wide + blur) / rate if rate else h

        for i, sense in self.sense.items():
            if i in motion.travel:
                row = [sense * k * c / self.m[i] for k, c in enumerate(motion.travel[i]) if k]
                look(i, row, 0.0, self._blur(i))
        for i, cell in enumerate(self.cells):
            if not cell.rubs or i in motion.travel or i in self.rests:
                continue
            at = ball(self.middle[i]) if i in self.middle else self.walk.stands[i].travel
            force, rub = cell.law(at)[0], balls.number(cell.friction)
            blur = self._blur(i) if i in self.middle else float(force.rad())
            for stop, sense in ((cell.high, 1), (cell.low, -1)):
                if at != stop:
                    look(i, motion.force, balls.number(force) + sense * rub, blur)
        return first

    def _cross(self, motion: FlowMotion, h: float, i: int, stop: int) -> None:
        self.least = math.inf
        super()._cross(motion, h, i, stop)

    def _grow(self, spans, h: float, defect: Ball, ends, motion: FlowMotion | None) -> bool | None:
        self.crosses, self.later = motion is None, None
        if self.crosses:
            # This defect holds the speed of the middle.
            self.pace, self.known = defect, None
        grown = super()._grow(spans, h, defect, ends, motion)
        # It holds in the tube of this step alone.
        self.known = None
        return grown

    def _may_free(self, loose: list[int], h: float) -> bool:
        return h <= self.least or not any(self.cells[i].rubs for i in loose)

    def _free(self, i: int) -> None:
        self.box = None
        if not self.cells[i].rubs:
            super()._free(i)
            return
        at = self.walk.stands[i].travel
        self.middle[i] = min(
            max(balls.number(at), balls.number(self.cells[i].low)), balls.number(self.cells[i].high)
        )
        root = 1 / ball(self.m[i]).sqrt() + self._inverse_root
        self.radius = high(self.radius + high(abs(at - self.middle[i])) * root)
        self.stuck.add(i)
        self.fresh.add(i)

    def _missed(self, motion: FlowMotion, h: float, defect: Ball) -> Ball | None:
        missed, over = super()._missed(motion, h, defect), self._over(motion, h)
        if missed is None or over is None:
            return None
        time = hull(ball(0.0), ball(h))
        square = ball(0.0)
        for i, c in motion.travel.items():
            way = abs(derivative([*map(ball, c)], 1, time))
            square = square + way * way / self.m[i]
        self.pace = high(high(square).sqrt() + missed)
        exact = self.obeys and over.is_zero() and missed is defect
        self.known = self._own_level(motion, h, defect) if exact else None
        return high(missed + over)

    def _own_level(self, motion: FlowMotion, h: float, defect: Ball) -> Ball:
        """λ of the middle in a step in which it obeys friction."""
        slope = self.cells[self.taker].law(motion.spans(h)[self.taker] + motion.off * UNIT)[1]
        most = max(1 / ball(self.m[i]).sqrt() for i in self.middle)
        return motion.level(h) + high(abs(slope) * motion.off + defect * most) * UNIT

    def _over(self, motion: FlowMotion, h: float) -> Ball | None:
        """By how much the middle misses the law of friction; None if a cell slides back in it."""
        time = hull(ball(0.0), ball(h))
        self.obeys = True
        self.speeds.clear()
        for i, sense in self.sense.items():
            if i in motion.travel:
                row = [k * c for k, c in enumerate(motion.travel[i]) if k]
                speed = sense * value(row, time)
                # The taker moves by what the sum of the others misses, too.
                self.speeds[i] = low(speed - (0 if i != self.taker else motion.slip))
                if not self.speeds[i] >= 0:
                    if self.box is None:
                        return None
                    self.obeys = False
        level = motion.level(h)
        total = ball(0.0)
        for i in self.stuck:
            gap = level - self.cells[i].law(ball(self.middle[i]))[0]
            rub, root = self.cells[i].friction, ball(self.m[i]).sqrt()
            if not self._stops(i, 1):
                total = total + max(high(gap - rub), ball(0.0)) * root
            if not self._stops(i, -1):
                total = total + max(high(-gap - rub), ball(0.0)) * root
        return high(total)

    # Rates at which flows in a tube part.

    def _bounds(self, tube: dict[int, Ball], defect: Ball, time: Ball) -> tuple[Ball, Ball]:
        level = self.levels(tube)
        if level is None:
            return ball(math.inf), defect
        if self._in_box(tube):
            return self._parting(tube), defect
        if not self.obeys and not self.crosses:
            return ball(math.inf), defect
        clear = self._clear(level, tube)
        if self._certain(level, tube) or (clear and self._is_fast(tube, defect, self.reach)):
            return self._parting(tube), defect
        if clear:
            return self._fastest_pace(tube), defect
        # Two flows part at most at the sum of their speeds.
        most = high(self.pace + self._fastest(tube))
        if not self.crosses and time * most > 16 * self.radius:
            return ball(math.inf), defect
        return (ball(0.0), most) if defect >= most else (ball(math.inf), high(most * 1.5))

    def _certain(self, level: Ball, tube: dict[int, Ball]) -> bool:
        """Whether each cell with friction slides in its sense, or rests, anywhere in a tube."""
        return not self.stuck and all(self._surely_slides(i, level, tube) for i in self.sense)

    def _is_fast(self, tube: dict[int, Ball], defect: Ball, reach: Ball) -> bool:
        """Whether the middle slides so fast that no velocity in a clear tube has another sense.

        Velocities differ from those of the middle by at most the pace times the radius of the tube.
        """
        if self.crosses or self.stuck:
            return False
        off = high(self._fastest_pace(tube) * reach + defect)
        return off.is_finite() and all(
            i in self.speeds and self.speeds[i] > off * ball(self.m[i]).sqrt() for i in self.sense
        )

    def _fastest_pace(self, tube: dict[int, Ball]) -> Ball:
        paces = [high(abs(self.m[i] * self.cells[i].narrow(s)[1])) for i, s in tube.items()]
        return max(paces, key=float)

    def _clear(self, level: Ball, tube: dict[int, Ball]) -> bool:
        """Whether no flow in a tube moves towards a stop that it may touch."""
        if self.rests:
            return False
        for i, s in tube.items():
            cell = self.cells[i]
            push = level - cell.law(s)[0]
            if not s < cell.high and not push < cell.friction:
                return False
            if not s > cell.low and not -push < cell.friction:
                return False
        return True

    def levels(self, tube: dict[int, Ball]) -> Ball | None:
        """A ball that has a λ of each flow in a tube, whichever cells slide; None if not found.

        While all cells rest, many λ belong to one flow, and one of them counts.
        """
        forces = {i: self.cells[i].narrow(s)[0] for i, s in tube.items()}
        if not all(f.is_finite() for f in forces.values()):
            return None
        if not self._movers():
            return None
        centre = ball(self._mean()[0])
        wide = max(*(float(f.rad()) for f in forces.values()), 1e-12 * float(self.walk.tie))
        ends = [
            self._outside(centre, sense * wide, lambda x: self._sum_of_rates(x, tube, forces))
            for sense in (-1, 1)
        ]
        return None if ends[0] is None or ends[1] is None else hull(*ends)

    def _outside(self, centre: Ball, step: float, rates) -> Ball | None:
        """A λ near a place at which no sum of velocities has the other sign than a step."""

        def is_out(way: float) -> bool:
            least, most = rates(balls.middle(centre + way))
            return bool(least >= 0 if step > 0 else most <= 0)

        inside, way = 0.0, step
        for _ in range(40):
            if is_out(way):
                break
            inside, way = way, 4.0 * way
        else:
            return None
        for _ in range(4 if inside else 0):
            half = 0.5 * (inside + way)
            inside, way = (inside, half) if is_out(half) else (half, way)
        return balls.middle(centre + way)

    def _sum_of_rates(self, level: Ball, tube, forces) -> tuple[Ball, Ball]:
        """The least and the largest sum of velocities at one λ."""
        least, most = ball(0.0), ball(0.0)
        still = ball(0.0)
        for i, s in tube.items():
            cell, m = self.cells[i], self.m[i]
            up, down = level - forces[i] - cell.friction, level - forces[i] + cell.friction
            a = low(up) if low(up) > 0 else low(down) if low(down) < 0 else still
            b = high(down) if high(down) < 0 else high(up) if high(up) > 0 else still
            if not s < cell.high:
                a = min(a, still)
            if not s > cell.low:
                b = max(b, still)
            least, most = least + m * a, most + m * b
        return low(least), high(most)

    def _level(self, tube: dict[int, Ball]) -> Ball:
        """λ of all flows in a tube, by that of the middle too.

        Forces of a flow and of the middle differ by κ times the radius, and λ by no more.
        """
        level = self.levels(tube)
        if level is None:
            raise UndecidedError(_CAUSE)
        if self.known is None or not self._clear(level, tube):
            return level
        slopes = {i: high(abs(self.cells[i].narrow(s)[1])) for i, s in tube.items()}
        off = max((k * ball(self.m[i]).sqrt() for i, k in slopes.items()), key=float) * self.reach
        near = self.known + high(off) * UNIT
        return level.intersection(near) if near.is_finite() and near.overlaps(level) else level

    def _narrower(self, motion: FlowMotion, spans, h: float, defect: Ball, known):
        radius = high(4 * self.radius + 8 * ball(h) * defect)
        around = self.around(spans, high(radius + self._drift() * self._inverse_root))
        level = self.levels(around)
        if level is None or not (
            self._in_box(around)
            or (self.obeys and self._certain(level, around))
            or (self._clear(level, around) and self._is_fast(around, defect, radius))
        ):
            return known
        if not all(self.walk.stays(i, level) for i in self._held()):
            return known
        narrower = super()._narrower(motion, spans, h, defect, known)
        later = self._later(known[0], h, (radius, defect))
        if later is not None and later.radius() < narrower[1]:
            self.later = later
            return known[0], later.radius()
        if narrower is not known:
            self.reach = radius
        return narrower

    def _later(
        self, tube: dict[int, Ball], h: float, most: tuple[Ball, Ball]
    ) -> SplitRadius | None:
        """The parts of the radius after a step; None if they are not known."""
        if self.parts is None or self.parts.cells != list(self.middle) or self.parts.has_fallen():
            return None
        try:
            slopes = [self.cells[i].law(tube[i])[1] for i in self.middle]
            parts = self.parts.wider(high(self.radius - self.split_at))
            return parts.later(slopes, h, most)
        except UndecidedError:
            return None

    # The landing.

    def put_last(self) -> bool:
        """As for a tube without friction; a last cell with friction may rest too."""
        (i,) = self.middle
        if not self.cells[i].rubs:
            return super().put_last()
        walk = self.walk
        walk.stands[i] = Stand(HELD, self._rest_of(i))
        if walk.windows_meet():
            return True
        own_down, own_up = walk.window(i)
        loose = []
        for k in self._held():
            down, up = walk.window(k)
            fits = (down is None or own_up is None or down < own_up) and (
                up is None or own_down is None or up > own_down
            )
            if not fits:
                loose.append(k)
        if not loose:
            raise UndecidedError("which cells are held by friction after a snap")
        for k in loose:
            self._free(k)
        return False

    def all_rest(self) -> bool:
        """Whether all places in the tube are rests: then the flow has landed where it is."""
        if self.rests or len(self._movers()) > 1:
            return False
        held, now, walk = self._held(), self._now(), self.walk
        windows = [walk.window(i) for i in held]
        windows += [walk.window_at(i, s) for i, s in now.items()]
        if not windows_meet(windows):
            return False
        for i, s in now.items():
            walk.stands[i] = Stand(HELD, s)
        return True

    def _keeps_senses(self, tube: dict[int, Ball]) -> bool:
        sliding = [i for i in self.sense if i in self.middle]
        if not sliding:
            return True
        now = self._now()
        level = self.levels(now)
        if level is None or not self._certain(level, now):
            return False
        # Two cells go along a line, and never come back on it.
        return len(self.middle) == 2 or self._in_cone(tube, now, level)

    def _in_cone(self, tube: dict[int, Ball], now: dict[int, Ball], level: Ball) -> bool:
        """Whether all velocities stay in a cone around those of the slowest motion."""
        order = list(self.middle)
        root = np.sqrt([self.m[i] for i in order])
        slopes = [self.cells[i].law(tube[i])[1] for i in order]
        w = slowest([balls.number(x) for x in slopes], root)
        rates = [ball(self.m[i]).sqrt() * (level - self._force(i, now[i])) for i in order]
        cone = Cone(slopes, root, w)
        width = max(cone.width, cone.apart(rates))
        pairs = zip(order, w.tolist(), strict=True)
        return bool(width < 1) and all(width < abs(x) / 2 for i, x in pairs if i in self.sense)
