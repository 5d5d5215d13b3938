"""The robot itself from above and from the side, drawn from its values."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from stepwell.figures.common import (
    INK,
    PAGE,
    blank,
    cell_colours,
    literal,
    pale,
    place,
    root,
    styled,
)
from stepwell.figures.robots.robot_above import ANTENNA, FOOT, SUPPORT, above_limits, draw_above
from stepwell.figures.robots.robot_side import draw_side, side_limits
from stepwell.robot import Robot

_LARGEST = 0.8  # mm of the page per mm of the robot
_KEY = 12.0


@styled
def robot_drawing(robot: Robot) -> Figure:
    """The robot from above and, at the same scale below, from the right.

    Drawn from its values with every cell at 0 and, pale, with every cell at 1.

    Args:
        robot: any robot.

    Returns:
        A figure of two columns' width, dimensions in mm.
    """
    above, side = above_limits(robot), side_limits(robot)
    left, right = min(above[0], side[0]), max(above[1], side[1])
    scale = min(_LARGEST, (PAGE - 4.0) / (right - left))
    high = [(box[3] - box[2]) * scale for box in (above, side)]
    title = 7.0 if robot.title else 1.0
    height = sum(high) + _KEY + title + 2.0
    figure = blank(PAGE, height)
    wide = (right - left) * scale
    start = (PAGE - wide) / 2
    draw_above(place(figure, start, height - title - high[0], wide, high[0]), robot)
    draw_side(place(figure, start, _KEY, wide, high[1]), robot)
    for ax in figure.axes:
        ax.set_xlim(left, right)
    _key(figure, robot)
    if robot.title:
        figure.text(
            0.5, 1 - 1.5 / height, literal(robot.title), ha="center", va="top", weight="bold"
        )
    return figure


@styled
def robot_above(robot: Robot, *, ax: Axes | None = None) -> Figure:
    """The robot from above: body, supports, chains, feet, antennas with their swing.

    Drawn from its values with every cell at 0 and, pale, with every cell at 1. Blocks that move
    sideways with a lever are drawn beside the block that they slide on.

    Args:
        robot: any robot.
        ax: axes to draw into; a new figure of two columns' width by default.

    Returns:
        The figure, x forward and y to the left, dimensions in mm.
    """
    if ax is not None:
        draw_above(ax, robot)
        return root(ax)
    figure, ax = _sheet(above_limits(robot))
    draw_above(ax, robot)
    _key(figure, robot)
    return figure


@styled
def robot_side(robot: Robot, *, ax: Axes | None = None) -> Figure:
    """The robot from its right: floor, supports, V links and feet, to scale.

    Drawn from its values with every cell at 0 and, pale, with every cell at 1.

    Args:
        robot: any robot; the rightmost leg is in front.
        ax: axes to draw into; a new figure of two columns' width by default.

    Returns:
        The figure, x forward and z up from the floor, dimensions in mm.
    """
    if ax is not None:
        draw_side(ax, robot)
        return root(ax)
    figure, ax = _sheet(side_limits(robot))
    draw_side(ax, robot)
    _key(figure, robot)
    return figure


def _sheet(box: tuple[float, float, float, float]) -> tuple[Figure, Axes]:
    scale = min(_LARGEST, (PAGE - 4.0) / (box[1] - box[0]))
    wide, high = (box[1] - box[0]) * scale, (box[3] - box[2]) * scale
    figure = blank(PAGE, high + _KEY + 2.0)
    return figure, place(figure, (PAGE - wide) / 2, _KEY, wide, high)


def _key(figure: Figure, robot: Robot) -> None:
    longest = max(robot.legs, key=lambda leg: len(leg.chain)).chain
    handles: list[Line2D | Patch] = [
        Line2D(
            [],
            [],
            color=colour,
            linewidth=1.8,
            marker="o",
            markersize=2.8,
            label=f"band of {literal(name)}",
        )
        for name, colour in zip(longest.names, cell_colours(len(longest)), strict=True)
    ]
    handles += [
        Line2D(
            [],
            [],
            color=INK,
            linewidth=1.6,
            marker="o",
            markersize=2.6,
            markerfacecolor="white",
            label="lever",
        ),
        Line2D(
            [], [], color=FOOT, linewidth=1.2, marker="o", markersize=5.0, label="V links, foot"
        ),
        Line2D([], [], color=SUPPORT, linewidth=1.4, marker="s", markersize=4.5, label="T-foot"),
        Line2D(
            [],
            [],
            color=INK,
            linestyle="none",
            marker="o",
            markersize=6.0,
            markerfacecolor="white",
            label="body's centre of mass",
        ),
    ]
    if robot.antennas:
        handles.append(
            Line2D([], [], color=ANTENNA, linewidth=1.8, label="antenna, pale at full swing")
        )
    handles.append(
        Patch(
            facecolor="white",
            edgecolor=pale(INK, 0.72),
            linewidth=0.6,
            label="pale: every cell at 1",
        )
    )
    high = 25.4 * figure.get_size_inches()[1]
    figure.legend(handles=handles, loc="lower center", bbox_to_anchor=(0.5, 1.5 / high), ncols=4)
