"""Following long chains: events out of queues and landings out of one equation.

What `follow` does event by event over all cells is done here for the cells that an event concerns,
so that a cycle grows as N log N. Cells without friction whose curves do not fold back, on a stroke
or behind a spring. All other events (a race, constant forces, a release against the drive) go back
to `follow`, which handles one event and returns to this file.
"""

import numpy as np

from stepwell.kernels import leaf, overspent
from stepwell.mechanism import largest, smallest, stored
from stepwell.statics.following import log as logged, rising as risings, state as st
from stepwell.statics.following.branch import first_fold, inverse_slope, point_at
from stepwell.statics.following.fall import Falling, floor_of, heaviest_of, land_after, with_curved
from stepwell.statics.following.log import add_mover
from stepwell.statics.following.pieces import find_piece, invert
from stepwell.statics.following.rising import Rising
from stepwell.statics.following.state import DrivenChain, State

# With fewer pieces in total, a loop over all cells is as fast as queues.
_WORTH = 64


@leaf
def is_regular(problem: DrivenChain) -> bool:
    """Whether long stretches of the path of a chain can be followed here."""
    laws, sheets = problem.laws, problem.sheets
    return bool(
        problem.alpha == 1.0
        and problem.pieces.of_sheet[-1] >= _WORTH
        and len(sheets.table) == len(sheets.now)
        and largest(laws.friction) == 0.0
        and smallest(problem.rank) == largest(problem.rank)
    )


@leaf
def _gather(problem: DrivenChain, state: State, rising: Rising, direction: int) -> tuple[bool, int]:
    """Sort the cells into the queues; whether that is possible, and the falling cell or -1."""
    leader = -1
    for i in range(len(state.mode)):
        if state.mode[i] == st.HELD:
            risings.rest(problem, state, rising, i)
            continue
        if state.mode[i] != st.FREE and state.sense[i] != direction:
            return False, -1
        sign = problem.pieces.sign[state.piece[i]]
        if sign > 0:
            risings.rise(problem, state, rising, i, state.piece[i])
        elif sign < 0 and leader < 0:
            leader = i
        else:
            return False, -1
    trigger = state.next_snap[st.TRIGGER]
    return trigger < 0 or trigger == leader, leader


@leaf
def _name(rising: Rising, i: int, travel: float) -> None:
    """Add cell i to the row of the segment, with its `travel` at the beginning."""
    segment = rising.segment
    if segment.named[i] == 0:
        k = segment.counts[0]
        segment.cell[k], segment.travel[k], segment.named[i] = i, travel, 1
        segment.counts[0] = k + 1


@leaf
def _end_segment(
    problem: DrivenChain, state: State, rising: Rising, kind: int, direction: int, drive: float
) -> None:
    """Write the segment that ends here, if it is not empty."""
    segment, force, begin = rising.segment, state.force[0], rising.segment.begin
    if kind != logged.SNAP and force == begin[1] and drive == begin[0]:
        return
    st.write_row(state, kind, direction, (begin[0], drive), (begin[1], force), (0.0, 0.0))
    row = state.log.used[0] - 1
    state.log.segments[row, logged.FOLLOW] = 1.0
    if kind == logged.SNAP:
        state.log.segments[row, logged.DECIDED] = logged.BY_EQUATION
    for k in range(segment.counts[0]):
        i = segment.cell[k]
        piece = -1 if kind == logged.SNAP else int(state.piece[i])
        after = float(state.travel[i])
        if not risings.is_held(rising, i):
            after = risings.travel_at_force(problem, state, i, force)
        add_mover(state.log, i, piece, 0.0, segment.travel[k], after)
        segment.named[i] = 0
    segment.counts[0], segment.counts[1] = 0, row
    begin[0], begin[1] = drive, force


@leaf
def _leave_branch(problem: DrivenChain, state: State, rising: Rising, i: int, toward: int) -> None:
    """Remove a cell from its branch at its end for λ going `toward`; its row is due."""
    pieces, log, segment = problem.pieces, state.log, rising.segment
    force, piece = segment.begin[1], state.piece[i]
    end = float(pieces.right[piece] if toward > 0 else pieces.left[piece])
    if state.force[0] != force:
        _name(rising, i, risings.travel_at_force(problem, state, i, force))
    elif segment.counts[1] >= 0 and segment.named[i] == 0:
        # No cell has moved since the row before, which did not name it.
        before = log.segments[segment.counts[1], logged.FORCE_0]
        was = risings.travel_at_force(problem, state, i, before)
        add_mover(log, i, piece, 0.0, was, end)
    risings.rise_no_more(problem, state, rising, i)
    state.travel[i] = end


