"""The body: its weight, where it is, and the points of the T-foot on which it rests."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from stepwell.base import ByValue, InputError, Vec2, check, require


@dataclass(frozen=True, slots=True, eq=False)
class Body(ByValue):
    """A rigid body on a T-foot.

    The origin lies at the height of the legs' pivots; x points forward, y to the left.

    Args:
        mass: without blocks, feet and antennas [kg], > 0.
        centre: (x, y, z) of its centre of mass [m].
        supports: (n, 2) points of the T-foot that touch the floor [m], n >= 3.
        length, width: outline that meets walls [m], > 0, about the origin.
        wall_friction: Coulomb's coefficient between walls and body or blocks, >= 0.

    Raises:
        ValueError: a value out of range, or too few supports to stand on.

    Source: Kamp et al. 2024, Fig. 3, for the T-foot; the numbers are assumed.
    """

    mass: float = 0.260
    centre: tuple[float, float, float] = (0.024, 0.0, 0.0)
    supports: Sequence[Vec2] = ((-0.055, 0.0), (0.038, 0.045), (0.038, -0.045))
    length: float = 0.100
    width: float = 0.070
    wall_friction: float = 0.2

    def __post_init__(self):
        check.fields(self, check.positive, mass="kg", length="m", width="m")
        check.fields(self, check.not_negative, wall_friction="1")
        x, y, z = self.centre
        centre = tuple(check.finite("centre", value, "m") for value in (x, y, z))
        object.__setattr__(self, "centre", centre)
        supports = tuple(check.vector("supports", point) for point in self.supports)
        object.__setattr__(self, "supports", supports)
        require("supports", len(supports), "the body has")
        if len(supports) < 3:
            raise InputError(
                f"supports has {len(supports)} points: must have 3 or more, or the body falls over "
                f"when the feet lift."
            )
