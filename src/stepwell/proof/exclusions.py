"""Proving that no allowed design reaches a target: every choice is excluded by enclosures."""

import math
import re
from collections.abc import Iterator, Sequence
from itertools import pairwise, permutations, product
from typing import Any, NamedTuple

import numpy as np

from stepwell.base import Bools, Floats, Progress, counted, notify, tracked
from stepwell.concave import TIED
from stepwell.design import (
    HoleEvidence,
    Impossible,
    Requirement,
    RequirementEvidence,
    ScaleEvidence,
    StateEvidence,
)
from stepwell.mechanism import Cell, Chain, Element
from stepwell.proof.balls import UndecidedError, ball, high, low
from stepwell.proof.box_proofs import BoxOutcome, ProvedImpossible
from stepwell.proof.cell_boxes import ALL, CellBox, CellPart, CriticalForce, element_forces
from stepwell.sequences import cycle
from stepwell.statics import StaticsError

Evidence = StateEvidence | HoleEvidence | ScaleEvidence | RequirementEvidence
# Largest number of partial choices of holes, and longest chain whose pairs of orders are all tried.
_MOST_NODES, _MOST_CELLS = 200_000, 5
# Largest number of other choices whose cycles are proved, at some 10 ms each.
_MOST_FOLLOWED = 2000
# Smallest gap of switching forces that counts, as a fraction of the largest: that of the search.
_LEAST_GAP = 1e-6


def prove_impossible(why: Impossible, progress: Progress = None) -> ProvedImpossible:
    """Prove with enclosures that no allowed design reaches a target.

    Args:
        why: the refusal.
        progress: called with (done, total) choices.

    Source: ours (theory page, "Proofs within tolerances").
    """
    try:
        covers, theorem = _excluded(why.evidence, progress)
    except UndecidedError as cause:
        return ProvedImpossible(why, BoxOutcome.UNDECIDED, "", "", cause.cause)
    return ProvedImpossible(why, BoxOutcome.PROVED, covers, theorem, "")


def _excluded(evidence: Evidence | None, progress: Progress) -> tuple[str, str]:
    """What is excluded, and by which theorem."""
    match evidence:
        case StateEvidence():
            return _states_excluded(evidence, progress)
        case HoleEvidence():
            return _holes_excluded(evidence, progress)
        case ScaleEvidence():
            return _scales_excluded(evidence, progress)
        case RequirementEvidence():
            return _requirements_excluded(evidence, progress)
        case None:
            raise UndecidedError("the search was no proof, or excluded no choices as a whole")


# States: no pair of orders makes exactly these reachable.


def _states_excluded(evidence: StateEvidence, progress: Progress) -> tuple[str, str]:
    states = evidence.states
    cells = len(next(iter(states), ""))
    missing = [name for name in "01" if name * cells not in states]
    if missing:
        return (
            "every chain of any cells",
            f"all cells are at {missing[0]} once in every full cycle, and this state is missing",
        )
    if any(_may_reach(states, *orders) for orders in _order_pairs(cells)):
        raise UndecidedError("two orders reach these states, or a part of them")
    _prove_concave(evidence.cells, progress)
    pairs = counted(math.factorial(cells) ** 2, "pair")
    return (
        f"{counted(len(evidence.cells), 'kind')} of cell with q - p anywhere in the region",
        f"each has a falling force, so its ideals are reached; those of {pairs} of orders have a "
        f"state that is not among the target ones",
    )


Orders = tuple[tuple[int, ...], tuple[int, ...]]


def _order_pairs(cells: int) -> Iterator[Orders]:
    """All orders of loading and unloading; UndecidedError for too many."""
    if cells > _MOST_CELLS:
        raise UndecidedError(f"the pairs of orders of {cells} cells are too many to try")
    every = [*permutations(range(cells))]
    yield from product(every, every)


def _may_reach(
    states: frozenset[str], loading: tuple[int, ...], unloading: tuple[int, ...]
) -> bool:
    """Whether concave cells of two orders may reach exactly some states.

    They reach the ideals; of three cells or more a stroke may reach further states.
    """
    ideals = _ideals(loading, unloading)
    return ideals == states if len(loading) <= 2 else ideals <= states


def _prove_concave(cells: tuple[tuple[Cell, Any], ...], progress: Progress) -> None:
    """Prove that cells anywhere in rectangles have falling forces, and one full travel."""
    if len({cell.full_travel for cell, _ in cells}) > 1:
        raise UndecidedError("cells of several full travels")
    for cell, box in tracked(cells, progress):
        if not _rectangle(cell, box).falls():
            raise UndecidedError("a cell of the region is not proved to have a falling force")


