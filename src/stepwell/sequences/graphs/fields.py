"""Graphs of relays: of chains under a force, and of the switching fields of others."""

from __future__ import annotations

import gc
import math
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import networkx as nx
import numpy as np
from numpy.typing import ArrayLike, NDArray

from stepwell.base import Floats, InputError, Ints, Measure
from stepwell.concave import Relays
from stepwell.mechanism import Cell, Chain, Element
from stepwell.sequences.branches import Branches
from stepwell.sequences.graphs.node import Node, Transition, TransitionKind
from stepwell.sequences.graphs.transition_graph import (
    TransitionGraph,
    about,
    join,
    measure_of,
)
from stepwell.statics import problem_of, travel_in

Edge = tuple[str, str, dict[str, tuple[Transition]]]


def preisach(chain: Chain, fields: Relays) -> TransitionGraph:
    """The force-controlled graph of concave cells and elements: a Preisach set of relays.

    A prescribed force is a dead load: λ and the energy of a cell ask for no other cell's travel, so
    each goes its own way. A state stands while the force is at least B and at most A of every cell
    in its phase. A rising force lets go the cell of least A, a falling one that of largest B. It
    goes downhill along its own curve to the next phase that holds at this force, and the others,
    which stood before, feel nothing of it; so there are no avalanches, and where it stands the
    state does.

    Args:
        chain: under force control.
        fields: its (A, B).

    Source: Preisach 1935; Terzi and Mungan 2020; that these chains are relays under a prescribed
    force: theory page, "Preisach limit".
    """
    phases = np.diff(fields.first) + 1
    digits = every_state(phases)
    up = np.full((len(phases), np.max(phases)), np.inf)
    down = -up
    up[fields.cell, fields.step] = fields.up
    down[fields.cell, fields.step + 1] = fields.down
    cells = np.arange(len(phases))
    opens, shuts = up[cells, digits], down[cells, digits]
    low, high = np.max(shuts, axis=1), np.min(opens, axis=1)
    low[0], high[-1] = Branches(chain).range
    stands = np.flatnonzero(low <= high)
    labels = labels_of(digits)
    travels = Travels(chain)
    rows = zip(
        stands.tolist(),
        low[stands].tolist(),
        high[stands].tolist(),
        travels.of(digits[stands], low[stands]).tolist(),
        travels.of(digits[stands], high[stands]).tolist(),
        strict=True,
    )
    rising, falling = stands[stands < len(labels) - 1], stands[stands > 0]
    first, last = np.argmin(opens[rising], axis=1), np.argmax(shuts[falling], axis=1)
    found = TransitionGraph()
    with _collector_at_rest():
        for branch, (code, a, b, begin, end) in enumerate(rows):
            label, ends = labels[code], (tuple(begin), tuple(end))
            found.add_node(label, node=Node(label, label, a, b, a, b, *ends, branch))
        ups, downs = _flips(chain, travels, up, +1), _flips(chain, travels, down, -1)
        found.add_edges_from(_edges(labels, digits, rising, first, ups))
        found.add_edges_from(_edges(labels, digits, falling, last, downs))
    elements = "cells" if chain.elements else "concave cells"
    found.graph.update(
        **about(chain),
        ties=(),
        start=None,
        method=f"closed form: {elements} under a prescribed force are independent relays",
    )
    return nx.freeze(found)


def every_state(phases: Ints) -> Ints:
    """(S, N) the phase of every cell in every state, in the order of itertools.product.

    `phases` is how many each cell has.
    """
    return np.arange(int(np.prod(phases)))[:, None] // _weights(phases) % phases


def _weights(phases: Ints) -> Ints:
    """(N,) how many states further on the one is in which a cell is in its next phase."""
    return np.cumprod(np.append(phases, 1)[::-1])[-2::-1]


def labels_of(digits: Ints) -> list[str]:
    """The same states as strings."""
    text, n = (digits + ord("0")).astype(np.uint8).tobytes().decode(), digits.shape[1]
    return [text[k : k + n] for k in range(0, len(text), n)]


class Travels:
    """Travels of the cells of a chain in their phases, by force."""

    def __init__(self, chain: Chain):
        self._problem, self._stretches = problem_of(chain), chain.stretches

    def at(self, cell: int, phase: int, force: float) -> float:
        """Travel [m] of one cell at a force [N]."""
        return travel_in(self._problem, cell, self._stretches[cell][phase], force)

    def of(self, digits: Ints, force: Floats) -> Floats:
        """(S, N) travels [m] in these phases, (S, N), at these forces, (S,) [N]."""
        out = np.empty(digits.shape)
        for cell, column in enumerate(digits.T):
            for phase in range(len(self._stretches[cell])):
                here = column == phase
                forces, which = np.unique(force[here], return_inverse=True)
                travels = [self.at(cell, phase, one) for one in forces.tolist()]
                out[here, cell] = np.array(travels)[which]
        return out


