"""Outcomes of a chain for values of two of its parameters: closed form first, then the engine."""

import math
from dataclasses import dataclass, replace
from operator import itemgetter
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from stepwell import concave
from stepwell.base import Bools, Floats, Ints, Progress, notify
from stepwell.concave import Simple
from stepwell.design.parameters import Parameter
from stepwell.kernels import entry, in_blocks, leaf, record
from stepwell.mechanism import Chain, Element
from stepwell.sequences import IMPOSSIBLE, UNSOLVED, Cycles, Pathway, Sequence, cycles_of
from stepwell.statics import batch, nominal

Codes = NDArray[np.int32]

# Column of a cell's row after the fields of `Simple`.
FRICTION = 6


@record
class VariedCells(NamedTuple):
    """A chain of n cells with two varied numbers."""

    base: Floats  # (n, 7) a row per cell: the fields of `Simple`, and its friction
    rows: Ints  # (2,) of the two numbers in `base`
    columns: Ints  # (2,)
    turned: Ints  # (c,) rows with varied numbers; all others are certified already


@record
class _Work(NamedTuple):
    cells: Floats  # (n, 7)
    force: Floats  # (2, n) F0 and -F1, which both fall in the order of motion
    full: Floats  # (n,) full travels
    order: Ints  # (2, n) cells in the order in which they load, and unload

    @classmethod
    def of(cls, base: Floats) -> Self:
        """Work arrays for designs with these numbers."""
        n = len(base)
        return cls(base.copy(), np.empty((2, n)), np.empty(n), np.empty((2, n), np.int64))


@record
class Swept(NamedTuple):
    """Results of `sweep` for m designs of n cells."""

    # (m,) number of the run of consecutive designs with equal orders; -1 if nothing is proved
    run: Codes
    orders: Codes  # (m, 2, n) of each run, cells in the order in which they load, and unload
    strokes: Floats  # (2, m) of the first snap [m], loading and unloading, NaN if there is none
    snaps: Codes  # (2, m) number of cells that snap
    gap: Floats  # (m,) smallest difference of two F0 or of two F1 [N], infinite for one cell
    monostable: Bools  # (m,) whether a turned cell is stable in one state only


@entry(3e-6, "values", "varied.base")
@leaf
def sweep(values: Floats, varied: VariedCells, work: _Work, out: Swept) -> int:
    """Cycles of m designs under a rigid actuator, where they are proved.

    They are proved if all cells are certified, without friction and with one full travel (a cell
    that gives travel back in a snap gives back less than that, and so never reaches its other
    stop), or for two cells, if neither has to give back its full travel.

    From the rules (a cell at 0 stays while F0 >= λ, one at 1 while F1 <= λ, one in transit has
    F = λ, two in transit with falling forces are unstable):
    - loading: cells leave 0 by ascending F0. Where cell j moves, λ = F_j(s) falls from F0_j, and
      the full cells stay at their stops while F1 <= λ: always if F1_j is the largest, else up to
      F_j(s*) = F1_i for the largest F1_i of a full cell, at the stroke of all full cells and s*.
      There i leaves its stop, two cells are in transit, and the chain snaps: j runs to its
      stop, i gives back as much and then finishes alone.
    - unloading: the same picture upside down. Cells leave 1 by descending F1; j snaps where
      F_j(s*) = F0_i for the smallest F0_i of an empty cell, at the stroke of the cells that are
      still full and s*.
    For equal forces, which no rule decides, the inner cell is first.

    `values` (m, 2) is added to the two varied numbers; returns the number of runs.
    """
    force, order, n = work.force, work.order, len(varied.base)
    for c in range(n):
        order[0, c] = order[1, c] = c
        force[0, c], force[1, c], work.full[c] = numbers(work.cells, c)
    runs = 0
    same = False
    for i in range(len(values)):
        out.run[i] = -1
        vary(work.cells, varied, values, i)
        holds, monostable = _certified(work, varied.turned)
        if not holds:
            continue
        equal = _have_one_travel(work.full)
        if not equal and n != 2:
            continue
        closest = np.inf
        for side in range(2):
            moved = sort(order, force, side)
            same = same and not moved
            out.strokes[side, i], out.snaps[side, i], proved = _snaps(work, side, equal)
            holds = holds and proved
            for k in range(1, n):
                apart = force[side, order[side, k]] - force[side, order[side, k - 1]]
                closest = min(closest, apart)
        if not holds:
            continue
        if not same:
            for side in range(2):
                for k in range(n):
                    out.orders[runs, side, k] = order[side, k]
            runs += 1
            same = True
        out.run[i] = runs - 1
        out.gap[i] = closest
        out.monostable[i] = monostable
    return runs


