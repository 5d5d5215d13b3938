"""The result of `stepwell reprogram` as people read it."""

from typing import Any

from stepwell.base import Quantity, number, signed
from stepwell.cli.screen import show_facts, show_lines, show_records, show_text
from stepwell.design.margins import WAY

# Of the places on the way every so manieth is printed; --json and --out have all.
EVERY = 5


def show(record: dict[str, Any]) -> None:
    """Print what `results.reprogram_record` returns."""
    if not record["possible"]:
        wanted = record["target"] or "another sequence"
        show_facts(record, {}, 0)
        show_lines(
            f"No displacement of {record['by']} up to {number(record['reach_mm'])} mm makes it "
            f"{wanted} ({record['method']}).",
        )
    elif not record["distance_mm"]:
        show_facts(record, {}, 0)
        show_lines(f"It does {record['before']} already.")
        return
    else:
        _way(record)
    if record["resolution"]:
        show_text(f"Searched, not exact: {record['resolution']}")


def _way(record: dict[str, Any]) -> None:
    x, y = record["displacement_mm"]
    at_x, at_y = record["place_mm"]
    found = {
        "Now": record["before"],
        "Then": record["after"],
        "Move": f"{record['by']} by ({signed(x)}, {signed(y)}) mm, {number(record['distance_mm'])} "
        f"mm, to ({number(at_x)}, {number(at_y)}) mm ({record['method']})",
        "Force": f"up to {number(record['largest_force_N'])} N against the displacement",
        "Work": f"{number(record['work_at_0_mJ'])} mJ at state 0 of the cell, "
        f"{number(record['work_at_1_mJ'])} mJ at state 1",
    }
    show_facts(record, found, 7)
    columns = [Quantity("moved", "mm", "moved"), *WAY[1:]]
    rows = (
        (one["fraction"] * record["distance_mm"], *one["at_mm"], *list(one.values())[2:])
        for one in record["way"]
    )
    show_records(
        "On the way: force against the displacement",
        columns,
        [{q.key: told for q, told in zip(columns, row, strict=True)} for row in rows],
        most=None,
        every=EVERY,
    )
