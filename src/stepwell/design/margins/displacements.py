"""Where an anchor may go: anywhere in the plane, or along a line."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stepwell.base import Floats, InputError
from stepwell.concave import Simple, concave_disc, concave_line


@dataclass(frozen=True, eq=False)
class Displacements:
    """Displacements an anchor may make: frame @ u for all u no longer than the reach.

    Attributes:
        frame: (2, n) orthonormal; n = 2 for the plane, 1 for a line.
        one_way: on a line, whether only u >= 0 counts.
        reach: largest displacement [m].
    """

    frame: Floats
    one_way: bool
    reach: float

    @classmethod
    def of(cls, along: Sequence[float] | None, one_way: bool, reach: float) -> Displacements:
        """The plane where `along` is None, else the line in that direction.

        Raises:
            ValueError: no direction, one way without a direction, or no reach.
        """
        if not 0 < reach < math.inf:
            raise InputError(f"reach = {reach} m: must be > 0 and finite.")
        if along is None:
            if one_way:
                raise InputError(
                    "one_way = True in the plane: give the direction as well, along = (dx, dy)."
                )
            return cls(np.eye(2), False, reach)
        direction = np.array(along, float)
        length = float(np.linalg.norm(direction))
        if direction.shape != (2,) or not 0 < length < math.inf:
            raise InputError(
                f"along = {along!r}: must be a direction (dx, dy) other than (0, 0), of any "
                f"length; (-1, 0) pushes the anchor inwards."
            )
        return cls(direction[:, None] / length, one_way, reach)

    @property
    def dimensions(self) -> int:
        """1 on a line, 2 in the plane."""
        return self.frame.shape[1]

    def move(self, u: Floats) -> tuple[float, float]:
        """The displacement (x, y) [m] that belongs to u (n,)."""
        x, y = self.frame @ u
        return float(x), float(y)

    def proved(self, cell: Simple, sign: int, distance: float) -> bool:
        """Whether the cell is proved concave and taut at every displacement up to `distance`.

        Args:
            cell: as it is.
            sign: +1 where the anchor is q, -1 where it is p: d = q - p.
            distance: [m], at most the reach.
        """
        if self.dimensions == 2:
            return concave_disc(cell, distance)
        start = 0.0 if self.one_way else -distance
        return concave_line(cell, sign * self.frame[:, 0], start, distance)
