"""The part of the anchor plane that is looked at."""

from dataclasses import dataclass

import numpy as np

from stepwell.base import Bools, ByValue, Floats


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

    def holds(self, q: Floats) -> Bools:
        """Which of the (m, 2) places lie inside."""
        x, y = q[:, 0], q[:, 1]
        return (x >= self.left) & (x <= self.right) & (y >= self.bottom) & (y <= self.top)
