"""Following the local minimum through a list of turning points, event by event.

Between events the set of moving cells is fixed and every event but the fold is a comparison of
two forces, so nothing here depends on a step size.
"""

from typing import NamedTuple

import numpy as np

from stepwell.kernels import LEGS, SPENT, entry, kernel, overspent
from stepwell.mechanism import Floats, Ints, Laws, law, stored, summed
from stepwell.statics.following.branch import (
    compliance,
    drive_of,
    first_fold,
    inverse_slope,
    point_at,
)
from stepwell.statics.following.flow import flow, unstable_direction
from stepwell.statics.following.landing import JOINED, STOPPED, UNDECIDED, slide
from stepwell.statics.following.pieces import Pieces, find_piece, invert

# What happens on a segment of the log.
HOLD, MOVE, DRIFT, SNAP = 0, 1, 2, 3
# What a cell does: rests against a stop or friction; follows λ both ways; slides one way against
# friction; has just reached the force at which it lets go.
HELD, FREE, SLIDES, LETS_GO = 0, 1, 2, 3
# Why a snap happened.
FOLD, RELEASE, KINK = 1, 2, 3
# How a run ended, or a part of it.
DONE, LOG_FULL, STALLED, NOT_SETTLED, RUNS_AWAY, GOES_ON, GAVE_UP = 0, 1, 2, 3, 4, 5, 6
# What the follower knows beside the state: what would set off a snap, and which cells tie.
TRIGGER, SENSE, WHY, MUST_SNAP, NOTE_A, NOTE_B = range(6)

SEGMENT_COLUMNS = 11
KIND, DIRECTION, DRIVE_0, DRIVE_1, FORCE_0, FORCE_1 = range(6)
RELEASED, RUBBED, CAUSE, TIE_A, TIE_B = range(6, SEGMENT_COLUMNS)
MOVER_COLUMNS = 5
CELL, PIECE, OFFSET, TRAVEL_0, TRAVEL_1 = range(MOVER_COLUMNS)


class Log(NamedTuple):
    """Segments (one row each) and, per segment, the cells that moved in it."""

    segments: Floats  # (K, SEGMENT_COLUMNS)
    first: Ints  # (K + 1,) movers of segment k are first[k] .. first[k + 1]
    movers: Floats  # (M, MOVER_COLUMNS)
    used: Ints  # (2,) segments and movers written


# Where two forces turn together both 1/κ are without bound and the sum of them is rounding. It is
# looked at this share of the largest force further on.
BLUNT = 1e-7


class State(NamedTuple):
    """Where the chain is."""

    travel: Floats  # (N,)
    mode: Ints  # (N,)
    way: Ints  # (N,) sense in which a cell slides or lets go
    piece: Ints  # (N,)
    at_rest: Floats  # (N,) force of a held cell
    force: Floats  # (1,) λ


@kernel
def _energy(laws: Laws, pieces: Pieces, cell: int, travel: float) -> float:
    return stored(laws, cell, pieces.picked[find_piece(pieces, cell, travel, 0)], travel)


@kernel
def _write(
    log: Log,
    kind: int,
    direction: int,
    before: Floats,
    state: State,
    moved: Ints,
    on: Ints,
    offset: Floats,
    drive_0: float,
    drive_1: float,
    force_0: float,
    released: float,
    rubbed: float,
    note: Ints,
) -> int:
    """Append one segment, and forget the tie that it tells of."""
    k, m = log.used
    if k >= len(log.segments) or m + len(moved) > len(log.movers):
        return LOG_FULL
    row = log.segments[k]
    row[KIND], row[DIRECTION] = kind, direction
    row[DRIVE_0], row[DRIVE_1] = drive_0, drive_1
    row[FORCE_0], row[FORCE_1] = force_0, state.force[0]
    row[RELEASED], row[RUBBED] = released, rubbed
    row[CAUSE] = note[WHY] if kind == SNAP else 0
    row[TIE_A], row[TIE_B] = note[NOTE_A], note[NOTE_B]
    note[NOTE_A], note[NOTE_B] = -1, -1
    for j in range(len(moved)):
        i = moved[j]
        mover = log.movers[m + j]
        mover[CELL], mover[PIECE], mover[OFFSET] = i, on[j], offset[j]
        mover[TRAVEL_0], mover[TRAVEL_1] = before[i], state.travel[i]
    log.used[0] = k + 1
    log.used[1] = m + len(moved)
    log.first[k + 1] = m + len(moved)
    return GOES_ON


