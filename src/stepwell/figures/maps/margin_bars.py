"""How far a design is from doing something else, change by change."""

from __future__ import annotations

import math

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepwell.design import Change, Margin
from stepwell.figures.common import (
    FAINT,
    MM,
    PAGE,
    blank,
    cell_colours,
    literal,
    name_rows,
    place,
    shortened,
    styled,
    text_at,
)

_ROW, _HEAD, _FOOT, _NAMES, _GAP = 5.0, 7.0, 11.0, 34.0, 8.0
_MOST = 24  # bars in a panel
_PERCENT = 100.0


@styled
def margin_bars(result: Margin) -> Figure:
    """The smallest change of each thing that gives another sequence, the nearest on top.

    Args:
        result: what `Chain.margin` returns.

    Returns:
        A figure of two columns' width: at the left displacements of anchors [mm], at the right
        changes of numbers [%], as far as there are any. Where nothing was found, a pale bar goes
        on past the axes. Of more than 24 changes in a panel the nearest 24 are shown.
    """
    places = [one for one in result.changes if one.parameter == "anchor"]
    numbers = [one for one in result.changes if one.parameter != "anchor"]
    panels = [(places, "Displacement of the anchor [mm]", MM)] if places else []
    panels += [(numbers, "Change [%]", _PERCENT)] if numbers else []
    tall = _ROW * max(min(len(changes), _MOST) for changes, _, _ in panels)
    figure = blank(PAGE, _HEAD + tall + _FOOT)
    wide = PAGE / 2
    for k, (changes, label, factor) in enumerate(panels):
        near = sorted(changes, key=lambda one: one.distance)[:_MOST]
        high = _ROW * len(near)
        bottom = _FOOT + tall - high
        ax = place(figure, k * wide + _NAMES, bottom, wide - _NAMES - _GAP, high)
        _bars(ax, result, near, factor)
        ax.set_xlabel(label)
    told = "exact" if result.method == "exact" else "searched, not exact"
    text = f"Smallest change that gives another sequence ({told})"
    text_at(figure, 2.0, _FOOT + tall + 2.0, text, weight="bold")
    return figure


def _bars(ax: Axes, result: Margin, changes: list[Change], factor: float) -> None:
    names, colours = result.chain.names, cell_colours(len(result.chain))
    found = [one.distance * factor for one in changes if math.isfinite(one.distance)]
    most = 1.25 * max(found, default=result.reach * factor)
    ax.set_xlim(0.0, most or 1.0)
    for row, one in enumerate(changes):
        finite = math.isfinite(one.distance)
        length = one.distance * factor if finite else 2.0 * most
        ax.barh(
            row,
            length,
            0.62,
            color=colours[one.cell] if finite else FAINT,
            alpha=1 if finite else 0.3,
        )
        text = f" {length:.3g}" if finite else " none within reach"
        ax.text(length if finite else 0.0, row, text, va="center", ha="left")
    words = [
        literal(shortened(names[one.cell], 14))
        + ("" if one.parameter == "anchor" else f", {one.parameter.replace('_', ' ')}")
        for one in changes
    ]
    name_rows(ax, words)
