"""Ground reaction forces of feet and supports, and the drive's spring on the carriage."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

from stepwell.base import Bools, Floats
from stepwell.robot.robot import Robot

# Travel [m] over which the weight passes from foot to supports: negligible against a travel, and
# yet a finite slope that the engine can follow.
HANDOVER = 1e-6
SAME = 1e-9  # heights of the body that differ by less [m] count as equal
POINTS = 8  # steps of a leg at which its stance is computed
HAIR = 1e-5  # travel by which a foot is lifted to compute the redistribution of weight [m]
CLOSE = 0.02  # a foot within this fraction of its travel above the supports' plane is landing


@dataclass(frozen=True, eq=False)
class Stance:
    """Stance of a foot as a function of the step of its leg, at k points."""

    robot: Robot
    step: Floats  # (k,) travel of all cells but the last together [m], rising
    load: Floats  # (k,) ground reaction force of the foot [N], its own weight included
    sharing: Floats  # (k,) number of feet in stance together
    drags: bool = True  # False leaves the drag out

    def alike(self, other: "Stance") -> bool:
        """Whether another stance is the same, but for rounding."""
        pairs = ((self.step, other.step), (self.load, other.load), (self.sharing, other.sharing))
        return self.drags == other.drags and all(
            len(a) == len(b) and bool(np.all(np.abs(a - b) < 1e-9)) for a, b in pairs
        )

    def load_at(self, step: float) -> float:
        """Ground reaction force of the foot [N] at a step of the leg [m]."""
        return float(np.interp(step, self.step, self.load))

    def hold(self, load: Floats, step: Floats | float) -> Floats:
        """Force along the floor [N] on the foot as it moves, carrying `load` [N].

        The drag of the passive support, which carries the rest of the weight, is shared by the feet
        in stance, up to the friction limit of the foot.
        """
        load = np.asarray(load, float)
        if not self.drags:
            return np.zeros_like(load)
        sharing = np.interp(step, self.step, self.sharing)
        left = np.maximum(self.robot.weight - sharing * load, 0.0)
        drag = self.robot.support_friction * left / sharing
        return np.minimum(drag, self.robot.floor.foot_friction * load)

    def slips_below(self, step: float) -> float:
        """Load [N] below which the foot slips and the body stays in place."""
        sharing = float(np.interp(step, self.step, self.sharing))
        drag = self.robot.support_friction
        if not self.drags or drag == 0.0:
            return 0.0
        # friction x load = drag x (weight - sharing x load) / sharing
        return drag * self.robot.weight / (sharing * (self.robot.floor.foot_friction + drag))

    def push(self, load: Floats, travel: Floats | float, step: Floats | float, way: int) -> Floats:
        """Force by which the floor opens the last cell [N], of the arguments' common shape.

        The foot carries `load` [N] at a `travel` of the last cell and a `step` of the others [m];
        `way` is +1 for loading (foot pushed back), -1 for unloading.
        """
        # A force H along the floor acts on the tip, which goes back by the travels of all cells but
        # the last and by half of the last one's. The same force on every cell moves nothing at a
        # given stroke; so H on all but the last and H/2 on the last is -H/2 against the last one.
        own = self.robot.foot.mass * self.robot.floor.gravity
        return (load - own) * self.robot.foot.lever(travel) + way * self.hold(load, step) / 2

    def change(self, start: float, way: int) -> Floats:
        """(k,) change of the opening force on the last cell since the step `start` [m], in N."""
        each = self.push(self.load, 0.0, self.step, way)
        return each - np.interp(start, self.step, each)


def touch(robot: Robot) -> float:
    """Travel of the last cell [m] beyond which the foot carries nothing."""
    return max(robot.foot.contact_travel, HANDOVER)


class Leaning(NamedTuple):
    """Ground reaction force of each foot (legs,) [N] at rest, and how far the body can lean."""

    even: Floats  # equal feet share the weight equally
    least: Floats  # the foot alone lifts
    most: Floats  # every other foot lifts
    lever: float  # opening force on the last cell over ground reaction force, at travel 0 [1]

    @classmethod
    def of(cls, robot: Robot) -> "Leaning":
        """That of a robot with every cell at 0; it does not depend on the bands."""
        legs = range(len(robot.legs))

        def carried(lifted: Sequence[int]) -> Floats:
            rest = [np.zeros(len(leg.chain)) for leg in robot.legs]
            for k in lifted:
                rest[k][-1] = HAIR
            return feet_load(robot, rest)

        even = carried(())
        least = np.minimum([carried([i])[i] for i in legs], even)
        most = np.maximum([carried([k for k in legs if k != i])[i] for i in legs], even)
        return cls(even, least, most, float(robot.foot.lever(0.0)))

    def force(self, lacks: Floats) -> Floats:
        """Ground reaction force of each foot (..., legs) [N] as the actuator sets out.

        `lacks` (..., legs) are the forces missing to open the last cell of each leg: its critical
        force at 0 less the smallest of the others [N]. If one leg would lift its foot and another
        would step, the body leans from the first towards the second until both lift or neither
        does. Moving weight makes the missing forces equal, as far as the body can lean.
        """
        leant = self.even + (lacks - lacks.mean(axis=-1, keepdims=True)) / self.lever
        return np.clip(leant, self.least, self.most)


def leaning(robot: Robot) -> Floats:
    """Ground reaction force of each foot (legs,) [N] as the actuator sets out from all cells at 0.

    See `Leaning.force`.
    """
    chains = [leg.chain.levers for leg in robot.legs]
    lacks = np.array([c[-1].force_0 - min(cell.force_0 for cell in c[:-1]) for c in chains])
    return Leaning.of(robot).force(lacks)


def stance(
    robot: Robot, leg: int, others: list[Floats], setting_out: float | None = None
) -> Stance:
    """Stance of a foot with its last cell at 0.

    The `others` are for each leg (POINTS, cells) travels [m] at these steps of the leg, whose own
    entry is not used; `setting_out` is the force on the foot before it has stepped [N].
    """
    cells = robot.legs[leg].chain.cells
    full = np.array([cell.full_travel for cell in cells])
    share = np.linspace(0.0, 1.0, POINTS)
    loads, sharing = [], []
    for k, part in enumerate(share):
        travels = [other[k].copy() for other in others]
        travels[leg] = np.append(part * full[:-1], 0.0)
        for travel, one in zip(travels, robot.legs, strict=True):
            # A foot that barely touches is about to carry weight.
            if travel[-1] <= touch(robot) + CLOSE * one.chain.cells[-1].full_travel:
                travel[-1] = 0.0
        loads.append(feet_load(robot, travels)[leg])
        sharing.append(sum(stands_proud(robot, travel) for travel in travels))
    if setting_out is not None:
        loads[0] = setting_out
    return Stance(robot, share * full[:-1].sum(), np.array(loads), np.array(sharing, float))


def feet_load(robot: Robot, travels: list[Floats]) -> Floats:
    """Ground reaction force of each foot at rest (legs,) [N], by the lever rule.

    The body rests on the triangle of contacts around the centre of mass that gives its lowest
    position; several such triangles share the weight equally. A foot no deeper than the supports
    carries nothing. Travels are (cells,) [m].
    """
    feet, foot = feet_places(robot, travels), robot.foot
    lift = foot.depth(0.0) - foot.depth(np.array([travel[-1] for travel in travels]))
    stands = np.array([stands_proud(robot, travel) for travel in travels])
    supports = np.asarray(robot.body.supports, float)
    points = np.concatenate([feet, supports])
    height = np.concatenate([-np.maximum(foot.below - lift, 0.0), np.zeros(len(supports))])
    usable = np.concatenate([stands, np.ones(len(supports), bool)])
    own = robot.foot.mass * robot.floor.gravity
    weight, middle = _body_weight(robot, travels, np.where(stands, 0.0, -own))
    share = _shares(points, height, usable, middle)[: len(feet)]
    return np.where(stands, weight * share + own, 0.0)


def supports_load(robot: Robot, travels: Sequence[Floats], feet: Floats) -> Floats:
    """Ground reaction force of each support (..., supports) [N] while the feet carry `feet` [N]."""
    supports = np.asarray(robot.body.supports, float)
    own = robot.foot.mass * robot.floor.gravity
    weight, middle = _body_weight(robot, travels, feet - own)
    every = np.ones(len(supports), bool)
    return weight[..., None] * _shares(supports, np.zeros(len(supports)), every, middle)


def stands_proud(robot: Robot, travel: Floats) -> bool:
    """Whether a foot is deeper than the supports, so that it carries weight."""
    return bool(travel[-1] <= max(robot.foot.contact_travel - HANDOVER, 0.0))


def feet_places(robot: Robot, travels: Sequence[Floats]) -> Floats:
    """Places of the feet (..., legs, 2) in the body's frame [m] at travels (..., cells)."""
    # A tip hangs midway between the block before the outermost one and that one.
    back = np.stack([s[..., :-1].sum(axis=-1) + s[..., -1] / 2 for s in travels], axis=-1)
    return np.array([leg.at for leg in robot.legs]) - np.stack([back, np.zeros_like(back)], axis=-1)


