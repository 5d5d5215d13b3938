"""Snaps: from an equilibrium that is lost to the next one, at a fixed drive."""

import numpy as np

from stepwell.base import Floats
from stepwell.kernels import leaf
from stepwell.mechanism import HIGH, LOW, largest, law, smallest, stored, summed
from stepwell.statics.following import landing, state as st
from stepwell.statics.following.branch import inverse_slope
from stepwell.statics.following.flow import flow, unstable_direction
from stepwell.statics.following.landing import SnapLine, land, least_pull, note_next_snap, pull_at
from stepwell.statics.following.log import BY_FLOW, BY_LINE, DECIDED, ENDS, FOLD, SNAP
from stepwell.statics.following.pieces import find_piece, sheet_of, stand_all_on, stand_on
from stepwell.statics.following.state import Begin, DrivenChain, State

# Accuracies of a step of the flow, as fractions of the travel: of a path, and of samples.
FINE, COARSE = 2e-7, 1e-4


@leaf
def snap(problem: DrivenChain, state: State, direction: int, accuracy: float) -> int:
    """Compute a snap, and log its movers, its heat, and the distance to another landing."""
    # One function: a sequence of steps, each of which may end the snap.
    begun = st.begin(problem, state, direction)
    state.near[0], state.near[1], state.near[2] = np.inf, np.inf, 0.0
    before, trigger = begun.travel, state.next_snap[st.TRIGGER]
    spare, rubbed = problem.spare, problem.spare.number[st.RUB]
    rubbed[:] = 0.0
    outcome, close = landing.JUMPED, False
    ends = state.next_snap[st.DUE] and state.next_snap[st.WHY] == ENDS
    if not (ends and st.jump(problem, state, trigger)):
        outcome, close = along_line(problem, state, direction, rubbed)
    jumped = outcome == landing.JUMPED
    by_flow = jumped or outcome == landing.JOINED
    if by_flow:
        settled, closer = _by_flow(problem, state, begun.drive, rubbed, jumped, accuracy)
        if not settled:
            return st.NOT_SETTLED
        close = close or closer
    st.settle(problem, state)
    note_next_snap(problem, state)
    # A snap at a prescribed stroke that does not keep it is no answer.
    shift = 0.0
    for i in range(len(before)):
        shift += state.travel[i] - before[i]
    if problem.beta == 0.0 and abs(shift) > 1e-9 * summed(problem.laws.full):
        return st.NOT_SETTLED
    moved, released, friction_work = _moved_by(problem, state, begun, trigger)
    if moved < 0:
        return st.STALLED
    if problem.beta > 0.0:
        # The load falls, or the spring gives back β/2 (λ² - λ'²) with β (λ - λ') = α Σ Δs: this
        # way no large numbers are subtracted.
        released += 0.5 * (begun.force + state.force[0]) * shift
    # Friction takes at most the released energy, although the first step off a fold may exceed it.
    friction_work = min(friction_work, max(released, 0.0))
    if close and state.tie[0] < 0:
        st.set_tie(state.tie, trigger, trigger)
    movers, heat = st.some_movers(spare, moved, 0.0), (released - friction_work, friction_work)
    st.write(problem, state, SNAP, begun, movers, heat, begun.drive)
    state.log.segments[state.log.used[0] - 1, DECIDED] = BY_FLOW if by_flow else BY_LINE
    st.set_snap(state.next_snap, -1, direction, FOLD)
    state.next_snap[st.DUE] = 0
    return st.GOES_ON


