"""What a build was seen to do, and how well a model agrees with it."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np

from stepwell.base import ByValue, Floats, InputError, brief
from stepwell.lab.recordings import LabError, Recording, from_zero
from stepwell.sequences import Cycle

# Forces of a recording that are compared, each way; more of them are no more independent.
_PLACES = 12
# Of the stroke, what a recording must reach over to be one of this design.
_REACH = 0.5


class Pull(NamedTuple):
    """The force of the actuator at a stroke.

    Attributes:
        direction: +1 while loading, -1 while unloading.
        stroke: from state 0 of all cells on [m].
        force: [N], positive where the actuator pulls.
    """

    direction: int
    stroke: float
    force: float


@dataclass(frozen=True, eq=False)
class Observed(ByValue):
    """What a build did when it was pulled out and let back once.

    Args:
        sequence: the states it went through, such as "00>10>11>01>00"; None where nobody looked.
        out, back: strokes at which it snapped while it was pulled out and let back [m]; None where
            nobody looked, empty where it did not snap.
        pulls: forces that were read on the way.
        ruler: standard deviation of a stroke [m].
        scale: standard deviation of a force [N].

    Raises:
        ValueError: nothing was seen, or a doubt that is not above zero.
    """

    sequence: str | None = None
    out: tuple[float, ...] | None = None
    back: tuple[float, ...] | None = None
    pulls: tuple[Pull, ...] = ()
    ruler: float = 1e-3
    scale: float = 0.02

    def __post_init__(self):
        if self.sequence is None and self.out is None and self.back is None and not self.pulls:
            raise InputError(
                "nothing was seen: give the states, strokes of snaps, or forces on the way."
            )
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name in ("ruler", "scale") and not 0 < value < math.inf:
                raise InputError(f"{field.name} = {value}: must be > 0, as doubts are.")

    @property
    def numbers(self) -> int:
        """How many strokes and forces were read."""
        return len(self.out or ()) + len(self.back or ()) + len(self.pulls)

    def misfit(self, cycle: Cycle) -> float:
        """Half the sum of squared errors in standard deviations; infinite where it did otherwise.

        A snap too many or too few is another motion, and so is a tie, which may end either way.
        """
        if self.sequence is not None and str(cycle.sequence) != self.sequence:
            return math.inf
        total = 0.0
        for direction, wanted in ((1, self.out), (-1, self.back)):
            if wanted is None:
                continue
            found = sorted(e.drive for e in cycle.snaps if e.direction == direction)
            if len(found) != len(wanted):
                return math.inf
            gaps = np.subtract(found, sorted(wanted)) / self.ruler
            total += 0.5 * float(gaps @ gaps)
        if self.pulls:
            gaps = (_forces(cycle, self.pulls) - [pull.force for pull in self.pulls]) / self.scale
            total += 0.5 * float(gaps @ gaps)
        return total

    def __repr__(self):
        return brief(self)


def _forces(cycle: Cycle, pulls: tuple[Pull, ...]) -> Floats:
    """Forces of the model [N] where some were read."""
    stroke, force = cycle.path.stroke, cycle.path.force
    top = int(np.argmax(stroke))
    ways = {
        1: (stroke[: top + 1], force[: top + 1]),
        -1: (stroke[top:][::-1], force[top:][::-1]),
    }
    return np.array([np.interp(pull.stroke, *ways[pull.direction]) for pull in pulls])


def pulls_of(recording: Recording, full: float) -> tuple[Pull, ...]:
    """Forces at even strokes of a recording, each the mean of what lies about it.

    Args:
        recording: pulled out, let back, or both.
        full: stroke with every cell at state 1 [m].

    Raises:
        LabError: it does not reach over half of that stroke, or over more than half as much again.
    """
    stroke = from_zero(recording, full)
    reached = float(np.ptp(stroke))
    if not _REACH * full <= reached <= (1.0 + _REACH) * full:
        raise LabError(
            recording.source,
            f"its stroke is {reached * 1e3:.4g} mm and that of the design {full * 1e3:.4g} mm: "
            f"check the unit in the header, and that this design was tested.",
        )
    edges = np.linspace(0.0, full, _PLACES + 1)
    found: list[Pull] = []
    for half in recording.halves:
        direction = 1 if recording.direction_of(half) == "loading" else -1
        place = np.digitize(stroke[half], edges) - 1
        for k in range(_PLACES):
            here = place == k
            if np.any(here):
                u, force = stroke[half][here], recording.force[half][here]
                found.append(Pull(direction, float(np.mean(u)), float(np.mean(force))))
    return tuple(found)
