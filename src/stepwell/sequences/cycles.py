"""The vertices that a chain visits, its full cycle, and the cycles of many designs."""

from collections.abc import Callable, Iterable, Iterator, Sequence as Sized
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from itertools import groupby, pairwise
from operator import itemgetter

import numpy as np

from stepwell import base, statics
from stepwell.base import ByValue, Drawn, Floats, InputError, Ints, amount, to_unit
from stepwell.mechanism import Cell, Chain, Element, phase_at
from stepwell.statics import batch

_DIGITS = frozenset("0123456789")


@dataclass(frozen=True, eq=False)
class Sequence(ByValue):
    """States with every cell in a phase, in the order of the visit, such as 00>10>11>01>00.

    Stored as changes from one vertex to the next, so that it is small for long chains.

    Attributes:
        first: state at the first vertex, the phase of every cell as a digit, inner first.
        changes: for every later vertex (cell, phase) of all cells that changed.
    """

    first: str
    changes: tuple[tuple[tuple[int, int], ...], ...]

    @classmethod
    def parse(cls, text: str) -> "Sequence":
        """The sequence of a text such as "00>10>11>01>00" (spaces do not count), or ValueError."""
        states = text.replace(" ", "").split(">")
        if any(len(s) != len(states[0]) or not s or set(s) - _DIGITS for s in states):
            raise InputError(
                f"{text!r}: must be states with > between, each with one character 0 or 1 per "
                f"cell, as in 00>10>11>01>00; for elements with more phases, their digits."
            )
        steps = (enumerate(zip(a, b, strict=True)) for a, b in pairwise(states))
        changes = (tuple((i, int(b)) for i, (a, b) in step if a != b) for step in steps)
        return cls(states[0], tuple(changes))

    @classmethod
    def full_cycle(cls, loading: Iterable[int], unloading: Iterable[int]) -> "Sequence":
        """The cycle with these loading and unloading permutations, one cell per step."""
        up = tuple(((cell, 1),) for cell in loading)
        return cls("0" * len(up), (*up, *(((cell, 0),) for cell in unloading)))

    @property
    def flips(self) -> tuple[tuple[int, ...], ...]:
        """For every later vertex the cells that changed."""
        return tuple(tuple(cell for cell, _ in change) for change in self.changes)

    @property
    def orders(self) -> tuple[tuple[int, ...], tuple[int, ...]] | None:
        """Loading and unloading permutations; None unless each cell switches once, one by one."""
        cells, twice = len(self.first), 2 * len(self.first)
        moves = [move for change in self.changes for move in change]
        if len(self.changes) != twice or len(moves) != twice or set(self.first) != {"0"}:
            return None
        if any(phase != (k < cells) for k, (_, phase) in enumerate(moves)):
            return None
        order = tuple(cell for cell, _ in moves)
        loading, unloading = order[:cells], order[cells:]
        once = len(set(loading)) == len(set(unloading)) == cells
        return (loading, unloading) if once else None

    @cached_property
    def states(self) -> tuple[str, ...]:
        """All vertices as strings."""
        state = list(self.first)
        states = [self.first]
        for change in self.changes:
            for cell, phase in change:
                state[cell] = str(phase)
            states.append("".join(state))
        return tuple(states)

    def __iter__(self) -> Iterator[str]:
        return iter(self.states)

    def __len__(self) -> int:
        return len(self.changes) + 1

    def __getitem__(self, index: int) -> str:
        return self.states[index]

    def __str__(self) -> str:
        return ">".join(self.states)

    def __eq__(self, other: object) -> bool:
        return str(self) == other if isinstance(other, str) else super().__eq__(other)

    # It equals its text, so the two are one key.
    def __hash__(self) -> int:
        return hash(str(self))

    def __repr__(self) -> str:
        if len(self.first) * len(self) > 2000:
            return f"Sequence({len(self.first)} cells, {len(self)} vertices)"
        return f"Sequence({str(self)!r})"


class Pathway(Enum):
    """How a two-cell chain loads and unloads (Kamp et al. 2024, Fig. 2)."""

    CLOCKWISE = "00>10>11>01>00"
    COUNTERCLOCKWISE = "00>01>11>10>00"
    VIA_01 = "00>01>11>01>00"
    VIA_10 = "00>10>11>10>00"
    OTHER = "any other sequence"

    @property
    def label(self) -> str:
        """A word or two for tables and figures."""
        return {"VIA_01": "via 01", "VIA_10": "via 10"}.get(self.name, self.name.lower())

    @property
    def is_directed(self) -> bool:
        """Whether loading and unloading have different sequences."""
        return self in (Pathway.CLOCKWISE, Pathway.COUNTERCLOCKWISE)


