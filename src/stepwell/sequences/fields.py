"""Transition graphs of relays: chains under a prescribed force, and given switching fields."""

import math
from collections.abc import Sequence
from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stepwell.base import Floats, InputError, Ints, Measure
from stepwell.concave import Relays
from stepwell.mechanism import Cell, Chain, Element
from stepwell.sequences import branches, transition_graph
from stepwell.sequences.nodes import StateNodes, States, Transition, TransitionKind
from stepwell.statics import problem_of, travel_in


def preisach(
    chain: Chain, fields: Relays, start: str | None = None
) -> transition_graph.TransitionGraph:
    """The force-controlled graph of concave cells and elements: a Preisach set of relays.

    A prescribed force is a dead load, so cells do not interact. A state is stable while the force
    is at least B and at most A of every cell in its phase. A rising force switches the cell with
    the least A, a falling one the cell with the largest B, to the next phase that is stable there.
    `fields` holds (A, B); without a `start` all states that stand are listed.

    Source: Preisach 1935; Terzi and Mungan 2020; theory page, "Preisach limit".
    """
    sizes = np.diff(fields.first) + 1
    states, travels = States(sizes.tolist()), Travels(chain)
    up = np.full((len(sizes), np.max(sizes)), np.inf)
    down = -up
    up[fields.cell, fields.step] = fields.up
    down[fields.cell, fields.step + 1] = fields.down
    low, high = branches.Branches(chain).range
    falls = _Flips(travels, states, down, -1, low)
    rises = _Flips(travels, states, up, +1, high)
    both = falls, rises
    if start is None:
        codes, first = np.arange(states.count), [flips.first_of_all() for flips in both]
    else:
        codes = _reached(chain, states, both, start)
        first = [flips.first_of(codes) for flips in both]
    low, high = (flips.force[one] for flips, one in zip(both, first, strict=True))
    stands = low <= high
    if not np.all(stands):
        codes, low, high = codes[stands], low[stands], high[stands]
        first = [one[stands] for one in first]
    nodes = StateNodes(states, codes, low, high, travels.shown)
    narrow = np.int32 if len(nodes) < 1 << 31 else np.int64
    target, number = np.full((2, 2, len(nodes)), -1, narrow)
    for row, (flips, one) in enumerate(zip(both, first, strict=True)):
        goes = one < len(flips.ways)
        target[row, goes] = nodes.numbers((codes + flips.shift[one])[goes])
        number[row, goes] = one[goes].astype(int) + row * len(falls.ways)
    elements = "cells" if chain.elements else "concave cells"
    method = f"closed form: {elements} under a prescribed force are independent relays"
    ways = (*falls.ways, *rises.ways)
    return transition_graph.TransitionGraph(
        nodes, target, number, ways, **transition_graph.about(chain), start=start, method=method
    )


class Travels:
    """Travels and energies of the cells of a chain in their phases, by force."""

    def __init__(self, chain: Chain):
        self._cells, self._stretches = chain.cells, chain.stretches
        self._problem = problem_of(chain)
        self._known: dict[tuple[int, int, float], float] = {}
        self._heat: dict[tuple[int, int, int], float] = {}

    def at(self, cell: int, phase: int, force: float) -> float:
        """Travel [m] of one cell at a force [N]."""
        key = cell, phase, force
        if key not in self._known:
            stretch = self._stretches[cell][phase]
            self._known[key] = travel_in(self._problem, cell, stretch, force)
        return self._known[key]

    def shown(self, phases: Sequence[int], force: float) -> tuple[float, tuple[float, ...]]:
        """The force [N] again, and the travels [m] of all cells in these phases at it."""
        return force, tuple(self.at(cell, phase, force) for cell, phase in enumerate(phases))

    def heat(self, switch: tuple[int, int, int], force: float) -> float:
        """Heat [J] of a cell's switch on its own, as (cell, phase before, after), at its force."""
        if switch not in self._heat:
            i, phase, target = switch
            cell, a, b = self._cells[i], self.at(i, phase, force), self.at(i, target, force)
            self._heat[switch] = force * (b - a) - (
                _energy(cell, target, b) - _energy(cell, phase, a)
            )
        return self._heat[switch]


