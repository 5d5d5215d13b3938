"""How a chain moves with the stroke: equilibria, paths, snaps, certificates."""

from stepwell.statics._outcome import StaticsError
from stepwell.statics.events import Cause, Event, EventKind, Tie
from stepwell.statics.path import Path
from stepwell.statics.run import full_cycle, path

__all__ = ["Cause", "Event", "EventKind", "Path", "StaticsError", "Tie", "full_cycle", "path"]
