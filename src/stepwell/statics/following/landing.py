"""Exact landing of a snap in which one cell, or one pair of cells, moves.

The landing rule is overdamped flow at fixed drive, each cell with its own mobility. With one
degree of freedom the flow runs along a line, so no time has to be integrated: it stops at the
first place where the driving force vanishes, or at a stop.
"""

from typing import NamedTuple

import numpy as np

from stepwell.base import Floats
from stepwell.kernels import leaf, overspent
from stepwell.mechanism import BEFORE, BEYOND, HIGH, LOW, beyond, law
from stepwell.statics.following.pieces import find_piece
from stepwell.statics.following.state import FREE, HELD, DrivenChain, State, set_near

LANDED, STOPPED, JOINED, UNDECIDED, JUMPED = 0, 1, 2, 3, 4
# First rows in the spare stack: shifts where stretches end, and the results of `_ends` there.
_SHIFT = 3


class SnapLine(NamedTuple):
    """The line on which `forth` moves by +x and `back` by -x; for a -1 the actuator moves."""

    forth: int
    back: int
    from_forth: float  # [m] travels at x = 0
    from_back: float
    force: float  # [N] λ at x = 0
    softness: float  # [N/m] stiffness of the actuator, 0 for a dead load
    share: float  # of λ that is the pull of `back`, by mobility; the rest is what `forth` resists
    lowest: float  # [N] λ between which all other cells keep still
    highest: float


@leaf
def _ends(
    problem: DrivenChain, line: SnapLine, on: tuple[int, int], bias: float, x: float
) -> tuple[float, float, float, float]:
    """Pull (G) and resistance (H) after a shift x, and both slopes by x."""
    laws, picked = problem.laws, problem.pieces.picked
    if line.back >= 0:
        value, slope, _ = law(laws, line.back, picked[on[1]], line.from_back - x)
        pull, pull_slope = value - laws.friction[line.back] + bias, -slope
    else:
        pull, pull_slope = line.force - line.softness * x + bias, -line.softness
    if line.forth >= 0:
        value, slope, _ = law(laws, line.forth, picked[on[0]], line.from_forth + x)
        resist, resist_slope = value + laws.friction[line.forth], slope
    else:
        resist, resist_slope = line.force + line.softness * x, line.softness
    return pull, pull_slope, resist, resist_slope


@leaf
def _pieces_at(problem: DrivenChain, line: SnapLine, x: float, onward: int) -> tuple[int, int]:
    """The pieces of both cells after a shift x, those next on the way or those before."""
    pieces, forth, back = problem.pieces, line.forth, line.back
    on_forth = find_piece(pieces, forth, line.from_forth + x, onward) if forth >= 0 else 0
    return on_forth, find_piece(pieces, back, line.from_back - x, -onward) if back >= 0 else 0


@leaf
def pull_at(problem: DrivenChain, line: SnapLine, x: float) -> float:
    """Pull minus resistance after a shift x, as far as the line goes [N]."""
    ends = problem.sheets.ends
    if line.forth >= 0:
        x = min(x, ends[line.forth, HIGH] - line.from_forth)
    if line.back >= 0:
        x = min(x, line.from_back - ends[line.back, LOW])
    pull, _, resist, _ = _ends(problem, line, _pieces_at(problem, line, x, -1), 0.0, x)
    return float(pull - resist)


@leaf
def _level(line: SnapLine, pull: float, resist: float) -> float:
    """λ where a snap comes to rest."""
    if line.forth >= 0 and line.back >= 0:
        return line.share * pull + (1.0 - line.share) * resist
    return pull if line.back < 0 else resist


@leaf
def _balance(
    problem: DrivenChain,
    line: SnapLine,
    on: tuple[int, int],
    bias: float,
    ends: tuple[float, float, float, float],
) -> tuple[float, float, float]:
    """Shift between two others at which a falling pull is balanced; pull and resistance there."""
    # The secant with half the value of an end that stays (Dowell and Jarratt 1971), or the middle.
    a, b, at_a, at_b = ends
    size, stays, x = problem.laws.full[line.forth if line.forth >= 0 else line.back], 0, b
    for step in range(200):
        middle = 0.5 * (a + b)
        if not a < middle < b:
            break
        guess = b - at_b * (b - a) / (at_b - at_a) if step % 4 != 3 else middle
        if not a < guess < b:
            guess = middle
        near, x = abs(guess - x) <= 1e-16 * size, guess
        pull, _, resist, _ = _ends(problem, line, on, bias, x)
        left = pull - resist
        if left == 0.0 or near:
            break
        if left > 0.0:
            a, at_a = x, left
            at_b *= 0.5 if stays == 1 else 1.0
            stays = 1
        else:
            b, at_b = x, left
            at_a *= 0.5 if stays == -1 else 1.0
            stays = -1
    pull, _, resist, _ = _ends(problem, line, on, bias, x)
    return x, pull, resist


