"""Why none of many mechanisms makes a wanted cycle, and what to ask for instead."""

import math
from itertools import pairwise

from stepwell.design.orders import short
from stepwell.mechanism import Chain
from stepwell.sequences import Sequence, cycle
from stepwell.statics import StaticsError


def why_none(chain: Chain, wanted: str, concave: bool) -> str:
    """The reason in a sentence, and advice.

    Args:
        chain: the drawing.
        wanted: the full cycle that none makes.
        concave: whether all cells that were made are proved concave, and so go one after the
            other.
    """
    states = Sequence.parse(wanted).states
    strokes = [
        math.fsum(c.full_travel for c, s in zip(chain.cells, state, strict=True) if s == "1")
        for state in states
    ]
    top = states.index("1" * len(chain))
    for k, (a, b) in enumerate(pairwise(strokes)):
        if (b <= a) if k < top else (b >= a):
            way = "rise" if k < top else "fall"
            return (
                f"one stroke out and back cannot do it: from {states[k]} to {states[k + 1]} the "
                f"stroke does not {way}. A stroke program turns back early: ask `stepwell "
                f"program`, in Python chain.program; and `stepwell yield --program` how surely it "
                f"works"
            )
    for (a, b), flips in zip(pairwise(states), Sequence.parse(wanted).flips, strict=True):
        if concave and len(flips) > 1:
            return (
                f"one stroke out and back cannot do it: {a}>{b} moves {len(flips)} cells at once, "
                f"and cells of falling force go one after the other. Name every step, "
                f"{_instead(chain)}; a program that ends in {b} is `stepwell program --to {b}`"
            )
    return f"none of those made does it. Ask for another cycle, {_instead(chain)}"


def _instead(chain: Chain) -> str:
    try:
        return f"such as {short(str(cycle(chain).sequence))}, which the drawing makes"
    except StaticsError:
        return "one with a step for each cell"
