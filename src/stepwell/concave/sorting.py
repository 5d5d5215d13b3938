"""Loading and unloading permutations of concave cells: two sorted lists of end forces.

Cells of falling force load in ascending F0 and unload in descending F1, where all travels are
equal (theory page, "Sorting").
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.concave.cell import Simple, simple
from stepwell.concave.certificate import proved_ends
from stepwell.kernels import leaf
from stepwell.mechanism import Chain

_SAME = 1e-12  # relative difference of travels that count as equal
TIED = 1e-9  # of the largest force: end forces nearer than this tie in the engine


@leaf
def same_travel(longest: float, shortest: float) -> bool:
    """Whether full travels between these differ by rounding only."""
    return longest - shortest <= _SAME * longest


def one_travel(chain: Chain) -> bool:
    """Whether all cells have the same full travel."""
    full = chain.full_travels
    return bool(same_travel(max(full), min(full)))


def proved_cells(chain: Chain) -> tuple[tuple[Simple, ...], Floats] | None:
    """All cells as plain numbers and their (N, 2) end forces, or None where one is not proved."""
    cells = tuple(numbers for cell in chain.cells if (numbers := simple(cell)) is not None)
    if len(cells) < len(chain):
        return None
    ends, proved = proved_ends(np.array(cells))
    return (cells, ends) if np.all(proved) else None


def motion_orders(ends: Floats) -> tuple[Ints, Ints]:
    """Loading and unloading permutations, (..., N) each, by end forces (..., N, 2).

    For equal forces the inner cell switches first, as in the engine.
    """
    loading = np.argsort(ends[..., 0], axis=-1, kind="stable")
    return loading, np.argsort(-ends[..., 1], axis=-1, kind="stable")


@leaf
def rank(key: Floats, start: Ints, order: Ints) -> None:
    """Cells by rising key, into `order`; quick where that is nearly the order `start`."""
    for place in range(len(start)):
        cell = start[place]
        j = place
        while j > 0 and key[order[j - 1]] > key[cell]:
            order[j] = order[j - 1]
            j -= 1
        order[j] = cell


class Neighbour(NamedTuple):
    """A neighbouring end force, of another cell."""

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

    @classmethod
    def of(cls, chain: Chain) -> "SortedChain | None":
        """The chain in this form, or None where that is not proved.

        Needs a rigid actuator, certified cells, and one full travel S for all: a cell that
        gives travel back in a snap gives back less than S, and so never reaches its other stop.
        """
        if math.isfinite(chain.actuator_stiffness) or not one_travel(chain):
            return None
        if (proved := proved_cells(chain)) is None:
            return None
        cells, ends = proved
        loading, unloading = motion_orders(ends)
        return cls(
            cells, (ends[:, 0], ends[:, 1]), tuple(loading.tolist()), tuple(unloading.tolist())
        )

    def neighbours(
        self, cell: int, orders: tuple[tuple[int, ...], tuple[int, ...]] | None = None
    ) -> list[Neighbour]:
        """End forces next to those of a cell, up to four; in its own orders, or in others.

        The sequence changes exactly when an end force of the cell passes one of these: the first
        force that it passes is next to it in the sorted list.
        """
        neighbours: list[Neighbour] = []
        # Ranks rise with F0 and fall with F1.
        orders = orders or (self.loading, self.unloading)
        for order, force, side in zip(orders, self._forces, (-1, +1), strict=True):
            place, own_force, up = order.index(cell), force[cell], -side
            if place > 0:
                neighbours.append(Neighbour(side, own_force, force[order[place - 1]], -up))
            if place + 1 < len(order):
                neighbours.append(Neighbour(side, own_force, force[order[place + 1]], up))
        return neighbours

    @cached_property
    def _forces(self) -> tuple[list[float], list[float]]:
        loading, unloading = self.forces
        return loading.tolist(), unloading.tolist()

    def smallest_gap(self) -> float:
        """Smallest difference of two F0 or of two F1 [N]; infinite for a single cell."""
        return float(np.min(np.diff(np.sort(self.forces, axis=1), axis=1), initial=math.inf))
