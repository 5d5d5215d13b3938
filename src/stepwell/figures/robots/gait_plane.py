"""The plane of the inner cell's forces, divided by the outer cell's thresholds into gaits."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepwell.base import Floats, InputError
from stepwell.figures.common import legends, sheet, style

if TYPE_CHECKING:
    from stepwell.simulation import CompiledRobot

_SIZE = (style.COLUMN, 92.0)
_MARGINS = (15.0, 11.0, 2.5, 13.0)
# Room around the points, as a fraction of their range.
_ROOM = 0.45


@style.styled
def gait_plane(result: CompiledRobot, *, ax: Axes | None = None) -> Figure:
    """F0 against F1 of the inner cell of both legs, at rest and with the anchor displaced.

    The outer cell opens at a vertical threshold and closes at a horizontal one. They divide the
    plane into the gaits: forward at the upper left, backward at the lower right, idle in the two
    other corners. Weight that moves between the feet shifts the vertical threshold: a shade covers
    all rows of the table. The distance of a point from the thresholds is its margin.

    Raises:
        ValueError: a result without a design.
    """
    design = result.design
    if design is None:
        raise InputError("the result has no design to draw; its text has the conflicting rows.")
    orders = [order for row in design.rows for order in row.orders]
    points = np.unique([(order.inner_0, order.inner_1) for order in orders], axis=0)
    opens = np.array([order.opens for order in orders])
    closes = np.array([order.closes for order in orders])
    figure, ax = sheet.canvas(ax, _SIZE, _MARGINS)
    (left, right), (bottom, top) = (
        _range(np.append(at, edge)) for at, edge in zip(points.T, (opens, closes), strict=True)
    )
    look: dict[str, Any] = {"color": style.pale(style.BLUE, 0.55), "linewidth": 0, "zorder": 0.5}
    ax.axvspan(opens.min(), opens.max(), **look, gid="opens")
    for at in (opens.min(), opens.max()):
        ax.axvline(at, color=style.BLUE, linewidth=1.0, zorder=1)
    for at in (closes.min(), closes.max()):
        ax.axhline(at, color=style.VERMILLION, linewidth=1.0, zorder=1, gid="closes")
    ends = [design.rows[0].orders[0], *_displaced(design.rows[0].orders[0], orders)]
    if len(ends) > 1:
        arrow = {"arrowstyle": "->", "color": style.FAINT, "linewidth": 1.0}
        a, b = ((one.inner_0, one.inner_1) for one in ends[:2])
        ax.annotate("", b, a, arrowprops=arrow | {"shrinkA": 4, "shrinkB": 4})
    ax.plot(*points.T, "o", color=style.INK, markersize=5.0, zorder=3, gid="legs")
    for text, one, up in (("at rest", ends[0], 6), ("displaced", ends[-1], -12)):
        ax.annotate(
            text,
            (one.inner_0, one.inner_1),
            xytext=(0, up),
            textcoords="offset points",
            ha="center",
            fontsize=7,
        )
    corners = (
        (0.02, 0.98, "left", "top", "forward"),
        (0.98, 0.02, "right", "bottom", "backward"),
        (0.02, 0.02, "left", "bottom", "idle"),
        (0.98, 0.98, "right", "top", "idle"),
    )
    for x, y, ha, va, text in corners:
        where: dict[str, Any] = {"ha": ha, "va": va, "transform": ax.transAxes}
        ax.text(x, y, text, color=style.FAINT, fontsize=8, **where)
    ax.set(xlim=(left, right), ylim=(bottom, top))
    ax.set(xlabel="F0 of the inner cell [N]", ylabel="F1 of the inner cell [N]")
    ax.locator_params(nbins=6)
    key = [
        legends.shade("outer cell opens, all rows", look["color"]),
        legends.line("outer cell closes", style.VERMILLION, 1.0),
    ]
    legends.above(ax, key, 1, fit=True)
    return figure


def _displaced(rest: Any, orders: list[Any]) -> list[Any]:
    """The first of some orders with other forces of the inner cell than at rest."""
    others = [one for one in orders if (one.inner_0, one.inner_1) != (rest.inner_0, rest.inner_1)]
    return others[:1]


def _range(values: Floats) -> tuple[float, float]:
    low, high = float(values.min()), float(values.max())
    room = _ROOM * max(high - low, 1e-3)
    return low - room, high + room
