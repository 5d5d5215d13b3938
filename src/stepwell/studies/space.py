"""The designs of a study: each by its number, whoever asks and in whatever order."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from enum import StrEnum
from functools import cache

import numpy as np

from stepwell.base import ByValue, Floats, InputError


class How(StrEnum):
    """How designs lie in a space."""

    GRID = "grid"
    SOBOL = "sobol"
    LATIN = "latin"
    RANDOM = "random"


# A Latin hypercube shuffles all of its designs, and every process holds them.
MOST_LATIN = 10_000_000


@dataclass(frozen=True, eq=False)
class Axis(ByValue):
    """What varies, and between which values.

    Attributes:
        name: of a parameter of the design, as `design.parameter` takes it.
        low, high: in SI.
        count: of values on a grid, both ends among them; elsewhere not looked at.
        log: whether values lie in equal ratios.
    """

    name: str
    low: float
    high: float
    count: int = 2
    log: bool = False

    def __post_init__(self):
        if not (math.isfinite(self.low) and math.isfinite(self.high) and self.low < self.high):
            raise InputError(
                f"{self.name}: goes from {self.low} to {self.high}: must rise, both finite."
            )
        if self.count < 2:
            raise InputError(f"{self.name}: count = {self.count}: must be 2 or more.")
        if self.log and self.low <= 0:
            raise InputError(f"{self.name}: starts at {self.low}: equal ratios take values > 0.")

    def at(self, share: Floats) -> Floats:
        """Values (n,) at shares (n,) of the way from `low` to `high`."""
        if self.log:
            return self.low * (self.high / self.low) ** share
        return self.low + (self.high - self.low) * share


@dataclass(frozen=True, eq=False)
class Space(ByValue):
    """Designs by number.

    Attributes:
        axes: one or more, no name twice.
        how: they lie in it.
        count: of designs; on a grid as many as it has.
        seed: of what is drawn.

    Raises:
        ValueError: no axis, a name twice, no designs, or too many of a Latin hypercube.

    Source: Latin hypercube, McKay, Beckman and Conover 1979; Sobol' sequence, scrambled as by Owen
    1995; independent draws by a counter (Philox, Salmon et al. 2011), so that any can be had alone.
    """

    axes: tuple[Axis, ...]
    how: How = How.GRID
    count: int = 0
    seed: int = 0

    def __post_init__(self):
        object.__setattr__(self, "how", How(self.how))
        names = [axis.name for axis in self.axes]
        if not names or len(set(names)) < len(names):
            raise InputError(f"axes = {names}: must be one or more, each name once.")
        if self.how is How.GRID:
            object.__setattr__(self, "count", math.prod(axis.count for axis in self.axes))
        if self.count < 1:
            raise InputError(f"count = {self.count}: must be 1 or more.")
        if self.how is How.LATIN and self.count > MOST_LATIN:
            raise InputError(
                f"count = {self.count}: a Latin hypercube takes at most {MOST_LATIN}; take "
                f"{How.SOBOL} for more."
            )
        if self.seed < 0:
            raise InputError(f"seed = {self.seed}: must be >= 0.")

    @property
    def names(self) -> tuple[str, ...]:
        """What varies."""
        return tuple(axis.name for axis in self.axes)

    def points(self, first: int, last: int) -> Floats:
        """Values (last - first, axes) of the designs from number `first` to before `last`."""
        if self.how is How.GRID:
            shape = [axis.count for axis in self.axes]
            at = np.unravel_index(np.arange(first, last), shape)
            shares = np.stack([i / (n - 1) for i, n in zip(at, shape, strict=True)], axis=1)
        else:
            shares = _SHARES[self.how](self, first, last)
        columns = [axis.at(one) for axis, one in zip(self.axes, shares.T, strict=True)]
        return np.stack(columns, axis=1)


def _random(space: Space, first: int, last: int) -> Floats:
    wide, per_step = len(space.axes), 4  # a step of the counter gives four numbers
    start, skipped = divmod(first * wide, per_step)
    numbers = np.random.Generator(np.random.Philox(key=space.seed).advance(start))
    return numbers.random(skipped + (last - first) * wide)[skipped:].reshape(-1, wide)


def _sobol(space: Space, first: int, last: int) -> Floats:
    from scipy.stats import qmc

    points = qmc.Sobol(len(space.axes), rng=np.random.default_rng(space.seed))
    with warnings.catch_warnings():
        # Its balance is that of the whole; a stretch of it need not be a power of two long.
        warnings.simplefilter("ignore", UserWarning)
        return (points.fast_forward(first) if first else points).random(last - first)


def _latin(space: Space, first: int, last: int) -> Floats:
    return _hypercube(len(space.axes), space.count, space.seed)[first:last]


@cache
def _hypercube(wide: int, count: int, seed: int) -> Floats:
    from scipy.stats import qmc

    return qmc.LatinHypercube(wide, rng=np.random.default_rng(seed)).random(count)


_SHARES = {How.RANDOM: _random, How.SOBOL: _sobol, How.LATIN: _latin}
