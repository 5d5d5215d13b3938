"""What a robot will do, from statics alone: gait, advance, drag and antenna limits, and doubts."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import cache, lru_cache, partial
from itertools import product

import numpy as np

from stepwell.base import ByValue, Drawn, Vec2, bisected, to_unit
from stepwell.robot.parts import Leg
from stepwell.robot.robot import Robot
from stepwell.robot.rounds import ROUNDING, Round, asked, footing, gait, go_round, go_rounds, rounds
from stepwell.robot.slide import STEPS, Slide, slide
from stepwell.robot.stance import Spring, largest, leaning
from stepwell.statics import StaticsError

HALVINGS = 8


def changes(
    answer: Callable[[float], str], values: Sequence[float], halvings: int = HALVINGS
) -> Iterator[tuple[float, str]]:
    """Every value along `values` at which the answer changes, with the answer just past it.

    Each value is looked at in turn, from the first on, and the stretch in which the answer changes
    is halved; a change that is undone between two neighbouring values goes unseen.
    """
    ask = cache(answer)

    known, before = ask(values[0]), values[0]
    for value in values[1:]:
        while ask(value) != known:
            same = partial(lambda known, at: ask(at) == known, known)
            before = bisected(same, before, value, halvings)[1]
            known = ask(before)
            yield before, known
        before = value


# A robot walks if a cycle takes it this share of the largest step, and turns from this angle on.
WALKS = 0.1
TURNS = math.radians(3.0)
PUSHES = 0.1  # a push shorter than this share of the largest step is none
# Tolerances on the states beside the usual one, which the gait must not depend on.
TOLERANCES = (0.15, 0.25)
LOOKS = 17  # steps in which an antenna's swing is looked at before its threshold is closed in on
# Forces [N] at which the margin is looked for: no cell of a robot that walks needs more.
FORCES = (0.0, *np.geomspace(0.004, 2.0, 10).tolist())
# How much deeper the feet are put in looking for where the gait changes [m], and how often the last
# of these stretches is halved: close to the feet to a hundredth of a millimetre.
DEEPER = tuple(1e-4 * 2.0**k for k in range(7))
DEPTH_HALVINGS = 4
# Between which shares and multiples of the largest force over the command the least stiffness of
# a drive is looked for; how close; in how many steps where the ways alone do not tell it, and how
# often the last of these stretches is halved.
STIFFNESSES = 1e4
WITHIN = 0.01
LOOKS_FOR_STIFFNESS = 7
STIFFNESS_HALVINGS = 6

ASSUMPTIONS = (
    "The drive is slow: no inertia. Damping enters as a lag at the drive's mean speed.",
    "Links, levers, blocks and floor are rigid; supports and feet touch in points.",
    "Feet share the weight with the supports by the lever rule at every step.",
    "Friction is Coulomb's, the same at rest and in motion, and decides by least dissipation "
    "which feet stick and how the body turns.",
    "A snap is overdamped and takes no time, and a foot grips at once; really the stroke goes on "
    "meanwhile, so that a forward step is shorter and a backward one longer than is said here.",
    "All legs end at one carriage behind the drive's spring. Where its force lets the carriage go "
    "at once, the cells still follow their equilibria stroke by stroke.",
    "The robot starts from rest with every cell at 0, far from walls, and each cycle where the one "
    "before it ended.",
)


class Motion(Enum):
    """Where a cycle takes a robot."""

    FORWARD = "walks forward"
    BACKWARD = "walks backward"
    LEFT = "turns left"
    RIGHT = "turns right"
    NONE = "stays where it is"


class PushEnd(Enum):
    """What ends a push when the floor drags more."""

    SLIP = "the foot slips"
    GAIT = "the gait changes"
    NOTHING = "nothing: this foot never has to hold against the drag"


@dataclass(frozen=True, slots=True, eq=False)
class Push(ByValue):
    """A foot that pushes the body over the floor, in one way of the actuator.

    Attributes:
        loading: True on the way out, False on the way back.
        step: how far the foot goes back under the body while it stands [m]; negative for a step
            that takes the body backwards.
        gain, slip: how far the body goes over the foot, and how far the foot slides [m].
        load: what the foot carries while it pushes, on average [N].
        drag: of the floor on the whole robot [N], as given.
        largest_drag: up to which this push goes on [N], in the terms of `Floor.drag` and at that
            average load; infinite where nothing ends it.
        limit: what then happens.
    """

    loading: bool
    step: float
    gain: float
    slip: float
    load: float
    drag: float
    largest_drag: float
    limit: PushEnd

    @property
    def safety(self) -> float:
        """Largest over given drag [1]; below 1 the foot slips already."""
        return self.largest_drag / self.drag if self.drag > 0 else math.inf

    def __repr__(self):
        sense = "forward" if self.step > 0 else "backward"
        return (
            f"Push({sense} while {'loading' if self.loading else 'unloading'}: gains "
            f"{to_unit(self.gain, 'mm'):.3g} of {to_unit(self.step, 'mm'):.3g} mm, up to a drag of "
            f"{self.largest_drag:.3g} N)"
        )


@dataclass(frozen=True, slots=True, eq=False)
class Flip(ByValue):
    """A displacement of an antenna that changes the gait of its leg.

    Attributes:
        antenna, leg: names.
        displacement: of the anchor [m] along the antenna's `moves`.
        earliest, latest: between which displacements [m] the change comes, given what the
            prediction cannot know; `latest` is infinite where it may not come at all.
        swing: of the antenna [rad] at `displacement`.
        before, gait: the gait up to there and past it.
    """

    antenna: str
    leg: str
    displacement: float
    earliest: float
    latest: float
    swing: float
    before: str
    gait: str

    def __repr__(self):
        return (
            f"Flip({self.antenna} at {to_unit(self.displacement, 'mm'):.3g} mm ("
            f"{to_unit(self.earliest, 'mm'):.3g}..{to_unit(self.latest, 'mm'):.3g}), "
            f"{math.degrees(self.swing):.3g}°: {self.leg} {self.before} → {self.gait})"
        )


@dataclass(frozen=True, slots=True, eq=False)
class LegPrediction(ByValue):
    """What one leg will do.

    Attributes:
        name: of the leg.
        gait: states as "00>10>11>01>00", a cell within a fifth of its travel from a stop counting
            as there; of the cycle that repeats itself.
        advance: how far a cycle takes the body over this leg's foot while it stands, over u_max,
            the leg's largest step [1].
        slip: how far the foot slides on the floor in a cycle [m].
        margin: the smallest constant force [N] that, added to the travel of one cell, in one sense
            or the other, changes the gait; infinite where 2 N do not.
        nearest: what it then becomes, or "".
        uncertainty: force [N] that this prediction does not know: damping at the drive's speed and
            what the middle blocks lag behind where the drive turns.
        alternatives: gaits that come out where what is assumed is changed within reason: no drag,
            other feet in the air, a cell within 0.15 or 0.25 of its stop counting as there.
        pushes: of its foot, on the way out and back.
        flips: what its antennas do to it, in the order in which they come.
        first_gait: of the first cycle, from all cells at 0; another where the drive is too soft to
            bring the leg back. Then margin, alternatives and flips are those of the first cycle.
        rigid_gait: of a drive that does not give.
    """

    name: str
    gait: str
    advance: float
    slip: float
    margin: float
    nearest: str
    uncertainty: float
    alternatives: tuple[str, ...]
    pushes: tuple[Push, ...]
    flips: tuple[Flip, ...]
    first_gait: str
    rigid_gait: str

    @property
    def near_boundary(self) -> bool:
        """Whether the gait may be another: margin below uncertainty, or an alternative."""
        return self.margin < self.uncertainty or bool(self.alternatives)

    @property
    def confident(self) -> bool:
        """Not near a boundary."""
        return not self.near_boundary

    def __repr__(self):
        near = f", near {self.nearest or self.alternatives[0]}" if self.near_boundary else ""
        return (
            f"LegPrediction({self.name} {self.gait}{near}: d/u_max {self.advance:.2f}, margin "
            f"{to_unit(self.margin, 'mN'):.3g} ± {to_unit(self.uncertainty, 'mN'):.3g} mN)"
        )


@dataclass(frozen=True, slots=True, eq=False)
class DriveNeeds(ByValue):
    """What a motor must have for the gait that a robot has behind a drive that does not give.

    Attributes:
        push, pull: largest force on the carriage on the way out and back [N], with the damping of
            the cells at the drive's mean speed.
        stiffness: least, to 1 %, at which all legs keep their gaits [N/m]; 0 where any will do.
    """

    push: float
    pull: float
    stiffness: float


@dataclass(frozen=True, slots=True, eq=False)
class Prediction(ByValue, Drawn):
    """What a robot will do in a cycle, computed without simulation.

    Attributes:
        robot, legs: which, and what each of its legs will do.
        advance, sideways: displacement forward and to the left in the cycle that repeats itself,
            over u_max, the legs' largest step [1].
        turn: rotation to the left in that cycle [rad].
        first_advance: displacement forward in the first cycle over u_max [1].
        strokes: least and largest stroke of the carriage [m].
        too_soft: what the drive's spring does to the gait, in words; "" where it changes nothing.
        assumptions: what all of this rests on.
    """

    robot: Robot
    legs: tuple[LegPrediction, ...]
    advance: float
    sideways: float
    turn: float
    first_advance: float
    strokes: tuple[float, float]
    too_soft: str
    assumptions: tuple[str, ...] = ASSUMPTIONS

    @property
    def drive_needs(self) -> DriveNeeds:
        """What a motor must have for the gait; worked out when it is first asked for."""
        return drive_needs(self.robot)

    @property
    def depths(self) -> tuple[tuple[float, float], ...]:
        """For each leg the depths of the feet [m] between which it surely keeps its gait.

        They are worked out when first asked for, in as long as the prediction took.
        """
        return depths(self.robot)

    @property
    def known_depths(self) -> tuple[tuple[float, float] | None, ...]:
        """The same, None for every leg where statics cannot determine them."""
        return known_depths(self.robot)

    @property
    def motion(self) -> Motion:
        """In a word; a robot that turns by 3° or more in a cycle turns, however far it goes."""
        if abs(self.turn) >= TURNS:
            return Motion.LEFT if self.turn > 0 else Motion.RIGHT
        if abs(self.advance) >= WALKS:
            return Motion.FORWARD if self.advance > 0 else Motion.BACKWARD
        return Motion.NONE

    @property
    def gaits(self) -> dict[str, str]:
        """For each leg its gait."""
        return {leg.name: leg.gait for leg in self.legs}

    @property
    def near_boundary(self) -> bool:
        """Whether any leg may do otherwise."""
        return any(leg.near_boundary for leg in self.legs)

    @property
    def confident(self) -> bool:
        """Not near a boundary."""
        return not self.near_boundary

    @property
    def flips(self) -> tuple[Flip, ...]:
        """What the antennas change, over all legs."""
        return tuple(flip for leg in self.legs for flip in leg.flips)

    def leg(self, name: str) -> LegPrediction:
        """The leg of that name; or a `ValueError`."""
        return self.legs[self.robot.legs.index(self.robot.leg(name))]

    def __repr__(self):
        legs = ", ".join(f"{leg.name} {leg.gait}" for leg in self.legs)
        near = [leg.name for leg in self.legs if leg.near_boundary]
        doubt = f"; near a boundary: {', '.join(near)}" if near else ""
        soft = f"; {self.too_soft}" if self.too_soft else ""
        # The depths at which all legs keep their gaits.
        lows, highs = zip(*self.depths, strict=True)
        least, most = to_unit(max(lows), "mm"), to_unit(min(highs), "mm")
        return (
            f"Prediction({self.motion.value}: {legs}; d/u_max {self.advance:z.2f}, turn "
            f"{math.degrees(self.turn):z.1f}°; feet {least:.2f} to {most:.2f} mm deep{doubt}{soft})"
        )


def predict(robot: Robot) -> Prediction:
    """Predict what a robot does in a cycle, without simulation. All else as for `Robot.predict`."""
    cycles = rounds(robot)
    slid, firsts = slide(robot, cycles), tuple(one.first for one in cycles)
    x, y, turn = slid.displacement()
    begun = x if firsts == cycles else slide(robot, firsts).displacement()[0]
    rigid, softer = _other_drives(robot, cycles)
    # What can be doubted of legs that are alike, and what antennas do to them, is the same.
    doubts = cache(lambda i: _doubts(firsts[i]))
    flips = cache(lambda i, *antenna: tuple(_flips(robot, firsts[i], *antenna)))
    legs: list[LegPrediction] = []
    for i, (one, first) in enumerate(zip(cycles, _first_alike(cycles), strict=True)):
        margin, nearest, alternatives = doubts(first)
        legs.append(
            LegPrediction(
                one.leg.name,
                one.gait(),
                float(slid.gain[:, i].sum()) / one.leg.stroke,
                float(slid.slip[:, i].sum()),
                margin,
                nearest,
                _uncertainty(robot, one.leg),
                tuple(sorted({*alternatives, *(gaits[i] for gaits in softer)} - {one.gait()})),
                tuple(_pushes(robot, i, one, slid)),
                tuple(
                    replace(flip, antenna=antenna.name, leg=one.leg.name)
                    for antenna in robot.antennas
                    if antenna.leg == one.leg.name and antenna.connected
                    for flip in flips(first, antenna.cell, antenna.moves, antenna.swing)
                ),
                firsts[i].gait(),
                rigid[i],
            )
        )
    ways = x / robot.u_max, y / robot.u_max, turn, begun / robot.u_max
    strokes = cycles[0].turns.back, cycles[0].turns.out
    return Prediction(robot, tuple(legs), *ways, strokes, too_soft(robot))


def predicted_gaits(robot: Robot) -> tuple[str, ...]:
    """For each leg the states of the cycle that repeats itself; errors as for `Robot.predict`."""
    return _gaits(rounds(robot))


def too_soft(robot: Robot) -> str:
    """What the drive's spring does to the gait, in words; "" where it changes nothing."""
    cycles, stiffness = rounds(robot), robot.drive.stiffness
    gaits = _gaits(cycles)
    if _passes(robot, cycles, stiffness) or gaits == _gaits(rounds(robot, math.inf)):
        return ""
    text = (
        f"the drive is too soft: with {stiffness:g} N/m the legs go from "
        f"{to_unit(cycles[0].turns.back, 'mm'):.1f} to {to_unit(cycles[0].turns.out, 'mm'):.1f} mm "
        f"of {to_unit(robot.drive.amplitude, 'mm'):g} mm"
    )
    firsts = tuple(one.first for one in cycles)
    if gaits == _gaits(firsts):
        return text
    advance = slide(robot, firsts).displacement()[0] / robot.u_max
    states = ", ".join(dict.fromkeys(gait or "none" for gait in gaits))
    stuck = all(">" not in gait for gait in gaits)
    then = f"is stuck in state {states}" if stuck else f"goes on as {states}"
    return f"{text}; the first cycle goes {advance:.2f} of u_max, then the robot {then}"


