"""One name for all graphs that differ only in which cell is which."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from functools import lru_cache
from itertools import permutations

from stepwell.concave import Way
from stepwell.sequences import TransitionGraph, TransitionKind

_NAME = 8  # hex digits


def ways_of(graph: TransitionGraph) -> tuple[Way, ...]:
    """The ways of a graph: from, to, direction of the drive, whether it snaps."""
    return tuple(
        (a, b, one.direction, one.kind is TransitionKind.SNAP) for a, b, one in graph.transitions()
    )


def canonical(ways: Iterable[Way], cells: int) -> str:
    """A text that two graphs share exactly if one is the other with its cells renumbered.

    Of all numberings the one is taken whose text comes first.

    Args:
        ways: as `concave.closed_graph` gives them.
        cells: how many there are.
    """
    return _canonical(frozenset(ways), cells)


@lru_cache(4096)
def _canonical(ways: frozenset[Way], cells: int) -> str:
    best = ""
    for places in permutations(range(cells)):
        text = " ".join(sorted(_told(way, places) for way in ways))
        if not best or text < best:
            best = text
    return best


def _told(way: Way, places: tuple[int, ...]) -> str:
    a, b, direction, snaps = way
    return f"{_moved(a, places)}{'+' if direction > 0 else '-'}{'!' * snaps}{_moved(b, places)}"


def _moved(label: str, places: tuple[int, ...]) -> str:
    # What follows the cells tells nodes of one state apart.
    return "".join(label[place] for place in places) + label[len(places) :]


def name_of(text: str) -> str:
    """The name of a graph by its canonical text: the first digits of its SHA-256."""
    return hashlib.sha256(text.encode()).hexdigest()[:_NAME]
