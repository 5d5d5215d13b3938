"""Requirements: parts of a target, and their smallest contradictory part."""

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations, islice, product

import numpy as np

from stepwell.base import ByValue, InputError, from_unit, number, to_unit
from stepwell.design.orders import Orders, TargetOrders, order_of
from stepwell.mechanism import Chain
from stepwell.sequences import Program, Sequence as Cycled, cycle, state_after

LOADING, UNLOADING = 0, 1
_WAYS = ("loading", "unloading")
# Pairs of orders that are compared, and different ones that are tried.
_MOST_COMPARED, _MOST_ORDERS = 5000, 24
# Larger sets of requirements are reduced one by one instead of in all combinations.
_ALL_COMBINATIONS = 12

GRAMMAR = (
    "'2 before 1 loading', '3 last unloading', '1 first loading', 'order 2-1-3 loading', "
    "'state 101', '100 to 110', 'never 1*0', '2 never without 1', 'never both half way', "
    "'101 after 40 mm', '3 cells'"
)

# (way, i, j): cell i moves before cell j.
Edge = tuple[int, int, int]
# One of the alternatives has to hold, and of it every edge.
Clause = tuple[frozenset[Edge], ...]


@dataclass(frozen=True, slots=True, eq=False)
class Requirement(ByValue):
    """One part of a target, such as "2 before 1 loading".

    Cells are numbered from the inner one, 1. Of a chain of two, "inner" and "outer" are also read.

    - `2 before 1 loading`, `2 before 1 unloading`: one cell moves before another one.
    - `3 first loading`, `3 last unloading`: before, or after, all others.
    - `order 2-1-3 loading`: the whole order.
    - `state 101`: a stroke program reaches this state from all cells at 0.
    - `100 to 110`: from the first state the drive leads to the second one, and to no other between.
    - `never 1*0`: no stroke program reaches a state of this pattern; * is any digit.
    - `2 never without 1`: cell 2 is at 1 only where cell 1 is.
    - `never both half way`, or of more cells `never two half way`: no stroke program brings two
      cells between their stops at once, in snaps neither. So no snap moves two cells: the order of
      unloading is the reverse of that of loading (theory page, "Sorting").
    - `101 after 40 mm`: loaded from all cells at 0 to this stroke, the unloading chain passes 101
      before any other state with all cells at stops.
    - `3 cells`: the number of cells.

    Attributes:
        text: as above.
        kind: "before", "place", "order", "state", "step", "never", "apart", "after" or "cells".
        cells: numbers of the cells it names, from 0.
        way: 0 for loading, 1 for unloading.
        state: the state or pattern it names, of a step the first; or "first" or "last".
        drive: the stroke [m], for "after".
    """

    text: str
    kind: str
    cells: tuple[int, ...] = ()
    way: int = LOADING
    state: str = ""
    drive: float = math.nan

    @classmethod
    def parse(cls, text: str) -> "Requirement":
        """The requirement of a text; InputError with the grammar for any other text."""
        words = " ".join(str(text).split())
        for pattern, build in _FORMS:
            match = re.fullmatch(pattern, words)
            if match:
                return build(cls, words, *match.groups())
        raise InputError(f"requirement {words!r}: must be one of {GRAMMAR}.")

    @property
    def least_cells(self) -> int:
        """Smallest number of cells of a chain to which it can apply."""
        named = [len(self.state) * (self.kind != "place"), *(cell + 1 for cell in self.cells)]
        return max([*named, 2 * (self.kind == "apart")])

    @property
    def needs_concave(self) -> bool:
        """Whether it follows from two orders only for concave cells of one full travel."""
        return self.kind == "apart" or bool(self.state and self.kind != "place")

    def clauses(self, n: int) -> list[Clause]:
        """What it requires of the two orders of n cells."""
        if self.kind == "order" or self.kind == "before":
            pairs = combinations(self.cells, 2)
            return [(frozenset({(self.way, i, j)}),) for i, j in pairs]
        if self.kind == "place":
            (cell,) = self.cells
            others = [i for i in range(n) if i != cell]
            ends = [(cell, i) if self.state == "first" else (i, cell) for i in others]
            return [(frozenset({(self.way, i, j)}),) for i, j in ends]
        if self.kind == "apart":
            return [_last_in_first_out(i, j) for i, j in combinations(range(n), 2)]
        if self.kind == "step":
            return [*self._of_states(), self._first_of_all()]
        return self._of_states()

    def _first_of_all(self) -> Clause:
        """The cell of a step is the first one of those that could move.

        Source: theory page, "Stroke programs", (a).
        """
        (cell,) = self.cells
        still = [i for i, digit in enumerate(self.state) if digit == "01"[self.way]]
        return (frozenset((self.way, cell, i) for i in still if i != cell),)

    def _of_states(self) -> list[Clause]:
        """What a state or a pattern requires of the two orders."""
        empty, full = (
            [i for i, digit in enumerate(self.state) if digit == one] for one in ("0", "1")
        )
        pairs = [*product(empty, full)]
        if self.kind in ("state", "step", "after"):
            # An ideal: no cell at 0 is both before one at 1 in F0 and after it in unloading.
            return [
                (frozenset({(LOADING, j, i)}), frozenset({(UNLOADING, i, j)})) for i, j in pairs
            ]
        if self.kind == "never":
            return [tuple(frozenset({(LOADING, i, j), (UNLOADING, j, i)}) for i, j in pairs)]
        return []

    def __str__(self):
        return self.text


