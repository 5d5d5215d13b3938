"""What a chain does for any values of two of its parameters: closed form first, then the engine."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from stepwell.concave import Simple, closed, look, simple
from stepwell.design.maps.pathways import IMPOSSIBLE, TIED, UNSOLVED
from stepwell.design.parameters import Knob
from stepwell.mechanism import Chain
from stepwell.sequences import Cycle, Pathway, Sequence, cycle
from stepwell.statics import SegmentKind, StaticsError

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

_AT_ONCE = 1_000_000  # end forces that are sorted in one go
# Of an axis: a design on a boundary is tied and its neighbours are not; within a region of ties
# they are.
_ASIDE = 1e-7 * np.array([0.8, 0.6])


@dataclass(frozen=True, eq=False)
class Sorted:
    """What the closed form says of m designs.

    Attributes:
        number: (m,) of the sequence, or `UNSOLVED` where nothing is proved.
        snaps: (m, 2) steps that snap while loading and while unloading.
        gap: (m,) smallest difference of two F0 or of two F1 [N].
    """

    number: Ints
    snaps: Ints
    gap: Floats


class Outcomes:
    """The sequence of a chain as a number, against the values of two parameters.

    Numbers from 0 up stand for sequences; `IMPOSSIBLE` for a chain that cannot be made,
    `UNSOLVED` for one that the engine cannot follow, and `TIED` for one in a region where only
    friction could tell.

    Args:
        chain: any number of cells.
        x, y: the parameters.
        spans: (2,) how far their values reach.
    """

    def __init__(self, chain: Chain, x: Knob, y: Knob, spans: Floats):
        self.chain, self.knobs, self._spans = chain, (x, y), spans
        # Two cells have their four pathways under the same numbers in every map.
        known = [p for p in Pathway if p is not Pathway.OTHER] if len(chain) == 2 else []
        self.sequences = [Sequence.parse(p.value) for p in known]
        self._numbers = {sequence: i for i, sequence in enumerate(self.sequences)}
        self._fixed = self._other_cells()
        self._moving = {k.cell: self._free_of_friction(k.cell) for k in (x, y)}
        self.has_closed_form = self._fixed is not None and None not in self._moving.values()

    def design(self, values: Floats) -> Chain:
        """The chain at (x, y); ValueError where there is none."""
        chain = self.chain
        for knob, value in zip(self.knobs, values.tolist(), strict=True):
            chain = knob.turned(chain, value)
        return chain

    def closed_form(self, values: Floats) -> Sorted:
        """What the closed form says of (m, 2) values, where it is proved."""
        m, n = len(values), len(self.chain)
        found = Sorted(np.full(m, UNSOLVED, np.int64), np.zeros((m, 2), np.int64), np.zeros(m))
        if self.has_closed_form:
            step = max(1, _AT_ONCE // n)
            for start in range(0, m, step):
                self._sort(values[start : start + step], found, start)
        return found

    def by_engine(self, values: Floats) -> tuple[int, Cycle | None]:
        """The number for one (2,) pair of values, and the cycle if there is one."""
        try:
            design = self.design(values)
        except ValueError:
            return IMPOSSIBLE, None
        try:
            result = cycle(design)
        except StaticsError:
            return UNSOLVED, None
        return self._number(result.sequence), result

    def label(
        self, values: Floats, told: Callable[[int, int], None] | None = None
    ) -> tuple[Ints, Bools]:
        """Numbers for (m, 2) values, and whether the closed form has proved each.

        `told` is called with (done, total) engine runs.
        """
        number = self.closed_form(values).number
        proved = number != UNSOLVED
        waiting = np.flatnonzero(~proved).tolist()
        for done, i in enumerate(waiting):
            if told is not None:
                told(done, len(waiting))
            number[i] = self._without_ties(values[i])
        if told is not None:
            told(len(waiting), len(waiting))
        return number, proved

    def _without_ties(self, values: Floats) -> int:
        number, result = self.by_engine(values)
        if result is None or not result.degenerate:
            return number
        beside, result = self.by_engine(values + _ASIDE * self._spans)
        return TIED if result is None or result.degenerate else beside

    def _number(self, sequence: Sequence) -> int:
        if sequence not in self._numbers:
            self._numbers[sequence] = len(self.sequences)
            self.sequences.append(sequence)
        return self._numbers[sequence]

    def _other_cells(self) -> dict[int, Simple] | None:
        if math.isfinite(self.chain.actuator_stiffness) or any(k.cell is None for k in self.knobs):
            return None
        turned = {k.cell for k in self.knobs}
        found: dict[int, Simple] = {}
        for i, cell in enumerate(self.chain.cells):
            if i in turned:
                continue
            numbers = closed(cell)
            if numbers is None:
                return None
            found[i] = numbers
        return found

    def _free_of_friction(self, cell: int | None) -> Simple | None:
        if cell is None:
            return None
        as_is = self.chain.cells[cell]
        turns_friction = any(k.cell == cell and k.part == "friction" for k in self.knobs)
        return simple(replace(as_is, friction=0.0) if turns_friction else as_is)

    def _sort(self, values: Floats, found: Sorted, start: int) -> None:
        assert self._fixed is not None
        m, n = len(values), len(self.chain)
        ends, full = np.zeros((m, n, 2)), np.empty((m, n))
        proved = np.ones(m, np.bool_)
        for i in range(n):
            if i in self._fixed:
                numbers = np.array([self._fixed[i]])
                here, holds = np.empty((1, 2)), np.empty(1, np.bool_)
            else:
                numbers, rubs = self._turned(i, values)
                here, holds = np.zeros((m, 2)), np.empty(m, np.bool_)
                proved &= ~rubs
            look(numbers, here, holds)
            ends[:, i], full[:, i] = here, 2.0 * numbers[:, 4] * numbers[:, 5]
            proved &= holds
        # A cell gives back less than its travel in a snap, and needs as much as any to be emptied.
        most = np.max(full, axis=1)
        proved &= most - np.min(full, axis=1) <= 1e-12 * most
        which = np.flatnonzero(proved)
        if len(which) == 0:
            return
        force_0, force_1 = ends[which, :, 0], ends[which, :, 1]
        # Equal forces: the inner cell first, as the engine does.
        loading = np.argsort(force_0, axis=1, kind="stable")
        unloading = np.argsort(-force_1, axis=1, kind="stable")
        rows, kind = np.unique(np.hstack([loading, unloading]), axis=0, return_inverse=True)
        numbers = np.array(
            [self._number(Sequence.full_cycle(row[:n], row[n:])) for row in rows.tolist()]
        )
        at = start + which
        found.number[at] = numbers[kind.reshape(-1)]
        if n > 1:
            # The cell that loads snaps where a full one lets go first, which has a larger F1.
            rising = np.take_along_axis(force_1, loading, axis=1)
            found.snaps[at, 0] = _overtaken(rising)
            falling = np.take_along_axis(force_0, unloading, axis=1)
            found.snaps[at, 1] = _overtaken(-falling)
            gaps = [np.min(np.diff(np.sort(f, axis=1), axis=1), axis=1) for f in (force_0, force_1)]
            found.gap[at] = np.minimum(*gaps)
        else:
            found.gap[at] = math.inf

    def _turned(self, cell: int, values: Floats) -> tuple[Floats, Bools]:
        """(m, 6) numbers of a cell whose parameters are turned, and where it has friction."""
        base, band = self._moving[cell], self.chain.cells[cell].bands[0]
        assert base is not None
        numbers = np.tile(np.array(base), (len(values), 1))
        places = {"p": np.tile(band.p, (len(values), 1)), "q": np.tile(band.q, (len(values), 1))}
        rubs = np.zeros(len(values), np.bool_)
        for knob, column in zip(self.knobs, values.T, strict=True):
            if knob.cell != cell:
                continue
            anchor, _, axis = knob.part.partition(".")
            if axis:
                places[anchor][:, "xy".index(axis)] = column
            elif knob.part == "friction":
                rubs |= column > 0
            elif knob.part == "limit":
                numbers[:, 5] = np.sin(column)
            else:
                numbers[:, ("stiffness", "rest_length", "lever").index(knob.part) + 2] = column
        numbers[:, :2] = places["q"] - places["p"]
        return numbers, rubs


def snapping_steps(result: Cycle) -> tuple[int, int]:
    """Steps from state to state of a cycle in which it snaps, loading and unloading.

    A step in which the snap is handed on to another cell, and a second one follows, counts once.
    """
    full = [cell.full_travel for cell in result.chain.cells]
    between: set[int] = set()
    counts = {1: 0, -1: 0}
    snapped = 0
    for segment in result.path.segments():
        if segment.kind is SegmentKind.SNAP:
            snapped = segment.direction
        for cell, travel in zip(segment.cells, segment.after, strict=True):
            at_stop = travel == 0 or travel == full[cell]
            between.discard(cell) if at_stop else between.add(cell)
        if snapped and not between:
            counts[snapped] += 1
            snapped = 0
    return counts[1], counts[-1]


def _overtaken(force: Floats) -> Ints:
    """(m,) how many in each row are smaller than one before them."""
    return np.sum(force[:, 1:] < np.maximum.accumulate(force, axis=1)[:, :-1], axis=1)
