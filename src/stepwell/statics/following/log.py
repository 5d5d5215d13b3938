"""Log of the follower: one row per segment, and a row for every cell that moved in it."""

from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import leaf, record

# Kinds of segments; on a drift, cells of constant force move.
HOLD, MOVE, DRIFT, SNAP = 0, 1, 2, 3
# Causes of a snap.
FOLD, RELEASE, KINK, ENDS = 1, 2, 3, 4

# Methods of landing: along the line on which one cell or pair moves; as the root of one equation,
# if all other cells are proved to stay on their branches; or by integrated flow.
BY_LINE, BY_EQUATION, BY_FLOW = 1, 2, 3

SEGMENT_COLUMNS = 18
KIND, DIRECTION, DRIVE_0, DRIVE_1, FORCE_0, FORCE_1 = range(6)
# LEADER and HEADING: the cell that triggers a snap, -1 on other segments, and its sense.
RELEASED, RUBBED, CAUSE, TIE_A, TIE_B, LEADER, HEADING = range(6, 13)
# Method of landing; and 1 where every cell between its stops without a row follows the force on
# its branch, the format of long chains.
DECIDED, FOLLOW = 13, 14
# Distance of a snap to another landing [N], [m], and the error of an integrated landing [m].
NEAR_FORCE, NEAR_TRAVEL, ERROR = range(15, SEGMENT_COLUMNS)
MOVER_COLUMNS = 7
CELL, PIECE, OFFSET, TRAVEL_0, TRAVEL_1, SHEET_0, SHEET_1 = range(MOVER_COLUMNS)
# Relative difference below which the largest pull and the largest push are equal.
ALIKE = 1e-6

# Two numbers, mostly of a beginning and an end.
Pair = tuple[float, float]


@record
class Log(NamedTuple):
    """K segments (one row each) and, per segment, the cells that moved in it."""

    segments: Floats  # (K, SEGMENT_COLUMNS)
    first: Ints  # (K + 1,) movers of segment k are first[k] .. first[k + 1]
    movers: Floats  # (M, MOVER_COLUMNS)
    used: Ints  # (2,) segments and movers written


def empty_log(segments: int, movers: int) -> Log:
    """An empty log with capacity for this number of segments and movers."""
    rows, first = np.zeros((segments, SEGMENT_COLUMNS)), np.zeros(segments + 1, np.int64)
    return Log(rows, first, np.zeros((movers, MOVER_COLUMNS)), np.zeros(2, np.int64))


def longer(log: Log) -> Log:
    """The same log with four times the capacity; memory is used only where it is written."""
    fresh = empty_log(4 * len(log.segments), 4 * len(log.movers))
    for old, new in zip(log, fresh, strict=True):
        new[: len(old)] = old
    return fresh


@leaf
def signed_peak(high: float, low: float) -> float:
    """The larger of two forces in size, with its sign; of equal sizes the positive one [N]."""
    size = max(high, -low)
    return size if high >= (1.0 - ALIKE) * size else -size


@leaf
def add_row(log: Log, kind: int, direction: int, drive: Pair, force: Pair) -> None:
    """Append the row of a segment without a trigger and without a tie."""
    k = log.used[0]
    row = log.segments[k]
    row[:] = 0.0
    row[KIND], row[DIRECTION] = kind, direction
    row[DRIVE_0], row[DRIVE_1] = drive
    row[FORCE_0], row[FORCE_1] = force
    row[LEADER] = row[TIE_A] = row[TIE_B] = -1
    log.used[0] = k + 1
    log.first[k + 1] = log.used[1]


@leaf
def add_mover(log: Log, cell: int, piece: int, offset: float, before: float, after: float) -> None:
    """Append the row of a cell that moves on its first sheet to the segment written last."""
    m = log.used[1]
    row = log.movers[m]
    row[CELL], row[PIECE], row[OFFSET] = cell, piece, offset
    row[TRAVEL_0], row[TRAVEL_1], row[SHEET_0], row[SHEET_1] = before, after, 0, 0
    log.used[1] = m + 1
    log.first[log.used[0]] = m + 1


def written(log: Log) -> Log:
    """A log without unused capacity, so that two logs of one motion are equal."""
    segments, movers = log.used.tolist()
    rows, first, moved = log.segments[:segments], log.first[: segments + 1], log.movers[:movers]
    if 4 * movers < len(log.movers):
        # Copies free the memory of much larger arrays.
        rows, first, moved = rows.copy(), first.copy(), moved.copy()
    return Log(rows, first, moved, log.used)
