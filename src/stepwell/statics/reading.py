"""Reading switches and snaps off the log of the follower."""

import numpy as np

from stepwell.mechanism import Floats, Laws
from stepwell.statics.events import Cause, Event, EventKind
from stepwell.statics.following import follow as f


def read_events(log: f.Log, laws: Laws, travels: Floats) -> list[Event]:
    """Every switch and snap of a log that starts at `travels`, which are used up."""
    events: list[Event] = []
    for k, row in enumerate(log.segments[: log.used[0]]):
        movers = log.movers[log.first[k] : log.first[k + 1]]
        cells = movers[:, f.CELL].astype(int)
        before, after = movers[:, f.TRAVEL_0], movers[:, f.TRAVEL_1]
        full = laws.full[cells]
        moved = before != after
        arrives = moved & ((after == 0.0) | (after == full))
        arrivals = [
            (int(c), int(a > 0)) for c, a in zip(cells[arrives], after[arrives], strict=True)
        ]
        tie = bool(row[f.TIE_A] >= 0)
        direction = int(row[f.DIRECTION])
        if row[f.KIND] == f.SNAP:
            events.append(
                Event(
                    EventKind.SNAP,
                    Cause.RELEASE if row[f.CAUSE] == f.RELEASE else Cause.FOLD,
                    float(row[f.DRIVE_0]),
                    float(np.sum(travels)),
                    cells=tuple(int(c) for c in cells),
                    before=tuple(float(s) for s in before),
                    after=tuple(float(s) for s in after),
                    force_before=float(row[f.FORCE_0]),
                    force_after=float(row[f.FORCE_1]),
                    released=float(row[f.RELEASED]),
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
                    float(row[f.DRIVE_1]),
                    float(np.sum(travels)),
                    cells=(cell,),
                    before=(float(before[j]),),
                    after=(float(after[j]),),
                    force_before=float(row[f.FORCE_1]),
                    force_after=float(row[f.FORCE_1]),
                    released=0.0,
                    arrivals=((cell, state),),
                    direction=direction,
                    tie=tie,
                )
            )
    return events
