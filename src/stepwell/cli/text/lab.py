"""The results of `stepwell lab` as people read them."""

from __future__ import annotations

from collections import Counter
from pathlib import PurePath
from typing import Any

from stepwell.cli.screen import number, show_lines, show_table

MOST_WINDOWS = 12


def readings(record: dict[str, Any]) -> None:
    """Print what `stepwell lab read` found."""
    rows = record["recordings"]
    if rows:
        show_table(
            "Recordings",
            ["file", "samples", "Hz", "mm/s", "stroke [mm]", "force [N]", "direction", "halves"],
            [
                [
                    row["source"],
                    str(row["samples"]),
                    number(row["rate_Hz"]),
                    number(row["speed_mm_s"], 3),
                    f"{number(row['stroke_from_mm'])} to {number(row['stroke_to_mm'])}",
                    f"{number(row['force_least_N'])} to {number(row['force_most_N'])}",
                    row["direction"],
                    str(row["halves"]),
                ]
                for row in rows
            ],
            left=(0, 6),
        )
    odd = [f"{row['source']}: {line}" for row in rows for line in row["odd"]]
    if odd:
        show_lines("", "Odd", *odd)
    if record["refused"]:
        show_lines("", "Not read", *(f"{r['source']}: {r['problem']}" for r in record["refused"]))
    if record["ignored"]:
        endings = Counter(
            PurePath(name).suffix or PurePath(name).name for name in record["ignored"]
        )
        told = ", ".join(f"{count} {ending}" for ending, count in sorted(endings.items()))
        show_lines("", f"Not tried, name them to try them: {told}.")
    samples = sum(row["samples"] for row in rows)
    show_lines(
        "",
        f"Recordings: {len(rows)}. Samples: {samples}. Odd: {len(odd)}. "
        f"Not read: {len(record['refused'])}.",
    )


def band(record: dict[str, Any]) -> None:
    """Print what `lab.band_record` returns."""
    low, high = record["window_mm"]
    k, loss = record["stiffness_N_per_m"], record["loss_used"]
    show_lines(
        f"Stiffness {k['value']:.3f} N/m, loading, {low:g} to {high:g} mm, cycles "
        f"{record['cycles'][0]} to {record['cycles'][1]}",
        f"  mean of such bands, 95 %:  {_interval(k, 'low', 'high')}",
        f"  one more band, 95 %:       {_interval(k, 'next_low', 'next_high')}",
        f"  by sample:                 {_each(k)}",
    )
    if loss is not None:
        each = _each(loss, ".1%")
        show_lines(f"Work lost in a cycle         {loss['value']:.1%}, by sample {each}")
    show_lines(
        "Intervals are Student's, from the scatter between samples, taken as independent and "
        "normal; cycles of one sample are no samples.",
        "",
        "Used and dropped",
        *record["told"],
    )
    _windows(record)
    show_table(
        "Force laws, fewest numbers first",
        ["law", "numbers", "leaves [mN]", f"{record['left_out']} left out [mN]", "values"],
        [
            [
                law["law"] + (" (chosen)" if law["law"] == record["law_chosen"] else ""),
                str(law["numbers"]),
                number(law["leaves_N"] * 1e3, 3),
                number(law["predicts_N"] * 1e3, 3),
                "; ".join(_value(name, v, law["at_bound"]) for name, v in law["values"].items()),
            ]
            for law in record["laws"]
        ],
        left=(0, 4),
    )
    show_lines(
        "",
        record["law_told"],
        record["rest_length_told"],
        "",
        "For a design file:",
        record["table"].rstrip(),
    )


