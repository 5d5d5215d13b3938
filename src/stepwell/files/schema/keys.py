"""Keys of a file: checks of their values, units in their names, and writing."""

import math
import unicodedata
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from functools import cache, lru_cache
from inspect import isclass
from typing import Annotated, Any, NoReturn, get_args

from pydantic import BaseModel, BeforeValidator, ConfigDict, PlainValidator
from pydantic_core import PydanticCustomError

from stepwell.base import UNITS, in_names, limits
from stepwell.files.text import array, exact_si, quoted, shortest, toml
from stepwell.mechanism import Size, Slip, SlipError

# Numbers are decimals until they become SI floats, so nothing is rounded twice. With these bounds
# forces and energies are far from overflow.
LENGTH = (Decimal("-1e6"), Decimal("1e6"))


def refuse(problem: str, key: str = "") -> NoReturn:
    """Raise an error for pydantic; `key` is a key in the table under check."""
    raise PydanticCustomError("design", "{problem}", {"problem": problem, "key": key})


def require_at_most(name: str, value: Any) -> Any:
    """`value`; an error if it is a list longer than its limit."""
    if isinstance(value, list) and len(value) > limits.most(name):
        refuse(limits.problem(name, len(value)))
    return value


def at_most(name: str) -> BeforeValidator:
    """Validator that returns a list as a tuple if it is not longer than the limit `name`."""
    return BeforeValidator(lambda v: tuple(require_at_most(name, v)) if isinstance(v, list) else v)


def listed(name: str, value: Any, least: int, problem: str) -> list[Any]:
    """`value`; an error if it is no list, or too short or too long."""
    if not isinstance(value, list) or len(value) < least:
        refuse(problem)
    return require_at_most(name, value)


def decimal_of(value: Any, least: Decimal, most: Decimal, allowed: str) -> Decimal:
    """`value` as a decimal between `least` and `most`; `allowed` is this range in words."""
    real = isinstance(value, int | Decimal) and not isinstance(value, bool)
    if not real or (isinstance(value, int) and abs(value) > 10**15):
        refuse(f"must be a number {allowed}.")
    decimal = Decimal(value)
    if not decimal.is_finite():
        refuse(f"must be a finite number {allowed}.")
    if not least <= decimal <= most:
        refuse(f"must be {allowed}.")
    return decimal


@dataclass(frozen=True, slots=True)
class Within:
    """Check of one number, with readable bounds."""

    least: Decimal
    most: Decimal
    allowed: str

    def __call__(self, value: Any) -> Decimal:
        """The number as a decimal; an error if not between the bounds."""
        return decimal_of(value, self.least, self.most, self.allowed)


def bounded(least: str, most: str, allowed: str = "") -> PlainValidator:
    """Check of one number between two bounds; `allowed` replaces their text in messages."""
    allowed = allowed or f"from {least} to {most}"
    return PlainValidator(Within(Decimal(least), Decimal(most), allowed))


def bounded_number(least: str, most: str) -> Any:
    """The annotation of a key with one number between two bounds."""
    return Annotated[Decimal, bounded(least, most)]


def above_zero(least: str, most: str) -> PlainValidator:
    """Check of one positive number between two bounds."""
    return bounded(least, most, f"> 0 ({least} to {most})")


def lengths(value: Any, count: int | None, problem: str) -> tuple[Decimal, ...]:
    """The numbers of a list of length `count`, or of any length for None."""
    try:
        numbers = tuple(decimal_of(v, *LENGTH, "") for v in value)
    except (TypeError, ValueError):
        refuse(problem)
    if count not in (None, len(numbers)):
        refuse(problem)
    return numbers


def _point(value: Any) -> tuple[Decimal, ...]:
    return lengths(value, 2, "must be two numbers from -1e6 to 1e6, in mm, as in [10, 0].")


def _line(value: Any) -> str:
    if not isinstance(value, str):
        refuse("must be text in quotes.")
    if len(value) > 200 or any(unicodedata.category(c) in ("Cc", "Cs", "Zl", "Zp") for c in value):
        refuse("must be one line of at most 200 characters.")
    return value


def _switch(value: Any) -> bool:
    if not isinstance(value, bool):
        refuse("must be true or false, without quotes.")
    return value


Line = Annotated[str, PlainValidator(_line)]
Switch = Annotated[bool, PlainValidator(_switch)]
Point = Annotated[tuple[Decimal, ...], PlainValidator(_point)]


