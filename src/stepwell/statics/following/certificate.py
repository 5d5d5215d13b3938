"""Independent checks of a computed path, and samples along it with their certificates."""

from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import entry, kernel, leaf, overspent, record
from stepwell.mechanism import BEFORE, BEYOND, HIGH, LOW, largest, law, smallest, stored, summed
from stepwell.statics.following import log as logged, pieces as cutting, state as st
from stepwell.statics.following.branch import inverse_slope, point_at, smallest_eigenvalue
from stepwell.statics.following.log import Pair
from stepwell.statics.following.state import DrivenChain, Movers, drive_of, moved, some_movers

KEPT, EQUILIBRIUM, STABILITY, ENERGY, STROKE = 0, 1, 2, 3, 4
# Tolerances as fractions of the largest force, and of its work or stiffness over a full travel.
# The engine is a hundred times better; a path that fails them has lost its digits.
FORCE_SLACK, STIFFNESS_SLACK, ENERGY_SLACK = 1e-7, 1e-4, 1e-7
# Number of evaluations of all cells of a long chain.
_WHOLE_LOOKS = 8
# Rows of the work memory, free once a path is followed, for the last values of every cell in the
# audit: its travel, its least and largest λ, its energy and force ...
_NOW, _LOWEST, _HIGHEST, _ENERGY, _PUSHES = st.WAS, st.PLACE, st.FAR_PLACE, st.START, st.WORN
# ... the piece of these two values, its last piece, and its segment; or -1.
_SEEN, _ON, _NAMED = st.MODES, st.SHEETS, st.WAS_ON


@leaf
def certify(problem: DrivenChain, travel: Floats, force: float, movers: Movers) -> Pair:
    """Worst violation of equilibrium by any cell [N], least stiffness of the free cells [N/m]."""
    # At a kink the smaller of two counts, unless a cell slides: it cannot give way to the other.
    # One function: one pass over the cells finds the worst force and all slopes.
    laws, pieces, alpha, beta = problem.laws, problem.pieces, problem.alpha, problem.beta
    ends, spare, worst, free, slides = problem.sheets.ends, problem.spare, 0.0, 0, False
    slopes, ones, place = spare.number[st.SLOPES], spare.number[st.WEIGHTS], spare.whole[st.MINE]
    place[:] = -1
    for j in range(len(movers.cell)):
        place[movers.cell[j]] = j
        slides = slides or laws.friction[movers.cell[j]] > 0.0
    for i in range(len(travel)):
        mine = int(place[i])
        known = mine >= 0 and movers.piece[mine] >= 0
        piece = int(movers.piece[mine]) if known else cutting.find_piece(pieces, i, travel[i], 0)
        value, _, _ = law(laws, i, pieces.picked[piece], travel[i])
        friction = laws.friction[i]
        forward, backward = value + friction - force, force - value + friction
        rises, falls = travel[i] < ends[i, BEYOND], travel[i] > ends[i, BEFORE]
        if rises:
            worst = max(worst, -forward)
        if falls:
            worst = max(worst, -backward)
        inside = rises and falls
        if mine >= 0 and inside:
            worst = max(worst, abs(value + movers.offset[mine] - force))
        if inside and (friction == 0.0 or mine >= 0):
            slopes[free] = _slope(problem, i, piece, travel[i])
            if not slides:
                slopes[free] = min(slopes[free], _beyond(problem, i, piece, travel[i]))
            ones[free] = 1.0
            free += 1
    return worst, smallest_eigenvalue(slopes[:free], ones[:free], alpha, beta)


@leaf
def _slope(problem: DrivenChain, cell: int, piece: int, travel: float) -> float:
    """κ with the sign of the piece."""
    if problem.pieces.sign[piece] == 0:
        return 0.0
    return float(1.0 / inverse_slope(problem, cell, piece, travel))


@leaf
def _beyond(problem: DrivenChain, cell: int, piece: int, travel: float) -> float:
    """κ on the other side of a joint of two pieces; inf away from one."""
    pieces, ends = problem.pieces, problem.sheets.ends
    if travel == pieces.left[piece] and travel > ends[cell, LOW]:
        return _slope(problem, cell, piece - 1, travel)
    if travel == pieces.right[piece] and travel < ends[cell, HIGH]:
        return _slope(problem, cell, piece + 1, travel)
    return np.inf


