"""The cells of a long chain that follow the common force, as one spring and four queues.

Cells in series share λ, so those on rising branches act as one spring in series with the actuator.
Where their forces are straight its length is C λ + O, with two sums that change by one cell at a
time; a cell whose force is curved is evaluated separately. The queues contain the forces of the
next events of the cells, so the first event is known without a loop over all cells.
"""

from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import leaf, record
from stepwell.mechanism import HIGH, LOW, Laws, stored
from stepwell.statics.following.branch import inverse_slope
from stepwell.statics.following.pieces import Pieces, find_piece, invert, invert_near, piece_along
from stepwell.statics.following.state import FREE, DrivenChain, State, hold

# Queues of the next joint of two rising pieces, and of the end of a rising branch or the release
# of a held cell; each with λ rising (key λ) and falling (key -λ).
JOINT_UP, JOINT_DOWN, END_UP, END_DOWN = range(4)
# Kinds of cells: held at a stop or the leader, straight, or curved.
_APART, _STRAIGHT, _CURVED = 0, 1, 2
# Sums, each with its rounding error: C [m/N], O with all held travels [m], mobilities, and the
# energy that the cells of straight force have stored since it was set to 0 [J].
COMPLIANCE, OFFSET, MOBILITY, STORED = 0, 2, 4, 6


@record
class Queues(NamedTuple):
    """Q binary heaps of up to N cells, least key first; places let a key change in O(log N)."""

    heap: Ints  # (Q, N) cells; those of queue q are the first size[q]
    key: Floats  # (Q, N) of these
    place: Ints  # (N, Q) where each cell is in the heap, or -1
    size: Ints  # (Q,)


@leaf
def _settle_at(queues: Queues, q: int, k: int, cell: int, own: float) -> None:
    """Insert a cell and its key at place k, and move it up or down until the heap is in order."""
    heap, key, place, size = queues.heap[q], queues.key[q], queues.place, queues.size[q]
    while k > 0:
        above = (k - 1) // 2
        if key[above] <= own:
            break
        heap[k], key[k] = heap[above], key[above]
        place[heap[k], q] = k
        k = above
    while 2 * k + 1 < size:
        below = 2 * k + 1
        if below + 1 < size and key[below + 1] < key[below]:
            below += 1
        if own <= key[below]:
            break
        heap[k], key[k] = heap[below], key[below]
        place[heap[k], q] = k
        k = below
    heap[k], key[k] = cell, own
    place[cell, q] = k


@leaf
def put(queues: Queues, q: int, cell: int, key: float) -> None:
    """Insert a cell with this key into queue q, or change its key."""
    at = queues.place[cell, q]
    if at < 0:
        at = queues.size[q]
        queues.size[q] = at + 1
    _settle_at(queues, q, at, cell, key)


@leaf
def drop(queues: Queues, q: int, cell: int) -> None:
    """Take a cell out of queue q, if it is there."""
    at = queues.place[cell, q]
    if at < 0:
        return
    last = queues.size[q] - 1
    queues.size[q] = last
    queues.place[cell, q] = -1
    if at < last:
        _settle_at(queues, q, at, queues.heap[q, last], queues.key[q, last])


@leaf
def first_key(queues: Queues, q: int) -> float:
    """The least key of queue q; inf where it is empty."""
    return float(queues.key[q, 0]) if queues.size[q] > 0 else np.inf


@leaf
def ties(queues: Queues, q: int, within: float) -> bool:
    """Whether the first two cells of a queue are nearer to each other than `within`."""
    size, key = queues.size[q], queues.key[q]
    return bool(size > 1 and (key[1] if size == 2 else min(key[1], key[2])) - key[0] <= within)


@record
class FollowedSegment(NamedTuple):
    """The present segment, and the cells that its row has to name; others follow λ."""

    begin: Floats  # (2,) drive and λ where it began
    cell: Ints  # (N,) the first counts[0]
    travel: Floats  # (N,) where these were then
    named: Ints  # (N,) 1 for these
    counts: Ints  # (2,) how many, and the row of the segment before or -1


@record
class Rising(NamedTuple):
    """The cells on rising branches; N cells in the chain."""

    queues: Queues
    kind: Ints  # (N,)
    curved: Ints  # (N,) the cells of curved force, the first counts[0]
    place: Ints  # (N,) where each of these is in `curved`
    counts: Ints  # (2,) cells of curved force, and all
    sums: Floats  # (8,)
    segment: FollowedSegment


def no_rising(cells: int) -> Rising:
    """Empty queues for a chain of N cells."""
    kind, curved, place, cell, named = np.zeros((5, cells), np.int64)
    counts, names = np.zeros((2, 2), np.int64)
    places, keys = np.full((cells, 4), -1), np.zeros((4, cells))
    queues = Queues(np.zeros((4, cells), np.int64), keys, places, np.zeros(4, np.int64))
    segment = FollowedSegment(np.zeros(2), cell, np.zeros(cells), named, names)
    return Rising(queues, kind, curved, place, counts, np.zeros(8), segment)


