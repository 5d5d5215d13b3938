"""Parts of a map: legend, names of regions, and values between its nodes."""

from collections.abc import Sequence
from typing import Any, NamedTuple, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle
from matplotlib.text import Text
from matplotlib.typing import ColorType, LineStyleType
from numpy.typing import NDArray

from stepwell.base import Bools, Floats
from stepwell.figures.common.marks import plain
from stepwell.figures.common.sheet import sheet_of, size_of
from stepwell.figures.common.style import FAINT, INK, on_white
from stepwell.figures.common.words import literal, wrapped

# Points along each axis: finer than a printed page shows.
PLACES = 480
# Least fraction of equal nodes within a closed boundary; otherwise the boundary has a leak.
_AGREE = 0.97


def between(
    nodes: NDArray[np.intp], x: Floats, y: Floats, curves: Sequence[Floats]
) -> NDArray[np.intp]:
    """Values on a fine grid from 0 to 1 along y and x, from those at the nodes (ny, nx), >= 0.

    A point has the value of the nodes that no curve (m, 2) separates from it. It has that of the
    nearest node if a curve is open or encloses no node.
    """
    from scipy import ndimage

    rows, columns = (_index(one) for one in (y, x))
    fine = np.linspace(0.0, 1.0, PLACES)
    near = (np.searchsorted((at[1:] + at[:-1]) / 2, fine) for at in (y, x))
    nearest = nodes[np.ix_(*near)]
    wall = np.zeros(nearest.shape, bool)
    for curve in curves:
        at = _drawn(curve)
        wall[at[:, 1], at[:, 0]] = True
    part, count = cast("tuple[NDArray[np.intp], int]", ndimage.label(~wall))
    # How often each value occurs at the nodes of each part.
    seen = np.zeros((count + 1, int(nodes.max()) + 1), int)
    np.add.at(seen, (part[np.ix_(rows, columns)], nodes), 1)
    most, total = seen.max(axis=1), seen.sum(axis=1)
    agreed: Bools = (total > 0) & (most >= _AGREE * total)
    agreed[0] = False
    filled = np.where(agreed[part], seen.argmax(axis=1)[part], nearest)
    if not agreed.any():
        return filled
    # Points on a boundary belong to the nearest region.
    nearest_free = ndimage.distance_transform_edt(wall, return_distances=False, return_indices=True)
    return filled[tuple(cast("NDArray[np.intp]", nearest_free))]


def _index(share: Any) -> NDArray[np.intp]:
    """Indices of these fractions of an axis, clipped to its ends."""
    return np.clip(np.rint(np.asarray(share) * (PLACES - 1)), 0, PLACES - 1).astype(int)


def _drawn(curve: Floats) -> NDArray[np.intp]:
    """Column and row of every point on a curve, without gaps."""
    steps = np.ceil(4 * PLACES * np.abs(np.diff(curve, axis=0)).max(axis=1, initial=0.0))
    along = np.cumsum([0.0, *np.maximum(steps, 1.0)])
    at = np.arange(along[-1] + 1.0)
    points = np.column_stack([np.interp(at, along, column) for column in curve.T])
    inside = np.all((points > -0.01) & (points < 1.01), axis=1)
    return _index(points[inside])


# Distance of two lines of text, and additional height of a row [mm].
_LINE, _GAP = 3.1, 1.5
# Width of the sample before the text, and of a character [mm].
_SAMPLE, _CHARACTER = 9.0, 1.5
_EDGE = 3.0


class Row(NamedTuple):
    """One legend row: a box with a letter, or a line with a number, and its meaning."""

    mark: str
    text: str
    shade: ColorType | None = None
    line: tuple[str, LineStyleType] | None = None
    hatched: bool = False


class Key:
    """Legend rows wrapped to a width [mm], and their height."""

    def __init__(self, rows: Sequence[Row], width: float):
        most = int((width - _SAMPLE - 1.0) / _CHARACTER)
        self._rows = [(row, wrapped(row.text, most)) for row in rows]
        lines = sum(len(text) for _, text in self._rows)
        self.width = width
        self.height = 2 * _EDGE + _LINE * lines + _GAP * len(rows)

    def draw(self, ax: Axes) -> None:
        """Write the rows into axes from the top."""
        box, (wide, high) = ax.get_position(), size_of(sheet_of(ax))
        wide, high = wide * box.width, high * box.height
        plain(ax, (0.0, wide, 0.0, high))
        y = high - _EDGE
        for row, lines in self._rows:
            middle = y - _LINE / 2
            if row.line is not None:
                colour, style = row.line
                wide = 1.5 if row.mark else 0.8
                ends = [0.0, _SAMPLE - 1.5]
                ax.plot(ends, [middle] * 2, color=colour, linestyle=style, linewidth=wide)
                if row.mark:
                    badge(ax, sum(ends) / 2, middle, row.mark, colour)
            else:
                look = {"facecolor": row.shade or "white", "edgecolor": FAINT, "linewidth": 0.5}
                hatch = "/////" if row.hatched else None
                ax.add_patch(Rectangle((1.5, middle - 1.7), 4.4, 3.4, **look, hatch=hatch))
                ax.text(3.7, middle, row.mark, ha="center", va="center_baseline", weight="bold")
            for line in lines:
                ax.text(_SAMPLE, y - _LINE / 2, literal(line), va="center_baseline", color=INK)
                y -= _LINE
            y -= _GAP


def badge(ax: Axes, x: float, y: float, text: str, colour: str) -> Text:
    """Write a number on a curve."""
    box = {"boxstyle": "circle,pad=0.12", "facecolor": "white", "edgecolor": colour}
    look: dict[str, Any] = {"ha": "center", "va": "center_baseline", "fontweight": "bold"}
    look |= {"color": colour, "bbox": box | {"linewidth": 0.8}}
    return ax.text(x, y, text, **look, zorder=8, gid="number")


def name_regions(
    ax: Axes, x: Floats, y: Floats, inside: Bools, forms: Sequence[str], shade: ColorType
) -> None:
    """Write a name into every connected region of nodes (ny, nx), in the first form that fits.
    Nodes have equal steps on the page, and the axes have their final limits.
    """
    from scipy import ndimage

    number, count = cast("tuple[NDArray[np.intp], int]", ndimage.label(inside))
    frame = ax.get_window_extent()
    per_x, per_y = frame.width / len(x), frame.height / len(y)
    for region in range(1, count + 1):
        part = np.pad(number == region, 1)
        for form in forms:
            look = {"fontweight": "bold", "fontsize": 7, "linespacing": 0.95}
            text = ax.text(0, 0, form, ha="center", va="center", **look)
            box = text.get_window_extent()
            # Text is wider than high: the best point is where a box of that shape fits best.
            shape = (per_y / box.height, per_x / box.width)
            depth = np.asarray(ndimage.distance_transform_edt(part, sampling=shape))
            # The middle one of all nearly optimal points.
            best = np.argwhere(depth >= 0.98 * depth.max())
            off = np.hypot(*(best - best.mean(axis=0)).T)
            row, column = best[int(np.argmin(off))].tolist()
            if float(depth[row, column]) >= 0.55:
                text.set_position((float(x[column - 1]), float(y[row - 1])))
                text.set_bbox(on_white(0.15) | {"facecolor": shade})
                break
            text.remove()
