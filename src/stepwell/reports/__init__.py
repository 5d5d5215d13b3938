"""Folders of results: figures, tables, numbers and pages that belong together.

Every `write_…` takes the result and a folder, which is made if missing, and writes all of its files
or nothing. What the same function wrote there before is replaced; figures are a .png and a .svg.

    design      text of the design file, kept beside the result; written anew by default
    progress    called with (done, total) files
    force       replace files that others wrote or changed too

It returns the names of the files, and raises OverwriteError where a file there is not one that it
wrote, and OSError where the folder cannot be written; nothing has changed then.
"""

from stepwell.reports.atlas import write_atlas
from stepwell.reports.chains import boundary_rows, checked_suffix, write_graph
from stepwell.reports.figure import PANELS, figure
from stepwell.reports.story import OPENING, STEPS, Step, Telling, write_story
from stepwell.reports.study import write_study
from stepwell.reports.write import write

__all__ = [
    "OPENING",
    "STEPS",
    "Step",
    "Telling",
    "PANELS",
    "boundary_rows",
    "checked_suffix",
    "figure",
    "write_atlas",
    "write",
    "write_graph",
    "write_story",
    "write_study",
]
