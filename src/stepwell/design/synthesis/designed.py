"""A chain designed for a purpose, with how surely it serves it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from stepwell.base import ByValue, Floats
from stepwell.concave import SortedChain
from stepwell.design.margins import Robustness, robustness
from stepwell.design.orders import Reached, reached, short
from stepwell.design.tolerances import Critical, Yield
from stepwell.mechanism import Chain


@dataclass(frozen=True, eq=False)
class Design(ByValue):
    """A chain that does what is wanted, and how surely.

    Attributes:
        chain: its cycle is verified by the engine, and where states were wanted, what it reaches.
        sequence: that cycle.
        loading, unloading: cells in the order in which they load and unload, 0 the innermost:
            concave ones in ascending F0 and in descending F1.
        yield_: the share of built mechanisms that do what was wanted, and its tolerances.
        region: the pairs (F0, F1) [N] that a cell can have: closed curves (m, 2) round them, or
            where there are holes all of them.
        holes: pitch of the drilled holes [m]; None where anchors may be anywhere.
        candidates: how many ways to build a cell were looked at first.
        proved: whether no other choice of holes is better by the objective, of those where the
            band is proved taut with falling force.
        method: what was searched, by which objective, and what of it is proved.
        standing: what is known of the cells.
    """

    chain: Chain
    sequence: str
    loading: tuple[int, ...]
    unloading: tuple[int, ...]
    yield_: Yield
    region: tuple[Floats, ...] = field(repr=False)
    holes: float | None
    candidates: int
    proved: bool
    method: str
    standing: str = field(repr=False)

    @property
    def anchors(self) -> Floats:
        """(N, 2) outer anchors q [m]."""
        return np.array([cell.bands[0].q for cell in self.chain.cells])

    @property
    def forces(self) -> Floats:
        """(N, 2) F0 and F1 of every cell [N]."""
        return np.array([(cell.force_0, cell.force_1) for cell in self.chain.cells])

    @cached_property
    def reached(self) -> Reached:
        """The states that can be reached from all cells at 0, and whether these are all."""
        return reached(self.chain)

    @property
    def states(self) -> tuple[str, ...]:
        """What can surely be reached from all cells at 0, turning back early included.

        `reached` tells whether it is all.
        """
        return self.reached.states

    @property
    def critical(self) -> Critical | None:
        """The two cells whose order goes wrong first."""
        return self.yield_.critical

    @cached_property
    def robustness(self) -> Robustness | None:
        """How far all anchors may be off at once; None without a closed form."""
        return None if SortedChain.of(self.chain) is None else robustness(self.chain)

    @property
    def assumptions(self) -> str:
        """Under which all this holds."""
        return f"{self.standing}; yield: {self.yield_.assumptions}"

    def __str__(self):
        surely = "" if self.reached.whole else " surely"
        lines = [f"{short(self.sequence)}, {self.reached.count} states{surely} in reach"]
        for name, cell in zip(self.chain.names, self.chain.cells, strict=True):
            (x, y), band = cell.bands[0].q, cell.bands[0]
            lines.append(
                f"{name}: q ({x * 1e3:.3f}, {y * 1e3:.3f}) mm, k {band.stiffness:.4g} N/m, "
                f"ℓ0 {band.rest_length * 1e3:.4g} mm, r {cell.lever * 1e3:.4g} mm: "
                f"F0 {cell.force_0:.4f} N, F1 {cell.force_1:.4f} N"
            )
        low, high = self.yield_.interval
        lines.append(
            f"yield {self.yield_.share * 100:.4g} % (95 % confidence: {low * 100:.4g} to "
            f"{high * 100:.4g} %), {self.yield_.tolerances!r}"
        )
        if self.critical is not None:
            lines.append(f"critical: {self.critical}")
        if self.robustness is not None:
            lines.append(str(self.robustness))
        return "\n".join([*lines, self.method])

    def __repr__(self):
        places = ", ".join(f"({x * 1e3:.4g}, {y * 1e3:.4g})" for x, y in self.anchors.tolist())
        return (
            f"Design({short(self.sequence)}: q {places} mm, yield {self.yield_.share * 100:.4g} %)"
        )
