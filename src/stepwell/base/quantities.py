"""Schemas of results: names, units and words from which JSON, CSV, xarray and tables are made."""

import math
import os
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from operator import attrgetter
from types import UnionType
from typing import Any, TypeVar

from stepwell.base.units import UNITS, display_unit, in_names
from stepwell.base.value import is_array
from stepwell.base.write import csv_text, write_atomic

K = TypeVar("K")
V = TypeVar("V")
_RATIO = "over_"
_WORDS = re.compile(r"(?<![a-z])(travel|stroke|force)(?![a-z])")


class Measure(Enum):
    """The conjugate pair of a chain, travel and force or another one: words and SI units.

    All statements on travel and force hold for the other pairs too; `Quantity` and `display_unit`
    have the units of reports.

    Attributes:
        travel, force: the words for the displacement of a cell and for its resistance.
        travel_unit, force_unit, stiffness_unit: SI units of travel, force, and force over travel.
        symbols: the letters for stroke, travel and force.
    """

    TRAVEL = "travel", "m", "force", "N", "N/m", "usF"
    VOLUME = "volume", "m³", "pressure", "Pa", "Pa/m³", "Vvp"
    ANGLE = "angle", "rad", "torque", "N m", "N m/rad", "ΦφT"

    def __init__(
        self,
        travel: str,
        travel_unit: str,
        force: str,
        force_unit: str,
        by_travel: str,
        symbols: str,
    ):
        self.travel, self.travel_unit, self.symbols = travel, travel_unit, symbols
        self.force, self.force_unit, self.stiffness_unit = force, force_unit, by_travel

    @property
    def stroke(self) -> str:
        """The word for the displacement of the whole chain by the actuator."""
        return "stroke" if self is Measure.TRAVEL else self.travel

    @property
    def words(self) -> tuple[str, str, str]:
        """The words for travel, stroke and force."""
        return self.travel, self.stroke, self.force

    @property
    def units(self) -> tuple[str, str, str]:
        """The units in which travel, force and stiffness are reported."""
        travel, force, stiffness = self.travel_unit, self.force_unit, self.stiffness_unit
        return display_unit(travel)[0], display_unit(force)[0], display_unit(stiffness)[0]


@dataclass(frozen=True, slots=True)
class Quantity:
    """One name in the schema of a result.

    Args:
        name: of the attribute; JSON and CSV append the unit.
        unit: of reports, such as "mm"; "over_kr" and such for ratios; "" for words, counts and
            flags.
        head: heading of its column in tables, without the unit; "" for no column.
        read: another attribute, or a function of the value.
        form: digits in tables, or a format, or a function of the reported value.
        doc: its meaning, in words.
        none: text in tables for a missing value.
        left: whether its column is aligned at the left, as words are.
        dims: further dimensions in xarray.
        holds: its type in JSON: a type, a union of types, a schema, a list of one of these, or a
            dictionary from `str` to one of these. By default a number if it has a unit, else text.
            The unit is that of all numbers in it.
        missing: whether JSON may have null; numbers always may.
    """

    name: str
    unit: str = ""
    head: str = ""
    read: str | Callable[[Any], Any] = ""
    form: int | str | Callable[[Any], str] = 4
    doc: str = ""
    none: str = ""
    left: bool | None = None
    dims: tuple[str, ...] = ()
    holds: Any = None
    missing: bool = False

    @property
    def attribute(self) -> str:
        """The attribute that it reads; its own name if a function reads it."""
        return self.read if isinstance(self.read, str) and self.read else self.name

    @property
    def key(self) -> str:
        """The name with its unit."""
        return f"{self.name}_{in_names(self.unit)}" if self.unit else self.name

    @property
    def si(self) -> str:
        """The unit of the value itself."""
        return UNITS[self.unit].si if self.unit in UNITS else self.sign or "1"

    @property
    def factor(self) -> float:
        """How many of its unit make one SI unit."""
        return UNITS[self.unit].per_si if self.unit in UNITS else 1.0

    @property
    def sign(self) -> str:
        """The unit as written after a number; "" for a bare number."""
        if self.unit.startswith(_RATIO):
            return ""
        return UNITS[self.unit].sign if self.unit in UNITS else self.unit

    @property
    def heading(self) -> str:
        """The head of its column, with the unit; "" without a head."""
        return f"{self.head} [{self.sign}]" if self.head and self.sign else self.head

    @property
    def numeric(self) -> bool:
        """Whether its column holds numbers."""
        return bool(self.unit) if self.left is None else not self.left

    def of(self, value: Any) -> Any:
        """The quantity of a value, in SI."""
        return self.read(value) if callable(self.read) else _part(value, self.attribute)

    def cell(self, row: Mapping[str, Any]) -> str:
        """Its text in a table, read from a record."""
        return self.text(row[self.key])

    def text(self, value: Any) -> str:
        """The text in a table for a value of a record."""
        if value is None:
            return self.none
        if callable(self.form):
            return self.form(value)
        if isinstance(value, list):
            return ", ".join(map(self.text, value))
        if not isinstance(value, float):
            return str(value)
        return number(value, self.form) if isinstance(self.form, int) else f"{value:{self.form}}"