@leaf
def _wait(stack: Floats, k: int, x: float, there: tuple[float, float, float, float]) -> int:
    """Push the end of a stretch to place k of the stack; returns its new height."""
    stack[_SHIFT, k] = x
    for row in range(4):
        stack[_SHIFT + 1 + row, k] = there[row]
    return k + 1


# One kernel for speed: its steps share what each would get again as arguments.
@leaf
def land(
    problem: DrivenChain, line: SnapLine, start: float, bias: float
) -> tuple[int, float, float]:
    """Outcome, shift x and λ of a snap along a line; `bias` is a force that helps the motion."""
    # JOINED where the flow leaves the range of λ in which all other cells keep still.
    # One function: it goes from piece to piece with arrays that are taken out once.
    pieces, ends, effort = problem.pieces, problem.sheets.ends, problem.effort
    forth, back, from_forth, from_back = line.forth, line.back, line.from_forth, line.from_back
    tolerance = 1e-12 * problem.scale
    lowest, highest = line.lowest - tolerance, line.highest + tolerance
    limit = np.inf
    if forth >= 0:
        limit = min(limit, ends[forth, HIGH] - from_forth)
    if back >= 0:
        limit = min(limit, from_back - ends[back, LOW])
    size = problem.laws.full[forth if forth >= 0 else back]
    near, start = 1e-12 * size, start * size
    on_forth, on_back = _pieces_at(problem, line, 0.0, 1)
    paired, share = forth >= 0 and back >= 0, line.share
    stack, begin, looks = problem.spare.stack, 0.0, 0
    while True:
        end, on = limit, (on_forth, on_back)
        if forth >= 0:
            end = min(end, pieces.right[on_forth] - from_forth)
        if back >= 0:
            end = min(end, from_back - pieces.left[on_back])
        end = max(end, begin)
        # Shifts wait where stretches end, the nearest last; after one stretch comes the next.
        waiting, after, of_after = 0, begin, (0.0, 0.0, 0.0, 0.0)
        if end > begin:
            of_after = _ends(problem, line, on, bias, begin)
            waiting = _wait(stack, waiting, end, _ends(problem, line, on, bias, end))
        while waiting > 0:
            looks += 1
            if overspent(effort, 4) or looks > 200_000:
                return UNDECIDED, begin, line.force
            waiting -= 1
            a, (ga, dga, ha, dha) = after, of_after
            b, gb, dgb, hb, dhb = stack[_SHIFT:, waiting]
            after, of_after = b, (gb, dgb, hb, dhb)
            if paired:
                low = share * min(ga, gb) + (1.0 - share) * min(ha, hb)
                high = share * max(ga, gb) + (1.0 - share) * max(ha, hb)
                at_b = share * gb + (1.0 - share) * hb
            else:
                one, two = (ga, gb) if back < 0 else (ha, hb)
                low, high, at_b = min(one, two), max(one, two), two
            inside = low >= lowest and high <= highest
            falls = max(dga, dgb) - min(dha, dhb) <= 0.0
            rises = min(dga, dgb) - max(dha, dhb) >= 0.0
            if inside:
                if b <= start:
                    continue
                if rises and (ga - ha > 0.0 or a <= near):
                    continue
                if falls and gb - hb > 0.0:
                    continue
                if max(ga, gb) - min(ha, hb) <= tolerance and a > start:
                    # Two constant forces in balance: the cells come to rest here.
                    return LANDED, a, _level(line, ga, ha)
                if min(ga, gb) - max(ha, hb) > 0.0:
                    continue
                if falls and a >= start and ga - ha > 0.0:
                    x, g, h = _balance(problem, line, on, bias, (a, b, ga - ha, gb - hb))
                    return LANDED, x, _level(line, g, h)
            if b - a <= near or 0.5 * (a + b) <= a or 0.5 * (a + b) >= b:
                if gb - hb <= 0.0:
                    fall = (ga - ha) - (gb - hb)
                    x = b if fall <= 0.0 or ga <= ha else a + (b - a) * (ga - ha) / fall
                    g, _, h, _ = _ends(problem, line, on, bias, x)
                    return LANDED, x, _level(line, g, h)
                if at_b < lowest or at_b > highest:
                    return JOINED, b, at_b
                continue
            middle = 0.5 * (a + b)
            after, of_after = a, (ga, dga, ha, dha)
            of_middle = _ends(problem, line, on, bias, middle)
            waiting = _wait(stack, waiting + 1, middle, of_middle)
        if end >= limit:
            g, _, h, _ = _ends(problem, line, on, bias, limit)
            return STOPPED, limit, _level(line, g, h)
        if forth >= 0 and pieces.right[on_forth] - from_forth <= end:
            on_forth += 1
        if back >= 0 and from_back - pieces.left[on_back] <= end:
            on_back -= 1
        begin = end


