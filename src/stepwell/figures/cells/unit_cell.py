"""Force and energy of single cells against lever angle."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepwell.base import Floats, InputError
from stepwell.figures.common import (
    COLUMN,
    INK,
    canvas,
    cell_colours,
    cell_dashes,
    hollow,
    keep_inside,
    legends,
    literal,
    marks,
    mm_pair,
    page_width,
    sheet_of,
    styled,
)
from stepwell.mechanism import Cell, Element

Curve = Callable[[Cell, Floats], Floats]

_SAMPLES = 181
# Narrower than this, names do not stand in two columns; between names and marks [mm].
_TWO, _BETWEEN = 70.0, 0.3
_END_0, _END_1, _PEAK = "<", ">", "D"
_GIDS = {_END_0: "end <", _END_1: "end >", _PEAK: "peak"}


@styled
def unit_cell_force(cells: Sequence[Cell | Element], *, ax: Axes | None = None) -> Figure:
    """F/(k r) of each cell against lever angle, with F0, F1 and θmax marked.

    k is the stiffness of the cell's stiffest band.

    Args:
        cells: any number; the legend calls each by its name, or else by its anchor.
        ax: axes to draw into; a new figure of one column's width by default.

    Raises:
        ValueError: no cells, or an element among them: see `element_curve`.

    Source: Kamp et al. 2024, Fig. 1D.
    """

    def scaled(cell: Cell, theta: Floats) -> Floats:
        return cell.force(theta) / (_stiffness(cell) * cell.lever)

    return _curves(cells, scaled, ax, "Force $F/(kr)$", ends=True)


@styled
def unit_cell_energy(cells: Sequence[Cell | Element], *, ax: Axes | None = None) -> Figure:
    """E/(k r²) of each cell against lever angle, with θmax marked.

    k is the stiffness of the cell's stiffest band.

    Args:
        cells: any number; the legend calls each by its name, or else by its anchor.
        ax: axes to draw into; a new figure of one column's width by default.

    Raises:
        ValueError: no cells, or an element among them: see `element_curve`.

    Source: Kamp et al. 2024, Fig. 1E.
    """

    def scaled(cell: Cell, theta: Floats) -> Floats:
        return cell.energy(theta) / (_stiffness(cell) * cell.lever**2)

    return _curves(cells, scaled, ax, "Energy $E/(kr^2)$", ends=False)


def _curves(
    cells: Sequence[Cell | Element], curve: Curve, ax: Axes | None, label: str, *, ends: bool
) -> Figure:
    if not cells:
        raise InputError("cells is empty: give one cell or more.")
    levers = [cell for cell in cells if isinstance(cell, Cell)]
    if len(levers) < len(cells):
        first = next(i for i, cell in enumerate(cells) if isinstance(cell, Element))
        raise InputError(
            f"cells[{first}] is an Element, which has no lever angle: draw it with element_curve."
        )
    # Names beside each other where there is room, the marks in a row of their own.
    columns = 2 if page_width(COLUMN) >= _TWO else 1
    rows = math.ceil(len(levers) / columns)
    top = 8.0 + 3.75 * rows
    own = ax is None
    figure, ax = canvas(ax, (COLUMN, 62.0 + top), (13.0, 10.0, 2.0, top))
    looks = list(zip(cell_colours(len(levers)), cell_dashes(len(levers)), strict=True))
    for cell, (colour, dashes) in zip(levers, looks, strict=True):
        theta = np.linspace(-cell.limit, cell.limit, _SAMPLES)
        ax.plot(np.degrees(theta), curve(cell, theta), color=colour, linestyle=dashes)
        shown = [(-cell.limit, _END_0), (cell.limit, _END_1)] if ends else []
        if abs(cell.peak_angle) < cell.limit:
            shown.append((cell.peak_angle, _PEAK))
        for angle, mark in shown:
            at = np.array([angle])
            look = _look(mark, colour) | {"clip_on": False, "gid": _GIDS[mark]}
            ax.plot(np.degrees(at), curve(cell, at), mark, zorder=4, **look)
    if ends:
        marks.zero_line(ax)
    ax.set(xlabel="Lever angle $\\theta$ [°]", ylabel=label)
    widest = math.degrees(max(cell.limit for cell in levers))
    ax.set_xlim(-1.08 * widest, 1.08 * widest)
    ax.set_xticks(np.linspace(-widest, widest, 7) if widest % 3 == 0 else [-widest, 0, widest])
    words = {_END_0: "$F_0$", _END_1: "$F_1$", _PEAK: "$\\theta_\\mathrm{max}$"}
    legends.above(
        ax,
        [
            legends.mark(word, mark, **_look(mark, INK))
            for mark, word in words.items()
            if ends or mark == _PEAK
        ],
    )
    lower = ax.get_legend()
    assert lower is not None
    ax.add_artist(lower)
    # In mm, for the axes may have to make room for more rows.
    high = lower.get_window_extent().y1 - ax.get_window_extent().y1
    over = 25.4 * high / sheet_of(ax).dpi + _BETWEEN
    handles = [
        legends.line(name, colour, linestyle=dashes)
        for name, (colour, dashes) in zip(_names(levers), looks, strict=True)
    ]
    legends.above(ax, handles, columns, lift=over, handlelength=2.6)
    if own:
        keep_inside(ax)
    return figure


def _look(mark: str, colour: str) -> dict[str, Any]:
    if mark == _PEAK:
        return hollow(4.0, colour, color=colour)
    return {"markersize": 4.0, "color": colour}


def _stiffness(cell: Cell) -> float:
    return max(band.stiffness for band in cell.bands)


def _names(cells: Sequence[Cell]) -> list[str]:
    same_p = len({cell.bands[0].p for cell in cells}) == 1
    found: list[str] = []
    for i, cell in enumerate(cells):
        band = cell.bands[0]
        anchor = f"${'q' if same_p else 'd'}$ = {mm_pair(band.q if same_p else band.d)} mm"
        unnamed = anchor if len(cell.bands) == 1 else f"cell {i + 1}"
        found.append(literal(cell.name) if cell.name else unnamed)
    return found
