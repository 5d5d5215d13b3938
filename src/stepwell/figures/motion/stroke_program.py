"""A stroke program: where the actuator turns, how far off it may be, and what the cells do."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Bbox
from numpy.typing import NDArray

from stepwell.figures.common import (
    BLACK,
    COLUMN,
    FAINT,
    MM,
    PAGE,
    Label,
    beside,
    blank,
    cell_colours,
    curve,
    keep_inside,
    literal,
    marks as _marks,
    pale,
    place,
    root,
    shortened,
    snaps_of,
    styled,
    vertices,
)
from stepwell.figures.motion.plan import StrokePlan, Window, draw_plan, limits, plan_of, windows_of

if TYPE_CHECKING:
    from stepwell.sequences.programs import Program
    from stepwell.statics import Path

Array = NDArray[np.float64]

# Past this many lanes, travels are shown as shades.
MOST_LANES = 12
_ABOVE, _LANE, _SHADES = 46.0, 10.0, 60.0
_FOOT = 10.0
_GAP = 0.55
# Characters that a line of a cell's name has room for.
_NAME = 13
# Past this many characters the names of the states cover what they name.
_MOST_LETTERS = 300
# A name farther than this from its dot could be another's [pt].
_NEAR = 9.0


@styled
def stroke_program(result: Program) -> Figure:
    """Where the actuator goes, the windows of its turns, and the travel of every cell below.

    Args:
        result: a program of a chain of any length.

    Returns:
        The figure: the drive [mm], or [N] under force control, against the way that the actuator
        has covered, which at constant speed is time. Every turn is numbered, with its window as
        a bar; states with all cells at a stop are named along the curve, snaps are marked.
    """
    path = result.path
    plan = plan_of(path)
    cells = len(path.chain)
    width = COLUMN if cells <= 3 and result.strokes <= 4 else PAGE
    below = _LANE * cells if cells <= MOST_LANES else _SHADES
    figure = blank(width, _FOOT + below + 3.0 + _ABOVE + 7.0)
    names = [shortened(name, _NAME, 2) for name in path.chain.names]
    longest = max(len(line) for name in names for line in name.split("\n"))
    right = 4.0 + 1.75 * longest if cells <= MOST_LANES else 5.0
    upper = place(figure, 14.0, _FOOT + 3.0 + below, width - 14.0 - right, _ABOVE)
    lower = place(figure, 14.0, _FOOT, width - 14.0 - right, below)
    for ax in (upper, lower):
        ax.set_xlim(limits(plan.way, 0.04))
    upper.tick_params(labelbottom=False)
    upper.set_ylabel(plan.name)
    lower.set_xlabel(f"Way covered by the actuator [{plan.unit}]")

    windows = windows_of(result)
    handles = draw_plan(upper, plan, windows, 0.28)
    if cells <= MOST_LANES:
        _draw_lanes(lower, path, plan.way, names)
    else:
        _draw_shades(lower, path, plan.way)
    # Names last, when the axes have their final size, and both the same.
    for ax, other in ((upper, lower), (lower, upper)):
        keep_inside(ax)
        box, under = ax.get_position(), other.get_position()
        other.set_position((box.x0, under.y0, box.width, under.height))
    taken = _number_turns(upper, windows[: len(result.turns)])
    _name_states(upper, result, plan, taken)
    upper.legend(handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.02), ncols=4)
    return figure


def _number_turns(ax: Axes, windows: Sequence[Window]) -> list[Bbox]:
    """The number of every turn beyond its window, with its value where there is room."""
    taken: list[Bbox] = []
    for k, (x, low, high, up) in enumerate(windows, 1):
        text = ax.annotate(
            str(k),
            (x, high if up else low),
            (0.0, 7.0 if up else -7.0),
            textcoords="offset points",
            ha="center",
            va="center_baseline",
            color="white",
            fontweight="bold",
            bbox={"boxstyle": "circle,pad=0.15", "facecolor": BLACK, "linewidth": 0},
            zorder=9,
            gid="turns",
        )
        box = text.get_window_extent()
        value = ax.annotate(
            _plus_minus((low + high) / 2, (high - low) / 2),
            (x, high if up else low),
            (0.0, 17.0 if up else -17.0),
            textcoords="offset points",
            ha="center",
            va="center",
        )
        words = value.get_window_extent()
        if any(words.overlaps(other) for other in taken) or not _inside(ax, words):
            value.remove()
            words = box
        taken += [box.padded(3.0), words]
    return taken


def _plus_minus(value: float, off: float) -> str:
    """The value with as many decimals as two digits of `off` have."""
    decimals = max(0, 1 - math.floor(math.log10(off))) if off > 0 else 2
    return f"{value:.{decimals}f} ± {off:.{decimals}f}".replace("-", "\N{MINUS SIGN}")


def _inside(ax: Axes, box: Bbox) -> bool:
    frame = ax.get_window_extent()
    return frame.x0 < box.x0 and box.x1 < frame.x1 and frame.y0 < box.y0 and box.y1 < frame.y1


def _name_states(ax: Axes, result: Program, plan: StrokePlan, taken: Sequence[Bbox]) -> None:
    """A dot for every state, and its name where there is room."""
    way, drive = plan.way, plan.drive
    rests = vertices(result.path)
    at = [rest.sample for rest in rests]
    crowded = len(rests) * len(result.to) > _MOST_LETTERS
    size = 1.8 if crowded else 3.4
    ax.plot(way[at], drive[at], "o", markersize=size, color=BLACK, zorder=7, gid="states")
    # Where the way turns is what a reader looks for first.
    turns = np.flatnonzero(np.diff(np.sign([rest.direction for rest in rests]))).tolist()
    first = list(dict.fromkeys([0, len(rests) - 1, *turns])) if rests else []
    others = [] if crowded else [k for k in range(len(rests)) if k not in first]
    kept = list(taken)
    point = root(ax).dpi / 72.0
    for k in first + others:
        label = Label(float(way[at[k]]), float(drive[at[k]]), rests[k].state)
        here = ax.transData.transform((label.x, label.y))
        for text in beside(ax, [label], keep_clear=kept):
            box = text.get_window_extent()
            near = box.padded(_NEAR * point).contains(*here)
            if near and _inside(ax, box) and not any(box.overlaps(other) for other in kept):
                kept.append(box)
            else:
                text.remove()


def _draw_lanes(ax: Axes, path: Path, way: Array, names: Sequence[str]) -> None:
    """Travel of every cell, innermost on top."""
    cells = path.chain.cells
    longest = max(cell.full_travel for cell in cells) * MM
    jumps = [(snap.before, snap.after, snap.cells) for snap in snaps_of(path)]
    ticks: list[float] = []
    marks: list[str] = []
    for i, (cell, name, colour) in enumerate(
        zip(cells, names, cell_colours(len(cells)), strict=True)
    ):
        base = -i * (1.0 + _GAP) * longest
        top = base + cell.full_travel * MM
        travel = base + path.travel[:, i] * MM
        for stop in (base, top):
            ax.axhline(stop, color=FAINT, linewidth=0.4, zorder=0)
        ax.fill_between(way, base, travel, color=pale(colour), linewidth=0, zorder=1)
        for direction in (1, -1):
            ax.plot(*curve(path, direction, way, travel), color=colour, zorder=3, gid="travel")
        for before, after, moved in jumps:
            if i in moved:
                ax.plot(
                    way[[before, after]],
                    travel[[before, after]],
                    color=colour,
                    linestyle=_marks.SNAP_DASHES,
                    linewidth=0.9,
                    zorder=3,
                    gid="jumps",
                )
        ticks += [base, top]
        marks += ["0", f"{cell.full_travel * MM:.3g}"]
        ax.annotate(
            literal(name),
            (1.0, (base + top) / 2),
            (4.0, 0.0),
            xycoords=("axes fraction", "data"),
            textcoords="offset points",
            ha="left",
            va="center",
            color=colour,
            fontweight="bold",
        )
    ax.set_yticks(ticks, marks)
    ax.set_ylabel("Travel $s$ [mm]")
    ax.set_ylim(-(len(cells) - 1) * (1.0 + _GAP) * longest - 0.15 * longest, 1.15 * longest)


def _draw_shades(ax: Axes, path: Path, way: Array) -> None:
    """Travel of every cell of a long chain as a shade, innermost on top."""
    full = np.array([cell.full_travel for cell in path.chain.cells])
    edges = np.concatenate([way, way[-1:]])
    ax.pcolormesh(
        edges,
        np.arange(len(full) + 1) + 0.5,
        (path.travel / full).T,
        cmap="Greys",
        vmin=0.0,
        vmax=1.1,
        rasterized=True,
    )
    ax.invert_yaxis()
    ax.yaxis.set_major_locator(MaxNLocator(integer=True))
    ax.set_ylabel("Cell (white at 0, black at 1)")
