"""An element as a symbol: a box with its force curve in it, and a mark where it stands on it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from stepwell.base import Floats, bisected
from stepwell.mechanism import Element, Phase

_SAMPLES = 97
# Between the curve and the box, as a share of the box.
_EDGE = 0.14


class Symbol:
    """The force curve of an element in a square of side 1, travel to the right, force upwards.

    Args:
        element: any.
        reached: (n,) travels [m] that are shown too, where they lie past an open end.

    Attributes:
        low: least travel that is shown [m].
        curves: (m, 2) each sheet.
        zero: height of the line of no force; NaN where that is outside.
    """

    def __init__(self, element: Element, reached: Sequence[float] | Floats = ()):
        self.element = element
        ends = [element.low, element.high, *(float(s) for s in reached)]
        self.low, high = min(ends), max(ends)
        samples: list[tuple[Floats, Floats]] = []
        for number, sheet in enumerate(element.laws):
            first = self.low if sheet.below is None and sheet.begin == element.low else sheet.begin
            last = high if sheet.above is None and sheet.end == element.high else sheet.end
            travel = np.linspace(first, last, _SAMPLES)
            samples.append((travel, element.force_at(travel, number)))
        # What lies past the ends of the curve does not set the scale.
        inside = [f[(s >= element.low) & (s <= element.high)] for s, f in samples]
        least, most = min(f.min() for f in inside), max(f.max() for f in inside)
        self._origin = np.array([self.low, least])
        self._size = np.array([high - self.low, (most - least) or 1.0])
        self.curves = [self._inside(np.column_stack(curve)) for curve in samples]
        zero = float(self._inside(np.array([self.low, 0.0]))[1])
        self.zero = zero if 0.0 < zero < 1.0 else math.nan

    def at(self, travel: float, sheet: int | None = None) -> Floats:
        """(2,) where the element stands: on this sheet, else on the first that has the travel.

        Raises:
            ValueError: a travel past a stop.
        """
        laws, within = self.element.laws, min(max(travel, self.element.low), self.element.high)
        holds = [k for k, one in enumerate(laws) if one.begin <= within <= one.end]
        if sheet not in holds:
            sheet = holds[0]
        return self._inside(np.array([travel, float(self.element.force_at(travel, sheet))]))

    def _inside(self, points: Floats) -> Floats:
        share = np.clip((points - self._origin) / self._size, -_EDGE, 1.0 + _EDGE)
        return _EDGE + (1.0 - 2.0 * _EDGE) * share


def rest_of(element: Element, phase: Phase) -> float:
    """Where an element stands in a phase without force, or with the least there is [m]."""
    if phase.force_high < 0.0:
        return phase.high
    if phase.force_low > 0.0:
        return phase.low

    def force(travel: float) -> float:
        return float(element.force_at(travel, phase.sheet))

    low, high = max(phase.low, element.low), min(phase.high, element.high)
    for end, limit, way in ((low, phase.low, -1.0), (high, phase.high, 1.0)):
        if way * force(end) < 0.0:
            if math.isfinite(limit):
                return end
            # Past an open end the curve goes on straight.
            further = way * element.full_travel
            return end - force(end) * further / (force(end + further) - force(end))
    return bisected(lambda travel: force(travel) <= 0.0, low, high, 60)[0]
