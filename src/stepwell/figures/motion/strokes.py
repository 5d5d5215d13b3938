"""Actuator force and travels against stroke, and travels over time during a snap."""

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.typing import LineStyleType

from stepwell.base import Floats, InputError, Measure, to_unit
from stepwell.figures.common import legends, marks, sheet, style, words
from stepwell.figures.common.legends import Label, place_labels
from stepwell.figures.common.reading import legs, path_of, snaps_of, span, vertices
from stepwell.figures.common.sheet import Point
from stepwell.figures.common.words import literal
from stepwell.lab import Recording
from stepwell.mechanism import Cell, Chain, Element
from stepwell.sequences import Cycle
from stepwell.statics import InertialLanding, Path

# One style per recording; the pale colours distinguish loading and unloading.
_DASHES: tuple[LineStyleType, ...] = ("-", (0, (4, 1.5)), (0, (1, 1.2)), (0, (6, 1.5, 1, 1.5)))
_WIDTH, _PALE = 1.0, 0.5


def draw_recorded(ax: Axes, recordings: Sequence[Recording], measure: Measure) -> list[Artist]:
    """Draw measured force [N] over stroke [mm], each half in the pale colour of its direction.
    Returns the legend entries.
    """
    if recordings and measure is not Measure.TRAVEL:
        raise InputError(
            f"measured: recordings are forces over strokes [N, mm], and this chain has "
            f"{measure.force} over {measure.stroke}."
        )
    if len(recordings) > len(_DASHES):
        raise InputError(
            f"measured has {len(recordings)} recordings: at most {len(_DASHES)} have a line style."
        )
    entries: list[Artist] = []
    for one, dashes in zip(recordings, _DASHES, strict=False):
        look = {"linewidth": _WIDTH, "linestyle": dashes, "zorder": 2, "gid": "measured"}
        for half in one.halves:
            loads = one.direction_of(half) == "loading"
            colour = style.pale(style.LOADING if loads else style.UNLOADING, _PALE)
            ax.plot(one.stroke[half] * style.MM, one.force[half], color=colour, **look)
        name = f"measured: {literal(one.name)}"
        entries.append(legends.line(name, style.pale(style.FAINT, 0.1), _WIDTH, linestyle=dashes))
    return entries


# Loading lies under unloading, so it is wider and stays visible where both coincide.
_WIDTHS = (2.2, 1.2)


@style.styled
def force_stroke(
    result: Cycle | Path, *, measured: Sequence[Recording] = (), ax: Axes | None = None
) -> Figure:
    """Actuator force [N] against stroke [mm], loading and unloading, snaps as dashed jumps.

    Units follow the chain's measure. States are named if there is room; the mark of a state of
    elements is in the middle of its range of the stroke.

    Args:
        result: a cycle, or a path over any turning points.
        measured: recordings drawn behind it in pale colours, at most four, as `lab.read` returns
            them.
        ax: axes to draw into; by default a new figure of one column's width, or of two for
            more than four cells.

    Raises:
        ValueError: too many recordings, or some for a chain of volumes or angles.
    """
    path = path_of(result)
    own = ax is None
    width = style.COLUMN if len(path.chain) <= 4 else style.PAGE
    figure, ax = sheet.canvas(ax, (width, 62.0), (15.0, 10.0, 2.0, 6.0), keyed=True)
    x, y = words.stroke(path.chain.measure), words.actuator(path.chain.measure)
    stroke, force = path.stroke * x.factor, path.force * y.factor
    ax.set(xlabel=x.label, ylabel=y.label)
    marks.zero_line(ax)
    crowded = len(legs(path)) > marks.MOST_HEADS
    loading, unloading = (width / (1 + crowded) for width in _WIDTHS)
    marks.trace(ax, path, stroke, force, (loading, unloading))
    marks.snaps(ax, snaps_of(path), stroke, force)
    recorded = draw_recorded(ax, measured, path.chain.measure)
    ax.margins(x=0.08, y=0.12)
    ax.autoscale_view()
    if own:
        sheet.keep_inside(ax)
    if own and path.chain.elements and sheet.current().shared is None:
        recorded.append(legends.mark(marks.STATE, size=3.4, color=style.BLACK))
    marks.legend(ax, path, _WIDTHS, more=recorded, fit=own)
    marks.headings(ax, path, stroke, force)
    rests = vertices(path)
    at = [vertex.sample for vertex in rests]
    # Names take two rows, above and below the curves; a character is 0.6 of 7 pt wide.
    needed = sum(4.2 * len(vertex.state) for vertex in rests) / 72 * figure.dpi
    size = 1.5 if crowded else 3.4
    ax.plot(stroke[at], force[at], "o", markersize=size, color=style.BLACK, zorder=7, gid="states")
    if needed < 1.2 * ax.get_window_extent().width:
        named = [Label((stroke[v.sample], force[v.sample]), v.state) for v in rests]
        place_labels(ax, named, leaders=True)
    return figure


