"""The states of a leg by phase, from the travels of its cells."""

from __future__ import annotations

import numpy as np

from stepwell.base import Floats

# A cell within this share of its full travel from a stop counts as being there: weight on a foot
# holds its cell a little open, and a compliant drive stops short.
TOLERANCE = 0.2


def states(share: Floats, tolerance: float = TOLERANCE) -> list[str | None]:
    """States as "01", or None where a cell is in transit.

    Args:
        share: (n, cells) travel of each cell over its full travel [1].
        tolerance: share of its travel within which a cell counts as at its stop [1].

    Returns:
        One for each of the n.
    """
    at_0, at_1 = np.asarray(share < tolerance), np.asarray(share > 1.0 - tolerance)
    resting = np.asarray((at_0 | at_1).all(axis=1))
    return [
        "".join("1" if one else "0" for one in row) if rests else None
        for row, rests in zip(at_1, resting, strict=True)
    ]


def gait(share: Floats, tolerance: float = TOLERANCE) -> str:
    """The states that follow each other, as "00>10>11>01>00".

    Args:
        share: (n, cells) travel of each cell over its full travel [1], over one cycle.
        tolerance: share of its travel within which a cell counts as at its stop [1].

    Returns:
        The states without repetition, "" where none is visited.
    """
    visited: list[str] = []
    for state in states(share, tolerance):
        if state is not None and (not visited or visited[-1] != state):
            visited.append(state)
    return ">".join(visited)
