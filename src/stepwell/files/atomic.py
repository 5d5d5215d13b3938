"""Writing results so that a reader never meets half of one, whatever interrupts the writer."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from stepwell._write import draft_beside, sync_folder, told_of, write_atomic

__all__ = ["staged_folder", "write_atomic"]


@contextmanager
def staged_folder(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A draft folder beside `path`; its files move there when the block ends without error.

    Other files that `path` already holds stay as they are.

    Raises:
        OSError: `path` is no folder, or its parent cannot be written.
    """
    target = Path(os.path.realpath(path))
    if target.exists() and not target.is_dir():
        raise NotADirectoryError(f"{path} is a file: give a folder to write into.")
    target.parent.mkdir(parents=True, exist_ok=True)
    draft = draft_beside(target)
    with told_of(target):
        draft.mkdir()
    try:
        yield draft
        for file in sorted(draft.rglob("*")):
            if file.is_file():
                _move(file, target / file.relative_to(draft))
    finally:
        shutil.rmtree(draft, ignore_errors=True)


def _move(file: Path, place: Path) -> None:
    with open(file, "rb+") as handle:
        os.fsync(handle.fileno())
    place.parent.mkdir(parents=True, exist_ok=True)
    os.replace(file, place)
    sync_folder(place.parent)
