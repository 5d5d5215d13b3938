"""Orders of the critical forces that give a target sequence or a target set of states."""

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import chain, combinations, islice, pairwise, permutations, product

import numpy as np

from stepwell.base import InputError, Ints
from stepwell.concave import ideals
from stepwell.sequences import Sequence


def checked_cycle(target: str, last: str, name: str = "target", names: tuple[str, ...] = ()) -> str:
    """The full cycle of a target without spaces; messages call it `name`.

    A target is a state sequence such as "00>10>11>01>00", or for cells of two phases the orders of
    loading and unloading such as "1-2/2-1" or, with cell `names`, "inner-outer/outer-inner". `last`
    is the state with every cell in its last phase. ValueError for any other text.
    """
    cycle = _cycle_of_orders(str(target), last, name, names)
    if cycle:
        return cycle
    refuse_order(str(target), name, names, len(last))
    states, two = target.replace(" ", "").split(">"), set(last) == {"1"}
    wrong = next((state for state in states if not is_state(state, last)), None)
    problem = ""
    if wrong is not None:
        digits = "characters 0 or 1" if two else f"digits up to {last}"
        problem = (
            f"state {short(wrong)!r} must be {len(last)} {digits}, one per cell, cell 1 (the inner "
            f"one) first, with > between states;"
        )
    elif {states[0], states[-1]} != {"0" * len(last)} or last not in states:
        ends = ("at 0", "at 1") if two else ("in their first phase", "in their last")
        problem = (
            f"a full cycle begins and ends with all cells {ends[0]} and includes the state with "
            f"all {ends[1]};"
        )
    elif any(a == b for a, b in pairwise(states)):
        problem = "the same state twice in a row; write it once per visit,"
    if problem:
        example = short(_example(last))
        raise InputError(f"{name} = {short(target)!r}: {problem} for example {example!r}.")
    return ">".join(states)


def is_state(state: str, last: str) -> bool:
    """Whether a text is a state of cells whose last state is `last`."""
    return len(state) == len(last) and all("0" <= a <= b for a, b in zip(state, last, strict=True))


def _example(last: str) -> str:
    steps = [cell for cell, digit in enumerate(last) for _ in range(int(digit))]
    state, states = [0] * len(last), ["0" * len(last)]
    for way, cell in product((1, -1), steps):
        state[cell] += way
        states.append("".join(map(str, state)))
    return ">".join(states)


