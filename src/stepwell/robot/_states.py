"""The states of a leg by phase, from the travels of its cells."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# A cell within this share of its full travel from a stop counts as being there: weight on a foot
# holds its cell a little open, and a compliant drive stops short.
TOLERANCE = 0.2


def gait(share: NDArray[np.float64], tolerance: float = TOLERANCE) -> str:
    """The states that follow each other, as "00>10>11>01>00".

    Args:
        share: (n, cells) travel of each cell over its full travel [1], over one cycle.
        tolerance: share of its travel within which a cell counts as at its stop [1].
    """
    at_0, at_1 = share < tolerance, share > 1.0 - tolerance
    states = at_1[(at_0 | at_1).all(axis=1)]
    if not len(states):
        return ""
    new = np.concatenate([[True], (states[1:] != states[:-1]).any(axis=1)])
    return ">".join("".join("1" if one else "0" for one in state) for state in states[new])
