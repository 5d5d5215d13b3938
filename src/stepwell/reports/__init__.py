"""Folders of results: records, pages, figures and data that belong together."""

from typing import TYPE_CHECKING, Any

from stepwell.reports.figure import PANELS, figure
from stepwell.reports.story.page import write_story
from stepwell.reports.story.steps import OPENING, STEPS, StoryStep, Telling
from stepwell.reports.write import boundary_rows, checked_suffix, write, write_graph

if TYPE_CHECKING:
    from stepwell.reports.paper import figure_of

__all__ = [
    "OPENING",
    "PANELS",
    "STEPS",
    "StoryStep",
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
        from stepwell.reports.paper import figure_of

        return figure_of
    raise AttributeError(f"module 'stepwell.reports' has no attribute {name!r}")
