"""Names inside the regions of a map, where they fit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.transforms import Bbox
from matplotlib.typing import ColorType
from numpy.typing import NDArray

from stepwell.figures.common import on_white


def name_regions(
    ax: Axes,
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    inside: NDArray[np.bool_],
    forms: Sequence[str],
    shade: ColorType,
) -> list[Bbox]:
    """Write a name in every connected region that has room for it.

    Args:
        ax: axes with their final limits, `x` and `y` at equal steps on the page.
        x, y: (nx,), (ny,) nodes of the map, in data units.
        inside: (ny, nx) which nodes belong to the regions of that name.
        forms: ways to write the name, the best first.
        shade: of the regions, behind the name.

    Returns:
        The boxes of what was written [display units].
    """
    from scipy import ndimage

    number, count = cast("tuple[NDArray[np.intp], int]", ndimage.label(inside))
    written: list[Bbox] = []
    frame = ax.get_window_extent()
    per_x, per_y = frame.width / len(x), frame.height / len(y)
    for region in range(1, count + 1):
        part = np.pad(number == region, 1)
        for form in forms:
            look = {"fontweight": "bold", "fontsize": 7, "linespacing": 0.95}
            text = ax.text(0, 0, form, ha="center", va="center", **look)
            box = text.get_window_extent()
            # Text is wider than high: a region's best place is where that shape fits best.
            shape = (per_y / box.height, per_x / box.width)
            depth = np.asarray(ndimage.distance_transform_edt(part, sampling=shape))
            # Of places as good as the best, the one in their middle.
            best = np.argwhere(depth >= 0.98 * depth.max())
            off = np.hypot(*(best - best.mean(axis=0)).T)
            row, column = best[int(np.argmin(off))].tolist()
            if float(depth[row, column]) >= 0.55:
                text.set_position((float(x[column - 1]), float(y[row - 1])))
                text.set_bbox(on_white(0.15) | {"facecolor": shade})
                written.append(text.get_window_extent())
                break
            text.remove()
    return written
