"""The keys of an element: a curve in one of several forms, or arguments of the library."""

from __future__ import annotations

from decimal import Decimal
from itertools import pairwise
from typing import Annotated, Any, ClassVar, NoReturn

from pydantic import PlainValidator, model_validator

from stepwell.base import Measure, display_unit, short
from stepwell.files.schema import keys
from stepwell.files.schema.keys import refuse
from stepwell.mechanism import MOBILITIES


def _corner(value: Any) -> tuple[Decimal, ...]:
    return keys.lengths(value, 2, "must be a travel in mm and a force in N, as in [4, 1].")


def _count(value: Any) -> int:
    if type(value) is not int or not 1 <= value <= 1000:
        refuse("must be a whole number from 1 to 1000.")
    return value


Corner = Annotated[tuple[Decimal, ...], PlainValidator(_corner)]
Count = Annotated[int, PlainValidator(_count)]
Size = Annotated[Decimal, keys.above_zero("1e-3", "1e6")]
Height = Annotated[Decimal, keys.bounded("0", "1e6", ">= 0 (up to 1e6)")]
Spring = Annotated[Decimal, keys.above_zero("1e-6", "1e9")]
Modulus = Annotated[Decimal, keys.above_zero("1e-6", "1e9")]
Share = Annotated[Decimal, keys.bounded("0", "1e9", ">= 0 (up to 1e9)")]
Stretch = Annotated[Decimal, keys.bounded("1", "100")]


class TrilinearKeys(keys.Keys):
    """Two straight rising branches with a falling one between them."""

    peak_mm_N: Corner | None = None
    valley_mm_N: Corner | None = None
    first_N_per_m: Spring | None = None
    last_N_per_m: Spring | None = None


class TrussKeys(keys.Keys):
    """Two inclined springs whose apex is pushed through."""

    half_width_mm: Size | None = None
    height_mm: Size | None = None
    stiffness_N_per_m: Spring | None = None


class BeamKeys(keys.Keys):
    """Cosine-shaped beams that are joined in the middle."""

    span_mm: Size | None = None
    height_mm: Size | None = None
    thickness_mm: Size | None = None
    width_mm: Size | None = None
    modulus_GPa: Modulus | None = None
    beams: Count | None = None


class BalloonKeys(keys.Keys):
    """A spherical rubber balloon."""

    radius_mm: Size | None = None
    thickness_mm: Size | None = None
    c1_kPa: Modulus | None = None
    c2_kPa: Share | None = None
    stretch: Stretch | None = None


class KreslingKeys(keys.Keys):
    """One storey of a folded cylinder."""

    sides: Count | None = None
    radius_mm: Size | None = None
    folded_mm: Height | None = None
    deployed_mm: Size | None = None
    mountain_N_per_m: Spring | None = None
    valley_N_per_m: Spring | None = None


class DomeKeys(keys.Keys):
    """Rubber domes of a keyboard, as measured."""

    count: Count | None = None


class LibraryKeys(keys.Keys):
    """The elements of the library by the names of their functions."""

    trilinear: TrilinearKeys | None = None
    von_mises_truss: TrussKeys | None = None
    curved_beam: BeamKeys | None = None
    balloon: BalloonKeys | None = None
    kresling: KreslingKeys | None = None
    dome: DomeKeys | None = None


# Larger than in any mechanism, and far from overflow.
MOST = "1e9"
_FINEST, _LEAST_FORCE = Decimal("1e-6"), Decimal("1e-9")
# Coefficients of cubics in SI: a pressure over the third power of a microlitre among them.
_MOST_SI = "1e60"


def key_in(word: str, unit: str) -> str:
    """The key of a quantity in the unit of files, such as force_N for force and N."""
    return f"{word}_{display_unit(unit)[0]}"


# The columns of a curve by measure, travel first.
COLUMNS = {
    one: (key_in(one.travel, one.travel_unit), key_in(one.force, one.force_unit)) for one in Measure
}
# The joints of a sheet in SI, by measure.
JOINTS = {Measure.TRAVEL: "travel_m", Measure.VOLUME: "volume_m3", Measure.ANGLE: "angle_rad"}
_RISE = (
    "Sort the rows and drop repeated ones; give loading or unloading alone; or, if the curve truly "
    "folds back, give it as curve."
)
_PAIRS = " or ".join(f"{x} and {y}" for x, y in COLUMNS.values())