@leaf
def _moved_by(
    problem: DrivenChain, state: State, begun: Begin, trigger: int
) -> tuple[int, float, float]:
    """List the movers of a snap: their number or -1; energy released and taken by friction."""
    laws, pieces, sheets, spare = problem.laws, problem.pieces, problem.sheets, problem.spare
    moved, any_changed, released, friction_work = 0, False, 0.0, 0.0
    for i in range(len(state.travel)):
        before, there = begun.travel[i], sheet_of(sheets, i)
        changed = state.travel[i] != before or there != begun.sheet[i]
        any_changed = any_changed or changed
        # A cell that yields and comes back has rubbed as well.
        friction_work += laws.friction[i] * spare.number[st.RUB, i]
        # The trigger belongs to the snap even where the flow brings it back to its stop.
        if not changed and i != trigger:
            continue
        spare.whole[st.MOVER, moved], spare.whole[st.ON_PIECE, moved] = i, -1
        spare.number[st.EXTRA, moved] = 0.0
        moved += 1
        stand_on(laws, sheets, pieces, i, begun.sheet[i])
        on = pieces.picked[find_piece(pieces, i, before, 0)]
        stand_on(laws, sheets, pieces, i, there)
        to = pieces.picked[find_piece(pieces, i, state.travel[i], 0)]
        released += stored(laws, i, on, before) - stored(laws, i, to, state.travel[i])
    return moved if any_changed else -1, released, friction_work


@leaf
def note_saddle(problem: DrivenChain, state: State, leader: int) -> None:
    """Equal cells that have reached a saddle together: only rounding decides which one leaves."""
    for i in range(len(state.mode)):
        if i != leader and state.mode[i] != st.HELD and problem.pieces.sign[state.piece[i]] < 0:
            st.set_tie(state.tie, leader, i)


# One kernel for speed: its steps share what each would get again as arguments.
@leaf
def along_line(
    problem: DrivenChain, state: State, direction: int, rubbed: Floats
) -> tuple[int, bool]:
    """Move one cell or pair to its landing; JOINED where more can move; whether by a tie."""
    # One function: the line changes as cells join, with all its values.
    laws, scale = problem.laws, problem.scale
    trigger, sense, partner, active = state.next_snap[st.TRIGGER], state.next_snap[st.SENSE], -1, 0
    mode = state.mode
    for i in range(len(mode)):
        if mode[i] != st.HELD:
            active += 1
            if i != trigger and (mode[i] == st.FREE or state.sense[i] == -sense):
                partner = i
    rigid, dead = problem.beta == 0.0, problem.alpha == 0.0
    if not (active == 2 and partner >= 0 if rigid else active == 1 or dead):
        return landing.JOINED, False
    other = partner if rigid else -1
    forth, back = (trigger, other) if sense > 0 else (other, trigger)
    low, high = st.held_range(problem, state)
    # One that ties with the trigger may have been due a little sooner.
    low, high = min(low, state.force[0]), max(high, state.force[0])
    if dead:
        # Under a dead load the cells do not interact.
        low, high = -np.inf, np.inf
    at_forth = state.travel[forth] if forth >= 0 else 0.0
    at_back = state.travel[back] if back >= 0 else 0.0
    softness, share, mobility = 0.0, 0.5, problem.mobility
    if rigid:
        share = mobility[back] / (mobility[back] + mobility[forth])
    else:
        softness = problem.alpha / problem.beta
    line = SnapLine(forth, back, at_forth, at_back, state.force[0], softness, share, low, high)
    size = laws.full[forth if forth >= 0 else back]
    begun, neutral = line, state.next_snap[st.WHY] != FOLD and _is_neutral(problem, line)
    if neutral:
        line = _driven_on(line, direction, 1e-10 * size)
    # The start is itself an equilibrium, at a fold a double one, and next to a double root
    # the sign of the pull is rounding noise: no landing is looked for this near to it.
    outcome, shift, level = land(problem, line, 1e-7, 0.0)
    # The same with a little more pull and a little less: if the landing then changes, the choice
    # depends on less than the precision of any real mechanism.
    start = 1e-7
    while outcome == landing.LANDED and shift <= 1e-3 * size and start < 1e-3:
        # This near to the start a landing may be rounding: it is real if the resistance past it is
        # larger than the precision of a mechanism.
        if pull_at(problem, line, 2.0 * shift) < -1e-12 * scale:
            break
        start = 4.0 * max(start, shift / size)
        outcome, shift, level = land(problem, line, start, 0.0)
    # On a line in balance everywhere, every place up to the landing is an equilibrium.
    tie = bool(neutral and abs(pull_at(problem, begun, 0.5 * shift)) <= st.TIE * scale)
    for bias in (1e-9 * scale, -1e-9 * scale):
        if shift > 2e-3 * size and not tie:
            other_outcome, other_shift, _ = land(problem, line, 1e-3, bias)
            tie = abs(other_shift - shift) > 1e-3 * size and other_outcome != landing.UNDECIDED
    if shift > start * size:
        st.set_near(state.near, *least_pull(problem, line, start * size, shift))
    if outcome == landing.UNDECIDED:
        outcome, shift, level = landing.JOINED, 0.0, line.force
    state.force[0], jumps = level, False
    for i, place, side in (
        (forth, line.from_forth + shift, HIGH),
        (back, line.from_back - shift, LOW),
    ):
        if i >= 0:
            end = problem.sheets.ends[i, side]
            near = (end - place if side == HIGH else place - end) <= 1e-15 * laws.full[i]
            state.travel[i], rubbed[i] = end if near else place, shift
            if outcome == landing.STOPPED and state.travel[i] == end:
                jumps = st.jump(problem, state, i) or jumps
    if jumps:
        return landing.JUMPED, tie
    if outcome == landing.STOPPED and rigid:
        # One of the two has stopped and no longer takes its part of the force: the other may now
        # push a third one off its place, and the snap continues.
        st.settle(problem, state)
        low, high = st.held_range(problem, state)
        slip = 1e-12 * scale
        if low > high + slip or not low - slip <= state.force[0] <= high + slip:
            outcome = landing.JOINED
    return outcome, tie


