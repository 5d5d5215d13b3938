"""A map over two parameters: the sequences, the fraction of the map of each, the boundaries."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell.accounts.head import About, Row, keys
from stepwell.accounts.parts import CARD, Account, Fact, Picture, RecordTable, Text
from stepwell.base import Column, Quantity, Schema, counted, display_unit, number, percent, record
from stepwell.sequences import Pathway

if TYPE_CHECKING:
    from stepwell.design import MapView

_BOUNDARY: Schema = (
    Quantity("changes", head="what changes"),
    *keys(kind=(str, lambda one: one.kind.name.lower()), between=([str], "sequences")),
    Quantity("method", head="method"),
    Quantity("error_of_axes", read="error", holds=float),
    Quantity("points", head="points", read=lambda one: len(one.points), holds=int, left=False),
)
_AXIS: Schema = (
    *keys(parameter=str, unit=str),
    Quantity("from", holds=float),
    *keys(to=float, count=int, design=float),
)


def _axis(view: MapView, name: str) -> Row:
    """An axis of a map, and the place of the design on it."""
    values, design = view.dataset[name], next(iter(view.designs.values()), None)
    unit, factor = display_unit(str(values.attrs["units"]))
    return {
        "parameter": str(values.attrs["long_name"]),
        "unit": unit,
        "from": float(values[0]) * factor,
        "to": float(values[-1]) * factor,
        "count": len(values),
        "design": None if design is None else float(design["xy".index(name)]) * factor,
    }


def _attribute(name: str, of: type = int) -> Any:
    return of, lambda view: of(view.dataset.attrs[name])


def _fractions(name: str) -> Any:
    """A function that returns the fraction of a map for each value of a field [1]."""

    def read(view: MapView) -> dict[str, float] | None:
        if name not in view.dataset:
            return None
        codes, flags = view.dataset[name].to_numpy(), view.dataset[name].attrs
        values, meanings = np.atleast_1d(flags["flag_values"]), flags["flag_meanings"].split()
        known = zip(values, meanings, strict=True)
        return {meaning: float(np.mean(codes == value)) for value, meaning in known}

    return read


# What is reported of a map.
MAP: Schema = (
    *keys(title=_attribute("title", str), across=(_AXIS, lambda view: _axis(view, "x"))),
    *keys(
        up=(_AXIS, lambda view: _axis(view, "y")), fractions=({str: float}, _fractions("sequence"))
    ),
    Quantity("pathway_fractions", read=_fractions("pathway"), holds={str: float}, missing=True),
    *keys(moved_cell=_attribute("moved_cell", str)),
    *keys(monostable_fraction=(float, lambda view: float(view.dataset["monostable"].mean()))),
    *keys(degenerate_designs=(int, lambda view: int(view.dataset["degenerate"].sum()))),
    *keys(closed_form_designs=_attribute("closed_form_designs")),
    *keys(engine_designs=_attribute("engine_designs"), boundaries=[_BOUNDARY]),
)


def map_view_account(view: MapView, about: About) -> Account:
    """What is reported of a map."""
    data, numbers = view.dataset, record(MAP, view)
    fractions = sorted(numbers["fractions"].items(), key=lambda one: -one[1])
    rows = [{"sequence": name, "fraction": fraction} for name, fraction in fractions if fraction]
    largest, most = rows[0]["sequence"], percent(rows[0]["fraction"])
    answer = f"{largest} everywhere"
    if rows[1:]:
        answer = f"{counted(len(rows), 'sequence')}: {largest} on {most} of the map"
    labels = {pathway.value: pathway.label for pathway in Pathway}
    columns = [
        Column("pathway", lambda row: labels.get(row["sequence"], "")),
        Quantity("sequence", head="sequence"),
        Column("fraction of the map", lambda row: percent(row["fraction"]), True),
    ][0 if "pathway" in data else 1 :]
    method = (
        "Monostable: {moved_cell} on {monostable} of the map. {closed_form_designs} designs in "
        "closed form, {engine_designs} by the engine; {degenerate_designs} are on a boundary."
    ).format(monostable=percent(numbers["monostable_fraction"]), **numbers)

    def error(curve: Row) -> str:
        within = f"{number(curve['error_of_axes'], 2)} of the axes"
        return "" if curve["method"] == "exact" else within

    curves = (*_BOUNDARY, Column("within", error))
    between = "The curves between the sequences."
    facts = [Fact(key.capitalize(), _axis_words(numbers[key])) for key in ("across", "up")]
    sections = {
        "Map": Picture("map", "Sequence at each point of the map"),
        "Sequences": RecordTable(columns, lambda: rows, more="sequences", level=CARD),
        "Boundaries": RecordTable(curves, "boundaries", between),
        "Method": Text(method),
    }
    return Account(view, numbers["title"] or "Map", "map/3", answer, facts, sections)


def _axis_words(axis: Row) -> str:
    unit = "" if axis["unit"] == "1" else f" {Quantity('', axis['unit']).sign}"
    ends = f"{number(axis['from'])} to {number(axis['to'])}{unit}"
    return f"{axis['parameter']} {ends}, {axis['count']} values"
