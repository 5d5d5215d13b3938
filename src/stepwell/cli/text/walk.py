"""The result of `stepwell walk` as people read it."""

from __future__ import annotations

from itertools import groupby
from typing import Any

from stepwell.base import Quantity, number
from stepwell.cli.screen import show_facts, show_lines, show_records
from stepwell.cli.text.sources import show_sources
from stepwell.results import CYCLES, PREDICTED


def show(record: dict[str, Any]) -> None:
    """Print what `results.walk_record` returns."""
    per_cycle = record["work_mJ"] / record["cycles"] if record["cycles"] else None
    found = {
        "Walked": f"{number(record['distance_mm'])} mm in {record['cycles']} cycles of "
        f"{number(record['period_s'])} s",
        "A cycle": mean_text(record),
        "Work": per_cycle is not None and f"{number(per_cycle)} mJ a cycle",
        "Transport": record["cost_of_transport"] is not None
        and f"{number(record['cost_of_transport'], 3)} of work over weight and distance",
        "Stopped": record["stopped"].removeprefix("Stopped "),
    }
    show_facts(record, found, 12)
    _gaits(record["legs"])
    _feet(record)
    rows = zip(*(record[q.key] for q in CYCLES), strict=True)
    show_records(
        "Cycle by cycle",
        [Quantity("cycle", head="cycle"), *CYCLES],
        [
            {"cycle": k} | {q.key: told for q, told in zip(CYCLES, row, strict=True)}
            for k, row in enumerate(rows, 1)
        ],
    )
    show_sources(record["parameters"])


def mean_text(record: dict[str, Any]) -> str:
    """How far and round a robot goes in a cycle."""
    if record["mean_advance_over_u_max"] is None:
        return ""
    after = " after the first" if record["cycles"] > 1 else ""
    return (
        f"d/u_max {record['mean_advance_over_u_max'] + 0.0:.3f} and "
        f"{record['mean_turn_deg']:z.2f}° to the left{after}"
    )


def _gaits(legs: list[dict[str, Any]]) -> None:
    rows = [
        {"leg": "" if i else leg["name"], "cycles": when, "states": gait}
        | {"slip": "" if i else number(leg["slip_mm"], 3)}
        for leg in legs
        for i, (when, gait) in enumerate(runs(leg["gaits"]))
    ]
    words = (Quantity(name, head=name) for name in ("leg", "cycles", "states"))
    slip = Quantity("slip", head="slip [mm a cycle]", left=False)
    show_records("Gaits", [*words, slip], rows)


def _feet(record: dict[str, Any]) -> None:
    known = [leg for leg in record["legs"] if leg["feet_mm"] is not None]
    if known:
        feet = next(q for q in PREDICTED if q.name == "feet")
        each = ", ".join(f"{leg['name']} {feet.cell(leg)} mm" for leg in known)
        show_lines(
            "",
            f"Feet stand {number(record['foot_mm'])} mm deep; by statics the predicted gait stays: "
            f"{each}.",
        )


def runs(gaits: list[str]) -> list[tuple[str, str]]:
    """Equal gaits that follow each other told once: their cycles from 1, and the gait."""
    found: list[tuple[str, str]] = []
    first = 1
    for gait, same in groupby(gaits):
        last = first + len(list(same)) - 1
        found.append((f"{first}" if first == last else f"{first} to {last}", gait or "none"))
        first = last + 1
    return found
