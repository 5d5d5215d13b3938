"""Rows of fields in a file: a text of any encoding and style, or the sheets of a workbook."""

import codecs
import csv
import datetime
import io
import re
import zipfile
import zlib
from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any, NamedTuple

import numpy as np

from stepwell import base
from stepwell.base import Floats, InputError

_DELIMITERS = (";", "\t", ",", "|", None)  # None splits at white space
CHUNK = 5000  # lines converted at once, or one by one if one of them is irregular
_LOOKED_AT = 400  # lines that decide on the delimiter
_LONGEST = 1 << 20  # characters of a line
_NUL = "is binary, not text: export the raw data as text, CSV or a workbook."

# Look-alikes in numbers: minus signs, and spaces and quotes between thousands.
_ALIKE = str.maketrans({"\u2212": "-", "\u2013": "-", "\u00a0": "", "\u202f": "", "'": ""})
_EXPONENT = r"(?:[eE][-+]?\d{1,3})?"
_OPEN, _CLOSE = r"(?<![\w.,:/-])[-+]?", rf"{_EXPONENT}(?![\w.,:/])"
# Programs write these words for missing numbers.
_MISSING = re.compile(
    r"[-+]?(?:nan|inf(?:inity)?|n/?a|#n/?a|none|null|-+|#[A-Z/0]+[!?])?", re.IGNORECASE
)


class Style(NamedTuple):
    """How the numbers of a file are written: decimal mark, and the mark between thousands."""

    decimal: str = "."
    thousands: str = ","

    def plain(self, field: str) -> str:
        """The number of a field as Python writes it; empty if it is none or missing."""
        text = field.strip().translate(_ALIKE)
        if not _number(self.decimal).fullmatch(text):
            return ""
        return text.replace(self.thousands, "").replace(self.decimal, ".").replace(" ", "")


_POINT, _COMMA = Style(), Style(",", ".")
_NUMBERS = {
    mark: re.compile(
        rf"[-+]?(?:[0-9]+|[0-9]{{1,3}}(?:[{other} ][0-9]{{3}})+|(?=[{mark}][0-9]))"
        rf"(?:[{mark}][0-9]*)?(?:[eE][-+]?[0-9]{{1,3}})?"
    )
    for mark, other in (_POINT, _COMMA)
}


def _number(mark: str) -> re.Pattern[str]:
    return _NUMBERS[mark]


def is_missing(field: str) -> bool:
    """Whether a field stands for a number that is missing."""
    return _MISSING.fullmatch(field.strip()) is not None


class TableText(NamedTuple):
    """A decoded text with its delimiter and the style of its numbers."""

    data: bytes  # in UTF-8
    delimiter: str | None
    style: Style

    @classmethod
    def of(cls, data: bytes, skip: int = 0, decimal: str | None = None) -> "TableText":
        """Decode the bytes, without their first lines, and find delimiter and style.

        Raises:
            ValueError: the data are empty or no text, or the style of its numbers is ambiguous.
        """
        if not data.strip():
            raise InputError("is empty: export it again.")
        text = decoded(data)
        if skip:
            rest = re.split(r"\r\n|\r|\n", text, maxsplit=skip)
            text = rest[-1] if len(rest) > skip else ""
        lines = list(islice(_lines(text), _LOOKED_AT))
        if any(len(line) > _LONGEST for line in lines):
            raise InputError(f"has a line of more than {_LONGEST} characters: export it again.")
        delimiter, start = _delimiter_of(lines)
        body = text[start:] if start < len(text) else text
        style = {None: None, ".": _POINT, ",": _COMMA}[decimal] or _style_of(body, delimiter)
        return cls(text.encode("utf-8", "replace"), delimiter, style)

    def chunks(self) -> "Iterator[Chunk]":
        """All lines, some at a time."""
        with io.TextIOWrapper(io.BytesIO(self.data), "utf-8", newline="") as lines:
            while some := list(islice(lines, CHUNK)):
                yield Chunk(some, self.delimiter, self.style)