@leaf
def vary(cells: Floats, varied: VariedCells, values: Floats, i: int) -> None:
    """Write the two numbers of a design over those of the previous one."""
    base, rows, columns = varied.base, varied.rows, varied.columns
    for k in range(2):
        cells[rows[k], columns[k]] = base[rows[k], columns[k]]
    for k in range(2):
        cells[rows[k], columns[k]] += values[i, k]


@leaf
def _certified(work: _Work, turned: Ints) -> tuple[bool, bool]:
    """Whether the turned cells are proved, and whether one of them is stable in one state only."""
    cells, force = work.cells, work.force
    monostable = False
    for c in turned:
        if not (cells[c, FRICTION] <= 0.0 and concave.certify(simple_of(cells, c), 0.0)):
            return False, monostable
        force[0, c], force[1, c], work.full[c] = numbers(cells, c)
        monostable = monostable or force[0, c] <= 0.0 or force[1, c] <= 0.0
    return True, monostable


@leaf
def _have_one_travel(full: Floats) -> bool:
    most, least = full[0], full[0]
    for c in range(1, len(full)):
        most, least = max(most, full[c]), min(least, full[c])
    return concave.same_travel(most, least)


@leaf
def _snaps(work: _Work, side: int, equal: bool) -> tuple[float, int, bool]:
    """Stroke [m] of the first snap one way, how many cells snap, and whether that is proved."""
    force, full, order = work.force, work.full, work.order
    n = len(full)
    stroke, count, holds = np.nan, 0, True
    # Of the cells that have moved: the largest F1 where they load, -F0 where they unload.
    pull = -np.inf
    for k in range(n):
        c: int = order[side, k]
        back = -force[1 - side, c]
        if back < pull:
            if count == 0:
                level = pull if side == 0 else -pull
                cell = simple_of(work.cells, c)
                stroke = concave.travel_at(cell, level, force[0, c], -force[1, c])
                gives = full[c] - stroke if side == 0 else stroke
                first: int = order[side, 0]
                holds = equal or gives < full[first]
                # The other cells that are full meanwhile.
                for j in range(k if side == 0 else n - k - 1):
                    other: int = order[side, j if side == 0 else k + 1 + j]
                    stroke += full[other]
            count += 1
        pull = max(pull, back)
    return stroke, count, holds


@entry(1e-5, "values", "varied.turned")
def ends(values: Floats, varied: VariedCells, out: Floats) -> None:
    """F0 and F1 [N] of the turned cells, (m, c, 2), proved or not; all else as in `sweep`."""
    cells, turned = varied.base.copy(), varied.turned
    for i in range(len(values)):
        vary(cells, varied, values, i)
        for k in range(len(turned)):
            out[i, k, 0], out[i, k, 1] = concave.end_forces(simple_of(cells, turned[k]))


# Single entries are read instead of rows, since in machine code a row is a separate object.


@leaf
def simple_of(cells: Floats, c: int) -> Simple:
    """The cell in a row of numbers."""
    return Simple(cells[c, 0], cells[c, 1], cells[c, 2], cells[c, 3], cells[c, 4], cells[c, 5])


@leaf
def numbers(cells: Floats, c: int) -> tuple[float, float, float]:
    """F0 [N], -F1 [N] and the full travel [m] of a cell."""
    cell = simple_of(cells, c)
    force_0, force_1 = concave.end_forces(cell)
    return force_0, -force_1, concave.full_travel(cell)