# One kernel for speed: its steps share what each would get again as arguments.
@entry()
@leaf
def audit(
    problem: DrivenChain, log: logged.Log, start: Floats, sheets: Ints
) -> tuple[int, int, float]:
    """The first segment of a log that fails a check, or -1; the check; by how much."""
    # At the end of a segment all cells are in equilibrium. On a smooth one the energy of a moving
    # cell is within the bounds by the forces at its ends and middle, being convex or concave there.
    # A snap releases energy, and the last of several at one drive ends in a stable equilibrium. If
    # cells follow the force without rows, all are evaluated and summed at the last such segment and
    # at about 8 before it, else only the cells with rows.
    # One function: every segment updates the same places, limits and marks.
    laws, pieces, scale, spare = problem.laws, problem.pieces, problem.scale, problem.spare
    n, ends = len(start), problem.sheets.ends
    cutting.stand_all_on(laws, problem.sheets, pieces, sheets)
    number, whole = spare.number, spare.whole
    now, named = number[_NOW], whole[_NAMED]
    for i in range(n):
        now[i], number[_ENERGY, i], number[_PUSHES, i] = start[i], 0.0, 0.0
        whole[_SEEN, i] = whole[_ON, i] = named[i] = -1
        _stands(problem, i, -1)
    limit, size = ENERGY_SLACK * scale * largest(laws.full), largest(laws.full)
    count = log.used[0]
    every = max(1, count // _WHOLE_LOOKS)
    for k in range(count):
        if overspent(problem.effort, 1):
            break
        row = log.segments[k]
        force, jumps, follow = (
            row[logged.FORCE_1],
            int(row[logged.KIND]) == logged.SNAP,
            row[logged.FOLLOW] != 0.0,
        )
        ends_here = k + 1 == count or log.segments[k + 1, logged.FOLLOW] == 0.0
        all_of_them = not follow or ends_here or k % every == 0
        gap, miss = 0.0, 0.0
        for j in range(log.first[k], log.first[k + 1]):
            mover = log.movers[j]
            i = int(mover[logged.CELL])
            named[i] = k
            if cutting.sheet_of(problem.sheets, i) != int(mover[logged.SHEET_1]):
                cutting.stand_on(laws, problem.sheets, pieces, i, int(mover[logged.SHEET_1]))
            way = mover[logged.TRAVEL_0], mover[logged.TRAVEL_1]
            off, lost = _goes(
                problem, i, int(mover[logged.PIECE]), way, force - mover[logged.OFFSET]
            )
            gap, miss = max(gap, off), max(miss, lost)
        if follow and all_of_them:
            for i in range(n):
                if named[i] == k or not ends[i, LOW] < now[i] < ends[i, HIGH]:
                    continue
                piece = cutting.piece_along(pieces, i, _rising_piece(problem, i), force)
                way = now[i], cutting.invert(laws, pieces, i, piece, force)
                off, lost = _goes(problem, i, -1 if jumps else piece, way, force)
                whole[_ON, i] = piece
                gap, miss = max(gap, off), max(miss, lost)
        if not miss <= limit:
            return k, ENERGY, miss
        if all_of_them:
            gap = max(gap, largest(number[_LOWEST]) - force, force - smallest(number[_HIGHEST]))
        if follow and all_of_them:
            lost = abs(problem.alpha * summed(now) + problem.beta * force - row[logged.DRIVE_1])
            if not lost <= 1e-9 * (problem.alpha * summed(laws.full) + problem.beta * scale):
                return k, STROKE, lost
        if not gap <= FORCE_SLACK * scale:
            return k, EQUILIBRIUM, gap
        if jumps:
            if not row[logged.RELEASED] >= -limit:
                return k, ENERGY, -row[logged.RELEASED]
            # Equal cells can reach a saddle together, or their peaks under the same force; they
            # leave by another snap at the same drive.
            if not all_of_them or _snaps_again(log, k):
                continue
            least = certify(problem, now, force, some_movers(spare, 0, 0.0))[1]
            if not least >= -STIFFNESS_SLACK * scale / size:
                return k, STABILITY, -least
    return -1, KEPT, 0.0


@leaf
def _rising_piece(problem: DrivenChain, i: int) -> int:
    pieces, spare = problem.pieces, problem.spare
    on, travel = spare.whole[_ON, i], spare.number[_NOW, i]
    if on >= 0 and pieces.sign[on] > 0 and pieces.left[on] <= travel <= pieces.right[on]:
        return int(on)
    return cutting.resting_piece(pieces, i, travel)


@leaf
def _goes(problem: DrivenChain, i: int, piece: int, way: Pair, force: float) -> Pair:
    """Move a cell to its end; errors of its `force` there [N], and of its stored energy [J]."""
    laws, pieces, (begin, end) = problem.laws, problem.pieces, way
    number, whole = problem.spare.number, problem.spare.whole
    begun = number[_NOW, i] == begin and whole[_SEEN, i] == piece
    number[_NOW, i] = end
    value = _stands(problem, i, piece)
    whole[_SEEN, i], whole[_ON, i] = -1, piece
    # One that passes a joint on the way has no such bounds.
    if piece < 0 or not pieces.left[piece] <= begin <= pieces.right[piece]:
        return 0.0, 0.0
    whole[_SEEN, i] = piece
    picked = pieces.picked[piece]
    held = number[_ENERGY, i] if begun else stored(laws, i, picked, begin)
    pushed = number[_PUSHES, i] if begun else law(laws, i, picked, begin)[0]
    number[_ENERGY, i], number[_PUSHES, i] = stored(laws, i, picked, end), value
    halfway = law(laws, i, picked, 0.5 * (begin + end))[0]
    gained, off = number[_ENERGY, i] - held, abs(value - force)
    one, two = (end - begin) * (0.5 * (pushed + value)), (end - begin) * halfway
    lost = max(gained - max(one, two), min(one, two) - gained)
    # What is no number would be lost among the others.
    return off if off >= 0.0 else np.inf, lost if lost > -np.inf else np.inf


@leaf
def _snaps_again(log: logged.Log, k: int) -> bool:
    """Whether another snap follows segment k at the same drive."""
    drive = log.segments[k, logged.DRIVE_1]
    for after in range(k + 1, log.used[0]):
        if int(log.segments[after, logged.KIND]) == logged.SNAP:
            return True
        if abs(log.segments[after, logged.DRIVE_1] - drive) > 1e-12 * abs(drive):
            return False
    return False


@leaf
def _stands(problem: DrivenChain, cell: int, piece: int) -> float:
    """Store the least and largest λ of a cell; returns its force [N]."""
    laws, pieces, ends = problem.laws, problem.pieces, problem.sheets.ends
    number, travel = problem.spare.number, problem.spare.number[_NOW, cell]
    on = piece if piece >= 0 else cutting.find_piece(pieces, cell, travel, 0)
    value = law(laws, cell, pieces.picked[on], travel)[0]
    falls, rises = travel > ends[cell, BEFORE], travel < ends[cell, BEYOND]
    number[_LOWEST, cell] = value - laws.friction[cell] if falls else -np.inf
    number[_HIGHEST, cell] = value + laws.friction[cell] if rises else np.inf
    return float(value)


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


def memory_for_samples(log: logged.Log, points: int, cells: int) -> Samples:
    """Memory for the samples of a log, with this number on every smooth branch."""
    kinds = log.segments[:, logged.KIND]
    ends = np.where(kinds == logged.SNAP, 1, np.where(kinds == logged.HOLD, 2, points))
    size = 1 + int(np.sum(ends))
    drive, force, residual, stability = np.empty((4, size))
    branch, snap_after, direction = np.zeros((3, size), np.int64)
    travel, sheet = np.empty((size, cells)), np.zeros((size, cells), np.int64)
    whole = branch, snap_after, direction
    return Samples(drive, travel, sheet, force, *whole, residual, stability)


# One kernel for speed: its steps share what each would get again as arguments.
@entry(1e-4, "samples.travel")
def sample(
    problem: DrivenChain,
    log: logged.Log,
    start: Floats,
    sheets: Ints,
    start_force: float,
    points: int,
    samples: Samples,
) -> int:
    """Fill the samples; evenly in the drive along a branch, both ends of every jump."""
    # One function: a sample fills nine arrays, which are taken out once.
    laws, pieces, alpha, beta = problem.laws, problem.pieces, problem.alpha, problem.beta
    drive, travel, sheet, force = samples.drive, samples.travel, samples.sheet, samples.force
    branch, snap_after, direction = samples.branch, samples.snap_after, samples.direction
    residual, stability = samples.residual, samples.stability
    cutting.stand_all_on(laws, problem.sheets, pieces, sheets)
    now, number = start.copy(), 0
    drive[0], travel[0], force[0] = drive_of(problem, start, start_force), start, start_force
    sheet[0], branch[0], snap_after[0] = sheets, number, 0
    direction[0] = int(log.segments[0, logged.DIRECTION]) if log.used[0] > 0 else 1
    none = _movers(np.empty((0, logged.MOVER_COLUMNS)), 0.0)
    residual[0], stability[0] = certify(problem, now, start_force, none)
    at = 1
    for k in range(log.used[0]):
        row = log.segments[k]
        kind, toward = int(row[logged.KIND]), int(row[logged.DIRECTION])
        begins, ends, follow = row[logged.FORCE_0], row[logged.FORCE_1], row[logged.FOLLOW] != 0.0
        rows = moved(problem, log, k, now)
        movers, m = _movers(rows, summed(now)), len(rows)
        moving = none if kind == logged.SNAP else movers
        if kind == logged.SNAP:
            snap_after[at - 1] = 1
            number += 1
        places, smooth = np.empty(m), kind == logged.MOVE or kind == logged.DRIFT
        count = points if smooth else 2
        for p in range(0 if smooth else 1, count):
            if overspent(problem.effort, 1):
                break
            share, last = p / (count - 1), p == count - 1
            level = begins + share * (ends - begins)
            u = row[logged.DRIVE_0] + share * (row[logged.DRIVE_1] - row[logged.DRIVE_0])
            if last or p == 0 or kind != logged.MOVE:
                for j in range(m):
                    was, there = rows[j, logged.TRAVEL_0], rows[j, logged.TRAVEL_1]
                    places[j] = there if last else was + share * (there - was)
                if last:
                    level, u = ends, row[logged.DRIVE_1]
            elif m == 1 and beta == 0.0 and not follow:
                cell, piece = movers.cell[0], movers.piece[0]
                places[0] = u / alpha - movers.held
                if piece < 0:
                    piece = cutting.find_piece(pieces, cell, places[0], 0)
                places[0] = min(max(places[0], pieces.left[piece]), pieces.right[piece])
                level = law(laws, cell, pieces.picked[piece], places[0])[0] + movers.offset[0]
            else:
                level = point_at(problem, movers, begins, ends, u, places, follow)
            for j in range(m):
                i, on = movers.cell[j], int(rows[j, logged.SHEET_1])
                now[i] = places[j]
                if follow and movers.piece[j] >= 0:
                    movers.piece[j] = cutting.piece_along(pieces, i, movers.piece[j], level)
                if cutting.sheet_of(problem.sheets, i) != on:
                    cutting.stand_on(laws, problem.sheets, pieces, i, on)
            stands = drive[at - 1] == u and force[at - 1] == level
            if p == 0 and stands and direction[at - 1] == toward:
                # The branch continues from the previous sample.
                continue
            drive[at], travel[at], sheet[at], force[at] = (
                u,
                now,
                cutting.sheets_of(problem.sheets),
                level,
            )
            branch[at], snap_after[at], direction[at] = number, 0, toward
            residual[at], stability[at] = certify(problem, now, level, moving)
            at += 1
    return at


@kernel
def _movers(rows: Floats, stroke: float) -> Movers:
    """The movers of a logged segment that begins at `stroke`."""
    for travel in rows[:, logged.TRAVEL_0]:
        stroke -= travel
    cell, piece = rows[:, logged.CELL].astype(np.int64), rows[:, logged.PIECE].astype(np.int64)
    return Movers(cell, piece, rows[:, logged.OFFSET].copy(), stroke, 0.0)
