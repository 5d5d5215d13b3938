"""Return-point memory: whether a chain that comes back to a turning point is as it was there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from stepwell.base import ByValue, number
from stepwell.sequences.graphs import Atlas, Mesostates, Routes

# Of all failures this many are compared for the one that is reached most simply.
_COMPARED = 200


@dataclass(frozen=True, slots=True, eq=False)
class Forgetting(ByValue):
    """A turning point that the chain does not remember.

    It stood at `first` when it got to `at`. The drive turned, went to `excursion` and came back,
    and never passed `before`, where it had turned earlier; yet it stood at `later` then.

    Attributes:
        turns: all turning points from the drive's lower end, with all cells at 0; the last four
            are before, at, excursion, at [m, or the graph's unit].
        first, later: labels of the nodes.
    """

    turns: tuple[float, ...]
    first: str
    later: str

    @property
    def before(self) -> float:
        """The earlier turning point: a minimum below `at`, or a maximum above it."""
        return self.turns[-4]

    @property
    def at(self) -> float:
        """The turning point that is forgotten."""
        return self.turns[-1]

    @property
    def excursion(self) -> float:
        """How far the drive went in between."""
        return self.turns[-2]

    def __repr__(self):
        points = ", ".join(number(drive) for drive in self.turns)
        return f"Forgetting({self.first}, later {self.later}, drive {points})"


@dataclass(frozen=True, slots=True, eq=False)
class ReturnPointMemory(ByValue):
    """Whether the chain has return-point memory, as far as one actuator can bring it.

    It has if for any drives u0 ≤ u' ≤ u: a chain that rises from u0 to u, falls to u' and
    rises to u again is as it was when it first came to u, from wherever it stood at u0; and the
    same for falling drives. Excursions within excursions then do nothing either, since the
    innermost can be left out first.

    Attributes:
        witness: how it fails; None where it holds.

    Source: Barker et al. 1983; Sethna et al. 1993, Phys. Rev. Lett. 70, 3347; Mungan and Terzi
    2019 for graphs.
    """

    witness: Forgetting | None

    @property
    def holds(self) -> bool:
        """Whether every turning point is remembered."""
        return self.witness is None

    def __repr__(self):
        return "ReturnPointMemory(holds)" if self.holds else f"ReturnPointMemory({self.witness!r})"


class _Lapse(NamedTuple):
    """Branches of a failure, for a drive that may be mirrored.

    The chain rises out of `left` into `first`, falls out of it as far as `turned`, which it
    entered at the drive `entered`, and rises from there to `later`.
    """

    left: int
    first: int
    turned: int
    entered: float
    later: int


def return_point_memory(atlas: Atlas, routes: Routes) -> ReturnPointMemory:
    """Check every turn that can be made, on the branches and so exactly."""
    for direction in (+1, -1):
        branches = atlas.mesostates.toward(direction)
        lapses = [x for x in _lapses(branches, routes) if not _alike(atlas, branches, x, direction)]
        if lapses:
            return ReturnPointMemory(_simplest(atlas, routes, branches, lapses, direction))
    return ReturnPointMemory(None)


def _lapses(branches: Mesostates, routes: Routes) -> list[_Lapse]:
    """Failures at a maximum.

    The chain enters `first` where the branch before it ends, at e, and holds it for u from e on.
    If it is back there at a u just above e, it is at any larger one. The excursion may go as far
    down as the least end of all branches from which the rise leads there.
    """
    left = np.flatnonzero(routes.reached & (branches.rise >= 0))
    first = branches.rise[left]
    room = branches.high[first] - branches.high[left]
    # A branch entered at its very end is left again at once.
    left, first, room = left[room > 0], first[room > 0], room[room > 0]
    just_above = branches.high[left] + np.minimum(branches.slip, room / 2)
    least = _least_end(branches, routes)[left] + branches.slip
    found: list[_Lapse] = []
    rows, at = np.arange(len(left)), first
    while True:
        go = (branches.low[at] > least[rows]) & (branches.fall[at] >= 0)
        if not np.any(go):
            return found
        rows, entered = rows[go], branches.low[at[go]]
        at = branches.fall[at[go]]
        later = branches.risen(at, just_above[rows])
        for k in np.flatnonzero(later != first[rows]).tolist():
            turned, drive, end = int(at[k]), float(entered[k]), int(later[k])
            found.append(_Lapse(int(left[rows[k]]), int(first[rows[k]]), turned, drive, end))


def _alike(atlas: Atlas, branches: Mesostates, lapse: _Lapse, direction: int) -> bool:
    """Whether two branches meet in one vertex there: a tie sends what follows different ways."""
    at = direction * _turning(branches, lapse)
    first, later = (
        atlas.graph.node(atlas.label_at(number, at)).state for number in (lapse.first, lapse.later)
    )
    return first == later and "-" not in first


def _turning(branches: Mesostates, lapse: _Lapse) -> float:
    """The middle of the drives at which the chain may stand on either branch."""
    high = branches.high
    return (float(high[lapse.left]) + float(min(high[lapse.first], high[lapse.later]))) / 2


def _least_end(branches: Mesostates, routes: Routes) -> np.ndarray:
    """(R,) the lowest lower end of the reached branches from which the rise leads to each."""
    least = np.where(routes.reached, branches.low, np.inf)
    rises = np.flatnonzero(routes.reached & (branches.rise >= 0))
    for _ in range(len(branches)):
        before = least.copy()
        np.minimum.at(least, branches.rise[rises], least[rises])
        if np.array_equal(least, before):
            break
    return least


def _simplest(
    atlas: Atlas, routes: Routes, branches: Mesostates, lapses: list[_Lapse], direction: int
) -> Forgetting:
    """The failure whose first turning point is reached with the fewest snaps."""
    sources: dict[int, list[int]] = {}
    for branch in np.flatnonzero(routes.reached).tolist():
        sources.setdefault(int(branches.rise[branch]), []).append(branch)
    begins: list[tuple[int, int, _Lapse]] = []
    for lapse in lapses[:_COMPARED]:
        waiting = [lapse.left]
        while waiting:
            number = waiting.pop()
            waiting += sources.get(number, [])
            if branches.low[number] < lapse.entered - branches.slip:
                begins.append((int(routes.depth[number]), number, lapse))
    _, start, lapse = min(begins)
    low, high = branches.low, branches.high
    before = float(low[start])
    if branches.fall[start] >= 0:
        # Well inside, so that no turning point is at an end.
        before += (min(lapse.entered, float(high[start])) - before) / 4
    excursion = (max(float(low[lapse.turned]), before) + lapse.entered) / 2
    at = _turning(branches, lapse)
    before, excursion, at = (direction * drive for drive in (before, excursion, at))
    return Forgetting(
        (*routes.turns(start, before), at, excursion, at),
        atlas.label_at(lapse.first, at),
        atlas.label_at(lapse.later, at),
    )