def _last_in_first_out(i: int, j: int) -> Clause:
    """Two cells with one order of F0 and F1, so that the later one does not snap with the other."""
    return tuple(frozenset({(LOADING, a, b), (UNLOADING, b, a)}) for a, b in ((i, j), (j, i)))


def _cell(text: str) -> int:
    named = {"inner": 0, "outer": 1}
    if text in named:
        return named[text]
    if not text.isdecimal() or not 1 <= int(text) <= 99:
        raise InputError(f"cell {text!r}: must be a number from 1, the inner one.")
    return int(text) - 1


def _before(cls: type, text: str, a: str, b: str, way: str) -> Requirement:
    if _cell(a) == _cell(b):
        raise InputError(f"requirement {text!r}: a cell cannot move before itself; name two cells.")
    return cls(text, "before", (_cell(a), _cell(b)), _WAYS.index(way))


def _place(cls: type, text: str, a: str, place: str, way: str) -> Requirement:
    return cls(text, "place", (_cell(a),), _WAYS.index(way), place)


def _order(cls: type, text: str, order: str, way: str) -> Requirement:
    cells = order_of(order, ("inner", "outer"))
    if not cells:
        raise InputError(f"requirement {text!r}: name each cell once, as in 'order 2-1-3 loading'.")
    return cls(text, "order", cells, _WAYS.index(way))


def _state(cls: type, text: str, state: str) -> Requirement:
    return cls(text, "state", state=state)


def _never(cls: type, text: str, pattern: str) -> Requirement:
    return cls(text, "never", state=pattern)


def _apart(cls: type, text: str, several: str) -> Requirement:
    return cls(text, "apart", (0, 1) if several == "both" else ())


def _step(cls: type, text: str, first: str, second: str) -> Requirement:
    moved = [i for i, (a, b) in enumerate(zip(first, second, strict=False)) if a != b]
    if len(first) != len(second) or len(moved) != 1:
        raise InputError(
            f"requirement {text!r}: the states must have one length and differ in one cell, as in "
            f"'100 to 110'."
        )
    return cls(text, "step", tuple(moved), "01".index(first[moved[0]]), first)


def _without(cls: type, text: str, a: str, b: str) -> Requirement:
    one, other = _cell(a), _cell(b)
    if one == other:
        raise InputError(f"requirement {text!r}: name two different cells.")
    pattern = ["*"] * (max(one, other) + 1)
    pattern[one], pattern[other] = "1", "0"
    return cls(text, "never", (one, other), state="".join(pattern))


def _after(cls: type, text: str, state: str, drive: str) -> Requirement:
    return cls(text, "after", state=state, drive=from_unit(float(drive), "mm"))


def _cells(cls: type, text: str, n: str) -> Requirement:
    if not 1 <= int(n) <= 99:
        raise InputError(f"requirement {text!r}: must be between 1 and 99 cells.")
    return cls(text, "cells", (int(n) - 1,))


_ONE, _WAY = r"(\d+|inner|outer)", "(loading|unloading)"
_FORMS = (
    (rf"{_ONE} before {_ONE} {_WAY}", _before),
    (rf"{_ONE} (first|last) {_WAY}", _place),
    (rf"order (\S+) {_WAY}", _order),
    (r"state ([01]+)", _state),
    (r"([01]+) to ([01]+)", _step),
    (r"never ([01*]+)", _never),
    (rf"{_ONE} never without {_ONE}", _without),
    (r"never (both|two) half way", _apart),
    (r"([01]+) after (\d+(?:\.\d+)?) mm", _after),
    (r"(\d+) cells?", _cells),
)


