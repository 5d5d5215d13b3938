"""Prediction of a robot from statics: gait, advance, drag and antenna limits, uncertainty."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import cache, lru_cache, partial
from itertools import product

import numpy as np

from stepwell.base import ByValue, Drawn, Vec2, bisected, to_unit
from stepwell.robot import leg_cycles as cycling
from stepwell.robot.leg_cycles import LegCycle, gait
from stepwell.robot.parts import Leg
from stepwell.robot.robot import Robot
from stepwell.robot.slide import STEPS, Slide, slide
from stepwell.robot.stance import Spring, largest, leaning
from stepwell.statics import StaticsError

HALVINGS = 8


def changes(
    answer: Callable[[float], str], values: Sequence[float], halvings: int = HALVINGS
) -> Iterator[tuple[float, str]]:
    """Every value along `values` at which the answer changes, with the answer just beyond it.

    The values are evaluated in order, and an interval in which the answer changes is bisected. A
    change that is undone between two neighbouring values is missed.
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


# A robot walks if it advances by this fraction of the largest step, and turns from this angle on.
WALKS = 0.1
TURNS = math.radians(3.0)
PUSHES = 0.1  # a push shorter than this fraction of the largest step is none
# Other tolerances on the states, on which the gait must not depend.
TOLERANCES = (0.15, 0.25)
LOOKS = 17  # values of an antenna's swing that are evaluated before its threshold is bisected
# Forces [N] at which the margin is searched: no cell of a robot that walks needs more.
FORCES = (0.0, *np.geomspace(0.004, 2.0, 10).tolist())
# Increases of the preload depth in the search for a change of gait [m], and bisections of the last
# interval: to a hundredth of a millimetre near the feet.
DEEPER = tuple(1e-4 * 2.0**k for k in range(7))
DEPTH_HALVINGS = 4
# Search for the least stiffness of a drive: range, as a factor on the largest force over the
# command; tolerance; number of values if the half cycles alone do not decide it; and number of
# bisections of the last interval.
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
    "A snap is overdamped and takes no time, and a foot grips at once. In reality the stroke "
    "changes meanwhile: forward steps are shorter and backward steps longer than predicted.",
    "All legs end at one carriage behind the drive's spring. If the carriage jumps, the cells "
    "still follow their equilibria stroke by stroke.",
    "The robot starts from rest with every cell at 0, far from walls, and each cycle starts where "
    "the previous one ended.",
)


class Motion(Enum):
    """Kind of motion in a cycle."""

    FORWARD = "walks forward"
    BACKWARD = "walks backward"
    LEFT = "turns left"
    RIGHT = "turns right"
    NONE = "stays in place"


class PushEnd(Enum):
    """Event that ends a push as the floor's drag increases."""

    SLIP = "the foot slips"
    GAIT = "the gait changes"
    NOTHING = "nothing: the drag never loads this foot"


@dataclass(frozen=True, slots=True, eq=False)
class Push(ByValue):
    """A push of a foot that moves the body over the floor, in loading or unloading.

    Attributes:
        loading: True for loading, False for unloading.
        step: backward travel of the foot under the body in stance [m]; negative for a step that
            moves the body backwards.
        gain, slip: advance of the body over the foot, and sliding of the foot [m].
        load: mean ground reaction force of the foot during the push [N].
        drag: of the floor on the whole robot [N], as given.
        largest_drag: largest drag at which this push works [N], defined as `Floor.drag`, at that
            mean load; infinite without a limit.
        limit: event at that drag.
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
        """Largest drag over given drag [1]; below 1 the foot slips."""
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
        earliest, latest: range of displacements [m] of the change within the uncertainty of the
            prediction; `latest` is infinite if the change may be missing.
        swing: of the antenna [rad] at `displacement`.
        before, gait: the gait below and above that displacement.
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
    """Prediction for one leg.

    Attributes:
        name: of the leg.
        gait: states as "00>10>11>01>00" of the cycle that repeats itself; a cell within a fifth of
            its travel from a stop counts as at the stop.
        advance: advance of the body over this leg's foot in stance per cycle, over u_max, the
            leg's largest step [1].
        slip: sliding of the foot on the floor in a cycle [m].
        margin: the smallest constant force [N] on the travel of one cell, in either direction,
            that changes the gait; infinite if 2 N do not change it.
        nearest: the gait after that change, or "".
        uncertainty: force [N] that statics neglects: damping at the drive's speed, and the lag of
            the middle blocks where the drive turns.
        alternatives: gaits under other plausible assumptions: no drag, other feet in flight, a
            cell within 0.15 or 0.25 of its stop counting as at the stop.
        pushes: of its foot, in loading and unloading.
        flips: changes of gait by its antennas, by increasing displacement.
        first_gait: of the first cycle, from all cells at 0; it differs if the drive is too soft to
            return the leg. Then margin, alternatives and flips are those of the first cycle.
        rigid_gait: with a rigid drive.
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
        """Whether the gait is uncertain: margin below uncertainty, or an alternative."""
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
    """Requirements on the actuator for the gaits that a robot has with a rigid drive.

    Attributes:
        push, pull: largest force on the carriage in loading and unloading [N], with the damping of
            the cells at the drive's mean speed.
        stiffness: least, to 1 %, at which all legs keep their gaits [N/m]; 0 if any is enough.
    """

    push: float
    pull: float
    stiffness: float