def _gaits(cycles: Sequence[Round]) -> tuple[str, ...]:
    return tuple(one.gait() for one in cycles)


def _other_drives(
    robot: Robot, cycles: tuple[Round, ...]
) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Gaits of all legs behind a drive that does not give; and with what is not known of forces.

    Where the drive has force to spare they are those found, and nothing is followed again.
    """
    unknown = sum(_uncertainty(robot, one.leg) for one in cycles)
    if _passes(robot, cycles, robot.drive.stiffness, unknown):
        return _gaits(cycles), []
    stances = [one.stances for one in cycles]
    others = (go_rounds(robot, stances, robot.drive.stiffness, by) for by in (unknown, -unknown))
    return _gaits(rounds(robot, math.inf)), list(map(_gaits, others))


def _passes(robot: Robot, cycles: Sequence[Round], stiffness: float, more: float = 0.0) -> bool:
    """Whether a drive takes the carriage all the way out and back along these rounds."""
    spring = Spring(robot.drive.amplitude, stiffness, more)
    reach = min(robot.drive.amplitude, *(one.leg.chain.full_stroke for one in cycles))
    out, back = spring.stops(asked(cycles, 0), 1), spring.stops(asked(cycles, 1), -1)
    return out >= reach - ROUNDING and back <= ROUNDING


def _visits(robot: Robot, cycles: Sequence[Round], stiffness: float) -> bool:
    """Whether it takes it so far that the legs visit the same states on these ways."""
    spring = Spring(robot.drive.amplitude, stiffness)
    for half, way in enumerate((1, -1)):
        end = spring.stops(asked(cycles, half), way)
        for one in cycles:
            ahead, full = one.halves[half], np.array(one.leg.chain.full_travels)
            gone = ahead.travel[way * ahead.stroke <= way * end + ROUNDING]
            travels = np.concatenate([gone, ahead.at(np.array([end]))[0]])
            if gait(travels / full) != gait(ahead.travel / full):
                return False
    return True


@lru_cache(maxsize=32)
def drive_needs(robot: Robot) -> DriveNeeds:
    """What a motor must have for the gait that a robot has behind a drive that does not give."""
    cycles = rounds(robot, math.inf)
    push, pull = largest(asked(cycles, 0), 1), largest(asked(cycles, 1), -1)
    scale = max(push, pull) / robot.drive.amplitude
    softest, stiffest = scale / STIFFNESSES, scale * STIFFNESSES

    def least(holds: Callable[[float], bool]) -> float:
        """The least stiffness that does, by what is known of these ways alone."""
        if holds(softest):
            return softest
        logs = math.log(stiffest), math.log(softest)
        return math.exp(bisected(lambda log: holds(math.exp(log)), *logs, 30)[0])

    # Between these two the drive stops the carriage past the last state that a leg visits.
    enough = least(partial(_passes, robot, cycles))
    needed = min(enough, least(partial(_visits, robot, cycles)))

    def gaits(stiffness: float) -> str:
        return str(_gaits(go_rounds(robot, [one.stances for one in cycles], stiffness)))

    looks = np.geomspace(enough, needed * (1.0 - WITHIN), LOOKS_FOR_STIFFNESS).tolist()
    if needed < (1.0 - WITHIN) * enough:
        enough = next(changes(gaits, looks, STIFFNESS_HALVINGS), (0.0, ""))[0]
    return DriveNeeds(push, pull, enough if enough > softest else 0.0)


@lru_cache(maxsize=32)
def depths(robot: Robot) -> tuple[tuple[float, float], ...]:
    """Between which depths below the supports [m] each leg surely keeps the gait predicted.

    There its gait is the same whatever the force that the prediction does not know, all else as it
    is; both are the feet's own depth where it may be another already.
    """
    cycles = tuple(one.first for one in rounds(robot))
    own = cache(lambda i: _depths(robot, i, cycles))
    return tuple(map(own, _first_alike(cycles)))


def known_depths(robot: Robot) -> tuple[tuple[float, float] | None, ...]:
    """The same, None for every leg where the engine could not go on."""
    try:
        return depths(robot)
    except StaticsError:
        return (None,) * len(robot.legs)


def _first_alike(cycles: Sequence[Round]) -> list[int]:
    """For each leg the number of the first one that is the same, or is so in a mirror."""
    return [[other.alike(one.leg, one.stances) for other in cycles].index(True) for one in cycles]


def _uncertainty(robot: Robot, leg: Leg) -> float:
    """Force [N] between two cells that the drive's speed may add or take."""
    speed = 2.0 * robot.drive.amplitude / robot.drive.period
    damping = robot.blocks.damping
    # Half of the damping is the lag that the round has as friction: which of two cells bears it
    # depends on how they start. A block follows its neighbour m/2c late, and meanwhile the
    # cells' forces fall at this rate.
    late = robot.blocks.mass / (2.0 * damping)
    falls = max(abs(c.force_0 - c.force_1) / c.full_travel for c in leg.chain.levers)
    return damping * speed / 2.0 + falls * speed * late


