"""A calibration: one model of bands and rig fitted to all cells, and its prediction errors."""

import math
from collections.abc import Sequence
from operator import itemgetter

import numpy as np

from stepwell import base
from stepwell.accounts import parts
from stepwell.accounts.head import About, Row, keys
from stepwell.accounts.parts import CARD, FULL, Account, Fact, Notes, RecordTable, Text
from stepwell.accounts.words import folded_notes
from stepwell.base import Column, Quantity, Schema, counted, headed, number, rows_of
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
    *keys(weight="N", weight_doubt=("N", "doubt"), machine_friction=("N", "friction")),
    *keys(loading_and_unloading=(bool, "both")),
)
_SNAP_ERRORS: Schema = tuple(
    Quantity(name, holds=float, read=lambda model, name=name: model.snap_error(name))
    for name in ("plain", "fitted", "left_out")
)
_INTERVALS = keys(of=(int, itemgetter(1)), hold=(int, itemgetter(0)))
_PLACE = Quantity(
    "d", "mm", "d", "sample.geometry", lambda d: f"({d[0]:g}, {d[1]:g})", left=True, holds=[float]
)
_ERROR: Schema = (
    Quantity("series", head="series", read="sample.name"),
    _PLACE,
    *keys(bands=(int, "sample.bands"), in_pair=(bool, "sample.in_pair")),
    Quantity("fit", "over_kr", "fit", form=".3f"),
    Quantity("left_out", "over_kr", "left out", form=".3f"),
)
_TENSION: Schema = (
    *keys(rubber=str, known=bool),
    Quantity("width", "percent"),
    Quantity("length", "mm", holds=[float], read=lambda one: one.length.tolist()),
    *(
        Quantity(name, "N", holds=[float], read=lambda one, name=name: getattr(one, name).tolist())
        for name in ("tension", "low", "high")
    ),
)
_FEW = 3  # rows of the table of tensions
_MEAN = keys(bands=int, in_pair=bool, fit="over_kr", left_out="over_kr")
_CORRELATED = keys(parameter=str, other=str, correlation=float)


def _snap(name: str, head: str, read: str = "") -> Quantity:
    return Quantity(name, "mm", head, read, ".2f", none="none")


_SNAP: Schema = (
    Quantity("series", head="series"),
    _snap("measured", "measured"),
    *keys(spread="mm", reached="mm"),
    _snap("plain", "no fit"),
    _snap("fitted", "own curves"),
    _snap("left_out", "left out"),
    _snap("doubt", "±"),
    *keys(covered=bool | None, order_seen=[str], order_predicted=([str], "order")),
    *keys(order_error_ratio=(float, "ratio")),
)


def _errors(model: Calibration) -> Sequence[Row]:
    """The errors of each cell in a series, fitted and left out [k r]."""
    errors = {"fit": model.fit_error, "left_out": model.left_out_error}
    return rows_of({"sample": model.samples, **errors})


def _means(model: Calibration) -> Sequence[Row]:
    """The mean errors of the cells by their number of bands, single and in pairs [k r]."""
    fits = (model.mean_error(*kind, left_out=False) for kind in model.kinds)
    errors = {"fit": fits, "left_out": (model.mean_error(*kind) for kind in model.kinds)}
    bands, in_pair = ([kind[i] for kind in model.kinds] for i in (0, 1))
    return rows_of({"bands": bands, "in_pair": in_pair, **errors})


def _correlations(model: Calibration) -> dict[str, dict[str, float]]:
    rows = [dict(zip(model.values, row, strict=True)) for row in model.correlations.tolist()]
    return dict(zip(model.values, rows, strict=True))


def summary(model: Calibration) -> list[str]:
    """Prediction errors of a calibration, a sentence each."""
    lines = [
        f"{'Pairs' if one['in_pair'] else 'Cells'} with {counted(one['bands'], 'band')}: force "
        f"within {one['fit']:.3f} k r fitted, {one['left_out']:.3f} predicted from the "
        "other geometries."
        for one in _means(model)
    ]
    if model.snaps:
        right, of = model.orders
        lines.append(f"Orders predicted from the other geometries: {right} of {of} as seen.")
    plain, fitted, left_out = (one.of(model) * _MM for one in _SNAP_ERRORS)
    if not math.isnan(left_out):
        held, of = model.coverage
        lines.append(
            f"Snaps, none of them fitted, are missed by {left_out:.2f} mm in the mean "
            f"from the other geometries, by {fitted:.2f} mm from a pair's own curves, by "
            f"{plain:.2f} mm without a fit; 90 % intervals hold {held} of {of}."
        )
    if (weighing := model.weighing) is not None:
        machine = f"; friction of the machine {weighing.friction:.3f} N" if weighing.both else ""
        lines.append(f"The block between two cells weighs {weighing.weight:.3f} N{machine}.")
    return lines