@dataclass(frozen=True, slots=True)
class Column:
    """A column of a table with text made from several quantities of a row."""

    heading: str
    cell: Callable[[Mapping[str, Any]], str]
    numeric: bool = False


def _part(value: Any, path: str) -> Any:
    """The attribute of a value at a dotted path; of a row of a table, the value of a key."""
    if isinstance(value, dict):
        key, _, path = path.partition(".")
        value = value[key]
    return attrgetter(path)(value) if path else value


Schema = Sequence[Quantity]
Columns = Sequence[Quantity | Column]


def keys(**holds: Any) -> tuple[Quantity, ...]:
    """Quantities read from the attributes of their names, without a column in tables.

    Each argument is a unit, such as "mm", or a type in JSON, such as `int`, `[str]` or a schema
    (see `Quantity`); `int | None` if JSON may have null. The second item of a pair is `read`.
    """
    return tuple(_quantity(*one) for one in holds.items())


def _quantity(name: str, holds: Any) -> Quantity:
    paired = isinstance(holds, tuple) and not isinstance(holds[0], Quantity)
    holds, read = holds if paired else (holds, "")
    if isinstance(holds, str):
        return Quantity(name, holds, read=read)
    if isinstance(holds, UnionType):
        return Quantity(name, read=read, holds=holds.__args__[0], missing=True)
    return Quantity(name, read=read, holds=holds)


def record(schema: Schema, value: Any, **given: Any) -> dict[str, Any]:
    """A value as a JSON object: each quantity under its name and unit.

    The value has attributes, or keys of a row; `given` are quantities missing in the value.
    """
    values = ((q, given[q.name] if q.name in given else q.of(value)) for q in schema)
    return {q.key: _held(q.holds, one, q.factor) for q, one in values}


def _held(holds: Any, value: Any, factor: float) -> Any:
    if value is None:
        return None
    if isinstance(holds, tuple):
        return {q.key: _held(q.holds, q.of(value), factor * q.factor) for q in holds}
    if isinstance(holds, list):
        return [_held(holds[0], one, factor) for one in value]
    if isinstance(holds, dict):
        return {key: _held(holds[str], one, factor) for key, one in value.items()}
    return plain(value, factor)


def in_measure(schema: Schema, measure: Measure) -> Schema:
    """A schema for travel and force, translated to another conjugate pair.

    Names, heads, docs and units change; the quantities read the same attributes.
    """
    usual = Measure.TRAVEL
    if measure is usual:
        return schema
    words = dict(zip(usual.words, measure.words, strict=True))
    units = dict(zip(usual.units, measure.units, strict=True))

    def translated(text: str) -> str:
        return _WORDS.sub(lambda match: words[match[0]], text)

    return tuple(
        replace(
            q,
            name=translated(q.name),
            unit=units.get(q.unit, q.unit),
            head=translated(q.head),
            doc=translated(q.doc),
            read=q.read or q.name,
            holds=_measured(q.holds, measure),
        )
        for q in schema
    )


def _measured(holds: Any, measure: Measure) -> Any:
    if isinstance(holds, tuple):
        return in_measure(holds, measure)
    if isinstance(holds, list):
        return [_measured(holds[0], measure)]
    if isinstance(holds, dict):
        return {str: _measured(holds[str], measure)}
    return holds


def read_off(schema: Schema, part: str) -> Schema:
    """The same quantities, read from an attribute of a value."""
    return tuple(replace(q, read=lambda value, q=q: q.of(_part(value, part))) for q in schema)


