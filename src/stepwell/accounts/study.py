"""Studies of many designs: outcomes, and the parameters that decide them."""

from collections.abc import Sequence
from typing import Any

from stepwell.accounts import parts
from stepwell.accounts.head import About, Row, keys, recorded
from stepwell.accounts.parts import FULL, TERMINAL, Account, Fact, Notes, Picture, RecordTable
from stepwell.base import Columns, Quantity, Schema, counted, number, percent, read_off, record
from stepwell.design import Fraction
from stepwell.studies import Status, gaps_text

_GAP = keys(first=int, last=int, damaged=bool)
_FRACTION = keys(times=int, of=int, low=float, high=float, fraction=(float, "estimate"))
# Fractions of a prefilter, and the designs that they are fractions of.
_AMONG = {"alike": "drawn at random", "held": "kept", "missed": "drawn at random and not kept"}
_SCREEN: Schema = (
    Quantity("engine", read=lambda status: status.study.given["engine"]),
    Quantity("wanted", read=lambda status: status.study.given["wanted"], holds=str | int),
    *read_off(keys(designs=int, kept=int, computed=int), "screened"),
    *(Quantity(name, read=f"screened.{name}", holds=_FRACTION, missing=True) for name in _AMONG),
)
_OUTCOME: Schema = (
    Quantity("column", head="column"),
    Quantity("value", head="value"),
    Quantity("designs", head="designs", read="fraction.times", holds=int, left=False),
    Quantity(
        "fraction", head="fraction", read="fraction.estimate", holds=float, form=percent, left=False
    ),
    Quantity(
        "fraction_low", read=lambda one: one.fraction.low if one.sampled else None, holds=float
    ),
    Quantity(
        "fraction_high", read=lambda one: one.fraction.high if one.sampled else None, holds=float
    ),
)
_INFLUENCE = keys(parameter=(str, "name"), fraction=float, trend=float)
_DECIDED: Schema = (
    Quantity("column"),
    Quantity("value", read=lambda one: one.value or None, missing=True),
    *keys(designs=int, floor=float, influences=[_INFLUENCE]),
)
# A row for each parameter that decides a column.
_DECIDING: Columns = (
    Quantity("column", head="column"),
    Quantity("parameter", head="parameter"),
    Quantity("fraction", head="fraction of its variance", form=percent, left=False),
    Quantity("trend", head="rank correlation", form="+.2f", left=False),
)


def _in_unit(**read: str) -> Schema:
    """A unit, and numbers in this unit."""
    return (
        Quantity("unit", "", "unit", lambda row: row.unit or "1", lambda u: u * (u != "1")),
        *(Quantity(k, head=k, read=path, holds=float, left=False) for k, path in read.items()),
    )


# Varied parameters, of atlases too.
VARIED: Schema = (Quantity("parameter", head="parameter"), *_in_unit(**{"from": "low"}, to="high"))
_NUMBER: Schema = (
    Quantity("column", head="column"),
    *_in_unit(least="least", median="median", most="most"),
    Quantity("designs", head="designs", holds=int, left=False),
)
_INTERVAL: Schema = (
    Quantity("column", head="column"),
    Quantity("value", head="value"),
    *_in_unit(**{"from": "first"}, to="last"),
    *(
        Quantity(f"boundary_{side}", head=f"boundary {side}", read=end, holds=float, left=False)
        for side, end in (("below", "low"), ("above", "high"))
    ),
    Quantity("designs", head="designs", holds=int, left=False),
)
STUDY: Schema = (
    *keys(title=(str, "study.subject.title"), store=(str, lambda status: str(status.study.folder))),
    *read_off(keys(what=str, identity=str, how=(str, lambda of: str(of.designs.how))), "study"),
    *keys(count=(int, "study.count"), varied=[VARIED]),
    *read_off(keys(chunk=int, chunks=int), "study"),
    *keys(done=int, finished=bool, missing=([_GAP], "gaps"), problems={str: int}),
    Quantity("screen", read=lambda one: one if one.screened else None, holds=_SCREEN, missing=True),
    *keys(outcomes=[_OUTCOME], intervals=[_INTERVAL], numbers=[_NUMBER], decided=[_DECIDED]),
)


_INTERVALS = (
    "Along the varied parameter, from the first to the last design with an outcome. An exact "
    "boundary to the neighbouring interval is given where the closed form holds."
)