CALIBRATE: Schema = (
    *keys(data_sha256={str: str}, summary=([str], summary), law=str, k=("N/m", "reference")),
    *keys(parameters=[_PARAMETER]),
    Quantity("weighing", holds=_WEIGHING, missing=True),
    *keys(compliance="mm/N", scatter="percent", snaps=[_SNAP]),
    Quantity("snap_errors", "mm", holds=_SNAP_ERRORS, read=lambda model: model),
    *keys(intervals_that_hold=(_INTERVALS, "coverage"), orders_right=([int], "orders")),
    *keys(errors=([_ERROR], _errors), mean_errors=([_MEAN], _means)),
    *keys(correlations=({str: {str: float}}, _correlations)),
    *keys(strongly_correlated=([_CORRELATED], "tied"), open=[str], notes=[str], table=str),
    *keys(unknown=[str], missing=str),
    Quantity("tensions", holds=[_TENSION]),
)


def calibration_account(model: Calibration, about: About) -> Account:
    """Parameters of bands and rig, fitted to all cells, and errors of their predictions."""
    answer, *rest = summary(model)
    table = calibrated_table(model, about.source or "")
    tied = ", ".join(f"{it.parameter} and {it.other} ({it.correlation:+.2f})" for it in model.tied)
    correlated = f"The data do not identify these parameters separately: {tied}."
    unit = f"errors are in k r, with k = {number(model.reference)} N/m a band"
    instead = "; its tension is written" if model.unknown and not model.missing else ""
    facts = (
        Fact("Force law", f"{model.law}; {unit}"),
        Fact("Not identified", base.join_first(model.unknown, 5) + instead),
    )
    assumed = (
        "Intervals are those of the jackknife over geometries, taken as independent; samples along "
        "a stroke are not independent."
    )
    snaps = "Measured and predicted; snaps are not fitted."
    title = "Bands calibrated on cells"
    missing = [headed(model.missing)] if model.missing else []
    warned = [parts.Warned("No band can be written", "", missing)]
    sections = {
        "Predictions": Notes(rest, CARD),
        "Tension of one band [N] by the distance of its anchors, with its 95 % band": RecordTable(
            _tension_columns(model), "tensions", level=CARD, pick=_tension_rows
        ),
        **folded_notes("Notes on the recordings", model.notes, 2),
        "Parameters, each with its 95 % interval by leaving out a geometry": RecordTable(
            _PARAMETER, "parameters", more="parameters", level=FULL
        ),
        "First snaps": RecordTable(_SNAP, "snaps", snaps, level=FULL, pick=_snapping),
        "Root mean square errors in k r": (
            parts.Picture("calibration", "Fitted and measured forces"),
            RecordTable(_ERROR, "errors", more="curves", level=FULL),
        ),
        "Correlated parameters": Text(
            correlated if tied else "The data identify each parameter by itself.", FULL
        ),
        "Not identified by these recordings": Notes(model.open, FULL),
        "Band table": parts.Verbatim(table.rstrip(), "Band table", FULL),
        "Assumptions": Text(assumed, FULL),
    }
    given = {"table": table}
    return Account(model, title, "lab.calibrate/2", answer, facts, sections, warned, given=given)


def _tension_columns(model: Calibration) -> list[Column]:
    """A column of lengths, and one of tensions for each kind of bands."""
    names = [one.rubber.removeprefix("stiffness_").replace("_", " ") for one in model.tensions]
    each = [
        Column(f"bands: {name}", lambda row, k=k: row[str(k)], True) for k, name in enumerate(names)
    ]
    return [Column("length [mm]", lambda row: row["length"], True), *each] if each else []


def _tension_rows(tensions: Sequence[Row]) -> list[Row]:
    """Tensions at a few lengths; a kind without this length in its data has no text."""
    lengths = [length for one in tensions for length in one["length_mm"]]
    if not lengths:
        return []
    at = np.linspace(min(lengths), max(lengths), _FEW)

    def text(one: Row, length: float) -> str:
        known = one["length_mm"]
        if not known[0] - 1e-9 <= length <= known[-1] + 1e-9:
            return "-"
        value, low, high = (
            float(np.interp(length, known, one[key])) for key in ("tension_N", "low_N", "high_N")
        )
        return f"{value:.3g} ({low:.3g} to {high:.3g})"

    return [
        {"length": f"{length:.3g}", **{str(k): text(one, length) for k, one in enumerate(tensions)}}
        for length in at.tolist()
    ]


def _snapping(rows: Sequence[Row]) -> list[Row]:
    """The rows with a snap, measured or predicted."""
    names = "measured_mm", "plain_mm", "left_out_mm"
    return [row for row in rows if any(row[name] is not None for name in names)]
