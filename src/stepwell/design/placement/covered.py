"""Whether a band is proved taut and concave wherever its anchor may be."""

import math

import numpy as np

from stepwell.concave import certified
from stepwell.design.placement.candidates import Rule
from stepwell.design.placement.region import Region

_FINEST = 64  # squares along the longer side of the region


def all_proved(rule: Rule, region: Region) -> bool:
    """Whether every kind of cell is proved at every place of the region.

    Squares cover the region; a disc round each is proved as a whole, or cut into four.
    """
    box = region.bounds
    side = max(box.right - box.left, box.top - box.bottom)
    for kind in rule.kinds:
        middles = np.array([[(box.left + box.right) / 2, (box.bottom + box.top) / 2]])
        half = side / 2
        while len(middles):
            if half < side / 2 / _FINEST:
                return False
            held = certified(kind.cell, middles - np.array(rule.p), half * math.sqrt(2.0))
            corners = half / 2 * np.array([(-1, -1), (1, -1), (-1, 1), (1, 1)])
            middles = (middles[~held][:, None] + corners).reshape(-1, 2)
            half /= 2
            away = np.max(np.abs(region.clamped(middles) - middles), axis=1)
            middles = middles[away <= half * (1 + 1e-9)]
    return True
