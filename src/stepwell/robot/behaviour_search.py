"""Evaluation of all designs of a choice by the closed form of their gaits, block by block."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import combinations, permutations, product
from typing import Any, NamedTuple

import numpy as np

from stepwell.base import Floats, Progress, Vec2, notify
from stepwell.design import BandType
from stepwell.robot.behaviour import CURVE, Action, BehaviourRow, RobotBehaviour
from stepwell.robot.gait_rules import Bands, GaitRules, LegForces

SHORTLIST = 1000  # designs of the largest margins that are kept
_LEFT, _RIGHT = 256, 1024  # legs of a block of pairs that is evaluated at once

Wiring = tuple[int, ...]  # for each antenna from the left: the leg whose anchor it moves
Pressed = tuple[bool, bool]  # whether the anchor of the left and of the right leg is displaced
AT_REST, DISPLACED = 0, 1
Leg = tuple[LegForces, LegForces]  # its forces at rest, and with its anchor displaced


class LegNumbers(NamedTuple):
    """Anchors q of the inner and of the outer cell of a leg [m], and number of bands on each."""

    inner: Vec2
    outer: Vec2
    inner_bands: int
    outer_bands: int


class ChosenNumbers(NamedTuple):
    """Chosen numbers of a design.

    Attributes:
        inner, outer: anchors q of the inner and of the outer cell [m], of the left leg.
        moves: displacement of the inner anchor p by an antenna [m].
        inner_bands, outer_bands: number of bands on each cell of the left leg.
        below: preload depth [m].
        band: type of all bands.
        wiring: for each antenna from the left, the leg whose anchor it moves: 0 left, 1 right.
        right: numbers of the right leg; None if the legs are equal.
    """

    inner: Vec2
    outer: Vec2
    moves: Vec2
    inner_bands: int
    outer_bands: int
    below: float
    band: BandType
    wiring: Wiring
    right: LegNumbers | None = None

    @property
    def legs(self) -> tuple[LegNumbers, LegNumbers]:
        """Numbers of the left and of the right leg."""
        left = LegNumbers(self.inner, self.outer, self.inner_bands, self.outer_bands)
        return left, self.right or left


class Displaced(NamedTuple):
    """Designs with one length of displacement and one number of inner bands.

    Attributes:
        moves: length of the displacement [m].
        inner_bands: number of bands on the inner cell.
        designs: number of designs with all rows.
        margin: largest margin [N]; NaN without a design.
        bound: largest possible margin of a leg that changes from forward to backward [N], if the
            thresholds do not move: half of the smaller change of F0 and of F1.
    """

    moves: float
    inner_bands: int
    designs: int
    margin: float
    bound: float


def band_types(behaviour: RobotBehaviour) -> tuple[BandType, ...]:
    """The types of band of a choice; by default the one on the robot's outer cell."""
    own = behaviour.robot.legs[0].chain.levers[-1].bands[0]
    return tuple(behaviour.choice.bands) or (BandType.of(own),)


def wirings(behaviour: RobotBehaviour) -> tuple[Wiring, ...]:
    """Every way in which the antennas can be joined to the legs, the robot's own first."""
    robot = behaviour.robot
    own = tuple(int(robot.leg(one.leg).side < 0) for one in behaviour.antennas)
    every = permutations((0, 1), len(own))
    return tuple(sorted(every, key=lambda one: one != own))


def pressed(behaviour: RobotBehaviour, wiring: Wiring, contact: str) -> Pressed:
    """Whether a contact displaces the anchor of the left and of the right leg."""
    names = [one.name for one in behaviour.antennas]
    legs = {wiring[names.index(name)] for name in behaviour.touched(contact)}
    return 0 in legs, 1 in legs


