"""A leg: a chain of cells behind the body, with a foot at its outer end."""

from __future__ import annotations

from dataclasses import dataclass, replace

from stepwell.base import ByValue, InputError, Vec2, check
from stepwell.mechanism import Chain


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
        object.__setattr__(self, "at", check.vector("at", self.at))
        if len(self.chain) < 2:
            raise InputError(
                f"leg {self.name!r} has {len(self.chain)} cell: must have 2 or more; the last "
                f"one lifts the foot and those before it make the step."
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
        cells = list(self.chain.cells)
        cells[index] = cells[index].with_anchors(p, q)
        return replace(self, chain=replace(self.chain, cells=tuple(cells)))

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
        told = f"{cell + 1} (index {cell} in Python)" if isinstance(cell, int) else repr(cell)
        raise InputError(
            f"leg {self.name!r} has no cell {told}: must be one of {', '.join(map(repr, names))}, "
            f"or a number up to {len(names)} (index {len(names) - 1} in Python)."
        )
