"""Everything about a study in one folder: figures, its table, numbers, a page."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from stepwell.base import InputError
from stepwell.reports.pages import study_page
from stepwell.reports.steps import Folder, Progress, bundle, pictured
from stepwell.results import study_record

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stepwell.studies import Status

_CAPTIONS = {
    "outcomes": "What the designs do, over what decides it",
    "influences": "How much each number decides by itself",
}


def write_study(
    found: Status,
    folder: Folder,
    *,
    partial: bool = False,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write what a study has found: study.csv, study.json, outcomes and influences.

    report.html tells it. Influences are drawn of 50 designs or more.

    Args:
        found: of the study.
        folder: made if missing.
        partial: write what is done, where designs are missing; the page then names them.
        progress: called with (done, total) files.
        force: replace files that others wrote or changed too.

    Raises:
        GapError: designs are missing.
        ValueError: an atlas, which `stepwell atlas show` tells, or a study without designs yet.
    """
    from stepwell import figures
    from stepwell.studies import decided

    study = found.study
    if study.what == "atlas":
        raise InputError(f"{study.folder}: is an atlas: see `stepwell atlas show`.")
    if not partial:
        study.require_whole()
    draws: dict[str, Callable[[], Figure]] = {"outcomes": lambda: figures.outcomes(study)}
    if what_decides := decided(study):
        draws["influences"] = lambda: figures.influences(what_decides)
    drawn = pictured(draws, _CAPTIONS)
    record = study_record(found)
    contents = {
        "study.csv": lambda file: study.to_csv(file, partial=partial),
        "study.json": record,
        "report.html": study_page(record, drawn.wide, drawn.narrow),
    }
    return bundle(folder, "sweep report", contents, drawn.files, progress=progress, force=force)
