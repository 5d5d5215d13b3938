"""Arenas: floor, walls, cylinders, start and goal, and random variants of an arena."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stepwell.base import ByValue, InputError, Vec2, check, require, to_unit
from stepwell.robot.fit import of_arena, refuse_slips

# Largest random deviations of a start or a layout, fixed before any run.
PLACE = 0.040  # [m]
HEADING = math.radians(10.0)
ANGLE = math.radians(8.0)


@dataclass(frozen=True, slots=True, eq=False)
class Floor(ByValue):
    """A level floor; a `ValueError` refuses values out of range.

    Args:
        drag: force that pulls the robot along on its passive support (T-foot) alone [N], >= 0.
        foot_friction: Coulomb's coefficient between a foot and the floor, > 0.
        gravity: [m/s²], >= 0; 0 hangs the robot in the air.

    Source: the notes of Kamp et al. 2024: a drag of 0.39 N on MDF and 0.79 N on rubber.
    """

    drag: float = 0.39
    foot_friction: float = 0.5
    gravity: float = 9.81

    def __post_init__(self):
        check.fields(self, check.not_negative, drag="N", gravity="m/s²")
        check.fields(self, check.positive, foot_friction="1")


@dataclass(frozen=True, slots=True, eq=False)
class Wall(ByValue):
    """A straight upright wall from `start` to `end` of its middle line [m].

    A `ValueError` refuses one without length or `thickness` [m].
    """

    start: Vec2
    end: Vec2
    thickness: float = 0.020

    def __post_init__(self):
        check.fields(self, check.vector, start="m", end="m")
        check.fields(self, check.positive, thickness="m")
        if self.start == self.end:
            raise InputError(f"start = end = {self.start}: a wall needs two different ends.")

    @property
    def length(self) -> float:
        """[m]."""
        return math.dist(self.start, self.end)

    @property
    def angle(self) -> float:
        """Direction from start to end [rad] from the x axis."""
        return math.atan2(self.end[1] - self.start[1], self.end[0] - self.start[0])


@dataclass(frozen=True, slots=True, eq=False)
class Cylinder(ByValue):
    """An upright cylinder about the axis `at` (x, y) [m]; a `radius` [m] must be > 0."""

    at: Vec2
    radius: float = 0.025

    def __post_init__(self):
        check.fields(self, check.vector, at="m")
        check.fields(self, check.positive, radius="m")


@dataclass(frozen=True, slots=True, eq=False)
class Goal(ByValue):
    """A disc around `at` (x, y) [m] that the body's origin has to reach.

    Its `radius` [m] is > 0, or a `ValueError`.
    """

    at: Vec2
    radius: float = 0.150

    def __post_init__(self):
        check.fields(self, check.vector, at="m")
        check.fields(self, check.positive, radius="m")

    def reached(self, x: float, y: float) -> bool:
        """Whether the point (x, y) [m] lies in the disc."""
        return math.dist((x, y), self.at) <= self.radius


@dataclass(frozen=True, slots=True, eq=False)
class Arena(ByValue):
    """Obstacles on a level floor.

    Args:
        walls, cylinders: none or several.
        start: (x, y) of the body's origin at the beginning [m].
        heading: direction of the robot at the start [rad] from the x axis, to the left.
        goal: disc to reach, None for none.
        title: name in reports.
        unusual: True to accept an arena smaller than a hand or larger than a field.

    Raises:
        ValueError: a start inside a wall or a cylinder, or sizes probably in another unit.
    """

    walls: Sequence[Wall] = ()
    cylinders: Sequence[Cylinder] = ()
    start: Vec2 = (0.0, 0.0)
    heading: float = 0.0
    goal: Goal | None = None
    title: str = ""
    unusual: bool = field(default=False, compare=False)
    # Whether the sizes were checked for wrong units; `replace` passes it on to the copies.
    _asked: bool = field(default=False, repr=False, compare=False, kw_only=True)

    def __post_init__(self):
        object.__setattr__(self, "walls", tuple(self.walls))
        object.__setattr__(self, "cylinders", tuple(self.cylinders))
        require("obstacles", len(self.walls) + len(self.cylinders), "the arena has")
        check.fields(self, check.vector, start="m")
        check.fields(self, check.finite, heading="rad")
        refuse_slips(self, of_arena(self))
        gap = self.clearance(*self.start)
        if gap <= 0:
            raise InputError(
                f"start = ({to_unit(self.start[0], 'mm'):.6g}, {to_unit(self.start[1], 'mm'):.6g}) "
                f"mm lies {to_unit(-gap, 'mm'):.3g} mm inside an obstacle; move the start."
            )

    def clearance(self, x: float, y: float) -> float:
        """Distance from the point (x, y) [m] to the nearest obstacle [m]; negative inside."""
        point = np.asarray([x, y])
        gaps = [math.inf]
        for wall in self.walls:
            a, b = np.asarray(wall.start), np.asarray(wall.end)
            along = np.clip(np.dot(point - a, b - a) / np.dot(b - a, b - a), 0.0, 1.0)
            gaps.append(float(np.linalg.norm(point - a - along * (b - a))) - wall.thickness / 2)
        gaps += [math.dist((x, y), one.at) - one.radius for one in self.cylinders]
        return min(gaps)

    def from_start(self, start: Vec2, heading: float) -> "Arena":
        """The same arena with another start [m] and heading [rad]."""
        return replace(self, start=start, heading=heading)

    def __repr__(self):
        title = f"{self.title!r}, " if self.title else ""
        goal = "" if self.goal is None else ", a goal"
        return f"Arena({title}{len(self.walls)} walls, {len(self.cylinders)} cylinders{goal})"


def other_start(
    arena: Arena, seed: int, *, place: float = PLACE, heading: float = HEADING
) -> Arena:
    """The same arena with a start near its own, drawn at random from a seed.

    The start shifts by at most `place` along x and along y [m], and turns by at most `heading`
    [rad]. A `ValueError` refuses a start inside an obstacle.
    """
    dx, dy, turn = np.random.default_rng(seed).uniform(-1.0, 1.0, 3) * (place, place, heading)
    return arena.from_start((arena.start[0] + dx, arena.start[1] + dy), arena.heading + turn)


def other_layout(arena: Arena, seed: int, *, place: float = PLACE, angle: float = ANGLE) -> Arena:
    """The same start with obstacles near their own places, drawn at random from a seed.

    Each obstacle shifts by at most `place` along x and along y [m], and walls turn by at most
    `angle` about their middle [rad]. A `ValueError` refuses a start inside an obstacle.
    """
    rng = np.random.default_rng(seed)
    walls = []
    for wall in arena.walls:
        dx, dy, turn = rng.uniform(-1.0, 1.0, 3) * (place, place, angle)
        middle = np.add(wall.start, wall.end) / 2 + (dx, dy)
        along = np.array([math.cos(wall.angle + turn), math.sin(wall.angle + turn)])
        half = along * wall.length / 2
        walls.append(Wall(tuple(middle - half), tuple(middle + half), wall.thickness))
    cylinders = [
        replace(one, at=tuple(np.add(one.at, rng.uniform(-place, place, 2)).tolist()))
        for one in arena.cylinders
    ]
    return replace(arena, walls=tuple(walls), cylinders=tuple(cylinders))
