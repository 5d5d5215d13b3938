"""Targets of a chain, whether a chain reaches them, and the reachable states."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from stepwell.base import ByValue, join_first
from stepwell.concave import one_travel, proved_cells, relays
from stepwell.design.orders import Orders, TargetOrders, by_cells_at_1, short
from stepwell.design.requirements import Requirements
from stepwell.mechanism import Chain
from stepwell.sequences import Branches, Sequence, cycle
from stepwell.statics import Landing, StaticsError, Tie

# Longest chain whose branches are all followed.
MOST_CELLS = 8
_LISTED = 4


@dataclass(frozen=True, slots=True, eq=False)
class Reached(ByValue):
    """States with every cell in a phase that are reachable from all cells in their first phase.

    Attributes:
        known: the states, or two orders of concave cells whose ideals they are.
        whole: whether these are all; if not, there may be more.
        how: the proof that these are all, or the reason why there is none.
    """

    known: tuple[str, ...] | Orders
    whole: bool
    how: str

    @property
    def states(self) -> tuple[str, ...]:
        """States such as "010" by the number of cells at 1; too many to list for long chains."""
        return self.known.states if isinstance(self.known, Orders) else self.known

    @property
    def count(self) -> int:
        """Number of the states, counted without listing them."""
        return self.known.count if isinstance(self.known, Orders) else len(self.known)


def reached(chain: Chain) -> Reached:
    """Reachable states of a chain: exact if all branches can be followed, else a lower bound.

    Up to eight cells are followed along every branch. More concave cells reach the ideals of their
    two orders under a force. With one full travel they reach at least these under a stroke, and
    all states if every two loops are nested. Other chains: the states of one full cycle.

    Source: theory page, "Transition graphs" and "Stroke programs" (a, b).
    """
    why = unsearchable(chain)
    if not why:
        try:
            states, ties = reachable_states(chain)
        except (StaticsError, ValueError) as failure:
            why = f"not all branches could be followed: {failure}"
        else:
            how = f"a tie: {ties[0].advice}" if ties else "every branch was followed to both ends"
            return Reached(by_cells_at_1(states), not ties, how)
    sequence = cycle(chain).sequence
    if sequence.orders is not None and chain.actuator_stiffness == 0 and relays(chain) is not None:
        return Reached(Orders(*sequence.orders), True, "under a force the cells are independent")
    if sequence.orders is None or not (one_travel(chain) and proved_cells(chain)):
        return Reached(by_cells_at_1(sequence.states), False, why)
    orders = Orders(*sequence.orders)
    if orders.nested:
        return Reached(orders, True, "all loops are nested, so all states are reached")
    return Reached(orders, False, why)


def reachable_states(chain: Chain) -> tuple[frozenset[str], tuple[Tie, ...]]:
    """All states reachable from all cells in their first phase, and ties on the way."""
    from stepwell.sequences import graph

    transitions = graph(chain, start=chain.first_state)
    labels = (label for label in transitions.reachable() if "-" not in label)
    # Nodes that share a state are numbered.
    return frozenset(label.partition("#")[0] for label in labels), transitions.ties


def landings_of_reachable(chain: Chain, ratio: float) -> Iterator[Landing]:
    """Landings of all snaps reachable from the first state, for all mobilities within a ratio."""
    branches = Branches(chain)
    place = branches.vertex(chain.first_state)
    assert place is not None
    for number in sorted(branches.all_from([branches.at(*place)])):
        for direction in (+1, -1):
            if branches.exit(number, direction) is not None:
                yield branches.landing(number, direction, ratio)


def unsearchable(chain: Chain, friction: float = 0.0) -> str:
    """Reason why not all branches can be followed, with added friction [N]; "" if they can."""
    if friction > 0 or any(cell.friction > 0 for cell in chain.cells):
        return (
            "with friction a chain stops at every reversal, so finitely many branches do not "
            "contain all reachable states"
        )
    if len(chain) > MOST_CELLS:
        return f"all branches are followed for up to {MOST_CELLS} cells only"
    return ""


def state_differences(reached_states: Iterable[str], target: Iterable[str]) -> str:
    """States reached in addition to the target, and those not reached; "" for the same states."""
    reached_states, target = set(reached_states), set(target)
    parts = [("also reaches", reached_states - target), ("does not reach", target - reached_states)]
    listed = (
        (words, join_first(by_cells_at_1(states), _LISTED, between=" ")) for words, states in parts
    )
    return ", ".join(f"{words} {states}" for words, states in listed if states)


class Behaviour(NamedTuple):
    """Simulated behaviour of a chain."""

    sequence: Sequence  # of its full cycle
    states: frozenset[str] | None  # all reachable from all cells at 0; None for a cycle
    tied: bool  # whether events are degenerate
    peak: float  # largest force of the actuator in the cycle, in size [N]


@dataclass(frozen=True)
class Target:
    """A target cycle, or the set of all reachable states."""

    text: str
    orders: TargetOrders  # orders of concave cells that give the target
    by_states: bool
    requirements: Requirements | None = None  # parts of a target, checked by simulation

    @cached_property
    def states(self) -> frozenset[str] | None:
        """The target states and no others; None if they are not checked."""
        if not self.by_states or self.orders.cells > MOST_CELLS:
            return None
        return self.orders.states or frozenset(self.orders.orders[0].states)

    @property
    def has_equal_cells(self) -> bool:
        """Whether two cells are always in the same state, as two equal cells until they tie."""
        columns = list(zip(*(self.states or ()), strict=True))
        return len(set(columns)) < len(columns)

    def simulate(self, chain: Chain) -> Behaviour:
        """The behaviour of a chain by the engine."""
        result = cycle(chain)
        states, ties = (None, ()) if self.states is None else reachable_states(chain)
        tied = bool(result.degenerate or ties)
        return Behaviour(result.sequence, states, tied, abs(result.peak_force))

    def fault(self, chain: Chain, orders: Orders) -> str:
        """How a simulated chain designed for orders misses the target; "" if it does not."""
        if self.requirements is not None:
            return self._missed(chain)
        try:
            behaviour = self.simulate(chain)
        except (StaticsError, ValueError) as failure:
            return str(failure)
        if behaviour.tied:
            return "a tie"
        if self.states is not None and behaviour.states is not None:
            return short(state_differences(behaviour.states, self.states))
        return "" if behaviour.sequence == orders.sequence else short(str(behaviour.sequence))

    def _missed(self, chain: Chain) -> str:
        """The first requirement that a simulated chain misses; "" for none."""
        assert self.requirements is not None
        try:
            behaviour = self.simulate(chain)
            reaches = None
            if self.requirements.by_states and not unsearchable(chain):
                reaches, ties = reachable_states(chain)
                behaviour = behaviour._replace(tied=behaviour.tied or bool(ties))
            if behaviour.tied:
                return "a tie"
            return short(self.requirements.fault(chain, behaviour.sequence, reaches))
        except (StaticsError, ValueError) as failure:
            return str(failure)