MOST_LANES = 60
_TRAVEL_WIDTHS = (2.0, 1.3)
_UNLOADING_DASHES = (0, (3.2, 1.6))
# Gap between two lanes, as a fraction of the longest travel; height of a name [mm].
_GAP, _NAME = 0.42, 3.9
# Heights in a panel of a page: a lane with name and ticks, and a row with a name alone [mm].
_LANE, _ROW = 11.0, 3.4
# Digits closer than this cover each other [pt].
_DIGIT = 7.2


@style.styled
def travel_stroke(result: Cycle | Path, *, ax: Axes | None = None) -> Figure:
    """Travel of each cell [mm] against stroke [mm], one lane per cell, innermost on top.

    Cells have lanes because in one frame the loading curve of one cell often coincides with the
    unloading curve of another. Units follow the chain's measure. Loading is solid, unloading
    dashed, snaps are dashed jumps, and the phases of an element are shaded and numbered.

    Args:
        result: a cycle, or a path over any turning points.
        ax: axes to draw into; a new figure of one column's width by default.

    Raises:
        ValueError: more cells than legible lanes.
    """
    path = path_of(result)
    cells = path.chain.cells
    if len(cells) > MOST_LANES:
        raise InputError(
            f"the chain has {len(cells)} cells: at most {MOST_LANES} lanes are legible; "
            f"path.travel contains the numbers."
        )
    lane = min(20.0, 200.0 / len(cells))
    own = ax is None
    # With more than 12 lanes, their names would overlap.
    named = len(cells) <= 12
    every = math.ceil(len(cells) / 20)
    least = len(cells) * (_LANE if named else _ROW / every)
    size, margins = (style.COLUMN, 16.0 + lane * len(cells)), (13.0, 10.0, 2.0, 6.0)
    figure, ax = sheet.canvas(ax, size, margins, keyed=True, least=least)
    x, y = words.stroke(path.chain.measure), words.travel(path.chain.measure)
    stroke = path.stroke * x.factor
    snaps = snaps_of(path)
    ticks: list[tuple[float, str]] = []
    pitch = ax.get_window_extent().height / sheet.root(ax).dpi * 25.4 / len(cells)
    gap = max(_GAP, _NAME / max(pitch - _NAME, _NAME)) if named else _GAP
    shown = lanes(path, gap)
    for i, (lane, name) in enumerate(zip(shown, path.chain.names, strict=True)):
        lane.draw(ax)
        if named:
            ticks += lane.ticks
            name_lane(ax, (0.0, lane.top), name, lane.colour, (3.0, 1.5), va="bottom")
        elif i % every == 0:
            ticks.append(((lane.base + lane.top) / 2, literal(name)))
        marks.trace(ax, path, stroke, lane.travel, _TRAVEL_WIDTHS, _UNLOADING_DASHES)
        marks.snaps(ax, [snap for snap in snaps if i in snap.cells], stroke, lane.travel, size=3.2)
    ax.set_yticks(*zip(*ticks, strict=True))
    ends = "its ends" if path.chain.elements else "0 to $S$"
    each = f"{y.word} {y.symbol} of each cell, {ends}"
    ax.set(xlabel=x.label, ylabel=y.label if named else each)
    ax.margins(x=0.06)
    longest = max(lane.top - lane.base for lane in shown)
    ax.set_ylim(shown[-1].base - 0.12 * longest, (1.0 + gap) * longest)
    for lane in shown if named else ():
        lane.number(ax)
    if own:
        sheet.keep_inside(ax)
    marks.legend(ax, path, _TRAVEL_WIDTHS, _UNLOADING_DASHES)
    return figure


