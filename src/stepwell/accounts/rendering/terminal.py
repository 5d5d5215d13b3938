"""An account on the terminal: lines and tables, folded to its width."""

import os
import re
import shutil
from collections.abc import Iterable, Mapping, Sequence
from textwrap import TextWrapper
from typing import Any, NamedTuple

from stepwell.accounts import parts
from stepwell.accounts.parts import TERMINAL, Account
from stepwell.base import Columns, headed, printable, shown

# What a pipe, a file and a page get; more than the most is hard to read, and less than the least
# holds no table.
_USUAL, _LEAST, _MOST = 80, 40, 100
_GAP, _HANG = "  ", "  "
# Where a cell of a table may be folded: behind a comma outside of brackets, or else at a space or
# between two states, or else between the parts of a key. A number is never cut, nor parted from
# its unit.
_LISTS = re.compile(r"(?<=[,;])( )(?![^(]*\))")
_WORDS = re.compile(r"(?<!\d)( )|( )(?![A-Za-z%°]{1,3}(?![A-Za-z]))|(?<=>)(?=\d)")
_KEYS = re.compile(rf"{_WORDS.pattern}|(?<=\.)(?=[a-z*])")
_PLACES = (_LISTS, _WORDS, _KEYS)
# Heads are folded before any cell, and cells at each kind of place in turn.
_HEADS, _COMMAS, _ALL = 0, 1, 3
# A column of words as narrow as this is still read; in a narrower one every word has a line.
_READ = 20
# A name, and what is said of it in a column of its own.
_NAMED = re.compile(r" *\S.*? {2,}(?=\S)")

Cells = Sequence[str]


def width() -> int:
    """Letters of a line: those of the terminal, or of COLUMNS; 80 where nobody looks."""
    found = shutil.get_terminal_size((_USUAL, 24)).columns
    # Who asks for more by COLUMNS gets it: each row of a table on a line, for grep.
    asked = os.environ.get("COLUMNS", "").isdecimal()
    return max(found if asked else min(found, _MOST), _LEAST)


def folded(text: str) -> list[str]:
    """A line in lines that are short enough; what follows stands under the words, not the name."""
    most = width()
    if len(text) <= most:
        return [text]
    named = _NAMED.match(text)
    indent = len(named[0]) if named else 0
    if not 0 < indent <= most // 2:
        sentence = text[:1].isupper() and text.endswith((".", "?"))
        indent = len(text) - len(text.lstrip(" ")) + len(_HANG) * (not sentence)
    return _wrap(text, most, " " * indent, _WORDS)


def blocks(
    head: Cells, rows: Sequence[Cells], left: Iterable[int]
) -> list[tuple[list[str], list[str]]]:
    """Heads and rows of a table as lines, in several blocks where it is too wide for one.

    Columns that find no room stand in a block below, again with those that tell the rows apart;
    those in `left` start at the left, the others end at the right.
    """
    columns = [[name, *(row[k] for row in rows)] for k, name in enumerate(head)]
    at_left = [k in set(left) for k in range(len(columns))]
    return [
        _drawn([columns[k] for k in chosen], [at_left[k] for k in chosen])
        for chosen in _shares(columns)
    ]


