"""Strip of the outcomes along one parameter: a row for each outcome, with its boundaries."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle
from matplotlib.text import Text

from stepwell.base import Floats
from stepwell.figures.common import sheet, style
from stepwell.figures.common.style import Colour
from stepwell.figures.common.words import literal, minus, shortened

if TYPE_CHECKING:
    from stepwell.studies import OutcomeInterval

# Height of a row, and of the title with the boundaries above the rows [mm].
ROW, HEAD = 6.2, 9.0
# Row of the designs that have no outcome.
MISSING = "not computed"
_BETWEEN = "grey: between two designs"
# Top and bottom of a bar, and foot of the text above it, as fractions of the row.
_BAR, _TEXT = (0.58, 0.94), 0.52
# Width of a letter [mm], and the largest number of designs that are marked one by one.
_LETTER, _MOST = 1.5, 80


def rows_of(runs: Sequence[OutcomeInterval], missing: Floats) -> list[str]:
    """The outcomes in the order of the parameter; designs without an outcome last."""
    return [*dict.fromkeys(run.value for run in runs), *[MISSING] * bool(len(missing))]


def draw_strip(
    ax: Axes,
    title: str,
    runs: Sequence[OutcomeInterval],
    colours: Mapping[str, Colour],
    designs: Mapping[str, Floats],
) -> None:
    """Draw the intervals into axes of `ROW` mm per row.

    Args:
        ax: the axes.
        title: name of the result, written above.
        runs: intervals of one column, in the order of the parameter.
        colours: by outcome.
        designs: values of the parameter by outcome, those without an outcome under `MISSING`.
    """
    rows = rows_of(runs, designs.get(MISSING, np.empty(0)))
    values = np.concatenate([*designs.values()])
    low, high = float(values.min()), float(values.max())
    room = 0.01 * (high - low)
    ax.set(xlim=(low - room, high + room), ylim=(len(rows), 0.0), yticks=[])
    ax.spines[["left", "right", "top"]].set_visible(False)
    unknown = any(run.high is None for run in runs[:-1])
    sheet.name_panel(ax, literal(title), 4.0, _BETWEEN if unknown else "")
    _draw_boundaries(ax, runs)
    few = len(values) <= _MOST
    for k, row in enumerate(rows):
        own = [run for run in runs if run.value == row]
        colour = colours.get(row, colours.get(style.REST, style.FAINT))
        top, foot = k + _BAR[0], k + _BAR[1]
        for run in own:
            begin, end = _ends(run)
            look = {"facecolor": colour, "edgecolor": colour, "linewidth": 0.8, "gid": "interval"}
            ax.add_patch(Rectangle((begin, top), end - begin, foot - top, **look, zorder=3))
        if few or row == MISSING:
            mark, ink = ("x", style.INK) if row == MISSING else ("|", "white")
            at = np.full(len(designs[row]), (top + foot) / 2)
            ax.plot(designs[row], at, mark, color=ink, markersize=3.0, zorder=4, gid="designs")
        ends = [_ends(run) for run in own] or [(designs[row].min(), designs[row].max())]
        text = _name_row(ax, k + _TEXT, row, own)
        _place_beside(ax, text, ends, runs)


def _ends(run: OutcomeInterval) -> tuple[float, float]:
    """An interval up to its exact boundaries, or to its first and last design."""
    return (run.first if run.low is None else run.low, run.last if run.high is None else run.high)


def _span(run: OutcomeInterval) -> str:
    return " to ".join(dict.fromkeys(f"{end:.4g}" for end in _ends(run)))


def _draw_boundaries(ax: Axes, runs: Sequence[OutcomeInterval]) -> None:
    """Draw exact boundaries as lines with their values, the others as grey intervals."""
    above = ax.get_xaxis_transform()
    taken = -np.inf
    for before, after in pairwise(runs):
        if before.high is None:
            look = {"color": style.pale(style.FAINT, 0.6), "linewidth": 0, "zorder": 1}
            ax.axvspan(before.last, after.first, **look, gid="between designs")
            continue
        ax.axvline(before.high, color=style.INK, linewidth=0.8, zorder=5, gid="exact boundary")
        look = {"ha": "center", "va": "bottom", "transform": above, "gid": "boundary"}
        text = ax.text(before.high, 1.02, minus(f"{before.high:.4g}"), **look)
        box = text.get_window_extent()
        # A value without room is left out; the row below has it too.
        if box.x0 < taken:
            text.remove()
        else:
            taken = box.x1 + box.height / 2


def _name_row(ax: Axes, y: float, row: str, own: Sequence[OutcomeInterval]) -> Text:
    """Write an outcome with its intervals above its bar, at the left edge of the axes."""
    box = ax.get_window_extent()
    letters = int(box.width / sheet.root(ax).dpi * 25.4 / _LETTER)
    spans = ", ".join(map(_span, own))
    spans = f"   {spans}" if len(spans) < letters / 2 else ""
    name = shortened(row, max(8, letters - len(spans)))
    look = {"va": "bottom", "zorder": 6, "gid": "outcome"}
    text = ax.text(ax.get_xlim()[0], y, literal(name) + minus(spans), **look)
    text.set_bbox(style.on_white(0.05, 1.0))
    return text


def _place_beside(
    ax: Axes, text: Text, ends: Sequence[tuple[float, float]], runs: Sequence[OutcomeInterval]
) -> None:
    """Move a text to an end of its intervals where it crosses no boundary, if there is one."""
    (low, high), box = ax.get_xlim(), ax.get_window_extent()
    per_mm = (high - low) * sheet.root(ax).dpi / 25.4 / box.width
    wide = text.get_window_extent().width / box.width * (high - low)
    lines = [end for run in runs for end in _ends(run)]
    places = [left + (left > low + per_mm) * per_mm for left, _ in ends]
    places += [right + per_mm for _, right in ends]
    places += [left - per_mm - wide for left, _ in ends]
    places = [min(max(at, low), high - wide) for at in places]
    free = [at for at in places if not any(at < line < at + wide for line in lines[1:-1])]
    text.set_x((free or places)[0])