def _ideals(loading: Sequence[int], unloading: Sequence[int]) -> frozenset[str]:
    """States in which every cell at 1 has all cells at 1 that load before and unload after it."""
    cells = range(len(loading))
    up, down = ([order.index(i) for i in cells] for order in (loading, unloading))
    needs = [[i for i in cells if up[i] < up[j] and down[i] > down[j]] for j in cells]
    return frozenset(
        "".join(map(str, state))
        for state in product((0, 1), repeat=len(loading))
        if all(state[i] for j in cells if state[j] for i in needs[j])
    )


def _rectangle(cell: Cell, box: Any) -> CellBox:
    x, y = cell.bands[0].d
    parts = (
        CellPart("x", ALL, box.left - x, box.right - x),
        CellPart("y", ALL, box.bottom - y, box.top - y),
    )
    return CellBox(cell, parts)


# Requirements: no pair of orders meets the smallest contradictory part.


def _requirements_excluded(evidence: RequirementEvidence, progress: Progress) -> tuple[str, str]:
    conflict, cells = evidence.conflict, evidence.number
    if cells > 2 and any(one.kind in ("state", "step", "after") for one in conflict):
        raise UndecidedError("a stroke may reach more states than those that two orders give")
    missed = [
        frozenset(k for k, one in enumerate(conflict) if not _meets(one, *orders))
        for orders in _order_pairs(cells)
    ]
    if not all(missed):
        raise UndecidedError("two orders meet the requirements")
    _prove_concave(evidence.cells, progress)
    part = "; ".join(f"'{one}'" for one in conflict)
    # Each of them is the only one that some pair misses.
    least = all(frozenset({k}) in missed for k in range(len(conflict)))
    spare = "and none of them can be left out" if least else "of which some can be left out"
    covered = f"every chain of {cells} cells, of any kind"
    if evidence.cells:
        kinds = counted(len(evidence.cells), "kind")
        covered = f"{kinds} of cell with q - p anywhere in the region"
    return (covered, f"none of {counted(len(missed), 'pair')} of orders meets {part}, {spare}")


def _meets(one: Requirement, loading: tuple[int, ...], unloading: tuple[int, ...]) -> bool:
    """Whether two orders meet a requirement, by the states that they reach."""
    order = unloading if one.way else loading
    match one.kind:
        case "before" | "order":
            return [cell for cell in order if cell in one.cells] == [*one.cells]
        case "place":
            return order[0 if one.state == "first" else -1] == one.cells[0]
        case "apart":
            return unloading == loading[::-1]
        case "cells":
            return True
    reached = _ideals(loading, unloading)
    if one.kind == "never":
        pattern = one.state.ljust(len(loading), "*").replace("*", ".")
        return not any(re.fullmatch(pattern, state) for state in reached)
    if one.kind == "step":
        still = [cell for cell in order if one.state[cell] == "01"[one.way]]
        return one.state in reached and still[0] == one.cells[0]
    return one.state in reached


# Holes: no choice of enclosed critical forces has the target orders.


class _Ends(NamedTuple):
    """Enclosed critical forces of the cells that one cell of a chain can be, as doubles."""

    low: Floats  # (m, 2) F0 and F1
    high: Floats


def _holes_excluded(evidence: HoleEvidence, progress: Progress) -> tuple[str, str]:
    targets = evidence.orders
    if evidence.states is not None:
        targets = _orders_within(evidence.states, evidence.tables)
    elif not evidence.whole:
        raise UndecidedError("there are too many orders that give the target")
    known: dict[Cell, _Ends | None] = {}
    nodes, followed = 0, 0
    for tables in evidence.tables:
        for cell in dict.fromkeys(cell for table in tables for cell in table):
            if cell not in known:
                known[cell] = _enclosed_ends(cell)
        others = list(_not_concave(tables, known))
        if others and evidence.states is not None:
            raise UndecidedError("the states of a choice of cells that are not concave")
        for cells in tracked(others, progress):
            _prove_other(Chain(cells, evidence.actuator_stiffness), targets)
        followed += len(others)
        nodes = _search_choices(tables, known, targets, nodes)
    total = sum(math.prod(map(len, tables)) for tables in evidence.tables)
    theorem = "of cells with falling forces, none has its enclosed F0 and F1 in the target orders"
    if followed:
        theorem += f"; the cycles of {counted(followed, 'other choice')} are proved to be others"
    return f"all {counted(total, 'choice')} of holes and bands, with nominal numbers", theorem


