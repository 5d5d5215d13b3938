"""The robot from above: body, supports, chains, feet, antennas with their swing."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from stepwell.figures.common import (
    BLOCK,
    BLUE,
    FAINT,
    FIXED_BLOCK,
    INK,
    MM,
    ORANGE,
    PAGE,
    VERMILLION,
    Label,
    along_x,
    along_y,
    arrow,
    beside,
    cell_colours,
    hollow,
    limits,
    literal,
    mm,
    page_width,
    pale,
    plain,
    scale_bar,
)
from stepwell.figures.robots.robot_parts import (
    LegParts,
    anchor_moves,
    antenna_line,
    bracket,
    leg_parts,
    rectangle,
    rest_states,
)
from stepwell.robot import Antenna, Leg, Robot

# A drawing of this width has room for its dimensions [mm].
_DETAILED = 140.0
FOOT, SUPPORT, ANTENNA = BLUE, VERMILLION, ORANGE
_HOLDER: dict[str, Any] = {"color": FIXED_BLOCK, "linewidth": 3.0, "solid_capstyle": "butt"}


def detailed() -> bool:
    """Whether there is room for dimensions and names; narrower, a drawing has none."""
    return page_width(PAGE) >= _DETAILED


def above_limits(robot: Robot) -> tuple[float, float, float, float]:
    """left, right, bottom, top of what is drawn, in the body's frame [mm]."""
    points = [rectangle((0.0, 0.0), robot.body.length, robot.body.width)]
    points.append(np.asarray(robot.body.supports))
    half = np.array([robot.blocks.length, robot.blocks.width]) / 2
    for leg in robot.legs:
        for travels in rest_states(leg):
            parts = leg_parts(robot, leg, travels)
            points += [parts.blocks - half, parts.blocks + half]
            points += [parts.levers.reshape(-1, 2), parts.bands.reshape(-1, 2)]
    for antenna in robot.antennas:
        swings = np.linspace(0.0, antenna.swing, 7)
        points += [antenna_line(antenna, swing) for swing in swings]
    room = (26.0, 12.0, 30.0, 4.0) if detailed() else (6.0, 6.0, 26.0, 6.0)
    return limits(np.concatenate(points) * MM, room)


def draw_above(ax: Axes, robot: Robot) -> None:
    """Draw it all, in mm, into axes that lose their frame."""
    box = above_limits(robot)
    plain(ax, box)
    body = rectangle((0.0, 0.0), robot.body.length, robot.body.width) * MM
    ax.add_patch(Polygon(body, facecolor=pale(BLOCK, 0.5), edgecolor=INK, linewidth=0.8, zorder=1))
    centre = np.array(robot.body.centre[:2]) * MM
    centre_of_mass(ax, centre[0], centre[1])
    for point in robot.body.supports:
        x, y = np.array(point) * MM
        ax.plot([0.4 * x, x], [0.4 * y, y], color=SUPPORT, linewidth=1.4, zorder=1.5)
        ax.plot(x, y, "s", color=SUPPORT, markersize=4.5, zorder=7, gid="support")
    for leg in robot.legs:
        at_0, at_1 = (leg_parts(robot, leg, travels) for travels in rest_states(leg))
        _chain_above(ax, robot, leg, at_1, faint=True)
        _chain_above(ax, robot, leg, at_0, faint=False)
    _carriage(ax, robot)
    for antenna in robot.antennas:
        _antenna_above(ax, robot, antenna)
    _scale(ax, box)
    if not detailed():
        return
    _dimensions(ax, robot, box)
    names = [Label(leg.at[0] * MM, leg.at[1] * MM, literal(leg.name), FOOT) for leg in robot.legs]
    for antenna in robot.antennas:
        x, y = antenna_line(antenna)[1] * MM
        names.append(Label(float(x), float(y), _antenna_text(robot, antenna)))
    beside(ax, names)


def _dimensions(ax: Axes, robot: Robot, box: tuple[float, float, float, float]) -> None:
    leg = min(robot.legs, key=lambda one: one.at[1])
    near, far = (leg_parts(robot, leg, travels).blocks[-1] * MM for travels in rest_states(leg))
    stroke = f"stroke {mm(leg.chain.full_stroke)} mm"
    along_x(ax, far[0], near[0], box[2] + 18.0, stroke, feet=near[1])
    low, high = (pick(one.at[1] for one in robot.legs) for pick in (min, max))
    if high > low:
        apart = f"{mm(high - low)} mm"
        along_y(ax, low * MM, high * MM, box[0] + 9.0, apart, feet=far[0])


def _scale(ax: Axes, box: tuple[float, float, float, float]) -> None:
    """What is forward, and how long 50 mm are."""
    x, y = box[1] - 26.0, box[2] + 6.0
    arrow(ax, (x, y), (x + 18.0, y), width=1.0)
    ax.text(x + 9.0, y + 1.5, "forward", ha="center", va="bottom")
    scale_bar(ax, x - (12.0 if detailed() else 36.0), y, 50.0)


