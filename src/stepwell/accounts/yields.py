"""Samples within tolerances: how many reproduce the target, or end where a program leads."""

from __future__ import annotations

from dataclasses import replace
from operator import itemgetter
from typing import TYPE_CHECKING

from stepwell.accounts import parts
from stepwell.accounts.head import CALIBRATED, About, Shape
from stepwell.accounts.words import assumed, calibration, cells_of, turning_points
from stepwell.base import Column, Quantity, Schema, in_measure, number, percent, quantities, record
from stepwell.mechanism import Chain

if TYPE_CHECKING:
    from stepwell.design import Survival, Tolerances, Yield


# Captions of the figures of samples.
OUTCOMES = "Outcomes of the samples"
FORCE_PLANE = "Switching forces of each cell, nominal and in samples"


def counted_schema(shape: Shape) -> Schema:
    """What is counted of samples, and within which tolerances."""
    return (
        Quantity("share", holds=float),
        Quantity("share_low", holds=float, read=lambda found: found.interval[0]),
        Quantity("share_high", holds=float, read=lambda found: found.interval[1]),
        *quantities(samples=int, successes=int, tolerances=tolerance_schema(shape)),
    )


def tolerance_schema(shape: Shape) -> Schema:
    """The tolerances of a chain; each kind of cell has its own."""
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
        Quantity("mobility", head="mobility ratio up to ", read=_ratio, holds=float),
    )
    return in_measure(schema, shape.measure)


def _ratio(tolerances: Tolerances) -> float | None:
    return tolerances.mobility if tolerances.mobility > 1 else None


def tolerance_words(given: Tolerances, chain: Chain) -> str:
    """The tolerances of a chain in words."""
    schema = tolerance_schema(Shape.of(chain))
    found = record(schema, given)
    words = [f"{q.head}{number(found[q.key])} {q.sign}".strip() for q in schema if found[q.key]]
    return ", ".join(words) or "no tolerance"


def yield_words(found: Yield | Survival) -> str:
    """The share of samples that reproduce the target, with its confidence interval."""
    low, high = map(percent, found.interval)
    return f"{percent(found.share)}, with 95 % confidence {low} to {high}"


def sample_words(found: Yield | Survival) -> str:
    """How many samples were made, and within which tolerances."""
    return f"{found.samples} samples with {tolerance_words(found.tolerances, found.chain)}"


def counted_facts(found: Yield | Survival) -> tuple[parts.Fact, ...]:
    """The facts that yields and survivals share."""
    return (
        parts.Fact("Yield", yield_words(found)),
        parts.Fact("Successes", f"{found.successes} of {found.samples}", parts.Level.PAGE),
        parts.Fact("Samples", sample_words(found)),
    )


_MOST_ROWS = 12


def yield_schema(shape: Shape) -> Schema:
    """What is reported of a yield."""
    return (
        Quantity("title", read="chain.title"),
        Quantity("cells", read="chain.names", holds=[str]),
        *inner_yield_schema(shape),
        Quantity("calibrated", holds=CALIBRATED, missing=True),
    )


def inner_yield_schema(shape: Shape) -> Schema:
    """A yield within another record."""
    return (
        Quantity("target"),
        Quantity("target_states", read="states", holds=[str], missing=True),
        *counted_schema(shape),
        Quantity("seed", holds=int),
        Quantity("outcomes", read=lambda found: [*found.outcomes.items()], holds=[_OUTCOME]),
        Quantity("critical", holds=_CRITICAL, missing=True),
        *quantities(by_engine=int, robust=float, proved=int | None, assumptions=str),
        *in_measure([_DEVIATION], shape.measure),
        Quantity("advice"),
        Quantity("gap_agreement", holds=float, read=lambda found: _of_gap(found, "agreed")),
        Quantity("sensitivities", holds=[_PART], read=_parts, missing=True),
    )


_OUTCOME: Schema = (
    Quantity("outcome", read=itemgetter(0)),
    Quantity("count", read=itemgetter(1), holds=int),
)
_CRITICAL: Schema = (
    *quantities(first=int, second=int, names=[str]),
    Quantity("while", read="way"),
    *quantities(share=float, narrowest=float),
)


def _fraction(value: float) -> str:
    # An estimate may be a little below zero.
    return f"{max(0.0, value):.2f}"


