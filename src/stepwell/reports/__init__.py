"""Folders of results: records, pages, figures and data."""

from typing import TYPE_CHECKING

from stepwell.base import late
from stepwell.reports.figure import PANELS, TALLEST, figure
from stepwell.reports.story.page import write_story
from stepwell.reports.story.steps import OPENING, STEPS, PlannedStep, StoryStep
from stepwell.reports.write import boundary_rows, checked_suffix, write, write_graph

if TYPE_CHECKING:
    from stepwell.reports.paper import figure_of

__all__ = [
    "OPENING",
    "PANELS",
    "STEPS",
    "TALLEST",
    "PlannedStep",
    "StoryStep",
    "boundary_rows",
    "checked_suffix",
    "figure",
    "figure_of",
    "write",
    "write_graph",
    "write_story",
]


# The claims of the paper are imported only for its figures.
__getattr__, __dir__ = late(__name__, {"paper": ("figure_of",)}, __all__)
