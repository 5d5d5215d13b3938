"""The transition graph of concave cells under a prescribed force, in closed form."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager

import networkx as nx
import numpy as np

from stepwell.base import Bools, Ints
from stepwell.concave import Relays
from stepwell.mechanism import Chain
from stepwell.sequences.branches import Branches
from stepwell.sequences.graphs.node import Node, Transition, TransitionKind
from stepwell.sequences.graphs.transition_graph import TransitionGraph, about

Edge = tuple[str, str, dict[str, tuple[Transition]]]


def preisach(chain: Chain, fields: Relays) -> TransitionGraph:
    """The force-controlled graph of concave cells: a Preisach set of relays.

    A state stands while the force is at least B of every cell at 1 and at most A of every cell at
    0. A rising force flips the cell of least A among those at 0, a falling one that of largest B
    among those at 1. One flip is all that happens there, even with cells that are not bistable:
    at the force A_i of the flip the others stood before and feel nothing of it, and i stands,
    since B_i < A_i. So there are no avalanches.

    Args:
        chain: under force control.
        fields: its (A, B).

    Source: Preisach 1935; Terzi and Mungan 2020; that concave cells are relays under a prescribed
    force: theory page, "Preisach limit".
    """
    full = np.array([cell.full_travel for cell in chain.cells])
    at_1 = every_state(len(chain))
    opens = np.where(at_1, np.inf, fields.up)
    shuts = np.where(at_1, fields.down, -np.inf)
    low, high = np.max(shuts, axis=1), np.min(opens, axis=1)
    low[0], high[-1] = Branches(chain).range
    stands = np.flatnonzero(low <= high)
    labels = labels_of(len(chain))
    rows = zip(
        stands.tolist(),
        low[stands].tolist(),
        high[stands].tolist(),
        (at_1[stands] * full).tolist(),
        strict=True,
    )
    ups, downs = _flips(chain, fields)
    rising, falling = stands[stands < len(labels) - 1], stands[stands > 0]
    first, last = np.argmin(opens[rising], axis=1), np.argmax(shuts[falling], axis=1)
    found = TransitionGraph()
    with _collector_at_rest():
        for branch, (code, a, b, travel) in enumerate(rows):
            label, travels = labels[code], tuple(travel)
            found.add_node(label, node=Node(label, label, a, b, a, b, travels, travels, branch))
        found.add_edges_from(_edges(labels, rising, first, ups))
        found.add_edges_from(_edges(labels, falling, last, downs))
    found.graph.update(
        **about(chain),
        ties=(),
        start=None,
        method="closed form: concave cells under a prescribed force are independent relays",
    )
    return nx.freeze(found)


def every_state(cells: int) -> Bools:
    """(2^N, N) which cells are at 1, the states counted up as binary numbers."""
    codes = np.arange(1 << cells)[:, None]
    return (codes >> np.arange(cells - 1, -1, -1)) & 1 == 1


def labels_of(cells: int) -> list[str]:
    """The same states as strings."""
    return [format(code, f"0{cells}b") for code in range(1 << cells)]


def _flips(chain: Chain, fields: Relays) -> tuple[list[Transition], list[Transition]]:
    """What happens when each cell goes up, and when each goes down.

    That does not depend on the others, so all states share these 2 N values.
    """
    ups: list[Transition] = []
    downs: list[Transition] = []
    pairs = zip(fields.up.tolist(), fields.down.tolist(), strict=True)
    for i, (cell, (up, down)) in enumerate(zip(chain.cells, pairs, strict=True)):
        gain = float(cell.energy(cell.limit)) - float(cell.energy(-cell.limit))
        work_up, work_down = up * cell.full_travel, down * cell.full_travel
        ups.append(Transition(TransitionKind.SNAP, +1, up, (i,), work_up - gain))
        downs.append(Transition(TransitionKind.SNAP, -1, down, (i,), gain - work_down))
    return ups, downs


def _edges(labels: list[str], codes: Ints, cells: Ints, flips: list[Transition]) -> Iterator[Edge]:
    alone = [(flip,) for flip in flips]
    # The first cell is the first character, which is the highest digit.
    targets = codes ^ (1 << (len(flips) - 1 - cells))
    for a, b, cell in zip(codes.tolist(), targets.tolist(), cells.tolist(), strict=True):
        yield labels[a], labels[b], {"transitions": alone[cell]}


@contextmanager
def _collector_at_rest() -> Iterator[None]:
    """Python's search for garbage takes longer than making values of which none is garbage."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()
