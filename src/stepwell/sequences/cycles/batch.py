"""The cycles of many designs of one shape of chain, and the different ones among them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.sequences.cycles.sequence import Sequence
from stepwell.statics import Designs, full_cycles


@dataclass(frozen=True, eq=False)
class Cycles:
    """What m designs do in a full cycle.

    Attributes:
        sequences: the different ones.
        number: (m,) which of them each design makes; -1 of one that has to be asked by itself,
            which may be no mechanism, or one without an answer.
        found: (m, 8) what else is known of each, see `Followed`.
    """

    sequences: tuple[Sequence, ...]
    number: Ints
    found: Floats


def cycles(designs: Designs, progress: Callable[[int, int], None] | None = None) -> Cycles:
    """Load every design fully and unload it, once, in one call; see `full_cycles`."""
    followed = full_cycles(designs, progress)
    rows, number = np.unique(followed.visited, axis=0, return_inverse=True)
    cells = designs.cells.shape[1]
    sequences = [_sequence(row, cells) for row in rows.tolist() if row[0] >= 0]
    # Rows are in order, so what was not followed comes first.
    number = number.ravel() - (len(rows) - len(sequences))
    return Cycles(tuple(sequences), number, followed.found)


def _sequence(codes: list[int], cells: int) -> Sequence:
    states = [f"{code:0{cells}d}" for code in codes if code >= 0]
    return Sequence.parse(">".join(states))
