"""End forces of a taut band against its anchors, with their slopes."""

from math import inf

import numpy as np

from stepwell.concave.certificate import Simple, band_length, length_slopes
from stepwell.kernels import entry, kernel


@entry()
def end_force(cell: Simple, side: int, dx: float, dy: float) -> tuple[float, float, float]:
    """F0 (side -1) or F1 (side +1) [N] of the cell with its anchors at d, and ∂F/∂d [N/m].

    From F = k (1 - ℓ0/ℓ) g with g = d_y - d_x tan θ: ∂g = (-tan θ, 1) and ∂ℓ is the unit vector
    along the band.
    """
    t = side * cell.sin_limit
    c = np.sqrt(1.0 - t * t)
    length = band_length(t, c, dx, dy, cell.lever)
    slope, _, _ = length_slopes(t, c, length, dx, dy, cell.lever)
    stretch = 1.0 - cell.rest / length
    pull = cell.rest * slope / (length * length)
    return (
        cell.stiffness * (length - cell.rest) * slope,
        cell.stiffness * (pull * (cell.lever * c + dx) - stretch * t / c),
        cell.stiffness * (pull * (cell.lever * t + dy) + stretch),
    )


@entry(1e-5, "d")
def end_forces_at(cell: Simple, side: int, d, out):
    """`end_force` of every row of d, (m, 2) [m], into out, (m, 3)."""
    for i in range(len(d)):
        out[i] = end_force(cell, side, d[i, 0], d[i, 1])


@kernel
def steepest(cell: Simple, side: int, dx: float, dy: float, radius: float) -> float:
    """A bound on |∂F/∂d| [N/m] over all anchors within `radius` of d; infinite if ℓ may be 0.

    On that disc ℓ and |g| c differ by at most the radius from their values in its middle.
    """
    t = side * cell.sin_limit
    c = np.sqrt(1.0 - t * t)
    length = band_length(t, c, dx, dy, cell.lever)
    shortest, longest = length - radius, length + radius
    if not shortest > 0.0:
        return inf
    g = abs(dy - dx * t / c) + radius / c
    stretch = max(abs(1.0 - cell.rest / shortest), abs(1.0 - cell.rest / longest))
    return cell.stiffness * (cell.rest * g / (shortest * shortest) + stretch / c)