@leaf
def sort(order: Ints, force: Floats, side: int) -> bool:
    """Sort mostly sorted cells by increasing force, then by number; returns whether any moved."""
    moved = False
    for k in range(1, order.shape[1]):
        c = order[side, k]
        own = force[side, c]
        j = k
        while j > 0:
            before = order[side, j - 1]
            if force[side, before] < own or (force[side, before] == own and before < c):
                break
            order[side, j] = before
            j -= 1
            moved = True
        order[side, j] = c
    return moved


# In addition to the codes of `cycles_of`: a region of ties, which only friction could decide.
TIED = -3
_MEANINGS = {IMPOSSIBLE: "no mechanism", UNSOLVED: "no answer", TIED: "a tie decides"}
# Longest chain whose sequences are written out; longer ones are given by their moves.
_SHORT = 12
# Fraction of an axis: at this distance a design on a boundary is no longer tied, but one within a
# region of ties is.
_ASIDE = 1e-7 * np.array([0.8, 0.6])
_BLOCK = 20_000  # designs per block of one core
_NUMBERS = {"stiffness": 2, "rest_length": 3, "lever": 4, "limit": 5, "friction": FRICTION}


@dataclass(frozen=True, eq=False)
class DesignOutcome:
    """Outcomes of m designs; strokes, snaps and the gap as in `Swept`."""

    sequence: Codes  # (m,) its number, or `IMPOSSIBLE`, `UNSOLVED` or `TIED`
    strokes: Floats
    snaps: Codes  # -1 if unknown
    gap: Floats  # NaN if not proved
    monostable: Bools
    degenerate: Bools  # whether a tie decides

    @classmethod
    def unknown(cls, m: int) -> "DesignOutcome":
        """Unknown outcomes of m designs."""
        return cls(
            np.full(m, UNSOLVED, np.int32),
            np.full((2, m), np.nan),
            np.full((2, m), -1, np.int32),
            np.full(m, np.nan),
            np.zeros(m, np.bool_),
            np.zeros(m, np.bool_),
        )


def _known_sequences(cells: int) -> list[Sequence]:
    """Two cells have their four pathways under the same numbers in every map."""
    known = [p for p in Pathway if p is not Pathway.OTHER] if cells == 2 else []
    return [Sequence.parse(p.value) for p in known]


