"""A chain designed for a purpose, with how surely it serves it, or why none does."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from stepwell.base import (
    ByValue,
    Drawn,
    Floats,
    Measure,
    Shown,
    StepwellError,
    display_unit,
    to_unit,
)
from stepwell.concave import TIED, SortedChain
from stepwell.design.margins.robustness import Robustness, robustness
from stepwell.design.orders import short
from stepwell.design.switches import are_relays, switching_forces
from stepwell.design.synthesis.attempt import Attempt
from stepwell.design.targets import Reached, Target, reached
from stepwell.design.tolerances.draws import levers_of
from stepwell.design.tolerances.yields import Critical, Yield
from stepwell.mechanism import Chain, Element
from stepwell.sequences import Cycle


@dataclass(frozen=True, eq=False)
class Design(ByValue, Drawn):
    """A chain that does what is wanted, and how surely.

    Attributes:
        chain: its cycle is verified by the engine, and where states were wanted, what it reaches.
        cycle: what it does.
        yield_: the share of built mechanisms that do what was wanted, and its tolerances.
        region: the pairs (F0, F1) [N] that a cell can have: closed curves (m, 2) round them, or
            where there are holes all of them.
        holes: pitch of the drilled holes [m]; None where anchors may be anywhere.
        candidates: how many ways to build a cell were looked at first.
        proved: whether no other choice of holes is better, of those where the cell is proved.
        method: what was searched, by which objective, and what of it is proved.
        standing: what is known of the cells.
    """

    chain: Chain
    cycle: Cycle = field(repr=False)
    yield_: Yield
    region: tuple[Floats, ...] = field(repr=False)
    holes: float | None
    candidates: int
    proved: bool
    method: str
    standing: str = field(repr=False)

    @property
    def sequence(self) -> str:
        """The states of the cycle."""
        return str(self.cycle.sequence)

    @property
    def loading(self) -> tuple[int, ...]:
        """Cells in the order in which they load, 0 the innermost: concave ones in ascending F0."""
        return self.cycle.loading_order

    @property
    def unloading(self) -> tuple[int, ...]:
        """Cells in the order in which they unload; concave ones in descending F1."""
        return self.cycle.unloading_order

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
        """What can surely be reached from all cells at 0; `reached` tells whether it is all."""
        return self.reached.states

    @property
    def critical(self) -> Critical | None:
        """The two cells whose order goes wrong first."""
        return self.yield_.critical

    @cached_property
    def robustness(self) -> Robustness | None:
        """How far all anchors, or all forces, may be off at once; None without a closed form."""
        relays = self.chain.elements and are_relays(self.chain)
        return robustness(self.chain) if relays or SortedChain.of(self.chain) else None

    @property
    def assumptions(self) -> str:
        """Under which all this holds."""
        return f"{self.standing}; yield: {self.yield_.assumptions}"

    def __str__(self):
        surely = "" if self.reached.whole else " surely"
        lines = [f"{short(self.sequence)}, {self.reached.count} states{surely} in reach"]
        placed = len({cell.bands[0].p for cell in levers_of(self.chain)}) > 1
        force, factor = display_unit(self.chain.measure.force_unit)
        for name, cell in zip(self.chain.names, self.chain.cells, strict=True):
            if isinstance(cell, Element):
                scales = f"force scale {cell.force_scale:.4g}, travel scale {cell.travel_scale:.4g}"
                fields = ", ".join(
                    f"up {up * factor:.4g} {force}, down {down * factor:.4g} {force}"
                    for up, down in cell.fields
                )
                lines.append(f"{name}: {scales}: {fields}")
                continue
            band = cell.bands[0]
            px, py, x, y = (f"{to_unit(part, 'mm') + 0.0:.3f}" for part in (*band.p, *band.q))
            lines.append(
                f"{name}: {f'p ({px}, {py}) mm, ' * placed}q ({x}, {y}) mm, k "
                f"{band.stiffness:.4g} N/m, ℓ0 {to_unit(band.rest_length, 'mm'):.4g} mm, r "
                f"{to_unit(cell.lever, 'mm'):.4g} mm: F0 {cell.force_0:.4f} N, F1 "
                f"{cell.force_1:.4f} N"
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
            parts = f"force scales {scales}"
        else:
            places = to_unit(self.anchors, "mm").tolist()
            parts = f"q {', '.join(f'({x:.4g}, {y:.4g})' for x, y in places)} mm"
        return f"Design({short(self.sequence)}: {parts}, yield {self.yield_.share * 100:.4g} %)"


class Impossible(Shown, StepwellError, ValueError):
    """What is wanted cannot be had within what is allowed; `str` of it says why.

    Attributes:
        target: as text.
        proved: True for a proof, which then covers all that is allowed, as it is drawn: no choice
            does it without a tie. False where something was not tried, and the text says what.
        region: the pairs (F0, F1) [N] that a cell can have: closed curves round them, or with holes
            all of them; empty where there are none, or none was looked at.
        largest_gap: the largest smallest gap between neighbours in the wanted orders of F0 and
            F1 that can be had, or was found where nothing is proved [N]: zero where two cells
            tie, less where they change places; NaN where there are no cells to compare.
        gap_needed: it would have to be more than this, or the engine finds a tie [N].
        measure: what the forces are.
    """

    def __init__(
        self,
        target: str,
        why: str,
        *,
        proved: bool,
        allowed: str = "",
        region: Sequence[Floats] = (),
        largest_gap: float = math.nan,
        gap_needed: float = math.nan,
        measure: Measure = Measure.TRAVEL,
    ):
        self.target, self.proved, self.measure = target, proved, measure
        self.region = tuple(region)
        self.largest_gap, self.gap_needed = largest_gap, gap_needed
        verdict = ("impossible" if proved else "not found") + (allowed and f" with {allowed}")
        super().__init__(f"{short(target)}: {verdict}: {why}.")


def explained(
    target: Target, attempts: list[Attempt], mismatch: str, rest: str, allowed: str, *, proved: bool
) -> Impossible:
    """Why nothing does what is wanted, of attempts to have the end forces in its orders."""
    if not attempts:
        return Impossible(target.text, _and_rest(target.orders.why, rest, proved), proved=proved)
    nearest = max(attempts, key=lambda attempt: attempt.quality[1])
    kind = "lattice places" if nearest.holes is None else "holes"
    region: Sequence[Floats] = ()
    largest = needed = math.nan
    if any(not len(table.q) for table in nearest.tables):
        # Elsewhere than on holes there may be a place between those looked at.
        why = (
            f"at none of the {kind} of some cell is the band proved taut with falling force and "
            f"weak enough for the actuator"
        )
        advice = "allow other places or another band, tighter tolerances or a stronger actuator"
    else:
        region = nearest.region()
        needed = TIED * max(float(np.max(np.abs(table.force))) for table in nearest.tables)
        if mismatch:
            largest = nearest.smallest_gap()
            does = mismatch if target.states is not None else f"does {mismatch}"
            why = (
                f"with F0 and F1 in the wanted orders the engine finds that it {does}, as can be "
                f"with unequal levers, or where a cell overtakes another in a snap"
            )
            advice = "allow equal_levers=True, other places or other levers"
        else:
            if nearest.holes is not None and all(attempt.complete for attempt in attempts):
                largest = nearest.largest_gap()
                nodes = sum(attempt.nodes for attempt in attempts)
                holes = f"{nearest.candidates} hole{'s' * (nearest.candidates != 1)}"
                how = f"none of all choices among {holes} and bands proved concave puts"
                evidence = f"complete search, {nodes} partial choices; the largest smallest gap is"
            else:
                largest = max(attempt.smallest_gap() for attempt in attempts)
                how = f"a search from {nearest.candidates} {kind} and bands has not put"
                evidence = "not a proof; the largest smallest gap found is"
            rising = nearest.orders.rising
            first, second = (" < ".join(str(cell + 1) for cell in order) for order in rising)
            why = (
                f"{how} F0 in the order {first} and F1 in the order {second} of cells ({evidence} "
                f"{to_unit(largest, 'mN'):.4g} mN, and more than {to_unit(needed, 'mN'):.2g} mN is "
                "needed)"
            )
            advice = "allow more places or other bands"
    return Impossible(
        target.text,
        f"{_and_rest(why, rest, proved)}: {advice}",
        proved=proved,
        allowed=allowed,
        region=region,
        largest_gap=largest,
        gap_needed=needed,
    )


def _and_rest(why: str, rest: str, proved: bool) -> str:
    if rest:
        return f"{why}; {rest}, and none does it"
    return why if proved else f"{why}; other cells than these were not tried"
