"""Full cycles of many designs of one shape of chain in one call: their states, as numbers.

Every design is cut, followed and audited by the same kernels as `full_cycle`, so its path passes
the same checks. Designs that the kernels cannot compute are left to `full_cycle`, which raises an
error with the reason.
"""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from stepwell import mechanism as mech
from stepwell.base import Floats, Ints, notify
from stepwell.kernels import MOST, entry, in_blocks, leaf, record
from stepwell.mechanism import Chain, Laws, Sheets
from stepwell.statics.following import log as logged, pieces as cuts, state as st
from stepwell.statics.following.certificate import KEPT, audit
from stepwell.statics.following.follow import follow
from stepwell.statics.following.pieces import CuttingSpace, Pieces
from stepwell.statics.following.rising import Rising, no_rising
from stepwell.statics.following.state import DrivenChain, Spare, State
from stepwell.statics.places import EPSILON, drive_weights, stand_at
from stepwell.statics.sorted_cycle import WORTH_SORTING

# Columns of the cells of a design.
LEVER, SIN_LIMIT, FULL, FRICTION, MOBILITY = range(5)
# And of a phase.
_SHEET, _LOW, _HIGH, _FORCE_LOW, _FORCE_HIGH = range(5)
# Columns of the results of a design.
SNAPS, TIES, PEAK, LOST, STROKE_UP, STROKE_DOWN, STEPS_UP, STEPS_DOWN = range(8)
FOUND = 8
# Limit of force evaluations between two turns; designs above it are followed separately.
_LOOKS = 1_000_000
_AT_ONCE = 128  # designs in one block of a core
# Nearer than this fraction to a limit of `Cell`, the cell itself is constructed.
_CLEAR = 1e-3
_LEAST_LIMIT, _MOST_LIMIT = math.sin(math.radians(0.02)), math.sin(math.radians(89.8))


@record
class Designs(NamedTuple):
    """m designs of one shape of chain: N cells, B bands, M rows, T sheets, P phases.

    Common values are those of the nominal chain. Rows and sheets have a leading axis of 1 if they
    are equal for all designs. Travels of sheets and phases of lever cells follow from `cells`.
    """

    laws: Laws
    sheets: Sheets
    open_ended: bool  # whether a full cycle does not go from stop to stop
    cells: Floats  # (m, N, 5) LEVER, SIN_LIMIT, FULL, FRICTION, MOBILITY
    bands: Floats  # (m, B, 4) d_x, d_y, k, ℓ0
    rows: Floats  # (1 or m, M, 6)
    tables: Floats  # (1 or m, T, 9)
    phase_first: Ints  # (N + 1,) phases of cell i are phase_first[i] .. phase_first[i + 1]
    phases: Floats  # (1 or m, P, 5) sheet, travels and forces between which it lies
    drives: Floats  # (m, 2) α and β of the drive coordinate


@record
class _Work(NamedTuple):
    """Work memory that is reused for every design."""

    laws: Laws
    sheets: Sheets
    pieces: Pieces
    room: CuttingSpace
    spare: Spare
    rising: Rising
    state: State
    begin: Floats  # (N,) travels where the cycle begins
    sheet: Ints  # (N,) sheets there
    mobility: Floats  # (N,)
    rank: Ints  # (N,)
    phase: Ints  # (N,) where a cell is, -1 in transit
    phases: Floats  # (P, 5)
    turning: Floats  # (3,)
    effort: Ints  # (2,)


@record
class Followed(NamedTuple):
    """Results of full cycles of m designs; a first number -1 means: follow this one separately.

    Attributes:
        visited: (m, V) the states in order, each a decimal number with one digit per cell, inner
            first; -1 after the last one.
        found: (m, 8) SNAPS and TIES, their numbers; PEAK, the extreme force [N]; LOST, energy [J];
            STROKE_UP, STROKE_DOWN of the first snap, loading and unloading [m], NaN without one;
            STEPS_UP, STEPS_DOWN, numbers of steps from state to state with a snap.
    """

    visited: Ints
    found: Floats