def _chain_above(ax: Axes, robot: Robot, leg: Leg, parts: LegParts, *, faint: bool) -> None:
    def shade(colour: str) -> tuple[float, float, float]:
        return faded(colour, faint)

    z = 2.0 if faint else 3.0
    ink = shade(INK)
    frame = {"facecolor": "none" if faint else BLOCK, "edgecolor": ink, "linewidth": 0.6}
    for middle in parts.blocks:
        outline = rectangle(middle, robot.blocks.length, robot.blocks.width) * MM
        ax.add_patch(Polygon(outline, **frame, zorder=z))
    # What slides sideways on a block reaches from beside it to the lever's outer joint.
    for middle, lever in zip(parts.blocks, parts.levers, strict=True):
        joint = lever[1]
        x = np.array([middle[0], middle[0], joint[0]]) * MM
        y = np.array([middle[1], joint[1], joint[1]]) * MM
        ax.plot(x, y, color=shade(FAINT), linewidth=2.0, zorder=z + 0.1)
    joints = hollow(2.6, ink, marker="o", markeredgewidth=0.6, gid=None if faint else "lever")
    for lever in parts.levers:
        ax.plot(*(lever * MM).T, color=ink, linewidth=1.6, zorder=z + 0.3, **joints)
    if not faint:
        # The innermost block belongs to the body, which holds the first lever and band.
        inside = min(abs(leg.at[1]), robot.body.width / 2) * leg.side
        x, y = parts.levers[0, 0]
        ends = [inside * MM, y * MM]
        ax.plot([x * MM] * 2, ends, **_HOLDER, zorder=z + 0.05)
    colours = cell_colours(len(leg.chain))
    anchors = {"marker": "o", "markersize": 2.8, "gid": "band at 1" if faint else "band"}
    for cell, band in zip(parts.owner, parts.bands, strict=True):
        colour = shade(colours[cell])
        ax.plot(*(band * MM).T, color=colour, linewidth=1.8, zorder=z + 0.5, **anchors)
    y, foot = leg.at[1] * MM, shade(FOOT)
    ax.plot(parts.pivots * MM, [y] * 2, color=foot, linewidth=1.0, zorder=z + 0.2)
    tip = {"zorder": 4.2, "gid": "foot at 1"} if faint else {"zorder": 4.4, "gid": "foot"}
    ax.plot(parts.tip[0] * MM, y, "o", color=foot, markersize=5.0, **tip)


def _carriage(ax: Axes, robot: Robot) -> None:
    """The bar that joins the outermost blocks."""
    ends = [leg_parts(robot, leg, rest_states(leg)[0]).blocks[-1] for leg in robot.legs]
    line = np.array(sorted(ends, key=lambda end: end[1])) * MM
    ax.plot(*line.T, **_HOLDER, zorder=1.2)


def _antenna_above(ax: Axes, robot: Robot, antenna: Antenna) -> None:
    back = antenna_line(antenna, antenna.swing) * MM
    ax.plot(*back.T, color=pale(ANTENNA, 0.6), linewidth=1.3, zorder=4)
    swings = np.linspace(0.0, antenna.swing, 41)
    sweep = np.array([antenna_line(antenna, swing)[1] for swing in swings]) * MM
    ax.plot(*sweep.T, color=ANTENNA, linewidth=0.7, linestyle=(0, (2, 2)), zorder=4, gid="swing")
    arrow(ax, tuple(sweep[-4]), tuple(sweep[-1]), ANTENNA, 0.0)
    ax.plot(*(antenna_line(antenna) * MM).T, color=ANTENNA, linewidth=1.8, zorder=5, gid="antenna")
    ax.plot(*(np.array(antenna.pivot) * MM), "o", **hollow(3.6, ANTENNA), zorder=6)
    ax.plot(*(bracket(robot, antenna) * MM).T, color=FAINT, linewidth=0.6, zorder=1)
    if antenna.connected:
        start, end = anchor_moves(robot, antenna) * MM
        ax.plot(*end, linestyle="none", gid="moved anchor")
        arrow(ax, tuple(start), tuple(end), width=1.0)


def _antenna_text(robot: Robot, antenna: Antenna) -> str:
    swing = math.degrees(antenna.swing)
    first = f"{literal(antenna.name)}: {mm(antenna.length)} mm, swing {swing:.3g}°"
    if not antenna.connected:
        return f"{first}\nlever taken off"
    cell = robot.leg(antenna.leg).chain.names[robot.leg(antenna.leg).cell_index(antenna.cell)]
    moved = literal(f"{antenna.leg} {cell}")
    return f"{first}\nmoves $p$ of {moved} by {mm(math.hypot(*antenna.moves))} mm"


def faded(colour: str, faint: bool) -> tuple[float, float, float]:
    """The colour itself, or so pale that what is drawn in it stays in the background."""
    return pale(colour, 0.72 if faint else 0.0)


def centre_of_mass(ax: Axes, x: float, y: float) -> None:
    """The mark of the body's centre of mass [mm]."""
    ax.plot(x, y, "o", **hollow(6.0), zorder=7, gid="centre of mass")
    ax.plot(x, y, "+", markersize=6.0, color=INK, markeredgewidth=0.8, zorder=7.1)