@dataclass(frozen=True, slots=True, eq=False)
class Prediction(ByValue, Drawn):
    """Prediction of a robot's motion in a cycle, computed without simulation.

    Attributes:
        robot, legs: the robot, and the prediction for each leg.
        advance, sideways: displacement forward and to the left in the cycle that repeats itself,
            over u_max, the legs' largest step [1].
        turn: rotation to the left in that cycle [rad].
        first_advance: displacement forward in the first cycle over u_max [1].
        strokes: least and largest stroke of the carriage [m].
        too_soft: effect of the drive's compliance on the gait, in words; "" without one.
        assumptions: of the prediction.
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
        """Requirements on the actuator for the gait; computed on first access."""
        return drive_needs(self.robot)

    @property
    def depths(self) -> tuple[tuple[float, float], ...]:
        """For each leg the range of preload depths [m] in which it certainly keeps its gait.

        Computed on first access, which takes as long as the prediction.
        """
        return depths(self.robot)

    @property
    def known_depths(self) -> tuple[tuple[float, float] | None, ...]:
        """The same as `depths`, None for every leg if statics cannot determine them."""
        return known_depths(self.robot)

    @property
    def motion(self) -> Motion:
        """The kind of motion; a turn of 3° or more in a cycle counts before any advance."""
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
        """Whether the gait of any leg is uncertain."""
        return any(leg.near_boundary for leg in self.legs)

    @property
    def confident(self) -> bool:
        """Not near a boundary."""
        return not self.near_boundary

    @property
    def flips(self) -> tuple[Flip, ...]:
        """Changes of gait by antennas, of all legs."""
        return tuple(flip for leg in self.legs for flip in leg.flips)

    def leg(self, name: str) -> LegPrediction:
        """The leg of that name; or a `ValueError`."""
        return self.legs[self.robot.legs.index(self.robot.leg(name))]

    def __repr__(self):
        legs = ", ".join(f"{leg.name} {leg.gait}" for leg in self.legs)
        near = [leg.name for leg in self.legs if leg.near_boundary]
        doubt = f"; near a boundary: {', '.join(near)}" if near else ""
        soft = f"; {self.too_soft}" if self.too_soft else ""
        # The preload depths at which all legs keep their gaits.
        lows, highs = zip(*self.depths, strict=True)
        least, most = to_unit(max(lows), "mm"), to_unit(min(highs), "mm")
        return (
            f"Prediction({self.motion.value}: {legs}; d/u_max {self.advance:z.2f}, turn "
            f"{math.degrees(self.turn):z.1f}°; preload {least:.2f} to {most:.2f} mm{doubt}{soft})"
        )


def predict(robot: Robot) -> Prediction:
    """Predict a cycle of a robot without simulation. All else as for `Robot.predict`."""
    cycles = cycling.leg_cycles(robot)
    slid, firsts = slide(robot, cycles), tuple(cycle.first for cycle in cycles)
    x, y, turn = slid.displacement()
    first_x = x if firsts == cycles else slide(robot, firsts).displacement()[0]
    rigid, softer = _other_drives(robot, cycles)
    # Equal legs have equal uncertainties and equal thresholds of antennas.
    margins = cache(lambda i: _margin_and_alternatives(firsts[i]))
    flips = cache(lambda i, *antenna: tuple(_flips(robot, firsts[i], *antenna)))
    legs: list[LegPrediction] = []
    for i, (cycle, first) in enumerate(zip(cycles, _first_alike(cycles), strict=True)):
        margin, nearest, alternatives = margins(first)
        legs.append(
            LegPrediction(
                cycle.leg.name,
                cycle.gait(),
                float(slid.gain[:, i].sum()) / cycle.leg.stroke,
                float(slid.slip[:, i].sum()),
                margin,
                nearest,
                _uncertainty(robot, cycle.leg),
                tuple(sorted({*alternatives, *(gaits[i] for gaits in softer)} - {cycle.gait()})),
                tuple(_pushes(robot, i, cycle, slid)),
                tuple(
                    replace(flip, antenna=antenna.name, leg=cycle.leg.name)
                    for antenna in robot.antennas
                    if antenna.leg == cycle.leg.name and antenna.connected
                    for flip in flips(first, antenna.cell, antenna.moves, antenna.swing)
                ),
                firsts[i].gait(),
                rigid[i],
            )
        )
    ways = x / robot.u_max, y / robot.u_max, turn, first_x / robot.u_max
    strokes = cycles[0].turns.unloading_end, cycles[0].turns.loading_end
    return Prediction(robot, tuple(legs), *ways, strokes, too_soft(robot))


def predicted_gaits(robot: Robot) -> tuple[str, ...]:
    """For each leg the states of the cycle that repeats itself; errors as for `Robot.predict`."""
    return _gaits(cycling.leg_cycles(robot))


def too_soft(robot: Robot) -> str:
    """Effect of the drive's compliance on the gait, in words; "" without one."""
    cycles, stiffness = cycling.leg_cycles(robot), robot.drive.stiffness
    gaits = _gaits(cycles)
    if _completes(robot, cycles, stiffness) or gaits == _gaits(cycling.leg_cycles(robot, math.inf)):
        return ""
    turns = cycles[0].turns
    text = (
        f"the drive is too soft: with {stiffness:g} N/m the legs move from "
        f"{to_unit(turns.unloading_end, 'mm'):.1f} to {to_unit(turns.loading_end, 'mm'):.1f} mm of "
        f"{to_unit(robot.drive.amplitude, 'mm'):g} mm"
    )
    firsts = tuple(cycle.first for cycle in cycles)
    if gaits == _gaits(firsts):
        return text
    advance = slide(robot, firsts).displacement()[0] / robot.u_max
    states = ", ".join(dict.fromkeys(gait or "none" for gait in gaits))
    stuck = all(">" not in gait for gait in gaits)
    then = f"is stuck in state {states}" if stuck else f"continues with the gait {states}"
    return f"{text}; the first cycle advances by {advance:.2f} u_max, then the robot {then}"


