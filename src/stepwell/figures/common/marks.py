"""Marks of paths, and dimensions and scale bars of drawings."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.typing import LineStyleType

from stepwell.base import Floats
from stepwell.figures.common import legends, reading, sheet, style, words
from stepwell.figures.common.sheet import Box, Point
from stepwell.figures.common.style import INK, MM, direction_colour, hollow
from stepwell.statics import Path

_BOTH = {"arrowstyle": "<|-|>", "linewidth": 0.6, "mutation_scale": 5, "shrinkA": 0, "shrinkB": 0}


def along_x(
    ax: Axes, ends: Point, heights: Point, text: str, colour: str = INK, gid: str | None = None
) -> None:
    """Draw a dimension along x at the second height [mm], with thin lines from the first."""
    (left, right), (feet, y) = ends, heights
    look = {"color": colour, "linewidth": 0.4, "zorder": 2.5, "gid": gid}
    for x in (left, right):
        ax.plot([x, x], [feet, y + np.sign(y - feet)], **look)
    ax.annotate("", (right, y), (left, y), arrowprops=_BOTH | {"color": colour}, zorder=8)
    middle = (left + right) / 2
    ax.text(middle, y + 1.0, text, ha="center", va="bottom", zorder=9, bbox=style.on_white())


def along_y(
    ax: Axes, ends: Point, places: Point, text: str, colour: str = INK, gid: str | None = None
) -> None:
    """Draw a dimension along y at the second place along x [mm], with thin lines from the first."""
    (low, high), (feet, x) = ends, places
    look = {"color": colour, "linewidth": 0.4, "zorder": 2.5, "gid": gid}
    for y in (low, high):
        ax.plot([feet, x + np.sign(x - feet)], [y, y], **look)
    ax.annotate("", (x, high), (x, low), arrowprops=_BOTH | {"color": colour}, zorder=8)
    ax.text(x - 1.2, (low + high) / 2, text, ha="right", va="center", rotation=90, zorder=9)


def arrow(
    ax: Axes,
    tail: Sequence[float] | Floats,
    tip: Sequence[float] | Floats,
    colour: str = INK,
    width: float = 0.6,
) -> None:
    """Draw an arrow from tail to tip [mm]; width 0 draws the head alone."""
    size = 5.0 + 2.0 * (width == 0 or width >= 1)
    props = {"arrowstyle": "-|>", "color": colour, "linewidth": width, "mutation_scale": size}
    ax.annotate("", (tip[0], tip[1]), (tail[0], tail[1]), arrowprops=_BOTH | props, zorder=8)


def scale_bar(ax: Axes, right: float, y: float, length: float) -> None:
    """Draw a bar of this length [mm] that ends at `right`, with its length above it."""
    look = {"color": INK, "linewidth": 1.6, "solid_capstyle": "butt", "gid": "scale bar"}
    ax.plot([right - length, right], [y, y], **look, zorder=9)
    label = f"{length:g} mm" if length < 1000 else f"{length / 1000:g} m"
    place: dict[str, Any] = {"textcoords": "offset points", "ha": "center", "va": "bottom"}
    ax.annotate(label, (right - length / 2, y), (0.0, 2.5), **place, zorder=9)


def round_length(longest: float) -> float:
    """The largest of 10, 20, 50, 100, ... that does not exceed `longest` [mm]."""
    decade = 10.0 ** np.floor(np.log10(longest))
    return float(max(step * decade for step in (1.0, 2.0, 5.0) if step * decade <= longest))


def limits(points: Floats, room: Box) -> Box:
    """left, right, bottom, top of (n, 2) points, with a margin `room` at each side."""
    (left, bottom), (right, top) = points.min(axis=0), points.max(axis=0)
    ends = left - room[0], right + room[1], bottom - room[2], top + room[3]
    return tuple(map(float, ends))  # pyright: ignore[reportReturnType]


def plain(ax: Axes, box: Box) -> None:
    """Set axes to left, right, bottom, top [mm], true to scale and without a frame."""
    ax.set(xlim=box[:2], ylim=box[2:], aspect="equal")
    ax.set_axis_off()


def mm(metres: float, digits: int = 4) -> str:
    """A length [m] as a number of millimetres."""
    # Nothing is ever minus zero.
    return words.minus(f"{round(metres * MM, 3) + 0.0:.{digits}g}")


def mm_pair(vector: Sequence[float]) -> str:
    """The two components [m] of a vector as "(x, y)" in millimetres."""
    x, y = vector
    return f"({mm(x, 6)}, {mm(y, 6)})"


# Legend entry of the states of a chain with elements.
STATE = "state, middle of its range"
# More arrow heads would cover the curve.
MOST_HEADS = 40
SNAP_DASHES: LineStyleType = (0, (2.2, 1.4))


def snaps(
    ax: Axes, samples: Sequence[reading.SnapSamples], x: Floats, y: Floats, size: float = 4.2
) -> None:
    """Draw snaps as dashed lines from open circles of this size [pt] to arrow heads."""
    for direction in (1, -1):
        some = [snap for snap in samples if snap.direction * direction > 0]
        if not some:
            continue
        colour = direction_colour(direction)
        ends = np.array([(snap.before, snap.after) for snap in some])
        gap = np.full(len(some), np.nan)
        jumps = [np.column_stack([column[ends], gap]).ravel() for column in (x, y)]
        look = {"color": colour, "linestyle": SNAP_DASHES, "linewidth": 1.1}
        ax.plot(*jumps, **look, zorder=5, gid="snaps")
        circles = hollow(size, colour, markeredgewidth=1.1, zorder=6)
        ax.plot(x[ends[:, 0]], y[ends[:, 0]], "o", **circles, gid="snap starts")
        if len(some) <= MOST_HEADS:
            for i, j in ends:
                head(ax, (float(x[i]), float(y[i])), (float(x[j]), float(y[j])), colour)


def trace(
    ax: Axes, path: Path, x: Floats, y: Floats, widths: Point, unloading_style: LineStyleType = "-"
) -> None:
    """Draw the smooth stretches of a path, unloading over loading, with their widths [pt]."""
    looks = ((1, widths[0], "-", 3), (-1, widths[1], unloading_style, 4))
    for direction, width, dashes, zorder in looks:
        look = {"color": direction_colour(direction), "linewidth": width, "linestyle": dashes}
        ax.plot(*reading.curve(path, direction, x, y), **look, zorder=zorder)


def headings(ax: Axes, path: Path, x: Floats, y: Floats, sizes: Point = (10.0, 10.0)) -> None:
    """Draw an arrow head on every leg of the path, unless there are too many. `sizes` are those of
    loading and unloading [pt]. The axes must have their final limits.
    """
    legs = reading.legs(path)
    for direction, at in legs if len(legs) <= MOST_HEADS else ():
        # Not in the middle: where both directions coincide, one head would hide the other.
        size = sizes[0 if direction > 0 else 1]
        heading(ax, x[at], y[at], direction_colour(direction), at=0.4, size=size)


def head(
    ax: Axes, start: Sequence[float], end: Sequence[float], colour: str, size: float = 7.0
) -> None:
    """Draw an arrow head at `end` that points away from `start`."""
    props = {"arrowstyle": "-|>,head_length=0.45,head_width=0.2", "mutation_scale": size}
    props |= {"linewidth": 0, "color": colour, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", (end[0], end[1]), (start[0], start[1]), arrowprops=props, zorder=6)


def heading(ax: Axes, x: Floats, y: Floats, colour: str, *, at: float, size: float) -> None:
    """Draw an arrow head at the fraction `at` of a curve's length, unless the curve is short. The
    axes must have their final limits.
    """
    xy = ax.transData.transform(np.column_stack([x, y]))
    frame = ax.get_window_extent()
    along = np.cumsum(np.hypot(*np.diff(xy, axis=0, prepend=xy[:1]).T))
    if along[-1] < 0.2 * min(frame.width, frame.height):
        return
    ends = at * along[-1] + np.array([-1.5, 1.5])
    points = np.column_stack([np.interp(ends, along, xy[:, k]) for k in (0, 1)])
    tail, tip = ax.transData.inverted().transform(points)
    head(ax, tail, tip, colour, size)


def legend(
    ax: Axes,
    path: Path,
    widths: Point,
    unloading_style: LineStyleType = "-",
    more: Sequence[Artist] = (),
    *,
    fit: bool = False,
) -> None:
    """Add the legend of a path and `more` entries above the axes, which may `fit` it. If panels
    share a legend, the entries of the path go there.
    """
    back = legends.line("unloading", style.UNLOADING, widths[1], linestyle=unloading_style)
    circle = hollow(4.2, linestyle=SNAP_DASHES, marker="o")
    entries = legends.applicable(
        (np.any(path.direction > 0), legends.line("loading", style.LOADING, widths[0])),
        (np.any(path.direction < 0), back),
        (np.any(path.snap_after), legends.line("snap", width=1.1, **circle)),
    )
    if (all_share := sheet.current().shared) is None:
        legends.above(ax, [*entries, *more], fit=fit)
    else:
        known = {one.get_label() for one in all_share}
        all_share.extend(one for one in entries if one.get_label() not in known)
        if more:
            legends.above(ax, more)


def zero_line(ax: Axes) -> None:
    """Draw a line at zero force."""
    ax.axhline(0.0, color=style.FAINT, linewidth=0.5, zorder=0)
