"""Force curves from CSV files, as elements or inserted into a design file."""

import os
import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell.base import InputError, Measure, most, require
from stepwell.files.cells import MAKE
from stepwell.files.schema import elements as schema
from stepwell.files.schema.keys import written
from stepwell.files.text import DesignError, inline, key_path, parsed, refuse_any, value_text
from stepwell.mechanism import Element

if TYPE_CHECKING:
    from stepwell.lab import MeasuredCurve, Reading

# A key that names a file, on one line; other strings and comments match without a group.
_KEYS = r"(?:table|points|curve)_csv"
_TEXT = r"""(?:"(?:[^"\\\n]|\\.)*"|'[^'\n]*')"""
_NAMED = re.compile(
    rf"""{_TEXT}|\#[^\n]*|(?<![\w."'-])(?:(?P<key>{_KEYS})[ \t]*=[ \t]*(?P<name>{_TEXT})"""
    rf"""|(?P<word>\w+)[ \t]*=[ \t]*(?P<value>{_TEXT}|\d+))"""
)
# A longer file is reduced to as many points, the means of consecutive rows.
_MOST_POINTS = 2000


def load_element(
    file: str | os.PathLike[str],
    name: str | None = None,
    *,
    form: str = "table",
    half: str | None = None,
    reading: "Reading | None" = None,
    stops: bool | tuple[bool, bool] = False,
    noise: float | None = None,
    friction: float = 0.0,
    mobility: float = 1.0,
) -> Element:
    """An element with the force curve in a file; its measure follows from the units.

    Args:
        file: a table of text, or a workbook, with columns such as "travel_mm,force_N",
            "Displacement [mm];Force [N]", "volume_mL,pressure_kPa" or "Angle (deg), Torque (N mm)";
            other columns are allowed. More rows than STEPWELL_LIMITS allows (10,000) are reduced
            to 2000 points, and `error_band` is the largest distance of a row from the curve.
        name: its name in messages and figures; by default that of the file.
        form: "table" for a smooth curve through the points, "points" for straight lines between
            them, "curve" for a curve that folds back, with points along the arc.
        half: "loading" or "unloading", to select a half of a recording with both.
        reading: columns, units, signs and part, where the file leaves them open; see `lab.Reading`.
        stops: whether it has stops at the low and at the high end of its curve.
        noise: standard deviation of the forces of a table [N], for smoothing.
        friction: Coulomb friction against travel [N], >= 0.
        mobility: speed per force, relative to the other cells of its chain.

    Raises:
        LabError: the file is missing or broken, no reading of its columns stands out, or it has
            loading and unloading and `half` is None.
        ValueError: the curve is not valid for an element.
    """
    from stepwell import lab

    if form not in MAKE:
        raise InputError(f"form = {form!r}: must be one of {', '.join(map(repr, MAKE))}.")
    if noise is not None and form != "table":
        raise InputError(f"noise is for form='table' only, which is smoothed; form = {form!r}.")
    if half not in (None, "loading", "unloading"):
        raise InputError(f"half = {half!r}: must be 'loading', 'unloading' or None.")
    chosen = reading if half is None else replace(reading or lab.Reading(), half=half)
    curve = lab.read_curve(file, chosen)
    options: dict[str, Any] = {"noise": noise} if form == "table" else {}
    options |= {"stops": stops, "friction": friction, "mobility": mobility}
    x, y, band = _columns(curve, form)
    named = Path(file).stem if name is None else name
    try:
        made = MAKE[form](x, y, named, measure=curve.measure, unusual=True, **options)
    except InputError as error:
        raise lab.LabError(os.fspath(file), str(error)) from None
    return replace(made, error_band=max(made.error_band, band)) if band else made


