"""The result of `stepwell program` as people read it."""

from typing import Any

from stepwell.cli.screen import number, show_lines, show_table, show_text, wrapped
from stepwell.cli.text.run import MOST_CELLS, MOST_ROWS, show_events


def show(record: dict[str, Any]) -> None:
    """Print what `results.program_record` or `results.unreachable_record` returns."""
    title = [record["title"], ""] if record["title"] else []
    if record["arrives"] is None:
        show_lines(*title, *wrapped(record["reason"]))
        return
    unit = "N" if "turning_points_N" in record else "mm"
    points = record[f"turning_points_{unit}"]
    found = {
        "Program": f"{record['from']} to {record['to']}: {_verdict(record)}",
        "Turns at": _points(points, unit),
        "Slack": _slack(record, unit),
        "States": record["sequence"] if len(record["cells"]) <= MOST_CELLS else None,
    }
    show_lines(*title, *(f"{name:<10}{value}" for name, value in found.items() if value))
    _turns(record, unit)
    show_events(record["events"], record["cells"])
    show_text(f"{record['reason']}.")


def _verdict(record: dict[str, Any]) -> str:
    times = f"{record['strokes']} stroke{'s' * (record['strokes'] != 1)}"
    return times if record["does_it"] else f"ends in {record['arrives']} after {times}"


def _points(points: list[float], unit: str) -> str:
    more = f" and {len(points) - 12} more" if len(points) > 12 else ""
    return " → ".join(map(number, points[:12])) + f" {unit}{more}"


def _slack(record: dict[str, Any], unit: str) -> str:
    slack = record[f"slack_{unit}"]
    return "" if slack is None else f"every turn may be off by {number(slack, 3)} {unit} at once"


def _turns(record: dict[str, Any], unit: str) -> None:
    turns = record["turns"]
    if not turns:
        return
    # Where a turn can go back to is known of programs that were searched for.
    columns = 5 if any(turn["branch"] for turn in turns) else 4
    rows = (
        [
            str(k),
            *(number(turn[f"{name}_{unit}"], 6) for name in ("drive", "low", "high")),
            ", ".join(turn["branch"]),
        ]
        for k, turn in enumerate(turns[:MOST_ROWS], 1)
    )
    show_table(
        "Turns: anywhere in its window each does the same",
        ["turn", f"at [{unit}]", f"from [{unit}]", f"to [{unit}]", "can go back to"][:columns],
        [row[:columns] for row in rows],
        left=(0, 4),
        hidden=len(turns) - MOST_ROWS,
    )
