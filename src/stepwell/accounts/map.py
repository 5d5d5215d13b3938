"""A map over two parameters: the sequences, how much of the map each takes, the boundaries."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from stepwell.accounts.head import About
from stepwell.accounts.parts import Account, Fact, Level, Picture, RecordTable, Section, Text
from stepwell.base import Column, Quantity, Schema, counted, number, percent, record, told_in
from stepwell.sequences import Pathway

if TYPE_CHECKING:
    import xarray

    from stepwell.design import MapView


class _Axis(NamedTuple):
    """An axis of a map, and the design's own place on it, in SI."""

    values: xarray.DataArray
    design: float | None


def _in_unit(axis: _Axis, value: float | None) -> float | None:
    return None if value is None else value * told_in(str(axis.values.attrs["units"]))[1]


_AXIS: Schema = (
    Quantity("parameter", read=lambda axis: str(axis.values.attrs["long_name"])),
    Quantity("unit", read=lambda axis: told_in(str(axis.values.attrs["units"]))[0]),
    Quantity("from", read=lambda axis: _in_unit(axis, float(axis.values[0])), holds=float),
    Quantity("to", read=lambda axis: _in_unit(axis, float(axis.values[-1])), holds=float),
    Quantity("count", read=lambda axis: len(axis.values), holds=int),
    Quantity("design", read=lambda axis: _in_unit(axis, axis.design), holds=float),
)
_BOUNDARY: Schema = (
    Quantity("changes", head="what changes"),
    Quantity("kind", read=lambda one: one.kind.name.lower()),
    Quantity("between", read="sequences", holds=[str]),
    Quantity("method", head="method"),
    Quantity("error_of_axes", read="error", holds=float),
    Quantity("points", head="points", read=lambda one: len(one.points), holds=int, left=False),
)


def _axis(view: MapView, name: str) -> _Axis:
    design = next(iter(view.designs.values()), None)
    return _Axis(view.dataset[name], None if design is None else design["xy".index(name)])


def _attribute(name: str) -> Any:
    return lambda view: int(view.dataset.attrs[name])


def _mean(field: xarray.DataArray) -> float:
    return float(np.mean(field.to_numpy()))


def _pathways(view: MapView) -> dict[str, float] | None:
    return shares(view.dataset["pathway"]) if "pathway" in view.dataset else None


def shares(field: xarray.DataArray) -> dict[str, float]:
    """The fraction of a map that each value of a field takes [1]."""
    codes, notes = field.to_numpy(), field.attrs
    flags = zip(np.atleast_1d(notes["flag_values"]), notes["flag_meanings"].split(), strict=True)
    return {meaning: float(np.mean(codes == value)) for value, meaning in flags}


# What is reported of a map.
MAP: Schema = (
    Quantity("title", read=lambda view: str(view.dataset.attrs["title"])),
    Quantity("across", read=lambda view: _axis(view, "x"), holds=_AXIS),
    Quantity("up", read=lambda view: _axis(view, "y"), holds=_AXIS),
    Quantity("shares", read=lambda view: shares(view.dataset["sequence"]), holds={str: float}),
    Quantity("pathway_shares", read=_pathways, holds={str: float}, missing=True),
    Quantity("moved_cell", read=lambda view: str(view.dataset.attrs["moved_cell"])),
    Quantity(
        "monostable_fraction", read=lambda view: _mean(view.dataset["monostable"]), holds=float
    ),
    Quantity(
        "degenerate_designs",
        read=lambda view: int(np.sum(view.dataset["degenerate"].to_numpy())),
        holds=int,
    ),
    Quantity("closed_form_designs", read=_attribute("closed_form_designs"), holds=int),
    Quantity("engine_designs", read=_attribute("engine_designs"), holds=int),
    Quantity("boundaries", holds=[_BOUNDARY]),
)


def map_account(view: MapView, about: About) -> Account:
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
        *(
            [Column("pathway", lambda row: labels.get(row["sequence"], ""))]
            if "pathway" in data
            else []
        ),
        Quantity("sequence", head="sequence"),
        Column("share of the map", lambda row: percent(row["share"]), True),
    ]
    by_share = RecordTable(columns, lambda: rows, most=None, more="sequences", level=Level.CARD)
    return Account(
        view,
        str(data.attrs["title"]) or "Map",
        "map/3",
        MAP,
        answer=answer,
        facts=[
            Fact("Across", _axis_words(_axis(view, "x"))),
            Fact("Up", _axis_words(_axis(view, "y"))),
        ],
        sections=(
            Section("Map", Picture("map", "Sequence at each point of the map")),
            Section("Sequences", by_share),
            Section(
                "Boundaries",
                RecordTable(
                    (*_BOUNDARY, Column("within", _error)),
                    "boundaries",
                    "The curves between the sequences.",
                    most=None,
                    more="curves",
                ),
            ),
            Section("Method", Text(_method(view))),
        ),
    )


def _axis_words(axis: _Axis) -> str:
    found = record(_AXIS, axis)
    unit = "" if found["unit"] == "1" else f" {Quantity('', found['unit']).sign}"
    return (
        f"{found['parameter']} {number(found['from'])} to {number(found['to'])}{unit}, "
        f"{found['count']} values"
    )


def _error(boundary: Any) -> str:
    exact = boundary["method"] == "exact"
    return "" if exact else f"{number(boundary['error_of_axes'], 2)} of the axes"


def _method(view: MapView) -> str:
    notes, alone = view.dataset.attrs, _mean(view.dataset["monostable"])
    return (
        f"Monostable: {notes['moved_cell']} on {percent(alone)} of the map. "
        f"{notes['closed_form_designs']} designs in closed form, {notes['engine_designs']} by the "
        f"engine; {int(np.sum(view.dataset['degenerate'].to_numpy()))} are on a boundary."
    )
