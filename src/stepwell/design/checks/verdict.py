"""The verdict on a design, and the rule by which it is given."""

from __future__ import annotations

from enum import StrEnum

# Of those built: what has to work for "works", and what has to fail for "won't".
SURE, HALF = 0.95, 0.5


class Verdict(StrEnum):
    """Whether the real one will do it, from the best to the worst."""

    WORKS = "works"
    FRAGILE = "fragile"
    WONT = "won't"


def judged(*, does_it: bool, tied: bool, interval: tuple[float, float]) -> Verdict:
    """The verdict; the [decision](decisions/verdict.md) says why its bounds are where they are.

    Args:
        does_it: whether the drawing does what is wanted.
        tied: whether it is a tie on its way.
        interval: 95 % confidence interval of the share of those built that do it.

    Returns:
        `WONT` where the drawing does not do it, or the interval ends below one half; `WORKS` where
        it does, without a tie, and the interval begins at 95 % or above; else `FRAGILE`.
    """
    low, high = interval
    if not does_it or high < HALF:
        return Verdict.WONT
    return Verdict.WORKS if low >= SURE and not tied else Verdict.FRAGILE
