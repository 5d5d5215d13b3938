"""Names and units of the columns of a block of numbers."""

import re
import unicodedata
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from stepwell.base import GRAVITY, UNITS, Floats, spellings
from stepwell.lab.recordings.rows import split
from stepwell.lab.recordings.tables import NumberBlock

WEIGHTS = spellings("kg")
# Units of a column of each kind, with factors to SI. A mass is read as its weight.
_SI = {
    "time": "s",
    "stroke": "m",
    "force": "N",
    "volume": "m³",
    "pressure": "Pa",
    "angle": "rad",
    "torque": "N m",
}
FACTORS = {kind: {unit: UNITS[unit].size for unit in spellings(si)} for kind, si in _SI.items()}
FACTORS["force"] |= {unit: UNITS[unit].size * GRAVITY for unit in WEIGHTS}
UNIT_KIND = {unit: kind for kind, units in FACTORS.items() for unit in units}

# Units that are unambiguous in capitals too, unlike M and m, MN and mN, ML and mL.
_ANY_CASE = {
    *("mm", "cm", "in", "inch", "inches", "um"),
    *("g", "gf", "kg", "kgf", "oz", "ozf", "lb", "lbf"),
    *("sec", "min", "bar", "mbar", "psi", "deg"),
}
# Other spellings, in lower case.
_SPELLED = {
    spelling: unit
    for unit, others in {
        "N": "newton newtons",
        "kN": "kn kilonewton kilonewtons",
        "mN": "millinewton millinewtons",
        "cN": "centinewton centinewtons",
        "lb": "lbs pound pounds",
        "lbf": "pound-force lb-f lbsf",
        "kgf": "kp kg-f",
        "gf": "g-f gram-force grf",
        "kg": "kgs kilogram kilograms",
        "g": "gram grams gr",
        "oz": "ounce ounces",
        "m": "meter meters metre metres",
        "cm": "centimeter centimeters centimetre centimetres",
        "mm": "millimeter millimeters millimetre millimetres",
        "um": "micron microns micrometer micrometers micrometre micrometres",
        "s": "second seconds secs sek sekunden",
        "min": "minute minutes mins",
        "ms": "millisecond milliseconds msec",
        "kPa": "kpa kilopascal kilopascals",
        "Pa": "pascal pascals",
        "mL": "cc ccm milliliter milliliters millilitre millilitres",
        "L": "liter liters litre litres",
        "deg": "degree degrees",
        "rad": "radian radians",
        "N m": "n.m n*m n-m",
        "N mm": "n.mm n*mm n-mm",
        "N cm": "n.cm n*cm n-cm",
    }.items()
    for spelling in others.split()
}

_BRACKETS = re.compile(r"[(\[{]\s*([^()\[\]{}]*?)\s*[)\]}]")
# A unit at the end of a name: after a slash, a comma, "in", an underscore or a space.
_ENDS = (
    re.compile(r"^(.*\S)\s*/\s*(\S+(?: ?m{1,2})?)$"),
    re.compile(r"^(.*\S)\s*[,;:]\s*(\S+)$"),
    re.compile(r"^(.*\S)\s+in\s+(\S+)$", re.IGNORECASE),
    re.compile(r"^(.*[^\W_])_(\S+)$"),
    re.compile(r"^(.*[^\W_])\s+([^\s\d]+)$"),
)
_PREAMBLE = re.compile(r"^(.*?)\bunits?\b\s*[:=]?\s*(\S*)$", re.IGNORECASE)
_SIGNAL = re.compile(r"Sig\d+")
_COMMENT = "#%!*'/ \t"


class TableColumn(NamedTuple):
    """A column of a table.

    Attributes:
        number: counted from 1, as in the file.
        name: without its unit; empty if unknown.
        label: name and unit as in the file.
        unit: as in `FACTORS` if it is known there, else as in the file; empty for none.
        values: (n,) as in the file; None for words.
    """

    number: int
    name: str
    label: str
    unit: str
    values: Floats | None

    @property
    def kind(self) -> str:
        """The kind of quantity that the unit stands for, such as "force"; empty if unknown."""
        return UNIT_KIND.get(self.unit, "")

    @property
    def si(self) -> Floats:
        """Values in SI; the unit must be known."""
        assert self.values is not None
        return self.values * FACTORS[self.kind][self.unit]

    @property
    def range(self) -> str:
        """Least and largest value."""
        if self.values is None:
            return "words"
        good = self.values[np.isfinite(self.values)]
        return f"{np.min(good):.5g} to {np.max(good):.5g}" if len(good) else "no numbers"

    def __str__(self):
        named = f" {self.name[:40]!r}" if self.name else ""
        return f"column {self.number}{named}" + f" [{self.unit[:20]}]" * bool(self.unit)


def spelled(unit: str) -> str:
    """A unit as in `FACTORS` if it is known in this or another spelling, else unchanged."""
    text = unicodedata.normalize("NFC", unit).strip().rstrip(".")
    text = text.replace("\u03bc", "\u00b5").replace("\u00ba", "°").strip('"') or unit.strip()
    if text in UNIT_KIND:
        return text
    lower = text.lower()
    if lower in _ANY_CASE:
        return lower
    return _SPELLED.get(lower, text)