def nominal(chain: Chain, count: int) -> Designs | None:
    """Designs that all equal the chain, to be overwritten; None for a long chain."""
    if len(chain) >= WORTH_SORTING:
        return None
    return _stacked([chain], [mech.packed(chain.cells)], count)


def stacked(chains: Sequence[Chain]) -> Designs | None:
    """Chains as designs of one shape; None if their shapes differ, or for long chains.

    One shape: equal numbers of cells, bands, sheets and phases, and the same laws of bands and
    loads of cells.
    """
    if not chains or any(len(one) >= WORTH_SORTING for one in chains):
        return None
    parts = [mech.packed(chain.cells) for chain in chains]
    shapes = [_shape(*both) for both in zip(chains, parts, strict=True)]
    return _stacked(chains, parts, len(chains)) if shapes.count(shapes[0]) == len(shapes) else None


def _shape(chain: Chain, part: tuple[Laws, Sheets]) -> tuple[object, ...]:
    laws, sheets = part
    arrays = laws.band_first, laws.two_sided, laws.band_rows, laws.load_rows
    # Rows of lever cells alone are those of their laws and loads; elements bring their own.
    rows = laws.rows.shape if chain.elements else laws.rows.tobytes()
    phases = tuple(len(cell.stretches) for cell in chain.cells)
    kinds = tuple(type(cell) for cell in chain.cells)
    ends = sheets.table.shape, phases, kinds, _is_open_ended(chain)
    return *(array.tobytes() for array in arrays), rows, *ends


def _is_open_ended(chain: Chain) -> bool:
    """Whether a full cycle goes past all critical forces, as for chains without stops."""
    rigid = math.isinf(chain.actuator_stiffness)
    stops = rigid and all(all(cell.stopped) for cell in chain.cells)
    return bool(chain.elements) and not stops


def _stacked(chains: Sequence[Chain], parts: Sequence[tuple[Laws, Sheets]], count: int) -> Designs:
    (laws, sheets), chain = parts[0], chains[0]
    elements = bool(chain.elements)
    cells, bands = np.empty((count, len(chain), 5)), np.empty((count, len(laws.band), 4))
    drives = np.empty((count, 2))
    mobility = [[cell.mobility for cell in one.cells] for one in chains]
    cells[:] = [
        np.column_stack([own.lever, own.sin_limit, own.full, own.friction, moves])
        for (own, _), moves in zip(parts, mobility, strict=True)
    ]
    bands[:] = [own.band for own, _ in parts]
    drives[:] = [drive_weights(one) for one in chains]
    # Lever cells alone have no rows or sheets of their own.
    apart = parts if elements else parts[:1]
    rows, tables = np.array([own.rows for own, _ in apart]), np.array([on.table for _, on in apart])
    first = np.cumsum([0, *(len(cell.stretches) for cell in chain.cells)])
    phases = np.array([_phase_rows(one) for one in (chains if elements else chains[:1])])
    open_ended = _is_open_ended(chain)
    return Designs(laws, sheets, open_ended, cells, bands, rows, tables, first, phases, drives)


def _phase_rows(chain: Chain) -> list[tuple[float, ...]]:
    return [
        (p.sheet, p.low, p.high, p.force_low, p.force_high)
        for cell in chain.cells
        for p in cell.phases
    ]


def full_cycles(designs: Designs, progress: Callable[[int, int], None] | None = None) -> Followed:
    """Full cycles of all designs, on all cores.

    Args:
        designs: designs of one shape of chain.
        progress: called from time to time with (done, total); designs left to `full_cycle` do not
            count as done.
    """
    m = len(designs.cells)
    out = Followed(np.full((m, 6 * designs.phases.shape[1] + 2), -1), np.full((m, FOUND), np.nan))

    def follow_block(begin: int, end: int) -> None:
        follow_each(designs, begin, end, _work(designs), out)

    def report(tried: int, total: int) -> None:
        notify(progress, int(np.count_nonzero(out.visited[:tried, 0] >= 0)), total)

    if m:
        in_blocks(follow_block, m, follow_each.block(_AT_ONCE, designs), report)
    return out


