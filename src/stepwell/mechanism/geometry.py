"""A band between two blocks on levers: its length, its slopes, and the force it makes of them.

Written for floats and arrays alike, so that NumPy evaluates it and Numba compiles the same
lines for the engine: one formula, one place.
"""

from typing import Any

import numpy as np

from stepwell.kernels import kernel


@kernel
def travel_of(sin: Any, lever: Any, sin_limit: Any) -> Any:
    """Travel s = r (sin θ + sin θc); at θ = θc it is the full travel S."""
    return lever * (sin + sin_limit)


@kernel
def sine_at(travel: Any, lever: Any, sin_limit: Any) -> Any:
    """The inverse: sin θ at a travel."""
    return travel / lever - sin_limit


def between_stops(travel: Any, full: Any) -> Any:
    """Whether a travel [m] is between the stops, to a billionth of the full travel."""
    slip = 1e-9 * full
    return (travel >= -slip) & (travel <= full + slip)


def angle_at(travel: Any, lever: Any, limit: Any, sin_limit: Any) -> Any:
    """Lever angle θ [rad] at a travel between the stops."""
    sine = np.clip(sine_at(travel, lever, sin_limit), -1.0, 1.0)
    return np.clip(np.arcsin(sine), -limit, limit)


@kernel
def band_length(sin: Any, cos: Any, dx: Any, dy: Any, lever: Any) -> Any:
    """ℓ(θ) = |(r cos θ + d_x, r sin θ + d_y)| (Kamp et al. 2024, Eq. 2)."""
    x = lever * cos + dx
    y = lever * sin + dy
    # The anchors are 1e-15 m off one plane: where they meet, ℓ keeps a slope by rounding.
    return np.sqrt(x * x + y * y + 1e-30)


def farthest_angle(dx: Any, dy: Any, limit: Any) -> Any:
    """Lever angle [rad] between -`limit` and `limit` at which a band is longest; arrays too.

    ℓ² = r² + |d|² + 2 r |d| cos(θ - θmax), so it is the angle nearest to θmax = atan2(d_y, d_x).
    """
    return np.clip(np.arctan2(dy, dx), -limit, limit)


def stretch_range(dx: Any, dy: Any, lever: Any, limit: Any) -> tuple[Any, Any]:
    """Least and largest length [m] of a band at angles up to `limit` [rad] in size; exact."""
    # The shortest is nearest to θmax + π, where d has the other sign.
    ends = farthest_angle(-dx, -dy, limit), farthest_angle(dx, dy, limit)
    least, most = (band_length(np.sin(at), np.cos(at), dx, dy, lever) for at in ends)
    return least, most


@kernel
def turn_at(length: Any, reach: Any, lever: Any) -> Any:
    """The inverse: cos(θ - θmax) of a band with |d| = `reach`, by the law of cosines."""
    # Where the band does not turn with the lever, no turn makes it longer: infinite or nearly.
    return (length * length - lever * lever - reach * reach) / (2.0 * lever * reach + 1e-300)


@kernel
def reach_along(sin: Any, cos: Any, dx: Any, dy: Any) -> Any:
    """g = ℓ dℓ/ds = d_y - d_x tan θ: half the slope of ℓ² by travel."""
    return dy - dx * sin / cos


@kernel
def reach_slopes(sin: Any, cos: Any, dx: Any, dy: Any, lever: Any) -> tuple[Any, Any, Any]:
    """g and its first two derivatives by travel s = r (sin θ + sin θc), with ds = r cos θ dθ."""
    rc3 = lever * cos * cos * cos
    return reach_along(sin, cos, dx, dy), -dx / rc3, -3.0 * dx * sin / (lever * cos * cos * rc3)


@kernel
def length_slope(sin: Any, cos: Any, length: Any, dx: Any, dy: Any) -> Any:
    """ℓ' = dℓ/ds = g/ℓ, from ℓ² = r² + d² + 2 r (d_x cos θ + d_y sin θ)."""
    return reach_along(sin, cos, dx, dy) / length


@kernel
def band_direction(
    sin: Any, cos: Any, length: Any, dx: Any, dy: Any, lever: Any
) -> tuple[Any, Any]:
    """∂ℓ/∂d: the unit vector (x, y) along the band, from p to q."""
    return (lever * cos + dx) / length, (lever * sin + dy) / length


@kernel
def slopes_by_anchor(
    sin: Any, cos: Any, length: Any, first: Any, x: Any, y: Any
) -> tuple[Any, Any]:
    """∂ℓ'/∂d, of a band along (x, y).

    ℓ' = g/ℓ with ∂g/∂d = (-tan θ, 1), so ∂ℓ'/∂d = (∂g/∂d - ℓ' (x, y))/ℓ.
    """
    return (-sin / cos - first * x) / length, (1.0 - first * y) / length


@kernel
def slopes_by_lever(
    sin: Any, cos: Any, length: Any, first: Any, dx: Any, dy: Any, lever: Any
) -> tuple[Any, Any]:
    """∂ℓ/∂r and ∂ℓ'/∂r at the same θ, where g does not depend on r."""
    by = (lever + dx * cos + dy * sin) / length
    return by, -first * by / length


@kernel
def band_force(tension: Any, first: Any) -> Any:
    """F = dE/ds = T dℓ/ds: tension T = dE/dℓ against travel."""
    return tension * first


@kernel
def band_energy(tension: Any, extension: Any) -> Any:
    """E, of which `band_force` is the slope: a mean tension over an extension."""
    return tension * extension


@kernel
def force_by(t0: Any, t1: Any, first: Any, by: Any, first_by: Any) -> Any:
    """∂F/∂p = T' ∂ℓ/∂p ℓ' + T ∂ℓ'/∂p, by anything p that changes a band's length.

    Args:
        t0, t1: tension and its slope by ℓ.
        first: ℓ', the slope of ℓ by travel.
        by, first_by: slopes of ℓ and of ℓ' by p.
    """
    return band_force(t1 * by, first) + band_force(t0, first_by)


@kernel
def steepening(length: Any, x: Any, c0: Any, c1: Any, c2: Any, c3: Any) -> Any:
    """h = d(T/ℓ)/dℓ = (T' - T/ℓ)/ℓ of a tension T = c0 + c1 x + c2 x² + c3 x³, with dx = dℓ.

    Written without the difference of T' and T/ℓ, which are equal where T is proportional to ℓ:
    of a linear band with ℓ0 = 0, whose ends may meet, h is 0 and not rounding over ℓ.
    """
    chord = c1 + x * (c2 + x * c3)
    return (x * (c2 + 2.0 * c3 * x) + ((length - x) * chord - c0) / length) / length


@kernel
def force_slopes(
    tension: Any, bend: Any, h: Any, length: Any, g: Any, g1: Any, g2: Any
) -> tuple[Any, Any, Any]:
    """F, κ = dF/ds and dκ/ds of a band: F = (T/ℓ) g, and d(T/ℓ)/ds = h ℓ' with ℓ' = g/ℓ.

    Args:
        tension, bend: T and its second slope by ℓ.
        h: slope of T/ℓ by ℓ, see `steepening`.
        length: ℓ.
        g, g1, g2: ℓ ℓ' and its first two slopes by travel, see `reach_slopes`.
    """
    first, ratio = g / length, tension / length
    return (
        band_force(tension, first),
        band_force(h * first, g) + band_force(ratio, g1),
        band_force(bend * first * first, first)
        + band_force(3.0 * h * first, g1 - first * first)
        + band_force(ratio, g2),
    )
