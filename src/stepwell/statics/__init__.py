"""How a chain moves with the stroke: equilibria, paths, snaps, certificates."""

from stepwell.statics.events import Cause, Event, EventKind, Tie
from stepwell.statics.outcome import StaticsError
from stepwell.statics.path import Path
from stepwell.statics.problem import drive_range
from stepwell.statics.run import full_cycle, path
from stepwell.statics.segment import Segment, SegmentKind

__all__ = [
    "Cause",
    "Event",
    "EventKind",
    "Path",
    "Segment",
    "SegmentKind",
    "StaticsError",
    "Tie",
    "drive_range",
    "full_cycle",
    "path",
]
