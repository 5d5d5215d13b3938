"""The keys of a design file with their values and units."""

from __future__ import annotations

from decimal import Decimal
from typing import Annotated, Any

from pydantic import PlainValidator, model_validator

from stepwell.base import Measure, short
from stepwell.files.schema import elements, keys
from stepwell.files.schema.hopper import HopperKeys
from stepwell.mechanism import LIMITS_DEG, SOFTEST, STIFFEST

ROW_STEP_MM = Decimal("1e-6")


def _rows(value: Any, least: int, example: str) -> tuple[tuple[Decimal, Decimal], ...]:
    must = f"must be {least} or more rows of two numbers, as in {example}."
    rows: list[tuple[Decimal, Decimal]] = []
    for i, row in enumerate(keys.listed("rows", value, least, must), 1):
        must = f"row {i} must be two numbers from -1e6 to 1e6, as in {example}."
        x, y = keys.lengths(row, 2, must)
        if rows and x - rows[-1][0] < ROW_STEP_MM:
            keys.refuse(f"row {i} must be at least {ROW_STEP_MM} mm above the row before it.")
        rows.append((x, y))
    return tuple(rows)


def _law_rows(value: Any) -> tuple[tuple[Decimal, Decimal], ...]:
    rows = _rows(value, 2, "[[0, 0], [10, 0.3], [30, 0.8]]")
    if rows[0] != (0, 0):
        keys.refuse("row 1 must be [0, 0]: a band has no tension at its rest length.")
    for i, (_, pull) in enumerate(rows):
        if pull < 0:
            keys.refuse(f"row {i + 1} must not be negative: bands pull. Did you mean {-pull}?")
    return rows


def _tension_rows(value: Any) -> tuple[tuple[Decimal, Decimal], ...]:
    rows = _law_rows(value)
    if rows[-1][1] < Decimal("1e-9"):
        keys.refuse("the last row must be a tension of 1e-9 N or more.")
    return rows


def _actuator(value: Any, least: str, most: str, allowed: str) -> Decimal:
    if value == "rigid":
        return Decimal("Infinity")
    allowed = f'from {least} to {most}, {allowed}or "rigid"'
    stiffness = keys.decimal_of(value, Decimal(0), Decimal(most), allowed)
    if stiffness == 0:
        return stiffness
    return keys.decimal_of(value, Decimal(least), stiffness, allowed)


def _state(value: Any) -> str:
    if not isinstance(value, str) or not value.isascii() or not value.isdecimal():
        keys.refuse('must be 0 or 1 for each cell in quotes, inner first, as in "010".')
    return value


def _drives(value: Any) -> tuple[Decimal, ...]:
    drives = keys.listed(
        "turns", value, 1, "must be a list of 1 or more numbers, as in [0, 45, 20]."
    )
    return keys.lengths(drives, None, "must be numbers from -1e6 to 1e6, as in [0, 45, 20].")


Lever = Annotated[Decimal, keys.bounded("1e-3", "1e6", "from 0.001 to 1e6")]
Limit = Annotated[Decimal, keys.bounded(*map(short, LIMITS_DEG))]
Stiffness = Annotated[Decimal, keys.above_zero("1e-6", "1e9")]
RestLength = Annotated[Decimal, keys.bounded("0", "1e6", ">= 0 (up to 1e6)")]
Coefficient = Annotated[Decimal, keys.bounded("-1e6", "1e6")]
Force = Annotated[Decimal, keys.bounded("-1e6", "1e6")]
Actuator = Annotated[
    Decimal, PlainValidator(lambda value: _actuator(value, short(SOFTEST), short(STIFFEST), "0, "))
]
OtherActuator = Annotated[Decimal, PlainValidator(lambda value: _actuator(value, "0", "1e15", ""))]
TensionRows = Annotated[tuple[tuple[Decimal, Decimal], ...], PlainValidator(_tension_rows)]
LawRows = Annotated[tuple[tuple[Decimal, Decimal], ...], PlainValidator(_law_rows)]
LoadRows = Annotated[
    tuple[tuple[Decimal, Decimal], ...],
    PlainValidator(lambda rows: _rows(rows, 1, "[[0, 0.02], [20, 0.05]]")),
]
State = Annotated[str, PlainValidator(_state)]
Drives = Annotated[tuple[Decimal, ...], PlainValidator(_drives)]


class BandKeys(keys.Keys):
    """Properties of a band without its anchors."""

    stiffness_N_per_m: Stiffness | None = None
    rest_length_mm: RestLength | None = None
    two_sided: keys.Switch | None = None
    quadratic_per_mm: Coefficient | None = None
    cubic_per_mm2: Coefficient | None = None
    table_mm_N: TensionRows | None = None
    shape_mm: LawRows | None = None
    table_csv: elements.CsvName | None = None

    @model_validator(mode="after")
    def _one_law(self) -> BandKeys:
        given = self.model_fields_set
        laws = [kind for kind, keys in LAWS.items() if keys & given]
        if len(laws) > 1:
            keys.refuse(f"gives {' and '.join(laws)}: a band has one law, keep one of them.")
        if {"table_mm_N", "stiffness_N_per_m"} <= given:
            keys.refuse(TABLE_OWNS_STIFFNESS, "stiffness_N_per_m")
        return self


# The keys of each law; a band has one law.
LAWS = {
    "quadratic_per_mm or cubic_per_mm2": {"quadratic_per_mm", "cubic_per_mm2"},
    "table_mm_N": {"table_mm_N", "table_csv"},
    "shape_mm": {"shape_mm"},
}
TABLE_OWNS_STIFFNESS = (
    "cannot be combined with table_mm_N, which sets the stiffness; leave it out, or give the law "
    "as shape_mm."
)


