"""Chains of concave cells seen as relays: one switches up at A = F0, and down at B = F1."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stepwell.base import Floats
from stepwell.concave.sorting import TIED, one_travel, proved_cells
from stepwell.mechanism import Chain


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
    found = proved_cells(chain)
    if found is None:
        return None
    _, ends = found
    if np.any(np.diff(np.sort(ends, axis=0), axis=0) <= TIED * np.max(np.abs(ends))):
        return None
    return Relays(ends[:, 0], ends[:, 1], one_travel(chain))


@dataclass(frozen=True)
class RelayPlan:
    """Strokes of relays: the states at which to turn and where the last one ends.

    Attributes:
        states: one a stroke, the last one the state wanted.
        blocked: (i, j) where there is no way: j is wanted at 1 without i, and i ≺ j.
    """

    states: tuple[str, ...]
    blocked: tuple[int, int] | None = None


def fewest_strokes(fields: Relays, start: str, to: str) -> RelayPlan:
    """The fewest strokes that bring relays from one state to another.

    Backward from the end. The last stroke, if it goes up, sets all cells with A below some
    field; it must set no cell that is wanted at 0, so it may go up to just below the least A of
    those, and then what the cells below were before does not matter any more. The stroke before
    it goes down and has to please fewer cells; and so on, until those left stand right from the
    start. Setting as many as allowed leaves the fewest to please, so none needs fewer strokes.

    Source: Preisach 1935; Terzi and Mungan 2020 for the states; the plan is ours (theory page).
    """
    if start == to:
        return RelayPlan(())
    plans = [plan for last in (+1, -1) if (plan := _backward(fields, start, to, last)) is not None]
    if plans:
        return RelayPlan(min(plans, key=len))
    blocked = [
        (i, j)
        for i, zero in enumerate(to)
        for j, one in enumerate(to)
        if (zero, one) == ("0", "1") and fields.precedes(i, j)
    ]
    # A cell that differs from the start shows the reader most.
    blocked.sort(key=lambda pair: all(start[cell] == to[cell] for cell in pair))
    return RelayPlan((), blocked[0])


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
