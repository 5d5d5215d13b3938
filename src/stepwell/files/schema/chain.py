"""The keys of a design file: what each may hold, and in which unit."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterator, Mapping
from decimal import Decimal
from inspect import isclass
from typing import Annotated, Any, NoReturn, get_args

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainValidator,
    model_validator,
)
from pydantic_core import PydanticCustomError

from stepwell.base import limits, short
from stepwell.mechanism import LIMITS_DEG, SOFTEST, STIFFEST

# Numbers stay the decimals of the file until they become SI floats, so nothing is rounded
# twice. Their bounds keep every force and energy far from overflow: a hair to a kilometre.
LENGTH = (Decimal("-1e6"), Decimal("1e6"))
ROW_STEP_MM = Decimal("1e-6")


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


def bounded(least: str, most: str, allowed: str = "") -> PlainValidator:
    """A check of one number between two bounds; messages may say what is `allowed` otherwise."""
    allowed = allowed or f"from {least} to {most}"
    return PlainValidator(lambda value: decimal_of(value, Decimal(least), Decimal(most), allowed))


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


def _rows(value: Any, least: int, example: str) -> tuple[tuple[Decimal, Decimal], ...]:
    if not isinstance(value, list) or len(value) < least:
        refuse(f"must be {least} or more rows of two numbers, as in {example}.")
    few("rows", value)
    rows: list[tuple[Decimal, Decimal]] = []
    for i, row in enumerate(value):
        allowed = f"two numbers from -1e6 to 1e6, as in {example}"
        x, y = lengths(row, 2, f"row {i + 1} must be {allowed}.")
        if rows and x - rows[-1][0] < ROW_STEP_MM:
            refuse(f"row {i + 1} must lie {ROW_STEP_MM} mm or more above the row before it.")
        rows.append((x, y))
    return tuple(rows)


def _law_rows(value: Any) -> tuple[tuple[Decimal, Decimal], ...]:
    rows = _rows(value, 2, "[[0, 0], [10, 0.3], [30, 0.8]]")
    if rows[0] != (0, 0):
        refuse("row 1 must be [0, 0]: a band carries nothing at its rest length.")
    for i, (_, pull) in enumerate(rows):
        if pull < 0:
            refuse(f"row {i + 1} must not be negative: bands pull. Did you mean {-pull}?")
    return rows


def _tension_rows(value: Any) -> tuple[tuple[Decimal, Decimal], ...]:
    rows = _law_rows(value)
    if rows[-1][1] < Decimal("1e-9"):
        refuse("the last row must be a tension of 1e-9 N or more.")
    return rows


def _actuator(value: Any) -> Decimal:
    if value == "rigid":
        return Decimal("Infinity")
    allowed = f'from {short(SOFTEST)} to {short(STIFFEST)}, 0, or "rigid"'
    stiffness = decimal_of(value, Decimal(0), Decimal(STIFFEST), allowed)
    softest = Decimal(short(SOFTEST))
    return stiffness if stiffness == 0 else decimal_of(value, softest, stiffness, allowed)


def _line(value: Any) -> str:
    if not isinstance(value, str):
        refuse("must be text in quotes.")
    if len(value) > 200 or any(unicodedata.category(c) in ("Cc", "Cs", "Zl", "Zp") for c in value):
        refuse("must be one line of at most 200 characters.")
    return value


def _state(value: Any) -> str:
    if not isinstance(value, str) or not value or set(value) - {"0", "1"}:
        refuse('must be 0 or 1 for each cell in quotes, inner first, as in "010".')
    return value


def _drives(value: Any) -> tuple[Decimal, ...]:
    if not isinstance(value, list) or not value:
        refuse("must be a list of 1 or more numbers, as in [0, 45, 20].")
    few("turns", value)
    return lengths(value, None, "must be numbers from -1e6 to 1e6, as in [0, 45, 20].")


def _switch(value: Any) -> bool:
    if not isinstance(value, bool):
        refuse("must be true or false, without quotes.")
    return value


Line = Annotated[str, PlainValidator(_line)]
Switch = Annotated[bool, PlainValidator(_switch)]
Point = Annotated[tuple[Decimal, ...], PlainValidator(point)]
Lever = Annotated[Decimal, bounded("1e-3", "1e6", "from 0.001 to 1e6")]
Limit = Annotated[Decimal, bounded(*map(short, LIMITS_DEG))]
Stiffness = Annotated[Decimal, above_zero("1e-6", "1e9")]
RestLength = Annotated[Decimal, bounded("0", "1e6", ">= 0 (up to 1e6)")]
Coefficient = Annotated[Decimal, bounded("-1e6", "1e6")]
Force = Annotated[Decimal, bounded("-1e6", "1e6")]
Friction = Annotated[Decimal, bounded("0", "1e6", ">= 0 (up to 1e6)")]
Actuator = Annotated[Decimal, PlainValidator(_actuator)]
TensionRows = Annotated[tuple[tuple[Decimal, Decimal], ...], PlainValidator(_tension_rows)]
LawRows = Annotated[tuple[tuple[Decimal, Decimal], ...], PlainValidator(_law_rows)]
LoadRows = Annotated[
    tuple[tuple[Decimal, Decimal], ...],
    PlainValidator(lambda rows: _rows(rows, 1, "[[0, 0.02], [20, 0.05]]")),
]
State = Annotated[str, PlainValidator(_state)]
Drives = Annotated[tuple[Decimal, ...], PlainValidator(_drives)]


class Keys(BaseModel):
    """A table of the file: strict, and no key that we do not know."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    def given(self) -> dict[str, Any]:
        """Only the keys that stand in the file."""
        return {key: getattr(self, key) for key in self.model_fields_set}

    @classmethod
    def names(cls) -> list[str]:
        """Every key that the table may hold, as the file spells it."""
        return [field.alias or key for key, field in cls.model_fields.items()]


