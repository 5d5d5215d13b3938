"""How many samples within tolerances reproduce a target: what yields and survivals share."""

from __future__ import annotations

from collections.abc import Callable
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from stepwell.accounts.account import Fact, Level
from stepwell.accounts.shape import Shape
from stepwell.base import Quantity, Schema, in_measure, number, percent, record
from stepwell.mechanism import Chain

if TYPE_CHECKING:
    from stepwell.design import Survival, Tolerances, Yield


# Captions of the figures of samples.
OUTCOMES = "Outcomes of the samples"
FORCE_PLANE = "Switching forces of each cell, nominal and in samples"


def counted_schema(shape: Shape, yield_: str = "") -> Schema:
    """What is counted of samples, and within which tolerances.

    Args:
        shape: of the chain.
        yield_: the attribute that has the yield; the value itself by default.
    """

    def read(name: str, k: int | None = None) -> Callable[[Any], Any]:
        get = attrgetter(f"{yield_}.{name}" if yield_ else name)
        return get if k is None else lambda found: get(found)[k]

    return (
        Quantity("share", holds=float, read=read("share")),
        Quantity("share_low", holds=float, read=read("interval", 0)),
        Quantity("share_high", holds=float, read=read("interval", 1)),
        Quantity("samples", holds=int, read=read("n")),
        Quantity("successes", holds=int, read=read("successes")),
        Quantity("tolerances", holds=tolerance_schema(shape), read=read("tolerances")),
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
    return f"{found.n} samples with {tolerance_words(found.tolerances, found.chain)}"


def counted_facts(found: Yield | Survival) -> tuple[Fact, ...]:
    """The facts that yields and survivals share."""
    return (
        Fact("Yield", yield_words(found)),
        Fact("Successes", f"{found.successes} of {found.n}", Level.PAGE),
        Fact("Samples", sample_words(found)),
    )
