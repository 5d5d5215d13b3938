"""Quasi-static motion of a chain: equilibria, paths, snaps, certificates.

Terms, here and in all packages that import this one:

- *stroke*: the displacement of the outermost block; a stroke of the actuator leads from one of its
  turning points to the next;
- *path*: the equilibria of a chain while the actuator visits its turning points;
- *segment*: a part of a path on which the same cells move; it holds, moves, or snaps;
- *event*: a switch, where a cell arrives in another phase, or a snap;
- *branch*: a connected family of stable equilibria, from snap to snap;
- *passage*: the part of one branch on a path;
- *section*: a part of a branch in one state;
- *phase*: a stretch of a cell's travel that is stable under a prescribed force; a stop is one;
- *state*: for each cell the number of its phase, or - in transit between two;
- *sheet*: a stable stretch of the curve of an element that folds back in travel;
- *piece*: a part of a cell's travel on which its force and its stiffness are monotone.
"""

# pyright: reportUnusedImport=false

from stepwell.statics import batch
from stepwell.statics.batch import Designs, full_cycles, nominal
from stepwell.statics.events import Cause, Decided, Event, EventKind, Segment, SegmentKind, Tie
from stepwell.statics.following.state import DrivenChain
from stepwell.statics.inertial import History, InertialLanding
from stepwell.statics.inertial_path import InertialPath
from stepwell.statics.landing_robustness import Landing, OtherLanding, Proof, checked_ratio
from stepwell.statics.outcome import StaticsError
from stepwell.statics.path import Path
from stepwell.statics.places import (
    Configuration,
    drive_range,
    drive_weights,
    problem_of,
    read_state,
    standing,
    travel_in,
)
from stepwell.statics.run import full_cycle, path
from stepwell.statics.safe_rate import SafeRate

__all__ = [
    "Cause",
    "Decided",
    "OtherLanding",
    "Event",
    "EventKind",
    "History",
    "InertialLanding",
    "InertialPath",
    "Landing",
    "Path",
    "Proof",
    "Configuration",
    "SafeRate",
    "Segment",
    "SegmentKind",
    "StaticsError",
    "Tie",
    "drive_range",
    "full_cycle",
    "path",
]
