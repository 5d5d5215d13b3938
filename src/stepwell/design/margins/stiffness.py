"""The smallest change of one cell's stiffness after which a chain does something else."""

from __future__ import annotations

import math

from stepwell.base import bisected
from stepwell.concave import SortedChain
from stepwell.design.margins.change import Change
from stepwell.design.margins.nearest import sequence
from stepwell.design.parameters import of_cell
from stepwell.design.plane import Method
from stepwell.mechanism import Chain
from stepwell.sequences import Sequence
from stepwell.statics import StaticsError

# How far past a change it is looked at: far enough to leave no tie.
_PAST = 1e-7
_RATIOS = 12
_STIFFEST = 8.0  # largest ratio tried, up and down; every other is the root of the next
_RESOLUTION = 1e-6  # of the stiffness, where bisection stops

RESOLUTION = (
    f"asked at {_RATIOS} ratios up to {_STIFFEST:g} times more and as many less, then "
    f"bisection to {_RESOLUTION * 100:g} %"
)


def stiffness(chain: Chain, forces: SortedChain | None, now: Sequence, cell: int) -> Change:
    """The smallest relative change of stiffness that changes the sequence.

    In closed form F of one linear band is proportional to k, so the ratio that reaches another
    force is a quotient; a force of the other sign, or zero, is never reached. Else ratios are
    asked, and the first change bisected.

    Args:
        chain: any number of cells.
        forces: the chain in closed form, None where that is not proved.
        now: what it does.
        cell: whose bands are made stiffer or softer, all alike.
    """
    if forces is None:
        moves, past, method = _searched(chain, now, cell), (0.0, 0.0), Method.SEARCH
    else:
        moves, past, method = _quotients(forces, cell), (_PAST, -_PAST), Method.EXACT
    common = (chain, cell, "stiffness")
    if not moves:
        return Change(*common, math.inf, math.nan, math.nan, method)
    move, grows = min(moves, key=lambda found: abs(found[0]))
    return Change(*common, abs(move), move, move + past[0 if grows > 0 else 1], method)


def _quotients(forces: SortedChain, cell: int) -> list[tuple[float, int]]:
    """Relative changes after which another force is reached, and whether k grows past them."""
    return [
        (n.other / n.own - 1.0, n.up if n.own > 0 else -n.up)
        for n in forces.neighbours(cell)
        if n.own * n.other > 0
    ]


def _searched(chain: Chain, now: Sequence, cell: int) -> list[tuple[float, int]]:
    parameter = of_cell(chain, cell, "stiffness")

    def same(fraction: float) -> bool:
        try:
            return sequence(parameter.scaled(chain, 1.0 + fraction)) == now
        except StaticsError:
            return False

    found: list[tuple[float, int]] = []
    least = math.inf
    for sign in (1, -1):
        good = 0.0
        for k in reversed(range(_RATIOS)):
            bad = sign * min(abs(_STIFFEST ** (sign * 0.5**k) - 1.0), least)
            if not same(bad):
                halvings = math.ceil(math.log2(max(1.0, abs(bad - good) / _RESOLUTION)))
                found.append((bisected(same, good, bad, halvings)[1], sign))
                least = abs(found[-1][0])
            if abs(bad) >= least:
                break
            good = bad
    return found