def _doubts(one: Round) -> tuple[float, str, tuple[str, ...]]:
    """Smallest force [N] on one cell that changes the gait, what it becomes, and alternatives."""
    cells = len(one.leg.chain)
    # At a given stroke a force on one of two cells does what its opposite does on the other.
    tried = (cells - 1,) if cells == 2 else range(cells)
    margin, nearest = math.inf, ""
    for cell, sense in product(tried, (1.0, -1.0)):

        def pushed(force: float, cell: int = cell, sense: float = sense) -> str:
            extra = {cell: sense * force}
            # Without a force it is the round that is known.
            return go_round(one.leg, one.stances, one.turns, extra).gait() if force else one.gait()

        nearer = [force for force in FORCES if force < margin]
        looks = [*nearer, margin] if math.isfinite(margin) else nearer
        change = next(changes(pushed, looks), None)
        if change is not None and change[0] < margin:
            margin, nearest = change
    # What the floor does to the foot may be another: no drag, or one load however far it steps.
    others = {one.gait(tolerance) for tolerance in TOLERANCES}
    for out, back in (
        [replace(foot, drags=False) for foot in one.stances],
        [replace(foot, load=np.full_like(foot.load, foot.load[0])) for foot in one.stances],
    ):
        others.add(go_round(one.leg, (out, back), one.turns).gait())
    return margin, nearest, tuple(sorted(others - {one.gait()}))


