"""Where the actuator goes: its strokes one after another, with the windows of its turns."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from stepwell.base import Floats
from stepwell.figures.common import (
    INK,
    curve,
    direction_colour,
    hollow,
    marks,
    snaps_of,
    told,
)

if TYPE_CHECKING:
    from stepwell.sequences import Program
    from stepwell.statics import Path


_BAR: dict[str, Any] = {"color": "#BDBDBD", "linewidth": 5.0}


class Window(NamedTuple):
    """Where a stroke may end, in drawn units; `rises` says from which side it comes."""

    way: float
    low: float
    high: float
    rises: bool


class StrokePlan(NamedTuple):
    """A path's drive over the way that the actuator has covered, both (n,) in drawn units.

    Attributes:
        name: what the drive is, with its unit.
    """

    path: Path
    way: Floats
    drive: Floats
    unit: str
    name: str


def plan_of(path: Path) -> StrokePlan:
    """The plan of a path: mm, or N under force control."""
    of = told.drive(path.chain)
    drive = path.drive * of.factor
    way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(drive)))])
    return StrokePlan(path, way, drive, of.sign, of.label)


def windows_of(program: Program) -> list[Window]:
    """One for every turn, and one for the end where that may vary."""
    scale = told.drive(program.chain).factor
    points = np.array(program.turning_points) * scale
    ways = np.cumsum(np.abs(np.diff(points)))
    bounds = [(turn.low, turn.high) for turn in program.turns]
    if program.strokes and program.high > program.low:
        bounds.append((program.low, program.high))
    return [
        Window(float(ways[k]), low * scale, high * scale, bool(points[k + 1] > points[k]))
        for k, (low, high) in enumerate(bounds)
    ]


def limits(values: Floats, margin: float) -> tuple[float, float]:
    """From below the lowest to above the highest value, by a share of their range."""
    low, high = float(np.min(values)), float(np.max(values))
    more = margin * (high - low) or 1.0
    return low - more, high + more


def draw_plan(ax: Axes, plan: StrokePlan, windows: list[Window], margin: float) -> list[Line2D]:
    """Strokes, windows and snaps; returns what a legend should list.

    Args:
        ax: axes, whose y limits are set.
        plan: what to draw.
        windows: bars at its turns.
        margin: above and below, as a share of the range.
    """
    path, way, drive = plan.path, plan.way, plan.drive
    bars = np.array([(window.low, window.high) for window in windows]).ravel()
    ax.set_ylim(limits(np.concatenate([drive, bars]), margin))
    handles: list[Line2D] = []
    for direction, name in ((1, "rising"), (-1, "falling")):
        if way[-1] > 0 and np.any(path.direction * direction > 0):
            at = curve(path, direction, way, drive)
            colour = direction_colour(direction)
            handles += ax.plot(*at, color=colour, zorder=4, label=name, gid="drive")
    if at := [snap.before for snap in snaps_of(path)]:
        few = len(at) <= marks.MOST_HEADS
        look = hollow(5.4 if few else 3.0, markeredgewidth=1.1 if few else 0.7)
        handles += ax.plot(way[at], drive[at], "o", **look, zorder=6, label="snap", gid="snaps")
    for window in windows:
        x, ends = [window.way] * 2, [window.low, window.high]
        ax.plot(x, ends, **_BAR, solid_capstyle="butt", zorder=2, gid="windows")
        ax.plot(x, ends, "_", markersize=7.0, color=INK, markeredgewidth=0.8, zorder=3)
    if windows:
        handles.append(Line2D([], [], **_BAR, label="window"))
    return handles
