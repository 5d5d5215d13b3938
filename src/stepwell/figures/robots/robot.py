"""The robot itself from above and from the side, drawn from its values."""

import math
from collections.abc import Callable, Sequence
from functools import partial
from textwrap import wrap
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from stepwell.figures.common import legends, sheet, style
from stepwell.figures.common.marks import along_x, along_y, arrow, limits, mm, plain, scale_bar
from stepwell.figures.common.sheet import Box
from stepwell.figures.common.words import literal
from stepwell.figures.robots import parts
from stepwell.figures.robots.parts import antenna_line, at_ends, rectangle
from stepwell.robot import Antenna, Leg, Robot

# A drawing of this width has room for its dimensions [mm].
_DETAILED = 140.0
_FADED = 0.72  # how pale cells at 1 are
FOOT, SUPPORT, ANTENNA = style.BLUE, style.VERMILLION, style.ORANGE
_BODY: dict[str, Any] = {"facecolor": style.pale(style.BLOCK, 0.5), "edgecolor": style.INK}
_BODY |= {"linewidth": 0.8, "zorder": 1}
_HOLDER: dict[str, Any] = {"color": style.FIXED_BLOCK, "linewidth": 3.0, "solid_capstyle": "butt"}


def detailed() -> bool:
    """Whether the page is wide enough for dimensions and names."""
    return sheet.page_width(style.PAGE) >= _DETAILED


def above_limits(robot: Robot) -> Box:
    """left, right, bottom, top of what is drawn, in the body's frame [mm]."""
    body = rectangle((0.0, 0.0), robot.body.length, robot.body.width)
    points = [body, np.asarray(robot.body.supports)]
    half = np.array([robot.blocks.length, robot.blocks.width]) / 2
    for leg in robot.legs:
        for pose in at_ends(robot, leg):
            points += [pose.blocks - half, pose.blocks + half]
            points += [pose.levers.reshape(-1, 2), pose.bands.reshape(-1, 2)]
    for antenna in robot.antennas:
        swings = np.linspace(0.0, antenna.swing, 7)
        points += [antenna_line(antenna, swing) for swing in swings]
    room = (26.0, 12.0, 30.0, 4.0) if detailed() else (6.0, 6.0, 26.0, 6.0)
    return limits(np.concatenate(points) * style.MM, room)


def draw_above(ax: Axes, robot: Robot) -> None:
    """Draw the robot from above, in mm, into axes without a frame."""
    box = above_limits(robot)
    plain(ax, box)
    body = rectangle((0.0, 0.0), robot.body.length, robot.body.width) * style.MM
    ax.add_patch(Polygon(body, **_BODY))
    _centre_of_mass(ax, *np.array(robot.body.centre[:2]) * style.MM)
    for point in robot.body.supports:
        x, y = np.array(point) * style.MM
        ax.plot([0.4 * x, x], [0.4 * y, y], color=SUPPORT, linewidth=1.4, zorder=1.5)
        ax.plot(x, y, "s", color=SUPPORT, markersize=4.5, zorder=7, gid="support")
    outermost: list[list[float]] = []
    for leg in robot.legs:
        at_0, at_1 = at_ends(robot, leg)
        _chain_above(ax, robot, leg, at_1, faint=True)
        _chain_above(ax, robot, leg, at_0, faint=False)
        outermost.append(at_0.blocks[-1].tolist())
    # The bar that joins these blocks.
    bar = np.array(sorted(outermost, key=lambda end: end[1])) * style.MM
    ax.plot(*bar.T, **_HOLDER, zorder=1.2)
    for antenna in robot.antennas:
        _antenna_above(ax, robot, antenna)
    # The forward direction and a scale bar.
    x, y = box[1] - 26.0, box[2] + 6.0
    arrow(ax, (x, y), (x + 18.0, y), width=1.0)
    ax.text(x + 9.0, y + 1.5, "forward", ha="center", va="bottom")
    scale_bar(ax, x - (12.0 if detailed() else 36.0), y, 50.0)
    if detailed():
        _dimensions(ax, robot, box)


