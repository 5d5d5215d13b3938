"""Choices of holes that no closed form decides: the engine tries them one by one."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations, combinations_with_replacement, permutations, product
from typing import NamedTuple

import numpy as np

from stepwell.concave import closed
from stepwell.design.orders import Seen, Target
from stepwell.design.placement import Region, Rule, lattice
from stepwell.design.synthesis.attempt import named
from stepwell.mechanism import Cell, Chain
from stepwell.statics import StaticsError

# Cells of all chains that are tried, through a cycle or along all their branches: some seconds.
_THROUGH_A_CYCLE, _ALONG_ALL_BRANCHES = 12_000, 2_400


class Buildable(NamedTuple):
    """A way to build a cell."""

    cell: Cell
    concave: bool  # proved, as drawn


@dataclass(frozen=True)
class Tried:
    """What came of trying choices of holes.

    Attributes:
        chains: those that do what is wanted.
        open: how many choices there are that no closed form decides.
        tried: how many of them were followed.
        unanswered: of how many of those the engine could not tell what they do.
    """

    chains: tuple[Chain, ...]
    open: int
    tried: int
    unanswered: int

    @property
    def all(self) -> bool:
        """Whether there is none of which it is not known what it does."""
        return self.tried == self.open and not self.unanswered

    @property
    def report(self) -> str:
        """What was tried, in words."""
        if self.all:
            return f"all {self.open} choices that no closed form decides were run by the engine"
        text = f"{self.tried} of {self.open} choices that no closed form decides were run"
        return text + (f", {self.unanswered} of them without an answer" * (self.unanswered > 0))


def tried(
    target: Target,
    rules: list[Rule],
    regions: tuple[Region, ...],
    holes: float,
    *,
    decided: bool,
    actuator_stiffness: float,
    seed: int,
    progress: Callable[[int, int], None],
) -> Tried:
    """Follow every choice of holes that is left, or as many as take some seconds.

    Args:
        target: what is wanted.
        rules: what may be built, one after the other.
        regions: of every cell.
        holes: pitch [m].
        decided: whether it is known of all choices of cells that are proved concave as drawn, and
            share a full travel, that they do not do it.
        actuator_stiffness: K [N/m].
        seed: which choices, where they are too many.
        progress: called with (done, total) choices.
    """
    different = list(dict.fromkeys(regions))
    alike, again = len(set(regions)) == 1, target.twins
    most = (_THROUGH_A_CYCLE if target.states is None else _ALONG_ALL_BRANCHES) // target.cells
    found: list[Chain] = []
    left = done = unanswered = 0
    for rule in rules:
        mine = [_ways(rule, region, holes) for region in different]
        tables = [mine[different.index(region)] for region in regions]
        settled = decided and len({kind.lever for kind in rule.kinds}) == 1
        count = _count(tables, alike, again, settled)
        left += count
        room = most - done
        picked = (
            _every(tables, alike, again, settled)
            if count <= room
            else _some(tables, settled, room, np.random.default_rng(seed))
        )
        for cells in picked:
            progress(done, min(most, left))
            done += 1
            chain = Chain([way.cell for way in cells], actuator_stiffness)
            try:
                seen = target.look(chain)
            except (StaticsError, ValueError):
                unanswered += 1
                continue
            order = _as_wanted(target, seen, alike)
            if order is None or seen.peak > rule.most_force * (1 + 1e-9):
                continue
            mine_now = [cells[k].cell for k in order]
            found.append(named(mine_now, actuator_stiffness, f"Designed for {target.text}"))
    return Tried(tuple(found), left, done, unanswered)


def _ways(rule: Rule, region: Region, holes: float) -> list[Buildable]:
    """All ways to build a cell, those not proved concave first."""
    found: list[Buildable] = []
    for x, y in region.clamped(lattice(region, holes)).tolist():
        for k in range(len(rule.kinds)):
            try:
                cell = rule.cell((x, y), k)
            except ValueError:
                continue  # nobody can build it
            if max(abs(cell.force_0), abs(cell.force_1)) <= rule.most_force:
                found.append(Buildable(cell, closed(cell) is not None))
    return sorted(found, key=lambda way: way.concave)


def _count(tables: list[list[Buildable]], alike: bool, again: bool, settled: bool) -> int:
    """How many choices there are; equal cells never part without a tie, `again` if they may."""

    def all_of(sizes: list[int]) -> int:
        if not alike:
            return math.prod(sizes)
        n, m = len(sizes), sizes[0]
        return math.comb(m + n - 1, n) if again and m else math.comb(m, n)

    every = all_of([len(table) for table in tables])
    if not settled:
        return every
    return every - all_of([sum(way.concave for way in table) for table in tables])


def _every(
    tables: list[list[Buildable]], alike: bool, again: bool, settled: bool
) -> Iterator[tuple[Buildable, ...]]:
    """All choices, those of concave cells alone left out where they are settled."""
    n = len(tables)
    if alike:
        table = tables[0]
        pick = combinations_with_replacement if again else combinations
        if not settled:
            yield from pick(table, n)
            return
        # Those that are not proved concave come first, so one of them leads.
        for k, way in enumerate(table):
            if way.concave:
                return
            for others in pick(table[k if again else k + 1 :], n - 1):
                yield (way, *others)
        return
    if not settled:
        yield from product(*tables)
        return
    for k in range(n):
        before = [[way for way in table if way.concave] for table in tables[:k]]
        here = [way for way in tables[k] if not way.concave]
        yield from product(*before, here, *tables[k + 1 :])


def _some(
    tables: list[list[Buildable]], settled: bool, most: int, rng: np.random.Generator
) -> Iterator[tuple[Buildable, ...]]:
    """So many different choices at random."""
    seen: set[tuple[int, ...]] = set()
    for _ in range(20 * most):
        if len(seen) == most:
            return
        picks = tuple(int(rng.integers(len(table))) for table in tables)
        cells = tuple(table[k] for table, k in zip(tables, picks, strict=True))
        if picks in seen or (settled and all(way.concave for way in cells)):
            continue
        seen.add(picks)
        yield cells


def _as_wanted(target: Target, seen: Seen, alike: bool) -> tuple[int, ...] | None:
    """Which cell of a chain has to be which wanted one; None where it does something else.

    The order of cells along a chain changes nothing but their names, so where all may be built
    alike any order will do.
    """
    if seen.tied:
        return None
    n = target.cells
    same = tuple(range(n))
    if target.states is not None:
        assert seen.states is not None
        if Counter(s.count("1") for s in seen.states) != Counter(
            s.count("1") for s in target.states
        ):
            return None
        for place in permutations(same) if alike else (same,):
            if {"".join(s[k] for k in place) for s in seen.states} == target.states:
                return place
        return None
    found = seen.sequence.orders
    if found is None:
        return None
    for wanted in target.wish.orders:
        place = same
        if alike:
            which = dict(zip(wanted.loading, found[0], strict=True))
            place = tuple(which[k] for k in same)
        orders = (wanted.loading, wanted.unloading)
        if tuple(tuple(place[k] for k in order) for order in orders) == found:
            return place
    return None