def status_account(status: Status, about: About) -> Account:
    """Outcomes of a study, their influences and its progress."""
    study = status.study
    # At most five parameters that influence a column with certainty, for each column.
    deciding = [
        {"column": one.column + f" = {one.value}" * bool(one.value), **record(_INFLUENCE, each)}
        for one in status.decided
        for each in one.sure[:5]
    ]
    problems = [f"{counted(n, 'design')}: {kind}" for kind, n in status.problems.items()]
    computed = f"{study.what} of {counted(study.count, 'design')}, {study.designs.how}"
    done = "all of it" if status.finished else f"{status.done} of {study.chunks} chunks"
    facts = (
        Fact("Study", computed),
        Fact("Done", done),
        Fact("Store", str(study.folder), TERMINAL),
        *_prefilter_facts(status),
    )
    influence = (
        "The fraction of a column's variance that a parameter explains by itself, and "
        "its rank correlation. Fractions that chance could produce are left out."
    )

    def table(columns: Schema, rows: Sequence[Any], more: str, about: str = "") -> RecordTable:
        return RecordTable(columns, recorded(columns, rows), about, more=more)

    sections = {
        "Outcomes": (
            Picture("outcomes", "Outcomes over the parameters that decide them"),
            table(_OUTCOME, status.outcomes, "outcomes", "The most frequent first."),
        ),
        "Intervals of the outcomes": table(_INTERVAL, status.intervals, "intervals", _INTERVALS),
        "Influence of each number": (
            Picture("influences", "Fraction of the variance that each parameter explains"),
            RecordTable(_DECIDING, lambda: deciding, influence),
        ),
        "Range of each result": table(_NUMBER, status.numbers, "results"),
        "Varied parameters": table(VARIED, status.varied, "parameters"),
        "Assumptions": Notes(_assumptions(status), FULL),
    }
    missing = [gaps_text(status.gaps, study.count)] if status.gaps else []
    warned = (
        parts.Warned("Missing designs", "", missing),
        parts.Warned("Designs that could not be computed", "", problems),
    )
    hints = [] if status.finished else [f"Continue with: stepwell sweep resume {study.folder}"]
    options = {"seed": study.designs.seed, "packages": ["zarr"], "hints": hints}
    title = study.subject.title or "A study"
    return Account(
        status, title, "study/1", _answer(status, deciding), facts, sections, warned, **options
    )


def _answer(status: Status, deciding: Sequence[Row]) -> str:
    """The most frequent outcome; or else the strongest influence, or the range of a result."""
    if status.outcomes:
        first = status.outcomes[0]
        fraction = _fraction(first.fraction, first.sampled, " of the designs")
        return f"{fraction} have {first.column} {first.value}"
    if deciding:
        row = deciding[0]
        variance = f"{percent(row['fraction'])} of the variance of {row['column']}"
        return f"{row['parameter']} explains {variance}"
    for one in status.numbers:
        if one.designs:
            low, middle, high = map(number, (one.least, one.median, one.most))
            unit = f" {one.unit}" * (one.unit not in ("", "1"))
            return f"{one.column} {low} to {high}{unit}, median {middle}{unit}"
    return f"{status.done} of {counted(status.study.chunks, 'chunk')} done, no results"


def _fraction(fraction: Fraction, sampled: bool = True, of: str = "") -> str:
    """A fraction, with its interval if the designs are a sample."""
    ends = f" (95 % confidence {percent(fraction.low)} to {percent(fraction.high)})"
    return f"{percent(fraction.estimate)}{of}{ends * sampled}"


def _prefilter_facts(status: Status) -> list[Fact]:
    """Agreement of the prefilter with the designs that were computed."""
    of = status.screened
    if of is None:
        return []
    engine, computed = status.study.given["engine"], f"{of.computed} were computed"
    facts = [Fact("Screen", f"{engine} keeps {of.kept} of {of.designs}; {computed}")]
    for name, among in _AMONG.items():
        if (one := getattr(of, name)) is not None:
            text = f"{one.times} of {one.of} {among}: {_fraction(one)}"
            facts.append(Fact(name.capitalize(), text))
    return facts


# How parameters vary in a study, by the way in which its designs were chosen.
_VARIED = {
    "listed": "The designs were listed; parameters that vary together have one common fraction.",
    "as built": "The designs are samples of the mechanism within its tolerances.",
}


def _assumptions(status: Status) -> list[str]:
    evenly = "Each parameter varies independently and evenly between its bounds."
    notes = {
        _VARIED.get(status.study.designs.how, evenly): True,
        "Effects of several parameters together count for none of them. A fraction below the "
        "floor is not shown: chance alone exceeds the floor in one of 20 studies.": status.decided,
        "Intervals hold for designs drawn independently, 95 % (Clopper and Pearson); with "
        "a Sobol' sequence or a Latin hypercube the error is mostly smaller.": any(
            one.sampled for one in status.outcomes
        ),
        "A prefilter in single precision chose the designs that were computed; further designs "
        "were drawn at random. Fractions are those of the designs drawn, all other numbers "
        "those of all designs that were computed.": status.screened,
    }
    return [note for note, applies in notes.items() if applies]
