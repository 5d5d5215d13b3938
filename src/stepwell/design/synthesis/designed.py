"""A chain designed for a purpose, with how surely it serves it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from stepwell.base import ByValue, Drawn, Floats, told_in
from stepwell.concave import SortedChain
from stepwell.design.margins import Robustness, robustness
from stepwell.design.orders import Reached, are_relays, reached, short, switching_forces
from stepwell.design.tolerances import Critical, Yield, levers_of
from stepwell.mechanism import Chain, Element


@dataclass(frozen=True, eq=False)
class Design(ByValue, Drawn):
    """A chain that does what is wanted, and how surely.

    Attributes:
        chain: its cycle is verified by the engine, and where states were wanted, what it reaches.
        sequence: that cycle.
        loading, unloading: cells in the order in which they load and unload, 0 the innermost:
            concave ones in ascending F0 and in descending F1, elements under a prescribed force
            in those of their switching forces.
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
        """(N, 2) outer anchors q [m]; (0, 2) of elements."""
        return np.array([cell.bands[0].q for cell in levers_of(self.chain)]).reshape(-1, 2)

    @property
    def forces(self) -> Floats:
        """(T, 2) F0 and F1 of every cell [N]; of elements all their switching forces."""
        return switching_forces(self.chain)

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
        """How far all anchors, or all forces, may be off at once; None without a closed form."""
        relays = bool(self.chain.elements) and are_relays(self.chain)
        known = relays or SortedChain.of(self.chain) is not None
        return robustness(self.chain) if known else None

    @property
    def assumptions(self) -> str:
        """Under which all this holds."""
        return f"{self.standing}; yield: {self.yield_.assumptions}"

    def __str__(self):
        surely = "" if self.reached.whole else " surely"
        lines = [f"{short(self.sequence)}, {self.reached.count} states{surely} in reach"]
        placed = len({cell.bands[0].p for cell in levers_of(self.chain)}) > 1
        force, factor = told_in(self.chain.measure.force_unit)
        for name, cell in zip(self.chain.names, self.chain.cells, strict=True):
            if isinstance(cell, Element):
                fields = ", ".join(
                    f"up {up * factor:.4g} {force}, down {down * factor:.4g} {force}"
                    for up, down in cell.fields
                )
                lines.append(
                    f"{name}: force scale {cell.force_scale:.4g}, travel scale "
                    f"{cell.travel_scale:.4g}: {fields}"
                )
                continue
            (x, y), band = cell.bands[0].q, cell.bands[0]
            px, py = band.p
            inner = f"p ({px * 1e3 + 0.0:.3f}, {py * 1e3 + 0.0:.3f}) mm, " if placed else ""
            lines.append(
                f"{name}: {inner}q ({x * 1e3:.3f}, {y * 1e3:.3f}) mm, k {band.stiffness:.4g} N/m, "
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
        if self.chain.elements:
            scales = ", ".join(f"{cell.force_scale:.4g}" for cell in self.chain.elements)
            share = self.yield_.share * 100
            return f"Design({short(self.sequence)}: force scales {scales}, yield {share:.4g} %)"
        places = ", ".join(f"({x * 1e3:.4g}, {y * 1e3:.4g})" for x, y in self.anchors.tolist())
        return (
            f"Design({short(self.sequence)}: q {places} mm, yield {self.yield_.share * 100:.4g} %)"
        )
