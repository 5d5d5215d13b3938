"""An account on the terminal: lines and tables, folded to its width."""

import math
import os
import re
import shutil
from collections.abc import Iterable, Sequence
from itertools import zip_longest
from textwrap import TextWrapper
from typing import NamedTuple

from stepwell.accounts import parts
from stepwell.accounts.parts import FULL, TERMINAL, Account, Level
from stepwell.base import counted, headed, printable, shown

# The width of pipes, files and pages; longer lines are hard to read, and shorter ones hold no
# table.
_USUAL, _LEAST, _MOST = 80, 40, 100
_GAP, _HANG, _BULLET = "  ", "  ", "- "
# Lines of an answer: a screen of usual height has room for them and the command.
SCREEN = 25
# A table is cut to no fewer rows; with less room it is left out.
_FEWEST = 3
# Where a cell of a table may be folded: behind a comma outside of brackets, or else at a space or
# between two states, or else between the parts of a key. A number is never cut, nor parted from
# its unit.
_LISTS = re.compile(r"(?<=[,;])( )(?![^(]*\))")
_WORDS = re.compile(r"(?<!\d)( )|( )(?![A-Za-z%°]{1,3}(?![A-Za-z]))|(?<=>)(?=\d)")
_KEYS = re.compile(rf"{_WORDS.pattern}|(?<=\.)(?=[a-z*])")
_PLACES = (_LISTS, _WORDS, _KEYS)
# Heads are folded before any cell, and cells at each kind of place in turn.
_HEADS, _COMMAS, _ALL = 0, 1, 3
# The narrowest readable column of words; in a narrower one every word has a line.
_READ = 20
# A name, and its description in a column of its own.
_NAMED = re.compile(r" *\S.*? {2,}(?=\S)")

Cells = Sequence[str]


def width() -> int:
    """Letters of a line: those of the terminal, or of COLUMNS; 80 without a terminal."""
    letters = shutil.get_terminal_size((_USUAL, 24)).columns
    # COLUMNS may ask for more: each row of a table on a line, for grep.
    asked = os.environ.get("COLUMNS", "").isdecimal()
    return max(letters if asked else min(letters, _MOST), _LEAST)