def orders_of(target: str) -> Ints | None:
    """Switches of a full cycle (2, T), in the order in which they go up and come down.

    None unless each switch goes up once and then comes down once, one at a time. For cells with two
    phases, the number of a switch is that of its cell.
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
    """Full cycle whose two orders are the digits of a number in base `cells`."""
    digits = [number // cells**place % cells for place in reversed(range(2 * cells))]
    return str(Sequence.full_cycle(digits[:cells], digits[cells:]))


def short(sequence: str) -> str:
    """The sequence, cut to fit on a line."""
    return sequence if len(sequence) <= 80 else f"{sequence[:60]}..."


# Several pairs of orders may give one set of states, with different yields: at most this many are
# tried, out of at most this many that are compared.
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
        """Ranks in F1 of cells in ascending F0: equal for chains that differ in names."""
        return tuple(self.rising[1].index(cell) for cell in self.loading)

    @property
    def states(self) -> tuple[str, ...]:
        """States reachable from all cells at 0, by the number of cells at 1."""
        ideals = {frozenset[int]()}
        for k, j in enumerate(self.loading):
            # A cell is at 1 only where all that load before it and unload after it are.
            needs = {*self.loading[:k]} & {*self.unloading[self.unloading.index(j) + 1 :]}
            ideals |= {ideal | {j} for ideal in ideals if needs <= ideal}
        return by_cells_at_1("".join("01"[i in one] for i in range(len(self))) for one in ideals)

    @property
    def count(self) -> int:
        """Number of these states, counted without listing them (theory page)."""
        return ideals((k, -self.unloading.index(cell)) for k, cell in enumerate(self.loading))

    @property
    def nested(self) -> bool:
        """Whether the cells unload in the order in which they load: 2^N states."""
        return self.loading == self.unloading


def by_cells_at_1(states: Iterable[str]) -> tuple[str, ...]:
    """States in the order of all lists: by the number of switches that are up."""
    return tuple(sorted(set(states), key=lambda s: (sum(map(int, s)), s[::-1])))


def order_of(text: str, names: tuple[str, ...] = ()) -> tuple[int, ...]:
    """Cells, 0 the innermost, of an order such as "2-1-3" of numbers or names; () for no order."""
    parts = [part.strip() for part in re.split("[->,]", text) if part.strip()] or [""]
    parts = text.split() if len(parts) == 1 else parts
    numbers = _numbered(parts, names)
    if len(numbers) < 2 or set(numbers) != {str(cell + 1) for cell in range(len(numbers))}:
        return ()
    return tuple(int(number) - 1 for number in numbers)


def refuse_order(text: str, name: str, names: tuple[str, ...] = (), cells: int = 0) -> None:
    """Raise InputError for an order such as "2-1-4" that does not name each cell once."""
    if ">" in text or not re.search("[-/,]", text) or set(text) <= set("01, "):
        return
    if len(states := re.findall(r"0\d*|1\d+", text)) > 1 and "-".join(states) == text:
        raise InputError(
            f"{name}: write > between states, {short('>'.join(states))}, or name each cell once "
            f"in an order, as in 2-1-3."
        )
    halves = text.split("/")
    orders = [_numbered([one.strip() for one in re.split("[-,]", half)], names) for half in halves]
    cells = cells or max([2, *(int(one) for one in chain(*orders) if one.isdecimal())])
    for half, order in zip(halves, orders, strict=True):
        for fault in _faults(order, cells):
            raise InputError(
                f"{name}: order {short(half)}: {fault}. Name each cell once, the inner one 1, "
                f"as in 2-1-3, or give the states, as in 00>10>11>01>00."
            )


def _numbered(order: list[str], names: tuple[str, ...]) -> list[str]:
    """An order with numbers in place of the names of cells."""
    return [str(names.index(one) + 1) if one in names else one for one in order]


def _faults(order: list[str], cells: int) -> Iterator[str]:
    """Faults of an order of that many cells; each assumes that none comes before it."""
    for one in order:
        if not one.isdecimal() or not int(one):
            yield f"{one!r} is no cell, the first is 1" if one else "a number is missing"
    yield from (f"cell {one} appears twice" for one in order if order.count(one) > 1)
    yield from (f"there is no cell {one}" for one in order if int(one) > cells)
    yield from (f"cell {k} is missing" for k in range(1, cells + 1) if str(k) not in order)


def _cycle_of_orders(target: str, last: str, name: str, names: tuple[str, ...]) -> str:
    """The cycle of a target given as "loading/unloading"; "" for one given as states."""
    loading, *unloading = (order_of(half, names) for half in target.split("/"))
    if set(last) != {"1"} or {*map(len, (loading, *unloading))} != {len(last)}:
        return ""
    back = unloading[0] if len(unloading) == 1 else loading
    cycle = str(Sequence.full_cycle(loading, back))
    if len(unloading) == 1 and ">" not in target:
        return cycle
    first, second = ("-".join(str(cell + 1) for cell in order) for order in (loading, back))
    half = cycle[: (len(last) + 1) ** 2 - 1]
    raise InputError(
        f"{name} = {short(target)!r} is not a state sequence (one digit per cell, cell 1 first). "
        f"For the loading order {first} write {short(half)} and then the states of unloading; with "
        f"the unloading order {second}: {short(cycle)!r}, or {f'{first}/{second}'!r}."
    )


class NoOrders(Exception):
    """No two orders give the target; the text states the reason."""


@dataclass(frozen=True)
class TargetOrders:
    """Orders that give the target."""

    orders: tuple[Orders, ...]  # different ones; each of them gives the target
    complete: bool = True  # whether there are no others
    states: frozenset[str] | None = None  # target states, if they were listed
    why: str = ""  # reason if there are no orders
    never: bool = False  # whether the reason holds for every chain of any cells
    stepwise: bool = True  # whether states lead from all cells at 0 to all at 1, one by one

    @property
    def cells(self) -> int:
        """Number of cells of the target."""
        return len(self.orders[0]) if self.orders else len(next(iter(self.states or ("",))))


def of_sequence(text: str) -> TargetOrders:
    """Orders of a cycle in which every cell loads once and unloads once, or ValueError.

    The text is a state sequence, "loading/unloading" such as "2-1-3/1-2-3", or a loading order
    such as "2-1-3", for which any unloading order will do.
    """
    pair = ("inner", "outer")
    loading = order_of(text.partition("/")[0], pair)
    if loading and not {">", "/", ","} & {*text}:
        back = islice(permutations(loading[::-1]), _MOST_ORDERS)
        complete = math.factorial(len(loading)) <= _MOST_ORDERS
        return TargetOrders(tuple(Orders(loading, unloading) for unloading in back), complete)
    refuse_order(text, "sequence", pair)
    cells = len(loading) or len(text.partition(">")[0].strip())
    if cells == 0:
        raise InputError(f'sequence = {text!r}: must be a cycle such as "00>10>11>01>00".')
    text = checked_cycle(text, "1" * cells, "sequence", pair if cells == 2 else ())
    orders = Sequence.parse(text).orders
    if orders is None:
        raise InputError(
            f"sequence = {short(text)!r}: concave cells load one at a time until all are at 1 "
            f"and then unload one at a time, as in 00>10>11>01>00. For a set of "
            f"reachable states use design(states=[...])."
        )
    return TargetOrders((Orders(*orders),))


def of_states(states: Iterable[str] | str, cells: int | None, alike: bool) -> TargetOrders:
    """Orders for which exactly these states, or "all", can be reached from all cells at 0.

    Two orders make the order ideals of i < j reachable, where F0_i < F0_j and F1_i < F1_j. So the
    target states must be all ideals of one partial order, "j is at 1 only where i is", and two
    orders of the cells must realise it. Orders that differ only in the labels of the cells count as
    one if cells may be built `alike`.
    """
    if states == "all":
        if cells is None or cells < 1:
            raise InputError(f'states = "all" with cells = {cells}: give the number, cells=3.')
        antichain = [[i == j for j in range(cells)] for i in range(cells)]
        return _orders_of(antichain, alike, None)
    target, n = _checked_states(states, cells)
    listed = frozenset(target)
    for name, state in (("0", "0" * n), ("1", "1" * n)):
        if state not in target:
            why = (
                f"{state} is not among the target states, but all cells of a chain are at {name} "
                f"once in every full cycle: add {state}"
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
            f"no two orders of the critical forces give these states, since cell {a + 1} would "
            f"have to be both before and after cell {b + 1} in one of them (the states make a "
            f"partial order of a dimension above two)"
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
            f"states = {sorted(target)}: must be states of 0 and 1, one digit per cell, cell 1 "
            f"(the inner one) first, and all of one length."
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
                    f"a chain that reaches {first} and {second} also reaches {third}, with the "
                    f"cells that are at 1 in {words}: add {third}, or leave out one of the two"
                )
    below = [[all(s[i] == "1" for s in target if s[j] == "1") for j in range(n)] for i in range(n)]
    for i, j in combinations(range(n), 2):
        if below[i][j] and below[j][i]:
            raise NoOrders(
                f"cells {i + 1} and {j + 1} are in the same state in all target states, but one "
                f"cell at a time changes its state: add a state with only one of them at 1"
            )
    return below


def _clash(below: Below) -> tuple[int, int] | None:
    """Two cells that no pair of orders can place, or None if there are none.

    For two cells that are not compared, one is first in F0 and the other in F1. If a is before b in
    F0, and c is compared with a but not with b, then c is before b in F0 as well, or b would lie
    between a and c. These consequences are followed; no orders exist if they lead to b before a
    (Gallai 1967; Golumbic, Algorithmic Graph Theory and Perfect Graphs, 1980, Theorem 5.27).
    """
    free: Below = (~(np.array(below) | np.array(below).T)).tolist()
    for a, b in combinations(range(len(below)), 2):
        if free[a][b] and (b, a) in _following(free, a, b):
            return a, b
    return None


def _following(free: Below, a: int, b: int) -> set[tuple[int, int]]:
    """Pairs of cells whose order in F0 follows from a before b."""
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
    """All pairs of orders that agree exactly on the pairs that the partial order compares.

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
            # Number of cells before each in ascending F1.
            before = np.sum(np.where(free, place[:, None] > place, below), axis=0)
            yield Orders(tuple(line), tuple(np.argsort(before)[::-1].tolist()))
            return
        for c in range(n):
            if c not in line and fits(c):
                line.append(c)
                yield from grow()
                line.pop()

    return grow()