_INDEX = Quantity("", form=_fraction, holds=float, left=False)
_PART: Schema = (
    Quantity("part", head="part", read=itemgetter(0)),
    replace(_INDEX, name="first_order", head="alone", read=itemgetter(1)),
    replace(_INDEX, name="total", head="with others", read=itemgetter(2)),
)
_DEVIATION = Quantity("gap_deviation", "N", read=lambda found: _of_gap(found, "deviation"))


def _of_gap(found: Yield, name: str) -> float | None:
    table = found.sensitivities
    return None if table is None else getattr(table, name)


def _parts(found: Yield) -> list[tuple[str, float, float]] | None:
    table = found.sensitivities
    if table is None:
        return None
    return [*zip(table.parameters, table.first_order, table.total, strict=True)]


def yield_account(found: Yield, about: About) -> parts.Account:
    """What is reported of a yield."""
    chain = found.chain
    target = "target sequence" if found.states is None else "target states and no others"
    return parts.Account(
        value=found,
        kind="yield/2",
        schema=yield_schema(Shape.of(chain)),
        title=chain.title or "A yield",
        origin=f"{cells_of(chain)}.",
        answer=f"{percent(found.share)} of the samples reproduce the {target}",
        seed=found.seed,
        facts=(parts.Fact("Target", found.target), *counted_facts(found), critical_fact(found)),
        warnings=(advised(found),),
        sections=(
            parts.Section(
                "Outcomes of the samples",
                parts.Picture("yield", OUTCOMES),
                parts.Picture("force-plane", FORCE_PLANE),
                other_outcomes(found),
            ),
            parts.Section("Variance of the smallest gap, by part", *_sensitivities(found)),
            calibration(about),
            assumed(chain, found.assumptions),
        ),
    )


def critical_fact(found: Yield) -> parts.Fact:
    """The two cells whose order is reversed first."""
    return parts.Fact("Critical order", "" if found.critical is None else str(found.critical))


def advised(found: Yield) -> parts.Warned:
    """Why no sample reproduces the target, and what to ask for instead."""
    return parts.Warned(
        "No sample reproduces the target", "", [found.advice] if found.advice else []
    )


def other_outcomes(found: Yield) -> parts.RecordTable:
    """What the samples do that do not reproduce the target."""
    return parts.RecordTable(
        [
            Column("other outcome", itemgetter("outcome")),
            Column("fraction", lambda row: percent(row["count"] / found.samples), True),
        ],
        lambda: [{"outcome": text, "count": n} for text, n in found.outcomes.items()],
        "Outcomes of the samples that do not reproduce the target, most frequent first.",
        most=_MOST_ROWS,
        more="outcomes",
        level=parts.Level.CARD,
    )


def _sensitivities(found: Yield) -> list[parts.Part]:
    rows = sorted(_parts(found) or (), key=itemgetter(2), reverse=True)
    agreed = _of_gap(found, "agreed")
    return [
        parts.RecordTable(
            _PART,
            lambda: [record(_PART, row) for row in rows],
            "The fraction of the variance of the smallest gap between two switching forces that "
            "the tolerance of each part causes, alone and with others (Sobol' indices).",
            most=_MOST_ROWS,
            more="parts",
        ),
        parts.Text(
            ""
            if agreed is None
            else "The sign of the smallest gap agrees with the outcome that the engine computes "
            f"in {percent(agreed)} of the samples"
        ),
    ]


def survival_schema(shape: Shape) -> Schema:
    """What is reported of a survival."""
    return (
        Quantity("title", read="chain.title"),
        Quantity("cells", read="chain.names", holds=[str]),
        Quantity("from", read="start"),
        Quantity("target"),
        Quantity("turning_points", shape.drive, holds=[float]),
        *counted_schema(shape),
        *quantities(seed=int, assumptions=str),
        Quantity("calibrated", holds=CALIBRATED, missing=True),
    )


def survival_account(found: Survival, about: About) -> parts.Account:
    """What is reported of a survival."""
    chain = found.chain
    return parts.Account(
        value=found,
        kind="survival/2",
        schema=survival_schema(Shape.of(chain)),
        title=chain.title or "A program with tolerances",
        origin=f"{cells_of(chain)}.",
        answer=f"The program ends in {found.target} in {percent(found.share)} of the samples",
        seed=found.seed,
        facts=(
            parts.Fact("Target", f"{found.start} to {found.target} by the program"),
            parts.Fact("Turning points", turning_points(found.turning_points, chain)),
            *counted_facts(found),
        ),
        sections=(calibration(about), assumed(chain, found.assumptions)),
    )
