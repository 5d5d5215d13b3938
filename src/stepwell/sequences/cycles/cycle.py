"""One full loading and unloading of a chain, and what it means."""

from __future__ import annotations

from collections.abc import Callable, Sequence as Sized
from dataclasses import dataclass
from functools import cached_property

from stepwell.base import ByValue
from stepwell.mechanism import Chain
from stepwell.sequences.cycles.pathway import Pathway, pathway_of
from stepwell.sequences.cycles.sequence import Sequence
from stepwell.sequences.cycles.vertices import sequence_of
from stepwell.statics import Event, EventKind, Path, Tie, full_cycle


@dataclass(frozen=True, eq=False)
class Cycle(ByValue):
    """A chain loaded from all cells at 0 to all at 1 and unloaded again.

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
        """The arrivals at a stop outside of snaps."""
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
        """Cells in the order in which they are first counted at 1."""
        return self._order(range(len(self.sequence.flips)), "0")

    @cached_property
    def unloading_order(self) -> tuple[int, ...]:
        """Cells in the order in which they are first counted at 0 after all were at 1."""
        states = self.sequence.states
        full = "1" * len(self.chain)
        if full not in states:
            return ()
        return self._order(range(states.index(full), len(self.sequence.flips)), "1")

    def _order(self, steps: range, leaves: str) -> tuple[int, ...]:
        order: dict[int, None] = {}
        for k in steps:
            before = self.sequence.states[k]
            for cell in self.sequence.flips[k]:
                if before[cell] == leaves:
                    order.setdefault(cell)
        return tuple(order)

    def __repr__(self):
        pathway = f", {self.pathway.label}" if self.pathway else ""
        tie = f", {len(self.degenerate)} ties" if self.degenerate else ""
        return (
            f"Cycle({self.sequence!r}{pathway}: {len(self.snaps)} snaps, dissipates "
            f"{self.dissipated * 1e3:.4g} mJ, peak {self.peak_force:.4g} N{tie})"
        )


def cycle(
    chain: Chain,
    *,
    prefer: Sized[int] | None = None,
    progress: Callable[[float, float], None] | None = None,
) -> Cycle:
    """Load a chain fully and unload it, once. All else as for `Chain.cycle`."""
    return Cycle(full_cycle(chain, prefer=prefer, progress=progress))
