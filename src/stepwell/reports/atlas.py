"""Everything about an atlas in one folder: its machines drawn, numbers, a page."""

from __future__ import annotations

from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING

from stepwell.base import InputError
from stepwell.reports.pages import atlas_page
from stepwell.reports.steps import Folder, Progress, bundle, pictured
from stepwell.results import atlas_record

if TYPE_CHECKING:
    from stepwell.studies import Atlas

_CAPTION = "The most frequent machines, and the share and yield of all"


def write_atlas(
    found: Atlas, folder: Folder, *, progress: Progress | None = None, force: bool = False
) -> tuple[str, ...]:
    """Write an atlas: atlas.json, its machines as graphs if they can be seen, and report.html."""
    from stepwell import figures

    drawn = pictured({}, {})
    # Of more cells than can be seen side by side the table tells all.
    with suppress(InputError):
        drawn = pictured({"machines": partial(figures.machines, found)}, {"machines": _CAPTION})
    record = atlas_record(found)
    contents = {"atlas.json": record, "report.html": atlas_page(record, drawn.wide, drawn.narrow)}
    return bundle(folder, "atlas show", contents, drawn.files, progress=progress, force=force)
