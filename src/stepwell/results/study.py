"""How far a study is and what it has found, as plain numbers with the unit in every name."""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell.base import Quantity, Schema
from stepwell.results.head import head

if TYPE_CHECKING:
    from stepwell.studies import Status

STUDY_OUTCOME: Schema = (
    Quantity("column", head="column"),
    Quantity("value", head="value"),
    Quantity("designs", head="designs"),
)
TEXT = "text"
# Of words so many of the most frequent values are told.
_VALUES = 20


def study_record(found: Status) -> dict[str, Any]:
    """How far a study is and what it has found so far, as docs/commands.md describes it."""
    study = found.study
    columns = {name: unit for name, unit in study.columns.items() if name not in study.varied}
    problems = columns.pop("problem", None) and found.problems
    return {
        **head("stepwell.study/1", study.text, study.designs.seed, "zarr"),
        "title": study.subject.title,
        "store": str(study.folder),
        "what": study.what,
        "identity": study.identity,
        "how": str(study.designs.how),
        "count": study.count,
        "varied": [{"parameter": name, **_span(found, name)} for name in study.varied],
        "chunk": study.chunk,
        "chunks": study.chunks,
        "done": found.done,
        "finished": found.finished,
        "problems": problems,
        "outcomes": [
            row for name, unit in columns.items() if unit == TEXT for row in _outcomes(found, name)
        ],
        "numbers": [_number(found, name) for name, unit in columns.items() if unit != TEXT],
    }


def _span(found: Status, name: str) -> dict[str, Any]:
    """The unit of what differs, and between which values; of what is not bounded, so far."""
    told, factor = found.study.told(name)
    designs = found.study.designs
    axes = {axis.name: (axis.low, axis.high) for axis in getattr(designs, "axes", ())}
    if name not in axes:
        values = found.study.column(name)[:]
        values = values[np.isfinite(values)]
        axes[name] = (values.min(), values.max()) if len(values) else (math.nan, math.nan)
    low, high = (float(end) * factor for end in axes[name])
    return {
        "unit": told or "1",
        "from": None if math.isnan(low) else low,
        "to": None if math.isnan(high) else high,
    }


def _outcomes(found: Status, name: str) -> list[dict[str, Any]]:
    counts = Counter(map(str, found.study.column(name)[:]))
    counts.pop("", None)
    return [
        {"column": name, "value": value, "designs": count}
        for value, count in sorted(counts.items(), key=lambda one: (-one[1], one[0]))[:_VALUES]
    ]


def _number(found: Status, name: str) -> dict[str, Any]:
    told, factor = found.study.told(name)
    values = found.study.column(name)[:] * factor
    values = values[np.isfinite(values)]
    of = (np.min, np.median, np.max)
    least, median, most = (float(one(values)) if len(values) else None for one in of)
    return {
        "column": name,
        "unit": told or "1",
        "least": least,
        "median": median,
        "most": most,
        "designs": len(values),
    }
