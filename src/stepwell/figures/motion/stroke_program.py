"""A path over time, and a stroke program: turning points, tolerance intervals and states."""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Bbox

from stepwell.base import Floats
from stepwell.figures.common import legends, marks, sheet, style, words
from stepwell.figures.common.legends import Label, inside, place_labels
from stepwell.figures.common.reading import curve, snaps_of, span, travelled, vertices
from stepwell.figures.common.words import minus, shortened
from stepwell.figures.motion.strokes import lanes, name_lane
from stepwell.sequences import Program
from stepwell.statics import Path

_BAR: dict[str, Any] = {"color": "#BDBDBD", "linewidth": 5.0}
# Axis label of `StrokePlan.way`.
COVERED = "Cumulative drive"


class Window(NamedTuple):
    """Tolerance interval of a turning point, in drawn units; `rises` if the stroke before rises."""

    way: float
    low: float
    high: float
    rises: bool


class StrokePlan(NamedTuple):
    """A path's drive over the cumulative drive `way`, both (n,) in drawn units."""

    path: Path
    way: Floats
    drive: Floats
    unit: str
    # Axis label of the drive.
    name: str


def plan_of(path: Path) -> StrokePlan:
    """The plan of a path: mm, or N under force control."""
    of = words.drive(path.chain)
    drive = path.drive * of.factor
    return StrokePlan(path, travelled(drive), drive, of.sign, of.label)


def windows_of(program: Program) -> list[Window]:
    """One window for each turning point, and one for the end if it has a tolerance."""
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
    """Limits round all values, with `margin` as a fraction of their range at both ends."""
    low, high = float(np.min(values)), float(np.max(values))
    more = margin * (high - low) or 1.0
    return low - more, high + more


def draw_plan(ax: Axes, plan: StrokePlan, windows: list[Window], margin: float) -> list[Line2D]:
    """Draw the drive, snaps and tolerance intervals, with a margin above and below. `margin` is a
    fraction of the range. Returns the legend entries.
    """
    path, way, drive = plan.path, plan.way, plan.drive
    bars = np.array([(window.low, window.high) for window in windows]).ravel()
    ax.set_ylim(limits(np.concatenate([drive, bars]), margin))
    handles: list[Line2D] = []
    for direction, name in ((1, "loading"), (-1, "unloading")):
        if way[-1] > 0 and np.any(path.direction * direction > 0):
            x, y = curve(path, direction, way, drive)
            colour = style.direction_colour(direction)
            handles += ax.plot(x, y, color=colour, zorder=4, label=name, gid="drive")
    if at := [snap.before for snap in snaps_of(path)]:
        few = len(at) <= marks.MOST_HEADS
        look = style.hollow(5.4 if few else 3.0, markeredgewidth=1.1 if few else 0.7)
        handles += ax.plot(way[at], drive[at], "o", **look, zorder=6, label="snap", gid="snaps")
    for window in windows:
        x, ends = [window.way] * 2, [window.low, window.high]
        ax.plot(x, ends, **_BAR, solid_capstyle="butt", zorder=2, gid="windows")
        ax.plot(x, ends, "_", markersize=7.0, color=style.INK, markeredgewidth=0.8, zorder=3)
    if windows:
        handles.append(Line2D([], [], **_BAR, label="tolerance interval"))
    return handles


# A snap takes milliseconds; in an animation it lasts long enough to be seen.
_SNAP_SECONDS = 0.5
_REST_SECONDS = 0.3


class Instant(NamedTuple):
    """State of a path in one frame, in SI; drive and way in the units of its plan."""

    travels: Floats
    sheets: tuple[int, ...]
    force: float
    snap: bool
    drive: float
    way: float


