"""What tension tests show, as JSON can hold it."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator
from itertools import product
from typing import Any

from stepwell.base import Floats, Quantity, Schema, __version__, plain, record, versions
from stepwell.lab.bands.band import BandTest, loss_grid, stiffness, stiffness_grid
from stepwell.lab.bands.choice import Choice, this_band
from stepwell.lab.bands.evidence import Interval
from stepwell.lab.bands.spread import Estimate, of_samples

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
