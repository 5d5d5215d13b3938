"""Studies: something computed of many designs, into a store that loses nothing."""

from stepwell.studies.mapper import WorkerError, mapped
from stepwell.studies.run import Status, SweepError, resumed, status, sweep
from stepwell.studies.space import Axis, How, Space
from stepwell.studies.store import Study, StudyError, begun, opened
from stepwell.studies.work import WORKS

__all__ = [
    "WORKS",
    "Axis",
    "How",
    "Space",
    "Status",
    "Study",
    "StudyError",
    "SweepError",
    "WorkerError",
    "begun",
    "mapped",
    "opened",
    "resumed",
    "status",
    "sweep",
]
