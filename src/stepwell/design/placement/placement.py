"""Places for all cells at once, so that their end forces come in two wanted orders, surely."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stepwell.base import Bools, Floats
from stepwell.design.orders import Orders
from stepwell.design.placement.candidates import Candidates, Rule, joined
from stepwell.design.placement.holes import best_choice
from stepwell.design.placement.region import Region

Offer = Callable[[int, "Placement"], Candidates]

_FINEST = 1e-6  # m, where refining stops
_MOST_ROUNDS = 1000
_WORTH_IT = 1e-4  # of a score, for a cell to move
_AROUND = np.stack(np.meshgrid(*[np.arange(-2.0, 3.0)] * 2), axis=-1).reshape(-1, 2)
# Where nothing can fail the chances of all designs are 1 and say nothing. So gaps are counted in
# units that make the smallest of them at most this: the question becomes what happens at larger
# tolerances. The more, the less do the other gaps count.
_SURE = 3.0
_SURER = (2.0, 4.0, 8.0, 16.0, 32.0, 64.0)
_SHORTER = 0.7  # first step of every next one of these


@dataclass(frozen=True, eq=False)
class Placement:
    """A choice of one candidate for every cell.

    Attributes:
        cells: the N chosen candidates.
        gaps: those between neighbours in F0, then in F1, over their deviations; in the worst
            case the radii [m] at which they close, and those at which the proof of a cell ends.
    """

    cells: Candidates
    gaps: Floats

    @property
    def smallest(self) -> float:
        """The smallest of the gaps; above zero where both orders are met."""
        return float(np.min(self.gaps, initial=math.inf))

    def quality(self, worst: bool) -> tuple[float, float]:
        """The larger the better: first the chance that no gap closes, then the smallest gap."""
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


def shared(tables: list[Candidates], owner: tuple[int, ...]) -> Bools:
    """Which of all candidates in a row each cell may take, (N, m)."""
    number = np.repeat(np.arange(len(tables)), [len(table.q) for table in tables])
    return number == np.array(owner)[:, None]


def choose(
    rule: Rule, orders: Orders, tables: list[Candidates], owner: tuple[int, ...], most_nodes: int
) -> tuple[Placement | None, bool, int]:
    """The best choice from tables of candidates, by complete search.

    Args:
        rule: what counts as sure.
        orders: wanted.
        tables: of candidates.
        owner: for every cell the number of its table.
        most_nodes: where to give up.

    Returns:
        The choice, None where none was found; whether the search was complete, which proves
        that it is the best one, or that there is none; and how many partial choices it took.
    """
    from scipy.special import log_ndtr  # pyright: ignore[reportMissingTypeStubs]

    table, allowed = joined(tables), shared(tables, owner)
    gaps = rule.gaps(table)
    found = best_choice(gaps, allowed, orders, add=False, most_nodes=most_nodes)
    proved, nodes = found.complete, found.nodes
    if not len(found.picks):
        return None, proved, nodes
    picks = found.picks
    if not rule.worst and len(orders) > 1:
        worth = np.where(gaps > -np.inf, log_ndtr(gaps / max(found.value / _SURE, 1.0)), -np.inf)
        floor = sum(
            float(worth[end, a, b])
            for end, order in enumerate(orders.rising)
            for a, b in zip(picks[list(order)], picks[list(order)][1:], strict=False)
        )
        better = best_choice(worth, allowed, orders, add=True, floor=floor, most_nodes=most_nodes)
        proved, nodes = proved and better.complete, nodes + better.nodes
        picks = better.picks if len(better.picks) else picks
    return measured(rule, orders, table.take(picks)), proved, nodes


@dataclass(eq=False)
class Search:
    """One cell after the other goes where it is best, the others staying, until none moves."""

    rule: Rule
    orders: Orders
    regions: tuple[Region, ...]

    def pattern(self, tables: list[Candidates]) -> Placement:
        """The wanted orders in small in the middle of what is possible, as far as tables allow."""
        force = np.concatenate([table.force for table in tables])
        middle, span = np.median(force, axis=0), 0.5 * np.ptp(force, axis=0) + 1e-300
        picks: list[Candidates] = []
        for i, table in enumerate(tables):
            ranks = np.array([order.index(i) for order in self.orders.rising])
            wanted = middle + (ranks / max(len(self.orders) - 1, 1) - 0.5) * span
            away = np.sum(((table.force - wanted) / span) ** 2, axis=1)
            picks.append(table.take(np.array([np.argmin(away)])))
        return measured(self.rule, self.orders, joined(picks))

    def settle(
        self, now: Placement, offer: Offer, rounds: int, sure: float = _SURE
    ) -> tuple[Placement, int]:
        """Let every cell in turn take the best offer, until a round moves none.

        Returns:
            The placement, and how many rounds moved a cell.
        """
        # Not by number, so that which cell is which changes nothing.
        turn = list(self.orders.loading)
        # The same for all, or cells could follow each other round in circles.
        unit = self._unit(now, sure)
        for k in range(rounds):
            moved = False
            for i in turn:
                offered = offer(i, now)
                if not len(offered.q):
                    continue
                score = self._score(now.cells, i, offered, unit)
                kept = self._score(now.cells, i, now.cells.take(np.array([i])), unit)[0]
                best = int(np.argmax(score))
                if score[best] > kept + _WORTH_IT * abs(kept):
                    cells = Candidates._make(column.copy() for column in now.cells)
                    for column, value in zip(cells, offered, strict=True):
                        column[i] = value[best]
                    now = measured(self.rule, self.orders, cells)
                    moved = True
            if not moved:
                return now, k
            turn.reverse()
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
            if place > 0:
                j = order[place - 1]
                gap = (force - cells.force[j, end]) / self.rule.combined(down, cells.up[j, end])
                total += log_ndtr(gap / unit)
            if place + 1 < len(order):
                j = order[place + 1]
                gap = (cells.force[j, end] - force) / self.rule.combined(cells.down[j, end], up)
                total += log_ndtr(gap / unit)
        return total

    def refine(self, now: Placement, pitch: float) -> Placement:
        """Go on with finer and finer lattices round each place, down to a micrometre."""
        left = _MOST_ROUNDS
        for turn, sure in enumerate(_SURER if self.rule.worst else (_SURE,)):
            step = pitch * _SHORTER**turn
            while step >= _FINEST and left > 0:
                now = self.renewed(now)

                def offer(i: int, now: Placement, step: float = step) -> Candidates:
                    radius = max(now.smallest, 0.0) if self.rule.worst else 0.0
                    around = now.cells.q[i] + step * _AROUND
                    return self.rule.everything(self.regions[i], around, radius)

                now, used = self.settle(now, offer, left, sure)
                left -= used
                step /= 2
        return self.renewed(now)

    def renewed(self, now: Placement) -> Placement:
        """The same places looked at anew: the worst case is exact for one displacement only."""
        if not self.rule.worst:
            return now
        for _ in range(3):
            cells = self.rule.these(now.cells.q, now.cells.kind, max(now.smallest, 0.0))
            now = measured(self.rule, self.orders, cells)
        return now
