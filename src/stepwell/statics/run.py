"""Following a chain while its actuator visits a list of turning points."""

import math
from collections.abc import Callable, Sequence
from time import monotonic
from typing import Any

import numpy as np

from stepwell.kernels import LEGS, UNLIMITED, beside, end_early, watched
from stepwell.mechanism import Chain, Floats, Ints, Laws, pack
from stepwell.statics.following import (
    KEPT,
    MOST_PIECES,
    Pieces,
    audit,
    cut,
    drive_of,
    follow as f,
    force_scale,
)
from stepwell.statics.outcome import StaticsError, refuse_broken, refuse_failure
from stepwell.statics.path import Path
from stepwell.statics.sorted_cycle import WORTH_SORTING, sorted_cycle
from stepwell.statics.start import drive_weights, start_travels, starting_state

# A path that needs more is not a path but a loop.
_MOST_SEGMENTS = 4_000_000
# So many are looked at beside this thread, for Ctrl-C's sake.
_MANY_SEGMENTS = 10_000
# Chains of up to so many cells look at so many forces at most between two turning points.
_SHORT, _MOST_LOOKS = 16, 20_000_000
# A run that looks no oftener than this, compiled or not, is over before anyone asks for it.
_UNWATCHED, _UNWATCHED_INTERPRETED = 1_000_000, 50_000
_ASK_AFTER = 1.0  # s
Progress = Callable[[float, float], None]


class _MachineCodeCame(Exception):
    """An interpreted run need not go on."""


def path(
    chain: Chain,
    turning_points: Sequence[float],
    *,
    start: str | Sequence[float] | None = None,
    prefer: Sequence[int] | None = None,
    progress: Progress | None = None,
) -> Path:
    """Follow the chain's local energy minimum exactly while the actuator turns at these points.

    Args:
        chain: the chain.
        turning_points: (m,) actuator positions [m], or forces [N] where its stiffness is 0.
        start: state such as "010" or (N,) travels [m]; all cells at 0 by default.
        prefer: cells by falling priority where two of them tie; by default the innermost goes
            first, and cells of constant force share the motion.
        progress: called now and then with (done, total) of the way of the actuator.

    Returns:
        The path.

    Raises:
        ValueError: turning points out of range, or a start that is no stable equilibrium.
        StaticsError: the follower could not go on, or what it found breaks its own certificate;
            the text says where and what to do.

    Source: the equilibria are those of Kamp et al. 2024, Eqs. 1, 2 and 5; following them through
    snaps is ours (theory page).
    """
    points = _checked_turns(chain, turning_points)
    laws = pack(chain.cells)
    pieces = _cut(chain, laws)
    scale = force_scale(laws, pieces)
    travels = start_travels(chain, start)
    state = starting_state(chain, laws, pieces, travels, points[0], scale)
    return _follow_from(chain, laws, pieces, points, travels, state, scale, prefer, progress)


def full_cycle(
    chain: Chain, *, prefer: Sequence[int] | None = None, progress: Progress | None = None
) -> Path:
    """Load from all cells at 0 until all are at 1, and unload.

    Args:
        chain: the chain.
        prefer: cells by falling priority where two of them tie; by default the innermost goes
            first, and cells of constant force share the motion.
        progress: called now and then with (done, total) of the way of the actuator.

    Returns:
        The path.

    Raises:
        StaticsError: the follower could not go on, or what it found breaks its own certificate;
            the text says where and what to do.
    """
    laws = pack(chain.cells)
    if len(chain) >= WORTH_SORTING and math.isinf(chain.actuator_stiffness) and prefer is None:
        proved = sorted_cycle(laws)
        if proved is not None:
            log, force = proved
            reach = float(np.sum(laws.full))
            return _as_path(
                chain, laws, None, np.array([0.0, reach, 0.0]), laws.full * 0, force, log
            )
    pieces = _cut(chain, laws)
    low, high = _drive_range(chain, laws, pieces)
    turning = np.array([low, high, low])
    scale = force_scale(laws, pieces)
    travels = np.zeros(len(chain))
    state = starting_state(chain, laws, pieces, travels, turning[0], scale)
    return _follow_from(chain, laws, pieces, turning, travels, state, scale, prefer, progress)


def drive_range(chain: Chain) -> tuple[float, float]:
    """Drives [m], or [N] under force control, that pull every cell to 0 and to 1.

    Raises:
        StaticsError: a force that turns too often to follow.
    """
    laws = pack(chain.cells)
    return _drive_range(chain, laws, _cut(chain, laws))


def _drive_range(chain: Chain, laws: Laws, pieces: Pieces) -> tuple[float, float]:
    alpha, beta = drive_weights(chain)
    low, high = _force_range(laws, pieces) if beta > 0 else (0.0, 0.0)
    return beta * low, alpha * float(np.sum(laws.full)) + beta * high


