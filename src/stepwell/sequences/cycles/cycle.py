"""One full loading and unloading of a chain, and the vertices that a path visits."""

from __future__ import annotations

from collections.abc import Callable, Sequence as Sized
from dataclasses import dataclass
from functools import cached_property

from stepwell.base import ByValue
from stepwell.mechanism import Chain
from stepwell.sequences.cycles.sequence import Pathway, Sequence, pathway_of
from stepwell.statics import Event, EventKind, Path, Tie, full_cycle

# Of a cell's travel: what one means who writes 20 mm where the levers give 19.998 mm.
_AT_STOP = 0.01


def arrival(path: Path) -> str:
    """The state in which a path ends, such as "010"; - for a cell between its stops.

    A cell counts as at a stop within a hundredth of its travel.
    """
    travels = zip(path.end.tolist(), path.chain.cells, strict=True)
    parts = (travel / cell.full_travel for travel, cell in travels)
    return "".join("0" if p <= _AT_STOP else "1" if p >= 1 - _AT_STOP else "-" for p in parts)


def sequence_of(path: Path) -> Sequence:
    """Every state with all cells at a stop that the path visits, in order.

    A path that starts between the stops begins with the first vertex it reaches.
    """
    full = path.chain.full_travels
    at = [0 if s == 0 else 1 if s == f else -1 for s, f in zip(path.start, full, strict=True)]
    between = sum(a < 0 for a in at)
    vertex = at.copy()
    first: str | None = None if between else "".join(map(str, at))
    flips: list[tuple[int, ...]] = []
    touched: set[int] = set()
    for segment in path.segments():
        for cell, travel in zip(segment.cells, segment.after, strict=True):
            now = 0 if travel == 0 else 1 if travel == full[cell] else -1
            between += (now < 0) - (at[cell] < 0)
            at[cell] = now
            touched.add(cell)
        if between:
            continue
        if first is None:
            first = "".join(map(str, at))
        else:
            flip = tuple(sorted(cell for cell in touched if at[cell] != vertex[cell]))
            if flip:
                flips.append(flip)
        for cell in touched:
            vertex[cell] = at[cell]
        touched.clear()
    if first is None:
        first = "".join("-" if a < 0 else str(a) for a in at)
    return Sequence(first, tuple(flips))


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