class BandKeys(Keys):
    """What a band is made of, without its anchors."""

    stiffness_N_per_m: Stiffness | None = None
    rest_length_mm: RestLength | None = None
    two_sided: Switch | None = None
    quadratic_per_mm: Coefficient | None = None
    cubic_per_mm2: Coefficient | None = None
    table_mm_N: TensionRows | None = None
    shape_mm: LawRows | None = None

    @model_validator(mode="after")
    def _one_law(self) -> BandKeys:
        given = self.model_fields_set
        laws = [kind for kind, keys in LAWS.items() if keys & given]
        if len(laws) > 1:
            refuse(f"gives {' and '.join(laws)}: a band has one law, keep one of them.")
        if {"table_mm_N", "stiffness_N_per_m"} <= given:
            refuse(TABLE_OWNS_STIFFNESS, "stiffness_N_per_m")
        return self


# The keys of each law, of which a band has one.
LAWS = {
    "quadratic_per_mm or cubic_per_mm2": {"quadratic_per_mm", "cubic_per_mm2"},
    "table_mm_N": {"table_mm_N"},
    "shape_mm": {"shape_mm"},
}
TABLE_OWNS_STIFFNESS = (
    "cannot stand with table_mm_N, which sets the stiffness itself; leave it out, or give the "
    "law as shape_mm."
)


class PlacedBandKeys(BandKeys):
    """One of several bands on a cell, with its anchors."""

    p_mm: Point
    q_mm: Point


class CellKeys(Keys):
    """A unit cell; what it leaves out it takes from the chain."""

    name: Line = ""
    p_mm: Point | None = None
    q_mm: Point | None = None
    lever_mm: Lever | None = None
    limit_deg: Limit | None = None
    band: BandKeys = BandKeys()
    bands: Annotated[tuple[PlacedBandKeys, ...], Field(strict=False), at_most("bands")] | None = (
        None
    )
    load_N: Force | None = None
    load_mm_N: LoadRows | None = None
    friction_N: Friction = Decimal(0)
    unusual: Switch | None = None

    @model_validator(mode="after")
    def _anchored_once(self) -> CellKeys:
        anchors = [key for key in ("p_mm", "q_mm") if key in self.model_fields_set]
        if self.bands is None:
            for key in ("p_mm", "q_mm"):
                if key not in anchors:
                    refuse("is missing: two numbers in mm, as in [10, 0].", key)
        elif anchors:
            refuse("cannot stand with bands, where every band has its own anchors.", anchors[0])
        elif not self.bands:
            refuse("must hold one band or more.", "bands")
        if self.load_N is not None and self.load_mm_N is not None:
            refuse("cannot stand with load_N: a cell has one load.", "load_mm_N")
        return self


class SharedKeys(Keys):
    """What the cells of a chain share."""

    lever_mm: Lever | None = None
    limit_deg: Limit | None = None
    unusual: Switch = False
    band: BandKeys = BandKeys()


class ChainKeys(SharedKeys):
    """The chain and what its cells share."""

    actuator_stiffness_N_per_m: Actuator = Decimal("Infinity")
    cell: Annotated[tuple[CellKeys, ...], Field(strict=False), at_most("cells")]

    @model_validator(mode="after")
    def _some_cell(self) -> ChainKeys:
        if not self.cell:
            refuse("must hold one cell or more, inner first.", "cell")
        return self


class ProgramKeys(Keys):
    """What the actuator is to do, and what for."""

    start: State | None = None
    turning_points_mm: Drives | None = None
    turning_points_N: Drives | None = None
    ends: State | None = None
    unusual: Switch = False

    @model_validator(mode="after")
    def _one_list(self) -> ProgramKeys:
        if self.turning_points_mm is None and self.turning_points_N is None:
            refuse("is missing: strokes in mm, as in [0, 45, 20].", "turning_points_mm")
        if self.turning_points_mm is not None and self.turning_points_N is not None:
            refuse("cannot stand with turning_points_mm: keep one of them.", "turning_points_N")
        return self


class FileKeys(Keys):
    """A whole design file."""

    title: Line = ""
    chain: ChainKeys
    program: ProgramKeys | None = None


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


# Where a reader may come from when a path holds one of these keys.
TABLES = tables_of(FileKeys)
