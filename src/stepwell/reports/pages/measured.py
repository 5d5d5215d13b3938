"""Pages of measured data: what was read, how stiff bands are, and whether the model holds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from stepwell.base import Column, Quantity, counted, number, percent
from stepwell.reports.pages import parts

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_SAID = "Used, dropped and odd"


def readings_page(record: Mapping[str, Any], columns: Sequence[Any]) -> str:
    """The page of recordings.

    Args:
        record: what `stepwell lab read` found.
        columns: of the table of recordings.

    Returns:
        HTML text.
    """
    rows, refused = record["recordings"], record["refused"]
    odd = [f"{row['source']}: {line}" for row in rows for line in row["odd"]]
    count = sum(row["samples"] for row in rows)
    return parts.page(
        "Recordings",
        f"{counted(len(rows) + len(refused), 'file')} tried.",
        f"{counted(len(rows), 'recording')} read",
        [f"{counted(count, 'sample')} in all; {len(refused)} could not be read."],
        {},
        [
            parts.part("What they hold", parts.table(columns, rows, "A row a recording.")),
            parts.part("Odd", parts.listed(odd)),
            parts.part(
                "Not read", parts.listed(f"{one['source']}: {one['problem']}" for one in refused)
            ),
        ],
    )


def band_page(
    record: Mapping[str, Any], drawn: Mapping[str, Figure], narrow: Mapping[str, Figure]
) -> str:
    """The page of tension tests.

    Args:
        record: what `lab.band_record` returns.
        drawn, narrow: figures by caption, on a wide window and on a phone.

    Returns:
        HTML text.
    """
    low, high = record["window_mm"]
    k, loss, alone = record["stiffness_N_per_m"], record["loss_used"], record["this_band"]
    tried = _thousandths("one left out [mN]", "predicts_N")
    if record["left_out"] == "nothing":
        tried = Column("criterion above best", lambda one: number(one["above_best"], 3), True)
    laws = [
        Column("law", lambda one: one["law"] + " (chosen)" * (one["law"] == record["law_chosen"])),
        Quantity("numbers", head="numbers", left=False),
        _thousandths("leaves [mN]", "leaves_N"),
        tried,
    ]
    numbers = {
        "Mean of bands, 95 %": _between(k, "low", "high") if k["low"] is not None else "",
        "Law chosen": record["law_chosen"],
    }
    for name, key, unit in (
        ("Rest length, 95 %", "rest_length_mm", "mm"),
        ("This band, 95 %", "stiffness_N_per_m", "N/m"),
    ):
        found = alone and alone[key]
        if found and found["low"] is not None:
            numbers = {name: _between(found, "low", "high", unit)} | numbers
    return parts.page(
        "Stiffness of bands",
        f"Loading, {low:.5g} to {high:.5g} mm, cycles {record['cycles'][0]} to "
        f"{record['cycles'][1]}.",
        f"{number(k['value'])} N/m",
        [
            f"One more band is to be expected {_between(k, 'next_low', 'next_high')}, with 95 % "
            f"confidence."
            if k["next_low"] is not None
            else "One sample shows no scatter, so nothing is said of the next band.",
            f"A cycle loses {percent(loss['value'])} of the work." if loss else "",
            parts.sentence(record["law_told"]),
        ],
        numbers,
        [
            parts.part(
                "Force laws",
                parts.pictures(drawn, narrow),
                parts.table(
                    laws,
                    record["laws"],
                    "What each law leaves of the force, and what it predicts of samples left out.",
                ),
            ),
            parts.part("For a design file", parts.verbatim(record["table"].rstrip(), "Band table")),
            parts.part(_SAID, parts.listed([*record["told"], record["rest_length_told"]])),
        ],
        parts.warned("Not one kind of band.", "", record["warnings"]),
    )


def comparison_page(
    record: Mapping[str, Any],
    cells: Sequence[Any],
    pairs: Sequence[Any],
    drawn: Mapping[str, Figure],
    narrow: Mapping[str, Figure],
) -> str:
    """The page of measured against model, its verdicts first.

    Args:
        record: what `lab.comparison_record` returns.
        cells, pairs: columns of the tables of unit cells and of pairs.
        drawn, narrow: figures by caption, on a wide window and on a phone.

    Returns:
        HTML text.
    """
    series = record["series"]
    told = {kind: [row for row in series if row["kind"] == kind] for kind in ("cell", "pair")}
    means = "; ".join(
        f"{one['rmse_over_kr']:.3f} k r with {counted(one['bands'], 'band')}"
        for one in record["mean_rmse_over_kr"]
    )
    ordered = [row for row in told["pair"] if not row["order_tie"]]
    right = sum(row["order_shown"] == row["order_predicted"] for row in ordered)
    return parts.page(
        "Measured against model",
        f"{counted(len(told['cell']), 'unit cell')} and {counted(len(told['pair']), 'pair')}.",
        f"{right} of {counted(len(ordered), 'pair')} in the order predicted"
        if ordered
        else f"Unit cells are off by {means}",
        [f"On average the force of unit cells is off by {means}." if means and ordered else ""],
        {},
        [
            parts.part(
                "Verdicts", parts.listed(f"{row['series']}: {row['verdict']}" for row in series)
            ),
            parts.part("Curves", parts.pictures(drawn, narrow)),
            parts.part(
                "Unit cells",
                parts.table(cells, told["cell"], "Measured (model); errors in k r and k r²."),
            ),
            parts.part(
                "Pairs",
                parts.table(
                    pairs, told["pair"], "Errors in k r; ratio of the errors against both orders."
                ),
            ),
            parts.part(
                _SAID,
                parts.listed(
                    [
                        *(f"{row['series']}: {line}" for row in series for line in row["told"]),
                        *record["told"],
                    ]
                ),
            ),
        ],
    )


def calibration_page(
    record: Mapping[str, Any],
    numbers: Sequence[Any],
    errors: Sequence[Any],
    snaps: Sequence[Any],
    drawn: Mapping[str, Figure],
    narrow: Mapping[str, Figure],
) -> str:
    """The page of a calibration.

    Args:
        record: what `stepwell lab calibrate` found.
        numbers, errors, snaps: columns of the tables of numbers, of errors and of snaps.
        drawn, narrow: figures by caption, on a wide window and on a phone.

    Returns:
        HTML text.
    """
    tied = ", ".join(f"{a} and {b} ({c:+.2f})" for a, b, c in record["not_told_apart"])
    return parts.page(
        "Bands calibrated on cells",
        f"Law: {record['law']}, k = {number(record['k_N_per_m'])} N/m a band.",
        record["summary"][0],
        [
            *record["summary"],
            f"The data do not tell apart {tied}." if tied else "",
            *(f"Not told: {line}." for line in record["open"]),
        ],
        {},
        [
            parts.part("Fitted and measured", parts.pictures(drawn, narrow)),
            parts.part(
                "Numbers",
                parts.table(
                    numbers,
                    record["parameters"],
                    "With their 95 % intervals, by leaving out a geometry at a time.",
                ),
            ),
            *_of_snaps(record, snaps),
            parts.part(
                "Errors", parts.table(errors, record["errors"], "Root mean squares in k r.")
            ),
            parts.part("For a design file", parts.verbatim(record["table"].rstrip(), "Band table")),
            parts.part(_SAID, parts.listed(record["told"])),
        ],
    )


def _of_snaps(record: Mapping[str, Any], snaps: Sequence[Any]) -> list[str]:
    keys = ("measured_mm", "plain_mm", "left_out_mm")
    rows = [one for one in record["snaps"] if any(one[key] is not None for key in keys)]
    told = "First snaps, seen and predicted; no snap has a part in a fit."
    return [parts.part("Snaps", parts.table(snaps, rows, told))] if rows else []


def _between(estimate: Mapping[str, Any], low: str, high: str, unit: str = "N/m") -> str:
    return f"{estimate[low]:.4g} to {estimate[high]:.4g} {unit}"


def _thousandths(heading: str, key: str) -> Column:
    return Column(heading, lambda one: number(one[key] * 1e3, 3), True)
