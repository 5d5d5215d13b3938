"""A calibration: one model of bands and rig fitted to all cells, and how well it predicts."""

import math
from collections.abc import Sequence
from typing import Any

from stepwell.accounts import parts
from stepwell.accounts.head import About
from stepwell.base import Quantity, Schema, counted, number, quantities, rows_of
from stepwell.lab import Calibration, calibrated_table

_MM = Quantity("stroke", "mm").factor

_PARAMETER: Schema = (
    Quantity("name", head="parameter"),
    Quantity("value", head="value", left=False, holds=float),
    Quantity("low", head="from", left=False, holds=float),
    Quantity("high", head="to", left=False, holds=float),
    Quantity("unit", head="unit"),
)
_WEIGHING: Schema = (
    Quantity("weight", "N"),
    Quantity("weight_doubt", "N", read="doubt"),
    Quantity("machine_friction", "N", read="friction"),
    Quantity("loading_and_unloading", read="both", holds=bool),
)
_SNAP: Schema = (
    Quantity("series", head="series"),
    Quantity("measured", "mm", "seen", form=".2f", none="none"),
    *quantities(spread="mm", reached="mm"),
    Quantity("plain", "mm", "no fit", form=".2f", none="none"),
    Quantity("fitted", "mm", "own curves", form=".2f", none="none"),
    Quantity("left_out", "mm", "left out", form=".2f", none="none"),
    Quantity("doubt", "mm", "±", form=".2f", none="none"),
    *quantities(covered=bool | None, order_seen=[str]),
    Quantity("order_predicted", holds=[str], read="order"),
    Quantity("order_error_ratio", holds=float, read="ratio"),
)
_SNAP_ERRORS: Schema = tuple(
    Quantity(name, holds=float, read=lambda found, name=name: found.snap_error(name))
    for name in ("plain", "fitted", "left_out")
)
_INTERVALS: Schema = (
    Quantity("of", holds=int, read=lambda coverage: coverage[1]),
    Quantity("hold", holds=int, read=lambda coverage: coverage[0]),
)
_ERROR: Schema = (
    Quantity("series", head="series", read="sample.name"),
    Quantity(
        "d",
        "mm",
        "d",
        "sample.geometry",
        lambda d: f"({d[0]:g}, {d[1]:g})",
        left=True,
        holds=[float],
    ),
    Quantity("bands", holds=int, read="sample.bands"),
    Quantity("in_pair", holds=bool, read="sample.in_pair"),
    Quantity("fit", "over_kr", "fit", form=".3f"),
    Quantity("left_out", "over_kr", "left out", form=".3f"),
)
_MEAN: Schema = quantities(bands=int, in_pair=bool, fit="over_kr", left_out="over_kr")
_CORRELATED: Schema = quantities(parameter=str, other=str, correlation=float)


def _errors(found: Calibration) -> Sequence[parts.Row]:
    """The errors of each cell in a series, fitted and left out [k r]."""
    fit, left_out = found.fit_error, found.left_out_error
    return rows_of({"sample": found.samples, "fit": fit, "left_out": left_out})


def _means(found: Calibration) -> Sequence[parts.Row]:
    """The mean errors of the cells with so many bands [k r]."""
    return [
        {
            "bands": bands,
            "in_pair": pair,
            "fit": found.mean_error(bands, pair, left_out=False),
            "left_out": found.mean_error(bands, pair),
        }
        for bands, pair in found.kinds
    ]


def _correlations(found: Calibration) -> dict[str, dict[str, float]]:
    names = list(found.values)
    rows = zip(names, found.correlations.tolist(), strict=True)
    return {name: dict(zip(names, row, strict=True)) for name, row in rows}


