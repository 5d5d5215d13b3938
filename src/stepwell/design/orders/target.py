"""What a chain shall do, and whether one does it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from stepwell.design.orders.orders import Orders, Wish, short
from stepwell.design.orders.reached import MOST_CELLS, searched, unlike
from stepwell.mechanism import Chain
from stepwell.sequences import Sequence, cycle
from stepwell.statics import StaticsError


class Seen(NamedTuple):
    """What the engine finds that a chain does.

    Attributes:
        sequence: of its full cycle.
        states: all that can be reached from all cells at 0; None where only a cycle is wanted.
        tied: whether the model cannot tell.
        peak: largest force of the actuator in the cycle, in size [N].
    """

    sequence: Sequence
    states: frozenset[str] | None
    tied: bool
    peak: float


@dataclass(frozen=True)
class Target:
    """A cycle, or a set of states that shall be in reach and no others.

    Attributes:
        text: what is wanted.
        wish: the orders of concave cells that do it.
        by_states: whether states are wanted.
    """

    text: str
    wish: Wish
    by_states: bool

    @property
    def cells(self) -> int:
        """How many there are."""
        return self.wish.cells

    @cached_property
    def states(self) -> frozenset[str] | None:
        """The states that shall be reached and no others; None where that is not looked at."""
        if not self.by_states or self.cells > MOST_CELLS:
            return None
        return self.wish.states or frozenset(self.wish.orders[0].states)

    @property
    def twins(self) -> bool:
        """Whether two cells are always in the same state, as two equal ones are until they tie."""
        columns = list(zip(*(self.states or ()), strict=True))
        return len(set(columns)) < len(columns)

    def look(self, chain: Chain) -> Seen:
        """What a chain does, by the engine.

        Raises:
            StaticsError: the engine could not go on.
            ValueError: too many branches.
        """
        result = cycle(chain)
        states, ties = (None, ()) if self.states is None else searched(chain)
        return Seen(
            result.sequence, states, bool(result.degenerate or ties), abs(result.peak_force)
        )

    def fault(self, chain: Chain, orders: Orders | None) -> str:
        """What is wrong with a chain, by the engine; "" where it does what is wanted."""
        try:
            return short(self.misses(self.look(chain), orders))
        except (StaticsError, ValueError) as failure:
            return str(failure)

    def misses(self, seen: Seen, orders: Orders | None) -> str:
        """What is wrong with what a chain does; "" where it is as wanted.

        Args:
            seen: what it does.
            orders: those it was built for, which tell the cycle where only that is looked at.
        """
        if seen.tied:
            return "a tie"
        if self.states is not None:
            assert seen.states is not None
            return unlike(seen.states, self.states)
        assert orders is not None
        return "" if seen.sequence == orders.sequence else str(seen.sequence)
