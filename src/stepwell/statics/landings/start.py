"""State of a chain just before each snap of a path, from its log."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import kernel
from stepwell.mechanism import BEFORE, BEYOND
from stepwell.statics.following import log as logged, state as st
from stepwell.statics.following.pieces import find_piece, resting_piece, stand_all_on
from stepwell.statics.following.state import DrivenChain, State, blank_state, hold, moved, set_snap


class Start(NamedTuple):
    """State of a chain of N cells just before a snap, and its trigger."""

    travel: Floats  # (N,) [m]
    sheet: Ints  # (N,) by number in the cell
    force: float  # λ [N]
    drive: float  # U, which is constant
    leader: int  # the cell that triggers it
    heading: int  # the sense in which the leader moves
    direction: int  # of the drive
    cause: int  # as in the log
    sense: Ints  # (N,) sense in which a cell slides against friction or is released, else 0
    piece: Ints  # (N,) last piece of a moving cell, else -1


class Snap(NamedTuple):
    """A snap of a path: start and landing, with further snaps that leave a saddle at once."""

    start: Start
    travel: Floats  # (N,) after it [m]
    sheet: Ints  # (N,)
    rows: int  # of the log


def snaps_of(problem: DrivenChain, log: logged.Log, travel: Floats, sheet: Ints) -> Iterator[Snap]:
    """Snaps of a path in order, which begins at (N,) travels and sheets."""
    now, on, (count, _) = travel.copy(), sheet.copy(), log.used.tolist()
    pending: Snap | None = None
    for k in range(count):
        row = log.segments[k]
        snaps = int(row[logged.KIND]) == logged.SNAP
        if pending is not None and not (snaps and _follows_at_once(problem, row, now)):
            yield pending
            pending = None
        start = _start(log, k, now, on) if snaps and pending is None else None
        movers = moved(problem, log, k, now)
        cells = movers[:, logged.CELL].astype(int)
        now[cells], on[cells] = movers[:, logged.TRAVEL_1], movers[:, logged.SHEET_1]
        if start is not None:
            pending = Snap(start, now.copy(), on.copy(), 1)
        elif pending is not None:
            pending = Snap(pending.start, now.copy(), on.copy(), pending.rows + 1)
    if pending is not None:
        yield pending


def _follows_at_once(problem: DrivenChain, row: Floats, travel: Floats) -> bool:
    """Whether a snap follows another one at once because it leaves a saddle."""
    leader = int(row[logged.LEADER])
    return int(row[logged.CAUSE]) == logged.FOLD and _inside(problem, leader, travel[leader])


def _inside(problem: DrivenChain, cell: int, travel: float) -> bool:
    """Whether a cell rests neither against a stop nor against friction."""
    ends = problem.sheets.ends
    free = problem.laws.friction[cell] == 0.0
    return bool(free and ends[cell, BEFORE] < travel < ends[cell, BEYOND])


def _start(log: logged.Log, k: int, travel: Floats, sheet: Ints) -> Start:
    n, row, last = len(travel), log.segments[k], log.segments[k - 1]
    leader, heading = int(row[logged.LEADER]), int(row[logged.HEADING])
    direction, cause = int(row[logged.DIRECTION]), int(row[logged.CAUSE])
    sense, piece = np.zeros(n, np.int64), np.full(n, -1)
    moved_on = k > 0 and int(last[logged.KIND]) in (logged.MOVE, logged.DRIFT)
    if moved_on and int(last[logged.DIRECTION]) == direction:
        movers = log.movers[log.first[k - 1] : log.first[k]]
        cells = movers[:, logged.CELL].astype(int)
        piece[cells], sense[cells] = movers[:, logged.PIECE], np.sign(movers[:, logged.OFFSET])
    if cause in (logged.RELEASE, logged.KINK):
        sense[leader] = heading
    where = travel.copy(), sheet.copy(), float(row[logged.FORCE_0]), float(row[logged.DRIVE_0])
    return Start(*where, leader, heading, direction, cause, sense, piece)


def empty_state(cells: int) -> State:
    """Uninitialised state of a chain of N cells."""
    return blank_state(np.zeros(cells), logged.empty_log(1, cells))


@kernel
def stand_before(problem: DrivenChain, start: Start, state: State) -> None:
    """Set the chain to its state just before a snap."""
    laws, pieces, ends = problem.laws, problem.pieces, problem.sheets.ends
    stand_all_on(laws, problem.sheets, pieces, start.sheet)
    state.travel[:] = start.travel
    state.force[0] = start.force
    for i in range(len(start.travel)):
        travel, piece = state.travel[i], start.piece[i]
        inside = ends[i, BEFORE] < travel < ends[i, BEYOND]
        if inside and laws.friction[i] == 0.0:
            state.mode[i], state.sense[i] = st.FREE, 0
        elif start.sense[i] != 0:
            state.mode[i], state.sense[i] = st.SLIDES, start.sense[i]
        else:
            hold(problem, state, i)
            continue
        if i == start.leader and start.cause in (logged.RELEASE, logged.KINK):
            state.piece[i] = find_piece(pieces, i, travel, start.heading)
        elif piece >= 0 and pieces.left[piece] <= travel <= pieces.right[piece]:
            state.piece[i] = piece
        else:
            state.piece[i] = resting_piece(pieces, i, travel)
    set_snap(state.next_snap, start.leader, start.heading, start.cause)
    state.next_snap[st.DUE] = 1
    state.tie[:] = -1
