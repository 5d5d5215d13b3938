"""Results of tension tests: stiffness, its dependence on the window, losses, force laws."""

import math
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from stepwell.base import ByValue, Drawn, InputError, amount, grouped, to_unit
from stepwell.lab.bands.band import BandTest, stiffness, stiffness_grid
from stepwell.lab.bands.choice import ACCURACY, Candidate, Choice, Interval, this_band
from stepwell.lab.bands.halves import Estimate, of_samples


class WindowStiffness(NamedTuple):
    """Stiffness [N/m] of the line between two strokes [m]."""

    start: float
    end: float
    stiffness: float


class OneBand(NamedTuple):
    """Number of readings, stiffness [N/m] and, if known, rest length [m] of one band."""

    readings: int
    stiffness: Interval
    rest_length: Interval | None


# A law is wrong where its residual exceeds this number of its own errors.
_SIGMAS = 3.0
# Number of strips of a test in which a law is compared with the measured force.
_STRIPS = 121


class LawError(NamedTuple):
    """A law that is wrong somewhere on the test by more than its own error.

    Attributes:
        law: its name.
        stroke, measured, predicted: the place of the largest deviation [m], and the forces [N].
        error: own error of the law [N], from its residual in the window, the accuracy of a load
            cell and the resolution.
        start, end: strokes around the middle of the window over which the law holds [m].
    """

    law: str
    stroke: float
    measured: float
    predicted: float
    error: float
    start: float
    end: float

    def __str__(self):
        low, high = (f"{to_unit(edge, 'mm'):.3g}" for edge in (self.start, self.end))
        return (
            f"The {self.law} law is wrong on this test: {self.predicted:.3g} N at "
            f"{amount(self.stroke, 'm', 3)}, where {self.measured:.3g} N was measured; its own "
            f"error is {self.error:.2g} N. It holds from {low} to {high} mm of stroke only: fit "
            f"where the band is used (--window FROM:TO), or use another law (--law)."
        )


@dataclass(frozen=True, eq=False)
class BandFit(ByValue, Drawn):
    """Tension tests and their results.

    Attributes:
        choice: the compared force laws.
        written: the law for a design file.
        stiffness: of the line through the window [N/m].
        loss: fraction of the loading work lost in a cycle [1]; None without unloading.
        alone: result for a single tested band; None for several.
        windows: the stiffness in other windows.
        wrong: where the written law does not hold on the test; None if it holds everywhere.
    """

    test: BandTest
    choice: Choice
    written: Candidate = field(repr=False)
    stiffness: Estimate
    loss: Estimate | None = field(repr=False)
    alone: OneBand | None = field(repr=False)
    windows: tuple[WindowStiffness, ...] = field(repr=False)
    wrong: LawError | None = field(repr=False, default=None)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of the test, of a law that does not hold on it, and of a doubtful stiffness."""
        low = self.alone.stiffness.low if self.alone else self.stiffness.low
        doubt = "The 95 % interval of the stiffness includes 0: the readings contradict each other."
        return (
            *self.test.warnings,
            *([str(self.wrong)] if self.wrong else []),
            *([doubt] if low <= 0 else []),
        )


def fit_bands(test: BandTest, choice: Choice, law: str | None = None) -> BandFit:
    """Stiffness, losses and force law of bands; `law` is for the design file.

    By default it is the chosen law.

    Raises:
        ValueError: the law is unknown.
    """
    known = {candidate.law.name: candidate for candidate in choice.candidates}
    if law is not None and law not in known:
        raise InputError(f"law = {law!r}: must be one of {', '.join(known)}.")
    losses = grouped((loop.sample, loop.loss) for loop in test.used if not math.isnan(loop.loss))
    edges, grid = stiffness_grid(test)
    written = choice.chosen if law is None else known[law]
    return BandFit(
        test,
        choice,
        written,
        stiffness(test),
        of_samples({s: sum(v) / len(v) for s, v in losses.items()}) if losses else None,
        _one_band(test, choice),
        tuple(
            WindowStiffness(float(low), float(high), float(k))
            for low, row in zip(edges, grid, strict=True)
            for high, k in zip(edges, row, strict=True)
            if not math.isnan(k)
        ),
        _law_error(test, written),
    )


def _law_error(test: BandTest, candidate: Candidate) -> LawError | None:
    """Where a law deviates from the whole test, inside and outside of its window."""
    fitted, loops = candidate.fitted, test.used
    reach = min(float(np.max(loop.stroke)) for loop in loops)
    whole = replace(test, window=(max(float(np.min(loop.stroke)) for loop in loops), reach))
    curves = [whole.curve(sample, _STRIPS) for sample in test.samples]
    stroke = curves[0][0]
    force = np.mean([np.interp(stroke, *curve) for curve in curves], axis=0)
    tension = fitted.tension(stroke)
    digit = max(test.steps_of(sample)[1] for sample in test.samples)
    error = math.hypot(fitted.rmse, ACCURACY * float(np.max(force)), digit)
    off = np.abs(tension - force)
    wrong = off > _SIGMAS * error
    if not np.any(wrong):
        return None
    worst = int(np.argmax(off))
    middle = int(np.argmin(np.abs(stroke - sum(test.window) / 2)))
    below, above = np.flatnonzero(wrong[: middle + 1]), np.flatnonzero(wrong[middle:])
    start = stroke[below[-1] + 1 if len(below) else 0] if not wrong[middle] else stroke[middle]
    end = stroke[middle + above[0] - 1 if len(above) else -1] if not wrong[middle] else start
    numbers = (stroke[worst], force[worst], tension[worst], error, start, end)
    return LawError(candidate.law.name, *map(float, numbers))


def _one_band(test: BandTest, choice: Choice) -> OneBand | None:
    if (band := this_band(test, choice)) is None:
        return None
    (slope, onset), gauge = band, choice.gauge
    length = None if gauge is None else Interval(*(gauge + edge for edge in onset))
    return OneBand(len(test.samples_of(test.samples[0], test.window)[0]), slope, length)
