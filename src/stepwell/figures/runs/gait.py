"""The gait: what the cells of every leg do while the actuator goes out and back."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from stepwell.base import InputError
from stepwell.figures.common import (
    FAINT,
    INK,
    MM,
    PAGE,
    blank,
    cell_colours,
    literal,
    pale,
    place,
    styled,
)
from stepwell.figures.runs.walk_reading import Interval, intervals, resting, span, standing, window

if TYPE_CHECKING:
    from stepwell.simulation import Walk

STANCE = pale(FAINT, 0.72)
_LEFT, _RIGHT, _TOP, _BOTTOM = 16.0, 5.0, 11.0, 9.0
_STROKE, _LEG, _STATES = 18.0, 24.0, 9.0


@styled
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
    if not cycles > 0:
        raise InputError(f"cycles = {cycles}: must be > 0.")
    refuse_empty(walk)
    some = window(walk, cycles)
    time, robot = walk.time[some], walk.robot
    height = _TOP + _STROKE + 3.0 + len(robot.legs) * (_LEG + _STATES) + _BOTTOM
    figure = blank(PAGE, height)
    wide = PAGE - _LEFT - _RIGHT
    bottom = height - _TOP - _STROKE
    top = place(figure, _LEFT, bottom, wide, _STROKE)
    top.plot(time, walk.command[some] * MM, color=FAINT, linewidth=1.0, gid="command")
    top.plot(time, walk.stroke[some] * MM, color=INK, linewidth=1.2, gid="stroke")
    most = robot.drive.amplitude * MM
    top.set_ylim(-0.06 * most, 1.06 * most)
    top.set_ylabel("Stroke\n$u$ [mm]")
    axes = [top]
    for i, leg in enumerate(robot.legs):
        bottom -= _LEG + (_STATES if i else 3.0)
        ax = place(figure, _LEFT, bottom, wide, _LEG)
        axes.append(ax)
        for stance in intervals(time, standing(walk.foot_force[some, i])):
            ax.axvspan(stance.begin, stance.end, color=STANCE, linewidth=0, zorder=0, gid="stance")
        full = max(cell.full_travel for cell in leg.chain.cells) * MM
        for j, colour in enumerate(cell_colours(len(leg.chain))):
            travel = walk.travel[some, i, j] * MM
            ax.plot(time, travel, color=colour, linewidth=1.4, gid=f"{leg.name} cell {j}")
        ax.set_ylim(-0.06 * full, 1.06 * full)
        ax.set_ylabel(f"Travel $s$ of\n{literal(leg.name)} [mm]")
        ax.set_xlim(*span(walk, some))
        _states(ax, resting(walk, leg.name, some))
    starts = walk.starts
    first = round(starts[0] / robot.drive.period) if len(starts) else 0
    for ax in axes:
        ax.set_xlim(*span(walk, some))
        ax.spines[["top", "right"]].set_visible(False)
        ax.yaxis.set_label_coords(-7.5 / wide, 0.5)
        for start in starts:
            if time[0] < start < time[-1]:
                ax.axvline(start, color=FAINT, linewidth=0.5, linestyle=(0, (4, 3)), zorder=1)
        ax.tick_params(labelbottom=False)
    _number_cycles(top, starts, first)
    last = axes[-1]
    last.tick_params(axis="x", labelbottom=True, pad=_STATES / 25.4 * 72.0 - 4.0)
    last.set_xlabel("Time [s]")
    _key(figure, walk, height)
    return figure


def refuse_empty(walk: Walk) -> None:
    """Refuse a walk that ended before its first sample."""
    if len(walk.time) == 0:
        why = f" {walk.stopped}" if walk.stopped else ""
        raise InputError(f"the walk has no samples, so there is nothing to draw.{why}")


def _states(ax: Axes, found: list[Interval]) -> None:
    """Below the axes, a bracket for every rest with the state under it."""
    low, high = ax.get_xlim()
    span = high - low
    wide = ax.get_position().width * PAGE
    below = ax.get_xaxis_transform()
    per_mm = 1.0 / _LEG
    reached = [-np.inf, -np.inf]
    for rest in found:
        ax.plot(
            [rest.begin, max(rest.end, rest.begin + 0.004 * span)],
            [-1.2 * per_mm] * 2,
            transform=below,
            color=INK,
            linewidth=1.6,
            solid_capstyle="butt",
            clip_on=False,
            gid="rest",
        )
        # Two rows, so that a short rest between two others keeps its label.
        half = (1.0 * len(rest.what) + 0.3) / wide * span
        middle = (rest.begin + rest.end) / 2
        row = next((k for k in (0, 1) if middle - half > reached[k]), None)
        if row is None or middle + half > high + 0.02 * span:
            continue
        reached[row] = middle + half
        ax.text(
            middle,
            (-1.9 - 2.9 * row) * per_mm,
            rest.what,
            transform=below,
            ha="center",
            va="top",
            fontweight="bold",
            gid="state",
        )


def _number_cycles(ax: Axes, starts: np.ndarray, first: int) -> None:
    """Above the axes, the number of every whole cycle that is shown."""
    low, high = ax.get_xlim()
    shown = [
        (first + k + 1, (a + b) / 2)
        for k, (a, b) in enumerate(pairwise(starts))
        if low - 1e-9 < (a + b) / 2 < high
    ]
    every = max(1, len(shown) // 10)
    for number, middle in shown[::every]:
        ax.text(
            middle,
            1.03,
            f"cycle {number}" if len(shown) <= 10 else str(number),
            transform=ax.get_xaxis_transform(),
            ha="center",
            va="bottom",
        )


def _key(figure: Figure, walk: Walk, height: float) -> None:
    longest = max(walk.robot.legs, key=lambda leg: len(leg.chain)).chain
    handles: list[Line2D | Patch] = [
        Line2D([], [], color=colour, label=literal(name))
        for name, colour in zip(longest.names, cell_colours(len(longest)), strict=True)
    ]
    handles += [
        Patch(facecolor=STANCE, label="foot on the floor"),
        Line2D([], [], color=INK, linewidth=1.2, label="stroke"),
        Line2D([], [], color=FAINT, linewidth=1.0, label="command"),
    ]
    figure.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=(_LEFT / PAGE, 1 - 1.5 / height),
        ncols=len(handles),
    )
