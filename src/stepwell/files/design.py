"""The text of a design file in, a chain out."""

from __future__ import annotations

import re
import tomllib
from decimal import Decimal, InvalidOperation
from typing import Any

from pydantic import ValidationError

from stepwell.files import _schema as schema, _units as units
from stepwell.files._errors import DesignError, value_text
from stepwell.files._wording import worded
from stepwell.mechanism import Band, Cell, Chain, Cubic, Law, Linear, Load, Table


def loads(text: str, name: str = "design") -> Chain:
    """The chain that the text of a design file describes.

    Args:
        text: TOML.
        name: what messages call it.

    Returns:
        The chain, in SI.

    Raises:
        DesignError: the text is no TOML, or asks for what no mechanism can be; its own text
            has one line for every problem.
    """
    try:
        keys = schema.FileKeys.model_validate(_parsed(text, name))
    except ValidationError as error:
        raise DesignError(name, worded(error)) from None
    problems: list[str] = []
    cells = [_cell(keys.chain, i, problems) for i in range(len(keys.chain.cell))]
    if problems:
        raise DesignError(name, problems)
    actuator = float(keys.chain.actuator_stiffness_N_per_m)
    return Chain(tuple(cell for cell in cells if cell), actuator, keys.title)


def _parsed(text: str, name: str) -> dict[str, Any]:
    if not text.strip():
        raise DesignError(name, ["is empty: a design file starts with a [chain] table."])
    try:
        return tomllib.loads(text.replace("\r\n", "\n"), parse_float=_decimal)
    except RecursionError:
        raise DesignError(name, ["is nested too deeply to be a design file."]) from None
    except ValueError as error:
        place = re.search(r" \(at (?:line (\d+), column (\d+)|end of document)\)$", str(error))
        if not isinstance(error, tomllib.TOMLDecodeError):
            raise DesignError(name, ["holds an integer of thousands of digits."]) from None
        if place is None:
            raise DesignError(name, [f"{error}."]) from None
        last = text.count("\n") + 1
        where = f"line {place[1]}, column {place[2]}" if place[1] else f"line {last}, at the end"
        raise DesignError(name, [f"{where}: {str(error)[: place.start()]}."]) from None


def _decimal(text: str) -> Decimal:
    try:
        return Decimal(text)
    except InvalidOperation:  # an exponent past a billion billion
        return Decimal(float(text))


def _cell(chain: schema.ChainKeys, index: int, problems: list[str]) -> Cell | None:
    keys = chain.cell[index]
    where = f"chain.cell[{index}]"
    geometry: dict[str, float] = {}
    lever = keys.lever_mm or chain.lever_mm
    limit = keys.limit_deg or chain.limit_deg
    if lever is not None:
        geometry["lever"] = units.moved(lever, -3)
    if limit is not None:
        geometry["limit"] = units.radians(limit)
    before = len(problems)
    own = _merged(chain.band.given(), keys.band.given(), f"{where}.band", problems)
    tables = [own | {"p_mm": keys.p_mm, "q_mm": keys.q_mm}]
    if keys.bands is not None:
        tables = [
            _merged(own, placed.given(), f"{where}.bands[{j}]", problems)
            for j, placed in enumerate(keys.bands)
        ]
    if len(problems) > before:
        return None
    try:
        return Cell(
            tuple(map(_band, tables)),
            load=_load(keys),
            friction=float(keys.friction_N),
            name=keys.name,
            **geometry,
        )
    except ValueError as error:
        problems.append(f"{where}: {error}")
        return None


def _merged(
    shared: dict[str, Any], own: dict[str, Any], where: str, problems: list[str]
) -> dict[str, Any]:
    """The shared band with its own keys over it; a law of its own replaces the shared law."""
    kept = dict(shared)
    if any(keys & own.keys() for keys in schema.LAWS.values()):
        for keys in schema.LAWS.values():
            for key in keys:
                kept.pop(key, None)
    if "table_mm_N" in own:
        kept.pop("stiffness_N_per_m", None)
    merged = kept | own
    if "table_mm_N" in merged and "stiffness_N_per_m" in merged:
        value = value_text(merged.pop("stiffness_N_per_m"))
        problems.append(f"{where}.stiffness_N_per_m = {value}: {schema.TABLE_OWNS_STIFFNESS}")
    return merged


def _band(keys: dict[str, Any]) -> Band:
    p, q = _metres(keys["p_mm"]), _metres(keys["q_mm"])
    values: dict[str, Any] = {"law": _law(keys)}
    if "rest_length_mm" in keys:
        values["rest_length"] = units.moved(keys["rest_length_mm"], -3)
    if "stiffness_N_per_m" in keys:
        values["stiffness"] = float(keys["stiffness_N_per_m"])
    if "table_mm_N" in keys:
        extension, tension = _columns(keys["table_mm_N"], -3, 0)
        measured = Band.from_table(p, q, 0.0, extension, tension)
        values |= {"law": measured.law, "stiffness": measured.stiffness}
    return Band(p, q, **values, two_sided=keys.get("two_sided", False))


def _metres(point: tuple[Decimal, Decimal]) -> tuple[float, float]:
    return units.moved(point[0], -3), units.moved(point[1], -3)


def _law(keys: dict[str, Any]) -> Law:
    if "shape_mm" in keys:
        return Table(*_columns(keys["shape_mm"], -3, -3))
    if "quadratic_per_mm" in keys or "cubic_per_mm2" in keys:
        none = Decimal(0)
        return Cubic(
            units.moved(keys.get("quadratic_per_mm", none), 3),
            units.moved(keys.get("cubic_per_mm2", none), 6),
        )
    return Linear()


def _load(keys: schema.CellKeys) -> Load | None:
    if keys.load_N is not None:
        return Load.constant(float(keys.load_N))
    if keys.load_mm_N is not None:
        return Load(*_columns(keys.load_mm_N, -3, 0))
    return None


def _columns(
    rows: tuple[tuple[Decimal, Decimal], ...], first: int, second: int
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The two columns of a table, the decimal points moved by `first` and `second` places."""
    return (
        tuple(units.moved(x, first) for x, _ in rows),
        tuple(units.moved(y, second) for _, y in rows),
    )