def _energy(cell: Cell | Element, phase: int, travel: float) -> float:
    if isinstance(cell, Element):
        return float(cell.energy_at(travel))
    return float(cell.energy(cell.limit if phase else -cell.limit))


class _Flips:
    """Flips of independent cells as the force goes one way.

    Flips are numbered in the order of their forces; one more represents the `end` of the drive.
    `fields` (N, P) are the forces at which a cell leaves each phase this way. `shift` is the
    difference of the state number by each flip. `rank` is the number of the flip by which a cell
    leaves each of its phases.
    """

    def __init__(self, travels: Travels, states: States, fields: Floats, way: int, end: float):
        cells, phases = np.nonzero(np.isfinite(fields))
        # If two cells tie, the inner cell flips first.
        order = np.argsort(way * fields[cells, phases], kind="stable")
        cells, phases = cells[order].tolist(), phases[order].tolist()
        # Read for every state, so as narrow as possible.
        kind = np.min_scalar_type(len(cells))
        self.states, self.rank = states, [np.full(size, len(cells), kind) for size in states.sizes]
        self.ways: list[Transition] = []
        shift: list[int] = []
        for number, (cell, phase) in enumerate(zip(cells, phases, strict=True)):
            force, target = float(fields[cell, phase]), phase + way
            # At this force it would leave these phases too.
            while way * (fields[cell, target] - force) < 0:
                target += way
            heat = travels.heat((cell, phase, target), force)
            self.ways.append(Transition(TransitionKind.SNAP, way, force, (cell,), heat))
            shift.append((target - phase) * states.weights[cell])
            self.rank[cell][phase] = number
        self.force = np.array([*(one.drive for one in self.ways), end])
        self.shift = np.array([*shift, 0])

    def first_of_all(self) -> Ints:
        return reduce(np.minimum.outer, self.rank).ravel()

    def first_of(self, codes: Ints) -> Ints:
        digits = (self.states.digit(codes, cell) for cell in range(len(self.rank)))
        ranks = (rank[digit] for rank, digit in zip(self.rank, digits, strict=True))
        return reduce(np.minimum, ranks)


def _reached(chain: Chain, states: States, both: tuple[_Flips, _Flips], start: str) -> Ints:
    """States that are reachable from one state under a force, in rising order."""
    code = states.code(branches.checked_state(chain, "start", start))
    assert code is not None
    seen = front = np.array([code])
    falls, rises = both
    if falls.force[falls.first_of(front)] > rises.force[rises.first_of(front)]:
        raise InputError(transition_graph.no_start(chain, start))
    what = "the number of reached states is that of"
    while len(front):
        transition_graph.require_as_many(len(seen), "relays", what)
        steps = [front + flips.shift[flips.first_of(front)] for flips in both]
        after = np.unique(np.concatenate(steps))
        place = np.minimum(np.searchsorted(seen, after), len(seen) - 1)
        front = after[seen[place] != after]
        # Two sorted runs, which a stable sort merges.
        seen = np.sort(np.concatenate([seen, front]), kind="stable")
    return seen


# Fields closer than this fraction of the largest are equal, as in the engine.
_TIE = 1e-9
# Range of the graph past the outermost field, as a fraction of the range of fields.
_BEYOND = 0.1