def with_curves(text: str, name: str) -> str:
    """The text of a design file with the numbers of its CSV files instead of their names.

    Such a text is complete without other files, and its hash changes with a curve. CSV files must
    be in the folder of the design file or below it; others raise a DesignError.
    """
    tables = _tables(text) if "_csv" in text else {}
    if not tables:
        return text
    named = list(_names((), tables))
    matches = _matching(text, named)
    if matches is None:
        raise DesignError(name, [_UNCLEAR_CSV])
    curves, end = _Curves(Path(name).parent), 0
    problems: list[str] = []
    out = ""
    for (path, value), match in zip(named, matches, strict=True):
        out += text[end : match.start()]
        end = match.end()
        if path[-1] in WORDS:
            out, end = _without(out, text, end)
            continue
        try:
            keys = curves.of(path, value, _reading(tables, path))
            _replace_key(tables, path, keys)
        except ValueError as error:
            problem = getattr(error, "problem", error)  # without the name of the file
            problems.append(f"{key_path(path)} = {value_text(value)}: {problem}")
            continue
        alone = not out.rpartition("\n")[2].strip()
        out += ("\n" if alone else ", ").join(f"{key} = {one}" for key, one in keys.items())
    refuse_any(name, problems)
    changed = out + text[end:]
    if _tables(changed) != tables:
        raise DesignError(name, [_UNCLEAR_CSV])
    return changed


def _without(out: str, text: str, end: int) -> tuple[str, int]:
    """The text before a key that is left out, and the place after it, without its comma."""
    if out.rstrip(" \t").endswith(","):
        return out.rstrip(" \t,"), end
    comma = re.compile(r"[ \t]*,[ \t]*").match(text, end)
    return out, comma.end() if comma else end


def _matching(text: str, named: list[tuple["_Path", Any]]) -> list[re.Match[str]] | None:
    """Places of these keys in the text, in the same order; None if a key is written otherwise."""
    found: list[re.Match[str]] = []
    wanted = iter(named)
    path, value = next(wanted)
    for match in _NAMED.finditer(text):
        if len(found) < len(named) and (path[-1], value) == _key_and_value(match):
            found.append(match)
            path, value = next(wanted, (path, value))
        elif match["key"]:
            return None
    return found if len(found) == len(named) else None


def _reading(tables: Any, path: "_Path") -> "Reading":
    """How a file is read: the keys beside its name, which are taken out of the table."""
    from stepwell import lab

    place = _table_at(tables, path)
    return lab.Reading.of({key: place.pop(key) for key in WORDS if key in place})


_UNCLEAR_CSV = (
    "names CSV files in an unsupported way: write each such key once, in the table of its cell or "
    'band, as in table_csv = "dome.csv", and not inside other text.'
)
_Path = tuple[str | int, ...]
# Keys beside the name of a file that select its columns and its part; fields of `lab.Reading`.
WORDS = ("stroke", "force", "unit", "flip", "half", "cycle", "skip", "sample", "decimal")


class _Curves:
    def __init__(self, folder: Path):
        self._folder = folder
        self._read: dict[tuple[str, Any], MeasuredCurve] = {}
        self._bytes = 0

    def of(self, path: _Path, name: str, reading: "Reading") -> dict[str, str]:
        """Keys and values that replace the name of a file, or a ValueError."""
        form = str(path[-1]).removesuffix("_csv")
        home = next(step for step in reversed(path[:-1]) if isinstance(step, str))
        of_band = home in ("band", "bands")
        if home not in ("cell", "beside", "inside") and not (of_band and form == "table"):
            raise InputError("belongs in the table of a cell, or table_csv in that of a band.")
        curve = self._curve(name, reading)
        x, y, band = _columns(curve, form)
        if of_band:
            if curve.measure is not Measure.TRAVEL:
                has = f"has {curve.measure.travel} and {curve.measure.force}"
                must = "a band has extension and tension, as in extension_mm,tension_N."
                raise InputError(f"{has}: {must}")
            keys = {"table_mm_N": written("table_mm_N", tuple(zip(x, y, strict=True)))}
        else:
            columns = zip(schema.COLUMNS[curve.measure], (x, y), strict=True)
            keys = {form: inline({one: written(one, column) for one, column in columns})}
            if band:
                key = schema.key_in("error_band", curve.measure.force_unit)
                keys[key] = written(key, band)
        self._bytes += sum(map(len, keys.values()))
        require("design_bytes", self._bytes, "with its curves it has")
        return keys

    def _curve(self, name: str, reading: "Reading") -> "MeasuredCurve":
        from stepwell import lab

        if (name, reading) not in self._read:
            self._read[name, reading] = lab.read_curve(self._place(name), reading)
        return self._read[name, reading]

    def _place(self, name: str) -> Path:
        """Path of the file; ValueError if it is not in the folder of the design or below."""
        place, inside = self._folder / name, False
        with suppress(ValueError):  # a name with a zero byte in it
            inside = Path(os.path.realpath(place)).is_relative_to(os.path.realpath(self._folder))
        if not name or Path(name).is_absolute() or ".." in Path(name).parts or not inside:
            where = "in the folder of the design, or in a folder below it"
            raise InputError(f"must be the name of a file {where}.")
        return place


