"""Measured unit cells and two-cell mechanisms beside their model."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from stepwell.base import Floats, InputError
from stepwell.figures.common import legends, marks, sheet, style
from stepwell.figures.common.marks import mm_pair
from stepwell.figures.common.words import literal
from stepwell.lab import CellTest, PairTest

T = TypeVar("T")

_POINTS = 16
# A row of the key with its surroundings, one more, and an entry [mm].
_KEY, _ROW, _ENTRY = 8.0, 3.8, 33.0
# One look for each number of bands: colour and mark say the same.
_LOOKS = ((style.BLUE, "o"), (style.VERMILLION, "^"), (style.GREEN, "s"))
_MEASURED = 2.6
_MODEL: dict[str, Any] = {"color": style.INK, "linewidth": 0.8, "linestyle": (0, (4, 3))}


@style.styled
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

    def measured(test: CellTest) -> Floats:
        return test.plain.force / test.series.scale

    def model(test: CellTest) -> Floats:
        return test.model / test.series.scale

    return _cells(tests, measured, model, "Force $F/(kr)$")


@style.styled
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

    def measured(test: CellTest) -> Floats:
        return test.plain.energy / (test.series.scale * test.cell.lever)

    def model(test: CellTest) -> Floats:
        energy = test.cell.energy(test.plain.theta)
        return (energy - energy[0]) / (test.series.scale * test.cell.lever)

    return _cells(tests, measured, model, "Energy $E/(kr^2)$")


@style.styled
def measured_pairs(tests: Sequence[PairTest]) -> Figure:
    """Actuator force of measured pairs against stroke, the model as a line, snaps marked.

    Args:
        tests: one or more, a panel each.

    Returns:
        A figure of a page's width: the measured mean with its baseline subtracted (blue loading,
        vermillion unloading), faint where it is not judged; triangles where runs snap, above the
        axis, and where the model does, below.

    Raises:
        ValueError: nothing to show.

    Source: after Kamp et al. 2024, Fig. 2D to 2G.
    """
    if not tests:
        raise InputError("tests is empty: give one pair or more.")
    looks = {
        True: ("measured, unloading", style.UNLOADING),
        False: ("measured, loading", style.LOADING),
    }
    occur = dict.fromkeys(test.series.unloading for test in tests)
    handles = [legends.line(*looks[unloading], _MEASURED) for unloading in occur]
    handles.append(Line2D([], [], **_MODEL, label="model"))
    handles.append(legends.mark("run snaps", "v", 4.0, color=style.FAINT))
    handles.append(legends.mark("model snaps", "^", **style.hollow(4.0)))
    sizes = (2, 52.0, 15.0, 19.0, 17.0)
    return _panels(tests, _pair, sizes, handles, "Stroke $u$ [mm]", "Actuator force [N]")


def _cells(
    tests: Sequence[CellTest],
    measured: Callable[[CellTest], Floats],
    model: Callable[[CellTest], Floats],
    label: str,
) -> Figure:
    if not tests:
        raise InputError("tests is empty: give one unit cell or more.")
    groups: dict[tuple[str, bool], list[CellTest]] = {}
    for test in tests:
        groups.setdefault((test.series.code, test.series.unloading), []).append(test)

    def draw(ax: Axes, group: list[CellTest]) -> None:
        _cell(ax, group, measured, model)

    handles: list[Artist] = [legends.line("model")]
    for count in sorted({test.series.bands for test in tests}):
        colour, mark = _LOOKS[(count - 1) % len(_LOOKS)]
        handles.append(legends.mark(bands_words(count), mark, 3.2, color=colour))
    handles.append(legends.mark("extrapolated to the stop", **style.hollow(3.2)))
    sizes = (3, 50.0, 16.0, 18.5, 16.0)
    return _panels(list(groups.values()), draw, sizes, handles, "Lever angle $\\theta$ [°]", label)


def _panels(
    shown: Sequence[T],
    draw: Callable[[Axes, T], None],
    sizes: tuple[int, float, float, float, float],
    handles: Sequence[Artist],
    xlabel: str,
    ylabel: str,
) -> Figure:
    """Panels in rows under room for a legend.

    Args:
        shown: what is in each panel.
        draw: draws one of them.
        sizes: how many a row of a page has, and in mm the height of a row, the left margin of a
            panel and how much smaller its axes are than the panel.
        handles: of the legend.
        xlabel, ylabel: below the lowest and left of the first panels.
    """
    most, tall, left, narrower, lower = sizes
    page = sheet.page_width(style.PAGE)
    columns = max(1, round(most * page / style.PAGE))
    rows = math.ceil(len(shown) / columns)
    wide = page / columns
    beside, below = legends.laid(len(handles), page - left, _ENTRY)
    figure = sheet.blank(page, rows * tall + _KEY + _ROW * (below - 1))
    legends.on_top(figure, handles, left, 2.0, columns=beside)
    for k, one in enumerate(shown):
        row, column = divmod(k, columns)
        bottom = (rows - 1 - row) * tall + 10.0
        ax = sheet.place(figure, column * wide + left, bottom, wide - narrower, tall - lower)
        draw(ax, one)
        if row == rows - 1 or k + columns >= len(shown):
            ax.set_xlabel(xlabel)
        if column == 0:
            ax.set_ylabel(ylabel)
    return figure


def _cell(
    ax: Axes,
    group: list[CellTest],
    measured: Callable[[CellTest], Floats],
    model: Callable[[CellTest], Floats],
) -> None:
    marks.zero_line(ax)
    for test in group:
        colour, mark = _LOOKS[(test.series.bands - 1) % len(_LOOKS)]
        theta, values = np.degrees(test.plain.theta), measured(test)
        at = np.linspace(0, len(theta) - 1, _POINTS).astype(int)
        seen = test.plain.inside[at]
        look = {"markersize": 3.2, "markeredgewidth": 0.8, "color": colour, "zorder": 4}
        for some, gid, face in ((seen, "measured", colour), (~seen, "extrapolated", "white")):
            k = at[some]
            ax.plot(theta[k], values[k], mark, **look, markerfacecolor=face, gid=gid)
    # In k r all numbers of bands have one model.
    first = group[0]
    ax.plot(np.degrees(first.plain.theta), model(first), color=style.INK, gid="model")
    widest = math.degrees(first.cell.limit)
    ax.set_xlim(-1.08 * widest, 1.08 * widest)
    ax.set_xticks([-widest, 0, widest])
    ax.margins(y=0.1)
    way = ", unloading" if first.series.unloading else ""
    place_of = mm_pair(first.cell.bands[0].d)
    sheet.name_panel(ax, f"{literal(first.series.code)}{way}, $d$ = {place_of} mm")


def _pair(ax: Axes, test: PairTest) -> None:
    colour = style.UNLOADING if test.series.unloading else style.LOADING
    u = test.stroke * style.MM
    marks.zero_line(ax)
    # Where the model is right it lies on the measurement, which is wide enough to be seen below.
    wide = {"linewidth": _MEASURED, "solid_capstyle": "butt"}
    ax.plot(u, test.force, color=style.pale(colour), **wide, gid="not judged")
    ax.plot(u, np.where(test.inside, test.force, np.nan), color=colour, **wide, gid="measured")
    ax.plot(u, test.model, **_MODEL, gid="model")
    low, high = ax.get_ylim()
    span = high - low
    ax.set_ylim(low - 0.12 * span, high + 0.12 * span)
    seen = [style.MM * snap for snaps in test.snaps for snap in snaps]
    wanted = [style.MM * snap for snap in test.snaps_predicted]
    above, below = [high + 0.06 * span] * len(seen), [low - 0.06 * span] * len(wanted)
    ax.plot(seen, above, "v", color=colour, markersize=4.0, zorder=5, gid="snaps")
    ax.plot(wanted, below, "^", **style.hollow(4.0), zorder=5, gid="snaps predicted")
    mechanism = test.series.name.removesuffix(", loading").removesuffix(", unloading")
    order = "tie" if test.tie else " then ".join(test.series.chain.names[c] for c in test.shown)
    sheet.name_panel(ax, literal(f"{mechanism}: {order}"))


def bands_words(count: int) -> str:
    """How many bands a cell has."""
    return "1 band" if count == 1 else f"{count} bands"
