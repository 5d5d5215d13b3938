"""Force curves: mean curves of repeats, and curves from two columns of a file."""

import os
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from stepwell.base import ByValue, Floats, InputError, Measure, display_unit, to_unit
from stepwell.lab.recordings import recording as recorded
from stepwell.lab.recordings.read import samples_of, several
from stepwell.lab.recordings.reading import Reading
from stepwell.lab.recordings.recording import LabError, Recording, without_spikes

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
        low, high = to_unit(self.stroke[0], "mm"), to_unit(self.stroke[-1], "mm")
        return f"Curve({len(self.runs)} runs, {low:.4g} to {high:.4g} mm)"


def mean_curve(recordings: Sequence[Recording], full: float) -> Curve:
    """Mean of some runs over their common strokes, counted from state 0.

    All runs load (stroke from 0 up), or all unload (stroke from 0 down, the machine being set to
    zero at stroke `full` [m], every cell at state 1). Strokes are `STEP` apart, and each force is a
    mean over a strip without spikes.
    """
    placed = [(from_zero(r, full), without_spikes(r.force)) for r in recordings]
    low = max(float(np.min(u)) for u, _ in placed)
    high = min(float(np.max(u)) for u, _ in placed)
    first, last = np.ceil(low / STEP - 1e-6), np.floor(high / STEP + 1e-6)
    grid = np.arange(first, last + 1) * STEP
    runs = np.array([_strips(u, force, grid) for u, force in placed])
    return Curve(grid, np.mean(runs, axis=0), runs)


def from_zero(recording: Recording, full: float) -> Floats:
    """Strokes counted from state 0 [m]: an unloading test is set to zero at `full`."""
    stroke = recording.stroke
    below = float(np.min(stroke)) < -0.5 * float(np.ptp(stroke))
    return stroke + full if recording.direction == "unloading" and below else stroke


def rms(values: Floats) -> float:
    """Root mean square of numbers of any shape."""
    return float(np.sqrt(np.mean(values**2)))


def _strips(u: Floats, force: Floats, grid: Floats) -> Floats:
    """Mean force in a strip around each stroke; interpolated if a strip has no sample."""
    strip = np.floor((u - grid[0]) / STEP + 0.5).astype(int)
    inside = (strip >= 0) & (strip < len(grid))
    count = np.bincount(strip[inside], minlength=len(grid))
    total = np.bincount(strip[inside], force[inside], len(grid))
    # Means over whole strips are at the middle of the strip, except the first and the last.
    order = np.argsort(u, kind="stable")
    between = np.interp(grid, u[order], force[order])
    return np.where(count > 0, total / np.maximum(count, 1), between)


@dataclass(frozen=True, eq=False, repr=False)
class MeasuredCurve(ByValue):
    """Force against travel from a file, in SI.

    Attributes:
        source: the file, as named by the user.
        measure: quantities of travel and force.
        travel, force: (n,) [m], [N], in the order of the file.
        reading: how the file was read, a line each.
    """

    source: str
    measure: Measure
    travel: Floats = field(repr=False)
    force: Floats = field(repr=False)
    reading: tuple[str, ...] = ()

    def rising(self, half: str | None = None) -> tuple[Floats, Floats]:
        """Rising travels and their forces; rows of equal travel are averaged.

        `half` is "loading" or "unloading", the first of these in the file; None for a file with
        one half.

        Raises:
            LabError: the file has both halves and `half` is None, or the requested half is missing.
            ValueError: `half` is another word.
        """
        if half not in (None, "loading", "unloading"):
            raise InputError(f"half = {half!r}: must be 'loading', 'unloading' or None.")
        turns = recorded.turns_of(self.travel)
        unit, factor = display_unit(self.measure.travel_unit)
        if half is None and turns:
            at = turns[0]
            raise LabError(
                self.source,
                f"row {at + 1}: the {self.measure.travel} turns back at "
                f"{self.travel[at] * factor:.6g} {unit}, so the file has loading and unloading: "
                f"give half = 'loading' or 'unloading'. A curve that folds back needs "
                f"form='curve', not a table.",
            )
        x, y = self.travel, self.force
        if half is not None:
            halves = recorded.halves_of(x, turns)
            matching = [p for p in halves if recorded.direction_of(x[p]) == half]
            if not matching:
                raise LabError(self.source, f"half = {half!r}: the file has no such half.")
            x, y = x[matching[0]], y[matching[0]]
        rising, place = np.unique(x, return_inverse=True)
        count = np.bincount(place)
        return rising, np.bincount(place, y) / count


def read_curve(file: str | os.PathLike[str], reading: Reading | None = None) -> MeasuredCurve:
    """The force curve in a file.

    Args:
        file: a table as for `read`, of stroke and force, volume and pressure, or angle and torque.
        reading: columns, units, signs and part, where the file leaves them open.

    Raises:
        LabError: the file is missing, broken, binary or empty, no reading stands out, it has
            several specimens, or a row without numbers: none is left out.
    """
    name = os.fspath(file)
    found = samples_of(file, reading)
    if len(found) > 1:
        raise several(name, found)
    (one,) = found
    if one.lost:
        number, line = one.lost[0]
        raise LabError(
            name, f"line {number} is no row of numbers ({line!r}): correct it or take it out."
        )
    # Rounded, so that 0.3 mm is exactly 0.0003 m.
    travel, force = (np.array([float(f"{x:.15g}") for x in c]) for c in (one.travel, one.force))
    return MeasuredCurve(name, one.measure, travel, force, one.reading)
