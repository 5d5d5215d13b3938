"""Arenas: floor, rough ground, walls, cylinders, start and goal, and random variants of them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations

import numpy as np

from stepwell.base import ByValue, InputError, Vec2, check, counted, require, to_unit
from stepwell.robot.fit import of_arena, refuse_slips

# Largest random deviations of a start or a layout, fixed before any run.
PLACE = 0.040  # [m]
HEADING = math.radians(10.0)
ANGLE = math.radians(8.0)
# Steepest floor, and largest level of a patch or thickness of a plate [m]: more is an obstacle.
STEEPEST, HIGHEST = math.radians(45.0), 0.010


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

    def support_friction(self, mass: float) -> float:
        """Coulomb's coefficient [1] under the passive support of a robot of this mass [kg]."""
        return self.drag / (mass * 9.81)


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


def _at_most(name: str, value: float, most: float, unit: str) -> None:
    """Refuse a number [m or rad] whose absolute value is larger than the largest."""
    if abs(value) > most:
        shown, limit = (to_unit(number, unit) for number in (value, most))
        raise InputError(f"{name} = {shown:.6g} {unit}: must be from {-limit:g} to {limit:g}.")


@dataclass(frozen=True, slots=True, eq=False)
class Slope(ByValue):
    """A tilt of the whole floor; positions of an arena are in the plane of the floor.

    Args:
        angle: of the floor against the horizontal [rad], from -45° to 45°; negative is downhill.
        uphill: direction in which the floor rises [rad] from the x axis, to the left.

    Raises:
        ValueError: a steeper floor.
    """

    angle: float
    uphill: float = 0.0

    def __post_init__(self):
        check.fields(self, check.finite, angle="rad", uphill="rad")
        _at_most("angle", self.angle, STEEPEST, "deg")


@dataclass(frozen=True, slots=True, eq=False)
class Patch(ByValue):
    """A rectangle of the floor with another level or other friction: a step, a bump, a groove.

    Only feet, supports and loose plates touch it.

    Args:
        start, end: opposite corners (x, y) [m]; the sides are parallel to the axes.
        level: height over the rest of the floor [m], from -10 mm (a groove) to 10 mm (a step).
        foot_friction: as for a Floor, > 0; None for that of the robot's floor.
        drag: as for a Floor [N], >= 0; None for that of the robot's floor.

    Raises:
        ValueError: a rectangle without area, or values out of range.
    """

    start: Vec2
    end: Vec2
    level: float = 0.0
    foot_friction: float | None = None
    drag: float | None = None

    def __post_init__(self):
        check.fields(self, check.vector, start="m", end="m")
        check.fields(self, check.finite, level="m")
        _at_most("level", self.level, HIGHEST, "mm")
        if self.foot_friction is not None:
            check.fields(self, check.positive, foot_friction="1")
        if self.drag is not None:
            check.fields(self, check.not_negative, drag="N")
        if self.start[0] == self.end[0] or self.start[1] == self.end[1]:
            raise InputError(
                f"start = {self.start}, end = {self.end}: a patch needs two opposite corners."
            )

    @property
    def low(self) -> Vec2:
        """The corner with the smallest x and y [m]."""
        return min(self.start[0], self.end[0]), min(self.start[1], self.end[1])

    @property
    def high(self) -> Vec2:
        """The corner with the largest x and y [m]."""
        return max(self.start[0], self.end[0]), max(self.start[1], self.end[1])

    def overlaps(self, other: "Patch") -> bool:
        """Whether two patches have an area in common."""
        pairs = zip(self.low, self.high, other.low, other.high, strict=True)
        return all(a < d and c < b for a, b, c, d in pairs)


