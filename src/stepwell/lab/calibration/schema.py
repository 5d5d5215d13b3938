"""What is told of a calibration: names, units, headings, and its record."""

from __future__ import annotations

import math
from typing import Any

from stepwell.base import Quantity, Schema, record
from stepwell.lab.calibration.calibrate import Calibration
from stepwell.lab.mechanisms import counted_bands

PARAMETER: Schema = (
    Quantity("name", head="number"),
    Quantity("unit", head="unit"),
    Quantity("value", head="value", left=False),
    Quantity("low", head="from", left=False),
    Quantity("high", head="to", left=False),
)
ERROR: Schema = (
    Quantity("series", head="series", read="name"),
    Quantity("d", "mm", "d", "geometry", lambda d: f"({d[0]:g}, {d[1]:g})", left=True),
    Quantity("bands"),
    Quantity("in_pair"),
    Quantity("fit", "over_kr", "fit", form=".3f"),
    Quantity("left_out", "over_kr", "left out", form=".3f"),
)


def _stroke(value: float | None) -> str:
    return "none" if value is None or math.isnan(value) else f"{value:.2f}"


SNAP: Schema = (
    Quantity("series", head="series"),
    Quantity("measured", "mm", "seen", form=_stroke, left=False),
    Quantity("spread", "mm"),
    Quantity("reached", "mm"),
    Quantity("plain", "mm", "no fit", form=_stroke, left=False),
    Quantity("fitted", "mm", "own curves", form=_stroke, left=False),
    Quantity("left_out", "mm", "left out", form=_stroke, left=False),
    Quantity("doubt", "mm", "±", form=_stroke, left=False),
    Quantity("covered", read="covered"),
    Quantity("order_seen", read=lambda one: list(one.order_seen)),
    Quantity("order_predicted", read=lambda one: list(one.order)),
    Quantity("order_error_ratio", read="ratio"),
)


def fit_record(calibration: Calibration) -> dict[str, Any]:
    """The calibration as JSON can hold it; docs/commands.md describes the names."""
    names = list(calibration.values)
    errors = calibration.fit_error, calibration.left_out_error
    weighing, given = calibration.weighing, calibration.compliance
    inside, told = calibration.coverage
    return {
        "summary": _summary(calibration),
        "law": calibration.law,
        "k_N_per_m": calibration.reference,
        "parameters": [record(PARAMETER, p) for p in calibration.parameters],
        "weighing": None
        if weighing is None
        else {
            "weight_N": weighing.weight,
            "weight_doubt_N": _known(weighing.doubt),
            "machine_friction_N": _known(weighing.friction),
            "loading_and_unloading": weighing.both,
        },
        "compliance_mm_per_N": _known(given * 1e3),
        "scatter_percent": _known(calibration.scatter * 1e2),
        "snaps": [record(SNAP, one) for one in calibration.snaps],
        "snap_errors_mm": {
            name: _known(calibration.snap_error(name) * 1e3)
            for name in ("plain", "fitted", "left_out")
        },
        "intervals_that_hold": {"of": told, "hold": inside},
        "orders_right": list(calibration.orders),
        "errors": [
            record(ERROR, sample, fit=fit, left_out=out)
            for sample, fit, out in zip(calibration.samples, *errors, strict=True)
        ],
        "mean_errors": [
            {
                "bands": n,
                "in_pair": pair,
                "fit_over_kr": calibration.mean_error(n, pair, left_out=False),
                "left_out_over_kr": calibration.mean_error(n, pair),
            }
            for n, pair in calibration.kinds
        ],
        "correlations": {
            name: dict(zip(names, row.tolist(), strict=True))
            for name, row in zip(names, calibration.correlations, strict=True)
        },
        "not_told_apart": [list(pair) for pair in calibration.tied],
        "open": calibration.open,
    }


def _summary(calibration: Calibration) -> list[str]:
    """How well the fit does, the answer first."""
    told = [
        f"{'Pairs' if pair else 'Cells'} with {counted_bands(n)}: force within "
        f"{calibration.mean_error(n, pair, left_out=False):.3f} k r fitted, "
        f"{calibration.mean_error(n, pair):.3f} predicted from the other geometries."
        for n, pair in calibration.kinds
    ]
    if calibration.snaps:
        right, of = calibration.orders
        told.append(f"Orders predicted from the other geometries: {right} of {of} as seen.")
    plain, fitted, left_out = (
        calibration.snap_error(name) * 1e3 for name in ("plain", "fitted", "left_out")
    )
    if not math.isnan(left_out):
        held, of = calibration.coverage
        told.append(
            f"Snaps, none of them fitted, are missed by {left_out:.2f} mm in the mean from the "
            f"other geometries, by {fitted:.2f} mm from a pair's own curves, by {plain:.2f} mm "
            f"without a fit; 90 % intervals hold {held} of {of}."
        )
    weighing = calibration.weighing
    if weighing is not None:
        machine = f"; friction of the machine {weighing.friction:.3f} N" if weighing.both else ""
        told.append(f"The block between two cells weighs {weighing.weight:.3f} N{machine}.")
    return told


def _known(value: float) -> float | None:
    return None if math.isnan(value) else value
