"""The simple cell, with one linear band only, as plain numbers for compiled code.

Its formulas hold while the band is in tension, which `certify` proves.
"""

from typing import Any, NamedTuple

import numpy as np

from stepwell import mechanism as mech
from stepwell.base import Floats
from stepwell.kernels import leaf
from stepwell.mechanism import Cell, Element, Laws, Linear, geometry


class Simple(NamedTuple):
    """A cell with one linear band and nothing else, as plain numbers."""

    dx: float  # q - p [m]
    dy: float  # [m]
    stiffness: float  # k [N/m]
    rest: float  # ℓ0 [m]
    lever: float  # r [m]
    sin_limit: float  # sin θc


def simple(cell: Cell | Element) -> Simple | None:
    """The cell as plain numbers; None for other than one linear band without load and friction."""
    if isinstance(cell, Element) or len(cell.bands) != 1:
        return None
    if cell.load is not None or cell.friction > 0:
        return None
    band = cell.bands[0]
    if not isinstance(band.law, Linear):
        return None
    return Simple(*band.d, band.stiffness, band.rest_length, cell.lever, cell.sin_limit)


def simple_rows(laws: Laws) -> Floats | None:
    """(N, 6) the cells of a packed chain, one a row, or None where one of them is not simple."""
    n = len(laws.lever)
    one_band = len(laws.band) == n and bool(np.all(np.diff(laws.band_first) == 1))
    if not one_band or len(laws.rows) != n or np.any(laws.friction > 0):
        return None
    if laws.band_rows[-1] != n or not np.all(laws.rows == Linear().pieces()):
        return None
    return np.column_stack([laws.band, laws.lever, laws.sin_limit])


@leaf
def of_row(row: Any) -> Simple:
    """The cell whose six numbers are a row of an array."""
    return Simple(row[0], row[1], row[2], row[3], row[4], row[5])


@leaf
def with_d(cell: Simple, dx: float, dy: float) -> Simple:
    """The same cell with other anchors, d = q - p [m]."""
    return Simple(dx, dy, cell.stiffness, cell.rest, cell.lever, cell.sin_limit)


@leaf
def full_travel(cell: Simple) -> float:
    """S = 2 r sin θc [m]."""
    return geometry.travel_of(cell.sin_limit, cell.lever, cell.sin_limit)


@leaf
def force_of(cell: Simple, sin: float) -> tuple[float, float]:
    """F [N] and κ = dF/ds [N/m] of a taut band at sin θ."""
    cos = np.sqrt(1.0 - sin * sin)
    length = geometry.band_length(sin, cos, cell.dx, cell.dy, cell.lever)
    g, g1, g2 = geometry.reach_slopes(sin, cos, cell.dx, cell.dy, cell.lever)
    stretch = length - cell.rest
    tension, stiffness, _ = mech.hooke(cell.stiffness, stretch)
    h = geometry.steepening(length, stretch, 0.0, stiffness, 0.0, 0.0)
    force, slope, _ = geometry.force_slopes(tension, 0.0, h, length, g, g1, g2)
    return force, slope


@leaf
def force_at(cell: Simple, travel: float) -> tuple[float, float]:
    """F [N] and κ = dF/ds [N/m] of a taut band at a travel [m]."""
    return force_of(cell, geometry.sine_at(travel, cell.lever, cell.sin_limit))


@leaf
def energy_at(cell: Simple, travel: float) -> float:
    """E [J] of a taut band at a travel [m]."""
    sin = geometry.sine_at(travel, cell.lever, cell.sin_limit)
    length = geometry.band_length(sin, np.sqrt(1.0 - sin * sin), cell.dx, cell.dy, cell.lever)
    return mech.hooke(cell.stiffness, length - cell.rest)[2]


@leaf
def travel_at(cell: Simple, force: float, f_low: float, f_high: float) -> float:
    """The unique travel [m] at which a certified cell resists with `force` [N].

    Forces beyond F0 and F1, `f_low` and `f_high`, give the stops. Newton inside a bracket that
    shrinks at every step.
    """
    low, high = 0.0, full_travel(cell)
    # F falls: above `force` at low, below it at high.
    if force >= f_low:
        return low
    if force <= f_high:
        return high
    enough = 1e-9 * high
    travel = (f_low - force) / (f_low - f_high) * high
    for _ in range(100):
        value, slope = force_at(cell, travel)
        if value == force:
            break
        if value > force:
            low = travel
        else:
            high = travel
        following = travel + (force - value) / slope
        if low < following < high:
            # Newton squares the error: after a step this small only rounding is left, and
            # a step of exactly zero may never come.
            done = abs(following - travel) <= enough
        else:
            following = 0.5 * (low + high)
            done = not low < following < high
        travel = following
        if done:
            break
    return travel


@leaf
def most_bend(cell: Simple) -> float:
    """A bound of |d²F/ds²| [N/m²] over the whole travel, every factor at its worst."""
    t = cell.sin_limit
    c = np.sqrt(1.0 - t * t)
    r = cell.lever
    shortest = min(
        geometry.band_length(-t, c, cell.dx, cell.dy, r),
        geometry.band_length(t, c, cell.dx, cell.dy, r),
    )
    d = np.sqrt(cell.dx * cell.dx + cell.dy * cell.dy)
    longest = geometry.band_length(cell.dy / d, cell.dx / d, cell.dx, cell.dy, r)
    g = geometry.reach_along(t, c, -cell.dx, abs(cell.dy))
    g1 = cell.dx / (r * c * c * c)
    g2 = 3.0 * cell.dx * t / (r * r * c * c * c * c * c)
    first = g / shortest
    _, stiffness, _ = mech.hooke(cell.stiffness, 0.0)
    # In tension T/ℓ = k (1 - ℓ0/ℓ) grows with ℓ, and its slope k ℓ0/ℓ² falls.
    h = geometry.steepening(shortest, shortest - cell.rest, 0.0, stiffness, 0.0, 0.0)
    ratio = mech.hooke(cell.stiffness, longest - cell.rest)[0] / longest
    return geometry.band_force(3.0 * h * first, g1 + first * first) + geometry.band_force(ratio, g2)