def _depths(robot: Robot, index: int, cycles: Sequence[Round]) -> tuple[float, float]:
    """Depths of the feet [m] between which a leg keeps its gait, whatever is not known."""
    foot, leg = robot.foot, robot.legs[index]
    unknown, gait = _uncertainty(robot, leg), cycles[index].gait()
    # No robot's feet stand deeper than its cells can lift them.
    deepest = 0.999 * float(foot.depth(0.0) - foot.depth(leg.chain.cells[-1].full_travel))

    def deep(below: float) -> str:
        other = replace(robot, foot=replace(foot, below=below))
        stances = footing(other, index, cycles, leaning(other))
        for force in (unknown, -unknown):
            extra = {len(leg.chain) - 1: force}
            try:
                after = go_round(leg, stances, cycles[index].turns, extra).gait()
            except StaticsError:
                return "not followed"  # so it is not sure
            if after != gait:
                return after
        return gait

    def until(looks: list[float]) -> float:
        return next(changes(deep, [foot.below, *looks], DEPTH_HALVINGS), (looks[-1], ""))[0]

    if deep(foot.below) != gait:
        return foot.below, foot.below
    deeper = [foot.below + more for more in DEEPER if foot.below + more < deepest]
    return until([foot.below / 2, 0.0]), until([*deeper, max(deepest, foot.below)])


