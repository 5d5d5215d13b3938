"""The results of commands about chains as people read them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from stepwell.base import Column, Quantity, number, percent, signed
from stepwell.cli.screen import (
    show_facts,
    show_lines,
    show_records,
    show_text,
    wrapped,
)
from stepwell.design import WAY
from stepwell.mechanism import Chain
from stepwell.results import (
    SENSITIVITY,
    built_schema,
    tolerance_words,
)

if TYPE_CHECKING:
    pass

# The states of a longer chain are too long to be read.
MOST_CELLS = 12


def _order(cells: Sequence[int], names: Sequence[str], most: int = 12) -> str:
    shown = ", ".join(names[cell] for cell in cells[:most])
    return shown + f" and {len(cells) - most} more" * (len(cells) > most)


def _unit(unit: str) -> str:
    return "" if unit == "1" else f" {Quantity('', unit).sign}"


# Of the places on the way every so manieth is printed; --json and --out have all.
EVERY = 5


def reprogram(record: dict[str, Any]) -> None:
    """Print what `results.reprogram_record` returns."""
    if not record["possible"]:
        wanted = record["target"] or "another sequence"
        reach = record.get("reach_mm")
        tried = (
            f"value of {record['by']} that was looked at"
            if reach is None
            else f"displacement of {record['by']} up to {number(reach)} mm"
        )
        show_facts(record, {}, 0)
        show_lines(f"No {tried} makes it {wanted} ({record['method']}).")
    elif not _told(record, "distance")[0]:
        show_facts(record, {}, 0)
        show_lines(f"It does {record['before']} already.")
        return
    elif record["way"]:
        _displacement(record)
    else:
        to, unit = _told(record, "place")
        by, _ = _told(record, "displacement")
        found = {
            "Now": record["before"],
            "Then": record["after"],
            "Set": f"{record['by']} to {number(to)}{unit} ({signed(by)}; {record['method']})",
        }
        show_facts(record, found, 7)
    if record["resolution"]:
        show_text(f"Searched, not exact: {record['resolution']}")


def _told(record: dict[str, Any], name: str) -> tuple[Any, str]:
    """A number with the unit that stands in its key."""
    key = next(key for key in record if key == name or key.startswith(f"{name}_"))
    return record[key], _unit(key.removeprefix(name).removeprefix("_") or "1")


def _displacement(record: dict[str, Any]) -> None:
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
    keys = [column.key for column in columns]
    rows = (
        (one["fraction"] * record["distance_mm"], *one["at_mm"], *list(one.values())[2:])
        for one in record["way"]
    )
    show_records(
        "On the way: force against the displacement",
        columns,
        [dict(zip(keys, row, strict=True)) for row in rows],
        most=None,
        every=EVERY,
    )


# A list of more states than these helps nobody.
MOST_STATES = 16


def design(record: dict[str, Any], chain: Chain | None) -> None:
    """Print what `results.design_record` or `results.impossible_record` returns of a chain."""
    if chain is None:
        show_lines(*wrapped(record["reason"]))
        return
    shares = _shares(record["yield"], chain) | {"Wanted": ""}
    found = _states(record) | shares | {"Worst": _robustness(record["robustness"], chain)}
    show_facts({"title": ""}, found, 10)
    schema = built_schema(chain)
    if not chain.elements:
        # What can be chosen stands before what is given.
        name, p, q, *others = schema
        schema = name, q, p, *others
    show_records("Cells, innermost first", schema, record["cells"])
    more = f"more states may be in reach: {record['states_how']}"
    show_text(record["reason"], *([] if record["states_whole"] else [more]), record["assumptions"])


def _states(record: dict[str, Any]) -> dict[str, str]:
    count, states = record["state_count"], record["states"]
    listed = f"{count} states" if record["states_whole"] else f"{count} states surely"
    if states is None:
        return {"In reach": listed}
    more = f" and {len(states) - MOST_STATES} more" if len(states) > MOST_STATES else ""
    listed += f": {', '.join(states[:MOST_STATES])}{more}"
    return {"Sequence": record["sequence"], "In reach": listed}


def _robustness(found: dict[str, Any] | None, chain: Chain) -> str:
    if found is None:
        return ""
    if "share" in found:
        text = f"all {chain.measure.force}s may be off by {number(found['share'] * 100)} % at once"
    else:
        text = f"all anchors may be off by {number(found['radius_mm'])} mm at once"
    if found["meet"] is not None:
        first, second = (chain.names[cell] for cell in found["meet"])
        text += f"; then {first} and {second} change places while {found['while']}"
    return text


MOST_ROWS = 12


def yields(record: dict[str, Any], chain: Chain) -> None:
    """Print what `results.yield_record` or `results.survival_record` returns of a chain."""
    show_facts(record, _shares(record, chain), 10)
    if "outcomes" not in record:
        calibrated(record)
        show_text(record["assumptions"])
        return
    if record["advice"]:
        show_text(record["advice"])
    show_records(
        "What the others do",
        [
            Column("outcome", lambda one: one["outcome"]),
            Column("share", lambda one: percent(one["count"] / record["samples"]), True),
        ],
        record["outcomes"],
        most=MOST_ROWS,
    )
    if record["sensitivities"] is not None:
        show_records(
            "Share of the variance of the smallest gap that a part makes, alone and with others",
            SENSITIVITY,
            sorted(record["sensitivities"], key=lambda one: -one["total"]),
            most=MOST_ROWS,
        )
        if record["gap_agreement"] is not None:
            agreed = percent(record["gap_agreement"])
            show_lines(f"The gap tells what the engine finds in {agreed}")
    calibrated(record)
    show_text(record["assumptions"])


def calibrated(record: dict[str, Any]) -> None:
    """Print what recordings have told, where some were folded in."""
    if about := record["calibrated"]:
        show_text(
            f"Bands, weight and friction as calibrated on {about['data']}:", *about["summary"]
        )


def _shares(record: dict[str, Any], chain: Chain) -> dict[str, str]:
    """Share, tolerances and critical pair of a yield."""
    tolerances = tolerance_words(record["tolerances"], chain)
    low, high = percent(record["share_low"]), percent(record["share_high"])
    return {
        "Yield": f"{percent(record['share'])}, with 95 % confidence {low} to {high}",
        "Wanted": record.get("wanted") or f"{record['from']} to {record['to']} by the program",
        "Made": f"{record['samples']} mechanisms with {tolerances}",
        "Critical": _critical(record.get("critical"), chain.names),
    }


def _critical(pair: dict[str, Any] | None, names: Sequence[str]) -> str:
    if pair is None:
        return ""
    first, second = pair.get("names") or (names[pair["first"]], names[pair["second"]])
    return (
        f"{first} before {second} while {pair['while']}: in the other order in "
        f"{percent(pair['share'])}"
    )