class Chunk(NamedTuple):
    """Consecutive lines of a text."""

    lines: list[str]
    delimiter: str | None
    style: Style

    def rows(self) -> list[list[str]]:
        """Fields of every line, by the rules of Python's csv module."""
        return list(split(iter(self.lines), self.delimiter))

    def numbers(self, width: int, places: Sequence[int]) -> Floats | None:
        """(n, len(places)) numbers in these of `width` columns; None if a row is irregular.

        By NumPy's reader, up to ten times as fast as row by row.
        """
        lines, text, whole = self.lines, "".join(self.lines), len(places) == width
        if not self._is_regular(text, width, whole):
            return None
        if '"' in text:
            lines = [line.replace('"', "") for line in lines]
        if self.style.decimal == ",":
            lines = [line.replace(",", ".") for line in lines]
        some = None if whole else places
        try:
            table = np.loadtxt(
                lines, delimiter=self.delimiter, comments=None, ndmin=2, usecols=some
            )
        except (ValueError, OverflowError):
            return None
        return table if table.shape == (len(lines), len(places)) else None

    def _is_regular(self, text: str, width: int, whole: bool) -> bool:
        """Whether NumPy reads the lines of this text as they are meant."""
        if self.style.decimal == "," and (self.delimiter == "," or "." in text):
            return False
        marks = {'"': 2 * width} if '"' in text else {}
        if not whole:  # NumPy ignores further fields
            if self.delimiter is None:
                return False
            marks[self.delimiter] = width - 1
        return all(line.count(mark) == n for mark, n in marks.items() for line in self.lines)


def split(lines: Iterator[str], delimiter: str | None) -> Iterator[list[str]]:
    """Fields of lines; delimiter None splits at white space."""
    if delimiter is None:
        for line in lines:
            text = line.rstrip("\r\n")
            for part in re.split(r"[\r\n]", text) if "\r" in text or "\n" in text else (text,):
                yield _words(part)
        return
    try:
        yield from csv.reader(lines, delimiter=delimiter, skipinitialspace=True)
    except csv.Error as error:
        raise InputError(f"is no table of text ({error}): export it again.") from None


# A word may have a unit in brackets after it.
_WORD = re.compile(r'"[^"]*"|[^\s(\["]+(?:\s*[(\[][^)\]]*[)\]])?|[(\[][^)\]]*[)\]]|\S+')


def _words(line: str) -> list[str]:
    if "(" in line or "[" in line or '"' in line:
        return [word.strip('"') for word in _WORD.findall(line)]
    return line.split()


def _lines(text: str) -> Iterator[str]:
    return (match[0] for match in re.finditer(r"[^\r\n]*(?:\r\n|\r|\n)|[^\r\n]+", text))


def decoded(data: bytes) -> str:
    """The text of bytes in UTF-8, UTF-16 or an encoding that charset-normalizer recognises.

    Raises:
        ValueError: the data are binary.
    """
    utf_16 = {codecs.BOM_UTF16_LE: "utf-16", codecs.BOM_UTF16_BE: "utf-16"}.get(data[:2])
    if utf_16 is None and b"\0" in data:
        ends = data[:4096:2].count(0), data[1:4096:2].count(0)
        size = min(len(data), 4096) // 2
        if size < 8 or max(ends) < 0.8 * size or min(ends) > 0:
            raise InputError(_NUL)
        utf_16 = "utf-16-be" if ends[0] > ends[1] else "utf-16-le"
    try:
        text = data.decode(utf_16 or "utf-8-sig")
    except UnicodeDecodeError as error:
        if utf_16:
            raise InputError(_NUL) from None
        text = _of_old_encoding(data, error.start)
    if "\0" in text:
        raise InputError(_NUL)
    return text


def _of_old_encoding(data: bytes, start: int) -> str:
    """The text of an encoding without a mark: two-byte characters come in runs, others do not."""
    part = data[max(0, start - 2000) : start + 20000]
    encoding = "cp1252"
    if re.search(rb"[\x81-\xfe][\x40-\xfe][\x81-\xfe][\x40-\xfe]", part):
        from charset_normalizer import from_bytes

        best = from_bytes(
            part, cp_isolation=["gb18030", "big5", "shift_jis", "euc_kr", "cp1252"]
        ).best()
        encoding = encoding if best is None else best.encoding
    for one in (encoding, "cp1252"):
        try:
            return data.decode(one)
        except UnicodeDecodeError:
            continue
    return data.decode("latin-1")


