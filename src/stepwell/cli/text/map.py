"""The result of `stepwell map` as people read it."""

from typing import Any

from stepwell.cli.screen import number, show_lines, show_table


def show(record: dict[str, Any]) -> None:
    """Print what `results.map_record` or `results.parameter_map_record` returns."""
    if "across" in record:
        _of_parameters(record)
    else:
        _of_anchor(record)


def _of_parameters(record: dict[str, Any]) -> None:
    def axis(name: str) -> str:
        one = record[name]
        ends = f"{number(one['from'])} to {number(one['to'])} {one['unit']}"
        return f"{one['parameter']} {ends}, {one['count']} values"

    show_lines(record["title"], "", f"Across {axis('across')}; up {axis('up')}")
    show_table(
        "Sequences",
        ["sequence", "share of the map"],
        [[name, f"{100 * share:.1f} %"] for name, share in record["shares"].items() if share],
    )
    show_lines(
        "",
        f"{record['closed_form_designs']} designs in closed form, {record['engine_designs']} by "
        f"the engine; {record['degenerate_designs']} sit on a boundary.",
    )
    if not record["boundaries"]:
        return
    show_table(
        "Boundaries",
        ["what changes", "points", "how"],
        [
            [boundary["changes"], str(boundary["points"]), boundary["method"]]
            for boundary in record["boundaries"]
        ],
        left=(0, 2),
    )


def _of_anchor(record: dict[str, Any]) -> None:
    x, y = record["x_mm"], record["y_mm"]
    show_lines(
        record["title"],
        "",
        f"Anchor q of {record['moved_cell']}: "
        f"x {number(x['from'])} to {number(x['to'])} mm, {x['count']} places; "
        f"y {number(y['from'])} to {number(y['to'])} mm, {y['count']} places",
    )
    show_table(
        "Pathways",
        ["pathway", "share of the map"],
        [
            [name.replace("_", " "), f"{100 * share:.1f} %"]
            for name, share in record["area_fractions"].items()
            if share
        ],
    )
    show_lines(
        "",
        f"{record['moved_cell']} is monostable on {100 * record['monostable_fraction']:.1f} % of "
        f"the map; {record['degenerate_designs']} designs sit on a boundary.",
    )
    show_table(
        "Boundaries",
        ["what changes", "points", "how", "within [mm]"],
        [
            [
                boundary["changes"],
                str(boundary["points"]),
                boundary["method"],
                "" if boundary["method"] == "exact" else number(boundary["error_mm"], 2),
            ]
            for boundary in record["boundaries"]
        ],
        left=(0, 2),
    )
