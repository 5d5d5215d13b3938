"""Tension tests of bands: stiffness with its uncertainty, losses, and the force law."""

import math
from collections.abc import Mapping
from typing import Any

from stepwell.accounts import parts
from stepwell.accounts.head import About
from stepwell.base import Column, Quantity, Schema, number, percent, quantities
from stepwell.lab import BandFit, BandTest, Estimate, band_table, stiffness

_MM, _MN = Quantity("stroke", "mm").factor, Quantity("force", "mN").factor

_NUMBERS = "value", "low", "high", "next_low", "next_high", "spread"
_ESTIMATE: Schema = (
    *(Quantity(name, holds=float) for name in _NUMBERS),
    Quantity("each", holds={str: float}, read=lambda one: {str(k): v for k, v in one.each.items()}),
)
_INTERVAL: Schema = tuple(Quantity(name, holds=float) for name in ("value", "low", "high"))
_ALONE: Schema = (
    Quantity("readings", holds=int),
    Quantity("stiffness", "N/m", holds=_INTERVAL),
    Quantity("rest_length", "mm", holds=_INTERVAL, missing=True),
)
_WINDOW: Schema = (
    Quantity("from", "mm", read="start"),
    Quantity("to", "mm", read="end"),
    Quantity("k", "N/m", read="stiffness"),
)
_LOSS: Schema = quantities(sample=int, cycle=int, loss=float)
_LAW: Schema = (
    Quantity("law", read="law.name"),
    Quantity("numbers", head="numbers", read="parameters", holds=int, left=False),
    Quantity("leaves", "N", read="fitted.rmse"),
    Quantity("predicts", "N", read="score"),
    Quantity("values", holds={str: _ESTIMATE}, read="estimates"),
    Quantity("at_bound", holds=[str], read="fitted.at_bound"),
    Quantity("above_best", holds=float),
)


def _losses(found: BandFit) -> list[Any]:
    """The cycles that unload, sample by sample."""
    known = [loop for loop in found.test.loops if not math.isnan(loop.loss)]
    return sorted(known, key=lambda loop: (loop.sample, loop.cycle))


# What is reported of bands.
BAND: Schema = (
    Quantity("data_sha256", holds={str: str}),
    Quantity("warnings", holds=[str], read="test.warnings"),
    Quantity("window", "mm", holds=[float], read="test.window"),
    Quantity("cycles", holds=[int], read="test.cycles"),
    Quantity("samples", holds=[int], read="test.samples"),
    Quantity("told", holds=[str], read="test.told"),
    Quantity("stiffness", "N/m", holds=_ESTIMATE),
    Quantity("this_band", holds=_ALONE, read="alone", missing=True),
    Quantity("windows", holds=[_WINDOW]),
    Quantity("loss", holds=[_LOSS], read=_losses),
    Quantity("loss_used", holds=_ESTIMATE, read="loss", missing=True),
    Quantity("laws", holds=[_LAW], read="choice.candidates"),
    Quantity("law_best", read="choice.best.law.name"),
    Quantity("law_chosen", read="choice.chosen.law.name"),
    Quantity("left_out", read="choice.folds"),
    Quantity("law_told", read="choice.told"),
    Quantity("rest_length", "mm", read="choice.rest_length"),
    Quantity("rest_length_told", read=lambda found: found.choice.rest_length_told()),
    Quantity("table"),
)


def band_account(found: BandFit, about: About) -> parts.Account:
    """What is reported of bands."""
    choice, alone = found.choice, found.alone
    table = band_table(found, about.source or "")
    return parts.Account(
        found,
        title="Stiffness of bands",
        kind="lab.band/1",
        schema=BAND,
        answer=f"Stiffness {number(found.stiffness.value)} N/m",
        given={"data_sha256": about.data_sha256, "table": table},
        facts=(
            parts.Fact(
                "This band, 95 %", "" if alone is None else _between(alone.stiffness, "N/m")
            ),
            parts.Fact("Rest length", _rest_length(found)),
            parts.Fact("Mean of bands, 95 %", _of_many(found.stiffness, "low", "high")),
            parts.Fact("Next band, 95 %", _of_many(found.stiffness, "next_low", "next_high")),
            parts.Fact("By sample", f"{_each(found.stiffness, '.4g')} N/m"),
            parts.Fact("Work lost in a cycle", _lost(found)),
            parts.Fact("Force law", choice.chosen.law.name),
            *_used(found.test),
        ),
        warnings=(parts.Warned("Check the recordings", "", found.test.warnings),),
        sections=(
            parts.Section(
                "Force laws",
                parts.Picture("laws", "Force against stroke, and the laws"),
                parts.RecordTable(
                    _laws(found),
                    "laws",
                    "What each law leaves of the force, and how well it predicts what was left "
                    "out; the law of the fewest numbers first.",
                    most=None,
                    more="laws",
                ),
            ),
            parts.Section(
                "Choice of the law", parts.Notes([choice.told, choice.rest_length_told()])
            ),
            parts.Section(
                "Stiffness [N/m] by window: from (down) and to (across) [mm]",
                parts.RecordTable(_ends(found), "windows", most=None, pick=_by_start),
            ),
            parts.Section("For a design file", parts.Verbatim(table.rstrip(), "Band table")),
            parts.Section("Used and dropped", parts.Notes(found.test.told)),
            parts.Section("Assumptions", parts.Text(_assumed(found))),
        ),
    )


