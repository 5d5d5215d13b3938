"""What a key of any file may hold: numbers between bounds, points, lines, tables of keys."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from inspect import isclass
from typing import Annotated, Any, NoReturn, get_args

from pydantic import BaseModel, BeforeValidator, ConfigDict, PlainValidator
from pydantic_core import PydanticCustomError

from stepwell.base import limits

# Numbers stay the decimals of the file until they become SI floats, so nothing is rounded
# twice. Their bounds keep every force and energy far from overflow: a hair to a kilometre.
LENGTH = (Decimal("-1e6"), Decimal("1e6"))


def refuse(problem: str, key: str = "") -> NoReturn:
    """Raise what pydantic collects; `key` is a key inside the table that is being checked."""
    raise PydanticCustomError("design", "{problem}", {"problem": problem, "key": key})


def few(name: str, value: Any) -> Any:
    """`value`, where it is no list of more than is allowed."""
    if isinstance(value, list) and len(value) > limits.most(name):
        refuse(limits.problem(name, len(value)))
    return value


def at_most(name: str) -> BeforeValidator:
    """A list is looked at only where it is no longer than the limit of that name."""
    return BeforeValidator(lambda value: few(name, value))


def decimal_of(value: Any, least: Decimal, most: Decimal, allowed: str) -> Decimal:
    """`value` as a decimal between `least` and `most`; `allowed` says so in words."""
    if isinstance(value, bool) or not isinstance(value, int | Decimal):
        refuse(f"must be a number {allowed}.")
    if isinstance(value, int) and abs(value) > 10**15:
        refuse(f"must be a number {allowed}.")
    decimal = Decimal(value)
    if not decimal.is_finite():
        refuse(f"must be a finite number {allowed}.")
    if not least <= decimal <= most:
        refuse(f"must be {allowed}.")
    return decimal


@dataclass(frozen=True, slots=True)
class Within:
    """A check of one number, whose bounds can be told."""

    least: Decimal
    most: Decimal
    allowed: str

    def __call__(self, value: Any) -> Decimal:
        """The number as a decimal; refused where it is none between the bounds."""
        return decimal_of(value, self.least, self.most, self.allowed)


def bounded(least: str, most: str, allowed: str = "") -> PlainValidator:
    """A check of one number between two bounds; messages may say what is `allowed` otherwise."""
    return PlainValidator(
        Within(Decimal(least), Decimal(most), allowed or f"from {least} to {most}")
    )


def above_zero(least: str, most: str) -> PlainValidator:
    """A check of one positive number between two bounds."""
    return bounded(least, most, f"> 0 ({least} to {most})")


def lengths(value: Any, count: int | None, problem: str) -> tuple[Decimal, ...]:
    """`count` numbers of a list, or all, as the file has them; `problem` says what it must be."""
    try:
        found = tuple(decimal_of(v, *LENGTH, "") for v in value)
    except (TypeError, ValueError):
        refuse(problem)
    if count not in (None, len(found)):
        refuse(problem)
    return found


def point(value: Any) -> tuple[Decimal, ...]:
    """Two lengths, as the file has them."""
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
Point = Annotated[tuple[Decimal, ...], PlainValidator(point)]


class Keys(BaseModel):
    """A table of the file: strict, and no key that we do not know."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, defer_build=True)

    def given(self) -> dict[str, Any]:
        """Only the keys that stand in the file."""
        return {key: getattr(self, key) for key in self.model_fields_set}

    @classmethod
    def names(cls) -> list[str]:
        """Every key that the table may hold, as the file spells it."""
        return [field.alias or key for key, field in cls.model_fields.items()]


Tables = Mapping[str, type[Keys]]


def tables_of(table: type[Keys], path: str = "") -> Tables:
    """A table and all tables in it, by their paths from the top of the file."""
    found = {path: table}
    for key, field in table.model_fields.items():
        for inner in _tables_in(field.annotation):
            found |= tables_of(inner, f"{path}.{key}".lstrip("."))
    return found


def _tables_in(annotation: Any) -> Iterator[type[Keys]]:
    for part in get_args(annotation):
        yield from _tables_in(part)
    if isclass(annotation) and issubclass(annotation, Keys):
        yield annotation