@kernel
def _hold(laws: Laws, pieces: Pieces, state: State, i: int) -> None:
    """Let cell i rest where it is."""
    state.mode[i], state.way[i] = HELD, 0
    piece = find_piece(pieces, i, state.travel[i], 0)
    if state.travel[i] == pieces.left[piece]:
        state.at_rest[i] = pieces.force_left[piece]
    elif state.travel[i] == pieces.right[piece]:
        state.at_rest[i] = pieces.force_right[piece]
    else:
        state.at_rest[i] = law(laws, i, pieces.picked[piece], state.travel[i])[0]


@kernel
def _choose(
    laws: Laws,
    pieces: Pieces,
    state: State,
    direction: int,
    alpha: float,
    beta: float,
    scale: float,
    goes: Ints,
) -> tuple[int, int]:
    """How the chain can go on, and the falling cell that leads it if there is one.

    +1: λ moves with the drive, every moving κ > 0. -1: λ moves against it, exactly one κ < 0 and
    α Σ 1/κ + β < 0. 0: a cell of constant force takes all the motion. 2: nothing of the kind is
    stable, so the chain snaps. `goes` marks the cells that move.
    """
    goes[:] = 0
    flat, falling, leader, blocked = 0, 0, -1, False
    for i in range(len(state.mode)):
        if state.mode[i] == HELD:
            continue
        sign = pieces.sign[state.piece[i]]
        free = state.mode[i] == FREE
        along = state.way[i] == direction
        if sign == 0 and (free or along):
            flat += 1
            goes[i] = 1
        elif sign < 0 and (free or along):
            falling += 1
            leader = i
        elif sign <= 0:
            # Pushed off its place by a falling λ and unable to follow it.
            blocked = True
    if falling == 0 and flat > 0 and not blocked:
        return 0, -1
    goes[:] = 0
    if falling == 0 and not blocked:
        for i in range(len(state.mode)):
            if state.mode[i] == FREE or (state.mode[i] != HELD and state.way[i] == direction):
                goes[i] = 1
        return 1, -1
    if falling != 1 or flat > 0 or blocked:
        return 2, leader
    total = beta
    for i in range(len(state.mode)):
        rising = i != leader and state.mode[i] != HELD
        if i == leader or (rising and (state.mode[i] == FREE or state.way[i] == -direction)):
            goes[i] = 1
            total += alpha * inverse_slope(laws, pieces, i, state.piece[i], state.travel[i])
    moved = np.flatnonzero(goes)
    if _turn_here(laws, pieces, state, moved, leader, scale):
        offset = state.way[moved] * laws.friction[moved]
        level = state.force[0] - direction * BLUNT * scale
        total = compliance(laws, pieces, moved, state.piece[moved], offset, alpha, beta, level)
    if total < 0.0:
        return -1, leader
    goes[:] = 0
    return 2, leader


@kernel
def _turn_here(
    laws: Laws, pieces: Pieces, state: State, moved: Ints, leader: int, scale: float
) -> bool:
    """Whether the leader and another moving cell stand where their forces turn."""
    others, leads = 0, False
    for m in range(len(moved)):
        i = int(moved[m])
        piece, travel = state.piece[i], state.travel[i]
        if travel == pieces.left[piece] or travel == pieces.right[piece]:
            slope = law(laws, i, pieces.picked[piece], travel)[1]
            if abs(slope) * laws.full[i] < 1e-5 * scale:
                leads = leads or i == leader
                others += i != leader
    return leads and others > 0


@kernel
def _settle(laws: Laws, pieces: Pieces, state: State, alpha: float, beta: float) -> None:
    """Read modes and λ off a resting configuration, after a snap."""
    free, total = 0, 0.0
    for i in range(len(state.mode)):
        inside = 0.0 < state.travel[i] < laws.full[i]
        if inside and laws.friction[i] == 0.0:
            state.mode[i], state.way[i] = FREE, 0
            piece = find_piece(pieces, i, state.travel[i], 0)
            state.piece[i] = piece
            total += law(laws, i, pieces.picked[piece], state.travel[i])[0]
            free += 1
        else:
            _hold(laws, pieces, state, i)
    if alpha > 0.0 and free > 0:
        # Behind a stiff spring λ = K (U - Σ s) is rounding: the cells tell it better.
        state.force[0] = total / free
    elif beta == 0.0:
        low, high = held_range(laws, state)
        state.force[0] = min(max(state.force[0], low), high)


@kernel
def held_range(laws: Laws, state: State) -> tuple[float, float]:
    """The forces λ at which every held cell stays."""
    low, high = -np.inf, np.inf
    for i in range(len(state.mode)):
        if state.mode[i] == HELD:
            if state.travel[i] > 0.0:
                low = max(low, state.at_rest[i] - laws.friction[i])
            if state.travel[i] < laws.full[i]:
                high = min(high, state.at_rest[i] + laws.friction[i])
    return low, high