def _numbers(value: Any, most: str = MOST, example: str = "[0, 1.5, 4]") -> tuple[Decimal, ...]:
    numbers: list[Decimal] = []
    must = f"must be a list of numbers, as in {example}."
    for i, one in enumerate(keys.listed("rows", value, 1, must), 1):
        try:
            numbers.append(keys.decimal_of(one, -Decimal(most), Decimal(most), ""))
        except ValueError:
            refuse(f"number {i} must be from -{most} to {most}, as in {example}.")
    return tuple(numbers)


def _cubics(value: Any) -> tuple[tuple[Decimal, ...], ...]:
    example = "[[0, 250, 0, 0, 0]]"
    listed = keys.listed(
        "rows", value, 1, f"must be one or more rows of five numbers, as in {example}."
    )
    rows = tuple(_numbers(row, _MOST_SI, "[0, 250, 0, 0, 0]") for row in listed)
    for i, row in enumerate(rows, 1):
        if len(row) != 5:
            refuse(f"row {i} must be five numbers, as in {example}.")
    return rows


def _stops(value: Any) -> bool | tuple[bool, bool]:
    if isinstance(value, bool):
        return value
    if not isinstance(value, list) or len(value) != 2 or any(type(v) is not bool for v in value):
        refuse("must be true or false, or two of them for the low and the high end.")
    return tuple(value)


def _sheet(value: Any) -> int:
    if type(value) is not int or not 1 <= value <= 10_000:
        refuse("must be the number of a sheet, from 1 on.")
    return value


def _csv(_: Any) -> NoReturn:
    way = "in a text give the numbers instead"
    refuse(f"names a file, which is only read for a design file that is loaded by name; {way}.")


Numbers = Annotated[tuple[Decimal, ...], PlainValidator(_numbers)]
JointsSI = Annotated[tuple[Decimal, ...], PlainValidator(lambda value: _numbers(value, _MOST_SI))]
Cubics = Annotated[tuple[tuple[Decimal, ...], ...], PlainValidator(_cubics)]
Stops = Annotated[bool | tuple[bool, bool], PlainValidator(_stops)]
SheetNumber = Annotated[int, PlainValidator(_sheet)]
CsvName = Annotated[str, PlainValidator(_csv)]
Friction = Annotated[Decimal, keys.bounded("0", "1e6", ">= 0 (up to 1e6)")]
Mobility = Annotated[Decimal, keys.bounded(*map(short, MOBILITIES))]
Noise = Annotated[Decimal, keys.above_zero("1e-9", MOST)]
Scale = Annotated[Decimal, keys.above_zero("1e-6", "1e6")]


class ColumnKeys(keys.Keys):
    """A curve by two columns of numbers with equal length and measure."""

    travel_mm: Numbers | None = None
    force_N: Numbers | None = None
    volume_mL: Numbers | None = None
    pressure_kPa: Numbers | None = None
    angle_deg: Numbers | None = None
    torque_mNm: Numbers | None = None

    _rises: ClassVar[bool] = False

    @property
    def measure(self) -> Measure:
        """Measure of the columns."""
        given = self.model_fields_set
        return next(measure for measure, pair in COLUMNS.items() if given & set(pair))

    @property
    def pair(self) -> tuple[tuple[Decimal, ...], tuple[Decimal, ...]]:
        """Both columns, travel first."""
        x, y = COLUMNS[self.measure]
        return getattr(self, x), getattr(self, y)

    @model_validator(mode="after")
    def _one_pair(self) -> ColumnKeys:
        given = self.model_fields_set
        if not given:
            refuse(f"has no columns: must hold {_PAIRS}.")
        keys = COLUMNS[self.measure]
        if given != set(keys):
            came = " and ".join(key for key in type(self).names() if key in given)
            refuse(f"has {came}: must hold {_PAIRS}.")
        x, y = self.pair
        if len(x) != len(y):
            refuse(f"has {len(x)} numbers, {keys[1]} {len(y)}: must be equal.", keys[0])
        if max(map(abs, y)) < _LEAST_FORCE:
            refuse(f"must hold a force of {_LEAST_FORCE} or more in size.", keys[1])
        for i, (a, b) in enumerate(pairwise(x), 2):
            if self._rises and b - a < _FINEST:
                must = f"must be at least {_FINEST} above the one before, {a}. {_RISE}"
                refuse(f"number {i}, {b}, {must}", keys[0])
            if abs(b - a) < _FINEST:
                refuse(f"number {i}, {b}, must differ from the one before by {_FINEST}.", keys[0])
        return self


