"""Yields that ask for all mobilities, and mobilities as a tolerance."""

import math
from dataclasses import replace

import numpy as np
import pytest

import stepwell as sw
from chains import any_chain, concave_chain
from facts import says
from sizes import examples
from stepwell.design import Yield
from stepwell.design.tolerances.draws import Draws
from stepwell.design.tolerances.tally import BY_MOBILITY

RATIO = 10.0
NARROW = sw.Tolerances(stiffness=0.01)
# On the way up from 010, one of two elements goes on, as their mobilities will.
RACE = sw.Chain(
    [
        sw.elements.trilinear((0.003, 1.3), (0.010, 0.8), 100.0, 800.0),
        sw.elements.trilinear((0.005, 0.3), (0.008, 0.0), 200.0, 300.0),
        sw.elements.trilinear((0.004, 1.1), (0.015, -0.3), 400.0, 100.0),
    ]
)


@pytest.mark.slow
def test_a_landing_that_hangs_on_the_mobilities_takes_the_yield_away():
    plain, robust = RACE.yields(NARROW, samples=5), RACE.yields(NARROW, samples=5, robust=RATIO)
    assert (plain.fraction, plain.robust, plain.proved) == (1.0, None, None)
    assert (robust.fraction, robust.robust, robust.proved) == (0.0, RATIO, 0)
    assert dict(robust.outcomes) == {BY_MOBILITY: 5}
    says(robust.advice, "mobilities", "smaller ratio", "Tolerances(mobility=...)")
    assert RACE.yields(NARROW, samples=5, robust=1.5).fraction == 1.0


@pytest.mark.slow
def test_what_is_counted_is_right_and_all_its_landings_hold():
    chain = any_chain(np.random.default_rng(4), 3, friction=False)
    result = chain.yields(sw.Tolerances(anchor=0.0005), samples=examples(6), robust=RATIO)
    made = [result.mechanism(number).cycle() for number in range(result.samples)]
    right = [one for one in made if str(one.sequence) == result.target and not one.degenerate]
    holding = [one for one in right if all(x.holds for x in one.path.landings(RATIO))]
    assert result.successes == len(holding)
    assert result.outcomes.get(BY_MOBILITY, 0) == len(right) - len(holding)
    assert result.proved is not None and 0 <= result.proved <= result.successes


@pytest.mark.parametrize("stiffness", [math.inf, 300.0, 0.0])
def test_what_end_forces_tell_counts_as_proved_for_any_mobilities(stiffness):
    chain = replace(concave_chain(np.random.default_rng(5), 4), actuator_stiffness=stiffness)
    plain = chain.yields(samples=2000)
    robust = chain.yields(samples=2000, robust=1000.0)
    assert plain.by_engine == robust.by_engine == 0
    assert (robust.successes, robust.proved) == (plain.successes, plain.successes)
    assert dict(robust.outcomes) == dict(plain.outcomes)
    # And it is: random mobilities change nothing in the closed form.
    drawn = chain.yields(sw.Tolerances(0.0003, 0.05, mobility=1000.0), samples=2000)
    assert drawn.successes == plain.successes
    for number in range(examples(5)):
        assert found_by_engine(drawn, number) == found_by_engine(plain, number)


def found_by_engine(counted: Yield, number: int) -> str:
    return str(counted.mechanism(number).cycle().sequence)


def test_states_are_wanted_with_landings_that_hold():
    states = [label for label in RACE.graph(start="000").reachable() if "-" not in label]
    wanted = {state.partition("#")[0] for state in states}
    plain = RACE.yields(NARROW, samples=2, target=wanted)
    assert plain.fraction == 1.0
    assert dict(RACE.yields(NARROW, samples=2, target=wanted, robust=RATIO).outcomes) == {
        BY_MOBILITY: 2
    }


@pytest.mark.slow
def test_mobilities_are_drawn_evenly_on_a_scale_of_logarithms_within_their_ratio():
    tolerances = sw.Tolerances(mobility=25.0)
    drawn = [Draws(RACE, tolerances, 0).sample(k) for k in range(400)]
    factors = np.array([[cell.mobility for cell in made.cells] for made in drawn])
    assert np.all((factors >= 1 / 5) & (factors <= 5))
    shares = np.sort(np.log(factors * 5).ravel() / math.log(25))
    even = (np.arange(shares.size) + 0.5) / shares.size
    assert np.max(np.abs(shares - even)) < 1.6 / math.sqrt(shares.size)
    assert np.all(np.abs(np.corrcoef(factors.T) - np.eye(3)) < 0.2)


def test_mobilities_leave_all_else_as_it_is_drawn():
    rng = np.random.default_rng(6)
    chain = sw.Chain([*concave_chain(rng, 2).cells, *RACE.cells])
    some = sw.Tolerances(anchor=0.001, stiffness=0.05, travel=0.03, friction=0.02)
    for number in (0, 3, 500):
        one, other = (
            Draws(chain, replace(some, mobility=ratio), 7).sample(number) for ratio in (1.0, 10.0)
        )
        assert {cell.mobility for cell in one.cells} == {1.0}
        assert {cell.mobility for cell in other.cells} != {1.0}
        plain = tuple(replace(cell, mobility=1.0) for cell in other.cells)
        assert replace(other, cells=plain) == one


def test_a_mechanism_by_number_is_the_one_that_was_counted():
    draws = Draws(RACE, sw.Tolerances(stiffness=0.02, mobility=10.0), 3)
    rows = np.concatenate([piece.copy() for piece in draws.chunks(200)])
    assert all(draws.built(rows[k]) == draws.sample(k) for k in (0, 1, 63, 64, 199))


@pytest.mark.slow
def test_unknown_dampers_lower_the_yield_by_as_much_as_they_decide():
    result = RACE.yields(replace(NARROW, mobility=10.0), samples=60)
    assert 0.5 < result.fraction < 1.0
    assert BY_MOBILITY not in result.outcomes


@pytest.mark.parametrize("ratio", [0.9, 0.0, -2.0, math.inf, math.nan])
def test_a_ratio_below_one_is_refused(ratio):
    with pytest.raises(ValueError, match="mobility"):
        sw.Tolerances(mobility=ratio)


def test_mobilities_that_no_cell_can_have_are_refused_with_the_ratio_that_is_left():
    fast = replace(RACE, cells=tuple(replace(cell, mobility=10.0) for cell in RACE.cells))
    with pytest.raises(ValueError, match="at most 100"):
        fast.yields(sw.Tolerances(mobility=101.0), samples=1)
    assert fast.yields(sw.Tolerances(mobility=100.0), samples=2).samples == 2
    assert RACE.yields(sw.Tolerances(mobility=1e4), samples=2).samples == 2
