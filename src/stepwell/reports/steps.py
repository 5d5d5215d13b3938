"""Writing a folder of results, its files counted for a progress bar."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from stepwell.base import write_atomic, write_netcdf
from stepwell.files import staged_folder

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

Folder = str | os.PathLike[str]
Progress = Callable[[int, int], None]

# The width of figures that fill a phone [mm].
PHONE = 85.0


def bundle(
    folder: Folder,
    command: str,
    contents: Mapping[str, Any],
    drawn: Mapping[str, Figure] | None = None,
    *,
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
        progress: called with (done, total) files.
        force: replace files that others wrote or changed too.

    Returns:
        The names of the files.

    Raises:
        OverwriteError: a file there is not one that this command wrote; nothing has changed.
        OSError: the folder cannot be written.
    """
    record = next(one for one in contents.values() if isinstance(one, dict))
    files = dict(contents)
    for name, figure in (drawn or {}).items():
        from stepwell import figures

        files |= {f"{name}{suffix}": partial(figures.save, figure) for suffix in (".png", ".svg")}
    with staged_folder(folder, command, record, force=force) as draft:
        for done, (name, content) in enumerate(files.items(), 1):
            if isinstance(content, dict):
                content = json.dumps(content, indent=2, allow_nan=False) + "\n"
            if isinstance(content, str):
                write_atomic(draft / name, content)
            else:
                content(draft / name)
            if progress is not None:
                progress(done, len(files))
        return tuple(sorted(file.name for file in draft.iterdir()))


def netcdf(data: xarray.Dataset) -> Callable[[Path], None]:
    """What writes data as NetCDF."""
    return lambda file: write_netcdf(file, data)


def narrow(draw: Callable[[], Figure]) -> Figure:
    """A figure as it fills a phone."""
    from stepwell import figures

    return figures.compose([draw], width=PHONE)


class Pictures(NamedTuple):
    """Figures by name, and those of a page by caption: on a wide window and on a phone."""

    files: dict[str, Figure]
    wide: dict[str, Figure]
    narrow: dict[str, Figure]


def pictured(draws: Mapping[str, Callable[[], Figure]], captions: Mapping[str, str]) -> Pictures:
    """What these functions draw, each by its name, for a folder and for its page."""
    files = {name: draw() for name, draw in draws.items()}
    wider = [name for name, one in files.items() if 25.4 * one.get_size_inches()[0] > PHONE + 1.0]
    return Pictures(
        files,
        {captions[name]: figure for name, figure in files.items()},
        {captions[name]: narrow(draws[name]) for name in wider},
    )