def _gaits(cycles: Sequence[LegCycle]) -> tuple[str, ...]:
    return tuple(cycle.gait() for cycle in cycles)


def _other_drives(
    robot: Robot, cycles: tuple[LegCycle, ...]
) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Gaits of all legs with a rigid drive, and gaits with the uncertain force added or removed.

    If the drive has enough force for both, they are the gaits of `cycles`, without a new path.
    """
    unknown = sum(_uncertainty(robot, cycle.leg) for cycle in cycles)
    if _completes(robot, cycles, robot.drive.stiffness, unknown):
        return _gaits(cycles), []
    stances = [cycle.stances for cycle in cycles]
    stiffness = robot.drive.stiffness
    others = (
        cycling.run_leg_cycles(robot, stances, stiffness, force) for force in (unknown, -unknown)
    )
    return _gaits(cycling.leg_cycles(robot, math.inf)), list(map(_gaits, others))


def _completes(
    robot: Robot, cycles: Sequence[LegCycle], stiffness: float, added_force: float = 0.0
) -> bool:
    """Whether the carriage reaches both ends of its stroke in these cycles."""
    spring = Spring(robot.drive.amplitude, stiffness, added_force)
    reach = min(robot.drive.amplitude, *(cycle.leg.chain.full_stroke for cycle in cycles))
    out, back = (
        spring.stops(cycling.forces(cycles, 0), 1),
        spring.stops(cycling.forces(cycles, 1), -1),
    )
    return out >= reach - cycling.ROUNDING and back <= cycling.ROUNDING


def _visits_same_states(robot: Robot, cycles: Sequence[LegCycle], stiffness: float) -> bool:
    """Whether the legs visit the same states in the strokes that the carriage reaches."""
    spring = Spring(robot.drive.amplitude, stiffness)
    for half, way in enumerate((1, -1)):
        end = spring.stops(cycling.forces(cycles, half), way)
        for cycle in cycles:
            ahead, full = cycle.halves[half], np.array(cycle.leg.chain.full_travels)
            gone = ahead.travel[way * ahead.stroke <= way * end + cycling.ROUNDING]
            travels = np.concatenate([gone, ahead.at(np.array([end]))[0]])
            if gait(travels / full) != gait(ahead.travel / full):
                return False
    return True


@lru_cache(maxsize=32)
def drive_needs(robot: Robot) -> DriveNeeds:
    """Requirements on the actuator for the gaits that a robot has with a rigid drive."""
    cycles = cycling.leg_cycles(robot, math.inf)
    push, pull = largest(cycling.forces(cycles, 0), 1), largest(cycling.forces(cycles, 1), -1)
    scale = max(push, pull) / robot.drive.amplitude
    softest, stiffest = scale / STIFFNESSES, scale * STIFFNESSES

    def least(holds: Callable[[float], bool]) -> float:
        """The least stiffness for which a condition on these half cycles holds."""
        if holds(softest):
            return softest
        logs = math.log(stiffest), math.log(softest)
        return math.exp(bisected(lambda log: holds(math.exp(log)), *logs, 30)[0])

    # Between these two the carriage stops beyond the last state that a leg visits.
    enough = least(partial(_completes, robot, cycles))
    needed = min(enough, least(partial(_visits_same_states, robot, cycles)))

    def gaits(stiffness: float) -> str:
        stances = [cycle.stances for cycle in cycles]
        return str(_gaits(cycling.run_leg_cycles(robot, stances, stiffness)))

    looks = np.geomspace(enough, needed * (1.0 - WITHIN), LOOKS_FOR_STIFFNESS).tolist()
    if needed < (1.0 - WITHIN) * enough:
        enough = next(changes(gaits, looks, STIFFNESS_HALVINGS), (0.0, ""))[0]
    return DriveNeeds(push, pull, enough if enough > softest else 0.0)


@lru_cache(maxsize=32)
def depths(robot: Robot) -> tuple[tuple[float, float], ...]:
    """Range of preload depths [m] in which each leg certainly keeps the predicted gait.

    In this range the gait does not depend on the uncertain force. If the gait is uncertain at the
    feet's own depth, both ends are that depth.
    """
    cycles = tuple(cycle.first for cycle in cycling.leg_cycles(robot))
    own = cache(lambda i: _depths(robot, i, cycles))
    return tuple(map(own, _first_alike(cycles)))


def known_depths(robot: Robot) -> tuple[tuple[float, float] | None, ...]:
    """The same as `depths`, None for every leg if the path could not be followed."""
    try:
        return depths(robot)
    except StaticsError:
        return (None,) * len(robot.legs)


def _first_alike(cycles: Sequence[LegCycle]) -> list[int]:
    """For each leg the index of the first equal leg, or of the first mirror image."""
    return [
        [other.alike(cycle.leg, cycle.stances) for other in cycles].index(True) for cycle in cycles
    ]


def _uncertainty(robot: Robot, leg: Leg) -> float:
    """Uncertain force [N] between two cells, from the speed of the drive."""
    speed = 2.0 * robot.drive.amplitude / robot.drive.period
    damping = robot.blocks.damping
    # Half of the damping is the lag that is in the cycle as friction: it depends on the start which
    # of two cells bears it. A block follows its neighbour with a delay of m/2c, and meanwhile the
    # cells' forces fall at this rate.
    late = robot.blocks.mass / (2.0 * damping)
    falls = max(abs(c.force_0 - c.force_1) / c.full_travel for c in leg.chain.levers)
    return damping * speed / 2.0 + falls * speed * late


def _margin_and_alternatives(cycle: LegCycle) -> tuple[float, str, tuple[str, ...]]:
    """Smallest force [N] on one cell that changes the gait, the new gait, and alternatives."""
    cells = len(cycle.leg.chain)
    # At a given stroke a force on one of two cells acts as the opposite force on the other.
    tried = (cells - 1,) if cells == 2 else range(cells)
    margin, nearest = math.inf, ""
    for cell, sense in product(tried, (1.0, -1.0)):

        def pushed(force: float, cell: int = cell, sense: float = sense) -> str:
            extra = {cell: sense * force}
            # Without a force it is the known cycle.
            return (
                cycling.run_leg_cycle(cycle.leg, cycle.stances, cycle.turns, extra).gait()
                if force
                else cycle.gait()
            )

        nearer = [force for force in FORCES if force < margin]
        looks = [*nearer, margin] if math.isfinite(margin) else nearer
        change = next(changes(pushed, looks), None)
        if change is not None and change[0] < margin:
            margin, nearest = change
    # Other forces of the floor: no drag, or a load that does not depend on the step.
    others = {cycle.gait(tolerance) for tolerance in TOLERANCES}
    for out, back in (
        [replace(foot, drags=False) for foot in cycle.stances],
        [replace(foot, load=np.full_like(foot.load, foot.load[0])) for foot in cycle.stances],
    ):
        others.add(cycling.run_leg_cycle(cycle.leg, (out, back), cycle.turns).gait())
    return margin, nearest, tuple(sorted(others - {cycle.gait()}))


def _depths(robot: Robot, index: int, cycles: Sequence[LegCycle]) -> tuple[float, float]:
    """Range of preload depths [m] in which a leg keeps its gait despite the uncertain force."""
    foot, leg = robot.foot, robot.legs[index]
    unknown, gait = _uncertainty(robot, leg), cycles[index].gait()
    # All legs have the same depth, and it cannot exceed the lift of any last cell.
    shortest = min(one.chain.cells[-1].full_travel for one in robot.legs)
    deepest = 0.999 * float(foot.depth(0.0) - foot.depth(shortest))

    def gait_at(below: float) -> str:
        other = replace(robot, foot=replace(foot, below=below))
        stances = cycling.footing(other, index, cycles, leaning(other))
        for force in (unknown, -unknown):
            extra = {len(leg.chain) - 1: force}
            try:
                after = cycling.run_leg_cycle(leg, stances, cycles[index].turns, extra).gait()
            except StaticsError:
                return "not followed"  # counts as another gait
            if after != gait:
                return after
        return gait

    def first_change(looks: list[float]) -> float:
        return next(changes(gait_at, [foot.below, *looks], DEPTH_HALVINGS), (looks[-1], ""))[0]

    if gait_at(foot.below) != gait:
        return foot.below, foot.below
    deeper = [foot.below + more for more in DEEPER if foot.below + more < deepest]
    return first_change([foot.below / 2, 0.0]), first_change([*deeper, max(deepest, foot.below)])


def _flips(
    robot: Robot, cycle: LegCycle, cell: int | str, moves: Vec2, swing: float
) -> Iterator[Flip]:
    """Changes of gait as an antenna moves this anchor p; the antenna's name is left empty."""
    unknown, length, before = _uncertainty(robot, cycle.leg), math.hypot(*moves), cycle.gait()

    def thresholds(force: float) -> list[tuple[float, str]]:
        def pressed(share: float) -> str:
            leg, last = cycle.leg.with_moved_anchor(cell, moves, share), len(cycle.leg.chain) - 1
            return cycling.run_leg_cycle(leg, cycle.stances, cycle.turns, {last: force}).gait()

        return list(changes(pressed, np.linspace(0.0, 1.0, LOOKS).tolist()))

    around = [thresholds(force) for force in (unknown, -unknown)]
    for share, after in thresholds(0.0):
        # The same change with the uncertain force added and removed.
        same = [next((s for s, g in changed if g == after), math.inf) for changed in around]
        early, late = min(share, *same) * length, max(share, *same) * length
        yield Flip("", cycle.leg.name, share * length, early, late, share * swing, before, after)
        before = after