def _columns(
    curve: "MeasuredCurve", form: str
) -> tuple[tuple[float, ...], tuple[float, ...], float]:
    """Travels and forces, along the arc for a curve that folds back, else rising; the error band.

    The error band is the largest distance of a row from its curve: 0 unless a long file is reduced.
    """
    x, y = (curve.travel, curve.force) if form == "curve" else curve.rising()
    count = min(_MOST_POINTS, most("rows"))
    if len(x) <= most("rows") or count < 4:
        require("rows", len(x), "the file has")
        return tuple(x.tolist()), tuple(y.tolist()), 0.0
    starts = np.linspace(1, len(x) - 1, count - 2, endpoint=False).astype(int)
    sizes = np.diff([*starts, len(x) - 1])
    means = [np.add.reduceat(v[: len(x) - 1], starts) / sizes for v in (x, y)]
    a, b = (np.array([v[0], *m, v[-1]]) for v, m in zip((x, y), means, strict=True))
    if form == "curve":
        near = np.repeat(b, np.concatenate([[1], sizes, [1]]))
    else:
        near = np.interp(x, a, b)
    return tuple(a.tolist()), tuple(b.tolist()), float(np.max(np.abs(y - near)))


def _tables(text: str) -> dict[str, Any]:
    """Tables of the text; empty if it is no TOML, which raises an error later."""
    with suppress(DesignError):
        return parsed(text, "", "")
    return {}


def _names(path: _Path, value: Any) -> Iterator[tuple[_Path, Any]]:
    """Names of files, and the keys beside them that say how they are read, in order."""
    if isinstance(value, dict):
        reads = any(re.fullmatch(_KEYS, key) and isinstance(v, str) for key, v in value.items())
        for key, below in value.items():
            is_name = re.fullmatch(_KEYS, key) and isinstance(below, str)
            if is_name or (reads and key in WORDS):
                yield (*path, key), below
            else:
                yield from _names((*path, key), below)
    elif isinstance(value, list):
        for i, below in enumerate(value):
            yield from _names((*path, i), below)


def _key_and_value(match: re.Match[str]) -> tuple[str, Any]:
    value = match["name"] or match["value"]
    return match["key"] or match["word"] or "", _tables(f"x = {value}").get("x", "")


def _table_at(tables: Any, path: _Path) -> dict[str, Any]:
    for step in path[:-1]:
        tables = tables[step]
    return tables


def _replace_key(tables: Any, path: _Path, keys: dict[str, str]) -> None:
    place = _table_at(tables, path)
    form = next(iter(keys))
    if form in place:
        raise InputError(f"cannot be combined with {form}: keep one of them.")
    for key in list(keys)[1:]:
        if any(one.startswith(("error_band_", "noise_")) for one in place):
            del keys[key]
    del place[str(path[-1])]
    place |= {key: parsed(f"x = {numbers}", "", "")["x"] for key, numbers in keys.items()}
