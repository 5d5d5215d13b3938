"""One full loading and unloading of a chain, and the vertices that a path visits."""

from __future__ import annotations

from collections.abc import Callable, Sequence as Sized
from dataclasses import dataclass
from functools import cached_property

from stepwell.base import ByValue, Drawn, amount
from stepwell.mechanism import Cell, Chain, Element, phase_at
from stepwell.sequences.cycles.sequence import Pathway, Sequence, pathway_of
from stepwell.statics import Event, EventKind, Path, Tie, full_cycle

# Of a cell's travel: what one means who writes 20 mm where the levers give 19.998 mm.
_AT_STOP = 0.01


def arrival(path: Path) -> str:
    """The state in which a path ends, such as "010"; - for a cell in transit between phases.

    A cell counts as in a phase within a hundredth of its travel.
    """
    places = zip(path.chain.cells, path.end.tolist(), path.end_sheet, strict=True)
    return "".join(_nearest(cell, travel, sheet) for cell, travel, sheet in places)


def _nearest(cell: Cell | Element, travel: float, sheet: int) -> str:
    exact = phase_at(cell.stretches, sheet, travel)
    if exact != "-":
        return exact
    slip = _AT_STOP * cell.full_travel
    return phase_at(tuple((s, a - slip, b + slip) for s, a, b in cell.stretches), sheet, travel)


def sequence_of(path: Path) -> Sequence:
    """Every state with all cells in a phase that the path visits, in order.

    A path that starts in transit begins with the first vertex it reaches.
    """
    at, changes = path.phase_changes
    at = at.copy()
    between = sum(phase < 0 for phase in at)
    vertex, first = at.copy(), None if between else at.copy()
    found: list[tuple[tuple[int, int], ...]] = []
    touched: set[int] = set()
    for change in changes:
        for cell, phase in change:
            between += (phase < 0) - (at[cell] < 0)
            at[cell] = phase
            touched.add(cell)
        if between:
            continue
        if first is None:
            first = at.copy()
        else:
            moved = tuple((cell, at[cell]) for cell in sorted(touched) if at[cell] != vertex[cell])
            if moved:
                found.append(moved)
        for cell in touched:
            vertex[cell] = at[cell]
        touched.clear()
    state = "".join("-" if phase < 0 else str(phase) for phase in first or at)
    return Sequence(state, tuple(found))


@dataclass(frozen=True, eq=False)
class Cycle(ByValue, Drawn):
    """A chain loaded from all cells at 0 to all in their last phases and unloaded again.

    Attributes:
        path: the way through the equilibria, with its certificates.
    """

    path: Path

    @property
    def chain(self) -> Chain:
        """What moved."""
        return self.path.chain

    @cached_property
    def sequence(self) -> Sequence:
        """The vertices visited, such as 00>10>11>01>00."""
        return sequence_of(self.path)

    @property
    def pathway(self) -> Pathway | None:
        """Which of the four pathways two cells take; None for any other number of cells."""
        return pathway_of(self.sequence)

    @property
    def events(self) -> tuple[Event, ...]:
        """Every switch and snap in order."""
        return self.path.events

    @cached_property
    def snaps(self) -> tuple[Event, ...]:
        """The snaps alone."""
        return tuple(e for e in self.events if e.kind is EventKind.SNAP)

    @cached_property
    def switches(self) -> tuple[Event, ...]:
        """The arrivals in another phase outside of snaps; a stop is one."""
        return tuple(e for e in self.events if e.kind is EventKind.SWITCH)

    @property
    def dissipated(self) -> float:
        """Energy lost in the cycle [J]: snaps and friction."""
        return self.path.dissipated

    @property
    def peak_force(self) -> float:
        """Largest actuator force in size [N], with its sign."""
        return self.path.peak_force

    @property
    def degenerate(self) -> tuple[Tie, ...]:
        """Where the model cannot tell two outcomes apart, with advice; empty if nowhere."""
        return self.path.degenerate

    @cached_property
    def loading_order(self) -> tuple[int, ...]:
        """Cells in the order in which they first come to their last phase, 1 for lever cells."""
        return self._order(range(len(self.sequence.changes)), self.chain.last_state)

    @cached_property
    def unloading_order(self) -> tuple[int, ...]:
        """Cells in the order in which they first come back to 0 after all were at their last."""
        states, last = self.sequence.states, self.chain.last_state
        if last not in states:
            return ()
        first = self.chain.first_state
        return self._order(range(states.index(last), len(self.sequence.changes)), first)

    def _order(self, steps: range, target: str) -> tuple[int, ...]:
        order: dict[int, None] = {}
        for k in steps:
            for cell, phase in self.sequence.changes[k]:
                if str(phase) == target[cell]:
                    order.setdefault(cell)
        return tuple(order)

    def __repr__(self):
        pathway = f", {self.pathway.label}" if self.pathway else ""
        tie = f", {len(self.degenerate)} ties" if self.degenerate else ""
        peak = amount(self.peak_force, self.chain.measure.force_unit)
        return (
            f"Cycle({self.sequence!r}{pathway}: {len(self.snaps)} snaps, dissipates "
            f"{self.dissipated * 1e3:.4g} mJ, peak {peak}{tie})"
        )


def cycle(
    chain: Chain,
    *,
    prefer: Sized[int] | None = None,
    progress: Callable[[float, float], None] | None = None,
) -> Cycle:
    """Load a chain fully and unload it, once. All else as for `Chain.cycle`."""
    return Cycle(full_cycle(chain, prefer=prefer, progress=progress))
