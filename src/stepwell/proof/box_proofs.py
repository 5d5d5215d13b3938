"""What is proved of all machines of a box: within tolerances, or within the margin of a number."""

from dataclasses import dataclass, field
from enum import StrEnum

from stepwell.base import ByValue, counted, percent
from stepwell.design import Change, Design, Impossible, Margin, Tolerances
from stepwell.mechanism import Chain
from stepwell.proof.path_proof import PathProof


class BoxOutcome(StrEnum):
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
        boxes: number of boxes that were looked at.
        undecided: fraction of the box that is not decided, by volume; None if it is refuted.

    Assumes: as for `PathProof`; masses and dimensions without a tolerance are nominal.
    """

    chain: Chain = field(repr=False)
    tolerances: Tolerances
    sequence: str
    outcome: BoxOutcome
    cause: str
    counterexample: Chain | None = field(repr=False)
    becomes: str
    parameters: int
    boxes: int
    undecided: float | None

    @property
    def proved(self) -> bool:
        """Whether every machine within the tolerances has the sequence."""
        return self.outcome is BoxOutcome.PROVED

    def __str__(self):
        if self.proved:
            numbers = counted(self.parameters, "number")
            boxes = f", {self.boxes} boxes" * (self.boxes > 1)
            return f"proved for every machine within the tolerances ({numbers} at once{boxes})"
        if self.counterexample is not None:
            return f"refuted: {self.cause}; a machine within the tolerances gives {self.becomes}"
        share = percent(self.undecided or 0.0)
        after = f" after {self.boxes} boxes" * (self.boxes > 1)
        return f"not decided in {share} of the box{after}: {self.cause}"

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
    outcome: BoxOutcome
    up_to: float
    refuted_from: float
    cause: str

    @property
    def proved(self) -> bool:
        """Whether every change smaller than the smallest one is proved to keep the sequence."""
        return self.outcome is BoxOutcome.PROVED


@dataclass(frozen=True, eq=False)
class MarginProof(ByValue):
    """What is proved of a margin.

    Attributes:
        margin: the margin.
        changes: each of its changes, and up to which size the sequence is proved to stay.
        within: what is proved of all machines within tolerances; None unless they were given.
    """

    margin: Margin = field(repr=False)
    changes: tuple[ProvedChange, ...]
    within: ToleranceProof | None = None

    @property
    def chain(self) -> Chain:
        """The nominal design."""
        return self.margin.chain

    @property
    def proved(self) -> bool:
        """Whether the proof covers every change up to the smallest that alters the sequence."""
        return all(change.proved for change in self.changes)

    def __str__(self):
        done = sum(change.proved for change in self.changes)
        words = [f"{done} of {counted(len(self.changes), 'margin')} proved"]
        for outcome in (BoxOutcome.REFUTED, BoxOutcome.UNDECIDED):
            causes = dict.fromkeys(one.cause for one in self.changes if one.outcome is outcome)
            words += [f"{outcome}: {', '.join(causes)}"] * bool(causes)
        return "; ".join(words)

    def __repr__(self):
        return f"MarginProof({self})"


@dataclass(frozen=True, eq=False)
class ProvedDesign(Design):
    """A design with what is proved of it.

    Attributes:
        path_proof: the proof of its cycle.
        margin_proof: of its margin, and of all machines within its tolerances.
    """

    path_proof: PathProof = field(repr=False)
    margin_proof: MarginProof = field(repr=False)


class ProvedImpossible(Impossible):
    """A refusal with what is proved of it.

    Attributes:
        outcome: proved, or not decided; all else is that of the refusal.
        covers: the set of parameters that the proof covers.
        theorem: what it uses, and how many choices were excluded.
        cause: what is not decided; "" if all is proved.
    """

    def __init__(self, why: Impossible, outcome: BoxOutcome, covers: str, theorem: str, cause: str):
        self.__dict__.update(vars(why))
        self.args = why.args
        self.outcome, self.covers, self.theorem, self.cause = outcome, covers, theorem, cause

    @property
    def proof(self) -> str:
        """What is proved, in a sentence."""
        if self.outcome is BoxOutcome.PROVED:
            return f"proved for {self.covers}: {self.theorem}"
        return f"not decided: {self.cause}"
