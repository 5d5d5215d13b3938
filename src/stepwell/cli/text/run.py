"""The result of `stepwell run` as people read it."""

from typing import Any

from stepwell.base import number
from stepwell.cli.screen import show_facts, show_lines, show_records
from stepwell.results import CELL, change_columns, event_columns

# The states of a longer chain are too long to be read.
MOST_CELLS = 12


def show(record: dict[str, Any]) -> None:
    """Print what `results.run_record` returns."""
    names = [cell["name"] for cell in record["cells"]]
    found = {
        "Sequence": record["sequence"] if len(names) <= MOST_CELLS else None,
        "Pathway": (record["pathway"] or "").replace("_", " "),
        "Loading": _order(record["loading_order"], names),
        "Unloading": _order(record["unloading_order"], names),
        "Peak force": f"{number(record['peak_force_N'])} N",
        "Dissipated": f"{number(record['dissipated_mJ'])} mJ in a cycle",
        "Margin": _nearest(record["margin"]),
    }
    show_facts(record, found, 12)
    show_records("Cells, innermost first", CELL, record["cells"])
    show_events(record["events"], names)
    changes = record["margin"]["changes"]
    show_records(
        "Margin: the smallest change of one thing that gives another sequence",
        change_columns(names, changes),
        changes,
    )
    if record["ties"]:
        show_lines("", "Too close to call", *record["ties"])


def _order(cells: list[int], names: list[str]) -> str:
    shown = ", ".join(names[cell] for cell in cells[:12])
    return shown + f" and {len(cells) - 12} more" * (len(cells) > 12)


def _nearest(margin: dict[str, Any]) -> str:
    found: list[str] = []
    for key, unit in (("distance_mm", "mm of an anchor"), ("distance_percent", "% of a stiffness")):
        known = [c[key] for c in margin["changes"] if c.get(key) is not None]
        if known:
            found.append(f"{number(min(known))} {unit}")
    if not found:
        return f"no other sequence within {number(margin['reach_mm'])} mm of any anchor"
    return f"{' or '.join(found)} to another sequence ({margin['method']})"


def show_events(events: list[dict[str, Any]], names: list[str]) -> None:
    """Print a table of switches and snaps."""
    show_records("Switches and snaps", event_columns(names), events)
