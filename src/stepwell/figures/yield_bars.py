"""How many built mechanisms work, what the others do, and whose tolerance counts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepwell.base import percent
from stepwell.figures.common import legends, sheet, style
from stepwell.figures.common.words import literal, sequence_words, shortened

if TYPE_CHECKING:
    from stepwell.design import Sensitivities, Yield

_OUTCOMES, _PARTS = 6, 16
# Shares below this are within the error of the estimate.
_LEAST = 0.01
# A bar, a line of text, and what a row has around them [mm].
_BAR, _LINE, _GAP = 3.0, 3.1, 2.2
_FOOT, _HEAD = 10.0, 6.0
# Characters that the line above a bar has room for, and how many such lines there may be.
_ROOM, _MOST_LINES = 48, 3


class _Outcome(NamedTuple):
    lines: list[str]
    share: float
    colour: str


@style.styled
def yield_bars(result: Yield) -> Figure:
    """The share of mechanisms that work, with its confidence interval, and what the others do.

    Args:
        result: what `design.yields` returns. With sensitivities, a second panel shows the share
            of the smallest gap's variance that each part's tolerance causes: dark by itself,
            pale together with others.

    Returns:
        The figure, one column wide, or two with sensitivities.
    """
    table = result.sensitivities
    outcomes = _outcomes(result)
    tall = sum(_BAR + _GAP + _LINE * len(one.lines) for one in outcomes)
    parts = [] if table is None or table.deviation == 0 else _parts(table)
    rows = (_BAR + _GAP) * len(parts)
    page = sheet.page_width(style.PAGE if parts else style.COLUMN)
    # Beside each other, or under each other where that is too narrow.
    beside = bool(parts) and page >= 2 * style.COLUMN
    side, start = (style.COLUMN, 0.0) if beside else (page, tall + _FOOT + _HEAD)
    body = max(tall, rows) if beside or not parts else start + rows
    height = _FOOT + body + _HEAD
    figure = sheet.blank(page, height)
    _draw_outcomes(
        sheet.place(figure, 4.0, height - _HEAD - tall, side - 9.0, tall), result, outcomes
    )
    if parts and table is not None:
        names = [table.parameters[i] for i in parts]
        first, top = (style.COLUMN, height - _HEAD) if beside else (-2.0, height - _HEAD - start)
        left = first + 8.0 + 1.6 * max(len(name) for name in names)
        ax = sheet.place(figure, left, top - rows, page - left - 5.0, rows)
        _draw_parts(ax, result, parts)
        look = {"fontweight": "bold"}
        sheet.text_at(figure, first + 6.0, top + 1.5, "Whose tolerance counts", **look)
    return figure


def _outcomes(result: Yield) -> list[_Outcome]:
    """What was wanted, then the most frequent other outcomes."""
    others = list(result.outcomes.items())
    shown = others[:_OUTCOMES]
    low, high = map(percent, result.interval)
    # On a line of its own: beside or on the bar, the interval would strike it through.
    words = f"{percent(result.share)} ({low} to {high}) as wanted"
    found = [_Outcome([*_lines(result.wanted), words], result.share, style.GREEN)]
    found += [_Outcome(_lines(text), count / result.n, style.VERMILLION) for text, count in shown]
    rest = sum(count for _, count in others[_OUTCOMES:])
    if rest:
        text = f"{len(others) - _OUTCOMES} other outcomes"
        found.append(_Outcome([text], rest / result.n, style.VERMILLION))
    return found


def _lines(text: str) -> list[str]:
    return shortened(sequence_words(text, _ROOM), _ROOM, _MOST_LINES).split("\n")


def _draw_outcomes(ax: Axes, result: Yield, outcomes: Sequence[_Outcome]) -> None:
    """A bar under the name of each outcome; the interval of the wanted one."""
    ax.set_xlim(0.0, 100.0)
    ax.set_ylim(sheet.size_of(sheet.sheet_of(ax))[1] * ax.get_position().height, 0.0)
    y = 0.0
    for k, (lines, share, colour) in enumerate(outcomes):
        for line in lines:
            weight = "bold" if k == 0 and line is lines[-1] else "normal"
            ax.text(0.0, y + _LINE / 2, literal(line), va="center_baseline", fontweight=weight)
            y += _LINE
        middle = y + _BAR / 2
        ax.barh(
            middle, 100.0 * share, _BAR, color=style.pale(colour, 0.3), linewidth=0, gid="outcomes"
        )
        if k == 0:
            ends = [100.0 * bound for bound in result.interval]
            ax.plot(ends, [middle] * 2, "|-", color=style.INK, linewidth=1.0, gid="interval")
        else:
            x = 2.0 if share > 0.5 else 100.0 * share + 2.0
            ax.text(x, middle, percent(share), va="center_baseline")
        y += _BAR + _GAP
    ax.set_yticks([])
    _bare(ax)
    ax.set_xlabel(f"Share of {result.n:,} built mechanisms [%]".replace(",", "\N{THIN SPACE}"))
    sheet.name_panel(ax, "What they do")


def _parts(table: Sensitivities) -> list[int]:
    """The parts by falling share, without those that hardly have one."""
    order = np.argsort(-np.asarray(table.total), kind="stable")[:_PARTS].tolist()
    return [i for i in order if table.total[i] >= _LEAST]


def _draw_parts(ax: Axes, result: Yield, parts: Sequence[int]) -> None:
    """What each part's tolerance contributes, by itself and together with others."""
    table = result.sensitivities
    assert table is not None
    names = result.chain.names
    tall = len(parts) * (_BAR + _GAP)
    colours = dict(zip(names, style.cell_colours(len(names)), strict=True))
    middles = [k * (_BAR + _GAP) + (_BAR + _GAP) / 2 for k in range(len(parts))]
    for middle, i in zip(middles, parts, strict=True):
        colour = colours.get(table.parameters[i].rpartition(".")[0], style.INK)
        for share, shade, gid in (
            (table.total[i], style.pale(colour), "total"),
            (table.first_order[i], colour, "first order"),
        ):
            # An index near zero may come out below it.
            ax.barh(middle, max(0.0, float(share)), _BAR, color=shade, linewidth=0, gid=gid)
    ax.set_yticks(middles, [literal(table.parameters[i]) for i in parts])
    ax.set_ylim(tall, 0.0)
    ax.set_xlim(0.0, 1.05 * max(0.05, float(np.max(table.total))))
    _bare(ax)
    ax.set_xlabel("Share of the variance of the smallest gap")
    handles = [
        legends.shade("by itself", style.INK),
        legends.shade("with others", style.pale(style.INK)),
    ]
    ax.legend(handles=handles, loc="lower right", bbox_to_anchor=(1.0, 1.0 + 1.5 / tall), ncols=2)


def _bare(ax: Axes) -> None:
    ax.spines[["top", "right", "left"]].set_visible(False)
    ax.spines.bottom.set_color(style.FAINT)
    ax.tick_params(axis="y", length=0.0)
