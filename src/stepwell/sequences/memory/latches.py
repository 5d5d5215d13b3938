"""Ways of no return: latches, and the vertices that no way leads to."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import networkx as nx

from stepwell.base import ByValue
from stepwell.sequences.graphs import Atlas, Transition, TransitionGraph, transitions


@dataclass(frozen=True, slots=True, eq=False)
class Latch(ByValue):
    """Nodes that lead to each other, and the ways out of them, from which none leads back.

    Whatever can be reached from all cells at 0 can be brought back to it by letting the drive
    down, so it holds no latch; one leaves a state that was set by hand. (An actuator that never
    goes all the way down may latch more. That is read off the drives of the transitions.)

    Attributes:
        nodes: labels of those left for ever.
        ways: (from, to, transition) for each way out.

    Source: transitions between strongly connected components, Mungan et al. 2019, Phys. Rev. Lett.
    123, 178002.
    """

    nodes: tuple[str, ...]
    ways: tuple[tuple[str, str, Transition], ...]

    def __repr__(self):
        ways = ", ".join(f"{a}>{b}" for a, b, _ in self.ways)
        return f"Latch({ways} for good)"


def latches(drawn: Atlas, groups: dict[str, int]) -> tuple[Latch, ...]:
    """All latches, one for each set of nodes that is left.

    Args:
        drawn: the graph.
        groups: of its nodes, by `groups_of`.
    """
    left: dict[int, list[str]] = {}
    for label, group in groups.items():
        left.setdefault(group, []).append(label)
    ways: dict[int, list[tuple[str, str, Transition]]] = {}
    for a, b, transition in transitions(drawn.graph):
        if groups[a] != groups[b]:
            ways.setdefault(groups[a], []).append((a, b, transition))
    found = [Latch(tuple(sorted(left[group])), tuple(out)) for group, out in ways.items()]
    return tuple(sorted(found, key=lambda latch: latch.nodes))


def groups_of(graph: TransitionGraph) -> dict[str, int]:
    """The number of each node's strongly connected component: nodes that lead to each other."""
    groups = nx.strongly_connected_components(graph)
    return {label: number for number, group in enumerate(groups) for label in group}


def gardens(drawn: Atlas, groups: dict[str, int]) -> tuple[str, ...]:
    """Vertices to which no other vertex leads: alone in a component that nothing enters.

    Behind a spring such a vertex may be returned to, from places that only it leads to.
    """
    graph = drawn.graph
    entered = {groups[b] for a, b in graph.edges if groups[a] != groups[b]}
    held = Counter(groups[label] for label in graph.vertices)
    alone = {group for group, count in held.items() if count == 1} - entered
    return tuple(label for label in graph.vertices if groups[label] in alone)
