"""Closed forms for the simple cell: one linear band, taut all the way, force falling throughout.

Everything here holds only where `certify` says so; elsewhere the general engine is asked.
"""

from typing import NamedTuple

import numpy as np

from stepwell.kernels import entry, kernel
from stepwell.mechanism import Cell, Linear, band_length, length_slopes

__all__ = [
    "Simple",
    "band_length",
    "certify",
    "closed",
    "end_forces",
    "length_slopes",
    "push",
    "simple",
    "travel_at",
]

# A stretch this much shorter than the range is given up on: the cell is so close to a force
# that does not fall that the general engine may as well decide.
_SHORTEST = 1.0 / 4096.0
_MOST_LOOKS = 256
# Rounding in the inequality is below 1e-14 of its sides.
_ROUNDING = 1.0 + 1e-12


class Simple(NamedTuple):
    """A cell with one linear band and nothing else, as plain numbers."""

    dx: float  # q - p [m]
    dy: float  # [m]
    stiffness: float  # k [N/m]
    rest: float  # ℓ0 [m]
    lever: float  # r [m]
    sin_limit: float  # sin θc


def simple(cell: Cell) -> Simple | None:
    """The cell as plain numbers, or None: several bands, a bent law, a load or friction."""
    if len(cell.bands) != 1 or cell.load is not None or cell.friction > 0:
        return None
    band = cell.bands[0]
    if not isinstance(band.law, Linear):
        return None
    sin_limit = float(np.sin(cell.limit))
    return Simple(*band.d, band.stiffness, band.rest_length, cell.lever, sin_limit)


@entry()
def certify(cell: Simple, reach: float) -> bool:
    """Whether the band is taut and F falls strictly over the whole travel, proved.

    And so for every other anchor within `reach` [m] of this one. False means "not proved".

    With t = sin θ, c = cos θ and h = d_y c - d_x t, dF/ds < 0 is the same as

        (ℓ - ℓ0) ℓ² d_x > ℓ0 r c h²

    (multiply κ/k = (ℓ0/ℓ³) g² - (1 - ℓ0/ℓ) d_x/(r c³), g = h/c, by r c³ ℓ³), which with
    d_x > 0 needs ℓ > ℓ0: a falling force proves a taut band, so a spring that pushes is no
    other case. On a stretch of θ both sides are bounded by values at its ends:
    - ℓ² = r² + d² + 2 r d cos(θ - θmax) and |θ - θmax| < π for d_x > 0: ℓ rises to θmax and
      falls after it, so it is smallest at an end;
    - g falls (g' = -d_x/(r c³) by travel), so |h| <= c |g| is at most the largest c times the
      larger end value of |g|; and never more than d;
    - c is largest at an end, or 1 where the stretch holds θ = 0.
    Moving d by at most R changes ℓ, |h| and d_x by at most R each. Stretches that fail are
    halved, those that pass are followed by longer ones.
    """
    r, rest = cell.lever, cell.rest
    dx = cell.dx - reach
    # Written so that a NaN fails it.
    if not dx > 0.0:
        return False
    d = np.sqrt(cell.dx * cell.dx + cell.dy * cell.dy)
    end = cell.sin_limit
    left = -end
    c_left = np.sqrt(1.0 - left * left)
    l_left = band_length(left, c_left, cell.dx, cell.dy, r)
    g_left = abs(cell.dy - cell.dx * left / c_left)
    width = 2.0 * end
    for _ in range(_MOST_LOOKS):
        right = min(left + width, end)
        c_right = np.sqrt(1.0 - right * right)
        l_right = band_length(right, c_right, cell.dx, cell.dy, r)
        g_right = abs(cell.dy - cell.dx * right / c_right)
        c = 1.0 if left <= 0.0 <= right else max(c_left, c_right)
        h = min(c * max(g_left, g_right), d) + reach
        shortest = min(l_left, l_right) - reach
        falls = (shortest - rest) * shortest * shortest * dx > rest * r * c * h * h * _ROUNDING
        if falls and shortest > rest * _ROUNDING:
            if right == end:
                return True
            left, c_left, l_left, g_left = right, c_right, l_right, g_right
            width *= 2.0
        else:
            width *= 0.5
            if not width > _SHORTEST * end:
                return False
    return False


def closed(cell: Cell, *, reach: float = 0.0) -> Simple | None:
    """The cell as plain numbers where the closed forms are proved to hold, else None.

    `reach` [m] asks for the proof at every anchor within that distance as well.
    """
    numbers = simple(cell)
    return numbers if numbers is not None and certify(numbers, reach) else None


@entry()
def end_forces(cell: Simple) -> tuple[float, float]:
    """F0 and F1 [N] of a taut band."""
    t = cell.sin_limit
    c = np.sqrt(1.0 - t * t)
    l0 = band_length(-t, c, cell.dx, cell.dy, cell.lever)
    l1 = band_length(t, c, cell.dx, cell.dy, cell.lever)
    slope_0, _, _ = length_slopes(-t, c, l0, cell.dx, cell.dy, cell.lever)
    slope_1, _, _ = length_slopes(t, c, l1, cell.dx, cell.dy, cell.lever)
    return (
        cell.stiffness * (l0 - cell.rest) * slope_0,
        cell.stiffness * (l1 - cell.rest) * slope_1,
    )


@kernel
def push(cell: Simple, travel: float) -> tuple[float, float]:
    """F [N] and κ = dF/ds [N/m] of a taut band at a travel [m]."""
    t = travel / cell.lever - cell.sin_limit
    c = np.sqrt(1.0 - t * t)
    length = band_length(t, c, cell.dx, cell.dy, cell.lever)
    first, second, _ = length_slopes(t, c, length, cell.dx, cell.dy, cell.lever)
    stretch = length - cell.rest
    return (
        cell.stiffness * stretch * first,
        cell.stiffness * (first * first + stretch * second),
    )


@kernel
def travel_at(cell: Simple, force: float) -> float:
    """The one travel [m] at which a certified cell pushes back with `force` [N].

    Forces beyond F0 and F1 give the stops. Newton inside a bracket that shrinks at every step.
    """
    low, high = 0.0, 2.0 * cell.lever * cell.sin_limit
    # F falls: above `force` at low, below it at high.
    f_low, f_high = end_forces(cell)
    if force >= f_low:
        return low
    if force <= f_high:
        return high
    enough = 1e-9 * high
    travel = (f_low - force) / (f_low - f_high) * high
    for _ in range(100):
        value, slope = push(cell, travel)
        if value == force:
            break
        if value > force:
            low = travel
        else:
            high = travel
        following = travel + (force - value) / slope
        if low < following < high:
            # Newton squares the error: after a step this small only rounding is left, and
            # waiting for a step of zero would be waiting for luck.
            done = abs(following - travel) <= enough
        else:
            following = 0.5 * (low + high)
            done = not low < following < high
        travel = following
        if done:
            break
    return travel
