"""Robots with a given behaviour: found designs with margins and yield, or conflicting rows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations, product
from typing import Any, NamedTuple

import numpy as np

from stepwell.base import ByValue, Floats, Progress, check
from stepwell.design import DEFAULT_TOLERANCES, Draws, Fraction, Tolerances, fraction_of
from stepwell.mechanism import Chain
from stepwell.robot.behaviour import STEPS, Action, BehaviourRow, LegGait, RobotBehaviour
from stepwell.robot.behaviour_search import (
    ChosenNumbers,
    DesignSearch,
    Displaced,
    Leg,
    PairSearch,
    Pressed,
    Wiring,
    band_types,
    curves,
    pressed,
    row_margins,
    wirings,
)
from stepwell.robot.gait_rules import Bands, GaitRules
from stepwell.robot.robot import Robot

MOST_DESIGNS = 20_000_000
SAMPLES = 500
STEPS_ON = 0.5  # part of a forward step that a design should have
SHOWN = 5  # designs in a result
# Of more designs, those that most of a few samples have are sampled in full.
SAMPLED, _FEW = 100, 40
# Yields in one interval of this width count as equal, so that the margin decides.
SAME_YIELD = 0.005
NUDGE = 1e-6  # displacement of an anchor for slopes of the margins [m]
_LOOKS = 9  # angles at which the pull on an antenna is computed


class GaitForces(NamedTuple):
    """Forces that decide which cell of a leg moves first [N].

    Attributes:
        inner_0, opens: F0 of the inner cell, and the force at which the outer cell opens.
        inner_1, closes: F1 of the inner cell, and the force at which the outer cell closes.
    """

    inner_0: float
    opens: float
    inner_1: float
    closes: float


@dataclass(frozen=True, slots=True, eq=False)
class RowMargin(ByValue):
    """The distance of a design to the loss of a row of its table.

    Attributes:
        row: of the table.
        gaits: of the left and of the right leg.
        force: smallest force on a cell that changes one of them [N]; negative if one is wrong,
            infinite for a row that is left open.
        anchor: smallest displacement of one anchor that changes one of them, from slopes [m].
        orders: forces that decide the gait of the left and of the right leg.
    """

    row: BehaviourRow
    gaits: tuple[LegGait, LegGait]
    force: float
    anchor: float
    orders: tuple[GaitForces, GaitForces]


@dataclass(frozen=True, slots=True, eq=False)
class CompiledDesign(ByValue):
    """A design that has a behaviour in closed form.

    Attributes:
        robot: the whole robot.
        places: the numbers that were chosen.
        rows: margins of all rows of the table.
        built: fraction of random samples within tolerances that have all rows.
        step: part of a forward step in which the foot grips [1]; NaN if no row steps forward.
        tip_force: largest contact force at an antenna's tip that the band resists with [N].
    """

    robot: Robot = field(repr=False)
    places: ChosenNumbers
    rows: tuple[RowMargin, ...]
    built: Fraction
    step: float
    tip_force: float

    @property
    def margin(self) -> float:
        """The smallest margin of all rows [N]."""
        return min(row.force for row in self.rows)

    @property
    def anchor(self) -> float:
        """The smallest displacement of one anchor that changes a row [m]."""
        return min(row.anchor for row in self.rows)


@dataclass(frozen=True, slots=True, eq=False)
class Compiled(ByValue):
    """Designs that have a behaviour, or the rows that exclude each other.

    Attributes:
        behaviour: the table.
        designs: the best designs, by yield and then by margin; empty if none was found.
        searched: number of designs evaluated.
        met: number of evaluated designs with all rows.
        conflict: contacts of the smallest set of rows that no design has together; empty if a
            design was found, or if the search ended early.
        proved: whether the conflict holds for all anchors, bands and depths.
        displaced: best margins by displacement and number of inner bands.
        tolerances, samples, seed: of the yields.
    """

    behaviour: RobotBehaviour
    designs: tuple[CompiledDesign, ...]
    searched: int
    met: int
    conflict: tuple[str, ...]
    proved: bool
    displaced: tuple[Displaced, ...]
    tolerances: Tolerances
    samples: int
    seed: int

    @property
    def total(self) -> int:
        """Number of all designs of the choice."""
        choice = self.behaviour.choice
        return choice.designs if self.equal_legs else choice.pairs

    @property
    def equal_legs(self) -> bool:
        """Whether designs with two equal legs were searched: the table is its mirror image."""
        return self.behaviour.is_mirrored

    @property
    def force(self) -> float:
        """k r of one band [N], to compare margins with."""
        lever = self.behaviour.robot.legs[0].chain.levers[0].lever
        return band_types(self.behaviour)[0].stiffness * lever

    @property
    def decided(self) -> bool:
        """Whether a design was found, or the rows exclude each other."""
        return bool(self.designs or self.conflict)

    @property
    def robot(self) -> Robot:
        """The best design; without one the given robot."""
        return self.designs[0].robot if self.designs else self.behaviour.robot

    def __repr__(self):
        found = f"{self.met} designs" if self.designs else "no design"
        conflict = f", conflict of {', '.join(self.conflict)}" if self.conflict else ""
        return f"Compiled({found} among {self.searched} of {self.total}{conflict})"


def compile_behaviour(
    behaviour: RobotBehaviour,
    *,
    tolerances: Tolerances = DEFAULT_TOLERANCES,
    samples: int = SAMPLES,
    seed: int = 0,
    most: int = MOST_DESIGNS,
    progress: Progress | None = None,
) -> Compiled:
    """Search designs of a robot that have a behaviour, in closed form.

    If the table is its own mirror image, both legs are equal, and all designs of the choice are
    evaluated by `GaitRules`. Otherwise the legs may differ, and pairs of legs are evaluated whose
    bound is above the margins that were found, see `PairSearch`. Designs of the largest margins are
    sampled within tolerances and ordered by yield. Nothing is simulated here:
    `stepwell.simulation.behaviour_trials` walks a design through all rows.

    Args:
        behaviour: the table, the robot, and the numbers to choose from.
        tolerances: of the samples; equal bands on one cell deviate together.
        samples, seed: number of samples of each design, > 0, and random seed.
        most: largest number of designs evaluated, > 0. If it is less than all, and none of
            these has the behaviour, the result is not decided.
        progress: called with (done, total) designs.

    Raises:
        ValueError: no samples, or no designs to evaluate.
    """
    check.whole("samples", samples, 1)
    check.whole("most", most, 1)
    conflict = contradiction(behaviour)
    search = (DesignSearch if behaviour.is_mirrored else PairSearch)(behaviour)
    proved, total = bool(conflict), search.total
    searched = 0 if proved else search.run(most, progress)
    likely = _likeliest(behaviour, search.best(), tolerances, seed)
    designs = [_designed(behaviour, one, tolerances, samples, seed) for one in likely]
    designs.sort(key=_rank)
    if not proved and not designs and searched == total:
        conflict = search.conflict()
    return Compiled(
        behaviour,
        tuple(designs[:SHOWN]),
        searched,
        search.met,
        conflict,
        proved,
        search.displaced(),
        tolerances,
        samples,
        seed,
    )


def _likeliest(
    behaviour: RobotBehaviour, found: list[ChosenNumbers], tolerances: Tolerances, seed: int
) -> list[ChosenNumbers]:
    """Designs to sample: those with the largest yields of a few samples, then margins."""
    if len(found) <= SAMPLED:
        return found
    few = [
        _made(behaviour, one, robot_of(behaviour, one), (tolerances, _FEW, seed)) for one in found
    ]
    order = sorted(range(len(found)), key=lambda k: -few[k])
    return [found[k] for k in sorted(order[:SAMPLED])]


def _rank(design: CompiledDesign) -> tuple[bool, int, float]:
    """Designs that hardly step come last; then by yield, then by margin."""
    return design.step < STEPS_ON, -round(design.built.estimate / SAME_YIELD), -design.margin


def contradiction(behaviour: RobotBehaviour) -> tuple[str, ...]:
    """Contacts of the fewest rows that exclude each other for all designs.

    Both legs are equal if the table is its own mirror image; otherwise they may differ. Which cell
    of a leg moves first while unloading depends on this leg and its own antenna alone: then its
    foot is in the air, so no weight of the body is on it. Rows that need both orders exclude each
    other.
    """
    rows = behaviour.rows
    for size in range(1, len(rows) + 1):
        for some in combinations(rows, size):
            if not any(_consistent(behaviour, wiring, some) for wiring in wirings(behaviour)):
                return tuple(row.contact for row in some)
    return ()


def _consistent(behaviour: RobotBehaviour, wiring: Wiring, rows: Sequence[BehaviourRow]) -> bool:
    """Whether the unloading orders of some rows agree, of each leg or of two equal ones."""
    moved = [pressed(behaviour, wiring, row.contact) for row in rows]
    for gaits in product(*(row.motion.gaits for row in rows)):
        order: dict[tuple[int, bool], bool] = {}
        orders = [
            ((0 if behaviour.is_mirrored else side, at), gait.unloading)
            for pair, legs in zip(gaits, moved, strict=True)
            for side, (gait, at) in enumerate(zip(pair, legs, strict=True))
        ]
        if all(order.setdefault(at, unloading) == unloading for at, unloading in orders):
            return True
    return False


class _Numbers(NamedTuple):
    """Bands of the cells of m robots: left inner and outer, then right inner and outer."""

    d: Floats  # (m, 4, 2) q - p [m]
    stiffness: Floats  # (m, 4) [N/m]
    rest: Floats  # (m, 4) [m]


class _Variants(NamedTuple):
    """Left and right legs of m variants of a robot, at rest and with their anchors displaced."""

    forces: tuple[Leg, Leg]
    steps: tuple[tuple[Floats, Floats], tuple[Floats, Floats]]  # parts of a forward step [1]

    @classmethod
    def of(cls, robot: Robot, rules: GaitRules, numbers: _Numbers) -> _Variants:
        """Variants with the bands of `numbers`, and the antennas of the robot."""
        law, moves = robot.legs[0].chain.levers[0].bands[0].law, robot.antennas[0].moves
        d, k, rest = numbers
        cells = [Bands(d[:, i, 0], d[:, i, 1], k[:, i], rest[:, i], law) for i in range(4)]
        (left, left_moved), (right, right_moved) = (
            ((inner, outer), (inner.displaced(*moves), outer))
            for inner, outer in (cells[:2], cells[2:])
        )
        forces, step = rules.forces, rules.step
        return cls(
            ((forces(*left), forces(*left_moved)), (forces(*right), forces(*right_moved))),
            ((step(*left), step(*left_moved)), (step(*right), step(*right_moved))),
        )

    def margins(
        self, behaviour: RobotBehaviour, wiring: Wiring, rules: GaitRules
    ) -> tuple[Floats, list[Any], Any]:
        """Margins of all rows (R, m) [N], numbers of their gaits, and whether they have a curve."""
        rows = [(row.motion, pressed(behaviour, wiring, row.contact)) for row in behaviour.rows]
        return *row_margins(rules, rows, self.forces), curves(rules, rows, *self.steps)


def rows_of(behaviour: RobotBehaviour, robot: Robot, wiring: Wiring) -> tuple[RowMargin, ...]:
    """Margins of all rows of a table for a robot, with antennas wired so."""
    numbers = _numbers(_cells(robot))
    # The nominal robot, then each coordinate of each cell's q - p a little further.
    nudged = np.repeat(numbers.d, 9, axis=0)
    for i, (cell, axis) in enumerate(product(range(4), range(2)), 1):
        nudged[i, cell, axis] += NUDGE
    variants = _Numbers(nudged, *(np.repeat(one, 9, axis=0) for one in numbers[1:]))
    rules = GaitRules(robot)
    legs = _Variants.of(robot, rules, variants)
    force, which, _ = legs.margins(behaviour, wiring, rules)
    # Rows that are left open keep an infinite margin: it has no slope.
    known = np.where(np.isinf(force), 0.0, force)
    slopes = (known[:, 1:] - known[:, :1]).reshape(-1, 4, 2) / NUDGE
    steepest = np.hypot(slopes[..., 0], slopes[..., 1]).max(axis=1)
    return tuple(
        RowMargin(
            row,
            row.motion.gaits[int(best[0])],
            float(now),
            float(now / slope) if slope > 0.0 else math.inf,
            _orders(rules, legs.forces, pressed(behaviour, wiring, row.contact)),
        )
        for row, best, now, slope in zip(behaviour.rows, which, force[:, 0], steepest, strict=True)
    )


def _orders(rules: GaitRules, legs: tuple[Leg, Leg], at: Pressed) -> tuple[GaitForces, GaitForces]:
    """Forces that decide the gaits of the nominal robot, the first variant."""
    left, right = (leg[moved] for leg, moved in zip(legs, at, strict=True))
    gaps = rules.gaps((left, right))
    first, second = (
        GaitForces(
            *(float(one.inner_0[0]), float(one.inner_0[0] + rules.rail + loading[0])),
            *(float(one.inner_1[0]), float(one.inner_1[0] - rules.rail - unloading[0])),
        )
        for one, (loading, unloading) in zip((left, right), gaps, strict=True)
    )
    return first, second


def _cells(robot: Robot) -> list[Any]:
    """Cells of a robot: left inner and outer, then right inner and outer."""
    sides = sorted(robot.legs, key=lambda leg: -leg.side)
    return [cell for leg in sides for cell in leg.chain.levers]


def _numbers(cells: Sequence[Any]) -> _Numbers:
    bands = [cell.bands[0] for cell in cells]
    stiffness = [[band.stiffness for band in bands]]
    rest = [[band.rest_length for band in bands]]
    return _Numbers(*(np.array(one) for one in ([[b.d for b in bands]], stiffness, rest)))


def _designed(
    behaviour: RobotBehaviour,
    places: ChosenNumbers,
    tolerances: Tolerances,
    samples: int,
    seed: int,
) -> CompiledDesign:
    """A found design with its margins row by row and its yield."""
    robot = robot_of(behaviour, places)
    rules = GaitRules(robot)
    right = _made(behaviour, places, robot, (tolerances, samples, seed))
    rows = rows_of(behaviour, robot, places.wiring)
    # The steps of the legs that step forward: at rest, or only with their anchors displaced.
    legs = [_bands_of(robot, side) for side in (0, 1)]
    steps = [
        float(rules.step(moved if displaced else inner, outer))
        for row in rows
        for gait, displaced, (inner, outer, moved) in zip(
            row.gaits, pressed(behaviour, places.wiring, row.row.contact), legs, strict=True
        )
        if gait == STEPS and row.row.motion is not Action.ANY
    ]
    tip = max(_tip_force(robot, rules, moved) for _, _, moved in legs)
    built = fraction_of(right, samples)
    return CompiledDesign(robot, places, rows, built, min(steps, default=math.nan), tip)


def _made(
    behaviour: RobotBehaviour,
    places: ChosenNumbers,
    robot: Robot,
    sampling: tuple[Tolerances, int, int],
) -> int:
    """Number of samples of a robot that have all rows; tolerances, samples and seed are given."""
    tolerances, samples, seed = sampling
    drawing, rules = Draws(Chain(_cells(robot)), tolerances, seed), GaitRules(robot)
    right = 0
    for drawn in drawing.chunks(samples):
        sampled = drawing.designs(drawn)
        assert sampled is not None, "a chain of four cells with bands"
        bands = sampled.bands
        numbers = _Numbers(bands[..., :2], bands[..., 2], bands[..., 3])
        variants = _Variants.of(robot, rules, numbers)
        margins, _, curved = variants.margins(behaviour, places.wiring, rules)
        right += int(((margins > 0.0) & curved).all(axis=0).sum())
    return right


def _bands_of(robot: Robot, side: int) -> tuple[Bands, Bands, Bands]:
    """Bands of the inner and of the outer cell of a leg, and of the inner one displaced."""
    cells = _cells(robot)[2 * side : 2 * side + 2]
    (d,), (k,), (rest,) = _numbers(cells)
    law = cells[0].bands[0].law
    inner, outer = (Bands(d[i, 0], d[i, 1], k[i], rest[i], law) for i in range(2))
    return inner, outer, inner.displaced(*robot.antennas[0].moves)


def _tip_force(robot: Robot, rules: GaitRules, bands: Bands) -> float:
    """Largest force at the tip of an antenna that a displaced band resists with [N]."""
    antenna = robot.antennas[0]
    angles = np.linspace(-rules.limit, rules.limit, _LOOKS)
    moves = np.array(antenna.moves)
    pull = max(float(bands.pull(angle, rules.lever, moves)) for angle in angles)
    return pull * antenna.gear / antenna.length


def robot_of(behaviour: RobotBehaviour, places: ChosenNumbers) -> Robot:
    """The robot of a behaviour with chosen numbers; its antennas keep their gearing."""
    base, band = behaviour.robot, places.band
    legs = []
    for leg in base.legs:
        own = places.legs[leg.side < 0]
        anchors = (own.inner, own.inner_bands), (own.outer, own.outer_bands)
        cells = [
            replace(cell, band=band.between(cell.bands[0].p, q, count))
            for cell, (q, count) in zip(leg.chain.levers, anchors, strict=True)
        ]
        legs.append(replace(leg, chain=replace(leg.chain, cells=tuple(cells))))
    sides = {int(leg.side < 0): leg.name for leg in base.legs}
    joined = dict(zip(behaviour.antennas, places.wiring, strict=True))
    swing = math.hypot(*places.moves)
    antennas = [
        replace(one, leg=sides[joined[one]], cell=0, moves=places.moves, swing=swing / one.gear)
        for one in base.antennas
    ]
    # The chosen numbers are no longer those of the sources.
    chosen = ("chain", "leg", "antenna", "foot")
    sources = {path: label for path, label in base.sources.items() if not path.startswith(chosen)}
    return replace(
        base,
        legs=legs,
        antennas=antennas,
        foot=replace(base.foot, below=places.below),
        sources=sources,
        title=behaviour.title or "Robot with a compiled behaviour",
    )
