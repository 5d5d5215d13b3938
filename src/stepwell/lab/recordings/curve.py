"""Repeats of one test brought onto common strokes and averaged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from stepwell.base import ByValue, Floats
from stepwell.lab.recordings.recording import Recording
from stepwell.lab.recordings.spikes import without_spikes

STEP = 0.05e-3  # [m] between the strokes of a mean curve


@dataclass(frozen=True, eq=False)
class Curve(ByValue):
    """Force against stroke, the mean of some runs.

    Attributes:
        stroke: (n,) rising [m], from state 0 of all cells on.
        force: (n,) mean [N].
        runs: (m, n) each run [N].
    """

    stroke: Floats = field(repr=False)
    force: Floats = field(repr=False)
    runs: Floats = field(repr=False)

    @property
    def spread(self) -> Floats:
        """(n,) standard deviation between the runs [N]; zero for one run."""
        return np.std(self.runs, axis=0, ddof=1) if len(self.runs) > 1 else np.zeros(len(self))

    def __len__(self) -> int:
        return len(self.stroke)

    def at(self, stroke: Floats) -> Floats:
        """Mean force [N] at strokes [m], constant beyond the ends."""
        return np.interp(stroke, self.stroke, self.force)

    def __repr__(self):
        low, high = self.stroke[0] * 1e3, self.stroke[-1] * 1e3
        return f"Curve({len(self.runs)} runs, {low:.4g} to {high:.4g} mm)"


def mean_curve(recordings: Sequence[Recording], full: float) -> Curve:
    """The mean of some runs over the strokes that all of them reach.

    Args:
        recordings: one or more, all loading (stroke from 0 up) or all unloading (stroke from 0
            down, the machine having been set to zero with every cell at state 1).
        full: stroke with every cell at state 1 [m].

    Returns:
        Forces at strokes counted from state 0, `STEP` apart, each the mean over a strip without
        its spikes.
    """
    placed = [(from_zero(r, full), without_spikes(r.force)) for r in recordings]
    low = max(float(np.min(u)) for u, _ in placed)
    high = min(float(np.max(u)) for u, _ in placed)
    first, last = np.ceil(low / STEP - 1e-6), np.floor(high / STEP + 1e-6)
    grid = np.arange(first, last + 1) * STEP
    runs = np.array([_strips(u, force, grid) for u, force in placed])
    return Curve(grid, np.mean(runs, axis=0), runs)


def from_zero(recording: Recording, full: float) -> Floats:
    """Strokes counted from state 0 [m]: an unloading test starts at `full`, set to zero there."""
    stroke = recording.stroke
    return stroke + full if is_unloading(recording) else stroke


def is_unloading(recording: Recording) -> bool:
    """Whether a run goes from state 1 down, its stroke from 0 to negative."""
    below = float(np.min(recording.stroke)) < -0.5 * float(np.ptp(recording.stroke))
    return recording.direction == "unloading" and below


def rms(values: Floats) -> float:
    """Root mean square of numbers of any shape."""
    return float(np.sqrt(np.mean(values**2)))


def _strips(u: Floats, force: Floats, grid: Floats) -> Floats:
    """Mean force in a strip around each stroke; between samples where a strip has none."""
    strip = np.floor((u - grid[0]) / STEP + 0.5).astype(int)
    inside = (strip >= 0) & (strip < len(grid))
    count = np.bincount(strip[inside], minlength=len(grid))
    total = np.bincount(strip[inside], force[inside], len(grid))
    # Means over whole strips sit in the strip's middle, but for the first and the last one.
    order = np.argsort(u, kind="stable")
    between = np.interp(grid, u[order], force[order])
    return np.where(count > 0, total / np.maximum(count, 1), between)
