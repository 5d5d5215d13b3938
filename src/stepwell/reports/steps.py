"""Writing a folder of results, its steps counted for a progress bar."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stepwell.base import write_atomic, write_netcdf
from stepwell.files import staged_folder

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

Folder = str | os.PathLike[str]
Progress = Callable[[int, int], None]


class Steps:
    """Counts what is done and says so."""

    def __init__(self, progress: Progress | None, total: int):
        self.progress, self.total, self.done = progress, total, 0

    def next(self) -> None:
        """One more is done."""
        self.done += 1
        if self.progress is not None:
            self.progress(self.done, self.total)


def save_figures(drawn: Mapping[str, Figure], folder: Path, steps: Steps) -> None:
    """Write every figure as .png and as .svg."""
    from stepwell import figures

    for name, figure in drawn.items():
        for suffix in (".png", ".svg"):
            figures.save(figure, folder / f"{name}{suffix}")
            steps.next()


def write_json(file: Path, record: dict[str, Any]) -> None:
    """Write a record, finite numbers only."""
    write_atomic(file, json.dumps(record, indent=2, allow_nan=False) + "\n")


def names(folder: Path) -> tuple[str, ...]:
    """What a draft will have put into its folder, by name."""
    return tuple(sorted(file.name for file in folder.iterdir()))


def bundle(
    folder: Folder,
    command: str,
    contents: Mapping[str, Any],
    drawn: Mapping[str, Figure] | None = None,
    *,
    film: Callable[[Path], None] | None = None,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write files that belong together into a folder, all of them or nothing.

    Args:
        folder: made if missing; what the same command wrote there before is replaced.
        command: whose results they are.
        contents: of each file by its name: text, a record for JSON, or what writes it where it
            is told to. The first record is that of the result.
        drawn: figures by name, each for a .png and a .svg.
        film: called with the draft folder, to add a video to it.
        progress: called with (done, total) files.
        force: replace files that others wrote or changed too.

    Returns:
        The names of the files.

    Raises:
        OverwriteError: a file there is not one that this command wrote; nothing has changed.
        OSError: the folder cannot be written.
    """
    record = next(one for one in contents.values() if isinstance(one, dict))
    drawn = drawn or {}
    with staged_folder(folder, command, record, force=force) as draft:
        steps = Steps(progress, len(contents) + 2 * len(drawn))
        for name, content in contents.items():
            if isinstance(content, str):
                write_atomic(draft / name, content)
            elif isinstance(content, dict):
                write_json(draft / name, content)
            else:
                content(draft / name)
            steps.next()
        save_figures(drawn, draft, steps)
        if film is not None:
            film(draft)
        return names(draft)


def netcdf(data: xarray.Dataset) -> Callable[[Path], None]:
    """What writes data as NetCDF."""
    return lambda file: write_netcdf(file, data)