class RisingKeys(ColumnKeys):
    """Two columns; the first one rises."""

    _rises = True


class SheetKeys(keys.Keys):
    """A stable branch of a curve as cubics in SI, for curves that no table reproduces."""

    travel_m: JointsSI | None = None
    volume_m3: JointsSI | None = None
    angle_rad: JointsSI | None = None
    cubics_SI: Cubics
    below: SheetNumber | None = None
    above: SheetNumber | None = None

    @property
    def measure(self) -> Measure:
        """Measure of its travel."""
        return next(one for one, key in JOINTS.items() if key in self.model_fields_set)

    @model_validator(mode="after")
    def _joined(self) -> SheetKeys:
        given = [key for key in JOINTS.values() if key in self.model_fields_set]
        if len(given) != 1:
            refuse(f"must hold one of {', '.join(JOINTS.values())}.")
        joints = getattr(self, given[0])
        if len(joints) != len(self.cubics_SI) + 1:
            has = f"has {len(joints)} numbers for {len(self.cubics_SI)} rows of cubics_SI"
            must = "must be one more, the begin of each row and the end of the last"
            refuse(f"{has}: {must}.", given[0])
        if any(b <= a for a, b in pairwise(map(float, joints))):
            refuse("must rise.", given[0])
        return self


class NumberKeys(keys.Keys):
    """The curve of an element in numbers, in one of several forms."""

    table: RisingKeys | None = None
    points: RisingKeys | None = None
    curve: ColumnKeys | None = None
    table_csv: CsvName | None = None
    points_csv: CsvName | None = None
    curve_csv: CsvName | None = None
    sheets: Annotated[tuple[SheetKeys, ...], keys.at_most("rows")] | None = None


class CurveKeys(LibraryKeys, NumberKeys):
    """The curve of an element, in numbers or by a name in the library."""


class ElementKeys(CurveKeys):
    """An element: its curve and options."""

    name: keys.Line = ""
    stops: Stops | None = None
    friction_N: Friction | None = None
    friction_kPa: Friction | None = None
    friction_mNm: Friction | None = None
    noise_N: Noise | None = None
    noise_kPa: Noise | None = None
    noise_mNm: Noise | None = None
    error_band_N: Friction | None = None
    error_band_kPa: Friction | None = None
    error_band_mNm: Friction | None = None
    force_scale: Scale | None = None
    travel_scale: Scale | None = None
    mobility: Mobility | None = None
    unusual: keys.Switch | None = None

    @property
    def forms(self) -> list[str]:
        """The keys of a curve; one in a valid file."""
        return [key for key in self.model_fields_set if key not in _NOT_CURVE]

    @model_validator(mode="after")
    def _at_most_one_curve(self) -> ElementKeys:
        forms = self.forms
        if len(forms) > 1:
            refuse(f"gives {' and '.join(sorted(forms))}: an element has one curve, keep one.")
        numbers = NumberKeys.model_fields.keys()
        for key in self.model_fields_set:
            if key.startswith("noise_") and forms not in (["table"], ["table_csv"]):
                refuse("is for table only; leave it out.", key)
            if key.startswith("error_band_") and not numbers & set(forms):
                refuse("is for a curve in numbers only; leave it out.", key)
        return self


# Keys that are no curve.
_NOT_CURVE = ElementKeys.model_fields.keys() - CurveKeys.model_fields.keys()


class PartKeys(ElementKeys):
    """One of several elements side by side."""

    @model_validator(mode="after")
    def _some_curve(self) -> PartKeys:
        if not self.forms:
            refuse(f"is no element: add one of {', '.join(CurveKeys.names())}.")
        return self