@leaf
def clear(rising: Rising) -> None:
    """Remove all cells."""
    rising.queues.place[:], rising.queues.size[:] = -1, 0
    rising.kind[:], rising.counts[:], rising.sums[:] = _APART, 0, 0.0
    rising.segment.named[:], rising.segment.counts[0], rising.segment.counts[1] = 0, 0, -1


@leaf
def _add(sums: Floats, at: int, value: float) -> None:
    """Add to a sum without losing digits (Neumaier 1974)."""
    before = sums[at]
    after = before + value
    if abs(before) >= abs(value):
        sums[at + 1] += (before - after) + value
    else:
        sums[at + 1] += (value - after) + before
    sums[at] = after


@leaf
def sum_of(rising: Rising, at: int) -> float:
    """One of the sums with its rounding error."""
    return float(rising.sums[at] + rising.sums[at + 1])


@leaf
def is_straight(laws: Laws, pieces: Pieces, cell: int, piece: int) -> bool:
    """Whether the force of a cell is a straight line over its travel on a piece."""
    if laws.band_first[cell + 1] > laws.band_first[cell]:
        return False
    row = pieces.picked[piece, 0]
    return bool(row >= 0 and laws.rows[row, 3] == 0.0 and laws.rows[row, 4] == 0.0)


@leaf
def _count_in(problem: DrivenChain, rising: Rising, piece: int, sign: float) -> None:
    soft, offset = _line(problem, piece)
    _add(rising.sums, COMPLIANCE, sign * soft)
    _add(rising.sums, OFFSET, sign * offset)


@leaf
def _line(problem: DrivenChain, piece: int) -> tuple[float, float]:
    """Compliance 1/κ [m/N] of a straight piece, and its travel at zero force [m]."""
    row = problem.laws.rows[problem.pieces.picked[piece, 0]]
    soft = 1.0 / row[2]
    return soft, row[0] - row[1] * soft


@leaf
def _enter(problem: DrivenChain, rising: Rising, i: int, piece: int) -> None:
    """Add cell i on a piece, and queue the joints at the ends of that piece."""
    if is_straight(problem.laws, problem.pieces, i, piece):
        rising.kind[i] = _STRAIGHT
        _count_in(problem, rising, piece, 1.0)
    else:
        rising.kind[i] = _CURVED
        last = rising.counts[0]
        rising.curved[last], rising.place[i] = i, last
        rising.counts[0] = last + 1
    _queue_joint(problem, rising, i, piece, 1)
    _queue_joint(problem, rising, i, piece, -1)


