"""Studies: something computed of many designs, into a store that loses nothing."""

from stepwell.studies.blocks import DRIVES, Packed, packed
from stepwell.studies.designs import (
    Axis,
    Block,
    Blocks,
    Designs,
    How,
    Space,
    Table,
    Workshop,
    changed,
    read_table,
    unit_in,
)
from stepwell.studies.fill import Estimate, estimate
from stepwell.studies.influence import Decided, Influence, decided
from stepwell.studies.mapper import WorkerError, dashboard, mapped, mapped_on
from stepwell.studies.pace import Pace, pace
from stepwell.studies.run import (
    CancelledError,
    Status,
    SweepError,
    asked,
    cancel,
    resumed,
    status,
    sweep,
)
from stepwell.studies.screen import Screened, screened
from stepwell.studies.store import (
    Gap,
    GapError,
    Study,
    StudyError,
    begun,
    extended,
    gaps_text,
    opened,
)
from stepwell.studies.work import SCREEN_COLUMNS, WORKS, function_of

__all__ = [
    "DRIVES",
    "SCREEN_COLUMNS",
    "WORKS",
    "Axis",
    "Block",
    "Blocks",
    "CancelledError",
    "Decided",
    "Designs",
    "Estimate",
    "Gap",
    "GapError",
    "How",
    "Influence",
    "Pace",
    "Packed",
    "Screened",
    "Space",
    "Status",
    "Study",
    "StudyError",
    "SweepError",
    "Table",
    "WorkerError",
    "Workshop",
    "asked",
    "begun",
    "cancel",
    "changed",
    "dashboard",
    "decided",
    "estimate",
    "extended",
    "function_of",
    "mapped",
    "mapped_on",
    "gaps_text",
    "opened",
    "pace",
    "packed",
    "read_table",
    "resumed",
    "status",
    "screened",
    "sweep",
    "unit_in",
]
