"""The result of `stepwell program` as people read it."""

from typing import Any

from stepwell.base import Quantity, number
from stepwell.cli.screen import show_facts, show_lines, show_records, show_text, wrapped
from stepwell.cli.text.run import MOST_CELLS, show_events
from stepwell.sequences.programs import turn_schema


def show(record: dict[str, Any]) -> None:
    """Print what `results.program_record` or `results.unreachable_record` returns."""
    if record["arrives"] is None:
        show_facts(record, {}, 10)
        show_lines(*wrapped(record["reason"]))
        return
    unit = "N" if "turning_points_N" in record else "mm"
    slack = record[f"slack_{unit}"]
    found = {
        "Program": f"{record['from']} to {record['to']}: {_verdict(record)}",
        "Turns at": _points(record[f"turning_points_{unit}"], unit),
        "Slack": slack is not None
        and f"every turn may be off by {number(slack, 3)} {unit} at once",
        "States": len(record["cells"]) <= MOST_CELLS and record["sequence"],
    }
    show_facts(record, found, 10)
    # Where a turn can go back to is known of programs that were searched for.
    columns = turn_schema(unit)[: None if any(turn["branch"] for turn in record["turns"]) else -1]
    show_records(
        "Turns: anywhere in its window each does the same",
        [Quantity("turn", head="turn"), *columns],
        [{"turn": k} | turn for k, turn in enumerate(record["turns"], 1)],
    )
    show_events(record["events"], record["cells"])
    show_text(f"{record['reason']}.")


def _verdict(record: dict[str, Any]) -> str:
    times = f"{record['strokes']} stroke{'s' * (record['strokes'] != 1)}"
    return times if record["does_it"] else f"ends in {record['arrives']} after {times}"


def _points(points: list[float], unit: str) -> str:
    more = f" and {len(points) - 12} more" if len(points) > 12 else ""
    return " → ".join(map(number, points[:12])) + f" {unit}{more}"
