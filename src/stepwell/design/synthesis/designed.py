"""Result of the inverse design: a chain with its yield, or the reason why there is none."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from stepwell import base
from stepwell.base import ByValue, Drawn, Floats, Measure, Shown, StepwellError
from stepwell.concave import TIED, SortedChain
from stepwell.design.margins.robustness import Robustness, robustness
from stepwell.design.orders import short
from stepwell.design.switches import are_relays, switching_forces
from stepwell.design.synthesis.attempt import Attempt
from stepwell.design.synthesis.evidence import Evidence
from stepwell.design.synthesis.region import BandType, HoleGrid, fits_grid, shown_mm
from stepwell.design.synthesis.slack import RegionsOf, slack_advice
from stepwell.design.targets import Reached, Target, reached
from stepwell.design.tolerances.draws import levers_of
from stepwell.design.tolerances.yields import Critical, Yield
from stepwell.mechanism import Chain, Element
from stepwell.sequences import Cycle

if TYPE_CHECKING:
    from stepwell.proof import ProvedDesign, ProvedImpossible


@dataclass(frozen=True, eq=False)
class Design(ByValue, Drawn):
    """A chain that reaches the target, with its yield.

    Attributes:
        chain: the nominal design. Its cycle, and for target states its reachable states, are
            verified by simulation.
        cycle: its full cycle.
        yield_: fraction of samples that reach the target, with the tolerances.
        region: feasible pairs (F0, F1) [N] of a cell: closed curves (m, 2) around them, or all of
            them for holes.
        holes: grid of the drilled holes, with `pitch` and `origin` [m]; None for anchors anywhere.
        candidates: number of candidates for a cell in the first step.
        proved: whether no other choice of holes with proved cells is better.
        method: what was searched, the objective, and what is proved.
        standing: what is proved or assumed for the cells.
        bands: type of band of each cell, and number of its equal bands, which are one in `chain`;
            empty for elements.
    """

    chain: Chain
    cycle: Cycle = field(repr=False)
    yield_: Yield
    region: tuple[Floats, ...] = field(repr=False)
    holes: HoleGrid | None
    candidates: int
    proved: bool
    method: str
    standing: str = field(repr=False)
    bands: tuple[tuple[BandType, int], ...] = field(repr=False)

    @property
    def bands_used(self) -> str:
        """Bands of each type in words; "" for one band a cell from packs without a limit."""
        if all(count == 1 and band.pack is None for band, count in self.bands):
            return ""
        numbers: dict[BandType, list[int]] = {}
        for band, count in self.bands:
            numbers.setdefault(band, []).append(count)
        shown = [
            f"{' + '.join(map(str, each))} of "
            f"{band.name or f'{band.stiffness:.4g} N/m'}"
            f"{'' if band.pack is None else f', pack of {band.pack}'}"
            for band, each in numbers.items()
        ]
        return "; ".join(shown)

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
        """States reachable from all cells at 0, and whether the list is complete."""
        return reached(self.chain)

    @property
    def states(self) -> tuple[str, ...]:
        """States proved reachable from all cells at 0; `reached` states whether these are all."""
        return self.reached.states

    @property
    def critical(self) -> Critical | None:
        """The two cells whose order is most often reversed."""
        return self.yield_.critical

    @cached_property
    def robustness(self) -> Robustness | None:
        """Largest deviation of all anchors, or forces, at once; None without a closed form."""
        relays = self.chain.elements and are_relays(self.chain)
        return robustness(self.chain) if relays or SortedChain.of(self.chain) else None

    def prove(self, progress: base.Progress = None) -> "ProvedDesign":
        """Prove the cycle, the margin, and the sequence of all machines within the tolerances.

        Needs python-flint, the extra `proof`.

        Args:
            progress: called with (done, total) changes of the margin.

        Raises:
            ExtraError: python-flint is not installed.

        Source: ours (theory page, "Proofs").
        """
        from stepwell import proof

        return proof.prove_design(self, progress)

    @property
    def off_grid(self) -> str:
        """The anchors that are in no hole of the grid, and the remedy; "" for none."""
        grid = self.holes
        if grid is None:
            return ""
        bands = [cell.bands[0] for cell in levers_of(self.chain)]
        places = dict.fromkeys((name, getattr(one, name)) for one in bands for name in "pq")
        off = [(name, place) for name, place in places if not fits_grid(place, grid)]
        if not off:
            return ""
        named = ", ".join(f"{name} {shown_mm(place)} mm" for name, place in off)
        x, y = (base.to_unit(one, "mm") + 0.0 for one in off[0][1])
        ways = ["--free both, where p = -q"] * grid.mirrored
        ways.append(f"--origin {x:.9g}:{y:.9g}, a grid through {off[0][0]}")
        return f"{named}: drill it separately, or search with {', or '.join(ways)}"

    @property
    def assumptions(self) -> str:
        """Assumptions of the design and its yield."""
        return f"{self.standing}; yield: {self.yield_.assumptions}"

    def __str__(self):
        least = "" if self.reached.whole else "at least "
        lines = [f"{short(self.sequence)}, {least}{self.reached.count} reachable states"]
        placed = len({cell.bands[0].p for cell in levers_of(self.chain)}) > 1
        force, factor = base.display_unit(self.chain.measure.force_unit)
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
            px, py, x, y = (f"{base.to_unit(part, 'mm') + 0.0:.3f}" for part in (*band.p, *band.q))
            lines.append(
                f"{name}: {f'p ({px}, {py}) mm, ' * placed}q ({x}, {y}) mm, k "
                f"{band.stiffness:.4g} N/m, ℓ0 {base.to_unit(band.rest_length, 'mm'):.4g} mm, r "
                f"{base.to_unit(cell.lever, 'mm'):.4g} mm: F0 {cell.force_0:.4f} N, F1 "
                f"{cell.force_1:.4f} N"
            )
        low, high = self.yield_.interval
        lines.append(
            f"yield {self.yield_.fraction * 100:.4g} % (95 % confidence: {low * 100:.4g} to "
            f"{high * 100:.4g} %), {self.yield_.tolerances!r}"
        )
        if self.critical is not None:
            lines.append(f"critical: {self.critical}")
        if self.robustness is not None:
            lines.append(str(self.robustness))
        bands = f"bands by cell: {self.bands_used}" * bool(self.bands_used)
        return "\n".join([*lines, self.method, *filter(None, [bands, self.off_grid])])

    def __repr__(self):
        if self.chain.elements:
            scales = ", ".join(f"{cell.force_scale:.4g}" for cell in self.chain.elements)
            parts = f"force scales {scales}"
        else:
            places = base.to_unit(self.anchors, "mm").tolist()
            parts = f"q {', '.join(f'({x:.4g}, {y:.4g})' for x, y in places)} mm"
        return f"Design({short(self.sequence)}: {parts}, yield {self.yield_.fraction * 100:.4g} %)"


class Impossible(Shown, StepwellError, ValueError):
    """No allowed design reaches the target; its text states the reason.

    Attributes:
        target: as text.
        why: the reason alone.
        proved: True for a proof, which covers all allowed nominal designs: none reaches the target
            without a tie. False if some were not tried; the text states which.
        region: feasible pairs (F0, F1) [N] of a cell: closed curves around them, or all of them
            for holes; empty if there are none, or none was computed.
        largest_gap: the largest smallest gap between neighbours in the target orders of F0 and
            F1, or the largest found if nothing is proved [N]: zero if two cells tie, negative if
            they are in the other order; NaN without cells to compare.
        gap_needed: the gap has to be larger than this, or the engine reports a tie [N].
        measure: kind of the forces.
        evidence: what was excluded, for a proof; None if nothing was as a whole.
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
        evidence: Evidence | None = None,
    ):
        self.target, self.why, self.proved, self.measure = target, why, proved, measure
        self.evidence = evidence
        self.region = tuple(region)
        self.largest_gap, self.gap_needed = largest_gap, gap_needed
        verdict = ("impossible" if proved else "not found") + (allowed and f" with {allowed}")
        super().__init__(f"{short(target)}: {verdict}: {why}.")

    def prove(self, progress: base.Progress = None) -> "ProvedImpossible":
        """Prove with enclosures that no allowed design reaches the target.

        Needs python-flint, the extra `proof`.

        Args:
            progress: called with (done, total) choices.

        Raises:
            ExtraError: python-flint is not installed.

        Source: ours (theory page, "Proofs within tolerances").
        """
        from stepwell import proof

        return proof.prove_impossible(self, progress)


