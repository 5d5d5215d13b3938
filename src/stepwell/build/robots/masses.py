"""Masses of a robot's rigid bodies from their parts, with centre of mass and inertia."""

import math
from collections.abc import Iterator

import numpy as np

from stepwell.base import Floats
from stepwell.build.plates import STEEL, Fastener
from stepwell.build.robots.making import PartFrame
from stepwell.build.robots.robot_layout import RobotLayout
from stepwell.robot import BodyMass, Inertial, joined_solids

# Density of posts and caps [kg/m³].
NYLON = 1140.0


def axes(place: PartFrame) -> Floats:
    """(3, 3) columns: the axes x, y and normal of a part's frame, in the frame of the robot.

    The normal of an upright part is y, so its frame is left-handed.
    """
    c, s = math.cos(place.angle), math.sin(place.angle)
    if place.upright:
        return np.array([[c, -s, 0.0], [0.0, 0.0, 1.0], [s, c, 0.0]])
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def in_robot(points: Floats, place: PartFrame) -> Floats:
    """Points (n, 3) of a part's frame, with the height above its own zero, in the robot's frame."""
    at = (place.x, 0.0, place.y) if place.upright else (place.x, place.y, 0.0)
    return np.asarray(points) @ axes(place).T + np.array(at)


def part_solids(layout: RobotLayout, body: str) -> Iterator[tuple[str, Inertial]]:
    """Name and mass properties of each part of a body, in the reference pose."""
    density = layout.build_file.sheet.density
    for part in layout.parts:
        if layout.body[part.name] != body:
            continue
        place = layout.places[part.name]
        x, y = part.centroid
        centre = in_robot(np.array([[x, y, part.base + part.thickness / 2.0]]), place)[0]
        turn = axes(place)
        inertia = turn @ part.inertia(density) @ turn.T
        yield part.name, Inertial(part.mass(density), centre, inertia)


def fastener_solid(one: Fastener) -> Inertial:
    """A fastener as a cylinder; shims and nuts are rings."""
    radius, height = one.diameter / 2.0, one.high - one.low
    bore = radius / 2.0 if one.use in ("shim", "nut") else 0.0
    density = NYLON if one.use in ("standoff", "cap") else STEEL
    if one.use in ("standoff", "cap"):
        bore = radius * 0.55
    mass = math.pi * (radius**2 - bore**2) * height * density
    square = radius**2 + bore**2
    across, along = mass * (square / 4.0 + height**2 / 12.0), mass * square / 2.0
    middle = (one.low + one.high) / 2.0
    x, y = one.centre
    if one.upright:
        return Inertial(mass, np.array([x, middle, y]), np.diag([across, along, across]))
    return Inertial(mass, np.array([x, y, middle]), np.diag([across, across, along]))


def box_solids(layout: RobotLayout, body: str) -> Iterator[tuple[str, Inertial]]:
    """Name and mass properties of each bought box of a body."""
    for one in layout.boxes:
        if one.body != body:
            continue
        low, high = np.array(one.low), np.array(one.high)
        square = (high - low) ** 2
        inertia = np.diag(square.sum() - square) * one.mass / 12.0
        yield one.name, Inertial(one.mass, (low + high) / 2.0, inertia)


def solids(layout: RobotLayout, body: str) -> list[tuple[str, Inertial]]:
    """Name and mass properties of all parts, fasteners and boxes of a body."""
    bought = [(one.name, fastener_solid(one)) for one in layout.fasteners if one.block == body]
    return [*part_solids(layout, body), *bought, *box_solids(layout, body)]


def body_mass(layout: RobotLayout, body: str) -> BodyMass:
    """Mass properties of one rigid body."""
    one = joined_solids([solid for _, solid in solids(layout, body)])
    return BodyMass(body, one.mass, one.centre, one.inertia)
