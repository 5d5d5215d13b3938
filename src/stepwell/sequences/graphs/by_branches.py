"""Ways between the states of any chain without friction, along branches followed when asked."""

from __future__ import annotations

import math
from collections import Counter
from functools import cached_property

from stepwell.base import InputError
from stepwell.concave import Relays, ideals, levels, relays, standing_states, switches
from stepwell.mechanism import Chain
from stepwell.sequences.branches import Branches, checked_state, order_kept
from stepwell.sequences.graphs.node import Node, Transition
from stepwell.sequences.graphs.transition_graph import node_of, overdrawn, way_on
from stepwell.statics import Tie


class ByBranches:
    """Nodes and the ways between them; each branch is followed once and remembered.

    Args:
        chain: no friction.
    """

    method = "every branch that was asked for followed to both ends by the engine"
    # Nobody counts these but by following every branch.
    transitions = gardens = sub_loops = None

    def __init__(self, chain: Chain):
        self.chain = chain
        self._branches = Branches(chain)
        self._sections: dict[str, tuple[int, int]] = {}
        self._labels: dict[tuple[int, int], str] = {}
        self._sharing: Counter[str] = Counter()

    @property
    def ties(self) -> tuple[Tie, ...]:
        """Those on the branches that were followed."""
        return tuple(self._branches.ties)

    @cached_property
    def standing(self) -> int:
        """How many states stand with every cell in a phase, at one force."""
        windows = [[(p.force_low, p.force_high) for p in cell] for cell in self.chain.phases]
        return standing_states(levels(windows, 0.0))

    @cached_property
    def reached(self) -> int | None:
        """How many of these are reached from the first one, where one cycle proves it."""
        fields = relays(self.chain)
        if fields is None or not fields.equal or not math.isinf(self.chain.actuator_stiffness):
            return None
        return _ideals(fields) if order_kept(self.chain, fields).only_ideals else None

    def node(self, label: str) -> Node:
        """The node of that label."""
        number, k = self._find(label)
        return node_of(label, self._branches[number].sections[k], number)

    def transition(self, label: str, direction: int) -> tuple[str, Transition] | None:
        """Where the drive leads from a node."""
        way = way_on(self._branches, *self._find(label), direction)
        return None if way is None else (self._label(way[0]), way[1])

    def _find(self, label: str) -> tuple[int, int]:
        if label in self._sections:
            return self._sections[label]
        if "-" in label or "#" in label:
            raise InputError(
                f"state = {label!r}: has not been come to: begin with a state in which every cell "
                f"is in a phase, such as {self.chain.first_state!r}, and walk."
            )
        place = self._branches.vertex(checked_state(self.chain, "state", label))
        if place is None:
            raise InputError(f"state = {label!r}: is no equilibrium: {overdrawn(self.chain)}.")
        number = self._branches.at(*place)
        found = number, self._branches[number].find(label, place[1])
        self._label(found)
        return self._sections[label]

    def _label(self, section: tuple[int, int]) -> str:
        if section not in self._labels:
            number, k = section
            state = self._branches[number].sections[k].state
            self._sharing[state] += 1
            count = self._sharing[state]
            label = state if count == 1 else f"{state}#{count}"
            self._labels[section], self._sections[label] = label, section
        return self._labels[section]


def _ideals(fields: Relays) -> int | None:
    known = switches(levels(fields.windows, fields.slip))
    return None if known is None else ideals(known)