def summary(found: Calibration) -> list[str]:
    """How well a calibration predicts, a sentence each."""
    lines = [
        f"{'Pairs' if one['in_pair'] else 'Cells'} with {counted(one['bands'], 'band')}: force "
        f"within {one['fit']:.3f} k r fitted, {one['left_out']:.3f} predicted from the "
        "other geometries."
        for one in _means(found)
    ]
    if found.snaps:
        right, of = found.orders
        lines.append(f"Orders predicted from the other geometries: {right} of {of} as seen.")
    plain, fitted, left_out = (one.of(found) * _MM for one in _SNAP_ERRORS)
    if not math.isnan(left_out):
        held, of = found.coverage
        lines.append(
            f"Snaps, none of them fitted, are missed by {left_out:.2f} mm in the mean "
            f"from the other geometries, by {fitted:.2f} mm from a pair's own curves, by "
            f"{plain:.2f} mm without a fit; 90 % intervals hold {held} of {of}."
        )
    if (weighing := found.weighing) is not None:
        machine = f"; friction of the machine {weighing.friction:.3f} N" if weighing.both else ""
        lines.append(f"The block between two cells weighs {weighing.weight:.3f} N{machine}.")
    return lines


# What is reported of a calibration.
CALIBRATE: Schema = (
    Quantity("data_sha256", holds={str: str}),
    Quantity("summary", holds=[str], read=summary),
    Quantity("law"),
    Quantity("k", "N/m", read="reference"),
    Quantity("parameters", holds=[_PARAMETER]),
    Quantity("weighing", holds=_WEIGHING, missing=True),
    *quantities(compliance="mm/N", scatter="percent", snaps=[_SNAP]),
    Quantity("snap_errors", "mm", holds=_SNAP_ERRORS, read=lambda found: found),
    Quantity("intervals_that_hold", holds=_INTERVALS, read="coverage"),
    Quantity("orders_right", holds=[int], read="orders"),
    Quantity("errors", holds=[_ERROR], read=_errors),
    Quantity("mean_errors", holds=[_MEAN], read=_means),
    Quantity("correlations", holds={str: {str: float}}, read=_correlations),
    Quantity("not_told_apart", holds=[_CORRELATED], read="tied"),
    Quantity("open", holds=[str]),
    Quantity("told", holds=[str], read="notes"),
    Quantity("table"),
)


def calibration_account(found: Calibration, about: About) -> parts.Account:
    """What is reported of a calibration."""
    answer, *rest = summary(found)
    table = calibrated_table(found, about.source or "")
    return parts.Account(
        found,
        title="Bands calibrated on cells",
        kind="lab.calibrate/2",
        schema=CALIBRATE,
        answer=answer,
        given={"data_sha256": about.data_sha256, "table": table},
        facts=(
            parts.Fact("Force law", found.law),
            parts.Fact("Unit of errors", f"k r, with k = {number(found.reference)} N/m a band"),
        ),
        sections=(
            parts.Section("Predictions", parts.Notes(rest, parts.Level.CARD)),
            parts.Section(
                "Parameters, each with its 95 % interval by leaving out a geometry",
                parts.RecordTable(
                    _PARAMETER, "parameters", most=None, more="parameters", level=parts.Level.CARD
                ),
            ),
            parts.Section(
                "First snaps",
                parts.RecordTable(
                    _SNAP,
                    "snaps",
                    "Seen and predicted; no snap has a part in a fit.",
                    most=None,
                    pick=lambda rows: [one for one in rows if _snaps(one)],
                ),
            ),
            parts.Section(
                "Root mean square errors in k r",
                parts.Picture("calibration", "Fitted and measured forces"),
                parts.RecordTable(_ERROR, "errors", most=None, more="curves"),
            ),
            parts.Section("Correlated parameters", parts.Text(_correlated(found))),
            parts.Section("Not identified by these recordings", parts.Notes(found.open)),
            parts.Section("For a design file", parts.Verbatim(table.rstrip(), "Band table")),
            parts.Section("Used, dropped and odd", parts.Notes(found.notes)),
            parts.Section(
                "Assumptions",
                parts.Text(
                    "Intervals are those of the jackknife over geometries, taken as "
                    "independent; samples along a stroke are not independent."
                ),
            ),
        ),
    )


def _snaps(row: dict[str, Any]) -> bool:
    """Whether there is a snap, seen or predicted."""
    return any(row[f"{name}_mm"] is not None for name in ("measured", "plain", "left_out"))


def _correlated(found: Calibration) -> str:
    each = ", ".join(
        f"{one.parameter} and {one.other} ({one.correlation:+.2f})" for one in found.tied
    )
    if not each:
        return "The data identify each parameter by itself."
    return f"The data do not identify these parameters separately: {each}."
