"""The V of two links that hangs from a leg's two outermost blocks, with the foot at its tip."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stepwell.base import ByValue, InputError, check


@dataclass(frozen=True, slots=True, eq=False)
class Foot(ByValue):
    """A foot at the tip of a V of two equal links.

    The V hangs from the outermost block and the one before it. When the outermost cell opens
    by a travel s, its pivots are `span` + s apart and the foot rises.

    Args:
        link: length of each link [m], > 0.
        span: distance of the two pivots with the outermost cell at 0 [m], > 0.
        mass: of the foot [kg], > 0.
        below: how far the feet stand below the plane of the supports with every cell
            at 0 [m], >= 0.
        radius: of the ball that touches the floor [m], > 0.

    Raises:
        ValueError: a value out of range, or pivots further apart than two links reach.

    Source: Kamp et al. 2024, Fig. 3, for the idea, their notes for `link`, `span` and `mass`;
    `below` and `radius` are ours.
    """

    link: float = 0.035
    span: float = 0.040
    mass: float = 0.0066
    below: float = 0.0009
    radius: float = 0.004

    def __post_init__(self):
        for name, unit in (("link", "m"), ("span", "m"), ("mass", "kg"), ("radius", "m")):
            object.__setattr__(self, name, check.positive(name, getattr(self, name), unit))
        object.__setattr__(self, "below", check.finite("below", self.below, "m"))
        if self.below < 0:
            raise InputError(
                f"below = {self.below * 1e3:.6g} mm: must be >= 0; feet above the plane of the "
                f"supports never touch the floor."
            )
        if self.span >= 2 * self.link:
            raise InputError(
                f"span = {self.span * 1e3:.6g} mm: must be < {2e3 * self.link:.6g} mm, the two "
                f"links stretched out; use longer links."
            )

    def depth(self, travel: ArrayLike) -> NDArray[np.float64]:
        """Depth of the tip below the pivots [m] at travels [m] of the outermost cell.

        Args:
            travel: of any shape, 0 .. 2 `link` - `span`.

        Returns:
            √(link² - (span + travel)²/4), of the same shape.
        """
        width = self.span + np.asarray(travel, float)
        return np.sqrt(np.maximum(self.link**2 - width**2 / 4.0, 0.0))

    def lever(self, travel: ArrayLike) -> NDArray[np.float64]:
        """Force that opens the outermost cell per newton that the foot carries [1].

        By virtual work -d(depth)/d(travel) = (span + travel) / (4 depth).

        Args:
            travel: of any shape [m].

        Returns:
            The ratio, of the same shape.
        """
        width = self.span + np.asarray(travel, float)
        return width / (4.0 * self.depth(travel))

    @property
    def contact_travel(self) -> float:
        """Travel of the outermost cell [m] past which the supports carry the body alone."""
        depth = float(self.depth(0.0)) - self.below
        if depth <= 0.0:
            return 2 * self.link - self.span
        return 2.0 * math.sqrt(self.link**2 - depth**2) - self.span
