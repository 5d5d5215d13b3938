"""Blocks of numbers in the rows of a file, each with the lines above it."""

import re
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple, Protocol

import numpy as np

from stepwell.base import Floats, InputError, Ints
from stepwell.lab.recordings.rows import Style, is_missing

_LOOKED_AT = 50  # rows that decide which columns hold numbers
_HEAD = 400  # most lines above the numbers that are kept
_SHOWN = 40
_WIDEST = 1000  # columns
_MOST_BLOCKS = 1000

_SPECIMEN = re.compile(
    r"[#*\W]*(?:sample|specimen|test|run|trial|probe|prüfling|essai|éprouvette|échantillon|muestra"
    r"|试样)\W*(?:n[or°]?\.?\W*)?\d{1,4}\W*",
    re.IGNORECASE,
)

_Row = tuple[int, list[str]]  # with the number of its line


class NumberBlock(NamedTuple):
    """Consecutive rows of numbers.

    Attributes:
        head: the fields of the lines above, back to the block before.
        preamble: those of the file's first lines.
        columns: (n,) numbers by index of the column; NaN if missing. Columns of words are absent.
        lines: (n,) line of each row in the file.
        bad: rows among the numbers, or below, that do not fit, as (line, text).
        width: number of columns.
        label: a line such as "Sample 2" above the numbers.
    """

    head: tuple[tuple[str, ...], ...]
    preamble: tuple[tuple[str, ...], ...]
    columns: dict[int, Floats]
    lines: Ints
    bad: tuple[tuple[int, str], ...]
    width: int
    label: str = ""

    def __len__(self) -> int:
        return len(self.lines)


class RowSource(Protocol):
    """Consecutive rows of a file."""

    def rows(self) -> list[list[str]]:
        """Fields of each row."""
        ...

    def numbers(self, width: int, places: Sequence[int]) -> Floats | None:
        """(n, len(places)) numbers in these of `width` columns; None if a row is irregular."""
        ...


def blocks(
    chunks: Iterable[RowSource],
    style: Style,
    is_header: Callable[[Sequence[str]], bool],
    delimiter: str = " ",
) -> list[NumberBlock]:
    """All blocks of two or more columns of numbers, in the order of the file.

    A block begins below a header, below a line such as "Sample 2", or where other columns hold
    numbers; `is_header` decides on the fields of a line of words.

    Raises:
        ValueError: there is none, or there are more than 1000 columns or blocks.
    """
    reader, line = _Blocks(style, is_header), 1
    for some in chunks:
        line += reader.add(some, line)
        if len(reader.found) > _MOST_BLOCKS:
            raise InputError(f"has more than {_MOST_BLOCKS} tables: export one test each.")
    if not reader.found:
        raise InputError(
            "holds no row of two or more numbers: a recording is rows of time, displacement and "
            "force."
        )
    reader.found[-1].bad += reader.head
    return [one.block(delimiter) for one in reader.found]


class _Blocks:
    """Blocks that are being read, and the lines that belong to none of them, or not yet."""

    def __init__(self, style: Style, is_header: Callable[[Sequence[str]], bool]):
        self.style, self.is_header = style, is_header
        self.found: list[_Growing] = []
        self.head: list[_Row] = []
        self.first: list[tuple[str, ...]] = []

    def add(self, some: RowSource, line: int) -> int:
        """Add rows from this line on and return how many: all at once if they are regular."""
        current = self.found[-1] if self.found and not self.head else None
        if current is not None and (count := current.add_all(some, line)):
            return count
        rows = list(enumerate(some.rows(), line))
        if current is None or not current.add_columns(rows):
            at = 0
            while at < len(rows):
                at += self._add_some(rows[at:])
        return len(rows)

    def _add_some(self, rows: Sequence[_Row]) -> int:
        """Add the first rows and return how many; 0 if a block begins with them."""
        number, fields = rows[0]
        current = self.found[-1] if self.found else None
        if current is not None and current.fits(fields):
            return self._continued(current, rows).add(rows)
        if not any(field.strip() for field in fields):
            return 1
        may_begin = current is None or _names(self.head, 0, self.style)
        if may_begin and _begins(rows, self.style):
            if len(fields) > _WIDEST:
                raise InputError(f"has {len(fields)} columns: at most {_WIDEST} are read.")
            head = self.head
            if self._begin(rows).fits(fields):
                return 0
            # Numbers of a header: most of the rows below have them in other columns.
            self.found.pop()
            self.head = head
        self.head.append((number, fields))
        if current is None:
            self.first += [tuple(fields)] * (len(self.first) < _HEAD)
            del self.head[:-_HEAD]
        return 1

    def _continued(self, block: "_Growing", rows: Sequence[_Row]) -> "_Growing":
        """The block of rows that fit this one: a new one below a label or a header."""
        if _label(self.head):
            self.head = [*((0, list(fields)) for fields in block.head), *self.head]
            return self._begin(rows)
        if _names(self.head, block.width, self.style) and (
            any(self.is_header(fields) for _, fields in self.head) or block.numbers_in(rows[0][1])
        ):
            return self._begin(rows)
        block.bad += self.head
        self.head = []
        return block

    def _begin(self, rows: Sequence[_Row]) -> "_Growing":
        self.found.append(_Growing(rows, self.style, self.head, self.first))
        self.head = []
        return self.found[-1]


