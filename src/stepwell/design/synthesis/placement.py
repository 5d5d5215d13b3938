"""Places of all cells with which their critical forces are in two target orders, robustly."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stepwell.base import Bools, Floats
from stepwell.concave import certified
from stepwell.design.orders import Orders
from stepwell.design.plane import narrowed, trace
from stepwell.design.synthesis.candidates import Candidates, Rule, joined
from stepwell.design.synthesis.holes import Offered, best_choice
from stepwell.design.synthesis.region import Region

_NODES = 81
_HALVINGS = 16


def outlines(rule: Rule, region: Region) -> list[Floats]:
    """Closed curves (m, 2) around the feasible (F0, F1) [N] of one cell, for every kind.

    The images of the edges of the allowed anchors, each edge located on a grid and bisected.
    """
    grid = region.bounds.grid(_NODES)
    # One more node on every side, so that the sides of the box are edges like all others.
    rim = np.pad(grid, ((1, 1), (1, 1), (0, 0)), mode="reflect", reflect_type="odd")
    curves: list[Floats] = []
    for k in range(len(rule.kinds)):

        def allowed(q: Floats, k: int = k) -> Bools:
            return region.holds(q) & rule.allowed(q, k)

        label = np.zeros(rim.shape[:2], np.int64)
        label[1:-1, 1:-1] = allowed(grid.reshape(-1, 2)).reshape(_NODES, _NODES)
        for a, b in trace(label, lambda row, column: 0):
            inside = label[a][:, None] == 1
            low, high = np.where(inside, rim[a], rim[b]), np.where(inside, rim[b], rim[a])
            yes = np.ones(len(low), np.bool_)
            low, _, _ = narrowed(allowed, low, high, yes, ~yes, _HALVINGS)
            # A corner of the box is the end of two edges.
            new = np.append(True, np.any(np.diff(low, axis=0) != 0.0, axis=1))
            curves.append(rule.kinds[k].ends(rule.differences(low[new]))[0])
    return curves


_FINEST = 64  # squares along the longer side of the region


def all_proved(rule: Rule, region: Region) -> bool:
    """Whether every kind of cell is proved at every place of the region.

    Squares cover the region; a disc around each is proved as a whole, or the square is divided.
    """
    if rule.bends:
        return False
    box = region.bounds
    side = max(box.right - box.left, box.top - box.bottom)
    for kind in rule.kinds:
        middles = np.array([[(box.left + box.right) / 2, (box.bottom + box.top) / 2]])
        half = side / 2
        while len(middles):
            if half < side / 2 / _FINEST:
                return False
            # If both anchors are free, d moves twice as far as either.
            around = (2.0 if rule.free == "both" else 1.0) * half * math.sqrt(2.0)
            held = certified(kind.cell, rule.differences(middles), around)
            corners = half / 2 * np.array([(-1, -1), (1, -1), (-1, 1), (1, 1)])
            middles = (middles[~held][:, None] + corners).reshape(-1, 2)
            half /= 2
            away = np.max(np.abs(region.clamped(middles) - middles), axis=1)
            middles = middles[away <= half * (1 + 1e-9)]
    return True


Offer = Callable[[int, "Placement"], Candidates]

_FINEST_STEP = 1e-6  # m, where refining stops
_MOST_ROUNDS = 1000
_LEAST_GAIN = 1e-4  # of a score, for a cell to move
_LATTICE = np.stack(np.meshgrid(*[np.arange(-2.0, 3.0)] * 2), axis=-1).reshape(-1, 2)
# If no sample fails, all designs have probability 1. So gaps are scaled until the smallest is at
# most this, which corresponds to larger tolerances. For larger values the other gaps count less.
_SURE = 3.0
_SURER = (2.0, 4.0, 8.0, 16.0, 32.0, 64.0)
_SHORTER = 0.7  # first step of every next one of these


@dataclass(frozen=True, eq=False)
class Placement:
    """A choice of one candidate for every cell.

    Gaps between neighbours in F0, then in F1, over their deviations; in the worst case the radii
    [m] at which they close, and the radii at which the proof of a cell ends.
    """

    cells: Candidates
    gaps: Floats

    @property
    def smallest(self) -> float:
        """The smallest of the gaps; above zero where both orders are met."""
        return float(np.min(self.gaps, initial=math.inf))

    def quality(self, worst: bool) -> tuple[float, float]:
        """Quality, larger is better: the chance that no gap closes, then the smallest gap."""
        from scipy.special import log_ndtr  # pyright: ignore[reportMissingTypeStubs]

        chance = float(np.sum(log_ndtr(self.gaps)))
        return (0.0 if worst or chance > -1e-9 else chance, self.smallest)


def measured(rule: Rule, orders: Orders, cells: Candidates) -> Placement:
    """A choice of candidates, one a cell, with its gaps."""
    gaps: list[Floats] = []
    for end, order in enumerate(orders.rising):
        at = list(order)
        force, down, up = cells.force[at, end], cells.down[at, end], cells.up[at, end]
        gaps.append(np.diff(force) / rule.combined(up[:-1], down[1:]))
    room = cells.room[np.isfinite(cells.room)]
    return Placement(cells, np.concatenate([*gaps, room]))


def shared(rule: Rule, tables: list[Candidates], owner: tuple[int, ...]) -> Offered:
    """Which of all candidates in a row each cell may take, with their bands."""
    number = np.repeat(np.arange(len(tables)), [len(table.q) for table in tables])
    packs = rule.packs.of(np.concatenate([table.kind for table in tables]))
    return Offered(number == np.array(owner)[:, None], packs)


def choose(
    rule: Rule, orders: Orders, tables: list[Candidates], owner: tuple[int, ...], most_nodes: int
) -> tuple[Placement | None, bool, int]:
    """The best choice, whether this is proved, and the number of nodes searched."""
    from scipy.special import log_ndtr  # pyright: ignore[reportMissingTypeStubs]

    table, offered = joined(tables), shared(rule, tables, owner)
    gaps = rule.gaps(table)
    best = best_choice(gaps, offered, orders, add=False, most_nodes=most_nodes)
    proved, nodes = best.complete, best.nodes
    if not len(best.picks):
        return None, proved, nodes
    picks = best.picks
    if not rule.worst and len(orders) > 1:
        chance = np.where(gaps > -np.inf, log_ndtr(gaps / max(best.value / _SURE, 1.0)), -np.inf)
        floor = sum(
            float(chance[end, a, b])
            for end, order in enumerate(orders.rising)
            for a, b in zip(picks[list(order)], picks[list(order)][1:], strict=False)
        )
        better = best_choice(chance, offered, orders, add=True, floor=floor, most_nodes=most_nodes)
        proved, nodes = proved and better.complete, nodes + better.nodes
        picks = better.picks if len(better.picks) else picks
    return measured(rule, orders, table.take(picks)), proved, nodes


@dataclass(eq=False)
class Search:
    """Coordinate search: each cell in turn takes its best place until none moves."""

    rule: Rule
    orders: Orders
    regions: tuple[Region, ...]

    def pattern(self, tables: list[Candidates]) -> Placement | None:
        """A small pattern of the target orders in the middle of the feasible forces.

        None if the packs do not hold the bands of the nearest candidates.
        """
        force = np.concatenate([table.force for table in tables])
        middle, span = np.median(force, axis=0), 0.5 * np.ptp(force, axis=0) + 1e-300
        picks: list[Candidates] = []
        for i, table in enumerate(tables):
            ranks = np.array([order.index(i) for order in self.orders.rising])
            wanted = middle + (ranks / max(len(self.orders) - 1, 1) - 0.5) * span
            taken = np.array([int(one.kind[0]) for one in picks], int)
            table = self.rule.left(table, taken)
            if not len(table.q):
                return None
            away = np.sum(((table.force - wanted) / span) ** 2, axis=1)
            picks.append(table.take(np.array([np.argmin(away)])))
        return measured(self.rule, self.orders, joined(picks))

    def settle(
        self, now: Placement, offer: Offer, rounds: int, sure: float = _SURE
    ) -> tuple[Placement, int]:
        """Place each cell in turn at its best offer until a round moves none; counts the rounds."""
        # One unit for all, or cells could alternate without end.
        unit = self._unit(now, sure)
        for k in range(rounds):
            before = now
            # Not by number, so that the result does not depend on the labels of the cells.
            for i in self.orders.loading[:: -1 if k % 2 else 1]:
                offered = self.rule.left(offer(i, now), np.delete(now.cells.kind, i))
                if not len(offered.q):
                    continue
                score = self._score(now.cells, i, offered, unit)
                current = self._score(now.cells, i, now.cells.take(np.array([i])), unit)[0]
                best = int(np.argmax(score))
                if score[best] > current + _LEAST_GAIN * abs(current):
                    cells = Candidates._make(column.copy() for column in now.cells)
                    for column, value in zip(cells, offered, strict=True):
                        column[i] = value[best]
                    now = measured(self.rule, self.orders, cells)
            if now is before:
                return now, k
        return now, rounds

    def _unit(self, now: Placement, sure: float) -> float:
        if self.rule.worst and now.smallest <= 0.0:
            return float(np.mean(np.abs(now.gaps))) / sure
        unit = now.smallest / sure if self.rule.worst else max(now.smallest / sure, 1.0)
        return unit if math.isfinite(unit) else 1.0  # a single cell has no gaps

    def _score(self, cells: Candidates, i: int, offered: Candidates, unit: float) -> Floats:
        from scipy.special import log_ndtr  # pyright: ignore[reportMissingTypeStubs]

        total = log_ndtr(offered.room / unit)
        for end, order in enumerate(self.orders.rising):
            place = order.index(i)
            force, down, up = offered.force[:, end], offered.down[:, end], offered.up[:, end]
            for next_, sign, own, other in ((-1, 1.0, down, cells.up), (1, -1.0, up, cells.down)):
                if 0 <= place + next_ < len(order):
                    j = order[place + next_]
                    near = self.rule.combined(own, other[j, end])
                    total += log_ndtr(sign * (force - cells.force[j, end]) / near / unit)
        return total

    def refine(self, now: Placement, pitch: float) -> Placement:
        """Refine with finer and finer lattices around each place, down to a micrometre."""
        left, sites = _MOST_ROUNDS, self.rule.sites(self.regions)
        for turn, sure in enumerate(_SURER if self.rule.worst else (_SURE,)):
            step = pitch * _SHORTER**turn
            while step >= _FINEST_STEP and left > 0:
                now = self.recomputed(now)

                def offer(i: int, now: Placement, step: float = step) -> Candidates:
                    radius = max(now.smallest, 0.0) if self.rule.worst else 0.0
                    around = now.cells.q[i] + step * _LATTICE
                    return self.rule.everything(sites[i].region, around, radius, sites[i].kinds)

                now, used = self.settle(now, offer, left, sure)
                left -= used
                step /= 2
        return self.recomputed(now)

    def recomputed(self, now: Placement) -> Placement:
        """The same places recomputed: the worst case is exact for one displacement only."""
        if not self.rule.worst:
            return now
        for _ in range(3):
            cells = self.rule.these(now.cells.q, now.cells.kind, max(now.smallest, 0.0))
            now = measured(self.rule, self.orders, cells)
        return now
