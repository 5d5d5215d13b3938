"""How far a study is and what it has found, as plain numbers with the unit in every name."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell.base import Quantity, Schema, told_in
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
    columns = {name: unit for name, unit in study.columns.items() if name not in study.space.names}
    problems = columns.pop("problem", None) and found.problems
    return {
        **head("stepwell.study/1", study.text, study.space.seed, "zarr"),
        "title": study.chain.title,
        "store": str(study.folder),
        "what": study.what,
        "identity": study.identity,
        "how": str(study.space.how),
        "count": study.count,
        "varied": [
            {"parameter": a.name, "unit": u, "from": a.low / f, "to": a.high / f}
            for a in study.space.axes
            for u, f in [_told(study.columns[a.name])]
        ],
        "chunk": study.chunk,
        "chunks": study.chunks,
        "done": found.done,
        "finished": found.finished,
        "problems": problems,
        "outcomes": [
            row for name, unit in columns.items() if unit == TEXT for row in _outcomes(found, name)
        ],
        "numbers": [_number(found, name, unit) for name, unit in columns.items() if unit != TEXT],
    }


def _told(unit: str) -> tuple[str, float]:
    """The unit in which a column is told, and how many SI units one of it is."""
    told, factor = told_in(unit)
    return told, 1.0 / factor


def _outcomes(found: Status, name: str) -> list[dict[str, Any]]:
    counts = Counter(map(str, found.study.column(name)[:]))
    counts.pop("", None)
    return [
        {"column": name, "value": value, "designs": count}
        for value, count in sorted(counts.items(), key=lambda one: (-one[1], one[0]))[:_VALUES]
    ]


def _number(found: Status, name: str, unit: str) -> dict[str, Any]:
    told, factor = _told(unit)
    values = found.study.column(name)[:] / factor
    values = values[np.isfinite(values)]
    of = (np.min, np.median, np.max)
    least, median, most = (float(one(values)) if len(values) else None for one in of)
    return {
        "column": name,
        "unit": told,
        "least": least,
        "median": median,
        "most": most,
        "designs": len(values),
    }