def _delimiter_of(lines: list[str]) -> tuple[str | None, int]:
    """The delimiter with most rows of numbers; the place of its first row in the text."""
    best: tuple[float, str | None, int] = (0.0, None, 0)
    for delimiter in _DELIMITERS:
        score, first = 0.0, -1
        for k, line in enumerate(lines):
            if delimiter is not None and delimiter not in line:
                continue  # one field
            (fields,) = split(iter([line]), delimiter) if line.strip() else ([],)
            numbers = sum(bool(_POINT.plain(f) or _COMMA.plain(f)) for f in fields)
            if numbers >= 2:
                score += numbers / sum(bool(f.strip()) for f in fields)
                first = k if first < 0 else first
        if score > best[0] + 1e-9:
            best = score, delimiter, first
    if not best[0]:
        raise InputError(
            "holds no row of two or more numbers: a recording is rows of time, displacement and "
            "force."
        )
    return best[1], sum(map(len, lines[: best[2]]))


class _Evidence:
    """Whether numbers of a text use a mark before decimals, between thousands, or in any way."""

    def __init__(self, text: str, mark: str, other: str):
        m, o = re.escape(mark), re.escape(other)
        end = r"(?![\w.,:/])"
        self._text = text if mark in text else ""
        self._decimal = (
            rf"{_OPEN}(?:(?:0|[0-9]{{4,}})?{m}[0-9]+|[0-9]{{1,3}}{m}(?:[0-9]{{1,2}}|[0-9]{{4,}})?)"
            rf"{_CLOSE}|{_OPEN}[0-9]{{1,3}}(?:{o}[0-9]{{3}})+{m}[0-9]*{_CLOSE}"
            rf"|{_OPEN}[0-9]{m}[0-9]+[eE][-+]?[0-9]{{1,3}}{end}"
        )
        self._grouped = rf"{_OPEN}[0-9]{{1,3}}(?:{m}[0-9]{{3}}){{2,}}{end}"
        self._either = rf"{_OPEN}[0-9]{{1,3}}{m}[0-9]{{3}}{end}"

    def decimal(self) -> bool:
        """Whether a number cannot be read but with the mark before its decimals."""
        return re.search(self._decimal, self._text) is not None

    def grouped(self) -> bool:
        """Whether a number cannot be read but with the mark between its thousands."""
        return re.search(self._grouped, self._text) is not None

    def either(self) -> str:
        """A number that can be read in both ways; empty for none."""
        match = re.search(self._either, self._text)
        return match[0] if match else ""


def _style_of(body: str, delimiter: str | None) -> Style:
    """The style of the numbers, decided by the whole file."""
    commas = body
    if delimiter == ",":
        if '"' not in body:
            return _POINT
        commas = "\n".join(re.findall(r'"([-+0-9.,eE \u2212]+)"', body))
        if "," not in commas:
            return _POINT
        points = re.sub(r'"[^"]*"', "", body).replace(",", "\n") + "\n" + commas
    elif "," not in body:
        return _POINT
    else:
        points = body
    comma, point = _Evidence(commas, ",", "."), _Evidence(points, ".", ",")
    by_comma, by_point = comma.decimal(), point.decimal()
    if by_comma and by_point:
        raise InputError(
            "has numbers with a decimal comma and others with a decimal point: export it with one."
        )
    if by_comma or (not by_point and point.grouped()):
        return _COMMA
    if not by_point and not comma.grouped() and (number := comma.either()):
        raise InputError(
            f"{number!r} may have a decimal comma or one between thousands, and no other number "
            f"decides: give --decimal , or --decimal . for a decimal point."
        )
    return _POINT


