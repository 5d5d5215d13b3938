"""Scrambling: pairs of cells that flip in one order in some states and in the other in others.

A flip leads from a phase of a cell to the next one, so a cell with three phases has two.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stepwell.base import Bools, ByValue, Ints
from stepwell.sequences.graphs import Atlas


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


def scrambling(atlas: Atlas, reachable: frozenset[str]) -> tuple[Scrambling, ...]:
    """Every scrambled pair of flips once, with states that can be reached if any are.

    A vertex tells the order of what flips on the way to the next one, against everything that
    could have and did not.
    """
    vertices = sorted(atlas.graph.vertices, key=lambda label: label not in reachable)
    count = sum(label in reachable for label in vertices)
    last = np.max(_phases(atlas, vertices), axis=0)
    # Flip m is that of cell[m] out of phase step[m], and of a falling drive back to it.
    cell = np.repeat(np.arange(len(last)), last)
    step = np.arange(len(cell)) - np.searchsorted(cell, cell)
    found: list[Scrambling] = []
    for direction in (+1, -1):
        flips, waits = _flips_and_waits(atlas, vertices, cell, step, direction)
        known = np.zeros((len(cell),) * 2, bool)
        for part, reached in ((slice(count), True), (slice(None), False)):
            # before[i, j]: whether flip i is before flip j somewhere.
            before = flips[part].T.astype(float) @ waits[part] > 0
            scrambled = before & before.T & ~known
            known |= scrambled
            for i, j in np.argwhere(np.triu(scrambled)).tolist():
                i_first = vertices[int(np.argmax(flips[part, i] & waits[part, j]))]
                j_first = vertices[int(np.argmax(flips[part, j] & waits[part, i]))]
                cells = int(cell[i]), int(cell[j])
                found.append(Scrambling(cells, direction, i_first, j_first, reached))
    return tuple(found)


def _flips_and_waits(
    atlas: Atlas, vertices: Sequence[str], cell: Ints, step: Ints, direction: int
) -> tuple[Bools, Bools]:
    """(V, M) which flips are on the way from each vertex to the next, and which could but wait."""
    steps = atlas.up if direction > 0 else atlas.down
    following: list[str] = []
    for vertex in vertices:
        label = vertex
        for _ in range(len(steps)):
            label = steps.get(label, "-")
            if "-" not in label:
                break
        # With no vertex to come nothing flips.
        following.append(vertex if "-" in label else label)
    here, there = (_phases(atlas, labels)[:, cell] for labels in (vertices, following))
    ready = here == (step if direction > 0 else step + 1)
    flips = ready & ((there > step) if direction > 0 else (there <= step))
    return flips, ready & ~flips


def _phases(atlas: Atlas, labels: Sequence[str]) -> Ints:
    """(V, N) the phase of every cell."""
    n = atlas.graph.cells
    text = "".join(label[:n] for label in labels)
    return np.frombuffer(text.encode(), np.uint8).reshape(-1, n).astype(np.int64) - ord("0")
