"""Samples within tolerances: the fraction that reproduces a target or a program."""

from dataclasses import replace
from operator import itemgetter
from typing import Any

from stepwell.accounts.head import CALIBRATED, About, DesignShape, keys, recorded
from stepwell.accounts.parts import CARD, FULL, Account, Fact, Picture, RecordTable, Text, Warned
from stepwell.accounts.words import assumed, calibration, cells_of, scattered, turning_points
from stepwell.base import Column, Quantity, Schema, in_measure, number, percent, record
from stepwell.design import CellTolerances, Survival, Tolerances, Yield
from stepwell.mechanism import Chain

# The figures of samples.
PICTURES = (
    Picture("yield", "Outcomes of the samples"),
    Picture("force-plane", "Switching forces of each cell, nominal and in samples"),
)
CHAIN = keys(title=(str, "chain.title"), cells=([str], "chain.names"))
_OUTCOME = keys(outcome=(str, itemgetter(0)), count=(int, itemgetter(1)))
_CRITICAL: Schema = (
    *keys(first=int, second=int, names=[str]),
    Quantity("while", read="way"),
    *keys(fraction=float, narrowest=float),
)
# An estimate may be a little below zero.
_INDEX = Quantity("", form=lambda at: f"{max(0.0, at):.2f}", holds=float, left=False)
_PART: Schema = (
    Quantity("part", head="part", read=itemgetter(0)),
    replace(_INDEX, name="first_order", head="alone", read=itemgetter(1)),
    replace(_INDEX, name="total", head="with others", read=itemgetter(2)),
)


def counted_schema(shape: DesignShape) -> Schema:
    """What is counted of samples, and within which tolerances."""
    low, high = (lambda result, k=k: result.interval[k] for k in (0, 1))
    return (
        *keys(fraction=float, fraction_low=(float, low), fraction_high=(float, high)),
        *keys(samples=int, successes=int, tolerances=tolerance_schema(shape)),
    )


def tolerance_schema(shape: DesignShape) -> Schema:
    """The tolerances of a chain; each kind of cell has its own."""

    def common(quantity: Quantity) -> Any:
        def read(tolerances: Tolerances) -> float | None:
            value = quantity.of(tolerances)
            return None if isinstance(value, tuple) else value

        return read

    own = _cell_tolerances(shape)
    return (
        *(replace(one, read=common(one)) for one in own),
        Quantity("mobility", head="mobility ratio up to ", read=_ratio, holds=float),
        Quantity("by_cell", read=_by_cell, holds=[own], missing=True),
    )


def _ratio(tolerances: Tolerances) -> float | None:
    return tolerances.mobility if tolerances.mobility > 1 else None


def _by_cell(tolerances: Tolerances) -> list[CellTolerances] | None:
    return [*tolerances.each(tolerances.cells)] or None


def _cell_tolerances(shape: DesignShape) -> Schema:
    """The tolerances of a cell."""
    of_levers = (
        Quantity("anchor", "mm", "anchors ±"),
        Quantity("stiffness", "percent", "stiffness ±"),
        Quantity("rest_length", "percent", "rest length ±"),
        Quantity("lever", "mm", "levers ±"),
    )
    schema = (
        *(of_levers if shape.levers else [Quantity("stiffness", "percent", "force ±")]),
        Quantity("friction", "N", "friction up to "),
        *([Quantity("travel", "percent", "travel ±")] if shape.elements else ()),
    )
    return in_measure(schema, shape.measure)


def tolerance_words(given: Tolerances, chain: Chain) -> str:
    """The tolerances of a chain in words."""
    schema = _cell_tolerances(DesignShape.of(chain))
    rows = [record(schema, one) for one in given.each(given.cells or 1)]
    words = [
        f"{q.head}{_of_cells([number(row[q.key]) for row in rows])} {q.sign}".strip()
        for q in schema
        if any(row[q.key] for row in rows)
    ]
    if given.mobility > 1:
        words.append(f"mobility ratio up to {number(given.mobility)}")
    return ", ".join(words) or "no tolerance"


def _of_cells(texts: list[str]) -> str:
    """What all cells have, or what each has."""
    return " / ".join(texts if len({*texts}) > 1 else texts[:1])


def yield_words(result: Yield | Survival) -> str:
    """The fraction of samples that reproduce the target, with its confidence interval."""
    low, high = map(percent, result.interval)
    return f"{percent(result.fraction)}, with 95 % confidence {low} to {high}"


def sample_words(result: Yield | Survival) -> str:
    """The number of samples, and their tolerances."""
    return f"{result.samples} samples with {tolerance_words(result.tolerances, result.chain)}"


