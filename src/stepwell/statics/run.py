"""Following a chain while its actuator visits a list of turning points."""

import math
from collections.abc import Callable, Sequence
from time import process_time

import numpy as np

from stepwell.base import Floats, InputError, Ints, Measure, display_unit
from stepwell.kernels import MOST, UNLIMITED, WORTH_LOADING, beside, end_early, watched
from stepwell.mechanism import Chain, ends_of, packed
from stepwell.statics import outcome, places, sorted_cycle
from stepwell.statics.following import certificate, log as logged, pieces, rising, state as st
from stepwell.statics.following.follow import follow
from stepwell.statics.following.state import DrivenChain, State, drive_of
from stepwell.statics.path import Path

# Limit of segments, which only an endless loop exceeds.
_MOST_SEGMENTS = 4_000_000
# Longer logs are audited in another thread, so that Ctrl-C works.
_MANY_SEGMENTS = 10_000
# Largest short chain, and its limit of force evaluations between two turning points.
_SHORT, _MOST_LOOKS = 16, 20_000_000
# Of chains up to this length a run may be too short for a thread, compiled or interpreted.
_DIRECT, _DIRECT_INTERPRETED = 64, _SHORT
# Force evaluations of a run, compiled or interpreted, that is too short for a thread.
_UNWATCHED, _UNWATCHED_INTERPRETED = 1_000_000, 50_000
_ASK_AFTER = 1.0  # s of the processor
Progress = Callable[[float, float], None]


class _MachineCodeCame(Exception):
    """Machine code is available, so the interpreted run stops."""


def path(
    chain: Chain,
    turning_points: Sequence[float],
    *,
    start: str | places.Configuration | Sequence[float] | None = None,
    prefer: Sequence[int] | None = None,
    progress: Progress | None = None,
) -> Path:
    """The path of the local energy minimum through these points. All else as for `Chain.path`."""
    points = _finite_turns(turning_points)
    problem = places.problem_of(chain, prefer=prefer)
    points = _reached_turns(chain, problem, points)
    place = places.starting_configuration(chain, problem, start, float(points[0]))
    state = places.starting_state(chain, problem, place, float(points[0]))
    return _follow_from(chain, problem, points, place, state, progress)


def full_cycle(
    chain: Chain, *, prefer: Sequence[int] | None = None, progress: Progress | None = None
) -> Path:
    """The path of a full cycle; see `Chain.cycle`."""
    cells = packed(chain.cells)
    laws, _ = cells
    rigid = math.isinf(chain.actuator_stiffness)
    alike = len({cell.mobility for cell in chain.cells}) == 1
    if len(chain) >= sorted_cycle.WORTH_SORTING and rigid and alike and prefer is None:
        proved = sorted_cycle.sorted_cycle(laws)
        if proved is not None:
            log, force = proved
            reach = float(np.sum(laws.full))
            begin = places.Configuration((0.0,) * len(chain), (0,) * len(chain))
            turning = np.array([0.0, reach, 0.0])
            return _as_path(chain, turning, begin, force, log).with_cells(cells)
    problem = places.problem_of(chain, cells, prefer)
    begin, (low, high) = places.full_range(chain, problem)
    state = places.starting_state(chain, problem, begin, low)
    return _follow_from(chain, problem, np.array([low, high, low]), begin, state, progress)


def _follow_from(
    chain: Chain,
    problem: DrivenChain,
    turning: Floats,
    place: places.Configuration,
    start: State,
    progress: Progress | None,
) -> Path:
    """Run the follower from a place and its state, and check the certificate of its log."""
    sheets = np.array(place.sheet)
    status, state = _followed(chain, problem, turning, sheets, start, progress)
    if status != st.DONE:
        outcome.refuse_failure(status, chain, state.travel, float(state.force[0]), _involved(state))
    log, travel = state.log, start.travel
    broken, promise, by = watched(
        lambda effort: certificate.audit(problem._replace(effort=effort), log, travel, sheets),
        long=int(log.used[0]) > _MANY_SEGMENTS,
    )
    if promise != certificate.KEPT:
        drive = float(log.segments[broken, logged.DRIVE_1])
        outcome.refuse_broken(promise, chain, drive, by, problem.scale)
    return _as_path(chain, turning, place, float(start.force[0]), log).with_problem(problem)


