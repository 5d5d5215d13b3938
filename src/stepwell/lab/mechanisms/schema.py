"""Columns of the results about unit cells, pairs and rigs: name, unit, heading, format."""

from __future__ import annotations

from typing import Any

from stepwell.base import Quantity, Schema


def _both(name: str) -> Any:
    return lambda test: {
        "measured": getattr(test.plain, name),
        "model": getattr(test.cell, name),
    }


def _beside(both: dict[str, float]) -> str:
    return f"{both['measured']:.3f} ({both['model']:.3f})"


def _series(kind: str) -> Schema:
    return (
        Quantity("series", head="series", read="series.name"),
        Quantity("kind", read=lambda test: kind),
        Quantity("runs", read=lambda test: [run.source for run in test.series.recordings]),
        Quantity("baseline", read=lambda test: [run.source for run in test.series.baseline]),
        Quantity("told", read="series.told"),
        Quantity("k_r", "N", read="series.scale"),
        Quantity("rmse", "over_kr", "RMSE", form=".3f"),
        Quantity("rmse_bar_corrected", "over_kr", "bar corr.", "rmse_corrected", ".3f"),
        Quantity("max", "over_kr", "max", "worst", ".3f"),
    )


RIG: Schema = (
    Quantity("stretch"),
    Quantity("start_loading", "mm"),
    Quantity("start_unloading", "mm"),
    Quantity("compliance_mm_per_N", read=lambda rig: rig.compliance * 1e3),
    Quantity("friction", "N"),
)
_THEN = " then ".join
_SPREAD = Quantity("spread", "over_kr", read=lambda test: test.spread / test.series.scale)
CELL_TEST: Schema = (
    *_series("cell"),
    Quantity("rmse_energy", "over_kr2", "E RMSE", form=".3f"),
    _SPREAD,
    Quantity("F0", "N", "F0", _both("force_0"), _beside),
    Quantity("F1", "N", "F1", _both("force_1"), _beside),
    Quantity("barrier", "mJ", "barrier", _both("barrier"), _beside),
    Quantity("bistable", read=_both("is_bistable")),
    Quantity(
        "rises",
        read=lambda test: [
            {"from_mm": a * 1e3, "to_mm": b * 1e3, "by_N": height} for a, b, height in test.rises
        ],
    ),
    Quantity("verdict"),
)
PAIR_TEST: Schema = (
    *_series("pair"),
    _SPREAD,
    Quantity("order_shown", "", "order shown", lambda test: test.names(test.shown), _THEN),
    Quantity(
        "order_predicted", "", "model", lambda test: test.names(test.predicted), " then ".join
    ),
    Quantity("order_tie", read="tie"),
    Quantity("order_error_ratio", "", "ratio", "ratio", ".1f", left=False),
    Quantity("snaps", "mm"),
    Quantity("slips", "mm"),
    Quantity("missing_samples", read="missing"),
    Quantity("snap_mean", "mm", read=lambda test: test.snap_strokes[0]),
    Quantity("snap_spread", "mm", read=lambda test: test.snap_strokes[1]),
    Quantity("snap_doubt", "mm", read="doubt"),
    Quantity("snap_off", "sigma", read="sigmas"),
    Quantity("snaps_agree", read="right_snaps"),
    Quantity("warning"),
    Quantity("snaps_predicted", "mm"),
    Quantity("snaps_with_friction", "mm"),
    Quantity("pull", "N", read=lambda test: test.pull if test.held else None),
    Quantity("hold", "N", read=lambda test: test.hold if test.held else None),
    Quantity("verdict"),
)
