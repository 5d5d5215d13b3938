"""The result of `stepwell walk` as people read it."""

from __future__ import annotations

from itertools import groupby
from typing import Any

from stepwell.cli.screen import number, show_lines, show_table
from stepwell.cli.text.robot import feet_text
from stepwell.cli.text.sources import show_sources

MOST_ROWS = 40


def show(record: dict[str, Any]) -> None:
    """Print what `results.walk_record` returns."""
    show_lines(*_head(record))
    _gaits(record["legs"])
    _feet(record)
    _cycles(record)
    show_sources(record["parameters"])


def _head(record: dict[str, Any]) -> list[str]:
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
    title = [record["title"], ""] if record["title"] else []
    return title + [f"{name:<12}{value}" for name, value in found.items() if value]


def mean_text(record: dict[str, Any]) -> str:
    """How far and round a robot goes in a cycle."""
    if record["mean_advance_over_u_max"] is None:
        return ""
    after = " after the first" if record["cycles"] > 1 else ""
    return (
        f"d/u_max {record['mean_advance_over_u_max'] + 0.0:.3f} and "
        f"{record['mean_turn_deg'] + 0.0:.2f}° to the left{after}"
    ).replace("-0.00°", "0.00°")


def _gaits(legs: list[dict[str, Any]]) -> None:
    rows = [
        [leg["name"] if not i else "", cycles, gait, number(leg["slip_mm"], 3) if not i else ""]
        for leg in legs
        for i, (cycles, gait) in enumerate(runs(leg["gaits"]))
    ]
    show_table(
        "Gaits",
        ["leg", "cycles", "states", "slip [mm a cycle]"],
        rows[:MOST_ROWS],
        left=(0, 1, 2),
        hidden=len(rows) - MOST_ROWS,
    )


def _feet(record: dict[str, Any]) -> None:
    known = [leg for leg in record["legs"] if leg["feet_mm"] is not None]
    if known:
        each = ", ".join(f"{leg['name']} {feet_text(leg['feet_mm'])} mm" for leg in known)
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


def _cycles(record: dict[str, Any]) -> None:
    columns = (record["advance_over_u_max"], record["sideways_over_u_max"], record["turn_deg"])
    rows = [
        [str(i + 1), *(f"{_whole(v):.3f}" for v in row)]
        for i, row in enumerate(zip(*columns, strict=True))
    ]
    show_table(
        "Cycle by cycle",
        ["cycle", "d/u_max", "to the left", "turn to the left [deg]"],
        rows[:MOST_ROWS],
        hidden=len(rows) - MOST_ROWS,
    )


def _whole(value: float) -> float:
    # A rounding error has no sign.
    return 0.0 if abs(value) < 5e-4 else value
