"""The end forces that the allowed anchors can give, as curves round them."""

import numpy as np

from stepwell.base import Bools, Floats
from stepwell.design.placement.candidates import Rule
from stepwell.design.placement.region import Region
from stepwell.design.plane import Box, narrowed, trace

_NODES = 81
_HALVINGS = 16


def outlines(rule: Rule, region: Region) -> list[Floats]:
    """Closed curves (m, 2) of (F0, F1) [N] round what one cell can have, for every kind.

    The images of the edges of the allowed anchors, each edge found on a grid and narrowed.
    """
    box = region.bounds
    grid = Box(box.left, box.right, box.bottom, box.top).grid(_NODES)
    # One more node all round, so that the sides of the box are edges like all others.
    rim = np.pad(grid, ((1, 1), (1, 1), (0, 0)), mode="reflect", reflect_type="odd")
    found: list[Floats] = []
    for k in range(len(rule.kinds)):

        def allowed(q: Floats, k: int = k) -> Bools:
            return region.holds(q) & rule.allowed(q, k)

        label = np.zeros(rim.shape[:2], np.int64)
        label[1:-1, 1:-1] = allowed(grid.reshape(-1, 2)).reshape(_NODES, _NODES)
        for line in trace(label, lambda row, column: 0):
            ends = tuple(line.low.T), tuple(line.high.T)
            inside = label[ends[0]] == 1
            low = np.where(inside[:, None], rim[ends[0]], rim[ends[1]])
            high = np.where(inside[:, None], rim[ends[1]], rim[ends[0]])
            yes = np.ones(len(low), np.bool_)
            low, _, _ = narrowed(allowed, low, high, yes, ~yes, _HALVINGS)
            # A corner of the box is the end of two edges.
            new = np.append(True, np.any(np.diff(low, axis=0) != 0.0, axis=1))
            found.append(rule.end_forces(low[new], k))
    return found
