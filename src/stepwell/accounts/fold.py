"""Lines and tables folded to the width of the terminal."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterable, Sequence
from textwrap import TextWrapper
from typing import NamedTuple

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


class Block(NamedTuple):
    """Some columns of a table."""

    head: list[str]
    rows: list[str]


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


def prose(text: str) -> list[str]:
    """Long sentences in lines."""
    return _wrap(text, width(), "", _WORDS)


def blocks(head: Cells, rows: Sequence[Cells], left: Iterable[int]) -> list[Block]:
    """A table as lines, in several blocks where it is too wide for one.

    Columns that find no room stand in a block below, again with those that tell the rows apart.

    Args:
        head: of each column.
        rows: text.
        left: columns that start at the left; the others end at the right.
    """
    columns = [[name, *(row[k] for row in rows)] for k, name in enumerate(head)]
    left = set(left)
    return [
        _drawn([columns[k] for k in chosen], [k in left for k in chosen])
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
        if found[-1] != keys and _total(wanted[i] for i in longer) > room:
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


def _drawn(columns: Sequence[Cells], left: Sequence[bool]) -> Block:
    widths = _widths(columns)
    heads, *rows = zip(*columns, strict=True)
    told = [_wrap(text, most, "", _WORDS) for text, most in zip(heads, widths, strict=True)]
    found = [_row(told, widths, left)]
    for row in rows:
        cells = [_cell(*one) for one in zip(row, widths, left, strict=True)]
        found.append(_row(cells, widths, left))
    return Block(found[0], [line for lines in found[1:] for line in lines])


def _row(cells: Sequence[Cells], widths: Sequence[int], left: Sequence[bool]) -> list[str]:
    """The lines of a row, as many as its tallest cell has."""
    tall = max(map(len, cells))
    columns = (
        [(text.ljust if at_left else text.rjust)(most) for text in [*cell, *[""] * tall][:tall]]
        for cell, most, at_left in zip(cells, widths, left, strict=True)
    )
    return [_GAP.join(texts).rstrip() for texts in zip(*columns, strict=True)]


def _cell(text: str, most: int, at_left: bool) -> list[str]:
    if len(text) <= most:
        return [text]
    lines: list[str] = []
    for places in _PLACES:
        lines = _wrap(text, most, _HANG if at_left else "", places)
        if max(map(len, lines)) <= most:
            break
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


def _total(widths: Iterable[int]) -> int:
    found = list(widths)
    return sum(found) + len(_GAP) * (len(found) - 1)


def _wrap(text: str, most: int, hang: str, places: re.Pattern[str]) -> list[str]:
    wrapper = TextWrapper(
        most, subsequent_indent=hang, break_long_words=False, break_on_hyphens=False
    )
    wrapper.wordsep_simple_re = places  # type: ignore[misc]
    return [line.rstrip() for line in wrapper.wrap(text)]
