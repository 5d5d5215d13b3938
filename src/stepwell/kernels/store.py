"""Store of compiled kernels on disk; incomplete or changed files are not used."""

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
# Stored versions of one kernel: other signatures, other processors, the last few edits.
_KEPT = 12


def notice(line: str) -> None:
    """Print one line to standard error."""
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
    """Folder of compiled kernels; a private temporary folder, or None, if it is not writable.

    It is the folder that NUMBA_CACHE_DIR names, or else the user's cache folder. Only the user can
    access it, because its contents are executed.
    """
    if _GIVEN:
        return _GIVEN[0]
    wanted = _intended_folder()
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
        notice(f"{wanted} cannot be written ({reason}): no compiled kernels are kept; {advice}")
        return None
    atexit.register(shutil.rmtree, private, ignore_errors=True)
    notice(
        f"{wanted} cannot be written ({reason}): compiled kernels are kept for this run; {advice}"
    )
    return private


class Kept(NamedTuple):
    """Number and size [bytes] of the stored kernels, earlier versions included, and their folder.

    If it is not `writable`, the folder is the intended one.
    """

    folder: Path
    writable: bool
    compiled: int
    size: int


def kept() -> Kept:
    """The present contents of the store."""
    place = _GIVEN[0] if _GIVEN else _intended_folder()
    files = [*place.glob("*.kernel")] if place.is_dir() else []
    names = {file.name.partition("-")[0] for file in files}
    return Kept(place, folder() == place, len(names), sum(file.stat().st_size for file in files))


def _intended_folder() -> Path:
    named = os.environ.get("NUMBA_CACHE_DIR")
    return Path(named) / "stepwell" if named else platformdirs.user_cache_path("stepwell")


def holds(name: str) -> bool:
    """Whether there is a file of this kernel, for any kind of arguments."""
    place = folder()
    return place is not None and any(place.glob(f"{name}-*.kernel"))


def read(name: str) -> bytes | None:
    """The bytes stored under a name; None if there are none or they are damaged."""
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
    notice(f"the compiled kernel {path} is damaged; it is made again.")
    return None


def write(name: str, payload: bytes) -> None:
    """Store bytes under a name, atomically."""
    place = folder()
    if place is None:
        return
    try:
        data = _MARK + hashlib.sha256(payload).digest() + payload
        write_atomic(place / f"{name}.kernel", data)
        _forget_old(place, name.split("-")[0])
    except OSError as error:
        notice(f"compiled kernels cannot be kept in {place} ({error.strerror or error}).")


def _forget_old(place: Path, kernel: str) -> None:
    versions = sorted(place.glob(f"{kernel}-*.kernel"), key=lambda path: path.stat().st_mtime)
    for path in versions[:-_KEPT]:
        with suppress(OSError):
            path.unlink()
