"""Accumulators: chains that count the cycles of the drive."""

from dataclasses import dataclass

import numpy as np

from stepwell.base import ByValue, Floats, Ints, number
from stepwell.sequences.mesostates import BranchAtlas, Mesostates, Routes

# Limit of the work of a search (extremes squared times branches): some seconds.
_BUDGET = 2e8


@dataclass(frozen=True, slots=True, eq=False)
class Accumulator(ByValue):
    """A chain whose response becomes periodic after two or more equal cycles of the drive.

    Attributes:
        low, high: the extremes of the cycle [m, or the graph's unit].
        direction: +1 if each cycle begins at `low` and goes up first, -1 if at `high`.
        states: labels of the nodes at the beginning and after each cycle, up to the first that
            comes again.
        transient: cycles until the response is periodic.
        period: cycles in one period; 1 if all further cycles are equal.
        slack: tolerance of either extreme for the same response.
        by_hand: whether its first state can only be set by hand.
        turns: turning points from the drive's lower end, with all cells at 0, to the beginning;
            that drive alone where it is set by hand.

    Source: Kwakernaak and van Hecke 2023, Phys. Rev. Lett. 130, 268204; Bense and van Hecke 2021
    for accumulators with a transient.
    """

    low: float
    high: float
    direction: int
    states: tuple[str, ...]
    transient: int
    period: int
    slack: float
    by_hand: bool
    turns: tuple[float, ...]

    def drives(self, cycles: int) -> tuple[float, ...]:
        """Turning points from all cells at 0, or from `states[0]`, through this many cycles."""
        pair = (self.high, self.low) if self.direction > 0 else (self.low, self.high)
        return self.turns + pair * cycles

    def __repr__(self):
        drives, rhythm = f"{number(self.low)} to {number(self.high)}", f"period {self.period}"
        states = ">".join(self.states)
        return f"Accumulator({states}, drive {drives}, transient {self.transient}, {rhythm})"


@dataclass(frozen=True, slots=True, eq=False)
class Counting(ByValue):
    """Result of a search for accumulators.

    Attributes:
        accumulators: one for each list of states, the longest first.
        exhaustive: whether every pair of extremes was tried, or none had to be tried.
    """

    accumulators: tuple[Accumulator, ...]
    exhaustive: bool

    def __repr__(self):
        part = "" if self.exhaustive else ", searched in part"
        return f"Counting({len(self.accumulators)} accumulators{part})"


def counting(atlas: BranchAtlas, routes: Routes, *, by_hand: bool) -> Counting:
    """Accumulators of all cycles between all extremes, from every reachable branch.

    The effect of a cycle changes only where an extreme passes an end of a branch. So one extreme
    between every two neighbouring ends stands for all. `routes` are from all cells at 0; with
    `by_hand` it also begins on branches that only a hand can set.
    """
    numbers = np.arange(len(routes.reached)) if by_hand else np.flatnonzero(routes.reached)
    branches = atlas.mesostates.among(numbers)
    # From every end of a branch to the next one.
    ends = np.unique(np.concatenate([branches.low, branches.high]))
    gaps = np.column_stack([ends[:-1], ends[1:]])[np.diff(ends) > branches.slip]
    most = int((_BUDGET / len(numbers)) ** 0.5)
    exhaustive = len(gaps) <= most
    if not exhaustive:
        gaps = gaps[np.unique(np.linspace(0, len(gaps) - 1, most).astype(int))]
    accumulators: list[Accumulator] = []
    for direction in (+1, -1):
        seen = gaps if direction > 0 else -gaps[::-1, ::-1]
        for orbit, (low, high) in _orbits(branches.toward(direction), seen).items():
            begin, end = direction * float(low.mean()), direction * float(high.mean())
            slack = float(min(np.ptp(low), np.ptp(high))) / 2
            states = tuple(atlas.label_at(int(numbers[b]), begin) for b in orbit)
            transient, first = orbit.index(orbit[-1]), int(numbers[orbit[0]])
            rhythm = transient, len(orbit) - 1 - transient
            hand = not routes.reached[first]
            turns = (begin,) if hand else routes.turns(first, begin)
            drives = min(begin, end), max(begin, end)
            accumulators.append(
                Accumulator(*drives, direction, states, *rhythm, slack, hand, turns)
            )
    accumulators.sort(key=lambda a: (-len(a.states), -a.period, -a.slack))
    return Counting(tuple(accumulators), exhaustive)


def _orbits(branches: Mesostates, gaps: Floats) -> dict[tuple[int, ...], tuple[Floats, Floats]]:
    """Branches at the lower extreme after each cycle, and the widest gaps of extremes for that."""
    middles = gaps.mean(axis=1)
    widths = np.diff(gaps, axis=1)[:, 0]
    everywhere = np.broadcast_to(np.arange(len(branches)), (len(gaps), len(branches)))
    risen = branches.risen(everywhere, middles[:, None])
    fallen = branches.toward(-1).risen(everywhere, -middles[:, None])
    widest_gaps: dict[tuple[int, ...], tuple[float, int, int]] = {}
    for low in range(len(gaps) - 1):
        stands = (branches.low <= middles[low]) & (middles[low] <= branches.high)
        starts = np.flatnonzero(stands)
        # One cycle from each branch, for each of the higher extremes.
        cycle = fallen[low][risen[low + 1 :]]
        once = cycle[:, starts]
        extreme, column = np.nonzero(np.take_along_axis(cycle, once, axis=1) != once)
        width = np.minimum(widths[low], widths[low + 1 :][extreme])
        widest = np.argsort(-width, kind="stable")
        extreme, start = extreme[widest], starts[column[widest]]
        orbits = _followed(cycle, extreme, start)
        for row in np.unique(orbits, axis=0, return_index=True)[1].tolist() if len(orbits) else ():
            orbit = tuple(orbits[row][orbits[row] >= 0].tolist())
            better = (float(width[widest[row]]), low, low + 1 + int(extreme[row]))
            widest_gaps[orbit] = max(widest_gaps.get(orbit, better), better)
    return {orbit: (gaps[low], gaps[high]) for orbit, (_, low, high) in widest_gaps.items()}


def _followed(cycle: Ints, extreme: Ints, start: Ints) -> Ints:
    """(M, T) branches after each cycle until the first comes again; -1 after that."""
    steps = [start]
    done = np.zeros(len(start), bool)
    while not np.all(done):
        step = cycle[extreme, np.maximum(steps[-1], 0)]
        again = np.any([step == earlier for earlier in steps], axis=0)
        steps.append(np.where(done, -1, step))
        done |= again
    return np.column_stack(steps)