class PlacedBandKeys(BandKeys):
    """One of several bands on a cell, with its anchors."""

    p_mm: keys.Point
    q_mm: keys.Point


class LeverKeys(keys.Keys):
    """A cell of levers and bands; missing keys are those of the chain."""

    name: keys.Line = ""
    p_mm: keys.Point | None = None
    q_mm: keys.Point | None = None
    lever_mm: Lever | None = None
    limit_deg: Limit | None = None
    band: BandKeys = BandKeys()
    bands: Annotated[tuple[PlacedBandKeys, ...], keys.at_most("bands")] | None = None
    load_N: Force | None = None
    load_mm_N: LoadRows | None = None
    friction_N: elements.Friction | None = None
    mobility: elements.Mobility | None = None
    unusual: keys.Switch | None = None


class OneCellKeys(elements.ElementKeys, LeverKeys):
    """A cell of levers and bands, or an element without a chain inside."""

    beside: Annotated[tuple[elements.PartKeys, ...], keys.at_most("bands")] | None = None

    @property
    def forms(self) -> list[str]:
        """The keys of a curve; empty for a cell of levers."""
        return [key for key in self.model_fields_set if key in FORMS]

    @model_validator(mode="after")
    def _anchored_once(self) -> OneCellKeys:
        given = self.model_fields_set
        for form in self.forms:
            for key in _OF_LEVERS & given:
                keys.refuse(f"cannot be combined with {form}: an element has no levers.", key)
            return self
        for key in _OF_ELEMENTS & given:
            keys.refuse(f"needs the curve of an element: {', '.join(FORMS)}.", key)
        for key in ("p_mm", "q_mm"):
            if self.bands is None and key not in given:
                keys.refuse("is missing: two numbers in mm, as in [10, 0].", key)
            if self.bands is not None and key in given:
                keys.refuse("cannot be combined with bands, which have their own anchors.", key)
        if self.bands == ():
            keys.refuse("must hold one band or more.", "bands")
        if self.load_N is not None and self.load_mm_N is not None:
            keys.refuse("cannot be combined with load_N: a cell has one load.", "load_mm_N")
        return self


class CellKeys(OneCellKeys):
    """A cell of levers and bands, or any element."""

    inside: Annotated[tuple[OneCellKeys, ...], keys.at_most("graph_cells")] | None = None


# Forms of the curve of an element, and keys of levers only and of elements only.
FORMS = (*elements.CurveKeys.model_fields, "beside", "inside")
_OF_LEVERS = LeverKeys.model_fields.keys() - elements.ElementKeys.model_fields.keys()
_OF_ELEMENTS = elements.ElementKeys.model_fields.keys() - LeverKeys.model_fields.keys()


class SharedKeys(keys.Keys):
    """Keys common to the cells of a chain."""

    lever_mm: Lever | None = None
    limit_deg: Limit | None = None
    unusual: keys.Switch = False
    band: BandKeys = BandKeys()


class ChainKeys(SharedKeys):
    """The chain, and keys common to its cells."""

    actuator_stiffness_N_per_m: Actuator | None = None
    actuator_stiffness_kPa_per_mL: OtherActuator | None = None
    actuator_stiffness_N_m_per_rad: OtherActuator | None = None
    cell: Annotated[tuple[CellKeys, ...], keys.at_most("cells")]

    @model_validator(mode="after")
    def _some_cell(self) -> ChainKeys:
        if not self.cell:
            keys.refuse("must hold one cell or more, inner first.", "cell")
        given = [key for key in ACTUATORS.values() if key in self.model_fields_set]
        if len(given) > 1:
            keys.refuse(f"cannot be combined with {given[0]}: keep one of them.", given[1])
        return self


# Key of the stiffness of the actuator, by the chain's measure.
ACTUATORS = {
    Measure.TRAVEL: "actuator_stiffness_N_per_m",
    Measure.VOLUME: "actuator_stiffness_kPa_per_mL",
    Measure.ANGLE: "actuator_stiffness_N_m_per_rad",
}
# Keys of the turning points: a travel, or a force under force control.
TURNING_POINTS = {
    measure: tuple(
        elements.key_in("turning_points", u) for u in (measure.travel_unit, measure.force_unit)
    )
    for measure in Measure
}


class ProgramKeys(keys.Keys):
    """Program of the actuator, and its target."""

    start: State | None = None
    turning_points_mm: Drives | None = None
    turning_points_N: Drives | None = None
    turning_points_mL: Drives | None = None
    turning_points_kPa: Drives | None = None
    turning_points_deg: Drives | None = None
    turning_points_mNm: Drives | None = None
    ends: State | None = None
    unusual: keys.Switch = False

    @property
    def given_points(self) -> list[str]:
        """The keys of turning points in the file; one in a valid file."""
        every = [key for pair in TURNING_POINTS.values() for key in pair]
        return [key for key in every if getattr(self, key) is not None]

    @model_validator(mode="after")
    def _one_list(self) -> ProgramKeys:
        given = self.given_points
        if not given:
            keys.refuse("is missing: strokes in mm, as in [0, 45, 20].", "turning_points_mm")
        if len(given) > 1:
            keys.refuse(f"cannot be combined with {given[0]}: keep one of them.", given[1])
        return self


class FileKeys(keys.Keys):
    """A whole design file."""

    title: keys.Line = ""
    chain: ChainKeys
    program: ProgramKeys | None = None
    hopper: HopperKeys | None = None


# Tables by path, used in messages on unknown keys.
TABLES = keys.tables_of(FileKeys)
