"""The result of `stepwell maze` as people read it."""

from __future__ import annotations

from typing import Any

from stepwell.cli.screen import number, show_lines, show_table
from stepwell.cli.text.sources import show_sources

MOST_ROWS = 40
_OUTCOMES = {
    "reached": "reached the goal",
    "timed_out": "ran out of time",
    "trapped": "got nowhere any more",
    "stopped": "stopped early",
}


def show(record: dict[str, Any]) -> None:
    """Print what `results.maze_record` returns."""
    show_lines(*_head(record))
    if record["touched"]:
        show_table(
            "Obstacles",
            ["obstacle", "first touched [s]"],
            [
                [one["obstacle"], "never" if one["time_s"] is None else number(one["time_s"])]
                for one in record["touched"]
            ],
        )
    _contacts(record)
    _changes(record["changes"])
    show_sources(record["parameters"])


def _head(record: dict[str, Any]) -> list[str]:
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
    title = [record["title"], ""] if record["title"] else []
    return title + [f"{name:<12}{value}" for name, value in found.items() if value]


def _antennas(antennas: list[dict[str, Any]]) -> str:
    if not antennas:
        return "none"
    off = [one["name"] for one in antennas if not one["connected"]]
    if not off:
        return str(len(antennas))
    return f"{len(antennas)}, the levers of {', '.join(off)} taken off"


def _contacts(record: dict[str, Any]) -> None:
    contacts = record["contacts"]
    if not contacts:
        return
    legs = {one["name"]: one["leg"] for one in record["antennas"] if one["connected"]}
    show_table(
        "Antenna contacts",
        ["antenna", "from [s]", "to [s]", "swing [deg]", "anchor moved [mm]", "reprograms"],
        [
            [
                one["antenna"],
                number(one["begin_s"]),
                number(one["end_s"]),
                number(one["swing_deg"], 3),
                number(one["moved_mm"], 3),
                legs.get(one["antenna"], "nothing"),
            ]
            for one in contacts[:MOST_ROWS]
        ],
        left=(0, 5),
        hidden=len(contacts) - MOST_ROWS,
    )


def _changes(changes: list[dict[str, Any]]) -> None:
    if not changes:
        return
    show_table(
        "Changes of gait",
        ["from [s] on", "leg", "was", "is"],
        [
            [number(one["time_s"]), one["leg"], one["before"] or "none", one["after"] or "none"]
            for one in changes[:MOST_ROWS]
        ],
        left=(1, 2, 3),
        hidden=len(changes) - MOST_ROWS,
    )
