"""A path in time: its strokes one after the other, and what is seen of it at each instant."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from stepwell.base import Floats
from stepwell.figures.common import marks, style, words
from stepwell.figures.common.reading import curve, snaps_of

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
    of = words.drive(path.chain)
    drive = path.drive * of.factor
    way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(drive)))])
    return StrokePlan(path, way, drive, of.sign, of.label)


def windows_of(program: Program) -> list[Window]:
    """One for every turn, and one for the end where that may vary."""
    scale = words.drive(program.chain).factor
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
            colour = style.direction_colour(direction)
            handles += ax.plot(*at, color=colour, zorder=4, label=name, gid="drive")
    if at := [snap.before for snap in snaps_of(path)]:
        few = len(at) <= marks.MOST_HEADS
        look = style.hollow(5.4 if few else 3.0, markeredgewidth=1.1 if few else 0.7)
        handles += ax.plot(way[at], drive[at], "o", **look, zorder=6, label="snap", gid="snaps")
    for window in windows:
        x, ends = [window.way] * 2, [window.low, window.high]
        ax.plot(x, ends, **_BAR, solid_capstyle="butt", zorder=2, gid="windows")
        ax.plot(x, ends, "_", markersize=7.0, color=style.INK, markeredgewidth=0.8, zorder=3)
    if windows:
        handles.append(Line2D([], [], **_BAR, label="window"))
    return handles


# A snap takes milliseconds; shown, it has to last long enough to be seen.
_SNAP_SECONDS = 0.5
_REST_SECONDS = 0.3


class Instant(NamedTuple):
    """What a path is doing in one frame.

    Attributes:
        travels: (N,) of every cell [m].
        sheets: (N,) of the elements' curves.
        force: of the actuator [N].
        snap: whether it is in the middle of a snap.
        drive: what the actuator prescribes, in the units of its plan.
        way: that the actuator has covered, in the same.
    """

    travels: Floats
    sheets: tuple[int, ...]
    force: float
    snap: bool
    drive: float
    way: float


def instants(path: Path, seconds: float, count: int) -> list[Instant]:
    """What to show in each of `count` frames, so that snaps last long enough to be seen.

    Args:
        path: any.
        seconds: how long all frames last.
        count: of frames.
    """
    snaps = snaps_of(path)
    plan = plan_of(path)
    moving = np.diff(plan.way)
    turns = np.flatnonzero(np.diff(np.sign(path.direction)))
    # Snaps and rests never take more than half of the time.
    pauses = _SNAP_SECONDS * len(snaps) + _REST_SECONDS * (len(turns) + 1)
    shrink = min(1.0, 0.5 * seconds / pauses)
    step = moving / max(float(moving.sum()), 1e-300) * (seconds - shrink * pauses)
    jumps = {snap.before for snap in snaps}
    for snap in snaps:
        step[snap.before] += shrink * _SNAP_SECONDS
    step[turns] += shrink * _REST_SECONDS
    time = np.concatenate([[0.0], np.cumsum(step)])

    frames: list[Instant] = []
    for at in np.linspace(0.0, seconds, count, endpoint=False):
        i = min(int(np.searchsorted(time, at, side="right")) - 1, len(time) - 1)
        j = min(i + 1, len(time) - 1)
        part = (at - time[i]) / (time[j] - time[i]) if time[j] > time[i] else 0.0
        snap = i in jumps
        if snap:
            part = part * part * (3.0 - 2.0 * part)
        travels, force, u, w = (
            column[i] + part * (column[j] - column[i])
            for column in (path.travel, path.force, plan.drive, plan.way)
        )
        sheets = tuple(path.sheet[j if part > 0.5 else i].tolist())
        frames.append(Instant(travels, sheets, float(force), snap, float(u), float(w)))
    return frames
