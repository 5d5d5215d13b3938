"""The overdamped flow of a snap at a prescribed stroke, enclosed in a tube around polynomials.

The flow falls along the gradient of the energy in the metric |δ|² = Σ δ_i²/m_i, with stops as a
convex constraint. So two flows part at most at the rate μ, the largest eigenvalue of -κ on all
differences with Σ δ_i = 0 (Gronwall). A Taylor polynomial of each travel has an enclosed defect;
from defect and μ follows the radius of a tube that holds the flow.
"""

import math

from stepwell.proof import balls
from stepwell.proof.balls import UNIT, Ball, UndecidedError, ball, high, hull, low
from stepwell.proof.motion import DEGREE, FlowMotion, kernel, parting_rate, when
from stepwell.proof.walk import FREE, HELD, SLIDES, EnclosedWalk, Stand

# Part of the travel by which a step may miss a last term.
_MISS = 1e-11
# Longest step in time scales 1/(m |κ|), largest number of steps.
_LONGEST, MOST_STEPS = 0.8, 4000
# Part of the travel around a stop or a joint of a law that is crossed in one small step.
_CROSSED = 1e-13
# Widest tube, as a fraction of the travel.
WIDE = 0.1
_ANY = ball(0.0, math.inf)


class Tube:
    """Middles of travels, and a radius: the flow is within it in the metric of mobilities.

    Cells that are not in `middle` are held for certain. Those in `rests` stand at a stop in the
    middle of the tube; `gap` bounds how far the flow may still be from that stop. Those in `stuck`
    are at rest by friction in the middle of the tube; `sense` has the senses in which others slide
    against friction. The cell `taker` takes up what the sum of the middles misses of the stroke.
    """

    def __init__(self, walk: EnclosedWalk, places: dict[int, Ball]):
        self.walk, self.cells = walk, walk.cells
        self.m = walk.mobility
        self.middle = {i: balls.number(s) for i, s in places.items()}
        self.rests: dict[int, int] = {}
        self.gap: dict[int, Ball] = {}
        self.stuck: set[int] = set()
        self.sense: dict[int, int] = {}
        self.taker = next(iter(places))
        self.total, square = ball(0.0), ball(0.0)
        for i, stand in enumerate(walk.stands):
            self.total = self.total + places.get(i, stand.travel)
        for i, s in places.items():
            square = square + (s - self.middle[i]) * (s - self.middle[i]) / self.m[i]
        self.radius = high(high(square).sqrt() + self._drift() * self._inverse_root)
        # The radius of the tube that is tried.
        self.reach = self.radius
        self.marks = {i: _marks(walk, i) for i in range(len(self.cells))}

    def width(self) -> float:
        """Its largest half width as a fraction of the travel."""
        return max(
            float(self.radius) * math.sqrt(self.m[i]) / self.cells[i].size for i in self.middle
        )

    def is_alone(self) -> bool:
        """Whether all cells but one are held for certain."""
        return len(self.middle) == 1

    # The middle of the tube: Taylor polynomials with float coefficients.

    def _movers(self) -> list[int]:
        """Cells that move in the middle of the tube, the taker first."""
        moving = [i for i in self.middle if i not in self.rests and i not in self.stuck]
        return sorted(moving, key=lambda i: i != self.taker)

    def shift(self, i: int) -> Ball:
        """What λ carries in addition to the force of a cell that slides."""
        return self.sense.get(i, 0) * self.cells[i].friction

    def _force(self, i: int, s: Ball) -> Ball:
        return self.cells[i].narrow(s)[0] + self.shift(i)

    def _take(self, apart: int = -1) -> None:
        """Let a cell that moves take up what the sum of the middles misses, if there is one."""
        movers = [i for i in self._movers() if i != apart]
        if self.taker in movers and self.taker not in self.sense:
            return
        plain = [i for i in movers if i not in self.sense]
        if movers and (plain or self.taker not in movers):
            before, self.taker = self._inverse_root, (plain or movers)[0]
            self.radius = high(self.radius + self._drift() * (before + self._inverse_root))

    # One step.

    def step(self) -> None:
        """Go on by a time in which the middle meets no joint and no stop, or across one."""
        motion = self._begin()
        h = self._length(motion)
        self._go(motion, h, self._event(motion, h))

    def _begin(self) -> FlowMotion:
        """Which cells move, and how."""
        self._release()
        self._take()
        movers = self._movers()
        if not movers:
            raise UndecidedError("all cells of a flow are at stops")
        shifts = {i: self.shift(i) for i in movers}
        return FlowMotion(self.cells, self.m, {i: self.middle[i] for i in movers}, shifts)

    def _go(self, motion: FlowMotion, h: float, event: tuple[int, float, int] | None) -> None:
        """Go on by a time, or up to an event and across it."""
        if event is None:
            self._smooth(motion, h)
            return
        i, time, stop = event
        if i in self.rests:
            self._smooth(motion, min(time + self._behind(motion, i), h))
            return
        speeds = {k: abs(c[1]) / self.cells[k].size for k, c in motion.travel.items()}
        short = min(_CROSSED / max(speeds[i], 1e-300), h)
        if time > 2.0 * short:
            self._smooth(motion, time - short)
        else:
            self._cross(motion, min(time + short, h), i, stop)

    def _behind(self, motion: FlowMotion, i: int) -> float:
        """A time after the release of a resting cell in which the middle misses little of it."""
        rate = abs(motion.force[1]) * math.sqrt(self.m[i])
        return math.sqrt(0.1 * max(float(self.radius), self._tiny(i)) / rate) if rate else 0.0

    def _tiny(self, i: int) -> float:
        """A part of the travel of a cell that does not count, in the metric of mobilities."""
        return _CROSSED * self.cells[i].size / math.sqrt(self.m[i])

    def _length(self, motion: FlowMotion) -> float:
        """A time in which the last term of the polynomials stays small."""
        pace, length = 0.0, math.inf
        for i, s in self.middle.items():
            pace = max(pace, abs(float(self.cells[i].law(ball(s))[1].mid())) * self.m[i])
        for i, c in motion.travel.items():
            size = self.cells[i].size
            for k in (DEGREE - 1, DEGREE):
                if c[k]:
                    length = min(length, (_MISS * size / abs(c[k])) ** (1.0 / k))
        # Where nothing moves the next event is that a cell is proved to be at its stop.
        length = min(length, _LONGEST / pace if pace else 1.0)
        if not length > 0.0:
            raise UndecidedError("the pace of the flow of a snap")
        return length

    def _event(self, motion: FlowMotion, h: float) -> tuple[int, float, int] | None:
        """The first joint or stop on the way: the cell, the time, and the sense of a stop."""
        first: tuple[int, float, int] | None = None
        for i, c in motion.travel.items():
            cell = self.cells[i]
            stops = balls.number(cell.low), balls.number(cell.high)
            for mark in (*self.marks[i], *stops):
                stop = 0 if mark not in stops else 1 if mark == stops[1] else -1
                if c[0] == mark and not stop:
                    return i, 0.0, 0
                time = when(c, mark, h if first is None else first[1])
                if time is not None:
                    first = i, time, stop
        for i in self.rests:
            own = balls.number(self._force(i, ball(self.middle[i])))
            time = when(motion.force, own, h if first is None else first[1])
            if time is not None:
                first = i, time, 0
        return first

    def _smooth(self, motion: FlowMotion, h: float) -> None:
        """A step with enclosed defect."""
        for _ in range(60):
            if self._tried(motion, h) is not None:
                return
            h /= 2.0
        raise UndecidedError("a step of the flow is not enclosed")

    def _tried(self, motion: FlowMotion, h: float) -> bool | None:
        """As for `_grow`."""
        spans = motion.spans(h)
        for i in (*self.rests, *self.stuck):
            spans[i] = ball(self.middle[i])
        defect = motion.defect(spans, h, self._drift())
        if defect is None or not motion.stays_within(spans, h):
            return None
        missed = self._missed(motion, h, defect)
        return None if missed is None else self._grow(spans, h, missed, motion.ends(h), motion)

    def _missed(self, motion: FlowMotion, h: float, defect: Ball) -> Ball | None:
        """By how much the middle misses the law of the flow; None for a step that is too long."""
        if not self.rests:
            return defect
        level = motion.level(h)
        over, tiny = ball(0.0), ball(0.0)
        for i, sense in self.rests.items():
            pull = high(sense * (self._force(i, ball(self.middle[i])) - level))
            # Where λ does not press it against its stop any more, the middle does not follow.
            over = over + max(pull, ball(0.0)) * ball(self.m[i]).sqrt()
            tiny = max(tiny, ball(self._tiny(i)))
        if h * over > max(self.radius, tiny):
            return None
        return high(defect + over)

    def _drift(self) -> Ball:
        """By how much the sum of the middles misses the stroke."""
        rest = self.total - self.walk.resting(set(self.middle))
        for s in self.middle.values():
            rest = rest - s
        return high(abs(rest))

    @property
    def _inverse_root(self) -> Ball:
        """1/√m of the cell that takes up what the sum of the middles misses."""
        return 1 / ball(self.m[self.taker]).sqrt()

    def _cross(self, motion: FlowMotion, h: float, i: int, stop: int) -> None:
        """A small step over a joint or to a stop, in which the middle moves on in a line."""
        ends = motion.line(h)
        if stop:
            cell = self.cells[i]
            if cell.leads[stop > 0]:
                raise UndecidedError("a curve that folds back")
            ends[i] = cell.high if stop > 0 else cell.low
            self._take(i)
        spans = {k: hull(ball(motion.travel[k][0]), x) for k, x in ends.items()}
        for k in (*self.rests, *self.stuck):
            spans[k] = ball(self.middle[k])
        square = ball(0.0)
        for k in spans:
            gone = (spans[k] - self.middle[k]) / h
            square = square + high(abs(gone)) * high(abs(gone)) / self.m[k]
        # The cell that takes up the rest of the stroke moves at most as fast as all others.
        speed = high(square).sqrt() * (1 + len(spans)) + self._fastest(spans)
        ways = sum((high(abs(s - self.middle[k])) for k, s in spans.items()), self._drift())
        spans[self.taker] = spans[self.taker] + high(ways) * UNIT
        grown = self._grow(spans, h, high(speed), ends, None)
        if grown is None:
            raise UndecidedError("a step of the flow is not enclosed")
        if stop and grown:
            self.rests[i] = stop
            self.gap[i] = high(self.radius * ball(self.m[i]).sqrt() + self._drift())

    def _fastest(self, spans: dict[int, Ball]) -> Ball:
        """A bound of the flow's speed: the projection of all forces but any level."""
        forces = {i: self.cells[i].law(s)[0] for i, s in spans.items()}
        level = balls.middle(sum(forces.values(), ball(0.0)) / len(forces))
        square = sum((self.m[i] * (f - level) * (f - level) for i, f in forces.items()), ball(0.0))
        return high(high(square).sqrt())

    def _grow(self, spans, h: float, defect: Ball, ends, motion: FlowMotion | None) -> bool | None:
        """Move the middle to the ends of a step, if a tube around its spans holds the flow.

        None if it does not; False if cells were released instead, and nothing moved.
        """
        found = self._enclosed(spans, ball(h), defect)
        if found is None:
            return None
        tube, grown, rate = found
        if motion is not None and rate > 0 and not self.rests:
            tube, grown = self._narrower(motion, spans, h, defect, (tube, grown))
        level = self._level(tube)
        loose = [i for i in self._held() if not self.walk.stays(i, level)]
        if loose:
            if not self._may_free(loose, h):
                return None
            for i in loose:
                self._free(i)
            return False
        for i, x in ends.items():
            if i in self.middle:
                at = balls.number(x)
                grown = high(
                    grown + abs(x - at) * (1 / ball(self.m[i]).sqrt() + self._inverse_root)
                )
                self.middle[i] = at
        self.radius = grown
        self._close()
        self._pin(level, tube, ball(h))
        return True

    def _enclosed(self, spans, time: Ball, defect: Ball):
        """A tube that holds the flow during a step, its radius after it, and the rate in it."""
        for factor in (1.25, 2.0, 4.0):
            self.reach = radius = high(self.radius * factor + 4 * time * defect)
            tube = self.around(spans, high(radius + self._drift() * self._inverse_root))
            rate, least = self._bounds(tube, defect, time)
            if not rate.is_finite():
                defect = least
                continue
            grown = high((time * rate).exp() * self.radius + kernel(rate, time) * defect)
            if grown <= radius:
                return tube, grown, rate
        return None

    def _bounds(self, tube: dict[int, Ball], defect: Ball, time: Ball) -> tuple[Ball, Ball]:
        """The rate at which two flows in the tube part, and the defect that counts with it.

        An infinite rate where they are not known, or where they hold for a larger tube.
        """
        return self._parting(tube), defect

    def _may_free(self, loose: list[int], h: float) -> bool:
        """Whether cells that may be released in a step are let go, or the step is shortened."""
        return bool(loose)

    def _narrower(self, motion: FlowMotion, spans, h: float, defect: Ball, known):
        """The tube and its radius after a step, of differences across the way if they are less."""
        radius = high(4 * self.radius + 8 * ball(h) * defect)
        around = self.around(spans, high(radius + self._drift() * self._inverse_root))
        if self._touches(around):
            return known
        across = motion.across(around, h, self.radius, (radius, defect))
        if across is None or not (across <= radius and across < known[1]):
            return known
        return around, across

    def _close(self) -> None:
        """Let one cell take up what the sum of the middles misses."""
        movers = self._movers()
        if not movers:
            return
        i, cell = movers[0], self.cells[movers[0]]
        if i != self.taker:
            return
        rest = self.total - self.walk.resting(set(self.middle))
        for k, s in self.middle.items():
            if k != i:
                rest = rest - s
        at = min(max(balls.number(rest), balls.number(cell.low)), balls.number(cell.high))
        self.middle[i] = at

    def around(self, spans: dict[int, Ball], radius: Ball) -> dict[int, Ball]:
        """Travels in the tube, within the stops."""
        out = {}
        for i, s in spans.items():
            wide, cell = s + radius * ball(self.m[i]).sqrt() * UNIT, self.cells[i]
            a, b = cell.low, cell.high
            if wide.is_finite():
                a, b = min(max(low(wide), a), b), max(min(high(wide), b), a)
            out[i] = hull(a, b)
        return out

    def _parting(self, tube: dict[int, Ball]) -> Ball:
        """A bound of the rate at which two flows in the tube part."""
        m = [self.m[i] for i in tube]
        d = [low(self.m[i] * self.cells[i].narrow(s)[1]) for i, s in tube.items()]
        return parting_rate(d, m)

    def _level(self, tube: dict[int, Ball]) -> Ball:
        """λ of all flows in the tube: a mean of the forces of those that move."""
        forces = {i: self._force(i, s) for i, s in tube.items()}
        sure = [i for i, s in tube.items() if s > self.cells[i].low and s < self.cells[i].high]
        if not sure:
            out = None
            for f in forces.values():
                out = f if out is None else hull(out, f)
            return out
        mass = sum((ball(self.m[i]) for i in sure), ball(0.0))
        level = sum((self.m[i] * forces[i] for i in sure), ball(0.0)) / mass
        for i, f in forces.items():
            if i not in sure:
                # λ with the cell lies between λ without it and the cell's own force.
                share = self.m[i] / (mass + self.m[i])
                level = hull(level, (1 - share) * level + share * f)
        return level

    # Cells at stops.

    def _held(self) -> list[int]:
        return [i for i in range(len(self.cells)) if i not in self.middle]

    def _free(self, i: int) -> None:
        stand = self.walk.stands[i]
        self.middle[i] = balls.number(stand.travel)
        sense = 1 if self.walk.at_end(i, 1) else -1 if self.walk.at_end(i, -1) else 0
        if not sense:
            raise UndecidedError("a held cell between its stops")
        self.rests[i], self.gap[i] = sense, ball(0.0)

    def _release(self) -> None:
        """Let resting cells move that λ of the middle pulls from their stops, and rest others."""
        for _ in range(8 * len(self.cells)):
            movers = self._movers()
            mass = sum(self.m[i] for i in movers)
            force = {
                i: balls.number(self.cells[i].law(ball(self.middle[i]))[0]) for i in self.middle
            }
            level = sum(self.m[i] * force[i] for i in movers) / mass if movers else 0.0
            off = [i for i, sense in self.rests.items() if not sense * (level - force[i]) > 0.0]
            if off:
                del self.rests[off[0]]
                del self.gap[off[0]]
            elif not self._rest_again(level):
                return
        raise UndecidedError("which cells rest at their stops in the flow of a snap")

    def _rest_again(self, level: float) -> bool:
        """Rest one cell at a stop against which λ of the middle pushes it; whether there is one.

        Of two cells that λ pulls from their stops, the second one may push the first one back.
        """
        for i in self._movers():
            sense = 1 if self._stops(i, 1) else -1 if self._stops(i, -1) else 0
            own = balls.number(self._force(i, ball(self.middle[i])))
            if i not in self.sense and sense * (level - own) > 0.0:
                self.rests[i] = sense
                self.gap[i] = high(self.radius * ball(self.m[i]).sqrt() + self._drift())
                return True
        return False

    def _stops(self, i: int, sense: int) -> bool:
        cell = self.cells[i]
        return self.middle[i] == balls.number(cell.high if sense > 0 else cell.low)

    def _pin(self, level: Ball, tube: dict[int, Ball], time: Ball) -> None:
        """Hold cells that are proved to have come to their stops."""
        for i, sense in list(self.rests.items()):
            m, force = ball(self.m[i]), self._force(i, tube[i])
            speed = low(m * sense * (level - force))
            whole = high(self.radius * m.sqrt() + self._drift())
            self.gap[i] = min(high(self.gap[i] - time * speed), whole) if speed > 0 else whole
            if not self.gap[i] > 0 and len(self.middle) > 1:
                cell = self.cells[i]
                self.walk.stands[i] = Stand(HELD, cell.high if sense > 0 else cell.low)
                del self.middle[i], self.rests[i], self.gap[i]
                self.sense.pop(i, None)

    # The landing.

    def put_last(self) -> bool:
        """The only cell that is not held takes the rest of the stroke.

        False if its force may release another one: then the flow goes on with it.
        """
        (i,) = self.middle
        travel = self._rest_of(i)
        level = self.cells[i].law(travel)[0]
        loose = [k for k in self._held() if not self.walk.stays(k, level)]
        for k in loose:
            self._free(k)
        if loose:
            return False
        self.walk.stands[i] = Stand(FREE, travel, self.walk.branch_at(self.cells[i], travel, 0))
        return True

    def all_rest(self) -> bool:
        """Whether all places in the tube are rests: never without friction."""
        return False

    def _rest_of(self, i: int) -> Ball:
        return self.total - self.walk.resting({i})

    def lands(self) -> bool:
        """Whether the tube is in a ball around a rest on which the energy is convex."""
        if self.rests or self.stuck:
            return False
        try:
            here = {i: ball(x) for i, x in self.middle.items()}
            if not self._parting(here) < 0:
                return False
            centre = self._polished(here)
            gone = self._norm({i: centre[i] - here[i] for i in here})
            away = high(self.radius + self._drift() * self._inverse_root + gone)
            tube = self.around(centre, away)
            rate, residual = self._parting(tube), self._residual(centre)
            if not rate < 0:
                return False
            near = high((residual + self._miss(centre)) / -rate)
            tube = self.around(centre, high(2 * away + 4 * near))
            if not self._parting(tube) < 0 or self._touches(tube):
                return False
            level = self._level(tube)
            if not all(self.walk.stays(i, level) for i in self._held()):
                return False
            if not self._keeps_senses(tube):
                return False
            rest = self.around(centre, near)
            self._put(rest)
        except UndecidedError:
            return False
        return True

    def _keeps_senses(self, tube: dict[int, Ball]) -> bool:
        """Whether cells with friction go on in their senses up to the rest, within a tube."""
        return bool(tube)

    def _put(self, rest: dict[int, Ball]) -> None:
        stands = {}
        for i, s in rest.items():
            mode, sense = (SLIDES, self.sense[i]) if i in self.sense else (FREE, 0)
            stands[i] = Stand(mode, s, self.walk.branch_at(self.cells[i], s, 0), sense)
        for i, stand in stands.items():
            self.walk.stands[i] = stand

    def _touches(self, tube: dict[int, Ball]) -> bool:
        return any(not (s > self.cells[i].low and s < self.cells[i].high) for i, s in tube.items())

    def _norm(self, x: dict[int, Ball]) -> Ball:
        return high(high(sum((d * d / self.m[i] for i, d in x.items()), ball(0.0))).sqrt())

    def _miss(self, at: dict[int, Ball]) -> Ball:
        """What the sum of middles misses in the speed, an upper bound."""
        off = abs(self.total - self.walk.resting(set(at)) - sum(at.values(), ball(0.0)))
        paces = [self.m[i] * abs(self.cells[i].law(s)[1]) for i, s in at.items()]
        return high(off * (2 * sum(paces, ball(0.0))) * sum(1 / ball(self.m[i]).sqrt() for i in at))

    def _residual(self, at: dict[int, Ball]) -> Ball:
        """The speed of the flow at a place between all stops."""
        forces = {i: self._force(i, s) for i, s in at.items()}
        mass = sum((ball(self.m[i]) for i in at), ball(0.0))
        level = sum((self.m[i] * f for i, f in forces.items()), ball(0.0)) / mass
        return self._norm({i: self.m[i] * (level - f) for i, f in forces.items()})

    def _polished(self, at: dict[int, Ball]) -> dict[int, Ball]:
        """A place near a rest, with the exact stroke: Newton's method on middles."""
        for _ in range(12):
            laws = {i: (self._force(i, s), self.cells[i].law(s)[1]) for i, s in at.items()}
            flat = [i for i, law in laws.items() if law[1].is_zero()]
            if flat:
                at = self._with_flat(at, laws, flat[0])
                continue
            soft = sum((1 / law[1] for law in laws.values()), ball(0.0))
            miss = self.total - self.walk.resting(set(at)) - sum(at.values(), ball(0.0))
            level = (miss + sum((law[0] / law[1] for law in laws.values()), ball(0.0))) / soft
            if not level.is_finite():
                raise UndecidedError("a rest of the flow")
            at = {i: balls.middle(s + (level - laws[i][0]) / laws[i][1]) for i, s in at.items()}
        return at

    def _with_flat(self, at, laws, flat: int) -> dict[int, Ball]:
        """One step of Newton's method where a cell of constant force takes the rest."""
        level, out = laws[flat][0], dict[int, Ball]()
        for i, s in at.items():
            if i != flat:
                out[i] = balls.middle(s + (level - laws[i][0]) / laws[i][1])
        rest = self.total - self.walk.resting(set(at)) - sum(out.values(), ball(0.0))
        out[flat] = balls.middle(rest)
        if not all(s.is_finite() for s in out.values()):
            raise UndecidedError("a rest of the flow")
        return out


def _marks(walk: EnclosedWalk, i: int) -> list[float]:
    """Travels at which the law of a cell may have a joint: hints."""
    pieces, sheets = walk.problem.pieces, walk.problem.sheets
    sheet = int(sheets.now[i])
    begin, end = int(pieces.of_sheet[sheet]), int(pieces.of_sheet[sheet + 1])
    return [float(pieces.left[k]) for k in range(begin + 1, end)]
