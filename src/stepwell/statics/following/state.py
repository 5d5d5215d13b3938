"""Records of the follower: the problem, which is constant, and the state of the chain."""

from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import entry, kernel, leaf, record
from stepwell.mechanism import BEFORE, BEYOND, FIRST, HIGH, LOW, Laws, Sheets, beyond, law, summed
from stepwell.statics.following import log as logged, pieces as cutting
from stepwell.statics.following.log import Pair, add_mover, add_row
from stepwell.statics.following.pieces import Pieces

# Modes of a cell: rests against a stop or friction; follows λ both ways; slides one way against
# friction; has just reached its critical force.
HELD, FREE, SLIDES, LETS_GO = 0, 1, 2, 3
# How a run ended, or a part of it.
DONE, LOG_FULL, STALLED, NOT_SETTLED, RUNS_AWAY, GOES_ON, GAVE_UP = 0, 1, 2, 3, 4, 5, 6
# Entries of the next snap: the cell that triggers it, its sense, the cause, and whether it is due
# although the cells could move on.
TRIGGER, SENSE, WHY, DUE = range(4)
# Two forces closer than this fraction of the largest force tie.
TIE = 1e-9
# Rows of the work memory. Numbers: travels where a segment began; friction that λ carries in
# addition to the force of a mover; travels of movers, and at the other end of a stretch; the path
# length of every cell in a snap; travels and path lengths before the flow; slopes and mobilities of
# some cells, and their direction; then the rows of the flow.
WAS, EXTRA, PLACE, FAR_PLACE, RUB, START, WORN, SLOPES, WEIGHTS, WAY, OF_FLOW = range(11)
# Whole numbers: sheets where a segment began; cells that move on; movers and their pieces; modes
# and sheets before the flow; the mover number of a cell; then the rows of the flow.
WAS_ON, GOES, MOVER, ON_PIECE, MODES, SHEETS, MINE, WHOLES_OF_FLOW = range(8)
_NUMBERS, _WHOLES, _STACK = OF_FLOW + 25, WHOLES_OF_FLOW + 3, 256


@record
class Spare(NamedTuple):
    """Work memory, so that no event makes an array; N cells."""

    number: Floats  # (35, N), see above
    whole: Ints  # (10, N)
    stack: Floats  # (8, 256) waiting stretches; row 2: values of the flow
    counts: Ints  # (3,) of the flow


def spare_memory(cells: int) -> Spare:
    """Work memory to follow N cells."""
    number, whole = np.zeros((_NUMBERS, cells)), np.zeros((_WHOLES, cells), np.int64)
    return Spare(number, whole, np.zeros((8, _STACK)), np.zeros(3, np.int64))


@record
class DrivenChain(NamedTuple):
    """A chain and its actuator, constant while the chain is followed; N cells."""

    laws: Laws
    sheets: Sheets
    pieces: Pieces
    alpha: float  # of the drive coordinate U = α Σ s_i + β λ
    beta: float
    scale: float  # [N] largest force of any cell
    rank: Ints  # (N,) where cells tie the lowest goes first; equal ones share a drift
    mobility: Floats  # (N,) the largest of them 1
    effort: Ints  # number of force evaluations, and its limit: see kernels
    spare: Spare


@record
class State(NamedTuple):
    """State of the chain, with the log of its path; N cells."""

    travel: Floats  # (N,)
    mode: Ints  # (N,) HELD, FREE, SLIDES or LETS_GO
    sense: Ints  # (N,) sense in which a cell slides or leaves its place, else 0
    piece: Ints  # (N,) of a cell that is not held
    at_rest: Floats  # (N,) force of a held cell
    force: Floats  # (1,) λ
    next_snap: Ints  # (4,) TRIGGER, SENSE, WHY, DUE
    tie: Ints  # (2,) cells that tie on the present segment, or -1
    near: Floats  # (3,) of the present snap, see log.NEAR_FORCE and what follows
    stroke: Ints  # (1,) number of strokes that have begun
    log: logged.Log


def blank_state(travel: Floats, log: logged.Log) -> State:
    """A state with (N,) travels, all else unset."""
    n = len(travel)
    modes, senses, pieces = np.zeros((3, n), np.int64)
    counts, near = np.zeros(4, np.int64), np.array([np.inf, np.inf, 0.0])
    rest = np.zeros(n), np.zeros(1), counts, np.full(2, -1), near, np.zeros(1, np.int64)
    return State(travel.copy(), modes, senses, pieces, *rest, log)


class Movers(NamedTuple):
    """The m cells that move on one branch; the stroke of the others is `held` + `soft` λ."""

    cell: Ints  # (m,)
    piece: Ints  # (m,), -1 where it is not known
    offset: Floats  # (m,) friction that λ carries in addition to the force of the cell
    held: float  # [m]
    soft: float  # [m/N] of other cells that follow λ