@kernel
def _snap(
    laws: Laws,
    pieces: Pieces,
    state: State,
    trigger: int,
    sense: int,
    drive: float,
    alpha: float,
    beta: float,
    scale: float,
    rubbed: Floats,
    effort: Ints,
) -> tuple[int, bool]:
    """Move the chain from a lost equilibrium to the next one; how it went, and whether by a tie."""
    n = len(state.mode)
    force = state.force[0]
    rubbed[:] = 0.0
    active = 0
    partner = -1
    for i in range(n):
        if state.mode[i] != HELD:
            active += 1
            if i != trigger and (state.mode[i] == FREE or state.way[i] == -sense):
                partner = i
    low, high = held_range(laws, state)
    outcome, tie = JOINED, False
    paired = beta == 0.0 and active == 2 and partner >= 0
    if paired or (beta > 0.0 and (active == 1 or alpha == 0.0)):
        other = partner if beta == 0.0 else -1
        forth, back = (trigger, other) if sense > 0 else (other, trigger)
        if alpha == 0.0:
            # Under a dead load no cell feels the others.
            low, high = -np.inf, np.inf
        at_forth = state.travel[forth] if forth >= 0 else 0.0
        at_back = state.travel[back] if back >= 0 else 0.0
        softness = alpha / beta if beta > 0.0 else 0.0
        # The start is itself an equilibrium, at a fold a double one, and next to a double root
        # the sign of the pull is rounding noise: no landing is looked for this near to it.
        outcome, shift, level = slide(
            laws, pieces, forth, back, at_forth, at_back, force, softness, low, high,
            1e-12 * scale, 1e-7, 0.0, effort,
        )  # fmt: skip
        # The same with a little more pull and a little less: where it then lands elsewhere, the
        # choice between two landings hangs on less than any real mechanism can promise.
        size = laws.full[forth] if forth >= 0 else laws.full[back]
        for bias in (1e-9 * scale, -1e-9 * scale):
            if shift > 2e-3 * size and not tie:
                other_outcome, other_shift, _ = slide(
                    laws, pieces, forth, back, at_forth, at_back, force, softness, low, high,
                    1e-12 * scale, 1e-3, bias, effort,
                )  # fmt: skip
                tie = abs(other_shift - shift) > 1e-3 * size and other_outcome != UNDECIDED
        if outcome == UNDECIDED:
            outcome, shift, level = JOINED, 0.0, force
        if forth >= 0:
            state.travel[forth] += shift
            if laws.full[forth] - state.travel[forth] <= 1e-15 * laws.full[forth]:
                state.travel[forth] = laws.full[forth]
            rubbed[forth] = shift
        if back >= 0:
            state.travel[back] -= shift
            if state.travel[back] <= 1e-15 * laws.full[back]:
                state.travel[back] = 0.0
            rubbed[back] = shift
        state.force[0] = level
        if outcome == STOPPED and beta == 0.0:
            # One of the two has stopped and no longer takes its part of the force: the other
            # may now push a third one off its place, and the snap goes on.
            _settle(laws, pieces, state, alpha, beta)
            low, high = held_range(laws, state)
            slip = 1e-12 * scale
            if low > high + slip or not low - slip <= state.force[0] <= high + slip:
                outcome = JOINED
    if outcome == JOINED:
        start, worn = state.travel.copy(), rubbed.copy()
        settled, level, again = False, force, start
        # The place next to a fold can be too narrow for the flow to get out of; then the way
        # out is begun further on, where the one unstable direction still holds.
        for share in (1e-4, 1e-3, 1e-2):
            state.travel[:] = start
            rubbed[:] = worn
            if worn[trigger] == 0.0:
                _leave(laws, pieces, state, trigger, sense, alpha, beta, share)
                rubbed += np.abs(state.travel - start)
            again = state.travel.copy()
            settled, level = flow(
                laws, state.travel, drive, alpha, beta, state.force[0], scale, 1e-6, rubbed, effort
            )
            if settled or worn[trigger] != 0.0:
                break
        if not settled:
            return NOT_SETTLED, False
        # The same flow, seen through a coarser glass: where it lands elsewhere, the choice
        # between two landings hangs on less than any real mechanism can promise.
        settled, _ = flow(
            laws, again, drive, alpha, beta, state.force[0], scale, 1e-4, worn, effort
        )
        state.force[0] = level
        tie = tie or not settled
        tie = tie or _elsewhere(laws, pieces, state.travel, again, beta, level, scale)
        for i in range(n):
            if abs(state.travel[i]) <= 1e-13 * laws.full[i]:
                state.travel[i] = 0.0
            elif abs(state.travel[i] - laws.full[i]) <= 1e-13 * laws.full[i]:
                state.travel[i] = laws.full[i]
    _settle(laws, pieces, state, alpha, beta)
    return DONE, tie


