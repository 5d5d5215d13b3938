"""Several cycles on one page, to be compared."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from stepwell.base import InputError
from stepwell.figures.common import (
    PAGE,
    blank,
    keep_inside,
    legends,
    literal,
    name_panel,
    place,
    styled,
    text_at,
)
from stepwell.figures.motion.force_stroke import force_stroke
from stepwell.figures.motion.landscape import landscape
from stepwell.figures.motion.travel_stroke import travel_stroke

if TYPE_CHECKING:
    from stepwell.sequences import Cycle

_ENERGY_KEY = "Darker: lower energy. Thin diagonals: equal stroke, along which snaps run."


@styled
def landscapes(cycles: Mapping[str, Cycle]) -> Figure:
    """The energy landscapes of several two-cell chains, each with its path, three in a row.

    Every panel has its own range of energies; `landscape` has a colour bar.

    Args:
        cycles: what to show, by the name to write above it.

    Raises:
        ValueError: nothing to show, or a chain that has not exactly two cells.
    """
    _refuse_none(cycles)
    side, wide, tall, key = 43.0, PAGE / 3, 62.0, 7.0
    rows = -(-len(cycles) // 3)
    height = rows * tall + key
    figure = blank(PAGE, height)
    for k, (name, cycle) in enumerate(cycles.items()):
        row, column = divmod(k, 3)
        left, bottom = column * wide + 13.0, (rows - 1 - row) * tall + 11.0 + key
        ax = place(figure, left, bottom, side, side)
        landscape(cycle, ax=ax)
        name_panel(ax, literal(name))
    # One legend for all, below them: the one that explains most.
    keys = [key for ax in figure.axes if (key := ax.get_legend())]
    for key in keys:
        key.remove()
    fullest = max(keys, key=lambda key: len(key.get_texts()))
    handles = [handle for handle in fullest.legend_handles if handle is not None]
    for handle, text in zip(handles, fullest.get_texts(), strict=True):
        handle.set_label(text.get_text())
    shown = legends.below(figure, handles, 3, 13.0)
    right = shown.get_window_extent().x1 / figure.bbox.width * PAGE + 4.0
    text_at(figure, right, 1.5, _ENERGY_KEY)
    return figure


@styled
def strokes(cycles: Mapping[str, Cycle]) -> Figure:
    """Force and travels against stroke of several chains, a row for each.

    Args:
        cycles: what to show, by the name to write above it.

    Raises:
        ValueError: nothing to show.
    """
    _refuse_none(cycles)
    body, tall = 46.0, 69.0
    figure = blank(PAGE, len(cycles) * tall)
    for k, (name, cycle) in enumerate(cycles.items()):
        bottom = (len(cycles) - 1 - k) * tall + 11.0
        force = place(figure, 15.0, bottom, 70.0, body)
        force_stroke(cycle, ax=force)
        # Above the legend.
        name_panel(force, literal(name), 6.0)
        travel = place(figure, 104.0, bottom, 72.0, body)
        travel_stroke(cycle, ax=travel)
        keep_inside(travel)
    return figure


def _refuse_none(cycles: Mapping[str, Cycle]) -> None:
    if not cycles:
        raise InputError("cycles is empty: give one cycle or more, by name.")
