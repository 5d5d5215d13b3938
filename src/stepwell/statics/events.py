"""Segments of a path, on which the same cells move, and the events between them."""

import math
from dataclasses import dataclass
from enum import Enum

from stepwell.base import ByValue, Measure, brief, number, told_in


class EventKind(Enum):
    """What happened."""

    SWITCH = "a cell arrives at a stop, or in another phase"
    SNAP = "the chain jumps at a fixed drive"


class Cause(Enum):
    """Why it happened."""

    STOP = "the blocks of a cell touch"
    FOLD = "the local minimum merges with a saddle and is gone"
    RELEASE = "a held cell lets go and the others cannot carry what it gives"
    TURN = "the curve of an element rises again"
    END = "the curve of an element folds back"


class Decided(Enum):
    """How the landing of a snap was found."""

    LINE = "along the line on which one cell or one pair moves"
    EQUATION = "by one equation: no other cell leaves its branch"
    FLOW = "by integrated flow"


@dataclass(frozen=True, slots=True, eq=False)
class Event(ByValue):
    """One switch or snap.

    Attributes:
        kind, cause: what happened and why.
        drive: actuator position [m], or its force [N] under force control.
        stroke: u = Σ s_i just before [m].
        direction: +1 while loading, -1 while unloading.
        cells: the cells that moved, for a snap also the one that set it off and came back; for a
            switch the one that arrived.
        before, after: their travels [m].
        sheets_before, sheets_after: on which sheets of their curves.
        force_before, force_after: actuator force λ [N].
        released: energy turned into heat by the jump [J], without what friction took.
        arrivals: (cell, phase) for every cell that arrived in another phase; a stop is one.
        tie: whether another outcome was closer than the tolerance.
        measure: what travel and force are.
        distance_force: of a snap, the least force on the way or after it that makes the difference
            to another landing [N]; inf where no other was near, and for a switch.
        distance_travel: the same over the stiffness of the cells there [m].
        error: by how much an integrated landing may be off [m]; 0 where no time was integrated.
        decided: how the landing of a snap was found; None for a switch.
    """

    kind: EventKind
    cause: Cause
    drive: float
    stroke: float
    direction: int
    cells: tuple[int, ...]
    before: tuple[float, ...]
    after: tuple[float, ...]
    sheets_before: tuple[int, ...]
    sheets_after: tuple[int, ...]
    force_before: float
    force_after: float
    released: float
    arrivals: tuple[tuple[int, int], ...]
    tie: bool
    measure: Measure
    distance_force: float = math.inf
    distance_travel: float = math.inf
    error: float = 0.0
    decided: Decided | None = None

    def __repr__(self):
        unit, factor = told_in(self.measure.travel_unit)
        moves = ", ".join(
            f"cell {c + 1} {a * factor:.4g}→{b * factor:.4g} {unit}"
            for c, a, b in zip(self.cells, self.before, self.after, strict=True)
        )
        what = f", releases {self.released * 1e3:.4g} mJ" if self.kind is EventKind.SNAP else ""
        way = "loading" if self.direction > 0 else "unloading"
        return f"{self.kind.name} at {number(self.stroke * factor)} {unit} {way}: {moves}{what}"


@dataclass(frozen=True, slots=True, eq=False)
class Tie(ByValue):
    """A place where the model cannot say what happens: two outcomes closer than the tolerance.

    Attributes:
        drive: where [m], or [N] under force control.
        cells: the cells that tie, or the one whose landing does.
        advice: what the user can do about it.
    """

    drive: float
    cells: tuple[int, ...]
    advice: str

    def __str__(self):
        return self.advice

    def __repr__(self):
        return brief(self)


class SegmentKind(Enum):
    """What a chain does on a segment of its path."""

    HOLD = "nothing moves while the force changes"
    MOVE = "cells move smoothly; turning back undoes it where there is no friction"
    SNAP = "the chain jumps at a fixed drive"


@dataclass(frozen=True, slots=True, eq=False)
class Segment(ByValue):
    """One part of a path, the same cells moving all along it.

    Attributes:
        kind: what happens.
        direction: +1 while the drive rises, -1 while it falls.
        drive: (2,) actuator position [m] at both ends, or its force [N] under force control.
        force: (2,) actuator force λ at both ends [N].
        cells: (m,) the cells that move.
        before, after: (m,) their travels [m].
        sheets_before, sheets_after: (m,) on which sheets of their curves.
        released: energy turned into heat by a snap [J].
        tie: whether another outcome was closer than the tolerance.
        cause: why it snapped; None where it did not.
        distance_force, distance_travel, error, decided: of a snap, as for `Event`.
    """

    kind: SegmentKind
    direction: int
    drive: tuple[float, float]
    force: tuple[float, float]
    cells: tuple[int, ...]
    before: tuple[float, ...]
    after: tuple[float, ...]
    sheets_before: tuple[int, ...]
    sheets_after: tuple[int, ...]
    released: float
    tie: bool
    cause: Cause | None
    distance_force: float = math.inf
    distance_travel: float = math.inf
    error: float = 0.0
    decided: Decided | None = None

    def __repr__(self):
        return brief(self)
