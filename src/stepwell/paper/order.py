"""Claims about the order of motion, of two cells and of more."""

from collections.abc import Callable, Iterable, Iterator
from functools import cache

import numpy as np

from stepwell.base import to_unit
from stepwell.design import Design, Tolerances, design
from stepwell.mechanism import Band, Cell, Chain
from stepwell.paper.cells import falls
from stepwell.paper.claims import Finding, claim, finding_of
from stepwell.sequences import Cycle, Sequence
from stepwell.statics import Event

_COUNT = 200
_SEED = 2024
_TOUCH = 1e-9  # of the full travel
_SAME = 1e-9  # of the peak force


@claim("Fig. 2C (rule: our reading)", "always", f"{_COUNT} random pairs, seed {_SEED}")
def order_two_cells() -> Finding:
    """Two cells load by rising F0 and unload by falling F1, so four forces give the pathway."""
    cycles = random_pairs()
    right = sum(map(_sorted, cycles))
    snapping = sum(bool(cycle.snaps) == _is_directed(cycle) for cycle in cycles)
    return finding_of(
        right == snapping == len(cycles),
        f"{right} of {len(cycles)} pairs",
        note="Random pairs of concave cells, followed by the general engine, which knows nothing "
        "of the rule. Exactly the directed ones snap.",
        otherwise=f"{len(cycles) - right} pairs break the rule, {len(cycles) - snapping} snap or "
        f"not against it.",
    )


@claim(
    "said of two cells (more: our reading)",
    "silent on snaps",
    f"{_COUNT} random chains, seed {_SEED + 1}",
)
def order_many_cells() -> Finding:
    """More than two cells follow the same rule."""
    cycles = random_chains()
    right = sum(map(_sorted, cycles))
    snaps = [(cycle, snap) for cycle in cycles for snap in cycle.snaps]
    released = [(cycle, snap, _weakest_held(snap, cycle)) for cycle, snap in snaps]
    at_its_force = sum(_is_released(snap, cycle, cell) for cycle, snap, cell in released)
    others = sum(_cell_between(snap, cycle) not in (cell, None) for cycle, snap, cell in released)
    return finding_of(
        right == len(cycles) and at_its_force == len(snaps),
        f"{right} of {len(cycles)} chains of 3 to 8",
        note=f"The paper is silent on which cell a snap leaves between its stops. Each of "
        f"{len(snaps)} snaps happens where the actuator force meets the largest F1 of the cells "
        f"that have moved (unloading: the smallest F0), so that this cell lets go; but in {others} "
        f"the flow hands its motion on and another cell is left there. The order of states stays "
        f"the sorted one.",
        otherwise=f"{len(cycles) - right} chains run in another order; in "
        f"{len(snaps) - at_its_force} snaps another cell lets go.",
    )


def random_pairs() -> list[Cycle]:
    """Cycles of random pairs of concave cells."""
    return [chain.cycle() for chain in _chains(_COUNT, 2, 2, _SEED)]


def random_chains() -> list[Cycle]:
    """Cycles of random chains of 3 to 8 concave cells."""
    return [chain.cycle() for chain in _chains(_COUNT, 3, 8, _SEED + 1)]


def _chains(count: int, shortest: int, longest: int, seed: int) -> tuple[Chain, ...]:
    """Chains of concave cells, anchors anywhere on the paper's map and 15 to 60 N/m."""
    rng = np.random.default_rng(seed)
    lengths = rng.integers(shortest, longest + 1, count)
    return tuple(Chain(tuple(_cell(rng) for _ in range(length))) for length in lengths)


def _cell(rng: np.random.Generator) -> Cell:
    while True:
        q = (rng.uniform(0.0, 0.020), rng.uniform(-0.015, 0.015))
        cell = Cell(Band((-0.010, 0.0), q, stiffness=rng.uniform(15.0, 60.0)))
        if falls(cell):
            return cell


def _sorted(cycle: Cycle) -> bool:
    """Whether the cells load by rising F0, unload by falling F1, and no state comes between."""
    cells = cycle.chain.levers
    by_0 = sorted(range(len(cells)), key=lambda i: cells[i].force_0)
    by_1 = sorted(range(len(cells)), key=lambda i: -cells[i].force_1)
    return cycle.sequence.flips == tuple((i,) for i in (*by_0, *by_1))


def _is_directed(cycle: Cycle) -> bool:
    inner, outer = cycle.chain.levers
    return (inner.force_0 < outer.force_0) == (inner.force_1 > outer.force_1)


def _cell_between(snap: Event, cycle: Cycle) -> int | None:
    """The cell between its stops after a snap; None without one."""
    return next(_between(snap, cycle, snap.after), None)