def band_test_account(found: BandTest, about: About) -> parts.Account:
    """What a notebook shows of tension tests, without a force law."""
    estimate = stiffness(found)
    return parts.Account(
        found,
        title="Tension tests of bands",
        facts=(
            parts.Fact("Stiffness", f"{number(estimate.value)} N/m"),
            parts.Fact("Mean of bands, 95 %", _of_many(estimate, "low", "high")),
            parts.Fact("Samples", ", ".join(map(str, found.samples))),
            *_used(found),
        ),
        warnings=(parts.Warned("Check the recordings", "", found.warnings),),
        sections=(
            parts.Section("Used and dropped", parts.Notes(found.told[:3], parts.Level.CARD)),
        ),
    )


def _used(test: BandTest) -> tuple[parts.Fact, ...]:
    low, high = (number(edge * _MM) for edge in test.window)
    return (
        parts.Fact("Window", f"{low} to {high} mm of stroke, loading"),
        parts.Fact("Cycles", f"{test.cycles[0]} to {test.cycles[1]}"),
    )


def _of_many(estimate: Estimate, low: str, high: str) -> str:
    if math.isnan(estimate.low):
        return "not known: one sample shows no scatter between samples"
    return f"{getattr(estimate, low):.4g} to {getattr(estimate, high):.4g} N/m"


def _between(interval: Any, unit: str, factor: float = 1.0) -> str:
    if math.isnan(interval.low):
        return "not known: too few readings"
    return f"{interval.low * factor:.4g} to {interval.high * factor:.4g} {unit}"


def _rest_length(found: BandFit) -> str:
    length = None if found.alone is None else found.alone.rest_length
    if length is None:
        return ""
    return f"{number(length.value * _MM)} mm; 95 % {_between(length, 'mm', _MM)}"


def _each(estimate: Estimate, form: str) -> str:
    return ", ".join(f"{sample}: {value:{form}}" for sample, value in estimate.each.items())


def _lost(found: BandFit) -> str:
    loss = found.loss
    return "" if loss is None else f"{percent(loss.value)}; by sample {_each(loss, '.1%')}"


def _assumed(found: BandFit) -> str:
    if found.alone is None:
        return (
            "Intervals are Student's, from the scatter between samples, taken as independent and "
            "normal; cycles of one sample are no samples."
        )
    return (
        "Intervals are Student's, from the scatter of the readings around the law and the digits "
        "of the readings."
    )


def _laws(found: BandFit) -> list[Quantity | Column]:
    choice = found.choice
    chosen, left_out = choice.chosen.law.name, choice.folds
    # On one curve by the criterion that chose, else by what was left out.
    tried = Column("criterion above best", lambda law: number(law["above_best"], 3), True)
    if left_out != "nothing":
        tried = _milli(f"{left_out} left out [mN]", "predicts_N")
    return [
        Column("law", lambda law: law["law"] + " (chosen)" * (law["law"] == chosen)),
        *(quantity for quantity in _LAW if quantity.head),
        _milli("leaves [mN]", "leaves_N"),
        tried,
        Column("values", _values),
    ]


def _milli(heading: str, key: str) -> Column:
    return Column(heading, lambda law: number(law[key] * _MN, 3), True)


def _values(law: Mapping[str, Any]) -> str:
    def value(name: str, estimate: Mapping[str, Any]) -> str:
        if name in law["at_bound"]:
            return f"{name} not identified by the data"
        spread = "" if estimate["spread"] is None else f" ± {estimate['spread']:.2g}"
        return f"{name} {estimate['value']:.4g}{spread}"

    return "; ".join(value(name, estimate) for name, estimate in law["values"].items())


def _ends(found: BandFit) -> list[Column]:
    """A column for each end of a window, in front of them the start."""

    def column(end: float) -> Column:
        text = number(end)
        return Column(text, lambda row: number(row.get(text)), True)

    ends = sorted({window.end for window in found.windows})
    first = Column("from", lambda row: number(row["from"]), True)
    return [first, *(column(end * _MM) for end in ends)] if ends else []


def _by_start(windows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Windows as rows: where they start, and the stiffness by their end."""
    rows: dict[float, dict[str, Any]] = {}
    for one in windows:
        row = rows.setdefault(one["from_mm"], {"from": one["from_mm"]})
        row[number(one["to_mm"])] = one["k_N_per_m"]
    return [rows[start] for start in sorted(rows)]
