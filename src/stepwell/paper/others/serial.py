"""Which graphs of two hysterons two elements in series make: a linear program for each.

Elements in series share one force. In a phase an element is as long as a rising function of that
force says, up to the force at which the phase ends; then it goes over to its other phase. So every
length at which a state of the pair ends is a sum of two travels, and a graph is made where these
lengths are in the order that it wants: linear inequalities between travels. Where they contradict
each other no pair makes the graph. Where they do not, a solution is a pair, and the engine is
asked whether it does.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise, product

import numpy as np

from stepwell.base import Floats
from stepwell.mechanism import Chain, Element
from stepwell.paper.others.hysterons import Graph, stations, way_to
from stepwell.sequences import TransitionGraph

# A sum of numbers: which, and how often.
_Sum = dict[int, float]

# Where the phases of a pair end [N]: at two valleys and two peaks.
_ENDS = (-1.0, -0.8, 0.8, 1.0)
# Its curves are straight between steps of these forces, and go as far beyond.
_STEPS, _BEYOND = 4, (0.25, 0.5, 0.75)
# Least compliance of a phase [mm/N], and how many mm a fall by 1 N is wide at most: then no
# element of the pair is held in the fall between its phases.
_SOFT, _STEEP = 0.5, 0.4
_REACH = 5.0  # largest travel [mm]
# How wide other gaps are at least, as a part of those between lengths.
_TURN, _FOLD, _LOSS = 0.1, 0.5, 0.3


def possible(graph: Graph, *, plain: bool) -> bool:
    """Whether any pair makes a graph, under a prescribed length or behind a spring.

    Only the order of the four forces at which phases end counts, and the graph tells it. The
    travels are any that rise with the force, the length of the spring too.

    Args:
        graph: of two hysterons.
        plain: only with elements whose force is a function of travel, so that the second phase
            begins beyond the end of the first.
    """
    asked = _Program(graph, np.arange(4.0), (0, 1, 2, 3))
    asked.rise()
    asked.order(asked.numbers(4))
    if plain:
        for cell in (0, 1):
            asked.below({asked.edge(cell, 0): 1.0}, {asked.edge(cell, 1): 1.0})
    return asked.solution() is not None


def pair(graph: Graph) -> Chain | None:
    """Two elements that make a graph under a prescribed length, as few as can be folding back."""
    steps = [np.linspace(a, b, _STEPS + 1)[:-1] for a, b in pairwise(_ENDS)]
    below, above = [_ENDS[0] - x for x in reversed(_BEYOND)], [_ENDS[3] + x for x in _BEYOND]
    forces = np.concatenate([below, *steps, [_ENDS[3]], above])
    first = len(_BEYOND)
    levels = (first, first + _STEPS, first + 2 * _STEPS, first + 3 * _STEPS)
    for folded in sorted(product((False, True), repeat=2), key=sum):
        asked = _Program(graph, forces, levels)
        asked.rise(_SOFT)
        asked.order()
        for cell in (0, 1):
            (asked.fold if folded[cell] else asked.fall)(cell)
        if (found := asked.solution()) is not None:
            return Chain([asked.element(cell, found) for cell in (0, 1)])
    return None


class _Program:
    """Inequalities between the travels of two elements in both phases at a grid of forces.

    Each is sum + gap * t + by <= other sum, and t is to be large: above 0 all of them hold with
    room to spare.
    """

    def __init__(self, graph: Graph, forces: Floats, levels: tuple[int, int, int, int]):
        """The phases end at these places of the grid, in the order that the graph tells."""
        self.graph, self.forces = graph, forces
        first_up, first_down = (_first(graph, way) for way in ("00+", "11-"))
        # What goes up first has the lower peak, what goes down first the higher valley.
        self.peak = {first_up: levels[2], 1 - first_up: levels[3]}
        self.valley = {first_down: levels[1], 1 - first_down: levels[0]}
        self.size, self.rows = 1, []
        self.travel: dict[tuple[int, int], dict[int, int]] = {}
        for cell in (0, 1):
            for phase, places in (
                (0, range(self.peak[cell] + 1)),
                (1, range(self.valley[cell], len(forces))),
            ):
                self.travel[cell, phase] = dict(zip(places, self.numbers(len(places)), strict=True))

    def numbers(self, count: int) -> range:
        """So many more unknown numbers; number 0 is t."""
        self.size += count
        return range(self.size - count, self.size)

    def below(self, small: _Sum, large: _Sum, gap: float = 1.0, by: float = 0.0) -> None:
        self.rows.append((small, large, gap, by))

    def edge(self, cell: int, phase: int) -> int:
        """The travel where a phase ends: at the peak, or at the valley."""
        return self.travel[cell, phase][(self.peak, self.valley)[phase][cell]]

    def rise(self, compliance: float | None = None) -> None:
        """Travel rises with force in every phase."""
        for there in self.travel.values():
            for (a, x), (b, y) in pairwise(there.items()):
                rise = 0.0 if compliance is None else compliance * (self.forces[b] - self.forces[a])
                self.below({x: 1.0}, {y: 1.0}, 1.0 if compliance is None else 0.0, rise)

    def order(self, spring: range | None = None) -> None:
        """The lengths at which states end are in the order that makes the graph."""
        if spring is not None:
            for x, y in pairwise(spring):
                self.below({x: 1.0}, {y: 1.0}, 0.0)
        for way in self.graph:
            states, flips = stations(way), [int(cell) - 1 for cell in way[3:]]
            length = self.end(states[0], way[2], flips[0], spring)
            for state, cell in zip(states[1:], flips[1:], strict=False):
                sign = "+" if state[cell] == "0" else "-"
                beyond = self.end(state, sign, cell, spring)
                self.below(*((beyond, length) if sign == "+" else (length, beyond)))
            for sign, leaves in (("+", "0"), ("-", "1")):
                if leaves in states[-1]:
                    end = self.end(states[-1], sign, None, spring)
                    self.below(*((length, end) if sign == "+" else (end, length)))

    def end(self, state: str, sign: str, cell: int | None, spring: range | None) -> _Sum:
        """The length at which a state ends, and with it this cell's phase."""
        places, phase, first = (self.peak, "0", min) if sign == "+" else (self.valley, "1", max)
        leaving = first((i for i in (0, 1) if state[i] == phase), key=places.__getitem__)
        place = places[leaving]
        length = {self.travel[i, int(state[i])][place]: 1.0 for i in (0, 1)}
        if cell not in (leaving, None):
            # The other one would go: no length does that.
            return {0: np.inf}
        return length if spring is None else length | {spring[self._rank(place)]: 1.0}
