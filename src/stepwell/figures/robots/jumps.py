"""Jumps of a hopper: energy from the springs to the flight, and the motion over time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch, Rectangle
from matplotlib.path import Path

from stepwell.base import Floats, number, percent, to_unit
from stepwell.figures.common import sheet, style
from stepwell.figures.common.words import literal
from stepwell.robot import Task

if TYPE_CHECKING:
    from stepwell.simulation import EnergyFlow, Jump

# Of the diagram of energies [mm]: width of a bar, height of all that is stored, of a label.
_BAR, _TALL, _LABEL, _WORDS, _TOP = 4.0, 62.0, 7.6, 34.0, 8.0
# Outputs, and their colours.
_OUT = {
    "flight": ("flight", style.GREEN),
    "stops": ("stops, until lift-off", style.VERMILLION),
    "inner": ("relative motion, for stops", style.ORANGE),
    "dampers": ("dampers", style.PURPLE),
    "friction": ("friction", "#7A6A00"),
    "springs": ("loss in the springs", style.SKY),
    "foot": ("contact", style.FAINT),
    "lift": ("lift before lift-off", style.BLUE),
}
_LETTERS = 60  # of a title
_LEAST = 1e-3  # fraction of the input from which an output is drawn
# Of the panels of the motion [mm]; time shown before the snap and after lift-off [s].
_HIGH, _LEFT, _FOOT, _GAP = 38.0, 13.0, 11.0, 18.0
_BEFORE, _AFTER = 0.015, 0.025


@style.styled
def energy_flow(jump: Jump) -> Figure:
    """Energy of the first jump from the springs to the flight, as flows [mJ].

    The height of a flow is its energy: what the springs store when the snap begins, what they set
    free, and what takes it until lift-off. Two columns wide.

    Args:
        jump: result of `simulation.jump`.
    """
    flow = jump.first.flow
    page = sheet.page_width(style.PAGE)
    given = flow.released + max(flow.actuator, 0.0)
    outputs = [
        (words, getattr(flow, name), colour)
        for name, (words, colour) in _OUT.items()
        if getattr(flow, name) > _LEAST * given
    ]
    scale = _TALL / flow.stored
    tall = max(_TALL, sum(max(_LABEL, value * scale + 1.0) for _, value, _ in outputs))
    figure = sheet.blank(page, tall + _TOP + 4.0)
    ax = sheet.place(figure, 2.0, 2.0, page - 4.0, tall)
    ax.set(xlim=(0.0, page - 4.0), ylim=(0.0, tall))
    ax.axis("off")
    _flows(ax, flow, outputs, (page - 4.0, tall, scale))
    title = jump.hopper.title[:_LETTERS] if page > style.COLUMN + 1 else ""
    sheet.name_panel(ax, literal(title) if title else "Energy")
    return figure


def _flows(
    ax: Axes,
    flow: EnergyFlow,
    outputs: list[tuple[str, float, str]],
    sizes: tuple[float, float, float],
) -> None:
    wide, tall, scale = sizes
    right = wide - _WORDS - _BAR
    middle = 0.42 * right
    top, kept = tall, (flow.stored - flow.released) * scale
    free = flow.released * scale
    ax.add_patch(Rectangle((0.0, top - kept - free), _BAR, kept + free, color=style.INK, lw=0))
    _band(ax, (_BAR, top), (middle, top), free, style.pale(style.INK, 0.75))
    ax.add_patch(Rectangle((middle, top - free), _BAR, free, color=style.INK, lw=0))
    _band(ax, (_BAR, top - free), (middle - 2.0, top - free - 3.0), kept, style.pale(style.FAINT))
    at = {"va": "center", "fontsize": 7.0}
    if kept:
        words = f"kept\n{_amount(flow.stored - flow.released)}"
        ax.text(_BAR + 2.0, top - free - 2.0 - kept / 2, words, **at)
    ax.text(_BAR + 2.0, top - free / 2, f"set free\n{_amount(flow.released)}", **at)
    begin, end = top, top
    for words, value, colour in outputs:
        high = value * scale
        room = max(_LABEL, high + 1.0)
        place = end - (room - high) / 2
        _band(ax, (middle + _BAR, begin), (right, place), high, style.pale(colour, 0.5))
        ax.add_patch(Rectangle((right, place - high), _BAR, high, color=colour, lw=0))
        share = percent(value / flow.released)
        label = f"{words}\n{_amount(value)}, {share}"
        ax.text(right + _BAR + 1.0, place - high / 2, label, linespacing=1.0, **at)
        begin, end = begin - high, end - room


def _amount(energy: float) -> str:
    return f"{number(energy * style.MJ, 3)} mJ"


def _band(
    ax: Axes, start: tuple[float, float], end: tuple[float, float], high: float, colour: object
) -> None:
    """A flow of constant height between two places of its upper edge [mm]."""
    (x0, y0), (x1, y1) = start, end
    half = (x0 + x1) / 2
    upper = [(x0, y0), (half, y0), (half, y1), (x1, y1)]
    lower = [(x, y - high) for x, y in reversed(upper)]
    curve = [Path.CURVE4] * 3
    codes = [Path.MOVETO, *curve, Path.LINETO, *curve, Path.CLOSEPOLY]
    outline = Path([*upper, *lower, upper[0]], codes)
    ax.add_patch(PathPatch(outline, facecolor=colour, linewidth=0))


@style.styled
def flight(jump: Jump) -> Figure:
    """Motion of a hopper: height over time, and the travels of its cells in the first snap.

    The height [mm] is that of the centre of mass over its lowest place, or of the ball; a dashed
    line is the bound above lift-off. Travels [mm] are drawn from before the snap to after lift-off.
    Two columns wide.

    Args:
        jump: result of `simulation.jump`.
    """
    page = sheet.page_width(style.PAGE)
    alone = jump.hopper.task is Task.STRIKE
    apart = page >= sheet.SIDE_BY_SIDE
    wide = (page - 2 * _LEFT - 2 * 4.0) / 2 if apart and not alone else page - _LEFT - 4.0
    rows = 1 if apart or alone else 2
    figure = sheet.blank(page, rows * (_HIGH + _GAP))
    below = sheet.place(figure, _LEFT, _FOOT, wide, _HIGH)
    _travels(below, jump)
    if not alone:
        # The travels stand at the right, or below.
        x, y = (_LEFT, _FOOT + (rows - 1) * (_HIGH + _GAP))
        if apart:
            box = below.get_position()
            shift = (page - wide - 4.0) / page
            below.set_position((shift, box.y0, box.width, box.height))
        _height(sheet.place(figure, x, y, wide, _HIGH), jump)
    for ax in figure.axes:
        sheet.name_panel(ax, str(ax.get_gid()))
    return figure


def _height(ax: Axes, jump: Jump) -> None:
    high = _risen(jump)
    ax.plot(jump.time, high * style.MM, color=style.BLUE, gid="height")
    lift_off = {**style.hollow(4.0), "linestyle": "", "marker": "o"}
    line = {"color": style.INK, "linestyle": "--", "linewidth": 0.8}
    for k, hop in enumerate(jump.hops):
        # The legend has one entry of each.
        marked, limit = ("lift-off", "bound") if k == 0 else (None, None)
        at = float(np.interp(hop.lift_off, jump.time, high))
        ax.plot(hop.lift_off, at * style.MM, label=marked, gid="lift-off", **lift_off)
        if np.isfinite(jump.bound.height):
            bound = [(at + jump.bound.height) * style.MM] * 2
            ends = [hop.lift_off, hop.lift_off + 0.4]
            ax.plot(ends, bound, label=limit, gid="bound", **line)
    ax.set(xlabel="Time [s]", ylabel="Height [mm]", gid="Flight")
    ax.set_xlim(0.0, float(jump.time[-1]))
    _legend(ax)
    ax.spines[["top", "right"]].set_visible(False)


def _risen(jump: Jump) -> Floats:
    """(n,) height of the centre of mass, or of the ball along the chain [m], from the lowest."""
    high = jump.centre[:, 1] / (1.0 if jump.hopper.task is Task.JUMP else np.cos(jump.hopper.tilt))
    return np.asarray(high - high.min(), float)


def _travels(ax: Axes, jump: Jump) -> None:
    first, names = jump.first, jump.hopper.chain.names
    shown = (jump.time > first.snap - _BEFORE) & (jump.time < first.lift_off + _AFTER)
    time = to_unit(jump.time[shown] - first.snap, "ms")
    colours, dashes = style.cell_colours(len(names)), style.cell_dashes(len(names))
    for i, name in enumerate(names):
        travel = jump.travels[shown, i] * style.MM
        ax.plot(
            time, travel, color=colours[i], linestyle=dashes[i], label=literal(name), gid="travel"
        )
    late = to_unit(first.lift_off - first.snap, "ms")
    ax.axvline(late, color=style.FAINT, linewidth=0.8)
    ax.set(xlabel="Time from the snap [ms]", ylabel="Travel [mm]", gid="Snap")
    _legend(ax)
    ax.spines[["top", "right"]].set_visible(False)


def _legend(ax: Axes) -> None:
    """A legend above the axes, at the right of the panel's name."""
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.03), ncols=2)