def row_margins(
    rules: GaitRules, rows: Sequence[tuple[Action, Pressed]], legs: tuple[Leg, Leg]
) -> tuple[Floats, list[Any]]:
    """Margins of rows (R, ...) [N], and for each row the number of its best pair of gaits (...).

    A row that is left open has an infinite margin.
    """
    gaps: dict[Pressed, tuple[tuple[Floats, Floats], ...]] = {}
    margins: list[Floats] = []
    which: list[Any] = []
    for action, at in rows:
        if at not in gaps:
            left, right = (leg[moved] for leg, moved in zip(legs, at, strict=True))
            gaps[at] = rules.gaps((left, right))
        each: list[Floats] = []
        for pair in action.gaits:
            signed = [
                own[half] if first else -own[half]
                for own, gait in zip(gaps[at], pair, strict=True)
                for half, first in enumerate(gait)
            ]
            each.append(np.minimum.reduce(np.broadcast_arrays(*signed)))
        which.append(np.argmax(each, axis=0))
        best = np.max(each, axis=0)
        margins.append(np.full_like(best, np.inf) if action is Action.ANY else best)
    return np.array(np.broadcast_arrays(*margins)), which


class DesignSearch:
    """Evaluation of all designs of a choice with two equal legs.

    Attributes:
        met: number of evaluated designs with all rows.
    """

    def __init__(self, behaviour: RobotBehaviour):
        self.met = 0
        self._behaviour, self._choice = behaviour, behaviour.choice
        self._found: list[tuple[float, ChosenNumbers]] = []
        # How many designs have which rows, as bits of the index.
        self._patterns = np.zeros(2 ** len(behaviour.rows), np.int64)
        self._table: dict[tuple[float, int], list[float]] = {}

    @property
    def total(self) -> int:
        """Number of all designs of the choice."""
        return self._choice.designs

    def run(self, most: int, progress: Progress | None) -> int:
        """Evaluate at most this number of designs; the number evaluated."""
        choice, done = self._choice, 0
        size = len(choice.holes) ** 2 * len(choice.displacements)
        for block in self._blocks():
            if done + size > most:
                break
            self._evaluate(*block)
            done += size
            notify(progress, done, choice.designs)
        return done

    def best(self) -> list[ChosenNumbers]:
        """Designs of the largest margins, one for each set of anchors."""
        ordered = sorted(self._found, key=lambda one: -one[0])
        first = {(one[:5], one.wiring): one for _, one in reversed(ordered)}
        return [one for _, one in ordered if first[one[:5], one.wiring] is one][:SHORTLIST]

    def conflict(self) -> tuple[str, ...]:
        """Contacts of the fewest rows that no evaluated design has together."""
        rows, numbers = self._behaviour.rows, np.arange(len(self._patterns))
        for size in range(1, len(rows) + 1):
            for some in combinations(range(len(rows)), size):
                bits = sum(1 << i for i in some)
                if not self._patterns[(numbers & bits) == bits].any():
                    return tuple(rows[i].contact for i in some)
        return ()

    def displaced(self) -> tuple[Displaced, ...]:
        """Best margins by length of the displacement and number of inner bands."""
        return tuple(
            Displaced(*key, int(count), margin if count else math.nan, bound)
            for key, (count, margin, bound) in sorted(self._table.items())
        )

    def _blocks(self) -> Iterator[tuple[BandType, float, int, int]]:
        choice = self._choice
        yield from product(
            band_types(self._behaviour), choice.below, choice.inner_bands, choice.outer_bands
        )

    def _evaluate(self, band: BandType, below: float, inner: int, outer: int) -> None:
        behaviour = self._behaviour
        rules = GaitRules.at_depth(behaviour.robot, below)
        holes, (x, y) = np.array(self._choice.holes).T, np.array(self._choice.displacements).T
        first, last = (np.array(c.bands[0].p) for c in behaviour.robot.legs[0].chain.levers)
        # Axes: hole of the inner cell, displacement, hole of the outer cell.
        at_rest = _bands(band, inner, (holes - first[:, None])[:, :, None, None])
        lifts = _bands(band, outer, (holes - last[:, None])[:, None, None, :])
        moves = np.stack([x, y], axis=-1)[:, None]
        moved = at_rest.displaced(moves[..., 0], moves[..., 1])
        usable = rules.falling(at_rest) & rules.falling(moved) & rules.falling(lifts)
        usable &= rules.returned(at_rest, moves) & rules.returned(moved, moves)
        leg = rules.forces(at_rest, lifts), rules.forces(moved, lifts)
        self._note_bounds(inner, usable, leg)
        steps = np.zeros((1, 1, 1)), np.zeros((1, 1, 1))
        if any(row.motion.gaits == Action.FORWARD.gaits for row in behaviour.rows[1:]):
            # Equal legs step equally, but for a touch that displaces the anchor of one.
            steps = rules.step(at_rest, lifts), rules.step(moved, lifts)
        for wiring in wirings(behaviour):
            rows = [(row.motion, pressed(behaviour, wiring, row.contact)) for row in behaviour.rows]
            margins, _ = row_margins(rules, rows, (leg, leg))
            margins = np.where(curves(rules, rows, steps, steps), margins, -np.inf)
            bits = np.tensordot(1 << np.arange(len(rows)), margins > 0.0, 1)
            self._patterns += np.bincount(bits[usable], minlength=len(self._patterns))
            self._take(margins.min(axis=0), usable, (inner, outer, below, band, wiring))

    def _take(self, margin: Floats, usable: Any, rest: tuple[Any, ...]) -> None:
        choice, found = self._choice, np.argwhere((margin > 0.0) & usable)
        self.met += len(found)
        values = margin[tuple(found.T)]
        lengths = self._lengths[found[:, 1]]
        for length in choice.moves:
            of_length = values[lengths == length]
            entry = self._table[length, rest[0]]
            entry[0] += len(of_length)
            entry[1] = max(entry[1], float(of_length.max(initial=-np.inf)))
        for k in np.argsort(-values, kind="stable")[:SHORTLIST].tolist():
            i, j, o = found[k].tolist()
            places = ChosenNumbers(choice.holes[i], choice.holes[o], choice.displacements[j], *rest)
            self._found.append((float(values[k]), places))

    def _note_bounds(self, inner: int, usable: Any, leg: Leg) -> None:
        rest, moved = leg
        changes = np.minimum(moved.inner_0 - rest.inner_0, rest.inner_1 - moved.inner_1) / 2.0
        changes = np.where(usable.any(axis=2), changes[:, :, 0], -np.inf)
        for length in self._choice.moves:
            bound = float(changes[:, self._lengths == length].max())
            entry = self._table.setdefault((length, inner), [0, -math.inf, -math.inf])
            entry[2] = max(entry[2], bound)

    @property
    def _lengths(self) -> Floats:
        return np.repeat(self._choice.moves, self._choice.directions)


