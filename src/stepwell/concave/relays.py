"""Relays of chains under a prescribed force, each with switching fields A and B; state counts."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise, product

import numpy as np

from stepwell.base import Bools, Floats, Ints
from stepwell.concave.cell import simple
from stepwell.concave.certificate import proved_ends
from stepwell.concave.sorting import TIED, one_travel
from stepwell.mechanism import Chain, Element

# Lower and upper end of the forces at which a phase is stable [N], by cell and phase.
Windows = Sequence[Sequence[tuple[float, float]]]
# The same ends as numbers in the order of all fields; infinite ends are -1 or their count.
Levels = list[list[tuple[int, int]]]


def levels(windows: Windows, slip: float) -> Levels:
    """The ends of windows of every phase of every cell [N] as numbers in the order of all fields.

    Upper ends no further apart than `slip` [N] have one number, and so have lower ends. The
    stability of a state depends on an upper and a lower end, which are compared exactly.
    """
    low, high = (
        _firsts({window[end] for cell in windows for window in cell}, slip) for end in (0, 1)
    )
    order = sorted(filter(math.isfinite, {*low.values(), *high.values()}))
    number = {end: k for k, end in enumerate(order)} | {-math.inf: -1, math.inf: len(order)}
    return [[(number[low[a]], number[high[b]]) for a, b in cell] for cell in windows]


def _firsts(ends: set[float], slip: float) -> dict[float, float]:
    """The first of the ends that each end ties with."""
    firsts: dict[float, float] = {}
    for before, end in pairwise([-math.inf, *sorted(ends)]):
        firsts[end] = firsts[before] if end - before <= slip else end
    return firsts


def standing_states(known: Levels) -> int:
    """Number of stable states: states in which one force keeps every cell in its phase.

    A state is counted at the largest lower end of its phases: the number of stable states at one
    field is a product over the cells, minus the states that are stable before.

    Source: ours (theory page, "Transition graphs").
    """
    begins, ends = _by_level(known)
    holding = _Product([sum(low < 0 for low, _ in cell) for cell in known])
    total = holding.value
    for begun, ended in zip(begins, ends, strict=True):
        before = holding.value
        for cell, _ in begun:
            holding.change(cell, +1)
        total += holding.value - before
        for cell, _ in ended:
            holding.change(cell, -1)
    return total


class _Product:
    """A product of whole numbers, one a cell, that change one by one."""

    def __init__(self, factors: list[int]):
        self.factors = factors
        self._nonzero = math.prod(filter(None, factors))
        self._zeros = factors.count(0)

    @property
    def value(self) -> int:
        return 0 if self._zeros else self._nonzero

    def change(self, cell: int, by: int) -> None:
        old, new = self.factors[cell], self.factors[cell] + by
        self._zeros += (new == 0) - (old == 0)
        self._nonzero = self._nonzero // (old or 1) * (new or 1)
        self.factors[cell] = new


# Phases as (cell, phase), in a list for every level.
_Phases = list[list[tuple[int, int]]]


def _by_level(known: Levels) -> tuple[_Phases, _Phases]:
    """The phases that begin at each level, and those that end there."""
    count = 1 + max((end for cell in known for window in cell for end in window), default=-1)
    begins: _Phases = [[] for _ in range(count)]
    ends: _Phases = [[] for _ in range(count)]
    for i, cell in enumerate(known):
        for k, (low, high) in enumerate(cell):
            if low >= 0:
                begins[low].append((i, k))
            if high < count:
                ends[high].append((i, k))
    return begins, ends


def landings(cell: Sequence[tuple[int, int]], direction: int) -> dict[int, int]:
    """Target of a single cell from each of its phases when the force passes the phase's end.

    The target is the next phase that is stable at this force, as it rises (direction +1) or falls
    (-1). Phases without an end are omitted.
    """
    targets: dict[int, int] = {}
    for phase, (low, high) in enumerate(cell):
        rest = cell[phase + 1 :] if direction > 0 else cell[:phase][::-1]
        for step, (least, most) in enumerate(rest, 1):
            if most > high if direction > 0 else least < low:
                targets[phase] = phase + direction * step
                break
    return targets


def garden_states(known: Levels) -> int:
    """Number of stable states that no force leads to: the Garden of Eden.

    In such a state no phase is entered at any force at which the state is stable. The force rises
    from the lower end of the state to where one of its phases is entered, or ends: each field on
    the way leaves fewer states.

    Source: theory page, "Relays" (Garden of Eden).
    """
    begins, ends = _by_level(known)
    count = len(begins)
    risen: _Phases = [[] for _ in range(count)]
    fallen: _Phases = [[] for _ in range(count)]
    for i, cell in enumerate(known):
        for phase, target in landings(cell, +1).items():
            risen[cell[phase][1]].append((i, target))
        for phase, target in landings(cell, -1).items():
            fallen[cell[phase][0]].append((i, target))

    def without_entry(start: int, first: int) -> int:
        """States of phases that begin at `start` or before and are stable at `first`."""
        gone: set[tuple[int, int]] = set()
        left: dict[int, int] = {}
        all_left = holding.value

        def lose(phases: Iterable[tuple[int, int]]) -> None:
            nonlocal all_left
            for i, k in phases:
                low, high = known[i][k]
                if low <= start and high >= first and (i, k) not in gone:
                    gone.add((i, k))
                    number = left.get(i, holding.factors[i])
                    left[i] = number - 1
                    all_left = all_left // number * (number - 1) if number else 0

        total = 0
        for level in range(max(first, 0), count):
            if level > first:
                lose(fallen[level])
            before = all_left
            lose(ends[level])
            total += before - all_left
            lose(risen[level])
            if not all_left:
                return total
        return total + all_left

    holding = _Product([sum(low < 0 for low, _ in cell) for cell in known])
    total = without_entry(-1, -1)
    for level, (begun, ended) in enumerate(zip(begins, ends, strict=True)):
        if begun:
            total -= without_entry(level - 1, level)
            for cell, _ in begun:
                holding.change(cell, +1)
            total += without_entry(level, level)
        for cell, _ in ended:
            holding.change(cell, -1)
    return total


def switches(known: Levels) -> list[tuple[int, int]] | None:
    """The levels (A, B) of independent relays; None where a cell can skip one of its phases."""
    levels: set[tuple[int, int]] = set()
    for cell in known:
        own = [(a[1], b[0]) for a, b in pairwise(cell)]
        if any(p[0] > q[0] or p[1] > q[1] for p, q in pairwise(own)):
            return None
        levels.update(own)
    return sorted(levels)


def _falling(relays: Sequence[tuple[int, int]]) -> list[int]:
    """Numbers of subsequences of rising A and falling B that begin with each pair (A, B)."""
    order = sorted(range(len(relays)), key=lambda i: -relays[i][0])
    rank = {b: k for k, b in enumerate(sorted({b for _, b in relays}), 1)}
    # Sums of the numbers, by B, in the tree of Fenwick 1994.
    tree = [0] * (len(rank) + 1)
    lengths = [1] * len(relays)
    for _, together in groupby(order, key=lambda i: relays[i][0]):
        same = list(together)
        for i in same:
            k = rank[relays[i][1]] - 1
            while k:
                lengths[i] += tree[k]
                k &= k - 1
        for i in same:
            k = rank[relays[i][1]]
            while k < len(tree):
                tree[k] += lengths[i]
                k += k & -k
    return lengths


def ideals(relays: Iterable[tuple[int, int]]) -> int:
    """Number of states reached from all-0: sets of relays (A, B) that contain all predecessors.

    Source: the falling subsequences of B listed by rising A, the empty one included (theory page,
    "Relays"; Terzi and Mungan 2020).
    """
    return 1 + sum(_falling(sorted(set(relays))))


def sub_loops(relays: Iterable[tuple[int, int]]) -> int:
    """Number of sub-loops: pairs of states reached from all-0 that lead to each other.

    The main loop is not counted. A state I forms a loop by a rise to a and back if all relays set
    by the rise reset before any relay of I: each relay outside I with A ≤ a has its B above b, the
    largest B of I. So I contains all relays with A ≤ a and B ≤ b. The rest of I is an ideal of the
    relays with larger A and smaller B: falling subsequences again.

    Source: pairs as in Mungan and Terzi 2019; the count is ours (theory page, "Relays").
    """
    points = sorted(set(relays))
    if not points:
        return 0
    falling = _falling(points)
    fields = sorted({a for a, _ in points})
    number = {a: k for k, a in enumerate(fields)}
    up = np.array([number[a] for a, _ in points])
    down = np.array([b for _, b in points])
    # The largest B of the relays that go up at each A.
    above = np.full(len(fields), np.iinfo(np.int64).min)
    np.maximum.at(above, up, down)
    # From all-0 every rise is a loop, one of them the main one.
    total = len(fields) - 1
    weights = np.zeros(len(points), np.int64)
    for i, (a, b) in enumerate(zip(up.tolist(), down.tolist(), strict=True)):
        rises = above > b
        beyond = up[(down == b) & (up > a)]
        cap = int(np.min(beyond, initial=len(fields)))
        total += int(np.count_nonzero(rises[: a + 1])) * falling[i]
        passed = np.zeros(len(fields) + 1, np.int64)
        passed[a + 2 : cap + 1] = np.cumsum(rises[a + 1 : cap])
        passed[cap + 1 :] = passed[cap]
        total += int(passed[cap])
        weights += np.where(down < b, passed[up], 0)
    return total + sum(w * h for w, h in zip(weights.tolist(), falling, strict=True))


@dataclass(frozen=True, eq=False)
class Relays:
    """Switching fields of a chain, which determine its response to a prescribed force.

    A lever cell that is proved concave is one relay, A = F0 and B = F1. An element with P phases is
    P - 1 relays: relay k is up if the element is beyond phase k.

    Attributes:
        up, down: (M,) A and B, the forces at which a cell leaves phase k upwards, and comes back to
            it out of phase k + 1 [N].
        first: (N + 1,) relays of cell i are first[i] .. first[i + 1].
        equal: whether all cells are proved concave and have equal full travels.
        slip: fields no further apart than this tie [N].
    """

    up: Floats
    down: Floats
    first: Ints
    equal: bool
    slip: float = 0.0

    @property
    def cell(self) -> Ints:
        """(M,) cell of each relay."""
        return np.repeat(np.arange(len(self.first) - 1), np.diff(self.first))

    @property
    def step(self) -> Ints:
        """(M,) phase k that each relay leaves upwards."""
        return np.arange(len(self.up)) - self.first[self.cell]

    @property
    def windows(self) -> tuple[tuple[tuple[float, float], ...], ...]:
        """Forces at which each phase is stable [N], by cell and phase; infinite at the ends."""
        ends = zip(self.first.tolist(), self.first[1:].tolist(), strict=False)
        up, down = self.up.tolist(), self.down.tolist()
        return tuple(
            tuple(zip((-np.inf, *down[a:b]), (*up[a:b], np.inf), strict=True)) for a, b in ends
        )

    @property
    def skips(self) -> bool:
        """Whether a cell can skip one of its phases; then its relays are not independent."""
        own = np.diff(self.cell) == 0
        return bool(np.any(own & ((np.diff(self.up) < 0) | (np.diff(self.down) < 0))))

    def precedes(self, i: int, j: int) -> bool:
        """i ≺ j: relay i goes up before j and also comes down after it."""
        return bool(self.up[i] < self.up[j] and self.down[i] < self.down[j])

    def raised(self, state: str) -> Bools:
        """(M,) whether each relay is up in a state."""
        return np.array([int(digit) for digit in state])[self.cell] > self.step

    def state(self, raised: Bools) -> str:
        """The state in which these relays are up, and no others."""
        counts = np.diff(np.append(0, np.cumsum(raised))[self.first])
        return "".join(map(str, counts.tolist()))


def relays(chain: Chain, *, ties: bool = False) -> Relays | None:
    """The switching fields of a chain.

    None where a lever cell is not proved concave, where an element has friction or a curve that
    folds back, or where two fields tie, unless `ties` is True.
    """
    levers = [simple(cell) for cell in chain.cells if not isinstance(cell, Element)]
    rubbing = any(len(one.laws) > 1 or one.friction > 0 for one in chain.elements)
    if rubbing or None in levers:
        return None
    ends, proved = proved_ends(np.array(levers).reshape(-1, 6))
    if not np.all(proved):
        return None
    rows = iter(ends)
    parts = [
        np.array(cell.fields).reshape(-1, 2) if isinstance(cell, Element) else next(rows)[None]
        for cell in chain.cells
    ]
    first = np.append(0, np.cumsum([len(part) for part in parts]))
    pairs = np.concatenate(parts)
    size = np.max(np.abs(pairs), initial=0.0)
    if not ties and np.any(np.diff(np.sort(pairs, axis=0), axis=0) <= TIED * size):
        return None
    equal = not chain.elements and one_travel(chain)
    return Relays(pairs[:, 0], pairs[:, 1], first, equal, TIED * float(size))


@dataclass(frozen=True)
class RelayPlan:
    """Turning states; or a pair (i, j) that excludes the target: j up, i down, and i ≺ j."""

    states: tuple[str, ...]
    blocked: tuple[int, int] | None = None


def fewest_strokes(fields: Relays, start: str, target: str) -> RelayPlan:
    """The fewest strokes that bring relays from one state to another, where none skips a phase.

    Planned backward from the end. The last stroke, if it goes up, sets all relays with A below some
    field. It must not set a relay that is down in the target, so it may go up to just below the
    least A of these. Then the earlier states of the relays it sets do not matter. The stroke before
    it goes down and has to fit fewer relays; and so on, until the remaining relays fit at the
    start. Each stroke sets as many relays as allowed, so no program has fewer strokes.

    Source: Preisach 1935; Terzi and Mungan 2020 for the states; the plan is ours (theory page).
    """
    if start == target:
        return RelayPlan(())
    begin, goal = fields.raised(start), fields.raised(target)
    plans = [_backward(fields, begin, goal, last) for last in (+1, -1)]
    if ways := [plan for plan in plans if plan is not None]:
        return RelayPlan(min(ways, key=len))
    pairs = product(np.flatnonzero(~goal).tolist(), np.flatnonzero(goal).tolist())
    blocked = [pair for pair in pairs if fields.precedes(*pair)]
    # Pairs with a relay that differs from the start explain the failure best.
    blocked.sort(key=lambda pair: all(begin[k] == goal[k] for k in pair))
    return RelayPlan((), blocked[0])


def _backward(fields: Relays, before: Bools, target: Bools, last: int) -> tuple[str, ...] | None:
    relevant = np.ones(len(target), bool)
    limits: list[tuple[int, float]] = []
    direction, idle = last, 0
    while np.any(relevant & (before != target)):
        if direction > 0:
            limit = float(np.min(fields.up[relevant & ~target], initial=np.inf))
            satisfied = relevant & (fields.up < limit)
        else:
            limit = float(np.max(fields.down[relevant & target], initial=-np.inf))
            satisfied = relevant & (fields.down > limit)
        idle = 0 if np.any(satisfied) else idle + 1
        if idle > 0 and (limits or idle > 1):
            return None
        relevant &= ~satisfied
        limits.append((direction, limit))
        direction = -direction
    state = before.copy()
    states: list[str] = []
    for way, limit in reversed(limits):
        state = state | (fields.up < limit) if way > 0 else state & ~(fields.down > limit)
        states.append(fields.state(state))
    return tuple(states)