class Reach:
    """Which of n cells move before which others, closed under transitivity."""

    def __init__(self, n: int):
        self.after = [0] * n  # bits of all cells after each

    def copy(self) -> "Reach":
        """The same relations, to be extended."""
        other = Reach(0)
        other.after = [*self.after]
        return other

    def add(self, i: int, j: int) -> bool:
        """Add i before j and all that follows; False where this closes a cycle."""
        if i == j or self.after[j] >> i & 1:
            return False
        more = self.after[j] | 1 << j
        self.after = [
            one | more if k == i or one >> i & 1 else one for k, one in enumerate(self.after)
        ]
        return True

    def order(self, like: Sequence[int]) -> tuple[int, ...]:
        """The linear extension that takes the earliest free cell in `like` each time."""
        left, line = [*like], list[int]()
        while left:
            cell = next(c for c in left if not any(self.after[k] >> c & 1 for k in left))
            left.remove(cell)
            line.append(cell)
        return tuple(line)

    def extensions(self) -> Iterator[tuple[int, ...]]:
        """All linear extensions."""
        n, line = len(self.after), list[int]()

        def grow(left: frozenset[int]) -> Iterator[tuple[int, ...]]:
            if not left:
                yield tuple(line)
            for cell in sorted(left):
                if not any(self.after[k] >> cell & 1 for k in left):
                    line.append(cell)
                    yield from grow(left - {cell})
                    line.pop()

        return grow(frozenset(range(n)))


def _solved(clauses: list[Clause], both: tuple[Reach, Reach]) -> Iterator[tuple[Reach, Reach]]:
    """All choices of one alternative a clause that leave both orders without a cycle."""
    if not clauses:
        yield both
        return
    first, *rest = clauses
    for alternative in first:
        now = both[0].copy(), both[1].copy()
        if all(now[way].add(i, j) for way, i, j in sorted(alternative)):
            yield from _solved(rest, now)


@dataclass(frozen=True, eq=False)
class Requirements(ByValue):
    """Several requirements together.

    Attributes:
        parts: the requirements.
        cells: number of cells; by default the smallest number to which all can apply.
    """

    parts: tuple[Requirement, ...]
    cells: int = field(default=0)

    def __post_init__(self):
        counts = [one.cells[0] + 1 for one in self.parts if one.kind == "cells"]
        least = max((one.least_cells for one in self.parts), default=0)
        given = {*counts, *filter(None, [self.cells])}
        if len(given) > 1:
            raise InputError(f"numbers of cells {sorted(given)}: give one number of cells.")
        n = next(iter(given), least)
        for one in self.parts:
            wrong = one.kind in ("state", "step", "after") and len(one.state) != n
            wrong |= one.kind == "never" and not one.cells and len(one.state) != n
            wrong |= one.kind in ("order", "apart") and len(one.cells) not in (0, n)
            if wrong or one.least_cells > n:
                way = (
                    "Write 'never two half way'"
                    if one.kind == "apart"
                    else "Name every cell in a state, pattern or order, or state the number, as in "
                    f"'{least} cells'"
                )
                raise InputError(
                    f"requirement {one.text!r}: does not fit a chain of {n} cells. {way}."
                )
        if n < 1:
            raise InputError(f"requirements: give one or more, such as {GRAMMAR}.")
        object.__setattr__(self, "cells", n)

    @classmethod
    def parse(cls, texts: str | Iterable[str], cells: int = 0) -> "Requirements":
        """Requirements of texts, or of one text with semicolons between them."""
        parts = texts.split(";") if isinstance(texts, str) else [*texts]
        return cls(tuple(Requirement.parse(one) for one in parts if str(one).strip()), cells)

    @property
    def text(self) -> str:
        """All requirements in a line."""
        return "; ".join(one.text for one in self.parts)

    def possible(self, parts: Iterable[Requirement] | None = None) -> bool:
        """Whether some two orders meet these parts, by default all."""
        return next(self._pairs(self.parts if parts is None else parts), None) is not None

    def _pairs(self, parts: Iterable[Requirement]) -> Iterator[tuple[Reach, Reach]]:
        clauses = [clause for one in parts for clause in one.clauses(self.cells)]
        # Clauses with one alternative decide others early.
        clauses.sort(key=len)
        yield from _solved(clauses, (Reach(self.cells), Reach(self.cells)))

    @cached_property
    def conflict(self) -> tuple[Requirement, ...]:
        """The smallest part that no two orders meet; empty if all can be met.

        Of up to 12 requirements all combinations are tried, so none is smaller. More are left out
        one by one: then no requirement of the result can be spared.
        """
        if self.possible():
            return ()
        if len(self.parts) <= _ALL_COMBINATIONS:
            sizes = range(1, len(self.parts) + 1)
            every = (part for size in sizes for part in combinations(self.parts, size))
            return next(part for part in every if not self.possible(part))
        left = [*self.parts]
        for one in self.parts:
            fewer = [other for other in left if other is not one]
            if not self.possible(fewer):
                left = fewer
        return tuple(left)

    def met_by(self, orders: Orders) -> bool:
        """Whether two orders meet all parts, without those about a stroke in mm."""
        place = [{cell: k for k, cell in enumerate(o)} for o in (orders.loading, orders.unloading)]
        return all(
            any(all(place[way][i] < place[way][j] for way, i, j in option) for option in clause)
            for one in self.parts
            for clause in one.clauses(self.cells)
        )

    def orders(self, *, alike: bool) -> TargetOrders:
        """Pairs of orders that meet all parts: all of them, or 24 that differ most.

        Orders that differ only in the labels of the cells count as one if cells are `alike`.
        """
        if self.conflict:
            shown = "; ".join(f"'{one}'" for one in self.conflict)
            several = "contradict each other" if len(self.conflict) > 1 else "cannot be met"
            why = (
                f"the requirements {shown} {several}: no two orders of loading and unloading meet "
                f"them. Leave one of them out"
            )
            return TargetOrders((), states=frozenset({"0" * self.cells}), why=why)
        different: dict[tuple[int, ...] | Orders, Orders] = {}
        counted = 0
        for both in self._pairs(self.parts):
            for orders in _candidates(both):
                different.setdefault(orders.pattern if alike else orders, orders)
            for pair in product(both[0].extensions(), both[1].extensions()):
                counted += 1
                orders = Orders(*pair)
                different.setdefault(orders.pattern if alike else orders, orders)
                if counted >= _MOST_COMPARED or len(different) > _MOST_ORDERS:
                    break
            if counted >= _MOST_COMPARED or len(different) > _MOST_ORDERS:
                break
        whole = counted < _MOST_COMPARED and len(different) <= _MOST_ORDERS
        return TargetOrders(tuple(islice(different.values(), _MOST_ORDERS)), whole)

    @property
    def by_states(self) -> bool:
        """Whether a requirement names states, of which two orders give the least only."""
        return any(one.kind in ("state", "step", "never") for one in self.parts)

    def fault(self, chain: Chain, sequence: Cycled, reached: frozenset[str] | None) -> str:
        """The first requirement that a chain misses, with its full cycle and reachable states.

        States are not checked where `reached` is None.
        """
        if sequence.orders is None or not self.met_by(Orders(*sequence.orders)):
            return f"has the sequence {sequence}"
        faults = (_state_fault(one, reached) for one in self.parts if reached is not None)
        if fault := next(filter(None, faults), ""):
            return fault
        if fault := next(filter(None, (_motion_fault(chain, one) for one in self.parts)), ""):
            return fault
        for one in self.parts:
            if one.kind == "after" and one.drive > chain.full_stroke:
                return f"ends at {number(to_unit(chain.full_stroke, 'mm'))} mm"
            if one.kind == "after":
                passed = state_after(chain, one.drive)
                if passed != one.state:
                    at = number(to_unit(one.drive, "mm"))
                    return f"passes {passed or 'no state'} after {at} mm"
        return ""


