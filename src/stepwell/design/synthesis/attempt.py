"""One attempt at a design with given orders, bands and levers."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from stepwell.base import Floats, to_unit
from stepwell.design.orders import Orders
from stepwell.design.synthesis import placement
from stepwell.design.synthesis.candidates import Candidates, Rule, Site, differences, joined
from stepwell.design.synthesis.holes import best_choice, fits
from stepwell.design.synthesis.region import HoleGrid, Region, drilled, lattice
from stepwell.mechanism import Cell, Chain

# Node limits of a complete search among holes (some ten seconds), and of a first search.
_MOST_NODES = 3_000_000
_START_NODES = 100_000
# Candidates of the first step: at most of one kind in one region, about of all, at least.
_LATTICE, _LATTICE_OF_ALL, _LATTICE_LEAST = 150, 240, 24
_LATTICE_MOST = 20_000  # places, if few of them are allowed
_ROUNDS = 200
_DECIMALS = 6  # decimals of a metre


@dataclass(frozen=True, eq=False)
class Attempt:
    """An attempt and its best placement."""

    rule: Rule
    orders: Orders
    regions: tuple[Region, ...]
    holes: HoleGrid | None
    tables: list[Candidates]  # candidates of the first step, for every different region
    owner: tuple[int, ...]  # number of the table of every cell
    best: placement.Placement | None
    complete: bool  # whether all choices from the tables were compared
    nodes: int  # number of partial choices
    pitch: float  # of the lattice or the holes [m]

    @property
    def quality(self) -> tuple[float, float]:
        """Quality of the best placement; larger is better."""
        if self.best is None:
            return -math.inf, -math.inf
        return self.best.quality(self.rule.worst)

    @property
    def meets_orders(self) -> bool:
        """Whether the best placement meets both orders."""
        return self.best is not None and self.best.smallest > 0.0

    @property
    def excluded(self) -> str:
        """Number of holes where the band is not proved, or too strong for the actuator."""
        if self.holes is None:
            return ""
        every = dict.fromkeys(self.rule.sites(self.regions))
        ways = sum(len(kinds) * len(drilled(region, self.holes)) for region, kinds in every)
        out = ways - self.candidates
        return f"{out} of {ways} holes" if out else ""

    @property
    def candidates(self) -> int:
        """Number of candidates for a cell in the first step."""
        return sum(len(table.q) for table in self.tables)

    def refined(self) -> "Attempt":
        """The attempt with anchors anywhere, not only on the lattice of the first step."""
        if self.best is None or self.holes is not None:
            return self
        search = placement.Search(self.rule, self.orders, self.regions)
        best = search.refine(self.best, self.pitch / 2)
        q = np.round(best.cells.q, _DECIMALS) + 0.0  # no -0
        q = np.concatenate([r.clamped(q[i : i + 1]) for i, r in enumerate(self.regions)])
        rounded = self.rule.these(q, best.cells.kind)
        if len(rounded.q) == len(self.orders):
            best = search.recomputed(placement.measured(self.rule, self.orders, rounded))
        return replace(self, best=best)

    def chain(self, actuator_stiffness: float, title: str) -> Chain:
        """The best placement as a chain."""
        assert self.best is not None
        q, kinds = self.best.cells.q.tolist(), self.best.cells.kind.tolist()
        cells = [self.rule.cell((x, y), k) for (x, y), k in zip(q, kinds, strict=True)]
        return named_chain(cells, actuator_stiffness, title)

    @property
    def bands(self) -> str:
        """The rest lengths of the bands, in words."""
        rest = {f"{to_unit(kind.band.rest_length, 'mm'):.4g}" for kind in self.rule.kinds}
        return f"band (rest length {' or '.join(sorted(rest, key=float))} mm)"

    def smallest_gap(self) -> float:
        """Smallest gap between neighbours in the target orders of the best placement [N]."""
        if self.best is None:
            return math.nan
        force = self.best.cells.force
        gaps = [np.diff(force[list(order), end]) for end, order in enumerate(self.orders.rising)]
        return float(np.min(gaps, initial=math.inf))

    def largest_gap(self) -> float:
        """Upper bound of the smallest gap if no choice meets the orders [N]."""
        if len(self.tables) == 1 and not self.rule.limited:
            return 0.0  # all cells in one hole
        gaps = differences(joined(self.tables))
        offered = placement.shared(self.rule, self.tables, self.owner)
        selection = best_choice(gaps, offered, self.orders, add=False, most_nodes=_START_NODES)
        return selection.value

    def region(self) -> tuple[Floats, ...]:
        """Feasible pairs (F0, F1) [N] of a cell: closed curves, or those of all holes."""
        if self.holes is not None:
            return tuple(table.force for table in self.tables)
        different = dict.fromkeys(self.regions)
        return tuple(curve for one in different for curve in placement.outlines(self.rule, one))


def named_chain(cells: Sequence[Cell], actuator_stiffness: float, title: str) -> Chain:
    """A chain of cells with names."""
    n = len(cells)
    names = ("inner", "outer") if n == 2 else tuple(f"cell {i + 1}" for i in range(n))
    named = tuple(replace(cell, name=name) for cell, name in zip(cells, names, strict=True))
    return Chain(named, actuator_stiffness, title)


def from_lattice(
    rule: Rule, orders: Orders, regions: tuple[Region, ...], holes: HoleGrid | None
) -> Attempt:
    """The best choice from a lattice or from all holes, by complete search if these are few."""
    pitch, tables, owner = _tables(rule, regions, holes)
    if not all(len(table.q) for table in tables):
        return Attempt(rule, orders, regions, holes, tables, owner, None, True, 0, pitch)
    best, complete, nodes = None, False, 0
    if fits(len(orders), sum(len(table.q) for table in tables)):
        most = _START_NODES if holes is None else _MOST_NODES
        best, complete, nodes = placement.choose(rule, orders, tables, owner, most)
    if best is None and not (complete and holes is not None):
        search, mine = placement.Search(rule, orders, regions), [tables[k] for k in owner]
        best = search.pattern(mine)
        if best is not None:
            best, _ = search.settle(best, lambda i, now: mine[i], rounds=_ROUNDS)
        if best is not None and holes is not None:
            best = search.recomputed(best)
    return Attempt(rule, orders, regions, holes, tables, owner, best, complete, nodes, pitch)


def possible(
    rule: Rule, orders: Orders, regions: tuple[Region, ...], holes: HoleGrid | None
) -> bool:
    """Whether a short search among the holes finds a choice that meets both orders."""
    _, tables, owner = _tables(rule, regions, holes)
    if not all(len(table.q) for table in tables):
        return False
    if not fits(len(orders), sum(len(table.q) for table in tables)):
        return False
    best, _, _ = placement.choose(rule, orders, tables, owner, _START_NODES)
    return best is not None and best.smallest > 0.0


def _tables(
    rule: Rule, regions: Sequence[Region], holes: HoleGrid | None
) -> tuple[float, list[Candidates], tuple[int, ...]]:
    """The pitch [m] of the lattice or the holes, candidates, and the number of each cell's."""
    sites = rule.sites(regions)
    different = list(dict.fromkeys(sites))
    owner = tuple(map(different.index, sites))
    if holes is not None:
        tables = [
            rule.everything(region, drilled(region, holes), kinds=kinds)
            for region, kinds in different
        ]
        return holes.pitch, tables, owner
    share = _LATTICE_OF_ALL / sum(len(site.kinds) for site in different)
    places = min(_LATTICE, max(_LATTICE_LEAST, share))
    pitches, tables = zip(*(_lattice(rule, site, places) for site in different), strict=True)
    return max(pitches), list(tables), owner


def _lattice(rule: Rule, site: Site, places: float) -> tuple[float, Candidates]:
    """Pitch [m] of a lattice with about `places` allowed places, and its candidates."""
    region, kinds = site
    box = region.bounds
    pitch = max(box.right - box.left, box.top - box.bottom)
    while True:
        q = lattice(region, pitch)
        table = rule.everything(region, q, kinds=kinds)
        if len(table.q) >= 0.8 * places * len(kinds) or len(q) >= _LATTICE_MOST:
            return pitch, table
        pitch /= 1.1