@leaf
def _is_neutral(problem: DrivenChain, line: SnapLine) -> bool:
    """Whether a whole line is in balance: then the drive, and not rounding, has to choose."""
    laws, pieces = problem.laws, problem.pieces
    total, size = line.softness, abs(line.softness)
    for cell, travel, heading in (
        (line.forth, line.from_forth, 1),
        (line.back, line.from_back, -1),
    ):
        if cell >= 0:
            picked = pieces.picked[find_piece(pieces, cell, travel, heading)]
            slope = law(laws, cell, picked, travel)[1]
            total += slope
            size += abs(slope)
    return bool(abs(total) <= 1e-9 * size)


@leaf
def _driven_on(line: SnapLine, direction: int, by: float) -> SnapLine:
    """The same line with the drive moved further by a small travel."""
    forth, back, at_forth, at_back, force, softness, share, low, high = line
    if forth >= 0 and (direction > 0 or back < 0):
        at_forth += direction * by
    else:
        at_back += direction * by
    return SnapLine(forth, back, at_forth, at_back, force, softness, share, low, high)


@leaf
def _by_flow(
    problem: DrivenChain, state: State, drive: float, rubbed: Floats, jumped: bool, accuracy: float
) -> tuple[bool, bool]:
    """Integrate the flow to rest, from after a jump or not; whether it settles, and by a tie."""
    laws, pieces, force = problem.laws, problem.pieces, state.force[0]
    travel, mode, spare, near = state.travel, state.mode, problem.spare, state.near
    start, worn = spare.number[st.START], spare.number[st.WORN]
    modes, sheets = spare.whole[st.MODES], spare.whole[st.SHEETS]
    for i in range(len(travel)):
        start[i], worn[i], modes[i] = travel[i], rubbed[i], mode[i]
        sheets[i] = sheet_of(problem.sheets, i)
    settled, level, tie = False, force, False
    on_its_way = jumped or worn[state.next_snap[st.TRIGGER]] != 0.0
    line = near[0], near[1]
    # The place next to a fold can be too narrow for the flow to get out of; then the way
    # out is begun further on, where the one unstable direction still holds.
    for share in (1e-4, 1e-3, 1e-2):
        for i in range(len(travel)):
            travel[i], rubbed[i], mode[i] = start[i], worn[i], modes[i]
        stand_all_on(laws, problem.sheets, pieces, sheets)
        near[0], near[1], near[2] = np.inf, np.inf, 0.0
        if not on_its_way:
            _leave(problem, state, share)
            for i in range(len(travel)):
                rubbed[i] += abs(travel[i] - start[i])
            # The way out bends away from its direction by the square of the first step.
            near[2] = share**2 * largest(laws.full)
        settled, level, tie = flow(problem, state, drive, force, accuracy, rubbed)
        if settled or on_its_way:
            break
    near[0], near[1] = min(near[0], line[0]), min(near[1], line[1])
    if not settled:
        return False, False
    state.force[0] = level
    ends, full = problem.sheets.ends, laws.full
    for i in range(len(travel)):
        for end in (LOW, HIGH):
            if abs(travel[i] - ends[i, end]) <= 1e-13 * full[i]:
                travel[i] = ends[i, end]
        # What Newton moved by rounding has not moved.
        if abs(travel[i] - start[i]) <= 1e-15 * full[i]:
            travel[i] = start[i]
    return True, tie


