"""Every specimen in a file, in SI: the one path from bytes to stroke and force."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import accumulate
from typing import NamedTuple

import numpy as np

from stepwell.base import (
    GRAVITY,
    Floats,
    InputError,
    Measure,
    amount,
    counted,
    display_unit,
    to_unit,
)
from stepwell.lab.recordings import columns as headings, roles, signs
from stepwell.lab.recordings.reading import Reading
from stepwell.lab.recordings.recording import direction_of, halves_of, turns_of
from stepwell.lab.recordings.roles import Taken
from stepwell.lab.recordings.rows import Style, TableText, is_workbook, sheets
from stepwell.lab.recordings.tables import NumberBlock, blocks

_SHOWN = 40
_DIGITS = 6  # decimal places, more than any reading has
_MANY = 20  # rows
_STEP_ROWS = 20_000  # rows that show the resolution


class Specimen(NamedTuple):
    """One specimen of a file.

    Attributes:
        label: its name among the others of the file, such as "2"; empty if it is alone.
        measure: quantities of travel and force.
        time: (n,) [s]; NaN if not recorded.
        travel, force: (n,) in SI.
        remarks: rows that are left out, and the like.
        reading: how it was read, a line each: columns, signs, part.
        gauge: least length [m], if the file contains the length of a band.
        steps: resolutions of travel and force from their digits, 0 if unknown.
        lost: lines of the file that could not be used, as (line, text).
        other_flip: the value of `flip` that may be right too, if the signs are not decided.
    """

    label: str
    measure: Measure
    time: Floats
    travel: Floats
    force: Floats
    remarks: tuple[str, ...]
    reading: tuple[str, ...]
    gauge: float | None
    steps: tuple[float, float]
    lost: tuple[tuple[int, str], ...] = ()
    other_flip: str = ""


def samples(
    content: bytes, reading: Reading | None = None, measures: Iterable[Measure] = Measure
) -> list[Specimen]:
    """All specimens in the bytes of a file, as far as they have columns of these measures.

    Raises:
        ValueError: the file is broken, binary or empty, or no reading stands out (`Unclear`).
    """
    reading = reading or Reading()
    found: list[Specimen] = []
    problems: list[tuple[int, InputError, str]] = []
    for sheet, block, delimiter in _tables(content, reading):
        try:
            found += _of_block(block, delimiter, reading, list(measures), sheet)
        except InputError as error:
            first, last = int(block.lines[0]), int(block.lines[-1])
            place = f"{sheet}: " * bool(sheet) + f"lines {first} to {last}"
            problems.append((len(block), error, place))
    if not found:
        raise max(problems, key=lambda one: one[0])[1]
    notes = tuple(f"{place} are not read: {error}" for _, error, place in problems)
    if reading.sample is not None:
        if reading.sample > len(found):
            raise InputError(f"sample = {reading.sample}: the file has {len(found)}.")
        found = [found[reading.sample - 1]._replace(label="")]
    elif len(found) > 1:
        found = [
            one._replace(
                label=one.label or f"{k}",
                remarks=(f"specimen {k} of {len(found)} in the file", *one.remarks),
            )
            for k, one in enumerate(_labelled(found), 1)
        ]
    else:
        found = [found[0]._replace(label="")]
    return [one._replace(remarks=(*one.remarks, *notes)) for one in found]


def listed(
    content: bytes, reading: Reading | None = None, measures: Iterable[Measure] = Measure
) -> list[tuple[str, ...]]:
    """Rows of the columns of the longest table of a file: number, name, unit, range, role.

    Raises:
        ValueError: the file is broken, binary or empty.
    """
    reading = reading or Reading()
    tables = [(block, delimiter) for _, block, delimiter in _tables(content, reading)]
    block, delimiter = max(tables, key=lambda one: len(one[0]))
    columns = headings.columns(block, delimiter)
    return roles.listed(columns, headings.preamble_units(block), reading, measures)


def _labelled(found: Sequence[Specimen]) -> list[Specimen]:
    """Samples whose labels differ, or none has one."""
    labels = [one.label for one in found]
    alone = len(set(labels)) == len(labels)
    return [one if alone else one._replace(label="") for one in found]


def _tables(content: bytes, reading: Reading) -> Iterator[tuple[str, NumberBlock, str | None]]:
    """Blocks of numbers, each with the name of its sheet and the delimiter."""
    if not is_workbook(content):
        text = TableText.of(content, reading.skip, reading.decimal)
        for block in blocks(text.chunks(), text.style, roles.names_columns, text.delimiter or " "):
            yield "", block, text.delimiter
        return
    nothing: InputError | None = None
    any_block = False
    for name, rows in sheets(content, reading.skip):
        try:
            for block in blocks(rows, Style(), roles.names_columns, ", "):
                any_block = True
                yield name, block, "\t"
        except InputError as error:
            nothing = error
    if not any_block:
        raise nothing or InputError("has no sheet with numbers.")


def _of_block(
    block: NumberBlock, delimiter: str | None, reading: Reading, measures: list[Measure], sheet: str
) -> list[Specimen]:
    if len(block.bad) > len(block):
        number, line = block.bad[0]
        raise InputError(
            f"{len(block.bad)} of {len(block) + len(block.bad)} rows are no {block.width} numbers "
            f"(line {number}: {line!r}): export it again."
        )
    if len(block) < 2:
        raise InputError(f"holds {len(block)} row of numbers: a recording has 2 or more.")
    columns = headings.columns(block, delimiter)
    taken = roles.choose(columns, headings.preamble_units(block), reading, measures)
    made = [_sample(one, block, reading, beside=len(taken) > 1) for one in taken]
    names = _group_names(block, taken) if len(taken) > 1 else [""]
    words = [c for c in columns if c.values is None and c.name]
    note = ", ".join(repr(c.name[:_SHOWN]) for c in words[:4]) + ", ..." * (len(words) > 4)
    remark = (f"column {note} contains words: not read",) if words else ()
    return [
        one._replace(label=" ".join(filter(None, label)), remarks=(*remark, *one.remarks))
        for one, *label in zip(
            made, [sheet] * len(made), [block.label] * len(made), names, strict=True
        )
    ]


def _group_names(block: NumberBlock, taken: Sequence[Taken]) -> list[str]:
    """Names of specimens beside each other, from a line above with one name for each."""
    firsts = [min(one.travel.number, one.force.number) for one in taken]
    for fields in block.head:
        places = [k for k, field in enumerate(fields, 1) if field.strip()]
        own = [max((p for p in places if p <= first), default=0) for first in firsts]
        if len(places) == len(taken) and own == places:
            return [fields[p - 1].strip()[:_SHOWN] for p in places]
    return [""] * len(taken)


def _sample(taken: Taken, block: NumberBlock, reading: Reading, beside: bool) -> Specimen:
    """Stroke and force of the chosen columns, with signs and zero, and the requested part."""
    travel, force = taken.travel.si, taken.force.si
    good = np.isfinite(travel) & np.isfinite(force)
    time = np.full(len(travel), np.nan) if taken.time is None else taken.time.si
    if 2 * np.count_nonzero(np.isfinite(time)) > len(time):
        good &= np.isfinite(time)
    lost = list(block.bad)
    if not np.all(good):
        where = np.flatnonzero(~good)
        ends = np.flatnonzero(good)
        if beside and len(ends):  # a shorter specimen than the one beside it
            where = where[where < ends[-1]]
        lost += [(int(block.lines[k]), _row_text(block, int(k))) for k in where[:1000]]
    if np.count_nonzero(good) < 2:
        count = int(np.count_nonzero(good))
        raise InputError(f"holds {count} row of numbers: a recording has 2 or more.")
    time, travel, force = time[good], travel[good], force[good]
    lost.sort()
    remarks = _lost(lost, int(block.lines[-1]))
    lines = [f"{taken.measure.stroke}: {taken.travel}", f"{taken.measure.force}: {taken.force}"]
    if taken.time is None:
        remarks.append("no time column, so its rate is unknown")
    gauge = None
    if taken.measure is Measure.TRAVEL and _is_length(taken):
        gauge = float(np.min(travel))
        travel = travel - gauge
        shown = to_unit(gauge, "mm")
        remarks.append(f"its length is that of the band: stroke counts from {shown:.5g} mm")
    if taken.force.unit in headings.WEIGHTS:
        remarks.append(f"{taken.force.unit} are weights: 1 kg is {GRAVITY} N, positive pulls")
    made = Specimen(
        "",
        taken.measure,
        time,
        travel,
        force,
        tuple(remarks),
        tuple(lines),
        gauge,
        (_step(taken.travel), _step(taken.force)),
        tuple(lost),
    )
    return _described(_part(_signed(_without_return(made), reading), reading), taken)


def _is_length(taken: Taken) -> bool:
    lower = taken.travel.name.lower()
    is_length = any(word in lower for word in ("length", "länge"))
    return is_length and not roles.is_called(lower, "stroke")


def _row_text(block: NumberBlock, k: int) -> str:
    return " ".join(f"{values[k]:.6g}" for values in block.columns.values())[:_SHOWN]


def _signed(one: Specimen, reading: Reading) -> Specimen:
    """The sample with the signs that are requested, or that the work decides."""
    if reading.flip is not None:
        chosen = signs.turned(reading.flip)
    else:
        chosen = signs.decided(one.travel, one.force)
        if not chosen.why:
            raise signs.UnclearSigns(
                "the work of loading does not decide whether the force is counted negative: give "
                "--flip none, --flip force, --flip stroke or --flip both."
            )
    travel, lines = one.travel * chosen.stroke, [f"signs: {chosen.reason}"]
    if signs.is_far(travel) and one.gauge is None:
        unit, factor = display_unit(one.measure.travel_unit)
        begin = f"{one.measure.stroke} counts from the first sample"
        lines.append(f"zero: {begin}, {one.travel[0] * factor:.6g} {unit} in the file")
        travel = travel - travel[0]
    return one._replace(
        travel=travel,
        force=one.force * chosen.force,
        reading=(*one.reading, *lines),
        other_flip=chosen.other,
    )


def _part(one: Specimen, reading: Reading) -> Specimen:
    """The requested half or cycle."""
    half = None if reading.half == "both" else reading.half
    keys = {"half": half, "cycle": reading.cycle}
    asked = " ".join(f"{key} = {value!r}" for key, value in keys.items() if value is not None)
    if not asked:
        return one
    parts = _numbered_halves(one.travel)
    total = parts[-1].cycle
    wanted = [p for p in parts if half in (None, p.direction) and reading.cycle in (None, p.cycle)]
    if not wanted:
        has = f"the file has {counted(total, 'cycle')}"
        raise InputError(f"{asked}: the file has no such half ({has}).")
    number = wanted[0].cycle
    first = [part.rows for part in wanted if part.cycle == number]
    rows = slice(first[0].start, first[-1].stop)
    shown = f"the {half} half of " * (half is not None)
    return one._replace(
        time=one.time[rows],
        travel=one.travel[rows],
        force=one.force[rows],
        reading=(*one.reading, f"part: {shown}cycle {number} of {total}"),
    )


def _without_return(one: Specimen) -> Specimen:
    """The sample without a first or last row that is one jump over most of the travel."""
    turns = turns_of(one.travel)
    span = float(np.ptp(one.travel))
    keep, jumps = slice(None), list[str]()
    if len(one.travel) >= _MANY and turns:
        ends = {"first": (0, turns[0]), "last": (turns[-1], len(one.travel) - 1)}
        for place, (a, b) in ends.items():
            jump = abs(float(one.travel[b] - one.travel[a]))
            if b - a == 1 and jump >= 0.5 * span:
                shown = amount(jump, one.measure.travel_unit)
                jumps.append(f"the {place} row is {shown} away from the one beside it: left out")
                keep = slice(1, keep.stop) if place == "first" else slice(keep.start, -1)
    return one._replace(
        time=one.time[keep],
        travel=one.travel[keep],
        force=one.force[keep],
        remarks=(*one.remarks, *jumps),
    )


class _Half(NamedTuple):
    rows: slice
    direction: str
    cycle: int


def _numbered_halves(travel: Floats) -> list[_Half]:
    """All halves; a cycle is a loading half and the unloading half after it, or either alone."""
    rows = halves_of(travel)
    directions = [direction_of(travel[half]) for half in rows]
    begins = (int(k == 0 or one == "loading") for k, one in enumerate(directions))
    return list(map(_Half, rows, directions, accumulate(begins)))


def _described(one: Specimen, taken: Taken) -> Specimen:
    """The sample with the ranges of its travel and its force in the first two lines."""
    lines = list(one.reading)
    units = one.measure.travel_unit, one.measure.force_unit
    for k, (values, si) in enumerate(zip((one.travel, one.force), units, strict=True)):
        unit, factor = display_unit(si)
        low, high = (np.min(values) * factor + 0.0, np.max(values) * factor + 0.0)
        lines[k] += f", {low:.4g} to {high:.4g} {unit}"
    if taken.time is not None:
        lines.insert(2, f"time: {taken.time}")
    return one._replace(reading=tuple(lines))


def _step(column: headings.TableColumn) -> float:
    """Resolution of the digits of a column in SI, such as 0.5 for 12.5, 14.0, 15.5; 0 for none.

    It is 1 or 5 in the last decimal place, and at most 1: weights of 50 g are set, not read.
    """
    assert column.values is not None
    values = column.values[np.isfinite(column.values)][:_STEP_ROWS]
    size = headings.FACTORS[column.kind][column.unit]
    for digits in range(_DIGITS + 1):
        counts = values * 10.0**digits
        whole = np.round(counts)
        if np.all(np.abs(counts - whole) < 1e-9 * np.maximum(np.abs(counts), 1.0)):
            halves = digits > 0 and len(values) > 2 and bool(np.all(whole % 5 == 0))
            return (5.0 if halves else 1.0) * 10.0**-digits * size
    return 0.0


def _lost(lost: Sequence[tuple[int, str]], last: int) -> list[str]:
    """Remarks on rows that are left out."""
    remarks: list[str] = []
    if lost and lost[-1][0] > last:
        number, line = lost[-1]
        remarks.append(f"the last row is cut off (line {number}: {line!r})")
        lost = lost[:-1]
    if lost:
        number, line = lost[0]
        rows = "row is" if len(lost) == 1 else "rows are"
        remarks.append(f"{len(lost)} {rows} left out (first line {number}: {line!r})")
    return remarks
