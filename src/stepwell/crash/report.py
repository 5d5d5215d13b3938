"""Report file of an unexpected error, and the line that names it.

Only the standard library is imported at once, since any package may be the one that fails.
"""

import os
import platform
import re
import shlex
import sys
import tempfile
import time
import traceback
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

# Number of reports kept, characters of the line, and bytes of a file copied into a report.
KEPT, _LETTERS, _BYTES = 20, 300, 1 << 20
# Extras that only a checkout has, as in the package's metadata.
_OF_OURS = re.compile(r"extra == .(dev|docs)\b")
_SECRET = re.compile(r"(?<=://)[^/@\s]+(?=@)")


def leave(*_: object) -> None:
    """End the program at once, with a line: the action of Ctrl-C until a command runs."""
    os.write(2, b"Interrupted before anything was done.\n")
    os._exit(130)


def reported(error: BaseException, arguments: list[str], design: str = "") -> str:
    """Write a report of an error into a file, and return the line that names it.

    Args:
        error: the one that ended a command.
        arguments: of the command, without its name.
        design: the text of its design, if no argument names the file.
    """
    words = " ".join(str(error).split())
    what = f"{type(error).__name__}: {words}" if words else type(error).__name__
    what = what if len(what) <= _LETTERS else what[: _LETTERS - 3] + "..."
    what = "".join(c if c.isprintable() else "?" for c in what)
    try:
        file = _kept("".join(_parts(error, arguments, design)))
    except OSError as why:
        return f"{what} (unexpected; no report could be written: {why})"
    return f"{what} (unexpected). To report this error, attach {file}"


def _parts(error: BaseException, arguments: list[str], design: str) -> Iterator[str]:
    """The parts of the report; an error in one part does not prevent the others."""
    yield (
        "A report of an unexpected error of Stepwell: the command, settings that begin with\n"
        "STEPWELL_, versions, the trace, and the text files in the arguments. Read it before you "
        "share it.\n"
    )
    for head, find in {
        "Command": lambda: _SECRET.sub("...", shlex.join(["stepwell", *arguments])),
        "Settings": lambda: "\n".join(
            f"{name}={_SECRET.sub('...', value)}"
            for name, value in sorted(os.environ.items())
            if name.startswith("STEPWELL_")
        ),
        "Versions": _versions,
        "Trace": lambda: _SECRET.sub("...", "".join(traceback.format_exception(error))),
        **({"Design": lambda: design} if design else {}),
        **{f"File {name}": (lambda name=name: _text(name)) for name in _named(arguments)},
    }.items():
        try:
            text = find()
        except Exception as why:
            text = f"not available: {type(why).__name__}: {why}"
        yield f"\n== {head}\n{text.rstrip()}\n"


def _versions() -> str:
    needed = [one for one in metadata.requires("stepwell") or [] if not _OF_OURS.search(one)]
    names = {re.split(r"[^\w.-]", text, maxsplit=1)[0] for text in needed}
    lines = [f"Python {sys.version}", f"System {platform.platform()}"]
    for name in ["stepwell", *sorted(names - {"stepwell"})]:
        try:
            lines.append(f"{name} {metadata.version(name)}")
        except metadata.PackageNotFoundError:
            continue
    return "\n".join(lines)


def _named(arguments: list[str]) -> list[str]:
    """Design files among the arguments."""
    return [one for one in dict.fromkeys(arguments) if one.endswith((".toml", ".txt", ".csv"))]


def _text(name: str) -> str:
    with open(name, "rb") as file:
        return file.read(_BYTES).decode("utf-8", "replace")


def _kept(text: str) -> Path:
    """Write a report to a new file, delete the oldest reports, and return the path."""
    name = f"stepwell-{time.strftime('%Y%m%d-%H%M%S')}-{os.getpid()}.txt"
    failed = OSError("no folder to write into")
    for folder in _folders():
        try:
            folder.mkdir(0o700, parents=True, exist_ok=True)
            with open(os.open(folder / name, os.O_WRONLY | os.O_CREAT, 0o600), "wb") as file:
                file.write(text.encode("utf-8", "backslashreplace"))
            for old in sorted(folder.glob("stepwell-*-*-*.txt"))[:-KEPT]:
                old.unlink(missing_ok=True)
            return folder / name
        except OSError as error:
            failed = error
    raise failed


def _folders() -> Iterator[Path]:
    """Folders for reports: the user's log folder, else the temporary folder."""
    try:
        import platformdirs

        yield platformdirs.user_log_path("stepwell")
    except Exception:  # platformdirs may be missing or broken
        pass
    yield Path(tempfile.gettempdir()) / "stepwell"
