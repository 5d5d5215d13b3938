"""Proving boxes of machines: all within tolerances, or all within the margin of one number."""

import math
from dataclasses import fields

from stepwell.base import InputError, Progress, tracked
from stepwell.design import Change, Design, Draws, Margin, Tolerances, margin as margin_of
from stepwell.mechanism import Cell, Chain
from stepwell.proof.box_proofs import (
    BoxOutcome,
    MarginProof,
    ProvedChange,
    ProvedDesign,
    ToleranceProof,
)
from stepwell.proof.cell_boxes import ALL, CellPart, displacements, parts_within
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


def prove_tolerances(
    chain: Chain, tolerances: Tolerances, target: str | None = None, progress: Progress = None
) -> ToleranceProof:
    """Prove that every machine within tolerances has the sequence of the nominal design.

    Or return a machine that has not, or the fraction of the box that is not decided.

    Args:
        chain: the nominal design.
        tolerances: of its parts.
        target: the sequence in question; by default that of the nominal design.
        progress: called with (done, total) samples, where no theorem decides.

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
    parts = [parts_within(cell, tolerances) for cell in chain.cells]
    decision = Decision(False, "the nominal design itself", chain, str(nominal.sequence))
    if str(nominal.sequence) == sequence:
        decision = OrderedBox(nominal, parts).decide()
    if not decision.proved and decision.machine is None:
        decision = _sampled(nominal, tolerances, decision, progress)
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
        None if refuted else float(not decision.proved),
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