@leaf
def _leave(problem: DrivenChain, state: State, share: float) -> None:
    """Step off an unstable equilibrium along its one unstable direction."""
    laws, pieces, alpha, beta = problem.laws, problem.pieces, problem.alpha, problem.beta
    trigger, sense = state.next_snap[st.TRIGGER], state.next_snap[st.SENSE]
    spare, count = problem.spare, _leavers(problem, state, True)
    movers, slopes, weights = (
        spare.whole[st.MOVER],
        spare.number[st.SLOPES],
        spare.number[st.WEIGHTS],
    )
    # At a fixed stroke no cell moves alone: then those that land against friction join in.
    if not (count > 1 or (count == 1 and beta > 0.0)):
        count = _leavers(problem, state, False)
    mine, way = 0, spare.number[st.WAY, :count]
    for m in range(count):
        i = int(movers[m])
        weights[m], slopes[m] = problem.mobility[i], 0.0
        if pieces.sign[state.piece[i]] != 0:
            slopes[m] = 1.0 / inverse_slope(problem, i, state.piece[i], state.travel[i])
        mine = m if i == trigger else mine
    if count > 1:
        unstable_direction(slopes[:count], weights[:count], alpha, beta, mine, way)
    else:
        way[0] = 1.0
    if beta == 0.0 and count > 1:
        if abs(summed(way)) > 1e-6:
            # Two equal slopes have no direction of their own.
            for m in range(count):
                way[m] = 1.0 if m == mine else -1.0 / (count - 1)
        # The stroke stays constant, to rounding.
        way[mine] -= summed(way)
    step = share * smallest(laws.full) * (sense if way[mine] > 0.0 else -sense)
    step = _short_of_stops(problem, state, step, way)
    for m in range(count):
        state.travel[movers[m]] += step * way[m]


@leaf
def _leavers(problem: DrivenChain, state: State, needed: bool) -> int:
    pieces, movers, count = problem.pieces, problem.spare.whole[st.MOVER], 0
    for i in range(len(state.mode)):
        falls = state.mode[i] != st.HELD and pieces.sign[state.piece[i]] < 0
        slides = state.mode[i] != st.HELD and not needed
        if state.mode[i] == st.FREE or i == state.next_snap[st.TRIGGER] or falls or slides:
            movers[count] = i
            count += 1
    return count


@leaf
def _short_of_stops(problem: DrivenChain, state: State, step: float, way: Floats) -> float:
    """One step length for all cells, short of every stop, so that the stroke stays constant."""
    ends, movers = problem.sheets.ends, problem.spare.whole[st.MOVER]
    for m in range(len(way)):
        i = movers[m]
        up = step * way[m] > 0.0
        room = ends[i, HIGH] - state.travel[i] if up else state.travel[i] - ends[i, LOW]
        if abs(step * way[m]) > 0.5 * room:
            step *= 0.5 * room / abs(step * way[m])
    return step