@leaf
def _queue_joint(problem: DrivenChain, rising: Rising, i: int, piece: int, toward: int) -> None:
    """Queue the joint of a piece of cell i with the rising one that λ going `toward` leads to."""
    pieces, q = problem.pieces, JOINT_UP if toward > 0 else JOINT_DOWN
    if piece != pieces.among[i, (toward + 1) // 2] and pieces.sign[piece + toward] > 0:
        force = pieces.force_right[piece] if toward > 0 else pieces.force_left[piece]
        put(rising.queues, q, i, toward * force)
    else:
        drop(rising.queues, q, i)


@leaf
def _exit(problem: DrivenChain, rising: Rising, i: int, piece: int) -> None:
    if rising.kind[i] == _STRAIGHT:
        _count_in(problem, rising, piece, -1.0)
    else:
        at, last = rising.place[i], rising.counts[0] - 1
        rising.curved[at] = rising.curved[last]
        rising.place[rising.curved[at]] = at
        rising.counts[0] = last
    rising.kind[i] = _APART


@leaf
def rise(problem: DrivenChain, state: State, rising: Rising, i: int, piece: int) -> None:
    """Start cell i to follow λ, on a rising piece."""
    pieces = problem.pieces
    state.mode[i], state.sense[i], state.piece[i] = FREE, 0, piece
    _enter(problem, rising, i, piece)
    rising.counts[1] += 1
    _add(rising.sums, MOBILITY, problem.mobility[i])
    first, last = pieces.among[i, 0], pieces.among[i, 1]
    low = high = piece
    while high < last and pieces.sign[high + 1] > 0:
        high += 1
    while low > first and pieces.sign[low - 1] > 0:
        low -= 1
    put(rising.queues, END_UP, i, pieces.force_right[high])
    put(rising.queues, END_DOWN, i, -pieces.force_left[low])


@leaf
def rise_no_more(problem: DrivenChain, state: State, rising: Rising, i: int) -> None:
    """Remove cell i at the end of its rising branch."""
    _exit(problem, rising, i, state.piece[i])
    rising.counts[1] -= 1
    _add(rising.sums, MOBILITY, -problem.mobility[i])
    for q in range(4):
        drop(rising.queues, q, i)


@leaf
def pass_joint(problem: DrivenChain, state: State, rising: Rising, toward: int) -> None:
    """Move the cell that is first at a joint, λ going `toward`, to the next piece."""
    laws, pieces, queues = problem.laws, problem.pieces, rising.queues
    i = queues.heap[JOINT_UP if toward > 0 else JOINT_DOWN, 0]
    piece, kind = int(state.piece[i]), rising.kind[i]
    following = piece + toward
    joint = float(pieces.right[piece] if toward > 0 else pieces.left[piece])
    state.piece[i], state.travel[i] = following, joint
    if kind == _STRAIGHT and is_straight(laws, pieces, i, following):
        (soft, offset), (softer, next_offset) = _line(problem, piece), _line(problem, following)
        _add(rising.sums, COMPLIANCE, softer - soft)
        _add(rising.sums, OFFSET, next_offset - offset)
        _queue_joint(problem, rising, i, following, toward)
        _queue_joint(problem, rising, i, following, -toward)
        return
    _exit(problem, rising, i, piece)
    _enter(problem, rising, i, following)
    if kind != rising.kind[i]:
        held = stored(laws, i, pieces.picked[piece], joint)
        _add(rising.sums, STORED, held if kind == _CURVED else -held)


@leaf
def rest(problem: DrivenChain, state: State, rising: Rising, i: int) -> None:
    """Hold cell i at the stop where it is, until λ releases it."""
    hold(problem, state, i)
    travel, ends = state.travel[i], problem.sheets.ends
    _add(rising.sums, OFFSET, travel)
    if travel < ends[i, HIGH]:
        put(rising.queues, END_UP, i, state.at_rest[i])
    if travel > ends[i, LOW]:
        put(rising.queues, END_DOWN, i, -state.at_rest[i])


@leaf
def rest_no_more(state: State, rising: Rising, i: int) -> None:
    """Remove a held cell, which starts to move."""
    _add(rising.sums, OFFSET, -state.travel[i])
    drop(rising.queues, END_UP, i)
    drop(rising.queues, END_DOWN, i)


@leaf
def past_end(problem: DrivenChain, state: State, rising: Rising, i: int, toward: int) -> int:
    """The sign of κ that comes for a cell at the end of its branch or released, or 2 for a stop."""
    pieces = problem.pieces
    if rising.kind[i] == _APART:
        return int(pieces.sign[find_piece(pieces, i, state.travel[i], toward)])
    edge = pieces.among[i, 1] if toward > 0 else pieces.among[i, 0]
    return 2 if state.piece[i] == edge else int(pieces.sign[state.piece[i] + toward])


@leaf
def is_held(rising: Rising, i: int) -> bool:
    """Whether a queued cell rests at a stop."""
    return bool(rising.kind[i] == _APART)


@leaf
def travel_at_force(problem: DrivenChain, state: State, i: int, force: float) -> float:
    """Travel of a rising cell at a force on its branch [m]."""
    pieces = problem.pieces
    piece = piece_along(pieces, i, state.piece[i], force)
    return invert(problem.laws, pieces, i, piece, force)


@leaf
def stroke_at(problem: DrivenChain, state: State, rising: Rising, force: float) -> float:
    """Σ s of all cells but the leader at λ between two joints [m]; curved ones are put there."""
    total = sum_of(rising, COMPLIANCE) * force + sum_of(rising, OFFSET)
    laws, pieces, travel = problem.laws, problem.pieces, state.travel
    for k in range(rising.counts[0]):
        i = rising.curved[k]
        piece = int(state.piece[i])
        travel[i] = invert_near(laws, pieces, i, piece, force, float(travel[i]))
        total += travel[i]
    return float(total)


@leaf
def softness_at(problem: DrivenChain, state: State, rising: Rising) -> float:
    """dΣs/dλ of the rising cells where those of curved force are [m/N]."""
    total = sum_of(rising, COMPLIANCE)
    for k in range(rising.counts[0]):
        i = rising.curved[k]
        piece, travel = int(state.piece[i]), float(state.travel[i])
        total += inverse_slope(problem, i, piece, travel)
    return float(total)


@leaf
def count_work(rising: Rising, before: float, after: float) -> None:
    """Add the energy that the cells of straight force store while λ changes."""
    soft = sum_of(rising, COMPLIANCE)
    _add(rising.sums, STORED, 0.5 * soft * (after - before) * (after + before))


@leaf
def energy_in(problem: DrivenChain, state: State, rising: Rising) -> float:
    """Stored energy of the rising cells, up to a constant [J]; curved ones at their travels."""
    total = sum_of(rising, STORED)
    for k in range(rising.counts[0]):
        i = rising.curved[k]
        picked = problem.pieces.picked[state.piece[i]]
        total += stored(problem.laws, i, picked, float(state.travel[i]))
    return float(total)
