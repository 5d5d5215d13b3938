"""Walks over time: the gait, contacts, forces and work."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby, pairwise
from operator import itemgetter
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from stepwell.base import Bools, Floats, InputError
from stepwell.figures.common import legends, marks, sheet, style
from stepwell.figures.common.words import literal
from stepwell.robot import Robot

if TYPE_CHECKING:
    from stepwell.simulation import Walk


# Motion of the robot in a cycle, in the order of legends.
FORWARD, BACKWARD, IDLE = "forward", "backward", "in place"
LEFT, RIGHT = "turning left", "turning right"
MOTION = {
    FORWARD: style.INK,
    LEFT: style.BLUE,
    RIGHT: style.VERMILLION,
    BACKWARD: style.ORANGE,
    IDLE: style.FAINT,
}
PRESSED = style.PURPLE

_MORE = (style.GREEN, style.BLUE, style.VERMILLION, style.INK)


def leg_colours(robot: Robot) -> dict[str, str]:
    """One colour a leg, by its name; neither blue nor vermillion, which have other meanings."""
    names = [leg.name for leg in robot.legs]
    return dict(zip(names, style.cell_colours(len(names)), strict=True))


def first_cycle(walk: Walk) -> int:
    """Number of actuator cycles before the first whole cycle of the walk."""
    return round(walk.starts[0] / walk.robot.drive.period) if len(walk.starts) else 0


def cycle_samples(walk: Walk) -> NDArray[np.intp]:
    """The sample at the start of every cycle and at the end of the last; none without a cycle."""
    return np.minimum(np.searchsorted(walk.time, walk.starts - 1e-9), len(walk.time) - 1)


def intervals(time: Floats, held: Bools) -> list[tuple[float, float]]:
    """The first and the last time of every stretch of samples in which `held` is true."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], held, [False]])))
    return [(float(time[first]), float(time[end - 1])) for first, end in edges.reshape(-1, 2)]


def standing(force: Floats) -> Bools:
    """Whether a foot or support is in stance, by its ground reaction forces [N]."""
    from stepwell.simulation import LOADED

    return force > LOADED


def resting(walk: Walk, leg: str, some: slice) -> list[tuple[float, float, str]]:
    """Begin and end [s] of each rest of a leg, with its state, as `Walk.gait` counts them."""
    states = ((time, walk.state(leg, time)) for time in walk.time[some].tolist())
    rests = groupby(((time, state) for time, state in states if state is not None), itemgetter(1))
    states_at = [(state, [time for time, _ in rest]) for state, rest in rests]
    return [(times[0], times[-1], state) for state, times in states_at]


def direction(gait: str) -> int:
    """+1 for a forward step, -1 for a backward step, 0 for none. In a forward step the last cell,
    which lifts the foot, moves last on loading and on unloading.
    """
    states = gait.split(">")
    ones = "1" * (len(states[0]) - 1)
    out, back = ones + "0", "0" * len(ones) + "1"
    if not ones or not {out, back, ones + "1"} <= {*states}:
        return 0
    return 1 if states.index(out) < states.index(back) else -1


def gait_words(gait: str) -> str:
    """A gait with the direction of its step."""
    return gait + {1: ", forward", -1: ", backward", 0: ""}[direction(gait)]


def motions(walk: Walk) -> list[str]:
    """Motion of the robot in each cycle, from the gaits of its legs."""
    gaits = walk.gaits
    kinds: list[str] = []
    for cycle in range(walk.cycles):
        steps = [(leg.side, direction(gaits[leg.name][cycle])) for leg in walk.robot.legs]
        sides = ([step for own, step in steps if own == side] for side in (1, -1))
        left, right = (sum(own) / max(len(own), 1) for own in sides)
        if left != right:
            kinds.append(LEFT if right > left else RIGHT)
        else:
            kinds.append(FORWARD if left > 0 else BACKWARD if left < 0 else IDLE)
    return kinds


