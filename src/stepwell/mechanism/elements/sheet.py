"""A sheet: a stable stretch of an element's curve, on which force is one function of travel."""

from dataclasses import dataclass, field

import numpy as np

from stepwell.base import ByValue, Floats
from stepwell.mechanism.cubics import end_of, monotone


@dataclass(frozen=True, slots=True, eq=False)
class Sheet(ByValue):
    """One stretch of a curve that is stable at a given travel.

    Most elements have one. A curve that folds back in travel has several, and where a sheet ends
    the element jumps, at that travel, to another one.

    Attributes:
        rows: (n, 6) monotone cubic pieces, see `mechanism/cubics`; the last number of each is
            the energy where it begins [J].
        end: travel where the last one ends [m].
        below, above: the sheet on which the element lands from the low end and from the high end;
            None where the whole curve ends.
    """

    rows: Floats
    end: float
    below: int | None = None
    above: int | None = None
    # Force, slope and energy at its high end, which a chain of very many elements asks each for.
    _tail: tuple[float, float, float] = field(init=False, repr=False, compare=False)

    def __post_init__(self):
        object.__setattr__(self, "_tail", end_of(self.rows, self.end))

    @classmethod
    def of(
        cls, rows: Floats, end: float, below: int | None = None, above: int | None = None
    ) -> "Sheet":
        """A sheet of any rows, cut where force and stiffness turn."""
        cut = monotone(rows, end)
        cut.setflags(write=False)
        return cls(cut, float(end), below, above)

    @property
    def begin(self) -> float:
        """Travel where it begins [m]."""
        return float(self.rows[0, 0])

    def scaled(self, force: float, travel: float) -> "Sheet":
        """The same sheet with all forces and all travels times a number."""
        by = force / travel ** np.arange(4)
        rows = self.rows * np.array([travel, *by, force * travel])
        rows.setflags(write=False)
        return Sheet(rows, self.end * travel, self.below, self.above)

    def beyond(self, low: float | None, high: float | None) -> tuple[Floats | None, Floats | None]:
        """A row before its own and one after, on which it goes straight on to these forces [N].

        Returns:
            Two (6,) rows, None at an end where it does not go on. The first begins where the force
            is `low`; the last has no end.
        """
        before = after = None
        if high is not None:
            force, slope, energy = self._tail
            after = np.array([self.end, force, slope, 0.0, 0.0, energy])
        if low is not None:
            x0, force, slope, _, _, begin = self.rows[0].tolist()
            way = (force - low) / slope
            energy = begin - way * (force + low) / 2.0
            before = np.array([x0 - way, low, slope, 0.0, 0.0, energy])
        return before, after

    def extended(self, low: float | None, high: float | None) -> Floats:
        """Its rows, going on straight to these forces [N] at an end; None where it does not."""
        before, after = self.beyond(low, high)
        return np.vstack([rows for rows in (before, self.rows, after) if rows is not None])
