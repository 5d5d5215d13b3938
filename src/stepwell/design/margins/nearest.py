"""The nearest displacement of one anchor after which a chain does otherwise."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from stepwell.base import Bools, Floats, Vec2
from stepwell.concave import Neighbour, SortedChain
from stepwell.design.margins.displacements import Displacements
from stepwell.design.margins.nearest_place import Place, nearest_place
from stepwell.design.margins.search import nearest_found
from stepwell.design.orders import relay_cycle
from stepwell.design.parameters import Parameter
from stepwell.design.plane import Method
from stepwell.mechanism import Chain
from stepwell.sequences import Sequence, cycle, cycles_of
from stepwell.statics import StaticsError, nominal

# How far past a change a chain is looked at [m]: far enough to leave no tie, near enough that
# nothing else has changed. The smaller ones are for regions that are narrower.
_PAST = (1e-8, 1e-9, 1e-10)


class Nearest(NamedTuple):
    """The nearest displacement, and one just past it.

    Attributes:
        distance: its length [m]; infinite where there is none within reach.
        move, past: (dx, dy) of the anchor there [m] and where the chain does otherwise; NaN
            where there is none.
        method: exact, or a search.
    """

    distance: float
    move: Vec2
    past: Vec2
    method: Method


def sequence(chain: Chain) -> Sequence:
    """What the chain does, in closed form where it holds, else by the general engine."""
    forces = SortedChain.of(chain)
    if forces is None:
        relays = relay_cycle(chain)
        return cycle(chain).sequence if relays is None else Sequence.parse(relays)
    return Sequence.full_cycle(forces.loading, forces.unloading)


def nearest(
    chain: Chain,
    forces: SortedChain | None,
    now: Sequence,
    anchor: Parameter,
    wanted: Sequence | None,
    ways: Displacements,
    progress: Callable[[int, int], None] | None = None,
) -> Nearest:
    """The nearest displacement of an anchor after which the chain does what is wanted.

    In closed form where the proof that the cells are concave holds for every displacement up to
    it; else what the closed form says is checked, and a nearer one searched.

    Args:
        chain: any number of cells.
        forces: the chain in closed form, None where that is not proved.
        now: what it does.
        anchor: a p or q of the chain.
        wanted: what it has to do; None for anything else than now.
        ways: where the anchor may go.
        progress: called with (done, total) places while the engine is asked.
    """
    assert anchor.cell is not None

    def does(move: Floats) -> bool:
        # A design that cannot be made, or that the engine cannot follow, does nothing.
        try:
            done = sequence(anchor.displaced(chain, move))
        except (ValueError, StaticsError):
            return False
        return done != now if wanted is None else done == wanted

    def all_do(moves: Floats) -> Bools:
        designs = nominal(chain, len(moves))
        assert designs is not None
        anchor.put(designs, chain, np.array(anchor.value(chain)) + moves)
        found = cycles_of(lambda i: anchor.displaced(chain, moves[i]), len(moves), designs)
        done = [one != now if wanted is None else one == wanted for one in found.sequences]
        # A design without a number does nothing.
        return np.array([*done, False])[np.maximum(found.number, -1)]

    known, past, proved = None, None, False
    if forces is not None:
        known, proved = _in_closed_form(forces, anchor, wanted, ways)
        # Where any other sequence will do, the closed form is proof enough.
        if proved and wanted is None:
            return _proved(known)
        if known is not None:
            past = next(filter(does, _just_past(known)), None)
    method = Method.EXACT if proved else Method.SEARCH
    within = ways.reach if known is None or past is None else known.distance
    if not proved:
        found = nearest_found(
            lambda u: does(ways.frame @ u),
            ways,
            within,
            wanted is not None,
            progress,
            None
            if forces or chain.elements or nominal(chain, 0) is None
            else lambda us: all_do(us @ ways.frame.T),
        )
        if found is not None and float(np.linalg.norm(found)) < within:
            move = ways.move(found)
            return Nearest(float(np.linalg.norm(found)), move, move, method)
    if known is None or past is None:
        return Nearest(math.inf, (math.nan, math.nan), (math.nan, math.nan), method)
    return Nearest(known.distance, _vec(known.move), _vec(past), method)


def nearest_proved(forces: SortedChain, anchor: Parameter, ways: Displacements) -> Nearest | None:
    """The nearest displacement that changes anything; None where no closed form proves it.

    Args:
        forces: a chain in closed form.
        anchor: a p or q of the chain.
        ways: where the anchor may go.
    """
    known, proved = _in_closed_form(forces, anchor, None, ways)
    return _proved(known) if proved else None


def _proved(known: Place | None) -> Nearest:
    if known is None:
        nowhere = math.nan, math.nan
        return Nearest(math.inf, nowhere, nowhere, Method.EXACT)
    return Nearest(known.distance, _vec(known.move), _vec(_just_past(known)[0]), Method.EXACT)


def _just_past(known: Place) -> list[Floats]:
    return [known.move + far * known.inward for far in _PAST]


def _vec(move: Floats) -> Vec2:
    x, y = move.tolist()
    return x, y


def _in_closed_form(
    forces: SortedChain, anchor: Parameter, wanted: Sequence | None, ways: Displacements
) -> tuple[Place | None, bool]:
    """The nearest place, and whether the cell is proved concave all the way there."""
    assert anchor.cell is not None
    cell, sign = anchor.cell, 1 if anchor.part == "q" else -1
    best: Place | None = None
    for conditions in _regions(forces, cell, wanted):
        within = ways.reach if best is None else best.distance
        place = nearest_place(forces.cells[cell], conditions, ways, sign, within)
        if place is not None and (best is None or place.distance < best.distance):
            best = place
    far = ways.reach if best is None else best.distance
    # One cell alone goes where the actuator goes, whatever its force.
    return best, len(forces.cells) == 1 or ways.proved(forces.cells[cell], sign, far)


def _regions(forces: SortedChain, cell: int, wanted: Sequence | None) -> list[list[Neighbour]]:
    """Conditions on the moved cell; the sequence is the wanted one where all of a list hold."""
    if wanted is None:
        return [[neighbour] for neighbour in forces.neighbours(cell)]
    orders = wanted.orders
    if orders is None:
        return []
    for order, now in zip(orders, (forces.loading, forces.unloading), strict=True):
        if [i for i in order if i != cell] != [i for i in now if i != cell]:
            return []  # the other cells do not do their part
    # It must not pass its neighbours in the wanted orders, but keep to its own side of them.
    return [[n._replace(up=-n.up) for n in forces.neighbours(cell, orders)]]