# By cell and phase: what happens when the one leaves the other, and the phase that it lands in.
_Flips = dict[tuple[int, int], tuple[tuple[Transition], int]]


def _flips(chain: Chain, travels: Travels, fields: Floats, direction: int) -> _Flips:
    """What every cell does all by itself; states share it, since none feels the others.

    `fields` are the forces at which it leaves each phase in this direction, (N, P).
    """
    found: _Flips = {}
    for i, leaves in enumerate(fields.tolist()):
        for phase, force in enumerate(leaves):
            if math.isinf(force):
                continue
            target = phase + direction
            # At this force it would leave these phases too.
            while direction * (leaves[target] - force) < 0:
                target += direction
            heat = heat_of(chain, travels, (i, phase, target), force)
            flip = Transition(TransitionKind.SNAP, direction, force, (i,), heat)
            found[i, phase] = (flip,), target
    return found


def heat_of(chain: Chain, travels: Travels, switch: tuple[int, int, int], force: float) -> float:
    """Energy [J] that a cell turns into heat as it goes from a phase to another, all by itself.

    Args:
        chain: whose cell it is.
        travels: of its cells.
        switch: numbers of the cell, of the phase it leaves and of the one it lands in.
        force: at which it goes [N].
    """
    i, phase, target = switch
    cell, (a, b) = chain.cells[i], (travels.at(i, k, force) for k in (phase, target))
    return force * (b - a) - (_energy(cell, target, b) - _energy(cell, phase, a))


def _energy(cell: Cell | Element, phase: int, travel: float) -> float:
    """Energy [J] of a cell in a phase."""
    if isinstance(cell, Element):
        return float(cell.energy_at(travel))
    return float(cell.energy(cell.limit if phase else -cell.limit))


def _edges(
    labels: list[str], digits: Ints, codes: Ints, cells: Ints, flips: _Flips
) -> Iterator[Edge]:
    """Where each of these states goes when that cell of it leaves its phase."""
    weights = _weights(digits[-1] + 1).tolist()
    phases = digits[codes, cells]
    for a, cell, phase in zip(codes.tolist(), cells.tolist(), phases.tolist(), strict=True):
        flip, target = flips[cell, phase]
        b = a + (target - phase) * weights[cell]
        yield labels[a], labels[b], {"transitions": flip}


