"""Segments of a path: what moves between one event and the next."""

from dataclasses import dataclass
from enum import Enum

from stepwell.base import ByValue
from stepwell.statics.events import Cause


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
        released: energy turned into heat by a snap [J].
        tie: whether another outcome was closer than the tolerance.
        cause: why it snapped; None where it did not.
    """

    kind: SegmentKind
    direction: int
    drive: tuple[float, float]
    force: tuple[float, float]
    cells: tuple[int, ...]
    before: tuple[float, ...]
    after: tuple[float, ...]
    released: float
    tie: bool
    cause: Cause | None
