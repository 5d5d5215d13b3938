"""How far the drive's spring takes the carriage that all legs share."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats

SAME = 12  # decimals of a stroke [m] that count


class Spring(NamedTuple):
    """The spring of a drive between its command and the carriage."""

    amplitude: float  # of the command [m]
    stiffness: float  # [N/m]
    more: float = 0.0  # force against the carriage besides that of the legs, in either way [N]

    def stops(self, legs: Sequence[tuple[Floats, Floats]], way: int) -> float:
        """The stroke at which the carriage stops as the command ends [m].

        The spring holds the carriage at a stroke u while the command is u + Σ λ / stiffness, with
        the force λ of every leg there. So it goes on until that takes more than the command has.

        Args:
            legs: for each leg (n,) strokes in the order in which they come [m], and the forces
                that push its outermost block out there [N].
            way: +1 out, -1 back.
        """
        along = [_Along.of(stroke, force, way) for stroke, force in legs]
        stroke = np.unique(np.concatenate([one.stroke for one in along]))
        limit = self.amplitude if way > 0 else 0.0

        def beyond(force: Floats) -> Floats:
            """By how much the command would have to go past its end [m]."""
            return stroke - way * limit + (force + self.more) / self.stiffness

        reaches, goes_on = (
            beyond(np.sum([one.at(stroke, column) for one in along], axis=0))
            for column in (_FIRST, _LAST)
        )
        most = beyond(np.sum([one.at(stroke, _MOST) for one in along], axis=0))
        over = np.flatnonzero(most > 10.0**-SAME)
        if not len(over):
            return float(way * stroke[-1])
        j = int(over[0])
        if j == 0 or reaches[j] <= 0.0:
            return float(way * stroke[j])
        a, b = min(goes_on[j - 1], 0.0), reaches[j]
        return float(way * (stroke[j - 1] - (stroke[j] - stroke[j - 1]) * a / (b - a)))


def largest(legs: Sequence[tuple[Floats, Floats]], way: int) -> float:
    """The largest force that all legs together ask of the drive on a way [N], as for `stops`."""
    along = [_Along.of(stroke, force, way) for stroke, force in legs]
    stroke = np.unique(np.concatenate([one.stroke for one in along]))
    return float(np.max(np.sum([one.at(stroke, _MOST) for one in along], axis=0)))


_FIRST, _LAST, _MOST = range(3)


class _Along(NamedTuple):
    """What a leg asks of the drive on its way, which counts as rising."""

    stroke: Floats  # (k,) each once, rising [m]
    force: Floats  # (3, k) as it comes there, as it goes on, and the largest between [N]

    @classmethod
    def of(cls, stroke: Floats, force: Floats, way: int) -> _Along:
        stroke = np.asarray(np.round(np.maximum.accumulate(way * stroke), SAME), float)
        once, first = np.unique(stroke, return_index=True)
        last = np.append(first[1:], len(stroke)) - 1
        rising = way * force
        most = np.maximum.reduceat(rising, first)
        return cls(once, np.stack([rising[first], rising[last], most]))

    def at(self, stroke: Floats, column: int) -> Floats:
        """(m,) one of the forces at strokes (m,) [m]; between its own, on the straight line."""
        after = np.clip(np.searchsorted(self.stroke, stroke), 0, len(self.stroke) - 1)
        before = np.maximum(after - 1, 0)
        width = self.stroke[after] - self.stroke[before]
        part = np.divide(
            stroke - self.stroke[before], width, out=np.ones_like(stroke), where=width > 0.0
        )
        part = np.clip(part, 0.0, 1.0)
        between = (1.0 - part) * self.force[_LAST, before] + part * self.force[_FIRST, after]
        return np.where(part < 1.0, between, self.force[column, after])
