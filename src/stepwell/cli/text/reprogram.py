"""The result of `stepwell reprogram` as people read it."""

from typing import Any

from stepwell.cli.screen import number, show_lines, show_table, show_text, signed

# Of the places on the way every so manieth is printed; --json and --out have all.
EVERY = 5


def show(record: dict[str, Any]) -> None:
    """Print what `results.reprogram_record` returns."""
    title = [record["title"], ""] if record["title"] else []
    if not record["possible"]:
        wanted = record["target"] or "another sequence"
        show_lines(
            *title,
            f"No displacement of {record['by']} up to {number(record['reach_mm'])} mm makes it "
            f"{wanted} ({record['method']}).",
        )
        _resolution(record)
        return
    if not record["distance_mm"]:
        show_lines(*title, f"It does {record['before']} already.")
        return
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
    show_lines(*title, *(f"{name:<7}{value}" for name, value in found.items()))
    show_table(
        "On the way: force against the displacement",
        ["moved [mm]", "x [mm]", "y [mm]", "at state 0 [N]", "at state 1 [N]", "largest [N]"],
        [
            [
                number(one["fraction"] * record["distance_mm"]),
                *map(number, one["at_mm"]),
                *(number(one[f"{name}_N"]) for name in _FORCES),
            ]
            for one in record["way"][::EVERY]
        ],
        left=(),
    )
    _resolution(record)


_FORCES = ("force_at_0", "force_at_1", "largest_force")


def _resolution(record: dict[str, Any]) -> None:
    if record["resolution"]:
        show_text(f"Searched, not exact: {record['resolution']}")
