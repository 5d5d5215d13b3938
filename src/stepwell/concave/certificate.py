"""Validity of the closed forms: end forces of a band in tension, and proofs of falling force."""

import math
from math import inf
from typing import Any

import numpy as np

from stepwell import mechanism as mech
from stepwell.base import Bools, Floats
from stepwell.concave.cell import Simple, force_of, of_row, simple, with_d
from stepwell.kernels import entry, leaf
from stepwell.mechanism import Cell, Element, geometry

# Shortest stretch over the range: the force of the cell is then so close to constant that the
# general engine decides.
_SHORTEST = 1.0 / 4096.0
_MOST_LOOKS = 256
# Rounding in the inequality is below 1e-14 of its sides.
_ROUNDING = 1.0 + 1e-12
# Number of halvings of a disc and of a line before their proof fails.
_DEPTH = 7
_LINE_DEPTH = 10


@entry()
@leaf
def certify(cell: Simple, reach: float) -> bool:
    """Proof that the band is in tension and F falls strictly over the whole travel.

    It covers every anchor within `reach` [m] of this one. False means "not proved".

    With t = sin θ, c = cos θ and h = d_y c - d_x t, dF/ds < 0 is the same as

        (ℓ - ℓ0) ℓ² d_x > ℓ0 r c h²

    (multiply κ/k = (ℓ0/ℓ³) g² - (1 - ℓ0/ℓ) d_x/(r c³), g = h/c, by r c³ ℓ³), which with
    d_x > 0 needs ℓ > ℓ0: a falling force proves a band in tension, so a two-sided spring is the
    same case. On a stretch of θ both sides are bounded by values at its ends:
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
    l_left = geometry.band_length(left, c_left, cell.dx, cell.dy, r)
    g_left = abs(geometry.reach_along(left, c_left, cell.dx, cell.dy))
    width = 2.0 * end
    for _ in range(_MOST_LOOKS):
        right = min(left + width, end)
        c_right = np.sqrt(1.0 - right * right)
        l_right = geometry.band_length(right, c_right, cell.dx, cell.dy, r)
        g_right = abs(geometry.reach_along(right, c_right, cell.dx, cell.dy))
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


def closed(cell: Cell | Element, *, reach: float = 0.0) -> Simple | None:
    """The cell as plain numbers where its closed forms are proved within reach [m], or None."""
    numbers = simple(cell)
    return numbers if numbers is not None and certify(numbers, reach) else None


@entry(1.5e-5, "d")
def certified_within(d: Floats, cell: Simple, reach: float, out: Bools) -> None:
    """`certify` within reach for differences d, (m, 2) [m], into (m,)."""
    for i in range(len(d)):
        out[i] = certify(with_d(cell, d[i, 0], d[i, 1]), reach)


def certified(cell: Simple, d: Floats, reach: float = 0.0) -> Bools:
    """(m,) results of `certify` for differences d, (m, 2) [m]."""
    out = np.empty(len(d), np.bool_)
    certified_within(np.ascontiguousarray(d), cell, reach, out)
    return out


@entry()
def concave_disc(cell: Simple, radius: float) -> bool:
    """Whether every anchor within `radius` [m] of the cell's own is certified.

    The proof for one disc is tried first, then for smaller discs that cover it.
    """
    if certify(cell, radius):
        return True
    most = 4 * _DEPTH + 4
    x, y, half = np.empty(most), np.empty(most), np.empty(most)
    x[0], y[0], half[0] = 0.0, 0.0, radius
    waiting = 1
    while waiting > 0:
        waiting -= 1
        u, v, h = x[waiting], y[waiting], half[waiting]
        # The square's nearest point: squares outside the disc need no proof.
        near_u, near_v = max(abs(u) - h, 0.0), max(abs(v) - h, 0.0)
        if near_u * near_u + near_v * near_v > radius * radius:
            continue
        if certify(with_d(cell, cell.dx + u, cell.dy + v), np.sqrt(2.0) * h):
            continue
        if h <= radius * 0.5**_DEPTH:
            return False
        for su in (-0.5, 0.5):
            for sv in (-0.5, 0.5):
                x[waiting], y[waiting], half[waiting] = u + su * h, v + sv * h, 0.5 * h
                waiting += 1
    return True


def concave_line(cell: Simple, along: Floats, start: float, end: float) -> bool:
    """`concave_disc` for the anchors from start to end [m] on a line in the direction `along`."""
    waiting = [(start, end, 0)]
    while waiting:
        a, b, depth = waiting.pop()
        middle, half = (a + b) / 2, (b - a) / 2
        here = cell._replace(dx=cell.dx + middle * along[0], dy=cell.dy + middle * along[1])
        if certify(here, half):
            continue
        if depth == _LINE_DEPTH:
            return False
        waiting += [(a, middle, depth + 1), (middle, b, depth + 1)]
    return True


def concave_box(cell: Simple, low: Floats, high: Floats) -> bool:
    """`concave_disc` for the anchors with d in the box between two corners (2,) [m]."""
    waiting = [(low[0], low[1], high[0] - low[0], high[1] - low[1], 0)]
    while waiting:
        x, y, wide, tall, depth = waiting.pop()
        if certify(with_d(cell, x + wide / 2, y + tall / 2), math.hypot(wide, tall) / 2):
            continue
        if depth == 2 * _DEPTH:
            return False
        # The longer side is halved.
        across, up = (wide / 2, 0.0) if wide >= tall else (0.0, tall / 2)
        half = wide - across, tall - up, depth + 1
        waiting += [(x, y, *half), (x + across, y + up, *half)]
    return True


@entry()
@leaf
def end_forces(cell: Simple) -> tuple[float, float]:
    """F0 and F1 [N] of a taut band."""
    return force_of(cell, -cell.sin_limit)[0], force_of(cell, cell.sin_limit)[0]


@entry()
@leaf
def end_force(cell: Simple, side: int, dx: float, dy: float) -> tuple[float, float, float]:
    """F0 (side -1) or F1 (side +1) [N] of the cell with its anchors at d, and ∂F/∂d [N/m]."""
    t = side * cell.sin_limit
    c = np.sqrt(1.0 - t * t)
    length = geometry.band_length(t, c, dx, dy, cell.lever)
    first = geometry.length_slope(t, c, length, dx, dy)
    x, y = geometry.band_direction(t, c, length, dx, dy, cell.lever)
    first_x, first_y = geometry.slopes_by_anchor(t, c, length, first, x, y)
    tension, stiffness, _ = mech.hooke(cell.stiffness, length - cell.rest)
    return (
        geometry.band_force(tension, first),
        geometry.force_by(tension, stiffness, first, x, first_x),
        geometry.force_by(tension, stiffness, first, y, first_y),
    )


def slopes_by_sizes(cell: Simple, side: Any, dx: Any, dy: Any) -> tuple[Any, Any]:
    """∂F/∂ℓ0 [N/m] and ∂F/∂r [N/m] of the same end force, of numbers or arrays."""
    t = side * cell.sin_limit
    c = np.sqrt(1.0 - t * t)
    length = geometry.band_length(t, c, dx, dy, cell.lever)
    first = geometry.length_slope(t, c, length, dx, dy)
    by, first_by = geometry.slopes_by_lever(t, c, length, first, dx, dy, cell.lever)
    tension, stiffness, _ = mech.hooke(cell.stiffness, length - cell.rest)
    return geometry.band_force(-stiffness, first), geometry.force_by(
        tension, stiffness, first, by, first_by
    )


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
    """(m, 2) F0 and F1 [N] of cells (m, 6), rows as `Simple`, and (m,) whether they are certified.

    The forces are zero without a proof.
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
    length = geometry.band_length(t, c, dx, dy, cell.lever)
    shortest, longest = length - radius, length + radius
    if not shortest > 0.0:
        return inf
    g = abs(geometry.reach_along(t, c, dx, dy)) + radius / c
    stretch = max(abs(1.0 - cell.rest / shortest), abs(1.0 - cell.rest / longest))
    # ∂F/∂d = (T' - T/ℓ) ℓ' ∂ℓ/∂d + T/ℓ ∂g/∂d, every factor at its bound.
    k = cell.stiffness
    return geometry.force_by(k * stretch, k * cell.rest / shortest, g / shortest, 1.0, 1.0 / c)
