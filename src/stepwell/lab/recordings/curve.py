"""Force curves: repeats of one test averaged, and any two columns of a file."""

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np

from stepwell.base import ByValue, Floats, InputError, Measure, content_of, display_unit, to_unit
from stepwell.lab.recordings.recording import LabError, Recording, turns_of, without_spikes
from stepwell.lab.recordings.text import parse_pair

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
    """The mean of some runs over the strokes that all of them reach, counted from state 0.

    All load (stroke from 0 up), or all unload (stroke from 0 down, the machine having been set to
    zero with every cell at state 1, at stroke `full` [m]). Forces are `STEP` apart, each the mean
    over a strip without its spikes.
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
    below = float(np.min(stroke)) < -0.5 * float(np.ptp(stroke))
    return stroke + full if recording.direction == "unloading" and below else stroke


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


@dataclass(frozen=True, eq=False, repr=False)
class MeasuredCurve(ByValue):
    """Force against travel as a file has them, in SI.

    Attributes:
        source: the file, as the user called it.
        measure: what travel and force are.
        travel, force: (n,) [m], [N], in the order of the file.
    """

    source: str
    measure: Measure
    travel: Floats = field(repr=False)
    force: Floats = field(repr=False)

    def rising(self, half: str | None = None) -> tuple[Floats, Floats]:
        """Travels that rise and their forces; those of rows at one travel are averaged.

        `half` is "loading" or "unloading", the first of them in the file; None for a file that
        holds one alone.

        Raises:
            LabError: both are there and none is asked for, or the one that is asked for is not.
            ValueError: no such word.
        """
        if half not in (None, "loading", "unloading"):
            raise InputError(f"half = {half!r}: must be 'loading', 'unloading' or None.")
        turns = turns_of(self.travel)
        unit, factor = display_unit(self.measure.travel_unit)
        if half is None and turns:
            at = turns[0]
            raise LabError(
                self.source,
                f"row {at + 1}: the {self.measure.travel} turns back at "
                f"{self.travel[at] * factor:.6g} {unit}, so the file holds loading and unloading: "
                f"keep one of them, or load it by stepwell.load_element with half='loading' or "
                f"'unloading'; if the curve truly folds back, it is a curve and no table.",
            )
        x, y = self.travel, self.force
        if half is not None:
            parts = [slice(a, b + 1) for a, b in pairwise([0, *turns, len(x) - 1])]
            matching = [p for p in parts if (x[p][-1] < x[p][0]) == (half == "unloading")]
            if not matching:
                raise LabError(self.source, f"half = {half!r}: there is no such half in the file.")
            x, y = x[matching[0]], y[matching[0]]
        rising, place = np.unique(x, return_inverse=True)
        count = np.bincount(place)
        return rising, np.bincount(place, y) / count


def read_curve(file: str | os.PathLike[str]) -> MeasuredCurve:
    """A force curve.

    Args:
        file: text whose header names columns and units, such as "travel_mm,force_N", "Displacement
            [mm];Force [N]", "volume_mL,pressure_kPa" or "Angle (deg), Torque (N mm)", then rows of
            numbers; other columns may stand beside them.

    Raises:
        LabError: the file is missing, broken, binary, empty, or in units that are not known or do
            not belong together.
    """
    name = os.fspath(file)
    try:
        measure, *columns = parse_pair(content_of(Path(file), "recording_bytes"))
        # 0.3 mm is 0.0003 m and not its neighbour.
        travel, force = (np.array([float(f"{x:.15g}") for x in column]) for column in columns)
        return MeasuredCurve(name, measure, travel, force)
    except FileNotFoundError:
        raise LabError(name, "no such file.") from None
    except OSError as error:
        raise LabError(name, f"cannot be read: {error.strerror or error}.") from None
    except ValueError as error:
        raise LabError(name, str(error)) from None