class Begin(NamedTuple):
    """Beginning of a segment."""

    direction: int  # of the drive
    drive: float
    force: float
    travel: Floats  # (N,)
    sheet: Ints  # (N,)


@leaf
def drive_of(problem: DrivenChain, travel: Floats, force: float) -> float:
    """U = α Σ s_i + β λ."""
    return problem.alpha * summed(travel) + problem.beta * force


@leaf
def drive_slack(problem: DrivenChain) -> float:
    """Drives closer than this differ by rounding."""
    return problem.alpha * 1e-13 * summed(problem.laws.full) + problem.beta * 1e-13 * problem.scale


@leaf
def begin(problem: DrivenChain, state: State, direction: int) -> Begin:
    """The beginning of a segment at the present state."""
    travel, sheet, now = problem.spare.number[WAS], problem.spare.whole[WAS_ON], state.travel
    for i in range(len(now)):
        travel[i], sheet[i] = now[i], cutting.sheet_of(problem.sheets, i)
    force = state.force[0]
    return Begin(direction, drive_of(problem, travel, force), force, travel, sheet)


@leaf
def some_movers(spare: Spare, count: int, held: float) -> Movers:
    """The first `count` movers in the work memory."""
    cell, piece, offset = spare.whole[MOVER], spare.whole[ON_PIECE], spare.number[EXTRA]
    return Movers(cell[:count], piece[:count], offset[:count], held, 0.0)


@leaf
def movers_of(problem: DrivenChain, state: State, goes: Ints) -> Movers:
    """The cells marked in (N,) `goes` as movers."""
    spare, friction = problem.spare, problem.laws.friction
    cell, piece, offset = spare.whole[MOVER], spare.whole[ON_PIECE], spare.number[EXTRA]
    travel, held, count = state.travel, summed(state.travel), 0
    for i in range(len(goes)):
        if goes[i]:
            held -= travel[i]
            cell[count], piece[count] = i, state.piece[i]
            offset[count] = state.sense[i] * friction[i]
            count += 1
    return some_movers(spare, count, held)


@leaf
def write_row(
    state: State, kind: int, direction: int, drive: Pair, force: Pair, heat: Pair
) -> None:
    """Append a segment without movers, and reset its tie; `heat` is released and rubbed energy."""
    log = state.log
    add_row(log, kind, direction, drive, force)
    row = log.segments[log.used[0] - 1]
    row[logged.RELEASED], row[logged.RUBBED] = heat
    row[logged.TIE_A], row[logged.TIE_B] = state.tie
    if kind == logged.SNAP:
        row[logged.CAUSE] = state.next_snap[WHY]
        row[logged.LEADER], row[logged.HEADING] = state.next_snap[TRIGGER], state.next_snap[SENSE]
        row[logged.NEAR_FORCE], row[logged.NEAR_TRAVEL], row[logged.ERROR] = state.near
    state.tie[:] = -1


@leaf
def write(
    problem: DrivenChain,
    state: State,
    kind: int,
    begun: Begin,
    movers: Movers,
    heat: Pair,
    drive: float,
) -> None:
    """Append the segment that ends here at `drive`, with a row for every mover."""
    log, force = state.log, (begun.force, state.force[0])
    write_row(state, kind, begun.direction, (begun.drive, drive), force, heat)
    for j in range(len(movers.cell)):
        i = movers.cell[j]
        before, after = float(begun.travel[i]), float(state.travel[i])
        add_mover(log, i, movers.piece[j], movers.offset[j], before, after)
        mover = log.movers[log.used[1] - 1]
        mover[logged.SHEET_0], mover[logged.SHEET_1] = (
            begun.sheet[i],
            cutting.sheet_of(problem.sheets, i),
        )


@kernel
def moved(problem: DrivenChain, log: logged.Log, k: int, travel: Floats) -> Floats:
    """Rows of all cells that move in segment k, by cell; (N,) `travel` is where they are before."""
    named = log.movers[log.first[k] : log.first[k + 1]]
    row, pieces = log.segments[k], problem.pieces
    if row[logged.FOLLOW] == 0.0:
        return named
    ends, force, count = problem.sheets.ends, row[logged.FORCE_1], len(named)
    follows = (ends[:, LOW] < travel) & (travel < ends[:, HIGH])
    for m in range(count):
        follows[int(named[m, logged.CELL])] = False
    rows = np.zeros((count + np.sum(follows), logged.MOVER_COLUMNS))
    rows[:count] = named
    for i in range(len(travel)):
        if not follows[i]:
            continue
        piece = cutting.piece_along(pieces, i, cutting.resting_piece(pieces, i, travel[i]), force)
        rows[count, logged.CELL], rows[count, logged.PIECE] = (
            i,
            -1 if int(row[logged.KIND]) == logged.SNAP else piece,
        )
        rows[count, logged.TRAVEL_0] = travel[i]
        rows[count, logged.TRAVEL_1] = cutting.invert(problem.laws, pieces, i, piece, force)
        count += 1
    return rows[np.argsort(rows[:, logged.CELL])]


