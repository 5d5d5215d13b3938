"""The result of `stepwell maze` as people read it."""

from __future__ import annotations

from typing import Any

from stepwell.base import Column, number
from stepwell.cli.screen import show_facts, show_records
from stepwell.cli.text.sources import show_sources
from stepwell.results import CHANGE, CONTACT, TOUCHED

_OUTCOMES = {
    "reached": "reached the goal",
    "timed_out": "ran out of time",
    "trapped": "got nowhere any more",
    "stopped": "stopped early",
}


def show(record: dict[str, Any]) -> None:
    """Print what `results.maze_record` returns."""
    touched = sum(one["time_s"] is not None for one in record["touched"])
    x, y = record["end_mm"] or (None, None)
    found = {
        "Arena": record["arena"],
        "Outcome": f"{_OUTCOMES[record['outcome']]} after {number(record['duration_s'])} s",
        "Touched": record["touched"] and f"{touched} of {len(record['touched'])} obstacles",
        "Antennas": _antennas(record["antennas"]),
        "Ended at": x is not None and f"({number(x)}, {number(y)}) mm",
        "Stopped": record["stopped"].removeprefix("Stopped "),
    }
    show_facts(record, found, 12)
    show_records("Obstacles", TOUCHED, record["touched"], most=None)
    legs = {one["name"]: one["leg"] for one in record["antennas"] if one["connected"]}
    leg = Column("reprograms", lambda contact: legs.get(contact["antenna"], "nothing"))
    show_records("Antenna contacts", [*CONTACT, leg], record["contacts"])
    time, *gaits = CHANGE
    show_records(
        "Changes of gait", [Column("from [s] on", time.cell, True), *gaits], record["changes"]
    )
    show_sources(record["parameters"])


def _antennas(antennas: list[dict[str, Any]]) -> str:
    if not antennas:
        return "none"
    off = [one["name"] for one in antennas if not one["connected"]]
    if not off:
        return str(len(antennas))
    return f"{len(antennas)}, the levers of {', '.join(off)} taken off"
