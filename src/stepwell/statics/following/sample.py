"""Points along a logged path, each with its certificate."""

from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import entry, kernel, overspent, record
from stepwell.mechanism import law, summed
from stepwell.statics.following.branch import point_at
from stepwell.statics.following.certificate import certify
from stepwell.statics.following.log import (
    CELL,
    DIRECTION,
    DRIFT,
    DRIVE_0,
    DRIVE_1,
    FOLLOW,
    FORCE_0,
    FORCE_1,
    HOLD,
    KIND,
    MOVE,
    OFFSET,
    PIECE,
    SHEET_1,
    SNAP,
    TRAVEL_0,
    TRAVEL_1,
    Log,
)
from stepwell.statics.following.pieces import (
    find_piece,
    piece_along,
    sheet_of,
    sheets_of,
    stand_all_on,
    stand_on,
)
from stepwell.statics.following.state import Movers, Problem, drive_of, moved


@record
class Samples(NamedTuple):
    """Points along a path, each with its certificate; n samples, N cells."""

    drive: Floats  # (n,)
    travel: Floats  # (n, N)
    sheet: Ints  # (n, N)
    force: Floats  # (n,) λ
    branch: Ints  # (n,) number of the smooth branch
    snap_after: Ints  # (n,) 1 where the next one is the landing of a snap
    direction: Ints  # (n,) of the drive
    residual: Floats  # (n,) [N], see certify
    stability: Floats  # (n,) [N/m]


@entry()
def count_samples(log: Log, points: int) -> int:
    """How many samples `sample` will write."""
    total = 1
    for k in range(log.used[0]):
        kind = int(log.segments[k, KIND])
        total += 1 if kind == SNAP else (points if kind != HOLD else 2)
    return total


@entry(1e-4, "samples.travel")
def sample(
    problem: Problem,
    log: Log,
    start: Floats,
    sheets: Ints,
    start_force: float,
    points: int,
    samples: Samples,
) -> int:
    """Fill the samples; evenly in the drive along a branch, both ends of every jump."""
    laws, pieces, alpha, beta = problem.laws, problem.pieces, problem.alpha, problem.beta
    drive, travel, sheet, force = samples.drive, samples.travel, samples.sheet, samples.force
    branch, snap_after, direction = samples.branch, samples.snap_after, samples.direction
    residual, stability = samples.residual, samples.stability
    stand_all_on(laws, problem.sheets, pieces, sheets)
    now, number = start.copy(), 0
    drive[0], travel[0], force[0] = drive_of(problem, start, start_force), start, start_force
    sheet[0], branch[0], snap_after[0] = sheets, number, 0
    direction[0] = int(log.segments[0, DIRECTION]) if log.used[0] > 0 else 1
    none = _no_movers()
    residual[0], stability[0] = certify(problem, now, start_force, none)
    at = 1
    for k in range(log.used[0]):
        row = log.segments[k]
        kind, toward, follow = int(row[KIND]), int(row[DIRECTION]), row[FOLLOW] != 0.0
        rows = moved(problem, log, k, now)
        m = len(rows)
        movers = _movers(rows, summed(now))
        moving = none if kind == SNAP else movers
        if kind == SNAP:
            snap_after[at - 1] = 1
            number += 1
        places = np.empty(m)
        smooth = kind == MOVE or kind == DRIFT
        count = points if smooth else 2
        for p in range(0 if smooth else 1, count):
            if overspent(problem.effort, 1):
                break
            share = p / (count - 1)
            last = p == count - 1
            level = row[FORCE_0] + share * (row[FORCE_1] - row[FORCE_0])
            u = row[DRIVE_0] + share * (row[DRIVE_1] - row[DRIVE_0])
            if last or p == 0 or kind != MOVE:
                for j in range(m):
                    places[j] = rows[j, TRAVEL_0] + share * (rows[j, TRAVEL_1] - rows[j, TRAVEL_0])
                    if last:
                        places[j] = rows[j, TRAVEL_1]
                if last:
                    level, u = row[FORCE_1], row[DRIVE_1]
            elif m == 1 and beta == 0.0 and not follow:
                cell, piece = movers.cell[0], movers.piece[0]
                places[0] = u / alpha - movers.held
                if piece < 0:
                    piece = find_piece(pieces, cell, places[0], 0)
                places[0] = min(max(places[0], pieces.left[piece]), pieces.right[piece])
                level = law(laws, cell, pieces.picked[piece], places[0])[0] + movers.offset[0]
            else:
                level = point_at(problem, movers, row[FORCE_0], row[FORCE_1], u, places, follow)
            for j in range(m):
                now[movers.cell[j]] = places[j]
                if follow and movers.piece[j] >= 0:
                    piece = movers.piece[j]
                    movers.piece[j] = piece_along(pieces, movers.cell[j], piece, level)
                if sheet_of(problem.sheets, movers.cell[j]) != int(rows[j, SHEET_1]):
                    stand_on(laws, problem.sheets, pieces, movers.cell[j], int(rows[j, SHEET_1]))
            stands = drive[at - 1] == u and force[at - 1] == level
            if p == 0 and stands and direction[at - 1] == toward:
                # The branch goes on from the sample before.
                continue
            drive[at], travel[at], sheet[at], force[at] = u, now, sheets_of(problem.sheets), level
            branch[at], snap_after[at], direction[at] = number, 0, toward
            residual[at], stability[at] = certify(problem, now, level, moving)
            at += 1
    return at


@kernel
def _no_movers() -> Movers:
    """No movers."""
    return Movers(np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0), 0.0, 0.0)


@kernel
def _movers(rows: Floats, stroke: float) -> Movers:
    """The movers of a logged segment that begins at `stroke`."""
    m = len(rows)
    cell, piece, offset = np.empty(m, np.int64), np.empty(m, np.int64), np.empty(m)
    for j in range(m):
        cell[j], piece[j] = int(rows[j, CELL]), int(rows[j, PIECE])
        offset[j] = rows[j, OFFSET]
        stroke -= rows[j, TRAVEL_0]
    return Movers(cell, piece, offset, stroke, 0.0)
