"""Measured unit cells beside their model: force and energy against lever angle."""

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
    BLUE,
    GREEN,
    INK,
    PAGE,
    VERMILLION,
    blank,
    literal,
    marks,
    name_panel,
    place,
    styled,
)
from stepwell.lab import CellTest

Array = NDArray[np.float64]

_COLUMNS = 3
_POINTS = 16
# One look for each number of bands: colour and mark say the same.
_LOOKS = ((BLUE, "o"), (VERMILLION, "^"), (GREEN, "s"))


@styled
def measured_forces(tests: Sequence[CellTest]) -> Figure:
    """F/(k r) of measured unit cells against lever angle, the model as a line.

    Args:
        tests: one or more; those of one configuration share a panel.

    Returns:
        A figure of a page's width: points where the force was measured, hollow where it is
        extrapolated to a stop. k is that of all bands of a cell.

    Raises:
        ValueError: nothing to show.

    Source: after Kamp et al. 2024, Fig. 1D.
    """

    def measured(test: CellTest) -> Array:
        return test.plain.force / test.series.scale

    def model(test: CellTest) -> Array:
        return test.model / test.series.scale

    return _panels(tests, measured, model, "Force $F/(kr)$")


@styled
def measured_energies(tests: Sequence[CellTest]) -> Figure:
    """E/(k r²) of measured unit cells from state 0 on against lever angle, the model as a line.

    Args:
        tests: one or more; those of one configuration share a panel.

    Returns:
        A figure of a page's width; k is that of all bands of a cell.

    Raises:
        ValueError: nothing to show.

    Source: after Kamp et al. 2024, Fig. 1E.
    """

    def measured(test: CellTest) -> Array:
        return test.plain.energy / (test.series.scale * test.cell.lever)

    def model(test: CellTest) -> Array:
        energy = test.cell.energy(test.plain.theta)
        return (energy - energy[0]) / (test.series.scale * test.cell.lever)

    return _panels(tests, measured, model, "Energy $E/(kr^2)$")


def _panels(
    tests: Sequence[CellTest],
    measured: Callable[[CellTest], Array],
    model: Callable[[CellTest], Array],
    label: str,
) -> Figure:
    if not tests:
        raise InputError("tests is empty: give one unit cell or more.")
    groups: dict[tuple[str, bool], list[CellTest]] = {}
    for test in tests:
        groups.setdefault((test.series.code, test.series.unloading), []).append(test)
    rows = math.ceil(len(groups) / _COLUMNS)
    wide, tall, key = PAGE / _COLUMNS, 50.0, 8.0
    height = rows * tall + key
    figure = blank(PAGE, height)
    for k, ((code, unloading), group) in enumerate(groups.items()):
        row, column = divmod(k, _COLUMNS)
        bottom = (rows - 1 - row) * tall + 10.0
        ax = place(figure, column * wide + 16.0, bottom, wide - 18.5, tall - 16.0)
        _panel(ax, group, measured, model)
        dx, dy = (1e3 * x for x in group[0].cell.bands[0].d)
        way = ", unloading" if unloading else ""
        name_panel(ax, f"{literal(code)}{way}, $d$ = ({_mm(dx)}, {_mm(dy)}) mm")
        if row == rows - 1 or k + _COLUMNS >= len(groups):
            ax.set_xlabel("Lever angle $\\theta$ [°]")
        if column == 0:
            ax.set_ylabel(label)
    _legend(figure, sorted({test.series.bands for test in tests}), height)
    return figure


def _panel(
    ax: Axes,
    group: list[CellTest],
    measured: Callable[[CellTest], Array],
    model: Callable[[CellTest], Array],
) -> None:
    marks.zero_line(ax)
    for test in group:
        colour, mark = _LOOKS[(test.series.bands - 1) % len(_LOOKS)]
        theta, values = np.degrees(test.plain.theta), measured(test)
        at = np.linspace(0, len(theta) - 1, _POINTS).astype(int)
        seen = test.plain.inside[at]
        style = {"linestyle": "none", "markersize": 3.2, "markeredgewidth": 0.8, "zorder": 4}
        ax.plot(theta[at[seen]], values[at[seen]], mark, color=colour, gid="measured", **style)
        ax.plot(
            theta[at[~seen]],
            values[at[~seen]],
            mark,
            color=colour,
            markerfacecolor="white",
            gid="extrapolated",
            **style,
        )
    # In k r all numbers of bands have one model.
    ax.plot(np.degrees(group[0].plain.theta), model(group[0]), color=INK, gid="model")
    widest = math.degrees(group[0].cell.limit)
    ax.set_xlim(-1.08 * widest, 1.08 * widest)
    ax.set_xticks([-widest, 0, widest])
    ax.margins(y=0.1)


def _legend(figure: Figure, counts: list[int], height: float) -> None:
    handles = [Line2D([], [], color=INK, label="model")]
    for count in counts:
        colour, mark = _LOOKS[(count - 1) % len(_LOOKS)]
        name = "1 band" if count == 1 else f"{count} bands"
        handles.append(
            Line2D([], [], linestyle="none", marker=mark, markersize=3.2, color=colour, label=name)
        )
    handles.append(
        Line2D(
            [],
            [],
            linestyle="none",
            marker="o",
            markersize=3.2,
            color=INK,
            markerfacecolor="white",
            label="extrapolated to the stop",
        )
    )
    figure.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=(16.0 / PAGE, 1.0 - 2.0 / height),
        ncols=len(handles),
    )


def _mm(value: float) -> str:
    return f"{round(value, 3) + 0.0:g}".replace("-", "\N{MINUS SIGN}")