def _begins(rows: Sequence[_Row], style: Style) -> bool:
    """Whether a block begins with the first row: numbers alone, or like those in the next row."""
    fields = rows[0][1]
    numbers = [bool(style.plain(field)) for field in fields]
    if sum(numbers) < 2:
        return False
    if all(n or is_missing(field) for n, field in zip(numbers, fields, strict=True)):
        return True
    below = next((f for _, f in rows[1:4] if any(x.strip() for x in f)), None)
    return below is None or [bool(style.plain(field)) for field in below] == numbers


def _names(head: Sequence[_Row], width: int, style: Style) -> bool:
    """Whether lines between numbers name columns: two words or more, and no number."""
    for _, fields in head:
        words = [field for field in fields if field.strip() and not is_missing(field)]
        if (
            len(words) >= 2
            and not any(map(style.plain, words))
            and (not width or width in (len(fields), _without_comment(fields)))
        ):
            return True
    return False


def _without_comment(fields: Sequence[str]) -> int:
    """Number of fields of a header of LabVIEW, which ends with a comment that rows leave out."""
    return len(fields) - (fields[-1].strip().lower() == "comment")


def _label(head: Sequence[_Row]) -> str:
    """The last line that names a specimen and nothing else, as "Sample 2" does; else empty."""
    for _, fields in reversed(head):
        words = [field.strip() for field in fields if field.strip()]
        text = " ".join(words)
        if len(words) <= 2 and _SPECIMEN.fullmatch(text):
            return text.strip(":# ")
    return ""


class _Growing:
    """A block that is being read."""

    def __init__(
        self,
        rows: Sequence[_Row],
        style: Style,
        head: Sequence[_Row],
        preamble: Sequence[tuple[str, ...]],
    ):
        self.style, self.preamble = style, tuple(preamble)
        self.width = len(rows[0][1])
        alike = [f for _, f in rows[:_LOOKED_AT] if len(f) == self.width]
        self.numeric = [
            k
            for k in range(self.width)
            if 2 * sum(bool(style.plain(f[k])) or _nan(f[k]) for f in alike) > len(alike)
        ]
        if len(self.numeric) < 2:  # the first row decides if the others are irregular
            self.numeric = [k for k, field in enumerate(rows[0][1]) if style.plain(field)]
        self.head = tuple(tuple(fields) for _, fields in head)
        self.pieces: list[Floats] = []
        self.lines: list[Ints] = []
        # A row with numbers above the first one is lost, unless it is a header.
        self.bad: list[_Row] = [
            row for row in head[-2:] if sum(bool(style.plain(f)) for f in row[1]) >= 2
        ]

    def fits(self, fields: list[str]) -> bool:
        """Whether a row has the width of the block, and numbers in its columns of numbers."""
        if len(fields) != self.width:
            return False
        given = [fields[k] for k in self.numeric]
        numbers = sum(bool(self.style.plain(field)) for field in given)
        return numbers >= min(1, len(given)) and all(
            is_missing(field) or self.style.plain(field) for field in given
        )

    def numbers_in(self, fields: Sequence[str]) -> bool:
        """Whether a row has numbers in columns that hold words here."""
        others = set(range(self.width)) - set(self.numeric)
        return any(self.style.plain(fields[k]) for k in others)

    def add(self, rows: Sequence[_Row]) -> int:
        """Add the first row and those after it that fit; return how many."""
        if self.add_columns(rows):
            return len(rows)
        count = 0
        while count < len(rows) and self.fits(rows[count][1]):
            count += 1
        good = rows[:count]
        plain = self.style.plain
        values = [[float(plain(f[k]) or "nan") for k in self.numeric] for _, f in good]
        self.pieces.append(np.array(values, float).reshape(count, len(self.numeric)))
        self.lines.append(np.array([line for line, _ in good]))
        return count

    def add_all(self, some: RowSource, line: int) -> int:
        """Add all rows and return how many; 0, and none added, if a row is irregular."""
        if (table := some.numbers(self.width, self.numeric)) is None:
            return 0
        self.pieces.append(table)
        self.lines.append(np.arange(line, line + len(table)))
        return len(table)

    def add_columns(self, rows: Sequence[_Row]) -> bool:
        """Add all rows without their words; False, and none added, if a row is irregular."""
        lines, fields = zip(*rows, strict=True)
        if {len(f) for f in fields} != {self.width}:
            return False
        columns = list(zip(*fields, strict=True))
        piece = np.empty((len(rows), len(self.numeric)))
        for k, place in enumerate(self.numeric):
            text = "\n".join(columns[place])
            if self.style.decimal == ",":
                if "." in text:
                    return False
                text = text.replace(",", ".")
            if "_" in text or not text.isascii():
                return False
            try:
                piece[:, k] = list(map(float, text.split("\n")))
            except ValueError:
                return False
        # Row by row, an infinite number is a missing one, and a row of missing ones does not fit.
        if np.isinf(piece).any() or np.isnan(piece).all(axis=1).any():
            return False
        self.pieces.append(piece)
        self.lines.append(np.array(lines))
        return True

    def block(self, delimiter: str) -> NumberBlock:
        """The block with all its rows."""
        values = np.concatenate(self.pieces)
        bad = sorted((line, delimiter.join(fields)[:_SHOWN]) for line, fields in self.bad)
        columns = {place: values[:, k].copy() for k, place in enumerate(self.numeric)}
        return NumberBlock(
            self.head,
            self.preamble,
            columns,
            np.concatenate(self.lines),
            tuple(bad),
            self.width,
            _label([(0, list(fields)) for fields in self.head]),
        )


def _nan(field: str) -> bool:
    return bool(field.strip()) and is_missing(field)