def _dimensions(ax: Axes, robot: Robot, box: Box) -> None:
    """Draw dimensions and the names of legs and antennas."""
    leg = min(robot.legs, key=lambda one: one.at[1])
    near, far = (pose.blocks[-1] * style.MM for pose in at_ends(robot, leg))
    stroke = f"stroke {mm(leg.chain.full_stroke)} mm"
    along_x(ax, (far[0], near[0]), (near[1], box[2] + 18.0), stroke)
    low, high = (pick(one.at[1] for one in robot.legs) for pick in (min, max))
    if high > low:
        apart = f"{mm(high - low)} mm"
        along_y(ax, (low * style.MM, high * style.MM), (far[0], box[0] + 9.0), apart)
    named = [(np.array(leg.at) * style.MM, literal(leg.name), FOOT) for leg in robot.legs]
    labels = [legends.Label(*one) for one in named]
    for antenna in robot.antennas:
        end = antenna_line(antenna)[1] * style.MM
        labels.append(legends.Label(end, _antenna_text(robot, antenna)))
    legends.place_labels(ax, labels)


def _chain_above(ax: Axes, robot: Robot, leg: Leg, parts: parts.LegParts, *, faint: bool) -> None:
    shade, z = partial(style.pale, amount=_FADED * faint), 2.0 if faint else 3.0
    ink = shade(style.INK)
    frame = {"facecolor": "none" if faint else style.BLOCK, "edgecolor": ink, "linewidth": 0.6}
    for middle in parts.blocks:
        outline = rectangle(middle, robot.blocks.length, robot.blocks.width) * style.MM
        ax.add_patch(Polygon(outline, **frame, zorder=z))
    # The slider of a block reaches from the block to the lever's outer joint.
    for (x, y), (_, joint) in zip(parts.blocks, parts.levers, strict=True):
        slide = np.array([(x, y), (x, joint[1]), joint]) * style.MM
        ax.plot(*slide.T, color=shade(style.FAINT), linewidth=2.0, zorder=z + 0.1)
    joints = style.hollow(2.6, ink, marker="o", markeredgewidth=0.6, gid=None if faint else "lever")
    for lever in parts.levers:
        ax.plot(*(lever * style.MM).T, color=ink, linewidth=1.6, zorder=z + 0.3, **joints)
    if not faint:
        # The innermost block belongs to the body, which holds the first lever and band.
        inside = min(abs(leg.at[1]), robot.body.width / 2) * leg.side
        x, y = parts.levers[0, 0]
        ends = [inside * style.MM, y * style.MM]
        ax.plot([x * style.MM] * 2, ends, **_HOLDER, zorder=z + 0.05)
    colours = style.cell_colours(len(leg.chain))
    anchors = {"marker": "o", "markersize": 2.8, "gid": "band at 1" if faint else "band"}
    for cell, band in zip(parts.owner, parts.bands, strict=True):
        colour = shade(colours[cell])
        ax.plot(*(band * style.MM).T, color=colour, linewidth=1.8, zorder=z + 0.5, **anchors)
    y, foot = leg.at[1] * style.MM, shade(FOOT)
    ax.plot(parts.pivots * style.MM, [y] * 2, color=foot, linewidth=1.0, zorder=z + 0.2)
    tip = {"zorder": 4.2, "gid": "foot at 1"} if faint else {"zorder": 4.4, "gid": "foot"}
    ax.plot(parts.tip[0] * style.MM, y, "o", color=foot, markersize=5.0, **tip)


