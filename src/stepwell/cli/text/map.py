"""The result of `stepwell map` as people read it."""

from typing import Any

from stepwell.base import number
from stepwell.cli.screen import show_lines, show_table
from stepwell.sequences import Pathway


def show(record: dict[str, Any]) -> None:
    """Print what `results.map_record` returns."""
    ends = {
        name: f"{axis['parameter']} {number(axis['from'])} to {number(axis['to'])} {axis['unit']}, "
        f"{axis['count']} values"
        for name, axis in record.items()
        if name in ("across", "up")
    }
    show_lines(record["title"], "", f"Across {ends['across']}; up {ends['up']}")
    shares = [(name, f"{100 * share:.1f} %") for name, share in record["shares"].items() if share]
    if "pathway_shares" in record:
        labels = {pathway.value: pathway.label for pathway in Pathway}
        rows = [[labels.get(name, ""), name, share] for name, share in shares]
        show_table("Sequences", ["pathway", "sequence", "share of the map"], rows, left=(0, 1))
    else:
        show_table("Sequences", ["sequence", "share of the map"], [list(row) for row in shares])
    show_lines(
        "",
        f"{record['moved_cell']} is monostable on {100 * record['monostable_fraction']:.1f} % of "
        f"the map. {record['closed_form_designs']} designs in closed form, "
        f"{record['engine_designs']} by the engine; {record['degenerate_designs']} sit on a "
        f"boundary.",
    )
    if not record["boundaries"]:
        return
    show_table(
        "Boundaries",
        ["what changes", "points", "how", "within"],
        [
            [
                boundary["changes"],
                str(boundary["points"]),
                boundary["method"],
                ""
                if boundary["method"] == "exact"
                else f"{number(boundary['error_of_axes'], 2)} of the axes",
            ]
            for boundary in record["boundaries"]
        ],
        left=(0, 2, 3),
    )
