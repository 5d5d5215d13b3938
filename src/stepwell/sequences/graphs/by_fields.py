"""Ways between the states of a chain under a force, told by the switching fields of its cells."""

from __future__ import annotations

import math
from functools import cached_property

from stepwell.base import InputError
from stepwell.concave import (
    Relays,
    garden_states,
    ideals,
    landings,
    levels,
    standing_states,
    sub_loops,
    switches,
)
from stepwell.mechanism import Chain
from stepwell.sequences.branches import Branches, checked_state
from stepwell.sequences.graphs.fields import Travels, heat_of
from stepwell.sequences.graphs.node import Node, Transition, TransitionKind
from stepwell.sequences.graphs.transition_graph import overdrawn
from stepwell.statics import Tie


class ByFields:
    """Windows of states and ways between them; every vertex is a branch of its own.

    Cells whose fields tie leave together: each goes its own way at the same force.

    Args:
        chain: under force control.
        fields: of its cells.
    """

    method = "switching fields: cells under a prescribed force do not feel each other"
    ties: tuple[Tie, ...] = ()

    def __init__(self, chain: Chain, fields: Relays):
        self.chain = chain
        self._windows = fields.windows
        self._levels = levels(self._windows, fields.slip)
        self._ways = {way: [landings(cell, way) for cell in self._levels] for way in (+1, -1)}
        self._travels = Travels(chain)
        self._ends = Branches(chain).range
        self._last = chain.last_state
        self._heat: dict[tuple[int, int, int], float] = {}

    @cached_property
    def standing(self) -> int:
        """How many states stand at some force."""
        return standing_states(self._levels)

    @cached_property
    def transitions(self) -> int:
        """How many: one up from every state but the last, one down from every one but the first."""
        return 2 * self.standing - 2

    @cached_property
    def gardens(self) -> int:
        """How many states no other leads to."""
        return garden_states(self._levels)

    @cached_property
    def reached(self) -> int | None:
        """How many states are reached from the first one; None where a cell passes a phase by."""
        relays = switches(self._levels)
        return None if relays is None else ideals(relays)

    @cached_property
    def sub_loops(self) -> int | None:
        """How many sub-loops are reached from the first state; None likewise."""
        relays = switches(self._levels)
        return None if relays is None else sub_loops(relays)

    def node(self, label: str) -> Node:
        """The state as a node."""
        phases = self._phases(label)
        own = [cell[k] for cell, k in zip(self._windows, phases, strict=True)]
        low = max(max(low for low, _ in own), self._ends[0])
        high = min(min(high for _, high in own), self._ends[1])
        begin, end = (
            tuple(self._travels.at(i, k, force) for i, k in enumerate(phases))
            for force in (low, high)
        )
        number = 0
        for cell, k in zip(self._windows, phases, strict=True):
            number = number * len(cell) + k
        return Node(label, label, low, high, low, high, begin, end, number)

    def transition(self, label: str, direction: int) -> tuple[str, Transition] | None:
        """Where the force leads from a state."""
        phases = self._phases(label)
        end = 1 if direction > 0 else 0
        ends = [cell[k][end] for cell, k in zip(self._levels, phases, strict=True)]
        first = min(ends) if direction > 0 else max(ends)
        ways = self._ways[direction]
        leave = tuple(i for i, at in enumerate(ends) if at == first and phases[i] in ways[i])
        if not leave:
            return None
        drives = [self._windows[i][phases[i]][end] for i in leave]
        after, heat = list(phases), []
        for i, force in zip(leave, drives, strict=True):
            after[i] = ways[i][phases[i]]
            heat.append(self._released(i, phases[i], after[i], force))
        drive = min(drives) if direction > 0 else max(drives)
        snap = Transition(TransitionKind.SNAP, direction, drive, leave, math.fsum(heat))
        return "".join(map(str, after)), snap

    def _phases(self, label: str) -> tuple[int, ...]:
        if not self._is_state(label):
            checked_state(self.chain, "state", label)
        phases = tuple(map(int, label))
        own = [cell[k] for cell, k in zip(self._levels, phases, strict=True)]
        if max(low for low, _ in own) > min(high for _, high in own):
            raise InputError(f"state = {label!r}: is no equilibrium: {overdrawn(self.chain)}.")
        return phases

    def _is_state(self, label: str) -> bool:
        # What checks a state for messages looks at every curve of the chain.
        digits = zip(label, self._last, strict=True)
        return len(label) == len(self._last) and all("0" <= a <= b for a, b in digits)

    def _released(self, cell: int, phase: int, target: int, force: float) -> float:
        key = cell, phase, target
        if key not in self._heat:
            self._heat[key] = heat_of(self.chain, self._travels, key, force)
        return self._heat[key]
