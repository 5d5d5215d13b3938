"""A yield: how many samples within tolerances reproduce the target, and what the others do."""

from __future__ import annotations

from dataclasses import replace
from operator import itemgetter
from typing import TYPE_CHECKING

from stepwell.accounts.account import (
    Account,
    Fact,
    Level,
    Part,
    Picture,
    Section,
    Table,
    Text,
    Warned,
)
from stepwell.accounts.head import CALIBRATED, About
from stepwell.accounts.shape import Shape
from stepwell.accounts.tolerances import (
    FORCE_PLANE,
    OUTCOMES,
    counted_facts,
    counted_schema,
)
from stepwell.accounts.words import assumed, calibration, cells_of
from stepwell.base import Column, Quantity, Schema, in_measure, percent, record

if TYPE_CHECKING:
    from stepwell.design import Yield

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
        Quantity("wanted"),
        Quantity("wanted_states", read="states", holds=[str], missing=True),
        *counted_schema(shape),
        Quantity("seed", holds=int),
        Quantity("outcomes", read=lambda found: [*found.outcomes.items()], holds=[_OUTCOME]),
        Quantity("critical", holds=_CRITICAL, missing=True),
        Quantity("by_engine", holds=int),
        Quantity("robust", holds=float),
        Quantity("proved", holds=int, missing=True),
        Quantity("assumptions"),
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
    Quantity("first", holds=int),
    Quantity("second", holds=int),
    Quantity("names", holds=[str]),
    Quantity("while", read="way"),
    Quantity("share", holds=float),
    Quantity("narrowest", holds=float),
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


def yield_account(found: Yield, about: About | None = None) -> Account:
    """What is reported of a yield."""
    chain, about = found.chain, about or About(found.chain)
    target = "target sequence" if found.states is None else "target states and no others"
    return Account(
        value=found,
        kind="yield/1",
        schema=yield_schema(Shape.of(chain)),
        title=chain.title or "A yield",
        origin=f"{cells_of(chain)}.",
        answer=f"{percent(found.share)} of the samples reproduce the {target}",
        about=about,
        seed=found.seed,
        given={"calibrated": about.calibrated},
        facts=(
            Fact("Target", found.wanted),
            *counted_facts(found),
            critical_fact(found),
        ),
        warnings=(advised(found),),
        sections=(
            Section(
                "Outcomes of the samples",
                [
                    Picture("yield", OUTCOMES),
                    Picture("force-plane", FORCE_PLANE),
                    other_outcomes(found),
                ],
            ),
            Section("Variance of the smallest gap, by part", _sensitivities(found)),
            calibration(about),
            assumed(chain, found.assumptions),
        ),
    )


def critical_fact(found: Yield) -> Fact:
    """The two cells whose order is reversed first."""
    return Fact("Critical order", "" if found.critical is None else str(found.critical))


def advised(found: Yield) -> Warned:
    """Why no sample reproduces the target, and what to ask for instead."""
    return Warned("No sample reproduces the target", "", [found.advice] if found.advice else [])


def other_outcomes(found: Yield) -> Table:
    """What the samples do that do not reproduce the target."""
    return Table(
        [
            Column("other outcome", itemgetter("outcome")),
            Column("fraction", lambda row: percent(row["count"] / found.n), True),
        ],
        lambda: [{"outcome": text, "count": n} for text, n in found.outcomes.items()],
        "Outcomes of the samples that do not reproduce the target, most frequent first.",
        most=_MOST_ROWS,
        more="outcomes",
        level=Level.CARD,
    )


def _sensitivities(found: Yield) -> list[Part]:
    rows = sorted(_parts(found) or (), key=itemgetter(2), reverse=True)
    agreed = _of_gap(found, "agreed")
    return [
        Table(
            _PART,
            lambda: [record(_PART, row) for row in rows],
            "The fraction of the variance of the smallest gap between two switching forces that "
            "the tolerance of each part causes, alone and with others (Sobol' indices).",
            most=_MOST_ROWS,
            more="parts",
        ),
        Text(
            ""
            if agreed is None
            else "The sign of the smallest gap agrees with the outcome that the engine computes "
            f"in {percent(agreed)} of the samples"
        ),
    ]
