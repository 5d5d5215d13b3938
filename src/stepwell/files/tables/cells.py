"""The tables of a design file about one cell, as a cell."""

from __future__ import annotations

from decimal import Decimal
from typing import Any, NamedTuple

from stepwell.files.schema import chain as schema, told
from stepwell.files.text import units, value_text
from stepwell.mechanism import Band, Cell, Cubic, Law, Linear, Load, Slip, SlipError, Table


class Shared(NamedTuple):
    """What the cells of a chain share."""

    lever_mm: Decimal | None
    limit_deg: Decimal | None
    unusual: bool
    band: dict[str, Any]


def cell(keys: schema.CellKeys, shared: Shared, where: str, problems: list[str]) -> Cell | None:
    """One cell, with what its chain shares; None where that is no cell, and then why."""
    geometry: dict[str, Any] = {}
    lever = keys.lever_mm or shared.lever_mm
    limit = keys.limit_deg or shared.limit_deg
    if lever is not None:
        geometry["lever"] = units.moved(lever, -3)
    if limit is not None:
        geometry["limit"] = units.radians(limit)
    before = len(problems)
    own = merged(shared.band, keys.band.given(), f"{where}.band", problems)
    tables = [own | {"p_mm": keys.p_mm, "q_mm": keys.q_mm}]
    if keys.bands is not None:
        tables = [
            merged(own, placed.given(), f"{where}.bands[{j}]", problems)
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
            unusual=shared.unusual if keys.unusual is None else keys.unusual,
            **geometry,
        )
    except SlipError as error:
        for slip in error.slips:
            band = None if slip.band is None else tables[slip.band]
            at = f"{where}.bands[{slip.band}]" if keys.bands and band else where
            problems.append(f"{at}.{told(slip, _key(slip, keys, band))} {UNUSUAL}")
        return None
    except ValueError as error:
        problems.append(f"{where}: {error}")
        return None


def _key(slip: Slip, cell: schema.CellKeys, band: dict[str, Any] | None) -> str:
    """The key of a cell, or of its band, that holds a size."""
    if slip.name == "load.force" and cell.load_N is not None:
        return "load_N"
    if band is None or slip.name not in ("extension", "tension"):
        return _KEYS[slip.name]
    return "table_mm_N" if "table_mm_N" in band else "shape_mm"


_KEYS = {
    "p": "p_mm",
    "q": "q_mm",
    "lever": "lever_mm",
    "limit": "limit_deg",
    "rest_length": "rest_length_mm",
    "stiffness": "stiffness_N_per_m",
    "a2": "quadratic_per_mm",
    "a3": "cubic_per_mm2",
    "friction": "friction_N",
    "load.travel": "load_mm_N",
    "load.force": "load_mm_N",
}
UNUSUAL = "If it is meant so, set unusual = true in the table of the cell."


def merged(
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
    band = kept | own
    if "table_mm_N" in band and "stiffness_N_per_m" in band:
        value = value_text(band.pop("stiffness_N_per_m"))
        problems.append(f"{where}.stiffness_N_per_m = {value}: {schema.TABLE_OWNS_STIFFNESS}")
    return band


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
