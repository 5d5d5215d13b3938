"""What carries the robot and what the actuator does: contacts, forces, work."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from stepwell.base import InputError
from stepwell.figures.common import (
    FAINT,
    INK,
    LOADING,
    MJ,
    MM,
    PAGE,
    UNLOADING,
    blank,
    literal,
    marks,
    place,
    styled,
)
from stepwell.figures.runs.gait import refuse_empty
from stepwell.figures.runs.walk_reading import intervals, leg_colours, span, standing, window

if TYPE_CHECKING:
    from stepwell.simulation import Walk

_LEFT, _RIGHT, _TOP = 20.0, 5.0, 8.0
_LEAST_FORCE = 0.1  # that the actuator's axis has room for [N]
_LANE, _FORCE, _LOOP = 4.2, 34.0, 44.0


@styled
def contacts(walk: Walk, *, cycles: float = 3) -> Figure:
    """When each foot and the T-foot stand, what they carry, and the actuator's force and work.

    Args:
        walk: any walk.
        cycles: how many to show against time, counted back from its end; > 0. Force against
            stroke and work are of all whole cycles.

    Returns:
        A figure of two columns' width: contacts and forces [N] against time [s], actuator force
        [N] against stroke [mm], work of each cycle [mJ].

    Raises:
        ValueError: no cycles asked for, or a walk without samples.
    """
    if not cycles > 0:
        raise InputError(f"cycles = {cycles}: must be > 0.")
    refuse_empty(walk)
    lanes = _LANE * (len(walk.robot.legs) + 1)
    height = _TOP + lanes + 2.5 + _FORCE + 14.0 + _LOOP + 10.0
    figure = blank(PAGE, height)
    wide = PAGE - _LEFT - _RIGHT
    bars = place(figure, _LEFT, height - _TOP - lanes, wide, lanes)
    force = place(figure, _LEFT, 24.0 + _LOOP, wide, _FORCE)
    _carried(bars, force, walk, window(walk, cycles))
    _loop(place(figure, _LEFT, 10.0, 72.0, _LOOP), walk)
    _work(place(figure, 112.0, 10.0, PAGE - 112.0 - _RIGHT, _LOOP), walk)
    return figure


def _carried(bars: Axes, force: Axes, walk: Walk, some: slice) -> None:
    time = walk.time[some]
    names = [leg.name for leg in walk.robot.legs] + ["T-foot"]
    colours = [*leg_colours(walk.robot), INK]
    loads = np.column_stack([walk.foot_force[some], walk.support_force[some].sum(axis=1)])
    step = walk.settings.sample
    for i, (name, colour) in enumerate(zip(names, colours, strict=True)):
        stood = standing(loads[:, i])
        spans = [
            (one.begin - step / 2, one.end - one.begin + step) for one in intervals(time, stood)
        ]
        bars.broken_barh(spans, (i - 0.32, 0.64), facecolors=colour, linewidth=0, gid=name)
        force.plot(
            time,
            loads[:, i],
            color=colour,
            linewidth=1.2,
            label=literal(name),
            gid=f"force {name}",
            zorder=2 if name == "T-foot" else 3,
        )
    bars.set_ylim(len(names) - 0.4, -0.6)
    bars.set_yticks(range(len(names)), [*map(literal, names)])
    bars.tick_params(axis="y", length=0)
    bars.tick_params(labelbottom=False)
    bars.set_title("Stands on the floor", loc="left", pad=3.0)
    bars.spines[["top", "right", "left"]].set_visible(False)
    force.axhline(
        walk.robot.weight,
        color=FAINT,
        linewidth=0.7,
        linestyle=(0, (4, 3)),
        zorder=1,
        gid="weight",
        label="weight of the robot",
    )
    force.set_ylabel("Force of the floor [N]")
    force.set_xlabel("Time [s]")
    force.set_ylim(0.0, 1.28 * max(walk.robot.weight, float(loads.max(initial=0.0))))
    force.spines[["top", "right"]].set_visible(False)
    force.legend(loc="upper left", bbox_to_anchor=(0.0, 1.0), ncols=min(len(names) + 1, 7))
    for ax in (bars, force):
        ax.set_xlim(*span(walk, some))
        for start in walk.starts:
            if time[0] < start < time[-1]:
                ax.axvline(start, color=FAINT, linewidth=0.5, linestyle=(0, (4, 3)), zorder=0)


def _loop(ax: Axes, walk: Walk) -> None:
    marks.zero_line(ax)
    rising = np.gradient(walk.command) >= 0 if len(walk.time) > 1 else np.array([True])
    stroke, force = walk.stroke * MM, walk.actuator_force
    for held, colour, name in ((rising, LOADING, "out"), (~rising, UNLOADING, "back")):
        # A sample past each end joins the way out to the way back.
        joined = held | np.roll(held, 1) if len(held) > 1 else held
        joined[0] = held[0]
        ax.plot(
            np.where(joined, stroke, np.nan),
            np.where(joined, force, np.nan),
            color=colour,
            linewidth=0.9,
            gid=name,
        )
    most = walk.robot.drive.amplitude * MM
    ax.set_xlim(-0.06 * most, 1.06 * most)
    low, high = ax.get_ylim()
    ax.set_ylim(min(low, -_LEAST_FORCE), max(high, _LEAST_FORCE))
    ax.set_xlabel("Stroke $u$ [mm]")
    ax.set_ylabel("Actuator force [N]")
    ax.legend(
        handles=[
            Line2D([], [], color=LOADING, label="out"),
            Line2D([], [], color=UNLOADING, label="back"),
        ],
        loc="lower left",
        bbox_to_anchor=(0.0, 1.02),
        ncols=2,
    )


def _work(ax: Axes, walk: Walk) -> None:
    """The area of each loop."""
    starts = walk.starts
    first = round(starts[0] / walk.robot.drive.period) if len(starts) else 0
    at = np.minimum(np.searchsorted(walk.time, starts - 1e-9), len(walk.time) - 1)
    work = [
        np.trapezoid(walk.actuator_force[a : b + 1], walk.stroke[a : b + 1])
        for a, b in pairwise(at)
    ]
    number = first + 1 + np.arange(walk.cycles)
    ax.bar(number, np.array(work) * MJ, width=0.7, color=INK, gid="work")
    marks.zero_line(ax)
    ax.set_xlim(first + 0.4, first + max(walk.cycles, 1) + 0.6)
    ax.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1, nbins=8))
    ax.set_xlabel("Cycle")
    ax.set_ylabel("Work of the actuator [mJ]")
    if not walk.cycles:
        ax.set_xticks([])
        ax.text(0.5, 0.5, "no whole cycle", transform=ax.transAxes, ha="center", va="center")
