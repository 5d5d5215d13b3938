"""Reading segments off the log of the follower, and switches and snaps off segments."""

from collections.abc import Iterable, Iterator

import numpy as np

from stepwell.base import Floats
from stepwell.statics.events import Cause, Event, EventKind, Segment, SegmentKind
from stepwell.statics.following import log as logged

# A drift moves cells of constant force.
_KINDS = {
    logged.HOLD: SegmentKind.HOLD,
    logged.MOVE: SegmentKind.MOVE,
    logged.DRIFT: SegmentKind.MOVE,
    logged.SNAP: SegmentKind.SNAP,
}


def segments_of(log: logged.Log) -> Iterator[Segment]:
    """Every segment of a log in order."""
    for k, row in enumerate(log.segments[: log.used[0]].tolist()):
        movers = log.movers[log.first[k] : log.first[k + 1]]
        kind, cause = _KINDS[int(row[logged.KIND])], None
        if kind is SegmentKind.SNAP:
            cause = Cause.RELEASE if row[logged.CAUSE] == logged.RELEASE else Cause.FOLD
        yield Segment(
            kind,
            int(row[logged.DIRECTION]),
            (row[logged.DRIVE_0], row[logged.DRIVE_1]),
            (row[logged.FORCE_0], row[logged.FORCE_1]),
            tuple(movers[:, logged.CELL].astype(int).tolist()),
            tuple(movers[:, logged.TRAVEL_0].tolist()),
            tuple(movers[:, logged.TRAVEL_1].tolist()),
            row[logged.RELEASED],
            row[logged.TIE_A] >= 0,
            cause,
        )


def events_of(segments: Iterable[Segment], start: Floats, stops: Floats) -> Iterator[Event]:
    """Every switch and snap of a path.

    Args:
        segments: of the path, in order.
        start: (N,) travels at its beginning [m].
        stops: (N,) full travels [m].
    """
    travels = start.copy()
    for segment in segments:
        cells, after = segment.cells, segment.after
        moved = list(zip(cells, segment.before, after, strict=True))
        arrivals = [(c, a, b) for c, a, b in moved if a != b and (b == 0.0 or b == stops[c])]
        stroke = float(np.sum(travels))
        travels[list(cells)] = after
        if segment.kind is SegmentKind.SNAP:
            assert segment.cause is not None
            what, moves = (
                (EventKind.SNAP, segment.cause),
                [(cells, segment.before, after, arrivals)],
            )
            place, force = (segment.drive[0], stroke, segment.direction), segment.force
        else:
            what = EventKind.SWITCH, Cause.STOP
            moves = [((c,), (a,), (b,), [(c, a, b)]) for c, a, b in arrivals]
            place = segment.drive[1], float(np.sum(travels)), segment.direction
            force = segment.force[1], segment.force[1]
        for which, begin, end, arrived in moves:
            stopped = tuple((c, int(b > 0)) for c, _, b in arrived)
            heat = segment.released if what[0] is EventKind.SNAP else 0.0
            yield Event(*what, *place, which, begin, end, *force, heat, stopped, segment.tie)