def _work(designs: Designs) -> _Work:
    laws = Laws._make(array.copy() for array in designs.laws)
    sheets = Sheets._make(array.copy() for array in designs.sheets)
    n, phases = len(laws.lever), designs.phases.shape[1]
    capacity = 64 + 16 * n * 3
    cutting = (
        cuts.memory_for_pieces(laws, sheets, 64 + 16 * n + 4 * len(laws.rows)),
        cuts.cutting_space(laws),
    )
    state = st.blank_state(np.zeros(n), logged.empty_log(capacity, 4 * capacity))
    sheet, rank, phase = np.zeros((3, n), np.int64)
    own = np.zeros(n), sheet, np.ones(n), rank, phase, np.zeros((phases, 5)), np.zeros(3)
    follows = st.spare_memory(n), no_rising(n), state
    return _Work(laws, sheets, *cutting, *follows, *own, np.array([0, _LOOKS]))


@entry(4e-3, "designs.cells")
def follow_each(designs: Designs, begin: int, end: int, work: _Work, out: Followed) -> None:
    """Follow designs begin .. end, and write their results."""
    for k in range(begin, end):
        _follow_one(designs, k, work, out.visited[k], out.found[k])


@leaf
def _follow_one(designs: Designs, k: int, work: _Work, visited: Ints, numbers: Floats) -> None:
    if not _build(designs, k, work):
        return
    laws, sheets, pieces, effort = work.laws, work.sheets, work.pieces, work.effort
    if cuts.cut_into(laws, sheets, pieces, work.room) < 0:
        return
    scale = cuts.force_scale(laws, sheets, pieces)
    alpha, beta = designs.drives[k, 0], designs.drives[k, 1]
    rank, mobility, spare = work.rank, work.mobility, work.spare
    problem = DrivenChain(laws, sheets, pieces, alpha, beta, scale, rank, mobility, effort, spare)
    if not _set_cycle(designs, problem, work):
        return
    state, turning = work.state, work.turning
    effort[0], effort[MOST] = 0, _LOOKS
    if follow(problem, turning, state, work.rising) != st.DONE:
        return
    effort[0], effort[MOST] = 0, _LOOKS
    _, promise, _ = audit(problem, state.log, work.begin, work.sheet)
    if promise == KEPT:
        _write_results(designs, work, (problem.alpha, problem.beta), visited, numbers)


@leaf
def _build(designs: Designs, k: int, work: _Work) -> bool:
    """Write one design over the previous one; False if it may be invalid."""
    laws, table, phases, mobility = work.laws, work.sheets.table, work.phases, work.mobility
    own = k if len(designs.rows) > 1 else 0
    _copy(designs.rows[own], laws.rows)
    _copy(designs.tables[own], table)
    _copy(designs.phases[own], phases)
    _copy(designs.bands[k], laws.band)
    cells, most = designs.cells[k], 0.0
    for i in range(len(cells)):
        most = max(most, cells[i, MOBILITY])
    at = 0
    for i in range(len(cells)):
        laws.lever[i], laws.sin_limit[i] = cells[i, LEVER], cells[i, SIN_LIMIT]
        laws.full[i], laws.friction[i] = cells[i, FULL], cells[i, FRICTION]
        mobility[i] = cells[i, MOBILITY] / most
        if laws.band_first[i] < laws.band_first[i + 1]:
            if not _can_be_built(laws, i, cells[i, MOBILITY]):
                return False
            table[at, mech.HIGH] = table[at, mech.CURVE_HIGH] = laws.full[i]
            last = designs.phase_first[i] + 1
            phases[last, _LOW] = phases[last, _HIGH] = laws.full[i]
        first = at
        at += 1
        while at < len(table) and table[at, mech.FIRST] == first:
            at += 1
    return True


@leaf
def _copy(rows: Floats, out: Floats) -> None:
    for i in range(len(rows)):
        for j in range(rows.shape[1]):
            out[i, j] = rows[i, j]


