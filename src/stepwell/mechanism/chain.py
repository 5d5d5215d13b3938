"""A serial chain of unit cells and the actuator that drives it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from stepwell.base import REACH, ByValue, Drawn, InputError, Measure, finite, require, short
from stepwell.mechanism import phase, sizes
from stepwell.mechanism.cell import Cell
from stepwell.mechanism.element import Element
from stepwell.mechanism.law import ends_of, packed

if TYPE_CHECKING:
    from stepwell.design import Margin, Reprogramming, Robustness, Survival, Tolerances, Yield
    from stepwell.sequences import Cycle, ImplicitGraph, Program, TransitionGraph
    from stepwell.statics import Configuration, Path

# Springs of an actuator [N/m]. A double has a relative precision of 1e-16: behind a softer spring
# the drive λ/K hides the strokes, behind a stiffer one the strokes hide λ/K.
SOFTEST, STIFFEST = 1e-6, 1e12


@dataclass(frozen=True, slots=True, eq=False)
class Chain(ByValue, Drawn):
    """Cells in series: the innermost block is fixed, the outermost is displaced.

    Args:
        cells: (N,) cells and elements, inner first, all of one measure.
        actuator_stiffness: K [N/m] of the spring between the actuator and the outermost
            block, 1e-6 to 1e12; or infinite for a prescribed stroke (the paper), or 0 for a
            prescribed force.
        title: name of the chain in reports.

    Raises:
        ValueError: no cells, cells of different measures, or a stiffness out of range.

    Source: Kamp et al. 2024, Fig. 2.
    """

    cells: Sequence[Cell | Element]
    actuator_stiffness: float = math.inf
    title: str = ""

    def __post_init__(self):
        object.__setattr__(self, "cells", _as_cells(self.cells))
        require("cells", len(self.cells), "the chain has")
        stiffness, unit = self.actuator_stiffness, self.measure.stiffness_unit
        softest, stiffest = SOFTEST, STIFFEST
        if self.measure is not Measure.TRAVEL:
            # For other measures the limits are relative to the stiffness of the cells.
            size = max(c.largest_force for c in self.elements) / self.full_stroke
            softest, stiffest = 1e-8 * size, 1e10 * size
        if stiffness != math.inf:
            stiffness = finite("actuator_stiffness", stiffness, unit)
        if stiffness not in (0.0, math.inf) and not softest <= stiffness <= stiffest:
            raise InputError(
                f"actuator_stiffness = {stiffness:g} {unit}: must be from {short(softest)} to "
                f"{short(stiffest)}; use math.inf for a prescribed stroke and 0 for a prescribed "
                f"force."
            )
        object.__setattr__(self, "actuator_stiffness", float(stiffness))

    def __len__(self) -> int:
        return len(self.cells)

    @property
    def full_stroke(self) -> float:
        """Σ S_i [m]: the stroke with every cell at 1."""
        return math.fsum(self.full_travels)

    @property
    def stroke_range(self) -> tuple[float, float]:
        """Least and largest Σ s [m]: open ends go on as far as any force of the chain pulls."""
        return ends_of(packed(self.cells)[1])

    @property
    def full_travels(self) -> tuple[float, ...]:
        """S_i [m] of every cell."""
        return tuple([cell.full_travel for cell in self.cells])

    @property
    def drive_unit(self) -> str:
        """SI unit of what the actuator prescribes: that of travel, or of force."""
        measure = self.measure
        return measure.force_unit if self.actuator_stiffness == 0 else measure.travel_unit

    @property
    def measure(self) -> Measure:
        """What travel and force are in this chain."""
        return self.cells[0].measure

    @property
    def elements(self) -> tuple[Element, ...]:
        """The cells that are elements."""
        return tuple(cell for cell in self.cells if isinstance(cell, Element))

    @property
    def levers(self) -> tuple[Cell, ...]:
        """The cells of a chain of lever cells.

        Raises:
            ValueError: a chain with an element; the text names the first one.
        """
        for i, cell in enumerate(self.cells):
            if isinstance(cell, Element):
                raise InputError(
                    f"cells[{i}] = {cell!r}: must be a Cell, because an element has no levers or "
                    f"bands. Use a chain of cells alone."
                )
        return tuple(cell for cell in self.cells if isinstance(cell, Cell))

    @property
    def phases(self) -> tuple[tuple[phase.Phase, ...], ...]:
        """The phases of every cell: digit k of a state stands for phase k of its cell."""
        return tuple(cell.phases for cell in self.cells)

    @property
    def stretches(self) -> tuple[tuple[phase.Stretch, ...], ...]:
        """Sheet and travels [m] of every phase of every cell."""
        return tuple(cell.stretches for cell in self.cells)

    @property
    def first_state(self) -> str:
        """The state with every cell in its first phase, such as "000"."""
        return "0" * len(self.cells)

    @property
    def last_state(self) -> str:
        """The state with every cell in its last phase, such as "111"."""
        return "".join(str(len(stretches) - 1) for stretches in self.stretches)

    @property
    def unusual(self) -> bool:
        """Whether one of its cells is `unusual`; then numbers are not checked for unit errors."""
        return any(cell.unusual for cell in self.cells)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the cells: their own, else inner/outer or their number from inside."""
        n = len(self.cells)
        own = ("inner", "outer") if n == 2 else [f"cell {i}" for i in range(1, n + 1)]
        return tuple(cell.name or name for cell, name in zip(self.cells, own, strict=True))

    def path(
        self,
        turning_points: Sequence[float],
        *,
        start: str | Configuration | Sequence[float] | None = None,
        prefer: Sequence[int] | None = None,
        progress: Callable[[float, float], None] | None = None,
    ) -> Path:
        """Follow the chain's local energy minimum exactly while the actuator turns at these points.

        Args:
            turning_points: (m,) actuator positions [m], or forces [N] where its stiffness is 0.
            start: state such as "010", (N,) travels [m], or the `end_configuration` of another
                path; all cells at 0 by default.
            prefer: cells by falling priority for ties; by default the first by its force, then
                the innermost, and cells of constant force share the motion.
            progress: called now and then with (done, total) of the way of the actuator.

        Raises:
            ValueError: turning points out of range, or probably in another unit, or a start that
                is no stable equilibrium.
            StaticsError: the path cannot be computed, or fails its own certificate; the text
                contains the place and a possible action.

        Source: the equilibria are those of Kamp et al. 2024, Eqs. 1, 2 and 5; following them
        through snaps is ours (theory page).
        """
        from stepwell import statics

        slips = sizes.drives(self, turning_points)
        if slips:
            raise sizes.SlipError(slips, "")
        return statics.path(self, turning_points, start=start, prefer=prefer, progress=progress)

    def cycle(
        self,
        *,
        prefer: Sequence[int] | None = None,
        progress: Callable[[float, float], None] | None = None,
    ) -> Cycle:
        """Compute one full cycle: load the chain fully and unload it.

        A rigid actuator goes 0 → Σ S_i → 0. A compliant actuator, or a prescribed force, goes far
        enough to pull every cell to its stop and back. `prefer`, `progress` and StaticsError are as
        for `path`.

        Source: Kamp et al. 2024, Fig. 2.
        """
        from stepwell import sequences

        return sequences.cycle(self, prefer=prefer, progress=progress)

    def graph(
        self,
        drive: str | float | None = None,
        *,
        start: str | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> TransitionGraph:
        """The transition graph of a chain.

        Args:
            drive: "stroke", "force" or the words of its measure, such as "volume" and "pressure";
                or the stiffness of the actuator [N/m]; that of the chain by default.
            start: a state such as "000", for the states reachable from it only; by default all
                states in which the chain can stand, states set by hand included.
            progress: called with (done, total) starts, then with (followed, known) branches.

        Raises:
            ValueError: friction, a start that is no equilibrium, too many states, or too many
                branches.
            StaticsError: a path cannot be computed; its text contains a possible action.
        """
        from stepwell import sequences

        return sequences.graph(self, drive, start=start, progress=progress)

    def implicit_graph(self, drive: str | float | None = None) -> ImplicitGraph:
        """The transition graph of a chain of any length, computed state by state on demand.

        It counts states, computes the window of a state and the transitions at its ends, and walks
        from state to state. `drive` is as for `graph`; friction and an unknown drive raise
        ValueError.
        """
        from stepwell import sequences

        return sequences.implicit_graph(self, drive)

    def program(
        self,
        target: str,
        *,
        start: str | None = None,
        robust: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> Program:
        """The shortest list of turning points of the actuator from one state to another.

        Args:
            target: state at the end, such as "01", inner cell first.
            start: state at the beginning; all cells at 0 by default.
            robust: a ratio, such as 10: the program has to work for all ratios of cell mobilities
                up to this one. Then every landing of the program holds within it, as of
                `Path.landings`, or its turning states are proved independent of landings.
            progress: called with (done, total) during a search.

        Returns:
            Among the compared programs with the fewest turns, the one whose narrowest window is
            widest. Its `landings` contain which landings are proved and which are sampled.

        Raises:
            Unreachable: no program reaches the target; the text is the proof, or describes the
                search, or names the landing that depends on the mobilities.
            ValueError: a state that this chain cannot have, or in which it cannot stand, or a ratio
                outside the range of `Path.landings`.

        Source: ours (theory page, "Stroke programs").
        """
        from stepwell import sequences

        return sequences.program(self, target, start=start, robust=robust, progress=progress)

    def margin(
        self, *, reach: float = REACH, progress: Callable[[int, int], None] | None = None
    ) -> Margin:
        """Largest change of each anchor and each stiffness that keeps the sequence.

        One parameter varies at a time; elements vary all forces, all travels, and their friction.
        If all cells are proved concave under a rigid actuator and have equal full travels, the
        sequence changes exactly when two neighbours in the order of F0 or of F1 change places. Then
        the nearest such anchor is exact to rounding, and the ratio of stiffness is a quotient of
        forces; the same holds for elements under a prescribed force. Where that proof fails, the
        general engine searches around the anchor and the method is "search". The anchor is that of
        `reprogram(chain, None, "<cell>.q")`.

        Args:
            reach: largest displacement of an anchor [m], > 0 (else ValueError); a distance is
                infinite if no displacement within reach changes the sequence.
            progress: called with (done, total) changes.

        Source: sorting theorem, theory page; after Kamp et al. 2024, Fig. 2C.
        """
        from stepwell.design import margin

        return margin(self, reach=reach, progress=progress)

    def yields(
        self,
        tolerances: Tolerances | None = None,
        *,
        samples: int | None = None,
        seed: int = 0,
        target: str | Iterable[str] | None = None,
        sensitivity: bool = False,
        robust: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> Yield:
        """Monte Carlo yield: fraction of random samples within tolerance that reach the target.

        If all cells of a sample are proved in tension with falling force, the order of F0 + f
        (rising, loading) and F1 - f (falling, unloading) decides its sequence, f being friction.
        That needs equal full travels, or a prescribed force, or a rigid actuator and the proof that
        no snap pushes a cell through its whole travel. Elements under a prescribed force are judged
        by their switching forces. The engine follows all other samples one by one, which takes
        milliseconds each (several bands in a cell, a nonlinear law, a load). For a target list of
        states the engine follows every branch of each sample. The exception: all 2^N states are
        the target, the travels are equal and every two loops are nested, which proves it.

        The same seed gives the same samples, and more `samples` keep the first ones.

        Args:
            tolerances: deviations of the parts from the nominal design, zero if not named; by
                default those of a careful workshop, anchors ±0.3 mm and stiffness ±5 %.
            samples: number of samples; by default 100,000 if end forces decide the sequence, and
                500 if the engine follows each.
            seed: random seed.
            target: the full cycle that counts as success, such as "00>10>11>01>00", by default
                that of the nominal design; or a list of states, such as ["00", "10", "11"]: exactly
                the states that shall be reachable from all cells at 0.
            sensitivity: also rank the tolerances of the parts, by Sobol' indices of the smallest
                gap between neighbours in the target order; if the engine follows every sample, also
                report how well the gap predicts its results.
            robust: a ratio, such as 10: a sample counts only if it works for all ratios of cell
                mobilities up to this one. End forces hold for any mobilities; for other samples
                every landing has to hold, as of `Path.landings`. For random mobilities see
                Tolerances(mobility=...).
            progress: called with (done, samples).

        Returns:
            The fraction that works, its confidence interval, and the outcomes of the others.

        Raises:
            ValueError: numbers out of range, a sequence that is no full cycle of this chain, a list
                of states of a chain with friction or more than 8 cells, or sensitivities of a
                cycle without two orders, or of samples that cannot all be built.
            StaticsError: the nominal design has no result, and no `target` was given.

        Source: sorting theorem, theory page; Sobol' 2001, Saltelli et al. 2010.
        """
        from stepwell.design import DEFAULT_TOLERANCES, yields

        return yields(
            self,
            tolerances or DEFAULT_TOLERANCES,
            samples=samples,
            seed=seed,
            target=target,
            sensitivity=sensitivity,
            robust=robust,
            progress=progress,
        )

    def reprogram(
        self,
        target: str | None,
        by: str,
        *,
        along: Sequence[float] | None = None,
        one_way: bool = False,
        reach: float = REACH,
        progress: Callable[[int, int], None] | None = None,
    ) -> Reprogramming:
        """The smallest displacement of one anchor that changes the sequence to the target.

        If all cells are proved concave under a rigid actuator and have equal full travels, the
        sequence is the order of the end forces. The target is then a region of the anchor's plane
        between curves of constant F0 and F1, whose nearest point is exact to rounding. If that
        proof fails for a displacement up to this point, the engine searches as well, and the method
        is "search".

        Args:
            target: a full cycle such as "00>01>11>10>00", or None for any other than the present.
            by: the anchor: "<cell>.p" on the inner block or "<cell>.q" on the outer one, of all
                bands of the cell; <cell> is a name or a number, 1 for the innermost. Or a number of
                an element: "<element>.force_scale", "<element>.travel_scale", "<element>.friction".
            along: (dx, dy), direction of the displacement; any direction by default.
            one_way: only in the sense of `along`, not against it.
            reach: largest displacement [m].
            progress: called with (done, total) places during a search by the engine.

        Returns:
            The displacement, the design just past it, and the force on the anchor during the
            displacement. Infinite if no displacement within reach leads to the target.

        Raises:
            ValueError: a target that is no full cycle of this chain, no anchor of that name, no
                direction, or no reach.
            StaticsError: the chain as it is cannot be followed.

        Source: sorting theorem, theory page; after Kamp et al. 2024, Fig. 4.
        """
        from stepwell.design import reprogram

        return reprogram(
            self, target, by, along=along, one_way=one_way, reach=reach, progress=progress
        )

    def robustness(self) -> Robustness:
        """The largest displacement of all anchors at once, in any directions, without a change.

        `margin` moves one anchor at a time; here all anchors move in their worst directions. For
        elements under a prescribed force: the largest relative deviation of all their forces.

        Raises:
            ValueError: the sequence is not proved to be the order of F0 and F1 or switching forces.

        Source: sorting theorem, theory page.
        """
        from stepwell.design import robustness

        return robustness(self)

    def survival(
        self,
        turning_points: Sequence[float],
        target: str,
        tolerances: Tolerances | None = None,
        *,
        start: str | None = None,
        samples: int | None = None,
        seed: int = 0,
        progress: Callable[[int, int], None] | None = None,
    ) -> Survival:
        """Monte Carlo of a stroke program: fraction of samples that end in the target state.

        The engine follows every sample, in a few milliseconds each. The actuator goes to the
        turning points, or as far as the sample can go. Samples that cannot be built or followed
        count as failures.

        Args:
            turning_points: as for `Chain.path`, or the `turning_points` of a Program.
            target: state at the end, such as "010".
            tolerances: deviations of the parts from the nominal design; as for `yields` by default.
            start: state at the beginning; all cells at 0 by default.
            samples: number of samples; 500 by default.
            seed: random seed; the same seed gives the same samples as `yields`.
            progress: called with (done, samples).

        Raises:
            ValueError: a state that this chain cannot have, `samples` below 1, or turning points or
                tolerances that are probably in another unit.
        """
        from stepwell.design import DEFAULT_TOLERANCES, survival

        return survival(
            self,
            turning_points,
            target,
            tolerances or DEFAULT_TOLERANCES,
            start=start,
            samples=samples,
            seed=seed,
            progress=progress,
        )

    def __repr__(self):
        title = f"{self.title!r}, " if self.title else ""
        stiffness = self.actuator_stiffness
        actuator = "" if math.isinf(stiffness) else f", actuator {stiffness:.4g} N/m"
        return f"Chain({title}{list(self.cells)!r}{actuator})"


def _as_cells(cells: Sequence[Cell | Element]) -> tuple[Cell | Element, ...]:
    checked = tuple(cells)
    for i, cell in enumerate(checked):
        if type(cell) not in (Cell, Element):
            raise InputError(f"cells[{i}] = {cell!r}: must be a Cell or an Element.")
    if not checked:
        raise InputError("cells is empty: a chain has one cell or more, inner first.")
    first = checked[0].measure
    for i, cell in enumerate(checked):
        if cell.measure is not first:
            raise InputError(
                f"cells[{i}] has {cell.measure.travel} and {cell.measure.force}, cells[0] has "
                f"{first.travel} and {first.force}: the cells of a chain share one force and their "
                f"travels add up, so all must be of one kind."
            )
    return checked
