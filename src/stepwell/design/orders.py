"""From what a chain shall do to the orders of its end forces that do it."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import combinations, pairwise, product

import numpy as np

from stepwell.base import InputError, Ints
from stepwell.concave import ideals
from stepwell.sequences import Sequence


def checked_cycle(target: str, last: str, name: str = "target") -> str:
    """A full cycle such as "00>10>11>01>00" without its spaces; messages call it `name`.

    `last` is the state with every cell in its last phase. ValueError for a text that is no cycle.
    """
    states, two = target.replace(" ", "").split(">"), set(last) == {"1"}
    wrong = next((state for state in states if not is_state(state, last)), None)
    problem = ""
    if wrong is not None:
        digits = "characters 0 or 1" if two else f"digits up to {last}"
        problem = (
            f"state {short(wrong)!r} must be {len(last)} {digits}, one a cell, inner first, with > "
            f"between states;"
        )
    elif {states[0], states[-1]} != {"0" * len(last)} or last not in states:
        ends = ("at 0", "at 1") if two else ("in their first phase", "in their last")
        problem = (
            f"a full cycle begins and ends with all cells {ends[0]} and passes the state with all "
            f"{ends[1]};"
        )
    elif any(a == b for a, b in pairwise(states)):
        problem = "the same state twice in a row; name it once a visit,"
    if problem:
        example = short(_example(last))
        raise InputError(f"{name} = {short(target)!r}: {problem} for example {example!r}.")
    return ">".join(states)


def is_state(state: str, last: str) -> bool:
    """Whether a text is a state of cells of which `last` is the last one."""
    return len(state) == len(last) and all("0" <= a <= b for a, b in zip(state, last, strict=True))


def _example(last: str) -> str:
    steps = [cell for cell, digit in enumerate(last) for _ in range(int(digit))]
    state, states = [0] * len(last), ["0" * len(last)]
    for way, cell in product((1, -1), steps):
        state[cell] += way
        states.append("".join(map(str, state)))
    return ">".join(states)


def orders_of(target: str) -> Ints | None:
    """(2, T) the switches of a full cycle in the order in which they go up, and come down.

    None unless each goes up once and then comes down once, one by one. Of cells with two phases,
    each is the number of its cell.
    """
    states = np.array([[int(digit) for digit in state] for state in target.split(">")], np.int64)
    last, steps = np.max(states, axis=0), np.diff(states, axis=0)
    ways = np.repeat([1, -1], np.sum(last))
    if np.any(np.sum(np.abs(steps), axis=1) != 1) or not np.array_equal(steps.sum(axis=1), ways):
        return None
    moved = np.nonzero(steps)
    phase = np.minimum(states[:-1], states[1:])[moved]
    return ((np.cumsum(last) - last)[moved[1]] + phase).reshape(2, -1)


def numbered_cycle(number: int, cells: int) -> str:
    """The cycle whose two orders are the digits of a number in base `cells`."""
    digits = [number // cells**place % cells for place in reversed(range(2 * cells))]
    return str(Sequence.full_cycle(digits[:cells], digits[cells:]))


def short(sequence: str) -> str:
    """A sequence that fits on a line."""
    return sequence if len(sequence) <= 80 else f"{sequence[:60]}..."


# Many orders may do the same, more or less surely. So many are tried, of so many.
_MOST_ORDERS = 24
_MOST_COMPARED = 5000


@dataclass(frozen=True)
class Orders:
    """Cells in ascending F0, the order of loading, and in descending F1, that of unloading."""

    loading: tuple[int, ...]
    unloading: tuple[int, ...]

    def __len__(self) -> int:
        return len(self.loading)

    @property
    def rising(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Cells in ascending F0, and in ascending F1."""
        return self.loading, self.unloading[::-1]

    @property
    def sequence(self) -> Sequence:
        """The states of one full cycle."""
        return Sequence.full_cycle(self.loading, self.unloading)

    @property
    def pattern(self) -> tuple[int, ...]:
        """Places in ascending F1 of the cells taken in ascending F0: alike but for labels."""
        return tuple(self.rising[1].index(cell) for cell in self.loading)

    @property
    def states(self) -> tuple[str, ...]:
        """What can be reached from all cells at 0, by the number of cells at 1."""
        ideals = {frozenset[int]()}
        for k, j in enumerate(self.loading):
            # A cell is at 1 only where all that load before it and unload after it are.
            needs = {*self.loading[:k]} & {*self.unloading[self.unloading.index(j) + 1 :]}
            ideals |= {ideal | {j} for ideal in ideals if needs <= ideal}
        return by_cells_at_1("".join("01"[i in one] for i in range(len(self))) for one in ideals)

    @property
    def count(self) -> int:
        """How many these states are, counted without listing them (theory page)."""
        return ideals((k, -self.unloading.index(cell)) for k, cell in enumerate(self.loading))

    @property
    def nested(self) -> bool:
        """Whether of every two cells the one that loads first unloads first: 2^N states."""
        return self.loading == self.unloading