@leaf
def _stop_here(
    problem: DrivenChain, state: State, rising: Rising, direction: int, drive: float, closes: bool
) -> None:
    """Update the travels of all cells, and add the missing cells to the last row."""
    pieces, force, segment = problem.pieces, state.force[0], rising.segment
    kind = logged.MOVE if rising.counts[1] > 0 or segment.counts[0] > 0 else logged.HOLD
    _end_segment(problem, state, rising, kind, direction, drive)
    softest, most, total = -1, 0.0, 0.0
    for i in range(len(state.mode)):
        if not risings.is_held(rising, i):
            state.travel[i] = risings.travel_at_force(problem, state, i, force)
            soft = inverse_slope(problem, i, state.piece[i], state.travel[i])
            if soft > most:
                softest, most = i, soft
        total += state.travel[i]
    if closes and softest >= 0 and most > problem.beta:
        on = state.piece[softest]
        at = state.travel[softest] + (drive - problem.beta * force - total)
        state.travel[softest] = min(max(at, pieces.left[on]), pieces.right[on])
    if segment.counts[1] >= 0:
        _name_all(problem, state, rising)


@leaf
def _name_all(problem: DrivenChain, state: State, rising: Rising) -> None:
    """Add the missing cells to the last row, with their present travels."""
    log, segment, row = state.log, rising.segment, rising.segment.counts[1]
    for m in range(log.first[row], log.first[row + 1]):
        mover = log.movers[m]
        i = int(mover[logged.CELL])
        segment.named[i] = 1
        if not risings.is_held(rising, i):
            mover[logged.TRAVEL_1] = state.travel[i]
    before = log.segments[row, logged.FORCE_0]
    snapped = int(log.segments[row, logged.KIND]) == logged.SNAP
    for i in range(len(state.mode)):
        if not risings.is_held(rising, i) and segment.named[i] == 0:
            piece = -1 if snapped else state.piece[i]
            was = risings.travel_at_force(problem, state, i, before)
            add_mover(log, i, piece, 0.0, was, state.travel[i])


@leaf
def _next_cell(problem: DrivenChain, state: State, rising: Rising, q: int, toward: int) -> int:
    """The cell of the first event; a tie is noted if it decides the falling cell."""
    queues, within = rising.queues, st.TIE * problem.scale
    if not risings.ties(queues, q, within):
        return int(queues.heap[q, 0])
    limit = risings.first_key(queues, q) + within
    falls, other, goes = -1, -1, -1
    for i in range(len(state.mode)):
        at = queues.place[i, q]
        if at < 0 or queues.key[q, at] > limit:
            continue
        if risings.past_end(problem, state, rising, i, toward) != -1:
            goes = i if goes < 0 else goes
        elif falls < 0:
            falls = i
        else:
            other = i
    if goes >= 0:
        if falls >= 0:
            st.set_tie(state.tie, goes, falls)
        return goes
    st.set_tie(state.tie, falls, other)
    return falls