def balanced_centre(robot: Robot, centre: Floats) -> Floats:
    """(x, y) of the body's centre [m] for which the whole robot's is `centre` with cells at 0."""
    rest = [np.zeros(len(leg.chain)) for leg in robot.legs]
    mass, others = _without_feet(robot, rest)
    feet = np.array([leg.at for leg in robot.legs])
    moment = mass * others + robot.foot.mass * feet.sum(axis=0)
    return robot.body.centre[:2] + (robot.mass * centre - moment) / robot.body.mass


def _body_weight(robot: Robot, travels: Sequence[Floats], lifted: Floats) -> tuple[Floats, Floats]:
    """Weight [N] left for the supports by feet that carry `lifted` (..., legs), and its place.

    The place is the point of action (x, y) (..., 2) [m].
    """
    mass, centre = _without_feet(robot, travels)
    whole = mass * robot.floor.gravity
    weight = np.maximum(whole - lifted.sum(axis=-1), 0.0)
    moment = whole * centre - np.einsum("...k,...kj->...j", lifted, feet_places(robot, travels))
    return weight, moment / np.where(weight > 0.0, weight, np.inf)[..., None]


def _without_feet(robot: Robot, travels: Sequence[Floats]) -> tuple[float, Floats]:
    """Mass [kg] and (x, y) of the centre of mass (..., 2) [m] of all but the feet."""
    parts: list[tuple[float, Any, Any]] = [(robot.body.mass, *robot.body.centre[:2])]
    half, strokes = robot.foot.span / 2, [travel.sum(axis=-1) for travel in travels]
    for leg, travel, stroke in zip(robot.legs, travels, strokes, strict=True):
        x, y = leg.at
        *moved, _ = np.moveaxis(np.cumsum(travel, axis=-1), -1, 0)
        *_, outer = robot.blocks.masses(len(leg.chain))
        for ahead, back in zip(reversed(range(len(moved))), moved, strict=True):
            parts.append((robot.blocks.mass, x + half + ahead * robot.blocks.length - back, y))
        parts.append((outer, x - half - stroke, y))
    x, y = np.mean([leg.at for leg in robot.legs], axis=0)
    parts.append((robot.blocks.carriage, x - half - np.mean(strokes, axis=0), y))
    for antenna in robot.antennas:
        (x, y), reach = antenna.pivot, antenna.length / 2
        tip = (x + reach * np.cos(antenna.angle), y + reach * np.sin(antenna.angle))
        parts.append((antenna.mass, *tip))
    mass = sum(part[0] for part in parts)
    moments = (sum(part[0] * part[k] for part in parts) for k in (1, 2))
    return mass, np.stack(np.broadcast_arrays(*moments), axis=-1) / mass


