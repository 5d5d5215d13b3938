"""A map over two parameters: the sequences, how much of the map each takes, the boundaries."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from stepwell.accounts.head import About, Row, keys
from stepwell.accounts.parts import CARD, Account, Fact, Picture, RecordTable, Text
from stepwell.base import Column, Quantity, Schema, counted, display_unit, number, percent, record
from stepwell.sequences import Pathway

if TYPE_CHECKING:
    import xarray

    from stepwell.design import MapView

_BOUNDARY: Schema = (
    Quantity("changes", head="what changes"),
    *keys(kind=(str, lambda one: one.kind.name.lower()), between=([str], "sequences")),
    Quantity("method", head="method"),
    Quantity("error_of_axes", read="error", holds=float),
    Quantity("points", head="points", read=lambda one: len(one.points), holds=int, left=False),
)
_AXES = ("Across", "x"), ("Up", "y")


class _Axis(NamedTuple):
    """An axis of a map, and the design's own place on it, in SI."""

    values: xarray.DataArray
    design: float | None


def _in_unit(at: Callable[[_Axis], Any]) -> Any:
    """A place on an axis in the unit of the axis."""

    def read(axis: _Axis) -> float | None:
        value = at(axis)
        return None if value is None else float(value) * display_unit(axis.values.attrs["units"])[1]

    return read


_AXIS: Schema = (
    Quantity("parameter", read=lambda axis: str(axis.values.attrs["long_name"])),
    Quantity("unit", read=lambda axis: display_unit(str(axis.values.attrs["units"]))[0]),
    Quantity("from", read=_in_unit(lambda axis: axis.values[0]), holds=float),
    Quantity("to", read=_in_unit(lambda axis: axis.values[-1]), holds=float),
    Quantity("count", read=lambda axis: len(axis.values), holds=int),
    Quantity("design", read=_in_unit(lambda axis: axis.design), holds=float),
)


def _axis(view: MapView, name: str) -> _Axis:
    design = next(iter(view.designs.values()), None)
    return _Axis(view.dataset[name], None if design is None else design["xy".index(name)])


def _attribute(name: str, of: type = int) -> Any:
    return of, lambda view: of(view.dataset.attrs[name])


def _monostable(view: MapView) -> float:
    return float(np.mean(view.dataset["monostable"].to_numpy()))


def _degenerate(view: MapView) -> int:
    return int(np.sum(view.dataset["degenerate"].to_numpy()))


def _pathways(view: MapView) -> dict[str, float] | None:
    return shares(view.dataset["pathway"]) if "pathway" in view.dataset else None


def shares(field: xarray.DataArray) -> dict[str, float]:
    """The fraction of a map that each value of a field takes [1]."""
    codes, notes = field.to_numpy(), field.attrs
    flags = zip(np.atleast_1d(notes["flag_values"]), notes["flag_meanings"].split(), strict=True)
    return {meaning: float(np.mean(codes == value)) for value, meaning in flags}


# What is reported of a map.
MAP: Schema = (
    *keys(title=_attribute("title", str), across=(_AXIS, lambda view: _axis(view, "x"))),
    *keys(up=(_AXIS, lambda view: _axis(view, "y"))),
    Quantity("shares", read=lambda view: shares(view.dataset["sequence"]), holds={str: float}),
    Quantity("pathway_shares", read=_pathways, holds={str: float}, missing=True),
    *keys(moved_cell=_attribute("moved_cell", str), monostable_fraction=(float, _monostable)),
    *keys(degenerate_designs=(int, _degenerate)),
    *keys(closed_form_designs=_attribute("closed_form_designs")),
    *keys(engine_designs=_attribute("engine_designs"), boundaries=[_BOUNDARY]),
)


def map_view_account(view: MapView, about: About) -> Account:
    """What is reported of a map."""
    data = view.dataset
    rows = [
        {"sequence": name, "share": share}
        for name, share in sorted(shares(data["sequence"]).items(), key=lambda one: -one[1])
        if share
    ]
    largest = rows[0]["sequence"]
    answer = f"{largest} everywhere"
    if rows[1:]:
        most = percent(rows[0]["share"])
        answer = f"{counted(len(rows), 'sequence')}: {largest} on {most} of the map"
    labels = {pathway.value: pathway.label for pathway in Pathway}
    columns = [
        Column("pathway", lambda row: labels.get(row["sequence"], "")),
        Quantity("sequence", head="sequence"),
        Column("share of the map", lambda row: percent(row["share"]), True),
    ][0 if "pathway" in data else 1 :]
    share = RecordTable(columns, lambda: rows, most=None, more="sequences", level=CARD)
    notes = data.attrs
    method = (
        f"Monostable: {notes['moved_cell']} on {percent(_monostable(view))} of the map. "
        f"{notes['closed_form_designs']} designs in closed form, {notes['engine_designs']} by the "
        f"engine; {_degenerate(view)} are on a boundary."
    )

    def error(curve: Row) -> str:
        within = f"{number(curve['error_of_axes'], 2)} of the axes"
        return "" if curve["method"] == "exact" else within

    between = "The curves between the sequences."
    curves = (*_BOUNDARY, Column("within", error))
    title = str(data.attrs["title"]) or "Map"
    facts = [Fact(label, _axis_words(_axis(view, name))) for label, name in _AXES]
    sections = {
        "Map": Picture("map", "Sequence at each point of the map"),
        "Sequences": share,
        "Boundaries": RecordTable(curves, "boundaries", between, most=None),
        "Method": Text(method),
    }
    return Account(view, title, "map/3", answer, facts, sections)


def _axis_words(axis: _Axis) -> str:
    found = record(_AXIS, axis)
    unit = "" if found["unit"] == "1" else f" {Quantity('', found['unit']).sign}"
    return (
        f"{found['parameter']} {number(found['from'])} to {number(found['to'])}{unit}, "
        f"{found['count']} values"
    )