@kernel
def _elsewhere(
    laws: Laws, pieces: Pieces, here: Floats, there: Floats, beta: float, level: float, scale: float
) -> bool:
    """Whether two computed landings are two, and not one that is known less well.

    Without friction places of rest stand apart. Friction makes a continuum of them, on which the
    place depends smoothly on the way there: two places are one if the chain can rest anywhere
    between them and they are no further apart than the coarser way may be off.
    """
    n = len(here)
    apart = 0.0
    for i in range(n):
        apart = max(apart, abs(there[i] - here[i]) / laws.full[i])
    if apart <= 1e-4:
        return False
    if apart > 1e-2 or np.max(laws.friction) == 0.0:
        return True
    for step in range(1, 9):
        low, high = -np.inf, np.inf
        for i in range(n):
            travel = here[i] + step / 8.0 * (there[i] - here[i])
            value = law(laws, i, pieces.picked[find_piece(pieces, i, travel, 0)], travel)[0]
            # A cell that slid all the way rests where its force and friction meet λ: between two
            # such places it is off by the bend of its force.
            slip = laws.friction[i] + 1e-4 * scale
            if travel > 0.0:
                low = max(low, value - slip)
            if travel < laws.full[i]:
                high = min(high, value + slip)
        if low > high or (beta > 0.0 and not low <= level <= high):
            return True
    return False


@kernel
def _leave(
    laws: Laws,
    pieces: Pieces,
    state: State,
    trigger: int,
    sense: int,
    alpha: float,
    beta: float,
    share: float,
) -> None:
    """Step off an unstable equilibrium along its one unstable direction."""
    n = len(state.mode)
    movers = np.empty(n, np.int64)
    count = 0
    for needed in (True, False):
        # At a fixed stroke no cell moves alone: then those that slide against friction join in.
        if count > 1 or (count == 1 and beta > 0.0):
            break
        count = 0
        for i in range(n):
            falls = state.mode[i] != HELD and pieces.sign[state.piece[i]] < 0
            slides = state.mode[i] != HELD and not needed
            if state.mode[i] == FREE or i == trigger or falls or slides:
                movers[count] = i
                count += 1
    slopes = np.empty(count)
    mine = 0
    for m in range(count):
        i = int(movers[m])
        if pieces.sign[state.piece[i]] == 0:
            slopes[m] = 0.0
        else:
            slopes[m] = 1.0 / inverse_slope(laws, pieces, i, state.piece[i], state.travel[i])
        if i == trigger:
            mine = m
    if count > 1:
        way = unstable_direction(slopes, alpha, beta)
    else:
        way = np.ones(1)
    if beta == 0.0 and count > 1:
        if abs(summed(way)) > 1e-6:
            # Two slopes alike to the last digit have no direction of their own.
            way[:] = -1.0 / (count - 1)
            way[mine] = 1.0
        # The stroke stays what it is, to rounding.
        way[mine] -= summed(way)
    step = share * np.min(laws.full) * (sense if way[mine] > 0.0 else -sense)
    # One length for all cells, short of every stop, or the stroke would not stay what it is.
    for m in range(count):
        i = int(movers[m])
        room = laws.full[i] - state.travel[i] if step * way[m] > 0.0 else state.travel[i]
        if abs(step * way[m]) > 0.5 * room:
            step *= 0.5 * room / abs(step * way[m])
    for m in range(count):
        state.travel[movers[m]] += step * way[m]


@kernel
def _pass_end(laws: Laws, pieces: Pieces, state: State, cell: int, heading: int) -> None:
    """A cell has reached the end of its piece: it rests at a stop, or goes on to the next."""
    stop = laws.full[cell] if heading > 0 else 0.0
    if state.travel[cell] == stop:
        _hold(laws, pieces, state, cell)
        return
    state.piece[cell] += heading
    if state.mode[cell] == SLIDES:
        state.mode[cell] = LETS_GO


@kernel
def _note_saddle(pieces: Pieces, state: State, leader: int, note: Ints) -> None:
    """Alike cells that have crept into a saddle together: only rounding tells which leaves it."""
    for i in range(len(state.mode)):
        if i != leader and state.mode[i] != HELD and pieces.sign[state.piece[i]] < 0:
            note[NOTE_A], note[NOTE_B] = leader, i


