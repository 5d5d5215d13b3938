"""What a pair of cells does for any place of one anchor: closed form first, then the engine."""

import math

import numpy as np
from numpy.typing import NDArray

from stepwell.concave import Simple, closed, decide, simple
from stepwell.design.parameters import moved
from stepwell.mechanism import Chain
from stepwell.sequences import Pathway, cycle
from stepwell.statics import StaticsError

Floats = NDArray[np.float64]

# Pathways by 2 * (first cell to load) + (first cell to unload), as the kernels count.
BY_ORDER = (Pathway.CLOCKWISE, Pathway.VIA_10, Pathway.VIA_01, Pathway.COUNTERCLOCKWISE)
IMPOSSIBLE = -1
UNSOLVED = -2
TIED = -3
_WORDS = {IMPOSSIBLE: "no mechanism", UNSOLVED: "no answer", TIED: "a tie decides"}
# A design on a boundary is tied and its neighbours are not; within a region of ties they are.
_ASIDE = 1e-8 * np.array([0.8, 0.6])


class Pathways:
    """The pathway of a pair as a number, against the anchor q of one cell.

    Numbers 0 to 3 are those of `BY_ORDER`, higher ones any other sequence met on the way,
    `IMPOSSIBLE` a place where the band's ends would meet, `UNSOLVED` one where the engine
    gave up, and `TIED` one in a region where only friction could tell (slack cells).
    """

    def __init__(self, chain: Chain, cell: int):
        self.chain, self.cell = chain, cell
        self.p = np.array(chain.cells[cell].bands[0].p)
        self.moving = simple(chain.cells[cell])
        self.fixed: Simple | None = None
        if math.isinf(chain.actuator_stiffness) and self.moving is not None:
            self.fixed = closed(chain.cells[1 - cell])
        self._words = [pathway.label for pathway in BY_ORDER]

    def proved(self, q: Floats) -> NDArray[np.int8]:
        """The number in closed form for (m, 2) anchors, -1 where it is not proved to hold."""
        out = np.full(len(q), -1, np.int8)
        if self.fixed is not None and self.moving is not None:
            decide(np.ascontiguousarray(q - self.p), self.fixed, self.moving, self.cell, out)
        return out

    def __call__(self, q: Floats) -> int:
        """The number for one anchor (2,)."""
        number = self._ask(q)
        return self._ask(q + _ASIDE) if number == TIED else number

    def _ask(self, q: Floats) -> int:
        order = int(self.proved(q[None])[0])
        if order >= 0:
            return order
        try:
            result = cycle(moved(self.chain, self.cell, *q.tolist()))
        except ValueError:
            return IMPOSSIBLE
        except StaticsError:
            return UNSOLVED
        if result.degenerate:
            return TIED
        if result.pathway in BY_ORDER:
            return BY_ORDER.index(result.pathway)
        text = str(result.sequence)
        if text not in self._words:
            self._words.append(text)
        return self._words.index(text)

    def words(self, number: int) -> str:
        """What a number stands for."""
        return _WORDS.get(number) or self._words[number]
