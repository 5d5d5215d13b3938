"""Proofs about all machines within tolerances, and within the margin of one parameter."""

import math
from dataclasses import dataclass, field
from enum import StrEnum

from stepwell.base import ByValue, InputError, Progress, counted, percent, tracked
from stepwell.design import Change, Draws, Margin, Tolerances
from stepwell.mechanism import Cell, Chain
from stepwell.proof.cell_boxes import ALL, Part, displacements, parts_within
from stepwell.proof.order_boxes import Decision, OrderedBox, becomes
from stepwell.sequences import Cycle, cycle

# Part of a margin up to which its proof is attempted: at the margin itself two cells tie.
UP_TO = 1.0 - 1e-5
# A change that no search found is looked at between these factors of a number.
_LEAST, _MOST = 1e-6, 8.0
# Halvings of a change that is not proved as a whole.
_HALVINGS = 6
# Samples that the engine follows in search of a counterexample.
_SAMPLES = 100


class Outcome(StrEnum):
    """What is proved of all machines of a box."""

    PROVED = "proved"
    REFUTED = "refuted"
    UNDECIDED = "not decided"


@dataclass(frozen=True, eq=False)
class ToleranceProof(ByValue):
    """What is proved of all machines within tolerances.

    They are all that `Draws` can sample: anchors p and q anywhere in their discs, levers and
    friction within their bounds, other numbers within four standard deviations.

    Attributes:
        chain: the nominal design.
        tolerances: of its parts.
        sequence: the sequence in question, that of the nominal design.
        outcome: proved for every machine, refuted by one, or not decided.
        cause: what is not decided, or the two cells that change places.
        counterexample: a machine within the tolerances with another sequence, as simulated.
        becomes: its sequence.
        parameters: number of the numbers that vary at once.
        undecided: fraction of the box that is not decided, by volume; 0 if all is proved.

    Assumes: as for `PathProof`; masses and dimensions without a tolerance are nominal.
    """

    chain: Chain = field(repr=False)
    tolerances: Tolerances
    sequence: str
    outcome: Outcome
    cause: str
    counterexample: Chain | None = field(repr=False)
    becomes: str
    parameters: int
    undecided: float

    @property
    def proved(self) -> bool:
        """Whether every machine within the tolerances has the sequence."""
        return self.outcome is Outcome.PROVED

    def __str__(self):
        if self.proved:
            numbers = counted(self.parameters, "number")
            return f"proved for every machine within the tolerances ({numbers} at once)"
        if self.counterexample is not None:
            return f"refuted: {self.cause}; a machine within the tolerances gives {self.becomes}"
        return f"not decided in {percent(self.undecided)} of the box: {self.cause}"

    def __repr__(self):
        return f"ToleranceProof({self})"


@dataclass(frozen=True, eq=False)
class ProvedChange(ByValue):
    """What is proved of a change of one parameter.

    Attributes:
        change: the smallest change that alters the sequence, as computed.
        outcome: proved that every smaller change keeps the sequence, refuted by a smaller one that
            does not, or not decided.
        up_to: the sequence is proved for every change up to this one: displacement [m] in any
            direction, or fraction of the number either way; 0 if nothing is proved.
        refuted_from: size of a change with another sequence, as simulated; infinite without one.
        cause: what is not decided, or the two cells that change places; "" if all is proved.
    """

    change: Change
    outcome: Outcome
    up_to: float
    refuted_from: float
    cause: str

    @property
    def proved(self) -> bool:
        """Whether every change smaller than the smallest one is proved to keep the sequence."""
        return self.outcome is Outcome.PROVED


