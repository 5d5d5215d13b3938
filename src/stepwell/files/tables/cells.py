"""The tables of a design file about one cell, as a cell."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from stepwell.base import InputError, StepwellError
from stepwell.files.schema import chain as schema, field_of, fields, key_of, si, slip_text
from stepwell.files.tables.elements import element_of, with_options
from stepwell.files.text import value_text
from stepwell.mechanism import Band, Cell, Chain, Cubic, Element, Load, Slip, SlipError, Table


class Shared(NamedTuple):
    """What the cells of a chain share: fields of a cell, and keys of its band."""

    cell: dict[str, Any]
    band: dict[str, Any]

    @classmethod
    def of(cls, band: dict[str, Any], *tables: schema.SharedKeys) -> Shared:
        """What `band` says of all bands and the tables of all cells, the last one above all."""
        given = {key: value for table in tables for key, value in table.given().items()}
        names = given.keys() & {"lever_mm", "limit_deg", "unusual"}
        return cls({field_of(key): si(key, given[key]) for key in names}, band)


def cells_of(
    tables: Sequence[schema.OneCellKeys], shared: Shared, where: str, problems: list[str]
) -> tuple[Cell | Element, ...]:
    """The cells of a list; `problems` gets a line for all that is wrong with each."""
    cells = [
        (_element if one.forms else _cell)(shared, one, f"{where}[{i}]", problems)
        for i, one in enumerate(tables)
    ]
    return tuple(cell for cell in cells if cell)


def chain_of(cells: Sequence[Cell | Element], keys: schema.ChainKeys, title: str) -> Chain:
    """The chain of these cells, with its actuator.

    Raises:
        ValueError: cells that are no chain, or an actuator in the units of another one.
    """
    rigid = Chain(cells, title=title)
    right = schema.ACTUATORS[rigid.measure]
    for key in schema.ACTUATORS.values():
        stiffness = getattr(keys, key)
        if stiffness is not None and key != right:
            raise InputError(
                f"{key} = {value_text(stiffness)}: this chain is of {rigid.measure.travel} and "
                f"{rigid.measure.force}, so it must be {right}."
            )
    stiffness = getattr(keys, right)
    return rigid if stiffness is None else Chain(cells, si(right, stiffness), title)


def _element(
    shared: Shared, keys: schema.OneCellKeys, where: str, problems: list[str]
) -> Element | None:
    before = len(problems)
    inside = getattr(keys, "inside", None)
    cells = () if inside is None else cells_of(inside, shared, f"{where}.inside", problems)
    if len(problems) > before:
        return None
    try:
        if inside is None:
            return element_of(keys)
        return with_options(Element.from_chain(Chain(cells)), keys)
    except StepwellError as error:
        problems += [f"{where}: {line}" for line in str(error).split("\n")]
        return None


def _cell(shared: Shared, keys: schema.OneCellKeys, where: str, problems: list[str]) -> Cell | None:
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
    values = shared.cell | fields(keys, left_out=["p_mm", "q_mm", "band", "bands", "load_N"])
    try:
        if keys.load_N is not None:
            values["load"] = Load.constant(float(keys.load_N))
        elif keys.load_mm_N is not None:
            values["load"] = Load(*zip(*values["load"], strict=True))
        return Cell(tuple(map(_band, tables)), **values)
    except SlipError as error:
        for slip in error.slips:
            band = None if slip.band is None else tables[slip.band]
            at = f"{where}.bands[{slip.band}]" if keys.bands and band else where
            problems.append(f"{at}.{slip_text(slip, _key(slip, keys, band))} {UNUSUAL}")
        return None
    except ValueError as error:
        problems.append(f"{where}: {error}")
        return None


def _key(slip: Slip, cell: schema.OneCellKeys, band: dict[str, Any] | None) -> str:
    """The key of a cell, or of its band, that holds a size."""
    if slip.name.startswith("load."):
        constant = slip.name == "load.force" and cell.load_N is not None
        return "load_N" if constant else "load_mm_N"
    if band is None or slip.name not in ("extension", "tension"):
        return key_of(slip)
    return "table_mm_N" if "table_mm_N" in band else "shape_mm"


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
    values = {field_of(key): si(key, value) for key, value in keys.items()}
    table, shape = values.pop("table", ()), values.pop("shape", ())
    cubic = values.pop("a2", None), values.pop("a3", None)
    if shape:
        values["law"] = Table(*zip(*shape, strict=True))
    elif cubic != (None, None):
        values["law"] = Cubic(*(number or 0.0 for number in cubic))
    elif table:
        measured = Band.from_table(values["p"], values["q"], 0.0, *zip(*table, strict=True))
        values |= {"law": measured.law, "stiffness": measured.stiffness}
    return Band(**values)