@kernel
def _take_snap(
    laws: Laws,
    pieces: Pieces,
    state: State,
    direction: int,
    alpha: float,
    beta: float,
    scale: float,
    note: Ints,
    log: Log,
    effort: Ints,
) -> int:
    """Snap, and write down what moved and what was released."""
    n = len(state.mode)
    before = state.travel.copy()
    force = state.force[0]
    drive = drive_of(before, force, alpha, beta)
    rubbed = np.zeros(n)
    status, close = _snap(
        laws, pieces, state, note[TRIGGER], note[SENSE], drive, alpha, beta, scale, rubbed, effort
    )
    if status != DONE:
        return status
    # A snap at a prescribed stroke that does not keep it is no answer.
    lost = beta == 0.0 and abs(summed(state.travel - before)) > 1e-9 * summed(laws.full)
    if lost:
        return NOT_SETTLED
    changed = state.travel != before
    if not np.any(changed):
        return STALLED
    # The cell that let go belongs to the snap even where the flow brings it back to its stop.
    changed[note[TRIGGER]] = True
    moved = np.flatnonzero(changed)
    released = 0.0
    for m in range(len(moved)):
        i = int(moved[m])
        released += _energy(laws, pieces, i, before[i]) - _energy(laws, pieces, i, state.travel[i])
    # A cell that yields and comes back has rubbed as well.
    friction_work = float(summed(laws.friction * rubbed))
    if beta > 0.0:
        # The load falls, or the spring gives back β/2 (λ² - λ'²) with β (λ - λ') = α Σ Δs: this
        # way no large numbers are subtracted.
        released += 0.5 * (force + state.force[0]) * summed(state.travel - before)
    # Friction takes no more than there is, though the first step off a fold may say so.
    friction_work = min(friction_work, max(released, 0.0))
    if close and note[NOTE_A] < 0:
        note[NOTE_A] = note[NOTE_B] = note[TRIGGER]
    nowhere = np.full(len(moved), -1, np.int64)
    status = _write(
        log, SNAP, direction, before, state, moved, nowhere, np.zeros(len(moved)),
        drive, drive, force, released - friction_work, friction_work, note,
    )  # fmt: skip
    note[TRIGGER], note[SENSE], note[WHY], note[MUST_SNAP] = -1, direction, FOLD, 0
    return status


@kernel
def _join_flat(laws: Laws, pieces: Pieces, state: State, direction: int, tie_force: float) -> bool:
    """Bring in the cells that offer the same constant force; whether there are any.

    They are held ones that let go at it, and moving ones that have just reached it.
    """
    any_joined = False
    for i in range(len(state.mode)):
        held = state.mode[i] == HELD
        if held and _until_letting_go(laws, state, i, direction, state.force[0]) > tie_force:
            continue
        piece = find_piece(pieces, i, state.travel[i], direction)
        if pieces.sign[piece] != 0 or (not held and piece == state.piece[i]):
            continue
        offset = state.way[i] * laws.friction[i]
        if not held and abs(pieces.force_left[piece] + offset - state.force[0]) > tie_force:
            continue
        state.piece[i] = piece
        if held:
            state.mode[i], state.way[i] = LETS_GO, direction
        any_joined = True
    return any_joined


@kernel
def _share(goes: Ints, rank: Ints, note: Ints) -> None:
    """Of cells of the same constant force those of lowest rank take the motion; a tie is noted."""
    moved = np.flatnonzero(goes)
    if len(moved) < 2:
        return
    # Nothing but friction decides how they share.
    note[NOTE_A], note[NOTE_B] = moved[0], moved[1]
    first = np.min(rank[moved])
    for m in range(len(moved)):
        if rank[moved[m]] > first:
            goes[moved[m]] = 0


@kernel
def _drift(
    laws: Laws,
    pieces: Pieces,
    state: State,
    direction: int,
    target: float,
    alpha: float,
    beta: float,
    moved: Ints,
    on: Ints,
    offset: Floats,
    note: Ints,
    log: Log,
) -> int:
    """Cells of constant force take the motion, equally, until one of them leaves its piece."""
    before = state.travel.copy()
    force = state.force[0]
    drive = drive_of(before, force, alpha, beta)
    ends = pieces.right[on] if direction > 0 else pieces.left[on]
    room = np.min(np.abs(ends - before[moved]))
    # A target within rounding of the end of the piece is that end.
    span = alpha * (len(moved) * room - 1e-13 * summed(laws.full))
    reached = alpha > 0.0 and direction * (target - drive) < span
    if reached:
        room = direction * (target - drive) / (alpha * len(moved))
    friction_work = 0.0
    for m in range(len(moved)):
        i = int(moved[m])
        left = abs(ends[m] - before[i]) - room
        arrives = not reached and left <= 1e-15 * laws.full[i]
        state.travel[i] = ends[m] if arrives else before[i] + direction * room
        friction_work += float(laws.friction[i]) * room
    status = _write(
        log, DRIFT, direction, before, state, moved, on, offset, drive,
        drive_of(state.travel, force, alpha, beta), force, 0.0, friction_work, note,
    )  # fmt: skip
    for m in range(len(moved)):
        i = int(moved[m])
        if not reached and state.travel[i] == ends[m]:
            note[TRIGGER], note[SENSE], note[WHY] = i, direction, KINK
            _pass_end(laws, pieces, state, i, direction)
    return DONE if reached and status == GOES_ON else status


