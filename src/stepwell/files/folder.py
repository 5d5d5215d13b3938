"""Folders of results: consistent files of one run, with one writer at a time."""

from __future__ import annotations

import errno
import hashlib
import json
import logging
import os
import re
import shutil
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, NamedTuple

from stepwell import base
from stepwell.files.outputs import OUTPUTS

if TYPE_CHECKING:
    from filelock import BaseFileLock


# Longest wait for another command [s], and time after which the wait is reported [s].
PATIENCE, _QUIET = 300.0, 0.5
# Errors of file systems without locks, such as some network folders.
_NO_LOCKS = {errno.ENOLCK, errno.ENOSYS, errno.ENOTSUP, errno.EOPNOTSUPP, errno.EINVAL}


class BusyError(base.StepwellError, TimeoutError):
    """Another process holds the lock of the target for too long; nothing was written."""


@contextmanager
def only_writer(file: Path, shown: str, patience: float = PATIENCE) -> Iterator[None]:
    """Hold a lock while the block runs; raise BusyError after `patience` [s].

    The lock of a process that ends is released. The lock file is removed with the lock. `shown` is
    the name of the target in messages.
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
        # Removed before the release: a process that waits for a removed file opens a new one.
        # Windows does not remove open files; there the lock removes its file.
        try:
            with suppress(OSError):
                os.unlink(lock.lock_file)
        finally:
            lock.release()


def _locked(file: Path, timeout: float) -> BaseFileLock:
    """A lock of the operating system; without these, the file itself is the lock."""
    from filelock import FileLock, SoftFileLock, Timeout

    try:
        lock = FileLock(file, fallback_to_soft=False)
        lock.acquire(timeout)
    except (OSError, NotImplementedError) as error:
        failed = isinstance(error, OSError) and error.errno not in _NO_LOCKS
        if failed or isinstance(error, Timeout):
            raise
        file.unlink(missing_ok=True)
        lock = SoftFileLock(f"{file}ed")
        lock.acquire(timeout)
    return lock


FOLDER_SCHEMA = "stepwell.folder/1"
# Manifest of a complete folder, and of one whose files are being replaced.
MANIFEST, UNFINISHED = "stepwell.json", "stepwell.unfinished.json"
# Stem of the names of drafts and lock in an existing folder.
_INSIDE = "stepwell"
_MOST_BYTES, _MOST_NAMED = 1 << 20, 6


class OverwriteError(base.StepwellError, FileExistsError):
    """Files of others exist at the target of the results; nothing was written."""


class IncompleteError(base.InputError):
    """The folder does not contain one complete set of results."""


@dataclass(frozen=True, slots=True)
class _Note:
    """Content of a manifest: the command, and possible hashes of its files by name."""

    command: str
    files: Mapping[str, tuple[str, ...]]


def digest(data: str | bytes) -> str:
    """SHA-256 of bytes, or of text as UTF-8, in the format of `sha256sum`."""
    return hashlib.sha256(data.encode("utf-8") if isinstance(data, str) else data).hexdigest()


def manifest(folder: str | os.PathLike[str]) -> dict[str, Any]:
    """Manifest of a complete folder of results, in the format of docs/commands/common.md.

    Returns:
        `command`, `design_sha256`, `seed`, and the SHA-256 of every file.

    Raises:
        IncompleteError: a run was stopped while it replaced the files, or a file is missing or
            was changed.
    """
    place, shown = Path(folder), base.printable(str(folder))
    note = _note(place / MANIFEST)
    if note is None:
        why = _interrupted(place) or "contains no complete results of Stepwell"
        raise IncompleteError(f"{shown}: {why}.")
    for name, hashes in note.files.items():
        if _digest_of(place / name) not in hashes:
            what = "was changed after it was written" if (place / name).exists() else "is missing"
            raise IncompleteError(f"{shown}: {base.printable(name)} {what}.")
    return json.loads((place / MANIFEST).read_text("utf-8"))


def mixed_results(file: Path) -> str | None:
    """Reason why a file must not be read: its folder may mix two results; else None."""
    whole, note = (_note(file.parent / name) for name in (MANIFEST, UNFINISHED))
    # A file common to both results may be read, so the stopped run can be repeated on the design in
    # its own folder.
    mixed = whole is None and note is not None and len(note.files.get(file.name, ())) > 1
    return _interrupted(file.parent) if mixed else None


def check_folder(
    folder: str | os.PathLike[str],
    command: str,
    *,
    names: Iterable[str] | None = None,
    force: bool = False,
    texts: Mapping[str, str] | None = None,
) -> None:
    """Raise an error before a computation if its results cannot be written into a folder.

    Args:
        folder: it may be missing.
        command: the command with these results, such as "run".
        names: of the files that may be written; those of OUTPUTS by default.
        force: replace files of others.
        texts: of files with known content; an existing equal file is no obstacle.

    Raises:
        OverwriteError: a file there was not written by this command and differs from its result,
            or the folder contains results of another command.
        OSError: `folder` is no folder, or cannot be made or written.
    """
    request = _write_request(folder, command, names, force)
    hashes = {name: digest(text) for name, text in (texts or {}).items()}
    _check(request, dict.fromkeys(request.known, "") | hashes)
    with _naming_folder_errors(request.shown):
        place = next(one for one in (request.target, *request.target.parents) if one.exists())
        trial = base.draft_beside(place / "stepwell")
        trial.mkdir()
        with suppress(FileNotFoundError):  # another command may have removed all drafts
            trial.rmdir()


@contextmanager
def staged_folder(
    folder: str | os.PathLike[str],
    command: str,
    record: Mapping[str, Any] | None = None,
    *,
    names: Iterable[str] | None = None,
    force: bool = False,
) -> Iterator[Path]:
    """A draft folder whose files are moved into `folder` when the block ends without error.

    They appear together with the manifest, `stepwell.json`. Files of an earlier result of the same
    command are replaced, or removed if there is no new file; other files are kept. One process at
    a time writes into a folder; the next one waits.

    Args:
        folder: made if missing.
        command: the command with these results, such as "run".
        record: of the result, for its `design_sha256` and `seed`.
        names: of the files that may be written; those of OUTPUTS by default.
        force: replace files of others, changed files, and results of other commands.

    Raises:
        OverwriteError: as for `check_folder`; nothing has changed.
        BusyError: another process has been writing into the folder for too long.
        OSError: `folder` is no folder, or cannot be made or written.
    """
    request = _write_request(folder, command, names, force)
    shown, target = request.shown, request.target
    _check(request, {})
    with _naming_folder_errors(shown):
        target.parent.mkdir(parents=True, exist_ok=True)
    with _only_writer(shown, target) as place:
        draft = base.draft_beside(place)
        with _naming_folder_errors(shown):
            draft.mkdir()
        try:
            with base.naming(draft, target):
                yield draft
                with ExitStack() as also:
                    if place != _place(target):
                        # Another process made the folder meanwhile, so the lock is now inside.
                        also.enter_context(_only_writer(shown, target))
                    _commit(request, draft, record or {})
        finally:
            shutil.rmtree(draft, ignore_errors=True)
    _remove_leftovers(target)


@contextmanager
def _only_writer(shown: str, target: Path) -> Iterator[Path]:
    """Hold the lock of a folder; yields the path from which names of drafts follow."""
    while True:
        place = _place(target)
        with ExitStack() as held:
            with _naming_folder_errors(shown):
                held.enter_context(only_writer(_lock(place), shown))
            if place == _place(target):
                yield place
                return


def _place(target: Path) -> Path:
    """Path from which location and names of drafts and lock follow."""
    # A missing folder is renamed in one step from a draft next to it. An existing folder may be a
    # separate file system, so its drafts are inside it.
    return target / _INSIDE if target.exists() else target


def _lock(place: Path) -> Path:
    return place.with_name(f".{place.name[:80]}.lock")


class _WriteRequest(NamedTuple):
    shown: str
    target: Path
    command: str
    known: frozenset[str]
    force: bool


def _write_request(
    folder: str | os.PathLike[str], command: str, names: Iterable[str] | None, force: bool
) -> _WriteRequest:
    base.refuse_address(folder)
    known = frozenset(OUTPUTS[command] if names is None else names)
    shown, target = base.printable(os.fspath(folder)), Path(os.path.realpath(folder))
    return _WriteRequest(shown, target, command, known, force)


def _commit(request: _WriteRequest, draft: Path, record: Mapping[str, Any]) -> None:
    """Move a draft to its target; after an interruption `manifest` reports the state."""
    shown, target, command, known, _ = request
    if not draft.is_dir():
        raise OSError(f"{shown}: its draft was removed during the writing: run the command again.")
    files = sorted(filter(Path.is_file, draft.rglob("*")))
    new = {file.relative_to(draft).as_posix(): _synced_digest(file) for file in files}
    if not new.keys() <= known:
        raise AssertionError(f"not in OUTPUTS[{command!r}]: {sorted(new.keys() - known)}")
    _check(request, new)
    about = {
        "schema": FOLDER_SCHEMA,
        "stepwell": base.__version__,
        "command": command,
        "design_sha256": record.get("design_sha256"),
        "seed": record.get("seed"),
    }
    mine = {name for name in new if not _was_there_unchanged(target, name, new[name])}
    _write(draft / MANIFEST, about, {name: new[name] for name in sorted(mine)})
    if not target.exists():
        os.rename(draft, target)
        base.sync_folder(target.parent)
        return
    old = _hashes(target)
    may_be = {
        name: {*old.get(name, ()), *([new[name]] if name in mine else [])}
        for name in old.keys() | mine
    }
    _write(draft / UNFINISHED, about, {name: sorted(may_be[name]) for name in sorted(may_be)})
    os.replace(draft / UNFINISHED, target / UNFINISHED)
    base.sync_folder(target)
    (target / MANIFEST).unlink(missing_ok=True)
    base.sync_folder(target)
    for name in sorted(mine):
        place = target / name
        place.parent.mkdir(parents=True, exist_ok=True)
        os.replace(draft / name, place)
        base.sync_folder(place.parent)
    for name in sorted(old.keys() - new.keys()):
        if _digest_of(target / name) in old[name]:
            (target / name).unlink()
    base.sync_folder(target)
    os.replace(draft / MANIFEST, target / MANIFEST)
    base.sync_folder(target)
    (target / UNFINISHED).unlink()


def _check(request: _WriteRequest, new: Mapping[str, str | None]) -> None:
    """Raise an error if files of others would be lost; `new` has a hash of each file, or ""."""
    shown, target, command, _, force = request
    if target.exists() and not target.is_dir():
        raise NotADirectoryError(f"{shown} is a file: give a folder for the results.")
    for name in (*new, MANIFEST, UNFINISHED):
        if (target / name).is_dir():
            raise OverwriteError(f"{shown}: {name} is a folder: move it to another place.")
    if force:
        return
    notes = [note for name in (MANIFEST, UNFINISHED) if (note := _note(target / name))]
    if notes and notes[0].command != command:
        holds = f"contains results of `stepwell {notes[0].command}`"
        way = "Name another folder, or replace them with --force (in Python force=True)."
        raise OverwriteError(f"{shown}: {holds}. A folder is for one command's results. {way}")
    if theirs := _foreign_files(target, new):
        named = base.join_first(list(map(base.printable, theirs)), _MOST_NAMED)
        it = "it" if len(theirs) == 1 else "them"
        raise OverwriteError(
            f"{shown}: `stepwell {command}` did not write {named} with this content, so "
            f"nothing is replaced. Name another folder, move {it} away, or "
            f"replace {it} with --force (in Python force=True)."
        )


def _foreign_files(target: Path, new: Mapping[str, str | None]) -> list[str]:
    """Names of existing files that Stepwell did not write, or that were changed."""
    owned = _hashes(target)
    changed = [
        name
        for name in new
        if os.path.lexists(target / name)
        and _digest_of(target / name) not in (*owned.get(name, ()), new[name])
    ]
    return changed + [
        name
        for name in (MANIFEST, UNFINISHED)
        if os.path.lexists(target / name) and _note(target / name) is None
    ]


def _was_there_unchanged(target: Path, name: str, content: str | None) -> bool:
    """Whether a file of others has the content to write; it is then kept and never removed."""
    there = _digest_of(target / name)
    return there is not None and there == content and there not in _hashes(target).get(name, ())


def _hashes(target: Path) -> dict[str, tuple[str, ...]]:
    """Possible hashes of the files that Stepwell wrote into a folder, by name."""
    notes = [_note(target / name) for name in (MANIFEST, UNFINISHED)]
    recorded = [note.files for note in notes if note]
    return {
        file: sum((one.get(file, ()) for one in recorded), ()) for one in recorded for file in one
    }


def _note(file: Path) -> _Note | None:
    """Content of a manifest; None if the file is no manifest of Stepwell."""
    try:
        if file.is_symlink() or file.stat().st_size > _MOST_BYTES:
            return None
        data = json.loads(file.read_text("utf-8"))
        if data["schema"] != FOLDER_SCHEMA or not isinstance(data["command"], str):
            return None
        files = {
            name: (hashes,) if isinstance(hashes, str) else tuple(map(str, hashes))
            for name, hashes in data["files"].items()
        }
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return None
    # Files are removed by these names, so none may point outside the folder.
    return _Note(base.printable(data["command"]), files) if all(map(_is_inside, files)) else None


def _is_inside(name: str) -> bool:
    path = PurePosixPath(name)
    odd = {*"\\:\0"} & {*name} or ".." in path.parts or path.is_absolute()
    return bool(path.parts) and not odd


def _digest_of(file: Path) -> str | None:
    if file.is_symlink() or not file.is_file():
        return None
    with open(file, "rb") as handle:
        return hashlib.file_digest(handle, "sha256").hexdigest()


def _synced_digest(file: Path) -> str:
    with open(file, "rb+") as handle:
        os.fsync(handle.fileno())
    return digest(file.read_bytes())


def _interrupted(folder: Path) -> str | None:
    note = _note(folder / UNFINISHED)
    return note and (
        f"is incomplete: `stepwell {note.command}` was stopped while it replaced the files, so "
        f"the folder may mix two results. Run the command again, or remove the folder"
    )


def _write(file: Path, about: Mapping[str, Any], hashes: Mapping[str, str | list[str]]) -> None:
    record = {**about, "files": hashes}
    base.write_atomic(file, json.dumps(record, indent=2, ensure_ascii=False) + "\n")


@contextmanager
def _naming_folder_errors(shown: str) -> Iterator[None]:
    """Add advice to an OSError about a folder."""
    try:
        yield
    except OSError as error:
        if isinstance(error, base.StepwellError):
            raise
        why = f"cannot be made or written ({error.strerror}): name a folder where you may write"
        raise type(error)(error.errno, why, shown) from None


def _remove_leftovers(target: Path) -> None:
    """Remove drafts and locks of interrupted commands."""
    for place in (target / _INSIDE, target):
        with suppress(OSError):
            if _leftover_drafts(place) or _lock(place).exists():
                with only_writer(_lock(place), str(target), 0.0):
                    for draft in _leftover_drafts(place):
                        shutil.rmtree(draft, ignore_errors=True)


def _leftover_drafts(place: Path) -> list[Path]:
    """Existing drafts; a draft of a running process exists only while it holds the lock."""
    draft = re.compile(rf"\.{re.escape(place.name[:80])}\.[0-9a-f]{{12}}\.tmp")
    return [
        draft_folder
        for draft_folder in place.parent.iterdir()
        if draft.fullmatch(draft_folder.name)
        and draft_folder.is_dir()
        and not draft_folder.is_symlink()
    ]
