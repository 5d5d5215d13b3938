"""Rubber bands between the blocks of a unit cell, their laws, and loads along a cell's travel."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from stepwell.base import ByValue, Floats, InputError, Vec2, check
from stepwell.kernels import kernel
from stepwell.mechanism.cubics import COLUMNS, integral, value, with_integrals
from stepwell.mechanism.geometry import (
    band_energy,
    band_force,
    band_length,
    length_slope,
    stretch_range,
)

Numbers = Sequence[float]

_HOOKE = np.array([[0.0, 0.0, 1.0, 0.0, 0.0, 0.0]])
_HOOKE.setflags(write=False)


@kernel
def hooke(stiffness: Any, extension: Any) -> tuple[Any, Any, Any]:
    """Tension k e of a linear band that is taut, its slope k, and the energy k e²/2 it stores."""
    energy = band_energy(0.5 * stiffness * extension, extension)
    return stiffness * extension, stiffness, energy


@dataclass(frozen=True, slots=True, eq=False)
class Linear(ByValue):
    """Hooke's law: tension is stiffness times extension (Kamp et al. 2024, Eq. 1)."""

    def pieces(self) -> Floats:
        """The shape φ(e) = e as one cubic piece, (1, 6) float."""
        return _HOOKE


@dataclass(frozen=True, slots=True, eq=False)
class Cubic(ByValue):
    """Rubber that softens and stiffens: tension k (e + a2 e² + a3 e³), a2 in 1/m and a3 in 1/m²."""

    a2: float
    a3: float

    def __post_init__(self):
        check.fields(self, check.finite, a2="1/m", a3="1/m²")

    def pieces(self) -> Floats:
        """The shape φ(e) = e + a2 e² + a3 e³ as one cubic piece, (1, 6) float."""
        return np.array([[0.0, 0.0, 1.0, self.a2, self.a3, 0.0]])


@dataclass(frozen=True, slots=True, eq=False)
class Table(ByValue):
    """A measured law: tension k φ(e), with φ through the given points, smooth between.

    The interpolation is PCHIP (Fritsch & Butland 1984): no overshoot, continuous slope. Past
    the last point the curve continues straight.

    Args:
        extension: (n,) rising [m], the first one 0, n >= 2.
        shape: (n,) φ at those extensions [m], the first one 0; tension divided by stiffness.

    Raises:
        ValueError: extensions that do not rise from 0, a band that pushes, or unequal lengths.
    """

    extension: tuple[float, ...]
    shape: tuple[float, ...]

    def __post_init__(self):
        extension = check.rising("extension", self.extension, "m", 2)
        shape = check.as_many("shape", self.shape, "m", "extension", len(extension))
        if extension[0] != 0 or shape[0] != 0:
            raise InputError(
                f"the table starts at ({extension[0]}, {shape[0]}): must start at (0, 0), because "
                f"a band has no tension at its rest length."
            )
        check.pulls("shape", shape, "m")
        object.__setattr__(self, "extension", extension)
        object.__setattr__(self, "shape", shape)

    def pieces(self) -> Floats:
        """The shape φ(e) as cubic pieces, (n, 6) float."""
        return _smooth(self.extension, self.shape)


Law = Linear | Cubic | Table


@dataclass(frozen=True, slots=True, eq=False)
class Load(ByValue):
    """A force on one cell that depends on its travel only, such as the weight of a foot.

    Positive resists travel. Between the points the force is straight, outside constant. Travels
    that do not rise and unequal lengths raise ValueError.

    Args:
        travel: (n,) rising [m], n >= 1.
        force: (n,) [N].
    """

    travel: tuple[float, ...]
    force: tuple[float, ...]

    def __post_init__(self):
        travel = check.rising("travel", self.travel, "m", 1)
        force = check.as_many("force", self.force, "N", "travel", len(travel))
        object.__setattr__(self, "travel", travel)
        object.__setattr__(self, "force", force)

    @classmethod
    def constant(cls, force: float) -> "Load":
        """The same force [N] at every travel."""
        return cls((0.0,), (force,))

    def pieces(self) -> Floats:
        """Force against travel as (n + 1, 6) pieces, the integral counted from travel 0."""
        return _straight(self.travel, self.force)


@lru_cache(maxsize=256)
def _smooth(x: tuple[float, ...], y: tuple[float, ...]) -> Floats:
    from scipy.interpolate import PchipInterpolator  # pyright: ignore[reportMissingTypeStubs]

    cubic = PchipInterpolator(np.array(x), np.array(y)).c[::-1].T
    end = cubic[-1] @ (np.array([0.0, 1.0, 2.0, 3.0]) * (x[-1] - x[-2]) ** np.array([0, 0, 1, 2]))
    rows = np.zeros((len(x), COLUMNS))
    rows[:, 0], rows[:-1, 1:5] = x, cubic
    rows[-1, 1:3] = y[-1], end
    return with_integrals(rows)