@leaf
def _can_be_built(laws: Laws, i: int, mobility: float) -> bool:
    """Whether a lever cell is certainly valid; otherwise `Cell` decides."""
    lever, limit, full = laws.lever[i], laws.sin_limit[i], laws.full[i]
    if not (0.0 < lever < np.inf and 0.0 <= laws.friction[i] < np.inf):
        return False
    if not (_LEAST_LIMIT < limit < _MOST_LIMIT and full > 0.0):
        return False
    if not mech.MOBILITIES[0] * (1.0 + _CLEAR) < mobility < mech.MOBILITIES[1] * (1.0 - _CLEAR):
        return False
    for row in range(laws.load_rows[i, 0] + 2, laws.load_rows[i, 1]):
        if laws.rows[row, 0] - laws.rows[row - 1, 0] < 2e-9 * full:
            return False
    for b in range(laws.band_first[i], laws.band_first[i + 1]):
        dx, dy = laws.band[b, 0], laws.band[b, 1]
        stiffness, rest = laws.band[b, 2], laws.band[b, 3]
        reach = np.sqrt(dx * dx + dy * dy)
        if not (0.0 < stiffness < np.inf and 0.0 <= rest < np.inf and reach < np.inf):
            return False
        # Its ends may meet.
        if abs(reach - lever) < _CLEAR * lever:
            return False
    return True


@leaf
def _set_cycle(designs: Designs, problem: DrivenChain, work: _Work) -> bool:
    """Set the beginning and the turns of a full cycle; False where they are uncertain."""
    # One function: chains with stops and without fill the same travels and turns.
    laws, sheets, pieces = problem.laws, problem.sheets, problem.pieces
    alpha, beta, scale, phases = problem.alpha, problem.beta, problem.scale, work.phases
    travel, sheet, n = work.begin, work.sheet, len(laws.lever)
    rub = 0.0
    for i in range(n):
        sheet[i] = int(phases[designs.phase_first[i], _SHEET])
        rub = max(rub, laws.friction[i])
    least, most = np.inf, -np.inf
    if designs.open_ended:
        for p in range(len(phases)):
            for force in (phases[p, _FORCE_LOW], phases[p, _FORCE_HIGH]):
                if np.isfinite(force):
                    least, most = min(least, force), max(most, force)
        if most < least:
            return False
        more = 0.05 * scale + rub
        least, most = min(0.0, least - more), max(0.0, most + more)
        low, high = 0.0, 0.0
        for i in range(n):
            p, q = designs.phase_first[i], designs.phase_first[i + 1] - 1
            first = int(phases[p, _SHEET]), phases[p, _LOW], phases[p, _HIGH]
            last = int(phases[q, _SHEET]), phases[q, _LOW], phases[q, _HIGH]
            travel[i] = cuts.travel_between(laws, sheets, pieces, i, first, least)
            low += travel[i]
            high += cuts.travel_between(laws, sheets, pieces, i, last, most)
        low, high = alpha * low + beta * least, alpha * high + beta * most
    else:
        low, high = mech.ends_of(sheets)
        at, table = 0, sheets.table
        for i in range(n):
            begin, travel[i] = at, np.inf
            while at < len(table) and table[at, mech.FIRST] == begin:
                travel[i] = min(travel[i], table[at, mech.CURVE_LOW])
                at += 1
        if beta > 0.0:
            for piece in range(pieces.of_sheet[len(sheets.table)]):
                one, other = pieces.force_left[piece], pieces.force_right[piece]
                least, most = min(least, one, other), max(most, one, other)
            margin = 0.01 * scale
            low = beta * (least - rub - margin)
            high = alpha * high + beta * (most + rub + margin)
    turning = work.turning
    turning[0], turning[1], turning[2] = low, high, low
    return _set_start_state(problem, work, low)


@leaf
def _set_start_state(problem: DrivenChain, work: _Work, drive: float) -> bool:
    """Set the state at the beginning, as `starting_state` does; False where that might raise."""
    state, beta, full = work.state, problem.beta, mech.summed(problem.laws.full)
    if beta > 0.0 and 4.0 * EPSILON * problem.alpha * full > 0.5e-2 * problem.scale * beta:
        return False
    state.next_snap[:], state.tie[:] = 0, -1
    state.stroke[0], state.log.used[0], state.log.used[1], state.log.first[0] = 0, 0, 0, 0
    for i in range(len(work.begin)):
        state.travel[i] = work.begin[i]
    balanced, stable, _, _ = stand_at(problem, state, work.sheet, drive)
    return balanced and stable