def _without_candidates(nearest: Attempt) -> tuple[str, str]:
    """Why a cell has no candidate, and what to change."""
    # Elsewhere than on holes there may be a place between those looked at.
    within = " within the tolerances" * (not nearest.rule.as_drawn)
    limited = math.isfinite(nearest.rule.most_force)
    limit = ", below the force limit of the actuator" * limited
    why = (
        f"for some cell, at none of the {_places(nearest)} is the {nearest.bands} proved to stay "
        f"in tension with falling force{within}{limit}"
    )
    force = ", a stronger actuator" * limited
    return why, f"use a larger region, longer levers{force} or another band"


def _too_close(attempts: list[Attempt], nearest: Attempt, needed: float) -> tuple[str, float]:
    """Why no choice has the target orders, and the largest gap of the forces [N]."""
    if nearest.holes is not None and all(attempt.complete for attempt in attempts):
        largest = nearest.largest_gap()
        nodes = sum(attempt.nodes for attempt in attempts)
        holes = f"{nearest.candidates} hole{'s' * (nearest.candidates != 1)}"
        how = f"no choice among {holes} and bands proved concave gives"
        found = f"complete search, {nodes} partial choices; the smallest gap is at most"
    else:
        largest = max(attempt.smallest_gap() for attempt in attempts)
        how = f"a search from {nearest.candidates} {_places(nearest)} and bands has not found"
        found = "not a proof; the smallest gap found is"
    rising = nearest.orders.rising
    first, second = (" < ".join(str(cell + 1) for cell in order) for order in rising)
    why = (
        f"{how} F0 in the order {first} and F1 in the order {second} of cells ({found} "
        f"{base.to_unit(largest, 'mN'):.4g} mN; more than "
        f"{base.to_unit(needed, 'mN'):.2g} mN is needed)"
    )
    return why, largest