def _pushes(robot: Robot, index: int, cycle: LegCycle, slid: Slide) -> Iterator[Push]:
    for half in (0, 1):
        rows = slice(half * STEPS, (half + 1) * STEPS)
        step, load = slid.push[rows, index], slid.load[rows, index]
        total = float(step.sum())
        if abs(total) < PUSHES * cycle.leg.stroke:
            continue
        # Only pushes in the direction of the total, not those during the handover of weight.
        pushing = np.maximum(np.sign(total) * step, 0.0)
        carries = float(pushing @ load / pushing.sum())
        feet = (slid.load[rows] > 0.0).sum(axis=1)
        sharing = float(pushing @ feet / pushing.sum())
        gain, slip = (float(of[rows, index].sum()) for of in (slid.gain, slid.slip))
        most = _largest_drag(robot, cycle, carries, sharing)
        yield Push(not half, total, gain, slip, carries, robot.floor.drag, *most)


def _largest_drag(
    robot: Robot, cycle: LegCycle, load: float, sharing: float
) -> tuple[float, PushEnd]:
    """The floor's drag [N] at which a foot slips or the gait of its leg changes."""
    left = robot.weight - sharing * load
    if left <= 0.0 or robot.floor.gravity == 0.0:
        return math.inf, PushEnd.NOTHING
    slips = robot.mass * 9.81 * sharing * robot.floor.foot_friction * load / left

    def dragged(drag: float) -> str:
        other = replace(robot, floor=replace(robot.floor, drag=drag))
        out, back = (replace(foot, robot=other) for foot in cycle.stances)
        return cycling.run_leg_cycle(cycle.leg, (out, back), cycle.turns).gait()

    if slips > robot.floor.drag:
        for drag, _ in changes(dragged, np.linspace(robot.floor.drag, slips, 9).tolist()):
            return drag, PushEnd.GAIT
    return slips, PushEnd.SLIP