_ZIP, _OLE = b"PK\x03\x04", b"\xd0\xcf\x11\xe0"
# A workbook of zeros may unpack to a thousand times its size.
_MOST_UNPACKED = 1 << 30
_RATIO = 200
# The reader keeps every cell between the first and the last, about 30 bytes each.
_MOST_CELLS = 30 << 20
_WIDE = (
    (16384, rb'<c [^>]*?\br="[A-Z]{3}\d'),
    (702, rb'<c [^>]*?\br="[C-Z][A-Z]\d'),
    (78, rb'<c [^>]*?\br="[A-Z]{2}\d'),
)
# Cells of an ods sheet that hold a value and are repeated.
_REPEATED = (
    rb'<table:table-cell(?=[^>]*office:value)[^>]*columns-repeated="\d{4,}"'
    rb'|<table:table-row[^>]*rows-repeated="\d{5,}"[^>]*>(?:(?!</table:table-row>).){0,4096}'
    rb"office:value"
)


def is_workbook(content: bytes) -> bool:
    """Whether a file begins as an xlsx, ods or xls workbook does."""
    return content[:4] in (_ZIP, _OLE)


class Cells(NamedTuple):
    """Consecutive rows of a sheet."""

    cells: list[list[Any]]

    def rows(self) -> list[list[str]]:
        """Fields of every row."""
        return [[_field(cell) for cell in row] for row in self.cells]

    def numbers(self, width: int, places: Sequence[int]) -> Floats | None:
        """(n, len(places)) numbers in these of `width` columns; None if a row is irregular."""
        if {len(row) for row in self.cells} != {width}:
            return None
        some = [[row[k] for k in places] for row in self.cells]
        kinds = {type(cell) for row in some for cell in row}
        return np.array(some, float) if kinds <= {float, int} else None


def sheets(content: bytes, skip: int = 0) -> Iterator[tuple[str, Iterator[Cells]]]:
    """Name and rows of every sheet, without its first rows.

    Raises:
        ValueError: the workbook is broken or unpacks to more than 1 GiB.
        ExtraError: python-calamine is not installed.
    """
    if content[:4] == _ZIP:
        _refuse_bomb(content)
    base.need("tables")
    import python_calamine

    try:
        book = python_calamine.CalamineWorkbook.from_filelike(io.BytesIO(content))
        for name in book.sheet_names:
            rows = islice(book.get_sheet_by_name(name).iter_rows(), skip, None)
            yield name, map(Cells, iter(lambda rows=rows: list(islice(rows, CHUNK)), []))
    except InputError:
        raise
    except Exception as error:  # each format has errors of its own
        raise InputError(
            f"is no workbook that can be read ({type(error).__name__}): export it again as CSV."
        ) from None


def _refuse_bomb(content: bytes) -> None:
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            size = sum(one.file_size for one in archive.infolist())
            if size > min(_MOST_UNPACKED, max(_RATIO * len(content), 1 << 24)):
                raise InputError(
                    f"unpacks to {size >> 20} MiB, {size // max(len(content), 1)} times its size: "
                    f"export it again as CSV."
                )
            for name in archive.namelist():
                if name == "content.xml" or re.fullmatch(r"xl/worksheets/[^/]+\.xml", name):
                    _refuse_wide(archive.read(name))
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, OSError, zlib.error):
        raise InputError("is a broken workbook or archive: export it again.") from None


def _refuse_wide(sheet: bytes) -> None:
    """Refuse a sheet whose reader would need memory for cells that the file does not have."""
    wide = next((most for most, one in _WIDE if re.search(one, sheet)), 26)
    tall = max(map(int, re.findall(rb'<(?:row|c) [^>]*?\br="[A-Z]*(\d{1,9})"', sheet)), default=0)
    if wide * tall > _MOST_CELLS or re.search(_REPEATED, sheet):
        raise InputError(
            f"has a sheet of up to {tall} rows and {wide} columns: delete the cells beside the "
            f"table, or export it again as CSV."
        )


def _field(cell: Any) -> str:
    if isinstance(cell, bool):
        return str(cell)
    if isinstance(cell, float | int):
        return repr(cell)
    if isinstance(cell, datetime.timedelta):
        return repr(cell.total_seconds())
    return str(cell)