# Tolerance of a stop as a fraction of the travel, for input such as 20 mm instead of 19.998 mm.
_AT_STOP = 0.01


def arrival(path: statics.Path) -> str:
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


def sequence_of(path: statics.Path) -> Sequence:
    """Every state with all cells in a phase that the path visits, in order.

    A path that starts in transit begins with the first vertex it reaches.
    """
    at, changes = path.phase_changes
    at = at.copy()
    between = sum(phase < 0 for phase in at)
    vertex, first = at.copy(), None if between else at.copy()
    steps: list[tuple[tuple[int, int], ...]] = []
    touched: set[int] = set()
    for _, together in groupby(changes, itemgetter(0)):
        for _, cell, phase in together:
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
                steps.append(moved)
        for cell in touched:
            vertex[cell] = at[cell]
        touched.clear()
    state = "".join("-" if phase < 0 else str(phase) for phase in first or at)
    return Sequence(state, tuple(steps))


@dataclass(frozen=True, eq=False)
class Cycle(ByValue, Drawn):
    """A chain loaded from all cells at 0 to all in their last phases and unloaded again."""

    path: statics.Path

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
        if len(self.chain) != 2:
            return None
        text = str(self.sequence)
        return next((p for p in Pathway if p.value == text), Pathway.OTHER)

    @property
    def events(self) -> tuple[statics.Event, ...]:
        """Every switch and snap in order."""
        return self.path.events

    @cached_property
    def snaps(self) -> tuple[statics.Event, ...]:
        """The snaps alone."""
        return tuple(e for e in self.events if e.kind is statics.EventKind.SNAP)

    @cached_property
    def switches(self) -> tuple[statics.Event, ...]:
        """The arrivals in another phase outside of snaps; a stop is one."""
        return tuple(e for e in self.events if e.kind is statics.EventKind.SWITCH)

    @property
    def dissipated(self) -> float:
        """Energy lost in the cycle [J]: snaps and friction."""
        return self.path.dissipated

    @property
    def peak_force(self) -> float:
        """Largest actuator force in size [N], with its sign; of equal ones the positive."""
        return self.path.peak_force

    @property
    def degenerate(self) -> tuple[statics.Tie, ...]:
        """Degenerate events, with advice; empty if there are none."""
        return self.path.degenerate

    @cached_property
    def loading_order(self) -> tuple[int, ...]:
        """Cells in the order in which they first come to their last phase, 1 for lever cells."""
        return self._order(range(len(self.sequence.changes)), self.chain.last_state)

    @cached_property
    def unloading_order(self) -> tuple[int, ...]:
        """Cells in the order in which they first come back to 0 after all were at their last."""
        states, last = self.sequence.states, self.chain.last_state
        begin = states.index(last) if last in states else len(states)
        return self._order(range(begin, len(self.sequence.changes)), self.chain.first_state)

    def _order(self, steps: range, target: str) -> tuple[int, ...]:
        moves = (move for k in steps for move in self.sequence.changes[k])
        return tuple(dict.fromkeys(cell for cell, phase in moves if str(phase) == target[cell]))

    def __repr__(self):
        pathway = f", {self.pathway.label}" if self.pathway else ""
        tie = f", {len(self.degenerate)} ties" if self.degenerate else ""
        peak = amount(self.peak_force, self.chain.measure.force_unit)
        return (
            f"Cycle({self.sequence!r}{pathway}: {len(self.snaps)} snaps, dissipates "
            f"{to_unit(self.dissipated, 'mJ'):.4g} mJ, peak {peak}{tie})"
        )


def cycle(
    chain: Chain,
    *,
    prefer: Sized[int] | None = None,
    progress: Callable[[float, float], None] | None = None,
) -> Cycle:
    """One full cycle of a chain. All else as for `Chain.cycle`."""
    return Cycle(statics.full_cycle(chain, prefer=prefer, progress=progress))


# Instead of the number of a sequence: no such chain, and one that the engine cannot follow.
IMPOSSIBLE, UNSOLVED = -1, -2
_ASK = -3