def comparison(record: dict[str, Any]) -> None:
    """Print what `lab.comparison_record` returns."""
    cells = [row for row in record["series"] if row["kind"] == "cell"]
    pairs = [row for row in record["series"] if row["kind"] == "pair"]
    if cells:
        head = ["series", "RMSE", "bar corr.", "max", "E RMSE", "F0 [N]", "F1 [N]", "barrier [mJ]"]
        show_table(
            "Unit cells: measured (model); errors in k r and k r²",
            head,
            [
                [
                    row["series"],
                    f"{row['rmse_over_kr']:.3f}",
                    f"{row['rmse_bar_corrected_over_kr']:.3f}",
                    f"{row['max_over_kr']:.3f}",
                    f"{row['rmse_energy_over_kr2']:.3f}",
                    *(_both(row[name]) for name in ("F0_N", "F1_N", "barrier_mJ")),
                ]
                for row in cells
            ],
        )
        means = ", ".join(
            f"{mean['rmse_over_kr']:.3f} with {_bands(mean['bands'])}"
            for mean in record["mean_rmse_over_kr"]
        )
        show_lines("", f"Mean RMSE over the geometries in k r: {means}.")
        rising = [
            f"{row['series']}: F rises by {rise['by_N']:.2g} N from {rise['from_mm']:.4g} to "
            f"{rise['to_mm']:.4g} mm"
            for row in cells
            for rise in row["rises"]
        ]
        show_lines(*(rising or ["F falls throughout in every series, to 0.005 k r."]))
    if pairs:
        show_table(
            "Pairs: errors in k r; ratio of the errors against the two orders",
            ["series", "RMSE", "bar corr.", "max", "order shown", "model", "ratio"],
            [
                [
                    row["series"],
                    f"{row['rmse_over_kr']:.3f}",
                    f"{row['rmse_bar_corrected_over_kr']:.3f}",
                    f"{row['max_over_kr']:.3f}",
                    " then ".join(row["order_shown"]),
                    "a tie" if row["order_tie"] else " then ".join(row["order_predicted"]),
                    f"{row['order_error_ratio']:.1f}",
                ]
                for row in pairs
            ],
            left=(0, 4, 5),
        )
    show_lines("", "Verdicts", *(f"{row['series']}: {row['verdict']}" for row in record["series"]))
    show_lines("", "Used, dropped and odd")
    for row in record["series"]:
        show_lines(*(f"{row['series']}: {line}" for line in row["told"]))
    show_lines(*record["told"])
    show_lines(
        "",
        "Not judged: the first 0.5 mm of stroke, the last 0.25 mm, and in pairs from 0.5 mm before "
        "to 2 mm after the next cell takes over. Which cell moves first in a baseline of two cells "
        "is not recorded: the reading that fits all series better is taken.",
    )


def calibration(record: dict[str, Any]) -> None:
    """Print what `stepwell lab calibrate` found."""
    show_table(
        f"{record['law']} law: each number with its 95 % interval, by leaving out a geometry",
        ["number", "value", "from", "to", "unit"],
        [
            [p["name"], *(number(p[key]) for key in ("value", "low", "high")), p["unit"]]
            for p in record["parameters"]
        ],
        left=(0, 4),
    )
    show_table(
        f"RMSE in k r, k = {number(record['k_N_per_m'])} N/m a band",
        ["series", "d [mm]", "fit", "left out"],
        [
            [
                row["series"],
                f"({row['d_mm'][0]:g}, {row['d_mm'][1]:g})",
                f"{row['fit_over_kr']:.3f}",
                f"{row['left_out_over_kr']:.3f}",
            ]
            for row in record["errors"]
        ],
        left=(0, 1),
    )
    for mean in record["mean_errors"]:
        show_lines(
            f"Mean over the geometries, {_bands(mean['bands'])}: {mean['fit_over_kr']:.3f} fitted, "
            f"{mean['left_out_over_kr']:.3f} left out."
        )
    names = list(record["correlations"])
    show_table(
        "Correlations",
        ["", *names],
        [[a, *(f"{record['correlations'][a][b]:+.2f}" for b in names)] for a in names],
    )
    tied = [f"{a} and {b} ({c:+.2f})" for a, b, c in record["not_told_apart"]]
    told = f"Not told apart by the data: {', '.join(tied)}." if tied else "No two are tied."
    show_lines(
        "",
        "Intervals are of the jackknife over geometries, taken as independent; samples along a "
        "stroke are not.",
    )
    show_lines(told, "", "For a design file:", record["table"].rstrip())
    show_lines("", "Used, dropped and odd", *record["told"])


def _windows(record: dict[str, Any]) -> None:
    rows = sorted({w["from_mm"] for w in record["windows"]})
    columns = sorted({w["to_mm"] for w in record["windows"]})
    value = {(w["from_mm"], w["to_mm"]): w["k_N_per_m"] for w in record["windows"]}
    show_table(
        "Stiffness [N/m] by window: from (down) and to (across) [mm]",
        ["", *(number(high) for high in columns)],
        [[number(low), *(number(value.get((low, high))) for high in columns)] for low in rows],
        left=(),
    )


def _interval(estimate: dict[str, Any], low: str, high: str) -> str:
    if estimate[low] is None:
        return "not known: one sample shows no scatter between samples"
    return f"{estimate[low]:.4g} to {estimate[high]:.4g} N/m"


def _each(estimate: dict[str, Any], form: str = ".4g") -> str:
    return ", ".join(f"{sample}: {value:{form}}" for sample, value in estimate["each"].items())


def _value(name: str, estimate: dict[str, Any], at_bound: list[str]) -> str:
    if name in at_bound:
        return f"{name} not told by the data"
    spread = estimate["spread"]
    return f"{name} {estimate['value']:.4g}" + ("" if spread is None else f" ± {spread:.2g}")


def _both(values: dict[str, float]) -> str:
    return f"{values['measured']:.3f} ({values['model']:.3f})"


def _bands(count: int) -> str:
    return "1 band" if count == 1 else f"{count} bands"
