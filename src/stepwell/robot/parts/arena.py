"""Where a robot is put: walls, cylinders, a start and a goal."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stepwell.base import ByValue, InputError, Vec2, check, require
from stepwell.mechanism import SlipError
from stepwell.robot.parts.slips import WAY, of_arena


@dataclass(frozen=True, slots=True, eq=False)
class Wall(ByValue):
    """A straight upright wall.

    Args:
        start, end: of its middle line [m].
        thickness: [m], > 0.

    Raises:
        ValueError: a wall without length or thickness.
    """

    start: Vec2
    end: Vec2
    thickness: float = 0.020

    def __post_init__(self):
        object.__setattr__(self, "start", check.vector("start", self.start))
        object.__setattr__(self, "end", check.vector("end", self.end))
        object.__setattr__(self, "thickness", check.positive("thickness", self.thickness, "m"))
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
    """An upright cylinder.

    Args:
        at: (x, y) of its axis [m].
        radius: [m], > 0.

    Raises:
        ValueError: a radius of nothing.
    """

    at: Vec2
    radius: float = 0.025

    def __post_init__(self):
        object.__setattr__(self, "at", check.vector("at", self.at))
        object.__setattr__(self, "radius", check.positive("radius", self.radius, "m"))


@dataclass(frozen=True, slots=True, eq=False)
class Goal(ByValue):
    """A disc that the body's origin has to reach.

    Args:
        at: (x, y) of its middle [m].
        radius: [m], > 0.

    Raises:
        ValueError: a radius of nothing.
    """

    at: Vec2
    radius: float = 0.150

    def __post_init__(self):
        object.__setattr__(self, "at", check.vector("at", self.at))
        object.__setattr__(self, "radius", check.positive("radius", self.radius, "m"))

    def reached(self, x: float, y: float) -> bool:
        """Whether the point (x, y) [m] lies in the disc."""
        return math.dist((x, y), self.at) <= self.radius


@dataclass(frozen=True, slots=True, eq=False)
class Arena(ByValue):
    """Obstacles on a level floor.

    Args:
        walls, cylinders: none or several.
        start: (x, y) of the body's origin at the beginning [m].
        heading: direction it faces there [rad] from the x axis, to the left.
        goal: where it should go, if anywhere.
        title: what reports call it.
        unusual: True where an arena smaller than a hand or larger than a field is meant.

    Raises:
        ValueError: a start inside a wall or a cylinder, or sizes that are probably in another
            unit.
    """

    walls: Sequence[Wall] = ()
    cylinders: Sequence[Cylinder] = ()
    start: Vec2 = (0.0, 0.0)
    heading: float = 0.0
    goal: Goal | None = None
    title: str = ""
    unusual: bool = field(default=False, compare=False)
    # Whether the sizes were asked for slips; `replace` carries it to whatever it makes.
    _asked: bool = field(default=False, repr=False, compare=False, kw_only=True)

    def __post_init__(self):
        object.__setattr__(self, "walls", tuple(self.walls))
        object.__setattr__(self, "cylinders", tuple(self.cylinders))
        require("obstacles", len(self.walls) + len(self.cylinders), "the arena has")
        object.__setattr__(self, "start", check.vector("start", self.start))
        object.__setattr__(self, "heading", check.finite("heading", self.heading, "rad"))
        if not (self.unusual or self._asked):
            slips = of_arena(self)
            if slips:
                raise SlipError(slips, WAY)
        object.__setattr__(self, "_asked", True)
        gap = self.clearance(*self.start)
        if gap <= 0:
            raise InputError(
                f"start = ({self.start[0] * 1e3:.6g}, {self.start[1] * 1e3:.6g}) mm lies "
                f"{-gap * 1e3:.3g} mm inside an obstacle; move it."
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

    def from_start(self, start: Vec2, heading: float) -> Arena:
        """The same arena entered at another place [m] and heading [rad]."""
        return replace(self, start=start, heading=heading)

    def __repr__(self):
        title = f"{self.title!r}, " if self.title else ""
        goal = "" if self.goal is None else ", a goal"
        return f"Arena({title}{len(self.walls)} walls, {len(self.cylinders)} cylinders{goal})"