def by_cells_at_1(states: Iterable[str]) -> tuple[str, ...]:
    """States in the order in which they are listed everywhere: by the switches that are up."""
    return tuple(sorted(set(states), key=lambda s: (sum(map(int, s)), s[::-1])))


class NoOrders(Exception):
    """No two orders do what is wanted; the text says why."""


def of_sequence(text: str) -> Orders:
    """The orders of a cycle in which every cell loads once and unloads once, or ValueError."""
    cells = len(str(text).partition(">")[0].strip())
    if cells == 0:
        raise InputError(f'sequence = {text!r}: must be a cycle such as "00>10>11>01>00".')
    text = checked_cycle(str(text), "1" * cells, "sequence")
    orders = Sequence.parse(text).orders
    if orders is None:
        raise InputError(
            f"sequence = {short(text)!r}: chains of concave cells load one cell at a time until "
            f"all are at 1, then unload one at a time, as in 00>10>11>01>00. For states beside "
            f"such a cycle, design(states=[...])."
        )
    return Orders(*orders)


@dataclass(frozen=True)
class TargetOrders:
    """Orders that do what is wanted."""

    orders: tuple[Orders, ...]  # different ones; any will do
    complete: bool = True  # whether there are no others
    states: frozenset[str] | None = None  # those wanted, where they were listed
    why: str = ""  # why there are no orders, where there are none
    never: bool = False  # whether that forbids it to every chain, of whatever cells
    stepwise: bool = True  # whether states lead from all cells at 0 to all at 1, one by one

    @property
    def cells(self) -> int:
        """How many cells are wanted."""
        return len(self.orders[0]) if self.orders else len(next(iter(self.states or ("",))))


def of_states(states: Iterable[str] | str, cells: int | None, alike: bool) -> TargetOrders:
    """Orders for which exactly these states, or "all", can be reached from all cells at 0.

    What two orders tell that can be reached are the order ideals of i < j where F0_i < F0_j and
    F1_i < F1_j. So the wanted ones must be all ideals of some partial order, which is that of "j is
    at 1 only where i is", and it must be met by two orders of the cells. Orders that differ only in
    which cell is which count as one where cells may be built `alike`.
    """
    if states == "all":
        if cells is None or cells < 1:
            raise InputError(f'states = "all" with cells = {cells}: say how many cells, 1 or more.')
        antichain = [[i == j for j in range(cells)] for i in range(cells)]
        return _orders_of(antichain, alike, None)
    target, n = _checked_states(states, cells)
    listed = frozenset(target)
    for name, state in (("0", "0" * n), ("1", "1" * n)):
        if state not in target:
            why = (
                f"{state} is not among the wanted states, but a chain has all its cells at {name} "
                f"in every full cycle: add it"
            )
            return TargetOrders((), states=listed, why=why, never=True)
    try:
        return _orders_of(_partial_order(target, n), alike, listed)
    except NoOrders as reason:
        return TargetOrders((), states=listed, why=str(reason), stepwise=_stepwise(target, n))


def _stepwise(target: set[str], n: int) -> bool:
    front = {"0" * n}
    for _ in range(n):
        more = {s[:i] + "1" + s[i + 1 :] for s in front for i in range(n) if s[i] == "0"}
        front = more & target
    return bool(front)


def _orders_of(below: "Below", alike: bool, states: frozenset[str] | None) -> TargetOrders:
    clash = _clash(below)
    if clash is not None:
        a, b = clash
        raise NoOrders(
            f"no two orders of end forces do this, as cell {a + 1} would have to come both before "
            f"and after cell {b + 1} in one of them (the states make a partial order of a "
            f"dimension above two)"
        )
    different: dict[tuple[int, ...] | Orders, Orders] = {}
    antichain = sum(map(sum, below)) == len(below)
    for looked_at, orders in enumerate(_realisers(below)):
        different.setdefault(orders.pattern if alike else orders, orders)
        if alike and antichain:
            break  # all others have the same pattern
        if len(different) == _MOST_ORDERS or looked_at == _MOST_COMPARED:
            return TargetOrders(tuple(different.values()), False, states)
    return TargetOrders(tuple(different.values()), True, states)


