"""How far a study is and what it has found, as plain numbers with the unit in every name."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell.accounts import head
from stepwell.base import Column, Columns, Quantity, percent

if TYPE_CHECKING:
    from stepwell.studies import Decided, Status

STUDY_OUTCOME: Columns = (
    Quantity("column", head="column"),
    Quantity("value", head="value"),
    Column("designs", lambda row: str(row["designs"]), True),
    Column("share", lambda row: percent(row["share"]), True),
)
STUDY_DECIDED: Columns = (
    Column("column", lambda row: row["column"]),
    Column("decided by", lambda row: row["parameter"]),
    Column("share", lambda row: percent(row["share"]), True),
    Column("trend", lambda row: f"{row['trend']:+.2f}", True),
)
TEXT = "text"
# Of words so many of the most frequent values are told, and of what decides a column so many.
_VALUES, _FOREMOST = 20, 5


def study_record(found: Status) -> dict[str, Any]:
    """How far a study is and what it has found so far, as docs/commands.md describes it."""
    from stepwell.studies import SCREEN_COLUMNS, decided

    study = found.study
    not_found = study.varied.keys() | SCREEN_COLUMNS.keys()
    columns = {name: unit for name, unit in study.columns.items() if name not in not_found}
    problems = columns.pop("problem", None) and found.problems
    return {
        **head("study/1", study.text, study.designs.seed, "zarr"),
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
        "missing": [asdict(gap) for gap in found.gaps],
        "problems": problems,
        "screen": _screen(found),
        "outcomes": [
            row
            for name, unit in columns.items()
            # What an atlas counts is JSON, which `stepwell atlas show` tells.
            if unit == TEXT and study.what != "atlas"
            for row in _outcomes(found, name)
        ],
        "numbers": [_number(found, name) for name, unit in columns.items() if unit != TEXT],
        "decided": [_decided(one) for one in decided(study)],
    }


def deciding_rows(record: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Of a study's record the numbers that surely decide something, the foremost of each column."""
    return [
        {"column": one["column"] + (f" = {one['value']}" if one["value"] else ""), **each}
        for one in record["decided"]
        for each in one["influences"][:_FOREMOST]
        if each["share"] > one["floor"]
    ]


def missing_text(record: Mapping[str, Any]) -> str:
    """Of a study's record which designs are missing, in words; "" where all are there."""
    from stepwell.studies import Gap, gaps_text

    gaps = [Gap(**one) for one in record["missing"]]
    return gaps_text(gaps, record["count"]) if gaps else ""


def screen_facts(record: Mapping[str, Any]) -> dict[str, str]:
    """Of a study's record how its screen and what was computed agree, in words."""
    screen = record["screen"]
    if screen is None:
        return {}
    engine, kept, told = screen["engine"], screen["kept"], screen["designs"]
    facts = {"Screen": f"{engine} keeps {kept} of {told}; {screen['computed']} were computed"}
    for name, among in (
        ("alike", "drawn by lot"),
        ("held", "kept"),
        ("missed", "drawn by lot and not kept"),
    ):
        if share := screen[name]:
            ends = f"{percent(share['low'])} to {percent(share['high'])}"
            facts[name.capitalize()] = f"{share['times']} of {share['of']} {among} (95 %: {ends})"
    return facts


def _decided(one: Decided) -> dict[str, Any]:
    return {
        "column": one.column,
        "value": one.value or None,
        "designs": one.designs,
        "floor": one.floor,
        "influences": [
            {"parameter": each.name, "share": each.share, "trend": each.trend}
            for each in one.influences
        ],
    }


def _screen(found: Status) -> dict[str, Any] | None:
    """How a screen and what was computed agree."""
    from stepwell.studies import screened

    of = screened(found.study)
    if of is None:
        return None
    shares = {"alike": of.alike, "held": of.held, "missed": of.missed}
    return {
        "engine": found.study.given["engine"],
        "wanted": found.study.given["wanted"],
        "designs": of.designs,
        "kept": of.kept,
        "computed": of.computed,
        **{name: one and {**one._asdict(), "share": one.share} for name, one in shares.items()},
    }


def _span(found: Status, name: str) -> dict[str, Any]:
    """The unit of what differs, and between which values; of what is not bounded, so far."""
    told, factor = found.study.told(name)
    designs = found.study.designs
    axes = {axis.name: (axis.low, axis.high) for axis in getattr(designs, "axes", ())}
    if name not in axes:
        values = found.study.values(name)
        values = values[np.isfinite(values)]
        axes[name] = (values.min(), values.max()) if len(values) else (math.nan, math.nan)
    low, high = (float(end) * factor for end in axes[name])
    return {
        "unit": told or "1",
        "from": None if math.isnan(low) else low,
        "to": None if math.isnan(high) else high,
    }


def _outcomes(found: Status, name: str) -> list[dict[str, Any]]:
    words = np.array([str(one) for one in found.study.values(name)], object)
    if found.study.work.screen:
        # Those that a screen chose are no sample of the designs; those that were drawn by lot are.
        words = words[found.study.values("lot") == 1]
    counts = Counter(words.tolist())
    counts.pop("", None)
    told = sum(counts.values())
    return [
        {"column": name, "value": value, **_share(found, count, told)}
        for value, count in sorted(counts.items(), key=lambda one: (-one[1], one[0]))[:_VALUES]
    ]


def _share(found: Status, count: int, told: int) -> dict[str, Any]:
    """How many do it, and their share; with an interval where designs are a sample."""
    from stepwell.design import share_of
    from stepwell.studies import How

    of = share_of(count, told)
    sampled = found.study.designs.how not in (How.GRID, "listed")
    ends = {"share_low": of.low, "share_high": of.high}
    return {"designs": count, "share": of.share, **(ends if sampled else dict.fromkeys(ends))}


def _number(found: Status, name: str) -> dict[str, Any]:
    told, factor = found.study.told(name)
    values = found.study.values(name) * factor
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
