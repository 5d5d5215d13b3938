"""Chains of concave cells seen as relays: one switches up at A = F0, and down at B = F1."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepwell.mechanism import Chain
from stepwell.statics.concave import certify, end_forces, simple

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Relays:
    """Switching fields of a chain whose cells are all proved concave.

    Attributes:
        up, down: (N,) A = F0 and B = F1 [N].
        equal: whether all cells share one full travel.
    """

    up: Floats
    down: Floats
    equal: bool

    def precedes(self, i: int, j: int) -> bool:
        """i ≺ j: i goes up before j and also comes down after it."""
        return bool(self.up[i] < self.up[j] and self.down[i] < self.down[j])


def relays(chain: Chain) -> Relays | None:
    """The switching fields, or None where a cell is not proved concave or two of them tie."""
    fields: list[tuple[float, float]] = []
    for cell in chain.cells:
        numbers = simple(cell)
        if numbers is None or not certify(numbers, 0.0):
            return None
        fields.append(end_forces(numbers))
    up, down = np.array(fields).T
    scale = max(float(np.max(np.abs(up))), float(np.max(np.abs(down))))
    for values in (up, down):
        if len(values) > 1 and np.min(np.diff(np.sort(values))) <= 1e-9 * scale:
            return None
    full = [cell.full_travel for cell in chain.cells]
    return Relays(up, down, max(full) - min(full) <= 1e-12 * max(full))
