"""Tension tests of bands: stiffness with its uncertainty, losses, and the force law."""

import math
from typing import Any

from stepwell.accounts import parts
from stepwell.accounts.head import About, Row, keys
from stepwell.accounts.parts import CARD, FULL, Account, Fact, Notes, Picture, RecordTable, Text
from stepwell.accounts.words import folded_notes
from stepwell.base import Column, Quantity, Schema, join_first, number, percent, read_off
from stepwell.lab import BandFit, BandTest, Estimate, band_table, stiffness

_MM, _MN = Quantity("stroke", "mm").factor, Quantity("force", "mN").factor
_ONE_SAMPLE = "one sample shows no scatter between samples"
_ESTIMATE: Schema = (
    *keys(value=float, low=float, high=float, next_low=float, next_high=float, spread=float),
    Quantity("each", holds={str: float}, read=lambda one: {str(k): v for k, v in one.each.items()}),
)
_INTERVAL = keys(value=float, low=float, high=float)
_ALONE: Schema = (
    Quantity("readings", holds=int),
    Quantity("stiffness", "N/m", holds=_INTERVAL),
    Quantity("rest_length", "mm", holds=_INTERVAL, missing=True),
)
_WRONG = keys(law=str, stroke="mm", measured="N", predicted="N", error="N", start="mm", end="mm")
_WINDOW = keys(**{"from": ("mm", "start")}, to=("mm", "end"), k=("N/m", "stiffness"))
_LOSS = keys(sample=int, cycle=int, loss=float)
_LAW: Schema = (
    Quantity("law", read="law.name"),
    Quantity("numbers", head="numbers", read="parameters", holds=int, left=False),
    *keys(leaves=("N", "fitted.rmse"), predicts=("N", "score")),
    *keys(values=({str: _ESTIMATE}, "estimates"), at_bound=([str], "fitted.at_bound")),
    *keys(above_best=float),
)


def _losses(fit: BandFit) -> list[Any]:
    """The cycles that unload, sample by sample."""
    measured = [loop for loop in fit.test.loops if not math.isnan(loop.loss)]
    return sorted(measured, key=lambda loop: (loop.sample, loop.cycle))


BAND: Schema = (
    *keys(data_sha256={str: str}, warnings=[str]),
    Quantity("window", "mm", holds=[float], read="test.window"),
    *read_off(keys(cycles=[int], samples=[int], notes=[str]), "test"),
    Quantity("stiffness", "N/m", holds=_ESTIMATE),
    Quantity("this_band", holds=_ALONE, read="alone", missing=True),
    *keys(windows=[_WINDOW], loss=([_LOSS], _losses)),
    Quantity("loss_used", holds=_ESTIMATE, read="loss", missing=True),
    *keys(laws=([_LAW], "choice.candidates"), law_best=(str, "choice.best.law.name")),
    *keys(law_chosen=(str, "choice.chosen.law.name"), left_out=(str, "choice.folds")),
    *keys(law_reason=(str, "choice.reason"), rest_length=("mm", "choice.rest_length")),
    *keys(rest_length_reason=(str, lambda fit: fit.choice.rest_length_reason()), table=str),
    Quantity("law_wrong", holds=_WRONG, read="wrong", missing=True),
)


def band_fit_account(fit: BandFit, about: About) -> Account:
    """Stiffness, losses and force law of bands."""
    choice, alone, mean, loss = fit.choice, fit.alone, fit.stiffness, fit.loss
    table = band_table(fit, about.source or "")
    length, rest = alone and alone.rest_length, ""
    if length:
        ends = _between(length.low * _MM, length.high * _MM, "mm")
        rest = f"{number(length.value * _MM)} mm; 95 % {ends}"
    own = fit.written is not choice.chosen
    if own:
        rest += f"; by the {choice.chosen.law.name} law" * bool(rest)
    alone_ends = _between(alone.stiffness.low, alone.stiffness.high, "N/m") if alone else ""
    lost = f"{percent(loss.value)}; by sample {_each(loss, '.1%')}" if loss else ""
    facts = (
        Fact("This band, 95 %", alone_ends),
        Fact("Rest length", rest or ("" if choice.gauge else "not known: give --gauge LENGTH")),
        Fact("Law written", _written_words(fit) if own else ""),
        *_interval_facts(mean),
        Fact("By sample", f"{_each(mean, '.4g')} N/m" if len(mean.each) > 1 else ""),
        Fact("Work lost in a cycle", lost),
        Fact("Force law", _law_words(fit)),
        _window_fact(fit.test),
    )
    laws = (
        "Residual force of each law, and its error in predicting the data left out; laws with "
        "fewest parameters first."
    )
    scatter = (
        "the scatter between samples, taken as independent and normal; cycles of one sample do "
        "not count."
    )
    if alone:
        scatter = "the scatter of the readings around the law and the digits of the readings."
    sections = {
        "For a design file": parts.Verbatim(table.splitlines()[-1], "Band table"),
        "Force laws": (
            Picture("laws", "Force against stroke, and the laws"),
            RecordTable(_law_columns(fit), "laws", laws, level=FULL),
        ),
        **folded_notes("Notes on the recordings", fit.test.notes),
        "Choice of the law": Notes([choice.reason, choice.rest_length_reason()], FULL),
        "Stiffness [N/m] by window: from (down) and to (across) [mm]": _window_table(fit),
        "Band table with its source": parts.Verbatim(table.rstrip(), "Band table", FULL),
        "Assumptions": Text(f"Intervals are Student's, from {scatter}", FULL),
    }
    title, answer = "Stiffness of bands", f"Stiffness {number(mean.value)} N/m"
    warned = [parts.Warned("Check the recordings", "", fit.warnings)]
    given = {"table": table}
    return Account(fit, title, "lab.band/2", answer, facts, sections, warned, given=given)


