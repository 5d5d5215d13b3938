"""Writing a file so that an interruption leaves the old one or the new one, never a half."""

import errno
import os
import re
import secrets
import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from stepwell.base.errors import InputError, printable

if TYPE_CHECKING:
    import xarray


# memory://x, s3://x, file:///x; `Path` drops one of the strokes. One letter is a disk of Windows.
_ADDRESS = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+:[/\\]")


def refuse_address(path: str | os.PathLike[str]) -> None:
    """Raise ValueError for an address, as file:///x or s3://x, given as a local path."""
    if _ADDRESS.match(os.fspath(path)):
        raise InputError(
            f"{printable(os.fspath(path))}: is an address, but results are written to local files. "
            f"Give a path, such as results or /tmp/results."
        )


def write_atomic(path: str | os.PathLike[str], data: str | bytes) -> None:
    """Write a file atomically: a temporary file in the same folder, synced, then renamed.

    A link is followed, and an existing file keeps its permissions. Text is written as UTF-8 with
    its line ends unchanged.

    Raises:
        OSError: the folder is missing or cannot be written, or the disk is full. The error names
            `path`, and the file is unchanged.
        ValueError: `path` is an address.
    """
    refuse_address(path)
    target = Path(os.path.realpath(path))
    content = data.encode("utf-8") if isinstance(data, str) else data
    if not target.parent.is_dir():
        why = f"there is no folder {Path(path).parent}: make it, or name another place"
        raise FileNotFoundError(errno.ENOENT, why, os.fspath(path))
    draft = draft_beside(target)
    try:
        with naming(draft, Path(path)):
            # os.open, not tempfile: the new file gets the permissions any other new file gets.
            # O_BINARY: without it Windows would turn every line end into two characters.
            flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
            with open(os.open(draft, flags, 0o666), "wb") as file:
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


def write_netcdf(path: str | os.PathLike[str], data: "xarray.Dataset") -> None:
    """Write data as NetCDF, atomically."""
    write_atomic(path, bytes(data.to_netcdf(engine="scipy")))


def csv_text(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A table as CSV; commas, quotes and line ends within a cell are quoted."""
    # csv.writer leaves a bare carriage return unquoted where lines end in a line feed.
    return "".join(",".join(map(_quoted, row)) + "\n" for row in (head, *rows))


def _quoted(cell: str) -> str:
    return '"' + cell.replace('"', '""') + '"' if set(cell) & set(',"\r\n') else cell


def draft_beside(target: Path) -> Path:
    """An unused hidden name in the same folder."""
    return target.with_name(f".{target.name[:80]}.{secrets.token_hex(6)}.tmp")


@contextmanager
def naming(draft: Path, target: Path) -> Iterator[None]:
    """Let errors name the target file instead of its draft, and always name a file."""
    try:
        yield
    except OSError as error:
        if error.errno is None:
            raise
        known = isinstance(error.filename, str | bytes)
        given = Path(os.fsdecode(error.filename)) if known else draft
        name = target / given.relative_to(draft) if given.is_relative_to(draft) else given
        raise type(error)(error.errno, error.strerror, str(name)) from None


def sync_folder(folder: Path) -> None:
    """Sync the folder's entries to disk, so that a rename survives a power cut."""
    # Windows has no such call, and some network folders refuse it; then only the file is synced.
    if not hasattr(os, "O_DIRECTORY"):
        return
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        with suppress(OSError):
            os.fsync(handle)
    finally:
        os.close(handle)