def _places(attempt: Attempt) -> str:
    return "lattice places" if attempt.holes is None else "holes"


def explained(
    target: Target,
    attempts: list[Attempt],
    words: tuple[str, str, str],
    regions_of: RegionsOf,
    evidence: Evidence | None,
    *,
    proved: bool,
) -> Impossible:
    """The error that states why no attempt brings the critical forces into the target orders.

    The words are those on what a better candidate does, on the rest, and on what is allowed.
    """
    mismatch, rest, allowed = words
    if not attempts:
        why = _and_rest(target.orders.why, rest, proved)
        return Impossible(target.text, why, proved=proved, evidence=evidence)
    nearest = max(attempts, key=lambda attempt: attempt.quality[1])
    region: Sequence[Floats] = ()
    largest = needed = math.nan
    if any(not len(table.q) for table in nearest.tables):
        why, advice = _without_candidates(nearest)
    else:
        region = nearest.region()
        needed = TIED * max(float(np.max(np.abs(table.force))) for table in nearest.tables)
        if mismatch:
            largest = nearest.smallest_gap()
            own = target.states is not None or target.requirements is not None
            does = mismatch if own else f"gives {mismatch}"
            why = (
                f"the chain with F0 and F1 in the target orders {does} in the simulation, because "
                f"of unequal levers or a snap in which a cell passes another"
            )
            advice = _other_levers(nearest)
        else:
            why, largest = _too_close(attempts, nearest, needed)
            advice = f"allow a larger region{', finer holes' * bool(nearest.holes)} or other bands"
    if not mismatch:
        slack, sizes = slack_advice(nearest, regions_of)
        why, advice = f"{why}; {slack}" if slack else why, sizes or advice
    return Impossible(
        target.text,
        f"{_and_rest(why, rest, proved)}: {advice}",
        proved=proved,
        allowed=allowed,
        region=region,
        largest_gap=largest,
        gap_needed=needed,
        evidence=evidence,
    )


def _other_levers(attempt: Attempt) -> str:
    mixed = len({kind.lever for kind in attempt.rule.kinds}) > 1
    return f"try {'equal_levers=True, ' * mixed}another region or other levers"


def _and_rest(why: str, rest: str, proved: bool) -> str:
    if rest:
        return f"{why}; {rest}, and none reaches the target"
    return why if proved else f"{why}; other cells were not tried"
