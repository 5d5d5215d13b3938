"""Curves in the unit square along which a smooth function is zero."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stepwell.base import Bools, Floats
from stepwell.design.plane.polyline import narrowed
from stepwell.design.plane.trace import trace

_STEP = 1e-6  # of the square, between which slopes are taken
_AROUND = _STEP * np.array([(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)])


@dataclass(frozen=True)
class Level:
    """The curve along which `function`, of (m, 2) places in the unit square, is zero."""

    function: Callable[[Floats], Floats]

    def above(self, t: Floats) -> Bools:
        """At which of the (m, 2) places the function is positive."""
        return self.function(t) > 0

    def look(self, t: Floats) -> tuple[Floats, Floats]:
        """The function (m,) and its gradient (m, 2), by central differences."""
        # All in one call: the function has its price for being called.
        around = self.function((t + _AROUND[:, None]).reshape(-1, 2)).reshape(5, -1)
        slope = np.stack([around[1] - around[2], around[3] - around[4]], axis=1) / (2 * _STEP)
        return around[0], slope

    def project(self, t: Floats) -> Floats:
        """The (m, 2) points moved onto the curve by Newton's method along the gradient."""
        for _ in range(20):
            value, slope = self.look(t)
            step = (value / np.sum(slope**2, axis=1))[:, None] * slope
            t = t - step
            if np.max(np.abs(step), initial=0.0) <= 1e-13:
                break
        return t

    def distance(self, t: Floats) -> Floats:
        """Distance of (m, 2) places from the curve, to first order; (m,)."""
        value, slope = self.look(t)
        return np.abs(value) / np.linalg.norm(slope, axis=1)


def curves(level: Level, grid: Floats, values: Floats) -> list[Floats]:
    """The curve on a grid, as polylines.

    Args:
        level: the curve.
        grid: (ny, nx, 2) places, so fine that no two strands share one of its edges.
        values: (ny, nx) of the level's function there.

    Returns:
        Polylines, (m, 2) each, from rim to rim of the grid or closed.
    """
    above = values > 0

    def centre(row: int, column: int) -> int:
        return int(level.above((grid[row, column] + grid[row + 1, column + 1])[None] / 2)[0])

    found: list[Floats] = []
    for line in trace(above.astype(np.int64), centre):
        low, high = tuple(line.low.T), tuple(line.high.T)
        # One root on every edge, by bisection: it cannot leave the edge, so the ends of a curve
        # lie on the rim of the grid exactly.
        a, b, _ = narrowed(level.above, grid[low], grid[high], above[low], above[high], 46)
        found.append((a + b) / 2)
    return found
