"""A first build as people read of it."""

from __future__ import annotations

from typing import Any

from stepwell.base import number, percent
from stepwell.cli.screen import show_facts, show_records
from stepwell.lab import KNOWN, MOVE, holes_told


def as_built(record: dict[str, Any]) -> None:
    """Print what `lab.as_built_record` returns."""
    wider = record["wider"]
    further = f", {number(wider)} times as far off as first thought" if wider > 1 else ""
    facts = {
        "Do now": record["advice"],
        "Wanted": record["wanted"],
        "Seen": _seen(record["seen"]),
        "Built": f"with anchors ±{number(record['anchor_mm'])} mm and stiffness "
        f"±{number(record['stiffness_percent'])} %{further}; {percent(record['agreeing'])} of such "
        f"builds move so",
        "Holes": holes_told(record),
    }
    show_facts(record, facts, 2 + max(map(len, facts)))
    if record["moves"]:
        head = f"Moves, and how many then do it; now {percent(record['share'])}"
        show_records(head, MOVE, record["moves"])
    show_records("As built, as far as this was told; p is taken as drawn", KNOWN, record["known"])


def _seen(seen: dict[str, Any]) -> str:
    told = [seen["sequence"] or ""]
    for key, way in (("snaps_out_mm", "out"), ("snaps_back_mm", "back")):
        if seen[key] is not None:
            strokes = ", ".join(f"{number(u)} mm" for u in seen[key])
            told.append(f"snaps {way} at {strokes}" if strokes else f"no snap {way}")
    count = len(seen["pulls"])
    told.append(f"{count} forces" if count else "")
    return "; ".join(filter(None, told))
