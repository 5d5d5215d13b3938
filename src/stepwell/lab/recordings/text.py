"""Numbers in the text export of a test machine."""

import re
from typing import NamedTuple

import numpy as np

from stepwell.base import GRAVITY, Floats, InputError, Measure, to_unit
from stepwell.lab.recordings.columns import WEIGHTS, columns, pair, split

_NUMBER = re.compile(r"[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d{1,3})?")
# Programs write these words for missing numbers.
_MISSING = re.compile(r"[-+]?(?:nan|inf(?:inity)?)", re.IGNORECASE)
# Blanks last: a comma within a field between blanks is a decimal comma.
_DELIMITERS = (";", "\t", ",", None)
_HEADER_AT_MOST = 200
_SHOWN = 40
_DIGITS = 6  # decimal places, more than any reading has
_BLOCK = 5000  # rows read at once, or one by one if one of them is irregular


_Lines = list[tuple[int, str]]  # with their numbers


class Export(NamedTuple):
    """Content of the text in SI; `time` is NaN if not recorded.

    `gauge` is the least length if the file contains the length of a band; the stroke counts from
    it. `steps` are the resolutions of stroke and force from their digits, 0 if unknown.
    """

    time: Floats
    stroke: Floats
    force: Floats
    remarks: tuple[str, ...]
    gauge: float | None = None
    steps: tuple[float, float] = (0.0, 0.0)


def parse(data: bytes) -> Export:
    """The recording in a Bluehill "Raw Data" text or CSV whose header names columns and units.

    Raises:
        ValueError: the data are no text, without a header or numbers, or with an unknown unit.
    """
    lines, words = _without_words(_lines(data))
    header, delimiter, count, body = _parts(lines, "time, displacement and force")
    roles = columns(header, delimiter, count)
    rows, bad = _rows(body, delimiter, count)
    remarks = (*words, *_remarks(bad, body[-1][0]))
    if len(rows) < 2:
        raise InputError(f"holds {len(rows)} row of numbers: a recording has 2 or more.")
    values = {role: rows[:, one.place] * one.factor for role, one in roles.items()}
    time = values.get("time", np.full(len(rows), np.nan))
    if "time" not in values:
        remarks += ("no time column, so its rate is unknown",)
    gauge, way = None, "stroke"
    if "length" in values:
        gauge, way = float(np.min(values["length"])), "length"
        values["stroke"] = values["length"] - gauge
        remarks += (
            f"its length is that of the band: stroke counts from {to_unit(gauge, 'mm'):.5g} mm",
        )
    unit = roles["force"].unit
    if unit in WEIGHTS:
        remarks += (f"{unit} are weights: 1 kg is {GRAVITY} N, positive pulls",)
    u, force = (_step(rows[:, one.place]) * one.factor for one in (roles[way], roles["force"]))
    return Export(time, values["stroke"], values["force"], remarks, gauge, (u, force))


def parse_pair(data: bytes) -> tuple[Measure, Floats, Floats]:
    """Measure, travels and forces in SI of the curve in a table, as for `parse`.

    Raises:
        ValueError: as `parse`; also for any row without numbers, since no row is left out.
    """
    header, delimiter, count, body = _parts(_lines(data), "travel and force")
    # A header has no number for a field, but an unreadable row has.
    if header and any(map(_NUMBER.fullmatch, split(header[-1], delimiter))):
        raise InputError(
            f"the line before the first row of {count} numbers is no header "
            f"({header[-1][:_SHOWN]!r}): correct it or take it out."
        )
    measure, (x, x_factor), (y, y_factor) = pair(header, delimiter, count)
    rows, bad = _rows(body, delimiter, count)
    if bad:
        number, line = bad[0]
        raise InputError(
            f"line {number} is no row of {count} numbers ({line[:_SHOWN]!r}): correct it or take "
            f"it out."
        )
    return measure, rows[:, x] * x_factor, rows[:, y] * y_factor


def _step(values: Floats) -> float:
    """Resolution of the digits of a column, such as 0.5 for 12.5, 14.0, 15.5; 0 for none.

    It is 1 or 5 in the last decimal place, and at most 1: weights of 50 g are set, not read.
    """
    for digits in range(_DIGITS + 1):
        counts = values * 10.0**digits
        whole = np.round(counts)
        if np.all(np.abs(counts - whole) < 1e-9 * np.maximum(np.abs(counts), 1.0)):
            halves = digits > 0 and len(values) > 2 and bool(np.all(whole % 5 == 0))
            return (5.0 if halves else 1.0) * 10.0**-digits
    return 0.0


