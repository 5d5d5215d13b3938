"""Landing of a snap in which one cell falls and all others stay on their branches: without flow.

A cell j that comes to the end of its branch at λ0 falls along its curve. As long as no other cell
leaves its branch, overdamped flow ends in the first equilibrium on the way, which is the first
root of x + Σ s_i(F_j(x)) = u: one scalar equation instead of a flow in N unknowns. This file proves
that (theory page, "Landing without flow") and solves the equation.
"""

from typing import NamedTuple

import numpy as np

from stepwell.base import Floats
from stepwell.kernels import leaf, overspent
from stepwell.mechanism import law
from stepwell.statics.following import rising as risings, state as st
from stepwell.statics.following.branch import drive_at, inverse_slope, point_at
from stepwell.statics.following.pieces import invert
from stepwell.statics.following.rising import Rising
from stepwell.statics.following.state import DrivenChain, Movers, State

# No landing is searched while the force has fallen by less than this fraction of the largest one:
# next to a fold the equation has a double root, and its sign is rounding.
_NEAR = 1e-9
# Number of parts of a curved rising piece for the bounds on it.
_PARTS = 8


class Falling(NamedTuple):
    """The falling cell, its place, and the place of the others."""

    cell: int
    piece: int
    travel: float
    force: float  # λ
    direction: int  # of its motion, and of the drive
    heaviest: float  # m κ of any cell on a rising branch [N/m]


