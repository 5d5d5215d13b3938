"""What a computed path has to keep, looked at anew: equilibrium, stability, balance of energy."""

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import entry, kernel, leaf, overspent
from stepwell.mechanism import BEFORE, BEYOND, HIGH, LOW, Laws, law, stored, summed
from stepwell.statics.following.branch import inverse_slope, smallest_eigenvalue
from stepwell.statics.following.log import (
    CELL,
    DRIVE_1,
    FOLLOW,
    FORCE_1,
    KIND,
    OFFSET,
    PIECE,
    RELEASED,
    SHEET_1,
    SNAP,
    TRAVEL_0,
    TRAVEL_1,
    Log,
)
from stepwell.statics.following.pieces import Pieces, find_piece, sheet_of, stand_all_on, stand_on
from stepwell.statics.following.state import Movers, Problem, moved, nobody

KEPT, EQUILIBRIUM, STABILITY, ENERGY, STROKE = 0, 1, 2, 3, 4
# Shares of the largest force, and of what that force does or resists over a full travel. The
# engine keeps them a hundred times better; what breaks them has lost its digits.
FORCE_SLACK, STIFFNESS_SLACK, ENERGY_SLACK = 1e-7, 1e-4, 1e-7


@kernel
def certify(problem: Problem, travel: Floats, force: float, movers: Movers) -> tuple[float, float]:
    """Worst violation of equilibrium [N], and the least stiffness of what can move [N/m].

    Independent of how the point was found: every cell is looked at, moving or not. A cell at a
    kink has two stiffnesses; the smaller counts, unless a cell slides against friction: that one
    cannot give way to what the other side of the kink would set off.
    """
    laws, pieces, alpha, beta = problem.laws, problem.pieces, problem.alpha, problem.beta
    ends = problem.sheets.ends
    n = len(travel)
    worst = 0.0
    slides = False
    for cell in movers.cell:
        slides = slides or laws.friction[cell] > 0.0
    slopes = np.empty(n)
    free = 0
    place = np.full(n, -1)
    for j in range(len(movers.cell)):
        place[movers.cell[j]] = j
    for i in range(n):
        mine = int(place[i])
        known = mine >= 0 and movers.piece[mine] >= 0
        piece = int(movers.piece[mine]) if known else find_piece(pieces, i, travel[i], 0)
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
            slopes[free] = _slope(laws, pieces, i, piece, travel[i])
            if not slides:
                slopes[free] = min(slopes[free], _beyond(problem, i, piece, travel[i]))
            free += 1
    return worst, smallest_eigenvalue(slopes[:free], np.ones(free), alpha, beta)


@leaf
def _slope(laws: Laws, pieces: Pieces, cell: int, piece: int, travel: float) -> float:
    """κ with the sign of the piece."""
    if pieces.sign[piece] == 0:
        return 0.0
    return float(1.0 / inverse_slope(laws, pieces, cell, piece, travel))


@leaf
def _beyond(problem: Problem, cell: int, piece: int, travel: float) -> float:
    """κ on the other side of a joint of two pieces; inf away from one."""
    laws, pieces, ends = problem.laws, problem.pieces, problem.sheets.ends
    if travel == pieces.left[piece] and travel > ends[cell, LOW]:
        return _slope(laws, pieces, cell, piece - 1, travel)
    if travel == pieces.right[piece] and travel < ends[cell, HIGH]:
        return _slope(laws, pieces, cell, piece + 1, travel)
    return np.inf