@dataclass(frozen=True, slots=True, eq=False)
class Cycles(ByValue):
    """Sequences and numbers of the full cycles of m designs.

    Attributes:
        sequences: the different sequences.
        number: (m,) number of the sequence of each design, or IMPOSSIBLE or UNSOLVED.
        found: (m, 8) snaps, ties, extreme force and more of each, see `Followed`.
    """

    sequences: tuple[Sequence, ...]
    number: Ints
    found: Floats

    @property
    def tied(self) -> Ints:
        """(m,) number of ties that affect the sequence of each design."""
        return np.nan_to_num(self.found[:, batch.TIES]).astype(np.int64)


def cycles_of(
    build: Callable[[int], Chain],
    count: int,
    designs: statics.Designs | None = None,
    progress: base.Progress = None,
) -> Cycles:
    """Full cycles of many designs: in one compiled call if possible, the others one by one.

    Args:
        build: makes the chain of a design, by its number; ValueError where there is none.
        count: number of designs.
        designs: the same designs as arrays, if available; else all are built.
        progress: called with (0, count) before a design is built, and from time to time after.
    """
    base.notify(progress, 0, count)
    number, numbers = np.full(count, _ASK), np.full((count, batch.FOUND), np.nan)
    sequences: dict[Sequence, int] = {}
    which = np.arange(count)
    if designs is None:
        chains = {i: chain for i in range(count) if (chain := _built(build, i)) is not None}
        number[[i not in chains for i in range(count)]] = IMPOSSIBLE
        designs, which = batch.stacked([*chains.values()]), np.array([*chains], np.int64)
    if designs is not None and len(which):
        followed = statics.full_cycles(designs, progress)
        number[which] = _numbered(followed.visited, designs.cells.shape[1], sequences)
        numbers[which] = followed.found
    left = np.flatnonzero(number == _ASK).tolist()
    for done, i in enumerate(left, count - len(left)):
        base.notify(progress, done, count)
        number[i] = IMPOSSIBLE
        chain = _built(build, i)
        if chain is None:
            continue
        try:
            result = cycle(chain)
        except (statics.StaticsError, ValueError):
            number[i] = UNSOLVED
            continue
        number[i] = sequences.setdefault(result.sequence, len(sequences))
        numbers[i] = _cycle_numbers(result)
    return Cycles(tuple(sequences), number, numbers)


def _numbered(rows: Ints, cells: int, sequences: dict[Sequence, int]) -> list[int]:
    """The number of each design's sequence, new ones added; _ASK where it was not followed.

    `rows` (m, V) are the states visited, as of `Followed`.
    """
    # One key a design: equal bytes are equal states.
    keys = rows.view(f"V{rows.itemsize * rows.shape[1]}").ravel().tolist()
    codes: dict[bytes, int] = {}
    for key, one in zip(keys, rows, strict=True):
        if key not in codes:
            codes[key] = _ASK
            if one[0] >= 0:
                text = ">".join(f"{code:0{cells}d}" for code in one.tolist() if code >= 0)
                codes[key] = sequences.setdefault(Sequence.parse(text), len(sequences))
    return [codes[key] for key in keys]


def _built(build: Callable[[int], Chain], i: int) -> Chain | None:
    try:
        return build(i)
    except ValueError:
        return None


def _cycle_numbers(result: Cycle) -> Floats:
    numbers = np.full(batch.FOUND, np.nan)
    numbers[batch.SNAPS], numbers[batch.TIES] = len(result.snaps), len(result.degenerate)
    numbers[batch.PEAK], numbers[batch.LOST] = result.peak_force, result.dissipated
    for snap in reversed(result.snaps):
        numbers[batch.STROKE_UP if snap.direction > 0 else batch.STROKE_DOWN] = snap.stroke
    numbers[batch.STEPS_UP], numbers[batch.STEPS_DOWN] = snapping_steps(result)
    return numbers


def snapping_steps(result: Cycle) -> tuple[int, int]:
    """Steps from state to state of a cycle in which it snaps, loading and unloading.

    A step in which the snap is handed on to another cell, and a second one follows, counts once.
    """
    stretches, between = result.chain.stretches, set[int]()
    counts, snapped = {1: 0, -1: 0}, 0
    for segment in result.path.segments():
        if segment.kind is statics.SegmentKind.SNAP:
            snapped = segment.direction
        moved = zip(segment.cells, segment.after, segment.sheets_after, strict=True)
        for cell, travel, sheet in moved:
            in_transit = phase_at(stretches[cell], sheet, travel) == "-"
            between.add(cell) if in_transit else between.discard(cell)
        if snapped and not between:
            counts[snapped] += 1
            snapped = 0
    return counts[1], counts[-1]
