"""How results look on the screen: plain where the reader is a program."""

import errno
import json
import os
import sys
from collections.abc import Iterable, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from stepwell.accounts import Account, Line, escaped, folded, heading, paragraph, table, terminal
from stepwell.cli.screen.progress import WRITING, progress


def styled() -> bool:
    """Whether boxes and colours are welcome: at a terminal, unless NO_COLOR is set."""
    return at_terminal() and not os.environ.get("NO_COLOR")


def at_terminal() -> bool:
    """Whether somebody reads what is shown as it comes."""
    return sys.stdout is not None and sys.stdout.isatty()


def has_display() -> bool:
    """Whether windows can open; elsewhere than on Linux one has to try."""
    screens = ("DISPLAY", "WAYLAND_DISPLAY")
    return sys.platform != "linux" or any(os.environ.get(name) for name in screens)


def write_out(text: str) -> None:
    """Write to standard output, and name it where that fails.

    Raises:
        OSError: it is closed, or the disk that it goes to is full.
    """
    # Closed by its caller with >&-; Python then has no stream at all.
    if sys.stdout is None:
        why = f"is closed, so nothing can be shown: send it to a file, or to {os.devnull}"
        raise OSError(errno.EBADF, why, "standard output")
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except BrokenPipeError:  # a reader that has enough, as `head` does
        raise
    except OSError as error:
        # Python would try to write the rest again at its end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise type(error)(error.errno, error.strerror, "standard output") from None


def warn(text: str) -> None:
    """Say something on standard error: a line each, for logs are searched; folded at a terminal."""
    from typer import echo

    lines = escaped(text).split("\n")
    looked_at = sys.stderr is not None and sys.stderr.isatty()
    for line in lines:
        echo("\n".join(folded(line)) if looked_at else line, err=True)


def show_json(record: dict[str, Any], *files: Path) -> None:
    """Print a record as JSON, with the files that were written."""
    shown = record | {"files": [str(file) for file in files]}
    write_out(json.dumps(shown, indent=2, allow_nan=False) + "\n")


def report(
    account: Account,
    as_json: bool,
    out: Path | None = None,
    force: bool = False,
    **options: Any,
) -> None:
    """Write a result into a folder, and print it as JSON or as text.

    Args:
        account: of the result.
        as_json: what --json says.
        out: what --out says.
        force: what --force says.
        options: of `reports.write`, for the kind of result.
    """
    names: Sequence[str] = ()
    if out is not None:
        from stepwell import reports

        with progress(WRITING) as tell:
            names = reports.write(account, out, progress=tell, force=force, **options)
    if as_json:
        show_json(account.record, *((out or Path()) / name for name in names))
        return
    _lines(terminal(account))
    if names:
        show_lines("", f"Written into {out}: {', '.join(names)}")


def show_lines(*lines: str) -> None:
    """Print lines, folded to the width of the terminal."""
    rows = (row for line in lines for row in escaped(line).split("\n"))
    write_out("".join(f"{part}\n" for row in rows for part in folded(row)))


def show_verbatim(text: str) -> None:
    """Print what will be copied, such as TOML, an address or a path, as it is."""
    write_out(f"{escaped(text)}\n")


def show_text(*paragraphs: str) -> None:
    """Print long sentences as paragraphs, each after an empty line."""
    for text in paragraphs:
        show_lines("", *wrapped(text))


def show_title(text: str) -> None:
    """Print a line that others stand under, after an empty one."""
    _lines([Line(""), *heading(text)])


def wrapped(text: str) -> list[str]:
    """A long sentence in lines, as a sentence begins."""
    return [line.text for line in paragraph(text)]


def show_table(
    title: str, head: Sequence[str], rows: Iterable[Sequence[str]], *, left: Sequence[int] = (0,)
) -> None:
    """Print a table, as `accounts` folds it."""
    _lines(table(title, head, rows, left))


def _lines(lines: Iterable[Line]) -> None:
    """Print lines that are folded; headings in bold where boxes and colours are welcome."""
    plain = not styled()
    for bold, some in groupby(lines, lambda line: line.bold):
        texts = [line.text for line in some]
        if plain or not bold:
            write_out("".join(f"{text}\n" for text in texts))
            continue
        from rich.console import Console
        from rich.text import Text

        console = Console(highlight=False, soft_wrap=True)
        for text in texts:
            console.print(Text(text, style="bold"))
