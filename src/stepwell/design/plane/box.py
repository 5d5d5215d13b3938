"""The part of the anchor plane that is looked at."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepwell.base import ByValue

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Box(ByValue):
    """A rectangle in the plane of an anchor [m]."""

    left: float
    right: float
    bottom: float
    top: float

    def grid(self, nodes: int) -> Floats:
        """(nodes, nodes, 2) places, rows upward, columns to the right."""
        x = np.linspace(self.left, self.right, nodes)
        y = np.linspace(self.bottom, self.top, nodes)
        return np.stack(np.meshgrid(x, y), axis=-1)

    @property
    def diagonal(self) -> float:
        """Length of the diagonal [m]."""
        return math.hypot(self.right - self.left, self.top - self.bottom)

    def holds(self, q: Floats) -> NDArray[np.bool_]:
        """Which of the (m, 2) places lie inside."""
        x, y = q[:, 0], q[:, 1]
        return (x >= self.left) & (x <= self.right) & (y >= self.bottom) & (y <= self.top)

    def ray(self, start: Floats, angle: float, skip: float) -> Floats:
        """The part inside of a ray from `start` (2,) at `angle` [rad], its first `skip` m left out.

        Returns:
            (2, 2) both ends, or (0, 2) where the ray misses the box.
        """
        along = np.array([math.cos(angle), math.sin(angle)])
        first, last = skip, math.inf
        sides = ((self.left, self.right), (self.bottom, self.top))
        for k, (low, high) in enumerate(sides):
            near, far = sorted(((low - start[k]) / along[k], (high - start[k]) / along[k]))
            first, last = max(first, near), min(last, far)
        return start + np.outer([first, last], along) if first < last else np.empty((0, 2))
