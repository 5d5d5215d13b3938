"""What carries the robot and what the actuator does: contacts, forces, work."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepwell.figures.common import legends, marks, sheet, style
from stepwell.figures.common.words import literal
from stepwell.figures.robots.walk_reading import (
    DASHED,
    cycle_samples,
    intervals,
    last_cycles,
    leg_colours,
    number_cycles,
    show_time,
    standing,
)

if TYPE_CHECKING:
    from stepwell.simulation import Walk

_LEFT, _RIGHT, _TOP = 20.0, 5.0, 8.0
_UPPER = (0, (3.0, 2.0))
_LEAST_FORCE = 0.1  # that the actuator's axis has room for [N]
_LANE, _FORCE, _LOOP = 4.2, 34.0, 44.0
_ENTRY = 25.0  # what one of a key takes [mm]


@style.styled
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
    some = last_cycles(walk, cycles)
    lanes = _LANE * (len(walk.robot.legs) + 1)
    page = sheet.page_width(style.PAGE)
    below = 0.0 if page >= sheet.BESIDE else _FORCE + 12.0
    height = _TOP + lanes + 2.5 + _FORCE + 14.0 + _LOOP + below + 10.0
    figure = sheet.blank(page, height)
    wide = page - _LEFT - _RIGHT
    bars = sheet.place(figure, _LEFT, height - _TOP - lanes, wide, lanes)
    force = sheet.place(figure, _LEFT, height - _TOP - lanes - 2.5 - _FORCE, wide, _FORCE)
    _carried(bars, force, walk, some)
    if below:
        _loop(sheet.place(figure, _LEFT, 10.0 + below, wide, _LOOP), walk)
        _work(sheet.place(figure, _LEFT, 10.0, wide, _FORCE), walk)
    else:
        _loop(sheet.place(figure, _LEFT, 10.0, 72.0, _LOOP), walk)
        _work(sheet.place(figure, 112.0, 10.0, page - 112.0 - _RIGHT, _LOOP), walk)
    return figure


def _carried(bars: Axes, force: Axes, walk: Walk, some: slice) -> None:
    time = walk.time[some]
    colours = leg_colours(walk.robot) | {"T-foot": style.INK}
    names = [*map(literal, colours)]
    loads = np.column_stack([walk.foot_force[some], walk.support_force[some].sum(axis=1)])
    step = walk.settings.sample
    # Legs that carry the same lie on each other: the lower ones are wider, the upper ones dashed.
    widths = [*np.linspace(1.2 + 1.2 * (len(names) - 2), 1.2, len(names) - 1), 1.2]
    for i, (name, colour) in enumerate(colours.items()):
        stood = intervals(time, standing(loads[:, i]))
        spans = [(begin - step / 2, end - begin + step) for begin, end in stood]
        bars.broken_barh(spans, (i - 0.32, 0.64), facecolors=colour, linewidth=0, gid=name)
        look = {
            "color": colour,
            "linewidth": widths[i],
            "linestyle": _UPPER if 0 < i < len(names) - 1 else "-",
            "zorder": 2 if name == "T-foot" else 3,
        }
        force.plot(time, loads[:, i], **look, label=literal(name), gid=f"force {name}")
    style.name_rows(bars, names, 0.6)
    bars.tick_params(labelbottom=False)
    bars.set_title("Stands on the floor", loc="left", pad=3.0)
    bars.spines[["top", "right", "left"]].set_visible(False)
    weight = walk.robot.weight
    look = DASHED | {"linewidth": 0.7, "zorder": 1}
    force.axhline(weight, **look, gid="weight", label="weight of the robot")
    force.set(xlabel="Time [s]", ylabel="Force of the floor [N]")
    room = sheet.page_width(style.PAGE) - _LEFT - _RIGHT
    columns, rows = legends.laid(len(names) + 1, room, _ENTRY, 7)
    force.set_ylim(0.0, (1.14 + 0.14 * rows) * max(weight, float(loads.max(initial=0.0))))
    force.spines[["top", "right"]].set_visible(False)
    force.legend(loc="upper left", bbox_to_anchor=(0.0, 1.0), ncols=columns)
    for ax in (bars, force):
        show_time(ax, walk, some, zorder=0)


def _loop(ax: Axes, walk: Walk) -> None:
    marks.zero_line(ax)
    rising = np.gradient(walk.command) >= 0 if len(walk.time) > 1 else np.array([True])
    stroke, force = walk.stroke * style.MM, walk.actuator_force
    looks = (rising, style.LOADING, "out"), (~rising, style.UNLOADING, "back")
    for held, colour, name in looks:
        # A sample past each end joins the way out to the way back.
        joined = held | np.roll(held, 1) if len(held) > 1 else held
        joined[0] = held[0]
        u, f = (np.where(joined, values, np.nan) for values in (stroke, force))
        ax.plot(u, f, color=colour, linewidth=0.9, gid=name)
    most = walk.robot.drive.amplitude * style.MM
    low, high = ax.get_ylim()
    ax.set(
        xlim=(-0.06 * most, 1.06 * most), ylim=(min(low, -_LEAST_FORCE), max(high, _LEAST_FORCE))
    )
    ax.set(xlabel="Stroke $u$ [mm]", ylabel="Actuator force [N]")
    legends.above(ax, [legends.line(name, colour) for _, colour, name in looks])


def _work(ax: Axes, walk: Walk) -> None:
    """The area of each loop."""
    work = [
        np.trapezoid(walk.actuator_force[a : b + 1], walk.stroke[a : b + 1])
        for a, b in pairwise(cycle_samples(walk))
    ]
    number = number_cycles(ax, walk)
    ax.bar(number, np.array(work) * style.MJ, width=0.7, color=style.INK, gid="work")
    ax.set_ylabel("Work of the actuator [mJ]")
