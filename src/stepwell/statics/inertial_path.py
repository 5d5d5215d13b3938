"""Motion of a chain with masses along the strokes of a path, at a rate."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from stepwell.base import ByValue, Floats, Ints, check
from stepwell.mechanism import Chain
from stepwell.statics import integrate, outcome
from stepwell.statics.events import Event, EventKind, by_segment
from stepwell.statics.following.pieces import stand_all_on
from stepwell.statics.following.state import DrivenChain
from stepwell.statics.inertia import STILL, Crank
from stepwell.statics.inertial import History, Inertia, checked_inertia

if TYPE_CHECKING:
    from stepwell.statics.path import Path

# Tolerance of a step, as a fraction of travel and of speed.
_TOLERANCE = 1e-6
# A cell this near to a phase has arrived, as a fraction of its travel.
_ARRIVED = 1e-6
# A stroke ends this fraction of its way before the turning point, where the drive nearly rests.
_SHORT = 1e-9
# Steps per call, and in total.
_ROWS, _MOST_STEPS = 1000, 30_000


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class InertialPath(ByValue):
    """Motion of a chain with masses along the strokes of a path; N cells, n steps.

    Attributes:
        rate: cycles per second [Hz]: every stroke takes half a period, as by a crank.
        masses: (N,) of the block outside each cell [kg].
        damping: (N,) on the travels [N s/m].
        restitution: coefficient of restitution at a stop.
        changes: (cell, phase) of each arrival in another phase, in order.
        keeps_order: whether these are the arrivals of the path in its order, but for a cell that
            strikes another stop and returns before any other cell arrives.
        snap_drives: for each snap of the path the drive at which the cell that jumps farthest is
            half way [m], or [N] under force control; of two such cells the one that goes with the
            drive; NaN where it is not.
        drive: (n,) actuator position [m], or its force [N].
        history: travels and speeds over time.
    """

    rate: float
    masses: tuple[float, ...]
    damping: tuple[float, ...]
    restitution: float
    changes: tuple[tuple[int, int], ...]
    keeps_order: bool
    snap_drives: tuple[float, ...]
    drive: Floats
    history: History

    def __str__(self):
        order = "keeps" if self.keeps_order else "changes"
        return f"{self.rate:.4g} Hz {order} the order of the quasi-static path."

    def __repr__(self):
        return f"InertialPath({self})"


class _Motion:
    """Rows of all strokes so far: time, drive, travels, speeds and sheets."""

    def __init__(self, problem: DrivenChain, body: integrate.Inertias) -> None:
        self.problem, self.body, n = problem, body, len(body.mass)
        still = np.zeros(n, np.int64)
        self.state = integrate.MotionState(
            body.begin.copy(), np.zeros(n), still, still.copy(), np.zeros(7)
        )
        self.begun = 0.0
        self.parts: list[Floats] = []

    def stroke(self, begin: float, end: float, seconds: float) -> None:
        """Moves the drive from a turning point to the next within the time [s]."""
        state, book, problem = self.state, self.state.book, self.problem
        n, omega = len(state.travel), math.pi / seconds
        until = seconds * (1.0 - 2.0 * math.asin(math.sqrt(_SHORT)) / math.pi)
        crank = Crank(0.5 * (end - begin), omega, until)
        body = self.body._replace(crank=crank, begin=state.travel.copy())
        book[integrate.TIME], book[integrate.STEP] = 0.0, 1e-6 * until
        state.moving[:], state.sense[:] = 0, 0
        status, steps = integrate.GOES_ON, 0
        while status == integrate.GOES_ON and steps < _MOST_STEPS:
            # Machine code that is on disk takes over after a short block.
            rows = np.full((integrate.integrate.block(_ROWS), 1 + 3 * n), np.nan)
            status = integrate.integrate(problem, body, state, rows)
            rows = rows[np.isfinite(rows[:, 0])]
            way = 2.0 * crank.swing * np.sin(0.5 * omega * rows[:, 0]) ** 2
            rows[:, 0] += self.begun
            self.parts.append(np.column_stack([rows[:, :1], begin + way, rows[:, 1:]]))
            steps += len(rows)
        if status != integrate.RESTS:
            raise outcome.StaticsError(
                f"with these masses the motion at {1.0 / (2.0 * seconds):.4g} Hz stops at "
                f"{100.0 * book[integrate.TIME] / seconds:.3g} % of a stroke. Likely cause: a cell "
                f"that rings at its stop. Set restitution = 0 or give the cells damping."
            )
        self.begun += seconds
        if problem.beta > 0.0:
            gone = float(np.sum(state.travel - body.begin))
            force = body.force + (end - begin - problem.alpha * gone) / problem.beta
            self.body = self.body._replace(force=force)
        self._seat(abs(end - begin))

    def _seat(self, way: float) -> None:
        """Bring cells that the end of a stroke left just short of a stop to it."""
        for i, travel in enumerate(self.state.travel.tolist()):
            for stop in integrate.ends_at(self.problem, i):
                if abs(travel - stop) <= 2.0 * _SHORT * way and self.problem.alpha > 0.0:
                    self.state.travel[i], self.state.speed[i] = stop, 0.0


def inertial_path(path: Path, problem: DrivenChain, rate: float, inertia: Inertia) -> InertialPath:
    """Motion along the strokes of a path at a rate, as for `Path.at_rate`."""
    check.positive("rate", rate, "Hz")
    chain, turns = path.chain, path.turning_points
    travel, sheet, n = np.array(path.start), np.array(path.start_sheet), len(chain)
    stand_all_on(problem.laws, problem.sheets, problem.pieces, sheet)
    body = checked_inertia(chain, problem, inertia)
    args = travel.copy(), path.start_force, -1, 0.0, _TOLERANCE, STILL
    motion = _Motion(problem, integrate.Inertias(*body, *args))
    for begin, end in pairwise(turns):
        if end != begin:
            motion.stroke(begin, end, 0.5 / rate)
    rows = np.vstack([[0.0, turns[0], *travel, *np.zeros(n), *sheet], *motion.parts])
    drive, travels = rows[:, 1], rows[:, 2 : n + 2]
    changes = tuple(arrivals(phases_of(chain, travels, rows[:, 2 * n + 2 :])))
    begun, expected = path.phase_changes
    groups = list(by_segment(expected).values())
    snaps = [event for event in path.events if event.kind is EventKind.SNAP]
    return InertialPath(
        rate,
        tuple(map(float, inertia[0])),
        tuple(map(float, inertia[1])),
        body[-1],
        changes,
        any(
            keeps_order(begun, groups, one) for one in (changes, without_excursions(begun, changes))
        ),
        tuple(snap_drives(snaps, drive, travels)),
        drive,
        History(rows[:, 0], travels, rows[:, n + 2 : 2 * n + 2]),
    )


def phases_of(chain: Chain, travel: Floats, sheet: Floats) -> Ints:
    """(n, N) phases at (n, N) travels and sheets, -1 in transit."""
    phases = np.full(travel.shape, -1)
    for i, stretches in enumerate(chain.stretches):
        near = _ARRIVED * chain.cells[i].full_travel
        for k, (on, low, high) in enumerate(stretches):
            s = travel[:, i]
            phases[(sheet[:, i] == on) & (s >= low - near) & (s <= high + near), i] = k
    return phases


def arrivals(phases: Ints) -> Iterator[tuple[int, int]]:
    """(cell, phase) of each arrival in another phase, in order, of (n, N) phases."""
    now = phases[0].tolist()
    rows = np.flatnonzero(np.any(np.diff(phases, axis=0) != 0, axis=1)) + 1
    for row in rows.tolist():
        for i, phase in enumerate(phases[row].tolist()):
            if phase not in (-1, now[i]):
                now[i] = phase
                yield i, phase


def without_excursions(
    begin: Sequence[int], changes: Sequence[tuple[int, int]]
) -> list[tuple[int, int]]:
    """Arrivals without those of a cell that returns before any other cell arrives."""
    kept: list[tuple[int, int]] = []
    left: list[int] = []
    now = list(begin)
    for i, phase in changes:
        if kept and kept[-1][0] == i and left[-1] == phase:
            kept.pop()
            now[i] = left.pop()
        else:
            kept.append((i, phase))
            left.append(now[i])
            now[i] = phase
    return kept


def keeps_order(
    begin: Sequence[int],
    groups: Sequence[Sequence[tuple[int, int]]],
    changes: Sequence[tuple[int, int]],
) -> bool:
    """Whether arrivals are those of groups of simultaneous changes of phases, in their order."""
    now, place = list(begin), 0
    for group in groups:
        wanted = {(i, phase) for i, phase in group if phase not in (-1, now[i])}
        for i, phase in wanted:
            now[i] = phase
        if {*changes[place : place + len(wanted)]} != wanted:
            return False
        place += len(wanted)
    return place == len(changes)


def snap_drives(events: Sequence[Event], drive: Floats, travel: Floats) -> Iterator[float]:
    """For each snap the drive at which the cell that jumps farthest is half way; NaN if never."""
    at = 0
    for event in events:
        jumps = [b - a for a, b in zip(event.before, event.after, strict=True)]
        # Of cells that jump equally far, the one that goes with the drive.
        size = 1e-9 * max(map(abs, jumps))
        k = max(
            range(len(jumps)), key=lambda m: abs(jumps[m]) + size * (jumps[m] * event.direction > 0)
        )
        middle, sense = 0.5 * (event.before[k] + event.after[k]), math.copysign(1.0, jumps[k])
        beyond = sense * (travel[at:, event.cells[k]] - middle)
        passes = np.flatnonzero((beyond[:-1] < 0.0) & (beyond[1:] >= 0.0))
        if not len(passes):
            yield math.nan
            continue
        first = int(passes[0])
        share = -beyond[first] / (beyond[first + 1] - beyond[first])
        at += first
        yield float(drive[at] + share * (drive[at + 1] - drive[at]))
