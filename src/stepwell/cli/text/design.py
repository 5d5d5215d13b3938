"""The results of `stepwell design` and `stepwell yield` as people read them."""

from typing import Any

from stepwell.base import Column, number
from stepwell.cli.screen import show_facts, show_lines, show_records, show_text, wrapped
from stepwell.results import BUILT, SENSITIVITY, TOLERANCES

# A list of more states than these helps nobody.
MOST_STATES = 16


def design(record: dict[str, Any]) -> None:
    """Print what `results.design_record` or `results.impossible_record` returns."""
    if not record["possible"]:
        show_lines(*wrapped(record["reason"]))
        return
    names = [cell["name"] for cell in record["cells"]]
    shares = _shares(record["yield"], names) | {"Wanted": ""}
    found = _states(record) | shares | {"Worst": _robustness(record["robustness"], names)}
    show_facts({"title": ""}, found, 10)
    name, p, q, *others = BUILT
    show_records("Cells, innermost first", [name, q, p, *others], record["cells"])
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


def _robustness(found: dict[str, Any] | None, names: list[str]) -> str:
    if found is None:
        return ""
    text = f"all anchors may be off by {number(found['radius_mm'])} mm at once"
    if found["meet"] is not None:
        first, second = (names[cell] for cell in found["meet"])
        text += f"; then {first} and {second} change places while {found['while']}"
    return text


MOST_ROWS = 12


def yields(record: dict[str, Any]) -> None:
    """Print what `results.yield_record` or `results.survival_record` returns."""
    show_facts(record, _shares(record, record["cells"]), 10)
    if "outcomes" not in record:
        show_text(record["assumptions"])
        return
    if record["advice"]:
        show_text(record["advice"])
    show_records(
        "What the others do",
        [
            Column("outcome", lambda one: one["outcome"]),
            Column("share", lambda one: _percent(one["count"] / record["samples"]), True),
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
            agreed = _percent(record["gap_agreement"])
            show_lines(f"The gap tells what the engine finds in {agreed}")
    show_text(record["assumptions"])


def _shares(record: dict[str, Any], names: list[str]) -> dict[str, str]:
    """Share, tolerances and critical pair of a yield."""
    low, high = _percent(record["share_low"]), _percent(record["share_high"])
    return {
        "Yield": f"{_percent(record['share'])}, with 95 % confidence {low} to {high}",
        "Wanted": record.get("wanted") or f"{record['from']} to {record['to']} by the program",
        "Made": f"{record['samples']} mechanisms with {_tolerances(record['tolerances'])}",
        "Critical": _critical(record.get("critical"), names),
    }


def _percent(share: float) -> str:
    """A share, with digits enough that 99.99 % is not printed as certain."""
    return f"{share * 100:.{2 if 0.01 < share < 0.99 else 4}f} %".replace(".0000 %", " %")


def _tolerances(given: dict[str, float]) -> str:
    told = [f"{q.head}{number(given[q.key])} {q.sign}" for q in TOLERANCES if given[q.key]]
    return ", ".join(told) or "no tolerance"


def _critical(pair: dict[str, Any] | None, names: list[str]) -> str:
    if pair is None:
        return ""
    first, second = names[pair["first"]], names[pair["second"]]
    return (
        f"{first} before {second} while {pair['while']}: in the other order in "
        f"{_percent(pair['share'])}"
    )
