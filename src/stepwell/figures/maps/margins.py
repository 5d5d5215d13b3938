"""How far each thing may be changed before a chain does something else."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepwell.base import number, signed
from stepwell.figures.common import (
    COLUMN,
    FAINT,
    GREEN,
    INK,
    MM,
    SKY,
    VERMILLION,
    blank,
    legends,
    literal,
    minus,
    pale,
    place,
    root,
    sequence_words,
    shortened,
    size_of,
    styled,
)

if TYPE_CHECKING:
    from stepwell.design import Change, Margin, Tolerances

# Of each unit so many are shown; of longer chains no sequence is looked for.
_MOST, _SPELLED = 8, 12
# A bar, a line of text, and what a row has around them [mm].
_BAR, _LINE, _GAP = 2.6, 3.1, 2.0
_HEAD, _FOOT, _BETWEEN, _LEFT, _RIGHT = 6.0, 9.0, 5.0, 4.0, 5.0
# Characters that a line above a bar has room for, and how many such lines there may be.
_ROOM, _MOST_LINES = 48, 2
_CHANGED = {
    "anchor": "anchor q",
    "stiffness": "stiffness",
    "force_scale": "all its {force}s",
    "travel_scale": "all its {travel}s",
    "friction": "friction",
}


class _Panel(NamedTuple):
    """Changes in one unit.

    Attributes:
        changes: nearest first.
        factor: that of the unit.
        label: of the axis.
        usual: how far parts usually are off, in the unit.
    """

    changes: list[Change]
    factor: float
    label: str
    usual: float


class _Row(NamedTuple):
    """A change: what is written above its bar, how long that is, and whether it is near."""

    lines: list[str]
    far: float
    colour: str


@styled
def margins(margin: Margin, tolerances: Tolerances | None = None) -> Figure:
    """How far each thing may be changed before the chain does something else, nearest on top.

    Args:
        margin: what `design.margin` returns.
        tolerances: how far parts are off when it is built, shaded; by default the usual ones. A
            bar that ends in the shade is red.

    Returns:
        A figure of one column's width: a bar for every anchor [mm], and one for every other number
        [%], with what the chain does past its end; of long chains those of the nearest.
    """
    from stepwell.design import USUAL

    panels = _panels(margin, USUAL if tolerances is None else tolerances)
    drawn = [(panel, _rows(margin, panel)) for panel in panels]
    tall = [sum(_LINE * len(row.lines) + _BAR + _GAP for row in rows) for _, rows in drawn]
    height = _HEAD + sum(tall) + len(drawn) * _FOOT + (len(drawn) - 1) * _BETWEEN
    figure = blank(COLUMN, height)
    top = height - _HEAD
    for (panel, rows), high in zip(drawn, tall, strict=True):
        ax = place(figure, _LEFT, top - high, COLUMN - _LEFT - _RIGHT, high)
        _draw(ax, panel, rows)
        top -= high + _FOOT + _BETWEEN
    handles = [legends.shade("another sequence past its end", pale(GREEN, 0.3))]
    if any(row.colour == VERMILLION for _, rows in drawn for row in rows):
        handles = [
            legends.shade("far", pale(GREEN, 0.3)),
            legends.shade("near", pale(VERMILLION, 0.3)),
        ]
    handles.append(legends.shade("usually off by", pale(SKY, 0.55)))
    legends.on_top(figure, handles, _LEFT)
    return figure


def _panels(margin: Margin, tolerances: Tolerances) -> list[_Panel]:
    """The anchors, then all that is told as a share."""
    near = sorted(margin.changes, key=lambda change: change.distance)
    anchors = [change for change in near if change.parameter == "anchor"]
    others = [change for change in near if change.parameter != "anchor"]
    found = [
        _Panel(anchors, MM, "The anchor moved by [mm]", tolerances.anchor),
        _Panel(others, 100.0, "The number changed by [%]", tolerances.stiffness),
    ]
    return [panel for panel in found if panel.changes]


def _rows(margin: Margin, panel: _Panel) -> list[_Row]:
    chain, shown = margin.chain, panel.changes[:_MOST]
    found: list[_Row] = []
    for change in shown:
        words = {"force": chain.measure.force, "travel": chain.measure.travel}
        what = f"{chain.names[change.cell]}: {_CHANGED[change.parameter].format(**words)}"
        if math.isinf(change.distance):
            reach = f" within {number(margin.reach * MM)} mm" if panel.factor == MM else ""
            lines = [*_lines(what), f"nothing else{reach}"]
            found.append(_Row(lines, 0.0, FAINT))
            continue
        near = change.distance < panel.usual
        lines = _lines(f"{what} {_by(change)}")
        becomes = change.becomes if len(chain) <= _SPELLED else ""
        if becomes:
            lines += _lines(f"then {sequence_words(becomes, _ROOM - 5)}", _MOST_LINES)
        far = change.distance * panel.factor
        found.append(_Row(lines, far, VERMILLION if near else GREEN))
    left = len(panel.changes) - len(shown)
    if left:
        found.append(_Row([f"and {left} more, no nearer"], 0.0, FAINT))
    return found


def _by(change: Change) -> str:
    """How far, and which way: of an anchor both components are in the tables."""
    if isinstance(change.move, tuple):
        return f"{number(change.distance * MM)} mm"
    return minus(f"{signed(change.move * 100)} %")


def _lines(text: str, most: int = 1) -> list[str]:
    return shortened(text, _ROOM, most).split("\n")


def _draw(ax: Axes, panel: _Panel, rows: Sequence[_Row]) -> None:
    far = max((row.far for row in rows), default=0.0)
    most = 1.06 * max(far, 2.0 * panel.usual * panel.factor) or 1.0
    ax.set_xlim(0.0, most)
    ax.set_ylim(size_of(root(ax))[1] * ax.get_position().height, 0.0)
    usual = panel.usual * panel.factor
    ax.axvspan(0.0, usual, color=pale(SKY, 0.55), linewidth=0, zorder=0, gid="usual")
    y = 0.0
    for row in rows:
        for k, line in enumerate(row.lines):
            look: dict[str, Any] = {"fontweight": "bold" if k == 0 and row.far else "normal"}
            ax.text(0.0, y + _LINE / 2, literal(line), va="center_baseline", zorder=3, **look)
            y += _LINE
        colour = pale(row.colour, 0.3)
        ax.barh(y + _BAR / 2, row.far, _BAR, color=colour, linewidth=0, zorder=2, gid="margins")
        y += _BAR + _GAP
    ax.set_yticks([])
    ax.spines[["top", "right", "left"]].set_visible(False)
    ax.spines.bottom.set_color(FAINT)
    ax.axvline(0.0, color=INK, linewidth=0.8, zorder=2)
    ax.set_xlabel(panel.label)