def _orders_within(states: frozenset[str], tables: Any) -> tuple[Orders, ...]:
    """Rising orders of which all ideals are among some states.

    A chain of other orders reaches a state that is not among them.
    """
    cells = len(tables[0]) if tables else 0
    return tuple(
        (loading, unloading[::-1])
        for loading, unloading in _order_pairs(cells)
        if _may_reach(states, loading, unloading)
    )


def _search_choices(tables: Any, known: dict[Cell, _Ends | None], targets: Any, nodes: int) -> int:
    """Prove that no choice of cells with falling forces has target orders; the partial choices."""
    ends = [_joined([one for cell in table if (one := known[cell])]) for table in tables]
    if not all(len(one.low) for one in ends):
        return nodes
    largest = max(float(np.max(np.abs(one.high))) for one in ends)
    for orders in targets:
        found, nodes = _choice(ends, orders, TIED * largest, nodes)
        if found:
            raise UndecidedError("a choice may have the target orders")
    return nodes


def _not_concave(tables: Any, known: dict[Cell, _Ends | None]) -> Iterator[tuple[Cell, ...]]:
    """Choices that the theorem does not cover; UndecidedError for too many."""
    travels = {cell.full_travel for table in tables for cell in table}
    if len(travels) == 1 and all(known[cell] for table in tables for cell in table):
        return
    if math.prod(map(len, tables)) > _MOST_NODES:
        raise UndecidedError("there are too many choices of cells that are not concave")
    number = 0
    for cells in product(*tables):
        one_travel = len({cell.full_travel for cell in cells}) == 1
        # Equal cells tie.
        if len(set(cells)) < len(cells) or (one_travel and all(known[cell] for cell in cells)):
            continue
        number += 1
        if number > _MOST_FOLLOWED:
            raise UndecidedError("there are too many choices of cells that are not concave")
        yield cells


def _prove_other(chain: Chain, orders: Any) -> None:
    """Prove that the cycle of a chain is none of two rising orders."""
    try:
        motion = cycle(chain)
    except StaticsError as failure:
        raise UndecidedError(f"a choice has no answer: {failure}") from None
    own = motion.sequence.orders
    if own is not None and (own[0], own[1][::-1]) in orders:
        raise UndecidedError("a choice has the target orders")
    if not motion.path.prove().proved:
        raise UndecidedError("the cycle of a choice of cells that are not concave is not proved")


def _enclosed_ends(cell: Cell) -> _Ends | None:
    """None for a cell whose force is not proved to fall."""
    box = CellBox(cell)
    if not box.falls():
        return None
    forces = [box.extreme(CriticalForce(0, end, 1), 0.0).bound for end in (0, 1)]
    least, most = ([float(side(force)) for force in forces] for side in (low, high))
    # The next doubles outside.
    return _Ends(
        np.nextafter([least], -np.inf), np.nextafter([most], np.inf)
    )  # fmt: skip


def _joined(ends: list[_Ends]) -> _Ends:
    if not ends:
        return _Ends(np.empty((0, 2)), np.empty((0, 2)))
    return _Ends(*(np.concatenate(part) for part in zip(*ends, strict=True)))


def _choice(ends: list[_Ends], orders: Any, least: float, nodes: int) -> tuple[bool, int]:
    """Whether a choice may have F0 and F1 in two rising orders, and the number of partial ones."""
    loading, rank = orders[0], [orders[1].index(cell) for cell in range(len(ends))]

    def fits(depth: int, picks: list[int]) -> Bools:
        cell = loading[depth]
        own = ends[cell]
        may = np.ones(len(own.low), np.bool_)
        for before, pick in zip(loading, picks, strict=False):
            other = ends[before]
            may &= own.high[:, 0] - other.low[pick, 0] > least
            if rank[before] < rank[cell]:
                may &= own.high[:, 1] - other.low[pick, 1] > least
            else:
                may &= other.high[pick, 1] - own.low[:, 1] > least
        return may

    waiting: list[list[int]] = [[]]
    while waiting:
        picks = waiting.pop()
        may = np.flatnonzero(fits(len(picks), picks))
        nodes += 1
        if nodes > _MOST_NODES:
            raise UndecidedError("there are too many choices of holes")
        if len(picks) + 1 == len(loading):
            if len(may):
                return True, nodes
        else:
            waiting += [[*picks, int(k)] for k in may]
    return False, nodes


