"""The result of `stepwell yield` as people read it."""

from typing import Any

from stepwell.cli.screen import number, show_lines, show_table, show_text

MOST_ROWS = 12


def show(record: dict[str, Any]) -> None:
    """Print what `results.yield_record` or `results.survival_record` returns."""
    title = [record["title"], ""] if record["title"] else []
    show_lines(*title, *lines(record, record["cells"]))
    if "outcomes" not in record:
        show_text(record["assumptions"])
        return
    if record["advice"]:
        show_text(record["advice"])
    outcomes = record["outcomes"]
    if outcomes:
        show_table(
            "What the others do",
            ["outcome", "share"],
            [[one["outcome"], percent(one["count"] / record["samples"])] for one in outcomes][
                :MOST_ROWS
            ],
            hidden=len(outcomes) - MOST_ROWS,
        )
    _sensitivities(record)
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
    known = {
        "anchors ±{} mm": given["anchor_mm"],
        "stiffness ±{} %": given["stiffness_percent"],
        "rest length ±{} %": given["rest_length_percent"],
        "levers ±{} mm": given["lever_mm"],
        "friction up to {} N": given["friction_N"],
    }
    told = [text.format(number(value)) for text, value in known.items() if value]
    return ", ".join(told) or "no tolerance"


def _critical(pair: dict[str, Any] | None, names: list[str]) -> str:
    if pair is None:
        return ""
    first, second = names[pair["first"]], names[pair["second"]]
    return (
        f"{first} before {second} while {pair['while']}: in the other order in "
        f"{percent(pair['share'])}"
    )


def _sensitivities(record: dict[str, Any]) -> None:
    table = record["sensitivities"]
    if table is None:
        return
    rows = sorted(table, key=lambda one: -one["total"])
    show_table(
        "Share of the variance of the smallest gap that a part makes, alone and with others",
        ["part", "alone", "with others"],
        [[one["part"], *(_share(one[key]) for key in ("first_order", "total"))] for one in rows][
            :MOST_ROWS
        ],
        hidden=len(rows) - MOST_ROWS,
    )
    if record["gap_agreement"] is not None:
        show_lines(f"The gap tells what the engine finds in {percent(record['gap_agreement'])}")


def _share(value: float) -> str:
    # An estimate may fall a little below zero.
    return f"{max(0.0, value):.2f}"