def columns(block: NumberBlock, delimiter: str | None) -> list[TableColumn]:
    """All columns of a block, with names and units from the lines above it."""
    names, units = _headings(block, delimiter)
    given = _in_preamble(block)
    found: list[TableColumn] = []
    for k in range(block.width):
        name, unit = names[k], units[k]
        bare, own = parted(name)
        unit = spelled(unit) or own
        if not unit and k in given:
            unit = given[k]
        found.append(TableColumn(k + 1, bare, name, unit, block.columns.get(k)))
    return found


def preamble_units(block: NumberBlock) -> dict[str, str]:
    """Units by kind that the first lines of a file name, as in `Travel Unit: mm`."""
    found: dict[str, set[str]] = {}
    for fields in (*block.preamble, *block.head):
        for text in {"".join(fields[:1]), ": ".join(f.strip() for f in fields[:2] if f.strip())}:
            match = _PREAMBLE.match(text.strip(_COMMENT))
            if match and (unit := spelled(match[2].strip("()[]"))) in UNIT_KIND:
                found.setdefault(UNIT_KIND[unit], set()).add(unit)
    return {kind: units.pop() for kind, units in found.items() if len(units) == 1}


def _in_preamble(block: NumberBlock) -> dict[int, str]:
    """Units of a LabVIEW measurement file by index of the column."""
    for fields in (*block.preamble, *block.head):
        if fields and fields[0] == "Y_Unit_Label":
            units = {k: spelled(unit) for k, unit in enumerate(fields) if k and unit}
            return {0: "s", **units}
    return {}


def parted(name: str) -> tuple[str, str]:
    """Name and unit of a heading: in brackets, or at its end if the unit is known."""
    text = name.strip()
    inner = [(match, spelled(match[1])) for match in _BRACKETS.finditer(text)]
    known = [one for one in inner if one[1] in UNIT_KIND]
    if known or (inner and inner[-1][0].end() == len(text)):
        match, unit = (known or inner)[-1]
        return f"{text[: match.start()]} {text[match.end() :]}".strip(), unit
    for pattern in _ENDS:
        if (match := pattern.match(text)) and (unit := spelled(match[2])) in UNIT_KIND:
            return match[1].strip(), unit
    return text, ""


def _headings(block: NumberBlock, delimiter: str | None) -> tuple[list[str], list[str]]:
    """Names, and units of a line below the names; empty strings if there is none."""
    empty = [""] * block.width
    rows = list(filter(None, (_fitted(fields, block, delimiter) for fields in block.head)))
    if not rows:
        return _signals(block) or empty, empty
    units, below_names, are_names = _as_units(rows[-1])
    if below_names and len(rows) > 1:
        return [parted(field)[0] or field for field in rows[-2]], units
    return rows[-1], units if are_names else empty


def _signals(block: NumberBlock) -> list[str]:
    """Names of a file of TA Instruments, with a line such as "Sig1 Time (min)" for each column."""
    lines = (fields for fields in (*block.preamble, *block.head) if len(fields) > 1)
    named = {f: " ".join(rest).strip() for f, *rest in lines if _SIGNAL.fullmatch(f.strip())}
    return [*named.values()] if len(named) == block.width else []


def _as_units(fields: Sequence[str]) -> tuple[list[str], bool, bool]:
    """Fields without brackets; whether they are units below names, or the only names."""
    units = [field.strip("()[] ") for field in fields]
    known, filled = sum(spelled(unit) in UNIT_KIND for unit in units), sum(map(bool, units))
    bracketed = all(not field or _BRACKETS.fullmatch(field) for field in fields)
    below_names = bracketed or 2 * known >= max(filled, 2)
    return units, below_names, known == filled > 1 and not bracketed


def _fitted(fields: Sequence[str], block: NumberBlock, delimiter: str | None) -> list[str]:
    """A line above the numbers as one field for each column; empty if it does not fit."""
    for row in _splits(fields, delimiter):
        row = [field.strip().strip('"').strip() for field in row]
        while len(row) > block.width and (not row[-1] or row[-1].lower() == "comment"):
            row.pop()
        words = sum(bool(field) and not _is_number(field) for field in row)
        spare = set(range(len(row), block.width))
        fits = len(row) <= block.width and not spare & block.columns.keys()
        if fits and words >= 2 and 2 * words >= sum(map(bool, row)):
            return row + [""] * len(spare)
    return []


def _is_number(field: str) -> bool:
    return re.fullmatch(r"[-+]?[\d.,]+(?:[eE][-+]?\d+)?", field) is not None


def _splits(fields: Sequence[str], delimiter: str | None) -> Iterator[list[str]]:
    """The fields of a line, without a comment sign, by this and by other delimiters."""
    first = "".join(fields[:1]).lstrip(_COMMENT)
    yield [first, *fields[1:]] if first or len(fields) > 1 else []
    if not first and len(fields) > 1:  # a comment sign with a delimiter after it
        yield list(fields[1:])
    text = (delimiter or " ").join([first, *fields[1:]]).strip()
    for other in (";", "\t", ",", "|", None):
        if other != delimiter and text:
            yield from split(iter([text]), other)