def _bands(band: BandType, count: int, d: Floats) -> Bands:
    """Equal bands of one type with q - p in an array (2, ...) [m]."""
    return Bands(d[0], d[1], count * band.stiffness, band.rest_length, band.law)


class _Legs(NamedTuple):
    """Candidates for one leg: numbers of each, forces, and parts of a forward step."""

    numbers: list[LegNumbers]
    forces: Leg  # (n,) at rest, and with the anchor displaced
    steps: tuple[Floats, Floats]  # (n,) at rest, and with the anchor displaced [1]

    def at(self, which: Any, axis: int) -> tuple[Leg, tuple[Floats, Floats]]:
        """Forces and steps of some legs, with an axis for the other leg."""
        rest, moved = (
            LegForces(*(np.expand_dims(force[which], axis) for force in state))
            for state in self.forces
        )
        first, second = (np.expand_dims(step[which], axis) for step in self.steps)
        return (rest, moved), (first, second)


class PairSearch:
    """Evaluation of pairs of unequal legs: every pair whose margin can be among the largest.

    The margin of a pair is at most that of each leg with the best other leg. So legs are ordered by
    this bound, and pairs of legs below the smallest margin that is kept are left out. Both legs
    have the same displacement by antennas, foot depth and type of band.

    Args:
        behaviour: the table.
        rows: some rows of the table, the others left open; None for all.

    Attributes:
        met: number of evaluated pairs with all rows; those left out are not counted.
        evaluated: number of evaluated pairs.
    """

    def __init__(self, behaviour: RobotBehaviour, rows: Sequence[BehaviourRow] | None = None):
        self.met, self.evaluated = 0, 0
        self._behaviour, self._choice = behaviour, behaviour.choice
        self._rows = behaviour.rows if rows is None else tuple(rows)
        self._found: list[tuple[float, ChosenNumbers]] = []
        self._cut = 0.0

    @property
    def total(self) -> int:
        """Number of all pairs of the choice."""
        return self._choice.pairs

    def run(self, most: int, progress: Progress | None) -> int:
        """Evaluate at most this number of pairs; the number decided, left out ones included."""
        choice, done = self._choice, 0
        each = choice.leg_designs**2
        for rules, band, below, moves in self._groups():
            legs = self._candidates(rules, band, moves)
            for wiring in wirings(self._behaviour):
                if not self._evaluate(rules, legs, (below, band, wiring, moves), most):
                    return done
            done += each
            notify(progress, done, choice.pairs)
        return done

    def best(self) -> list[ChosenNumbers]:
        """Pairs of the largest margins."""
        return [places for _, places in self._found]

    def conflict(self) -> tuple[str, ...]:
        """Contacts of the fewest rows that no pair of the choice has together."""
        rows = self._behaviour.rows
        for size in range(1, len(rows) + 1):
            for some in combinations(rows, size):
                if not PairSearch(self._behaviour, some)._finds_one():
                    return tuple(row.contact for row in some)
        return ()

    def displaced(self) -> tuple[Displaced, ...]:
        """None: these margins are those of equal legs."""
        return ()

    def _finds_one(self) -> bool:
        """Whether any pair has the rows."""
        for rules, band, below, moves in self._groups():
            legs = self._candidates(rules, band, moves)
            for wiring in wirings(self._behaviour):
                self._evaluate(rules, legs, (below, band, wiring, moves))
                if self.met:
                    return True
        return False

    def _groups(self) -> Iterator[tuple[GaitRules, BandType, float, Vec2]]:
        choice, robot = self._choice, self._behaviour.robot
        for below, band in product(choice.below, band_types(self._behaviour)):
            rules = GaitRules.at_depth(robot, below)
            for moves in choice.displacements:
                yield rules, band, below, moves

    def _candidates(self, rules: GaitRules, band: BandType, moves: Vec2) -> _Legs:
        choice, holes = self._choice, np.array(self._choice.holes).T
        first, last = (np.array(c.bands[0].p) for c in self._behaviour.robot.legs[0].chain.levers)
        numbers: list[LegNumbers] = []
        parts: list[list[Floats]] = []
        for inner, outer in product(choice.inner_bands, choice.outer_bands):
            rest = _bands(band, inner, (holes - first[:, None])[:, :, None])
            lifts = _bands(band, outer, (holes - last[:, None])[:, None, :])
            moved = rest.displaced(*moves)
            usable = rules.falling(rest) & rules.falling(moved) & rules.falling(lifts)
            usable &= rules.returned(rest, moves) & rules.returned(moved, moves)
            numbers += [
                LegNumbers(choice.holes[i], choice.holes[o], inner, outer)
                for i, o in np.argwhere(usable).tolist()
            ]
            parts.append(
                [
                    np.broadcast_to(number, usable.shape)[usable]
                    for one in (rest, moved)
                    for number in (*rules.forces(one, lifts), rules.step(one, lifts))
                ]
            )
        joined = [np.concatenate(one) for one in zip(*parts, strict=True)]
        forces = LegForces(*joined[:5]), LegForces(*joined[6:11])
        return _Legs(numbers, forces, (joined[5], joined[11]))

    def _evaluate(
        self,
        rules: GaitRules,
        legs: _Legs,
        shared: tuple[float, BandType, Wiring, Vec2],
        most: float = math.inf,
    ) -> bool:
        """Evaluate the pairs of some legs; whether the budget was enough."""
        rows = [
            (row.motion, pressed(self._behaviour, shared[2], row.contact)) for row in self._rows
        ]
        bounds = [leg_bounds(rules, rows, side, legs.forces) for side in (0, 1)]
        for bound, left, right in self._blocks(bounds):
            if bound <= self._cut:
                break
            if self.evaluated + len(left) * len(right) > most:
                return False
            self.evaluated += len(left) * len(right)
            (one, first), (other, second) = legs.at(left, 1), legs.at(right, 0)
            margins, _ = row_margins(rules, rows, (one, other))
            margins = np.where(curves(rules, rows, first, second), margins, -np.inf)
            numbers = [[legs.numbers[i] for i in which] for which in (left, right)]
            self._take(margins.min(axis=0), (numbers[0], numbers[1]), shared)
        return True

    def _blocks(self, bounds: list[Floats]) -> list[tuple[float, Any, Any]]:
        """Bound, left legs and right legs of blocks of pairs, the largest bounds first."""
        parts: list[list[Any]] = []
        for bound, size in zip(bounds, (_LEFT, _RIGHT), strict=True):
            ordered = np.argsort(-bound, kind="stable")[: int((bound > self._cut).sum())]
            parts.append([ordered[i : i + size] for i in range(0, len(ordered), size)])
        blocks = [(float(min(bounds[0][a[0]], bounds[1][b[0]])), a, b) for a, b in product(*parts)]
        return sorted(blocks, key=lambda block: -block[0])

    def _take(
        self,
        margins: Floats,
        legs: tuple[list[LegNumbers], list[LegNumbers]],
        shared: tuple[float, BandType, Wiring, Vec2],
    ) -> None:
        self.met += int((margins > 0.0).sum())
        below, band, wiring, moves = shared
        found = np.argwhere(margins > self._cut)
        values = margins[tuple(found.T)]
        for k in np.argsort(-values, kind="stable")[:SHORTLIST].tolist():
            one, other = legs[0][found[k, 0]], legs[1][found[k, 1]]
            own = one.inner, one.outer, moves, one.inner_bands, one.outer_bands
            places = ChosenNumbers(*own, below, band, wiring, None if one == other else other)
            self._found.append((float(values[k]), places))
        self._found.sort(key=lambda one: -one[0])
        del self._found[SHORTLIST:]
        if len(self._found) == SHORTLIST:
            self._cut = self._found[-1][0]


