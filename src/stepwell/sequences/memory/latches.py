"""Ways of no return: latches, and the vertices that no way leads to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stepwell.base import ByValue, Ints
from stepwell.sequences.graphs import Transition, TransitionGraph


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


def latches(graph: TransitionGraph, groups: Ints) -> tuple[Latch, ...]:
    """All latches, one for each set of nodes that is left.

    Args:
        graph: what is read.
        groups: of its nodes, by `groups_of`.
    """
    leaves = (graph.target >= 0) & (groups[graph.target] != groups)
    ways: dict[int, list[tuple[str, str, Transition]]] = {}
    # Of each node first where the rise leads, then the fall.
    for node, row in np.argwhere(leaves.T[:, ::-1]).tolist():
        at = 1 - row, node
        a, b = graph.nodes.label(node), graph.nodes.label(int(graph.target[at]))
        ways.setdefault(int(groups[node]), []).append((a, b, graph.ways[graph.number[at]]))
    found = [
        Latch(tuple(sorted(graph.nodes.labels(np.flatnonzero(groups == group)))), tuple(out))
        for group, out in ways.items()
    ]
    return tuple(sorted(found, key=lambda latch: latch.nodes))


def groups_of(graph: TransitionGraph) -> Ints:
    """(R,) number of each node's strongly connected component: nodes that lead to each other."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    row, begin = np.nonzero(graph.target >= 0)
    ends = begin, graph.target[row, begin]
    size = len(graph)
    leads = csr_array((np.ones(len(begin), np.int8), ends), (size, size))
    return connected_components(leads, connection="strong")[1].astype(int)


def gardens(graph: TransitionGraph, groups: Ints) -> tuple[str, ...]:
    """Vertices to which no other vertex leads: alone in a component that nothing enters.

    Behind a spring such a vertex may be returned to, from places that only it leads to.
    """
    into = (graph.target >= 0) & (groups[graph.target] != groups)
    vertices = graph.nodes.vertices
    alone = np.bincount(groups[vertices], minlength=len(graph)) == 1
    alone[groups[graph.target[into]]] = False
    return tuple(graph.nodes.labels(vertices[alone[groups[vertices]]]))
