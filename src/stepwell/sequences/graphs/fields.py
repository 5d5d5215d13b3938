"""Graphs of relays: of concave cells under a force, and of the switching fields of others."""

from __future__ import annotations

import gc
import math
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import networkx as nx
import numpy as np
from numpy.typing import ArrayLike, NDArray

from stepwell.base import Bools, Floats, InputError, Ints
from stepwell.concave import Relays
from stepwell.mechanism import Chain
from stepwell.sequences.branches import Branches
from stepwell.sequences.graphs.node import Node, Transition, TransitionKind
from stepwell.sequences.graphs.transition_graph import TransitionGraph, about, join

Edge = tuple[str, str, dict[str, tuple[Transition]]]


def preisach(chain: Chain, fields: Relays) -> TransitionGraph:
    """The force-controlled graph of concave cells: a Preisach set of relays.

    A state stands while the force is at least B of every cell at 1 and at most A of every cell at
    0. A rising force flips the cell of least A among those at 0, a falling one that of largest B
    among those at 1. One flip is all that happens there, even with cells that are not bistable:
    at the force A_i of the flip the others stood before and feel nothing of it, and i stands,
    since B_i < A_i. So there are no avalanches.

    Args:
        chain: under force control.
        fields: its (A, B).

    Source: Preisach 1935; Terzi and Mungan 2020; that concave cells are relays under a prescribed
    force: theory page, "Preisach limit".
    """
    full = np.array(chain.full_travels)
    at_1 = every_state(len(chain))
    opens = np.where(at_1, np.inf, fields.up)
    shuts = np.where(at_1, fields.down, -np.inf)
    low, high = np.max(shuts, axis=1), np.min(opens, axis=1)
    low[0], high[-1] = Branches(chain).range
    stands = np.flatnonzero(low <= high)
    labels = labels_of(len(chain))
    rows = zip(
        stands.tolist(),
        low[stands].tolist(),
        high[stands].tolist(),
        (at_1[stands] * full).tolist(),
        strict=True,
    )
    ups, downs = _flips(chain, fields)
    rising, falling = stands[stands < len(labels) - 1], stands[stands > 0]
    first, last = np.argmin(opens[rising], axis=1), np.argmax(shuts[falling], axis=1)
    found = TransitionGraph()
    with _collector_at_rest():
        for branch, (code, a, b, travel) in enumerate(rows):
            label, travels = labels[code], tuple(travel)
            found.add_node(label, node=Node(label, label, a, b, a, b, travels, travels, branch))
        found.add_edges_from(_edges(labels, rising, first, ups))
        found.add_edges_from(_edges(labels, falling, last, downs))
    found.graph.update(
        **about(chain),
        ties=(),
        start=None,
        method="closed form: concave cells under a prescribed force are independent relays",
    )
    return nx.freeze(found)


def every_state(cells: int) -> Bools:
    """(2^N, N) which cells are at 1, the states counted up as binary numbers."""
    codes = np.arange(1 << cells)[:, None]
    return (codes >> np.arange(cells - 1, -1, -1)) & 1 == 1


def labels_of(cells: int) -> list[str]:
    """The same states as strings."""
    return [format(code, f"0{cells}b") for code in range(1 << cells)]


def _flips(chain: Chain, fields: Relays) -> tuple[list[Transition], list[Transition]]:
    """What happens when each cell goes up, and when each goes down.

    That does not depend on the others, so all states share these 2 N values.
    """
    ups: list[Transition] = []
    downs: list[Transition] = []
    pairs = zip(fields.up.tolist(), fields.down.tolist(), strict=True)
    for i, (cell, (up, down)) in enumerate(zip(chain.cells, pairs, strict=True)):
        gain = float(cell.energy(cell.limit)) - float(cell.energy(-cell.limit))
        work_up, work_down = up * cell.full_travel, down * cell.full_travel
        ups.append(Transition(TransitionKind.SNAP, +1, up, (i,), work_up - gain))
        downs.append(Transition(TransitionKind.SNAP, -1, down, (i,), gain - work_down))
    return ups, downs


def _edges(labels: list[str], codes: Ints, cells: Ints, flips: list[Transition]) -> Iterator[Edge]:
    alone = [(flip,) for flip in flips]
    # The first cell is the first character, which is the highest digit.
    targets = codes ^ (1 << (len(flips) - 1 - cells))
    for a, b, cell in zip(codes.tolist(), targets.tolist(), cells.tolist(), strict=True):
        yield labels[a], labels[b], {"transitions": alone[cell]}


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
        graph: of a chain under force control, or behind a spring so soft that no cell comes to
            rest between its stops; or one made by `from_switching_fields`.

    Returns:
        (2^N, N) array [N under force control, m behind a spring]. Rows are states in the order of
        itertools.product([0, 1], repeat=N), the inner cell first. `[state][i]` is the drive at
        which cell i lets go of its stop while the others hold theirs: its up field if it is at 0,
        its down field if it is at 1. Rows of states in which the chain cannot stand are filled in
        by the same formula:

            F0_i or F1_i under force control,   Σ S_j + F/K behind a spring K, j the cells at 1

    Raises:
        ValueError: the cells are no hysterons: under a prescribed stroke all of them let go at
            one stroke, and a cell that rests between its stops has more than two fields.

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
            f"graph: cells rest between their stops ({resting}), so they are no hysterons with "
            f"two fields. Ask for chain.graph('force') or a softer spring than "
            f"{stiffness:.4g} N/m; where they still do, no switching fields describe them."
        )
    at_1 = every_state(len(chain))
    forces = np.array([(cell.force_0, cell.force_1) for cell in chain.cells])
    let_go = np.where(at_1, forces[:, 1], forces[:, 0])
    if stiffness == 0:
        return let_go
    full = np.array(chain.full_travels)
    return (at_1 @ full)[:, None] + let_go / stiffness


def from_switching_fields(fields: ArrayLike, *, unit: str = "") -> TransitionGraph:
    """The transition graph of interacting hysterons, by the rule of those who study them.

    From a state that stands, a rising drive flips the cell at 0 of least field, when it reaches
    it; a falling one the cell at 1 of largest field. If that leaves another cell past its field
    in the new state, it flips too at the same drive, and so on: an avalanche.

    Args:
        fields: (2^N, N) in the order that `switching_fields` tells.
        unit: of the fields: "N", "m", or nothing for bare numbers.

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
    if unit not in ("", "N", "m"):
        raise InputError(f"unit = {unit!r}: must be 'N', 'm', or '' for bare numbers.")
    at_1 = every_state(fields.shape[1])
    opens, shuts = np.where(at_1, np.inf, fields), np.where(at_1, fields, -np.inf)
    low, high = np.max(shuts, axis=1), np.min(opens, axis=1)
    span = float(np.ptp(fields)) or 1.0
    low[0], high[-1] = np.min(fields) - _BEYOND * span, np.max(fields) + _BEYOND * span
    stands = np.flatnonzero(low <= high)
    labels = labels_of(fields.shape[1])
    found = TransitionGraph()
    for branch, code in enumerate(stands.tolist()):
        ends = float(low[code]), float(high[code])
        label = labels[code]
        unknown = (math.nan, math.nan) if unit != "N" else ends
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
