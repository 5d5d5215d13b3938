"""Claims about pairs of hysterons: how many graphs there are, and which of them chains make."""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import cache
from itertools import pairwise, product

import numpy as np

from stepwell.mechanism import Chain
from stepwell.paper.claims import Finding, claim, judged
from stepwell.paper.others.hysterons import Graph, canonical, graphs, reached, way_to
from stepwell.paper.others.inequalities import Inequalities
from stepwell.sequences import TransitionGraph

WHERE = "Teunisse and van Hecke 2025"
OURS = "ours; the graphs are those of Teunisse and van Hecke 2025"
# Where the phases of a designed pair end [N]: at two valleys and two peaks.
ENDS = (-1.0, -0.8, 0.8, 1.0)
# Of its curves: straight pieces between two of them, how far they are designed beyond the outermost
# [N], and the least compliance [mm/N].
_STEPS, _BEYOND, _COMPLIANCE = 4, (0.25, 0.5, 0.75), 0.25
# A spring behind which the pairs still do what they do under a prescribed length [N/m].
SPRING = 100e3


def possible(graph: Graph, *, plain: bool) -> bool:
    """Whether any pair makes a graph, under a prescribed length or behind a spring.

    Only the order of the four forces at which phases end counts, and the graph tells it. The
    travels are any that rise with the force, and so is what the spring gives.

    Args:
        graph: of two hysterons.
        plain: only with elements whose force is a function of travel, so that the second phase
            begins beyond the end of the first.
    """
    asked = Inequalities(graph, np.arange(4.0), (0, 1, 2, 3))
    asked.rise(0.0)
    asked.make(spring=True)
    if plain:
        for cell in (0, 1):
            asked.fall(cell, steep=False)
    return asked.solution() is not None


@cache
def pair(graph: Graph) -> Chain | None:
    """Two elements for a graph under a prescribed length, of which as few fold back as can be."""
    inner = [np.linspace(a, b, _STEPS + 1)[:-1] for a, b in pairwise(ENDS)]
    below, above = ENDS[0] - np.array(_BEYOND[::-1]), ENDS[-1] + np.array((0.0, *_BEYOND))
    forces = np.concatenate([below, *inner, above])
    low, valley, peak, high = (len(_BEYOND) + k * _STEPS for k in range(4))
    for folded in sorted(product((False, True), repeat=2), key=sum):
        asked = Inequalities(graph, forces, (low, valley, peak, high))
        asked.rise(_COMPLIANCE)
        asked.make(spring=False)
        for cell in (0, 1):
            if folded[cell]:
                asked.fold(cell)
            else:
                asked.fall(cell, steep=True)
        found = asked.solution()
        if found is not None:
            return Chain([asked.element(cell, found) for cell in (0, 1)])
    return None


def graph_of(chain: Chain, drive: str | float | None = None) -> Graph:
    """The graph of a pair of elements with two phases, as the engine follows it.

    Where a way leads tells the transition graph; which cell goes first tell the forces at which
    phases end, since both feel one force.
    """
    found = chain.graph(drive)
    fields = [cell.fields[0] for cell in chain.elements]
    ways: list[str] = []
    for state in found.vertices:
        for sign, phase, first in (("+", "0", min), ("-", "1", max)):
            cells = [cell for cell in (0, 1) if state[cell] == phase]
            if cells:
                leaving = first(cells, key=lambda cell: fields[cell][int(phase)])
                end = _next(found, state, +1 if sign == "+" else -1)
                ways.append(way_to(state, sign, leaving, end))
    return tuple(sorted(ways))


def _next(found: TransitionGraph, state: str, direction: int) -> str:
    """The next state with both cells in a phase."""
    while (way := found.transition(state, direction)) is not None:
        state = way[0]
        if "-" not in state:
            return state
    return "nowhere"
