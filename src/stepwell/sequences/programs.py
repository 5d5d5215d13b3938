"""Driving protocols: turning points of the actuator that bring a chain to a target state."""

import math
from collections.abc import Sequence as Drives
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
from pathlib import Path as File

from stepwell import base, mechanism
from stepwell.sequences.branches import windows
from stepwell.sequences.cycles import Sequence, arrival, sequence_of
from stepwell.statics import Configuration, Landing, Path, drive_range


class ProgramMethod(StrEnum):
    """Method that computed a program, and whether a shorter one is excluded."""

    BRANCHES = (
        "search over all reachable branches in the order of the number of turns: no program has "
        "fewer"
    )
    FIELDS = "planned backward from the cells' F0 and F1, and followed by the engine"
    RELAYS = (
        "planned backward from the forces at which the cells leave their phases, and followed by "
        "the engine"
    )
    VERTICES = (
        "planned backward from the cells' F0 and F1, and turned only past states with every cell "
        "at a stop: their order is the same for any mobilities"
    )
    FRICTION = (
        "searched with friction, turning in the middle of every smooth part of every run; each "
        "window was bisected with the other turns fixed, and a shorter program may exist"
    )
    GIVEN = "as it was given"


def turn_schema(unit: str) -> base.Schema:
    """Reported quantities of a turning point; `unit` is that of the drive."""
    return (
        base.Quantity("drive", unit, "at"),
        base.Quantity("low", unit, "from"),
        base.Quantity("high", unit, "to"),
        base.Quantity("branch", head="can go back to", holds=[str]),
    )


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Turn(base.ByValue):
    """A turning point and its tolerance interval.

    Attributes:
        drive: turning point, the middle of the window [m], or [N] under force control.
        low, high: ends of the window: any turn within it has the same result, if the other turns
            are within their own windows.
        branch: states without a cell in transit that the chain can reach from there without a
            snap; empty if the turning points were given.
    """

    drive: float
    low: float
    high: float
    branch: tuple[str, ...]

    @property
    def slack(self) -> float:
        """Largest deviation of the turning point in both directions."""
        return min(self.drive - self.low, self.high - self.drive)


