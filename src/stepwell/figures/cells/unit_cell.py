"""Force and energy of single cells against lever angle."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from stepwell.base import InputError
from stepwell.figures.common import (
    COLUMN,
    INK,
    MM,
    canvas,
    cell_colours,
    keep_inside,
    literal,
    marks as _marks,
    styled,
)
from stepwell.mechanism import Cell

Array = NDArray[np.float64]
Curve = Callable[[Cell, Array], Array]

_SAMPLES = 181
_END_0, _END_1, _PEAK = "<", ">", "D"


@styled
def unit_cell_force(cells: Sequence[Cell], *, ax: Axes | None = None) -> Figure:
    """F/(k r) of each cell against lever angle, with F0, F1 and θmax marked.

    k is the stiffness of the cell's stiffest band.

    Args:
        cells: any number; the legend calls each by its name, or else by its anchor.
        ax: axes to draw into; a new figure of one column's width by default.

    Source: Kamp et al. 2024, Fig. 1D.
    """

    def scaled(cell: Cell, theta: Array) -> Array:
        return cell.force(theta) / (_stiffness(cell) * cell.lever)

    own = ax is None
    figure, ax = _curves(cells, scaled, ax, ends=True)
    _marks.zero_line(ax)
    ax.set_ylabel("Force $F/(kr)$")
    if own:
        keep_inside(ax)
    return figure


@styled
def unit_cell_energy(cells: Sequence[Cell], *, ax: Axes | None = None) -> Figure:
    """E/(k r²) of each cell against lever angle, with θmax marked.

    k is the stiffness of the cell's stiffest band.

    Args:
        cells: any number; the legend calls each by its name, or else by its anchor.
        ax: axes to draw into; a new figure of one column's width by default.

    Source: Kamp et al. 2024, Fig. 1E.
    """

    def scaled(cell: Cell, theta: Array) -> Array:
        return cell.energy(theta) / (_stiffness(cell) * cell.lever**2)

    own = ax is None
    figure, ax = _curves(cells, scaled, ax, ends=False)
    ax.set_ylabel("Energy $E/(kr^2)$")
    if own:
        keep_inside(ax)
    return figure


def _curves(
    cells: Sequence[Cell], curve: Curve, ax: Axes | None, *, ends: bool
) -> tuple[Figure, Axes]:
    if not cells:
        raise InputError("cells is empty: give one cell or more.")
    # Names in rows of two, the marks in a row of their own.
    rows = math.ceil(len(cells) / 2)
    top = 6.5 + 3.6 * rows
    figure, ax = canvas(ax, (COLUMN, 62.0 + top), (13.0, 10.0, 2.0, top))
    named = _names(cells)
    for cell, colour in zip(cells, cell_colours(len(cells)), strict=True):
        theta = np.linspace(-cell.limit, cell.limit, _SAMPLES)
        ax.plot(np.degrees(theta), curve(cell, theta), color=colour)
        if ends:
            for end, mark in ((theta[:1], _END_0), (theta[-1:], _END_1)):
                _mark(ax, end, curve(cell, end), mark, colour, f"end {mark}")
        if abs(cell.peak_angle) < cell.limit:
            peak = np.array([cell.peak_angle])
            _mark(ax, peak, curve(cell, peak), _PEAK, colour, "peak")
    ax.set_xlabel("Lever angle $\\theta$ [°]")
    widest = math.degrees(max(cell.limit for cell in cells))
    ax.set_xlim(-1.08 * widest, 1.08 * widest)
    ax.set_xticks(np.linspace(-widest, widest, 7) if widest % 3 == 0 else [-widest, 0, widest])
    marks = [_key(_END_0, "$F_0$"), _key(_END_1, "$F_1$")] if ends else []
    marks.append(_key(_PEAK, "$\\theta_\\mathrm{max}$"))
    lower = ax.legend(handles=marks, loc="lower left", bbox_to_anchor=(0.0, 1.02), ncols=3)
    ax.add_artist(lower)
    above = lower.get_window_extent().transformed(ax.transAxes.inverted()).y1 + 0.01
    handles = [
        Line2D([], [], color=colour, label=name)
        for colour, name in zip(cell_colours(len(cells)), named, strict=True)
    ]
    ax.legend(handles=handles, loc="lower left", bbox_to_anchor=(0.0, above), ncols=2)
    return figure, ax


def _mark(ax: Axes, theta: Array, value: Array, mark: str, colour: str, gid: str) -> None:
    ax.plot(
        np.degrees(theta),
        value,
        mark,
        markersize=4.0,
        markerfacecolor="white" if mark == _PEAK else colour,
        markeredgecolor=colour,
        zorder=4,
        clip_on=False,
        gid=gid,
    )


def _key(mark: str, label: str) -> Line2D:
    return Line2D(
        [],
        [],
        linestyle="none",
        marker=mark,
        markersize=4.0,
        color=INK,
        markerfacecolor="white" if mark == _PEAK else INK,
        label=label,
    )


def _stiffness(cell: Cell) -> float:
    return max(band.stiffness for band in cell.bands)


def _names(cells: Sequence[Cell]) -> list[str]:
    same_p = len({cell.bands[0].p for cell in cells}) == 1
    found: list[str] = []
    for i, cell in enumerate(cells):
        band = cell.bands[0]
        x, y = band.q if same_p else band.d
        anchor = f"${'q' if same_p else 'd'}$ = ({_mm(x)}, {_mm(y)}) mm"
        told = anchor if len(cell.bands) == 1 else f"cell {i + 1}"
        found.append(literal(cell.name) if cell.name else told)
    return found


def _mm(metres: float) -> str:
    return f"{round(metres * MM, 3) + 0.0:g}".replace("-", "\N{MINUS SIGN}")
