"""Scales of elements for which their switching forces come in two wanted orders.

All forces of an element grow together with its scale c, so that its switching forces are c times
those of its shape. Two orders of them are linear inequalities in the scales, and a linear program
tells whether there are scales that meet them, and for which all forces may be off the most.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.design.orders import Switches, switching_forces
from stepwell.mechanism import Chain, Element

Range = tuple[float, float]

LEAST = 1e-6  # of the largest force: what a linear program can tell from nothing
_HALVINGS = 30


@dataclass(frozen=True, eq=False)
class Scales:
    """Linear inequalities in the scales c (N,): gaps @ c + rub > share * sizes @ c.

    All forces are counted in the largest there can be.

    Attributes:
        gaps, sizes: (m, N) between neighbours of different cells in both orders.
        rub: (m,) what friction adds.
        bounds: (N, 2) of the scales.
    """

    gaps: Floats
    sizes: Floats
    rub: Floats
    bounds: Floats

    @classmethod
    def of(
        cls, elements: Sequence[Element], orders: Ints, scale: Range, most_force: float
    ) -> Scales | None:
        """None where no scales can do it: phases in another order, or too strong at any scale."""
        chain = Chain([one.renamed("") for one in elements])
        switches = Switches.of(chain.last_state)
        friction = np.array([one.friction for one in elements])
        own = switching_forces(chain) - friction[switches.cell, None] * [1.0, -1.0]
        strongest = np.array(
            [np.max(np.abs(own[switches.cell == k])) for k in range(len(elements))]
        )
        bounds = np.column_stack(
            [np.full(len(elements), scale[0]), np.full(len(elements), scale[1])]
        )
        bounds[:, 1] = np.minimum(bounds[:, 1], most_force / np.maximum(strongest, 1e-300))
        if np.any(bounds[:, 1] < bounds[:, 0]):
            return None
        largest = float(np.max(strongest * bounds[:, 1]))
        rows: list[tuple[Floats, Floats, float]] = []
        for end, order in enumerate(orders.tolist()):
            sign = 1.0 - 2.0 * end
            for a, b in pairwise(order):
                first, second = int(switches.cell[a]), int(switches.cell[b])
                if first == second:
                    if not sign * (own[b, end] - own[a, end]) > 0.0:
                        return None
                    continue
                gap, size = np.zeros(len(elements)), np.zeros(len(elements))
                gap[first], gap[second] = -sign * own[a, end], sign * own[b, end]
                size[first], size[second] = abs(own[a, end]), abs(own[b, end])
                rows.append((gap, size, float(friction[second] - friction[first])))
        if not rows:
            nothing = np.zeros((0, len(elements)))
            return cls(nothing, nothing, np.zeros(0), bounds)
        gaps, sizes, rub = (np.array(part) / largest for part in zip(*rows, strict=True))
        return cls(gaps, sizes, rub, bounds)

    @property
    def largest_gap(self) -> float:
        """The largest that the smallest gap can be, over the largest force; not above 0: none."""
        return self._best(0.0)[1]

    def surest(self, least: float) -> tuple[tuple[float, ...] | None, float]:
        """The scales for which all forces may be off by the largest share, and that share.

        None where it is no more than `least`.
        """
        low, high = least, 1.0
        scales, slack = self._best(low)
        if scales is None or not slack > 0.0:
            return None, low
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            found, slack = self._best(middle)
            if found is not None and slack >= 0.0:
                low, scales = middle, found
            else:
                high = middle
        return tuple(scales.tolist()), low

    def _best(self, share: float) -> tuple[Floats | None, float]:
        """The scales with the largest smallest gap beyond a share of the forces, and that gap."""
        if not len(self.gaps):
            return self.bounds.mean(axis=1), math.inf
        from scipy.optimize import linprog  # pyright: ignore[reportMissingTypeStubs]

        # Maximise t with gaps c - share sizes c + rub >= t.
        table = np.column_stack([share * self.sizes - self.gaps, np.ones(len(self.gaps))])
        cost = np.zeros(table.shape[1])
        cost[-1] = -1.0
        found = linprog(cost, table, self.rub, bounds=[*self.bounds.tolist(), (None, None)])
        if found.x is None:
            return None, -math.inf
        return np.asarray(found.x[:-1]), float(found.x[-1])
