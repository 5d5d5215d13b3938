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
            yield Event(
                EventKind.SNAP,
                segment.cause,
                segment.drive[0],
                stroke,
                segment.direction,
                cells,
                segment.before,
                after,
                *segment.force,
                segment.released,
                tuple((c, int(b > 0)) for c, _, b in arrivals),
                segment.tie,
            )
            continue
        drive, force, stroke = segment.drive[1], segment.force[1], float(np.sum(travels))
        for c, a, b in arrivals:
            yield Event(
                EventKind.SWITCH,
                Cause.STOP,
                drive,
                stroke,
                segment.direction,
                (c,),
                (a,),
                (b,),
                force,
                force,
                0.0,
                ((c, int(b > 0)),),
                segment.tie,
            )