class Outcomes:
    """Outcomes of a chain over two parameters with spans (2,), with numbered sequences."""

    def __init__(self, chain: Chain, parameters: tuple[Parameter, Parameter], spans: Floats):
        self.chain, self.parameters, self._spans = chain, parameters, spans
        self.sequences = _known_sequences(len(chain))
        self._numbers = {sequence: i for i, sequence in enumerate(self.sequences)}
        self._by_orders: dict[bytes, int] = {}
        self.turned = sorted({k.cell for k in parameters if k.cell is not None})
        # Rows, columns and signs of the numbers that the parameters change.
        parts = [k.part.partition(".") for k in parameters]
        places = ["xy".index(axis) if axis else _NUMBERS.get(one, 0) for one, _, axis in parts]
        self.rows = np.array([k.cell or 0 for k in parameters], np.int64)
        self.columns = np.array(places, np.int64)
        self._signs = np.array([-1.0 if one == "p" else 1.0 for one, _, _ in parts])
        self._plain = {cell: self._row(cell) for cell in self.turned}
        self.base, self._varied = self._base(), None
        if self.base is not None:
            turned = np.array(self.turned)
            self._varied = VariedCells(self.base, self.rows, self.columns, turned)

    def design(self, values: Floats) -> Chain:
        """The chain at (x, y); ValueError if there is none."""
        chain = self.chain
        for parameter, value in zip(self.parameters, values.tolist(), strict=True):
            chain = parameter.changed(chain, value)
        return chain

    def closed_form(self, values: Floats, tie: float = 0.0) -> DesignOutcome:
        """Outcomes of (m, 2) values in closed form; a gap below `tie` [N] is degenerate."""
        result = DesignOutcome.unknown(len(values))
        varied, n = self._varied, len(self.chain)
        if varied is None or len(values) == 0:
            return result
        blocks: dict[int, tuple[DesignOutcome, Codes]] = {}

        def block(begin: int, end: int) -> None:
            # Machine code is compiled for contiguous arrays; slices would need another version.
            one, orders = (
                DesignOutcome.unknown(end - begin),
                np.empty((end - begin, 2, n), np.int32),
            )
            added = self.added(values[begin:end])
            out = Swept(one.sequence, orders, one.strokes, one.snaps, one.gap, one.monostable)
            runs = sweep(added, varied, _Work.of(varied.base), out)
            blocks[begin] = one, orders[:runs].copy()

        in_blocks(block, len(values), sweep.block(min(_BLOCK, len(values)), values, varied))
        for begin, (one, orders) in sorted(blocks.items(), key=itemgetter(0)):
            m = slice(begin, begin + len(one.sequence))
            numbers = [self._of_orders(each) for each in orders] + [UNSOLVED]
            result.sequence[m] = np.array(numbers, np.int32)[one.sequence]
            result.strokes[:, m], result.snaps[:, m] = one.strokes, one.snaps
            result.gap[m], result.monostable[m] = one.gap, one.monostable
        result.degenerate[:] = result.gap < tie
        return result

    def simulate(
        self,
        which: NDArray[np.intp],
        values: Floats,
        result: DesignOutcome,
        progress: Progress = None,
    ) -> None:
        """Simulate the designs `which` of (m, 2) values and store their outcomes."""
        number, cycles = self._simulated(values[which], progress)
        result.sequence[which] = number
        known, at = cycles.found[number >= 0], which[number >= 0]
        result.degenerate[at] = cycles.tied[number >= 0] > 0
        result.strokes[:, at] = known[:, [batch.STROKE_UP, batch.STROKE_DOWN]].T
        result.snaps[:, at] = known[:, [batch.STEPS_UP, batch.STEPS_DOWN]].T

    def label(
        self, values: Floats, progress: Progress = None, sure: DesignOutcome | None = None
    ) -> Codes:
        """Numbers for (m, 2) values, by the engine where the closed form gives no `sure` one."""
        number = (sure or self.closed_form(values)).sequence.copy()
        waiting = np.flatnonzero(number == UNSOLVED)
        number[waiting], cycles = self._simulated(values[waiting], progress)
        ties = waiting[cycles.tied > 0]
        if len(ties):
            beside, cycles = self._simulated(values[ties] + _ASIDE * self._spans)
            unclear = (beside < 0) | (cycles.tied > 0)
            number[ties] = np.where(unclear, TIED, beside)
        return number

    def meaning(self, number: int) -> str:
        """Text of a sequence number."""
        if number < 0:
            return _MEANINGS[number]
        sequence = self.sequences[number]
        if len(self.chain) <= _SHORT:
            return str(sequence)
        # Numbers of the cells in the order in which they move.
        return "moves:" + ",".join("+".join(map(str, flip)) for flip in sequence.flips)

    def added(self, values: Floats) -> Floats:
        """Increments (m, 2) of two numbers of `base` for these values."""
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
        assert self._varied is not None
        out = np.empty((len(values), len(self.turned), 2))
        ends(self.added(values), self._varied, out)
        return out

    def _simulated(self, values: Floats, progress: Progress = None) -> tuple[Codes, Cycles]:
        designs = None if self.chain.elements else nominal(self.chain, len(values))
        if designs is not None:
            for parameter, column in zip(self.parameters, values.T, strict=True):
                parameter.put(designs, self.chain, column)
        cycles = cycles_of(lambda i: self.design(values[i]), len(values), designs, progress)
        notify(progress, len(values), len(values))
        # Codes without a sequence are negative and count from the end.
        numbers = [*map(self._number, cycles.sequences), UNSOLVED, IMPOSSIBLE]
        return np.array(numbers, np.int32)[cycles.number], cycles

    def _of_orders(self, orders: Codes) -> int:
        key = orders.tobytes()
        if key not in self._by_orders:
            self._by_orders[key] = self._number(Sequence.full_cycle(*orders.tolist()))
        return self._by_orders[key]

    def _number(self, sequence: Sequence) -> int:
        if sequence not in self._numbers:
            self._numbers[sequence] = len(self.sequences)
            self.sequences.append(sequence)
        return self._numbers[sequence]

    def _base(self) -> Floats | None:
        """The cells as numbers (n, 7) without the parameters; None if nothing is proved."""
        of_actuator = any(k.cell is None for k in self.parameters)
        if of_actuator or math.isfinite(self.chain.actuator_stiffness):
            return None
        base = np.empty((len(self.chain), FRICTION + 1))
        for i, cell in enumerate(self.chain.cells):
            proved = None if i in self.turned else concave.closed(cell)
            row = self._plain[i] if i in self.turned else proved and (*proved, 0.0)
            if row is None or row[FRICTION] > 0:
                return None
            base[i] = row
        return base

    def _row(self, cell: int) -> Floats | None:
        """(7,) a cell with one linear band and no load as numbers, the parameters left out."""
        as_is = self.chain.cells[cell]
        plain = concave.simple(replace(as_is, friction=0.0))
        if plain is None or isinstance(as_is, Element):
            return None
        row = np.array([*plain, as_is.friction])
        band, parts = as_is.bands[0], [k.part for k in self.parameters if k.cell == cell]
        for part in parts:
            end, _, axis = part.partition(".")
            if not axis:
                row[_NUMBERS[part]] = 0.0
                continue
            # d = q - p: the remainder is the other end of the band, unless that varies too.
            column = "xy".index(axis)
            left = -band.p[column] if end == "q" else band.q[column]
            row[column] = 0.0 if {f"p.{axis}", f"q.{axis}"} <= set(parts) else left
        return row


