"""Chains under a prescribed force seen as relays, each of which switches up at A and down at B."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stepwell.base import Bools, Floats, Ints
from stepwell.concave.cell import Simple, simple
from stepwell.concave.ends import proved_ends
from stepwell.concave.sorting import TIED, one_travel
from stepwell.mechanism import Chain, Element


@dataclass(frozen=True, eq=False)
class Relays:
    """Switching fields of a chain, all that there is to know of it under a prescribed force.

    A lever cell that is proved concave is one relay, A = F0 and B = F1. An element with P phases is
    P - 1 of them: relay k is up where it stands beyond phase k.

    Attributes:
        up, down: (M,) A and B, the forces at which a cell leaves phase k upwards, and comes back to
            it out of phase k + 1 [N].
        first: (N + 1,) relays of cell i are first[i] .. first[i + 1].
        equal: whether all cells are proved concave and share one full travel.
        slip: fields no further apart than this tie [N].
    """

    up: Floats
    down: Floats
    first: Ints
    equal: bool
    slip: float = 0.0

    @property
    def cell(self) -> Ints:
        """(M,) of which cell each relay is."""
        return np.repeat(np.arange(len(self.first) - 1), np.diff(self.first))

    @property
    def step(self) -> Ints:
        """(M,) k: out of which phase of its cell each relay leads."""
        return np.arange(len(self.up)) - self.first[self.cell]

    @property
    def windows(self) -> tuple[tuple[tuple[float, float], ...], ...]:
        """By cell and phase: the forces between which it holds [N], infinite at the ends."""
        ends = zip(self.first.tolist(), self.first[1:].tolist(), strict=False)
        up, down = self.up.tolist(), self.down.tolist()
        return tuple(
            tuple(zip((-np.inf, *down[a:b]), (*up[a:b], np.inf), strict=True)) for a, b in ends
        )

    @property
    def skips(self) -> bool:
        """Whether a cell can pass a phase of its own by: its relays are not independent then."""
        own = np.diff(self.cell) == 0
        return bool(np.any(own & ((np.diff(self.up) < 0) | (np.diff(self.down) < 0))))

    def precedes(self, i: int, j: int) -> bool:
        """i ≺ j: relay i goes up before j and also comes down after it."""
        return bool(self.up[i] < self.up[j] and self.down[i] < self.down[j])

    def raised(self, state: str) -> Bools:
        """(M,) which relays are up in a state."""
        return np.array([int(digit) for digit in state])[self.cell] > self.step

    def state(self, raised: Bools) -> str:
        """The state in which these relays are up, and no others."""
        counts = np.diff(np.append(0, np.cumsum(raised))[self.first])
        return "".join(map(str, counts.tolist()))


def relays(chain: Chain, *, ties: bool = False) -> Relays | None:
    """The switching fields of a chain.

    None where a lever cell is not proved concave, where an element has friction or a curve that
    folds back, or where two fields tie, unless `ties` says that they may.
    """
    fields: list[Floats | None] = []
    levers: list[Simple] = []
    for cell in chain.cells:
        if isinstance(cell, Element):
            if len(cell.laws) > 1 or cell.friction > 0:
                return None
            fields.append(np.array(cell.fields).reshape(-1, 2))
        elif (numbers := simple(cell)) is not None:
            levers.append(numbers)
            fields.append(None)
        else:
            return None
    ends, proved = proved_ends(np.array(levers).reshape(-1, 6))
    if not np.all(proved):
        return None
    rows = iter(ends)
    parts = [next(rows)[None] if one is None else one for one in fields]
    first = np.append(0, np.cumsum([len(part) for part in parts]))
    pairs = np.concatenate(parts)
    size = np.max(np.abs(pairs), initial=0.0)
    if not ties and np.any(np.diff(np.sort(pairs, axis=0), axis=0) <= TIED * size):
        return None
    equal = not chain.elements and one_travel(chain)
    return Relays(pairs[:, 0], pairs[:, 1], first, equal, TIED * float(size))


@dataclass(frozen=True)
class RelayPlan:
    """Strokes of relays: the states at which to turn and where the last one ends.

    Attributes:
        states: one a stroke, the last one the state wanted.
        blocked: (i, j) where there is no way: relay j is wanted up without i, and i ≺ j.
    """

    states: tuple[str, ...]
    blocked: tuple[int, int] | None = None


def fewest_strokes(fields: Relays, start: str, to: str) -> RelayPlan:
    """The fewest strokes that bring relays from one state to another, where none skips a phase.

    Backward from the end. The last stroke, if it goes up, sets all relays with A below some
    field; it must set none that is wanted down, so it may go up to just below the least A of
    those, and then what the relays below were before does not matter any more. The stroke before
    it goes down and has to please fewer; and so on, until those left stand right from the
    start. Setting as many as allowed leaves the fewest to please, so none needs fewer strokes.

    Source: Preisach 1935; Terzi and Mungan 2020 for the states; the plan is ours (theory page).
    """
    if start == to:
        return RelayPlan(())
    before, wanted = fields.raised(start), fields.raised(to)
    plans = [
        plan for last in (+1, -1) if (plan := _backward(fields, before, wanted, last)) is not None
    ]
    if plans:
        return RelayPlan(min(plans, key=len))
    blocked = [
        (i, j)
        for i in np.flatnonzero(~wanted).tolist()
        for j in np.flatnonzero(wanted).tolist()
        if fields.precedes(i, j)
    ]
    # A relay that differs from the start shows the reader most.
    blocked.sort(key=lambda pair: all(before[k] == wanted[k] for k in pair))
    return RelayPlan((), blocked[0])


def _backward(fields: Relays, before: Bools, wanted: Bools, last: int) -> tuple[str, ...] | None:
    care = np.ones(len(wanted), bool)
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
        states.append(fields.state(state))
    return tuple(states)
