"""End forces F0 and F1 of a taut band: their slopes, bounds on these, and many cells at once."""

from math import inf
from typing import Any

import numpy as np

from stepwell.base import Bools, Floats
from stepwell.concave.cell import Simple, force_of, of_row
from stepwell.concave.certificate import certify
from stepwell.kernels import entry, leaf
from stepwell.mechanism import (
    band_direction,
    band_force,
    band_length,
    force_by,
    hooke,
    length_slope,
    reach_along,
    slopes_by_anchor,
    slopes_by_lever,
)


@entry()
def end_forces(cell: Simple) -> tuple[float, float]:
    """F0 and F1 [N] of a taut band."""
    return force_of(cell, -cell.sin_limit)[0], force_of(cell, cell.sin_limit)[0]


@entry()
def end_force(cell: Simple, side: int, dx: float, dy: float) -> tuple[float, float, float]:
    """F0 (side -1) or F1 (side +1) [N] of the cell with its anchors at d, and ∂F/∂d [N/m]."""
    t = side * cell.sin_limit
    c = np.sqrt(1.0 - t * t)
    length = band_length(t, c, dx, dy, cell.lever)
    first = length_slope(t, c, length, dx, dy)
    x, y = band_direction(t, c, length, dx, dy, cell.lever)
    first_x, first_y = slopes_by_anchor(t, c, length, first, x, y)
    tension, stiffness, _ = hooke(cell.stiffness, length - cell.rest)
    return (
        band_force(tension, first),
        force_by(tension, stiffness, first, x, first_x),
        force_by(tension, stiffness, first, y, first_y),
    )


def slopes_by_sizes(cell: Simple, side: Any, dx: Any, dy: Any) -> tuple[Any, Any]:
    """∂F/∂ℓ0 [N/m] and ∂F/∂r [N/m] of the same end force, of numbers or arrays."""
    t = side * cell.sin_limit
    c = np.sqrt(1.0 - t * t)
    length = band_length(t, c, dx, dy, cell.lever)
    first = length_slope(t, c, length, dx, dy)
    by, first_by = slopes_by_lever(t, c, length, first, dx, dy, cell.lever)
    tension, stiffness, _ = hooke(cell.stiffness, length - cell.rest)
    return band_force(-stiffness, first), force_by(tension, stiffness, first, by, first_by)


@entry(1e-5, "d")
def end_forces_at(cell: Simple, side: int, d: Floats, out: Floats) -> None:
    """`end_force` of every row of d, (m, 2) [m], into out, (m, 3)."""
    for i in range(len(d)):
        out[i] = end_force(cell, side, d[i, 0], d[i, 1])


def end_force_field(cell: Simple, side: int, d: Floats) -> Floats:
    """`end_force` at differences d, (..., 2) [m], as (..., 3)."""
    out = np.empty((*d.shape[:-1], 3))
    end_forces_at(cell, side, np.ascontiguousarray(d).reshape(-1, 2), out.reshape(-1, 3))
    return out


@entry(7e-6, "numbers")
def _proved_ends(numbers: Floats, ends: Floats, proved: Bools) -> None:
    for i in range(len(numbers)):
        cell = of_row(numbers[i])
        proved[i] = certify(cell, 0.0)
        if proved[i]:
            ends[i, 0], ends[i, 1] = end_forces(cell)


def proved_ends(numbers: Floats) -> tuple[Floats, Bools]:
    """F0 and F1 [N] of m cells, with the proof that they are all there is to know.

    Args:
        numbers: (m, 6) a cell a row, as the fields of `Simple`.

    Returns:
        (m, 2) forces, zero where nothing is proved, and (m,) whether the cell is certified.
    """
    ends, proved = np.zeros((len(numbers), 2)), np.empty(len(numbers), np.bool_)
    _proved_ends(numbers, ends, proved)
    return ends, proved


@leaf
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
    g = abs(reach_along(t, c, dx, dy)) + radius / c
    stretch = max(abs(1.0 - cell.rest / shortest), abs(1.0 - cell.rest / longest))
    # ∂F/∂d = (T' - T/ℓ) ℓ' ∂ℓ/∂d + T/ℓ ∂g/∂d, every factor at its worst.
    k = cell.stiffness
    return force_by(k * stretch, k * cell.rest / shortest, g / shortest, 1.0, 1.0 / c)