@dataclass(frozen=True, eq=False)
class MarginProof(ByValue):
    """What is proved of a margin.

    Attributes:
        margin: the margin.
        changes: each of its changes, and up to which size the sequence is proved to stay.
    """

    margin: Margin = field(repr=False)
    changes: tuple[ProvedChange, ...]

    @property
    def proved(self) -> bool:
        """Whether the proof covers every change up to the smallest that alters the sequence."""
        return all(change.proved for change in self.changes)

    def __str__(self):
        done = sum(change.proved for change in self.changes)
        words = [f"{done} of {counted(len(self.changes), 'margin')} proved"]
        for outcome in (Outcome.REFUTED, Outcome.UNDECIDED):
            causes = dict.fromkeys(one.cause for one in self.changes if one.outcome is outcome)
            words += [f"{outcome}: {', '.join(causes)}"] * bool(causes)
        return "; ".join(words)

    def __repr__(self):
        return f"MarginProof({self})"


def prove_tolerances(
    chain: Chain, tolerances: Tolerances, progress: Progress = None
) -> ToleranceProof:
    """Prove that every machine within tolerances has the sequence of the nominal design.

    Or return a machine that has not, or the fraction of the box that is not decided.

    Args:
        chain: the nominal design.
        tolerances: of its parts.
        progress: called with (done, total) steps.

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
    parts = [parts_within(cell, tolerances) for cell in chain.cells]
    decision = OrderedBox(nominal, parts).decide()
    if not decision.proved and decision.machine is None:
        decision = _sampled(nominal, tolerances, decision, progress)
    refuted = decision.machine is not None
    outcome = Outcome.PROVED if decision.proved else Outcome.UNDECIDED
    return ToleranceProof(
        chain,
        tolerances,
        str(nominal.sequence),
        Outcome.REFUTED if refuted else outcome,
        decision.cause,
        decision.machine,
        decision.becomes,
        sum(len(own) for own in parts),
        float(not decision.proved),
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
            return decision._replace(machine=machine, becomes=other)
    return decision


def prove_margin(margin: Margin, progress: Progress = None) -> MarginProof:
    """Prove that no change of one parameter below the margin alters the sequence.

    The proof goes up to 99.999 % of each change: there, two cells tie. A change that is infinite
    is covered up to the reach of the margin, or up to a factor of 8.

    Args:
        margin: of a chain.
        progress: called with (done, total) changes.

    Source: ours (theory page, "Proofs within tolerances").
    """
    nominal = cycle(margin.chain)
    changes = [_proved_change(nominal, margin, one) for one in tracked(margin.changes, progress)]
    return MarginProof(margin, tuple(changes))


def _proved_change(nominal: Cycle, margin: Margin, change: Change) -> ProvedChange:
    anchor = change.parameter == "anchor"
    most = margin.reach if anchor else _MOST - 1.0
    size = UP_TO * change.distance if math.isfinite(change.distance) else most

    def decide(up_to: float) -> Decision:
        parts: list[list[Part]] = [[] for _ in nominal.chain.cells]
        parts[change.cell] = _changes_of(nominal.chain, change, up_to)
        return OrderedBox(nominal, parts).decide()

    decision = decide(size)
    if decision.proved:
        return ProvedChange(change, Outcome.PROVED, size, math.inf, "")
    low, high, refuted = 0.0, size, size if decision.machine is not None else math.inf
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        found = decide(middle)
        low, high = (middle, high) if found.proved else (low, middle)
        refuted = middle if found.machine is not None else refuted
    outcome = Outcome.UNDECIDED if math.isinf(refuted) else Outcome.REFUTED
    return ProvedChange(change, outcome, low, refuted, decision.cause)


def _changes_of(chain: Chain, change: Change, up_to: float) -> list[Part]:
    cell = chain.cells[change.cell]
    if change.parameter == "anchor":
        assert isinstance(cell, Cell)
        return displacements(cell, up_to)
    if change.parameter == "friction":
        least = max(0.0, cell.friction - up_to * cell.largest_force)
        return [Part("friction", ALL, least, cell.friction + up_to * cell.largest_force)]
    # A factor is above zero.
    return [Part(change.parameter, ALL, max(_LEAST, 1.0 - up_to), 1.0 + up_to)]
