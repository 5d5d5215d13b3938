"""Studies: something computed of many designs, into a store that loses nothing."""

from stepwell.studies.designs import (
    Axis,
    Designs,
    How,
    Space,
    Table,
    Workshop,
    read_table,
    unit_in,
)
from stepwell.studies.fill import Estimate, estimate
from stepwell.studies.mapper import WorkerError, dashboard, mapped, mapped_on
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
from stepwell.studies.store import Study, StudyError, begun, extended, opened
from stepwell.studies.work import WORKS, function_of

__all__ = [
    "WORKS",
    "Axis",
    "CancelledError",
    "Designs",
    "Estimate",
    "How",
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
    "dashboard",
    "estimate",
    "extended",
    "function_of",
    "mapped",
    "mapped_on",
    "opened",
    "read_table",
    "resumed",
    "status",
    "sweep",
    "unit_in",
]
