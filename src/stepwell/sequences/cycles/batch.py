"""The cycles of many designs of one shape of chain, and the different ones among them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stepwell.base import ByValue, Floats, Ints
from stepwell.mechanism import Chain, phase_at
from stepwell.sequences.cycles.cycle import Cycle, cycle
from stepwell.sequences.cycles.sequence import Sequence
from stepwell.statics import (
    FOUND,
    LOST,
    PEAK,
    SNAPS,
    STEPS_DOWN,
    STEPS_UP,
    STROKE_DOWN,
    STROKE_UP,
    TIES,
    Designs,
    SegmentKind,
    StaticsError,
    full_cycles,
    stacked,
)

# Instead of the number of a sequence: no such chain, and one that the engine cannot follow.
IMPOSSIBLE, UNSOLVED = -1, -2
_ASK = -3
Progress = Callable[[int, int], None]


@dataclass(frozen=True, slots=True, eq=False)
class Cycles(ByValue):
    """What m designs do in a full cycle.

    Attributes:
        sequences: the different ones.
        number: (m,) which of them each design makes, or IMPOSSIBLE or UNSOLVED.
        found: (m, 8) snaps, ties, extreme force and more of each, see `Followed`.
    """

    sequences: tuple[Sequence, ...]
    number: Ints
    found: Floats

    @property
    def tied(self) -> Ints:
        """(m,) of each design, how many ties decide what it does."""
        return np.nan_to_num(self.found[:, TIES]).astype(np.int64)


def cycles_of(
    build: Callable[[int], Chain],
    count: int,
    designs: Designs | None = None,
    progress: Progress | None = None,
) -> Cycles:
    """Load every design fully and unload it, once: all in one call, and one by one what is left.

    Args:
        build: makes the chain of a design, by its number; ValueError where there is none.
        count: how many there are.
        designs: the same designs as numbers, where they are at hand; else all are built.
        progress: called now and then with (done, count).
    """
    number, found = np.full(count, _ASK), np.full((count, FOUND), np.nan)
    sequences: dict[Sequence, int] = {}
    which = np.arange(count)
    if designs is None:
        chains = {i: chain for i in range(count) if (chain := _built(build, i)) is not None}
        number[[i not in chains for i in range(count)]] = IMPOSSIBLE
        designs, which = stacked([*chains.values()]), np.array([*chains], np.int64)
    if designs is not None and len(which):
        followed = full_cycles(designs, progress)
        rows = followed.visited
        # One key a design: equal bytes are equal states.
        keys = rows.view(f"V{rows.itemsize * rows.shape[1]}").ravel().tolist()
        codes: dict[bytes, int] = {}
        for key, one in zip(keys, rows, strict=True):
            if key not in codes:
                codes[key] = _ASK
                if one[0] >= 0:
                    sequence = _sequence(one.tolist(), designs)
                    codes[key] = sequences.setdefault(sequence, len(sequences))
        number[which], found[which] = [codes[key] for key in keys], followed.found
    for i in np.flatnonzero(number == _ASK).tolist():
        if progress is not None:
            progress(i, count)
        number[i] = IMPOSSIBLE
        chain = _built(build, i)
        if chain is None:
            continue
        try:
            result = cycle(chain)
        except (StaticsError, ValueError):
            number[i] = UNSOLVED
            continue
        number[i] = sequences.setdefault(result.sequence, len(sequences))
        found[i] = _found(result)
    return Cycles(tuple(sequences), number, found)


def _built(build: Callable[[int], Chain], i: int) -> Chain | None:
    try:
        return build(i)
    except ValueError:
        return None


def _sequence(codes: list[int], designs: Designs) -> Sequence:
    cells = designs.cells.shape[1]
    return Sequence.parse(">".join(f"{code:0{cells}d}" for code in codes if code >= 0))


def _found(result: Cycle) -> Floats:
    """The same of one cycle."""
    found = np.full(FOUND, np.nan)
    found[SNAPS], found[TIES] = len(result.snaps), len(result.degenerate)
    found[PEAK], found[LOST] = result.peak_force, result.dissipated
    for snap in reversed(result.snaps):
        found[STROKE_UP if snap.direction > 0 else STROKE_DOWN] = snap.stroke
    found[STEPS_UP], found[STEPS_DOWN] = snapping_steps(result)
    return found


def snapping_steps(result: Cycle) -> tuple[int, int]:
    """Steps from state to state of a cycle in which it snaps, loading and unloading.

    A step in which the snap is handed on to another cell, and a second one follows, counts once.
    """
    stretches = result.chain.stretches
    between: set[int] = set()
    counts = {1: 0, -1: 0}
    snapped = 0
    for segment in result.path.segments():
        if segment.kind is SegmentKind.SNAP:
            snapped = segment.direction
        moved = zip(segment.cells, segment.after, segment.sheets_after, strict=True)
        for cell, travel, sheet in moved:
            in_transit = phase_at(stretches[cell], sheet, travel) == "-"
            between.add(cell) if in_transit else between.discard(cell)
        if snapped and not between:
            counts[snapped] += 1
            snapped = 0
    return counts[1], counts[-1]