def _without_words(lines: list[str]) -> tuple[list[str], tuple[str, ...]]:
    """The lines without columns of words, if no row has numbers alone; and notes."""
    if _row_of_numbers(lines) is not None:
        return lines, ()
    for delimiter in (";", "\t", ","):
        fields = [split(line, delimiter) for line in lines]
        start = _begin(fields)
        width = len(fields[start])
        kept = _numeric([row for row in fields[start:] if len(row) == width], width)
        if not start or not 2 <= len(kept) < width:
            continue
        above = next((row for row in fields[start - 1 :: -1] if len(row) == width), [""] * width)
        notes = ", ".join(repr(above[k][:_SHOWN]) for k in range(width) if k not in kept)
        cut = [
            delimiter.join(row[k] for k in kept) if len(row) == width else line
            for row, line in zip(fields, lines, strict=True)
        ]
        return cut, (f"column {notes} contains words: not read",)
    return lines, ()


def _begin(rows: list[list[str]]) -> int:
    """Index of the first row with two numbers or more; 0 for none."""
    ahead = enumerate(rows[:_HEADER_AT_MOST])
    return next((n for n, row in ahead if sum(map(_is_number, row)) >= 2), 0)


def _numeric(rows: list[list[str]], width: int) -> list[int]:
    """Indices of the columns in which more than half of the fields are numbers, or missing."""

    def numbers(k: int) -> int:
        return sum(_is_number(row[k]) or bool(_MISSING.fullmatch(row[k])) for row in rows)

    return [k for k in range(width) if 2 * numbers(k) > len(rows)]


def _is_number(field: str) -> bool:
    return _NUMBER.fullmatch(field) is not None


def _parts(lines: list[str], example: str) -> tuple[list[str], str | None, int, _Lines]:
    """Header lines, delimiter, number of columns, and lines from the first numbers on."""
    first = _row_of_numbers(lines)
    if first is None:
        raise InputError(f"holds no row of two or more numbers: a recording is rows of {example}.")
    start, delimiter = first
    body = [(n, line) for n, line in enumerate(lines[start:], start + 1) if line.strip()]
    header = [line for line in lines[:start] if line.strip()]
    return header, delimiter, len(split(lines[start], delimiter)), body


def _lines(data: bytes) -> list[str]:
    if not data.strip():
        raise InputError("is empty: export it again.")
    utf_16 = data[:2] in (b"\xff\xfe", b"\xfe\xff")
    if b"\0" in data and not utf_16:
        raise InputError("is binary, not text: export the raw data as text or CSV.")
    try:
        text = data.decode("utf-16" if utf_16 else "utf-8-sig")
    except UnicodeDecodeError:
        # Old Windows programs encode degree and micro signs in this way.
        text = data.decode("latin-1")
    return re.split(r"\r\n|\r|\n", text)


def _row_of_numbers(lines: list[str]) -> tuple[int, str | None] | None:
    """Index and delimiter of the first line of numbers alone, two or more."""
    for at, line in enumerate(lines[:_HEADER_AT_MOST]):
        for delimiter in _DELIMITERS:
            fields = split(line, delimiter)
            if len(fields) >= 2 and all(map(_is_number, fields)):
                return at, delimiter
    return None


def _rows(body: _Lines, delimiter: str | None, count: int) -> tuple[Floats, _Lines]:
    """Readable rows, and the other lines with their numbers."""
    pieces: list[Floats] = []
    bad: _Lines = []
    for first in range(0, len(body), _BLOCK):
        block = body[first : first + _BLOCK]
        piece = _at_once([line for _, line in block], delimiter, count)
        pieces.append(_one_by_one(block, delimiter, count, bad) if piece is None else piece)
    good = np.concatenate(pieces)
    if len(bad) > len(good):
        number, line = bad[0]
        raise InputError(
            f"{len(bad)} of {len(body)} rows are no {count} numbers (line {number}: "
            f"{line[:_SHOWN]!r}): export it again."
        )
    return good, bad


def _one_by_one(block: _Lines, delimiter: str | None, count: int, bad: _Lines) -> Floats:
    """Readable rows of a block; other lines are added to `bad`."""
    good: list[list[float]] = []
    for number, line in block:
        fields = split(line, delimiter)
        if len(fields) == count and all(map(_NUMBER.fullmatch, fields)):
            row = [float(field.replace(",", ".")) for field in fields]
            if np.all(np.isfinite(row)):
                good.append(row)
                continue
        bad.append((number, line))
    return np.array(good).reshape(-1, count)


def _at_once(lines: list[str], delimiter: str | None, count: int) -> Floats | None:
    """All rows by NumPy's reader, ten times as fast; None if a row is irregular."""
    try:
        rows = np.loadtxt(lines, delimiter=delimiter, ndmin=2, comments=None)
    except ValueError:
        return None
    return rows if rows.shape[1] == count and np.all(np.isfinite(rows)) else None


def _remarks(bad: _Lines, last: int) -> list[str]:
    remarks: list[str] = []
    if bad and bad[-1][0] == last:
        remarks.append(f"the last row is cut off (line {last}: {bad[-1][1][:_SHOWN]!r})")
        bad = bad[:-1]
    if bad:
        number, line = bad[0]
        rows = "row is" if len(bad) == 1 else "rows are"
        remarks.append(f"{len(bad)} {rows} left out (first line {number}: {line[:_SHOWN]!r})")
    return remarks
