"""What cannot occur: all graphs that the order of end forces allows, and where that is all."""

from __future__ import annotations

from functools import cache
from itertools import permutations

import numpy as np

from stepwell.atlas.canonical import canonical
from stepwell.concave import STROKE, Simple, concave_box, graph_by_ends, same_travel
from stepwell.mechanism import Chain
from stepwell.studies import Axis, packed

# 4 cells have 105 orders, 5 have 945, each with 120 numberings.
_MOST = 4


@cache
def possible(cells: int, drive: int) -> frozenset[str] | None:
    """The canonical texts of all graphs that concave cells of one travel can have, proved.

    Where end forces alone tell the graph, it is that of their order, and the orders can be listed:
    every F1 is below its own F0, and which cell is which does not matter. Under a stroke that is so
    of two cells; of more, a snap may land by forces in between, and None is returned. Chains with
    a tie are none of these.

    Args:
        cells: how many.
        drive: STROKE or FORCE.

    Source: ours (theory page, "Graphs in closed form").
    """
    if cells > _MOST or (drive == STROKE and cells > 2):
        return None
    found: set[str] = set()
    for order in permutations(range(2 * cells)):
        ends = np.array(order, float).reshape(cells, 2)
        rising = np.all(np.diff(ends[:, 0]) > 0)
        if rising and np.all(ends[:, 1] < ends[:, 0]):
            found.add(canonical(graph_by_ends(ends, drive), cells))
    return frozenset(found)


def proved_space(chain: Chain, axes: tuple[Axis, ...]) -> bool:
    """Whether every design of a space has concave taut cells of one travel, proved.

    Args:
        chain: that is varied.
        axes: what varies; anchors and stiffness, on which the proof does not hang.
    """
    numbers = packed(chain, [axis.name for axis in axes])
    values = np.array([(axis.low, axis.high) for axis in axes])
    ends = numbers.slopes[..., None] * values[:, None, None, :]
    low = numbers.base + np.sum(np.min(ends, axis=-1), axis=0)
    high = numbers.base + np.sum(np.max(ends, axis=-1), axis=0)
    # ℓ0, r and θc are those of the drawing, and k > 0 scales both sides of the certificate.
    if np.any(low[:, 3:] != high[:, 3:]) or np.any(low[:, 2] <= 0):
        return False
    travels = low[:, 4] * low[:, 5]
    if not same_travel(np.max(travels), np.min(travels)):
        return False
    return all(
        concave_box(Simple(*row), row[:2], top[:2]) for row, top in zip(low, high, strict=True)
    )
