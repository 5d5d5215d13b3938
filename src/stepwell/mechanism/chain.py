"""A serial chain of unit cells and the actuator that drives it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from stepwell.base import REACH, ByValue, finite, require, short
from stepwell.mechanism import sizes
from stepwell.mechanism.cell import Cell, as_cells
from stepwell.mechanism.sizes import SlipError

if TYPE_CHECKING:
    from stepwell.design import Margin, Reprogramming, Tolerances, Yield
    from stepwell.sequences import Cycle, Program, TransitionGraph
    from stepwell.statics import Path

# Springs of an actuator [N/m]. A double holds a drive to a share of 1e-16: behind a softer spring
# it loses the strokes beside λ/K, behind a stiffer one λ/K beside the strokes.
SOFTEST, STIFFEST = 1e-6, 1e12


@dataclass(frozen=True, slots=True, eq=False)
class Chain(ByValue):
    """Cells in series: the innermost block is fixed, the outermost is displaced.

    Args:
        cells: (N,) cells, inner first.
        actuator_stiffness: K [N/m] of the spring between the actuator and the outermost
            block, 1e-6 to 1e12; or infinite for a prescribed stroke (the paper), or 0 for a
            prescribed force.
        title: what reports call the chain.

    Raises:
        ValueError: no cells, or a stiffness out of range.

    Source: Kamp et al. 2024, Fig. 2.
    """

    cells: Sequence[Cell]
    actuator_stiffness: float = math.inf
    title: str = ""

    def __post_init__(self):
        object.__setattr__(self, "cells", as_cells(self.cells))
        require("cells", len(self.cells), "the chain has")
        stiffness = self.actuator_stiffness
        if stiffness != math.inf:
            stiffness = finite("actuator_stiffness", stiffness, "N/m")
        if stiffness not in (0.0, math.inf) and not SOFTEST <= stiffness <= STIFFEST:
            raise ValueError(
                f"actuator_stiffness = {stiffness:g} N/m: must be from {short(SOFTEST)} to "
                f"{short(STIFFEST)}; use math.inf for a prescribed stroke and 0 for a prescribed "
                f"force."
            )
        object.__setattr__(self, "actuator_stiffness", float(stiffness))

    def __len__(self) -> int:
        return len(self.cells)

    @property
    def full_stroke(self) -> float:
        """Σ S_i [m]: the stroke with every cell at 1."""
        return math.fsum(cell.full_travel for cell in self.cells)

    @property
    def drive_unit(self) -> str:
        """Unit of what the actuator prescribes: "m", or "N" under force control."""
        return "N" if self.actuator_stiffness == 0 else "m"

    @property
    def unusual(self) -> bool:
        """Whether one of its cells is `unusual`: then no number that meets the chain is a slip."""
        return any(cell.unusual for cell in self.cells)

    @property
    def names(self) -> tuple[str, ...]:
        """What each cell is called: its own name, else inner/outer or its number from inside."""
        fallback = ("inner", "outer") if len(self.cells) == 2 else None
        return tuple(
            cell.name or (fallback[i] if fallback else f"cell {i + 1}")
            for i, cell in enumerate(self.cells)
        )

    def path(
        self,
        turning_points: Sequence[float],
        *,
        start: str | Sequence[float] | None = None,
        prefer: Sequence[int] | None = None,
        progress: Callable[[float, float], None] | None = None,
    ) -> Path:
        """How the chain moves while the actuator visits these turning points.

        Args:
            turning_points: (m,) positions of the actuator [m], or forces [N] where
                `actuator_stiffness` is 0; the first one is where it starts.
            start: the state there, as "010" or as (N,) travels [m]; all cells at 0 by default.
            prefer: cells by falling priority where two of them tie; by default the innermost
                goes first, and cells of constant force share the motion.
            progress: called now and then with (done, total) of the way of the actuator.

        Returns:
            The path: branches, switches and snaps, each with its certificate.

        Raises:
            ValueError: turning points out of range, or probably in another unit, or a start that
                is no stable equilibrium.
            StaticsError: the follower could not go on, or what it found breaks its certificate.
        """
        from stepwell import statics

        slips = sizes.drives(self, turning_points)
        if slips:
            raise SlipError(slips, "")
        return statics.path(self, turning_points, start=start, prefer=prefer, progress=progress)

    def cycle(
        self,
        *,
        prefer: Sequence[int] | None = None,
        progress: Callable[[float, float], None] | None = None,
    ) -> Cycle:
        """Load from all cells at 0 to all at 1 and unload again, once.

        Args:
            prefer: cells by falling priority where two of them tie; by default the innermost
                goes first, and cells of constant force share the motion.
            progress: called now and then with (done, total) of the way of the actuator.

        Returns:
            The cycle: its sequence, its snaps, what it dissipates.

        Raises:
            StaticsError: the follower could not go on, or what it found breaks its certificate.
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
        """Everything that one actuator can do to the chain, as a networkx DiGraph.

        Args:
            drive: "stroke", "force", or the stiffness of the actuator [N/m]; the chain's own by
                default.
            start: a state such as "000" to begin with; every state the chain can stand in by
                default.
            progress: called with (done, total) states.

        Returns:
            The graph: nodes are stable equilibria with their strokes, edges are events.

        Raises:
            ValueError: friction, too many cells, or a start that is no equilibrium.
        """
        from stepwell import sequences

        return sequences.graph(self, drive, start=start, progress=progress)

    def program(
        self,
        to: str,
        *,
        start: str | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> Program:
        """The shortest list of turning points of the actuator that brings the chain to a state.

        Args:
            to: the state, such as "01", inner cell first.
            start: the state at the beginning; all cells at 0 by default.
            progress: called with (done, total) while a search goes on.

        Returns:
            The program, every turn with the window that does the same.

        Raises:
            Unreachable: no program does it; the text is the proof, or says what was searched.
            ValueError: a state that this chain cannot have.
        """
        from stepwell import sequences

        return sequences.program(self, to, start=start, progress=progress)

    def margin(
        self, *, reach: float = REACH, progress: Callable[[int, int], None] | None = None
    ) -> Margin:
        """How far each anchor and each stiffness may change before the sequence does.

        Args:
            reach: farthest displacement of an anchor that is looked at [m].
            progress: called with (done, total) changes.

        Returns:
            The margin: exact where the closed form is proved to hold, else searched.

        Raises:
            ValueError: `reach` is not above 0.
        """
        from stepwell.design import margin

        return margin(self, reach=reach, progress=progress)

    def yields(
        self,
        tolerances: Tolerances | None = None,
        *,
        n: int | None = None,
        seed: int = 0,
        wanted: str | Iterable[str] | None = None,
        sensitivity: bool = False,
        progress: Callable[[int, int], None] | None = None,
    ) -> Yield:
        """Make the chain n times at random within its tolerances and count those that work.

        Args:
            tolerances: how far the parts may be from the drawing; what a careful workshop can
                do by default, anchors ±0.3 mm and stiffness ±5 %.
            n: how many to make; by default 100,000 where end forces tell what they do, and 500
                where the engine has to follow each.
            seed: which ones.
            wanted: the full cycle that counts as success, what the drawing does by default; or a
                list of the states that shall be in reach, and no others.
            sensitivity: also ask which part's tolerance counts.
            progress: called with (done, n).

        Returns:
            The share that works, its confidence interval, and what the others do.

        Raises:
            ValueError: numbers out of range, or a sequence that is no full cycle of this chain.
        """
        from stepwell.design import USUAL, yields

        return yields(
            self,
            USUAL if tolerances is None else tolerances,
            n=n,
            seed=seed,
            wanted=wanted,
            sensitivity=sensitivity,
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
    ) -> Reprogramming:
        """The smallest displacement of one anchor after which the chain does what is wanted.

        Args:
            target: a full cycle such as "00>01>11>10>00", or None for any other than now.
            by: the anchor, such as "inner.p".
            along: (dx, dy), a line that the anchor keeps to; anywhere in the plane by default.
            one_way: only in the sense of `along`, not against it.
            reach: largest displacement that is looked at [m].

        Returns:
            The displacement, the design just past it, and what has to push the anchor.

        Raises:
            ValueError: a target that is no full cycle of this chain, or no anchor of that name.
        """
        from stepwell.design import reprogram

        return reprogram(self, target, by, along=along, one_way=one_way, reach=reach)

    def __repr__(self):
        title = f"{self.title!r}, " if self.title else ""
        actuator = (
            ""
            if math.isinf(self.actuator_stiffness)
            else f", actuator {self.actuator_stiffness:.4g} N/m"
        )
        return f"Chain({title}{list(self.cells)!r}{actuator})"