def _followed(
    chain: Chain,
    problem: DrivenChain,
    turning: Floats,
    sheets: Ints,
    start: State,
    progress: Progress | None,
) -> tuple[int, State]:
    """Status and state at the end of the follower, with a longer log where needed."""
    capacity = 64 + 16 * len(chain) * len(turning)
    # A short chain ends or reaches the step limit in seconds; longer chains have no limit.
    most = _MOST_LOOKS if len(chain) <= _SHORT else UNLIMITED
    short = _DIRECT_INTERPRETED if follow.interpreted else _DIRECT
    aside = len(chain) * len(turning) > 3 * short or progress is not None

    def fresh() -> State:
        log = logged.empty_log(capacity, 4 * capacity)
        return State._make([*(values.copy() for values in start[:-1]), log])

    def again() -> State:
        pieces.stand_all_on(problem.laws, problem.sheets, problem.pieces, sheets)
        return fresh()

    state, queues = fresh(), rising.no_rising(len(chain))
    while True:
        few = _UNWATCHED_INTERPRETED if follow.interpreted else _UNWATCHED
        problem.effort[MOST] = most if aside else min(most, few)
        try:
            if aside:
                status = _watched(problem, turning, state, queues, progress)
            else:
                status = follow(problem, turning, state, queues)
        except _MachineCodeCame:
            follow.compiled()
            state = again()
            continue
        if status == st.GAVE_UP and not aside and few < most:
            aside, state = True, again()
        elif status == st.LOG_FULL and len(state.log.segments) <= _MOST_SEGMENTS:
            state = state._replace(log=logged.longer(state.log))
        else:
            return st.STALLED if status == st.LOG_FULL else status, state


def _involved(state: State) -> list[int]:
    """The cells that moved in the last two segments, and the trigger of the next snap."""
    log, trigger = state.log, int(state.next_snap[st.TRIGGER])
    begin, end = log.first[[max(int(log.used[0]) - 2, 0), int(log.used[0])]].tolist()
    moved = log.movers[begin:end, logged.CELL].astype(int).tolist()
    return sorted({*moved, trigger} - {-1}) or list(range(len(state.travel)))


def _watched(
    problem: DrivenChain,
    turning: Floats,
    state: State,
    queues: rising.Rising,
    progress: Progress | None,
) -> int:
    """Run in another thread; this one handles Ctrl-C and changes to machine code if available."""
    way = np.abs(np.diff(turning))
    done = np.concatenate([[0.0], np.cumsum(way)])
    interpreted, begun = follow.interpreted, process_time()

    def look() -> None:
        spent = process_time() - begun
        if interpreted and spent > WORTH_LOADING and follow.ready():
            raise _MachineCodeCame
        if interpreted and spent > _ASK_AFTER:
            follow.ask_for_machine_code(problem, turning, state, queues)
        if progress is not None:
            stroke = max(int(state.stroke[0]) - 1, 0)
            here = drive_of(problem, state.travel, float(state.force[0]))
            progress(done[stroke] + min(abs(here - turning[stroke]), way[stroke]), done[-1])

    def run() -> int:
        return follow(problem, turning, state, queues)

    return beside(run, lambda: end_early(problem.effort), look)


def _as_path(
    chain: Chain, turning: Floats, begin: places.Configuration, force: float, log: logged.Log
) -> Path:
    # Long chains have many branches: fewer samples on each keep the arrays in memory.
    points = max(2, min(33, 4_000_000 // max(1, int(log.used[0]) * len(chain))))
    turns, written = tuple(turning.tolist()), logged.written(log)
    return Path(chain, turns, begin.travel, points, begin.sheet, force, written)


def _finite_turns(turning_points: Sequence[float]) -> Floats:
    points = np.asarray(turning_points, float)
    if points.ndim != 1 or len(points) < 1 or not np.all(np.isfinite(points)):
        raise InputError(
            f"turning_points = {turning_points!r}: must be one or more finite numbers, the start "
            f"and the turning points of the actuator."
        )
    return points


def _reached_turns(chain: Chain, problem: DrivenChain, points: Floats) -> Floats:
    if problem.beta > 0:
        return points
    least, most = ends_of(problem.sheets)
    slip = 1e-9 * chain.full_stroke
    outside = (points < least - slip) | (points > most + slip)
    if outside.any():
        worst, measure = float(points[outside][0]), chain.measure
        unit, factor = display_unit(measure.travel_unit)
        what = "all travels" if measure is Measure.TRAVEL else f"every {measure.travel}"
        raise InputError(
            f"turning_points: {worst * factor:.6g} {unit} is out of reach: must be between "
            f"{least * factor:.6g} and {most * factor:.6g} {unit}, the sum of {what} "
            f"({measure.stroke}s are in {measure.travel_unit})."
        )
    return np.clip(points, least, most)