def gait_colours(walk: Walk) -> dict[str, str]:
    """A colour for every gait string that occurs, directed ones first."""
    occur = {gait for gaits in walk.gaits.values() for gait in gaits}
    colours = {gait: colour for gait, colour in style.PATHWAY.items() if gait in occur}
    longer = {1: style.ORANGE, -1: style.SKY, 0: style.YELLOW}
    step = {gait: direction(gait) for gait in occur}
    rest = sorted(occur - set(colours), key=lambda gait: (-abs(step[gait]), -step[gait], gait))
    spare = iter(_MORE * (len(rest) // len(_MORE) + 1))
    for gait in rest:
        colour = longer[step[gait]] if len(gait.split(">")[0]) > 2 else ""
        colours[gait] = colour if colour and colour not in colours.values() else next(spare)
    return colours


DASHED = {"color": style.FAINT, "linewidth": 0.5, "linestyle": (0, (4, 3))}


def refuse_empty(walk: Walk) -> None:
    """Refuse a walk that ended before its first sample."""
    if len(walk.time) == 0:
        why = f" {walk.stopped}" if walk.stopped else ""
        raise InputError(f"the walk has no samples, so there is nothing to draw.{why}")


def last_cycles(walk: Walk, cycles: float) -> slice:
    """The samples of the last cycles; refuses cycles <= 0 and a walk without samples."""
    if not cycles > 0:
        raise InputError(f"cycles = {cycles}: must be > 0.")
    refuse_empty(walk)
    begin = walk.time[-1] - cycles * walk.robot.drive.period
    return slice(int(np.searchsorted(walk.time, begin - 1e-9)), len(walk.time))


def show_time(ax: Axes, walk: Walk, some: slice, zorder: float) -> None:
    """Set limits at the first and last sample, at least a tenth of a period apart, and draw the
    starts of cycles as dashed lines.
    """
    time = walk.time[some]
    ax.set_xlim(time[0], max(time[-1], time[0] + 0.1 * walk.robot.drive.period))
    if sheet.page_width(style.PAGE) < style.PAGE:
        # Moments of a short walk have many digits.
        ax.xaxis.set_major_locator(MaxNLocator(nbins=5, steps=[1, 2, 5, 10]))
    for start in walk.starts:
        if time[0] < start < time[-1]:
            ax.axvline(start, **DASHED, zorder=zorder)


def number_cycles(ax: Axes, walk: Walk) -> NDArray[np.intp]:
    """Set an axis for bars over whole cycles, with a note if there is none; returns numbers."""
    first = first_cycle(walk)
    marks.zero_line(ax)
    ax.set(xlim=(first + 0.4, first + max(walk.cycles, 1) + 0.6), xlabel="Cycle")
    ax.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1, nbins=8))
    if not walk.cycles:
        ax.set_xticks([])
        middle = {"transform": ax.transAxes, "ha": "center", "va": "center"}
        ax.text(0.5, 0.5, "no whole cycle", bbox=style.on_white(0.2), **middle)
    return first + 1 + np.arange(walk.cycles)


STANCE = style.pale(style.FAINT, 0.72)
_LEFT, _RIGHT, _TOP, _BOTTOM = 16.0, 5.0, 11.0, 9.0
_STROKE, _LEG, _STATES = 18.0, 24.0, 9.0
# Width of an entry and height of a row of the legend [mm].
_ENTRY, _ROW = 26.0, 3.8


