"""Proof of a path: each answer of the engine with a proved bound of its error, and all gaps."""

from dataclasses import dataclass, field
from enum import Enum
from functools import cached_property
from pathlib import Path as File

from stepwell.base import ByValue, counted, display_unit, number, write_atomic
from stepwell.design import Run
from stepwell.statics import Event, Path


class Theorem(Enum):
    """How the landing of a snap is proved (theory page, "Proofs")."""

    LINE = "one cell, or one pair of cells, moves along a line"
    RISING = "one cell falls, and all others that move are on rising branches"
    RACE = "one cell falls to its stop, and of all others that yield the first stays ahead"
    FLOW = "the overdamped flow is enclosed step by step"


@dataclass(frozen=True, slots=True, eq=False)
class ProvedEvent(ByValue):
    """One event of a path with proved bounds of the errors of its numbers.

    The model has exactly one such event in the box of these bounds around the numbers of `event`.

    Attributes:
        number: of the event in the path, from 0.
        event: the engine's answer.
        theorem: how its landing is proved; None for a switch.
        drive_error: bound of the error of its drive [m], or [N] under force control.
        stroke_error: of its stroke [m].
        travel_error: of the largest error of the travels after it [m].
        force_error: of the forces before and after [N]; None where the model leaves both open.
        released_error: of the released energy [J]; None for a switch, or with friction.
    """

    number: int
    event: Event
    theorem: Theorem | None
    drive_error: float
    stroke_error: float
    travel_error: float
    force_error: float | None
    released_error: float | None


@dataclass(frozen=True, slots=True, eq=False)
class ProofGap(ByValue):
    """A part of a path that is not proved.

    Attributes:
        number: of the event that is not proved, from 0; None for the end of a stroke.
        drive: where the part ends [m], or [N] under force control.
        direction: +1 while loading, -1 while unloading.
        cause: what is not decided.
        size: by how much [N], if it has a size.
        contradicted: whether the proof gives another answer than the engine.
    """

    number: int | None
    drive: float
    direction: int
    cause: str
    size: float | None = None
    contradicted: bool = False


@dataclass(frozen=True, eq=False)
class PathProof(ByValue):
    """What is proved of a path.

    Between two proved events the branch continues, is stable, and no event is missed. After a gap
    the proof begins again at the next event, from the engine's answer within 1e-9.

    Attributes:
        path: the path.
        events: what is proved, in order.
        gaps: what is not, in order; empty if the whole path is proved.
        stretches: number of smooth stretches that are covered.
        mobility_ratio: largest ratio of factors of the mobilities for which landings are proved.

    Assumes: the model with the engine's numbers, doubles, taken as exact: levers, sines of limits,
    anchors' differences, stiffnesses, cubics of tables (theory page, "Proofs").
    """

    path: Path
    events: tuple[ProvedEvent, ...]
    gaps: tuple[ProofGap, ...]
    stretches: int
    mobility_ratio: float

    @property
    def proved(self) -> bool:
        """Whether the whole path is proved."""
        return not self.gaps

    @cached_property
    def outcome(self) -> str:
        """The answer in a line: proved, or proved except each gap."""
        if self.proved:
            return "proved"
        unit, factor = display_unit(self.path.chain.drive_unit)
        where = [f"{number(gap.drive * factor)} {unit}: {gap.cause}" for gap in self.gaps[:3]]
        more = len(self.gaps) - 3
        rest = f"; and {counted(more, 'more gap')}" if more > 0 else ""
        return f"proved except at {'; at '.join(where)}{rest}"

    @property
    def worst_error(self) -> float:
        """The largest bound of an error of a travel or stroke [m]; 0 without events."""
        errors = [max(e.stroke_error, e.travel_error) for e in self.events]
        return max(errors, default=0.0)

    def write_certificate(self, file: str | File) -> None:
        """Write the certificate of this proof as JSON; all else as for `proof.certificate`."""
        from stepwell.proof.certificates import certificate

        write_atomic(file, certificate(self))

    def __repr__(self):
        return f"PathProof({self.outcome}: {counted(len(self.events), 'event')})"


@dataclass(frozen=True, eq=False)
class ProvedRun(Run):
    """A full cycle of a design with its margin, and what is proved of the cycle.

    Attributes:
        proof: the proof of the cycle's path.
    """

    proof: PathProof = field(repr=False)

    @classmethod
    def proved(cls, run: Run, proof: PathProof) -> "ProvedRun":
        """A run with the proof of its path."""
        return cls(run.cycle, run.margin, run.landings, proof)