@entry()
def audit(problem: Problem, log: Log, start: Floats, sheets: Ints) -> tuple[int, int, float]:
    """The first segment of a log that breaks a promise, which one, and by how much.

    KEPT if none does. At the end of every segment all cells are in equilibrium; on a smooth one,
    what each moving cell stores in addition lies between the bounds that its forces at the ends
    and in the middle set, its force being convex or concave there; a snap sets energy free, and
    the last of several at one drive ends in a place that is stable. [N], [N/m] or [J]. Where cells
    follow the force without rows of their own, all of them are looked at, and their travels added
    up, at the last such segment and at about 64 before it; at the others the cells with rows are.
    """
    laws, pieces, scale = problem.laws, problem.pieces, problem.scale
    n = len(start)
    now = start.copy()
    stand_all_on(laws, problem.sheets, pieces, sheets)
    lowest, highest = np.full(n, -np.inf), np.full(n, np.inf)
    # What every cell stores and pushes back with where it was seen last, and on which piece.
    energy, pushes, seen = np.zeros(n), np.zeros(n), np.full(n, -1)
    for i in range(n):
        _stands(problem, i, -1, now[i], lowest, highest)
    size = np.max(laws.full)
    count = log.used[0]
    every = max(1, count // 64)
    for k in range(count):
        if overspent(problem.effort, 1):
            break
        row = log.segments[k]
        force = row[FORCE_1]
        jumps = int(row[KIND]) == SNAP
        gap = 0.0
        follow = row[FOLLOW] != 0.0
        ends_here = k + 1 == count or log.segments[k + 1, FOLLOW] == 0.0
        whole = not follow or ends_here or k % every == 0
        movers = log.movers[log.first[k] : log.first[k + 1]]
        if whole:
            movers = moved(problem, log, k, now)
        for j in range(len(movers)):
            mover = movers[j]
            i, piece = int(mover[CELL]), int(mover[PIECE])
            before, now[i] = now[i], mover[TRAVEL_1]
            if sheet_of(problem.sheets, i) != int(mover[SHEET_1]):
                stand_on(laws, problem.sheets, pieces, i, int(mover[SHEET_1]))
            begun = before == mover[TRAVEL_0] and seen[i] == piece
            value = _stands(problem, i, piece, now[i], lowest, highest)
            seen[i] = -1
            # One that passes a joint on the way has no such bounds.
            if piece >= 0 and pieces.left[piece] <= mover[TRAVEL_0] <= pieces.right[piece]:
                seen[i] = piece
                picked, begin = pieces.picked[piece], mover[TRAVEL_0]
                held = energy[i] if begun else stored(laws, i, picked, begin)
                pushed = pushes[i] if begun else law(laws, i, picked, begin)[0]
                energy[i], pushes[i] = stored(laws, i, picked, now[i]), value
                gap = max(gap, abs(value + mover[OFFSET] - force))
                halfway = law(laws, i, picked, 0.5 * (begin + now[i]))[0]
                miss = _unbalanced(
                    energy[i] - held, now[i] - begin, 0.5 * (pushed + value), halfway
                )
                if not miss <= ENERGY_SLACK * scale * size:
                    return k, ENERGY, miss
        if whole:
            gap = max(gap, np.max(lowest) - force, force - np.min(highest))
        if follow and whole:
            lost = abs(problem.alpha * summed(now) + problem.beta * force - row[DRIVE_1])
            if not lost <= 1e-9 * (problem.alpha * summed(laws.full) + problem.beta * scale):
                return k, STROKE, lost
        if not gap <= FORCE_SLACK * scale:
            return k, EQUILIBRIUM, gap
        if jumps:
            if not row[RELEASED] >= -ENERGY_SLACK * scale * size:
                return k, ENERGY, -row[RELEASED]
            # Alike cells can creep into a saddle together, or stand on their tops under the same
            # force; they leave by another snap at the same drive.
            if not whole or _snaps_again(log, k):
                continue
            least = certify(problem, now, force, nobody())[1]
            if not least >= -STIFFNESS_SLACK * scale / size:
                return k, STABILITY, -least
    return -1, KEPT, 0.0


@leaf
def _snaps_again(log: Log, k: int) -> bool:
    """Whether another snap follows segment k before the drive goes on."""
    drive = log.segments[k, DRIVE_1]
    for after in range(k + 1, log.used[0]):
        if int(log.segments[after, KIND]) == SNAP:
            return True
        if abs(log.segments[after, DRIVE_1] - drive) > 1e-12 * abs(drive):
            return False
    return False


@leaf
def _stands(
    problem: Problem, cell: int, piece: int, travel: float, lowest: Floats, highest: Floats
) -> float:
    """Write down between which λ a cell stands; its force [N]."""
    laws, pieces, ends = problem.laws, problem.pieces, problem.sheets.ends
    on = piece if piece >= 0 else find_piece(pieces, cell, travel, 0)
    value = law(laws, cell, pieces.picked[on], travel)[0]
    falls, rises = travel > ends[cell, BEFORE], travel < ends[cell, BEYOND]
    lowest[cell] = value - laws.friction[cell] if falls else -np.inf
    highest[cell] = value + laws.friction[cell] if rises else np.inf
    return float(value)


@leaf
def _unbalanced(gained: float, way: float, mean: float, halfway: float) -> float:
    """By how much a cell stores more or less on its way than its force can make it [J].

    `mean` is that of its forces at both ends.
    """
    one, two = way * mean, way * halfway
    return float(max(gained - max(one, two), min(one, two) - gained))
