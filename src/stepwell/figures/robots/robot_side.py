"""The robot from its right: floor, supports, V links and feet."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from stepwell.figures.common import (
    BLOCK,
    FAINT,
    INK,
    MM,
    along_x,
    along_y,
    arrow,
    hollow,
    mm,
    pale,
    plain,
)
from stepwell.figures.robots.robot_above import (
    ANTENNA,
    FOOT,
    SUPPORT,
    above_limits,
    centre_of_mass,
    detailed,
    faded,
)
from stepwell.figures.robots.robot_parts import (
    LegParts,
    antenna_line,
    leg_parts,
    rectangle,
    rest_states,
)
from stepwell.robot import Robot


def side_limits(robot: Robot) -> tuple[float, float, float, float]:
    """left, right, bottom, top of what is drawn, x of the body and z from the floor [mm]."""
    above = above_limits(robot)
    right = max(above[1], _beyond(robot) + 44.0)
    if not detailed():
        return above[0], above[1], -6.0, float(robot.foot.depth(0.0)) * MM + 16.0
    return above[0], right, -12.0, float(robot.foot.depth(0.0)) * MM + 34.0


def draw_side(ax: Axes, robot: Robot) -> None:
    """Draw it all, in mm, into axes that lose their frame."""
    box = side_limits(robot)
    plain(ax, box)
    floor = box[0] + 20.0, box[1] - 4.0
    ax.plot(floor, [0.0, 0.0], color=INK, linewidth=1.0, zorder=1, gid="floor")
    for x in np.arange(floor[0] + 2.5, floor[1], 5.0):
        ax.plot([x, x - 2.5], [0.0, -2.5], color=INK, linewidth=0.4, zorder=1)
    pivot = float(robot.foot.depth(0.0)) * MM  # above the floor while the feet stand on it
    _body(ax, robot, pivot)
    leg = min(robot.legs, key=lambda one: one.at[1])
    at_0, at_1 = (leg_parts(robot, leg, travels) for travels in rest_states(leg))
    _leg(ax, robot, at_1, pivot, faint=True)
    _leg(ax, robot, at_0, pivot, faint=False)
    if detailed():
        _dimensions(ax, robot, at_0, at_1, pivot)


def _body(ax: Axes, robot: Robot, pivot: float) -> None:
    """Body, supports and antennas; the body has a length, and its height is drawn for the eye."""
    half, low = robot.body.length / 2 * MM, robot.foot.below * MM
    plate = rectangle((0.0, pivot + 8.0), 2 * half, 8.0)
    grey = pale(BLOCK, 0.5)
    ax.add_patch(Polygon(plate, facecolor=grey, edgecolor=INK, linewidth=0.8, zorder=1))
    centre_of_mass(ax, robot.body.centre[0] * MM, pivot + robot.body.centre[2] * MM)
    # Supports behind each other are one in this view.
    for x in sorted({round(x * MM, 6) for x, _ in robot.body.supports}):
        strut = [0.4 * x, x], [pivot + 4.0, low + 1.5]
        ax.plot(*strut, color=SUPPORT, linewidth=1.4, zorder=1.5)
        ax.add_patch(Polygon(rectangle((x, low + 1.5), 6.0, 3.0), facecolor=SUPPORT, zorder=6))
        ax.plot([x], [low], linestyle="none", gid="support")
    for antenna in robot.antennas:
        x = [half, *(antenna_line(antenna)[:, 0] * MM)]
        z = [pivot + 4.0, *([pivot] * (len(x) - 1))]
        ax.plot(x, z, color=ANTENNA, linewidth=1.4, zorder=2)


def _dimensions(ax: Axes, robot: Robot, at_0: LegParts, at_1: LegParts, pivot: float) -> None:
    near, wide = at_0.pivots * MM, at_1.pivots * MM
    along_x(ax, near[1], near[0], pivot + 18.0, f"{mm(robot.foot.span)} mm", feet=pivot)
    opened = f"{mm(at_1.pivots[0] - at_1.pivots[1])} mm with every cell at 1"
    along_x(ax, wide[1], wide[0], pivot + 27.0, opened, feet=pivot, colour=FAINT)
    # Clear of the chain at full stroke.
    along_y(ax, 0.0, pivot, wide[1] - 16.0, f"{pivot:.3g} mm", feet=wide[1] - 8.0)
    low, far = robot.foot.below * MM, _beyond(robot)
    fore = max(x for x, _ in robot.body.supports) * MM
    for height in (0.0, low):
        ax.plot([fore + 3.0, far + 3.0], [height, height], color=INK, linewidth=0.5, zorder=2)
    arrow(ax, (far, low + 7.0), (far, low))
    arrow(ax, (far, -7.0), (far, 0.0))
    below = f"feet {mm(robot.foot.below)} mm below\nthe supports"
    ax.text(far + 4.0, low + 3.0, below, va="bottom", ha="left", zorder=9)
    x, lifted = at_1.tip[0] * MM, pivot + at_1.tip[1] * MM
    ax.plot([x, x], [0.0, lifted], color=FAINT, linewidth=0.5, zorder=1)
    ax.text(x, -4.0, f"rises {lifted:.3g} mm", ha="center", va="top")
    ax.text(at_0.tip[0] * MM, -4.0, f"links {mm(robot.foot.link)} mm", ha="left", va="top")


def _beyond(robot: Robot) -> float:
    """x of what is written ahead of the body and its supports [mm]."""
    return max(robot.body.length / 2, *(x for x, _ in robot.body.supports)) * MM + 8.0


def _leg(ax: Axes, robot: Robot, parts: LegParts, pivot: float, *, faint: bool) -> None:
    def shade(colour: str) -> tuple[float, float, float]:
        return faded(colour, faint)

    z = 3.0 if faint else 4.0
    frame = {"facecolor": "white" if faint else BLOCK, "edgecolor": shade(INK), "linewidth": 0.6}
    for x, _ in parts.blocks:
        outline = rectangle((x * MM, pivot), robot.blocks.length * MM, 8.0)
        ax.add_patch(Polygon(outline, **frame, zorder=z))
    tip = (parts.tip[0] * MM, pivot + parts.tip[1] * MM)
    link = {"color": shade(FOOT), "linewidth": 1.6, "gid": "link at 1" if faint else "link"}
    for x in parts.pivots * MM:
        ax.plot([x, tip[0]], [pivot, tip[1]], **link, zorder=z + 0.3)
    pins = hollow(2.8, shade(INK), markeredgewidth=0.6)
    ax.plot(parts.pivots * MM, [pivot] * 2, "o", **pins, zorder=z + 0.5)
    radius = robot.foot.radius * MM
    turn = np.linspace(0.0, 2 * np.pi, 33)
    ball = tip + radius * np.column_stack([np.cos(turn), 1.0 + np.sin(turn)])
    ax.add_patch(Polygon(ball, facecolor=shade(FOOT), zorder=z + 0.4))
    ax.plot([tip[0]], [tip[1]], linestyle="none", gid="foot at 1" if faint else "foot")
