"""Search for a chain that reaches a target: closed forms first, then simulated candidates."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations, combinations_with_replacement, permutations, product, takewhile
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints, Progress, notify
from stepwell.concave import TIED, closed
from stepwell.design.synthesis.attempt import Attempt, from_lattice, named_chain
from stepwell.design.synthesis.candidates import Candidates, Rule, Site, joined
from stepwell.design.synthesis.designed import Impossible, explained
from stepwell.design.synthesis.evidence import (
    Evidence,
    HoleEvidence,
    RequirementEvidence,
    StateEvidence,
    rectangles,
)
from stepwell.design.synthesis.placement import all_proved, measured
from stepwell.design.synthesis.region import (
    BandType,
    HoleGrid,
    Region,
    allowed_text,
    drilled,
    packs_text,
    usual_box,
)
from stepwell.design.targets import Behaviour, Target
from stepwell.design.tolerances.draws import Tolerances
from stepwell.design.tolerances.yields import yields
from stepwell.mechanism import Cell, Chain
from stepwell.statics import StaticsError

_RANDOM = 5000  # placements of each attempt
_NEARBY = 200  # places around the best one of each cell
# Number of cells of all simulated chains: some seconds.
_LOOKED_AT = 2400


def random_placement(
    target: Target, attempts: list[Attempt], actuator_stiffness: float, seed: int
) -> tuple[Attempt | None, int]:
    """The most robust random placement that reaches the target, and the number simulated.

    Two orders decide which states are reached at least. A cell that passes another in a snap may
    reach more states, which the critical forces do not decide. So placements in the target orders
    are taken at random and simulated, the most robust first.
    """
    rng = np.random.default_rng(seed)
    pool: list[tuple[float, Attempt, Candidates]] = []
    for attempt in [one for given in attempts for one in (given, _nearby(given, rng))]:
        if not attempt.tables or not all(len(table.q) for table in attempt.tables):
            continue
        table = joined(attempt.tables)
        picks = _random_picks(attempt, rng)
        sure = _log_chance(attempt, table, picks)
        rows = np.flatnonzero(sure > -np.inf).tolist()
        pool += [(float(sure[row]), attempt, table.take(picks[row])) for row in rows]
    pool.sort(key=lambda one: -one[0])
    most = _LOOKED_AT // target.orders.cells
    for looked_at, (_, attempt, cells) in enumerate(pool[:most], 1):
        placed = replace(attempt, best=measured(attempt.rule, attempt.orders, cells))
        if _meets(target, placed, actuator_stiffness):
            finer = placed.refined()
            return (finer if _meets(target, finer, actuator_stiffness) else placed), looked_at
    return None, min(most, len(pool))


def _meets(target: Target, attempt: Attempt, actuator_stiffness: float) -> bool:
    return not target.fault(attempt.chain(actuator_stiffness, ""), attempt.orders)


def _nearby(attempt: Attempt, rng: np.random.Generator) -> Attempt:
    if attempt.best is None or attempt.holes is not None:
        return replace(attempt, tables=[])
    tables: list[Candidates] = []
    best = attempt.best.cells
    for region, q, kind in zip(attempt.regions, best.q, best.kind, strict=True):
        away = attempt.pitch * rng.uniform(0.01, 4.0, (_NEARBY, 1))
        away = away * rng.standard_normal((_NEARBY, 2))
        tables.append(attempt.rule.these(region.clamped(q + away), np.full(_NEARBY, kind)))
    return replace(attempt, tables=tables, owner=tuple(range(len(tables))))


def _random_picks(attempt: Attempt, rng: np.random.Generator) -> Ints:
    """(m, N) numbers of candidates, each cell's from its own table."""
    sizes = np.array([len(table.q) for table in attempt.tables])
    first = np.cumsum(sizes) - sizes
    owner = np.array(attempt.owner)
    return first[owner] + rng.integers(sizes[owner], size=(_RANDOM, len(owner)))


