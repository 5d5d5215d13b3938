"""Yields once more, with one part known better than its tolerance says."""

from __future__ import annotations

from stepwell.design.tolerances.draws import Draws, Part
from stepwell.design.tolerances.survival import Survival, count_ends
from stepwell.design.tolerances.tally import Tally
from stepwell.design.tolerances.yields import Yield


def parts_of(found: Yield | Survival) -> dict[str, Part]:
    """The parts that vary in what was counted, by their names, such as "outer.stiffness"."""
    return Draws(found.chain, found.tolerances, found.seed).parts


def with_known(found: Yield | Survival, part: str, left: float, n: int) -> int:
    """How many of the first n mechanisms work where one part is known better.

    The same mechanisms are made with the same luck; only that part is nearer to its drawing, and
    friction to the middle of its tolerance.

    Args:
        found: what was counted with all tolerances.
        part: which, as `parts_of` names it.
        left: the share of its tolerance that is left, 0 to 1.
        n: how many are counted.
    """
    draws = Draws(found.chain, found.tolerances, found.seed, part, left)
    if isinstance(found, Survival):
        return count_ends(draws, found.turning_points, found.start, found.ends, n)
    states = None if found.states is None else frozenset(found.states)
    tally = Tally(draws, found.wanted, states, found.robust)
    tally.count(n, None)
    return tally.successes
