"""Mechanisms made at random and counted: the share that works, and how sure it is."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

from stepwell.base import ByValue
from stepwell.design.tolerances.tolerances import Tolerances
from stepwell.mechanism import Chain

_LEVERS = "anchors, levers and friction evenly within their tolerance, k and ℓ0 normally"
_ELEMENTS = "all forces of an element alike and all its travels alike, normally"


def varied(chain: Chain) -> str:
    """How mechanisms after a drawing are made, in words."""
    how = _LEVERS
    if chain.elements:
        levers = len(chain.elements) < len(chain)
        how = f"{_LEVERS if levers else 'friction evenly within its tolerance'}, {_ELEMENTS}"
    return f"assumed: every part varies by itself, {how}; quasi-static"


class Share(NamedTuple):
    """How often something came among designs drawn independently.

    Attributes:
        times: how often.
        of: so many designs.
        low, high: 95 % confidence interval of the share (Clopper & Pearson 1934).
    """

    times: int
    of: int
    low: float
    high: float

    @property
    def share(self) -> float:
        """The estimate."""
        return self.times / self.of


def share_of(times: int, of: int) -> Share:
    """A share with its interval."""
    from scipy.stats import binomtest

    found = binomtest(times, of).proportion_ci(0.95, "exact")
    return Share(times, of, float(found.low), float(found.high))


@dataclass(frozen=True, eq=False, kw_only=True)
class Counted(ByValue):
    """How many of n mechanisms, made at random after a drawing, do something."""

    chain: Chain = field(repr=False)
    tolerances: Tolerances
    n: int
    seed: int
    successes: int

    @property
    def share(self) -> float:
        """Successes over n: the estimate of the probability."""
        return self.successes / self.n

    @cached_property
    def interval(self) -> tuple[float, float]:
        """95 % confidence interval of the probability (Clopper & Pearson 1934)."""
        found = share_of(self.successes, self.n)
        return found.low, found.high
