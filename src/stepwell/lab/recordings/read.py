"""Recordings from files: one that is broken says so and stops no other."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from stepwell.base import ByValue, content_of
from stepwell.lab.recordings.errors import LabError
from stepwell.lab.recordings.recording import Recording
from stepwell.lab.recordings.text import parse

SUFFIXES = (".txt", ".csv", ".tsv", ".raw")
# Tables about recordings, not recordings.
_NOT_DATA = re.compile(r"manifest|readme|licen[cs]e|requirements", re.IGNORECASE)


@dataclass(frozen=True, eq=False)
class Batch(ByValue):
    """What became of a number of files: every one of them is in one of the three.

    Attributes:
        recordings: what could be read, in the natural order of the names.
        refused: for each other file one line that says why.
        ignored: files of a folder that were not tried, having another ending or a name such as
            manifest or readme.
    """

    recordings: tuple[Recording, ...]
    refused: tuple[LabError, ...]
    ignored: tuple[str, ...] = ()

    def __repr__(self):
        return f"Batch({len(self.recordings)} recordings, {len(self.refused)} refused)"


def read(file: str | os.PathLike[str]) -> Recording:
    """One recording.

    Args:
        file: a Bluehill "Raw Data" export, or CSV whose header names columns and units.

    Returns:
        The recording, in SI.

    Raises:
        LabError: the file is missing, broken, binary, empty, or in a unit that is not known.
    """
    name = os.fspath(file)
    try:
        content = content_of(Path(file), "recording_bytes")
    except FileNotFoundError:
        raise LabError(name, "no such file.") from None
    except OSError as error:
        raise LabError(name, f"cannot be read: {error.strerror or error}.") from None
    return read_bytes(content, name)


def read_bytes(content: bytes, name: str) -> Recording:
    """One recording from the content of its file.

    Args:
        content: as for `read`.
        name: what the file is called; it is not opened.

    Returns:
        The recording, in SI.

    Raises:
        LabError: the content is broken, binary, empty, or in a unit that is not known.
    """
    try:
        export = parse(content)
    except ValueError as error:
        raise LabError(name, str(error)) from None
    sha256 = hashlib.sha256(content).hexdigest()
    return Recording(name, sha256=sha256, **export._asdict())


def read_all(
    files: Iterable[str | os.PathLike[str]],
    progress: Callable[[int, int], None] | None = None,
) -> Batch:
    """Recordings from files and folders, whatever some of them hold.

    Args:
        files: files, and folders in which .txt, .csv, .tsv and .raw files are looked for at any
            depth. A file that is named is always tried.
        progress: called with (done, total) files.

    Returns:
        The recordings, and a line for every file that is none.
    """
    found: list[Recording] = []
    refused: list[LabError] = []
    ignored: list[str] = []
    names = list(dict.fromkeys(name for f in files for name in _files(os.fspath(f), ignored)))
    for done, name in enumerate(names, 1):
        try:
            found.append(read(name))
        except LabError as error:
            refused.append(error)
        if progress is not None:
            progress(done, len(names))
    return Batch(tuple(found), tuple(refused), tuple(ignored))


def natural(name: str) -> tuple[tuple[int, str], ...]:
    """A key that sorts run_2 before run_10."""
    return tuple(
        (int(part), "") if part.isdecimal() and part.isascii() else (-1, part)
        for part in re.split(r"(\d{1,18})", name)
    )


def _files(name: str, ignored: list[str]) -> list[str]:
    if not os.path.isdir(name):
        return [name]
    wanted: list[str] = []
    for file in sorted((str(p) for p in Path(name).rglob("*") if p.is_file()), key=natural):
        path = Path(file)
        is_data = path.suffix.lower() in SUFFIXES and not _NOT_DATA.search(path.stem)
        (wanted if is_data else ignored).append(file)
    return wanted
