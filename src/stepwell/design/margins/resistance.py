"""What has to push an anchor along: the pull of its bands against a displacement."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stepwell.base import ByValue, Floats, Vec2
from stepwell.mechanism import Band, Cell, band_direction, band_length

_ANGLES = 1025  # looked at over the travel; the largest force is right to 1e-6 of itself
_POSITIONS = 41


@dataclass(frozen=True, eq=False)
class Resistance(ByValue):
    """The force against which an anchor moves in a straight line, by bands that pull at it.

    A band of tension T pulls p towards q and q towards p; what counts is the part of that along
    the displacement, positive where it resists and negative where it helps. Without weight,
    friction or inertia of what pushes.

    Attributes:
        fraction: (m,) part of the displacement gone, 0 to 1.
        force_0, force_1: (m,) at state 0 and at state 1 of the cell [N].
        peak: (m,) the largest over the cell's travel [N].
        work_0, work_1: what the whole displacement takes at state 0 and at state 1 [J].
    """

    fraction: Floats
    force_0: Floats
    force_1: Floats
    peak: Floats
    work_0: float
    work_1: float

    @classmethod
    def of(cls, cell: Cell, anchor: str, displacement: Vec2) -> Resistance:
        """Moving the anchors "p" or "q" of all bands of a cell by `displacement` (x, y) [m]."""
        fraction = np.linspace(0.0, 1.0, _POSITIONS)
        theta = np.linspace(-cell.limit, cell.limit, _ANGLES)
        force = np.zeros((_POSITIONS, _ANGLES))
        work = np.zeros(2)
        # Moving p is moving d = q - p the other way.
        change = (1 if anchor == "q" else -1) * np.array(displacement)
        for band in cell.bands:
            force += _against(band, cell.lever, theta, fraction, change)
            ends = (_lengths(band, cell.lever, theta[[0, -1]], part * change) for part in (0, 1))
            before, after = (band.energy(length) for length in ends)
            work += after - before
        return cls(
            fraction,
            force[:, 0],
            force[:, -1],
            np.max(force, axis=1),
            float(work[0]),
            float(work[1]),
        )

    @classmethod
    def nowhere(cls) -> Resistance:
        """No way at all."""
        none = np.empty(0)
        return cls(none, none, none, none, float("nan"), float("nan"))

    @property
    def largest(self) -> float:
        """Largest force [N] at any place on the way and any travel; NaN where there is no way."""
        return float(np.max(self.peak)) if len(self.peak) else float("nan")

    def __str__(self):
        if not len(self.peak):
            return "no way"
        work = f"work {self.work_0 * 1e3:.4g} mJ at state 0, {self.work_1 * 1e3:.4g} mJ at state 1"
        if self.largest > 0:
            return f"push with up to {self.largest:.4g} N; {work}"
        return f"the band itself pulls it there; {work}"

    def __repr__(self):
        return f"Resistance({self})"


def _lengths(band: Band, lever: float, theta: Floats, change: Floats) -> Floats:
    dx, dy = np.array(band.d) + change
    return band_length(np.sin(theta), np.cos(theta), dx, dy, lever)


def _against(band: Band, lever: float, theta: Floats, fraction: Floats, change: Floats) -> Floats:
    """(m, angles) dE/dx [N], x the way gone along `change` (2,) in d."""
    away = np.linalg.norm(change)
    if away == 0:
        return np.zeros((len(fraction), len(theta)))
    sin, cos = np.sin(theta), np.cos(theta)
    dx, dy = np.array(band.d)[:, None, None] + change[:, None, None] * fraction[:, None]
    length = band_length(sin, cos, dx, dy, lever)
    x, y = band_direction(sin, cos, length, dx, dy, lever)
    return band.tension(length) * (x * change[0] + y * change[1]) / away