def _shares(points: Floats, height: Floats, usable: Bools, middle: Floats) -> Floats:
    """Fraction (..., points) of a weight at (..., 2) [m] on each point, 0 .. 1."""
    threes = np.array([*combinations(np.flatnonzero(usable), 3)])
    corners = np.insert(points[threes], 2, 1.0, axis=2).swapaxes(1, 2)
    wide = np.abs(np.linalg.det(corners)) >= 1e-12
    threes, corners = threes[wide], corners[wide]
    place = np.insert(middle, 2, 1.0, axis=-1)[..., None, :, None]
    weights = np.linalg.solve(corners, place)[..., 0]
    # On an edge, rounding decides the side; outside of all triangles, the nearest one carries.
    outside = np.maximum(-weights, 0.0).sum(axis=-1)
    near = outside <= np.maximum(1e-9, outside.min(axis=-1, keepdims=True) + 1e-9)
    level = np.where(near, (weights * height[threes]).sum(axis=-1), np.inf)
    rests = level < level.min(axis=-1, keepdims=True) + SAME
    carried = np.where(rests[..., None], np.maximum(weights, 0.0), 0.0)
    out = np.einsum("...tk,tkp->...p", carried, np.eye(len(points))[threes])
    return out / out.sum(axis=-1, keepdims=True)