# One kernel for speed: its steps share what each would get again as arguments.
@leaf
def advance(
    problem: DrivenChain, state: State, rising: Rising, direction: int, target: float, slack: float
) -> int:
    """Follow a chain towards a target; GOES_ON at an event that `follow` has to handle."""
    # One function: an event changes force, drive and queues, all locals, at once.
    laws, pieces, d = problem.laws, problem.pieces, direction
    n, places = len(state.mode), problem.spare.number[st.PLACE]
    risings.clear(rising)
    regular, leader = _gather(problem, state, rising, d)
    if not regular or (leader >= 0 and rising.counts[0] > 0):
        return st.GOES_ON
    queues, segment = rising.queues, rising.segment
    joint, end = (
        (risings.JOINT_UP, risings.END_UP) if d > 0 else (risings.JOINT_DOWN, risings.END_DOWN)
    )
    joint_back, end_back = (
        (risings.JOINT_DOWN, risings.END_DOWN) if d > 0 else (risings.JOINT_UP, risings.END_UP)
    )
    force = float(state.force[0])
    apart = float(state.travel[leader]) if leader >= 0 else 0.0
    drive = risings.stroke_at(problem, state, rising, force) + apart + problem.beta * force
    segment.begin[0], segment.begin[1] = drive, force
    known = leader >= 0 and state.next_snap[st.TRIGGER] >= 0
    why = int(state.next_snap[st.WHY]) if known else logged.FOLD
    heaviest, log, status = -1.0, state.log, st.GOES_ON
    while True:
        if d * (target - drive) <= slack:
            status = st.DONE
            break
        if log.used[0] + 6 > len(log.segments) or log.used[1] + 4 * n + 16 > len(log.movers):
            status = st.LOG_FULL
            break
        if overspent(problem.effort, 4 + rising.counts[0]):
            status = st.GAVE_UP
            break
        if leader < 0:
            joint_key, end_key = risings.first_key(queues, joint), risings.first_key(queues, end)
            key = min(joint_key, end_key)
            if key == np.inf:
                break
            there = risings.stroke_at(problem, state, rising, d * key) + problem.beta * d * key
            if d * (there - target) > slack:
                movers = with_curved(problem, state, rising, -1, 0, 0.0)
                at = places[: len(movers.cell)]
                state.force[0] = point_at(problem, movers, force, d * key, target, at, False)
                drive, status = target, st.DONE
                break
            if joint_key <= end_key:
                risings.pass_joint(problem, state, rising, d)
                state.force[0] = force = d * key
                drive = there
                continue
            if rising.counts[0] > 0 and risings.ties(queues, end, st.TIE * problem.scale):
                # Where curved forces turn together the sum of 1/κ is rounding, see `smooth`.
                break
            i = _next_cell(problem, state, rising, end, d)
            past = risings.past_end(problem, state, rising, i, d)
            if past == 0:
                break
            kind = logged.MOVE if rising.counts[1] > 0 else logged.HOLD
            state.force[0] = force = d * key
            drive, state.next_snap[st.TRIGGER] = there, -1
            if risings.is_held(rising, i):
                _end_segment(problem, state, rising, kind, d, drive)
                risings.rest_no_more(state, rising, i)
                piece = find_piece(pieces, i, state.travel[i], d)
                if past > 0:
                    _name(rising, i, state.travel[i])
                    risings.rise(problem, state, rising, i, piece)
                    continue
                why = logged.RELEASE
            else:
                piece = state.piece[i] + d
                _leave_branch(problem, state, rising, i, d)
                _end_segment(problem, state, rising, kind, d, drive)
                if past == 2:
                    risings.rest(problem, state, rising, i)
                    continue
                why = logged.KINK
            leader = i
            state.mode[i], state.sense[i], state.piece[i] = st.FREE, 0, piece
            continue
        # One cell falls: with λ going back while that is stable.
        piece, travel = int(state.piece[leader]), float(state.travel[leader])
        own = inverse_slope(problem, leader, piece, travel)
        stable = own + risings.softness_at(problem, state, rising) + problem.beta < 0.0
        if stable:
            last = d * float(pieces.force_right[piece] if d > 0 else pieces.force_left[piece])
            joint_level, end_level = (
                -risings.first_key(queues, joint_back),
                -risings.first_key(queues, end_back),
            )
            level = max(last, joint_level, end_level)
            if min(last, end_level) >= level - st.TIE * problem.scale:
                # Both come to the ends of their branches, as alike cells do.
                break
            movers = with_curved(problem, state, rising, leader, piece, 0.0)
            fold = np.nan
            if rising.counts[0] > 0 or not risings.is_straight(laws, pieces, leader, piece):
                fold = first_fold(problem, movers, force, d * level)
            following = d * level if np.isnan(fold) else fold
            place = invert(laws, pieces, leader, piece, following)
            there = (
                risings.stroke_at(problem, state, rising, following)
                + place
                + problem.beta * following
            )
            _name(rising, leader, travel)
            if d * (there - target) > slack:
                at = places[: len(movers.cell)]
                state.force[0] = point_at(problem, movers, force, following, target, at, False)
                state.travel[leader] = at[0]
                drive, status = target, st.DONE
                break
            state.force[0] = force = following
            state.travel[leader], drive = place, there
            why, state.next_snap[st.TRIGGER] = logged.FOLD, -1
            if not np.isnan(fold):
                stable = False
            elif level == last:
                edge = pieces.among[leader, (d + 1) // 2]
                state.travel[leader] = pieces.right[piece] if d > 0 else pieces.left[piece]
                sign = 2 if piece == edge else pieces.sign[piece + d]
                if sign == -1:
                    state.piece[leader] = piece + d
                    continue
                if sign == 0:
                    break
                _end_segment(problem, state, rising, logged.MOVE, d, drive)
                if sign == 2:
                    risings.rest(problem, state, rising, leader)
                else:
                    risings.rise(problem, state, rising, leader, piece + d)
                leader = -1
                continue
            elif joint_level >= end_level:
                risings.pass_joint(problem, state, rising, -d)
                continue
            else:
                i = int(queues.heap[end_back, 0])
                stops = (
                    not risings.is_held(rising, i)
                    and risings.past_end(problem, state, rising, i, -d) == 2
                )
                if not stops or risings.ties(queues, end_back, st.TIE * problem.scale):
                    break
                _leave_branch(problem, state, rising, i, -d)
                _end_segment(problem, state, rising, logged.MOVE, d, drive)
                risings.rest(problem, state, rising, i)
                continue
        # It falls on by itself, at a fixed drive.
        _end_segment(problem, state, rising, logged.MOVE, d, drive)
        st.set_snap(state.next_snap, leader, d, why)
        if heaviest < 0.0:
            heaviest = heaviest_of(problem)
        travel = float(state.travel[leader])
        falling = Falling(leader, piece, travel, force, d, heaviest)
        decided, floor = floor_of(problem, rising, falling)
        if not decided:
            break
        rising.sums[risings.STORED] = rising.sums[risings.STORED + 1] = 0.0
        risings.stroke_at(problem, state, rising, force)
        before = risings.energy_in(problem, state, rising)
        before += stored(laws, leader, pieces.picked[piece], travel)
        landing = land_after(problem, state, rising, falling, floor, drive)
        if not landing.exists:
            break
        _name(rising, leader, travel)
        risings.stroke_at(problem, state, rising, landing.force)
        after = risings.energy_in(problem, state, rising)
        after += stored(laws, leader, pieces.picked[landing.piece], landing.travel)
        # Behind a spring Σ s goes up by β (λ - λ').
        spring = 0.5 * problem.beta * (force - landing.force) * (force + landing.force)
        soft_there = risings.softness_at(problem, state, rising) + problem.beta
        room = landing.missed / soft_there if landing.missed < np.inf else np.inf
        if room < st.TIE * problem.scale:
            st.set_tie(state.tie, leader, leader)
        state.near[0], state.near[1], state.near[2] = room, landing.missed, 0.0
        for q, level in ((end, d * landing.force), (end_back, -d * landing.force)):
            # One more snap would follow where λ comes to the end of the next branch.
            gap = max(risings.first_key(queues, q) - level, 0.0)
            st.set_near(state.near, gap, 1.0 / max(soft_there, 1e-300))
        state.force[0] = force = landing.force
        state.travel[leader], state.piece[leader] = landing.travel, landing.piece
        _end_segment(problem, state, rising, logged.SNAP, d, drive)
        log.segments[log.used[0] - 1, logged.RELEASED] = before - after + spring
        why = logged.FOLD
        st.set_snap(state.next_snap, -1, d, why)
        edge = pieces.among[leader, (d + 1) // 2]
        stop = pieces.right[edge] if d > 0 else pieces.left[edge]
        if landing.piece == edge and landing.travel == stop:
            risings.rest(problem, state, rising, leader)
            leader = -1
        elif pieces.sign[landing.piece] > 0:
            risings.rise(problem, state, rising, leader, landing.piece)
            leader = -1
    _stop_here(problem, state, rising, d, drive, status == st.DONE)
    due = leader >= 0 and state.next_snap[st.TRIGGER] == leader and why == logged.FOLD
    if status == st.GOES_ON and due:
        state.next_snap[st.DUE] = 1
    return status
