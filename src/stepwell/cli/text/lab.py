"""The results of `stepwell lab` as people read them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from pathlib import PurePath
from typing import Any

from stepwell.base import Column, Quantity, number, record
from stepwell.cli.screen import show_lines, show_records, show_table, show_verbatim
from stepwell.lab import CELL_TEST, ERROR, PAIR_TEST, PARAMETER, RIG, SNAP, SUMMARY, Rig

# More turning points of a stroke than this are not listed.
_MOST_POINTS = 6
_AS_DRAWN = record(RIG, Rig())


def readings(record: dict[str, Any]) -> None:
    """Print what `stepwell lab read` found."""
    rows = record["recordings"]
    source, samples, rate, speed, *_, direction, halves, _, _ = SUMMARY
    columns = [
        source,
        samples,
        rate,
        speed,
        Column("stroke [mm]", _strokes, True),
        _between("force [N]", "force_least_N", "force_most_N"),
        direction,
        halves,
    ]
    show_records("Recordings", columns, rows, most=None)
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
    count = sum(row["samples"] for row in rows)
    show_lines(
        "",
        f"Recordings: {len(rows)}. Samples: {count}. Odd: {len(odd)}. "
        f"Not read: {len(record['refused'])}.",
    )


def band(record: dict[str, Any]) -> None:
    """Print what `lab.band_record` returns."""
    low, high = record["window_mm"]
    k, loss, alone = record["stiffness_N_per_m"], record["loss_used"], record["this_band"]
    first, last = record["cycles"]
    show_lines(*(f"Warning: {line}" for line in record["warnings"]))
    show_lines(
        f"Stiffness {number(k['value'])} N/m, loading, {low:.5g} to {high:.5g} mm, cycles "
        f"{first} to {last}",
    )
    if alone is not None:
        show_lines(f"  this band, 95 %:      {_of_one(alone['stiffness_N_per_m'], 'N/m')}")
        if (length := alone["rest_length_mm"]) is not None:
            told = f"{number(length['value'])} mm, 95 %: {_of_one(length, 'mm')}"
            show_lines(f"  its rest length:      {told}")
    show_lines(
        f"  mean of bands, 95 %:  {_interval(k, 'low', 'high')}",
        f"  one more band, 95 %:  {_interval(k, 'next_low', 'next_high')}",
        f"  by sample:            {_each(k)}",
    )
    if loss is not None:
        each = _each(loss, ".1%")
        show_lines(f"Work lost in a cycle    {loss['value']:.1%}, by sample {each}")
    show_lines(
        "Intervals are Student's, from the scatter between samples, taken as independent and "
        "normal; cycles of one sample are no samples."
        if alone is None
        else "Intervals are Student's, from the scatter of the readings around the law and the "
        "digits they are told in.",
        "",
        "Used and dropped",
        *record["told"],
    )
    _windows(record)
    columns = [
        Column("law", lambda law: law["law"] + " (chosen)" * (law["law"] == record["law_chosen"])),
        Quantity("numbers", head="numbers", left=False),
        _thousandths("leaves [mN]", "leaves_N"),
        _tried(record),
        Column("values", _values),
    ]
    show_records("Force laws, fewest numbers first", columns, record["laws"], most=None)
    show_lines(
        "",
        record["law_told"],
        record["rest_length_told"],
        "",
        "For a design file:",
    )
    show_verbatim(record["table"].rstrip())


def comparison(record: dict[str, Any]) -> None:
    """Print what `lab.comparison_record` returns."""
    cells = [row for row in record["series"] if row["kind"] == "cell"]
    pairs = [row for row in record["series"] if row["kind"] == "pair"]
    if cells:
        title = "Unit cells: measured (model); errors in k r and k r²"
        show_records(title, CELL_TEST, cells, most=None)
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
        show_lines(
            *(rising or [f"F falls throughout in every series, to {record['rise_over_kr']:g} k r."])
        )
    if pairs:
        title = "Pairs: errors in k r; ratio of the errors against the two orders"
        columns = [
            Column(q.head, lambda pair, q=q: "a tie" if pair["order_tie"] else q.cell(pair))
            if q.name == "order_predicted"
            else q
            for q in PAIR_TEST
        ]
        show_records(title, columns, pairs, most=None)
    show_lines("", "Verdicts", *(f"{row['series']}: {row['verdict']}" for row in record["series"]))
    if pairs and record["rig"] != _AS_DRAWN:
        show_lines("", _moved_by(record["rig"]))
    show_lines("", "Used, dropped and odd")
    for row in record["series"]:
        show_lines(*(f"{row['series']}: {line}" for line in row["told"]))
    show_lines(*record["told"])
    show_lines(
        "",
        record["not_judged"],
    )


def _moved_by(rig: dict[str, Any]) -> str:
    """The rig that moves predicted snaps to what the machine shows."""
    return (
        f"Predicted where the machine shows it: travels {rig['stretch']:.4g} times as drawn, "
        f"{rig['start_loading_mm']:+.2f} mm before loading, {rig['start_unloading_mm']:+.2f} mm "
        f"before unloading; the rig gives way by {rig['compliance_mm_per_N']:.2g} mm/N, with "
        f"{rig['friction_N']:.2g} N of its own friction."
    )


def calibration(record: dict[str, Any]) -> None:
    """Print what `stepwell lab calibrate` found."""
    show_lines(*record["summary"])
    name, unit, *numbers = PARAMETER
    show_records(
        f"Law: {record['law']}. Each number with its 95 % interval, by leaving out a geometry",
        [name, *numbers, unit],
        record["parameters"],
        most=None,
    )
    series, *strokes = (q for q in SNAP if q.head)
    snapping = [
        one
        for one in record["snaps"]
        if one["measured_mm"] is not None or one["plain_mm"] is not None
    ]
    if snapping:
        show_records("First snaps [mm]", [series, *strokes], snapping, most=None)
    title = f"RMSE in k r, k = {number(record['k_N_per_m'])} N/m a band"
    show_records(title, ERROR, record["errors"], most=None)
    tied = [f"{a} and {b} ({c:+.2f})" for a, b, c in record["not_told_apart"]]
    told = f"Not told apart by the data: {', '.join(tied)}." if tied else "No two are tied."
    show_lines(
        "",
        "Intervals are of the jackknife over geometries, taken as independent; samples along a "
        "stroke are not.",
        told,
        *(f"Not told: {line}." for line in record["open"]),
        "",
        "For a design file:",
    )
    show_verbatim(record["table"].rstrip())
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


def _of_one(interval: dict[str, Any], unit: str) -> str:
    if interval["low"] is None:
        return "not known: too few readings"
    return f"{interval['low']:.4g} to {interval['high']:.4g} {unit}"


def _tried(record: dict[str, Any]) -> Column:
    """How laws did on what was left out; on one curve, by the criterion that chose."""
    if record["left_out"] == "nothing":
        return Column("criterion above best", lambda law: number(law["above_best"], 3), True)
    return _thousandths(f"{record['left_out']} left out [mN]", "predicts_N")


def _each(estimate: dict[str, Any], form: str = ".4g") -> str:
    return ", ".join(f"{sample}: {value:{form}}" for sample, value in estimate["each"].items())


def _values(law: Any) -> str:
    def value(name: str, estimate: dict[str, Any]) -> str:
        if name in law["at_bound"]:
            return f"{name} not told by the data"
        spread = "" if estimate["spread"] is None else f" ± {estimate['spread']:.2g}"
        return f"{name} {estimate['value']:.4g}{spread}"

    return "; ".join(value(name, estimate) for name, estimate in law["values"].items())


def _strokes(row: Mapping[str, Any]) -> str:
    """Where the stroke began, turned and ended; of many turns the first two and the last."""
    points = [number(row["stroke_from_mm"]), *map(number, row["turns_mm"])]
    points.append(number(row["stroke_to_mm"]))
    if len(points) > _MOST_POINTS:
        points = [*points[:3], "...", *points[-2:]]
    return " to ".join(points)


def _between(heading: str, low: str, high: str) -> Column:
    return Column(heading, lambda row: f"{number(row[low])} to {number(row[high])}", True)


def _thousandths(heading: str, key: str) -> Column:
    return Column(heading, lambda law: number(law[key] * 1e3, 3), True)


def _bands(count: int) -> str:
    return "1 band" if count == 1 else f"{count} bands"
