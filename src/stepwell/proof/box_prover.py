"""Proving boxes of machines: all within tolerances, or all within the margin of one number."""

import heapq
import math
from collections.abc import Sequence
from dataclasses import fields
from itertools import count
from typing import NamedTuple

from stepwell.base import InputError, Progress, tracked
from stepwell.design import Change, Design, Draws, Margin, Tolerances, margin as margin_of
from stepwell.mechanism import Cell, Chain, Element
from stepwell.proof.box_proofs import (
    BoxOutcome,
    MarginProof,
    ProvedChange,
    ProvedDesign,
    ToleranceProof,
)
from stepwell.proof.cell_boxes import ALL, CellBox, CellPart, displacements, parts_within
from stepwell.proof.order_boxes import Decision, OrderedBox, becomes
from stepwell.sequences import Cycle, cycle

# CellPart of a margin up to which its proof is attempted: at the margin itself two cells tie.
UP_TO = 1.0 - 1e-5
# A change that no search found is looked at between these factors of a number.
_LEAST, _MOST = 1e-6, 8.0
# Halvings of a change that is not proved as a whole.
_HALVINGS = 6
# Samples that the engine follows in search of a counterexample.
_SAMPLES = 100
# Longest chain whose box is bisected, and the largest number of boxes.
_MOST_CELLS, MOST_BOXES = 4, 200


def prove_tolerances(
    chain: Chain,
    tolerances: Tolerances,
    target: str | None = None,
    progress: Progress = None,
    *,
    boxes: int = MOST_BOXES,
) -> ToleranceProof:
    """Prove that every machine within tolerances has the sequence of the nominal design.

    Or return a machine that has not, or the fraction of the box that is not decided. Boxes of up to
    four cells that are not decided as a whole are bisected.

    Args:
        chain: the nominal design.
        tolerances: of its parts.
        target: the sequence in question; by default that of the nominal design.
        progress: called with (done, total) samples, then boxes, where the whole is not decided.
        boxes: largest number of boxes.

    Raises:
        ValueError: a tolerance of mobilities, which no proof here covers.
        StaticsError: the engine cannot follow the chain.

    Source: ours (theory page, "Proofs within tolerances").
    """
    if tolerances.mobility > 1.0:
        raise InputError(
            f"mobility = {tolerances.mobility:g}: must be 1; the proof of an order of critical "
            f"forces holds for any mobilities."
        )
    nominal = cycle(chain)
    sequence = str(nominal.sequence) if target is None else target
    parts = [*map(parts_within, chain.cells, tolerances.each(len(chain)))]
    decision = Decision(False, "the nominal design itself", chain, str(nominal.sequence))
    if str(nominal.sequence) == sequence:
        decision = OrderedBox(nominal, parts).decide()
    share, looked = float(not decision.proved), 1
    if not decision.proved and decision.machine is None:
        decision = _sampled(nominal, tolerances, decision, progress)
        # Without cells whose spans are too wide, narrower ones do not help.
        if decision.machine is None and decision.cells and len(chain) <= _MOST_CELLS:
            search = _Bisection(nominal, parts)
            decision = search.run(decision, boxes, progress)
            share, looked = search.undecided, search.looked
    refuted = decision.machine is not None
    outcome = BoxOutcome.PROVED if decision.proved else BoxOutcome.UNDECIDED
    return ToleranceProof(
        chain,
        tolerances,
        sequence,
        BoxOutcome.REFUTED if refuted else outcome,
        decision.cause,
        decision.machine,
        decision.becomes,
        sum(len(own) for own in parts),
        looked,
        None if refuted else share,
    )


def _sampled(
    nominal: Cycle, tolerances: Tolerances, decision: Decision, progress: Progress
) -> Decision:
    """A decision with a counterexample among samples that the engine follows, if there is one."""
    draws = Draws(nominal.chain, tolerances, 0)
    for number in tracked(range(_SAMPLES), progress):
        try:
            machine = draws.sample(number)
        except ValueError:
            continue
        if other := becomes(machine, str(nominal.sequence)):
            return Decision(False, f"sample {number} of seed 0", machine, other)
    return decision


# Bisection of a box.

_Spans = tuple[tuple[CellPart, ...], ...]


class _Box(NamedTuple):
    """A part of a box of machines; the largest one is divided first."""

    less: float  # minus its volume, as a fraction of the whole
    number: int
    parts: _Spans
    known: Decision


