"""How results look on the screen: plain where the reader is a program."""

import json
import os
import sys
import textwrap
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

_WIDTH = 100


def styled() -> bool:
    """Whether boxes and colours are welcome: at a terminal, unless NO_COLOR is set."""
    return sys.stdout.isatty() and not os.environ.get("NO_COLOR")


def show_json(
    record: dict[str, Any], folder: Path | None = None, names: Sequence[str] = ()
) -> None:
    """Print a record as JSON, with the files that were written."""
    files = {"files": [str(folder / name) for name in names] if folder else []}
    sys.stdout.write(json.dumps(record | files, indent=2, allow_nan=False) + "\n")


def show_written(folder: Path | None, names: Sequence[str]) -> None:
    """Say what was written and where."""
    if folder is not None:
        show_lines("", f"Written into {folder}: {', '.join(names)}")


def show_lines(*lines: str) -> None:
    """Print lines as they are."""
    sys.stdout.write("".join(f"{line}\n" for line in lines))


def show_text(*paragraphs: str) -> None:
    """Print long sentences as paragraphs, each after an empty line."""
    for text in paragraphs:
        show_lines("", *wrapped(text))


def wrapped(text: str) -> list[str]:
    """A long sentence in lines, as a sentence begins."""
    begun = text[:1].upper() + text[1:]
    return textwrap.wrap(begun, _WIDTH, break_on_hyphens=False, break_long_words=False)


def show_table(
    title: str,
    head: Sequence[str],
    rows: Iterable[Sequence[str]],
    *,
    left: Sequence[int] = (0,),
    hidden: int = 0,
) -> None:
    """Print a table.

    Args:
        title: a line above it.
        head: column names, with units.
        rows: text.
        left: columns that start at the left; the others hold numbers.
        hidden: how many rows are left out, for a line below it.
    """
    draw = _styled if styled() else _plain
    draw(title, head, list(rows), left)
    if hidden > 0:
        show_lines(f"and {hidden} more; --json shows all")


def number(value: float | None, digits: int = 4) -> str:
    """A number for a table; an empty place where there is none."""
    return "" if value is None else f"{_rounded(value):.{digits}g}"


def signed(value: float) -> str:
    """A change for a table, with its sign."""
    return f"{_rounded(value):+.4g}"


def _rounded(value: float) -> float:
    # A rounding error has no sign.
    return 0.0 if abs(value) < 1e-12 else value


def _plain(title: str, head: Sequence[str], rows: list[Sequence[str]], left: Sequence[int]) -> None:
    """Aligned columns, two spaces apart: what other programs and diffs like."""
    table = [head, *rows]
    widths = [max(len(row[k]) for row in table) for k in range(len(head))]
    show_lines("", title)
    for row in table:
        cells = (
            text.ljust(width) if k in left else text.rjust(width)
            for k, (text, width) in enumerate(zip(row, widths, strict=True))
        )
        show_lines("  ".join(cells).rstrip())


def _styled(
    title: str, head: Sequence[str], rows: list[Sequence[str]], left: Sequence[int]
) -> None:
    """Columns that fit the terminal."""
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, header_style="bold")
    for k, name in enumerate(head):
        table.add_column(Text(name), justify="left" if k in left else "right")
    for row in rows:
        table.add_row(*map(Text, row))
    console = Console(highlight=False)
    console.print()
    console.print(Text(title, style="bold"))
    console.print(table)