def band_test_account(test: BandTest, about: About) -> Account:
    """Card of tension tests in a notebook, without a force law."""
    mean = stiffness(test)
    facts = (
        Fact("Stiffness", f"{number(mean.value)} N/m"),
        _interval_facts(mean)[0],
        Fact("Samples", ", ".join(map(str, test.samples))),
        _window_fact(test),
    )
    warnings = [parts.Warned("Check the recordings", "", test.warnings)]
    sections = {"Notes on the recordings": Notes(test.notes[:3], CARD)}
    title = "Tension tests of bands"
    return Account(test, title, facts=facts, warnings=warnings, sections=sections)


def _window_fact(test: BandTest) -> Fact:
    low, high = (number(edge * _MM) for edge in test.window)
    cycles = " to ".join(map(str, dict.fromkeys(test.cycles)))
    return Fact("Window", f"{low} to {high} mm of stroke, loading, cycles {cycles}")


def _interval_facts(mean: Estimate) -> list[Fact]:
    """Intervals of the mean of bands and of one more band; one fact if they are not known."""
    ends = {"Mean of bands": (mean.low, mean.high), "Next band": (mean.next_low, mean.next_high)}
    facts = [
        Fact(f"{name}, 95 %", _between(*two, "N/m", _ONE_SAMPLE)) for name, two in ends.items()
    ]
    return facts[: 1 if math.isnan(mean.low) else 2]


def _law_words(fit: BandFit) -> str:
    """The chosen law, and the residual of every law."""
    chosen = fit.choice.chosen
    others = [one for one in fit.choice.candidates if one is not chosen]
    left = {one.law.name: number(one.fitted.rmse * _MN, 3) for one in (chosen, *others)}
    rest = ", ".join(f"{one.law.name} {left[one.law.name]}" for one in others)
    return f"{chosen.law.name}, leaves {left[chosen.law.name]} mN" + (f" ({rest})" if rest else "")


def _written_words(fit: BandFit) -> str:
    """The law of the line to copy, with the rest length that belongs to it."""
    rest = fit.choice.gauge
    length = (
        "" if rest is None else f", rest length {(rest + fit.written.fitted.onset) * _MM:.5g} mm"
    )
    return f"{fit.written.law.name}{length}, leaves {number(fit.written.fitted.rmse * _MN, 3)} mN"


def _between(low: float, high: float, unit: str, lacking: str = "too few readings") -> str:
    return f"not known: {lacking}" if math.isnan(low) else f"{low:.4g} to {high:.4g} {unit}"


def _each(estimate: Estimate, form: str) -> str:
    return join_first([f"{sample}: {value:{form}}" for sample, value in estimate.each.items()], 6)


def _law_columns(fit: BandFit) -> list[Quantity | Column]:
    """The columns of the table of laws, the fitted values last."""
    choice = fit.choice
    chosen, left_out = choice.chosen.law.name, choice.folds
    # Laws of a single curve are compared by a criterion, else by the error in data left out.
    tried = Column("criterion above best", lambda law: number(law["above_best"], 3), True)
    if left_out != "nothing":
        heading = f"{left_out} left out [mN]"
        tried = Column(heading, lambda law: number(law["predicts_N"] * _MN, 3), True)
    return [
        Column("law", lambda law: law["law"] + " (chosen)" * (law["law"] == chosen)),
        *(quantity for quantity in _LAW if quantity.head),
        Column("leaves [mN]", lambda law: number(law["leaves_N"] * _MN, 3), True),
        tried,
        Column("values", _parameter_values),
    ]


def _parameter_values(law: Row) -> str:
    def value(name: str, estimate: Row) -> str:
        if name in law["at_bound"]:
            return f"{name} not identified by the data"
        spread = "" if estimate["spread"] is None else f" ± {estimate['spread']:.2g}"
        return f"{name} {estimate['value']:.4g}{spread}"

    return "; ".join(value(name, estimate) for name, estimate in law["values"].items())


def _window_table(fit: BandFit) -> RecordTable:
    """Stiffness by the start of a window, in a column for each end."""
    rows: dict[float, dict[str, float]] = {}
    for one in sorted(fit.windows):
        row = rows.setdefault(one.start, {"from": one.start * _MM})
        row[number(one.end * _MM)] = one.stiffness
    ends = [number(end * _MM) for end in sorted({one.end for one in fit.windows})]
    columns = [
        Column(end, lambda row, end=end: number(row.get(end)), True)
        for end in (["from", *ends] if ends else [])
    ]
    return RecordTable(columns, lambda: [*rows.values()], level=FULL)
