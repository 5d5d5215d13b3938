"""The robot itself from above and from the side, drawn from its values."""

from __future__ import annotations

from collections.abc import Callable
from textwrap import wrap

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepwell.figures.common import (
    INK,
    PAGE,
    blank,
    hollow,
    legends,
    literal,
    page_width,
    place,
    root,
    styled,
    text_at,
)
from stepwell.figures.robots.robot_above import (
    ANTENNA,
    FOOT,
    SUPPORT,
    above_limits,
    draw_above,
    faded,
)
from stepwell.figures.robots.robot_side import draw_side, side_limits
from stepwell.robot import Robot

_LARGEST = 0.8  # mm of the page per mm of the robot
_KEY = 12.0
# What an entry of the key takes [mm], and how many there are.
_ENTRY, _ENTRIES = 42.0, 8
# What a line of the title and a letter of it take [mm].
_LINE, _LETTER = 3.4, 1.7


@styled
def robot_drawing(robot: Robot) -> Figure:
    """The robot from above and, at the same scale below, from the right.

    Drawn from its values with every cell at 0 and, pale, with every cell at 1.

    Args:
        robot: any robot.

    Returns:
        A figure of two columns' width, dimensions in mm; as a narrower panel of a page without
        them.
    """
    page = page_width(PAGE)
    above, side = above_limits(robot), side_limits(robot)
    left, right = min(above[0], side[0]), max(above[1], side[1])
    scale = min(_LARGEST, (page - 4.0) / (right - left))
    high = [(box[3] - box[2]) * scale for box in (above, side)]
    words = wrap(robot.title, int(page / _LETTER))
    title = 7.0 + _LINE * (len(words) - 1) if words else 1.0
    key = _rows()[1]
    height = sum(high) + key + title + 2.0
    figure = blank(page, height)
    across = (right - left) * scale
    start = (page - across) / 2
    draw_above(place(figure, start, height - title - high[0], across, high[0]), robot)
    draw_side(place(figure, start, key, across, high[1]), robot)
    for ax in figure.axes:
        ax.set_xlim(left, right)
    _key(figure, robot)
    look = {"ha": "center", "va": "top", "weight": "bold"}
    for k, line in enumerate(words):
        text_at(figure, page / 2, height - 1.5 - _LINE * k, literal(line), **look)
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
    return _view(robot, ax, above_limits, draw_above)


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
    return _view(robot, ax, side_limits, draw_side)


def _view(
    robot: Robot,
    ax: Axes | None,
    limits_of: Callable[[Robot], tuple[float, float, float, float]],
    draw: Callable[[Axes, Robot], None],
) -> Figure:
    if ax is not None:
        draw(ax, robot)
        return root(ax)
    page = page_width(PAGE)
    left, right, bottom, top = limits_of(robot)
    scale = min(_LARGEST, (page - 4.0) / (right - left))
    across, high = (right - left) * scale, (top - bottom) * scale
    key = _rows()[1]
    figure = blank(page, high + key + 2.0)
    draw(place(figure, (page - across) / 2, key, across, high), robot)
    _key(figure, robot)
    return figure


def _rows() -> tuple[int, float]:
    """Columns of the key, and its height [mm]."""
    columns, rows = legends.laid(_ENTRIES, page_width(PAGE), _ENTRY, 4)
    return columns, _KEY + 3.8 * (rows - 2)


def _key(figure: Figure, robot: Robot) -> None:
    longest = max(robot.legs, key=lambda leg: len(leg.chain)).chain
    handles: list[Artist] = [
        *legends.cells(longest.names, 1.8, "band of {}", marker="o", markersize=2.8),
        legends.line("lever", width=1.6, marker="o", **hollow(2.6)),
        legends.line("V links, foot", FOOT, 1.2, marker="o", markersize=5.0),
        legends.line("T-foot", SUPPORT, marker="s", markersize=4.5),
        legends.mark("body's centre of mass", **hollow(6.0)),
    ]
    if robot.antennas:
        handles.append(legends.line("antenna, pale at full swing", ANTENNA, 1.8))
    look = {"edgecolor": faded(INK, True), "linewidth": 0.6}
    handles.append(legends.shade("pale: every cell at 1", "white", **look))
    legends.below(figure, handles, _rows()[0])
