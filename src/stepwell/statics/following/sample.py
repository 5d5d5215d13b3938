"""Points along a logged path, each with its certificate."""

import numpy as np

from stepwell.kernels import entry, overspent
from stepwell.mechanism import Floats, Ints, Laws, law, summed
from stepwell.statics.following.branch import point_at
from stepwell.statics.following.certificate import certify
from stepwell.statics.following.follow import (
    CELL,
    DIRECTION,
    DRIVE_0,
    DRIVE_1,
    FORCE_0,
    FORCE_1,
    HOLD,
    KIND,
    MOVE,
    OFFSET,
    PIECE,
    SNAP,
    TRAVEL_0,
    TRAVEL_1,
    Log,
)
from stepwell.statics.following.pieces import Pieces, find_piece


@entry()
def count_samples(log: Log, points: int) -> int:
    """How many samples `sample` will write."""
    total = 1
    for k in range(log.used[0]):
        kind = int(log.segments[k, KIND])
        total += 1 if kind == SNAP else (points if kind != HOLD else 2)
    return total


@entry(1e-4, "travel")
def sample(
    laws: Laws,
    pieces: Pieces,
    log: Log,
    start: Floats,
    start_force: float,
    alpha: float,
    beta: float,
    points: int,
    drive: Floats,
    travel: Floats,
    force: Floats,
    branch: Ints,
    snap_after: Ints,
    direction: Ints,
    residual: Floats,
    stability: Floats,
    effort: Ints,
) -> int:
    """Fill the arrays; evenly in the drive along a branch, both ends of every jump."""
    now = start.copy()
    at = 0
    part = 0
    drive[0] = alpha * summed(start) + beta * start_force
    travel[0], force[0], branch[0], snap_after[0] = now, start_force, 0, 0
    direction[0] = int(log.segments[0, DIRECTION]) if log.used[0] > 0 else 1
    residual[0], stability[0] = certify(
        laws, pieces, now, start_force, alpha, beta, np.empty(0, np.int64), np.empty(0, np.int64),
        np.empty(0),
    )  # fmt: skip
    at = 1
    for k in range(log.used[0]):
        row = log.segments[k]
        kind = int(row[KIND])
        movers = log.movers[log.first[k] : log.first[k + 1]]
        m = len(movers)
        cells = np.empty(m, np.int64)
        on = np.empty(m, np.int64)
        offset = np.empty(m)
        places = np.empty(m)
        for j in range(m):
            cells[j], on[j] = int(movers[j, CELL]), int(movers[j, PIECE])
            offset[j] = movers[j, OFFSET]
        if kind == SNAP:
            snap_after[at - 1] = 1
            part += 1
            for j in range(m):
                now[cells[j]] = movers[j, TRAVEL_1]
            drive[at], force[at] = row[DRIVE_1], row[FORCE_1]
            travel[at], branch[at], snap_after[at] = now, part, 0
            direction[at] = int(row[DIRECTION])
            residual[at], stability[at] = certify(
                laws, pieces, now, force[at], alpha, beta, cells[:0], on[:0], offset[:0]
            )
            at += 1
            continue
        rest = summed(now)
        for j in range(m):
            rest -= movers[j, TRAVEL_0]
        count = 2 if kind == HOLD else points
        for p in range(1 if kind == HOLD else 0, count):
            if overspent(effort, 1):
                break
            share = p / (count - 1)
            last = p == count - 1
            level = row[FORCE_0] + share * (row[FORCE_1] - row[FORCE_0])
            u = row[DRIVE_0] + share * (row[DRIVE_1] - row[DRIVE_0])
            if last or p == 0 or kind != MOVE:
                for j in range(m):
                    places[j] = movers[j, TRAVEL_0] + share * (
                        movers[j, TRAVEL_1] - movers[j, TRAVEL_0]
                    )
                    if last:
                        places[j] = movers[j, TRAVEL_1]
                if last:
                    level, u = row[FORCE_1], row[DRIVE_1]
            elif m == 1 and beta == 0.0:
                places[0] = u / alpha - rest
                piece = find_piece(pieces, cells[0], places[0], 0) if on[0] < 0 else on[0]
                places[0] = min(max(places[0], pieces.left[piece]), pieces.right[piece])
                level = law(laws, cells[0], pieces.picked[piece], places[0])[0] + offset[0]
            else:
                level = point_at(
                    laws, pieces, cells, on, offset, alpha, beta, rest, row[FORCE_0],
                    row[FORCE_1], u, places,
                )  # fmt: skip
            for j in range(m):
                now[cells[j]] = places[j]
            on_before = drive[at - 1] == u and force[at - 1] == level
            if p == 0 and on_before and direction[at - 1] == int(row[DIRECTION]):
                # The branch goes on from the sample before.
                continue
            drive[at], force[at] = u, level
            travel[at], branch[at], snap_after[at] = now, part, 0
            direction[at] = int(row[DIRECTION])
            residual[at], stability[at] = certify(
                laws, pieces, now, level, alpha, beta, cells, on, offset
            )
            at += 1
    return at
