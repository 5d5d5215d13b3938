"""What one curve alone tells: which law it supports, and how well it tells the band's numbers."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats
from stepwell.lab.bands.extent import taut
from stepwell.lab.bands.laws import Fitted
from stepwell.lab.bands.spread import student

# A load cell or a scale is true to about this share of its largest reading: what a law leaves below
# it, drift leaves too.
TRUE_TO = 0.002
# A difference of the criterion up to this is not worth a further number (Kass & Raftery 1995).
WORTH = 2.0
_FEW = 8  # readings, too few to tell whether neighbours err alike
_STEP = 1e-6  # of the strokes, for slopes by differences


class Interval(NamedTuple):
    """A number with its 95 % interval; NaN where nothing is known of it."""

    value: float
    low: float
    high: float


def independent(left: Floats) -> float:
    """How many independent readings a curve is worth, by what a law leaves of it, (n,) [N].

    Neighbours along a stroke err alike, by drift and by what the law cannot follow.

    Source: Bayley and Hammersley 1946, for a first-order autoregression.
    """
    n = len(left)
    off = left - np.mean(left)
    power = float(off @ off)
    if n <= _FEW or power == 0:
        return float(n)
    # Residuals of a fit are correlated by -1/n on average; three of them are gone in its numbers.
    alike = min(max(float(off[1:] @ off[:-1]) / power + 3.0 / n, 0.0), 0.98)
    return max(n * (1 - alike) / (1 + alike), 4.0)


def criterion(left: Floats, numbers: int, worth: float, doubt: float) -> float:
    """How badly a law with so many numbers explains a curve; less is better.

    Args:
        left: (n,) what it leaves [N].
        numbers: how many of its numbers are fitted.
        worth: independent readings in the curve.
        doubt: what a reading may be off whatever the law [N].

    Few readings make a number dearer, as in the criterion of Hurvich & Tsai 1989: by chance it
    explains more of them.

    Source: Schwarz 1978.
    """
    n = len(left)
    size = float(np.mean(left**2)) + doubt**2
    few = n / max(n - numbers, 0.5)
    return worth * math.log(max(size, 1e-300)) + numbers * math.log(worth) * few


def reading_doubt(fitted: Fitted, stroke: Floats, steps: tuple[float, float]) -> Floats:
    """Standard deviation of readings by the digits they are told in, (n,) [N].

    Args:
        fitted: the law, for what a step of stroke is in force.
        stroke: (n,) [m].
        steps: of stroke [m] and force [N].
    """
    slope = (fitted.tension(stroke + _STEP) - fitted.tension(stroke - _STEP)) / (2 * _STEP)
    return np.hypot(steps[1], slope * steps[0]) / math.sqrt(12.0)


def intervals(
    fitted: Fitted,
    gauge: float | None,
    stroke: Floats,
    force: Floats,
    steps: tuple[float, float],
) -> tuple[Interval, Interval]:
    """Slope of the line through a curve [N/m] and onset of its law [m], with 95 % intervals.

    They hold what this band has, by the scatter of its readings around the law and the digits they
    are told in (Student); not what other bands have.

    Args:
        fitted: the law through the curve.
        gauge: length of the band at stroke 0 [m], where it is known.
        stroke, force: (n,) [m], [N].
        steps: in which stroke [m] and force [N] are told.
    """
    pulls = taut(force, steps[1])
    x = stroke[pulls] - np.mean(stroke[pulls])
    k = float(x @ force[pulls] / (x @ x)) if len(x) > 1 else math.nan
    beyond = stroke > fitted.onset
    u, f = stroke[beyond], force[beyond]
    if len(u) <= fitted.law.count(gauge):
        return Interval(k, math.nan, math.nan), Interval(fitted.onset, math.nan, math.nan)
    slopes = fitted.slopes(u, gauge)
    left = f - fitted.tension(u)
    worth = independent(left)
    spare = len(u) - slopes.shape[1]
    # What neighbours leave alike still tells something, if little.
    free = min(max(math.floor(worth) - slopes.shape[1], 1), spare)
    told = any(steps)
    doubt = reading_doubt(fitted, u, steps) if told else np.ones(len(u))
    scatter = float(np.sum((left / doubt) ** 2)) / spare
    if told:
        # Few readings can lie on the law by luck: what their digits tell counts as one more.
        scatter = (free * scatter + 1.0) / (free + 1)
    # As many readings as are independent, spread over the strokes as all of them are.
    wide = student(free + told) * math.sqrt(scatter * len(u) / worth)
    scale = np.linalg.norm(slopes, axis=0)
    to_onset = np.linalg.pinv(slopes / scale)[0] / scale[0]
    to_slope = x / float(x @ x)
    at_pulls = reading_doubt(fitted, stroke[pulls], steps) if told else np.ones(len(x))
    k_error = wide * float(np.linalg.norm(to_slope * at_pulls))
    onset_error = wide * float(np.linalg.norm(to_onset * doubt))
    return (
        Interval(k, k - k_error, k + k_error),
        Interval(fitted.onset, fitted.onset - onset_error, fitted.onset + onset_error),
    )
