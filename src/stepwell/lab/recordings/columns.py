"""Which column of an export is time, stroke or force, with the factor that makes it SI."""

from __future__ import annotations

import re

from stepwell.base import InputError

# In the order in which they are looked for: "Time" in "Load time" is a time.
ROLES = {
    "time": ("time", "zeit"),
    "stroke": ("displacement", "stroke", "extension", "position", "crosshead", "travel", "weg"),
    "force": ("force", "load", "kraft"),
}
UNITS = {
    "time": {"s": 1.0, "sec": 1.0, "ms": 1e-3, "min": 60.0},
    "stroke": {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "um": 1e-6, "µm": 1e-6, "in": 0.0254},
    "force": {"N": 1.0, "mN": 1e-3, "kN": 1e3, "lbf": 4.4482216152605, "kgf": 9.80665},
}
NEEDED = ("stroke", "force")
EXAMPLE = "Time (s), Displacement (mm), Force (N)"

_UNIT = re.compile(r"[(\[]\s*([^()\[\]]*?)\s*[)\]]")
_WORD = re.compile(r"[^\s(\[]+(?:\s*[(\[][^)\]]*[)\]])?|[(\[][^)\]]*[)\]]")


def split(line: str, delimiter: str | None) -> list[str]:
    """The fields of a line, without quotes; None splits at blanks."""
    fields = line.split(delimiter) if delimiter else line.split()
    return [field.strip().strip('"').strip() for field in fields]


def columns(header: list[str], delimiter: str | None, count: int) -> dict[str, tuple[int, float]]:
    """Time, stroke and force among `count` columns, by the names and units above them.

    Args:
        header: the lines above the numbers.
        delimiter: what separates fields; None for blanks.
        count: how many fields a row of numbers has.

    Returns:
        For each quantity that is there its place in a row, and the factor that makes it SI.

    Raises:
        ValueError: a column that is needed is not named, or its unit is missing or unknown.
    """
    names, units = _named(header, delimiter, count)
    found: dict[str, tuple[int, float]] = {}
    for role, words in ROLES.items():
        for place, name in enumerate(names):
            if role not in found and any(word in name.lower() for word in words):
                found[role] = place, _factor(role, name, units[place])
    for role in NEEDED:
        if role not in found:
            shown = ", ".join(name for name in names if name) or "none"
            raise InputError(
                f"no column for the {role} (columns: {shown}): name the columns and their units, "
                f"as in {EXAMPLE}."
            )
    return found


def _named(header: list[str], delimiter: str | None, count: int) -> tuple[list[str], list[str]]:
    """Names and units, from one line that holds both or from a line of each."""
    rows = [row for line in header if len(row := _fields(line, delimiter)) == count]
    if not rows:
        raise InputError(
            f"no line above the numbers names its {count} columns: put one there, as in {EXAMPLE}."
        )
    below = rows[-1]
    bare = [_UNIT.sub("", field).strip() for field in below]
    if len(rows) > 1 and (not any(bare) or all(_is_unit(field) for field in below)):
        units = [_unit(field) if _UNIT.search(field) else field for field in below]
        return [_UNIT.sub("", field).strip() for field in rows[-2]], units
    return bare, [_unit(field) or _suffix(field) for field in below]


def _fields(line: str, delimiter: str | None) -> list[str]:
    if delimiter is None:
        return [field.strip('"') for field in _WORD.findall(line)]
    return split(line, delimiter)


def _unit(field: str) -> str:
    found = _UNIT.search(field)
    return found[1] if found else ""


def _suffix(field: str) -> str:
    """The unit in a name such as stroke_mm."""
    end = field.rpartition("_")[2]
    return end if _is_unit(end) and "_" in field else ""


def _is_unit(text: str) -> bool:
    return any(text in units for units in UNITS.values())


def _factor(role: str, name: str, unit: str) -> float:
    allowed = UNITS[role]
    if unit in allowed:
        return allowed[unit]
    came = f"is in {unit[:30]!r}" if unit else "has no unit"
    raise InputError(
        f"column {name[:40]!r} {came}: must be one of {', '.join(allowed)}; write it into the "
        f"header or export the data again."
    )
