"""Unit cells and pairs on a test machine, compared with their models."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from stepwell import base
from stepwell.accounts.head import About, Row, keys, of_class
from stepwell.accounts.parts import CARD, TERMINAL, Account, Fact, Notes, Picture, RecordTable, Text
from stepwell.base import Quantity, Schema, amount, counted, number
from stepwell.lab import NOT_JUDGED, RISE, CellTest, Comparison, PairTest, Rig

_MM = Quantity("stroke", "mm").factor

_RIG = keys(
    stretch=float, start_loading="mm", start_unloading="mm", compliance="mm/N", friction="N"
)
_RISE: Schema = (
    Quantity("from", "mm", read="start"),
    Quantity("to", "mm", read="end"),
    Quantity("by", "N", read="height"),
)


def _both(name: str) -> Any:
    """A number of the measured force and of the model."""
    return lambda test: {"measured": getattr(test.plain, name), "model": getattr(test.cell, name)}


def _of_both(kind: type) -> Schema:
    return keys(measured=kind, model=kind)


def _beside(both: Mapping[str, float]) -> str:
    return f"{both['measured']:.3f} ({both['model']:.3f})"


def _sources(name: str) -> Any:
    return lambda test: [one.source for one in getattr(test.series, name)]


_EACH: Schema = (
    Quantity("series", head="series", read="series.name"),
    Quantity("kind", read=lambda test: "cell" if isinstance(test, CellTest) else "pair"),
    *keys(runs=([str], _sources("recordings")), baseline=([str], _sources("baseline"))),
    *keys(told=([str], "series.told"), k_r=("N", "series.scale")),
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
        *keys(bistable=(_of_both(bool), _both("is_bistable")), rises=[_RISE]),
    ),
)


def _order(name: str, head: str, read: str) -> Quantity:
    def names(test: PairTest) -> Any:
        return test.names(getattr(test, read))

    return Quantity(name, "", head, names, " then ".join, holds=[str])


def _held(name: str) -> Any:
    return "N", lambda test: getattr(test, name) if test.held else None


_PAIR = of_class(
    PairTest,
    (
        _order("order_shown", "order shown", "shown"),
        _order("order_predicted", "model", "predicted"),
        *keys(order_tie=(bool, "tie")),
        Quantity("order_error_ratio", "", "ratio", "ratio", ".1f", left=False, holds=float),
        Quantity("snaps", "mm", holds=[[float]]),
        Quantity("slips", "mm", holds=[[float]]),
        *keys(missing_samples=([int], "missing")),
        *keys(snap_mean=("mm", lambda test: test.snap_strokes[0])),
        *keys(snap_spread=("mm", lambda test: test.snap_strokes[1]), snap_doubt=("mm", "doubt")),
        *keys(snap_off=("sigma", "sigmas"), snaps_agree=(bool, "right_snaps"), warning=str),
        Quantity("snaps_predicted", "mm", holds=[float]),
        Quantity("snaps_with_friction", "mm", holds=[float]),
        *keys(pull=_held("pull"), hold=_held("hold")),
    ),
)
_SERIES: Schema = (*_EACH, *_CELL, *_PAIR)
_PAIR_COLUMNS: base.Columns = tuple(
    base.Column(one.head, lambda pair, one=one: "a tie" if pair["order_tie"] else one.cell(pair))
    if one.name == "order_predicted"
    else one
    for one in (*_EACH, *_PAIR)
)


def _means(compared: Comparison) -> Sequence[Row]:
    """The mean error of the unit cells with so many bands [k r]."""
    counts = sorted({test.series.bands for test in compared.cells})
    return base.rows_of({"bands": counts, "rmse": map(compared.mean_rmse, counts)})


def cell_test_account(test: CellTest | PairTest, about: About) -> Account:
    """What a notebook shows of a single series."""
    return Account(test, test.series.name, answer=f"{test.verdict}.")


pair_test_account = cell_test_account


COMPARE: Schema = (
    *keys(data_sha256={str: str}, designs_sha256={str: str}, bar=("mm", "rig.bar"), rig=_RIG),
    Quantity("mean_rmse", "over_kr", holds=[keys(bands=int, rmse="over_kr")], read=_means),
    *keys(series=([_SERIES], "tests"), told=[str], not_judged=(str, lambda _: NOT_JUDGED)),
    Quantity("rise", "over_kr", read=lambda _: RISE),
)


def comparison_account(compared: Comparison, about: About) -> Account:
    """What is reported of a comparison."""
    cells, pairs, tests = compared.cells, compared.pairs, compared.tests

    def of_kind(kind: str) -> Callable[[Sequence[Row]], Sequence[Row]]:
        return lambda series: [one for one in series if one["kind"] == kind]

    means = (f"{m['rmse']:.3f} k r with {counted(m['bands'], 'band')}" for m in _means(compared))
    facts = (
        Fact("Unit cells", f"{len(cells)}" if cells else ""),
        Fact("Pairs", f"{len(pairs)}" if pairs else ""),
        Fact("Mean RMSE of unit cells", "; ".join(means)),
        Fact("Force rises", _rises(cells), TERMINAL),
    )
    odd = [f"{test.series.name}: {line}" for test in tests for line in test.series.told]
    level = TERMINAL if cells else CARD
    title, answer = "Measured against model", _answer(compared)
    sections = {
        "Verdicts": (
            Notes([f"{test.series.name}: {test.verdict}" for test in tests]),
            Picture("forces", "Forces of unit cells, measured and modelled"),
            Picture("energies", "Energies of unit cells, measured and modelled"),
            Picture("pairs", "Forces of pairs, measured and modelled"),
        ),
        "Unit cells: measured (model); errors in k r and k r²": RecordTable(
            (*_EACH, *_CELL), "series", "", (), None, "unit cells", CARD, of_kind("cell")
        ),
        "Pairs: errors in k r; ratio of the errors against the two orders": RecordTable(
            _PAIR_COLUMNS, "series", "", (), None, "pairs", level, of_kind("pair")
        ),
        "Rig": Text(_rig_words(compared.rig) if pairs else ""),
        "Used, dropped and odd": Notes([*odd, *compared.told]),
        "Assumptions": Text(NOT_JUDGED),
    }
    given = {"data_sha256": about.data_sha256, "designs_sha256": about.designs_sha256}
    return Account(compared, title, "lab.compare/2", answer, facts, sections, given=given)


def _answer(compared: Comparison) -> str:
    ordered = [pair for pair in compared.pairs if not pair.tie]
    right = sum(pair.shown == pair.predicted for pair in ordered)
    agreed = sum(cell.agrees for cell in compared.cells)
    of_pairs = f"{right} of {counted(len(ordered), 'pair')} in the predicted order"
    of_cells = f"{agreed} of {counted(len(compared.cells), 'unit cell')} agree with the model"
    return "; ".join([of_pairs] * bool(ordered) + [of_cells] * bool(compared.cells))


def _rises(cells: Sequence[CellTest]) -> str:
    """Where the force of unit cells rises though it should fall."""
    if not cells:
        return ""
    rises = [
        f"{test.series.name} by {one.height:.2g} N from {number(one.start * _MM)} to "
        f"{number(one.end * _MM)} mm"
        for test in cells
        for one in test.rises
    ]
    return "; ".join(rises) or f"in no series, to {RISE:g} k r"


def _rig_words(rig: Rig) -> str:
    """How predicted snaps are moved to the strokes of the machine; "" where they are not."""
    if base.record(_RIG, rig) == base.record(_RIG, Rig()):
        return ""
    return (
        f"Predicted snaps are at the strokes of the machine: travels {rig.stretch:.4g} times "
        f"nominal, {rig.start_loading * _MM:+.2f} mm before loading, "
        f"{rig.start_unloading * _MM:+.2f} mm before unloading; the compliance of the rig "
        f"is {amount(rig.compliance, 'm/N', 2)}, its own friction "
        f"{amount(rig.friction, 'N', 2)}."
    )
