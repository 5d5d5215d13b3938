"""Robustness as bars: margins, yield under tolerances, and sensitivities."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepwell.base import InputError, number, percent, signed
from stepwell.design import DEFAULT_TOLERANCES, Change, Margin, Sensitivities, Tolerances, Yield
from stepwell.figures.common import legends, sheet, style
from stepwell.figures.common.words import literal, minus, sequence_words, shortened

if TYPE_CHECKING:
    from stepwell.paper import Sensitivity


# Largest number of bars per panel; longest chain with sequences at its bars.
_MOST, _SPELLED = 8, 12
# Heights of a bar and of a line of text, and the gap of two rows [mm].
_BAR, _LINE, _GAP = 2.6, 3.1, 2.0
_FOOT, _BETWEEN, _LEFT, _RIGHT = 9.0, 5.0, 4.0, 5.0
# Largest number of characters in a line above a bar, and of lines.
_ROOM, _MOST_LINES = 48, 2
# Name of each parameter, and the tolerance that applies to it.
_CHANGED = {
    "anchor": ("anchor q", "anchor"),
    "stiffness": ("stiffness", "stiffness"),
    "force_scale": ("all its {force}s", "stiffness"),
    "travel_scale": ("all its {travel}s", "travel"),
    "friction": ("friction", "friction"),
}
_OFF = style.pale(style.SKY, 0.55)


class _Row(NamedTuple):
    """A change of a parameter: text above its bar, length of the bar, and tolerance."""

    lines: list[str]
    far: float = math.inf
    off: float = 0.0

    @property
    def near(self) -> bool:
        # Whether the margin is smaller than the tolerance.
        return self.far < self.off


@style.styled
def margins(margin: Margin, tolerances: Tolerances | None = None) -> Figure:
    """Robustness margin of each parameter to another sequence, the smallest on top.

    Every anchor has a bar in mm, every other parameter a bar in %, with the sequence past its end.
    Only the smallest margins of a long chain are shown. One column wide.

    Args:
        margin: result of `design.margin`.
        tolerances: tolerances to draw in the bars; by default the usual ones.
    """
    off = tolerances or DEFAULT_TOLERANCES
    panels = (
        ("Anchor displacement [mm]", _rows(margin, True, off)),
        ("Relative change of the parameter [%]", _rows(margin, False, off)),
    )
    drawn = [(label, rows) for label, rows in panels if rows]
    every = [row for _, rows in drawn for row in rows]
    near = legends.shade("margin smaller than the tolerance", _pale(style.VERMILLION))
    handles = legends.applicable(
        (True, legends.shade("margin to another sequence", _pale(style.GREEN))),
        (any(row.near for row in every), near),
        (any(row.off for row in every), legends.shade("tolerance", _OFF)),
    )
    head = 2.0 + 4.0 * (1 if len(handles) <= 2 else len(handles))
    tall = [sum(_LINE * len(row.lines) + _BAR + _GAP for row in rows) for _, rows in drawn]
    height = head + sum(tall) + len(drawn) * _FOOT + (len(drawn) - 1) * _BETWEEN
    figure = sheet.blank(style.COLUMN, height)
    wide = style.COLUMN - _LEFT - _RIGHT
    axes = sheet.stack(figure, (_LEFT, _FOOT), wide, tall, _FOOT + _BETWEEN)
    for ax, (label, rows) in zip(axes, drawn, strict=True):
        _draw(ax, label, rows)
    legends.on_top(figure, handles, _LEFT, columns=2 if len(handles) == 2 else 1)
    return figure


def _rows(margin: Margin, anchors: bool, tolerances: Tolerances) -> list[_Row]:
    """Rows of the anchors [mm], or of all other parameters [%]; smallest margin first."""
    each = tolerances.each(len(margin.chain))
    some = [change for change in margin.changes if (change.parameter == "anchor") == anchors]
    chain, shown = margin.chain, sorted(some, key=lambda change: change.distance)[:_MOST]
    words = {"force": chain.measure.force, "travel": chain.measure.travel}
    factor = style.MM if anchors else 100.0
    reach = f" within {number(margin.reach * style.MM)} mm" if anchors else ""
    rows: list[_Row] = []
    for change in shown:
        changed, deviation = _CHANGED[change.parameter]
        what = f"{chain.names[change.cell]}: {changed.format(**words)}"
        off = getattr(each[change.cell], deviation) * factor
        if math.isinf(change.distance):
            rows.append(_Row([*_lines(what), f"no other sequence{reach}"], off=off))
            continue
        lines = _lines(f"{what} {_by(change)}")
        if change.becomes and len(chain) <= _SPELLED:
            lines += _lines(f"then {sequence_words(change.becomes, _ROOM - 5)}", _MOST_LINES)
        rows.append(_Row(lines, change.distance * factor, off))
    left = len(some) - len(shown)
    return rows + [_Row([f"and {left} more, with larger margins"])] * bool(left)


def _by(change: Change) -> str:
    """Text of a margin; signed, except for an anchor."""
    if change.distance * style.MM < 1e-6:
        return "by almost 0"
    if isinstance(change.move, tuple):
        return f"{number(change.distance * style.MM)} mm"
    return minus(f"{signed(change.move * 100)} %")


def _lines(text: str, most: int = 1) -> list[str]:
    return shortened(text, _ROOM, most).split("\n")


def _draw(ax: Axes, label: str, rows: Sequence[_Row]) -> None:
    ends = [row.far for row in rows if math.isfinite(row.far)] + [2.0 * row.off for row in rows]
    most = 1.06 * max(ends) or 1.0
    ax.set_xlim(0.0, most)
    words = [(row.lines, 0 if math.isfinite(row.far) else -1) for row in rows]
    for row, y in zip(rows, _under(ax, 0.012 * most, words, _BAR, _GAP), strict=True):
        if math.isfinite(row.far):
            colour = _pale(style.VERMILLION if row.near else style.GREEN)
            look = {"color": colour, "linewidth": 0, "zorder": 2, "gid": "margins"}
            ax.barh(y, row.far, _BAR, **look)
        # Within the bar, so that both lengths can be compared.
        inner = {"color": _OFF, "edgecolor": style.INK, "linewidth": 0.5, "zorder": 3, "gid": "off"}
        ax.barh(y, row.off, 0.5 * _BAR, **inner)
    ax.axvline(0.0, color=style.INK, linewidth=0.8, zorder=2)
    ax.set_xlabel(label)


def _under(
    ax: Axes, x: float, words: Sequence[tuple[list[str], int]], bar: float, gap: float
) -> list[float]:
    """Write each row's lines, one of them bold, from the top down, and return the middles of the
    bars under them; all in mm.
    """
    ax.set_ylim(sheet.size_of(sheet.sheet_of(ax))[1] * ax.get_position().height, 0.0)
    ax.set_yticks([])
    _bare(ax)
    y, middles = 0.0, []
    for lines, bold in words:
        for k, line in enumerate(lines):
            weight = "bold" if k == bold else "normal"
            ax.text(x, y + _LINE / 2, literal(line), va="center_baseline", fontweight=weight)
            y += _LINE
        middles.append(y + bar / 2)
        y += bar + gap
    return middles


def _pale(colour: str) -> tuple[float, float, float]:
    return style.pale(colour, 0.3)


LOW, HIGH, _TARGET = style.SKY, style.ORANGE, style.pale(style.GREEN, 0.7)
_MISSING: dict[str, Any] = {"markersize": 5.5, "markeredgecolor": style.INK, "markeredgewidth": 0.5}
_ROW, _HEAD, _TORNADO_FOOT, _KEY = 4.4, 4.0, 11.0, 6.0


@style.styled
def tornado(results: Sensitivity | Sequence[Sensitivity]) -> Figure:
    """Tornado plot: range of each result between the low and the high value of each parameter.

    Bars start at the nominal result, the parameter with the widest span is on top, the target is
    shaded. Two columns wide.

    Args:
        results: one sensitivity, or several, plotted two per row.

    Raises:
        ValueError: no results.
    """
    shown = list(results) if isinstance(results, Sequence) else [results]
    if not shown or not all(one.effects for one in shown):
        raise InputError("results is empty: give one Sensitivity or more, each with effects.")
    columns = min(len(shown), 2)
    rows = [shown[i : i + columns] for i in range(0, len(shown), columns)]
    tall = [_ROW * max(len(one.effects) for one in row) for row in rows]
    height = sum(tall) + len(rows) * (_HEAD + _TORNADO_FOOT) + _KEY
    figure = sheet.blank(style.PAGE, height)
    top, wide = height - _KEY, style.PAGE / columns
    for row, high in zip(rows, tall, strict=True):
        top -= _HEAD
        for k, one in enumerate(row):
            own = _ROW * len(one.effects)
            _bars(sheet.place(figure, k * wide + 2.0, top - own, wide - 7.0, own), one, k * wide)
        top -= high + _TORNADO_FOOT
    missing = any(math.isinf(effect.span) for one in shown for effect in one.effects)
    handles = legends.applicable(
        (True, legends.shade("at the low value", LOW)),
        (True, legends.shade("at the high value", HIGH)),
        (any(one.target for one in shown), legends.shade("target", _TARGET)),
        (missing, legends.mark("no result", "X", **_MISSING, color="white")),
    )
    legends.on_top(figure, handles, 2.0, columns=4)
    return figure


def _bars(ax: Axes, one: Sensitivity, left: float) -> None:
    effects = sorted(one.effects, key=lambda effect: -effect.span)
    for i, effect in enumerate(effects):
        # Two bars to one side of the nominal value lie on halves of the lane.
        same_side = (effect.at_low - one.nominal) * (effect.at_high - one.nominal) > 0
        ends = (effect.at_low, LOW, "low", -0.2), (effect.at_high, HIGH, "high", 0.2)
        for value, colour, name, off in ends:
            if math.isfinite(value):
                look = {"left": one.nominal, "height": 0.38 if same_side else 0.76, "zorder": 2}
                look |= {"color": colour, "gid": f"{name} {effect.parameter}"}
                ax.barh(i + off * same_side, value - one.nominal, **look)
            else:
                look = _MISSING | {"color": colour, "zorder": 4, "gid": "missing"}
                ax.plot(one.nominal, i + off, "X", **look)
    ax.axvline(one.nominal, color=style.INK, linewidth=0.8, zorder=3, gid="nominal")
    results = [v for e in effects for v in (e.at_low, e.at_high, one.nominal) if math.isfinite(v)]
    results += one.target or ()
    low, high = min(results), max(results)
    room = 0.06 * (high - low) or 0.1 * abs(one.nominal) or 1.0
    ax.set_xlim(low - room, high + room)
    if one.target:
        ax.axvspan(*one.target, color=_TARGET, linewidth=0, zorder=0, gid="target")
    ranges = ((literal(e.parameter), minus(f"{e.low:.4g} to {e.high:.4g}")) for e in effects)
    style.name_rows(ax, [*map("  ".join, ranges)])
    ax.locator_params(axis="x", nbins=4)
    ax.set_xlabel(one.result, loc="right")
    ax.spines[["top", "right", "left"]].set_visible(False)
    ax.grid(axis="x", color=style.FAINT, linewidth=0.3, alpha=0.5, zorder=0)
    ax.set_axisbelow(True)
    # As narrow as the names at its left require.
    box, place = ax.yaxis.get_tightbbox(), ax.get_position()
    if box is not None:
        missing = (left + 1.0) / style.PAGE - box.x0 / sheet.root(ax).bbox.width
        ax.set_position((place.x0 + missing, place.y0, place.width - missing, place.height))


_OUTCOMES, _PARTS = 6, 16
# Fractions below this are within the error of the estimate.
_LEAST = 0.01
# Height of a bar, and gap of two rows [mm].
_YIELD_BAR, _YIELD_GAP = 3.0, 2.2
_STEP = _YIELD_BAR + _YIELD_GAP
_YIELD_FOOT, _YIELD_HEAD = 10.0, 6.0
# Largest number of lines above a bar.
_YIELD_MOST_LINES = 3


@style.styled
def yield_bars(result: Yield) -> Figure:
    """Yield with its confidence interval, and the fractions of all other outcomes.

    One column wide. With sensitivities it is two columns wide, with a panel of the fraction of the
    smallest force gap's variance caused by each tolerance: first order dark, total pale.

    Args:
        result: result of `design.yields`.
    """
    table = result.sensitivities
    outcomes = _outcomes(result)
    tall = sum(_STEP + _LINE * len(lines) for lines, _ in outcomes)
    parts = [] if table is None or table.deviation == 0 else _parts(table)
    rows = _STEP * len(parts)
    page = sheet.page_width(style.PAGE if parts else style.COLUMN)
    # Side by side, or stacked on a narrow page.
    side_by_side = bool(parts) and page >= 2 * style.COLUMN
    side, start = (style.COLUMN, 0.0) if side_by_side else (page, tall + _YIELD_FOOT + _YIELD_HEAD)
    body = max(tall, rows) if side_by_side or not parts else start + rows
    top = _YIELD_FOOT + body
    figure = sheet.blank(page, top + _YIELD_HEAD)
    _draw_outcomes(sheet.place(figure, 4.0, top - tall, side - 9.0, tall), result, outcomes)
    if parts and table is not None:
        first, top = (style.COLUMN, top) if side_by_side else (-2.0, top - start)
        left = first + 8.0 + 1.6 * max(len(table.parameters[i]) for i in parts)
        ax = sheet.place(figure, left, top - rows, page - left - 5.0, rows)
        _draw_parts(ax, table, result.chain.names, parts)
        head = "Sensitivity to tolerances"
        sheet.text_at(figure, first + 6.0, top + 1.5, head, fontweight="bold")
    return figure


def _outcomes(result: Yield) -> list[tuple[list[str], float]]:
    """Names and fractions of the target, followed by the most frequent other outcomes."""
    others = list(result.outcomes.items())
    low, high = map(percent, result.interval)
    # On its own line: on the bar, the interval would strike it through.
    words = f"{percent(result.fraction)} ({low} to {high}) reach the target"
    reproduced = [([*_outcome_lines(result.target), words], result.fraction)]
    shown = [(_outcome_lines(text), count) for text, count in others[:_OUTCOMES]]
    if rest := sum(count for _, count in others[_OUTCOMES:]):
        shown.append(([f"{len(others) - _OUTCOMES} other outcomes"], rest))
    return reproduced + [(lines, n / result.samples) for lines, n in shown]


def _outcome_lines(text: str) -> list[str]:
    return _lines(sequence_words(text, _ROOM), _YIELD_MOST_LINES)


def _draw_outcomes(ax: Axes, result: Yield, outcomes: Sequence[tuple[list[str], float]]) -> None:
    """Draw a bar under the name of each outcome, and the interval of the yield."""
    ax.set_xlim(0.0, 100.0)
    words = [(lines, -1 if k else len(lines) - 1) for k, (lines, _) in enumerate(outcomes)]
    middles = _under(ax, 0.0, words, _YIELD_BAR, _YIELD_GAP)
    for k, ((_, fraction), y) in enumerate(zip(outcomes, middles, strict=True)):
        colour = _pale(style.VERMILLION if k else style.GREEN)
        ax.barh(y, 100.0 * fraction, _YIELD_BAR, color=colour, linewidth=0, gid="outcomes")
        if k:
            x = 2.0 if fraction > 0.5 else 100.0 * fraction + 2.0
            ax.text(x, y, percent(fraction), va="center_baseline")
    ends = [100.0 * bound for bound in result.interval]
    ax.plot(ends, middles[:1] * 2, "|-", color=style.INK, linewidth=1.0, gid="interval")
    count = f"{result.samples:,}".replace(",", "\N{THIN SPACE}")
    ax.set_xlabel(f"Fraction of {count} samples [%]")
    sheet.name_panel(ax, "Outcomes")


def _parts(table: Sensitivities) -> list[int]:
    """Parameters by falling fraction, without those below the error of the estimate."""
    order = np.argsort(-np.asarray(table.total), kind="stable")[:_PARTS].tolist()
    return [i for i in order if table.total[i] >= _LEAST]


def _draw_parts(ax: Axes, table: Sensitivities, names: Sequence[str], parts: Sequence[int]) -> None:
    """Draw the first-order and total sensitivity index of each tolerance."""
    tall = len(parts) * _STEP
    colours = dict(zip(names, style.cell_colours(len(names)), strict=True))
    middles = [k * _STEP + _STEP / 2 for k in range(len(parts))]
    for middle, i in zip(middles, parts, strict=True):
        colour = colours.get(table.parameters[i].rpartition(".")[0], style.INK)
        total, alone = (table.total[i], style.pale(colour)), (table.first_order[i], colour)
        for gid, (fraction, shade) in (("total", total), ("first order", alone)):
            # An index near zero may come out below it.
            ax.barh(
                middle, max(0.0, float(fraction)), _YIELD_BAR, color=shade, linewidth=0, gid=gid
            )
    ax.set_yticks(middles, [literal(table.parameters[i]) for i in parts])
    ax.set(ylim=(tall, 0.0), xlim=(0.0, 1.05 * max(0.05, float(np.max(table.total)))))
    _bare(ax)
    ax.set_xlabel("Variance fraction of the smallest force gap")
    pale = style.pale(style.INK)
    handles = [legends.shade("first order", style.INK), legends.shade("total", pale)]
    ax.legend(handles=handles, loc="lower right", bbox_to_anchor=(1.0, 1.0 + 1.5 / tall), ncols=2)


def _bare(ax: Axes) -> None:
    ax.spines[["top", "right", "left"]].set_visible(False)
    ax.spines.bottom.set_color(style.FAINT)
    ax.tick_params(axis="y", length=0.0)