def _checked_states(given: Iterable[str] | str, cells: int | None) -> tuple[set[str], int]:
    if isinstance(given, str):
        raise InputError(f'states = {given!r}: must be "all" or a list such as ["00", "10", "11"].')
    target = {str(state) for state in given}
    n = len(next(iter(target), ""))
    if n == 0 or any(len(s) != n or set(s) - {"0", "1"} for s in target):
        raise InputError(
            f"states = {sorted(target)}: must be states of 0 and 1, one a cell, inner first, and "
            f"as long as each other."
        )
    if cells not in (None, n):
        raise InputError(f"cells = {cells}, but the states have {n} cells: leave `cells` out.")
    return target, n


Below = list[list[bool]]  # below[i][j]: j is at 1 only where i is


def _partial_order(target: set[str], n: int) -> Below:
    # Birkhoff: a family with empty and full set, closed under union and intersection, holds
    # exactly the ideals of the preorder that it makes.
    numbers = {int(state, 2) for state in target}
    for a, b in combinations(sorted(numbers), 2):
        for needed, words in ((a | b, "either of them"), (a & b, "both")):
            if needed not in numbers:
                first, second, third = (f"{number:0{n}b}" for number in (a, b, needed))
                raise NoOrders(
                    f"{first} and {second} are wanted, so {third}, with the cells that are at 1 in "
                    f"{words}, comes with them"
                )
    below = [[all(s[i] == "1" for s in target if s[j] == "1") for j in range(n)] for i in range(n)]
    for i, j in combinations(range(n), 2):
        if below[i][j] and below[j][i]:
            raise NoOrders(
                f"cells {i + 1} and {j + 1} are in the same state in all that is wanted, but a "
                f"chain moves one cell at a time: add a state with only one of them at 1"
            )
    return below


def _clash(below: Below) -> tuple[int, int] | None:
    """Two cells that no pair of orders can place, or None if there are none.

    Of two cells that are not compared, F0 has one first and F1 the other. If F0 has a before b, and
    c is compared with a but not with b, then F0 has c before b as well, or b would lie between a
    and c. Such consequences are followed; where they come back to b before a, no orders exist, and
    else they do (Gallai 1967; Golumbic, Algorithmic Graph Theory and Perfect Graphs, 1980, Theorem
    5.27).
    """
    free: Below = (~(np.array(below) | np.array(below).T)).tolist()
    for a, b in combinations(range(len(below)), 2):
        if free[a][b] and (b, a) in _following(free, a, b):
            return a, b
    return None


def _following(free: Below, a: int, b: int) -> set[tuple[int, int]]:
    """Pairs of cells that F0 has in this order if it has a before b."""
    n = len(free)
    seen, waiting = {(a, b)}, [(a, b)]
    while waiting:
        i, j = waiting.pop()
        follows = [(k, j) for k in range(n) if k != i and free[k][j] and not free[k][i]]
        follows += [(i, k) for k in range(n) if k != j and free[i][k] and not free[j][k]]
        waiting += (fresh := set(follows) - seen)
        seen |= fresh
    return seen


def _realisers(below: Below) -> Iterator[Orders]:
    """Every pair of orders that agree exactly on what the partial order says.

    F0 must be a linear extension in which no b stands between a and c > a without being compared
    with either (Dushnik & Miller 1941); F1 is then the other way round wherever the partial order
    does not decide.
    """
    n = len(below)
    line: list[int] = []
    free: Below = (~(np.array(below) | np.array(below).T)).tolist()

    def fits(c: int) -> bool:
        if any(below[i][c] and i != c and i not in line for i in range(n)):
            return False
        # Cells between a < c in the line must be compared with one of the two.
        for place, a in enumerate(line):
            if below[a][c] and any(free[a][b] and free[b][c] for b in line[place + 1 :]):
                return False
        return True

    def grow() -> Iterator[Orders]:
        if len(line) == n:
            place = np.argsort(line)
            # How many cells come before each in ascending F1.
            before = np.sum(np.where(free, place[:, None] > place, below), axis=0)
            yield Orders(tuple(line), tuple(np.argsort(before)[::-1].tolist()))
            return
        for c in range(n):
            if c not in line and fits(c):
                line.append(c)
                yield from grow()
                line.pop()

    return grow()