@dataclass(frozen=True, slots=True, eq=False)
class Plate(ByValue):
    """A loose rectangular plate on the floor, which the robot can push.

    Feet and supports have the friction of the robot's floor on it.

    Args:
        at: (x, y) of its middle at the start [m].
        size: length and width [m], > 0.
        thickness: [m], > 0, at most 10 mm.
        mass: [kg], > 0.
        friction: Coulomb's coefficient between the plate and the floor, >= 0.
        heading: direction of its length at the start [rad] from the x axis, to the left.

    Raises:
        ValueError: values out of range.
    """

    at: Vec2
    size: Vec2
    thickness: float
    mass: float
    friction: float = 0.4
    heading: float = 0.0

    def __post_init__(self):
        check.fields(self, check.vector, at="m", size="m")
        check.fields(self, check.positive, thickness="m", mass="kg")
        check.fields(self, check.not_negative, friction="1")
        check.fields(self, check.finite, heading="rad")
        for i, length in enumerate(self.size):
            check.positive(f"size[{i}]", length, "m")
        _at_most("thickness", self.thickness, HIGHEST, "mm")

    def own_frame(self, x: float, y: float) -> Vec2:
        """The point (x, y) [m] in the frame of the plate [m]: along its length and its width."""
        dx, dy = x - self.at[0], y - self.at[1]
        c, s = math.cos(self.heading), math.sin(self.heading)
        return c * dx + s * dy, c * dy - s * dx


@dataclass(frozen=True, slots=True, eq=False)
class Arena(ByValue):
    """Obstacles on a floor, which is level and even unless it has a slope, patches or plates.

    Args:
        walls, cylinders: none or several.
        start: (x, y) of the body's origin at the beginning [m].
        heading: direction of the robot at the start [rad] from the x axis, to the left.
        goal: disc to reach, None for none.
        title: name in reports.
        unusual: True to accept an arena smaller than a hand or larger than a field.
        slope: of the whole floor, None for a level one.
        patches, plates: none or several; patches must not overlap.

    Raises:
        ValueError: a start inside a wall or a cylinder, patches that overlap, or sizes probably in
            another unit.
    """

    walls: Sequence[Wall] = ()
    cylinders: Sequence[Cylinder] = ()
    start: Vec2 = (0.0, 0.0)
    heading: float = 0.0
    goal: Goal | None = None
    title: str = ""
    unusual: bool = field(default=False, compare=False)
    slope: Slope | None = None
    patches: Sequence[Patch] = ()
    plates: Sequence[Plate] = ()
    # Whether the sizes were checked for wrong units; `replace` passes it on to the copies.
    _asked: bool = field(default=False, repr=False, compare=False, kw_only=True)

    def __post_init__(self):
        object.__setattr__(self, "walls", tuple(self.walls))
        object.__setattr__(self, "cylinders", tuple(self.cylinders))
        object.__setattr__(self, "patches", tuple(self.patches))
        object.__setattr__(self, "plates", tuple(self.plates))
        require("obstacles", len(self.walls) + len(self.cylinders), "the arena has")
        require("patches", len(self.patches) + len(self.plates), "the arena has")
        for (i, one), (k, other) in combinations(enumerate(self.patches), 2):
            if one.overlaps(other):
                raise InputError(f"patch[{i}] and patch[{k}] overlap: divide the larger one.")
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

    def ground_level(self, x: float, y: float, reach: float = 0.0) -> float:
        """Largest level [m] of the ground under a disc about (x, y) [m] of radius `reach` [m]."""
        points = [(x, y), (x + reach, y), (x - reach, y), (x, y + reach), (x, y - reach)]
        return max(self._level(*point) for point in points)

    def _level(self, x: float, y: float) -> float:
        under = (one.level for one in self.patches if _inside((x, y), one.low, one.high))
        level = next(under, 0.0)
        for plate in self.plates:
            half = plate.size[0] / 2, plate.size[1] / 2
            if _inside(plate.own_frame(x, y), (-half[0], -half[1]), half):
                level += plate.thickness
        return level

    def from_start(self, start: Vec2, heading: float) -> "Arena":
        """The same arena with another start [m] and heading [rad]."""
        return replace(self, start=start, heading=heading)

    def __repr__(self):
        title = f"{self.title!r}, " if self.title else ""
        parts = [f"{len(self.walls)} walls", f"{len(self.cylinders)} cylinders"]
        if self.slope is not None:
            parts.append(f"slope {math.degrees(self.slope.angle):.3g}°")
        many = "es" * (len(self.patches) > 1)
        parts += [f"{len(self.patches)} patch{many}"] * bool(self.patches)
        parts += [counted(len(self.plates), "plate")] * bool(self.plates)
        parts += ["a goal"] * (self.goal is not None)
        return f"Arena({title}{', '.join(parts)})"


def _inside(point: Vec2, low: Vec2, high: Vec2) -> bool:
    return all(a <= x <= b for x, a, b in zip(point, low, high, strict=True))


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
