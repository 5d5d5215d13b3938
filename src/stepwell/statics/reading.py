"""Reading segments off the log of the follower, and switches and snaps off segments."""

from collections.abc import Callable, Iterable, Iterator
from itertools import pairwise

import numpy as np

from stepwell.base import Floats
from stepwell.mechanism import Chain, Stretch, phase_at
from stepwell.statics.events import Cause, Decided, Event, EventKind, Segment, SegmentKind
from stepwell.statics.following import Problem, log as logged, moved

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


def segments_of(
    log: logged.Log, start: tuple[float, ...], problem: Callable[[], Problem]
) -> Iterator[Segment]:
    """Every segment of a log in order.

    Args:
        log: of the path.
        start: (N,) travels at its beginning [m].
        problem: makes what was followed, where a segment has cells without a row.
    """
    rows, now = log.segments[: log.used[0]].tolist(), np.array(start)
    for k, row in enumerate(rows):
        movers = log.movers[log.first[k] : log.first[k + 1]]
        if row[logged.FOLLOW]:
            movers = moved(problem(), log, k, now)
        whole = movers[:, [logged.CELL, logged.SHEET_0, logged.SHEET_1]].astype(int)
        cells, sheet_0, sheet_1 = whole.T.tolist()
        before, after = movers[:, logged.TRAVEL_0], movers[:, logged.TRAVEL_1]
        now[cells] = after
        kind, cause = _KINDS[int(row[logged.KIND])], None
        if kind is SegmentKind.SNAP:
            cause = _CAUSES.get(int(row[logged.CAUSE]), Cause.FOLD)
        yield Segment(
            kind,
            int(row[logged.DIRECTION]),
            (row[logged.DRIVE_0], row[logged.DRIVE_1]),
            (row[logged.FORCE_0], row[logged.FORCE_1]),
            tuple(cells),
            tuple(before.tolist()),
            tuple(after.tolist()),
            tuple(sheet_0),
            tuple(sheet_1),
            row[logged.RELEASED],
            row[logged.TIE_A] >= 0,
            cause,
            *(row[logged.NEAR_FORCE :] if kind is SegmentKind.SNAP else ()),
            decided=_DECIDED.get(int(row[logged.DECIDED])),
        )


# The phase of a cell that is in transit.
TRANSIT = -1


def phase_changes(
    log: logged.Log,
    start: tuple[float, ...],
    sheets: tuple[int, ...],
    stretches: tuple[tuple[Stretch, ...], ...],
) -> tuple[list[int], list[list[tuple[int, int]]]]:
    """The phases at the start, and for every segment in which any changes, those that do.

    Curves of many pieces have many segments of which nothing else is to be told.

    Args:
        log: of the path.
        start, sheets: (N,) where the cells begin.
        stretches: (N,) where the phases of every cell lie.

    Returns:
        (N,) phases, TRANSIT between two; and lists of (cell, phase), in order of the segments.
    """
    begin = [
        _phase(own, *at) for own, at in zip(stretches, zip(sheets, start, strict=True), strict=True)
    ]
    movers = log.movers[: log.used[1]]
    cells = movers[:, logged.CELL].astype(int)
    order = np.argsort(cells, kind="stable")
    phases = np.full(len(cells), TRANSIT)
    before = np.full(len(cells), TRANSIT)
    ends = np.searchsorted(cells[order], np.arange(len(stretches) + 1))
    for cell, (a, b) in enumerate(pairwise(ends.tolist())):
        if a == b:
            continue
        rows = order[a:b]
        travel, sheet = movers[rows, logged.TRAVEL_1], movers[rows, logged.SHEET_1]
        own = phases[rows]
        for number, (on, low, high) in enumerate(stretches[cell]):
            own[(own == TRANSIT) & (sheet == on) & (low <= travel) & (travel <= high)] = number
        phases[rows] = own
        before[rows] = [begin[cell], *own[:-1].tolist()]
    segment = np.repeat(np.arange(int(log.used[0])), np.diff(log.first[: log.used[0] + 1]))
    changes: dict[int, list[tuple[int, int]]] = {}
    for row in np.flatnonzero(phases != before).tolist():
        changes.setdefault(int(segment[row]), []).append((int(cells[row]), int(phases[row])))
    return begin, list(changes.values())


def _phase(stretches: tuple[Stretch, ...], sheet: int, travel: float) -> int:
    digit = phase_at(stretches, sheet, travel)
    return TRANSIT if digit == "-" else int(digit)


def events_of(segments: Iterable[Segment], start: Floats, chain: Chain) -> Iterator[Event]:
    """Every switch and snap of a path.

    Args:
        segments: of the path, in order.
        start: (N,) travels at its beginning [m].
        chain: whose path it is.
    """
    stretches, measure = chain.stretches, chain.measure
    travels = start.copy()
    for segment in segments:
        arrivals = list(_arrivals(segment, stretches))
        stroke = float(np.sum(travels))
        travels[list(segment.cells)] = segment.after
        if segment.kind is SegmentKind.SNAP:
            assert segment.cause is not None
            yield Event(
                EventKind.SNAP,
                segment.cause,
                segment.drive[0],
                stroke,
                segment.direction,
                segment.cells,
                segment.before,
                segment.after,
                segment.sheets_before,
                segment.sheets_after,
                *segment.force,
                segment.released,
                tuple((segment.cells[m], phase) for m, phase in arrivals),
                segment.tie,
                measure,
                segment.distance_force,
                segment.distance_travel,
                segment.error,
                segment.decided,
            )
            continue
        for m, phase in arrivals:
            cell, sheets = segment.cells[m], (segment.sheets_after[m],)
            _, low, high = stretches[cell][phase]
            yield Event(
                EventKind.SWITCH,
                Cause.STOP if low == high else Cause.TURN,
                segment.drive[1],
                float(np.sum(travels)),
                segment.direction,
                (cell,),
                (segment.before[m],),
                (segment.after[m],),
                sheets,
                sheets,
                segment.force[1],
                segment.force[1],
                0.0,
                ((cell, phase),),
                segment.tie,
                measure,
            )


def _arrivals(
    segment: Segment, stretches: tuple[tuple[Stretch, ...], ...]
) -> Iterator[tuple[int, int]]:
    """Movers, by number in the segment, that arrive in another phase, and the phase."""
    for m, cell in enumerate(segment.cells):
        after = phase_at(stretches[cell], segment.sheets_after[m], segment.after[m])
        if after != "-":
            before = phase_at(stretches[cell], segment.sheets_before[m], segment.before[m])
            if before != after:
                yield m, int(after)
