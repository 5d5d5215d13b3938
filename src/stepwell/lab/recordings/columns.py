"""Roles of the columns of a table of numbers, with conversion factors to SI."""

import re
from itertools import product
from typing import NamedTuple

from stepwell.base import GRAVITY, UNITS, InputError, Measure, spellings

WEIGHTS = spellings("kg")

# In the order of the search, so that "Load time" is a time.
ROLES = {
    "time": ("time", "zeit"),
    "stroke": ("displacement", "stroke", "extension", "position", "crosshead", "travel", "weg"),
    "force": ("force", "load", "kraft"),
    "volume": ("volume", "volumen"),
    "pressure": ("pressure", "druck"),
    "angle": ("angle", "rotation", "twist", "winkel"),
    "torque": ("torque", "moment"),
}
# Units that a column of each role may have, with factors to SI. A mass is read as its weight.
_SI = dict(zip(ROLES, ("s", "m", "N", "m³", "Pa", "rad", "N m"), strict=True))
FACTORS = {role: {unit: UNITS[unit].size for unit in spellings(si)} for role, si in _SI.items()}
FACTORS["force"] |= {unit: UNITS[unit].size * GRAVITY for unit in WEIGHTS}
# Names in a handmade table, if no column has a name above: a weight is a force, and the length of
# the band replaces the stroke.
_AT_HOME = {"force": ("weight", "mass", "gewicht", "masse"), "length": ("length", "länge")}
# Units that are unambiguous in capitals too, unlike M and m, MN and mN, ML and mL.
_ANY_CASE = {
    *("mm", "cm", "in", "inch", "inches"),
    *("g", "gf", "kg", "kgf", "oz", "ozf", "lb", "lbf"),
}
# Columns of a recording of a test machine; columns of the curve of an element, with the measures
# that they belong to.
_RECORDED = ("time", "stroke", "force")
_TRAVELS = {"stroke": Measure.TRAVEL, "volume": Measure.VOLUME, "angle": Measure.ANGLE}
_FORCES = {"force": Measure.TRAVEL, "pressure": Measure.VOLUME, "torque": Measure.ANGLE}
EXAMPLE = "Time (s), Displacement (mm), Force (N)"
_HOME_EXAMPLE = "Length (mm), Weight (g)"
_PAIR = "travel_mm,force_N"
_PAIRS = "travel and force (mm, N), volume and pressure (mL, kPa) or angle and torque (deg, N mm)"

_UNIT = re.compile(r"[(\[]\s*([^()\[\]]*?)\s*[)\]]")
_WORD = re.compile(r"[^\s(\[]+(?:\s*[(\[][^)\]]*[)\]])?|[(\[][^)\]]*[)\]]")


def split(line: str, delimiter: str | None) -> list[str]:
    """Fields of a line without quotes; None splits at blanks."""
    fields = line.split(delimiter) if delimiter else line.split()
    return [field.strip().strip('"').strip() for field in fields]


class FoundColumn(NamedTuple):
    """A column: its index in a row, its factor to SI, and its unit."""

    place: int
    factor: float
    unit: str


def columns(header: list[str], delimiter: str | None, count: int) -> dict[str, FoundColumn]:
    """Columns of time, stroke or band length, and force by role, from names and units.

    Raises:
        ValueError: a necessary column is not named, or its unit is missing or unknown.
    """
    names, units = _named(header, delimiter, count, EXAMPLE)
    by_role: dict[str, FoundColumn] = {}

    def look(role: str, words: tuple[str, ...], kind: str) -> None:
        taken = {column.place for column in by_role.values()}
        for place, name in enumerate(names):
            if place not in taken and any(word in name.lower() for word in words):
                by_role[role] = FoundColumn(place, _factor(kind, name, units[place]), units[place])
                return

    for role in _RECORDED:
        look(role, ROLES[role], role)
    if "stroke" not in by_role:
        look("length", _AT_HOME["length"], "stroke")
    if "force" not in by_role:
        look("force", _AT_HOME["force"], "force")
    for role, taken in (("stroke", {"stroke", "length"}), ("force", {"force"})):
        if not by_role.keys() & taken:
            shown = ", ".join(name for name in names if name) or "none"
            raise InputError(
                f"no column for the {role} (columns: {shown}): name the columns and their units, "
                f"as in {EXAMPLE} or {_HOME_EXAMPLE}."
            )
    return by_role