@lru_cache(maxsize=256)
def _straight(x: tuple[float, ...], y: tuple[float, ...]) -> Floats:
    rows = np.zeros((len(x) + 1, COLUMNS))
    rows[0, :2] = min(x[0], 0.0) - 1.0, y[0]
    rows[1:, 0], rows[1:, 1] = x, y
    rows[1:-1, 2] = np.diff(y) / np.diff(x)
    rows = with_integrals(rows)
    rows[:, 5] -= integral(rows, np.zeros(1))[0]
    rows.setflags(write=False)
    return rows


@dataclass(frozen=True, slots=True, eq=False)
class Band(ByValue):
    """A rubber band between two blocks.

    Slack bands carry nothing: below `rest_length` energy and force are zero, unless the band
    is a `two_sided` spring as in the paper.

    Args:
        p, q: anchors on the inner and the outer block [m], each from the midpoint between
            that block's lever joints. Only d = q - p matters to the motion.
        stiffness: k [N/m], > 0.
        rest_length: ℓ0 [m], >= 0.
        law: tension is `stiffness` times this shape of the extension ℓ - ℓ0.
        two_sided: True for a spring that also pushes.

    Raises:
        ValueError: a value out of its range, or a two-sided Table.

    Source: Kamp et al. 2024, Eqs. 1 and 2; tension-only is ours (theory page, "Slack").
    """

    p: Vec2
    q: Vec2
    stiffness: float = 28.5
    rest_length: float = 0.010
    law: Law = Linear()
    two_sided: bool = False

    def __post_init__(self):
        check.fields(self, check.vector, p="m", q="m")
        check.fields(self, check.positive, stiffness="N/m")
        check.fields(self, check.not_negative, rest_length="m")
        if self.two_sided and isinstance(self.law, Table):
            raise InputError(
                "two_sided = True with a Table: a table has no values for compression. Use Linear "
                "or Cubic, or leave the band tension-only."
            )

    @classmethod
    def from_table(
        cls, p: Vec2, q: Vec2, rest_length: float, extension: Numbers, tension: Numbers
    ) -> "Band":
        """A band with a measured law; its stiffness is the secant to the last point.

        Args:
            p, q, rest_length: anchors and ℓ0 [m].
            extension: (n,) rising, the first one 0 [m].
            tension: (n,) at those extensions, the first one 0, the last one > 0 [N].

        Raises:
            ValueError: a table that does not rise, holds a push, or does not end in tension.
        """
        extension = check.rising("extension", extension, "m", 2)
        check.pulls("tension", tension, "N")
        stiffness = check.positive("tension[-1]", tension[-1], "N") / extension[-1]
        shape = tuple(t / stiffness for t in tension)
        return cls(p, q, stiffness, rest_length, Table(extension, shape))

    @property
    def d(self) -> Vec2:
        """q - p [m]; the motion depends on the anchors only by this difference."""
        return self.q[0] - self.p[0], self.q[1] - self.p[1]

    def length(self, theta: ArrayLike, lever: float) -> Floats:
        """Band length ℓ [m] at lever angles θ [rad] of any shape (Kamp et al. 2024, Eq. 2)."""
        theta = np.asarray(theta, float)
        return band_length(np.sin(theta), np.cos(theta), *self.d, lever)

    def lengths(self, lever: float, limit: float) -> tuple[float, float]:
        """Least and largest length [m] at lever angles up to `limit` [rad] in size; exact."""
        least, most = stretch_range(*self.d, lever, limit)
        return float(least), float(most)

    def largest_stretch(self, lever: float, limit: float) -> float:
        """Largest length over rest length [1] at lever angles up to `limit` [rad] in size."""
        return self.lengths(lever, limit)[1] / self.rest_length if self.rest_length else math.inf

    def tension(self, length: ArrayLike) -> Floats:
        """Tension [N] at band lengths [m] of any shape; zero where slack."""
        extension = np.asarray(length, float) - self.rest_length
        tension = self.stiffness * value(self.law.pieces(), extension)
        return tension if self.two_sided else np.where(extension > 0, tension, 0.0)

    def energy(self, length: ArrayLike) -> Floats:
        """Stored energy [J] at band lengths [m] of any shape (Kamp et al. 2024, Eq. 1)."""
        extension = np.asarray(length, float) - self.rest_length
        energy = band_energy(self.stiffness, integral(self.law.pieces(), extension))
        return energy if self.two_sided else np.where(extension > 0, energy, 0.0)

    def force(self, theta: ArrayLike, lever: float) -> Floats:
        """Force along travel, dE/ds [N], at lever angles θ [rad] of any shape."""
        theta = np.asarray(theta, float)
        sin, cos = np.sin(theta), np.cos(theta)
        length = band_length(sin, cos, *self.d, lever)
        return band_force(self.tension(length), length_slope(sin, cos, length, *self.d))
