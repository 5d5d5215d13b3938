"""What lies between the nodes of a map: the same as at the nodes, up to the exact boundaries."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from stepwell.base import Bools, Floats

# Places along each axis: finer than a printed page shows.
PLACES = 480
# So many of the nodes that a boundary encloses have to agree, or it leaks and encloses nothing.
_AGREE = 0.97


def between(
    nodes: NDArray[np.intp], x: Floats, y: Floats, curves: Sequence[Floats]
) -> NDArray[np.intp]:
    """(n, n) what is at fine places, as at the nodes that no curve parts them from.

    Args:
        nodes: (ny, nx) what is at each node, a number >= 0.
        x, y: (nx,), (ny,) where the nodes are, between 0 and 1 on the page.
        curves: (m, 2) each boundary, in the same measure.

    Returns:
        Rows from 0 to 1 along y, columns along x. What no node tells, because a boundary is open
        or encloses none, is that of the nearest node.
    """
    from scipy import ndimage

    rows, columns = (_index(one) for one in (y, x))
    fine = np.linspace(0.0, 1.0, PLACES)
    nearest = nodes[np.ix_(_nearest(y, fine), _nearest(x, fine))]
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
    found = np.where(agreed[part], seen.argmax(axis=1)[part], nearest)
    if not agreed.any():
        return found
    # A boundary itself belongs to what is beside it.
    beside = cast(
        "NDArray[np.intp]",
        ndimage.distance_transform_edt(wall, return_distances=False, return_indices=True),
    )
    return found[tuple(beside)]


def _nearest(nodes: Floats, places: Floats) -> NDArray[np.intp]:
    """The node that is nearest to each place."""
    return np.searchsorted((nodes[1:] + nodes[:-1]) / 2, places)


def _index(share: Any) -> NDArray[np.intp]:
    """Which places these are, those outside at the edge."""
    return np.clip(np.rint(np.asarray(share) * (PLACES - 1)), 0, PLACES - 1).astype(int)


def _drawn(curve: Floats) -> NDArray[np.intp]:
    """Column and row of every place on a curve, without a gap."""
    steps = np.ceil(4 * PLACES * np.abs(np.diff(curve, axis=0)).max(axis=1, initial=0.0))
    along = np.concatenate([[0.0], np.cumsum(np.maximum(steps, 1.0))])
    at = np.arange(along[-1] + 1.0)
    points = np.column_stack([np.interp(at, along, column) for column in curve.T])
    inside = np.all((points > -0.01) & (points < 1.01), axis=1)
    return _index(points[inside])