class TravelLane(NamedTuple):
    """Heights at which a cell's travel is drawn: of its least, its largest, and all values."""

    base: float
    top: float
    travel: Floats
    colour: str
    # Heights and texts of both ends.
    ticks: list[tuple[float, str]]
    # Heights of the two ends of each phase of an element; empty for a lever cell.
    phases: list[tuple[float, float]]

    def draw(self, ax: Axes) -> None:
        """Draw lines at both ends, and the phases as shades."""
        for end in (self.base, self.top):
            ax.axhline(end, color=style.FAINT, linewidth=0.4, zorder=0)
        for low, high in self.phases:
            ax.axhspan(low, high, color=style.PHASE, linewidth=0, zorder=-1, gid="phases")

    def number(self, ax: Axes) -> None:
        """Write the digits of the phases at the right, on axes with their final limits."""
        middles = [(low + high) / 2 for low, high in self.phases]
        heights = [float(ax.transData.transform((0.0, y))[1]) for y in middles]
        near = _DIGIT * sheet.root(ax).dpi / 72.0
        # All or none: a part of the digits would be misread.
        if any(b - a < near for a, b in pairwise(sorted(heights))):
            return
        look: dict[str, Any] = {"ha": "right", "va": "center_baseline", "color": style.FAINT}
        look |= {"xycoords": ("axes fraction", "data"), "textcoords": "offset points"}
        for digit, y in enumerate(middles):
            ax.annotate(str(digit), (1.0, y), (-1.0, 0.0), **look, zorder=8, gid="digit")


def lanes(path: Path, gap: float) -> list[TravelLane]:
    """A lane for every cell, innermost on top; `gap` is a fraction of the longest travel."""
    cells, of = path.chain.cells, words.travel(path.chain.measure)
    spans = [span(path, i) for i in range(len(cells))]
    longest = max(high - low for low, high in spans) * of.factor
    lanes: list[TravelLane] = []
    for i, (cell, colour) in enumerate(zip(cells, style.cell_colours(len(cells)), strict=True)):
        low, high = spans[i]
        base = -i * (1.0 + gap) * longest
        # The height of a travel is foot + factor * travel.
        k, foot = of.factor, base - of.factor * low
        phases = cell.phases if isinstance(cell, Element) else ()
        shades = [(foot + k * max(p.low, low), foot + k * min(p.high, high)) for p in phases]
        top, travel = foot + k * high, foot + k * path.travel[:, i]
        ticks = [(base, of.number(low)), (top, of.number(high))]
        lanes.append(TravelLane(base, top, travel, colour, ticks, shades))
    return lanes


def name_lane(ax: Axes, at: Point, name: str, colour: str, offset: Point, va: str) -> None:
    """Write a cell's name `offset` pt from `at`: a fraction of the width, and a height."""
    look: dict[str, Any] = {"ha": "left", "va": va, "color": colour, "fontweight": "bold"}
    look |= {"xycoords": ("axes fraction", "data"), "textcoords": "offset points"}
    ax.annotate(literal(name), at, offset, **look)


# One style per landing; the first, the reference, is thin and below the others.
_LOOKS = (
    {"linewidth": 1.0, "linestyle": (0, (3.2, 1.6))},
    {"linewidth": 1.4, "linestyle": "-"},
    {"linewidth": 1.2, "linestyle": ":"},
)
# Points on each step of the integration, on which travels are parabolas.
_POINTS = 6
# A motion begins when a cell has moved by this fraction of its travel. It ends when all cells are
# within a tenth of that of their landings; 25 % more time is shown.
_STILL, _MORE = 2e-3, 1.25


