"""The von Mises truss: two inclined springs that meet in an apex, pushed through their line."""

import numpy as np

from stepwell.base import Floats, check
from stepwell.elements.kept import kept
from stepwell.mechanism import Element


@kept
def von_mises_truss(
    half_width: float = 0.030,
    height: float = 0.012,
    stiffness: float = 2000.0,
    name: str = "von Mises truss",
) -> Element:
    """Two equal springs from fixed pivots to an apex, which rests on either side of their line.

    Exact at any height: only the springs' lengths change, and they neither bend nor buckle. The
    apex moves on the axis of symmetry. Travel is 0 at rest above and twice the height at rest
    below; the force vanishes at both, and half-way. A quarter of the height past either the force
    goes on straight.

    Args:
        half_width: w [m], from the axis to a pivot, > 0.
        height: h [m] of the apex at rest above the pivots, > 0.
        stiffness: k [N/m] of one spring along itself, EA/L of a bar, > 0.
        name: what messages and figures call the element.

    Raises:
        ValueError: a value out of its range.

    Source: von Mises 1923, Z. angew. Math. Mech. 3:406.
    """
    half_width = check.positive("half_width", half_width, "m")
    height = check.positive("height", height, "m")
    stiffness = check.positive("stiffness", stiffness, "N/m")
    return Element.from_law(
        lambda travel: truss_force(travel, half_width, height, stiffness),
        -height / 4,
        2 * height + height / 4,
        name,
    )


def truss_force(travel: Floats, half_width: float, height: float, stiffness: float) -> Floats:
    """F = 2 k y (L0/L - 1) [N] at travels [m] of any shape, with y = h - s and L² = w² + y²."""
    y = height - travel
    return 2 * stiffness * y * (np.hypot(half_width, height) / np.hypot(half_width, y) - 1)
