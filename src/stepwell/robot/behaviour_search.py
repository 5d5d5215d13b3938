"""Evaluation of all designs of a choice by the closed form of their gaits, block by block."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import combinations, permutations, product
from typing import Any, NamedTuple

import numpy as np

from stepwell.base import Floats, Progress, Vec2, notify
from stepwell.design import BandType
from stepwell.robot.behaviour import Action, RobotBehaviour
from stepwell.robot.gait_rules import Bands, GaitRules, LegForces

SHORTLIST = 200  # designs of the largest margins that are kept

Wiring = tuple[int, ...]  # for each antenna from the left: the leg whose anchor it moves
Pressed = tuple[bool, bool]  # whether the anchor of the left and of the right leg is displaced
AT_REST, DISPLACED = 0, 1
Leg = tuple[LegForces, LegForces]  # its forces at rest, and with its anchor displaced


class ChosenNumbers(NamedTuple):
    """Chosen numbers of a design with two equal legs.

    Attributes:
        inner, outer: anchors q of the inner and of the outer cell [m].
        moves: displacement of the inner anchor p by an antenna [m].
        inner_bands, outer_bands: number of bands on each cell.
        below: preload depth [m].
        band: type of all bands.
        wiring: for each antenna from the left, the leg whose anchor it moves: 0 left, 1 right.
    """

    inner: Vec2
    outer: Vec2
    moves: Vec2
    inner_bands: int
    outer_bands: int
    below: float
    band: BandType
    wiring: Wiring


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
    """Margins of rows (R, ...) [N], and for each row the number of its best pair of gaits (...)."""
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
        margins.append(np.max(each, axis=0))
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
        for wiring in wirings(behaviour):
            rows = [(row.motion, pressed(behaviour, wiring, row.contact)) for row in behaviour.rows]
            margins, _ = row_margins(rules, rows, (leg, leg))
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
