"""A force curve from a file: any two columns of travel and force, volume and pressure, ..."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np

from stepwell.base import ByValue, Floats, InputError, Measure, brief, content_of, told_in
from stepwell.lab.recordings.errors import LabError
from stepwell.lab.recordings.recording import turns_of
from stepwell.lab.recordings.text import parse_pair


@dataclass(frozen=True, eq=False)
class MeasuredCurve(ByValue):
    """Force against travel as a file has them, in SI.

    Attributes:
        source: the file, as the user called it.
        measure: what travel and force are.
        travel: (n,) [m], in the order of the file.
        force: (n,) [N].
    """

    source: str
    measure: Measure
    travel: Floats = field(repr=False)
    force: Floats = field(repr=False)

    def rising(self, half: str | None = None) -> tuple[Floats, Floats]:
        """Travels that rise and their forces; those of rows at one travel are averaged.

        Args:
            half: "loading" or "unloading", the first of them in the file; None for a file that
                holds one alone.

        Raises:
            LabError: both are there and none is asked for, or the one that is asked for is not.
            ValueError: no such word.
        """
        if half not in (None, "loading", "unloading"):
            raise InputError(f"half = {half!r}: must be 'loading', 'unloading' or None.")
        turns = turns_of(self.travel)
        unit, factor = told_in(self.measure.travel_unit)
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
            ends = [0, *turns, len(x) - 1]
            parts = [slice(a, b + 1) for a, b in pairwise(ends)]
            falls = half == "unloading"
            found = [p for p in parts if (x[p][-1] < x[p][0]) == falls]
            if not found:
                raise LabError(self.source, f"half = {half!r}: there is no such half in the file.")
            x, y = x[found[0]], y[found[0]]
        rising, place = np.unique(x, return_inverse=True)
        count = np.bincount(place)
        return rising, np.bincount(place, y) / count

    def __repr__(self):
        return brief(self)


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
