"""Segments of a path, the events between them, and both read off the log of the follower."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum
from itertools import pairwise, zip_longest
from typing import NamedTuple

import numpy as np

from stepwell.base import ByValue, Measure, display_unit, grouped, number, to_unit
from stepwell.mechanism import Chain, Stretch
from stepwell.statics.following import log as logged, state


class EventKind(Enum):
    """Kind of an event."""

    SWITCH = "a cell reaches a stop or another phase"
    SNAP = "snap-through at a fixed drive"


class Cause(Enum):
    """Cause of an event."""

    STOP = "the cell reaches its end stop"
    FOLD = "the local energy minimum merges with a saddle (fold)"
    RELEASE = "snap-through of a held cell at its critical force"
    TURN = "the element reaches another rising part of its curve"
    END = "the force curve of an element folds back"


class Decided(Enum):
    """Method that computed the landing of a snap."""

    LINE = "along the line on which one cell or one pair moves"
    EQUATION = "by one equation: no other cell leaves its branch"
    FLOW = "by integration of the overdamped flow"


@dataclass(frozen=True, slots=True, eq=False)
class Event(ByValue):
    """One switch or snap.

    Attributes:
        kind, cause: kind of the event, and its cause.
        drive: actuator position [m], or its force [N] under force control.
        stroke: u = Σ s_i just before [m].
        direction: +1 while loading, -1 while unloading.
        cells: cells that moved; for a snap also the cell that triggered it and came back.
        before, after: their travels [m].
        sheets_before, sheets_after: sheets of their curves.
        force_before, force_after: actuator force λ [N].
        released: energy turned into heat by the jump [J], without the work of friction.
        arrivals: (cell, phase) for every cell that arrived in another phase; a stop is one.
        tie: whether another outcome was closer than the tolerance.
        measure: kind of travel and force.
        distance_force: least force during or after a snap that leads to another landing [N]; inf
            where no other landing is near, and for a switch.
        distance_travel: the same divided by the stiffness of the cells there [m].
        error: error bound of an integrated landing [m]; 0 where no time was integrated.
        decided: method that computed the landing of a snap; None for a switch.
    """

    kind: EventKind
    cause: Cause
    drive: float
    stroke: float
    direction: int
    cells: tuple[int, ...]
    before: tuple[float, ...]
    after: tuple[float, ...]
    sheets_before: tuple[int, ...]
    sheets_after: tuple[int, ...]
    force_before: float
    force_after: float
    released: float
    arrivals: tuple[tuple[int, int], ...]
    tie: bool
    measure: Measure
    distance_force: float = math.inf
    distance_travel: float = math.inf
    error: float = 0.0
    decided: Decided | None = None

    def __repr__(self):
        unit, factor = display_unit(self.measure.travel_unit)
        moves = ", ".join(
            f"cell {c + 1} {a * factor:.4g}→{b * factor:.4g} {unit}"
            for c, a, b in zip(self.cells, self.before, self.after, strict=True)
        )
        what = f", releases {to_unit(self.released, 'mJ'):.4g} mJ"
        what = what if self.kind is EventKind.SNAP else ""
        way = "loading" if self.direction > 0 else "unloading"
        return f"{self.kind.name} at {number(self.stroke * factor)} {unit} {way}: {moves}{what}"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Tie(ByValue):
    """Degeneracy: two outcomes at the same drive, closer than the tolerance.

    Attributes:
        drive: actuator position [m], or its force [N] under force control.
        cells: the cells that tie, or the one whose landing does.
        advice: a change that removes the tie.
    """

    drive: float
    cells: tuple[int, ...]
    advice: str

    def __str__(self):
        return self.advice


class SegmentKind(Enum):
    """Kind of motion on a segment of a path."""

    HOLD = "nothing moves while the force changes"
    MOVE = "cells move smoothly; turning back undoes it where there is no friction"
    SNAP = "the chain jumps at a fixed drive"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Segment(ByValue):
    """One part of a path, the same cells moving all along it.

    Attributes:
        kind: kind of motion.
        drive: (2,) actuator position [m] at both ends, or its force [N] under force control.
        force: (2,) actuator force λ at both ends [N].
        cause: cause of the snap; None on other segments.
        direction, cells, before, after, sheets_before, sheets_after, released, tie: as for `Event`.
        distance_force, distance_travel, error, decided: of a snap, as for `Event`.
    """

    kind: SegmentKind
    direction: int
    drive: tuple[float, float]
    force: tuple[float, float]
    cells: tuple[int, ...]
    before: tuple[float, ...]
    after: tuple[float, ...]
    sheets_before: tuple[int, ...]
    sheets_after: tuple[int, ...]
    released: float
    tie: bool
    cause: Cause | None
    distance_force: float = math.inf
    distance_travel: float = math.inf
    error: float = 0.0
    decided: Decided | None = None


# A drift moves cells of constant force.
_KINDS = {
    logged.HOLD: SegmentKind.HOLD,
    logged.MOVE: SegmentKind.MOVE,
    logged.DRIFT: SegmentKind.MOVE,
    logged.SNAP: SegmentKind.SNAP,
}
_CAUSES = {logged.RELEASE: Cause.RELEASE, logged.ENDS: Cause.END}
_DECIDED = {
    logged.BY_LINE: Decided.LINE,
    logged.BY_EQUATION: Decided.EQUATION,
    logged.BY_FLOW: Decided.FLOW,
}


class _Moved(NamedTuple):
    """The cells that move in a segment, with sheets and travels [m] before and after."""

    cells: tuple[int, ...]
    sheets_before: tuple[int, ...]
    sheets_after: tuple[int, ...]
    before: tuple[float, ...]
    after: tuple[float, ...]


def segments_of(
    log: logged.Log, start: tuple[float, ...], problem: Callable[[], state.DrivenChain]
) -> Iterator[Segment]:
    """Segments of a log in order; `problem` is called where cells follow without a row."""
    for row, moved in zip(log.segments.tolist(), _moved(log, start, problem), strict=True):
        kind, cause, near = _KINDS[int(row[logged.KIND])], None, (math.inf, math.inf, 0.0)
        if kind is SegmentKind.SNAP:
            cause = _CAUSES.get(int(row[logged.CAUSE]), Cause.FOLD)
            near = row[logged.NEAR_FORCE], row[logged.NEAR_TRAVEL], row[logged.ERROR]
        drive = row[logged.DRIVE_0], row[logged.DRIVE_1]
        force = row[logged.FORCE_0], row[logged.FORCE_1]
        moves = moved.cells, moved.before, moved.after
        sheets = moved.sheets_before, moved.sheets_after
        direction = int(row[logged.DIRECTION])
        heat, tie, decided = row[logged.RELEASED], row[logged.TIE_A] >= 0, int(row[logged.DECIDED])
        what = kind, direction, drive, force
        yield Segment(*what, *moves, *sheets, heat, tie, cause, *near, _DECIDED.get(decided))


def _moved(
    log: logged.Log, start: tuple[float, ...], problem: Callable[[], state.DrivenChain]
) -> Iterator[_Moved]:
    """What moves in every segment."""
    rows, first = log.movers, log.first
    if follow := int(np.count_nonzero(log.segments[:, logged.FOLLOW])):
        rows = np.empty((len(rows) + follow * len(start), logged.MOVER_COLUMNS))
        first = np.empty_like(first)
        rows = rows[: state.all_moved(problem(), log, np.array(start), rows, first)]
    # Slices of lists: most segments have one mover or two, for which arrays take longer.
    whole = logged.CELL, logged.SHEET_0, logged.SHEET_1
    columns = rows[:, whole].astype(int).T.tolist()
    columns += [rows[:, one].tolist() for one in (logged.TRAVEL_0, logged.TRAVEL_1)]
    cells, on, onto, before, after = map(tuple, columns)
    ends = first.tolist()
    for a, b in pairwise(ends):
        yield _Moved(cells[a:b], on[a:b], onto[a:b], before[a:b], after[a:b])


# The phase of a cell that is in transit.
TRANSIT = -1
# Of a cell with fewer phases than others.
_NOWHERE: Stretch = -1, math.inf, -math.inf


# (segment, cell, phase) of every cell that changes in a segment, TRANSIT between two phases.
Changes = list[tuple[int, int, int]]


def phase_changes(
    log: logged.Log,
    start: tuple[float, ...],
    sheets: tuple[int, ...],
    stretches: tuple[tuple[Stretch, ...], ...],
) -> tuple[list[int], Changes]:
    """(N,) phases at the start, TRANSIT between two, and all changes in order."""
    movers, n = log.movers, len(start)
    cells = np.concatenate([np.arange(n), movers[:, logged.CELL].astype(int)])
    travel = np.concatenate([start, movers[:, logged.TRAVEL_1]])
    sheet = np.concatenate([sheets, movers[:, logged.SHEET_1]])
    phases = np.full(len(cells), TRANSIT)
    for phase, of_all in enumerate(zip_longest(*stretches, fillvalue=_NOWHERE)):
        on, low, high = np.array(of_all)[cells].T
        within = (sheet == on) & (low <= travel) & (travel <= high)
        phases[(phases == TRANSIT) & within] = phase
    # The phase that each cell had before: at the start, or after its last move.
    order = np.argsort(cells, kind="stable")
    before = np.empty_like(phases)
    before[order] = np.roll(phases[order], 1)
    changed = n + np.flatnonzero(phases[n:] != before[n:])
    segment = np.repeat(np.arange(int(log.used[0])), np.diff(log.first))
    columns = segment[changed - n], cells[changed], phases[changed]
    return phases[:n].tolist(), list(zip(*(one.tolist() for one in columns), strict=True))


def by_segment(changes: Changes) -> dict[int, list[tuple[int, int]]]:
    """The (cell, phase) of the changes of each segment that has any, in order."""
    return grouped((segment, (cell, phase)) for segment, cell, phase in changes)


def events_of(
    log: logged.Log,
    start: tuple[float, ...],
    problem: Callable[[], state.DrivenChain],
    changes: Changes,
    chain: Chain,
) -> Iterator[Event]:
    """Switches and snaps of a log; `problem` is called where cells follow without a row."""
    stretches, travels = chain.stretches, np.array(start)
    of = by_segment(changes)
    moves = zip(log.segments.tolist(), _moved(log, start, problem), strict=True)
    for k, (row, moved) in enumerate(moves):
        arrived = [change for change in of.get(k, ()) if change[1] != TRANSIT]
        snaps = int(row[logged.KIND]) == logged.SNAP
        if snaps:
            yield _snap(row, moved, float(travels.sum()), tuple(arrived), chain.measure)
        for cell, travel in zip(moved.cells, moved.after, strict=True):
            travels[cell] = travel
        for cell, phase in () if snaps else arrived:
            _, low, high = stretches[cell][phase]
            what = (cell, phase), Cause.STOP if low == high else Cause.TURN, chain.measure
            yield _switch(row, moved, float(travels.sum()), *what)


def _snap(
    row: list[float],
    moved: _Moved,
    stroke: float,
    arrived: tuple[tuple[int, int], ...],
    measure: Measure,
) -> Event:
    cause = _CAUSES.get(int(row[logged.CAUSE]), Cause.FOLD)
    direction, tie = int(row[logged.DIRECTION]), row[logged.TIE_A] >= 0
    what = EventKind.SNAP, cause, row[logged.DRIVE_0], stroke, direction
    moves = moved.cells, moved.before, moved.after, moved.sheets_before, moved.sheets_after
    forces = row[logged.FORCE_0], row[logged.FORCE_1]
    rest = row[logged.RELEASED], arrived, tie, measure
    near = row[logged.NEAR_FORCE], row[logged.NEAR_TRAVEL], row[logged.ERROR]
    return Event(*what, *moves, *forces, *rest, *near, _DECIDED.get(int(row[logged.DECIDED])))


def _switch(
    row: list[float],
    moved: _Moved,
    stroke: float,
    arrived: tuple[int, int],
    cause: Cause,
    measure: Measure,
) -> Event:
    m = moved.cells.index(arrived[0])
    sheet = (moved.sheets_after[m],)
    direction, tie = int(row[logged.DIRECTION]), row[logged.TIE_A] >= 0
    what = EventKind.SWITCH, cause, row[logged.DRIVE_1], stroke, direction
    moves = (arrived[0],), (moved.before[m],), (moved.after[m],)
    forces = row[logged.FORCE_1], row[logged.FORCE_1]
    return Event(*what, *moves, sheet, sheet, *forces, 0.0, (arrived,), tie, measure)
