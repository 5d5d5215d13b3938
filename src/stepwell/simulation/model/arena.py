"""Walls and cylinders in the simulation."""

from __future__ import annotations

import math
from typing import Any

from stepwell.robot import Arena
from stepwell.simulation.model import parts

HEIGHT = 0.10  # [m]: above everything of the robot that meets walls


def obstacle_names(arena: Arena) -> tuple[str, ...]:
    """What the model calls the obstacles: walls first, numbered from 1."""
    walls = (f"wall {i + 1}" for i in range(len(arena.walls)))
    return (*walls, *(f"cylinder {i + 1}" for i in range(len(arena.cylinders))))


def add_arena(spec: Any, arena: Arena) -> None:
    """Add every obstacle, each a body of its own, so that what touches it is known."""
    names = iter(obstacle_names(arena))
    for wall in arena.walls:
        x, y = ((a + b) / 2 for a, b in zip(wall.start, wall.end, strict=True))
        half = wall.angle / 2
        body = spec.worldbody.add_body(
            name=next(names), pos=(x, y, HEIGHT / 2), quat=(math.cos(half), 0, 0, math.sin(half))
        )
        size = (wall.length, wall.thickness, HEIGHT)
        parts.box(body, size, rgba=parts.WALL, **parts.OBSTACLE)
        _feel(body, parts.mujoco.mjtGeom.mjGEOM_BOX, [length / 2 + 0.01 for length in size])
    for cylinder in arena.cylinders:
        body = spec.worldbody.add_body(name=next(names), pos=(*cylinder.at, HEIGHT / 2))
        shape = parts.mujoco.mjtGeom.mjGEOM_CYLINDER
        size = (cylinder.radius, HEIGHT / 2, 0.0)
        body.add_geom(type=shape, size=size, rgba=parts.WALL, **parts.OBSTACLE)
        _feel(body, shape, (cylinder.radius + 0.01, HEIGHT / 2 + 0.01, 0.0))


def _feel(body: Any, shape: Any, size: Any) -> None:
    body.add_site(name=body.name, type=shape, size=size, rgba=parts.HIDDEN)