@kernel
def _until_letting_go(laws: Laws, state: State, i: int, toward: int, force: float) -> float:
    """How far λ has to go `toward` until held cell i lets go; inf where it never does."""
    stop = laws.full[i] if toward > 0 else 0.0
    if state.mode[i] != HELD or state.travel[i] == stop:
        return np.inf
    return max(0.0, toward * (state.at_rest[i] - force) + laws.friction[i])


@kernel
def _first_to_let_go(
    laws: Laws,
    pieces: Pieces,
    state: State,
    toward: int,
    rank: Ints,
    tie_force: float,
    note: Ints,
) -> tuple[float, int]:
    """Distance of λ to the first release and the cell; a tie is settled by rank and noted."""
    n = len(state.mode)
    force = state.force[0]
    nearest = np.inf
    for i in range(n):
        nearest = min(nearest, _until_letting_go(laws, state, i, toward, force))
    first, rival, falls = -1, -1, False
    if nearest == np.inf:
        return nearest, first
    for i in range(n):
        if _until_letting_go(laws, state, i, toward, force) <= nearest + tie_force:
            piece = find_piece(pieces, i, state.travel[i], toward)
            falls = falls or pieces.sign[piece] < 0
            if first < 0 or rank[i] < rank[first]:
                first, rival = i, first
            else:
                rival = i
    if rival >= 0 and falls:
        # Cells of rising force would share the motion; of these, only one can have it.
        note[NOTE_A], note[NOTE_B] = first, rival
    return nearest, first


@kernel
def _end_distance(pieces: Pieces, state: State, piece: int, offset: float, toward: int) -> float:
    """How far λ has to go `toward` until a moving cell is at the end of its piece."""
    outwards = toward * pieces.sign[piece] > 0
    end = pieces.force_right[piece] if outwards else pieces.force_left[piece]
    return float(max(0.0, toward * (end + offset - state.force[0])))


@kernel
def _turns_over(laws: Laws, pieces: Pieces, cell: int, piece: int, heading: int) -> int:
    """Sign of a cell's κ past the end of its piece; 2 where that is a stop."""
    end = pieces.right[piece] if heading > 0 else pieces.left[piece]
    stop = laws.full[cell] if heading > 0 else 0.0
    return 2 if end == stop else int(pieces.sign[piece + heading])


@kernel
def _first_to_arrive(
    laws: Laws,
    pieces: Pieces,
    state: State,
    toward: int,
    direction: int,
    moved: Ints,
    on: Ints,
    offset: Floats,
    rank: Ints,
    scale: float,
    note: Ints,
) -> tuple[float, int, bool]:
    """Distance of λ to the first end of a piece, which mover comes there, and whether in company.

    Cells whose forces reach their tops together tie, for only one of them can go on. A leader
    and one that gives way can reach the bottoms of theirs together, as alike cells do: from
    there both forces rise with the drive, with the leader on its next piece and the other one
    turned back on its own.
    """
    arrival, who, rival = np.inf, -1, -1
    for m in range(len(moved)):
        distance = _end_distance(pieces, state, on[m], offset[m], toward)
        if distance < arrival:
            arrival, who = distance, m
    if who < 0:
        return arrival, who, False
    if toward == direction:
        first = -1
        for m in range(len(moved)):
            distance = _end_distance(pieces, state, on[m], offset[m], toward)
            over = _turns_over(laws, pieces, moved[m], on[m], direction) == -1
            if not over or distance > arrival + 1e-9 * scale:
                continue
            if first < 0 or rank[moved[m]] < rank[moved[first]]:
                first, rival = m, first
            else:
                rival = m
        if rival >= 0:
            note[NOTE_A], note[NOTE_B] = moved[first], moved[rival]
            arrival = _end_distance(pieces, state, on[first], offset[first], toward)
            return arrival, first, True
        return arrival, who, False
    leads = -1
    for m in range(len(moved)):
        if _end_distance(pieces, state, on[m], offset[m], toward) <= arrival + 1e-13 * scale:
            if pieces.sign[on[m]] < 0:
                leads = m
            else:
                rival = m
    if leads < 0 or rival < 0 or _turns_over(laws, pieces, moved[leads], on[leads], direction) != 1:
        return arrival, who, False
    note[NOTE_A], note[NOTE_B] = moved[leads], moved[rival]
    return arrival, leads, True


