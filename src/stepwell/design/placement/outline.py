"""What allowed anchors can give: the end forces, as curves round them; whether all is proved."""

import math

import numpy as np

from stepwell.base import Bools, Floats
from stepwell.concave import certified
from stepwell.design.placement.candidates import Rule
from stepwell.design.placement.region import Region
from stepwell.design.plane import narrowed, trace

_NODES = 81
_HALVINGS = 16


def outlines(rule: Rule, region: Region) -> list[Floats]:
    """Closed curves (m, 2) of (F0, F1) [N] round what one cell can have, for every kind.

    The images of the edges of the allowed anchors, each edge found on a grid and narrowed.
    """
    grid = region.bounds.grid(_NODES)
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


_FINEST = 64  # squares along the longer side of the region


def all_proved(rule: Rule, region: Region) -> bool:
    """Whether every kind of cell is proved at every place of the region.

    Squares cover the region; a disc round each is proved as a whole, or cut into four.
    """
    if rule.bends:
        return False
    box = region.bounds
    side = max(box.right - box.left, box.top - box.bottom)
    for kind in rule.kinds:
        middles = np.array([[(box.left + box.right) / 2, (box.bottom + box.top) / 2]])
        half = side / 2
        while len(middles):
            if half < side / 2 / _FINEST:
                return False
            around = rule.stretch * half * math.sqrt(2.0)
            held = certified(kind.cell, rule.differences(middles), around)
            corners = half / 2 * np.array([(-1, -1), (1, -1), (-1, 1), (1, 1)])
            middles = (middles[~held][:, None] + corners).reshape(-1, 2)
            half /= 2
            away = np.max(np.abs(region.clamped(middles) - middles), axis=1)
            middles = middles[away <= half * (1 + 1e-9)]
    return True