def _log_chance(attempt: Attempt, table: Candidates, picks: Ints) -> Floats:
    """(m,) logarithm of the chance that no gap closes; -inf where an order is not met."""
    from scipy.special import log_ndtr  # pyright: ignore[reportMissingTypeStubs]

    total = np.where(attempt.rule.within_packs(table.kind[picks]), 0.0, -np.inf)
    least = TIED * float(np.max(np.abs(table.force)))
    for end, order in enumerate(attempt.orders.rising):
        at = picks[:, list(order)]
        gap = np.diff(table.force[at, end], axis=1)
        near = attempt.rule.combined(table.up[at[:, :-1], end], table.down[at[:, 1:], end])
        # In the worst case a gap is not reduced without a displacement.
        ratio = np.divide(gap, near, out=gap.copy(), where=near > 0)
        total += np.sum(np.where(gap > least, log_ndtr(ratio), -np.inf), axis=1)
    return total


# Number of cells of all simulated chains, in cycles or along all branches: some seconds.
_THROUGH_A_CYCLE, _ALONG_ALL_BRANCHES = 12_000, 2_400


class Buildable(NamedTuple):
    """A way to build a cell."""

    cell: Cell
    concave: bool  # whether the nominal cell is proved concave
    kind: int


def _without_packs(attempts: Sequence[Attempt]) -> str:
    """What a design takes if packs are not limited, in words; "" if none is found."""
    for one in (attempt for attempt in attempts if attempt.rule.limited):
        free = tuple(replace(k, band=replace(k.band, pack=None)) for k in one.rule.kinds)
        found = from_lattice(replace(one.rule, kinds=free), one.orders, one.regions, one.holes)
        if found.meets_orders:
            assert found.best is not None
            taken = Counter[str]()
            for kind in (free[k] for k in found.best.cells.kind.tolist()):
                taken[kind.band.name or f"{kind.band.stiffness:.4g} N/m"] += kind.count
            needs = ", ".join(f"{count} of {band}" for band, count in taken.items())
            return f" (a choice without these limits exists and takes {needs})"
    return ""


def _buildable(rule: Rule, site: Site, holes: HoleGrid) -> list[Buildable]:
    region, kinds = site
    buildable: list[Buildable] = []
    places = drilled(region, holes)
    taut = {k: rule.kinds[k].taut(rule.differences(places)).tolist() for k in kinds}
    for row, (x, y) in enumerate(places.tolist()):
        for k in kinds:
            if not taut[k][row]:
                continue  # a slack band holds no state
            try:
                cell = rule.cell((x, y), k)
            except ValueError:
                continue  # cannot be built
            if max(abs(cell.force_0), abs(cell.force_1)) <= rule.most_force:
                buildable.append(Buildable(cell, closed(cell) is not None, k))
    return sorted(buildable, key=lambda way: way.concave)


def _count(tables: list[list[Buildable]], alike: bool, repeats: bool, settled: bool) -> int:
    """Number of choices; equal cells always tie, so cells differ unless `repeats`."""

    def all_of(sizes: list[int]) -> int:
        n, m = len(sizes), sizes[0]
        return math.comb(m + (n - 1) * repeats, n) if alike else math.prod(sizes)

    concave = all_of([sum(way.concave for way in table) for table in tables])
    return all_of([len(table) for table in tables]) - settled * concave


def _all_choices(
    tables: list[list[Buildable]], alike: bool, repeats: bool, settled: bool
) -> Iterator[tuple[Buildable, ...]]:
    if alike:
        every = (combinations_with_replacement if repeats else combinations)(tables[0], len(tables))
        # Cells that are not proved concave come first, so one of them is the first of each choice.
        yield from takewhile(lambda cells: not (settled and cells[0].concave), every)
        return
    if not settled:
        yield from product(*tables)
        return
    for k in range(len(tables)):
        before = [[way for way in table if way.concave] for table in tables[:k]]
        here = [way for way in tables[k] if not way.concave]
        yield from product(*before, here, *tables[k + 1 :])