STROKE_DECIMALS = 12  # decimals of a stroke [m] that count


class Spring(NamedTuple):
    """The spring of a drive between its command and the carriage."""

    amplitude: float  # of the command [m]
    stiffness: float  # [N/m]
    more: float = 0.0  # additional force against the carriage, in both directions [N]

    def stops(self, legs: Sequence[tuple[Floats, Floats]], way: int) -> float:
        """The stroke at which the carriage stops as the command ends [m].

        The carriage is at stroke u if the command is u + Σ λ / stiffness, with the force λ of every
        leg at u. So it stops where that exceeds the end of the command. Each leg has (n,) strokes
        in the order of motion [m], and the forces on its outermost block, positive outwards [N];
        `way` is +1 for loading, -1 for unloading.
        """
        stroke, asked = _forces(legs, way)
        limit = self.amplitude if way > 0 else 0.0
        # Overshoot of the command beyond its end that would be needed [m].
        reaches, goes_on, most = stroke - way * limit + (asked + self.more) / self.stiffness
        over = np.flatnonzero(most > 10.0**-STROKE_DECIMALS)
        if not len(over):
            return float(way * stroke[-1])
        j = int(over[0])
        if j == 0 or reaches[j] <= 0.0:
            return float(way * stroke[j])
        a, b = min(goes_on[j - 1], 0.0), reaches[j]
        return float(way * (stroke[j - 1] - (stroke[j] - stroke[j - 1]) * a / (b - a)))


def largest(legs: Sequence[tuple[Floats, Floats]], way: int) -> float:
    """The largest force of the drive on all legs in a half cycle [N], as for `stops`."""
    return float(_forces(legs, way)[1][2].max())


def _forces(legs: Sequence[tuple[Floats, Floats]], way: int) -> tuple[Floats, Floats]:
    """Strokes (k,) of a half cycle, counted as rising [m], and the forces of the drive there.

    The forces (3, k) are those at arrival, at departure, and the largest between [N].
    """
    each: list[tuple[Floats, Floats]] = []
    for stroke, force in legs:
        rising = way * force
        along = np.asarray(np.round(np.maximum.accumulate(way * stroke), STROKE_DECIMALS), float)
        once, first = np.unique(along, return_index=True)
        last = np.append(first[1:], len(along)) - 1
        most = np.maximum.reduceat(rising, first)
        each.append((once, np.stack([rising[first], rising[last], most])))
    stroke = np.unique(np.concatenate([once for once, _ in each]))
    return stroke, np.sum([_forces_at(stroke, *one) for one in each], axis=0)


def _forces_at(stroke: Floats, own: Floats, force: Floats) -> Floats:
    """(3, m) forces of a leg at strokes (m,) [m]; between its own, on the straight line."""
    after = np.clip(np.searchsorted(own, stroke), 0, len(own) - 1)
    before = np.maximum(after - 1, 0)
    width = own[after] - own[before]
    part = np.divide(stroke - own[before], width, out=np.ones_like(stroke), where=width > 0.0)
    part = np.clip(part, 0.0, 1.0)
    between = (1.0 - part) * force[1, before] + part * force[0, after]
    return np.where(part < 1.0, between, force[:, after])
