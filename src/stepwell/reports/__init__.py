"""Folders of results: records, pages, figures and data that belong together."""

from typing import TYPE_CHECKING, Any

from stepwell.reports.chains import boundary_rows, checked_suffix, write_graph
from stepwell.reports.figure import PANELS, figure
from stepwell.reports.story import OPENING, STEPS, Step, Telling, write_story
from stepwell.reports.write import write

if TYPE_CHECKING:
    from stepwell.reports.paper import figure_of

__all__ = [
    "OPENING",
    "PANELS",
    "STEPS",
    "Step",
    "Telling",
    "boundary_rows",
    "checked_suffix",
    "figure",
    "figure_of",
    "write",
    "write_graph",
    "write_story",
]


# The claims of the paper are opened when its figures are asked for.
def __getattr__(name: str) -> Any:
    if name == "figure_of":
        from stepwell.reports import paper

        return paper.figure_of
    raise AttributeError(f"module 'stepwell.reports' has no attribute {name!r}")
