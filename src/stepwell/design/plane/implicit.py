"""Curves in the unit square along which a smooth function is zero."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stepwell.base import Floats
from stepwell.design.plane.trace import trace

_STEP = 1e-6  # of the square, between which slopes are taken
_LAST_STEP = 1e-7  # of the square, after which Newton's method has arrived
_SETTLED = 1e-13  # of an edge, where its crossing is known
_MOST_STEPS = 100
_AROUND = _STEP * np.array([(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)])


@dataclass(frozen=True)
class Level:
    """The curve along which `function`, of (m, 2) places in the unit square, is zero."""

    function: Callable[[Floats], Floats]

    def look(self, t: Floats) -> tuple[Floats, Floats]:
        """The function (m,) and its gradient (m, 2), by central differences."""
        # All in one call: the function has its price for being called.
        around = self.function((t + _AROUND[:, None]).reshape(-1, 2)).reshape(5, -1)
        slope = np.stack([around[1] - around[2], around[3] - around[4]], axis=1) / (2 * _STEP)
        return around[0], slope

    def project(self, t: Floats) -> Floats:
        """The (m, 2) points moved onto the curve by Newton's method along the gradient."""
        return self.projected(t)[0]

    def projected(self, t: Floats) -> tuple[Floats, Floats]:
        """The same, and the gradients (m, 2) beside them, no farther than the last step."""
        slope = t
        for _ in range(20):
            value, slope = self.look(t)
            step = (value / np.sum(slope**2, axis=1))[:, None] * slope
            t = t - step
            # What is left is of the order of the step's square.
            if np.max(np.abs(step), initial=0.0) <= _LAST_STEP:
                break
        return t, slope

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

    def centre(row: int, column: int) -> int:
        middle = (grid[row, column] + grid[row + 1, column + 1])[None] / 2
        return int(level.function(middle)[0] > 0)

    found: list[Floats] = []
    for line in trace((values > 0).astype(np.int64), centre):
        low, high = tuple(line.low.T), tuple(line.high.T)
        found.append(_crossings(level, grid[low], grid[high], values[low], values[high]))
    return found


def _crossings(level: Level, a: Floats, b: Floats, at_a: Floats, at_b: Floats) -> Floats:
    """Where (m,) edges from a to b, (m, 2) each, cross the level, between values of unlike sign.

    By false position after the Illinois rule (Dowell and Jarratt 1971): it cannot leave the edge,
    so the ends of a curve lie on the rim of the grid exactly.
    """
    low, high = np.zeros(len(a)), np.ones(len(a))
    side, at = np.zeros(len(a)), np.full(len(a), np.inf)
    for _ in range(_MOST_STEPS):
        before = at
        with np.errstate(invalid="ignore"):
            at = low + (high - low) * at_a / (at_a - at_b)
        # Beside a value that is none, halfway.
        at = np.where(np.isfinite(at), at, (low + high) / 2)
        if np.max(np.abs(at - before), initial=0.0) <= _SETTLED:
            break
        value = level.function(a + at[:, None] * (b - a))
        as_a = (value > 0) == (at_a > 0)
        # Where the same end moves twice, the other's value counts half.
        at_b = np.where(as_a, np.where(side > 0, at_b / 2, at_b), value)
        at_a = np.where(as_a, value, np.where(side < 0, at_a / 2, at_a))
        low, high = np.where(as_a, at, low), np.where(as_a, high, at)
        side = np.where(as_a, 1.0, -1.0)
    return a + at[:, None] * (b - a)
