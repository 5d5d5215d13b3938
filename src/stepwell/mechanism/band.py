"""A rubber band between the two blocks of a unit cell."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from stepwell.base import ByValue, Floats, InputError, Vec2, check
from stepwell.mechanism.cubics import integral, value
from stepwell.mechanism.curves import Law, Linear, Table
from stepwell.mechanism.geometry import band_energy, band_force, band_length, length_slope


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
        object.__setattr__(self, "p", check.vector("p", self.p))
        object.__setattr__(self, "q", check.vector("q", self.q))
        object.__setattr__(self, "stiffness", check.positive("stiffness", self.stiffness, "N/m"))
        object.__setattr__(
            self, "rest_length", check.not_negative("rest_length", self.rest_length, "m")
        )
        if self.two_sided and isinstance(self.law, Table):
            raise InputError(
                "two_sided = True with a Table: a table says nothing of compression; use Linear "
                "or Cubic, or leave the band tension-only."
            )

    @classmethod
    def from_table(
        cls,
        p: Vec2,
        q: Vec2,
        rest_length: float,
        extension: Sequence[float],
        tension: Sequence[float],
    ) -> "Band":
        """A band with a measured law; its stiffness is the secant to the last point.

        Args:
            p, q: anchors [m].
            rest_length: ℓ0 [m].
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
        """q - p [m]: all that the motion knows of the anchors."""
        return self.q[0] - self.p[0], self.q[1] - self.p[1]

    def length(self, theta: ArrayLike, lever: float) -> Floats:
        """Band length ℓ [m] at lever angles θ [rad] of any shape (Kamp et al. 2024, Eq. 2)."""
        theta = np.asarray(theta, float)
        return band_length(np.sin(theta), np.cos(theta), *self.d, lever)

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
