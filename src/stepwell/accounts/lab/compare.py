"""Unit cells and pairs on a test machine, compared with their models."""

from collections.abc import Callable, Sequence

from stepwell import base
from stepwell.accounts import parts
from stepwell.accounts.head import About, Row, keys, of_class
from stepwell.accounts.parts import CARD, FULL, TERMINAL, Account, Fact, Notes, RecordTable, Text
from stepwell.accounts.words import clipped, folded_notes
from stepwell.base import Quantity, Schema, amount, counted, number
from stepwell.lab import NOT_JUDGED, RISE, CellTest, ChainTest, Comparison, PairTest, Rig

_MM = Quantity("stroke", "mm").factor

# Notes of every series, which are listed last.
_USUAL = "runs", "baseline", "configuration"
# Verdicts that a terminal shows in full, and lines of those that do not agree.
_FEW, _ODD = 3, 6

_RIG = keys(
    stretch=float, start_loading="mm", start_unloading="mm", compliance="mm/N", friction="N"
)
_RISE = keys(**{"from": ("mm", "start")}, to=("mm", "end"), by=("N", "height"))


def _measured_and_model(name: str, unit: str, read: str, kind: type = float) -> Quantity:
    """A number of the measured force and of the model; tables have it if it has a unit."""

    def both(test: CellTest) -> Row:
        return {"measured": getattr(test.plain, read), "model": getattr(test.cell, read)}

    text, holds = "{measured:.3f} ({model:.3f})".format_map, keys(measured=kind, model=kind)
    return Quantity(name, unit, name * bool(unit), both, text, holds=holds)


_Test = CellTest | PairTest | ChainTest


def _in_kr(name: str, head: str, read: str) -> Quantity:
    """A number of a unit cell or a pair in units of k r; a chain has none."""

    def value(test: _Test) -> float | None:
        return None if isinstance(test, ChainTest) else getattr(test, read)

    return Quantity(name, "over_kr", head, value, ".3f", missing=True)


def _k_r(test: _Test) -> float | None:
    return None if isinstance(test, ChainTest) else test.series.scale


_KINDS = {CellTest: "cell", PairTest: "pair", ChainTest: "chain"}
_EACH: Schema = (
    Quantity("series", head="series", read="series.name"),
    Quantity("kind", read=lambda test: _KINDS[type(test)]),
    *keys(runs=([str], lambda test: [one.source for one in test.series.recordings])),
    *keys(baseline=([str], lambda test: [one.source for one in test.series.baseline])),
    *keys(notes=([str], "series.notes"), k_r=("N", _k_r)),
    _in_kr("rmse", "RMSE", "rmse"),
    _in_kr("rmse_bar_corrected", "bar corr.", "rmse_corrected"),
    _in_kr("max", "max", "worst"),
    Quantity("spread", "over_kr", read=lambda t: t.spread / k if (k := _k_r(t)) else None),
    Quantity("verdict"),
)
_CELL = of_class(
    CellTest,
    (
        Quantity("rmse_energy", "over_kr2", "E RMSE", form=".3f"),
        _measured_and_model("F0", "N", "force_0"),
        _measured_and_model("F1", "N", "force_1"),
        _measured_and_model("barrier", "mJ", "barrier"),
        _measured_and_model("bistable", "", "is_bistable", bool),
        *keys(rises=[_RISE]),
    ),
)


def _order(name: str, head: str, read: str) -> Quantity:
    return Quantity(name, "", head, lambda t: t.names(getattr(t, read)), " then ".join, holds=[str])


_PAIR = of_class(
    PairTest,
    (
        _order("order_shown", "order shown", "shown"),
        _order("order_predicted", "model", "predicted"),
        *keys(order_tie=(bool, "tie")),
        Quantity("order_error_ratio", "", "ratio", "ratio", ".1f", left=False, holds=float),
        Quantity("snaps", "mm", holds=[[float]]),
        Quantity("slips", "mm", holds=[[float]]),
        *keys(missing_samples=([int], "missing"), snap_mean=("mm", lambda t: t.snap_strokes[0])),
        *keys(snap_spread=("mm", lambda test: test.snap_strokes[1]), snap_doubt=("mm", "doubt")),
        *keys(snap_off=("sigma", "sigmas"), snaps_agree=(bool, "right_snaps"), warning=str),
        Quantity("snaps_predicted", "mm", holds=[float]),
        Quantity("snaps_with_friction", "mm", holds=[float]),
        *keys(pull=("N", lambda test: test.pull if test.held else None)),
        *keys(hold=("N", lambda test: test.hold if test.held else None)),
    ),
)
_JUMP = keys(predicted="mm", jump="N", measured="mm", error="mm", doubt="mm", runs=int)
_JUMP += keys(continuous=bool)
_CHAIN = of_class(
    ChainTest,
    (
        Quantity("force_rmse", "N", "RMSE", "rmse"),
        *keys(force_range=("N", "range"), force_off=("N", lambda test: test.worst[1])),
        *keys(force_off_at=("mm", lambda test: test.worst[0])),
        Quantity("jumps", holds=[_JUMP]),
        *keys(agrees=bool, motion_tie=(bool, "tie")),
    ),
)
_SERIES: Schema = (*_EACH, *_CELL, *_PAIR, *_CHAIN)
_PAIR_COLUMNS: base.Columns = tuple(
    base.Column(one.head, lambda pair, one=one: "a tie" if pair["order_tie"] else one.cell(pair))
    if one.name == "order_predicted"
    else one
    for one in (*_EACH, *_PAIR)
)


