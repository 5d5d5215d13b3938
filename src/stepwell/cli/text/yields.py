"""The result of `stepwell yield` as people read it."""

from typing import Any

from stepwell.base import Column, number
from stepwell.cli.screen import show_facts, show_lines, show_records, show_text
from stepwell.results import SENSITIVITY, TOLERANCES

MOST_ROWS = 12


def show(record: dict[str, Any]) -> None:
    """Print what `results.yield_record` or `results.survival_record` returns."""
    show_facts(record, {}, 10)
    show_lines(*lines(record, record["cells"]))
    if "outcomes" not in record:
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
    show_text(record["assumptions"])


def lines(record: dict[str, Any], names: list[str]) -> list[str]:
    """Share, tolerances and critical pair of a yield."""
    low, high = percent(record["share_low"]), percent(record["share_high"])
    found = {
        "Yield": f"{percent(record['share'])}, with 95 % confidence {low} to {high}",
        "Wanted": record.get("wanted") or f"{record['from']} to {record['to']} by the program",
        "Made": f"{record['samples']} mechanisms with {_tolerances(record['tolerances'])}",
        "Critical": _critical(record.get("critical"), names),
    }
    return [f"{name:<10}{value}" for name, value in found.items() if value]


def percent(share: float) -> str:
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
        f"{percent(pair['share'])}"
    )
