"""The result of `stepwell design` as people read it."""

from typing import Any

from stepwell.cli.screen import number, show_lines, show_table, show_text, wrapped
from stepwell.cli.text import yields

# A list of more states than these helps nobody.
MOST_STATES = 16


def show(record: dict[str, Any]) -> None:
    """Print what `results.design_record` or `results.impossible_record` returns."""
    if not record["possible"]:
        show_lines(*wrapped(record["reason"]))
        return
    cells = record["cells"]
    names = [cell["name"] for cell in cells]
    show_lines(
        *_states(record),
        *(line for line in yields.lines(record["yield"], names) if line[:6] != "Wanted"),
        *_robustness(record["robustness"], names),
    )
    show_table(
        "Cells, innermost first",
        ["cell", "q [mm]", "p [mm]", "k [N/m]", "l0 [mm]", "lever [mm]", "F0 [N]", "F1 [N]"],
        [
            [
                cell["name"],
                *(", ".join(number(round(v, 3), 6) for v in cell[key]) for key in _ANCHORS),
                *(number(cell[key]) for key in _NUMBERS),
            ]
            for cell in cells
        ],
    )
    reach = [] if record["states_whole"] else [_more(record)]
    show_text(record["reason"], *reach, record["assumptions"])


def _states(record: dict[str, Any]) -> list[str]:
    count, states = record["state_count"], record["states"]
    listed = f"{count} states" if record["states_whole"] else f"{count} states surely"
    if states is None:
        return [f"In reach  {listed}"]
    more = f" and {len(states) - MOST_STATES} more" if len(states) > MOST_STATES else ""
    listed += f": {', '.join(states[:MOST_STATES])}{more}"
    return [f"Sequence  {record['sequence']}", f"In reach  {listed}"]


def _more(record: dict[str, Any]) -> str:
    return f"more states may be in reach: {record['states_how']}"


_ANCHORS = ("q_mm", "p_mm")
_NUMBERS = ("stiffness_N_per_m", "rest_length_mm", "lever_mm", "F0_N", "F1_N")


def _robustness(found: dict[str, Any] | None, names: list[str]) -> list[str]:
    if found is None:
        return []
    text = f"all anchors may be off by {number(found['radius_mm'])} mm at once"
    if found["meet"] is not None:
        first, second = (names[cell] for cell in found["meet"])
        text += f"; then {first} and {second} change places while {found['while']}"
    return [f"Worst     {text}"]