class _Bisection:
    """Boxes of the numbers of a chain: those that are proved, and those that are not.

    Displacements of q - p lie in rectangles here; what is outside of the disc of the tolerance is
    left out.
    """

    def __init__(self, nominal: Cycle, parts: Sequence[Sequence[CellPart]]):
        self.nominal, self.sequence = nominal, str(nominal.sequence)
        self.discs = [
            {part.band: part.high for part in own if part.what == "radius"} for own in parts
        ]
        self.whole: _Spans = tuple(tuple(_rectangular(own)) for own in parts)
        pairs = zip(nominal.chain.cells, self.whole, strict=True)
        self.weight = [[_effect(cell, part) for part in own] for cell, own in pairs]
        self.done, self.looked, self._number = 0.0, 1, count()
        self.waiting: list[_Box] = []

    @property
    def undecided(self) -> float:
        """Fraction of the volume that is not proved."""
        rest = -sum(one.less for one in self.waiting)
        return rest / (rest + self.done) if rest else 0.0

    def run(self, decision: Decision, most: int, progress: Progress) -> Decision:
        """Divide boxes until all are proved, a machine refutes them, or too many are seen."""
        self._wait(1.0, self.whole, decision)
        for _ in tracked(range(max(0, (most - 1) // 2)), progress):
            if not self.waiting:
                break
            top = heapq.heappop(self.waiting)
            halves = self._halves(top)
            if not halves:
                heapq.heappush(self.waiting, top)
                break
            for parts in halves:
                found = self._look(-0.5 * top.less, parts)
                if found is not None and found.machine is not None:
                    return found
        return self.waiting[0].known if self.waiting else Decision(True)

    def _wait(self, volume: float, parts: _Spans, known: Decision) -> None:
        heapq.heappush(self.waiting, _Box(-volume, next(self._number), parts, known))

    def _look(self, volume: float, parts: _Spans) -> Decision | None:
        """Decide a box; returns a decision that is no proof."""
        if any(map(_outside, self.discs, parts)):
            return None
        self.looked += 1
        known = OrderedBox(self.nominal, parts).decide()
        if known.proved:
            self.done += volume
            return None
        # A machine at an end of a rectangle may be outside of the disc.
        machine = known.machine if known.machine is not None and not any(self.discs) else None
        other = known.becomes if machine is not None else ""
        if machine is None and (machine := self._middle(parts)) is not None:
            other = becomes(machine, self.sequence)
        known = known._replace(machine=machine if other else None, becomes=other)
        self._wait(volume, parts, known)
        return known

    def _middle(self, parts: _Spans) -> Chain | None:
        """The machine in the middle of a box; None if it is outside of the tolerances."""
        middles = [
            [part._replace(low=0.5 * (part.low + part.high), high=0.5 * (part.low + part.high))
             for part in own]
            for own in parts
        ]  # fmt: skip
        if any(map(_outside, self.discs, middles)):
            return None
        box = OrderedBox(self.nominal, middles)
        return box.machine({i: [part.low for part in own] for i, own in enumerate(middles)})

    def _halves(self, box: _Box) -> list[_Spans]:
        """Both halves of a box, across the number with the largest effect; none for a point."""
        best, at = 0.0, (-1, -1)
        for i in box.known.cells:
            for k, part in enumerate(box.parts[i]):
                whole = self.whole[i][k]
                width = (part.high - part.low) / (whole.high - whole.low) * self.weight[i][k]
                if width > best:
                    best, at = width, (i, k)
        i, k = at
        if i < 0:
            return []
        part, own = box.parts[i][k], box.parts[i]
        centre = 0.5 * (part.low + part.high)
        halves = part._replace(high=centre), part._replace(low=centre)
        return [
            (*box.parts[:i], (*own[:k], half, *own[k + 1 :]), *box.parts[i + 1 :])
            for half in halves
        ]


def _rectangular(parts: Sequence[CellPart]) -> list[CellPart]:
    """Parts with the square around each disc of displacements."""
    out: list[CellPart] = []
    for part in parts:
        if part.what == "radius":
            out += [CellPart(axis, part.band, -part.high, part.high) for axis in "xy"]
        elif part.what != "angle" and part.high > part.low:
            out.append(part)
    return out


def _outside(discs: dict[int, float], parts: Sequence[CellPart]) -> bool:
    """Whether the displacement of some band is outside of its disc everywhere in a box."""
    for band, radius in discs.items():
        own = [part for part in parts if part.band == band and part.what in ("x", "y")]
        nearest = [max(0.0, part.low, -part.high) for part in own]
        if math.hypot(*nearest) > radius:
            return True
    return False


def _effect(cell: Cell | Element, part: CellPart) -> float:
    """By how much the critical forces of a cell differ between the ends of a part."""
    ends: list[tuple[float, ...]] = []
    for value in (part.low, part.high):
        if part.what in ("x", "y"):
            own = CellPart("y" if part.what == "x" else "x", part.band, 0.0, 0.0)
            both = sorted([(part, value), (own, 0.0)], key=lambda one: one[0].what)
        else:
            both = [(part, value)]
        box = CellBox(cell, tuple(one for one, _ in both))
        made = box.machine([at for _, at in both])
        forces = [force for one in made.phases for force in (one.force_low, one.force_high)]
        ends.append(tuple(force for force in forces if math.isfinite(force)))
    friction = part.high - part.low if part.what == "friction" else 0.0
    return friction + math.fsum(abs(a - b) for a, b in zip(*ends, strict=False)) + 1e-12


def prove_margin(
    margin: Margin, tolerances: Tolerances | None = None, progress: Progress = None
) -> MarginProof:
    """Prove that no change of one parameter below the margin alters the sequence.

    The proof goes up to 99.999 % of each change: there, two cells tie. A change that is infinite
    is covered up to the reach of the margin, or up to a factor of 8.

    Args:
        margin: of a chain.
        tolerances: of its parts, to prove the sequence for all machines within them too.
        progress: called with (done, total) changes.

    Source: ours (theory page, "Proofs within tolerances").
    """
    nominal = cycle(margin.chain)
    changes = [_proved_change(nominal, margin, one) for one in tracked(margin.changes, progress)]
    within = None if tolerances is None else prove_tolerances(margin.chain, tolerances)
    return MarginProof(margin, tuple(changes), within)


def _proved_change(nominal: Cycle, margin: Margin, change: Change) -> ProvedChange:
    anchor = change.parameter == "anchor"
    most = margin.reach if anchor else _MOST - 1.0
    size = UP_TO * change.distance if math.isfinite(change.distance) else most

    def decide(up_to: float) -> Decision:
        parts: list[list[CellPart]] = [[] for _ in nominal.chain.cells]
        parts[change.cell] = _changes_of(nominal.chain, change, up_to)
        return OrderedBox(nominal, parts).decide()

    decision = decide(size)
    if decision.proved:
        return ProvedChange(change, BoxOutcome.PROVED, size, math.inf, "")
    low, high, refuted = 0.0, size, size if decision.machine is not None else math.inf
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        found = decide(middle)
        low, high = (middle, high) if found.proved else (low, middle)
        refuted = middle if found.machine is not None else refuted
    outcome = BoxOutcome.UNDECIDED if math.isinf(refuted) else BoxOutcome.REFUTED
    return ProvedChange(change, outcome, low, refuted, decision.cause)


def _changes_of(chain: Chain, change: Change, up_to: float) -> list[CellPart]:
    cell = chain.cells[change.cell]
    if change.parameter == "anchor":
        assert isinstance(cell, Cell)
        return displacements(cell, up_to)
    if change.parameter == "friction":
        least = max(0.0, cell.friction - up_to * cell.largest_force)
        return [CellPart("friction", ALL, least, cell.friction + up_to * cell.largest_force)]
    # A factor is above zero.
    return [CellPart(change.parameter, ALL, max(_LEAST, 1.0 - up_to), 1.0 + up_to)]


def prove_design(design: Design, progress: Progress = None) -> ProvedDesign:
    """Prove the cycle of a design, its margin, and its sequence for all machines within tolerances.

    Args:
        design: the result of a search.
        progress: called with (done, total) changes of the margin.

    Source: ours (theory page, "Proofs").
    """
    margin = margin_of(design.chain)
    proof = prove_margin(margin, design.yield_.tolerances, progress)
    own = {one.name: getattr(design, one.name) for one in fields(Design)}
    return ProvedDesign(**own, path_proof=design.cycle.path.prove(), margin_proof=proof)
