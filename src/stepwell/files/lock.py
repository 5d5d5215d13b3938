"""One writer at a time: a lock on the place where results go, which ends with its process."""

from __future__ import annotations

import errno
import logging
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from stepwell.base import StepwellError

if TYPE_CHECKING:
    from filelock import BaseFileLock

# How long a command waits for another one [s], and after how long it reports that it waits [s].
PATIENCE, _QUIET = 300.0, 0.5
# What file systems without locks answer, such as some network folders.
_NO_LOCKS = {errno.ENOLCK, errno.ENOSYS, errno.ENOTSUP, errno.EOPNOTSUPP, errno.EINVAL}


class BusyError(StepwellError, TimeoutError):
    """Another process has been writing there for too long; nothing was written."""


@contextmanager
def only_writer(file: Path, shown: str, patience: float = PATIENCE) -> Iterator[None]:
    """Hold a lock while the block runs; wait for the process that holds it.

    A process that dies gives its lock back. The file vanishes with the lock.

    Args:
        file: the lock, the same for all who write to one place; its folder is there.
        shown: what is written, for messages.
        patience: how long to wait at most [s].

    Raises:
        BusyError: another process held the lock for so long.
        OSError: the file cannot be made.
    """
    from filelock import Timeout

    try:
        try:
            lock = _locked(file, min(_QUIET, patience))
        except Timeout:
            if patience > _QUIET:
                logging.getLogger("stepwell").warning(
                    "%s: another stepwell command writes here. Waiting for it, %.0f s at most.",
                    shown,
                    patience,
                )
            lock = _locked(file, max(patience - _QUIET, 0.0))
    except Timeout as error:
        raise BusyError(
            f"{shown}: another stepwell command has been writing here for {patience:.0f} s. Wait "
            f"until it ends, or name another place. If no command runs, remove {error.lock_file}."
        ) from None
    try:
        yield
    finally:
        # Before it is given back: whoever waits for a file that is gone opens a new one. Windows
        # keeps open files, and there the lock removes its own.
        try:
            with suppress(OSError):
                os.unlink(lock.lock_file)
        finally:
            lock.release()


def _locked(file: Path, timeout: float) -> BaseFileLock:
    """A lock that the system holds, or, where it has none, one that the file's being there is."""
    from filelock import FileLock, SoftFileLock, Timeout

    try:
        lock = FileLock(file, fallback_to_soft=False)
        lock.acquire(timeout)
    except Timeout:
        raise
    except (OSError, NotImplementedError) as error:
        if isinstance(error, OSError) and error.errno not in _NO_LOCKS:
            raise
        file.unlink(missing_ok=True)
        lock = SoftFileLock(f"{file}ed")
        lock.acquire(timeout)
    return lock
