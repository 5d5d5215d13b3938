"""The smallest change of one anchor or one stiffness that alters the sequence."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from stepwell.base import ByValue
from stepwell.design.parameters import of_cell
from stepwell.design.plane import Method
from stepwell.mechanism import Chain
from stepwell.sequences import cycle
from stepwell.statics import StaticsError


@dataclass(frozen=True, eq=False)
class Change(ByValue):
    """The smallest change of one thing about one cell after which the chain does otherwise.

    Attributes:
        chain: the design as it is.
        cell: whose anchor or stiffness it is, 0 the innermost.
        parameter: "anchor" (q on the outer block; moving p the opposite way is the same) or
            "stiffness" (of all bands of the cell).
        distance: how far that is: [m], or the fraction of the stiffness; infinite where
            nothing within reach changes the sequence.
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
        return of_cell(self.chain, self.cell, "stiffness").scaled(self.chain, 1.0 + self.past)

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
        return f"stiffness: {self.move * 100:+.4g} %"