def _antenna_above(ax: Axes, robot: Robot, antenna: Antenna) -> None:
    at_rest, back = (antenna_line(antenna, turn) * style.MM for turn in (0.0, antenna.swing))
    ax.plot(*back.T, color=style.pale(ANTENNA, 0.6), linewidth=1.3, zorder=4)
    swings = np.linspace(0.0, antenna.swing, 41)
    sweep = np.array([antenna_line(antenna, swing)[1] for swing in swings]) * style.MM
    ax.plot(*sweep.T, color=ANTENNA, linewidth=0.7, linestyle=(0, (2, 2)), zorder=4, gid="swing")
    arrow(ax, sweep[-4], sweep[-1], ANTENNA, 0.0)
    ax.plot(*at_rest.T, color=ANTENNA, linewidth=1.8, zorder=5, gid="antenna")
    ax.plot(*at_rest[0], "o", **style.hollow(3.6, ANTENNA), zorder=6)
    bracket = parts.bracket(robot, antenna) * style.MM
    ax.plot(*bracket.T, color=style.FAINT, linewidth=0.6, zorder=1)
    if antenna.connected:
        start, end = parts.anchor_moves(robot, antenna) * style.MM
        ax.plot(*end, linestyle="none", gid="moved anchor")
        arrow(ax, start, end, width=1.0)


def _antenna_text(robot: Robot, antenna: Antenna) -> str:
    swing = math.degrees(antenna.swing)
    first = f"{literal(antenna.name)}: {mm(antenna.length)} mm, swing {swing:.3g}°"
    if not antenna.connected:
        return f"{first}\nlever taken off"
    leg = robot.leg(antenna.leg)
    moved = literal(f"{antenna.leg} {leg.chain.names[leg.cell_index(antenna.cell)]}")
    return f"{first}\nmoves $p$ of {moved} by {mm(math.hypot(*antenna.moves))} mm"


def _centre_of_mass(ax: Axes, x: float, y: float) -> None:
    ax.plot(x, y, "o", **style.hollow(6.0), zorder=7, gid="centre of mass")
    ax.plot(x, y, "+", markersize=6.0, color=style.INK, markeredgewidth=0.8, zorder=7.1)


def side_limits(robot: Robot) -> Box:
    """left, right, bottom, top of what is drawn, x of the body and z from the floor [mm]."""
    left, right, _, _ = above_limits(robot)
    pivot = float(robot.foot.depth(0.0)) * style.MM
    if not detailed():
        return left, right, -6.0, pivot + 16.0
    return left, max(right, _beyond(robot) + 44.0), -12.0, pivot + 34.0


def draw_side(ax: Axes, robot: Robot) -> None:
    """Draw the robot from its right, in mm, into axes without a frame."""
    box = side_limits(robot)
    plain(ax, box)
    floor = box[0] + 20.0, box[1] - 4.0
    ax.plot(floor, [0.0, 0.0], color=style.INK, linewidth=1.0, zorder=1, gid="floor")
    for x in np.arange(floor[0] + 2.5, floor[1], 5.0):
        ax.plot([x, x - 2.5], [0.0, -2.5], color=style.INK, linewidth=0.4, zorder=1)
    pivot = float(robot.foot.depth(0.0)) * style.MM  # above the floor while the feet stand on it
    _body(ax, robot, pivot)
    leg = min(robot.legs, key=lambda one: one.at[1])
    at_0, at_1 = at_ends(robot, leg)
    _leg(ax, robot, at_1, pivot, faint=True)
    _leg(ax, robot, at_0, pivot, faint=False)
    if detailed():
        _side_dimensions(ax, robot, at_0, at_1, pivot)


def _body(ax: Axes, robot: Robot, pivot: float) -> None:
    """Draw body, supports and antennas; the height of the body is illustrative."""
    half, low = robot.body.length / 2 * style.MM, robot.foot.below * style.MM
    ax.add_patch(Polygon(rectangle((0.0, pivot + 8.0), 2 * half, 8.0), **_BODY))
    _centre_of_mass(ax, robot.body.centre[0] * style.MM, pivot + robot.body.centre[2] * style.MM)
    # Supports behind one another coincide in this view.
    for x in sorted({round(x * style.MM, 6) for x, _ in robot.body.supports}):
        strut = [0.4 * x, x], [pivot + 4.0, low + 1.5]
        ax.plot(*strut, color=SUPPORT, linewidth=1.4, zorder=1.5)
        ax.add_patch(Polygon(rectangle((x, low + 1.5), 6.0, 3.0), facecolor=SUPPORT, zorder=6))
        ax.plot([x], [low], linestyle="none", gid="support")
    for antenna in robot.antennas:
        x = [half, *(antenna_line(antenna)[:, 0] * style.MM)]
        z = [pivot + 4.0, *([pivot] * (len(x) - 1))]
        ax.plot(x, z, color=ANTENNA, linewidth=1.4, zorder=2)


