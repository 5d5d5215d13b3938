"""Whether all anchors within a disc are proved concave."""

import numpy as np

from stepwell.concave.certificate import Simple, certify
from stepwell.kernels import entry

_DEPTH = 7


@entry()
def concave_disc(cell: Simple, radius: float) -> bool:
    """Whether every anchor within `radius` [m] of the cell's own is proved concave and taut.

    The proof for a disc is tried first, then for smaller ones that cover it.
    """
    if certify(cell, radius):
        return True
    x = np.empty(4 * _DEPTH + 4)
    y = np.empty(4 * _DEPTH + 4)
    half = np.empty(4 * _DEPTH + 4)
    x[0], y[0], half[0] = 0.0, 0.0, radius
    waiting = 1
    while waiting > 0:
        waiting -= 1
        u, v, h = x[waiting], y[waiting], half[waiting]
        # The square's nearest point: squares outside the disc need no proof.
        near_u, near_v = max(abs(u) - h, 0.0), max(abs(v) - h, 0.0)
        if near_u * near_u + near_v * near_v > radius * radius:
            continue
        here = Simple(
            cell.dx + u, cell.dy + v, cell.stiffness, cell.rest, cell.lever, cell.sin_limit
        )
        if certify(here, np.sqrt(2.0) * h):
            continue
        if h <= radius * 0.5**_DEPTH:
            return False
        for su in (-0.5, 0.5):
            for sv in (-0.5, 0.5):
                x[waiting], y[waiting], half[waiting] = u + su * h, v + sv * h, 0.5 * h
                waiting += 1
    return True
