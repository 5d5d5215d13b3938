"""A map over two parameters as plain numbers, each with its unit."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell.base import csv_text, told_in
from stepwell.results.head import head
from stepwell.results.run import finite

if TYPE_CHECKING:
    import xarray

    from stepwell.design import ParameterBoundary

PARAMETER_MAP_SCHEMA = "stepwell.parameter-map/1"


def parameter_map_record(
    dataset: xarray.Dataset,
    boundaries: Iterable[ParameterBoundary],
    design: tuple[float, float] | None = None,
    *,
    text: str | None = None,
) -> dict[str, Any]:
    """What a map over two parameters says in short: how much of it each sequence takes.

    Args:
        dataset: what `design.parameter_map` returns.
        boundaries: what `design.parameter_boundaries` returns for the same parameters.
        design: the two parameters of the design itself, in SI.
        text: of the design file, for the hash of it; unknown by default.

    Returns:
        The record that docs/commands.md describes.
    """
    codes = dataset["sequence"].to_numpy()
    notes = dataset["sequence"].attrs
    meanings = str(notes["flag_meanings"]).split()
    values = [int(value) for value in notes["flag_values"]]
    return {
        **head(PARAMETER_MAP_SCHEMA, text),
        "title": str(dataset.attrs["title"]),
        **{
            name: _axis(dataset[letter], None if design is None else design[k])
            for k, (name, letter) in enumerate((("across", "x"), ("up", "y")))
        },
        "shares": {
            meaning: float(np.mean(codes == value))
            for value, meaning in zip(values, meanings, strict=True)
        },
        "degenerate_designs": int(np.sum(dataset["degenerate"].to_numpy())),
        "closed_form_designs": int(dataset.attrs["closed_form_designs"]),
        "engine_designs": int(dataset.attrs["engine_designs"]),
        "boundaries": [
            {
                "changes": boundary.changes,
                "kind": boundary.kind.name.lower(),
                "between": list(boundary.sequences),
                "method": boundary.method,
                "error_of_axes": finite(boundary.error),
                "points": len(boundary.points),
            }
            for boundary in boundaries
        ],
    }


def parameter_boundary_rows(boundaries: Iterable[ParameterBoundary]) -> str:
    """The curves of a map as CSV: curve, kind and the two parameters, a row for every point."""
    head, rows = ["curve", "kind"], list[tuple[str, ...]]()
    for number, boundary in enumerate(boundaries):
        told = [told_in(unit) for unit in boundary.units]
        names = [
            f"{name}_{unit.replace('/', '_per_')}"
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


def _axis(axis: xarray.DataArray, design: float | None) -> dict[str, Any]:
    unit, factor = told_in(str(axis.attrs["units"]))
    return {
        "parameter": str(axis.attrs["long_name"]),
        "unit": unit,
        "from": finite(float(axis[0]), factor),
        "to": finite(float(axis[-1]), factor),
        "count": len(axis),
        "design": None if design is None else finite(design, factor),
    }
