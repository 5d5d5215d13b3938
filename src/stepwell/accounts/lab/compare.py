"""Unit cells and pairs on a test machine, compared with their models."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

from stepwell import base
from stepwell.accounts import parts
from stepwell.accounts.head import About, of_class
from stepwell.base import Quantity, Schema
from stepwell.lab import NOT_JUDGED, RISE, CellTest, Comparison, PairTest, Rig

_MM = Quantity("stroke", "mm").factor

_RIG: Schema = base.quantities(
    stretch=float, start_loading="mm", start_unloading="mm", compliance="mm/N", friction="N"
)
_MEANS: Schema = base.quantities(bands=int, rmse="over_kr")
_RISE: Schema = (
    Quantity("from", "mm", read="start"),
    Quantity("to", "mm", read="end"),
    Quantity("by", "N", read="height"),
)


def _both(name: str) -> Any:
    """A number of the measured force and of the model."""
    return lambda test: {"measured": getattr(test.plain, name), "model": getattr(test.cell, name)}


def _of_both(kind: type) -> Schema:
    return base.quantities(measured=kind, model=kind)


def _beside(both: Mapping[str, float]) -> str:
    return f"{both['measured']:.3f} ({both['model']:.3f})"


_EACH: Schema = (
    Quantity("series", head="series", read="series.name"),
    Quantity("kind", read=lambda test: "cell" if isinstance(test, CellTest) else "pair"),
    Quantity("runs", holds=[str], read=lambda test: [one.source for one in test.series.recordings]),
    Quantity(
        "baseline", holds=[str], read=lambda test: [one.source for one in test.series.baseline]
    ),
    Quantity("told", holds=[str], read="series.told"),
    Quantity("k_r", "N", read="series.scale"),
    Quantity("rmse", "over_kr", "RMSE", form=".3f"),
    Quantity("rmse_bar_corrected", "over_kr", "bar corr.", "rmse_corrected", ".3f"),
    Quantity("max", "over_kr", "max", "worst", ".3f"),
    Quantity("spread", "over_kr", read=lambda test: test.spread / test.series.scale),
    Quantity("verdict"),
)
_CELL = of_class(
    CellTest,
    (
        Quantity("rmse_energy", "over_kr2", "E RMSE", form=".3f"),
        Quantity("F0", "N", "F0", _both("force_0"), _beside, holds=_of_both(float)),
        Quantity("F1", "N", "F1", _both("force_1"), _beside, holds=_of_both(float)),
        Quantity("barrier", "mJ", "barrier", _both("barrier"), _beside, holds=_of_both(float)),
        Quantity("bistable", read=_both("is_bistable"), holds=_of_both(bool)),
        Quantity("rises", holds=[_RISE]),
    ),
)
_PAIR = of_class(
    PairTest,
    (
    Quantity(
        "order_shown", "", "order shown", lambda test: test.names(test.shown), " then ".join,
        holds=[str],
    ),
    Quantity(
        "order_predicted", "", "model", lambda test: test.names(test.predicted), " then ".join,
        holds=[str],
    ),
    Quantity("order_tie", read="tie", holds=bool),
    Quantity("order_error_ratio", "", "ratio", "ratio", ".1f", left=False, holds=float),
    Quantity("snaps", "mm", holds=[[float]]),
    Quantity("slips", "mm", holds=[[float]]),
    Quantity("missing_samples", read="missing", holds=[int]),
    Quantity("snap_mean", "mm", read=lambda test: test.snap_strokes[0]),
    Quantity("snap_spread", "mm", read=lambda test: test.snap_strokes[1]),
    Quantity("snap_doubt", "mm", read="doubt"),
    Quantity("snap_off", "sigma", read="sigmas"),
    Quantity("snaps_agree", read="right_snaps", holds=bool),
    Quantity("warning"),
    Quantity("snaps_predicted", "mm", holds=[float]),
    Quantity("snaps_with_friction", "mm", holds=[float]),
    Quantity("pull", "N", read=lambda test: test.pull if test.held else None),
    Quantity("hold", "N", read=lambda test: test.hold if test.held else None),
    ),
)  # fmt: skip
_SERIES: Schema = (*_EACH, *_CELL, *_PAIR)
_PAIR_COLUMNS: base.Columns = tuple(
    base.Column(one.head, lambda pair, one=one: "a tie" if pair["order_tie"] else one.cell(pair))
    if one.name == "order_predicted"
    else one
    for one in (*_EACH, *_PAIR)
)


def _means(found: Comparison) -> Sequence[parts.Row]:
    """The mean error of the unit cells with so many bands [k r]."""
    counts = sorted({test.series.bands for test in found.cells})
    return base.rows_of({"bands": counts, "rmse": map(found.mean_rmse, counts)})


def series_account(found: CellTest | PairTest, about: About) -> parts.Account:
    """What a notebook shows of a single series."""
    return parts.Account(found, found.series.name, answer=f"{found.verdict}.")


# What is reported of a comparison.
COMPARE: Schema = (
    *base.quantities(data_sha256={str: str}, designs_sha256={str: str}),
    Quantity("bar", "mm", read="rig.bar"),
    Quantity("rig", holds=_RIG),
    Quantity("mean_rmse", "over_kr", holds=[_MEANS], read=_means),
    Quantity("series", holds=[_SERIES], read="tests"),
    Quantity("told", holds=[str]),
    Quantity("not_judged", read=lambda _: NOT_JUDGED),
    Quantity("rise", "over_kr", read=lambda _: RISE),
)


def comparison_account(found: Comparison, about: About) -> parts.Account:
    """What is reported of a comparison."""
    cells, pairs, tests = found.cells, found.pairs, found.tests

    return parts.Account(
        found,
        title="Measured against model",
        kind="lab.compare/2",
        schema=COMPARE,
        answer=_answer(found),
        given={"data_sha256": about.data_sha256, "designs_sha256": about.designs_sha256},
        facts=(
            parts.Fact("Unit cells", f"{len(cells)}" if cells else ""),
            parts.Fact("Pairs", f"{len(pairs)}" if pairs else ""),
            parts.Fact("Mean RMSE of unit cells", _mean_words(found)),
            parts.Fact("Force rises", _rises(cells), parts.Level.TERMINAL),
        ),
        sections=(
            parts.Section(
                "Verdicts",
                parts.Notes([f"{test.series.name}: {test.verdict}" for test in tests]),
                parts.Picture("forces", "Forces of unit cells, measured and modelled"),
                parts.Picture("energies", "Energies of unit cells, measured and modelled"),
                parts.Picture("pairs", "Forces of pairs, measured and modelled"),
            ),
            parts.Section(
                "Unit cells: measured (model); errors in k r and k r²",
                parts.RecordTable(
                    (*_EACH, *_CELL),
                    "series",
                    most=None,
                    pick=partial(_of_kind, "cell"),
                    more="unit cells",
                    level=parts.Level.CARD,
                ),
            ),
            parts.Section(
                "Pairs: errors in k r; ratio of the errors against the two orders",
                parts.RecordTable(
                    _PAIR_COLUMNS,
                    "series",
                    most=None,
                    pick=partial(_of_kind, "pair"),
                    more="pairs",
                    level=parts.Level.TERMINAL if cells else parts.Level.CARD,
                ),
            ),
            parts.Section("Rig", parts.Text(_rig_words(found.rig) if pairs else "")),
            parts.Section(
                "Used, dropped and odd",
                parts.Notes(
                    [
                        *(f"{t.series.name}: {line}" for t in tests for line in t.series.told),
                        *found.told,
                    ]
                ),
            ),
            parts.Section("Assumptions", parts.Text(NOT_JUDGED)),
        ),
    )


def _of_kind(kind: str, series: Sequence[parts.Row]) -> list[parts.Row]:
    return [one for one in series if one["kind"] == kind]


def _answer(found: Comparison) -> str:
    ordered = [pair for pair in found.pairs if not pair.tie]
    right = sum(pair.shown == pair.predicted for pair in ordered)
    agreed = sum(cell.agrees for cell in found.cells)
    of_pairs = f"{right} of {base.counted(len(ordered), 'pair')} in the predicted order"
    of_cells = f"{agreed} of {base.counted(len(found.cells), 'unit cell')} agree with the model"
    return "; ".join([of_pairs] * bool(ordered) + [of_cells] * bool(found.cells))


def _mean_words(found: Comparison) -> str:
    means = _means(found)
    return "; ".join(f"{m['rmse']:.3f} k r with {base.counted(m['bands'], 'band')}" for m in means)


def _rises(cells: Sequence[CellTest]) -> str:
    """Where the force of unit cells rises though it should fall."""
    if not cells:
        return ""
    found = [
        f"{test.series.name} by {one.height:.2g} N from {base.number(one.start * _MM)} to "
        f"{base.number(one.end * _MM)} mm"
        for test in cells
        for one in test.rises
    ]
    return "; ".join(found) or f"in no series, to {RISE:g} k r"


def _rig_words(rig: Rig) -> str:
    """How predicted snaps are moved to the strokes of the machine; "" where they are not."""
    if base.record(_RIG, rig) == base.record(_RIG, Rig()):
        return ""
    return (
        f"Predicted snaps are at the strokes of the machine: travels {rig.stretch:.4g} times "
        f"nominal, {rig.start_loading * _MM:+.2f} mm before loading, "
        f"{rig.start_unloading * _MM:+.2f} mm before unloading; the compliance of the rig "
        f"is {base.amount(rig.compliance, 'm/N', 2)}, its own friction "
        f"{base.amount(rig.friction, 'N', 2)}."
    )