@entry()
def all_moved(
    problem: DrivenChain, log: logged.Log, travel: Floats, rows: Floats, first: Ints
) -> int:
    """Fill the rows of `moved` of all segments, and where each begins; (N,) `travel` then ends."""
    at = 0
    for k in range(log.used[0]):
        first[k] = at
        for row in moved(problem, log, k, travel):
            rows[at] = row
            travel[int(row[logged.CELL])] = row[logged.TRAVEL_1]
            at += 1
    first[log.used[0]] = at
    return at


@leaf
def set_near(near: Floats, force: float, stiffness: float) -> None:
    """Note the force that would change the landing of the snap, at a stiffness of the cells."""
    near[0] = min(near[0], force)
    if stiffness > 0.0:
        near[1] = min(near[1], force / stiffness)


@leaf
def set_snap(next_snap: Ints, trigger: int, sense: int, why: int) -> None:
    """Note the trigger of the next snap."""
    next_snap[TRIGGER], next_snap[SENSE], next_snap[WHY] = trigger, sense, why


@leaf
def set_tie(tie: Ints, one: int, two: int) -> None:
    """Note that two cells tie."""
    tie[0], tie[1] = one, two


@leaf
def force_at(problem: DrivenChain, i: int, travel: float) -> float:
    """F of cell i [N]; at the end of a piece its stored value."""
    pieces = problem.pieces
    piece = cutting.find_piece(pieces, i, travel, 0)
    if travel == pieces.left[piece]:
        return float(pieces.force_left[piece])
    if travel == pieces.right[piece]:
        return float(pieces.force_right[piece])
    return law(problem.laws, i, pieces.picked[piece], travel)[0]


@leaf
def hold(problem: DrivenChain, state: State, i: int) -> None:
    """Let cell i rest where it is."""
    state.mode[i], state.sense[i] = HELD, 0
    state.at_rest[i] = force_at(problem, i, state.travel[i])


@leaf
def held_range(problem: DrivenChain, state: State) -> Pair:
    """The forces λ at which every held cell stays."""
    friction, ends = problem.laws.friction, problem.sheets.ends
    mode, travel, at_rest = state.mode, state.travel, state.at_rest
    low, high = -np.inf, np.inf
    for i in range(len(mode)):
        if mode[i] == HELD:
            if travel[i] > ends[i, BEFORE]:
                low = max(low, at_rest[i] - friction[i])
            if travel[i] < ends[i, BEYOND]:
                high = min(high, at_rest[i] + friction[i])
    return low, high


@leaf
def settle(problem: DrivenChain, state: State) -> None:
    """Read modes and λ off a resting configuration, after a snap."""
    laws, pieces, ends, mode = problem.laws, problem.pieces, problem.sheets.ends, state.mode
    free, total = 0, 0.0
    for i in range(len(mode)):
        if mode[i] == HELD:
            # It has not moved: a cell that moves leaves its place first.
            continue
        inside = ends[i, BEFORE] < state.travel[i] < ends[i, BEYOND]
        if inside and laws.friction[i] == 0.0:
            mode[i], state.sense[i] = FREE, 0
            piece = cutting.resting_piece(pieces, i, state.travel[i])
            state.piece[i] = piece
            total += law(laws, i, pieces.picked[piece], state.travel[i])[0]
            free += 1
        else:
            hold(problem, state, i)
    if problem.alpha > 0.0 and free > 0:
        # Behind a stiff spring λ = K (U - Σ s) is rounding: the forces of the cells are exact.
        state.force[0] = total / free
    elif problem.beta == 0.0:
        low, high = held_range(problem, state)
        state.force[0] = min(max(state.force[0], low), high)


@leaf
def end_piece(problem: DrivenChain, state: State, cell: int, heading: int) -> None:
    """Handle a cell at the end of its piece: it rests at a stop, jumps, or moves on."""
    ends = problem.sheets.ends
    end = ends[cell, HIGH] if heading > 0 else ends[cell, LOW]
    if state.travel[cell] == end:
        if beyond(problem.sheets, cell, state.travel[cell]) < 0:
            hold(problem, state, cell)
        else:
            # Its curve folds back here: it has to jump.
            state.next_snap[WHY], state.next_snap[DUE] = logged.ENDS, 1
        return
    state.piece[cell] += heading
    if state.mode[cell] == SLIDES:
        state.mode[cell] = LETS_GO


@leaf
def jump(problem: DrivenChain, state: State, cell: int) -> bool:
    """Move a cell at the end of its sheet to the next sheet; returns whether there is one."""
    sheets = problem.sheets
    to = beyond(sheets, cell, state.travel[cell])
    if to < 0:
        return False
    cutting.stand_on(problem.laws, sheets, problem.pieces, cell, to - int(sheets.table[to, FIRST]))
    state.piece[cell] = cutting.find_piece(problem.pieces, cell, state.travel[cell], 0)
    return True