@style.styled
def gait(walk: Walk, *, cycles: float = 3) -> Figure:
    """Travel of every cell of every leg against time [s], with the states of each leg.

    The actuator's stroke [mm] is on top, then travels [mm] leg by leg, shaded in stance, with the
    states below each. Two columns wide.

    Args:
        walk: the walk to plot.
        cycles: number of cycles plotted, counted back from the end; > 0.

    Raises:
        ValueError: cycles <= 0, or a walk without samples.

    Source: Kamp et al. 2024, Fig. 3.
    """
    some = last_cycles(walk, cycles)
    time, robot, page = walk.time[some], walk.robot, sheet.page_width(style.PAGE)
    longest = max(robot.legs, key=lambda leg: len(leg.chain)).chain
    handles = [
        *legends.cells(longest.names, dashed=True),
        legends.shade("stance", STANCE),
        legends.line("stroke", width=1.2),
        legends.line("command", style.FAINT, 1.0),
    ]
    columns, rows = legends.grid_size(len(handles), page - _LEFT, _ENTRY)
    above = _TOP + _ROW * (rows - 1)
    legs = len(robot.legs) * (_LEG + _STATES)
    figure = sheet.blank(page, above + _STROKE + 3.0 + legs + _BOTTOM)
    across = page - _LEFT - _RIGHT
    top = sheet.place(figure, _LEFT, _BOTTOM + legs + 3.0, across, _STROKE)
    corner = _LEFT, _BOTTOM + _STATES
    axes = sheet.stack(figure, corner, across, [_LEG] * len(robot.legs), _STATES)
    top.plot(time, walk.command[some] * style.MM, color=style.FAINT, linewidth=1.0, gid="command")
    top.plot(time, walk.stroke[some] * style.MM, color=style.INK, linewidth=1.2, gid="stroke")
    most = robot.drive.amplitude * style.MM
    top.set(ylim=(-0.06 * most, 1.06 * most), ylabel="Stroke\n$u$ [mm]")
    for i, (ax, leg) in enumerate(zip(axes, robot.legs, strict=True)):
        for begin, end in intervals(time, standing(walk.foot_force[some, i])):
            ax.axvspan(begin, end, color=STANCE, linewidth=0, zorder=0, gid="stance")
        full = max(leg.chain.full_travels) * style.MM
        for j, (colour, dashes) in enumerate(_cell_looks(leg.chain.names, longest.names)):
            look = {"color": colour, "linestyle": dashes, "gid": f"{leg.name} cell {j}"}
            ax.plot(time, walk.travel[some, i, j] * style.MM, linewidth=1.4, **look)
        ax.set(ylim=(-0.06 * full, 1.06 * full), ylabel=f"Travel $s$ of\n{literal(leg.name)} [mm]")
    for ax in (top, *axes):
        show_time(ax, walk, some, zorder=1)
        ax.spines[["top", "right"]].set_visible(False)
        ax.yaxis.set_label_coords(-7.5 / across, 0.5)
        ax.tick_params(labelbottom=False)
    for ax, leg in zip(axes, robot.legs, strict=True):
        _states(ax, resting(walk, leg.name, some))
    _number_cycles(top, walk)
    axes[-1].tick_params(axis="x", labelbottom=True, pad=_STATES / 25.4 * 72.0 - 4.0)
    axes[-1].set_xlabel("Time [s]")
    legends.on_top(figure, handles, _LEFT, columns=columns)
    return figure


def _cell_looks(names: Sequence[str], listed: Sequence[str]) -> list[tuple[Any, Any]]:
    """Colour and dashes of each cell of a leg, those of its name in a legend of listed names."""
    looks = [*zip(style.cell_colours(len(listed)), style.cell_dashes(len(listed)), strict=True)]
    known = set(names) <= set(listed)
    return [looks[listed.index(name) if known else j] for j, name in enumerate(names)]


