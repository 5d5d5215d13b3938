"""The same arena a little different: other starts, other layouts, from a seed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from stepwell.robot.parts.arena import Arena, Wall

# Declared before any run: what a start or a layout may differ by.
PLACE = 0.040  # [m]
HEADING = math.radians(10.0)
ANGLE = math.radians(8.0)


def other_start(
    arena: Arena, seed: int, *, place: float = PLACE, heading: float = HEADING
) -> Arena:
    """The same arena, entered a little elsewhere.

    Args:
        arena: any.
        seed: of the draw.
        place: largest shift along x and along y [m].
        heading: largest rotation [rad].

    Returns:
        The arena with another start.

    Raises:
        ValueError: the start that was drawn lies inside an obstacle.
    """
    draw = np.random.default_rng(seed).uniform(-1.0, 1.0, 3)
    x, y = arena.start
    return arena.from_start(
        (x + place * draw[0], y + place * draw[1]), arena.heading + heading * draw[2]
    )


def other_layout(arena: Arena, seed: int, *, place: float = PLACE, angle: float = ANGLE) -> Arena:
    """The same start among walls and cylinders that stand a little differently.

    Args:
        arena: any.
        seed: of the draw.
        place: largest shift of each obstacle along x and along y [m].
        angle: largest rotation of each wall about its middle [rad].

    Returns:
        The arena with other obstacles.

    Raises:
        ValueError: the start lies inside an obstacle that was drawn.
    """
    rng = np.random.default_rng(seed)
    walls = []
    for wall in arena.walls:
        dx, dy, turn = rng.uniform(-1.0, 1.0, 3) * (place, place, angle)
        middle = np.add(wall.start, wall.end) / 2 + (dx, dy)
        along = np.array([math.cos(wall.angle + turn), math.sin(wall.angle + turn)])
        half = along * wall.length / 2
        walls.append(Wall(tuple(middle - half), tuple(middle + half), wall.thickness))
    cylinders = []
    for cylinder in arena.cylinders:
        dx, dy = rng.uniform(-place, place, 2)
        cylinders.append(replace(cylinder, at=(cylinder.at[0] + dx, cylinder.at[1] + dy)))
    return replace(arena, walls=tuple(walls), cylinders=tuple(cylinders))