def _flips(robot: Robot, one: Round, cell: int | str, moves: Vec2, swing: float) -> Iterator[Flip]:
    """What an antenna that moves this anchor p changes; it is not named yet."""
    unknown, length, before = _uncertainty(robot, one.leg), math.hypot(*moves), one.gait()

    def thresholds(force: float) -> list[tuple[float, str]]:
        def pressed(share: float) -> str:
            leg, last = one.leg.with_moved_anchor(cell, moves, share), len(one.leg.chain) - 1
            return go_round(leg, one.stances, one.turns, {last: force}).gait()

        return list(changes(pressed, np.linspace(0.0, 1.0, LOOKS).tolist()))

    around = [thresholds(force) for force in (unknown, -unknown)]
    for share, after in thresholds(0.0):
        # The same change where the unknown force is added and taken.
        same = [next((s for s, g in changed if g == after), math.inf) for changed in around]
        early, late = min(share, *same) * length, max(share, *same) * length
        yield Flip("", one.leg.name, share * length, early, late, share * swing, before, after)
        before = after


def _pushes(robot: Robot, index: int, one: Round, slid: Slide) -> Iterator[Push]:
    for half in (0, 1):
        rows = slice(half * STEPS, (half + 1) * STEPS)
        step, load = slid.push[rows, index], slid.load[rows, index]
        total = float(step.sum())
        if abs(total) < PUSHES * one.leg.stroke:
            continue
        # While it pushes the way it ends up going, and not while the weight passes over.
        pushing = np.maximum(np.sign(total) * step, 0.0)
        carries = float(pushing @ load / pushing.sum())
        feet = (slid.load[rows] > 0.0).sum(axis=1)
        sharing = float(pushing @ feet / pushing.sum())
        gain, slip = (float(of[rows, index].sum()) for of in (slid.gain, slid.slip))
        most = _largest_drag(robot, one, carries, sharing)
        yield Push(not half, total, gain, slip, carries, robot.floor.drag, *most)


def _largest_drag(robot: Robot, one: Round, load: float, sharing: float) -> tuple[float, PushEnd]:
    """The floor's drag [N] at which a foot slips or its leg steps otherwise."""
    left = robot.weight - sharing * load
    if left <= 0.0 or robot.floor.gravity == 0.0:
        return math.inf, PushEnd.NOTHING
    slips = robot.mass * 9.81 * sharing * robot.floor.foot_friction * load / left

    def dragged(drag: float) -> str:
        other = replace(robot, floor=replace(robot.floor, drag=drag))
        out, back = (replace(foot, robot=other) for foot in one.stances)
        return go_round(one.leg, (out, back), one.turns).gait()

    if slips > robot.floor.drag:
        for drag, _ in changes(dragged, np.linspace(robot.floor.drag, slips, 9).tolist()):
            return drag, PushEnd.GAIT
    return slips, PushEnd.SLIP
