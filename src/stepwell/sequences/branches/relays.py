"""How far chains under a prescribed stroke move as relays do."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

from stepwell.concave import Relays
from stepwell.mechanism import Chain
from stepwell.sequences.branches.passages import passages_of
from stepwell.statics import StaticsError, path


class Order(NamedTuple):
    """How far relays tell what a chain under a prescribed stroke does, from all cells at 0 on.

    Attributes:
        only_ideals: whether nothing but ideals is reached.
        leaders_win: whether in every snap the cell whose release begins it is the one left in
            transit. Then the chain moves as relays do, turn for turn, and only ideals are reached.
    """

    only_ideals: bool
    leaders_win: bool


def order_kept(chain: Chain, fields: Relays) -> Order:
    """What the full cycle proves about all that one actuator can do to equal full travels.

    Whatever ideal the chain comes from, loading j goes through the snaps in which j loads on the
    full cycle. Turning back after one of them empties the cell left in transit, and that is all
    that full strokes do not do. So the full cycle decides: where that cell may go back without
    leaving the ideals, nothing else is ever reached, and where it may not, turning there does.
    Where a snap hangs on a tie, or the engine cannot go on, nothing is said.

    Source: ours (theory page, "Stroke programs").
    """
    try:
        cycle = path(chain, [0.0, chain.full_stroke, 0.0])
    except StaticsError:
        return Order(False, False)
    ideals = leaders = not cycle.degenerate
    for passage, landed in pairwise(passages_of(cycle)):
        state = landed.sections[0].state
        if passage.snap is None or state.count("-") != 1:
            return Order(False, False)
        k = state.index("-")
        if passage.snap.direction > 0:
            full = [m for m, at in enumerate(state) if at == "1"]
            ideals &= not any(fields.precedes(k, m) for m in full)
            leaders &= all(fields.down[m] < fields.down[k] for m in full)
        else:
            empty = [m for m, at in enumerate(state) if at == "0"]
            ideals &= not any(fields.precedes(m, k) for m in empty)
            leaders &= all(fields.up[m] > fields.up[k] for m in empty)
    return Order(ideals, leaders)
