"""Studies as people read them: what was found, and how far it is."""

from __future__ import annotations

from typing import Any

from stepwell.base import Column, number
from stepwell.cli.screen import show_facts, show_records, show_text
from stepwell.results import STUDY_DECIDED, STUDY_OUTCOME, deciding_rows, missing_text, screen_facts

_ENDS = ("least", "median", "most")


def study(record: dict[str, Any]) -> None:
    """Print what `results.study_record` returns."""
    varied = ", ".join(_between(one) for one in record["varied"])
    facts = {
        "Study": f"{record['what']} of {record['count']} designs, {record['how']}",
        "Varied": varied,
        "Done": "all of it"
        if record["finished"]
        else f"{record['done']} of {record['chunks']} chunks",
        "Missing": missing_text(record),
        "Store": record["store"],
    }
    show_facts(record, facts | screen_facts(record), 8)
    if record["outcomes"]:
        show_records("What they do, most frequent first", STUDY_OUTCOME, record["outcomes"])
    columns = [
        Column("column", lambda one: one["column"]),
        Column("unit", lambda one: "" if one["unit"] == "1" else one["unit"]),
        *(Column(name, lambda one, name=name: _told(one[name]), True) for name in _ENDS),
    ]
    show_records("Their numbers", columns, record["numbers"])
    if rows := deciding_rows(record):
        show_records("Share of the variance that a number decides by itself", STUDY_DECIDED, rows)
    if record["problems"]:
        rows = [{"kind": kind, "designs": count} for kind, count in record["problems"].items()]
        kind = Column("kind", lambda one: one["kind"])
        show_records(
            "Could not be computed",
            [kind, Column("designs", lambda one: str(one["designs"]), True)],
            rows,
        )
    if not record["finished"]:
        show_text(f"Go on with: stepwell sweep resume {record['store']}")


def _between(one: dict[str, Any]) -> str:
    unit = "" if one["unit"] == "1" else f" {one['unit']}"
    return f"{one['parameter']} {number(one['from'])} to {number(one['to'])}{unit}"


def _told(value: float | None) -> str:
    return "" if value is None else number(value)
