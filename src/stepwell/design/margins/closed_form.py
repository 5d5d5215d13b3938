"""The smallest change of anchor or stiffness of a chain whose sequence is sorted end forces."""

import math

import numpy as np

from stepwell.concave import SortedChain, nearest_of
from stepwell.design.margins.change import Change
from stepwell.mechanism import Chain

# How far past a change it is looked at, [m] and [1]: far enough to leave no tie, near enough that
# a second change in between would be a coincidence.
_HAIR = 1e-8
_HAIR_STIFFNESS = 1e-7


def anchor(chain: Chain, forces: SortedChain, cell: int, reach: float) -> Change | None:
    """The nearest anchor that changes the sequence, or None where the proof ends before it."""
    near = forces.neighbours(cell)
    out = np.empty(3)
    nearest_of(
        forces.cells[cell],
        np.array([n.side for n in near], np.int64),
        np.array([n.other for n in near], float),
        np.array([n.up for n in near], np.int64),
        reach,
        out,
    )
    away, x, y = out.tolist()
    if away < 0:
        return None
    if math.isinf(away):
        nowhere = (math.nan, math.nan)
        return Change(chain, cell, "anchor", math.inf, nowhere, "exact", nowhere)
    past = away + _HAIR
    return Change(chain, cell, "anchor", away, (away * x, away * y), "exact", (past * x, past * y))


def stiffness(chain: Chain, forces: SortedChain, cell: int) -> Change:
    """The smallest relative change of stiffness that changes the sequence.

    F of one linear band is proportional to k, so the ratio that reaches another force is a
    quotient; a force of the other sign, or zero, is never reached.
    """
    found: list[tuple[float, int]] = []
    for n in forces.neighbours(cell):
        if n.own * n.other > 0:
            grows = n.up if n.own > 0 else -n.up
            found.append((n.other / n.own - 1.0, grows))
    if not found:
        return Change(chain, cell, "stiffness", math.inf, math.nan, "exact", math.nan)
    fraction, grows = min(found, key=lambda item: abs(item[0]))
    past = fraction + grows * _HAIR_STIFFNESS
    return Change(chain, cell, "stiffness", abs(fraction), fraction, "exact", past)