def leg_bounds(
    rules: GaitRules, rows: Sequence[tuple[Action, Pressed]], side: int, leg: Leg
) -> Floats:
    """Largest margins (n,) [N] of rows that legs on one side can have with any other leg."""
    limits = [rules.limits(state, side) for state in leg]
    bounds: list[Floats] = []
    for action, at in (row for row in rows if row[0] is not Action.ANY):
        light, heavy, unloading = limits[at[side]]
        each = [
            np.minimum(
                light if pair[side].loading else -heavy,
                unloading if pair[side].unloading else -unloading,
            )
            for pair in action.gaits
        ]
        bounds.append(np.max(each, axis=0))
    return np.min(bounds, axis=0)


def curves(
    rules: GaitRules,
    rows: Sequence[tuple[Action, Pressed]],
    left: tuple[Floats, Floats],
    right: tuple[Floats, Floats],
) -> Any:
    """Whether each row (R, ...) has the curve it asks for, or none while both legs step forward.

    Both legs have parts of a forward step at rest, and with their anchors displaced: see
    `GaitRules.step`.
    """
    fit = np.ones((len(rows), *np.broadcast(left[0], right[0]).shape), bool)
    for (action, at), row in zip(rows, fit, strict=True):
        if action.gaits == Action.FORWARD.gaits:
            turn = rules.turn(left[at[0]], right[at[1]])
            least, most = CURVE if action.curve else (-CURVE[0], CURVE[0])
            side = action.curve or 1
            row[...] = (turn * side >= least) & (turn * side <= most)
    return fit