@leaf
def floor_of(problem: DrivenChain, rising: Rising, falling: Falling) -> tuple[bool, float]:
    """Whether the fall is decided, and the force times direction below which no other one comes."""
    # One function: valley, mean and way change together from piece to piece.
    laws, pieces = problem.laws, problem.pieces
    j, p, travel, force, d, heaviest = falling
    own, others = problem.mobility[j], risings.sum_of(rising, risings.MOBILITY)
    begin, picked, edge = d * force, pieces.picked, pieces.among[j, (d + 1) // 2]
    # Of d F: its valley, and the least that the mean of all forces by mobility can be.
    valley, mean, way, at = begin, np.inf, 0.0, travel
    while True:
        end = pieces.right[p] if d > 0 else pieces.left[p]
        level = d * (pieces.force_right[p] if d > 0 else pieces.force_left[p])
        if pieces.sign[p] == 0:
            return False, begin
        if pieces.sign[p] < 0:
            way = abs(end - travel)
            valley = min(valley, level)
            mean = min(mean, others * begin + own * level - heaviest * way)
        else:
            over = level >= begin
            if over:
                end, level = invert(laws, pieces, j, p, force), begin
            straight = risings.is_straight(laws, pieces, j, p)
            parts = 1 if straight else _PARTS
            before = d * law(laws, j, picked[p], at)[0]
            for part in range(1, parts + 1):
                here = at + (end - at) * part / parts
                value = level if part == parts else d * law(laws, j, picked[p], here)[0]
                least = others * begin + own * (value if straight else min(before, value))
                mean, before = min(mean, least - heaviest * abs(here - travel)), value
            way = abs(end - travel)
            if over:
                break
            if p != edge and pieces.sign[p + d] <= 0:
                # Its next peak is lower: past that the others need not move one way only.
                return False, begin
        if p == edge:
            break
        at = end
        p += d
    soft = problem.beta > 0.0
    floor = max(valley, begin - way / problem.beta if soft else mean / (others + own))
    leaves = -risings.first_key(rising.queues, risings.END_DOWN if d > 0 else risings.END_UP)
    return bool(leaves < floor - st.TIE * problem.scale), float(floor)


@leaf
def with_curved(
    problem: DrivenChain, state: State, rising: Rising, cell: int, piece: int, apart: float
) -> Movers:
    """`cell` unless it is -1, and the rising cells of curved force; straight ones are `soft`."""
    spare, one = problem.spare, 0 if cell < 0 else 1
    cells, on, offset = spare.whole[st.MOVER], spare.whole[st.ON_PIECE], spare.number[st.EXTRA]
    if one > 0:
        cells[0], on[0], offset[0] = cell, piece, 0.0
    for k in range(rising.counts[0]):
        i = rising.curved[k]
        cells[one + k], on[one + k], offset[one + k] = i, state.piece[i], 0.0
    held, count = risings.sum_of(rising, risings.OFFSET) + apart, rising.counts[0] + one
    return Movers(
        cells[:count], on[:count], offset[:count], held, risings.sum_of(rising, risings.COMPLIANCE)
    )


@leaf
def _softest(problem: DrivenChain, movers: Movers, one: Floats, two: Floats) -> tuple[float, float]:
    """Bounds of dU/dλ between two places on the same pieces, on which κ is monotone."""
    low = high = problem.beta + problem.alpha * movers.soft
    for m in range(len(one)):
        cell, piece = movers.cell[m], movers.piece[m]
        a = problem.alpha * inverse_slope(problem, cell, piece, one[m])
        b = problem.alpha * inverse_slope(problem, cell, piece, two[m])
        low += min(a, b)
        high += max(a, b)
    return low, high


@leaf
def _first_return(
    problem: DrivenChain, movers: Movers, ends: tuple[float, float], goal: float, direction: int
) -> tuple[float, float, float]:
    """First λ between `ends` at which U is back at `goal` from beyond it, or NaN."""
    # Then the travel of the cell that falls, and how far from the goal U turns on the way [drive].
    count = len(movers.cell)
    spare = problem.spare
    a_places, b_places = spare.number[st.FAR_PLACE, :count], spare.number[st.PLACE, :count]
    a_places[:] = b_places[:] = np.nan
    one, two = spare.stack[0], spare.stack[1]
    one[0], two[0] = ends
    waiting, nearest = 1, np.inf
    near = _NEAR * problem.scale
    while waiting > 0:
        waiting -= 1
        a, b = one[waiting], two[waiting]
        if overspent(problem.effort, 8 * count):
            break
        drive_at(problem, movers, a, a_places, False)
        short = direction * (goal - drive_at(problem, movers, b, b_places, False))
        low, high = _softest(problem, movers, a_places, b_places)
        if low >= 0.0:
            # U moves away from the goal.
            continue
        if high <= 0.0:
            if short <= 0.0:
                root = point_at(problem, movers, a, b, goal, b_places, False)
                return root, b_places[0], nearest
            nearest = min(nearest, short)
            continue
        middle = 0.5 * (a + b)
        if abs(b - a) <= near or middle == a or middle == b:
            # The bounds stay undecided where terms of both signs nearly cancel; their sum at the
            # ends is exact, and U turns only if it becomes negative.
            at_a, _ = _softest(problem, movers, a_places, a_places)
            at_b, _ = _softest(problem, movers, b_places, b_places)
            if abs(a - ends[0]) > near and min(at_a, at_b) < 0.0:
                nearest = min(nearest, abs(short))
            continue
        one[waiting], two[waiting] = middle, b
        one[waiting + 1], two[waiting + 1] = a, middle
        waiting += 2
    return np.nan, np.nan, nearest


class FallEnd(NamedTuple):
    """End of a fall."""

    exists: bool
    force: float  # λ
    piece: int  # of the cell that fell
    travel: float  # of it
    missed: float  # by how much of the drive it missed an equilibrium before


# One kernel for speed: its steps share what each would get again as arguments.
@leaf
def land_after(
    problem: DrivenChain, state: State, rising: Rising, falling: Falling, floor: float, drive: float
) -> FallEnd:
    """The first equilibrium on the way of a falling cell, down to its floor."""
    # If there is one, the rising cells are put on their pieces there.
    # One function: piece, level and edge of the cell that falls are its locals.
    pieces, queues = problem.pieces, rising.queues
    j, p, travel, force, d, _ = falling
    behind, edge = risings.JOINT_DOWN if d > 0 else risings.JOINT_UP, pieces.among[j, (d + 1) // 2]
    # While it falls; `level` is where the rising cells are.
    begin = level = d * force
    missed = np.inf
    while pieces.sign[p] < 0:
        end = d * (pieces.force_right[p] if d > 0 else pieces.force_left[p])
        if not _goes_on_away(problem, rising, falling, p, travel):
            while level > max(end, floor):
                joint = -risings.first_key(queues, behind)
                following = max(end, floor, joint)
                movers = with_curved(problem, state, rising, j, p, 0.0)
                top = min(level, d * (pieces.force_left[p] if d > 0 else pieces.force_right[p]))
                if following < top:
                    way = d * top, d * following
                    root, place, near = _first_return(problem, movers, way, drive, d)
                    missed = min(missed, near)
                    if not np.isnan(root):
                        risings.count_work(rising, d * level, root)
                        return FallEnd(True, root, p, place, missed)
                risings.count_work(rising, d * level, d * following)
                level = following
                if joint >= level:
                    risings.pass_joint(problem, state, rising, -d)
        if end < floor or p == edge:
            break
        p += d
        travel = pieces.left[p] if d > 0 else pieces.right[p]
    # From there on all forces rise with λ, so there is one equilibrium: a search from above passes
    # the fewest joints.
    _lead_back(problem, state, rising, level, begin, d)
    level = begin
    while p != edge:
        over = d * (pieces.force_right[p] if d > 0 else pieces.force_left[p]) > begin
        if pieces.sign[p] > 0 and over:
            break
        p += d
    stop = float(pieces.right[p] if d > 0 else pieces.left[p])
    stopped = d * (pieces.force_right[p] if d > 0 else pieces.force_left[p]) <= begin
    while pieces.sign[p] > 0 or stopped:
        end = d * (pieces.force_right[p] if stopped == (d > 0) else pieces.force_left[p])
        joint = -risings.first_key(queues, behind)
        following = max(end, floor, joint)
        at = stop if stopped else invert(problem.laws, pieces, j, p, d * following)
        there = at + risings.stroke_at(problem, state, rising, d * following)
        if d * (there + problem.beta * d * following - drive) <= 0.0:
            one, apart = (-1, stop) if stopped else (j, 0.0)
            movers = with_curved(problem, state, rising, one, p, apart)
            places = problem.spare.number[st.PLACE, : len(movers.cell)]
            root = point_at(problem, movers, d * level, d * following, drive, places, False)
            risings.count_work(rising, d * level, root)
            return FallEnd(True, root, p, stop if stopped else places[0], missed)
        risings.count_work(rising, d * level, d * following)
        level = following
        if joint >= level:
            risings.pass_joint(problem, state, rising, -d)
        elif end < level:
            break
        elif stopped:
            stopped = False
        else:
            p -= d
    # By rounding there may be none: back to the beginning.
    _lead_back(problem, state, rising, level, begin, d)
    return FallEnd(False, force, falling.piece, falling.travel, missed)


@leaf
def _lead_back(
    problem: DrivenChain, state: State, rising: Rising, level: float, begin: float, d: int
) -> None:
    """Move the rising cells along d λ from a level back to the beginning."""
    ahead = risings.JOINT_UP if d > 0 else risings.JOINT_DOWN
    while risings.first_key(rising.queues, ahead) <= begin:
        joint = risings.first_key(rising.queues, ahead)
        risings.count_work(rising, d * level, d * joint)
        level = joint
        risings.pass_joint(problem, state, rising, d)
    risings.count_work(rising, d * level, d * begin)


@leaf
def _goes_on_away(
    problem: DrivenChain, rising: Rising, falling: Falling, p: int, travel: float
) -> bool:
    """Whether no equilibrium is passed up to the end of piece p: the others are softer."""
    laws, pieces, j = problem.laws, problem.pieces, falling.cell
    picked, end = pieces.picked[p], pieces.right[p] if falling.direction > 0 else pieces.left[p]
    gentle = min(-law(laws, j, picked, travel)[1], -law(laws, j, picked, end)[1])
    # Σ 1/κ of the others is Σ m / max (m κ) or more.
    return bool(
        (risings.sum_of(rising, risings.MOBILITY) / falling.heaviest + problem.beta) * gentle > 1.0
    )


@leaf
def heaviest_of(problem: DrivenChain) -> float:
    """The largest m κ of any cell on a rising piece [N/m]."""
    laws, pieces, most = problem.laws, problem.pieces, 0.0
    for i in range(len(problem.mobility)):
        for p in range(pieces.among[i, 0], pieces.among[i, 1] + 1):
            if pieces.sign[p] > 0:
                for travel in (pieces.left[p], pieces.right[p]):
                    slope = law(laws, i, pieces.picked[p], travel)[1]
                    most = max(most, problem.mobility[i] * abs(slope))
    return float(most)
