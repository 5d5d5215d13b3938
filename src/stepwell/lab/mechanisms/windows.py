"""Where along a stroke the rig speaks, and not the mechanism."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Found on the paper's rig and stated beside the results: slack is taken up within half a
# millimetre, blocks touch in the last quarter, and the next cell takes over within two.
SETTLE = 0.5e-3
END = 0.25e-3
BEFORE, AFTER = 0.5e-3, 2.0e-3


def quiet_zones(
    full: float, unloading: bool, first: float | None = None
) -> list[tuple[float, float]]:
    """Strokes between which a recording is not judged [m].

    Args:
        full: stroke with every cell at state 1 [m].
        unloading: whether the stroke falls.
        first: full travel of the cell that moves first, in a pair [m].
    """
    far = 1.0
    if unloading:
        zones = [(full - SETTLE, far), (-far, END)]
        if first is not None:
            zones.append((full - first - AFTER, full - first + BEFORE))
        return zones
    zones = [(-far, SETTLE), (full - END, far)]
    if first is not None:
        zones.append((first - BEFORE, first + AFTER))
    return zones


def judged(stroke: Array, zones: list[tuple[float, float]]) -> NDArray[np.bool_]:
    """Which strokes (n,) [m] lie in no quiet zone."""
    inside = np.ones(len(stroke), bool)
    for low, high in zones:
        inside &= ~((stroke >= low) & (stroke <= high))
    return inside
