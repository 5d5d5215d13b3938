"""The page of a study: what was found of many designs, and which number decides it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from stepwell.base import Column, counted, number, percent
from stepwell.reports.pages import parts
from stepwell.results import STUDY_DECIDED, STUDY_OUTCOME, deciding_rows, missing_text, screen_facts

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_ENDS = ("least", "median", "most")
_VARIED = (
    Column("varied", lambda row: row["parameter"]),
    Column("from", lambda row: _told(row["from"]), True),
    Column("to", lambda row: _told(row["to"]), True),
    Column("unit", lambda row: _unit(row)),
)


def study_page(
    record: Mapping[str, Any], drawn: Mapping[str, Figure], narrow: Mapping[str, Figure]
) -> str:
    """The page of a study.

    Args:
        record: what `results.study_record` returns.
        drawn, narrow: figures by caption, on a wide window and on a phone.

    Returns:
        HTML text.
    """
    failed = sum((record["problems"] or {}).values())
    numbers = [
        Column("column", lambda row: row["column"]),
        Column("unit", lambda row: _unit(row)),
        *(Column(name, lambda row, name=name: _told(row[name]), True) for name in _ENDS),
        Column("designs", lambda row: str(row["designs"]), True),
    ]
    kinds = [{"kind": kind, "designs": n} for kind, n in (record["problems"] or {}).items()]
    return parts.page(
        record["title"] or "A study",
        f"{record['what'].capitalize()} of {counted(record['count'], 'design')}, {record['how']}.",
        _answer(record),
        [
            ""
            if record["finished"]
            else f"{record['done']} of {record['chunks']} chunks are done: {missing_text(record)}.",
            f"{counted(failed, 'design')} could not be computed." if failed else "",
        ],
        screen_facts(record),
        [
            parts.part("What they do", parts.pictures(drawn, narrow)),
            parts.part(
                "Which number decides what",
                parts.table(
                    STUDY_DECIDED,
                    deciding_rows(record),
                    "Share of the variance that a number decides by itself, and its rank "
                    "correlation; what chance alone could make is left out.",
                ),
            ),
            parts.part(
                "All of it in numbers",
                parts.table(STUDY_OUTCOME, record["outcomes"], "Most frequent first."),
                parts.table(numbers, record["numbers"], "Numbers that were found."),
                parts.table(
                    [
                        Column("kind", lambda row: row["kind"]),
                        Column("designs", lambda row: str(row["designs"]), True),
                    ],
                    kinds,
                    "Designs that could not be computed, by the kind of their problem.",
                ),
                parts.table(_VARIED, record["varied"], "What was varied."),
            ),
            parts.part("What the numbers assume", parts.listed(_assumed(record))),
        ],
    )


def _answer(record: Mapping[str, Any]) -> str:
    """What most of them do, or else what decides most."""
    if record["outcomes"]:
        first = record["outcomes"][0]
        ends = first["share_low"], first["share_high"]
        surely = "" if None in ends else f" (surely {percent(ends[0])} to {percent(ends[1])})"
        return f"{percent(first['share'])}{surely} do {first['value']}"
    if rows := deciding_rows(record):
        return f"{rows[0]['parameter']} decides {percent(rows[0]['share'])} of {rows[0]['column']}"
    return f"{counted(record['count'], 'design')}"


def _assumed(record: Mapping[str, Any]) -> list[str]:
    found = ["Every number varies by itself, evenly between its bounds."]
    if record["how"] == "listed":
        found = ["Designs were listed: of numbers that go together each has the share of both."]
    elif record["how"] == "as built":
        found = ["Designs vary as mechanisms are built within their tolerances."]
    if record["decided"]:
        found.append(
            "What numbers only do together is the share of none; shares below the floor, which "
            "chance alone exceeds in one study of twenty, are not told."
        )
    if any(one["share_low"] is not None for one in record["outcomes"]):
        found.append(
            "Intervals are those of designs drawn independently, 95 % (Clopper and Pearson); a "
            "Sobol' sequence and a Latin hypercube are mostly surer."
        )
    if record["screen"]:
        found.append(
            "A screen in single precision chose the designs that were computed, and some were "
            "drawn by lot: shares are those of designs drawn, all other numbers those of all that "
            "were computed."
        )
    return found


def _told(value: float | None) -> str:
    return "" if value is None else number(value)


def _unit(row: Mapping[str, Any]) -> str:
    return "" if row["unit"] == "1" else row["unit"]
