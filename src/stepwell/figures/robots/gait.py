"""The gait: what the cells of every leg do while the actuator goes out and back."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepwell.figures.common import legends, sheet, style
from stepwell.figures.common.words import literal
from stepwell.figures.robots.walk_reading import (
    Rest,
    first_cycle,
    intervals,
    last_cycles,
    resting,
    show_time,
    standing,
)

if TYPE_CHECKING:
    from stepwell.simulation import Walk

STANCE = style.pale(style.FAINT, 0.72)
_LEFT, _RIGHT, _TOP, _BOTTOM = 16.0, 5.0, 11.0, 9.0
_STROKE, _LEG, _STATES = 18.0, 24.0, 9.0
# What an entry and a row of the key take.
_ENTRY, _ROW = 26.0, 3.8


@style.styled
def gait(walk: Walk, *, cycles: float = 3) -> Figure:
    """Travel of every cell of every leg against time, with the states that each leg rests in.

    Args:
        walk: any walk.
        cycles: how many to show, counted back from its end; > 0.

    Returns:
        A figure of two columns' width: the actuator's stroke [mm] on top, then travels [mm] leg
        by leg, shaded while the foot stands, with the states below each.

    Raises:
        ValueError: no cycles asked for, or a walk without samples.

    Source: Kamp et al. 2024, Fig. 3.
    """
    some = last_cycles(walk, cycles)
    time, robot, page = walk.time[some], walk.robot, sheet.page_width(style.PAGE)
    longest = max(robot.legs, key=lambda leg: len(leg.chain)).chain
    handles = [
        *legends.cells(longest.names, dashed=True),
        legends.shade("foot on the floor", STANCE),
        legends.line("stroke", width=1.2),
        legends.line("command", style.FAINT, 1.0),
    ]
    columns, rows = legends.laid(len(handles), page - _LEFT, _ENTRY)
    above = _TOP + _ROW * (rows - 1)
    height = above + _STROKE + 3.0 + len(robot.legs) * (_LEG + _STATES) + _BOTTOM
    figure = sheet.blank(page, height)
    across = page - _LEFT - _RIGHT
    bottom = height - above - _STROKE
    top = sheet.place(figure, _LEFT, bottom, across, _STROKE)
    top.plot(time, walk.command[some] * style.MM, color=style.FAINT, linewidth=1.0, gid="command")
    top.plot(time, walk.stroke[some] * style.MM, color=style.INK, linewidth=1.2, gid="stroke")
    most = robot.drive.amplitude * style.MM
    top.set(ylim=(-0.06 * most, 1.06 * most), ylabel="Stroke\n$u$ [mm]")
    axes = [top]
    for i, leg in enumerate(robot.legs):
        bottom -= _LEG + (_STATES if i else 3.0)
        ax = sheet.place(figure, _LEFT, bottom, across, _LEG)
        axes.append(ax)
        for begin, end in intervals(time, standing(walk.foot_force[some, i])):
            ax.axvspan(begin, end, color=STANCE, linewidth=0, zorder=0, gid="stance")
        full = max(leg.chain.full_travels) * style.MM
        cells = len(leg.chain)
        looks = zip(style.cell_colours(cells), style.cell_dashes(cells), strict=True)
        for j, (colour, dashes) in enumerate(looks):
            look = {"color": colour, "linestyle": dashes, "gid": f"{leg.name} cell {j}"}
            ax.plot(time, walk.travel[some, i, j] * style.MM, linewidth=1.4, **look)
        ax.set(ylim=(-0.06 * full, 1.06 * full), ylabel=f"Travel $s$ of\n{literal(leg.name)} [mm]")
    for ax in axes:
        show_time(ax, walk, some, zorder=1)
        ax.spines[["top", "right"]].set_visible(False)
        ax.yaxis.set_label_coords(-7.5 / across, 0.5)
        ax.tick_params(labelbottom=False)
    for ax, leg in zip(axes[1:], robot.legs, strict=True):
        _states(ax, resting(walk, leg.name, some))
    _number_cycles(top, walk)
    last = axes[-1]
    last.tick_params(axis="x", labelbottom=True, pad=_STATES / 25.4 * 72.0 - 4.0)
    last.set_xlabel("Time [s]")
    legends.on_top(figure, handles, _LEFT, columns=columns)
    return figure


def _states(ax: Axes, found: list[Rest]) -> None:
    """Below the axes, a bracket for every rest with the state under it."""
    low, high = ax.get_xlim()
    span = high - low
    across = ax.get_position().width * sheet.page_width(style.PAGE)
    per_mm = 1.0 / _LEG
    reached = [-np.inf, -np.inf]
    under: dict[str, Any] = {"transform": ax.get_xaxis_transform()}
    bar = {"color": style.INK, "linewidth": 1.6, "solid_capstyle": "butt", "clip_on": False}
    look = {"ha": "center", "va": "top", "fontweight": "bold", "gid": "state"}
    for begin, end, state in found:
        ends = [begin, max(end, begin + 0.004 * span)]
        ax.plot(ends, [-1.2 * per_mm] * 2, **bar, **under, gid="rest")
        # Two rows, so that a short rest between two others keeps its label.
        half = (1.0 * len(state) + 0.3) / across * span
        middle = (begin + end) / 2
        row = next((k for k in (0, 1) if middle - half > reached[k]), None)
        if row is None or middle + half > high + 0.02 * span:
            continue
        reached[row] = middle + half
        ax.text(middle, (-1.9 - 2.9 * row) * per_mm, state, **look, **under)


def _number_cycles(ax: Axes, walk: Walk) -> None:
    """Above the axes, the number of every whole cycle that is shown."""
    low, high = ax.get_xlim()
    middles = enumerate((walk.starts[:-1] + walk.starts[1:]) / 2, first_cycle(walk) + 1)
    shown = [(number, x) for number, x in middles if low - 1e-9 < x < high]
    look = {"transform": ax.get_xaxis_transform(), "ha": "center", "va": "bottom"}
    for number, x in shown[:: max(1, len(shown) // 10)]:
        ax.text(x, 1.03, f"cycle {number}" if len(shown) <= 10 else str(number), **look)
