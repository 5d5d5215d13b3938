"""Force curves from CSV files, as elements or inserted into a design file."""

import os
import re
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stepwell.base import InputError, Measure, require
from stepwell.files.cells import MAKE
from stepwell.files.schema import elements as schema
from stepwell.files.schema.keys import written
from stepwell.files.text import DesignError, inline, key_path, parsed, refuse_any, value_text
from stepwell.mechanism import Element

if TYPE_CHECKING:
    from stepwell.lab import MeasuredCurve

# A key that names a file, on one line; other strings and comments match without a group.
_KEYS = r"(?:table|points|curve)_csv"
_TEXT = r"""(?:"(?:[^"\\\n]|\\.)*"|'[^'\n]*')"""
_NAMED = re.compile(
    rf"""{_TEXT}|\#[^\n]*|(?<![\w."'-])(?P<key>{_KEYS})[ \t]*=[ \t]*(?P<name>{_TEXT})"""
)


def load_element(
    file: str | os.PathLike[str],
    name: str | None = None,
    *,
    form: str = "table",
    half: str | None = None,
    stops: bool | tuple[bool, bool] = False,
    noise: float | None = None,
    friction: float = 0.0,
    mobility: float = 1.0,
) -> Element:
    """An element with the force curve in a file; its measure follows from the units.

    Args:
        file: text whose header names columns and units, such as "travel_mm,force_N", "Displacement
            [mm];Force [N]", "volume_mL,pressure_kPa" or "Angle (deg), Torque (N mm)", then rows of
            numbers; other columns are allowed.
        name: its name in messages and figures; by default that of the file.
        form: "table" for a smooth curve through the points, "points" for straight lines between
            them, "curve" for a curve that folds back, with points along the arc.
        half: "loading" or "unloading", to select a half of a recording with both.
        stops: whether it has stops at the low and at the high end of its curve.
        noise: standard deviation of the forces of a table [N], for smoothing.
        friction: Coulomb friction against travel [N], >= 0.
        mobility: speed per force, relative to the other cells of its chain.

    Raises:
        LabError: the file is missing or broken, its units are unknown or do not belong together, or
            it has loading and unloading and `half` is None.
        ValueError: the curve is not valid for an element.
    """
    from stepwell import lab

    if form not in MAKE:
        raise InputError(f"form = {form!r}: must be one of {', '.join(map(repr, MAKE))}.")
    if noise is not None and form != "table":
        raise InputError(f"noise is for form='table' only, which is smoothed; form = {form!r}.")
    curve = lab.read_curve(file)
    options: dict[str, Any] = {"noise": noise} if form == "table" else {}
    options |= {"stops": stops, "friction": friction, "mobility": mobility}
    x, y = _columns(curve, form, half)
    try:
        return MAKE[form](
            x,
            y,
            Path(file).stem if name is None else name,
            measure=curve.measure,
            unusual=True,
            **options,
        )
    except InputError as error:
        raise lab.LabError(os.fspath(file), str(error)) from None


def with_curves(text: str, name: str) -> str:
    """The text of a design file with the numbers of its CSV files instead of their names.

    Such a text is complete without other files, and its hash changes with a curve. CSV files must
    be in the folder of the design file or below it; others raise a DesignError.
    """
    tables = _tables(text) if "_csv" in text else {}
    if not tables:
        return text
    named = list(_names((), tables))
    matches = [match for match in _NAMED.finditer(text) if match["key"]]
    if [(path[-1], value) for path, value in named] != [_key_and_name(match) for match in matches]:
        raise DesignError(name, [_UNCLEAR_CSV])
    curves, end = _Curves(Path(name).parent), 0
    problems: list[str] = []
    pieces: list[str] = []
    for (path, value), match in zip(named, matches, strict=True):
        try:
            key, numbers = curves.of(path, value)
            _replace_key(tables, path, key, numbers)
        except ValueError as error:
            problems.append(f"{key_path(path)} = {value_text(value)}: {error}")
            continue
        pieces += [text[end : match.start()], f"{key} = {numbers}"]
        end = match.end()
    refuse_any(name, problems)
    changed = "".join([*pieces, text[end:]])
    if _tables(changed) != tables:
        raise DesignError(name, [_UNCLEAR_CSV])
    return changed


_UNCLEAR_CSV = (
    "names CSV files in an unsupported way: write each such key once, in the table of its cell or "
    'band, as in table_csv = "dome.csv", and not inside other text.'
)
_Path = tuple[str | int, ...]


class _Curves:
    def __init__(self, folder: Path):
        self._folder = folder
        self._read: dict[str, MeasuredCurve] = {}
        self._bytes = 0

    def of(self, path: _Path, name: str) -> tuple[str, str]:
        """Key and value that replace the name of a file, or a ValueError."""
        form = str(path[-1]).removesuffix("_csv")
        home = next(step for step in reversed(path[:-1]) if isinstance(step, str))
        of_band = home in ("band", "bands")
        if home not in ("cell", "beside", "inside") and not (of_band and form == "table"):
            raise InputError("belongs in the table of a cell, or table_csv in that of a band.")
        curve = self._curve(name)
        x, y = _columns(curve, form, None)
        require("rows", len(x), "the file has")
        if of_band:
            if curve.measure is not Measure.TRAVEL:
                has = f"has {curve.measure.travel} and {curve.measure.force}"
                must = "a band has extension and tension, as in extension_mm,tension_N."
                raise InputError(f"{has}: {must}")
            key, numbers = "table_mm_N", written("table_mm_N", tuple(zip(x, y, strict=True)))
        else:
            columns = zip(schema.COLUMNS[curve.measure], (x, y), strict=True)
            key, numbers = form, inline({one: written(one, column) for one, column in columns})
        self._bytes += len(numbers)
        require("design_bytes", self._bytes, "with its curves it has")
        return key, numbers

    def _curve(self, name: str) -> "MeasuredCurve":
        from stepwell import lab

        if name not in self._read:
            try:
                self._read[name] = lab.read_curve(self._place(name))
            except lab.LabError as error:
                raise InputError(error.problem) from None
        return self._read[name]

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
    curve: "MeasuredCurve", form: str, half: str | None
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Travels and forces, along the arc for a curve that folds back, else rising."""
    along = form == "curve" and half is None
    x, y = (curve.travel, curve.force) if along else curve.rising(half)
    return tuple(x.tolist()), tuple(y.tolist())


def _tables(text: str) -> dict[str, Any]:
    """Tables of the text; empty if it is no TOML, which raises an error later."""
    with suppress(DesignError):
        return parsed(text, "", "")
    return {}


def _names(path: _Path, value: Any) -> Iterator[tuple[_Path, str]]:
    if isinstance(value, dict):
        for key, below in value.items():
            if re.fullmatch(_KEYS, key) and isinstance(below, str):
                yield (*path, key), below
            else:
                yield from _names((*path, key), below)
    elif isinstance(value, list):
        for i, below in enumerate(value):
            yield from _names((*path, i), below)


def _key_and_name(match: re.Match[str]) -> tuple[str, str]:
    return match["key"], _tables(f"x = {match['name']}").get("x", "")


def _replace_key(tables: Any, path: _Path, key: str, numbers: str) -> None:
    place = tables
    for step in path[:-1]:
        place = place[step]
    if key in place:
        raise InputError(f"cannot be combined with {key}: keep one of them.")
    del place[path[-1]]
    place[key] = parsed(f"x = {numbers}", "", "")["x"]
