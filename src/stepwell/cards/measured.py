"""Cards of recordings and of what they say."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from stepwell.base import counted, number, record
from stepwell.cards.html import Card, facts
from stepwell.lab import CELL_TEST, KNOWN, PAIR_TEST, PARAMETER, SUMMARY, as_built_record

if TYPE_CHECKING:
    from stepwell.lab import (
        AsBuilt,
        BandTest,
        Calibration,
        CellTest,
        Comparison,
        PairTest,
        Recording,
    )


def _recording(one: Recording) -> Card:
    told = [q for q in SUMMARY if q.name not in ("source", "turns", "odd")]
    return Card(f"Recording {one.name}", list(one.remarks), facts(told, one))


def _batch(batch: Any) -> Card:
    rows = [record(SUMMARY, one, odd=[]) for one in batch.recordings]
    says = f"{len(batch.recordings)} were read, {len(batch.refused)} were not."
    return Card("Recordings", [says], {}, SUMMARY, rows, "recordings")


def _band_test(test: BandTest) -> Card:
    from stepwell.lab import stiffness

    low, high = (number(edge * 1e3) for edge in test.window)
    found = stiffness(test)
    return Card(
        "Tension tests of bands",
        list(test.told[:3]),
        {
            "stiffness": f"{number(found.value)} N/m, 95 % {number(found.low)} to "
            f"{number(found.high)} N/m",
            "samples": ", ".join(map(str, test.samples)),
            "cycles": f"{test.cycles[0]} to {test.cycles[1]}",
            "stroke": f"{low} to {high} mm",
        },
    )


def _calibration(found: Calibration) -> Card:
    return Card(
        f"Calibration with a {found.law} law",
        [
            f"RMSE {found.mean_error(n, pair, left_out=False):.3f} k r fitted, "
            f"{found.mean_error(n, pair):.3f} k r predicted from the other geometries, "
            f"{'pairs' if pair else 'cells'} with {counted(n, 'band')} each."
            for n, pair in found.kinds
        ],
        {},
        PARAMETER,
        [record(PARAMETER, one) for one in found.parameters],
        "numbers",
    )


def _test(test: CellTest | PairTest) -> Card:
    return Card(test.series.name, [f"{test.verdict[:1].upper()}{test.verdict[1:]}."])


def _comparison(found: Comparison) -> Card:
    schema, tests = (CELL_TEST, found.cells) if found.cells else (PAIR_TEST, found.pairs)
    told = f"{len(found.cells)} series of unit cells and {len(found.pairs)} of pairs."
    return Card(
        "Measured beside the model", [told], {}, schema, [t.record() for t in tests], "series"
    )


def _as_built(found: AsBuilt) -> Card:
    known = as_built_record(found)["known"]
    return Card("As built", [f"Do now: {found.advice}."], {}, KNOWN, known, "numbers")


MEASURED: dict[str, Callable[[Any], Card]] = {
    "AsBuilt": _as_built,
    "BandTest": _band_test,
    "Batch": _batch,
    "Calibration": _calibration,
    "CellTest": _test,
    "Comparison": _comparison,
    "PairTest": _test,
    "Recording": _recording,
}