def _states(ax: Axes, rests: list[tuple[float, float, str]]) -> None:
    """Draw a bracket below the axes for each rest, with its state under it."""
    low, high = ax.get_xlim()
    span = high - low
    across = ax.get_position().width * sheet.page_width(style.PAGE)
    per_mm = 1.0 / _LEG
    reached = [-np.inf, -np.inf]
    under: dict[str, Any] = {"transform": ax.get_xaxis_transform()}
    bar = {"color": style.INK, "linewidth": 1.6, "solid_capstyle": "butt", "clip_on": False}
    look = {"ha": "center", "va": "top", "fontweight": "bold", "gid": "state"}
    for begin, end, state in rests:
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
    """Write the number of each whole cycle above the axes."""
    low, high = ax.get_xlim()
    middles = enumerate((walk.starts[:-1] + walk.starts[1:]) / 2, first_cycle(walk) + 1)
    shown = [(number, x) for number, x in middles if low - 1e-9 < x < high]
    look = {"transform": ax.get_xaxis_transform(), "ha": "center", "va": "bottom"}
    for number, x in shown[:: max(1, len(shown) // 10)]:
        ax.text(x, 1.03, f"cycle {number}" if len(shown) <= 10 else str(number), **look)


_CONTACTS_LEFT, _CONTACTS_RIGHT, _CONTACTS_TOP = 20.0, 5.0, 8.0
_UPPER = (0, (3.0, 2.0))
_LEAST_FORCE = 0.1  # least range of the actuator force axis [N]
_LANE, _FORCE, _LOOP = 4.2, 34.0, 44.0
_CONTACTS_ENTRY = 25.0  # width of a legend entry [mm]


@style.styled
def contacts(walk: Walk, *, cycles: float = 3) -> Figure:
    """Stance and ground reaction force of each foot and the T-foot, actuator force and work.

    Stance and ground reaction forces [N] are drawn against time [s], actuator force [N] against
    stroke [mm], and the work of each cycle [mJ]. Two columns wide.

    Args:
        walk: the walk to plot.
        cycles: number of cycles plotted against time, counted back from the end; > 0. Force
            against stroke and work show all whole cycles.

    Raises:
        ValueError: cycles <= 0, or a walk without samples.
    """
    some = last_cycles(walk, cycles)
    lanes = _LANE * (len(walk.robot.legs) + 1)
    page = sheet.page_width(style.PAGE)
    left, wide = _CONTACTS_LEFT, page - _CONTACTS_LEFT - _CONTACTS_RIGHT
    # The work is at the right of the loop, or below it.
    base, loop, work = 10.0, 72.0, (112.0, 10.0, page - 112.0 - _CONTACTS_RIGHT, _LOOP)
    if page < sheet.SIDE_BY_SIDE:
        base, loop, work = 22.0 + _FORCE, wide, (left, 10.0, wide, _FORCE)
    upper = base + _LOOP + 14.0
    figure = sheet.blank(page, upper + _FORCE + 2.5 + lanes + _CONTACTS_TOP)
    bars, force = sheet.stack(figure, (left, upper), wide, [lanes, _FORCE], 2.5)
    _carried(bars, force, walk, some)
    _loop(sheet.place(figure, left, base, loop, _LOOP), walk)
    _work(sheet.place(figure, *work), walk)
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
        last = i == len(names) - 1
        look = {"color": colour, "linewidth": widths[i], "zorder": 2 if last else 3}
        look["linestyle"] = "-" if i == 0 or last else _UPPER
        force.plot(time, loads[:, i], **look, label=literal(name), gid=f"force {name}")
    style.name_rows(bars, names, 0.6)
    bars.tick_params(labelbottom=False)
    bars.set_title("Stance", loc="left", pad=3.0)
    bars.spines[["top", "right", "left"]].set_visible(False)
    weight = walk.robot.weight
    look = DASHED | {"linewidth": 0.7, "zorder": 1, "gid": "weight"}
    force.axhline(weight, **look, label="weight of the robot")
    force.set(xlabel="Time [s]", ylabel="Ground reaction force [N]")
    room = sheet.page_width(style.PAGE) - _CONTACTS_LEFT - _CONTACTS_RIGHT
    columns, rows = legends.grid_size(len(names) + 1, room, _CONTACTS_ENTRY, 7)
    force.set_ylim(0.0, (1.14 + 0.14 * rows) * max(weight, float(loads.max(initial=0.0))))
    force.spines[["top", "right"]].set_visible(False)
    force.legend(loc="upper left", bbox_to_anchor=(0.0, 1.0), ncols=columns)
    for ax in (bars, force):
        show_time(ax, walk, some, zorder=0)


def _loop(ax: Axes, walk: Walk) -> None:
    marks.zero_line(ax)
    rising = np.gradient(walk.command) >= 0 if len(walk.time) > 1 else np.array([True])
    stroke, force = walk.stroke * style.MM, walk.actuator_force
    looks = (rising, style.LOADING, "loading"), (~rising, style.UNLOADING, "unloading")
    for held, colour, name in looks:
        # One sample past each end joins loading to unloading.
        joined = held | np.append(False, held[:-1])
        u, f = (np.where(joined, values, np.nan) for values in (stroke, force))
        ax.plot(u, f, color=colour, linewidth=0.9, gid=name)
    most = walk.robot.drive.amplitude * style.MM
    low, high = ax.get_ylim()
    ends = min(low, -_LEAST_FORCE), max(high, _LEAST_FORCE)
    ax.set(xlim=(-0.06 * most, 1.06 * most), ylim=ends)
    ax.set(xlabel="Stroke $u$ [mm]", ylabel="Actuator force [N]")
    legends.above(ax, [legends.line(name, colour) for _, colour, name in looks])


def _work(ax: Axes, walk: Walk) -> None:
    spans = [slice(a, b + 1) for a, b in pairwise(cycle_samples(walk))]
    work = [np.trapezoid(walk.actuator_force[one], walk.stroke[one]) * style.MJ for one in spans]
    ax.bar(number_cycles(ax, walk), work, width=0.7, color=style.INK, gid="work")
    ax.set_ylabel("Actuator work [mJ]")
