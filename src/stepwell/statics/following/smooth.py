"""Smooth motion: the cells that can move, and the distance to the next event."""

from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import leaf
from stepwell.mechanism import BEFORE, BEYOND, HIGH, LOW, law, summed
from stepwell.statics.following import state as st
from stepwell.statics.following.branch import compliance, first_fold, inverse_slope, point_at
from stepwell.statics.following.log import DRIFT, FOLD, HOLD, KINK, MOVE, RELEASE
from stepwell.statics.following.pieces import Pieces, find_piece, invert_near
from stepwell.statics.following.state import DrivenChain, Movers, State

# Kinds of smooth motion: λ moves with the drive, every moving κ > 0; λ moves against it, exactly
# one κ < 0 and α Σ 1/κ + β < 0; cells of constant force take all the motion; or nothing of the
# kind is stable, so the chain snaps.
WITH, AGAINST, FLAT, LOST = 1, -1, 0, 2
# Where two forces turn together both 1/κ are without bound and the sum of them is rounding. It is
# looked at this share of the largest force further on.
BLUNT = 1e-7
_NOTHING = 0


class BranchEnd(NamedTuple):
    """The first event on a branch."""

    why: int  # RELEASE, KINK (the end of a piece), FOLD or _NOTHING
    level: float  # λ there
    cell: int  # that is released, arrives or leads
    heading: int  # the sense in which it moves
    arrives: int  # which mover comes to the end of its piece
    within: float  # movers whose λ is this near to the end of their pieces come there too


# One kernel for speed: its steps share what each would get again as arguments.
@leaf
def choose(problem: DrivenChain, state: State, direction: int, goes: Ints) -> tuple[int, int]:
    """Kind of motion, with the moving cells marked in `goes`; and the falling cell or -1."""
    # One function: one pass over the cells with arrays that are taken out once.
    mode, sense, piece, signs = state.mode, state.sense, state.piece, problem.pieces.sign
    goes[:] = 0
    flat, falling, leader, blocked = 0, 0, -1, False
    for i in range(len(goes)):
        if mode[i] == st.HELD:
            continue
        sign = signs[piece[i]]
        follows = mode[i] == st.FREE or sense[i] == direction
        if sign == 0 and follows:
            flat += 1
            goes[i] = 1
        elif sign < 0 and follows:
            falling += 1
            leader = i
        elif sign <= 0:
            # Pushed off its place by a falling λ and unable to follow it.
            blocked = True
    if falling == 0 and flat > 0 and not blocked:
        return FLAT, -1
    goes[:] = 0
    if falling == 0 and not blocked:
        for i in range(len(goes)):
            if mode[i] != st.HELD and (mode[i] == st.FREE or sense[i] == direction):
                goes[i] = 1
        return WITH, -1
    if falling != 1 or flat > 0 or blocked:
        return LOST, leader
    total = problem.beta
    for i in range(len(goes)):
        rising = i != leader and mode[i] != st.HELD
        if i == leader or (rising and (mode[i] == st.FREE or sense[i] == -direction)):
            goes[i] = 1
            total += problem.alpha * inverse_slope(problem, i, piece[i], state.travel[i])
    movers = st.movers_of(problem, state, goes)
    if _turn_here(problem, state, movers.cell):
        level = state.force[0] - direction * BLUNT * problem.scale
        total = compliance(problem, movers, level, level)[1]
    if total < 0.0:
        return AGAINST, leader
    goes[:] = 0
    return LOST, leader


@leaf
def _turn_here(problem: DrivenChain, state: State, cells: Ints) -> bool:
    """Whether the leader and another moving cell stand where their forces turn."""
    laws, pieces = problem.laws, problem.pieces
    others, leads = 0, False
    for i in cells:
        piece, travel = state.piece[i], float(state.travel[i])
        if travel == pieces.left[piece] or travel == pieces.right[piece]:
            slope = law(laws, i, pieces.picked[piece], travel)[1]
            if abs(slope) * laws.full[i] < 1e-5 * problem.scale:
                leads = leads or bool(pieces.sign[piece] < 0)
                others += int(pieces.sign[piece] >= 0)
    return leads and others > 0


@leaf
def set_off(problem: DrivenChain, state: State, goes: Ints) -> Movers:
    """Start the cells marked in `goes`, and stop the other moving cells."""
    mode = state.mode
    for i in range(len(goes)):
        if mode[i] != st.HELD and mode[i] != st.FREE:
            if not goes[i]:
                st.hold(problem, state, i)
            elif problem.laws.friction[i] == 0.0:
                mode[i], state.sense[i] = st.FREE, 0
            else:
                mode[i] = st.SLIDES
    state.next_snap[st.TRIGGER] = -1
    return st.movers_of(problem, state, goes)


