"""Path of a walking robot, with advance and turn of each cycle."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from stepwell.base import Floats, InputError
from stepwell.figures.common import legends, marks, sheet, style
from stepwell.figures.common.words import literal, wrapped
from stepwell.figures.robots.parts import frame, in_world
from stepwell.figures.robots.walks import cycle_samples, number_cycles, refuse_empty

if TYPE_CHECKING:
    from stepwell.simulation import Walk


_WIDE, _BAR, _GAP = 66.0, 35.0, 15.0
# Height of bars below a path; width of an entry and height of a row of the legend [mm].
_LOW, _ENTRY, _ROW = 34.0, 36.0, 3.8
_APART = 1.5  # between the name of x and the numbers of the bars below it [mm]
_LEFT, _ABOVE, _BELOW, _KEY = 14.0, 6.0, 10.0, 6.0
_LINE, _LETTER = 3.4, 1.7  # height of a line and width of a letter of a name [mm]
_LEAST_TURN = 20.0  # least range of a panel of turns [°]
_START = style.hollow(4.5)
_HEADING = 3.4  # length of an arrow to the heading [mm]
_FAN = 2.6  # longer where steps are shorter than arrows
_SLIGHT = 0.5  # turns that no bar shows [°]
_SIDEWAYS: dict[str, Any] = {"markersize": 3.0, "color": style.ORANGE}
_SIDEWAYS |= {"markeredgecolor": style.INK, "markeredgewidth": 0.4}


def trajectory(walk: Walk) -> Figure:
    """The path of the body from above, with advance and turn of each cycle.

    The path [mm] has an arrow along the heading at the start of every cycle. Bars show d/u_max
    along and across that heading and the turn to the left [°]. Two columns wide.

    Raises:
        ValueError: a walk without samples.

    Source: Kamp et al. 2024, Figs. 3C to 3E.
    """
    return trajectories({walk.robot.title: walk})


@style.styled
def trajectories(walks: Mapping[str, Walk]) -> Figure:
    """The paths of several walks at one scale, each with advance and turn of its cycles.

    Each walk has a row with its name above; see `trajectory`.

    Raises:
        ValueError: no walks, or a walk without samples.

    Source: Kamp et al. 2024, Figs. 3C to 3E.
    """
    if not walks:
        raise InputError("walks is empty: give one walk or more, by name.")
    boxes = [_extent(walk) for walk in walks.values()]
    widest = max(box[1] - box[0] for box in boxes)
    page = sheet.page_width(style.PAGE)
    side_by_side = page >= sheet.SIDE_BY_SIDE
    wide = _WIDE if side_by_side else page - _LEFT - 5.0
    bar = _BAR if side_by_side else (page - _LEFT - _GAP - 2.0) / 2
    # 10 % more width, so that ticks are clear of the frame.
    scale = min(wide / (1.1 * widest), 60.0 / max(box[3] - box[2] for box in boxes))
    tall = [max(30.0, (box[3] - box[2]) * scale + 4.0) for box in boxes]
    names = [_name(name, walk, int((page - _LEFT) / _LETTER)) for name, walk in walks.items()]
    named = [5.0 + _LINE * (len(lines) - 1) if lines else 0.0 for lines in names]
    lower = 0.0 if side_by_side else _LOW + _BELOW + _APART
    handles = [
        legends.line("path of the body", style.BLUE),
        legends.mark("start", **_START),
        legends.mark("end"),
        legends.line("robot at start", style.FAINT, 0.7),
        legends.line("robot at end", style.INK, 0.7),
        legends.mark("heading at each cycle", "$\\rightarrow$", 7.0, markeredgewidth=0),
        legends.shade("along the heading", style.BLUE),
        legends.mark("to its left", "D", **_SIDEWAYS),
    ]
    columns, keys = legends.grid_size(len(handles), page - _LEFT, _ENTRY)
    key = _KEY + _ROW * (keys - 1)
    height = sum(tall) + sum(named) + len(tall) * (_ABOVE + _BELOW + lower) + key
    figure = sheet.blank(page, height)
    bars: list[tuple[Axes, Axes]] = []
    bottom = height - key
    shown = zip(walks.values(), names, named, boxes, tall, strict=True)
    for walk, lines, above, box, high in shown:
        bottom -= _ABOVE + above + high
        path = sheet.place(figure, _LEFT, bottom, wide, high)
        _path(path, walk, box, scale, (wide, high))
        left, low = (_LEFT + wide + _GAP, high) if side_by_side else (_LEFT, _LOW)
        moved = sheet.place(figure, left, bottom - lower, bar, low)
        turned = sheet.place(figure, left + bar + _GAP, bottom - lower, bar - 3.0, low)
        _bars(moved, turned, walk, bar)
        bars.append((moved, turned))
        _write(figure, lines, bottom + high + 1.8)
        bottom -= _BELOW + lower
    for column in zip(*bars, strict=True):
        _one_scale(column)
    legends.on_top(figure, handles, _LEFT, columns=columns)
    return figure


def _name(name: str, walk: Walk, most: int) -> list[str]:
    """The name of a row and a remark, in lines of at most that many letters."""
    words = [name] * bool(name) + ["stopped early"] * bool(walk.stopped)
    return wrapped(", ".join(words), most) if words else []


def _write(figure: Figure, lines: Sequence[str], y: float) -> None:
    """Write the lines of a name, the last of them at this height [mm]."""
    for k, line in enumerate(reversed(lines)):
        sheet.text_at(figure, _LEFT, y + _LINE * k, literal(line), weight="bold")


def _one_scale(column: Sequence[Axes]) -> None:
    most = max(ax.get_ylim()[1] for ax in column)
    for ax in column:
        ax.set_ylim(-most, most)


def _outline(walk: Walk, sample: int) -> list[Floats]:
    where = (walk.x[sample], walk.y[sample], walk.yaw[sample])
    return [in_world(line, *where) * style.MM for line in frame(walk.robot)]


def _extent(walk: Walk) -> sheet.Box:
    refuse_empty(walk)
    ends = [line for sample in (0, -1) for line in _outline(walk, sample)]
    points = np.concatenate([*ends, np.column_stack([walk.x, walk.y]) * style.MM])
    return marks.limits(points, (0.0, 0.0, 0.0, 0.0))


def _path(ax: Axes, walk: Walk, box: sheet.Box, scale: float, size: sheet.Point) -> None:
    """The path in axes of this width and height [mm]."""
    wide, high = size
    x, y = walk.x * style.MM, walk.y * style.MM
    for sample, colour in ((0, style.FAINT), (len(x) - 1, style.INK)):
        for line in _outline(walk, sample):
            ax.plot(*line.T, color=colour, linewidth=0.7, zorder=2, gid="robot")
    ax.plot(x, y, color=style.BLUE, linewidth=1.6, zorder=4.5, gid="path")
    at = cycle_samples(walk) if len(walk.starts) else np.unique([0, len(x) - 1])
    # A robot that turns in place has its arrows in a fan.
    step = float(np.median(np.hypot(np.diff(x[at]), np.diff(y[at])))) if len(at) > 1 else 0.0
    length = _HEADING / scale * (1.0 if step * scale > _HEADING else _FAN)
    for sample in at:
        yaw, start = walk.yaw[sample], np.array([x[sample], y[sample]])
        tip = start + length * np.array([math.cos(yaw), math.sin(yaw)])
        # Below the path, with only the head above: on a straight walk both are on one line.
        look = {"color": style.INK, "linewidth": 0.8, "zorder": 4.2, "gid": "heading"}
        ax.plot(*np.array([start, tip]).T, **look)
        marks.head(ax, start.tolist(), tip.tolist(), style.INK, size=9.0)
    ax.plot(x[0], y[0], "o", **_START, zorder=5, gid="start")
    ax.plot(x[-1], y[-1], "o", markersize=4.5, color=style.INK, zorder=5, gid="end")
    middle = (box[0] + box[1]) / 2, (box[2] + box[3]) / 2
    ax.set_xlim(middle[0] - wide / scale / 2, middle[0] + wide / scale / 2)
    ax.set_ylim(middle[1] - high / scale / 2, middle[1] + high / scale / 2)
    step = marks.round_length(min(high, wide / 2) / scale / 1.5)
    for axis in (ax.xaxis, ax.yaxis):
        low, top = axis.get_view_interval()
        axis.set_ticks(np.arange(math.ceil(low / step), math.floor(top / step) + 1) * step)
    ax.set(aspect="equal", xlabel="$x$ [mm]", ylabel="$y$ [mm]")
    ax.yaxis.set_label_coords(-9.8 / wide, 0.5)


def _bars(moved: Axes, turned: Axes, walk: Walk, wide: float) -> None:
    number, degrees = number_cycles(moved, walk), np.degrees(walk.turn)
    number_cycles(turned, walk)
    look = {"width": 0.7, "color": style.BLUE, "zorder": 2}
    moved.bar(number, walk.advance, **look, gid="advance")
    moved.plot(number, walk.sideways, "D", **_SIDEWAYS, zorder=3, gid="sideways")
    turned.bar(number, degrees, **look, gid="turn")
    # A robot that walks straight turns by almost 0°, which no bar shows.
    turned.plot(number, degrees, "o", markersize=3.0, color=style.INK, zorder=3, gid="turns")
    most = float(np.abs(degrees).max(initial=0.0))
    if walk.cycles and most < _SLIGHT:
        words = f"at most {most:.1f}° per cycle"
        if most < 0.1:
            words = "straight:\nless than 0.1° per cycle"
        if wide < _BAR:
            words = fill(words, int(wide / 1.8))
        look = {"transform": turned.transAxes, "ha": "center", "va": "center"}
        turned.text(0.5, 0.75, words, **look)
    moved.set_ylabel("Advance $d/u_\\mathrm{max}$")
    turned.set_ylabel("Turn to the left [°]")
    # Symmetric limits make left and right, forward and backward comparable.
    for ax, least in ((moved, 1.1), (turned, _LEAST_TURN)):
        most = max(least, *(abs(limit) for limit in ax.get_ylim()))
        ax.set_ylim(-most, most)
        ax.yaxis.set_major_locator(MaxNLocator(nbins=6, steps=[1, 2, 5, 10]))
        ax.yaxis.set_label_coords(-9.5 / wide, 0.5)