@kernel
def _move(
    laws: Laws,
    pieces: Pieces,
    state: State,
    direction: int,
    toward: int,
    leader: int,
    target: float,
    alpha: float,
    beta: float,
    moved: Ints,
    on: Ints,
    offset: Floats,
    rank: Ints,
    scale: float,
    note: Ints,
    log: Log,
    effort: Ints,
) -> int:
    """Follow one branch to its first event or to the target; λ moves `toward`."""
    count = len(moved)
    tie_force = 1e-9 * scale
    small_drive = alpha * 1e-13 * summed(laws.full) + beta * 1e-13 * scale
    before = state.travel.copy()
    force = state.force[0]
    drive = drive_of(before, force, alpha, beta)
    arrival, who, company = _first_to_arrive(
        laws, pieces, state, toward, direction, moved, on, offset, rank, scale, note
    )
    release, cell = _first_to_let_go(laws, pieces, state, toward, rank, tie_force, note)
    releases = release < arrival - tie_force
    coincide = who >= 0 and not releases and release <= arrival + tie_force
    if coincide:
        # A force that turns just where another cell lets go: it may or may not. Against the
        # drive an arrival at a stop is one too: a snap of no size or none at all.
        sign = int(pieces.sign[on[who]])
        past = _turns_over(laws, pieces, moved[who], on[who], toward * sign)
        coincide = past == -1 if toward == direction else past != sign
    if coincide:
        note[NOTE_A], note[NOTE_B] = moved[who], cell
    if releases:
        heading = toward
        level = float(force + toward * release)
    elif who >= 0:
        cell = int(moved[who])
        heading = toward * int(pieces.sign[on[who]])
        end = pieces.force_right[on[who]] if heading > 0 else pieces.force_left[on[who]]
        level = end + offset[who] if arrival > 0.0 else force
    elif beta == 0.0:
        return RUNS_AWAY
    else:
        # Nothing is left to happen: the drive only changes the force.
        state.force[0] = (target - alpha * summed(before)) / beta
        status = _write(
            log, HOLD, direction, before, state, moved, on, offset, drive, target, force,
            0.0, 0.0, note,
        )  # fmt: skip
        return DONE if status == GOES_ON else status
    folds = False
    if toward != direction and (count > 1 or (beta > 0.0 and alpha > 0.0)):
        begin, end = force, level
        if _turn_here(laws, pieces, state, moved, leader, scale):
            begin = force + toward * BLUNT * scale
        if company and not releases:
            end = level - toward * BLUNT * scale
        fold = np.nan
        if toward * (end - begin) > 0.0:
            fold = first_fold(
                laws, pieces, moved, on, offset, alpha, beta, begin, end, 1e-15 * scale, effort
            )
        if not np.isnan(fold) and abs(fold - level) > 1e-12 * scale:
            folds, level = True, fold
    places = np.empty(count)
    rest = float(summed(before))
    for m in range(count):
        i = int(moved[m])
        rest -= float(before[i])
        places[m] = invert(laws, pieces, i, on[m], level - offset[m])
    if not folds and not releases:
        for m in range(count):
            near = _end_distance(pieces, state, on[m], offset[m], toward) <= arrival
            outwards = toward * pieces.sign[on[m]] > 0
            there = pieces.right[on[m]] if outwards else pieces.left[on[m]]
            # Alike cells arrive together, but for rounding.
            alike = abs(places[m] - there) <= 1e-15 * laws.full[moved[m]]
            if m == who or alike or (company and near):
                places[m] = there
    following = alpha * (rest + float(summed(places))) + beta * level
    reached = direction * (following - target) > small_drive
    if reached and count == 1 and beta == 0.0:
        places[0] = target - rest
        level = law(laws, moved[0], pieces.picked[on[0]], places[0])[0] + offset[0]
    elif reached:
        level = point_at(
            laws, pieces, moved, on, offset, alpha, beta, rest, force, level, target, places
        )
    if reached:
        following = target
    friction_work = 0.0
    moves = level != force or following != drive
    for m in range(count):
        i = int(moved[m])
        moves = moves or places[m] != before[i]
        friction_work += float(laws.friction[i]) * abs(places[m] - before[i])
        state.travel[i] = places[m]
    state.force[0] = level
    if moves:
        status = _write(
            log, MOVE if count > 0 else HOLD, direction, before, state, moved, on, offset,
            drive, following, force, 0.0, friction_work, note,
        )  # fmt: skip
        if status != GOES_ON:
            return status
    if reached:
        return DONE
    if folds:
        note[TRIGGER], note[SENSE], note[WHY], note[MUST_SNAP] = leader, direction, FOLD, 1
    elif releases:
        state.mode[cell], state.way[cell] = LETS_GO, toward
        state.piece[cell] = find_piece(pieces, cell, state.travel[cell], toward)
        note[TRIGGER], note[SENSE], note[WHY] = cell, toward, RELEASE
    else:
        note[TRIGGER], note[SENSE], note[WHY] = cell, heading, KINK
        _pass_end(laws, pieces, state, cell, heading)
        if state.mode[cell] == HELD:
            note[TRIGGER], note[WHY] = -1, FOLD
    return GOES_ON


