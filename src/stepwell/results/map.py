"""A map over two parameters as plain numbers, each with its unit."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell.accounts import head
from stepwell.base import Quantity, csv_text, plain, told_in

if TYPE_CHECKING:
    import xarray

    from stepwell.design import Boundary


def map_record(
    dataset: xarray.Dataset,
    boundaries: Iterable[Boundary],
    design: tuple[float, float] | None = None,
    *,
    text: str | None = None,
) -> dict[str, Any]:
    """What a map says in short: how much of it each sequence takes.

    Args:
        dataset: what `design.transition_map` or `design.parameter_map` returns.
        boundaries: what `design.boundaries` or `design.parameter_boundaries` returns for the same.
        design: the two parameters of the design itself, in SI, if it has one place on the map.
        text: of the design file, for the hash of it; unknown by default.
    """
    axes = zip(("across", "up"), "xy", design or (None, None), strict=True)
    pathways = {"pathway_shares": _shares(dataset["pathway"])} if "pathway" in dataset else {}
    return {
        **head("map/2", text),
        "title": str(dataset.attrs["title"]),
        **{name: _axis(dataset[letter], here) for name, letter, here in axes},
        "shares": map_shares(dataset),
        **pathways,
        "moved_cell": str(dataset.attrs["moved_cell"]),
        "monostable_fraction": float(np.mean(dataset["monostable"].to_numpy())),
        "degenerate_designs": int(np.sum(dataset["degenerate"].to_numpy())),
        "closed_form_designs": int(dataset.attrs["closed_form_designs"]),
        "engine_designs": int(dataset.attrs["engine_designs"]),
        "boundaries": [
            {
                "changes": boundary.changes,
                "kind": boundary.kind.name.lower(),
                "between": list(boundary.sequences),
                "method": boundary.method,
                "error_of_axes": plain(boundary.error),
                "points": len(boundary.points),
            }
            for boundary in boundaries
        ],
    }


def boundary_rows(boundaries: Iterable[Boundary]) -> str:
    """The curves of a map as CSV: curve, kind and the two parameters, a row for every point."""
    head, rows = ["curve", "kind"], list[tuple[str, ...]]()
    for number, boundary in enumerate(boundaries):
        told = [told_in(unit) for unit in boundary.units]
        names = [
            Quantity(name, "" if unit == "1" else unit).key
            for name, (unit, _) in zip(boundary.parameters, told, strict=True)
        ]
        head = ["curve", "kind", *names]
        kind = boundary.kind.name.lower()
        (_, across), (_, up) = told
        rows += [
            (str(number), kind, f"{x * across:.9g}", f"{y * up:.9g}")
            for x, y in boundary.points.tolist()
        ]
    return csv_text(head, rows)


def map_shares(dataset: xarray.Dataset) -> dict[str, float]:
    """How much of a map each sequence takes [1]."""
    return _shares(dataset["sequence"])


def _shares(field: xarray.DataArray) -> dict[str, float]:
    codes, notes = field.to_numpy(), field.attrs
    flags = zip(np.atleast_1d(notes["flag_values"]), notes["flag_meanings"].split(), strict=True)
    return {meaning: float(np.mean(codes == value)) for value, meaning in flags}


def _axis(axis: xarray.DataArray, design: float | None) -> dict[str, Any]:
    unit, factor = told_in(str(axis.attrs["units"]))
    return {
        "parameter": str(axis.attrs["long_name"]),
        "unit": unit,
        "from": plain(float(axis[0]), factor),
        "to": plain(float(axis[-1]), factor),
        "count": len(axis),
        "design": None if design is None else plain(design, factor),
    }
