"""Which one measurement makes it surest that a design works."""

from __future__ import annotations

from dataclasses import dataclass

from stepwell.base import ByValue, brief
from stepwell.design.tolerances import Survival, Tolerances, Yield, parts_of, with_known

# What a kitchen scale and callipers give; friction is known to a fifth of its tolerance.
MEASURED = Tolerances(anchor=1e-4, stiffness=0.02, rest_length=0.02, lever=1e-4, travel=0.02)
_OF_FRICTION = 0.2
# Mechanisms that rank the parts: judged in closed form, or followed one by one by the engine.
_RANKED, _RANKED_ONE_BY_ONE = 4_000, 60
_GAIN = 0.005  # a smaller one is not worth a measurement


@dataclass(frozen=True, slots=True, eq=False)
class Measurement(ByValue):
    """A part that is worth being measured, and made or chosen as drawn.

    Attributes:
        cell: whose part it is, 0 the innermost.
        what: "d" (all anchors of its bands), "stiffness", "rest_length", "lever", "friction", or
            of an element "force_scale", "travel_scale".
        tolerance: its field of `Tolerances`.
        now, then: that tolerance as it is, and once it is measured, in SI.
        before, after: share of those built that do what is wanted.
    """

    cell: int
    what: str
    tolerance: str
    now: float
    then: float
    before: float
    after: float

    def __repr__(self):
        return brief(self)


def measurement(found: Yield | Survival) -> Measurement | None:
    """The part whose measurement raises a yield most; None where none is worth it.

    Each part in turn has only the tolerance that a scale and callipers leave of it, and the same
    mechanisms are counted again: a few to rank the parts, all of them for the first.

    Args:
        found: the yield with all tolerances.
    """
    parts = parts_of(found)
    left = {name: _left(found.tolerances, part.tolerance) for name, part in parts.items()}
    worth = [name for name in parts if left[name] < 1.0]
    if found.successes == found.n or not worth:
        return None
    quickly = isinstance(found, Yield) and not found.by_engine
    n = min(found.n, _RANKED if quickly else _RANKED_ONE_BY_ONE)
    best = max(worth, key=lambda name: with_known(found, name, left[name], n))
    after = with_known(found, best, left[best], found.n) / found.n
    if after < found.share + _GAIN:
        return None
    cell, what, tolerance, _ = parts[best]
    now = getattr(found.tolerances, tolerance)
    return Measurement(cell, what, tolerance, now, now * left[best], found.share, after)


def _left(tolerances: Tolerances, name: str) -> float:
    if name == "friction":
        return _OF_FRICTION
    return min(1.0, getattr(MEASURED, name) / getattr(tolerances, name))