@leaf
def least_pull(
    problem: DrivenChain, line: SnapLine, begin: float, end: float
) -> tuple[float, float]:
    """The least pull between two shifts with more on both sides, or inf; the stiffness there."""
    # One function: pieces, and whether the pull falls, are locals.
    pieces, forth, back = problem.pieces, line.forth, line.back
    on_forth, on_back = _pieces_at(problem, line, begin, 1)
    least, stiffness, falls, at = np.inf, 0.0, False, begin
    while at < end:
        until, on = end, (on_forth, on_back)
        if forth >= 0:
            until = min(until, pieces.right[on_forth] - line.from_forth)
        if back >= 0:
            until = min(until, line.from_back - pieces.left[on_back])
        until = max(until, at)
        if until > at:
            low, high = at, until
            pull, pull_slope, resist, resist_slope = _ends(problem, line, on, 0.0, at)
            if falls and pull_slope >= resist_slope and pull - resist < least:
                least, stiffness = pull - resist, max(abs(pull_slope), abs(resist_slope))
            falls = pull_slope < resist_slope
            _, pull_slope, _, resist_slope = _ends(problem, line, on, 0.0, until)
            if falls and pull_slope >= resist_slope:
                for _ in range(40):
                    middle = 0.5 * (low + high)
                    _, pull_slope, _, resist_slope = _ends(problem, line, on, 0.0, middle)
                    if pull_slope < resist_slope:
                        low = middle
                    else:
                        high = middle
                pull, pull_slope, resist, resist_slope = _ends(problem, line, on, 0.0, high)
                if pull - resist < least:
                    least, stiffness = pull - resist, max(abs(pull_slope), abs(resist_slope))
                falls = False
            else:
                falls = pull_slope < resist_slope
        if until >= end:
            break
        if forth >= 0 and pieces.right[on_forth] - line.from_forth <= until:
            on_forth += 1
        if back >= 0 and line.from_back - pieces.left[on_back] <= until:
            on_back -= 1
        at = until
    return max(least, 0.0), stiffness


# One kernel for speed: its steps share what each would get again as arguments.
@leaf
def note_next_snap(problem: DrivenChain, state: State) -> None:
    """Note the distance of λ to the force at which a cell would trigger one more snap."""
    # One function: one pass over the cells finds the nearest event of any kind.
    laws, pieces, ends, travel = problem.laws, problem.pieces, problem.sheets.ends, state.travel
    shared, falling = state.force[0], 0
    compliance = problem.beta / problem.alpha if problem.alpha > 0.0 else np.inf
    for i in range(len(travel)):
        gap = laws.friction[i] - abs(state.at_rest[i] - shared)
        slid = state.mode[i] == HELD and laws.friction[i] > 0.0 and gap <= 1e-9 * problem.scale
        if state.mode[i] == FREE or slid:
            heading = 1 if shared > state.at_rest[i] else -1
            piece = find_piece(pieces, i, travel[i], heading) if slid else state.piece[i]
            slope = law(laws, i, pieces.picked[piece], travel[i])[1]
            falling += slope < 0.0
            compliance += 1.0 / slope if slope != 0.0 else np.inf
    for i in range(len(travel)):
        if state.mode[i] == FREE and pieces.sign[state.piece[i]] <= 0:
            continue
        for heading in (1, -1):
            stop = ends[i, BEYOND] if heading > 0 else ends[i, BEFORE]
            if heading * (stop - travel[i]) <= 0.0:
                continue
            last = pieces.among[i, (heading + 1) // 2]
            first = find_piece(pieces, i, travel[i], heading)
            slope = law(laws, i, pieces.picked[first], travel[i])[1]
            piece, end, force = first, travel[i], heading * state.at_rest[i]
            if pieces.sign[first] > 0:
                while piece != last and pieces.sign[piece + heading] > 0:
                    piece += heading
                end = pieces.right[piece] if heading > 0 else pieces.left[piece]
                if piece == last and beyond(problem.sheets, i, end) < 0:
                    continue
                at_end = pieces.force_right[piece] if heading > 0 else pieces.force_left[piece]
                force = heading * at_end
            elif slope >= 0.0 or (falling == 0 and compliance <= -1.0 / slope):
                # If the others are too stiff it would follow λ and not snap.
                continue
            gap, room = force - heading * shared + laws.friction[i], heading * (end - travel[i])
            if room > 0.0:
                set_near(state.near, max(gap, 0.0), max(gap, 0.0) / room)
            elif laws.friction[i] == 0.0 or gap > 1e-9 * problem.scale:
                # A cell that slid here comes to rest like others that follow λ.
                set_near(state.near, max(gap, 0.0), -slope)
