"""The result of `stepwell run` as people read it."""

from typing import Any

from stepwell.cli.screen import number, show_lines, show_table, signed

# Longer tables help nobody on a screen; --json and --out have everything.
MOST_ROWS = 40
# The states of a longer chain are too long to be read.
MOST_CELLS = 12


def show(record: dict[str, Any]) -> None:
    """Print what `results.run_record` returns."""
    names = [cell["name"] for cell in record["cells"]]
    show_lines(*_head(record, names))
    _cells(record["cells"])
    show_events(record["events"], names)
    _margin(record["margin"], names)
    if record["ties"]:
        show_lines("", "Too close to call", *record["ties"])


def _head(record: dict[str, Any], names: list[str]) -> list[str]:
    def order(cells: list[int]) -> str:
        shown = ", ".join(names[cell] for cell in cells[:12])
        return shown + f" and {len(cells) - 12} more" * (len(cells) > 12)

    found = {
        "Sequence": record["sequence"] if len(names) <= MOST_CELLS else None,
        "Pathway": (record["pathway"] or "").replace("_", " "),
        "Loading": order(record["loading_order"]),
        "Unloading": order(record["unloading_order"]),
        "Peak force": f"{number(record['peak_force_N'])} N",
        "Dissipated": f"{number(record['dissipated_mJ'])} mJ in a cycle",
        "Margin": _nearest(record["margin"]),
    }
    title = [record["title"], ""] if record["title"] else []
    return title + [f"{name:<12}{value}" for name, value in found.items() if value]


def _nearest(margin: dict[str, Any]) -> str:
    found: list[str] = []
    for key, unit in (("distance_mm", "mm of an anchor"), ("distance_percent", "% of a stiffness")):
        known = [c[key] for c in margin["changes"] if c.get(key) is not None]
        if known:
            found.append(f"{number(min(known))} {unit}")
    if not found:
        return f"no other sequence within {number(margin['reach_mm'])} mm of any anchor"
    return f"{' or '.join(found)} to another sequence ({margin['method']})"


def _cells(cells: list[dict[str, Any]]) -> None:
    show_table(
        "Cells, innermost first",
        ["cell", "F0 [N]", "F1 [N]", "F0/(kr)", "F1/(kr)", "travel [mm]", "peak [deg]", "stable"],
        [
            [
                cell["name"],
                number(cell["F0_N"]),
                number(cell["F1_N"]),
                number(cell["F0_over_kr"]),
                number(cell["F1_over_kr"]),
                number(cell["full_travel_mm"]),
                number(cell["peak_angle_deg"]),
                "both states" if cell["bistable"] else "one state",
            ]
            for cell in cells[:MOST_ROWS]
        ],
        left=(0, 7),
        hidden=len(cells) - MOST_ROWS,
    )


def show_events(events: list[dict[str, Any]], names: list[str]) -> None:
    """Print a table of switches and snaps."""
    show_table(
        "Switches and snaps",
        ["while", "event", "stroke [mm]", "cells [mm of travel]", "force [N]", "released [mJ]"],
        [
            [
                event["direction"],
                event["kind"],
                number(event["stroke_mm"], 6),
                _moves(event, names),
                f"{number(event['force_before_N'])} → {number(event['force_after_N'])}"
                if event["kind"] == "snap"
                else number(event["force_before_N"]),
                number(event["released_mJ"]) if event["kind"] == "snap" else "",
            ]
            for event in events[:MOST_ROWS]
        ],
        left=(0, 1, 3),
        hidden=len(events) - MOST_ROWS,
    )


def _moves(event: dict[str, Any], names: list[str]) -> str:
    if event["kind"] == "switch":
        return ", ".join(f"{names[a['cell']]} at {a['state']}" for a in event["arrivals"])
    moves = zip(event["cells"], event["before_mm"], event["after_mm"], strict=True)
    return ", ".join(f"{names[cell]} {number(a)} → {number(b)}" for cell, a, b in moves)


def _margin(margin: dict[str, Any], names: list[str]) -> None:
    changes = margin["changes"]
    # Long chains are told the distances alone.
    columns = 5 if any(change["becomes"] for change in changes) else 4
    rows = (
        [names[change["cell"]], change["parameter"], *_way(change), change["becomes"] or ""]
        for change in changes[:MOST_ROWS]
    )
    show_table(
        "Margin: the smallest change of one thing that gives another sequence",
        ["cell", "what", "how far", "which way", "sequence past it"][:columns],
        [row[:columns] for row in rows],
        left=(0, 1, 3, 4),
        hidden=len(changes) - MOST_ROWS,
    )


def _way(change: dict[str, Any]) -> tuple[str, str]:
    if change["parameter"] == "anchor":
        if change["distance_mm"] is None:
            return "none in reach", ""
        x, y = change["move_mm"]
        return f"{number(change['distance_mm'])} mm", f"q by ({signed(x)}, {signed(y)}) mm"
    if change["distance_percent"] is None:
        return "none", ""
    return f"{number(change['distance_percent'])} %", f"k by {signed(change['move_percent'])} %"