@dataclass(frozen=True, eq=False)
class Program(base.ByValue, base.Drawn):
    """The shortest list of turning points from one state to another.

    Attributes:
        chain: the chain with its actuator.
        start, target: the states, such as "10".
        begin: drive at the start [m], or [N] under force control.
        turns: turning points between start and end; empty if one stroke is enough.
        low, high: interval of the drive in which the last stroke may end at `target`: one stroke
            where a rigid actuator has every cell at a stop.
        method: method that computed it, and the reason why it is the shortest.
        shortest: whether a shorter program is excluded by proof.
        robust: the mobility ratio within which its landings have to hold, relative to the
            mobilities of `chain`; None if not requested.
    """

    chain: mechanism.Chain
    start: str
    target: str
    begin: float
    turns: tuple[Turn, ...]
    low: float
    high: float
    method: ProgramMethod
    shortest: bool
    _start: Configuration = field(repr=False)
    robust: float | None = None

    @classmethod
    def given(
        cls,
        chain: mechanism.Chain,
        turning_points: Drives[float],
        *,
        start: str | None = None,
        target: str | None = None,
    ) -> "Program":
        """A program whose turning points are known, with the window of every turn.

        Args:
            chain: the chain; with friction no turn has a window.
            turning_points: from the beginning to the end [m], or [N] under force control.
            start: the state at the beginning; every cell in its first phase by default.
            target: intended state at the end; the computed one by default.

        Raises:
            ValueError: the chain cannot stand at the start.
            StaticsError: a path cannot be computed; its text contains a possible action.
        """
        start = chain.first_state if start is None else start
        points = tuple(float(point) for point in turning_points)
        path = chain.path(points, start=start)
        intervals = zip(points[1:-1], windows(chain, start, points), strict=True)
        turns = tuple(Turn(point, low, high, ()) for point, (low, high) in intervals)
        target, ends = target or arrival(path), (points[-1], points[-1])
        begin = Configuration(path.start, path.start_sheet)
        given = points[0], turns, *ends, ProgramMethod.GIVEN, False, begin
        return cls(chain, start, target, *given)

    @property
    def end(self) -> float:
        """Drive at which the last stroke ends, the middle of its window [m], or [N]."""
        if not self.turns and self.low <= self.begin <= self.high:
            return self.begin
        return (self.low + self.high) / 2

    @property
    def turning_points(self) -> tuple[float, ...]:
        """All drives for `Chain.path`: begin, every turn, end [m], or [N] under force control."""
        if not self.turns and self.begin == self.end:
            return (self.begin,)
        return (self.begin, *(turn.drive for turn in self.turns), self.end)

    @property
    def strokes(self) -> int:
        """How often the actuator moves, one way each time."""
        return len(self.turning_points) - 1

    @property
    def slack(self) -> float:
        """How far every turn may be off at once; infinite without turns."""
        return min((turn.slack for turn in self.turns), default=float("inf"))

    @cached_property
    def path(self) -> Path:
        """Path of the chain under this program, computed by the engine."""
        return self.chain.path(self.turning_points, start=self._start)

    @cached_property
    def landings(self) -> tuple[Landing, ...]:
        """Robustness of the landing of every snap for all mobilities within the ratio.

        Empty if not requested, or irrelevant: a program that turns only past states with every
        cell at a stop works for any landings of its snaps.
        """
        if self.robust is None or self.method is ProgramMethod.VERTICES:
            return ()
        return self.path.landings(self.robust)

    @property
    def reason(self) -> str:
        """Method that computed it, and the robustness of its landings if requested."""
        if not self.landings:
            return self.method
        if landing := self.mobility_dependent_landing:
            at = base.amount(landing.event.drive, self.chain.drive_unit, 4)
            return f"{self.method}; the snap at {at} {str(landing).rstrip('.')}"
        sampled = [one for one in self.landings if one.proof is None]
        proved = len(self.landings) - len(sampled)
        ways = [f"{proved} proved"] if proved else []
        if sampled:
            most = base.percent_at_most(max(one.bound for one in sampled))
            count = len(sampled)
            ways.append(f"in {count} at most {most} of mobilities lead elsewhere (95 % confidence)")
        hold = f"its landings hold for mobility ratios up to {self.robust:g}"
        return f"{self.method}; {hold}: {', '.join(ways)}"

    @property
    def mobility_dependent_landing(self) -> Landing | None:
        """The first of its landings that depends on the mobilities; None where all hold."""
        return next((one for one in self.landings if not one.holds), None)

    @property
    def meets_target(self) -> bool:
        """Whether it ends in its target for all mobilities."""
        return self.arrives == self.target and self.mobility_dependent_landing is None

    @property
    def arrives(self) -> str:
        """State at the end, such as "010"; - for a cell between its phases."""
        return arrival(self.path)

    @cached_property
    def sequence(self) -> Sequence:
        """Sequence of the states with every cell in a phase."""
        return sequence_of(self.path)

    def to_csv(self, file: str | File) -> None:
        """Write begin, turns and end as CSV, with their windows (mm, or N)."""
        rows = [
            ("begin", self.begin, self.begin, self.begin),
            *((f"turn {k}", t.drive, t.low, t.high) for k, t in enumerate(self.turns, 1)),
            ("end", self.end, self.low, self.high),
        ]
        schema = (
            base.Quantity("what"),
            *turn_schema(base.display_unit(self.chain.drive_unit)[0])[:3],
        )
        base.write_csv(file, zip(schema, zip(*rows, strict=True), strict=True), 9)

    def __str__(self):
        shown_unit, factor = base.display_unit(self.chain.drive_unit)
        unit = base.Quantity("drive", shown_unit).sign
        # A billionth of the stroke is rounding.
        least = 1e-9 * max(map(abs, self.turning_points))
        shown = (0.0 if abs(point) < least else point for point in self.turning_points)
        points = " → ".join(f"{point * factor:.4g}" for point in shown)
        text = f"{self.start} to {self.target}: {points} {unit}"
        if not self.turns:
            return text
        if all(math.isclose(turn.slack, (turn.high - turn.low) / 2) for turn in self.turns):
            return f"{text}, each turn ±{self.slack * factor:.3g} {unit}"
        # Not in the middle: at a stop, for instance, it can deviate in one direction only.
        windows = ", ".join(f"{t.low * factor:.4g}..{t.high * factor:.4g}" for t in self.turns)
        return f"{text}, turns within {windows} {unit}"

    def __repr__(self):
        return f"Program({self})"


def state_after(chain: mechanism.Chain, turn: float) -> str:
    """First state with every cell in a phase that a chain passes on unloading after one turn.

    The chain is loaded from all cells in their first phase to `turn` [m], or [N] under force
    control, and unloaded from there. "" if it passes none.
    """
    low, _ = drive_range(chain)
    loaded = chain.path([low, turn])
    unloading = chain.path([turn, low], start=loaded.end_configuration)
    first = sequence_of(unloading).first
    return "" if "-" in first else first


class Unreachable(base.Shown, base.StepwellError, ValueError):
    """Error for a target state that the actuator cannot reach.

    Attributes:
        proved: True if this is proved; False if only a search was without result.
        chain, start, target, robust: arguments of `Chain.program`; None where not known.
    """

    chain: mechanism.Chain | None = None
    start: str | None = None
    target: str | None = None
    robust: float | None = None

    def __init__(self, text: str, *, proved: bool):
        super().__init__(text)
        self.proved = proved
