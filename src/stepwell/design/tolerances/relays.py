"""What many chains of relays do that differ a little from their drawing, by switching forces."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.concave import DOES, OTHER, TIE, Judged
from stepwell.design.orders import Switches, are_relays
from stepwell.design.tolerances.draws import Draws


@dataclass
class RelayJudge:
    """Judges many draws of one chain of elements under a prescribed force.

    There elements of one sheet are independent relays, whose switching forces grow and shrink with
    all their forces, and with friction.

    Attributes:
        draws: the mechanisms.
        wanted: the cycle that counts.
        orders: (2, T) of that; None where it is not one switch after the other.
        texts: the cycles found, to which `Judged.does` are the numbers.
    """

    draws: Draws
    wanted: str
    orders: Ints | None
    texts: list[str] = field(default_factory=list[str])
    _numbers: dict[str, int] = field(default_factory=dict[str, int])

    @classmethod
    def of(cls, draws: Draws, wanted: str, orders: Ints | None) -> RelayJudge | None:
        """None where switching forces do not decide, or a cell has levers."""
        chain = draws.chain
        if len(chain.elements) < len(chain) or not are_relays(chain):
            return None
        return cls(draws, wanted, orders)

    def __call__(self, drawn: Floats) -> Judged:
        """The verdicts on draws (m, columns)."""
        forces = self.draws.switching_forces(drawn)
        motion = Switches.of(self.draws.chain.last_state).motion(forces)
        cycles, which = motion.cycles()
        does = np.array([self._number(text) for text in cycles])[which]
        right = np.array([text == self.wanted for text in cycles])[which]
        verdict = np.where(motion.tied, TIE, np.where(right, DOES, OTHER)).astype(np.int8)
        gap, wrong = np.full(len(drawn), np.inf), np.zeros((2, 0), np.int64)
        narrowest = wrong
        if self.orders is not None and forces.shape[1] > 1:
            gaps = gaps_between(forces, self.orders)
            gap = np.min(gaps, axis=(1, 2))
            wrong = np.sum((gaps < 0) & (verdict == OTHER)[:, None, None], axis=0)
            nearest = np.argmin(gaps.reshape(len(gaps), -1), axis=1)
            narrowest = np.bincount(nearest, minlength=wrong.size).reshape(wrong.shape)
        return Judged(verdict, does, gap, wrong, narrowest)

    def _number(self, text: str) -> int:
        if text not in self._numbers:
            self._numbers[text] = len(self.texts)
            self.texts.append(text)
        return self._numbers[text]


def gaps_between(forces: Floats, orders: Ints) -> Floats:
    """(m, 2, T - 1) gaps [N] between neighbours of two orders (2, T), of forces (m, T, 2).

    Negative where two are in the other order.
    """
    up, down = forces[:, orders[0], 0], -forces[:, orders[1], 1]
    return np.diff(np.stack([up, down], axis=1), axis=2)