def pair(
    header: list[str], delimiter: str | None, count: int
) -> tuple[Measure, tuple[int, float], tuple[int, float]]:
    """Columns of travel and force of one measure: indices and factors to SI.

    Raises:
        ValueError: a column is missing or ambiguous, its unit is missing or unknown, or both
            columns do not belong together.
    """
    names, units = _named(header, delimiter, count, _PAIR)
    x, travel = _only(_TRAVELS, names, units)
    y, force = _only(_FORCES, names, units)
    if _TRAVELS[travel] is not _FORCES[force]:
        raise InputError(
            f"columns {names[x][:40]!r} in {units[x]} and {names[y][:40]!r} in {units[y]} do not "
            f"belong together: must be {_PAIRS}."
        )
    return (_TRAVELS[travel], (x, FACTORS[travel][units[x]]), (y, FACTORS[force][units[y]]))


def _only(roles: dict[str, Measure], names: list[str], units: list[str]) -> tuple[int, str]:
    """Index and role of the one column with a unit of these roles; of several the named one."""
    every = [(k, role) for k, unit in enumerate(units) for role in roles if unit in FACTORS[role]]
    named = [(k, role) for k, role in every if _is_called(names[k], role)]
    matches = every if len(every) < 2 else named or every
    if len(matches) == 1:
        return matches[0]
    words = " or ".join("travel" if role == "stroke" else role for role in roles)
    if matches:
        both = ", ".join(repr(names[k][:40]) for k, _ in matches)
        raise InputError(f"columns {both} could both be the {words}: leave out one of them.")
    for (name, unit), role in product(zip(names, units, strict=True), roles):
        if _is_called(name, role):
            _factor(role, name, unit)
    shown = ", ".join(name[:40] for name in names if name) or "none"
    raise InputError(
        f"no column for the {words} (columns: {shown}): name the columns and their "
        f"units, as in {_PAIR}; they must be {_PAIRS}."
    )


def _is_called(name: str, role: str) -> bool:
    return any(word in name.lower() for word in ROLES[role])


def _named(
    header: list[str], delimiter: str | None, count: int, example: str
) -> tuple[list[str], list[str]]:
    """Names and units, from one line with both or from two lines."""
    rows = [row for line in header if len(row := _fields(line, delimiter)) == count]
    if not rows:
        raise InputError(
            f"no line above the numbers names the {count} columns: add one, as in {example}."
        )
    below = rows[-1]
    bare = [_UNIT.sub("", field).strip() for field in below]
    if len(rows) > 1 and (not any(bare) or all(_is_unit(field) for field in below)):
        units = [_unit(field) if _UNIT.search(field) else field for field in below]
        names = [_UNIT.sub("", field).strip() for field in rows[-2]]
    else:
        # The unit may be in a name such as stroke_mm.
        ends = [field.rpartition("_") for field in below]
        suffixes = [end if blank and _is_unit(end) else "" for _, blank, end in ends]
        names, units = bare, [_unit(f) or end for f, end in zip(below, suffixes, strict=True)]
    return names, [_spelled(unit) for unit in units]


def _fields(line: str, delimiter: str | None) -> list[str]:
    if delimiter is None:
        return [field.strip('"') for field in _WORD.findall(line)]
    return split(line, delimiter)


def _unit(field: str) -> str:
    match = _UNIT.search(field)
    return match[1] if match else ""


def _is_unit(text: str) -> bool:
    return any(_spelled(text) in units for units in FACTORS.values())


def _spelled(unit: str) -> str:
    """A unit as in `FACTORS`, in lower case if that is unambiguous."""
    return unit.lower() if unit.lower() in _ANY_CASE else unit


def _factor(role: str, name: str, unit: str) -> float:
    allowed = FACTORS[role]
    if unit in allowed:
        return allowed[unit]
    came = f"is in {unit[:30]!r}" if unit else "has no unit"
    raise InputError(
        f"column {name[:40]!r} {came}: must be one of {', '.join(allowed)}; write it into the "
        f"header or export the data again."
    )
