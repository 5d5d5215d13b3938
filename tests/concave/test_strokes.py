"""Graphs of concave cells in closed form, by stroke and by force."""

from itertools import permutations
from typing import Any

import numpy as np
import pytest

import stepwell as sw
from facts import refuses
from sizes import cases
from stepwell.concave import (
    DECIDED,
    FORCE,
    NOT_PROVED,
    STROKE,
    TIES,
    KeyCounts,
    classed,
    closed_graph,
    graph_by_ends,
    proved_ends,
)
from stepwell.sequences import TransitionKind

R, SIN = 0.01 * 2**0.5, np.sin(np.pi / 4)
DRIVES = {STROKE: None, FORCE: "force"}


def drawn(rng, *shape) -> Any:
    """Cells of the paper's map, with one band or up to two, as plain numbers."""
    numbers = np.empty((*shape, 6))
    numbers[..., 0] = rng.uniform(0.01, 0.03, shape)
    numbers[..., 1] = rng.uniform(-0.015, 0.015, shape)
    numbers[..., 2] = rng.uniform(28.5, 57, shape)
    numbers[..., 3:] = 0.01, R, SIN
    return numbers


def chain_of(numbers):
    return sw.Chain(
        [
            sw.Cell(
                sw.Band(p=(0.0, 0.0), q=(dx, dy), stiffness=k, rest_length=rest),
                lever=lever,
                limit=float(np.arcsin(sin)),
            )
            for dx, dy, k, rest, lever, sin in numbers.tolist()
        ]
    )


def ways_of(chain, drive):
    graph = chain.graph(DRIVES[drive])
    return sorted(
        (a, b, one.direction, one.kind is TransitionKind.SNAP) for a, b, one in graph.transitions()
    )


@pytest.mark.slow
@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize(
    ("cells", "count"),
    cases([(1, 3), (2, 25), (3, 40), (4, 12)], [(1, 3), (2, 10), (3, 15), (4, 4)]),
)
def test_closed_form_finds_the_graph_that_the_engine_finds(cells, count, drive):
    numbers = drawn(np.random.default_rng(7), count, cells)
    status = classed(numbers, drive)[3]
    assert np.sum(status == DECIDED) >= count - 1
    for one in numbers[status == DECIDED]:
        assert sorted(closed_graph(one, drive)) == ways_of(chain_of(one), drive)


@pytest.mark.parametrize("drive", DRIVES)
def test_a_key_is_the_same_for_the_same_graph_and_for_no_other(drive):
    numbers = drawn(np.random.default_rng(1), 60, 3)
    key, _, _, status = classed(numbers, drive)
    by_key, by_graph = {}, {}
    for one, k in zip(numbers[status == DECIDED], key[status == DECIDED].tolist(), strict=True):
        # Cells in the order in which they load, as the key takes them.
        order = np.argsort(proved_ends(one)[0][:, 0])
        graph = frozenset(closed_graph(one[order], drive))
        assert by_key.setdefault(k, graph) == graph
        assert by_graph.setdefault(graph, k) == k
    assert len(by_key) > 3


@pytest.mark.parametrize("drive", DRIVES)
def test_it_does_not_matter_which_cell_is_where(drive):
    one = drawn(np.random.default_rng(2), 3)
    keys = {int(classed(one[list(order)][None], drive)[0][0]) for order in permutations(range(3))}
    assert len(keys) == 1 and keys != {-1}


def test_cycles_are_those_of_the_engine():
    numbers = drawn(np.random.default_rng(3), 20, 3)
    for one, code in zip(numbers, classed(numbers, STROKE)[1].tolist(), strict=True):
        digits = [code // 3**k % 3 for k in reversed(range(6))]
        state, states = ["0"] * 3, ["000"]
        for place, cell in enumerate(digits):
            state[cell] = "1" if place < 3 else "0"
            states.append("".join(state))
        assert str(chain_of(one).cycle().sequence) == ">".join(states)


def test_what_is_not_proved_has_no_key():
    numbers = drawn(np.random.default_rng(4), 3, 2)
    numbers[0, 1, 0] = 0.0  # no falling force
    numbers[1, 1] = numbers[1, 0]  # a tie
    numbers[2, 1, 4] *= 1.1  # another travel
    key, cycle, _, status = classed(numbers, STROKE)
    assert status.tolist() == [NOT_PROVED, TIES, NOT_PROVED]
    assert key.tolist() == [-1] * 3 and cycle.tolist() == [-1] * 3


def test_a_graph_is_kept_while_forces_come_nearer_by_less_than_the_gap():
    rng = np.random.default_rng(5)
    numbers = drawn(rng, 200, 2)
    key, _, gap, _ = classed(numbers, STROKE)
    ends = np.array([proved_ends(one)[0] for one in list(numbers)])
    scale = np.max(np.abs(ends), axis=(1, 2))
    for k in range(200):
        # Stiffness scales all forces of a cell: by so little that none passes another.
        moved = numbers[k].copy()
        moved[0, 2] *= 1 + 0.99 * gap[k, 0] * scale[k] / np.max(np.abs(ends[k, 0]))
        assert classed(moved[None], STROKE)[0][0] == key[k]


def test_too_many_cells_are_refused():
    with refuses(sw.InputError, "7 cells", "at most 6"):
        classed(drawn(np.random.default_rng(0), 1, 7), STROKE)


def test_end_forces_alone_tell_no_stroke_of_three_cells():
    with refuses(sw.InputError, "3 cells", "a stroke", "2"):
        graph_by_ends(np.arange(6.0).reshape(3, 2), STROKE)


@pytest.mark.parametrize("drive", DRIVES)
def test_end_forces_alone_tell_two_cells(drive):
    for one in list(drawn(np.random.default_rng(6), 20, 2)):
        assert graph_by_ends(proved_ends(one)[0], drive) == closed_graph(one, drive)


def test_a_tally_counts_as_numpy_does():
    rng = np.random.default_rng(8)
    key, gap = rng.integers(-1, 40, 5000) * 10**15, rng.random(5000)
    key_counts = KeyCounts(100)
    for first in range(0, 5000, 777):
        key_counts.add(key[first : first + 777], gap[first : first + 777], first)
    there, sizes = np.unique(key[key >= 0], return_counts=True)
    best = [np.flatnonzero(key == k)[np.argmax(gap[key == k])] for k in there]
    wanted = [there.tolist(), sizes.tolist(), gap[best].tolist(), [int(b) for b in best]]
    assert [list(column) for column in zip(*key_counts.rows, strict=True)] == wanted


def test_a_tally_says_when_there_are_too_many():
    with refuses(sw.InputError, "more than 10", "different graphs"):
        KeyCounts(10).add(np.arange(12), np.ones(12), 0)