@leaf
def join_flat(problem: DrivenChain, state: State, direction: int) -> bool:
    """Bring in held and moving cells that come to the same constant force; whether any do."""
    pieces, mode, tie_force, joined = problem.pieces, state.mode, st.TIE * problem.scale, False
    for i in range(len(mode)):
        held = mode[i] == st.HELD
        if held and _until_release(problem, state, i, direction) > tie_force:
            continue
        piece = find_piece(pieces, i, state.travel[i], direction)
        if pieces.sign[piece] != 0 or (not held and piece == state.piece[i]):
            continue
        level = pieces.force_left[piece] + state.sense[i] * problem.laws.friction[i]
        if not held and abs(level - state.force[0]) > tie_force:
            continue
        state.piece[i], joined = piece, True
        if held:
            mode[i], state.sense[i] = st.LETS_GO, direction
    return joined


@leaf
def share(problem: DrivenChain, state: State, goes: Ints) -> None:
    """Give the motion to the cells of equal constant force with the lowest rank; note a tie."""
    rank, one, two, first = problem.rank, -1, -1, len(goes)
    for i in range(len(goes)):
        if goes[i]:
            if one >= 0 and two < 0:
                two = i
            one, first = i if one < 0 else one, min(first, rank[i])
    if two < 0:
        return
    # Their mobility alone decides their fractions of the motion.
    st.set_tie(state.tie, one, two)
    for i in range(len(goes)):
        if rank[i] > first:
            goes[i] = 0


@leaf
def _end_of(pieces: Pieces, piece: int, toward: int) -> float:
    return float(pieces.right[piece] if toward > 0 else pieces.left[piece])


@leaf
def drift(problem: DrivenChain, state: State, movers: Movers, direction: int, target: float) -> int:
    """Cells of constant force take the motion, by mobility, until one of them leaves its piece."""
    laws, pieces, alpha = problem.laws, problem.pieces, problem.alpha
    mobility, count = problem.mobility, len(movers.cell)
    begun = st.begin(problem, state, direction)
    # What a cell of mobility 1 goes until the first one arrives.
    room, total = np.inf, 0.0
    for m in range(count):
        i, end = movers.cell[m], _end_of(pieces, movers.piece[m], direction)
        room = min(room, abs(end - float(begun.travel[i])) / float(mobility[i]))
        total += float(mobility[i])
    # A target within rounding of the end of the piece is that end.
    span = alpha * (total * room - 1e-13 * summed(laws.full))
    reached = alpha > 0.0 and direction * (target - begun.drive) < span
    if reached:
        room = direction * (target - begun.drive) / (alpha * total)
    friction_work = 0.0
    for m in range(count):
        i, end = movers.cell[m], _end_of(pieces, movers.piece[m], direction)
        way = room * float(mobility[i])
        arrives = not reached and abs(end - begun.travel[i]) - way <= 1e-15 * laws.full[i]
        state.travel[i] = end if arrives else begun.travel[i] + direction * way
        friction_work += float(laws.friction[i]) * way
    drive = st.drive_of(problem, state.travel, begun.force)
    st.write(problem, state, DRIFT, begun, movers, (0.0, friction_work), drive)
    for m in range(count):
        i = movers.cell[m]
        if not reached and state.travel[i] == _end_of(pieces, movers.piece[m], direction):
            st.set_snap(state.next_snap, i, direction, KINK)
            st.end_piece(problem, state, i, direction)
    return st.DONE if reached else st.GOES_ON


@leaf
def _until_release(problem: DrivenChain, state: State, i: int, toward: int) -> float:
    """Distance of λ to the release of held cell i; inf where it is never released."""
    travel, ends = state.travel[i], problem.sheets.ends
    free = travel < ends[i, BEYOND] if toward > 0 else travel > ends[i, BEFORE]
    distance = toward * (state.at_rest[i] - state.force[0]) + problem.laws.friction[i]
    return max(0.0, distance) if free else np.inf


@leaf
def _first_release(problem: DrivenChain, state: State, toward: int) -> tuple[float, int]:
    """Distance of λ to the first release and the cell; a tie is settled by rank and noted."""
    pieces, rank, mode = problem.pieces, problem.rank, state.mode
    first, rival, falls, closest, nearest = -1, -1, False, np.inf, np.inf
    for i in range(len(rank)):
        if mode[i] == st.HELD:
            nearest = min(nearest, _until_release(problem, state, i, toward))
    if nearest == np.inf:
        return nearest, first
    tie_force = st.TIE * problem.scale
    for i in range(len(rank)):
        distance = np.inf
        if mode[i] == st.HELD:
            distance = _until_release(problem, state, i, toward)
        if distance > nearest + tie_force:
            continue
        piece = find_piece(pieces, i, state.travel[i], toward)
        falls = falls or pieces.sign[piece] < 0
        # A cell released out of order would be called back by the next one in order.
        sooner = distance < closest - 1e-3 * tie_force
        same = first >= 0 and rank[i] == rank[first]
        if first < 0 or rank[i] < rank[first] or (same and sooner):
            first, rival, closest = i, first, distance
        else:
            rival = i
    if rival >= 0 and falls:
        # Cells of rising force would share the motion; of these, only one can have it.
        st.set_tie(state.tie, first, rival)
    return nearest, first


