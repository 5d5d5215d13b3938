"""Reading switches and snaps off the log of the follower."""

import numpy as np

from stepwell.mechanism import Floats
from stepwell.statics.events import Cause, Event, EventKind
from stepwell.statics.following import log as logged


def read_events(log: logged.Log, stops: Floats, travels: Floats) -> list[Event]:
    """Every switch and snap of a log that starts at `travels`, which are used up."""
    events: list[Event] = []
    for k, row in enumerate(log.segments[: log.used[0]]):
        movers = log.movers[log.first[k] : log.first[k + 1]]
        cells = movers[:, logged.CELL].astype(int)
        before, after = movers[:, logged.TRAVEL_0], movers[:, logged.TRAVEL_1]
        full = stops[cells]
        moved = before != after
        arrives = moved & ((after == 0.0) | (after == full))
        arrivals = [
            (int(c), int(a > 0)) for c, a in zip(cells[arrives], after[arrives], strict=True)
        ]
        tie = bool(row[logged.TIE_A] >= 0)
        direction = int(row[logged.DIRECTION])
        if row[logged.KIND] == logged.SNAP:
            events.append(
                Event(
                    EventKind.SNAP,
                    Cause.RELEASE if row[logged.CAUSE] == logged.RELEASE else Cause.FOLD,
                    float(row[logged.DRIVE_0]),
                    float(np.sum(travels)),
                    cells=tuple(int(c) for c in cells),
                    before=tuple(float(s) for s in before),
                    after=tuple(float(s) for s in after),
                    force_before=float(row[logged.FORCE_0]),
                    force_after=float(row[logged.FORCE_1]),
                    released=float(row[logged.RELEASED]),
                    arrivals=tuple(arrivals),
                    direction=direction,
                    tie=tie,
                )
            )
            travels[cells] = after
            continue
        travels[cells] = after
        for cell, state in arrivals:
            j = int(np.flatnonzero(cells == cell)[0])
            events.append(
                Event(
                    EventKind.SWITCH,
                    Cause.STOP,
                    float(row[logged.DRIVE_1]),
                    float(np.sum(travels)),
                    cells=(cell,),
                    before=(float(before[j]),),
                    after=(float(after[j]),),
                    force_before=float(row[logged.FORCE_1]),
                    force_after=float(row[logged.FORCE_1]),
                    released=0.0,
                    arrivals=((cell, state),),
                    direction=direction,
                    tie=tie,
                )
            )
    return events
