"""Four priority queues of cells by force: which one reaches its next event first.

Each is a binary heap of cell numbers with the place of every cell in it, so that a cell changes
its force, enters or leaves in O(log N).
"""

from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import kernel, leaf


class Queues(NamedTuple):
    """Q queues of up to N cells, each with the least key first."""

    heap: Ints  # (Q, N) cells; those of queue q are the first size[q]
    place: Ints  # (Q, N) where each cell is in the heap, or -1
    key: Floats  # (Q, N) by cell
    size: Ints  # (Q,)


@kernel
def empty_queues(count: int, cells: int) -> Queues:
    """So many queues, all empty, for so many cells."""
    return Queues(
        np.zeros((count, cells), np.int64),
        np.full((count, cells), -1),
        np.zeros((count, cells)),
        np.zeros(count, np.int64),
    )


@leaf
def _settle_at(queues: Queues, q: int, k: int) -> None:
    """Move the cell at place k up or down until the heap is in order."""
    heap, place, key = queues.heap, queues.place, queues.key
    cell = heap[q, k]
    own = key[q, cell]
    while k > 0:
        above = (k - 1) // 2
        if key[q, heap[q, above]] <= own:
            break
        heap[q, k] = heap[q, above]
        place[q, heap[q, k]] = k
        k = above
    size = queues.size[q]
    while 2 * k + 1 < size:
        below = 2 * k + 1
        if below + 1 < size and key[q, heap[q, below + 1]] < key[q, heap[q, below]]:
            below += 1
        if own <= key[q, heap[q, below]]:
            break
        heap[q, k] = heap[q, below]
        place[q, heap[q, k]] = k
        k = below
    heap[q, k] = cell
    place[q, cell] = k


@leaf
def put(queues: Queues, q: int, cell: int, key: float) -> None:
    """Let a cell stand in queue q with this key, whether it was there or not."""
    queues.key[q, cell] = key
    if queues.place[q, cell] < 0:
        last = queues.size[q]
        queues.size[q] = last + 1
        queues.heap[q, last] = cell
        queues.place[q, cell] = last
    _settle_at(queues, q, queues.place[q, cell])


@leaf
def drop(queues: Queues, q: int, cell: int) -> None:
    """Take a cell out of queue q, if it is there."""
    at = queues.place[q, cell]
    if at < 0:
        return
    last = queues.size[q] - 1
    queues.size[q] = last
    queues.place[q, cell] = -1
    if at < last:
        queues.heap[q, at] = queues.heap[q, last]
        queues.place[q, queues.heap[q, at]] = at
        _settle_at(queues, q, at)


@leaf
def first_key(queues: Queues, q: int) -> float:
    """The least key of queue q; inf where it is empty."""
    return float(queues.key[q, queues.heap[q, 0]]) if queues.size[q] > 0 else np.inf


@leaf
def second(queues: Queues, q: int) -> int:
    """The cell with the least key but one of queue q, or -1."""
    size = queues.size[q]
    if size < 2:
        return -1
    if size == 2:
        return int(queues.heap[q, 1])
    one, two = queues.heap[q, 1], queues.heap[q, 2]
    return int(one if queues.key[q, one] <= queues.key[q, two] else two)