class Keys(BaseModel):
    """A table of the file: strict, without unknown keys."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, defer_build=True)

    def given(self) -> dict[str, Any]:
        """Keys and values that are in the file."""
        return {key: getattr(self, key) for key in self.model_fields_set}

    @classmethod
    def names(cls) -> list[str]:
        """All possible keys of the table, as spelled in the file."""
        return [field.alias or key for key, field in cls.model_fields.items()]


Tables = Mapping[str, type[Keys]]


@cache
def tables_of(table: type[Keys], path: str = "") -> Tables:
    """A table and all tables in it, by path from the top of the file."""
    tables = {path: table}
    for key, field in table.model_fields.items():
        for inner in _tables_in(field.annotation):
            tables |= tables_of(inner, f"{path}.{key}".lstrip("."))
    return tables


def _tables_in(annotation: Any) -> Iterator[type[Keys]]:
    for part in get_args(annotation):
        yield from _tables_in(part)
    if isclass(annotation) and issubclass(annotation, Keys):
        yield annotation


# Units by the ends of keys; longer ends first.
ENDS = {
    f"_{in_names(unit)}": UNITS[unit].sign
    for unit in (
        *("kPa/mL", "N m/rad", "N m s/rad", "N s/m", "N/m", "m/s²", "mm/s", "mm/N", "1/mm²"),
        *("1/mm",),
        *("kg/m³", "percent", "mm", "deg", "mL", "kPa", "MPa", "GPa", "mNm", "g", "N", "s"),
    )
}
# Units of files for quantities that are not in SI there.
_SHOWN = {"m": "mm", "kg": "g", "rad": "deg", "1/m": "1/mm", "1/m²": "1/mm²"}
# Fields of these keys; other fields have the name of the key without its unit.
_FIELDS = {
    "stroke_mm": "amplitude",
    "hook_deg": "hook_angle",
    "from_mm": "start",
    "to_mm": "end",
    "quadratic_per_mm": "a2",
    "cubic_per_mm2": "a3",
    "table_mm_N": "table",
    "load_mm_N": "load",
    "peak_mm_N": "peak",
    "valley_mm_N": "valley",
}
_KEYS = {field: key for key, field in _FIELDS.items()}


@cache
def unit_of(key: str, column: int = 0) -> str:
    """Unit in a key, "" for none. Tables have one for each column."""
    if key.endswith("_mm_N"):
        return ("mm", "N")[column]
    return next((shown for end, shown in ENDS.items() if key.endswith(end)), "")


@cache
def field_of(key: str) -> str:
    """Name of the field for a key."""
    end = next((end for end in ENDS if key.endswith(end)), "")
    return _FIELDS.get(key, key.removesuffix(end))


def fields(keys: Keys, left_out: Iterable[str] = ()) -> dict[str, Any]:
    """Values in a table of the file, in SI, by names of fields."""
    given = keys.given()
    return {field_of(key): si(key, given[key]) for key in given if key not in left_out}


def si(key: str, value: Any, column: int = 0) -> Any:
    """A value of the file in SI; rows and points number by number."""
    if isinstance(value, tuple):
        return tuple(si(key, part, i) for i, part in enumerate(value))
    if key == "cell" and isinstance(value, int):
        return value - 1  # files count from 1
    if not isinstance(value, Decimal):
        return value
    return exact_si(value, unit_of(key, column) or "1")


def written(key: str, value: Any, column: int = 0) -> str:
    """A value in SI as text for the file."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return quoted(str(value))
    if isinstance(value, tuple):
        return array([written(key, part, i) for i, part in enumerate(value)])
    if key == "cell":
        return str(value + 1)
    return _number(repr(float(value)), unit_of(key, column))


# Cells of one chain have many numbers in common. The key is text, because 0 equals -0.
@lru_cache(4096)
def _number(digits: str, unit: str) -> str:
    return toml(shortest(float(digits), unit or "1"))


def slips_text(error: SlipError) -> str:
    """Messages on unit errors in mm, degrees and N, one line each."""
    lines = [slip_text(slip, slip.name, name_unit=True) for slip in error.slips]
    way = "set unusual = true in the design file; `stepwell design` has --unusual."
    return "\n".join([*lines, f"If the value is intended, {way}"] if error.way else lines)


def lines_of(error: ValueError) -> list[str]:
    """A line for each problem of a robot or an arena, unit errors by the keys of the file."""
    if not isinstance(error, SlipError):
        return str(error).split("\n")
    way = "If the value is intended, set unusual = true at the top of the file."
    return [f"{slip_text(slip, key_of(slip))} {way}" for slip in error.slips]


def key_of(slip: Slip) -> str:
    """The key of the value in a unit error."""
    place, dot, name = slip.name.rpartition(".")
    key = _KEYS.get(name, f"{name}_{in_names(_SHOWN.get(slip.unit, slip.unit))}")
    return slip.name if " " in slip.name else place + dot + key


def slip_text(slip: Slip, key: str, *, name_unit: bool = False) -> str:
    """Message on a unit error, with the key and the unit of the file."""
    unit = _SHOWN.get(slip.unit, slip.unit)

    def shown(size: Size) -> str:
        if isinstance(size, tuple):
            return array(shown(part) for part in size)
        return toml(Decimal(f"{shortest(size, unit):.6g}"))

    # A row of a table has two units, and the message names the wrong one.
    rows = key.endswith("_mm_N") or key == "shape_mm"
    what = f"{key}, {slip.name.removeprefix('load.')}" if rows else key
    probably = "" if slip.meant is None else f" Did you mean {shown(slip.meant)} {unit}?"
    return f"{what} = {shown(slip.value)}{f' {unit}' * name_unit}: {slip.why}.{probably}"


def table_lines(table: type[Keys], value: Any, left_out: Iterable[str] = ()) -> list[str]:
    """Lines of the keys of a table with the fields of a value."""
    return [
        f"{key} = {written(key, getattr(value, field_of(key)))}"
        for key in table.model_fields
        # A limit or a number that is not given has no line.
        if key not in left_out and getattr(value, field_of(key), None) not in (None, math.inf)
    ]
