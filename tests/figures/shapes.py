"""Reading boxes and strips back from a figure."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import Collection
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle


def boxes(drawn: Figure | Axes, gid: str | None = None) -> list[Rectangle]:
    """The bars and bands with this mark; all of them by default."""
    axes = drawn.axes if isinstance(drawn, Figure) else [drawn]
    patches = [patch for ax in axes for patch in ax.patches if gid in (None, patch.get_gid())]
    return [patch for patch in patches if isinstance(patch, Rectangle)]


def ends(box: Rectangle) -> tuple[float, float]:
    """From where to where a box is along x."""
    low, high = sorted((box.get_x(), box.get_x() + box.get_width()))
    return low, high


def strips(drawn: Axes, gid: str) -> list[tuple[float, float]]:
    """From where to where along x each piece of the strip with this mark is."""
    (strip,) = (c for c in drawn.collections if c.get_gid() == gid)
    assert isinstance(strip, Collection)
    edges = [np.asarray(path.vertices)[:, 0] for path in strip.get_paths()]
    return [(float(x.min()), float(x.max())) for x in edges]
