"""The only table of units: the SI unit of each and how many SI units make one.

All internal values are in SI. `to_unit` and `from_unit` convert at inputs and outputs with another
unit.
"""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING, NamedTuple, TypeVar

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Number = TypeVar("Number", float, NDArray[np.float64])

GRAVITY = 9.80665  # [m/s²], the standard acceleration of free fall
_POUND = 0.45359237  # [kg]

# By SI unit: the spellings of each unit, and how many SI units make one. A whole number is a power
# of ten. The first spelling is used for display.
_TABLE: dict[str, dict[tuple[str, ...], int | float]] = {
    "1": {("1",): 0, ("%", "percent"): -2},
    "m": {
        ("mm",): -3,
        ("cm",): -2,
        ("m",): 0,
        ("um", "µm"): -6,
        ("in", "inch", "inches", '"'): 0.0254,
    },
    "m/s": {("m/s",): 0, ("mm/s", "mm_s"): -3},
    "m/s²": {("m/s²",): 0},
    "1/m": {("1/m",): 0, ("1/mm",): 3},
    "1/m²": {("1/m²",): 0, ("1/mm²",): 6},
    "N": {
        ("N",): 0,
        ("mN",): -3,
        ("kN",): 3,
        ("lbf",): _POUND * GRAVITY,
        ("kgf",): GRAVITY,
        ("gf",): GRAVITY * 1e-3,
        ("ozf",): _POUND * GRAVITY / 16.0,
    },
    "N/m": {("N/m",): 0},
    "N s/m": {("N s/m",): 0},
    "m/N": {("m/N",): 0, ("mm/N",): -3},
    "J": {("J",): 0, ("mJ",): -3},
    "s": {("s", "sec"): 0, ("ms",): -3, ("min",): 60.0},
    "kg": {("g",): -3, ("kg",): 0, ("oz",): _POUND / 16.0, ("lb",): _POUND},
    "m³": {
        ("m³", "m3"): 0,
        ("L", "l", "dm3"): -3,
        ("mL", "ml", "cm³", "cm3"): -6,
        ("µL", "uL", "mm³", "mm3"): -9,
    },
    "Pa": {
        ("Pa",): 0,
        ("hPa", "mbar"): 2,
        ("kPa",): 3,
        ("bar",): 5,
        ("MPa",): 6,
        ("GPa",): 9,
        ("psi",): 6894.757293168,
    },
    "kg/m³": {("kg/m³", "kg/m3"): 0},
    "Pa/m³": {("Pa/m³",): 0, ("kPa/mL", "kPa_per_mL"): 9},
    "rad": {("rad",): 0, ("mrad",): -3, ("deg", "°"): math.pi / 180.0},
    "N m": {
        ("N m", "Nm", "N·m"): 0,
        ("N cm", "Ncm", "N·cm"): -2,
        ("N mm", "Nmm", "N·mm"): -3,
        ("mN m", "mNm", "mN·m"): -3,
    },
    "N m/rad": {("N m/rad",): 0},
    "N m s/rad": {("N m s/rad",): 0},
}
# Display unit of an SI unit; all others are displayed in SI.
_SHOWN = {
    "m": "mm",
    "J": "mJ",
    "kg": "g",
    "rad": "deg",
    "m³": "mL",
    "Pa": "kPa",
    "N m": "mNm",
    "Pa/m³": "kPa_per_mL",
    "m/N": "mm/N",
}


class Unit(NamedTuple):
    """A unit: its SI unit, its symbol, and both factors as the nearest floats.

    `size` is how many SI units make one, `per_si` how many of it make one SI unit, `places` the
    power of ten of `size`, None if `size` is none.
    """

    si: str
    sign: str
    size: float
    per_si: float
    places: int | None


def _unit(si: str, sign: str, size: int | float) -> Unit:
    if isinstance(size, int):
        return Unit(si, sign, float(f"1e{size}"), float(f"1e{-size}"), size)
    return Unit(si, sign, size, 180.0 / math.pi if sign == "deg" else 1.0 / size, None)


UNITS = {
    spelling: _unit(si, spellings[0], size)
    for si, units in _TABLE.items()
    for spellings, size in units.items()
    for spelling in spellings
}


@cache
def spellings(si: str) -> tuple[str, ...]:
    """Every spelling of every unit of an SI unit, in the order of the table."""
    return tuple(spelling for spelling, unit in UNITS.items() if unit.si == si)


def to_unit(value: Number, unit: str) -> Number:
    """A value in SI, or an array of them, in a unit of the table: 0.01 m is 10.0 "mm"."""
    return value * UNITS[unit].per_si


def from_unit(value: Number, unit: str) -> Number:
    """A value in a unit of the table, or an array of them, in SI: 10 "mm" is 0.01 m.

    A division, since 1e3 is exact as a float and 1e-3 is not: the result is the nearest float.
    """
    return value / UNITS[unit].per_si


def in_names(unit: str) -> str:
    """A unit as part of a key: N m/rad is N_m_per_rad, 1/mm² is per_mm2."""
    spelled = unit.replace("/", "_per_").replace(" ", "_").replace("²", "2").replace("³", "3")
    return spelled.removeprefix("1_")


def display_unit(unit: str) -> tuple[str, float]:
    """The display unit of an SI unit, and how many of it make one SI unit."""
    shown = _SHOWN.get(unit, unit)
    return shown, UNITS[shown].per_si if shown in UNITS else 1.0
