"""The result of `stepwell design` as people read it."""

from typing import Any

from stepwell.base import number
from stepwell.cli.screen import show_lines, show_records, show_text, wrapped
from stepwell.cli.text import yields
from stepwell.results import BUILT

# A list of more states than these helps nobody.
MOST_STATES = 16


def show(record: dict[str, Any]) -> None:
    """Print what `results.design_record` or `results.impossible_record` returns."""
    if not record["possible"]:
        show_lines(*wrapped(record["reason"]))
        return
    names = [cell["name"] for cell in record["cells"]]
    show_lines(
        *_states(record),
        *(line for line in yields.lines(record["yield"], names) if line[:6] != "Wanted"),
        *_robustness(record["robustness"], names),
    )
    name, p, q, *others = BUILT
    show_records("Cells, innermost first", [name, q, p, *others], record["cells"])
    more = f"more states may be in reach: {record['states_how']}"
    show_text(record["reason"], *([] if record["states_whole"] else [more]), record["assumptions"])


def _states(record: dict[str, Any]) -> list[str]:
    count, states = record["state_count"], record["states"]
    listed = f"{count} states" if record["states_whole"] else f"{count} states surely"
    if states is None:
        return [f"In reach  {listed}"]
    more = f" and {len(states) - MOST_STATES} more" if len(states) > MOST_STATES else ""
    listed += f": {', '.join(states[:MOST_STATES])}{more}"
    return [f"Sequence  {record['sequence']}", f"In reach  {listed}"]


def _robustness(found: dict[str, Any] | None, names: list[str]) -> list[str]:
    if found is None:
        return []
    text = f"all anchors may be off by {number(found['radius_mm'])} mm at once"
    if found["meet"] is not None:
        first, second = (names[cell] for cell in found["meet"])
        text += f"; then {first} and {second} change places while {found['while']}"
    return [f"Worst     {text}"]
