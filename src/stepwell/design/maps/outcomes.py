"""What a chain does for any values of two of its parameters: closed form first, then the engine."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from operator import itemgetter

import numpy as np
from numpy.typing import NDArray

from stepwell.concave import closed, simple
from stepwell.design.maps.sweep import FRICTION, ends, sweep
from stepwell.design.parameters import Parameter
from stepwell.kernels import in_blocks
from stepwell.mechanism import Chain, Element
from stepwell.sequences import IMPOSSIBLE, UNSOLVED, Cycles, Pathway, Sequence, cycles_of
from stepwell.statics import STEPS_DOWN, STEPS_UP, STROKE_DOWN, STROKE_UP, nominal

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Bools = NDArray[np.bool_]
Progress = Callable[[int, int], None] | None

# Instead of a sequence, with those of `cycles_of`: a region where only friction could tell.
TIED = -3
_WORDS = {IMPOSSIBLE: "no mechanism", UNSOLVED: "no answer", TIED: "a tie decides"}
# Longest chain whose sequences are written out; those of longer ones are told by their moves.
_SHORT = 12
# Of an axis: a design on a boundary is tied and its neighbours are not; within a region of ties
# they are.
_ASIDE = 1e-7 * np.array([0.8, 0.6])
_BLOCK = 20_000  # designs that one core takes at a time
_NUMBERS = {"stiffness": 2, "rest_length": 3, "lever": 4, "limit": 5, "friction": FRICTION}


@dataclass(frozen=True, eq=False)
class Found:
    """What is known of m designs.

    Attributes:
        sequence: (m,) its number, or `IMPOSSIBLE`, `UNSOLVED` or `TIED`.
        strokes: (2, m) stroke [m] of the first snap, loading and unloading; NaN where none.
        snaps: (2, m) steps that snap, loading and unloading; -1 where nothing is known.
        gap: (m,) smallest difference of two F0 or of two F1 [N]; NaN where not proved.
        monostable: (m,) whether a cell whose parameter varies is stable in one state only.
        degenerate: (m,) whether a tie decides.
    """

    sequence: Ints
    strokes: Floats
    snaps: Ints
    gap: Floats
    monostable: Bools
    degenerate: Bools

    @classmethod
    def nothing(cls, m: int) -> Found:
        """Of m designs."""
        return cls(
            np.full(m, UNSOLVED, np.int32),
            np.full((2, m), np.nan),
            np.full((2, m), -1, np.int32),
            np.full(m, np.nan),
            np.zeros(m, np.bool_),
            np.zeros(m, np.bool_),
        )


class Outcomes:
    """The sequence of a chain as a number, and more, against the values of two parameters.

    Args:
        chain: any number of cells.
        parameters: the parameters.
        spans: (2,) how far their values reach.
    """

    def __init__(self, chain: Chain, parameters: tuple[Parameter, Parameter], spans: Floats):
        self.chain, self.parameters, self._spans = chain, parameters, spans
        # Two cells have their four pathways under the same numbers in every map.
        known = [p for p in Pathway if p is not Pathway.OTHER] if len(chain) == 2 else []
        self.sequences = [Sequence.parse(p.value) for p in known]
        self._numbers = {sequence: i for i, sequence in enumerate(self.sequences)}
        self._by_orders: dict[bytes, int] = {}
        self.turned = sorted({k.cell for k in parameters if k.cell is not None})
        self.rows, self.columns, self._signs = self._places()
        self._plain = {cell: self._row(cell) for cell in self.turned}
        self.base = self._base()

    def design(self, values: Floats) -> Chain:
        """The chain at (x, y); ValueError where there is none."""
        chain = self.chain
        for parameter, value in zip(self.parameters, values.tolist(), strict=True):
            chain = parameter.changed(chain, value)
        return chain

    def closed_form(self, values: Floats, tie: float = 0.0) -> Found:
        """What the closed form says of (m, 2) values, where it is proved.

        Designs whose gap is below `tie` [N] are degenerate.
        """
        found = Found.nothing(len(values))
        if self.base is None or len(values) == 0:
            return found
        base, n = self.base, len(self.chain)
        turned = np.array(self.turned)
        blocks: dict[int, tuple[Found, Ints]] = {}

        def block(begin: int, end: int) -> None:
            # Machine code is for arrays that are whole, and parts of others would need their own.
            one, orders = Found.nothing(end - begin), np.empty((end - begin, 2, n), np.int32)
            added = self.added(values[begin:end])
            out = one.sequence, orders, one.strokes, one.snaps, one.gap, one.monostable
            runs = sweep(added, base, self.rows, self.columns, turned, *out)
            blocks[begin] = one, orders[:runs].copy()

        in_blocks(block, len(values), sweep.block(min(_BLOCK, len(values)), values, base))
        for begin, (one, orders) in sorted(blocks.items(), key=itemgetter(0)):
            m = slice(begin, begin + len(one.sequence))
            numbers = [self._of_orders(each) for each in orders] + [UNSOLVED]
            found.sequence[m] = np.array(numbers, np.int32)[one.sequence]
            found.strokes[:, m], found.snaps[:, m] = one.strokes, one.snaps
            found.gap[m], found.monostable[m] = one.gap, one.monostable
        found.degenerate[:] = found.gap < tie
        return found

    def proved(self, values: Floats) -> Bools:
        """For which of (m, 2) values the closed form holds."""
        return self.closed_form(values).sequence != UNSOLVED

    def ask(
        self, which: NDArray[np.intp], values: Floats, found: Found, progress: Progress = None
    ) -> None:
        """Have the engine follow those of (m, 2) designs, and note what they do."""
        number, cycles = self._followed(values[which], progress)
        found.sequence[which] = number
        known, at = cycles.found, which[number >= 0]
        found.degenerate[at] = cycles.tied[number >= 0] > 0
        for column, way in ((STROKE_UP, 0), (STROKE_DOWN, 1)):
            found.strokes[way, at] = known[number >= 0, column]
        for column, way in ((STEPS_UP, 0), (STEPS_DOWN, 1)):
            found.snaps[way, at] = known[number >= 0, column]

    def label(
        self,
        values: Floats,
        progress: Progress = None,
        found: Found | None = None,
    ) -> Ints:
        """Numbers for (m, 2) values, of which the closed form says what was `found`.

        `progress` is called with (done, total) engine runs.
        """
        number = (found or self.closed_form(values)).sequence.copy()
        waiting = np.flatnonzero(number == UNSOLVED)
        number[waiting], cycles = self._followed(values[waiting], progress)
        ties = waiting[cycles.tied > 0]
        if len(ties):
            beside, cycles = self._followed(values[ties] + _ASIDE * self._spans)
            unclear = (beside < 0) | (cycles.tied > 0)
            number[ties] = np.where(unclear, TIED, beside)
        if progress is not None:
            progress(len(waiting), len(waiting))
        return number

    def meaning(self, number: int) -> str:
        """What a number stands for."""
        if number < 0:
            return _WORDS[number]
        sequence = self.sequences[number]
        if len(self.chain) <= _SHORT:
            return str(sequence)
        # Cells in the order in which they move, by number.
        return "moves:" + ",".join("+".join(map(str, flip)) for flip in sequence.flips)

    def added(self, values: Floats) -> Floats:
        """(m, 2) what the values add to two of the numbers of `base`."""
        added = values * self._signs
        for k, parameter in enumerate(self.parameters):
            if parameter.part == "limit":
                added[:, k] = np.sin(values[:, k])
        return added

    def numbers(self, cell: int, values: Floats) -> Floats | None:
        """(m, 7) a cell whose parameters vary, a row as in `sweep`, if it has one linear band."""
        row = self._plain[cell]
        if row is None:
            return None
        rows, added = np.tile(row, (len(values), 1)), self.added(values)
        for k, parameter in enumerate(self.parameters):
            if parameter.cell == cell:
                rows[:, self.columns[k]] += added[:, k]
        return rows

    def forces(self, values: Floats) -> Floats:
        """F0 and F1 [N] of the cells whose parameters vary, (m, c, 2), proved or not."""
        assert self.base is not None
        out = np.empty((len(values), len(self.turned), 2))
        turned = np.array(self.turned)
        ends(self.added(values), self.base, self.rows, self.columns, turned, out)
        return out

    def _followed(self, values: Floats, progress: Progress = None) -> tuple[Ints, Cycles]:
        """What the engine finds of (m, 2) values: numbers of sequences, and the rest."""
        designs = None if self.chain.elements else nominal(self.chain, len(values))
        if designs is not None:
            for parameter, column in zip(self.parameters, values.T, strict=True):
                parameter.put(designs, self.chain, column)
        found = cycles_of(lambda i: self.design(values[i]), len(values), designs, progress)
        own = np.array([self._number(sequence) for sequence in found.sequences], np.int32)
        number = found.number.astype(np.int32)
        number[number >= 0] = own[number[number >= 0]]
        return number, found

    def _of_orders(self, orders: Ints) -> int:
        key = orders.tobytes()
        number = self._by_orders.get(key)
        if number is None:
            number = self._number(Sequence.full_cycle(*orders.tolist()))
            self._by_orders[key] = number
        return number

    def _number(self, sequence: Sequence) -> int:
        if sequence not in self._numbers:
            self._numbers[sequence] = len(self.sequences)
            self.sequences.append(sequence)
        return self._numbers[sequence]

    def _places(self) -> tuple[NDArray[np.int64], NDArray[np.int64], Floats]:
        """Rows and columns of the numbers that the parameters change, and with which sign."""
        rows, columns, signs = np.zeros(2, np.int64), np.zeros(2, np.int64), np.ones(2)
        for k, parameter in enumerate(self.parameters):
            anchor, _, axis = parameter.part.partition(".")
            rows[k] = parameter.cell if parameter.cell is not None else 0
            columns[k] = "xy".index(axis) if axis else _NUMBERS.get(parameter.part, 0)
            signs[k] = -1.0 if anchor == "p" else 1.0
        return rows, columns, signs

    def _base(self) -> Floats | None:
        """(n, 7) the cells as numbers, the parameters left out; None where nothing is proved."""
        if math.isfinite(self.chain.actuator_stiffness) or any(
            k.cell is None for k in self.parameters
        ):
            return None
        base = np.empty((len(self.chain), FRICTION + 1))
        for i, cell in enumerate(self.chain.cells):
            if i in self.turned:
                row = self._plain[i]
                if row is None or row[FRICTION] > 0:
                    return None
                base[i] = row
                continue
            numbers = closed(cell)
            if numbers is None:
                return None
            base[i] = *numbers, 0.0
        return base

    def _row(self, cell: int) -> Floats | None:
        """(7,) a cell with one linear band and no load as numbers, the parameters left out."""
        as_is = self.chain.cells[cell]
        if isinstance(as_is, Element):
            return None
        plain = simple(replace(as_is, friction=0.0))
        if plain is None:
            return None
        row = np.array([*plain, as_is.friction])
        band, parts = as_is.bands[0], [k.part for k in self.parameters if k.cell == cell]
        for part in parts:
            end, _, axis = part.partition(".")
            if not axis:
                row[_NUMBERS[part]] = 0.0
                continue
            # d = q - p: what is left is the other end of the band, unless that varies too.
            column = "xy".index(axis)
            left = -band.p[column] if end == "q" else band.q[column]
            row[column] = 0.0 if {f"p.{axis}", f"q.{axis}"} <= set(parts) else left
        return row