def _random_choices(
    tables: list[list[Buildable]], settled: bool, most: int, rng: np.random.Generator
) -> Iterator[tuple[Buildable, ...]]:
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


def _matching_order(target: Target, seen: Behaviour, alike: bool) -> tuple[int, ...] | None:
    """Which cell of a chain is which cell of the target; None if it misses the target.

    The order of cells along a chain changes only their names, so any order will do if all cells
    may be built alike.
    """
    if seen.tied:
        return None
    if target.states is not None:
        assert seen.states is not None
        return _by_states(target.states, seen.states, alike)
    orders_seen = seen.sequence.orders
    if orders_seen is None:
        return None
    for wanted in target.orders.orders:
        same = tuple(range(target.orders.cells))
        place = tuple(orders_seen[0][wanted.loading.index(k)] for k in same) if alike else same
        orders = (wanted.loading, wanted.unloading)
        if tuple(tuple(place[k] for k in order) for order in orders) == orders_seen:
            return place
    return None


def _by_states(wanted: frozenset[str], seen: frozenset[str], alike: bool) -> tuple[int, ...] | None:
    """Which cell is which cell of the target for these states; None if no order will do."""
    if Counter(s.count("1") for s in seen) != Counter(s.count("1") for s in wanted):
        return None
    same = tuple(range(len(next(iter(wanted)))))
    for place in permutations(same) if alike else (same,):
        if {"".join(s[k] for k in place) for s in seen} == wanted:
            return place
    return None


_REFINED = 3  # attempts
# Choices whose yields are compared, and samples of each.
_COMPARED, _SAMPLES = 24, 40


@dataclass(frozen=True, eq=False)
class Placed:
    """Result of the search among candidates that the closed form decides."""

    best: Attempt | None  # the best that reaches the target in the simulation
    attempts: list[Attempt]
    complete: bool  # all choices were compared: none is better, or none reaches the target
    mismatch: str  # what a better candidate does in the simulation
    others: int  # number of random choices simulated
    weighed: str = ""  # the comparison by weights, in words

    @property
    def candidates(self) -> int:
        """Number of candidates for a cell in the first step."""
        return max((attempt.candidates for attempt in self.attempts), default=0)

    @property
    def proved_best(self) -> bool:
        """Whether all choices were compared, and one reaches the target."""
        return self.best is not None and self.complete