def instants(path: Path, seconds: float, count: int) -> list[Instant]:
    """State of the path in each of `count` frames; snaps are slow enough to be seen."""
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
        if i in jumps:
            part = part * part * (3.0 - 2.0 * part)
        columns = path.travel, path.force, plan.drive, plan.way
        travels, force, u, w = (one[i] + part * (one[j] - one[i]) for one in columns)
        sheets = tuple(path.sheet[j if part > 0.5 else i].tolist())
        frames.append(Instant(travels, sheets, float(force), i in jumps, float(u), float(w)))
    return frames


# More lanes are replaced by shades.
MOST_LANES = 12
_ABOVE, _LANE, _SHADES = 46.0, 10.0, 60.0
_FOOT = 10.0
_GAP = 0.55
# Least width of a page with the legend in one row [mm].
_ONE_ROW = 110.0
# Largest number of characters in a line of a cell's name.
_NAME = 13
# With more characters the names of the states would cover their dots.
_MOST_LETTERS = 300
# A name farther than this from its dot would be ambiguous [pt].
_NEAR = 9.0


@style.styled
def stroke_program(result: Program) -> Figure:
    """Drive, tolerance intervals of its turning points, and the travel of every cell below.

    The drive [mm], or [N] under force control, is drawn against the cumulative drive, which at
    constant speed is proportional to time; units follow the measure of the chain. Every turning
    point has a number and its tolerance interval as a bar. States with all cells at a stop or in a
    phase are named along the curve; snaps are marked.

    Args:
        result: a program of a chain of any length.
    """
    path, plan = result.path, plan_of(result.path)
    cells = len(path.chain)
    width = sheet.page_width(style.COLUMN if cells <= 3 and result.strokes <= 4 else style.PAGE)
    below = _LANE * cells if cells <= MOST_LANES else _SHADES
    windows = windows_of(result)
    # On a narrow page the legend takes two rows.
    rows = 2 if windows and width < _ONE_ROW else 1
    figure = sheet.blank(width, _FOOT + below + 3.0 + _ABOVE + 3.2 + 3.8 * rows)
    names = [shortened(name, _NAME, 2) for name in path.chain.names]
    longest = max(len(line) for name in names for line in name.split("\n"))
    right = 4.0 + 1.75 * longest if cells <= MOST_LANES else 5.0
    upper, lower = sheet.stack(figure, (14.0, _FOOT), width - 14.0 - right, [_ABOVE, below], 3.0)
    for ax in (upper, lower):
        ax.set_xlim(limits(plan.way, 0.04))
    upper.tick_params(labelbottom=False)
    upper.set_ylabel(plan.name)
    lower.set_xlabel(f"{COVERED} [{plan.unit}]")
    handles = draw_plan(upper, plan, windows, 0.28)
    if cells <= MOST_LANES:
        _draw_lanes(lower, path, plan.way, names)
    else:
        _draw_shades(lower, path, plan.way)
    # Names come last, when both axes have their final size.
    sheet.keep_both_inside(upper, lower)
    taken = _number_turns(upper, windows[: len(result.turns)])
    _name_states(upper, result, plan, taken)
    legends.above(upper, handles, 4 // rows)
    return figure


def _number_turns(ax: Axes, windows: Sequence[Window]) -> list[Bbox]:
    """Number the turning points beyond their intervals, with values if there is room."""
    taken: list[Bbox] = []
    frame = ax.get_window_extent()
    look: dict[str, Any] = {"textcoords": "offset points", "ha": "center"}
    for k, (x, low, high, up) in enumerate(windows, 1):
        end, off = ((x, high), 1.0) if up else ((x, low), -1.0)
        text = ax.annotate(str(k), end, (0.0, 7.0 * off), zorder=9, gid="turns", **look)
        text.set(va="center_baseline", **style.on_black())
        box = text.get_window_extent()
        tolerance = _plus_minus((low + high) / 2, (high - low) / 2)
        value = ax.annotate(tolerance, end, (0.0, 17.0 * off), va="center", **look)
        value_box = value.get_window_extent()
        if any(value_box.overlaps(other) for other in taken) or not inside(frame, value_box):
            value.remove()
            value_box = box
        taken += [box.padded(3.0), value_box]
    return taken


def _plus_minus(value: float, off: float) -> str:
    """The value ± `off`, with the decimals of two digits of `off`."""
    decimals = max(0, 1 - math.floor(math.log10(off))) if off > 0 else 2
    return minus(f"{value:.{decimals}f} ± {off:.{decimals}f}")


def _name_states(ax: Axes, result: Program, plan: StrokePlan, taken: Sequence[Bbox]) -> None:
    """Draw a dot for each state, and its name if there is room."""
    way, drive = plan.way, plan.drive
    rests = vertices(result.path)
    at = [rest.sample for rest in rests]
    crowded = len(rests) * len(result.target) > _MOST_LETTERS
    size = 1.8 if crowded else 3.4
    ax.plot(way[at], drive[at], "o", markersize=size, color=style.BLACK, zorder=7, gid="states")
    # Turning points are named first.
    turns = np.flatnonzero(np.diff(np.sign([rest.direction for rest in rests]))).tolist()
    first = list(dict.fromkeys([0, len(rests) - 1, *turns])) if rests else []
    others = [] if crowded else [k for k in range(len(rests)) if k not in first]
    occupied, frame = list(taken), ax.get_window_extent()
    point = sheet.root(ax).dpi / 72.0
    for k in first + others:
        label = Label((way[at[k]], drive[at[k]]), rests[k].state)
        here = ax.transData.transform(label.at)
        for text in place_labels(ax, [label], keep_clear=occupied):
            box = text.get_window_extent()
            near = box.padded(_NEAR * point).contains(*here)
            if near and inside(frame, box) and not any(box.overlaps(other) for other in occupied):
                occupied.append(box)
            else:
                text.remove()


def _draw_lanes(ax: Axes, path: Path, way: Floats, names: Sequence[str]) -> None:
    """Draw the travel of every cell as a lane, innermost on top."""
    shown = lanes(path, _GAP)
    jumps = snaps_of(path)
    ticks: list[tuple[float, str]] = []
    look: dict[str, Any] = {"linestyle": marks.SNAP_DASHES, "linewidth": 0.9, "gid": "jumps"}
    for i, lane in enumerate(shown):
        lane.draw(ax)
        base, top, travel, colour = lane[:4]
        ax.fill_between(way, base, travel, color=style.pale(colour), linewidth=0, zorder=1)
        for direction in (1, -1):
            ax.plot(*curve(path, direction, way, travel), color=colour, zorder=3, gid="travel")
        for at in (list(snap[:2]) for snap in jumps if i in snap.cells):
            ax.plot(way[at], travel[at], color=colour, zorder=3, **look)
        ticks += lane.ticks
        name_lane(ax, (1.0, (base + top) / 2), names[i], colour, (4.0, 0.0), va="center")
    ax.set_yticks(*zip(*ticks, strict=True))
    longest = max(lane.top - lane.base for lane in shown)
    low = shown[-1].base - 0.15 * longest
    ax.set(ylabel=words.travel(path.chain.measure).label, ylim=(low, 1.15 * longest))
    for lane in shown:
        lane.number(ax)


def _draw_shades(ax: Axes, path: Path, way: Floats) -> None:
    """Draw the travel of every cell of a long chain as a shade, innermost on top."""
    low, high = np.array([span(path, i) for i in range(len(path.chain))]).T
    look = {"cmap": "Greys", "vmin": 0.0, "vmax": 1.1, "rasterized": True}
    x, y = np.append(way, way[-1]), np.arange(len(low) + 1) + 0.5
    ax.pcolormesh(x, y, ((path.travel - low) / (high - low)).T, **look)
    ax.invert_yaxis()
    ax.yaxis.set_major_locator(MaxNLocator(integer=True))
    ends = ("least", "most travel") if path.chain.elements else ("0", "1")
    ax.set_ylabel(f"Cell (white at {ends[0]}, black at {ends[1]})")