def switching_fields(graph: transition_graph.TransitionGraph) -> Floats:
    """The switching fields of a graph whose cells are hysterons.

    Args:
        graph: of a chain whose cells have two phases each, under force control, or behind a spring
            so soft that no cell comes to rest between them; or one made by `from_switching_fields`.

    Returns:
        (2^N, N) array [N under force control, m behind a spring]. Rows are states in the order of
        itertools.product([0, 1], repeat=N), the inner cell first. `[state][i]` is the drive at
        which cell i leaves its phase while the others stay in theirs: its up field if it is at 0,
        its down field if it is at 1; the same formula holds in states that are no equilibrium:

            F0_i or F1_i under force control,   Σ S_j + F/K behind a spring K, j the cells at 1

        For elements F0 and F1 are the critical forces of their two phases, and S_j is the travel of
        every cell in its phase at that force.

    Raises:
        ValueError: the cells are no hysterons: under a prescribed stroke all of them switch at one
            stroke, and a cell that has more phases or rests between its stops has more fields.

    Source: the convention is that of hysteron-tgraphs (Teunisse and van Hecke 2025, R. Soc. Open
    Sci.), their class SwitchingFields; the formula for a spring is ours (theory page).
    """
    if graph.fields is not None:
        return graph.fields.copy()
    chain = graph.chain
    if chain is None:
        raise InputError(
            "graph: was read from a file, which contains no chain. Use the fields of the graph of "
            "the chain itself."
        )
    stiffness = chain.actuator_stiffness
    if math.isinf(stiffness):
        raise InputError(
            "graph: under a prescribed stroke every cell of a vertex switches at the same stroke, "
            "so there are no switching fields. Use chain.graph('force'), or chain.graph(K) with a "
            "soft spring K [N/m] between actuator and chain."
        )
    resting = next((label for label in graph if "-" in label), None)
    if resting is not None:
        raise InputError(
            f"graph: cells rest between their {'phases' if chain.elements else 'stops'} "
            f"({resting}), so they are no hysterons with two fields. Use chain.graph('force') or a "
            f"softer spring than {stiffness:.4g} {chain.measure.stiffness_unit}. If that changes "
            f"nothing, no switching fields describe these cells."
        )
    for name, phases in zip(chain.names, chain.phases, strict=True):
        if len(phases) != 2:
            raise InputError(
                f"graph: {name} has {len(phases)} phases and a hysteron has two. Its critical "
                f"forces are its `fields`."
            )
    digits = States([2] * len(chain)).phases(np.arange(2 ** len(chain)))
    forces = np.array([(one.force_high, other.force_low) for one, other in chain.phases])
    let_go = np.where(digits == 1, forces[:, 1], forces[:, 0])
    if stiffness == 0:
        return let_go
    travels = Travels(chain)
    sums = [
        np.sum([travels.shown(state, force)[1] for force in row], axis=1)
        for state, row in zip(digits.tolist(), let_go.tolist(), strict=True)
    ]
    return np.array(sums) + let_go / stiffness


def from_switching_fields(fields: ArrayLike, *, unit: str = "") -> transition_graph.TransitionGraph:
    """The transition graph of interacting hysterons from their switching fields.

    In a stable state, a rising drive flips the cell at 0 with the least field, when it reaches
    that field; a falling one the cell at 1 with the largest field. If another cell is then past
    its field in the new state, it flips too at the same drive, and so on: an avalanche.

    Args:
        fields: (2^N, N) in the order of `switching_fields`.
        unit: of the fields: "N", "m", that of another measure, or nothing for bare numbers.

    Returns:
        A graph of the states that stand at some drive, without a chain (None), travels and
        energies (NaN).

    Raises:
        ValueError: another shape, a number that is not finite, two fields that tie, an avalanche
            in which two cells are past their field at once (a race), or one without end (a loop).
    Source: van Hecke 2021, Phys. Rev. E 104, 054608; Teunisse and van Hecke 2025.
    """
    fields = _checked(fields)
    measure = transition_graph.measure_of(unit)
    if unit not in ("", measure.force_unit, measure.travel_unit):
        others = [si for one in Measure for si in (one.force_unit, one.travel_unit)][2:]
        raise InputError(
            f"unit = {unit!r}: must be 'N', 'm', or '' for bare numbers; or {', '.join(others)}."
        )
    states = States([2] * fields.shape[1])
    at_1 = states.phases(np.arange(states.count)) == 1
    opens, shuts = np.where(at_1, np.inf, fields), np.where(at_1, fields, -np.inf)
    low, high = np.max(shuts, axis=1), np.min(opens, axis=1)
    span = float(np.ptp(fields)) or 1.0
    low[0], high[-1] = np.min(fields) - _BEYOND * span, np.max(fields) + _BEYOND * span
    codes = np.flatnonzero(low <= high)
    shown = _force_alone if unit == measure.force_unit else _nothing
    nodes = StateNodes(states, codes, low[codes], high[codes], shown)
    target, number = np.full((2, len(nodes)), -1), np.full((2, len(nodes)), -1)
    ways: list[Transition] = []
    for row, direction, drive, last in ((1, +1, high, len(low) - 1), (0, -1, low, 0)):
        goes = codes != last
        begin = codes[goes]
        landed = _avalanches(fields, at_1, begin, direction, drive[begin])
        target[row, goes] = nodes.numbers(landed)
        number[row, goes] = len(ways) + np.arange(len(begin))
        for flipped, at in zip(at_1[begin] != at_1[landed], drive[begin].tolist(), strict=True):
            cells = tuple(np.flatnonzero(flipped).tolist())
            ways.append(Transition(TransitionKind.SNAP, direction, at, cells, math.nan))
    return transition_graph.TransitionGraph(
        nodes,
        target,
        number,
        tuple(ways),
        chain=None,
        names=tuple(f"cell {i + 1}" for i in range(fields.shape[1])),
        actuator="field",
        unit=unit,
        start=None,
        method="critical cells and avalanches of switching fields",
        fields=fields,
    )


