"""Scrambling: pairs of cells that flip in one order in some states and in the other in others.

A flip leads from a phase of a cell to the next one, so a cell with three phases has two.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stepwell.base import Bools, ByValue, Ints
from stepwell.sequences.graphs import TransitionGraph

_BLOCK = 1 << 16  # vertices that are looked at together


@dataclass(frozen=True, slots=True, eq=False)
class Scrambling(ByValue):
    """Two cells whose order depends on the state of the others.

    Attributes:
        cells: (i, j), indices in chain.cells; the text counts cells from 1.
        direction: +1 where both have a phase to rise to and the drive rises, -1 where both have one
            to fall to and it falls; with two phases each, both are at 0 or both at 1.
        i_first, j_first: vertices from which i flips before j, and j before i.
        reachable: whether both vertices can be reached from all cells at 0; if not, at least one
            has to be set by hand.

    Source: Bense and van Hecke 2021, PNAS 118, e2111436118; van Hecke 2021, Phys. Rev. E 104,
    054608.
    """

    cells: tuple[int, int]
    direction: int
    i_first: str
    j_first: str
    reachable: bool

    def __repr__(self):
        way = "up" if self.direction > 0 else "down"
        i, j = (cell + 1 for cell in self.cells)
        return f"Scrambling({way}: cell {i} before {j} from {self.i_first}, not {self.j_first})"


def scrambling(graph: TransitionGraph, reached: Ints, others: Ints) -> tuple[Scrambling, ...]:
    """Every scrambled pair of flips once, with states that can be reached if any are.

    A vertex tells the order of what flips on the way to the next one, against everything that
    could have and did not.

    Args:
        graph: what is read.
        reached: numbers of the vertices that can be reached from all cells at 0.
        others: of those that cannot.
    """
    vertices = np.concatenate([reached, others])
    last = np.max(graph.nodes.phases(vertices), axis=0).astype(int)
    # Flip m is that of cell[m] out of phase step[m], and of a falling drive back to it.
    cell = np.repeat(np.arange(len(last)), last)
    step = np.arange(len(cell)) - np.searchsorted(cell, cell)
    found: list[Scrambling] = []
    for direction in (+1, -1):
        order = _Order(graph, cell, step, direction)
        # before[i, j]: whether flip i is before flip j somewhere.
        known = before = np.zeros((len(cell),) * 2, bool)
        for part, more, reachable in ((reached, reached, True), (vertices, others, False)):
            before = before | order.before(more)
            scrambled = before & before.T & ~known
            known = known | scrambled
            for i, j in np.argwhere(np.triu(scrambled)).tolist():
                i_first, j_first = (
                    graph.nodes.label(order.example(part, *pair)) for pair in ((i, j), (j, i))
                )
                cells = int(cell[i]), int(cell[j])
                found.append(Scrambling(cells, direction, i_first, j_first, reachable))
    return tuple(found)


@dataclass(frozen=True, eq=False)
class _Order:
    """Which flips are on the way from a vertex to the next, and which could be but wait.

    Attributes:
        graph: what is read.
        cell, step: (M,) the flips.
        direction: of the drive.
    """

    graph: TransitionGraph
    cell: Ints
    step: Ints
    direction: int

    def before(self, vertices: Ints) -> Bools:
        """(M, M) whether flip i is on the way from one of these vertices while flip j waits."""
        found = np.zeros((len(self.cell),) * 2, bool)
        for begin in range(0, len(vertices), _BLOCK):
            flips, waits = self._of(vertices[begin : begin + _BLOCK])
            found |= flips.T.astype(np.float32) @ waits.astype(np.float32) > 0
        return found

    def example(self, vertices: Ints, i: int, j: int) -> int:
        """The first of these vertices from which flip i is on the way while flip j waits."""
        for begin in range(0, len(vertices), _BLOCK):
            part = vertices[begin : begin + _BLOCK]
            flips, waits = self._of(part)
            if np.any(does := flips[:, i] & waits[:, j]):
                return int(part[np.argmax(does)])
        raise AssertionError("before() said that there is one")

    def _of(self, vertices: Ints) -> tuple[Bools, Bools]:
        """(V, M) for each flip, whether it is on the way, and whether it waits."""
        leads, nodes = self.graph.target[int(self.direction > 0)], self.graph.nodes
        is_vertex = np.zeros(len(nodes) + 1, bool)
        is_vertex[nodes.vertices] = is_vertex[-1] = True
        after = leads[vertices]
        for _ in range(len(nodes)):
            between = ~is_vertex[after]
            if not np.any(between):
                break
            after = np.where(between, leads[after], after)
        # With no vertex to come nothing flips.
        after = np.where(after < 0, vertices, after)
        here, there = (nodes.phases(one)[:, self.cell] for one in (vertices, after))
        ready = here == (self.step if self.direction > 0 else self.step + 1)
        flips = ready & ((there > self.step) if self.direction > 0 else (there <= self.step))
        return flips, ready & ~flips
