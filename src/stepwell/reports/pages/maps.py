"""The page of a map: what a chain does for every value of two of its parameters."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from stepwell.base import Column, Quantity, counted, number, percent
from stepwell.reports.pages import parts

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def map_page(record: Mapping[str, Any], drawn: Figure, narrow: Figure) -> str:
    """The page of a map.

    Args:
        record: what `results.map_record` returns.
        drawn, narrow: it as a figure, for a wide window and for a phone.

    Returns:
        HTML text.
    """
    shares = sorted(record["shares"].items(), key=lambda one: -one[1])
    rows = [
        {"sequence": name.replace(">", " → "), "share": share} for name, share in shares if share
    ]
    largest = rows[0]
    axes = [_axis(record[name]) for name in ("across", "up")]
    return parts.page(
        record["title"],
        f"Across: {axes[0]}. Up: {axes[1]}.",
        counted(len(rows), "sequence") if rows[1:] else f"{largest['sequence']} everywhere",
        [
            f"The most frequent, {largest['sequence']}, takes {percent(largest['share'])} of "
            f"the map."
            if rows[1:]
            else "",
        ],
        {"Places looked at": str(record["across"]["count"] * record["up"]["count"])},
        [
            parts.part(
                "The map",
                parts.figures(parts.figure("Which sequence where", drawn, narrow)),
            ),
            parts.part(
                "Sequences",
                parts.table(
                    [
                        Column("sequence", lambda row: row["sequence"]),
                        Column("share of the map", lambda row: percent(row["share"]), True),
                    ],
                    rows,
                    "Most frequent first.",
                ),
            ),
            parts.part(
                "Boundaries",
                parts.table(
                    [
                        Quantity("changes", head="what changes"),
                        Quantity("method", head="how it was found"),
                        Quantity("points", head="points", left=False),
                    ],
                    record["boundaries"],
                    "The curves between the sequences.",
                ),
            ),
            parts.part(
                "What the numbers assume",
                parts.paragraph(
                    f"{record['closed_form_designs']} designs were judged in closed form, "
                    f"{record['engine_designs']} followed by the engine; "
                    f"{record['degenerate_designs']} sit on a boundary. "
                    f"{record['moved_cell']} is stable in one state only on "
                    f"{percent(record['monostable_fraction'])} of the map."
                ),
            ),
        ],
    )


def _axis(axis: Mapping[str, Any]) -> str:
    unit = "" if axis["unit"] == "1" else f" {Quantity('', axis['unit']).sign}"
    return f"{axis['parameter']} from {number(axis['from'])} to {number(axis['to'])}{unit}"