def _side_dimensions(
    ax: Axes, robot: Robot, at_0: parts.LegParts, at_1: parts.LegParts, pivot: float
) -> None:
    near, wide = at_0.pivots * style.MM, at_1.pivots * style.MM
    along_x(ax, (near[1], near[0]), (pivot, pivot + 18.0), f"{mm(robot.foot.span)} mm")
    opened = f"{mm(at_1.pivots[0] - at_1.pivots[1])} mm with every cell at 1"
    along_x(ax, (wide[1], wide[0]), (pivot, pivot + 27.0), opened, style.FAINT)
    # Clear of the chain at full stroke.
    along_y(ax, (0.0, pivot), (wide[1] - 8.0, wide[1] - 16.0), f"{pivot:.3g} mm")
    low, far = robot.foot.below * style.MM, _beyond(robot)
    fore = max(x for x, _ in robot.body.supports) * style.MM
    for height in (0.0, low):
        ax.plot([fore + 3.0, far + 3.0], [height, height], color=style.INK, linewidth=0.5, zorder=2)
    arrow(ax, (far, low + 7.0), (far, low))
    arrow(ax, (far, -7.0), (far, 0.0))
    below = f"feet {mm(robot.foot.below)} mm below\nthe supports"
    ax.text(far + 4.0, low + 3.0, below, va="bottom", ha="left", zorder=9)
    x, lifted = at_1.tip[0] * style.MM, pivot + at_1.tip[1] * style.MM
    ax.plot([x, x], [0.0, lifted], color=style.FAINT, linewidth=0.5, zorder=1)
    ax.text(x, -4.0, f"rises {lifted:.3g} mm", ha="center", va="top")
    ax.text(at_0.tip[0] * style.MM, -4.0, f"links {mm(robot.foot.link)} mm", ha="left", va="top")


def _beyond(robot: Robot) -> float:
    """x of the text ahead of the body and its supports [mm]."""
    return max(robot.body.length / 2, *(x for x, _ in robot.body.supports)) * style.MM + 8.0


def _leg(ax: Axes, robot: Robot, parts: parts.LegParts, pivot: float, *, faint: bool) -> None:
    shade, z = partial(style.pale, amount=_FADED * faint), 3.0 if faint else 4.0
    ink, fill = shade(style.INK), "white" if faint else style.BLOCK
    frame = {"facecolor": fill, "edgecolor": ink, "linewidth": 0.6}
    for x, _ in parts.blocks:
        outline = rectangle((x * style.MM, pivot), robot.blocks.length * style.MM, 8.0)
        ax.add_patch(Polygon(outline, **frame, zorder=z))
    tip = (parts.tip[0] * style.MM, pivot + parts.tip[1] * style.MM)
    link = {"color": shade(FOOT), "linewidth": 1.6, "gid": "link at 1" if faint else "link"}
    for x in parts.pivots * style.MM:
        ax.plot([x, tip[0]], [pivot, tip[1]], **link, zorder=z + 0.3)
    pins = style.hollow(2.8, ink, markeredgewidth=0.6)
    ax.plot(parts.pivots * style.MM, [pivot] * 2, "o", **pins, zorder=z + 0.5)
    radius = robot.foot.radius * style.MM
    turn = np.linspace(0.0, 2 * np.pi, 33)
    ball = tip + radius * np.column_stack([np.cos(turn), 1.0 + np.sin(turn)])
    ax.add_patch(Polygon(ball, facecolor=shade(FOOT), zorder=z + 0.4))
    ax.plot([tip[0]], [tip[1]], linestyle="none", gid="foot at 1" if faint else "foot")


_LARGEST = 0.8  # mm of the page per mm of the robot
_KEY = 12.0
# Width of a legend entry [mm], and number of entries.
_ENTRY, _ENTRIES = 42.0, 8
# Height of a line and width of a letter of the title [mm].
_LINE, _LETTER = 3.4, 1.7


