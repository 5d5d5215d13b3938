"""Tension of a calibrated band at the lengths in the data, with a band of curves around it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from stepwell.base import ByValue, Floats, to_unit
from stepwell.lab.bands.halves import student
from stepwell.lab.fit_samples import Sample
from stepwell.mechanism import Law, Table, geometry

# Largest half width of the 95 % band of a known tension, over the largest tension.
KNOWN_TENSION = 0.3
_POINTS = 13  # lengths of a curve


@dataclass(frozen=True, eq=False, repr=False)
class TensionCurve(ByValue):
    """Tension of one band against its length, in loading, where the data contain this length.

    Attributes:
        rubber: name of its stiffness, such as "stiffness_2_in_pairs".
        length: (n,) distance of the anchors [m].
        tension: (n,) from the fit to all geometries [N].
        low, high: (n,) 95 % band of curves, by leaving out one geometry in turn [N].
    """

    rubber: str
    length: Floats = field(repr=False)
    tension: Floats = field(repr=False)
    low: Floats = field(repr=False)
    high: Floats = field(repr=False)

    @property
    def width(self) -> float:
        """Largest half width of the band of curves over the largest tension [1]."""
        most = max(float(np.max(np.abs(self.tension))), 1e-12)
        return float(np.max(self.high - self.low)) / 2.0 / most

    @property
    def known(self) -> bool:
        """Whether the tension is known well enough for a design."""
        return self.width <= KNOWN_TENSION

    def __repr__(self):
        low, high = (to_unit(float(end), "mm") for end in self.length[[0, -1]])
        return f"TensionCurve({self.rubber}, {low:.3g} to {high:.3g} mm, ±{self.width:.0%})"


def lengths_of(samples: Sequence[Sample]) -> tuple[float, float]:
    """Least and largest distance of the anchors of a band in the data [m]."""
    ends: list[float] = []
    for sample in samples:
        cell, full = sample.cell, sample.cell.full_travel
        travel = np.clip(sample.way, 0.0, full)
        sine = geometry.sine_at(travel, cell.lever, cell.sin_limit)
        sine = -sine if sample.unloading else sine  # the way of unloading begins at state 1
        cosine = np.sqrt(1.0 - sine**2)
        length = geometry.band_length(sine, cosine, *sample.geometry, cell.lever)
        ends += [float(np.min(length)), float(np.max(length))]
    return min(ends), max(ends)


def tension_curve(
    rubber: str,
    samples: Sequence[Sample],
    whole: Callable[[Floats], Floats],
    left_out: Sequence[Callable[[Floats], Floats]],
) -> TensionCurve:
    """Curve of the bands of these samples; functions are tensions [N] at lengths (n,) [m]."""
    length = np.linspace(*lengths_of(samples), _POINTS)
    tension = whole(length)
    each = np.array([one(length) for one in left_out])
    n = len(each)
    scatter = np.sum((each - np.mean(each, axis=0)) ** 2, axis=0)
    wide = student(n - 1) * np.sqrt((n - 1) / n * scatter)
    return TensionCurve(rubber, length, tension, tension - wide, tension + wide)


def measured_law(law: Law, rest: float, curves: Sequence[TensionCurve]) -> Table:
    """A law as a table over the lengths in the data; `rest` is the rest length [m].

    Between the rest length and the least length in the data the table is a straight line.
    """
    from stepwell.mechanism import Band

    low = max(min(float(curve.length[0]) for curve in curves), rest + 1e-4)
    high = max(float(curve.length[-1]) for curve in curves)
    extension = np.linspace(low, high, _POINTS) - rest
    one = Band((0.0, 0.0), (1.0, 0.0), 1.0, rest, law)
    shape = np.maximum.accumulate(np.maximum(one.tension(rest + extension), 1e-6))
    return Table((0.0, *extension.tolist()), (0.0, *shape.tolist()))