@style.styled
def snap_motion(
    chain: Chain, landings: Mapping[str, InertialLanding], *, ax: Axes | None = None
) -> Figure:
    """Travel of each cell over time [ms] during a snap, with up to three landings in one frame.

    Time starts when a cell has moved by 0.2 % of its travel: near a fold the time before depends on
    the initial perturbation. Units follow the chain's measure.

    Args:
        chain: the chain that snaps.
        landings: landings of one snap with their history, by name; at most three.
        ax: axes to draw into; a new figure of one column's width by default.

    Raises:
        ValueError: no landing, more than three, or a landing without a history.
    """
    if not 1 <= len(landings) <= len(_LOOKS):
        raise InputError(
            f"landings has {len(landings)} entries: must be 1 to {len(_LOOKS)}, one per line style."
        )
    own = ax is None
    full = np.array([cell.full_travel for cell in chain.cells])
    y, colours = words.travel(chain.measure), style.cell_colours(len(chain))
    curves = [_curve(name, landing, full) for name, landing in landings.items()]
    until = max(_MORE * time[-1] for time, _ in curves)
    swings = [np.ptp(travel, axis=0) > _STILL * full for _, travel in curves]
    moved = np.flatnonzero(np.any(swings, axis=0)).tolist()
    # Height of the legend.
    top = 2.5 + 3.8 * -(-(len(moved) + len(landings)) // 3)
    figure, ax = sheet.canvas(ax, (style.COLUMN, 50.0 + top), (13.0, 10.0, 2.0, top))
    looks = _LOOKS if len(landings) > 1 else _LOOKS[1:]
    for look, (time, travel) in zip(looks, curves, strict=False):
        # At rest from then on.
        time, travel = np.append(time, until), np.vstack([travel, travel[-1]])
        for i in moved:
            ax.plot(to_unit(time, "ms"), travel[:, i] * y.factor, color=colours[i], **look)
    ax.set(xlabel="Time [ms]", ylabel=y.label)
    ax.set_xlim(0.0, to_unit(until, "ms"))
    ax.margins(y=0.08)
    # Stops within the frame; they do not widen it.
    ax.set_ylim(ax.get_ylim())
    for stop in _stops([chain.cells[i] for i in moved]):
        ax.axhline(stop * y.factor, color=style.FAINT, linewidth=0.4, zorder=0)
    lines = [legends.line(literal(chain.names[i]), colours[i]) for i in moved]
    lines += [
        Line2D([], [], color=style.FAINT, label=literal(name), **look)
        for look, name in zip(looks, landings, strict=False)
    ]
    if own:
        sheet.keep_inside(ax)
    legends.above(ax, lines, columns=3)
    return figure


def _stops(cells: Sequence[Cell | Element]) -> set[float]:
    """Travels at which a cell has a stop."""
    ends = [end for one in cells for end in zip((one.low, one.high), one.stopped, strict=True)]
    return {travel for travel, there in ends if there}


def _curve(name: str, landing: InertialLanding, full: Floats) -> tuple[Floats, Floats]:
    """Times [s] from the begin to the end of the visible motion, and the travels [m]."""
    history = landing.history
    if history is None:
        raise InputError(f"landings[{name!r}] has no history: ask for it with history=True.")
    off = np.max(np.abs(history.travel - history.travel[0]) / full, axis=1) > _STILL
    far = np.max(np.abs(history.travel - history.travel[-1]) / full, axis=1) > 0.1 * _STILL
    first = max(int(np.argmax(off)) - 1, 0)
    last = min(int(np.flatnonzero(far)[-1]) + 1 if far.any() else 1, len(off) - 1)
    part = slice(first, last + 1)
    t, s, v = history.time[part], history.travel[part], history.speed[part]
    share = np.linspace(0.0, 1.0, _POINTS, endpoint=False)[:, None, None]
    h = np.diff(t)[:, None]
    # A parabola on each step, from its begin: an impact at its end changes the speed.
    begin = h * v[:-1]
    inside = s[:-1] + share * (begin + share * (np.diff(s, axis=0) - begin))
    times = t[:-1, None] + h * share[:, 0, 0]
    travel = np.vstack([inside.transpose(1, 0, 2).reshape(-1, s.shape[1]), s[-1]])
    return np.append(times.ravel(), t[-1]) - t[0], travel
