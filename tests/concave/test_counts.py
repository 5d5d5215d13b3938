"""Counts of states of relays: what listing all of them says, by code that shares nothing."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from sizes import examples
from stepwell.concave.relays import (
    garden_states,
    ideals,
    levels,
    standing_states,
    sub_loops,
    switches,
)

Windows = list[list[tuple[float, float]]]


class Listed:
    """Every state of cells that do not feel each other, and where a force brings each."""

    def __init__(self, windows: Windows):
        self.windows = windows
        every = itertools.product(*(range(len(cell)) for cell in windows))
        self.states = [s for s in every if self.window(s)[0] <= self.window(s)[1]]
        self.up = {s: self.moved(s, +1) for s in self.states}
        self.down = {s: self.moved(s, -1) for s in self.states}

    def window(self, state):
        own = [cell[k] for cell, k in zip(self.windows, state, strict=True)]
        return max(low for low, _ in own), min(high for _, high in own)

    def moved(self, state, way):
        """Where the state goes just past an end of its window; None where it never ends."""
        low, high = self.window(state)
        force = high if way > 0 else low
        if math.isinf(force):
            return None
        after = []
        for cell, k in zip(self.windows, state, strict=True):
            while cell[k][1] <= force if way > 0 else cell[k][0] >= force:
                k += way
            after.append(k)
        return tuple(after)

    def from_first(self):
        seen = {tuple(0 for _ in self.windows)}
        waiting = list(seen)
        while waiting:
            state = waiting.pop()
            for target in (self.up[state], self.down[state]):
                if target is not None and target not in seen:
                    seen.add(target)
                    waiting.append(target)
        return seen

    def gardens(self):
        return set(self.states) - {*self.up.values(), *self.down.values()}

    def sub_loops(self):
        loops = 0
        for low in self.from_first():
            high = self.up[low]
            while high is not None:
                back = self.down[high]
                while back is not None and back != low:
                    back = self.down[back]
                loops += back == low
                high = self.up[high]
        return max(loops - 1, 0)


def two_phases(up, down) -> Windows:
    return [[(-math.inf, a), (b, math.inf)] for a, b in zip(up, down, strict=True)]


def check(windows: Windows):
    """All counts of these cells, but what nobody can count where a phase is passed by."""
    listed, known = Listed(windows), levels(windows, 0.0)
    assert standing_states(known) == len(listed.states)
    assert garden_states(known) == len(listed.gardens())
    relays = switches(known)
    if relays is not None:
        assert ideals(relays) == len(listed.from_first())
        assert sub_loops(relays) == listed.sub_loops()
    return relays


@pytest.mark.slow
@pytest.mark.parametrize("n", range(1, 11))
def test_counts_of_hysterons_are_those_of_all_their_states(n):
    rng = np.random.default_rng(n)
    for _ in range(examples(4, full=160)):
        fields = np.sort(rng.permutation(2 * n).reshape(n, 2), axis=1)
        assert check(two_phases(fields[:, 1], fields[:, 0])) is not None


@pytest.mark.slow
@pytest.mark.parametrize("n", [12, 14])
def test_counts_of_hysterons_are_those_of_all_their_states_up_to_fourteen(n):
    rng = np.random.default_rng(n)
    for k in range(examples(2, full=80)):
        # Of every second one all states stand.
        up, down = rng.permutation(n) + n * (k % 2), rng.permutation(n) - 0.5 * n
        check(two_phases(np.maximum(up, down + 0.5), down))


fields = st.integers(-4, 4)


@pytest.mark.slow
@given(st.lists(st.tuples(fields, fields).map(sorted), min_size=1, max_size=7))
def test_fields_may_tie(pairs):
    down, up = zip(*pairs, strict=True)
    check(two_phases([a + 0.5 for a in up], down))
    # A cell may go up at the force at which another comes down.
    check(two_phases([a + 1 for a in up], down))


@st.composite
def elements(draw):
    """The windows of an element of one to four phases, on a curve that turns at these forces."""
    turns = draw(st.lists(st.tuples(fields, fields), max_size=3))
    lows, highs = [-math.inf], []
    for one, other in turns:
        highs.append(max(one, other) + 0.5)
        lows.append(min(one, other))
    return list(zip(lows, [*highs, math.inf], strict=True))


def is_curve(cell) -> bool:
    """Whether rising stretches with these windows can follow each other: each falls in between."""
    return all(low < high for low, high in cell)


@given(st.lists(elements().filter(is_curve), min_size=1, max_size=4))
def test_elements_of_several_phases_are_counted_even_where_one_is_passed_by(cells):
    check(cells)


@pytest.mark.slow
@given(st.lists(st.integers(1, 3), min_size=1, max_size=5), st.randoms(use_true_random=False))
def test_elements_whose_fields_rise_are_as_many_relays(steps, random):
    cells = []
    for count in steps:
        up = sorted(random.sample(range(12), count))
        down = sorted(random.sample(range(-6, 6), count))
        low = [-math.inf, *(min(b, a - 0.5) for a, b in zip(up, down, strict=True))]
        cells.append(list(zip(low, [*map(float, up), math.inf], strict=True)))
    assert check([[*map(tuple, cell)] for cell in cells]) is not None


def test_a_state_stands_to_the_last_digit_as_the_engine_says_and_fields_of_one_way_tie():
    hair = math.nextafter(0.6, 1.0)
    cells = two_phases([0.6, 2.0, 2.0 + 1e-12], [-1.0, hair, -1.0])
    assert levels(cells, 1e-9) == [[(-1, 1), (0, 4)], [(-1, 3), (2, 4)], [(-1, 3), (0, 4)]]
    # At no force is the first cell still at 0 and the second still at 1.
    assert standing_states(levels(cells, 1e-9)) == len(Listed(cells).states) == 6


def test_both_extremes_of_relays_have_their_numbers():
    nested = [(k, -k) for k in range(24)]
    following = [(k, k) for k in range(24)]
    assert ideals(nested) == 2**24
    assert ideals(following) == 25
    # Relays that follow each other make one loop for each stretch of them; one is the main loop.
    assert sub_loops(following) == 24 * 25 // 2 - 1
    assert ideals([(k, -k) for k in range(1000)]) == 2**1000


def test_of_bistable_cells_a_quarter_is_a_garden_of_eden_if_two_cells_go_first():
    rng = np.random.default_rng(5)
    up, down = rng.permutation(1000) + 1.0, -rng.permutation(1000) - 1.0
    known = levels(two_phases(up, down), 0.0)
    assert standing_states(known) == 2**1000
    alike = int(np.argmin(up)) == int(np.argmax(down))
    assert garden_states(known) == (0 if alike else 2**998)


@pytest.mark.slow
def test_ten_thousand_cells_are_counted():
    rng = np.random.default_rng(7)
    n = 10_000
    windows = two_phases(rng.permutation(n) + 1.0, -rng.permutation(n) - 1.0)
    known = levels(windows, 0.0)
    relays = switches(known)
    assert relays is not None
    assert standing_states(known) == 2**n
    assert garden_states(known) in (0, 2 ** (n - 2))
    # Fewer falling subsequences than those of any n numbers, more than those of any two.
    assert n + 1 < ideals(relays) < sub_loops(relays) < 2**n
