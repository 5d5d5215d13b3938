"""A leg: a chain of cells behind the body, with its blocks and a foot at its outer end."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from stepwell.base import ByValue, Floats, InputError, Vec2, check
from stepwell.mechanism import Chain


@dataclass(frozen=True, slots=True, eq=False)
class Blocks(ByValue):
    """What every block of every leg weighs and how it is damped.

    Args:
        mass: of each block that moves [kg], > 0.
        carriage: of the actuator's moving part, which joins the outermost blocks [kg], > 0.
        damping: of each cell's travel [N s/m], > 0; it stands for the loss in the rubber and
            the joints.
        width, length: outline that meets walls and other legs [m], > 0.

    Raises:
        ValueError: a value out of range.
    """

    mass: float = 0.006
    carriage: float = 0.010
    damping: float = 1.0
    width: float = 0.030
    length: float = 0.020

    def __post_init__(self):
        check.fields(self, check.positive, mass="kg", carriage="kg", damping="N s/m")
        check.fields(self, check.positive, width="m", length="m")


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
        check.fields(self, check.positive, link="m", span="m", mass="kg", radius="m")
        check.fields(self, check.finite, below="m")
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

    def depth(self, travel: ArrayLike) -> Floats:
        """Depth of the tip below the pivots [m] at travels [m] of the outermost cell.

        Args:
            travel: of any shape, 0 .. 2 `link` - `span`.

        Returns:
            √(link² - (span + travel)²/4), of the same shape.
        """
        width = self.span + np.asarray(travel, float)
        return np.sqrt(np.maximum(self.link**2 - width**2 / 4.0, 0.0))

    def lever(self, travel: ArrayLike) -> Floats:
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


@dataclass(frozen=True, slots=True, eq=False)
class Leg(ByValue):
    """A chain that carries a foot.

    The innermost block is part of the body and the chain extends backwards, so that a cell
    that opens while the foot is planted drives the body forward. The last cell lifts the
    foot, the cells before it make the step.

    Args:
        name: what messages and figures call it.
        chain: two cells or more, inner first, driven by a prescribed stroke.
        at: (x, y) of the foot [m] from the body's origin with every cell at 0; x forward,
            y left. Anchors' first coordinate points away from the midline.

    Raises:
        ValueError: too short a chain, or one with an actuator of its own stiffness.
    """

    name: str
    chain: Chain
    at: Vec2

    def __post_init__(self):
        check.fields(self, check.vector, at="m")
        if len(self.chain) < 2:
            raise InputError(
                f"leg {self.name!r} has {len(self.chain)} cell: must have 2 or more; the last "
                f"one lifts the foot and those before it make the step."
            )
        if self.chain.elements:
            raise InputError(
                f"leg {self.name!r} has elements: must have cells of levers and bands alone, whose "
                f"blocks carry the foot."
            )
        if self.chain.actuator_stiffness != float("inf"):
            raise InputError(
                f"leg {self.name!r}: actuator_stiffness = {self.chain.actuator_stiffness:g} N/m: "
                f"must be infinite; the stiffness that a robot's legs share is the drive's."
            )

    @property
    def side(self) -> int:
        """+1 for a leg on or left of the midline, -1 for one right of it."""
        return 1 if self.at[1] >= 0 else -1

    @property
    def stroke(self) -> float:
        """Σ S_i over the cells that make the step [m]: u_max, the most one cycle can advance."""
        return self.chain.full_stroke - self.chain.cells[-1].full_travel

    def with_anchors(self, cell: int | str, p: Vec2 | None = None, q: Vec2 | None = None) -> Leg:
        """The same leg with the anchors of one cell moved.

        Args:
            cell: index, 0 for the innermost, or a name.
            p, q: anchors [m]; None leaves them.

        Returns:
            The new leg.

        Raises:
            ValueError: no such cell, or anchors that no cell can have.
        """
        index = self.cell_index(cell)
        cells = list(self.chain.levers)
        cells[index] = cells[index].with_anchors(p, q)
        return replace(self, chain=replace(self.chain, cells=tuple(cells)))

    def with_moved_anchor(self, cell: int | str, moves: Vec2, share: float = 1.0) -> Leg:
        """The same leg with the anchor p of one cell moved by `share` [1] of `moves` [m].

        Raises:
            ValueError: no such cell, or an anchor that no cell can have.
        """
        p = self.chain.levers[self.cell_index(cell)].bands[0].p
        return self.with_anchors(cell, p=(p[0] + share * moves[0], p[1] + share * moves[1]))

    def cell_index(self, cell: int | str) -> int:
        """The index of a cell, 0 for the innermost, given that index or its name.

        Raises:
            ValueError: no such cell.
        """
        names = self.chain.names
        if isinstance(cell, str) and cell in names:
            return names.index(cell)
        if isinstance(cell, int) and 0 <= cell < len(names):
            return cell
        given = f"{cell + 1} (index {cell} in Python)" if isinstance(cell, int) else repr(cell)
        raise InputError(
            f"leg {self.name!r} has no cell {given}: must be one of {', '.join(map(repr, names))}, "
            f"or a number up to {len(names)} (index {len(names) - 1} in Python)."
        )
