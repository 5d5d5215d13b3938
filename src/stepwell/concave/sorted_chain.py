"""Chains of concave cells, whose sequence is two sorted lists of end forces."""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from stepwell.concave.certificate import Simple, closed, end_forces
from stepwell.mechanism import Chain

Floats = NDArray[np.float64]


class Neighbour(NamedTuple):
    """An end force that another cell has and this one may reach."""

    side: int  # -1 for F0, +1 for F1
    own: float  # [N]
    other: float  # [N]
    up: int  # +1 where the own force has to rise to pass it, -1 where it has to fall


@dataclass(frozen=True, eq=False)
class SortedChain:
    """A chain that loads its cells in ascending F0 and unloads them in descending F1, proved."""

    cells: tuple[Simple, ...]
    forces: tuple[Floats, Floats]  # F0 and F1 [N], (N,) each
    loading: tuple[int, ...]  # cells in order of arrival
    unloading: tuple[int, ...]
    places: tuple[NDArray[np.int64], NDArray[np.int64]]  # of every cell in those two orders

    @classmethod
    def of(cls, chain: Chain) -> "SortedChain | None":
        """The chain in this form, or None where that is not proved.

        Needs a rigid actuator, certified cells, and one full travel S for all: a cell that
        gives travel back in a snap gives back less than S, and so never reaches its other stop.
        """
        if math.isfinite(chain.actuator_stiffness):
            return None
        full = [cell.full_travel for cell in chain.cells]
        if max(full) - min(full) > 1e-12 * max(full):
            return None
        cells: list[Simple] = []
        for cell in chain.cells:
            numbers = closed(cell)
            if numbers is None:
                return None
            cells.append(numbers)
        ends = np.array([end_forces(cell) for cell in cells])
        # Equal forces: the inner cell first, as the engine does.
        loading = np.argsort(ends[:, 0], kind="stable")
        unloading = np.argsort(-ends[:, 1], kind="stable")
        return cls(
            tuple(cells),
            (ends[:, 0], ends[:, 1]),
            tuple(loading.tolist()),
            tuple(unloading.tolist()),
            (np.argsort(loading), np.argsort(unloading)),
        )

    def neighbours(self, cell: int) -> list[Neighbour]:
        """The end forces next to those of a cell, up to four.

        The sequence changes exactly when an end force of the cell passes one of these: whatever
        it passes first is next to it in the sorted list.
        """
        found: list[Neighbour] = []
        # Ranks rise with F0 and fall with F1.
        for side, order, force, place, up in (
            (-1, self.loading, self.forces[0], int(self.places[0][cell]), 1),
            (+1, self.unloading, self.forces[1], int(self.places[1][cell]), -1),
        ):
            own = float(force[cell])
            if place > 0:
                found.append(Neighbour(side, own, float(force[order[place - 1]]), -up))
            if place + 1 < len(order):
                found.append(Neighbour(side, own, float(force[order[place + 1]]), up))
        return found

    def smallest_gap(self) -> float:
        """Smallest difference of two F0 or of two F1 [N]; infinite for a single cell."""
        gaps = [abs(b - a) for force in self.forces for a, b in pairwise(np.sort(force).tolist())]
        return min(gaps, default=math.inf)
