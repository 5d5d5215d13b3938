"""How a chain moves with the stroke: equilibria, paths, snaps, certificates."""

from stepwell.statics._outcome import StaticsError
from stepwell.statics.events import Cause, Event, EventKind, Tie
from stepwell.statics.path import Path
from stepwell.statics.run import drive_range, full_cycle, path
from stepwell.statics.stretch import Stretch, StretchKind

__all__ = [
    "Cause",
    "Event",
    "EventKind",
    "Path",
    "StaticsError",
    "Stretch",
    "StretchKind",
    "Tie",
    "drive_range",
    "full_cycle",
    "path",
]
