"""Which cells move in a segment of a log, those that follow the force without a row included."""

import numpy as np

from stepwell.base import Floats
from stepwell.kernels import kernel
from stepwell.mechanism import HIGH, LOW
from stepwell.statics.following.log import (
    CELL,
    FOLLOW,
    FORCE_1,
    KIND,
    MOVER_COLUMNS,
    PIECE,
    SNAP,
    TRAVEL_0,
    TRAVEL_1,
    Log,
)
from stepwell.statics.following.pieces import invert, piece_along, resting_piece
from stepwell.statics.following.state import Problem


@kernel
def moved(problem: Problem, log: Log, k: int, travel: Floats) -> Floats:
    """(m, MOVER_COLUMNS) rows of all cells that move in segment k, by cell.

    `travel` (N,) says where the cells are before it; (N,) for cells that follow, any place on their
    present branch will do.
    """
    named = log.movers[log.first[k] : log.first[k + 1]]
    row, pieces = log.segments[k], problem.pieces
    if row[FOLLOW] == 0.0:
        return named
    ends, force = problem.sheets.ends, row[FORCE_1]
    follows = np.zeros(len(travel), np.int64)
    for i in range(len(travel)):
        follows[i] = ends[i, LOW] < travel[i] < ends[i, HIGH]
    for m in range(len(named)):
        follows[int(named[m, CELL])] = 0
    count = len(named)
    rows = np.zeros((count + np.sum(follows), MOVER_COLUMNS))
    rows[:count] = named
    for i in range(len(travel)):
        if not follows[i]:
            continue
        piece = piece_along(pieces, i, resting_piece(pieces, i, travel[i]), force)
        rows[count, CELL], rows[count, PIECE] = i, -1 if int(row[KIND]) == SNAP else piece
        rows[count, TRAVEL_0] = travel[i]
        rows[count, TRAVEL_1] = invert(problem.laws, pieces, i, piece, force)
        count += 1
    return rows[np.argsort(rows[:, CELL])]
