"""Chains of concave cells seen as relays: one switches up at A = F0, and down at B = F1."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from stepwell.concave import certify, end_forces, simple
from stepwell.mechanism import Chain
from stepwell.sequences.branches.passages import passages_of
from stepwell.statics import StaticsError, path

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Relays:
    """Switching fields of a chain whose cells are all proved concave.

    Attributes:
        up, down: (N,) A = F0 and B = F1 [N].
        equal: whether all cells share one full travel.
    """

    up: Floats
    down: Floats
    equal: bool

    def precedes(self, i: int, j: int) -> bool:
        """i ≺ j: i goes up before j and also comes down after it."""
        return bool(self.up[i] < self.up[j] and self.down[i] < self.down[j])


def relays(chain: Chain) -> Relays | None:
    """The switching fields, or None where a cell is not proved concave or two of them tie."""
    fields: list[tuple[float, float]] = []
    for cell in chain.cells:
        numbers = simple(cell)
        if numbers is None or not certify(numbers, 0.0):
            return None
        fields.append(end_forces(numbers))
    scale = max(abs(force) for pair in fields for force in pair)
    for values in zip(*fields, strict=True):
        if any(b - a <= 1e-9 * scale for a, b in pairwise(sorted(values))):
            return None
    up, down = np.array(fields).T
    full = [cell.full_travel for cell in chain.cells]
    return Relays(up, down, max(full) - min(full) <= 1e-12 * max(full))


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


@dataclass(frozen=True)
class Plan:
    """Strokes of relays: the states at which to turn and where the last one ends.

    Attributes:
        states: one a stroke, the last one the state wanted.
        blocked: (i, j) where there is no way: j is wanted at 1 without i, and i ≺ j.
    """

    states: tuple[str, ...]
    blocked: tuple[int, int] | None = None


def shortest(fields: Relays, start: str, to: str) -> Plan:
    """The fewest strokes that bring relays from one state to another.

    Backward from the end. The last stroke, if it goes up, sets all cells with A below some
    field; it must set no cell that is wanted at 0, so it may go up to just below the least A of
    those, and then what the cells below were before does not matter any more. The stroke before
    it goes down and has to please fewer cells; and so on, until those left stand right from the
    start. Setting as many as allowed leaves the fewest to please, so none needs fewer strokes.

    Source: Preisach 1935; Terzi and Mungan 2020 for the states; the plan is ours (theory page).
    """
    if start == to:
        return Plan(())
    plans = [plan for last in (+1, -1) if (plan := _backward(fields, start, to, last)) is not None]
    if plans:
        return Plan(min(plans, key=len))
    blocked = [
        (i, j)
        for i, zero in enumerate(to)
        for j, one in enumerate(to)
        if (zero, one) == ("0", "1") and fields.precedes(i, j)
    ]
    # A cell that differs from the start shows the reader most.
    blocked.sort(key=lambda pair: all(start[cell] == to[cell] for cell in pair))
    return Plan((), blocked[0])


def _backward(fields: Relays, start: str, to: str, last: int) -> tuple[str, ...] | None:
    before = np.array([c == "1" for c in start])
    wanted = np.array([c == "1" for c in to])
    care = np.ones(len(to), bool)
    limits: list[tuple[int, float]] = []
    direction, idle = last, 0
    while np.any(care & (before != wanted)):
        if direction > 0:
            limit = float(np.min(fields.up[care & ~wanted], initial=np.inf))
            pleased = care & (fields.up < limit)
        else:
            limit = float(np.max(fields.down[care & wanted], initial=-np.inf))
            pleased = care & (fields.down > limit)
        idle = 0 if np.any(pleased) else idle + 1
        if idle > 0 and (limits or idle > 1):
            return None
        care &= ~pleased
        limits.append((direction, limit))
        direction = -direction
    state = before.copy()
    states: list[str] = []
    for way, limit in reversed(limits):
        state = state | (fields.up < limit) if way > 0 else state & ~(fields.down > limit)
        states.append("".join("1" if s else "0" for s in state))
    return tuple(states)