class Stability:
    """Number of stable states of a cell with varied parameters, 1 or 2, for (m, 2) values.

    `words` describe the change at each limit in closed form; none if designs are evaluated singly.
    """

    def __init__(self, outcomes: Outcomes, cell: int, nodes: Floats):
        self._outcomes, self._cell = outcomes, cell
        one, name = outcomes.chain.cells[cell], outcomes.chain.names[cell]
        numbers = outcomes.numbers(cell, nodes)
        self.words: tuple[str, ...] = ()
        if isinstance(one, Element) or numbers is None:
            return
        if not one.bands[0].two_sided or _taut(numbers):
            self.words = (
                f"state 0 of {name} stops being stable: F0 = 0",
                f"state 1 of {name} stops being stable: F1 = 0",
                f"{name} goes slack over its whole travel: r + |q - p| = ℓ0",
            )

    def limits(self, values: Floats) -> Floats:
        """(m, 3) numbers, all positive where the cell is bistable, in closed form.

        The energy of one band that only pulls has one peak, at θmax = atan2(d_y, d_x) where the
        band is longest (Kamp et al. 2024, Eq. 3), unless it is slack even there, r + |d| <= ℓ0.
        """
        numbers = self._outcomes.numbers(self._cell, values)
        assert numbers is not None
        dx, dy, _, rest, lever, sine = numbers.T[:6]
        cosine = np.sqrt(1.0 - sine**2)
        across, along = dy * cosine, dx * sine
        return np.stack([along + across, along - across, lever + np.hypot(dx, dy) - rest], axis=1)

    def __call__(self, values: Floats) -> Ints:
        """The number of states; `IMPOSSIBLE` if there is no such cell."""
        if self.words:
            return 1 + np.all(self.limits(values) > 0, axis=1).astype(np.int64)
        return np.array([self._count_states(one) for one in values], np.int64)

    def _count_states(self, values: Floats) -> int:
        try:
            return 1 + int(self._outcomes.design(values).cells[self._cell].is_bistable)
        except ValueError:
            return IMPOSSIBLE


def _taut(numbers: Floats) -> bool:
    # ℓ² is linear in (cos θ, sin θ): over the travel it is smallest at a stop, or at the turn
    # opposite to d, which for d_x > 0 lies outside.
    dx, dy, _, rest, lever, sine = numbers.T[:6]
    x, y = dx + lever * np.sqrt(1.0 - sine**2), np.abs(dy) - lever * sine
    return bool(np.all(dx > 0) and np.all(np.hypot(x, y) >= rest))