def _means(compared: Comparison) -> Sequence[Row]:
    """Mean error of the unit cells by their number of bands [k r]."""
    counts = sorted({test.series.bands for test in compared.cells})
    return base.rows_of({"bands": counts, "rmse": map(compared.mean_rmse, counts)})


def cell_test_account(test: _Test, about: About) -> Account:
    """Card of a single series in a notebook."""
    return Account(test, test.series.name, answer=f"{test.verdict}.")


pair_test_account = chain_test_account = cell_test_account


COMPARE: Schema = (
    *keys(data_sha256={str: str}, designs_sha256={str: str}, bar=("mm", "rig.bar"), rig=_RIG),
    Quantity("mean_rmse", "over_kr", holds=[keys(bands=int, rmse="over_kr")], read=_means),
    *keys(series=([_SERIES], "tests"), notes=[str], not_judged=(str, lambda _: NOT_JUDGED)),
    Quantity("rise", "over_kr", read=lambda _: RISE),
)


def comparison_account(compared: Comparison, about: About) -> Account:
    """Errors of the models against the measured forces, and verdicts."""
    cells, pairs, tests = compared.cells, compared.pairs, compared.tests

    def of_kind(kind: str) -> Callable[[Sequence[Row]], Sequence[Row]]:
        return lambda series: [one for one in series if one["kind"] == kind]

    means = (f"{m['rmse']:.3f} k r with {counted(m['bands'], 'band')}" for m in _means(compared))
    rises = [
        f"{test.series.name} by {one.height:.2g} N from {number(one.start * _MM)} to "
        f"{number(one.end * _MM)} mm"
        for test in cells
        for one in test.rises
    ]
    no_rise = f"in no series, to {RISE:g} k r" * bool(cells)
    facts = (
        Fact("Mean RMSE of unit cells", "; ".join(means)),
        Fact("Force rises", base.join_first(rises, 1) or no_rise, TERMINAL),
    )
    notes = [f"{test.series.name}: {line}" for test in tests for line in test.series.notes]
    odd = sorted(notes, key=lambda line: any(f": {name}: " in line for name in _USUAL))
    figures = (
        ("forces", "Forces of unit cells"),
        ("energies", "Energies of unit cells"),
        ("pairs", "Forces of pairs"),
        ("chains", "Forces of chains"),
    )
    verdicts = [f"{test.series.name}: {test.verdict}" for test in tests]
    sections = {
        **_verdicts(tests, verdicts),
        "Figures": [parts.Picture(name, f"{of}, measured and modelled") for name, of in figures],
        "Unit cells: measured (model); errors in k r and k r²": RecordTable(
            (*_EACH, *_CELL), "series", "", (), "unit cells", FULL, of_kind("cell")
        ),
        "Pairs: errors in k r; ratio of the errors against the two orders": RecordTable(
            _PAIR_COLUMNS, "series", "", (), "pairs", FULL, of_kind("pair")
        ),
        "Rig": Text(_rig_words(compared.rig) if pairs else ""),
        **folded_notes("Notes on the recordings", [*odd, *compared.notes]),
        "Assumptions": Text(NOT_JUDGED, FULL),
    }
    title, answer = "Measured against model", _agreement(compared)
    return Account(compared, title, "lab.compare/2", answer, facts, sections)


def _verdicts(tests: Sequence[_Test], verdicts: Sequence[str]) -> parts.Sections:
    """The verdicts; of many, a terminal shows the first ones of those that do not agree."""
    if len(tests) <= _FEW:
        return {"Verdicts": Notes(verdicts, CARD)}
    pairs = zip(tests, verdicts, strict=True)
    odd = [clipped(verdict) for test, verdict in pairs if not test.agrees]
    more = [f"and {len(odd) - _ODD} more"] * (len(odd) > _ODD)
    return {
        f"Differ or undecided: {len(odd)} of {len(tests)} series": Notes(
            [*odd[:_ODD], *more], CARD
        ),
        "Verdicts": Notes(verdicts, FULL),
    }


def _agreement(compared: Comparison) -> str:
    """How many pairs have the predicted order, and how many unit cells their model."""
    ordered = [pair.shown == pair.predicted for pair in compared.pairs if not pair.tie]
    kinds = (
        ("pair", "in the predicted order", ordered),
        ("unit cell", "agree with the model", [one.agrees for one in compared.cells]),
        ("chain", "as predicted", [one.agrees for one in compared.chains]),
    )
    known = (f"{sum(of)} of {counted(len(of), noun)} {right}" for noun, right, of in kinds if of)
    return "; ".join(known) or "No series is decided"


def _rig_words(rig: Rig) -> str:
    """Conversion of predicted snaps to the strokes of the machine; "" for an ideal rig."""
    if base.record(_RIG, rig) == base.record(_RIG, Rig()):
        return ""
    return (
        f"Predicted snaps are at the strokes of the machine: travels {rig.stretch:.4g} times "
        f"nominal, {rig.start_loading * _MM:+.2f} mm before loading, "
        f"{rig.start_unloading * _MM:+.2f} mm before unloading; the compliance of the rig "
        f"is {amount(rig.compliance, 'm/N', 2)}, its own friction "
        f"{amount(rig.friction, 'N', 2)}."
    )
