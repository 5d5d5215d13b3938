"""Dimensions and scale bars of drawings whose data are millimetres."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from stepwell.figures.common.style import INK, MM, on_white
from stepwell.figures.common.words import minus

_BOTH = {"arrowstyle": "<|-|>", "linewidth": 0.6, "mutation_scale": 5, "shrinkA": 0, "shrinkB": 0}


def along_x(
    ax: Axes,
    left: float,
    right: float,
    y: float,
    text: str,
    *,
    feet: float,
    colour: str = INK,
    gid: str | None = None,
) -> None:
    """A dimension along x at height y, with thin lines to it from height `feet`; all in mm."""
    look = {"color": colour, "linewidth": 0.4, "zorder": 2.5, "gid": gid}
    for x in (left, right):
        ax.plot([x, x], [feet, y + np.sign(y - feet)], **look)
    ax.annotate("", (right, y), (left, y), arrowprops=_BOTH | {"color": colour}, zorder=8)
    middle = (left + right) / 2
    ax.text(middle, y + 1.0, text, ha="center", va="bottom", zorder=9, bbox=on_white())


def along_y(
    ax: Axes,
    low: float,
    high: float,
    x: float,
    text: str,
    *,
    feet: float,
    colour: str = INK,
    gid: str | None = None,
) -> None:
    """A dimension along y at x, with thin lines to it from x = `feet`; all in mm."""
    look = {"color": colour, "linewidth": 0.4, "zorder": 2.5, "gid": gid}
    for y in (low, high):
        ax.plot([feet, x + np.sign(x - feet)], [y, y], **look)
    ax.annotate("", (x, high), (x, low), arrowprops=_BOTH | {"color": colour}, zorder=8)
    ax.text(x - 1.2, (low + high) / 2, text, ha="right", va="center", rotation=90, zorder=9)


def arrow(
    ax: Axes,
    tail: tuple[float, float],
    tip: tuple[float, float],
    colour: str = INK,
    width: float = 0.6,
) -> None:
    """An arrow from tail to tip [mm]; one of no width is a head alone."""
    size = 5.0 + 2.0 * (width == 0 or width >= 1)
    props = {"arrowstyle": "-|>", "color": colour, "linewidth": width, "mutation_scale": size}
    ax.annotate("", tip, tail, arrowprops=_BOTH | props, zorder=8)


def scale_bar(ax: Axes, right: float, y: float, length: float) -> None:
    """A bar of this length [mm] that ends at `right`, with its length above it."""
    look = {"color": INK, "linewidth": 1.6, "solid_capstyle": "butt", "gid": "scale bar"}
    ax.plot([right - length, right], [y, y], **look, zorder=9)
    label = f"{length:g} mm" if length < 1000 else f"{length / 1000:g} m"
    place: dict[str, Any] = {"textcoords": "offset points", "ha": "center", "va": "bottom"}
    ax.annotate(label, (right - length / 2, y), (0.0, 2.5), **place, zorder=9)


def round_length(longest: float) -> float:
    """The longest of 10, 20, 50, 100, ... that is no longer than this [mm]."""
    decade = 10.0 ** np.floor(np.log10(longest))
    return float(max(step * decade for step in (1.0, 2.0, 5.0) if step * decade <= longest))


def limits(
    points: NDArray[np.float64], room: tuple[float, float, float, float]
) -> tuple[float, float, float, float]:
    """left, right, bottom, top round (n, 2) points, with this room at each side."""
    (left, bottom), (right, top) = points.min(axis=0), points.max(axis=0)
    ends = left - room[0], right + room[1], bottom - room[2], top + room[3]
    return tuple(map(float, ends))  # pyright: ignore[reportReturnType]


def plain(ax: Axes, box: tuple[float, float, float, float]) -> None:
    """Axes without a frame, true to scale, for left, right, bottom, top [mm]."""
    ax.set(xlim=box[:2], ylim=box[2:], aspect="equal")
    ax.set_axis_off()


def mm(metres: float, digits: int = 4) -> str:
    """A length [m] as a number of millimetres."""
    # Nothing is ever minus zero.
    return minus(f"{round(metres * MM, 3) + 0.0:.{digits}g}")


def mm_pair(vector: Sequence[float]) -> str:
    """The two components [m] of a vector as "(x, y)" in millimetres."""
    x, y = vector
    return f"({mm(x, 6)}, {mm(y, 6)})"
