"""A report of an error that nothing expected, and the line that names it.

Nothing but Python's own modules is imported at once: the package that fails may be any.
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

# Reports that are kept, letters of the line, and bytes of a file that a report holds.
KEPT, _LETTERS, _BYTES = 20, 300, 1 << 20
# What only a checkout has, as the package's own record says it.
_OF_OURS = re.compile(r"extra == .(dev|docs)\b")
_SECRET = re.compile(r"(?<=://)[^/@\s]+(?=@)")


def leave(*_: object) -> None:
    """End the program at once, with a line: what Ctrl-C does until a command runs."""
    os.write(2, b"Interrupted before anything was done.\n")
    os._exit(130)


def reported(error: BaseException, arguments: list[str], design: str = "") -> str:
    """Write a report of an error into a file, and return the line that names it.

    Args:
        error: that ended a command.
        arguments: of the command, without its name.
        design: on which it worked, where no argument names its file.
    """
    words = " ".join(str(error).split())
    what = f"{type(error).__name__}: {words}" if words else type(error).__name__
    what = what if len(what) <= _LETTERS else what[: _LETTERS - 3] + "..."
    what = "".join(c if c.isprintable() else "?" for c in what)
    try:
        file = _kept("".join(_parts(error, arguments, design)))
    except OSError as why:
        return f"{what} (unexpected; and no report of it could be written: {why})"
    return f"{what} (unexpected). To report this error, attach {file}"


def _parts(error: BaseException, arguments: list[str], design: str) -> Iterator[str]:
    """The report, whose parts never keep each other from being written."""
    yield (
        "A report of an unexpected error of Stepwell: the command, settings that begin with\n"
        "STEPWELL_, versions, the trace, and the text files that the command names. Read it before "
        "you share it.\n"
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
            text = f"cannot be told: {type(why).__name__}: {why}"
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
    """The file of a report, beside the last ones."""
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
    """Where reports go: with this user's logs, or else with what is temporary."""
    try:
        import platformdirs

        yield platformdirs.user_log_path("stepwell")
    except Exception:  # whatever keeps platformdirs from being imported
        pass
    yield Path(tempfile.gettempdir()) / "stepwell"
