"""The page of an atlas: its machines, how often they come and how surely they are built."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from stepwell.base import Column, counted, number
from stepwell.reports.pages import parts
from stepwell.results import ATLAS_MACHINES, atlas_assumed, atlas_facts

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_CYCLES = (
    Column("cycle", lambda row: row["sequence"].replace(">", " → ")),
    Column("share [%]", lambda row: number(row["share_percent"]), True),
)
_SPACE = (
    Column("varied", lambda row: row["parameter"]),
    Column("from", lambda row: number(row["from"]), True),
    Column("to", lambda row: number(row["to"]), True),
    Column("unit", lambda row: "" if row["unit"] == "1" else row["unit"]),
)


def atlas_page(
    record: Mapping[str, Any], drawn: Mapping[str, Figure], narrow: Mapping[str, Figure]
) -> str:
    """The page of an atlas.

    Args:
        record: what `results.atlas_record` returns.
        drawn, narrow: figures by caption, on a wide window and on a phone.

    Returns:
        HTML text.
    """
    facts = atlas_facts(record)
    graphs, cycles = counted(record["graphs"], "graph"), counted(len(record["cycles"]), "cycle")
    return parts.page(
        record["title"] or f"An atlas of {record['cells']} cells",
        f"{facts['Space']}.",
        f"{graphs} and {cycles}",
        [
            f"{record['designs']} designs were drawn evenly, and {record['told']} of them told in "
            f"closed form.",
            parts.sentence(facts["Proved"]),
        ],
        {},
        [
            parts.part("What they do", parts.pictures(drawn, narrow)),
            parts.part(
                "All machines",
                parts.table(ATLAS_MACHINES, record["machines"], atlas_assumed(record)),
                parts.table(_CYCLES, record["cycles"], "Full cycles, inner cell first."),
                parts.table(_SPACE, record["space"], "What was varied, evenly."),
            ),
            parts.part(
                "How sure it is",
                parts.listed(
                    f"{name}: {facts[name]}."
                    for name in ("Unseen", "Engine", "Others")
                    if name in facts
                ),
            ),
        ],
    )