@contextmanager
def _collector_at_rest() -> Iterator[None]:
    """Python's search for garbage takes longer than making values of which none is garbage."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


# Fields closer than this share of the largest are equal, as in the engine.
_TIE = 1e-9
# How far past the outermost field the graph goes, as a share of their range.
_BEYOND = 0.1


def switching_fields(graph: TransitionGraph) -> Floats:
    """The switching fields of a graph whose cells are hysterons.

    Args:
        graph: of a chain whose cells have two phases each, under force control, or behind a spring
            so soft that no cell comes to rest between them; or one made by `from_switching_fields`.

    Returns:
        (2^N, N) array [N under force control, m behind a spring]. Rows are states in the order of
        itertools.product([0, 1], repeat=N), the inner cell first. `[state][i]` is the drive at
        which cell i leaves its phase while the others stay in theirs: its up field if it is at 0,
        its down field if it is at 1. Rows of states in which the chain cannot stand are filled in
        by the same formula:

            F0_i or F1_i under force control,   Σ S_j + F/K behind a spring K, j the cells at 1

        Of elements F0 and F1 are the forces at which they leave their two phases, and S_j is the
        travel of every cell in its phase at that force.

    Raises:
        ValueError: the cells are no hysterons: under a prescribed stroke all of them let go at
            one stroke, and a cell that has more phases or rests between its stops has more fields.

    Source: the convention is that of hysteron-tgraphs (Teunisse and van Hecke 2025, R. Soc. Open
    Sci.), their class SwitchingFields; the formula for a spring is ours (theory page).
    """
    known = graph.graph.get("fields")
    if known is not None:
        return known.copy()
    chain = graph.chain
    if chain is None:
        raise InputError(
            "graph: was read from a file that tells what its cells do and not what they are. "
            "Take the fields of the graph of the chain itself."
        )
    stiffness = chain.actuator_stiffness
    if math.isinf(stiffness):
        raise InputError(
            "graph: under a prescribed stroke every cell of a vertex lets go at the same stroke, "
            "so there are no switching fields. Ask for chain.graph('force'), or for "
            "chain.graph(K) with a soft spring K [N/m] between actuator and chain."
        )
    resting = next((label for label in graph if "-" in label), None)
    if resting is not None:
        raise InputError(
            f"graph: cells rest between their {'phases' if chain.elements else 'stops'} "
            f"({resting}), so they are no hysterons with two fields. Ask for chain.graph('force') "
            f"or a softer spring than {stiffness:.4g} {chain.measure.stiffness_unit}; where they "
            f"still do, no switching fields describe them."
        )
    for name, phases in zip(chain.names, chain.phases, strict=True):
        if len(phases) != 2:
            raise InputError(
                f"graph: {name} has {len(phases)} phases and a hysteron has two. The forces at "
                f"which it leaves each of them are its `fields`."
            )
    digits = every_state(np.full(len(chain), 2))
    forces = np.array([(one.force_high, other.force_low) for one, other in chain.phases])
    let_go = np.where(digits == 1, forces[:, 1], forces[:, 0])
    if stiffness == 0:
        return let_go
    travels = Travels(chain)
    columns = [np.sum(travels.of(digits, force), axis=1) for force in let_go.T]
    return np.column_stack(columns) + let_go / stiffness


def from_switching_fields(fields: ArrayLike, *, unit: str = "") -> TransitionGraph:
    """The transition graph of interacting hysterons, by the rule of those who study them.

    From a state that stands, a rising drive flips the cell at 0 of least field, when it reaches
    it; a falling one the cell at 1 of largest field. If that leaves another cell past its field
    in the new state, it flips too at the same drive, and so on: an avalanche.

    Args:
        fields: (2^N, N) in the order that `switching_fields` tells.
        unit: of the fields: "N", "m", that of another measure, or nothing for bare numbers.

    Returns:
        A graph whose nodes are the states that stand at some drive. It knows no chain, no travels
        and no energies (`graph.chain` is None, `released` is NaN).

    Raises:
        ValueError: another shape, a number that is not finite, two fields that tie, an avalanche
            in which two cells are past their field at once (a race), or one without end (a loop):
            the rule decides none of these.

    Source: van Hecke 2021, Phys. Rev. E 104, 054608; Teunisse and van Hecke 2025.
    """
    fields = _checked(fields)
    measure = measure_of(unit)
    if unit not in ("", measure.force_unit, measure.travel_unit):
        others = [si for one in Measure for si in (one.force_unit, one.travel_unit)][2:]
        raise InputError(
            f"unit = {unit!r}: must be 'N', 'm', or '' for bare numbers; or {', '.join(others)}."
        )
    digits = every_state(np.full(fields.shape[1], 2))
    at_1 = digits == 1
    opens, shuts = np.where(at_1, np.inf, fields), np.where(at_1, fields, -np.inf)
    low, high = np.max(shuts, axis=1), np.min(opens, axis=1)
    span = float(np.ptp(fields)) or 1.0
    low[0], high[-1] = np.min(fields) - _BEYOND * span, np.max(fields) + _BEYOND * span
    stands = np.flatnonzero(low <= high)
    labels = labels_of(digits)
    found = TransitionGraph()
    for branch, code in enumerate(stands.tolist()):
        ends = float(low[code]), float(high[code])
        label = labels[code]
        unknown = ends if unit == measure.force_unit else (math.nan, math.nan)
        found.add_node(label, node=Node(label, label, *ends, *unknown, (), (), branch))
    rising, falling = stands[stands < len(labels) - 1], stands[stands > 0]
    for codes, direction, drive in ((rising, +1, high), (falling, -1, low)):
        landed = _avalanches(fields, at_1, codes, direction, drive[codes])
        for a, b, at in zip(codes.tolist(), landed.tolist(), drive[codes].tolist(), strict=True):
            cells = tuple(np.flatnonzero(at_1[a] != at_1[b]).tolist())
            flip = Transition(TransitionKind.SNAP, direction, at, cells, math.nan)
            join(found, labels[a], labels[b], flip)
    found.graph.update(
        chain=None,
        names=tuple(f"cell {i + 1}" for i in range(fields.shape[1])),
        actuator="field",
        unit=unit,
        ties=(),
        start=None,
        method="critical cells and avalanches of switching fields",
        fields=fields,
    )
    return nx.freeze(found)


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
    """Where each of these states goes at that drive, which is its critical cell's field."""
    n = fields.shape[1]
    slip = _TIE * float(np.max(np.abs(fields)))
    digit = 1 << np.arange(n - 1, -1, -1)
    before = at_1[codes] == (direction < 0)
    critical = before & (np.abs(fields[codes] - drive[:, None]) <= slip)
    _refuse(np.sum(critical, axis=1) > 1, codes, critical, drive, _TIED, n)
    at = codes ^ (critical @ digit)
    # Brent: an avalanche that comes back to a place where it was marked goes round for ever.
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
            f"The rule does not decide this; change these fields to say what is meant."
        )
