"""Writing a file so that an interruption leaves the old one or the new one, never a half."""

from __future__ import annotations

import os
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


def write_atomic(path: str | os.PathLike[str], data: str | bytes) -> None:
    """Write a file whole or not at all: a new name beside it, synced, then renamed over it.

    Args:
        path: where to; a link is followed, an existing file keeps its permissions.
        data: bytes, or text that is written as UTF-8 with the line ends it has.

    Raises:
        OSError: the folder is missing or cannot be written; nothing has changed then.
    """
    target = Path(os.path.realpath(path))
    content = data.encode("utf-8") if isinstance(data, str) else data
    draft = draft_beside(target)
    try:
        # os.open, not tempfile: the new file gets the permissions any other new file gets.
        with told_of(target):
            handle = os.open(draft, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)
        with open(handle, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        with suppress(FileNotFoundError):
            shutil.copymode(target, draft)
        os.replace(draft, target)
    except BaseException:
        draft.unlink(missing_ok=True)
        raise
    sync_folder(target.parent)


def draft_beside(target: Path) -> Path:
    """A hidden name in the same folder that nothing else uses."""
    return target.with_name(f".{target.name[:80]}.{secrets.token_hex(6)}.tmp")


@contextmanager
def told_of(target: Path) -> Iterator[None]:
    """Errors name the file the user asked for, not its draft."""
    try:
        yield
    except OSError as error:
        raise type(error)(error.errno, error.strerror, str(target)) from None


def sync_folder(folder: Path) -> None:
    """Bring the folder's names to the disk: only then does a rename survive a power cut."""
    # Windows has no such call, and some network folders refuse it: there the file alone is synced.
    if not hasattr(os, "O_DIRECTORY"):
        return
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        with suppress(OSError):
            os.fsync(handle)
    finally:
        os.close(handle)
