"""The smallest change of one anchor, or of one stiffness, that alters the sequence."""

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from stepwell.base import ByValue, bisected
from stepwell.concave import SortedChain
from stepwell.design.margins.nearest import sequence
from stepwell.design.parameters import of_cell
from stepwell.design.plane import Method
from stepwell.mechanism import Chain
from stepwell.sequences import Sequence, cycle
from stepwell.statics import StaticsError


@dataclass(frozen=True, eq=False)
class Change(ByValue):
    """The smallest change of one thing about one cell after which the chain does otherwise.

    Attributes:
        chain: the design as it is.
        cell: whose anchor or stiffness it is, 0 the innermost.
        parameter: "anchor" (q on the outer block; moving p the opposite way is the same) or
            "stiffness" (of all bands of the cell).
        distance: how far that is: [m], or the fraction of the stiffness; infinite where
            nothing within reach changes the sequence.
        move: (dx, dy) [m] that brings the anchor there, or the signed fraction; NaN if infinite.
        past: the same a hair further, where the sequence is another one already.
        method: exact, or a search.
    """

    chain: Chain = field(repr=False)
    cell: int
    parameter: str
    distance: float
    move: tuple[float, float] | float
    past: tuple[float, float] | float = field(repr=False)
    method: Method

    @property
    def design(self) -> Chain | None:
        """The chain just past the change; None where there is no change."""
        if np.isinf(self.distance):
            return None
        if isinstance(self.past, tuple):
            return of_cell(self.chain, self.cell, "q").displaced(self.chain, self.past)
        return of_cell(self.chain, self.cell, "stiffness").scaled(self.chain, 1.0 + self.past)

    @cached_property
    def becomes(self) -> str:
        """The sequence just past the change, by the engine; empty where there is no change."""
        if self.design is None:
            return ""
        try:
            return str(cycle(self.design).sequence)
        except StaticsError as failure:
            return f"no answer: {failure}"

    def __str__(self):
        if np.isinf(self.distance):
            return f"{self.parameter}: none within reach"
        if isinstance(self.move, tuple):
            x, y = self.move
            return (
                f"anchor: {self.distance * 1e3:.4g} mm "
                f"(move q by ({x * 1e3:+.4g}, {y * 1e3:+.4g}) mm)"
            )
        return f"stiffness: {self.move * 100:+.4g} %"


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
