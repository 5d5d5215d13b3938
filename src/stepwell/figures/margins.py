"""How far each thing may be changed before a chain does something else."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepwell.base import number, signed
from stepwell.figures.common import legends, sheet, style
from stepwell.figures.common.words import literal, minus, sequence_words, shortened

if TYPE_CHECKING:
    from stepwell.design import Change, Margin, Tolerances

# Of each unit so many are shown; of longer chains no sequence is looked for.
_MOST, _SPELLED = 8, 12
# A bar, a line of text, and what a row has around them [mm].
_BAR, _LINE, _GAP = 2.6, 3.1, 2.0
_FOOT, _BETWEEN, _LEFT, _RIGHT = 9.0, 5.0, 4.0, 5.0
# Characters that a line above a bar has room for, and how many such lines there may be.
_ROOM, _MOST_LINES = 48, 2
_CHANGED = {
    "anchor": "anchor q",
    "stiffness": "stiffness",
    "force_scale": "all its {force}s",
    "travel_scale": "all its {travel}s",
    "friction": "friction",
}
# The tolerance that says how far each is off.
_OFF_BY = {
    "anchor": "anchor",
    "stiffness": "stiffness",
    "force_scale": "stiffness",
    "travel_scale": "travel",
    "friction": "friction",
}
_OFF = style.pale(style.SKY, 0.55)


class _Panel(NamedTuple):
    """Changes in one unit: nearest first, its factor, and the label of the axis."""

    changes: list[Change]
    factor: float
    label: str


class _Row(NamedTuple):
    """A change: what is written above its bar, how long that is, and how far parts are off."""

    lines: list[str]
    far: float = math.inf
    off: float = 0.0

    @property
    def near(self) -> bool:
        """Whether parts as they usually are go past it."""
        return self.far < self.off


@style.styled
def margins(margin: Margin, tolerances: Tolerances | None = None) -> Figure:
    """How far each thing may be changed before the chain does something else, nearest on top.

    Args:
        margin: what `design.margin` returns.
        tolerances: how far parts are off when it is built, shaded; by default the usual ones.

    Returns:
        A figure of one column's width: a bar for every anchor [mm], and one for every other number
        [%], with what the chain does past its end; of long chains those of the nearest.
    """
    from stepwell.design import USUAL

    given = USUAL if tolerances is None else tolerances
    drawn = [(panel, _rows(margin, panel, given)) for panel in _panels(margin)]
    handles = [legends.shade("another sequence past its end", _pale(style.GREEN))]
    if any(row.off for _, rows in drawn for row in rows):
        handles.append(legends.shade("parts are off by", _OFF))
    if any(row.near for _, rows in drawn for row in rows):
        handles.insert(
            1, legends.shade("the same, nearer than parts are off", _pale(style.VERMILLION))
        )
    keys = 1 if len(handles) <= 2 else len(handles)
    head = 2.0 + 4.0 * keys
    tall = [sum(_LINE * len(row.lines) + _BAR + _GAP for row in rows) for _, rows in drawn]
    height = head + sum(tall) + len(drawn) * _FOOT + (len(drawn) - 1) * _BETWEEN
    figure = sheet.blank(style.COLUMN, height)
    top = height - head
    for (panel, rows), high in zip(drawn, tall, strict=True):
        ax = sheet.place(figure, _LEFT, top - high, style.COLUMN - _LEFT - _RIGHT, high)
        _draw(ax, panel, rows)
        top -= high + _FOOT + _BETWEEN
    legends.on_top(figure, handles, _LEFT, columns=2 if len(handles) == 2 else 1)
    return figure


def _panels(margin: Margin) -> list[_Panel]:
    """The anchors, then all that is told as a share."""
    near = sorted(margin.changes, key=lambda change: change.distance)
    anchors = [change for change in near if change.parameter == "anchor"]
    others = [change for change in near if change.parameter != "anchor"]
    found = [
        _Panel(anchors, style.MM, "The anchor moved by [mm]"),
        _Panel(others, 100.0, "The number changed by [%]"),
    ]
    return [panel for panel in found if panel.changes]


def _rows(margin: Margin, panel: _Panel, tolerances: Tolerances) -> list[_Row]:
    chain, shown = margin.chain, panel.changes[:_MOST]
    words = {"force": chain.measure.force, "travel": chain.measure.travel}
    found: list[_Row] = []
    for change in shown:
        what = f"{chain.names[change.cell]}: {_CHANGED[change.parameter].format(**words)}"
        off = getattr(tolerances, _OFF_BY[change.parameter]) * panel.factor
        if math.isinf(change.distance):
            reach = (
                f" within {number(margin.reach * style.MM)} mm" if panel.factor == style.MM else ""
            )
            found.append(_Row([*_lines(what), f"nothing else{reach}"], off=off))
            continue
        lines = _lines(f"{what} {_by(change)}")
        becomes = change.becomes if len(chain) <= _SPELLED else ""
        if becomes:
            lines += _lines(f"then {sequence_words(becomes, _ROOM - 5)}", _MOST_LINES)
        found.append(_Row(lines, change.distance * panel.factor, off))
    left = len(panel.changes) - len(shown)
    return found + [_Row([f"and {left} more, no nearer"])] * bool(left)


def _by(change: Change) -> str:
    """How far; of a number which way too."""
    if change.distance * style.MM < 1e-6:
        return "by next to nothing"
    if isinstance(change.move, tuple):
        return f"{number(change.distance * style.MM)} mm"
    return minus(f"{signed(change.move * 100)} %")


def _lines(text: str, most: int = 1) -> list[str]:
    return shortened(text, _ROOM, most).split("\n")


def _draw(ax: Axes, panel: _Panel, rows: Sequence[_Row]) -> None:
    ends = [row.far for row in rows if math.isfinite(row.far)] + [2.0 * row.off for row in rows]
    ax.set_xlim(0.0, 1.06 * max(ends) or 1.0)
    ax.set_ylim(sheet.size_of(sheet.root(ax))[1] * ax.get_position().height, 0.0)
    y = 0.0
    for row in rows:
        known = math.isfinite(row.far)
        for k, line in enumerate(row.lines):
            look: dict[str, Any] = {"fontweight": "bold" if k == 0 and known else "normal"}
            at = 0.012 * ax.get_xlim()[1], y + _LINE / 2
            ax.text(*at, literal(line), va="center_baseline", zorder=3, **look)
            y += _LINE
        if known:
            colour = _pale(style.VERMILLION if row.near else style.GREEN)
            look = {"color": colour, "linewidth": 0, "zorder": 2, "gid": "margins"}
            ax.barh(y + _BAR / 2, row.far, _BAR, **look)
        # In the bar, so that whichever is longer is seen to be.
        inner = {"color": _OFF, "edgecolor": style.INK, "linewidth": 0.5, "zorder": 3, "gid": "off"}
        ax.barh(y + _BAR / 2, row.off, 0.5 * _BAR, **inner)
        y += _BAR + _GAP
    ax.set_yticks([])
    ax.spines[["top", "right", "left"]].set_visible(False)
    ax.spines.bottom.set_color(style.FAINT)
    ax.axvline(0.0, color=style.INK, linewidth=0.8, zorder=2)
    ax.set_xlabel(panel.label)


def _pale(colour: str) -> tuple[float, float, float]:
    return style.pale(colour, 0.3)
