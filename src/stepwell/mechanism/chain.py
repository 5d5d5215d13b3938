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

# Springs of an actuator [N/m]. A double holds a drive to a share of 1e-16: behind a softer spring
# it loses the strokes beside λ/K, behind a stiffer one λ/K beside the strokes.
SOFTEST, STIFFEST = 1e-6, 1e12


@dataclass(frozen=True, slots=True, eq=False)
class Chain(ByValue, Drawn):
    """Cells in series: the innermost block is fixed, the outermost is displaced.

    Args:
        cells: (N,) cells and elements, inner first, all of one measure.
        actuator_stiffness: K [N/m] of the spring between the actuator and the outermost
            block, 1e-6 to 1e12; or infinite for a prescribed stroke (the paper), or 0 for a
            prescribed force.
        title: what reports call the chain.

    Raises:
        ValueError: no cells, cells of unlike measure, or a stiffness out of range.

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
            # What is soft and what is stiff there, the cells themselves tell.
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
        """Those of its cells that are elements."""
        return tuple(cell for cell in self.cells if isinstance(cell, Element))

    @property
    def levers(self) -> tuple[Cell, ...]:
        """All its cells, where all of them are lever cells.

        Raises:
            ValueError: a chain with an element; the text names the first one.
        """
        for i, cell in enumerate(self.cells):
            if isinstance(cell, Element):
                raise InputError(
                    f"cells[{i}] = {cell!r}: must be a Cell; an element has no levers or bands, so "
                    f"take a chain of cells alone."
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
        """Whether one of its cells is `unusual`: then no number that meets the chain is a slip."""
        return any(cell.unusual for cell in self.cells)

    @property
    def names(self) -> tuple[str, ...]:
        """What each cell is called: its own name, else inner/outer or its number from inside."""
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
            prefer: cells by falling priority where two of them tie; by default the first by its
                force, then the innermost, and cells of constant force share the motion.
            progress: called now and then with (done, total) of the way of the actuator.

        Raises:
            ValueError: turning points out of range, or probably in another unit, or a start that
                is no stable equilibrium.
            StaticsError: the follower could not go on, or breaks its own certificate; the text
                says where and what to do.

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
        """Load a chain fully and unload it, once.

        A rigid actuator goes 0 → Σ S_i → 0; a compliant one far enough to pull every cell to its
        stop and back, a prescribed force likewise. `prefer`, `progress` and StaticsError are as for
        `path`.

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
            drive: "stroke", "force" or what its measure calls them, such as "volume" and
                "pressure"; or the stiffness of the actuator [N/m]; that of the chain by default.
            start: a state such as "000", to see only what can be reached from it; by default
                all states in which the chain can stand, those set by hand included.
            progress: called with (done, total) starts, then with (followed, known) branches.

        Raises:
            ValueError: friction, a start that is no equilibrium, too many states to look at all
                of them, or too many branches.
            StaticsError: the engine could not go on; its text says what to do.
        """
        from stepwell import sequences

        return sequences.graph(self, drive, start=start, progress=progress)

    def implicit_graph(self, drive: str | float | None = None) -> ImplicitGraph:
        """The transition graph of a chain, asked state by state and never listed.

        For chains of any length: it counts states, finds the window of each and where its ends
        lead, and walks from one to the next; nothing is computed before it is asked for. `drive`
        is as for `graph`; friction and an unknown drive raise ValueError.
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
            target: the state in which it is to end, such as "01", inner cell first.
            start: the state at the beginning; all cells at 0 by default.
            robust: a ratio, such as 10: it has to work for all mobilities of the cells within
                that ratio of those given. Then every landing on the way holds within it, as of
                `Path.landings`, or the states at which it turns are proved not to hang on landings.
            progress: called with (done, total) while a search goes on.

        Returns:
            Among the programs compared with equally few turns, the one whose narrowest window is
            widest. Its `landings` tell which are proved and which sampled.

        Raises:
            Unreachable: no program does it; the text is the proof, or says what was searched, or
                which landing stands in the way.
            ValueError: a state that this chain cannot have, or in which it cannot stand, or a ratio
                that `Path.landings` does not take.

        Source: ours (theory page, "Stroke programs").
        """
        from stepwell import sequences

        return sequences.program(self, target, start=start, robust=robust, progress=progress)

    def margin(
        self, *, reach: float = REACH, progress: Callable[[int, int], None] | None = None
    ) -> Margin:
        """How far each anchor and each stiffness may change before the sequence does.

        One thing at a time; of an element all its forces, all its travels, and its friction. Where
        all cells are proved concave under a rigid actuator and share one full travel, the sequence
        changes exactly when two neighbours in the order of F0 or of F1 change places: the nearest
        anchor that does it is found to rounding, and the ratio of stiffness is a quotient of
        forces; so are those of elements under a prescribed force. Where that proof fails, on the
        way to the change or from the start, the general engine is asked around the anchor and the
        answer says "search". The anchor's is what `reprogram(chain, None, "<cell>.q")` finds.

        Args:
            reach: farthest displacement of an anchor that is looked at [m], > 0 (else ValueError);
                a distance is infinite where no change within reach does it.
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
        """Make a mechanism many times at random within its tolerances and count those that work.

        A mechanism whose cells are all proved taut with falling force does what the order of its F0
        + f (rising, loading) and F1 - f (falling, unloading) says, f being friction; that needs
        equal full travels, or a prescribed force, or a rigid actuator and the proof that no cell is
        pushed through its whole travel in a snap. Elements under a prescribed force are judged by
        their switching forces. All other mechanisms are followed by the engine, one by one; if that
        is every one (several bands in a cell, a bent law, a load), it takes milliseconds for each.
        Where states are wanted the engine follows every branch of each, unless all 2^N states are
        wanted of cells of one travel and every two loops are nested, which proves it.

        The same seed gives the same mechanisms, and more `samples` keep the first ones.

        Args:
            tolerances: how far the parts may be from the drawing, exact where it names nothing; by
                default what a careful workshop can do, anchors ±0.3 mm and stiffness ±5 %.
            samples: how many mechanisms to make; by default 100,000 where end forces tell what they
                do, and 500 where the engine has to follow each.
            seed: which ones.
            target: the full cycle that counts as success, such as "00>10>11>01>00", by default
                what the drawing does; or a list of states, such as ["00", "10", "11"]: all that
                shall be in reach from all cells at 0, and no others.
            sensitivity: also find which part's tolerance counts, by Sobol' indices of the smallest
                gap between neighbours in the wanted order; where the engine follows every
                mechanism, with how well the gap predicts what it finds.
            robust: a ratio, such as 10: a mechanism counts only if it works for all mobilities of
                its cells within that ratio of its own. End forces hold for any mobilities; of other
                mechanisms every landing on the way has to hold, as of `Path.landings`. For
                mobilities drawn at random see Tolerances(mobility=...).
            progress: called with (done, samples).

        Returns:
            The share that works, its confidence interval, and what the others do.

        Raises:
            ValueError: numbers out of range, a sequence that is no full cycle of this chain, states
                where not all that can be reached can be looked at (friction, more than 8 cells), or
                sensitivities of a cycle without two orders, or where not all can be built.
            StaticsError: the drawing itself has no answer, and no `target` was given.

        Source: sorting theorem, theory page; Sobol' 2001, Saltelli et al. 2010.
        """
        from stepwell.design import USUAL, yields

        return yields(
            self,
            tolerances or USUAL,
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
        """The smallest displacement of one anchor after which a chain does what is wanted.

        Where all cells are proved concave under a rigid actuator and share one full travel, the
        sequence is the order of the end forces: the wanted one is a region of the anchor's plane
        between curves of constant F0 and F1, whose nearest point is found to rounding. That is the
        answer where the proof holds for every displacement up to it; otherwise the engine is asked
        as well, and the answer says "search".

        Args:
            target: a full cycle such as "00>01>11>10>00", or None for any other than now.
            by: the anchor: "<cell>.p" on the inner block or "<cell>.q" on the outer one, of all
                bands of the cell; <cell> is a name or a number, 1 for the innermost. Or a number of
                an element: "<element>.force_scale", "<element>.travel_scale", "<element>.friction".
            along: (dx, dy), a line that the anchor keeps to; anywhere in the plane by default.
            one_way: only in the sense of `along`, not against it.
            reach: largest displacement that is looked at [m].
            progress: called with (done, total) places while the engine is asked.

        Returns:
            The displacement, the design just past it, and what has to push the anchor on the
            way. Infinite where nothing within reach does it.

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
        """The largest displacement that all anchors may have at once, whatever their directions.

        `margin` moves one anchor at a time; here every other one moves to meet it. Of elements
        under a prescribed force, the largest share by which all their forces may be off.

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
        """Make a mechanism many times at random and run the same stroke program on each.

        Every mechanism is followed by the engine, in a millisecond or a few. The actuator goes
        where the program says, or as far as the mechanism lets it. One that cannot be built or
        followed does not end right.

        Args:
            turning_points: as for `Chain.path`; of a Program its `turning_points`.
            target: the state wanted at the end, such as "010".
            tolerances: how far the parts may be from the drawing; as for `yields` by default.
            start: the state at the beginning; all cells at 0 by default.
            samples: how many mechanisms to make; 500 by default.
            seed: which ones; the same seed gives the same mechanisms as `yields`.
            progress: called with (done, samples).

        Raises:
            ValueError: a state that this chain cannot have, `samples` below 1, or turning points or
                tolerances that are probably in another unit.
        """
        from stepwell.design import USUAL, survival

        return survival(
            self,
            turning_points,
            target,
            tolerances or USUAL,
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