def folded(text: str) -> list[str]:
    """A line in lines that are short enough; further lines are below the words, not the name."""
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

    Columns for which there is no room are in a block below, again with those that distinguish the
    rows; those in `left` start at the left, the others end at the right.
    """
    columns = [[name, *(row[k] for row in rows)] for k, name in enumerate(head)]
    at_left = [k in set(left) for k in range(len(columns))]
    return [
        _block([columns[k] for k in chosen], [at_left[k] for k in chosen])
        for chosen in _distributed(columns)
    ]


def _distributed(columns: Sequence[Cells]) -> list[list[int]]:
    """The columns of each block."""
    room = width()
    least = [max(_least(column, _ALL), min(_least(column, _COMMAS), _READ)) for column in columns]
    if _total(least) <= room:
        return [list(range(len(columns)))]
    keys = [0]
    # The first columns that distinguish the rows if they are narrow; else the first alone.
    for count in range(1, len(columns)):
        if _total(least[:count]) > room // 2:
            break
        if len(set(zip(*columns[:count], strict=True))) == len(columns[0]):
            keys = list(range(count))
            break
    chosen = [keys]
    for k in range(len(keys), len(columns)):
        longer = [*chosen[-1], k]
        if chosen[-1] != keys and _total([least[i] for i in longer]) > room:
            chosen.append([*keys, k])
        else:
            chosen[-1] = longer
    return chosen


def _block(columns: Sequence[Cells], left: Sequence[bool]) -> tuple[list[str], list[str]]:
    widths = _widths(columns)

    def lines(cells: Iterable[Cells]) -> list[str]:
        """The lines of a row; its tallest cell decides how many."""
        sides = list(zip(widths, left, strict=True))
        return [
            _GAP.join(
                text.ljust(most) if at_left else text.rjust(most)
                for text, (most, at_left) in zip(line, sides, strict=True)
            ).rstrip()
            for line in zip_longest(*cells, fillvalue="")
        ]

    heads, *rows = zip(*columns, strict=True)
    body = (lines(map(_folded_cell, row, widths, left)) for row in rows)
    head = lines(_wrap(text, most, "", _WORDS) for text, most in zip(heads, widths, strict=True))
    return head, [line for row in body for line in row]


def _folded_cell(text: str, most: int, at_left: bool) -> list[str]:
    lines = [text]
    for places in _PLACES:
        if max(map(len, lines)) > most:
            lines = _wrap(text, most, _HANG if at_left else "", places)
    return lines


def _widths(columns: Sequence[Cells]) -> list[int]:
    """The width of each column: unfolded, and if that is too wide, the widest are folded."""
    widths = [max(map(len, column)) for column in columns]
    for effort in range(_HEADS, _ALL + 1):
        least = [_least(column, effort) for column in columns]
        while _total(widths) > width():
            foldable = [(now, k) for k, now in enumerate(widths) if now > least[k]]
            if not foldable:
                break
            widths[max(foldable)[1]] -= 1
    return widths


def _least(column: Cells, effort: int) -> int:
    """The least width of a column whose head is folded, and its cells with this effort."""
    head, *cells = column
    letters = [len(part) for part in _WORDS.split(head) if part]
    for text in cells:
        pieces = [text] if effort == _HEADS else _PLACES[effort - 1].split(text)
        words = [piece for piece in pieces if piece and piece != " "]
        letters += [len(piece) + len(_HANG) * (k > 0) for k, piece in enumerate(words)]
    return max(letters, default=0)


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
_ASSUMPTIONS = "Assumptions"


def terminal(account: Account, *, full: bool = False) -> list[Line]:
    """What the terminal shows of a result: the answer first, and a screen of lines at most.

    Answer, warnings, facts and hints are always shown. Sections fill the screen in their order; the
    last line counts the lines that are left out.

    Args:
        account: of the result.
        full: whether all lines are shown.

    Returns:
        Lines as `folded` folds them; what would move, hide or recolour other text is escaped.
    """
    hints = [line for hint in account.hints for line in (_EMPTY, *paragraph(hint))]
    whole = [*_summary(account, FULL), *_sections(account, FULL), *hints]
    if full or len(whole) <= SCREEN:
        return whole
    lines = _summary(account, TERMINAL)
    # The last two lines are the count of the others.
    room = SCREEN - 2 - len(lines) - len(hints)
    lines += [*_sections(account, TERMINAL, room), *hints]
    notes = dict(account.within(FULL)).get(_ASSUMPTIONS, ())
    among = ", assumptions among them" * any(map(parts.lines_of, notes))
    left = counted(len(whole) - len(lines), "more line")
    return [*lines, _EMPTY, *paragraph(f"{left} with --full{among}; everything with --json")]


def _summary(account: Account, level: Level) -> list[Line]:
    """The answer, the title, the warnings and the facts."""
    lines = [*paragraph(account.answer), *paragraph(account.title)]
    if level == FULL:
        lines += paragraph(account.origin)
    for warned in account.warnings:
        if warned.lines:
            about = [warned.text] * (level == FULL)
            lines += [_EMPTY, *heading(warned.heading), *paragraph(*about, *warned.lines)]
    facts = account.known(level)
    label = 2 + max(map(len, facts), default=0)
    lines += [_EMPTY] * bool(facts)
    for name, text in facts.items():
        lines += map(Line, folded(f"{name:<{label}}{escaped(text)}"))
    return lines


def _sections(account: Account, level: Level, room: float = math.inf) -> list[Line]:
    """The sections in their order, as far as there is room for them [lines]."""
    lines: list[Line] = []
    for title, shown_here in account.within(level):
        above = [_EMPTY, *heading(title)]
        for part in shown_here:
            left = room - len(lines) - len(above)
            if isinstance(part, parts.RecordTable):
                under = _records(account, part, level, left)
            elif isinstance(part, parts.Verbatim):
                under = [*map(Line, escaped(part.text).split("\n"))] if part.text else []
            elif isinstance(part, parts.Notes) and part.short and level < FULL:
                under = _sentences(part.short)
            else:
                under = _sentences(parts.lines_of(part))
            if under is None or len(under) > left:
                return lines
            if under:
                lines += [*above, *under]
                above = [_EMPTY]
    return lines


def _sentences(texts: Sequence[str]) -> list[Line]:
    """A sentence as a paragraph, several as a list."""
    if len(texts) < 2:
        return paragraph(*texts)
    wrapped = (_wrap(f"{_BULLET}{escaped(headed(text))}", width(), _HANG, _WORDS) for text in texts)
    return [Line(line) for lines in wrapped for line in lines]


def escaped(text: str) -> str:
    """Text as a terminal may have it: what would move, hide or recolour other text is escaped."""
    return "\n".join(map(printable, text.split("\n")))


def paragraph(*texts: str) -> list[Line]:
    """Sentences, which begin with a capital; no lines without a text."""
    wrapped = (_wrap(escaped(headed(text)), width(), "", _WORDS) for text in texts if text)
    return [Line(line) for lines in wrapped for line in lines]


def heading(text: str) -> list[Line]:
    """A heading of other lines."""
    return [Line(line, bold=True) for line in folded(escaped(text))]


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
    return [_EMPTY, *heading(title), *_grid(head, rows, left)]


def _grid(head: Cells, rows: Iterable[Cells], left: Sequence[int]) -> list[Line]:
    # Escaped here: a column is as wide as what is shown.
    names, cells = [*map(escaped, head)], [[*map(escaped, row)] for row in rows]
    lines: list[Line] = []
    for k, (heads, body) in enumerate(blocks(names, cells, left)):
        lines += [_EMPTY] if k else []
        lines += [*(Line(line, bold=True) for line in heads), *map(Line, body)]
    return lines


def _records(
    account: Account, part: parts.RecordTable, level: Level, room: float
) -> list[Line] | None:
    """As many rows of a table as there is room for; None if there is none for the first ones."""
    if not (rows := account.rows(part)):
        return []
    everything = level == FULL
    columns = shown((*part.columns, *(part.wide if everything else ())))
    left = [k for k, column in enumerate(columns) if not column.numeric]
    cells = [
        [column.cell(row) for column in columns]
        for row in rows[: max(0, int(min(room, len(rows))))]
    ]
    about = paragraph(part.about) if everything else []
    for count in range(len(cells), min(_FEWEST, len(rows)) - 1, -1):
        lines = _grid([column.heading for column in columns], cells[:count], left)
        if more := len(rows) - count:
            lines.append(Line(f"and {counted(more, 'more row')}"))
        if len(about) + len(lines) <= room:
            return [*about, *lines]
    return None