# Scales: multipliers that add the target inequalities up to a contradiction.


def _scales_excluded(evidence: ScaleEvidence, progress: Progress) -> tuple[str, str]:
    forces: dict[Element, list[Any]] = {}
    for done, (elements, orders) in enumerate(evidence.programs):
        for one in elements:
            if one not in forces:
                forces[one] = element_forces(one)
        notify(progress, done, len(evidence.programs))
        if not _contradiction(elements, orders, forces, evidence):
            raise UndecidedError("multipliers that exclude all scales of a choice")
    low_, high_ = evidence.force_scale
    choices = counted(len(evidence.programs), "choice")
    return (
        f"{choices} of elements and orders with all scales from {low_:g} to {high_:g}",
        "for each, non-negative multipliers add the inequalities of the orders up to a falsehood",
    )


class _Row(NamedTuple):
    """An inequality of two neighbours in an order: Σ c_k gain_k + offset > 0."""

    gain: list[Any]
    offset: Any


def _contradiction(elements: Any, orders: Any, forces: Any, evidence: ScaleEvidence) -> bool:
    """Whether no scales between the bounds meet all inequalities of two orders, proved."""
    bounds = [_scales_of(forces[one], evidence) for one in elements]
    if any(one is None for one in bounds):
        return True
    spans = [one for one in bounds if one is not None]
    rows = list(_rows(elements, orders, forces))
    if any(row is None for row in rows):
        return True
    table = [row for row in rows if row is not None]
    return bool(table) and _add_up(table, spans, evidence.force_scale[1])


def _add_up(table: list[_Row], spans: list[tuple[Any, Any]], most: float) -> bool:
    """Whether weighted inequalities add up to one that no scales in the spans meet."""
    weights = _multipliers(table, spans)
    scale = max(float(abs(g).upper()) for row in table for g in row.gain) * float(most)
    total = sum((w * row.offset for w, row in zip(weights, table, strict=True)), ball(0.0))
    for k, (a, b) in enumerate(spans):
        slope = sum((w * row.gain[k] for w, row in zip(weights, table, strict=True)), ball(0.0))
        ends = slope * a, slope * b
        total = total + (ends[0].union(ends[1]).upper())
    return bool(total <= _LEAST_GAP * scale * sum(weights))


def _scales_of(forces: list[Any], evidence: ScaleEvidence) -> tuple[Any, Any] | None:
    """The least and the largest scale of an element; None if its force is too large at any."""
    least, most = evidence.force_scale
    strongest = max((abs(f) for pair in forces for f in pair), key=lambda f: float(f.mid()))
    limit = ball(most) if np.isinf(evidence.most_force) else ball(evidence.most_force) / strongest
    return None if limit < least else (ball(least), min(ball(most), limit))


def _rows(elements: Any, orders: Any, forces: Any) -> Iterator[_Row | None]:
    """Inequalities of neighbours in two orders; None for one of a single element that is false."""
    cell = [i for i, one in enumerate(elements) for _ in forces[one]]
    own = [pair for one in elements for pair in forces[one]]
    for end, order in enumerate(np.asarray(orders).tolist()):
        sign = -1 if end else 1
        for before, after in pairwise(order):
            i, j = cell[before], cell[after]
            less, more = sign * own[before][end], sign * own[after][end]
            if i == j:
                if not more > less:
                    yield None
                continue
            gain = [ball(0.0) for _ in elements]
            gain[i], gain[j] = -less, more
            yield _Row(gain, ball(elements[j].friction) - ball(elements[i].friction))


def _multipliers(table: list[_Row], bounds: Sequence[tuple[Any, Any]]) -> list[Any]:
    """Non-negative weights of the inequalities, hints of a linear program, as exact doubles."""
    from scipy.optimize import linprog  # pyright: ignore[reportMissingTypeStubs]

    gains = np.array([[float(g.mid()) for g in row.gain] for row in table])
    offsets = np.array([float(row.offset.mid()) for row in table])
    size = float(np.max(np.abs(gains)))
    matrix = np.column_stack([-gains / size, np.ones(len(table))])
    cost = np.zeros(matrix.shape[1])
    cost[-1] = -1.0
    spans = [(float(a.mid()), float(b.mid())) for a, b in bounds]
    solution = linprog(cost, matrix, offsets / size, bounds=[*spans, (None, None)])
    return [ball(max(0.0, -float(y))) for y in solution.ineqlin.marginals]
