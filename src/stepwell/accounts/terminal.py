"""An account on the terminal: lines of text, folded to its width."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from stepwell.accounts.account import Account, Level, Notes, Part, Table, Text, Verbatim
from stepwell.accounts.fold import blocks, folded, prose
from stepwell.base import Columns, headed, printable, shown


class Line(NamedTuple):
    """A line that is short enough, and whether it is a heading."""

    text: str
    bold: bool = False


_EMPTY = Line("")


def terminal(account: Account) -> list[Line]:
    """What the terminal shows of a result.

    Args:
        account: of the result.

    Returns:
        Lines as `folded` folds them; what would move, hide or recolour other text is escaped.
    """
    lines = [*paragraph(account.title), _EMPTY] if account.title else []
    for warned in account.warnings:
        if warned.lines:
            lines += heading(warned.heading)
            lines += [line for text in warned.lines for line in paragraph(text)]
            lines += [_EMPTY]
    lines += paragraph(account.answer)
    lines += facts(account.known(Level.TERMINAL))
    for section in account.sections:
        parts = [list(_part(part, section.heading)) for part in section.within(Level.TERMINAL)]
        lines += [line for part in parts for line in part]
    for hint in account.hints:
        lines += [_EMPTY, *paragraph(hint)]
    return lines[1:] if lines[:1] == [_EMPTY] else lines


def _part(part: Part, title: str) -> Iterator[Line]:
    if isinstance(part, Table):
        yield from records(title, part.columns, part.rows(), most=part.most)
    elif isinstance(part, Text) and part.text:
        yield from (_EMPTY, *heading(title), *paragraph(part.text))
    elif isinstance(part, Notes) and part.lines:
        yield from (_EMPTY, *heading(title))
        for line in part.lines:
            yield from paragraph(line)
    elif isinstance(part, Verbatim) and part.text:
        yield from (_EMPTY, *heading(title), *map(Line, escaped(part.text).split("\n")))


def escaped(text: str) -> str:
    """Text as a terminal may have it: what would move, hide or recolour other text is escaped."""
    return "\n".join(map(printable, text.split("\n")))


def paragraph(text: str) -> list[Line]:
    """Sentences, which begin with a capital; nothing of none."""
    if not text:
        return []
    return [Line(line) for line in prose(escaped(headed(text)))]


def heading(text: str) -> list[Line]:
    """A line that others stand under."""
    return [Line(line, bold=True) for line in folded(escaped(text))]


def facts(found: Mapping[str, str]) -> list[Line]:
    """Labels and what stands behind them, in two columns; those without a text are left out."""
    kept = {label: text for label, text in found.items() if text}
    width = 2 + max(map(len, kept), default=0)
    rows = (f"{label:<{width}}{escaped(text)}" for label, text in kept.items())
    return [Line(line) for row in rows for line in folded(row)]


def table(
    title: str, head: Sequence[str], rows: Iterable[Sequence[str]], left: Sequence[int] = (0,)
) -> list[Line]:
    """A table under its title, in several blocks where it is too wide for one.

    Args:
        title: a line above it.
        head: names of the columns, with units.
        rows: text.
        left: columns that start at the left; the others hold numbers.
    """
    # Escaped here: a column is as wide as what is shown.
    found = blocks([*map(escaped, head)], [[*map(escaped, row)] for row in rows], left)
    lines = [_EMPTY, *heading(title)]
    for k, block in enumerate(found):
        lines += [_EMPTY] if k else []
        lines += [Line(line, bold=True) for line in block.head]
        lines += map(Line, block.rows)
    return lines


def records(
    title: str,
    columns: Columns,
    found: Sequence[Mapping[str, Any]],
    *,
    most: int | None = 40,
) -> list[Line]:
    """Records as a table; nothing where there are none.

    Args:
        title: a line above it.
        columns: what is shown of each record; quantities without a head are not.
        found: records of results.
        most: records of which rows are shown, None for all.
    """
    if not found:
        return []
    kept = shown(columns)
    lines = table(
        title,
        [column.heading for column in kept],
        [[column.cell(one) for column in kept] for one in found[:most]],
        [k for k, column in enumerate(kept) if not column.numeric],
    )
    hidden = 0 if most is None else len(found) - most
    return [*lines, Line(f"and {hidden} more; --json shows all")] if hidden > 0 else lines
