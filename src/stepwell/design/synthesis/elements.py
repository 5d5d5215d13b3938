"""Inverse design with elements: their kinds, scales and order along the chain."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product

import numpy as np

from stepwell.base import Floats, InputError, Ints, Progress, bisected, display_unit, tracked
from stepwell.design.orders import checked_cycle, of_states, order_of, orders_of, short
from stepwell.design.switches import Switches, is_relay, switching_forces
from stepwell.design.synthesis.designed import Impossible
from stepwell.design.synthesis.evidence import ScaleEvidence, StateEvidence
from stepwell.design.targets import reachable_states, state_differences
from stepwell.design.tolerances.draws import Tolerances
from stepwell.design.tolerances.yields import yields
from stepwell.mechanism import Chain, Element
from stepwell.sequences import cycle
from stepwell.statics import StaticsError

Range = tuple[float, float]

LEAST = 1e-6  # of the largest force: smallest gap that a linear program resolves
_HALVINGS = 30


@dataclass(frozen=True, eq=False)
class Scales:
    """Linear inequalities in the scales c (N,): gaps @ c + rub > share * sizes @ c.

    All forces are in units of the largest possible force.
    """

    gaps: Floats  # (m, N) between neighbours of different cells in both orders
    sizes: Floats  # (m, N)
    offset: Floats  # (m,) contribution of friction
    bounds: Floats  # (N, 2) of the scales

    @classmethod
    def of(
        cls, elements: Sequence[Element], orders: Ints, scale: Range, most_force: float
    ) -> "Scales | None":
        """None if no scales are possible: phases in another order, or too strong at any scale."""
        chain = Chain([one.renamed("") for one in elements])
        cell = Switches.of(chain.last_state).cell
        friction = np.array([one.friction for one in elements])
        own = switching_forces(chain) - friction[cell, None] * [1.0, -1.0]
        strongest = np.array([np.max(np.abs(own[cell == k])) for k in range(len(elements))])
        bounds = np.tile(np.array(scale, float), (len(elements), 1))
        bounds[:, 1] = np.minimum(bounds[:, 1], most_force / np.maximum(strongest, 1e-300))
        if np.any(bounds[:, 1] < bounds[:, 0]):
            return None
        rising = own.T * [[1.0], [-1.0]]
        before, after = orders[:, :-1], orders[:, 1:]
        low, high = (np.take_along_axis(rising, these, 1) for these in (before, after))
        apart = cell[before] != cell[after]
        if not np.all(apart | (high > low)):
            return None
        first, second, unit = cell[before[apart]], cell[after[apart]], np.eye(len(elements))
        less, more = low[apart, None] * unit[first], high[apart, None] * unit[second]
        table = more - less, np.abs(more) + np.abs(less), friction[second] - friction[first]
        gaps, sizes, offset = (part / np.max(strongest * bounds[:, 1]) for part in table)
        return cls(gaps, sizes, offset, bounds)

    @property
    def largest_gap(self) -> float:
        """Largest possible smallest gap over the largest force; 0 or less if there is none."""
        return self._best(0.0)[1]

    def most_robust(self, least: float) -> tuple[tuple[float, ...] | None, float]:
        """Scales with the largest deviation of all forces, if above `least`, and that deviation."""
        if not self._best(least)[1] > 0.0:
            return None, least
        share, _ = bisected(lambda at: self._best(at)[1] >= 0.0, least, 1.0, _HALVINGS)
        scales, _ = self._best(share)
        return None if scales is None else tuple(scales.tolist()), share

    def _best(self, share: float) -> tuple[Floats | None, float]:
        """Scales with the largest smallest gap beyond a share of the forces, and that gap."""
        if not len(self.gaps):
            return self.bounds.mean(axis=1), math.inf
        from scipy.optimize import linprog  # pyright: ignore[reportMissingTypeStubs]

        # Maximise t with gaps c - share sizes c + rub >= t.
        table = np.column_stack([share * self.sizes - self.gaps, np.ones(len(self.gaps))])
        cost = np.zeros(table.shape[1])
        cost[-1] = -1.0
        solution = linprog(cost, table, self.offset, bounds=[*self.bounds.tolist(), (None, None)])
        if solution.x is None:
            return None, -math.inf
        return np.asarray(solution.x[:-1]), float(solution.x[-1])


_MOST_CHOICES = 2000  # of shapes for all cells: some seconds
# Number of choices simulated, the best by switching forces, and number of cells at random.
_SIMULATED, _RANDOM_CELLS = 24, 2400
_COMPARED, _SAMPLES = 4, 40

_RELAYS = (
    "under a prescribed force elements are independent, and the order of their switching forces "
    "decides the sequence, confirmed by simulation of the nominal design"
)
_FOLLOWS = "elements interact under this drive; the nominal design was simulated"


@dataclass(frozen=True)
class ElementTarget:
    """The target of a chain of elements."""

    text: str
    last: str  # state with every cell in its last phase
    orders: tuple[Ints, ...]  # (2, T) each, of its switches, that give it under a prescribed force
    complete: bool  # whether there are no others
    cycle: str  # the target cycle; "" for states
    states: frozenset[str] | None  # the target states and no others; None for a cycle
    why: str = ""  # reason if there are no orders
    never: bool = False  # whether the reason holds for every chain

    @classmethod
    def of(
        cls, sequence: str | None, states: Iterable[str] | str | None, cells: int | None
    ) -> "ElementTarget":
        """A cycle, or a set of states of cells of two phases; ValueError for any other text."""
        if sequence is not None:
            given = str(sequence).replace(" ", "").split(">")
            last = "".join(max(digits) for digits in zip(*given, strict=False))
            last = "1" * len(order_of(given[0].partition("/")[0])) or last
            text = checked_cycle(str(sequence), last, "sequence")
            orders = orders_of(text)
            if orders is None:
                raise InputError(
                    f"sequence = {short(text)!r}: one cell at a time must go to its next phase "
                    f"until all are in the last one, and back, as in 00>10>11>01>00."
                )
            return cls(text, last, (orders,), True, text, None)
        target = states if isinstance(states, str) else tuple(states or ())
        wanted = of_states(target, cells, True)
        listed = wanted.states or frozenset(wanted.orders[0].states)
        text = f"states {' '.join(target)}" if target != "all" else f"all states of {cells} cells"
        last = "1" * wanted.cells
        orders = tuple(np.array([one.loading, one.unloading]) for one in wanted.orders)
        return cls(text, last, orders, wanted.complete, "", listed, wanted.why, wanted.never)

    def is_met_by(self, chain: Chain) -> bool:
        """Whether a simulated chain reaches the target."""
        try:
            if self.states is not None:
                states, ties = reachable_states(chain)
                return not ties and not state_differences(states, self.states)
            result = cycle(chain)
        except (StaticsError, ValueError):
            return False
        return not result.degenerate and str(result.sequence) == self.cycle


# A chain that reaches the target, the number of choices of shapes, whether none is better (proved),
# the method, and what is known of its motion.
Scaled = tuple[Chain, int, bool, str, str]
Sets = list[list[int]]  # for every cell the elements that it can be


@dataclass(frozen=True, eq=False)
class Allowed:
    """Available elements and ranges of their scales."""

    elements: Sequence[Element]  # each as often as needed
    force_scale: Range  # least and largest, times the element's own
    travel_scale: Range
    most_force: float  # no switching force is larger [N]
    tolerances: Tolerances

    def __post_init__(self):
        for i, one in enumerate(self.elements):
            if not isinstance(one, Element):
                raise InputError(f"elements[{i}] = {one!r}: must be an Element.")
        Chain(self.elements)  # of one measure
        for name in ("force_scale", "travel_scale"):
            between: Range = getattr(self, name)
            low, high = between
            if not 0 < low <= high < math.inf:
                raise InputError(
                    f"{name} = {between!r}: must be (least, largest), both > 0 and finite, such as "
                    f"(0.5, 2.0), or (1.0, 1.0) for no scaling."
                )
        if not isinstance(self.tolerances, Tolerances):
            raise InputError(
                f"tolerances = {self.tolerances!r}: must be Tolerances(stiffness=0.05, ...)."
            )
        if not self.most_force > 0:
            raise InputError(f"most_force = {self.most_force}: must be > 0.")

    def scales(self, shapes: Sequence[int], orders: Ints) -> Scales | None:
        """The scales with which the switching forces of these elements are in these orders."""
        made = [self.elements[k] for k in shapes]
        return Scales.of(made, orders, self.force_scale, self.most_force)


def _without_order(goal: ElementTarget, relays: bool) -> Impossible:
    states = StateEvidence(goal.states or frozenset(), ()) if goal.never else None
    return Impossible(goal.text, goal.why, proved=goal.never or relays, evidence=states)


def scaled(
    goal: ElementTarget, allowed: Allowed, actuator_stiffness: float, seed: int, progress: Progress
) -> Scaled:
    """Elements, their order along the chain and their scales that reach the target.

    Raises Impossible, with a proof or because none was found.
    """
    sets = _fitting(goal, allowed.elements)
    relays = actuator_stiffness == 0 and all(map(is_relay, allowed.elements))
    if not goal.orders:
        raise _without_order(goal, relays)
    rng = np.random.default_rng(seed)
    whole = math.prod(map(len, sets)) <= _MOST_CHOICES
    choices = list(product(*sets)) if whole else _random_choices(sets, rng)
    candidates, closest = _scalable(goal, allowed, choices, progress, best_only=relays)
    complete = relays and whole and goal.complete
    for share, these in candidates[: 1 if relays else _SIMULATED]:
        chain = _named_chain(goal, these, actuator_stiffness)
        if goal.is_met_by(chain):
            return (
                chain,
                len(choices),
                complete,
                f"searched: the best of {len(choices)} {'random ' * (not whole)}choices of "
                f"elements, scales by linear programming; objective: largest deviation of all "
                f"forces at once that keeps the order of the switching forces, {share * 100:.4g} %",
                _RELAYS if relays else _FOLLOWS,
            )
    other = None if relays else _at_random(goal, allowed, sets, actuator_stiffness, rng)
    if other is None:
        proved = complete and not candidates
        raise _refusal(goal, allowed, sets, closest, proved, choices)
    return other


def _scalable(
    goal: ElementTarget,
    allowed: Allowed,
    choices: Sequence[tuple[int, ...]],
    progress: Progress,
    *,
    best_only: bool,
) -> tuple[list[tuple[float, list[Element]]], float]:
    """Choices with scales by linear programming, the best first, and the largest smallest gap.

    Each with the relative deviation that all its forces may have at once. With `best_only`, choices
    worse than an earlier one may be left out.
    """
    candidates: list[tuple[float, list[Element]]] = []
    closest = -math.inf
    for orders, shapes in tracked([*product(goal.orders, choices)], progress):
        program = allowed.scales(shapes, orders)
        gap = -math.inf if program is None else program.largest_gap
        closest = max(closest, gap)
        if program is None or not gap > LEAST:
            continue
        scales, share = program.most_robust(candidates[0][0] if candidates and best_only else 0.0)
        if scales is not None:
            elements = [allowed.elements[k] for k in shapes]
            pairs = zip(elements, scales, strict=True)
            made = [replace(one, force_scale=one.force_scale * c) for one, c in pairs]
            candidates.append((share, made))
            candidates.sort(key=lambda one: -one[0])
    return candidates, closest


def _random_choices(sets: Sets, rng: np.random.Generator) -> list[tuple[int, ...]]:
    return [tuple(int(rng.choice(one)) for one in sets) for _ in range(_MOST_CHOICES)]


def _fitting(goal: ElementTarget, elements: Sequence[Element]) -> list[list[int]]:
    phases = [len(one.phases) for one in elements]
    sets = [[k for k, n in enumerate(phases) if n == int(digit) + 1] for digit in goal.last]
    for cell, fitting in enumerate(sets):
        if not fitting:
            has = ", ".join(map(str, phases))
            raise InputError(
                f"{short(goal.text)}: cell {cell + 1} has {int(goal.last[cell]) + 1} phases there, "
                f"but the elements have {has}: add an element with as many phases."
            )
    return sets


def _named_chain(goal: ElementTarget, cells: Sequence[Element], stiffness: float) -> Chain:
    names = [cell.name for cell in cells]
    named = [
        cell.renamed(f"{name} {i + 1}" if name and names.count(name) > 1 else name)
        for i, (cell, name) in enumerate(zip(cells, names, strict=True))
    ]
    return Chain(named, stiffness, f"Designed for {short(goal.text)}")


def _at_random(
    goal: ElementTarget, allowed: Allowed, sets: Sets, stiffness: float, rng: np.random.Generator
) -> Scaled | None:
    matches: list[Chain] = []
    looked_at = 0
    while looked_at < _RANDOM_CELLS // len(sets) and len(matches) < _COMPARED:
        looked_at += 1
        cells: list[Element] = []
        for fitting in sets:
            one = allowed.elements[int(rng.choice(fitting))]
            force, travel = (
                float(np.exp(rng.uniform(*np.log(between))))
                for between in (allowed.force_scale, allowed.travel_scale)
            )
            cells.append(
                replace(
                    one, force_scale=one.force_scale * force, travel_scale=one.travel_scale * travel
                )
            )
        chain = _named_chain(goal, cells, stiffness)
        if goal.is_met_by(chain):
            matches.append(chain)
    if not matches:
        return None
    counted = {"samples": _SAMPLES, "target": goal.cycle or sorted(goal.states or ())}
    return (
        max(matches, key=lambda chain: yields(chain, allowed.tolerances, **counted).fraction),
        looked_at,
        False,
        f"searched: {looked_at} random choices of elements and scales simulated; best yield of "
        f"{len(matches)} that reach the target, {_SAMPLES} samples each",
        _FOLLOWS,
    )


def _refusal(
    goal: ElementTarget,
    allowed: Allowed,
    sets: Sets,
    closest: float,
    proved: bool,
    choices: Sequence[tuple[int, ...]],
) -> Impossible:
    elements, scale = allowed.elements, allowed.force_scale
    pair, scales = _clash(goal, allowed, sets), f"scales from {scale[0]:g} to {scale[1]:g}"
    if pair is not None:
        why = (
            f"no two of these elements, at any {scales}, have their switching forces in the "
            f"target orders of cells {pair[0] + 1} and {pair[1] + 1}: all forces of an element "
            f"scale together, so the stronger of two of one shape goes up later; it comes down "
            f"later if its force falls below zero, and earlier if not"
        )
    else:
        why = (
            f"for none of {len(choices)} choices of elements do {scales} bring the switching "
            f"forces into the target orders (linear programming)"
        )
    if not proved:
        why += "; random choices of elements and scales were simulated: none reaches the target"
    measure = elements[0].measure
    unit, factor = display_unit(measure.force_unit)
    largest = max(one.largest_force for one in elements) * scale[1]
    needed, gap = LEAST * largest, math.nan
    if math.isfinite(closest):
        gap = closest * largest + 0.0  # no -0
        why += (
            f" (the smallest gap is at most {gap * factor:.3g} {unit}, and {needed * factor:.2g} "
            f"{unit} is needed)"
        )
    return Impossible(
        goal.text,
        f"{why}: add elements of other shapes, or widen force_scale",
        proved=proved,
        largest_gap=gap,
        gap_needed=needed,
        measure=measure,
        evidence=_excluded(goal, allowed, choices) if proved else None,
    )


def _excluded(
    goal: ElementTarget, allowed: Allowed, choices: Sequence[tuple[int, ...]]
) -> ScaleEvidence:
    pairs = product(goal.orders, choices)
    programs = ((tuple(allowed.elements[k] for k in shapes), orders) for orders, shapes in pairs)
    return ScaleEvidence(tuple(programs), allowed.force_scale, allowed.most_force)


def _clash(goal: ElementTarget, allowed: Allowed, sets: Sets) -> tuple[int, int] | None:
    """Two cells whose orders exclude each other, for any other cells; None if there are none."""
    if len(goal.orders) != 1:
        return None
    cell = Switches.of(goal.last).cell
    for a, b in combinations(range(len(sets)), 2):
        # The switches of these two alone, numbered from 0.
        kept = np.isin(cell, (a, b))
        target = goal.orders[0]
        orders = (np.cumsum(kept) - 1)[target[kept[target]].reshape(2, -1)]
        programs = (allowed.scales(pair, orders) for pair in product(sets[a], sets[b]))
        if not any(one is not None and one.largest_gap > LEAST for one in programs):
            return a, b
    return None
