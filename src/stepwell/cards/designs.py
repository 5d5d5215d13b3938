"""Cards of designs: found, judged, changed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from stepwell.base import Column, Quantity, percent, record
from stepwell.cards.html import Card
from stepwell.results import (
    ATLAS_MACHINES,
    atlas_assumed,
    atlas_facts,
    atlas_record,
    built_schema,
    tolerance_words,
)

if TYPE_CHECKING:
    from stepwell.design import (
        Design,
        Impossible,
        Reprogramming,
        Robustness,
        Survival,
        Yield,
    )
    from stepwell.studies import Atlas


def _shares(found: Yield | Survival) -> dict[str, str]:
    low, high = map(percent, found.interval)
    return {
        "works": f"{percent(found.share)}, with 95 % confidence {low} to {high}",
        "made": f"{found.n} mechanisms with {tolerance_words(found.tolerances, found.chain)}",
    }


def _outcomes(outcomes: Mapping[str, int], n: int) -> dict[str, Any]:
    rows = [{"outcome": text, "share": count / n} for text, count in outcomes.items()]
    columns = (
        Quantity("outcome", head="what the others do"),
        Column("share", lambda row: percent(row["share"]), True),
    )
    return {"columns": columns, "rows": rows, "more": "outcomes"}


def _yield(found: Yield) -> Card:
    return Card(
        f"Yield of {found.chain.title}" if found.chain.title else "Yield",
        [f"Wanted: {found.wanted}.", found.advice or ""],
        _shares(found),
        **_outcomes(found.outcomes, found.n),
    )


def _survival(found: Survival) -> Card:
    return Card(f"Survival of a program from {found.start} to {found.ends}", (), _shares(found))


def _design(found: Design) -> Card:
    chain = found.chain
    schema = built_schema(chain)
    rows = [
        record(schema, cell, name=name) for cell, name in zip(chain.cells, chain.names, strict=True)
    ]
    return Card(
        chain.title or f"A design for {found.sequence}",
        [f"{found.method}."],
        _shares(found.yield_),
        schema,
        rows,
        "cells",
    )


def _impossible(why: Impossible) -> Card:
    proved = "This is proved." if why.proved else "A search found none; that is no proof."
    return Card("No such design", [str(why), proved])


def _robustness(found: Robustness) -> Card:
    return Card("Robustness", [f"{found}."])


def _reprogramming(found: Reprogramming) -> Card:
    return Card(f"Reprogramming by {found.by}", str(found).splitlines())


def _atlas(found: Atlas) -> Card:
    told = atlas_record(found)
    return Card(
        f"Atlas of {told['cells']} cells",
        [atlas_assumed(told)],
        atlas_facts(told),
        ATLAS_MACHINES,
        told["machines"],
        "machines",
    )


DESIGNS: dict[str, Callable[[Any], Card]] = {
    "Atlas": _atlas,
    "Design": _design,
    "Impossible": _impossible,
    "Reprogramming": _reprogramming,
    "Robustness": _robustness,
    "Survival": _survival,
    "Yield": _yield,
}