@leaf
def _phase_at(designs: Designs, phases: Floats, cell: int, sheet: int, travel: float) -> int:
    first = designs.phase_first[cell]
    for p in range(first, designs.phase_first[cell + 1]):
        if phases[p, _SHEET] == sheet and phases[p, _LOW] <= travel <= phases[p, _HIGH]:
            return p - first
    return -1


@leaf
def _write_results(
    designs: Designs, work: _Work, drive: tuple[float, float], visited: Ints, numbers: Floats
) -> None:
    log, travel = work.state.log, work.state.travel
    code = _first_state(designs, work)
    if code < 0:
        return
    used, last, between, visited[0] = 1, code, 0, code
    snaps, ties, lost, snapped, steps_up, steps_down = 0, 0, 0.0, 0, 0, 0
    for k in range(log.used[0]):
        row = log.segments[k]
        lost += row[logged.RELEASED] + row[logged.RUBBED]
        ties += int(row[logged.TIE_A] >= 0.0)
        if int(row[logged.KIND]) == logged.SNAP:
            snaps += 1
            snapped = int(row[logged.DIRECTION])
            way = STROKE_UP if snapped > 0 else STROKE_DOWN
            if np.isnan(numbers[way]):
                # Cells without a row follow λ: the drive gives the sum, except under a dead load.
                (alpha, beta), numbers[way] = drive, mech.summed(travel)
                if alpha > 0.0:
                    numbers[way] = (row[logged.DRIVE_0] - beta * row[logged.FORCE_0]) / alpha
        more, left = _moved_on(designs, work, k)
        code, between = code + more, between + left
        if between == 0:
            steps_up, steps_down = steps_up + (snapped > 0), steps_down + (snapped < 0)
            snapped = 0
            if code != last:
                if used == len(visited):
                    visited[0] = -1
                    return
                visited[used] = last = code
                used += 1
    numbers[SNAPS], numbers[TIES], numbers[PEAK], numbers[LOST] = snaps, ties, _peak(log), lost
    numbers[STEPS_UP], numbers[STEPS_DOWN] = steps_up, steps_down


@leaf
def _first_state(designs: Designs, work: _Work) -> int:
    """The number of the state where the log begins; negative where a cell is in transit."""
    code, weight = 0, 1
    for i in range(len(work.phase) - 1, -1, -1):
        travel = work.state.travel[i] = work.begin[i]
        phase = work.phase[i] = _phase_at(designs, work.phases, i, work.sheet[i], travel)
        if phase < 0:
            return -1
        code += weight * phase
        weight *= 10
    return code


@leaf
def _moved_on(designs: Designs, work: _Work, k: int) -> tuple[int, int]:
    """Changes of the number of the state and of the number of cells in transit by a segment."""
    log, phase, travel = work.state.log, work.phase, work.state.travel
    code, between = 0, 0
    for j in range(log.first[k], log.first[k + 1]):
        mover = log.movers[j]
        i = int(mover[logged.CELL])
        travel[i] = mover[logged.TRAVEL_1]
        now = _phase_at(designs, work.phases, i, int(mover[logged.SHEET_1]), travel[i])
        if now == phase[i]:
            continue
        between += int(now < 0) - int(phase[i] < 0)
        weight = 10 ** (len(phase) - 1 - i)
        # A cell in transit has no digit; it counts as the one that it left.
        if now >= 0:
            code += weight * now
        if phase[i] >= 0:
            code -= weight * phase[i]
        phase[i] = now
    return code, between


@leaf
def _peak(log: logged.Log) -> float:
    high = low = log.segments[0, logged.FORCE_0] if log.used[0] > 0 else 0.0
    for k in range(log.used[0]):
        for force in (log.segments[k, logged.FORCE_0], log.segments[k, logged.FORCE_1]):
            high, low = max(high, force), min(low, force)
    return logged.signed_peak(high, low)
