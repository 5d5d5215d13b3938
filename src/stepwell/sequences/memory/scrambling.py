"""Scrambling: pairs of cells that flip in one order in some states and in the other in others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stepwell.base import Bools, ByValue
from stepwell.sequences.graphs import Atlas


@dataclass(frozen=True, slots=True, eq=False)
class Scrambling(ByValue):
    """Two cells whose order depends on the state of the others.

    Attributes:
        cells: (i, j), indices in chain.cells; the text counts cells from 1.
        direction: +1 where both are at 0 and the drive rises, -1 where both are at 1 and it falls.
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
    """Every scrambled pair once for each direction, with states that can be reached if any are.

    A vertex tells the order of what flips on the way to the next one, against everything that
    could have and did not.
    """
    vertices = sorted(atlas.graph.vertices, key=lambda label: label not in reachable)
    count = sum(label in reachable for label in vertices)
    found: list[Scrambling] = []
    for direction in (+1, -1):
        flips, waits = _flips_and_waits(atlas, vertices, direction)
        known = np.zeros((atlas.graph.cells,) * 2, bool)
        for part, reached in ((slice(count), True), (slice(None), False)):
            # before[i, j]: whether i flips before j somewhere.
            before = flips[part].T.astype(float) @ waits[part] > 0
            scrambled = before & before.T & ~known
            known |= scrambled
            for i, j in np.argwhere(np.triu(scrambled)).tolist():
                i_first = vertices[int(np.argmax(flips[part, i] & waits[part, j]))]
                j_first = vertices[int(np.argmax(flips[part, j] & waits[part, i]))]
                found.append(Scrambling((i, j), direction, i_first, j_first, reached))
    return tuple(found)


def _flips_and_waits(atlas: Atlas, vertices: Sequence[str], direction: int) -> tuple[Bools, Bools]:
    """(V, N) which cells flip on the way from each vertex to the next, and which could but wait."""
    steps = atlas.up if direction > 0 else atlas.down
    before, ahead = "01" if direction > 0 else "10"
    n = atlas.graph.cells
    following: list[str] = []
    for label in vertices:
        for _ in range(len(steps)):
            label = steps.get(label, "")
            if "-" not in label:
                break
        # With nothing more to come nothing flips.
        following.append(label or before * n)
    ready = _cells(vertices, n) == ord(before)
    flips = ready & (_cells(following, n) == ord(ahead))
    return flips, ready & ~flips


def _cells(labels: Sequence[str], n: int) -> np.ndarray:
    """(V, N) the character of every cell."""
    return np.frombuffer("".join(label[:n] for label in labels).encode(), np.uint8).reshape(-1, n)