def _follow_from(
    chain: Chain,
    laws: Laws,
    pieces: Pieces,
    turning: Floats,
    travels: Floats,
    state: f.State,
    scale: float,
    prefer: Sequence[int] | None,
    progress: Progress | None,
) -> Path:
    """Run the follower, giving it a longer log until the path fits."""
    alpha, beta = drive_weights(chain)
    rank = _ranks(len(chain), prefer)
    start_force = float(state.force[0])
    room = 64 + 16 * len(chain) * len(turning)
    # Up to so many cells a run answers or gives up in seconds; longer ones may take what they need.
    most = _MOST_LOOKS if len(chain) <= _SHORT else UNLIMITED
    aside = len(chain) * len(turning) > 3 * _SHORT or progress is not None
    while True:
        few = _UNWATCHED_INTERPRETED if f.follow.interpreted else _UNWATCHED
        trial = _copied(state)
        log = f.Log(
            np.zeros((room, f.SEGMENT_COLUMNS)),
            np.zeros(room + 1, np.int64),
            np.zeros((4 * room, f.MOVER_COLUMNS)),
            np.zeros(2, np.int64),
        )
        effort = np.array([0, most if aside else min(most, few), 0])
        problem = (laws, pieces, alpha, beta, turning, trial, rank, scale, log, effort)
        try:
            status = _watched(problem, progress) if aside else f.follow(*problem)
        except _MachineCodeCame:
            f.follow.compiled()
            continue
        if status == f.GAVE_UP and not aside and few < most:
            aside = True
            continue
        if status == f.LOG_FULL and room > _MOST_SEGMENTS:
            status = f.STALLED
        if status != f.LOG_FULL:
            break
        room *= 4
    if status != f.DONE:
        refuse_failure(status, chain, trial.travel, float(trial.force[0]))
    broken, promise, by = watched(
        lambda effort: audit(laws, pieces, log, travels, alpha, beta, scale, effort),
        long=int(log.used[0]) > _MANY_SEGMENTS,
    )
    if promise != KEPT:
        refuse_broken(promise, chain, float(log.segments[broken, f.DRIVE_1]), by, scale)
    return _as_path(chain, laws, pieces, turning, travels, start_force, log)


def _watched(problem: tuple[Any, ...], progress: Progress | None) -> int:
    """Run beside this thread, which goes on hearing Ctrl-C and tells how far the run is.

    An interpreted run is given up for a compiled one as soon as there is machine code.
    """
    _, _, alpha, beta, turning, state, _, _, _, effort = problem
    way = np.abs(np.diff(turning))
    done = np.concatenate([[0.0], np.cumsum(way)])
    interpreted, patience = f.follow.interpreted, monotonic() + _ASK_AFTER

    def look() -> None:
        if interpreted and f.follow.ready():
            raise _MachineCodeCame
        if interpreted and monotonic() > patience:
            f.follow.ask_for_machine_code(*problem)
        if progress is not None:
            leg = int(effort[LEGS])
            here = drive_of(state.travel, float(state.force[0]), alpha, beta)
            progress(done[leg] + min(abs(here - turning[leg]), way[leg]), done[-1])

    return beside(lambda: f.follow(*problem), lambda: end_early(effort), look)


def _as_path(
    chain: Chain,
    laws: Laws,
    pieces: Pieces | None,
    turning: Floats,
    travels: Floats,
    force: float,
    log: f.Log,
) -> Path:
    # Long chains have many branches: fewer samples on each keep the arrays in memory.
    points = max(2, min(33, 4_000_000 // max(1, int(log.used[0]) * len(chain))))
    # Nothing but what was written, so that two logs of one motion are equal.
    segments, movers = log.used.tolist()
    log = f.Log(
        log.segments[:segments].copy(),
        log.first[: segments + 1].copy(),
        log.movers[:movers].copy(),
        log.used,
    )
    return Path(
        chain,
        tuple(float(t) for t in turning),
        tuple(float(s) for s in travels),
        points,
        force,
        laws,
        log,
    ).with_pieces(pieces)


def _cut(chain: Chain, laws: Laws) -> Pieces:
    pieces = cut(laws)
    counts = np.diff(pieces.first)
    worst = int(np.argmax(counts))
    if counts[worst] > MOST_PIECES:
        raise StaticsError(
            f"the force of {chain.names[worst]} turns {counts[worst]} times over its travel, too "
            f"often to follow: smooth its table, or look for a band whose ends nearly meet."
        )
    return pieces


def _copied(state: f.State) -> f.State:
    return f.State(
        state.travel.copy(),
        state.mode.copy(),
        state.way.copy(),
        state.piece.copy(),
        state.at_rest.copy(),
        state.force.copy(),
    )


def _force_range(laws: Laws, pieces: Pieces) -> tuple[float, float]:
    """A force below which no cell leaves 0, and one above which none leaves 1 [N]."""
    forces = np.concatenate([pieces.force_left, pieces.force_right])
    rub = float(np.max(laws.friction))
    margin = 0.01 * force_scale(laws, pieces)
    return float(np.min(forces)) - rub - margin, float(np.max(forces)) + rub + margin


def _ranks(cells: int, prefer: Sequence[int] | None) -> Ints:
    if prefer is None:
        # All alike: cells of constant force share the motion, else the innermost goes first.
        return np.zeros(cells, np.int64)
    order = [int(i) for i in prefer]
    if sorted(order) != list(range(cells)):
        raise ValueError(
            f"prefer = {prefer!r}: must name each of the cells 0..{cells - 1} once, first the one "
            f"that goes first."
        )
    ranks = np.empty(cells, np.int64)
    ranks[order] = np.arange(cells)
    return ranks


def _checked_turns(chain: Chain, turning_points: Sequence[float]) -> Floats:
    points = np.asarray(turning_points, float)
    if points.ndim != 1 or len(points) < 1 or not np.all(np.isfinite(points)):
        raise ValueError(
            f"turning_points = {turning_points!r}: must be one or more finite numbers, where the "
            f"actuator starts and where it turns."
        )
    if math.isinf(chain.actuator_stiffness):
        most = chain.full_stroke
        outside = (points < -1e-9 * most) | (points > (1 + 1e-9) * most)
        if outside.any():
            worst = float(points[outside][0])
            raise ValueError(
                f"turning_points: {worst * 1e3:.6g} mm is out of reach: must be between 0 and "
                f"{most * 1e3:.6g} mm, the sum of all travels (strokes are in m)."
            )
        points = np.clip(points, 0.0, most)
    return points