def _between(snap: Event, cycle: Cycle, travels: Iterable[float]) -> Iterator[int]:
    """The cells of a snap that are between their stops at these travels [m]."""
    for cell, travel in zip(snap.cells, travels, strict=True):
        full = cycle.chain.cells[cell].full_travel
        if _TOUCH * full < travel < (1 - _TOUCH) * full:
            yield cell


def _weakest_held(snap: Event, cycle: Cycle) -> int:
    """The cell that has moved already with the weakest force at its stop."""
    cells = cycle.chain.levers
    order = cycle.loading_order if snap.direction > 0 else cycle.unloading_order
    mover = next(_between(snap, cycle, snap.before), snap.cells[0])
    moved = order[: order.index(mover)]
    if snap.direction > 0:
        return max(moved, key=lambda cell: cells[cell].force_1)
    return min(moved, key=lambda cell: cells[cell].force_0)


def _is_released(snap: Event, cycle: Cycle, cell: int) -> bool:
    """Whether the snap happens exactly at the critical force of this cell at its stop."""
    held = cycle.chain.levers[cell]
    limit = held.force_1 if snap.direction > 0 else held.force_0
    return abs(snap.force_before - limit) <= _SAME * abs(cycle.peak_force)


ORDER_CLAIMS = (order_two_cells, order_many_cells)


ANCHORS = (0.0001, 0.0003, 0.001)  # tolerances [m]
SPREAD = 0.05  # of the bands' stiffness
WANTED = 0.99
# Number of cells that the paper built.
BUILT = 2
_MOST = 32
_TRIED, _MADE = 20_000, 1_000_000


def sequenced(cells: int, tolerances: Tolerances, n: int) -> Design:
    """Design for the cycle with reversed unloading order: last in, first out."""
    cycle = Sequence.full_cycle(range(cells), reversed(range(cells)))
    return design(str(cycle), tolerances=tolerances, samples=n)


def programmable(cells: int, tolerances: Tolerances, n: int) -> Design:
    """Design of a chain in which stroke programs reach every state.

    Proved if of every two cells the one that loads first unloads first, as in this cycle (theory
    page, "Stroke programs").
    """
    cycle = Sequence.full_cycle(range(cells), range(cells))
    return design(str(cycle), tolerances=tolerances, samples=n)


@cache
def most_cells(make: Callable[[int, Tolerances, int], Design], anchor: float) -> Design:
    """The longest chain with a yield of 99 %, as the lower end of the 95 % interval.

    Longer chains have smaller gaps, so the length is bracketed by doubling and bisection.
    """
    tolerances = Tolerances(anchor=anchor, stiffness=SPREAD)

    def works(cells: int) -> Design | None:
        # First with few samples; a million only if the yield is near the limit.
        trial = make(cells, tolerances, _TRIED)
        if abs(trial.yield_.fraction - WANTED) < 0.005:
            trial = make(cells, tolerances, _MADE)
        return trial if trial.yield_.interval[0] >= WANTED else None

    best, low, high = works(BUILT), BUILT, 2 * BUILT
    assert best is not None
    while high <= _MOST and (longer := works(high)) is not None:
        low, high, best = high, 2 * high, longer
    while high - low > 1:
        middle = (low + high) // 2
        if (candidate := works(middle)) is None:
            high = middle
        else:
            low, best = middle, candidate
    return best


def _extends(make: Callable[[int, Tolerances, int], Design]) -> Finding:
    designs = [most_cells(make, anchor) for anchor in ANCHORS]
    counts = [len(one.chain) for one in designs]
    each = ", ".join(
        f"{count} cells (anchors ±{to_unit(anchor, 'mm'):g} mm, {100 * one.yield_.fraction:.2f} %)"
        for count, anchor, one in zip(counts, ANCHORS, designs, strict=True)
    )
    return finding_of(
        min(counts) > BUILT,
        each,
        note=f"The paper's cell and band, q in the paper's box, band stiffness spread "
        f"{100 * SPREAD:g} %; the longest chain that `design` found of which {100 * WANTED:g} % "
        f"work. A better design may exist, so these are floors; the yield of other cycles is in "
        f"`docs/any-cycle.md`.",
        otherwise="No longer chain than the paper's was found.",
    )


@claim("Conclusion", "more than two, no number", "more than two")
def more_cells_sequenced() -> Finding:
    """The approach extends to more cells: as many can be sequenced, in one order and back."""
    return _extends(sequenced)


@claim("Conclusion", "more than two, no number", "more than two")
def more_cells_programmable() -> Finding:
    """The approach extends to more cells: as many can be brought to every state."""
    return _extends(programmable)


MORE_CELLS_CLAIMS = (more_cells_sequenced, more_cells_programmable)
