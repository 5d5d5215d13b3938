"""Curves in the plane of an anchor along which an end force has a given value."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepwell.concave import Simple, certified, end_force_field
from stepwell.design.plane.trace import trace

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Level:
    """The curve F0(d) = force (side -1) or F1(d) = force (side +1) of a taut linear band."""

    cell: Simple
    side: int
    force: float

    def __call__(self, d: Floats) -> Floats:
        """F - force [N] at (..., 2) differences d = q - p [m]."""
        return end_force_field(self.cell, self.side, d)[..., 0] - self.force

    def gradient(self, d: Floats) -> Floats:
        """∂F/∂d [N/m], (..., 2)."""
        return end_force_field(self.cell, self.side, d)[..., 1:]

    def project(self, d: Floats) -> Floats:
        """The (m, 2) points moved onto the curve by Newton's method along the gradient."""
        for _ in range(50):
            gradient = self.gradient(d)
            step = (self(d) / np.sum(gradient**2, axis=1))[:, None] * gradient
            d = d - step
            if np.max(np.abs(step), initial=0.0) <= 1e-12 * self.cell.lever:
                break
        return d

    def distance(self, d: Floats) -> Floats:
        """Distance [m] of the (m, 2) points from the curve, to first order; (m,)."""
        return np.abs(self(d)) / np.linalg.norm(self.gradient(d), axis=1)

    def proved(self, d: Floats) -> NDArray[np.bool_]:
        """At which of the (m, 2) differences the cell is proved concave."""
        return certified(self.cell, d)


def curves(level: Level, grid: Floats) -> list[Floats]:
    """The curve on a grid, as polylines.

    Args:
        level: the curve.
        grid: (ny, nx, 2) differences d [m], so fine that no two strands share one of its edges.

    Returns:
        Polylines, (m, 2) each, from rim to rim of the grid or closed.
    """
    above = (level(grid) > 0).astype(np.int64)

    def centre(row: int, column: int) -> int:
        return int(level((grid[row, column] + grid[row + 1, column + 1]) / 2) > 0)

    return [
        _rooted(level, grid[tuple(line.low.T)], grid[tuple(line.high.T)])
        for line in trace(above, centre)
    ]


def _rooted(level: Level, low: Floats, high: Floats) -> Floats:
    # One root on every edge, by bisection: it cannot leave the edge, so the ends of a curve lie
    # on the rim of the grid exactly.
    rising = (level(high) > 0)[:, None]
    for _ in range(60):
        middle = (low + high) / 2
        beyond = (level(middle) > 0)[:, None] == rising
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return (low + high) / 2
