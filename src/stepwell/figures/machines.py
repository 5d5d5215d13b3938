"""The machines of an atlas: what they do, side by side, and how often and how surely."""

from __future__ import annotations

from dataclasses import replace
from math import comb
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from stepwell.base import InputError, number
from stepwell.figures.common import sheet, style
from stepwell.figures.graphs import small_graph
from stepwell.mechanism import Cell

if TYPE_CHECKING:
    from stepwell.mechanism import Chain
    from stepwell.studies import Atlas, Machine

# What a graph needs at least, by how many cells it has [mm].
_WIDTHS = {1: 36.0, 2: 40.0, 3: 52.0, 4: 80.0}
# Graphs at most; entries of the key at most, and what one takes [mm].
_GRAPHS, _ENTRIES, _ENTRY, _LINE = 12, 7, 42.0, 3.9
_EDGE, _HEAD, _GAP = 2.0, 8.0, 4.0
# Of a state in the fullest column [mm].
_STATE = 8.5
_LEFT, _RIGHT, _BOTTOM, _TALL, _BETWEEN = 17.0, 4.0, 11.0, 26.0, 4.5


@style.styled
def machines(found: Atlas, most: int = _GRAPHS) -> Figure:
    """The most frequent machines of an atlas as graphs, and the share and yield of all.

    Args:
        found: of at most 4 cells.
        most: graphs that are drawn.

    Returns:
        A figure of two columns' width. Cells are numbered as they load, and states stand at one
        place in all graphs; below, all machines by their share of the designs with its 95 %
        interval, and how many built after their most robust design do the same.

    Raises:
        ValueError: more cells, or an atlas without a machine.
    """
    count = len(found.chain)
    if count not in _WIDTHS:
        raise InputError(
            f"the atlas has {count} cells: graphs of at most {max(_WIDTHS)} can be read side by "
            "side."
        )
    if not found.machines:
        raise InputError("the atlas holds no machine yet: build more designs.")
    shown = found.machines[: max(1, most)]
    page = sheet.page_width(style.PAGE)
    room = int((page - 2 * _EDGE + _GAP) / (_WIDTHS[count] + _GAP))
    beside = max(1, min(len(shown), room))
    rows = -(-len(shown) // beside)
    wide = (page - 2 * _EDGE - (beside - 1) * _GAP) / beside
    # A state for every subset: the fullest column has those of half of the cells.
    tall = 6.0 + _STATE * comb(count, count // 2)
    foot = _BOTTOM + 2 * _TALL + _BETWEEN + 4.0
    columns = max(1, int(page / _ENTRY))
    key_high = _LINE * -(-_ENTRIES // columns) + 1.5
    high = foot + key_high + rows * (_HEAD + tall + _GAP)
    figure = sheet.blank(page, high)
    key: dict[str, Artist] = {}
    for k, one in enumerate(shown):
        row, column = divmod(k, beside)
        left = _EDGE + column * (wide + _GAP)
        bottom = foot + key_high + (rows - 1 - row) * (_HEAD + tall + _GAP)
        ax = sheet.place(figure, left, bottom, wide, tall)
        graph = _as_it_loads(one.chain).graph("force" if found.drive == "force" else None)
        key |= {str(each.get_label()): each for each in small_graph(graph, ax, wide, tall)}
        _head(figure, left + 1.0, bottom + tall, k + 1, one)
    _tell(figure, found, len(shown), page)
    handles = list(key.values())
    figure.legend(
        handles=handles, ncols=columns, loc="upper left",
        bbox_to_anchor=((_EDGE + 1.0) / page, (foot + key_high - 1.0) / high),
    )  # fmt: skip
    return figure


def _as_it_loads(chain: Chain) -> Chain:
    """The same cells in the order in which they load.

    Cells in series share one force, so their places decide nothing; concave ones, and an atlas has
    no others, load in the order of their forces at 0.
    """
    cells = [cell for cell in chain.cells if isinstance(cell, Cell)]
    return replace(chain, cells=tuple(sorted(cells, key=lambda cell: cell.force_0)))


def _head(figure: Figure, x: float, y: float, place: int, one: Machine) -> None:
    """The number of a machine, how often it comes, how surely it is built, what it remembers."""
    sheet.text_at(figure, x, y + 3.4, f"{place}", fontweight="bold", fontsize=8.0)
    share = f"{number(one.share.share * 100)} % of designs"
    sheet.text_at(figure, x + 5.5, y + 3.4, share, fontweight="bold", fontsize=8.0, gid="share")
    grey = {"color": "#5A5A5A", "gid": "name"}
    text = f"{one.name}, yield {number(one.kept.share * 100)} %"
    sheet.text_at(figure, x + 5.5, y, text, **grey)
    sheet.text_at(figure, x + 5.5, y - 3.1, one.memory, **grey)


def _tell(figure: Figure, found: Atlas, shown: int, page: float) -> None:
    """Shares and yields of all machines, most frequent first."""
    wide = page - _LEFT - _RIGHT
    upper = sheet.place(figure, _LEFT, _BOTTOM + _TALL + _BETWEEN, wide, _TALL)
    lower = sheet.place(figure, _LEFT, _BOTTOM, wide, _TALL)
    ranks = np.arange(1, len(found.machines) + 1)
    for ax, colour, shares in (
        (upper, style.BLUE, [one.share for one in found.machines]),
        (lower, style.GREEN, [one.kept for one in found.machines]),
    ):
        ends = np.array([[each.low, each.high] for each in shares]) * 100.0
        values = np.array([each.share for each in shares]) * 100.0
        ax.vlines(ranks, *ends.T, color=colour, linewidth=1.0)
        ax.plot(ranks, values, "o", color=colour, markersize=3.2, markeredgewidth=0, gid="machines")
        ax.set_xlim(0.3, len(ranks) + 0.7)
        _drawn_end(ax, shown, len(ranks))
    upper.set_yscale("log")
    upper.yaxis.set_major_locator(LogLocator(numticks=8))
    upper.yaxis.set_major_formatter(FuncFormatter(lambda value, _: number(value)))
    upper.yaxis.set_minor_formatter(NullFormatter())
    upper.set_ylabel("Designs [%]")
    upper.tick_params(axis="x", labelbottom=False)
    lower.set(ylabel="Yield [%]", ylim=(-4.0, 104.0))
    lower.set_xlabel("Machine, most frequent first")
    if len(ranks) < 20:
        lower.set_xticks(ranks)
    upper.set_xticks(lower.get_xticks())
    upper.set_xlim(*lower.get_xlim())


def _drawn_end(ax: Axes, shown: int, count: int) -> None:
    """Where the machines end that are drawn above."""
    if shown < count:
        ax.axvline(shown + 0.5, color=style.FAINT, linewidth=0.7, linestyle=(0, (2.0, 2.0)))
