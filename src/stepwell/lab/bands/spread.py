"""A mean over samples, with the interval that their scatter allows."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from stepwell.base import ByValue

CONFIDENCE = 0.95


@dataclass(frozen=True, eq=False)
class Estimate(ByValue):
    """A mean over samples.

    Attributes:
        value: the mean.
        low, high: 95 % interval of the mean of all such samples; NaN for one sample, which
            shows no scatter.
        next_low, next_high: 95 % interval for one more sample.
        spread: standard deviation between samples; NaN for one sample.
        each: the samples' own values.
    """

    value: float
    low: float
    high: float
    next_low: float
    next_high: float
    spread: float
    each: Mapping[int, float] = field(repr=False)

    def __repr__(self):
        if math.isnan(self.spread):
            return f"Estimate({self.value:.5g}, one sample: its uncertainty is not known)"
        return (
            f"Estimate({self.value:.5g}, 95 % {self.low:.5g} to {self.high:.5g}, "
            f"{len(self.each)} samples that scatter by {self.spread:.3g})"
        )


def of_samples(each: Mapping[int, float]) -> Estimate:
    """The mean of samples and its Student interval.

    Args:
        each: value by sample.

    Returns:
        The estimate.

    Source: Student 1908; the interval for one more sample is the usual prediction interval.
    """
    values = np.array(list(each.values()))
    n, mean = len(values), float(np.mean(values))
    spread = float(np.std(values, ddof=1)) if n > 1 else math.nan
    wide = student(n - 1) * spread
    near, far = wide / math.sqrt(n), wide * math.sqrt(1 + 1 / n)
    return Estimate(mean, mean - near, mean + near, mean - far, mean + far, spread, dict(each))


def student(freedom: float) -> float:
    """How many standard errors a two-sided 95 % interval reaches."""
    from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.5 + CONFIDENCE / 2))