def _force_alone(_: tuple[int, ...], drive: float) -> tuple[float, tuple[float, ...]]:
    return drive, ()


def _nothing(*_: object) -> tuple[float, tuple[float, ...]]:
    return math.nan, ()


def _checked(fields: ArrayLike) -> Floats:
    fields = np.array(fields, float)
    if fields.ndim != 2 or fields.shape[0] != 1 << fields.shape[1] or not fields.shape[1]:
        raise InputError(
            f"fields has shape {fields.shape}: must be (2^N, N), one row for each state of N cells."
        )
    if not np.all(np.isfinite(fields)):
        row, cell = np.argwhere(~np.isfinite(fields))[0].tolist()
        raise InputError(f"fields[{row}][{cell}] = {fields[row, cell]}: must be a finite number.")
    return fields


def _avalanches(
    fields: Floats, at_1: NDArray[Any], codes: Ints, direction: int, drive: Floats
) -> Ints:
    """Target of each of these states at a drive, the field of its critical cell."""
    n = fields.shape[1]
    slip = _TIE * float(np.max(np.abs(fields)))
    digit = 1 << np.arange(n - 1, -1, -1)
    before = at_1[codes] == (direction < 0)
    critical = before & (np.abs(fields[codes] - drive[:, None]) <= slip)
    _refuse(np.sum(critical, axis=1) > 1, codes, critical, drive, _TIED, n)
    at = codes ^ (critical @ digit)
    # Brent: an avalanche that returns to a marked state never ends.
    mark, last, steps, until = codes, codes, 0, 1
    while True:
        _refuse((at == mark) | (at == codes), codes, at_1[at] != at_1[last], drive, _LOOP, n)
        past = drive[:, None] - fields[at]
        tied = np.abs(past) <= slip
        _refuse(np.any(tied, axis=1), codes, tied, drive, _TIED, n)
        unstable = np.where(at_1[at], past < 0, past > 0)
        count = np.sum(unstable, axis=1)
        _refuse(count > 1, codes, unstable, drive, _RACE, n)
        if not np.any(count):
            return at
        steps += 1
        if steps == until:
            mark, steps, until = np.where(count > 0, at, codes), 0, 2 * until
        last, at = at, at ^ (unstable @ digit)


_TIED = "a field is just that drive, so the cell may flip or not"
_RACE = "two cells are past their fields at once, so either may flip first, a race"
_LOOP = "cells flip to and fro for ever, a loop"


def _refuse(
    wrong: NDArray[Any], codes: Ints, cells: NDArray[Any], drive: Floats, why: str, n: int
) -> None:
    if np.any(wrong):
        k = int(np.argmax(wrong))
        named = ", ".join(f"cell {i + 1}" for i in np.flatnonzero(cells[k]).tolist())
        raise InputError(
            f"fields: on the way from {codes[k]:0{n}b} at the drive {drive[k]:.6g} {why}: {named}. "
            f"The rule does not decide this. Change one of these fields."
        )