@kernel
def _leg(
    laws: Laws,
    pieces: Pieces,
    alpha: float,
    beta: float,
    direction: int,
    target: float,
    state: State,
    rank: Ints,
    scale: float,
    log: Log,
    effort: Ints,
) -> int:
    """Drive the chain to `target` in one direction."""
    n = len(state.mode)
    goes = np.zeros(n, np.int64)
    note = np.array([-1, direction, FOLD, 0, -1, -1])
    small_drive = alpha * 1e-13 * summed(laws.full) + beta * 1e-13 * scale
    for i in range(n):
        if state.mode[i] == SLIDES or state.mode[i] == LETS_GO:
            _hold(laws, pieces, state, i)
    # With all the stroke used up every cell is at its stop: ask for that and not for a number,
    # which rounding could meet one cell early.
    to_the_end = beta == 0.0 and (
        target >= summed(laws.full) - small_drive if direction > 0 else target <= small_drive
    )
    if to_the_end:
        target = direction * np.inf
    furthest, idle = np.nan, 0
    while True:
        drive = drive_of(state.travel, state.force[0], alpha, beta)
        if direction * (target - drive) <= small_drive:
            return DONE
        idle = idle + 1 if abs(drive - furthest) <= small_drive else 0
        furthest = drive
        if idle > 40 * n + 400:
            return STALLED
        if overspent(effort, 10 * n):
            return GAVE_UP
        choice, leader = _choose(laws, pieces, state, direction, alpha, beta, scale, goes)
        if choice == 0 and _join_flat(laws, pieces, state, direction, 1e-9 * scale):
            choice, leader = _choose(laws, pieces, state, direction, alpha, beta, scale, goes)
        if choice == 2 or note[MUST_SNAP]:
            if note[TRIGGER] < 0:
                note[TRIGGER], note[SENSE] = leader, direction
                _note_saddle(pieces, state, leader, note)
            status = _take_snap(
                laws, pieces, state, direction, alpha, beta, scale, note, log, effort
            )
        else:
            if choice == 0:
                _share(goes, rank, note)
            for i in range(n):
                if state.mode[i] != HELD and state.mode[i] != FREE:
                    if not goes[i]:
                        _hold(laws, pieces, state, i)
                    elif laws.friction[i] == 0.0:
                        state.mode[i], state.way[i] = FREE, 0
                    else:
                        state.mode[i] = SLIDES
            moved = np.flatnonzero(goes)
            on = state.piece[moved]
            offset = state.way[moved] * laws.friction[moved]
            note[TRIGGER] = -1
            if choice == 0:
                status = _drift(
                    laws, pieces, state, direction, target, alpha, beta, moved, on, offset,
                    note, log,
                )  # fmt: skip
            else:
                status = _move(
                    laws, pieces, state, direction, choice * direction, leader, target, alpha,
                    beta, moved, on, offset, rank, scale, note, log, effort,
                )  # fmt: skip
        if status != GOES_ON:
            return DONE if to_the_end and status == RUNS_AWAY else status


@entry()
def follow(
    laws: Laws,
    pieces: Pieces,
    alpha: float,
    beta: float,
    turning: Floats,
    state: State,
    rank: Ints,
    scale: float,
    log: Log,
    effort: Ints,
) -> int:
    """Drive the chain through `turning`, writing every segment to `log`; how it ended."""
    for turn in range(1, len(turning)):
        effort[LEGS] = turn - 1
        if turning[turn] != turning[turn - 1]:
            direction = 1 if turning[turn] > turning[turn - 1] else -1
            effort[SPENT] = 0
            status = _leg(
                laws, pieces, alpha, beta, direction, turning[turn], state, rank, scale, log, effort
            )
            if status != DONE:
                # What ran out of looks may say that it did not settle.
                return GAVE_UP if status != LOG_FULL and overspent(effort, 0) else status
    return DONE