@leaf
def _until_end(pieces: Pieces, movers: Movers, m: int, force: float, toward: int) -> float:
    """Distance of λ in the sense `toward` to the end of the piece of mover m."""
    piece = movers.piece[m]
    outwards = toward * pieces.sign[piece] > 0
    end = pieces.force_right[piece] if outwards else pieces.force_left[piece]
    return max(0.0, toward * (end + movers.offset[m] - force))


@leaf
def _turns_over(ends: Floats, pieces: Pieces, cell: int, piece: int, heading: int) -> int:
    """Sign of a cell's κ past the end of its piece; 2 where that is the end of its sheet."""
    stop = ends[cell, HIGH] if heading > 0 else ends[cell, LOW]
    return 2 if _end_of(pieces, piece, heading) == stop else pieces.sign[piece + heading]


@leaf
def _first_to_arrive(
    problem: DrivenChain, state: State, movers: Movers, toward: int, direction: int
) -> tuple[float, int, bool]:
    """Distance of λ to the first end of a piece, the mover that comes there, if in company."""
    # Cells that come to their tops together tie: only one can go on. A leader and one that gives
    # way can reach their bottoms together, if alike: there both forces rise with the drive.
    # One function: both senses compare movers with the first that arrives.
    pieces, rank, force, ends = problem.pieces, problem.rank, state.force[0], problem.sheets.ends
    scale, cell, on = problem.scale, movers.cell, movers.piece
    arrival, who, rival, first, leads = np.inf, -1, -1, -1, -1
    for m in range(len(cell)):
        distance = _until_end(pieces, movers, m, force, toward)
        if distance < arrival:
            arrival, who = distance, m
    if who < 0:
        return arrival, who, False
    if toward == direction:
        for m in range(len(cell)):
            late = _until_end(pieces, movers, m, force, toward) > arrival + st.TIE * scale
            if late or _turns_over(ends, pieces, cell[m], on[m], direction) != -1:
                continue
            if first < 0 or rank[cell[m]] < rank[cell[first]]:
                first, rival = m, first
            else:
                rival = m
        if rival >= 0:
            st.set_tie(state.tie, cell[first], cell[rival])
            return _until_end(pieces, movers, first, force, toward), first, True
        return arrival, who, False
    for m in range(len(cell)):
        if _until_end(pieces, movers, m, force, toward) <= arrival + 1e-13 * scale:
            if pieces.sign[on[m]] < 0:
                leads = m
            else:
                rival = m
    if leads < 0 or rival < 0 or _turns_over(ends, pieces, cell[leads], on[leads], direction) != 1:
        return arrival, who, False
    st.set_tie(state.tie, cell[leads], cell[rival])
    return arrival, leads, True


@leaf
def _first_event(
    problem: DrivenChain, state: State, movers: Movers, toward: int, direction: int
) -> BranchEnd:
    """The release of a held cell or the end of a mover's piece, whichever λ meets first."""
    pieces, force, tie_force = problem.pieces, state.force[0], st.TIE * problem.scale
    arrival, who, company = _first_to_arrive(problem, state, movers, toward, direction)
    release, cell = _first_release(problem, state, toward)
    if release < arrival - tie_force:
        return BranchEnd(RELEASE, force + toward * release, cell, toward, -1, -1.0)
    if who < 0:
        return BranchEnd(_NOTHING, force, -1, toward, -1, -1.0)
    arrives, on = movers.cell[who], movers.piece[who]
    heading = toward * int(pieces.sign[on])
    if release <= arrival + tie_force:
        # A force that turns at the release of another cell: both orders are possible. Against the
        # drive an arrival at a stop is one too: a snap of zero size or none.
        past = _turns_over(problem.sheets.ends, pieces, arrives, on, heading)
        if past == -1 if toward == direction else past != pieces.sign[on]:
            st.set_tie(state.tie, arrives, cell)
    end = pieces.force_right[on] if heading > 0 else pieces.force_left[on]
    level = end + movers.offset[who] if arrival > 0.0 else force
    return BranchEnd(KINK, level, arrives, heading, who, arrival if company else -1.0)