def _shares(columns: Sequence[Cells]) -> list[list[int]]:
    """Which columns each block has."""
    room = width()
    wanted = [max(_least(column, _ALL), min(_least(column, _COMMAS), _READ)) for column in columns]
    if _total(wanted) <= room:
        return [list(range(len(columns)))]
    keys = _keys(columns, wanted, room // 2)
    found = [keys]
    for k in range(len(keys), len(columns)):
        longer = [*found[-1], k]
        if found[-1] != keys and _total([wanted[i] for i in longer]) > room:
            found.append([*keys, k])
        else:
            found[-1] = longer
    return found


def _keys(columns: Sequence[Cells], widths: Sequence[int], room: int) -> list[int]:
    """The first columns, if not many, by which the rows are told apart; else the first alone."""
    for count in range(1, len(columns)):
        if _total(widths[:count]) > room:
            break
        if len(set(zip(*columns[:count], strict=True))) == len(columns[0]):
            return list(range(count))
    return [0]


def _drawn(columns: Sequence[Cells], left: Sequence[bool]) -> tuple[list[str], list[str]]:
    widths = _widths(columns)
    heads, *rows = zip(*columns, strict=True)
    head = _row([_wrap(*one, "", _WORDS) for one in zip(heads, widths, strict=True)], widths, left)
    lines: list[str] = []
    for row in rows:
        cells = [_folded_cell(*one) for one in zip(row, widths, left, strict=True)]
        lines += _row(cells, widths, left)
    return head, lines


def _row(cells: Sequence[Cells], widths: Sequence[int], left: Sequence[bool]) -> list[str]:
    """The lines of a row, as many as its tallest cell has."""
    tall = max(map(len, cells))
    columns = (
        [(text.ljust if at_left else text.rjust)(most) for text in [*cell, *[""] * tall][:tall]]
        for cell, most, at_left in zip(cells, widths, left, strict=True)
    )
    return [_GAP.join(texts).rstrip() for texts in zip(*columns, strict=True)]


def _folded_cell(text: str, most: int, at_left: bool) -> list[str]:
    lines = [text]
    for places in _PLACES:
        if max(map(len, lines)) <= most:
            break
        lines = _wrap(text, most, _HANG if at_left else "", places)
    return lines


def _widths(columns: Sequence[Cells]) -> list[int]:
    """How wide each column is: as it likes, and if that is too much, the widest are folded."""
    room = width()
    found = [max(map(len, column)) for column in columns]
    for effort in range(_HEADS, _ALL + 1):
        least = [_least(column, effort) for column in columns]
        while _total(found) > room:
            foldable = [(now, k) for k, now in enumerate(found) if now > least[k]]
            if not foldable:
                break
            found[max(foldable)[1]] -= 1
    return found


def _least(column: Cells, effort: int) -> int:
    """How narrow a column can be whose head is folded, and its cells with so much effort."""
    head, *cells = column
    words = max((len(part) for part in _WORDS.split(head) if part), default=0)
    return max([words, *(_longest(text, effort) for text in cells)])


def _longest(text: str, effort: int) -> int:
    if effort == _HEADS:
        return len(text)
    parts = [part for part in _PLACES[effort - 1].split(text) if part and part != " "]
    return max((len(part) + len(_HANG) * (k > 0) for k, part in enumerate(parts)), default=0)


def _total(widths: Sequence[int]) -> int:
    return sum(widths) + len(_GAP) * (len(widths) - 1)


def _wrap(text: str, most: int, hang: str, places: re.Pattern[str]) -> list[str]:
    wrapper = TextWrapper(
        most, subsequent_indent=hang, break_long_words=False, break_on_hyphens=False
    )
    wrapper.wordsep_simple_re = places  # type: ignore[misc]
    return [line.rstrip() for line in wrapper.wrap(text)]


class Line(NamedTuple):
    """A line that is short enough, and whether it is a heading."""

    text: str
    bold: bool = False


_EMPTY = Line("")


def terminal(account: Account) -> list[Line]:
    """What the terminal shows of a result.

    Returns:
        Lines as `folded` folds them; what would move, hide or recolour other text is escaped.
    """
    lines = [*paragraph(account.title), _EMPTY] if account.title else []
    for warned in account.warnings:
        if warned.lines:
            lines += [*heading(warned.heading), *_paragraphs(warned.lines), _EMPTY]
    lines += [*paragraph(account.answer), *facts(account.known(TERMINAL))]
    for title, found in account.within(TERMINAL):
        for part in found:
            if isinstance(part, parts.RecordTable):
                lines += records(title, part.columns, account.rows(part), most=part.most)
            elif under := _part(part):
                lines += [_EMPTY, *heading(title), *under]
    for hint in account.hints:
        lines += [_EMPTY, *paragraph(hint)]
    return lines[1:] if lines[:1] == [_EMPTY] else lines


def _part(part: parts.Part) -> list[Line]:
    if isinstance(part, parts.Text):
        return paragraph(parts.text_of(part))
    if isinstance(part, parts.Notes):
        return _paragraphs(part.lines)
    if isinstance(part, parts.Verbatim) and part.text:
        return [*map(Line, escaped(part.text).split("\n"))]
    return []


def _paragraphs(texts: Iterable[str]) -> list[Line]:
    return [line for text in texts for line in paragraph(text)]


def escaped(text: str) -> str:
    """Text as a terminal may have it: what would move, hide or recolour other text is escaped."""
    return "\n".join(map(printable, text.split("\n")))


def paragraph(text: str) -> list[Line]:
    """Sentences, which begin with a capital; nothing of none."""
    return [*map(Line, _wrap(escaped(headed(text)), width(), "", _WORDS))] if text else []


def heading(text: str) -> list[Line]:
    """A line that others stand under."""
    return [Line(line, bold=True) for line in folded(escaped(text))]


def facts(found: Mapping[str, str]) -> list[Line]:
    """Labels and what stands behind them, in two columns."""
    width = 2 + max(map(len, found), default=0)
    rows = (f"{label:<{width}}{escaped(text)}" for label, text in found.items())
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
    for k, (heads, body) in enumerate(found):
        lines += [_EMPTY] if k else []
        lines += [*(Line(line, bold=True) for line in heads), *map(Line, body)]
    return lines


def records(
    title: str, columns: Columns, found: Sequence[Mapping[str, Any]], *, most: int | None = 40
) -> list[Line]:
    """Records as a table, `most` of them or all; nothing where there are none."""
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