@dataclass
class TargetSearch:
    """The search for one target, with its progress."""

    target: Target
    regions: tuple[Region, ...]
    holes: HoleGrid | None
    actuator_stiffness: float
    seed: int
    progress: Progress
    rules: int  # sets of bands and levers
    free: str = "q"  # which anchors are placed
    usual: bool = False  # whether the region is the usual one of the lever
    bands: tuple[BandType, ...] = ()
    _done: int = field(default=0, init=False)

    @property
    def _total(self) -> int:
        once = self.rules * len(self.target.orders.orders) + _REFINED
        # Among holes there may be a second round, and then the rest.
        return once + 1 if self.holes is None else 2 * once + 100 + 1

    def _advance(self, step: int = 1) -> None:
        self._done = min(self._done + step, self._total)
        notify(self.progress, self._done, self._total)

    def end(self) -> None:
        """Report the search as finished."""
        self._advance(self._total)

    def placed(self, rules: list[Rule]) -> Placed:
        """The best choice by the objective that reaches the target."""
        placed = self._best_of_rules(rules)
        if placed.best is None and self.holes is not None:
            # More cells are proved concave in the nominal design than within all tolerances.
            placed = self._best_of_rules([replace(rule, as_drawn=True) for rule in rules])
        return placed

    def _best_of_rules(self, rules: list[Rule]) -> Placed:
        target, attempts = self.target, self._attempts(rules)
        complete = target.orders.complete and self.holes is not None
        complete = complete and not any(rule.bends for rule in rules)
        complete = complete and all(attempt.complete for attempt in attempts)
        mismatch, best, others = "", None, 0
        for attempt in filter(lambda attempt: attempt.meets_orders, attempts):
            fault = target.fault(attempt.chain(self.actuator_stiffness, ""), attempt.orders)
            if not fault:
                best = attempt
                break
            mismatch = mismatch or fault
        if mismatch and best is None:
            best, others = random_placement(target, attempts, self.actuator_stiffness, self.seed)
        return Placed(best, attempts, complete and not mismatch, mismatch, others)

    def _attempts(self, rules: list[Rule]) -> list[Attempt]:
        attempts: list[Attempt] = []
        for rule, orders in product(rules, self.target.orders.orders):
            self._advance()
            attempts.append(from_lattice(rule, orders, self.regions, self.holes))
        attempts.sort(key=lambda attempt: attempt.quality, reverse=True)
        for k in range(min(_REFINED, len(attempts))):
            self._advance()
            attempts[k] = attempts[k].refined()
        attempts.sort(key=lambda attempt: attempt.quality, reverse=True)
        return attempts

    def _most_cells(self) -> int:
        return _THROUGH_A_CYCLE if self.target.states is None else _ALONG_ALL_BRANCHES

    def _simulated_choices(
        self, rules: list[Rule], holes: HoleGrid, *, decided: bool
    ) -> tuple[list[Chain], bool, str]:
        """Simulate every remaining choice of holes, or random ones for some seconds.

        `decided`: no choice of cells proved concave and with one full travel reaches the target.
        Returned are the chains that reach it, whether all others are known to miss it, and a
        report.
        """
        target, regions, before = self.target, self.regions, self._done
        repeats = target.has_equal_cells
        most = self._most_cells() // target.orders.cells
        chains: list[Chain] = []
        left = done = unanswered = 0
        for rule in rules:
            sites = rule.sites(regions)
            alike = len(set(sites)) == 1
            ways = {site: _buildable(rule, site, holes) for site in dict.fromkeys(sites)}
            tables = [ways[site] for site in sites]
            settled = decided and len({kind.lever for kind in rule.kinds}) == 1
            count = _count(tables, alike, repeats, settled)
            left += count
            room = most - done
            picked = (
                _all_choices(tables, alike, repeats, settled)
                if count <= room
                else _random_choices(tables, settled, room, np.random.default_rng(self.seed))
            )
            for cells in picked:
                self._advance(max(0, before + 100 * done // max(min(most, left), 1) - self._done))
                done += 1
                if not rule.within_packs(np.array([way.kind for way in cells])):
                    continue
                try:
                    chain = self._matching(cells, rule.most_force, alike)
                except (StaticsError, ValueError):
                    unanswered += 1
                    continue
                if chain is not None:
                    chains.append(chain)
        choices = f"{left} remaining candidates were simulated" * (left > 0)
        if done == left and not unanswered:
            return chains, True, choices and f"all {choices}"
        mismatch = f", {unanswered} of them without an answer" * (unanswered > 0)
        return chains, False, f"{done} of {choices}{mismatch}"

    def _matching(self, cells: Sequence[Buildable], most_force: float, alike: bool) -> Chain | None:
        """The chain of these cells, if it reaches the target within the limit of force [N]."""
        target, stiffness = self.target, self.actuator_stiffness
        seen = target.simulate(Chain([way.cell for way in cells], stiffness))
        order = _matching_order(target, seen, alike)
        if order is None or not seen.peak <= most_force * (1 + 1e-9):
            return None
        these = [cells[k].cell for k in order]
        return named_chain(these, stiffness, f"Designed for {target.text}")

    def simulated(
        self, rules: list[Rule], placed: Placed, tolerances: Tolerances
    ) -> tuple[Chain, str]:
        """A chain that no closed form decides, with its method; raises Impossible for none."""
        target = self.target
        if target.requirements is not None:
            proved = self._contradictory(rules)
            left = "" if proved else "only cells proved concave were tried"
            excluded = self._excluded_requirements(rules) if proved else None
            raise self._impossible(placed, left, excluded, proved=proved)
        if self.holes is None:
            proved = target.orders.never or (not target.orders.stepwise and self._all_proved(rules))
            report = f"{placed.others} random choices in the target orders were simulated"
            report *= placed.others > 0
            excluded = self._excluded_states(rules) if proved else None
            raise self._impossible(placed, report, excluded, proved=proved)
        if target.orders.never or (not target.orders.orders and target.states is None):
            excluded = self._excluded_states(rules) if target.orders.never else None
            raise self._impossible(placed, "", excluded, proved=target.orders.never)
        decided = placed.complete and target.states is None
        chains, whole, report = self._simulated_choices(rules, self.holes, decided=decided)
        if not chains:
            excluded = self._excluded_holes(rules, self.holes) if whole else None
            raise self._impossible(placed, report, excluded, proved=whole)
        counted = None if tolerances.most.friction else target.states

        def fraction(chain: Chain) -> float:
            return yields(
                chain, tolerances, samples=_SAMPLES, seed=self.seed, target=counted
            ).fraction

        return max(chains[:_COMPARED], key=fraction), (
            f"searched: no choice among the {placed.candidates} holes where the closed form holds "
            f"reaches the target; {report}, and {len(chains)} of them reach it; best yield of "
            f"{min(len(chains), _COMPARED)} of these, {_SAMPLES} samples each"
        )

    def _contradictory(self, rules: list[Rule]) -> bool:
        """Whether no allowed chain meets the requirements, by their orders alone.

        Requirements on states, and on cells half way, follow from orders only for concave cells of
        one full travel.
        """
        assert self.target.requirements is not None
        conflict = self.target.requirements.conflict
        if not any(one.needs_concave for one in conflict):
            return bool(conflict)
        one_lever = all(len({kind.lever for kind in rule.kinds}) == 1 for rule in rules)
        return one_lever and self._all_proved(rules)

    def _all_proved(self, rules: list[Rule]) -> bool:
        return all(all_proved(rule, region) for rule in rules for region in set(self.regions))

    def _excluded_states(self, rules: list[Rule]) -> StateEvidence | None:
        states, never = self.target.orders.states, self.target.orders.never
        if states is None:
            return None
        return StateEvidence(states, () if never else rectangles(rules, self.regions))

    def _excluded_requirements(self, rules: list[Rule]) -> RequirementEvidence:
        assert self.target.requirements is not None
        conflict, number = self.target.requirements.conflict, self.target.requirements.cells
        concave = any(one.needs_concave for one in conflict)
        return RequirementEvidence(
            conflict, number, rectangles(rules, self.regions) if concave else ()
        )

    def _excluded_holes(self, rules: list[Rule], holes: HoleGrid) -> HoleEvidence | None:
        if rules[0].limited:
            return None  # its tables have no packs
        tables: list[tuple[tuple[Cell, ...], ...]] = []
        for rule in rules:
            sites = rule.sites(self.regions)
            ways = {site: _buildable(rule, site, holes) for site in dict.fromkeys(sites)}
            tables.append(tuple(tuple(way.cell for way in ways[one]) for one in sites))
        orders = tuple(one.rising for one in self.target.orders.orders)
        states = None if self.target.states is None else frozenset(self.target.states)
        whole = self.target.orders.complete
        return HoleEvidence(orders, tuple(tables), whole, self.actuator_stiffness, states)

    def _impossible(
        self, placed: Placed, rest: str, evidence: Evidence | None = None, *, proved: bool
    ) -> Impossible:
        allowed = allowed_text(self.regions, self.holes, self.free)
        allowed += " and taut bands" * (self.holes is not None) + packs_text(self.bands)
        attempts, mismatch = placed.attempts, placed.mismatch
        allowed += _without_packs(attempts)
        return explained(
            self.target,
            attempts,
            (mismatch, rest, allowed),
            self._regions_of,
            evidence,
            proved=proved,
        )

    def _regions_of(self, lever: float) -> tuple[Region, ...]:
        """The regions with that lever [m]: a usual region is scaled with it."""
        if not self.usual:
            return self.regions
        return (usual_box(lever, self.free),) * len(self.regions)
