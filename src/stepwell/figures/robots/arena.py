"""An arena from above: walls, cylinders, goal."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Polygon

from stepwell.base import Floats
from stepwell.figures.common import FIXED_BLOCK, GREEN, INK, MM, pale
from stepwell.robot import Arena, Wall

OBSTACLE, TOUCHED = FIXED_BLOCK, INK


def draw_arena(ax: Axes, arena: Arena, touched: Sequence[bool]) -> None:
    """Every obstacle and the goal, in mm.

    Args:
        ax: axes true to scale.
        arena: any.
        touched: of each obstacle, walls first.
    """
    walls = [Polygon(_wall(wall) * MM) for wall in arena.walls]
    rounds = [Circle((c.at[0] * MM, c.at[1] * MM), c.radius * MM) for c in arena.cylinders]
    for shape, felt in zip([*walls, *rounds], touched, strict=True):
        shape.set_facecolor(TOUCHED if felt else OBSTACLE)
        shape.set_edgecolor(INK)
        shape.set(linewidth=0.5, zorder=3, gid="touched obstacle" if felt else "obstacle")
        ax.add_patch(shape)
    if arena.goal is not None:
        x, y = (value * MM for value in arena.goal.at)
        disc = Circle((x, y), arena.goal.radius * MM, linewidth=0.8, linestyle=(0, (3, 2)))
        disc.set(facecolor=pale(GREEN, 0.85), edgecolor=GREEN, zorder=0.5, gid="goal")
        ax.add_patch(disc)


def outlines(arena: Arena) -> list[Floats]:
    """Points (n, 2) that enclose every obstacle and the goal [m]."""
    discs = [(one.at, one.radius) for one in arena.cylinders]
    if arena.goal is not None:
        discs.append((arena.goal.at, arena.goal.radius))
    corners = np.array([(-1.0, -1.0), (1.0, 1.0)])
    return [*map(_wall, arena.walls), *(np.array(at) + radius * corners for at, radius in discs)]


def _wall(wall: Wall) -> Floats:
    """(4, 2) corners [m]."""
    a, b = np.array(wall.start), np.array(wall.end)
    across = np.array([a[1] - b[1], b[0] - a[0]]) / wall.length * wall.thickness / 2
    return np.array([a + across, b + across, b - across, a - across])