@leaf
def _or_fold(
    problem: DrivenChain, state: State, movers: Movers, event: BranchEnd, toward: int
) -> BranchEnd:
    blunt = toward * BLUNT * problem.scale
    begins, ends = state.force[0], event.level
    if _turn_here(problem, state, movers.cell):
        begins += blunt
    if event.within >= 0.0:
        ends -= blunt
    if toward * (ends - begins) > 0.0:
        fold = first_fold(problem, movers, begins, ends)
        if not np.isnan(fold) and abs(fold - event.level) > 1e-12 * problem.scale:
            return BranchEnd(FOLD, fold, _leader(problem.pieces, movers), -toward, -1, -1.0)
    return event


@leaf
def _places_at(
    problem: DrivenChain, state: State, movers: Movers, event: BranchEnd, toward: int, out: Floats
) -> None:
    """Travels of the movers at an event, into `out`; those that come to an end are there."""
    laws, pieces, force = problem.laws, problem.pieces, state.force[0]
    for m in range(len(out)):
        i, on = movers.cell[m], movers.piece[m]
        out[m] = state.travel[i]
        if event.level != force:
            out[m] = invert_near(laws, pieces, i, on, event.level - movers.offset[m], out[m])
    if event.why != KINK:
        return
    for m in range(len(out)):
        on = movers.piece[m]
        there = _end_of(pieces, on, toward * int(pieces.sign[on]))
        # Alike cells arrive together, but for rounding.
        alike = abs(out[m] - there) <= 1e-15 * laws.full[movers.cell[m]]
        near = _until_end(pieces, movers, m, force, toward) <= event.within
        if m == event.arrives or alike or near:
            out[m] = there


@leaf
def _leader(pieces: Pieces, movers: Movers) -> int:
    """The cell of falling force among the movers, or -1."""
    for m in range(len(movers.cell)):
        if pieces.sign[movers.piece[m]] < 0:
            return movers.cell[m]
    return -1


@leaf
def move(problem: DrivenChain, state: State, movers: Movers, direction: int, target: float) -> int:
    """Follow one branch to its first event or to the target."""
    # One function: drive, level and places of a step decide what is done after it.
    laws, pieces, alpha, beta = problem.laws, problem.pieces, problem.alpha, problem.beta
    toward = direction if _leader(pieces, movers) < 0 else -direction
    begun = st.begin(problem, state, direction)
    event = _first_event(problem, state, movers, toward, direction)
    if event.why == _NOTHING:
        if beta == 0.0:
            return st.RUNS_AWAY
        # Nothing is left to happen: the drive only changes the force.
        state.force[0] = (target - alpha * summed(begun.travel)) / beta
        st.write(problem, state, HOLD, begun, movers, (0.0, 0.0), target)
        return st.DONE
    count = len(movers.cell)
    if toward != direction and (count > 1 or (beta > 0.0 and alpha > 0.0)):
        event = _or_fold(problem, state, movers, event, toward)
    level = event.level
    places = problem.spare.number[st.PLACE, :count]
    _places_at(problem, state, movers, event, toward, places)
    drive = alpha * (movers.held + summed(places)) + beta * level
    reached = direction * (drive - target) > st.drive_slack(problem)
    if reached:
        drive = target
        if count == 1 and beta == 0.0:
            places[0] = target - movers.held
            picked = pieces.picked[movers.piece[0]]
            level = law(laws, movers.cell[0], picked, places[0])[0] + movers.offset[0]
        else:
            level = point_at(problem, movers, begun.force, level, target, places, False)
    friction_work = 0.0
    moves = level != begun.force or drive != begun.drive
    for m in range(count):
        i = movers.cell[m]
        moves = moves or places[m] != begun.travel[i]
        friction_work += laws.friction[i] * abs(places[m] - begun.travel[i])
        state.travel[i] = places[m]
    state.force[0] = level
    if moves:
        kind = MOVE if count > 0 else HOLD
        st.write(problem, state, kind, begun, movers, (0.0, friction_work), drive)
    if reached:
        return st.DONE
    cell, heading = event.cell, event.heading
    if event.why == FOLD:
        st.set_snap(state.next_snap, cell, heading, FOLD)
        state.next_snap[st.DUE] = 1
    elif event.why == RELEASE:
        state.mode[cell], state.sense[cell] = st.LETS_GO, heading
        state.piece[cell] = find_piece(pieces, cell, state.travel[cell], heading)
        st.set_snap(state.next_snap, cell, heading, RELEASE)
    else:
        st.set_snap(state.next_snap, cell, heading, KINK)
        st.end_piece(problem, state, cell, heading)
        if state.mode[cell] == st.HELD:
            state.next_snap[st.TRIGGER], state.next_snap[st.WHY] = -1, FOLD
    return st.GOES_ON
