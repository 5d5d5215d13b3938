"""Parameter studies of many designs in a Zarr store, and the atlas of transition graphs."""

from stepwell.studies.blocks import DRIVES, Packed, packed
from stepwell.studies.charting import charted
from stepwell.studies.designs import (
    Axis,
    Block,
    Designs,
    How,
    IndependentBlocks,
    ListedDesigns,
    Space,
    Workshop,
    changed,
    read_table,
    unit_in,
)
from stepwell.studies.fill import Pace, StudyEstimate, estimate, pace
from stepwell.studies.finding import (
    QUERIES,
    THREE,
    ClassBoundary,
    class_boundaries,
    find,
    understood,
)
from stepwell.studies.found import Extent, Frequency, OutcomeInterval, Varied, intervals
from stepwell.studies.graph_classes import (
    Atlas,
    FullCycle,
    GraphClass,
    SampledGraphs,
    atlas,
    atlas_blocks,
    canonical,
    name_of,
    possible,
    proved_space,
)
from stepwell.studies.influence import DecidingNumbers, Influence, decided
from stepwell.studies.mapper import WorkerError, dashboard, mapped, mapped_on
from stepwell.studies.run import (
    CancelledError,
    Status,
    SweepError,
    cancel,
    planned_study,
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
    "QUERIES",
    "SCREEN_COLUMNS",
    "THREE",
    "WORKS",
    "Atlas",
    "Axis",
    "Block",
    "IndependentBlocks",
    "ClassBoundary",
    "CancelledError",
    "FullCycle",
    "DecidingNumbers",
    "Designs",
    "StudyEstimate",
    "Extent",
    "Frequency",
    "Gap",
    "GapError",
    "How",
    "Influence",
    "GraphClass",
    "OutcomeInterval",
    "Pace",
    "Packed",
    "SampledGraphs",
    "Screened",
    "Space",
    "Status",
    "Study",
    "StudyError",
    "SweepError",
    "ListedDesigns",
    "Varied",
    "WorkerError",
    "Workshop",
    "planned_study",
    "atlas",
    "atlas_blocks",
    "begun",
    "class_boundaries",
    "cancel",
    "canonical",
    "changed",
    "charted",
    "dashboard",
    "decided",
    "estimate",
    "extended",
    "find",
    "function_of",
    "gaps_text",
    "intervals",
    "mapped",
    "mapped_on",
    "name_of",
    "opened",
    "pace",
    "packed",
    "possible",
    "proved_space",
    "read_table",
    "resumed",
    "screened",
    "status",
    "sweep",
    "understood",
    "unit_in",
]


def __dir__() -> list[str]:
    return sorted(__all__)