@style.styled
def robot_drawing(robot: Robot) -> Figure:
    """The robot from above and, at the same scale below, from the right.

    Every cell is drawn at 0 and, pale, at 1, with dimensions in mm. Two columns wide; a narrower
    panel has no dimensions.
    """
    words = wrap(robot.title, int(sheet.page_width(style.PAGE) / _LETTER))
    figure = _page(robot, [_ABOVE, _SIDE], 7.0 + _LINE * (len(words) - 1) if words else 1.0)
    width, height = sheet.size_of(figure)
    look = {"ha": "center", "va": "top", "weight": "bold"}
    for k, line in enumerate(words):
        sheet.text_at(figure, width / 2, height - 1.5 - _LINE * k, literal(line), **look)
    return figure


@style.styled
def robot_above(robot: Robot, *, ax: Axes | None = None) -> Figure:
    """The robot from above: body, supports, chains, feet, antennas with their swing.

    Every cell is drawn at 0 and, pale, at 1; x points forward and y to the left; dimensions are in
    mm. Blocks that move sideways with a lever are drawn at the block on which they slide.

    Args:
        robot: the robot to draw.
        ax: axes to draw into; a new figure of two columns' width by default.
    """
    return _view(robot, ax, _ABOVE)


@style.styled
def robot_side(robot: Robot, *, ax: Axes | None = None) -> Figure:
    """The robot from its right: floor, supports, V links and feet, to scale.

    Every cell is drawn at 0 and, pale, at 1; x points forward and z up from the floor; dimensions
    are in mm. The rightmost leg is in front. Arguments are those of `robot_above`.
    """
    return _view(robot, ax, _SIDE)


_View = tuple[Callable[[Robot], Box], Callable[[Axes, Robot], None]]
_ABOVE: _View = above_limits, draw_above
_SIDE: _View = side_limits, draw_side


def _view(robot: Robot, ax: Axes | None, view: _View) -> Figure:
    if ax is None:
        return _page(robot, [view], 2.0)
    view[1](ax, robot)
    return sheet.root(ax)


def _page(robot: Robot, views: Sequence[_View], head: float) -> Figure:
    """Stack views at one scale under a margin `head` [mm], with the legend below."""
    page = sheet.page_width(style.PAGE)
    columns, rows = legends.grid_size(_ENTRIES, page, _ENTRY, 4)
    key = _KEY + 3.8 * (rows - 2)
    lefts, rights, bottoms, tops = zip(*(limits_of(robot) for limits_of, _ in views), strict=True)
    left, right = min(lefts), max(rights)
    scale = min(_LARGEST, (page - 4.0) / (right - left))
    across = (right - left) * scale
    tall = [(top - bottom) * scale for bottom, top in zip(bottoms, tops, strict=True)]
    figure = sheet.blank(page, key + sum(tall) + 2.0 * (len(views) - 1) + head)
    axes = sheet.stack(figure, ((page - across) / 2, key), across, tall, 2.0)
    for ax, (_, draw) in zip(axes, views, strict=True):
        draw(ax, robot)
        ax.set_xlim(left, right)
    legends.below(figure, _key(robot), columns)
    return figure


def _key(robot: Robot) -> list[Artist]:
    longest = max(robot.legs, key=lambda leg: len(leg.chain)).chain
    edge = {"edgecolor": style.pale(style.INK, _FADED), "linewidth": 0.6}
    antenna = legends.line("antenna, pale at full swing", ANTENNA, 1.8)
    return [
        *legends.cells(longest.names, 1.8, "band of {}", marker="o", markersize=2.8),
        legends.line("lever", width=1.6, marker="o", **style.hollow(2.6)),
        legends.line("V links, foot", FOOT, 1.2, marker="o", markersize=5.0),
        legends.line("T-foot", SUPPORT, marker="s", markersize=4.5),
        legends.mark("body's centre of mass", **style.hollow(6.0)),
        *[antenna] * bool(robot.antennas),
        legends.shade("pale: every cell at 1", "white", **edge),
    ]
