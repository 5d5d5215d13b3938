"""What is shown of bands, calibrations and builds: names, units, headings, and their records."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from itertools import product
from typing import Any

from stepwell.base import (
    Floats,
    Quantity,
    Schema,
    __version__,
    percent,
    plain,
    record,
    told_in,
    versions,
)
from stepwell.lab.bands.band import BandTest, loss_grid, stiffness, stiffness_grid
from stepwell.lab.bands.choice import Choice, Interval, this_band
from stepwell.lab.bands.halves import Estimate, of_samples
from stepwell.lab.calibration import Calibration
from stepwell.lab.first_build import AsBuilt, Known
from stepwell.lab.series import counted_bands

ESTIMATE: Schema = tuple(
    map(Quantity, ("value", "low", "high", "next_low", "next_high", "spread", "each"))
)
LAW: Schema = (
    Quantity("law", read="law.name"),
    Quantity("numbers", head="numbers", read="parameters", left=False),
    Quantity("leaves", "N", read="fitted.rmse"),
    Quantity("predicts", "N", read="score"),
    Quantity("values", read=lambda law: {k: _estimate(e) for k, e in law.estimates.items()}),
    Quantity("at_bound", read="fitted.at_bound"),
    Quantity("above_best", form=3, left=False),
)
INTERVAL: Schema = tuple(map(Quantity, ("value", "low", "high")))


def band_record(test: BandTest, choice: Choice, table: str) -> dict[str, Any]:
    """Stiffness, its dependence on the window, losses and force laws of a band test.

    Args:
        test: the tension tests.
        choice: their force laws.
        table: what `band_table` returns for them.

    Returns:
        Names as docs/commands.md describes them.
    """
    edges, windows = stiffness_grid(test)
    return {
        "schema": "stepwell.lab.band/1",
        "stepwell": __version__,
        "versions": versions(),
        "warnings": list(test.warnings),
        "window_mm": plain(test.window, 1e3),
        "cycles": list(test.cycles),
        "samples": list(test.samples),
        "told": list(test.told),
        "stiffness_N_per_m": _estimate(stiffness(test)),
        "this_band": _this_band(test, choice),
        "windows": [
            {"from_mm": 1e3 * low, "to_mm": 1e3 * high, "k_N_per_m": k}
            for low, high, k in _known(edges, edges, windows)
        ],
        "loss": [
            {"sample": sample, "cycle": cycle, "loss": loss}
            for sample, cycle, loss in _known(*loss_grid(test))
        ],
        "loss_used": _loss_used(test),
        "laws": [record(LAW, candidate) for candidate in choice.candidates],
        "law_best": choice.best.law.name,
        "law_chosen": choice.chosen.law.name,
        "left_out": choice.folds,
        "law_told": choice.told,
        "rest_length_mm": plain(choice.rest_length, 1e3),
        "rest_length_told": choice.rest_length_told(),
        "table": table,
    }


def _this_band(test: BandTest, choice: Choice) -> dict[str, Any] | None:
    found = this_band(test, choice)
    if found is None:
        return None
    slope, onset = found
    length = None
    if choice.gauge is not None:
        length = Interval(*(1e3 * (choice.gauge + edge) for edge in onset))
    return {
        "readings": sum(len(test.samples_of(sample, test.window)[0]) for sample in test.samples),
        "stiffness_N_per_m": record(INTERVAL, slope),
        "rest_length_mm": length and record(INTERVAL, length),
    }


def _known(down: Iterable[Any], across: Iterable[Any], grid: Floats) -> Iterator[tuple[Any, ...]]:
    """The places of a grid that hold a number, with the number."""
    for (one, other), value in zip(product(down, across), grid.flat, strict=True):
        if not math.isnan(value):
            yield one, other, float(value)


def _loss_used(test: BandTest) -> dict[str, Any] | None:
    """Loss of the cycles that are used, a mean for each sample first."""
    each: dict[int, list[float]] = defaultdict(list)
    for loop in test.used:
        if not math.isnan(loop.loss):
            each[loop.sample].append(loop.loss)
    return _estimate(of_samples({s: sum(v) / len(v) for s, v in each.items()})) if each else None


def _estimate(estimate: Estimate) -> dict[str, Any]:
    return record(ESTIMATE, estimate, each={str(k): value for k, value in estimate.each.items()})


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
            "weight_doubt_N": _or_none(weighing.doubt),
            "machine_friction_N": _or_none(weighing.friction),
            "loading_and_unloading": weighing.both,
        },
        "compliance_mm_per_N": _or_none(given * 1e3),
        "scatter_percent": _or_none(calibration.scatter * 1e2),
        "snaps": [record(SNAP, one) for one in calibration.snaps],
        "snap_errors_mm": {
            name: _or_none(calibration.snap_error(name) * 1e3)
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


def _or_none(value: float) -> float | None:
    return None if math.isnan(value) else value


KNOWN: Schema = (
    Quantity("parameter", head="number"),
    Quantity("drawn", head="drawn", left=False),
    Quantity("value", head="as built", left=False),
    Quantity("doubt", head="±", left=False),
    Quantity("doubt_before", head="± before", left=False),
    Quantity("unit", head="unit"),
    Quantity("told", head="told by what was seen", form=lambda told: "yes" if told else "no"),
)
_PLACED: Schema = (
    Quantity("anchor", read="anchor.name"),
    Quantity("was", "mm"),
    Quantity("to", "mm"),
)
MOVE: Schema = (
    Quantity("move", head="move", read=str),
    *_PLACED,
    Quantity("also", read=lambda move: [record(_PLACED, step) for step in move.steps[1:]]),
    Quantity("share", head="share", form=percent, left=False),
)
WRONG: Schema = (
    Quantity("wrong", head="hole", read=str),
    *_PLACED,
    Quantity("share", head="share", form=percent, left=False),
)


def as_built_record(found: AsBuilt) -> dict[str, Any]:
    """A build as JSON can hold it; docs/commands.md describes the names."""
    seen = found.seen
    return {
        "schema": "stepwell.lab.as_built/1",
        "stepwell": __version__,
        "versions": versions(),
        "title": found.drawing.title,
        "advice": found.advice,
        "wanted": found.wanted,
        "share": found.share,
        "moves": [record(MOVE, move) for move in found.moves],
        "hole_mm": found.hole * 1e3,
        "wrong_hole": found.chance,
        "wrong_holes": [record(WRONG, one) for one in found.wrong],
        "seen": {
            "sequence": seen.sequence,
            "snaps_out_mm": _mm(seen.out),
            "snaps_back_mm": _mm(seen.back),
            "pulls": [
                {"direction": p.direction, "stroke_mm": p.stroke * 1e3, "force_N": p.force}
                for p in seen.pulls
            ],
            "ruler_mm": seen.ruler * 1e3,
            "scale_N": seen.scale,
        },
        "known": [_known_part(one) for one in found.known],
        "drawn": found.n,
        "seed": found.seed,
        "agreeing": found.agreeing,
        "wider": found.wider,
        "anchor_mm": found.tolerances.anchor * 1e3,
        "stiffness_percent": found.tolerances.stiffness * 1e2,
    }


def holes_told(told: Mapping[str, Any]) -> str:
    """What a record of a build says of its holes, in words."""
    if not told["wrong_hole"]:
        return "as drawn; wrong ones were not looked for"
    if not told["wrong_holes"]:
        return "as drawn, as far as was seen"
    each = [f"{one['wrong']} in {percent(one['share'])}" for one in told["wrong_holes"]]
    return f"{', '.join(each)} of the builds that would do this; p the other way does the same"


def _known_part(one: Known) -> dict[str, Any]:
    unit, factor = told_in(one.parameter.unit)
    numbers = {
        "drawn": one.drawn,
        "value": one.value,
        "doubt": one.doubt,
        "doubt_before": one.before,
    }
    return {
        "parameter": one.parameter.name,
        **{name: value * factor for name, value in numbers.items()},
        "unit": Quantity("", unit).sign,
        "told": one.told,
    }


def _mm(strokes: tuple[float, ...] | None) -> list[float] | None:
    return None if strokes is None else [u * 1e3 for u in strokes]
