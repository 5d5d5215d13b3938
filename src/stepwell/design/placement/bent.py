"""Cells of one band whose law is no straight line: what anchors give, by looking."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from stepwell.base import Bools, Floats
from stepwell.mechanism import Band, band_force, band_length, length_slope

# Places over the travel at which the force is looked at, and steps of the derivatives [1].
LOOKS = 129
_NUDGE = 1e-6


@dataclass(frozen=True, eq=False)
class Bent:
    """A band on a lever, whose anchors are not looked at.

    Attributes:
        band: with any law.
        lever, sin_limit: of the cell [m], [1].
    """

    band: Band
    lever: float
    sin_limit: float

    def ends(self, d: Floats) -> tuple[Floats, Floats]:
        """F0 and F1 (m, 2) [N] at differences d (m, 2) [m], and their slopes (m, 2, 2) [N/m]."""
        step = _NUDGE * self.lever
        moves = step * np.eye(2)
        slopes = [(self._forces(d + move) - self._forces(d - move)) / (2 * step) for move in moves]
        return self._forces(d), np.stack(slopes, axis=2)

    def falls(self, d: Floats) -> Bools:
        """At which of (m, 2) differences [m] the band is taut and its force falls, (m,)."""
        sine = np.linspace(-self.sin_limit, self.sin_limit, LOOKS)
        force, length = self._at(sine, d)
        taut = np.all(length > self.band.rest_length, axis=1)
        return taut & np.all(np.diff(force, axis=1) < 0.0, axis=1)

    def by_sizes(self, d: Floats) -> tuple[Floats, Floats]:
        """∂F/∂ℓ0 and ∂F/∂r [N/m] of F0 and F1, (m, 2) each."""
        step = _NUDGE * self.lever
        rest = self.band.rest_length
        longer, shorter = (
            replace(self, band=replace(self.band, rest_length=one))._forces(d)
            for one in (rest + step, max(rest - step, 0.0))
        )
        wide, narrow = (replace(self, lever=self.lever + one)._forces(d) for one in (step, -step))
        return (longer - shorter) / (step + min(step, rest)), (wide - narrow) / (2 * step)

    def _forces(self, d: Floats) -> Floats:
        return self._at(np.array([-self.sin_limit, self.sin_limit]), d)[0]

    def _at(self, sine: Floats, d: Floats) -> tuple[Floats, Floats]:
        """Force [N] and length [m], (m, k) each, at k sines of the angle."""
        cosine = np.sqrt(1.0 - sine**2)
        dx, dy = d[:, :1], d[:, 1:]
        length = band_length(sine, cosine, dx, dy, self.lever)
        first = length_slope(sine, cosine, length, dx, dy)
        return np.asarray(band_force(self.band.tension(length), first)), length