def counted_facts(result: Yield | Survival) -> tuple[Fact, ...]:
    """The facts that yields and survivals share."""
    return (
        Fact("Yield", yield_words(result)),
        Fact("Successes", f"{result.successes} of {result.samples}", FULL),
        Fact("Samples", sample_words(result)),
    )


def yield_schema(shape: DesignShape) -> Schema:
    """What is reported of a yield."""
    return (*CHAIN, *inner_yield_schema(shape), CALIBRATED)


def inner_yield_schema(shape: DesignShape) -> Schema:
    """A yield within another record."""
    return (
        Quantity("target"),
        Quantity("target_states", read="states", holds=[str], missing=True),
        *counted_schema(shape),
        *keys(seed=int, outcomes=([_OUTCOME], lambda result: [*result.outcomes.items()])),
        Quantity("critical", holds=_CRITICAL, missing=True),
        *keys(by_engine=int, robust=float, proved=int | None, assumptions=str),
        *in_measure(keys(gap_deviation=("N", _of_gap("deviation"))), shape.measure),
        *keys(advice=str, gap_agreement=(float, _of_gap("agreed"))),
        Quantity("sensitivities", holds=[_PART], read=_parts, missing=True),
    )


def _of_gap(name: str) -> Any:
    return lambda result: result.sensitivities and getattr(result.sensitivities, name)


def _parts(result: Yield) -> list[tuple[str, float, float]] | None:
    table = result.sensitivities
    return table and [*zip(table.parameters, table.first_order, table.total, strict=True)]


def yield_account(result: Yield, about: About) -> Account:
    """What is reported of a yield."""
    target = "target sequence" if result.states is None else "target states and no others"
    answer = f"{percent(result.fraction)} of the samples reproduce the {target}"
    facts = (Fact("Target", result.target), *counted_facts(result), critical_fact(result))
    sections = {
        "Outcomes of the samples": (*PICTURES, other_outcomes(result)),
        "Variance of the smallest gap, by part": _sensitivities(result),
    }
    report = Account(result, "A yield", "yield/2", answer, facts, sections, [advised(result)])
    return _of_samples(report, about)


def _of_samples(report: Account, about: About) -> Account:
    chain, value = report.value.chain, report.value
    sections = {**report.sections, **calibration(about), **assumed(chain, value.assumptions)}
    title, origin = chain.title or report.title, f"{cells_of(chain)}."
    warnings = [*report.warnings, scattered(chain)]
    report = replace(report, warnings=warnings, seed=value.seed)
    return replace(report, title=title, origin=origin, sections=sections)


def critical_fact(result: Yield) -> Fact:
    """The two cells whose order is reversed most easily."""
    return Fact("Critical order", "" if result.critical is None else str(result.critical))


def advised(result: Yield) -> Warned:
    """Why no sample reproduces the target, and a target that samples reproduce."""
    return Warned("No sample reproduces the target", "", list(filter(None, [result.advice])))


def other_outcomes(result: Yield) -> RecordTable:
    """Outcomes of the samples that do not reproduce the target."""
    return RecordTable(
        [
            Column("other outcome", itemgetter("outcome")),
            Column("fraction", lambda row: percent(row["count"] / result.samples), True),
        ],
        recorded(_OUTCOME, result.outcomes.items()),
        "Outcomes of the samples that do not reproduce the target, most frequent first.",
        more="outcomes",
        level=CARD,
    )


def _sensitivities(result: Yield) -> tuple[RecordTable, Text]:
    rows = sorted(_parts(result) or (), key=itemgetter(2), reverse=True)
    about = (
        "The fraction of the variance of the smallest gap between two switching forces that the "
        "tolerance of each part causes, alone and with others (Sobol' indices)."
    )
    agreed = _of_gap("agreed")(result)
    fraction = "" if agreed is None else percent(agreed)
    checked = "Sign of the smallest gap agrees with the simulated outcome in"
    table = RecordTable(_PART, recorded(_PART, rows), about)
    return table, Text(f"{checked} {fraction} of the samples" if fraction else "")


def survival_schema(shape: DesignShape) -> Schema:
    """What is reported of a survival."""
    return (
        *CHAIN,
        Quantity("from", read="start"),
        Quantity("target"),
        Quantity("turning_points", shape.drive, holds=[float]),
        *counted_schema(shape),
        *keys(seed=int, assumptions=str),
        CALIBRATED,
    )


def survival_account(result: Survival, about: About) -> Account:
    """What is reported of a survival."""
    answer = f"The program ends in {result.target} in {percent(result.fraction)} of the samples"
    facts = (
        Fact("Target", f"{result.start} to {result.target} by the program"),
        Fact("Turning points", turning_points(result.turning_points, result.chain)),
        *counted_facts(result),
    )
    report = Account(result, "A program with tolerances", "survival/2", answer, facts)
    return _of_samples(report, about)