def _candidates(both: tuple[Reach, Reach]) -> Iterator[Orders]:
    """Orders near the extremes: unloading in the order of loading, and in the reverse order."""
    n = len(both[0].after)
    for like in (range(n), range(n)[::-1]):
        loading = both[0].order(like)
        yield Orders(loading, both[1].order(loading[::-1]))
        yield Orders(loading, both[1].order(loading))


def _motion_fault(chain: Chain, one: Requirement) -> str:
    """How a chain misses a step, or a requirement on cells half way; "" if it does not."""
    return _snap_fault(chain) if one.kind == "apart" else _step_fault(chain, one)


def _snap_fault(chain: Chain) -> str:
    """The first snap that moves several cells; "" for none."""
    several = (event.cells for event in cycle(chain).snaps if len(event.cells) > 1)
    cells = next(several, ())
    return f"cells {' and '.join(str(cell + 1) for cell in cells)} snap together" if cells else ""


def _step_fault(chain: Chain, one: Requirement) -> str:
    """How a step misses its second state under a prescribed stroke; "" if it does not."""
    if one.kind != "step" or not math.isinf(chain.actuator_stiffness):
        return ""
    (cell,) = one.cells
    first, full = np.array([digit == "1" for digit in one.state]), np.array(chain.full_travels)
    second = first ^ (np.arange(len(full)) == cell)
    drives = float(full @ first), float(full @ second)
    wanted = "".join("01"[int(digit)] for digit in second)
    passed = Program.given(chain, drives, start=one.state, target=wanted).sequence
    return "" if str(passed) == f"{one.state}>{wanted}" else f"{one.state} leads to {passed}"


def _state_fault(one: Requirement, states: frozenset[str]) -> str:
    if one.kind in ("state", "step") and one.state not in states:
        return f"{one.state} is not reached"
    if one.kind == "never":
        pattern = re.compile(one.state.replace("*", ".") + ".*")
        met = sorted(filter(pattern.fullmatch, states))
        return f"{met[0]} is reached" if met else ""
    return ""
