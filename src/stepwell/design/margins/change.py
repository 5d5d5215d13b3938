"""The smallest change of one anchor, or of one number, that alters the sequence."""

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from stepwell.base import ByValue, brief
from stepwell.concave import SortedChain
from stepwell.design.margins.numbers import changed_by, nearest_share
from stepwell.design.parameters import of_cell
from stepwell.design.plane import Method
from stepwell.mechanism import Chain
from stepwell.sequences import Sequence, cycle
from stepwell.statics import StaticsError

# Cells of the longest chain whose sequence past each change is computed unasked: it takes a cycle.
LONGEST_FOLLOWED = 12


@dataclass(frozen=True, eq=False)
class Change(ByValue):
    """The smallest change of one thing about one cell after which the chain does otherwise.

    Attributes:
        chain: the design as it is.
        cell: whose anchor or number it is, 0 the innermost.
        parameter: "anchor" (q on the outer block; moving p the opposite way is the same) or
            "stiffness" (of all bands of the cell); of an element "force_scale", "travel_scale" or
            "friction".
        distance: how far that is: [m], or the fraction of the number, of friction that of the
            element's largest force; infinite where nothing within reach changes the sequence.
        move: (dx, dy) [m] that brings the anchor there, or the signed fraction; NaN if infinite.
        past: the same a hair further, where the sequence is another one already.
        method: exact, or a search.
    """

    chain: Chain = field(repr=False)
    cell: int
    parameter: str
    distance: float
    move: tuple[float, float] | float
    past: tuple[float, float] | float = field(repr=False)
    method: Method

    @property
    def design(self) -> Chain | None:
        """The chain just past the change; None where there is no change."""
        if np.isinf(self.distance):
            return None
        if isinstance(self.past, tuple):
            return of_cell(self.chain, self.cell, "q").displaced(self.chain, self.past)
        return changed_by(self.chain, of_cell(self.chain, self.cell, self.parameter), self.past)

    @cached_property
    def becomes(self) -> str:
        """The sequence just past the change, by the engine; empty where there is no change."""
        if self.design is None:
            return ""
        try:
            return str(cycle(self.design).sequence)
        except StaticsError as failure:
            return f"no answer: {failure}"

    def __str__(self):
        if np.isinf(self.distance):
            return f"{self.parameter}: none within reach"
        if isinstance(self.move, tuple):
            x, y = self.move
            return (
                f"anchor: {self.distance * 1e3:.4g} mm "
                f"(move q by ({x * 1e3:+.4g}, {y * 1e3:+.4g}) mm)"
            )
        of = " of the largest force" if self.parameter == "friction" else ""
        return f"{self.parameter}: {self.move * 100:+.4g} %{of}"

    def __repr__(self):
        return brief(self)


def number_change(
    chain: Chain, forces: SortedChain | None, now: Sequence, cell: int, part: str
) -> Change:
    """The smallest change of a number of a cell that changes the sequence.

    Args:
        chain: any number of cells.
        forces: the chain in closed form, None where that is not proved.
        now: what it does.
        cell: whose number it is; of bands, of all alike.
        part: "stiffness", "force_scale", "travel_scale" or "friction".
    """
    found = nearest_share(chain, forces, str(now), of_cell(chain, cell, part))
    far = math.inf if math.isnan(found.share) else abs(found.share)
    return Change(chain, cell, part, far, found.share, found.past, found.method)
