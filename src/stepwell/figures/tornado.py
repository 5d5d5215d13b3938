"""How results depend on the values assumed: one bar a parameter, the longest on top."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepwell.base import InputError
from stepwell.figures.common import legends, sheet, style
from stepwell.figures.common.words import literal, minus

if TYPE_CHECKING:
    from stepwell.paper import Sensitivity

LOW, HIGH = style.SKY, style.ORANGE
_MISSING: dict[str, Any] = {"markersize": 5.5, "markeredgecolor": style.INK, "markeredgewidth": 0.5}
_ROW, _HEAD, _FOOT, _KEY = 4.4, 4.0, 11.0, 6.0


@style.styled
def tornado(results: Sensitivity | Sequence[Sensitivity]) -> Figure:
    """For each result a bar from its value at the low to that at the high value of a parameter.

    Args:
        results: one, or several to be shown two a row.

    Returns:
        A figure of two columns' width; bars start at the nominal result, the parameter with the
        widest span is on top, the target is shaded.

    Raises:
        ValueError: nothing to show.
    """
    shown = list(results) if isinstance(results, Sequence) else [results]
    if not shown or not all(one.effects for one in shown):
        raise InputError("results is empty: give one Sensitivity or more, each with effects.")
    columns = min(len(shown), 2)
    rows = [shown[i : i + columns] for i in range(0, len(shown), columns)]
    tall = [_ROW * max(len(one.effects) for one in row) for row in rows]
    height = sum(tall) + len(rows) * (_HEAD + _FOOT) + _KEY
    figure = sheet.blank(style.PAGE, height)
    bottom = height - _KEY
    for row, high in zip(rows, tall, strict=True):
        bottom -= _HEAD + high
        for k, one in enumerate(row):
            own = _ROW * len(one.effects)
            left = k * style.PAGE / columns
            ax = sheet.place(
                figure, left + 2.0, bottom + high - own, style.PAGE / columns - 7.0, own
            )
            _bars(ax, one, left)
        bottom -= _FOOT
    handles: list[Artist] = [
        legends.shade("at the low value", LOW),
        legends.shade("at the high value", HIGH),
    ]
    if any(one.target for one in shown):
        handles.append(legends.shade("target", style.pale(style.GREEN, 0.7)))
    if any(math.isinf(effect.span) for one in shown for effect in one.effects):
        handles.append(legends.mark("no result", "X", **_MISSING, color="white"))
    legends.on_top(figure, handles, 2.0, columns=4)
    return figure


def _bars(ax: Axes, one: Sensitivity, left: float) -> None:
    effects = sorted(one.effects, key=lambda effect: -effect.span)
    for i, effect in enumerate(effects):
        # Two bars to one side of the nominal value lie on halves of the lane.
        same_side = (effect.at_low - one.nominal) * (effect.at_high - one.nominal) > 0
        tall = 0.38 if same_side else 0.76
        for value, colour, name, off in (
            (effect.at_low, LOW, "low", -0.2),
            (effect.at_high, HIGH, "high", 0.2),
        ):
            if math.isfinite(value):
                look = {"color": colour, "zorder": 2, "gid": f"{name} {effect.parameter}"}
                row, wide = i + off * same_side, value - one.nominal
                ax.barh(row, wide, left=one.nominal, height=tall, **look)
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
        ax.axvspan(
            *one.target, color=style.pale(style.GREEN, 0.7), linewidth=0, zorder=0, gid="target"
        )
    ends = [minus(f"{effect.low:.4g} to {effect.high:.4g}") for effect in effects]
    names = [f"{literal(e.parameter)}  {each}" for e, each in zip(effects, ends, strict=True)]
    style.name_rows(ax, names)
    ax.locator_params(axis="x", nbins=4)
    ax.set_xlabel(one.result, loc="right")
    ax.spines[["top", "right", "left"]].set_visible(False)
    ax.grid(axis="x", color=style.FAINT, linewidth=0.3, alpha=0.5, zorder=0)
    ax.set_axisbelow(True)
    _make_room(ax, left)


def _make_room(ax: Axes, left: float) -> None:
    """Narrow the axes by as much as their names need from `left` mm on."""
    box, place = ax.yaxis.get_tightbbox(), ax.get_position()
    if box is not None:
        missing = (left + 1.0) / style.PAGE - box.x0 / sheet.root(ax).bbox.width
        ax.set_position((place.x0 + missing, place.y0, place.width - missing, place.height))
