"""Compiled kernels on disk: each in a file that is whole and unchanged, or not used."""

import atexit
import hashlib
import os
import shutil
import sys
import tempfile
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import NamedTuple

import platformdirs

from stepwell.base import write_atomic

_MARK = b"a compiled kernel of Stepwell\n"
_DIGEST = 32
# Versions of one kernel that are kept: other signatures, other processors, the last few edits.
_KEPT = 12


def say(line: str) -> None:
    """One line to whoever runs the program."""
    with suppress(OSError, ValueError, AttributeError):
        sys.stderr.write(f"stepwell: {line}\n")
        sys.stderr.flush()


_GIVEN: list[Path] = []


def keep_in(place: Path) -> None:
    """Keep compiled kernels in this folder, which exists."""
    _GIVEN[:] = [place]
    folder.cache_clear()


@cache
def folder() -> Path | None:
    """Where compiled kernels are kept; a private temporary folder, or None, where nowhere can.

    The folder that NUMBA_CACHE_DIR names, or else the user's own folder for what can be made
    again. Made for the user alone: what is in it will be run.
    """
    if _GIVEN:
        return _GIVEN[0]
    wanted = _wanted()
    try:
        if not os.environ.get("NUMBA_CACHE_DIR") and not wanted.is_absolute():
            raise OSError("there is no home folder")
        wanted.mkdir(0o700, parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=wanted):
            return wanted
    except OSError as error:
        reason = error.strerror or error
    advice = "name a folder that can with NUMBA_CACHE_DIR."
    try:
        private = Path(tempfile.mkdtemp(prefix="stepwell-"))
    except OSError:
        say(f"{wanted} cannot be written ({reason}): no compiled kernels are kept; {advice}")
        return None
    atexit.register(shutil.rmtree, private, ignore_errors=True)
    say(f"{wanted} cannot be written ({reason}): compiled kernels are kept for this run; {advice}")
    return private


class Kept(NamedTuple):
    """What is kept of compiled kernels [bytes], of this version or an earlier one, and where.

    The folder is where they would be if it is not `writable`.
    """

    folder: Path
    writable: bool
    compiled: int
    size: int


def kept() -> Kept:
    """What is kept of compiled kernels now."""
    place = _GIVEN[0] if _GIVEN else _wanted()
    files = [*place.glob("*.kernel")] if place.is_dir() else []
    names = {file.name.partition("-")[0] for file in files}
    return Kept(place, folder() == place, len(names), sum(file.stat().st_size for file in files))


def _wanted() -> Path:
    named = os.environ.get("NUMBA_CACHE_DIR")
    return Path(named) / "stepwell" if named else platformdirs.user_cache_path("stepwell")


def holds(name: str) -> bool:
    """Whether there is a file of this kernel, for any kind of arguments."""
    place = folder()
    return place is not None and any(place.glob(f"{name}-*.kernel"))


def read(name: str) -> bytes | None:
    """What was kept under a name; None where nothing was, or no longer what was written."""
    place = folder()
    if place is None:
        return None
    path = place / f"{name}.kernel"
    try:
        data = path.read_bytes()
    except OSError:
        return None
    start = len(_MARK) + _DIGEST
    payload = data[start:]
    if data[:start] == _MARK + hashlib.sha256(payload).digest():
        return payload
    with suppress(OSError):
        path.unlink()
    say(f"the compiled kernel {path} is damaged; it is made again.")
    return None


def write(name: str, payload: bytes) -> None:
    """Keep bytes under a name, whole or not at all."""
    place = folder()
    if place is None:
        return
    try:
        data = _MARK + hashlib.sha256(payload).digest() + payload
        write_atomic(place / f"{name}.kernel", data)
        _forget_old(place, name.split("-")[0])
    except OSError as error:
        say(f"compiled kernels cannot be kept in {place} ({error.strerror or error}).")


def _forget_old(place: Path, kernel: str) -> None:
    kept = sorted(place.glob(f"{kernel}-*.kernel"), key=lambda path: path.stat().st_mtime)
    for path in kept[:-_KEPT]:
        with suppress(OSError):
            path.unlink()