def plain(value: Any, factor: float = 1.0) -> Any:
    """A value in types of JSON: numbers in another unit, None for numbers that are not finite."""
    if type(value) is float:
        scaled = value * factor
        return scaled if math.isfinite(scaled) else None
    if type(value).__module__ == "numpy":
        return plain(value.tolist(), factor)
    if value is None or isinstance(value, str | bool):
        return value
    if isinstance(value, Mapping):
        return {key: plain(part, factor) for key, part in value.items()}
    if isinstance(value, Enum):
        return value.name.lower()
    if isinstance(value, Iterable):
        return [plain(part, factor) for part in value]
    if isinstance(value, int) and factor == 1.0:
        return value
    scaled = float(value) * factor
    return scaled if math.isfinite(scaled) else None


def rows_of(columns: Mapping[str, Iterable[Any]]) -> list[dict[str, Any]]:
    """The rows of a table from its columns by name."""
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def grouped(pairs: Iterable[tuple[K, V]]) -> dict[K, list[V]]:
    """The values of each key, keys and values in input order."""
    groups: dict[K, list[V]] = {}
    for key, value in pairs:
        groups.setdefault(key, []).append(value)
    return groups


def shown(schema: Columns) -> list[Quantity | Column]:
    """The quantities and columns of a schema that have a heading."""
    return [column for column in schema if column.heading]


def write_csv(
    file: str | os.PathLike[str], columns: Iterable[tuple[Quantity, Any]], digits: int = 12
) -> None:
    """Write columns of values in SI as CSV, atomically, with the unit in every heading."""
    head, values = zip(*((q.key, _texts(q, given, digits)) for q, given in columns), strict=True)
    write_atomic(file, csv_text(head, zip(*values, strict=True)))


def _texts(quantity: Quantity, values: Any, digits: int) -> list[str]:
    if quantity.factor != 1.0:
        import numpy as np

        values = np.asarray(values, float) * quantity.factor
    rows = values.tolist() if is_array(values) else values
    return [f"{value:.{digits}g}" if isinstance(value, float) else str(value) for value in rows]


def variables(schema: Schema, value: Any, *dims: str) -> dict[str, Any]:
    """Variables for an xarray data set, in SI, with units and meaning as attributes."""
    about = [{"units": q.si} | ({"long_name": q.doc} if q.doc else {}) for q in schema]
    described = zip(schema, about, strict=True)
    return {q.name: ((*dims, *q.dims), q.of(value), texts) for q, texts in described}


def number(value: float | None, digits: int = 4) -> str:
    """A number as text; "" for None.

    All rounding of reports is here: four digits of computed numbers, fewer only if a schema asks
    for fewer, and no power of ten below one million.
    """
    if value is None:
        return ""
    rounded = _whole(value)
    return f"{rounded:.0f}" if 10.0**digits <= abs(rounded) < 1e6 else f"{rounded:.{digits}g}"


def amount(value: float, unit: str, digits: int = 4) -> str:
    """A number in SI as text, in its display unit."""
    display, factor = display_unit(unit)
    return f"{number(value * factor, digits)} {Quantity('', display).sign}"


def percent(share: float) -> str:
    """A fraction in percent as text, with enough digits that 99.99 % is not shown as 100 %."""
    digits = 1 if 0.01 < share < 0.99 else 2 if 0.0001 < share < 0.9999 else 4
    return f"{share * 100:.{digits}f} %".replace(".0000 %", " %")


def percent_at_most(share: float) -> str:
    """An upper bound of a fraction as text, rounded up: 0.0495 is "5 %", 0.0501 is "5.1 %"."""
    digits = 0 if share >= 0.1 else 1
    return f"{math.ceil(round(share * 10.0 ** (digits + 2), 6)) / 10.0**digits:g} %"


def headed(heading: str) -> str:
    """The heading of a column, with a capital if it begins with a word, not a symbol or a key."""
    word = heading.partition(" ")[0]
    plain = len(word) > 1 and word.rstrip(":,").replace("-", "").isalpha()
    return heading[:1].upper() + heading[1:] if plain else heading


def counted(count: int, what: str) -> str:
    """A count with its noun, which has a plural in s: "1 cell", "2 cells"."""
    return f"{number(count)} {what}{'s' * (count != 1)}"


def join_first(words: Sequence[str], most: int, what: str = "more", between: str = ", ") -> str:
    """The first `most` words in one line, then the number of the others: "a, b and 3 more"."""
    rest = f" and {len(words) - most} {what}" if len(words) > most else ""
    return between.join(words[:most]) + rest


def signed(value: float) -> str:
    """A change as text, with its sign."""
    return f"{_whole(value):+.4g}"


def _whole(value: float) -> float:
    # A rounding error has no sign.
    return 0.0 if abs(value) < 1e-12 else value
