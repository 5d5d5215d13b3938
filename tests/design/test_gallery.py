"""The machines of the gallery do what their titles say, and bear what a workshop does to them."""

from itertools import permutations

import numpy as np
import pytest

import stepwell as sw
from sizes import cases
from stepwell import files
from stepwell.design import survival

MACHINES = ("finger-selector", "combination-lock", "used-before", "countdown", "metachronal-wave")
CAREFUL = sw.Tolerances(anchor=0.0003, stiffness=0.05)


def state_of(chain: sw.Chain, travels) -> str:
    """Every cell stands at a stop."""
    full = np.array([cell.full_travel for cell in chain.cells])
    assert np.all((travels < 1e-9) | (travels > full - 1e-9))
    return "".join("1" if s > 0.01 else "0" for s in travels)


@pytest.mark.parametrize("name", MACHINES)
def test_the_program_in_the_file_ends_where_the_file_says(name):
    chain, plan = sw.preset(name), files.load(f"preset:{name}").program
    assert plan is not None
    path = chain.path(plan.turning_points, start=plan.start)
    assert state_of(chain, path.end) == plan.ends
    assert not path.degenerate


@pytest.mark.slow
@pytest.mark.parametrize("name", cases(MACHINES, [*MACHINES][:2]))
def test_ninety_five_of_a_hundred_built_with_care_do_it(name):
    chain, plan = sw.preset(name), files.load(f"preset:{name}").program
    assert plan is not None and plan.ends is not None
    made = survival(chain, plan.turning_points, plan.ends, CAREFUL, start=plan.start, samples=200)
    assert made.interval[0] > 0.95


def test_the_finger_selector_leaves_only_finger_k_up():
    hand = sw.preset("finger-selector")
    for k in range(1, 6):
        turns = [0.0, 0.020 * k, 0.020] if k > 1 else [0.0, 0.020]
        assert state_of(hand, hand.path(turns).end) == "0" * (k - 1) + "1" + "0" * (5 - k)


@pytest.mark.slow
def test_the_lock_opens_for_one_order_of_its_four_turning_points():
    lock, plan = sw.preset("combination-lock"), files.load("preset:combination-lock").program
    assert plan is not None
    first, *points = plan.turning_points
    assert len(points) == 4
    opening = [
        order
        for order in permutations(points)
        if np.allclose(lock.path([first, *order]).end, [0, 0.020, 0, 0.020], atol=1e-9)
    ]
    assert opening == [tuple(points)]
    # No shorter program does it, and no other state of the four cells needs as many strokes.
    strokes = {state: lock.program(state).strokes for state in map("{:04b}".format, range(16))}
    assert [state for state, count in strokes.items() if count == 4] == ["0101"]


def test_the_seal_once_broken_cannot_be_mended_by_any_stroke():
    seal = sw.preset("used-before")
    assert state_of(seal, seal.path([0.020, 0.040, 0.020], start="01").end) == "10"
    for start in ("00", "10", "11"):
        with pytest.raises(sw.Unreachable) as reason:
            seal.program("01", start=start)
        assert reason.value.proved


def test_the_countdown_counts_from_three_to_zero_and_stops():
    counter = sw.preset("countdown")
    shown = [
        state_of(counter, counter.path([0.040, *[0.068, 0.040] * pulls], start="01001").end)
        for pulls in range(8)
    ]
    assert shown[:4] == ["01001", "00101", "10100", "10010"]
    assert set(shown[3:]) == {"10010"}


def test_the_wave_runs_the_same_way_out_and_back():
    cycle = sw.preset("metachronal-wave").cycle()
    assert cycle.loading_order == cycle.unloading_order == tuple(range(6))
