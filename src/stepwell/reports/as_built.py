"""A first build in one folder: the design as it was built, and with the move that is advised."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from stepwell.files import dumps
from stepwell.reports.pages import as_built_page
from stepwell.reports.steps import Folder, Progress, bundle

if TYPE_CHECKING:
    from stepwell.lab import AsBuilt


def write_as_built(
    found: AsBuilt,
    record: dict[str, Any],
    folder: Folder,
    *,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write what `lab.as_built` found: built.toml, moved.toml, built.json, report.html."""
    contents: dict[str, Any] = {"built.json": record, "built.toml": dumps(found.chain)}
    if found.moves:
        contents["moved.toml"] = dumps(found.moves[0].of(found.chain))
    contents["report.html"] = as_built_page(found, record)
    return bundle(folder, "lab as-built", contents, progress=progress, force=force)
