"""How a standing robot shares its weight: forces and moments balance, and the lever rule."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from robot.robots import explorer, robot
from stepwell.robot import Body, Floor, Foot
from stepwell.robot.stance import _without_feet, feet_load, feet_places, leaning, supports_load

travels = st.lists(
    st.tuples(st.floats(0.0, 0.020), st.sampled_from([0.0, 0.0, 0.010])), min_size=2, max_size=2
).map(lambda pair: [np.array(each) for each in pair])


@given(travels, st.floats(0.0, 0.03), st.floats(-0.02, 0.02), st.floats(0.0001, 0.0012))
def test_forces_and_moments_of_a_standing_robot_balance(travels, x, y, below):
    one = robot(body=Body(centre=(x, y, 0.012)), foot=Foot(below=below))
    feet = feet_load(one, travels)
    supports = supports_load(one, travels, feet)
    assert (feet >= 0.0).all()
    assert (supports >= 0.0).all()
    # A foot in the air hangs on the body.
    assert feet.sum() + supports.sum() == pytest.approx(one.weight)
    mass, centre = _without_feet(one, travels)
    moment = mass * 9.81 * centre
    moment = moment + one.foot.mass * 9.81 * feet_places(one, travels).sum(axis=0)
    carried = feet @ feet_places(one, travels) + supports @ np.asarray(one.body.supports)
    assert carried == pytest.approx(moment, abs=1e-8)


def test_two_feet_and_the_front_of_the_t_foot_share_by_the_lever_rule():
    one = robot()
    rest = [np.zeros(2)] * 2
    feet = feet_load(one, rest)
    supports = supports_load(one, rest, feet)
    # Feet 8 mm and front supports 38 mm ahead of the origin; the rear support is off the floor.
    mass, centre = _without_feet(one, rest)
    together = mass * 9.81 * (0.038 - centre[0]) / (0.038 - 0.008)
    assert feet == pytest.approx([together / 2 + 0.0066 * 9.81] * 2)
    assert supports[0] == pytest.approx(0.0, abs=1e-12)
    assert supports[1] == pytest.approx(supports[2])


def test_a_foot_behind_carries_less_and_a_foot_in_the_air_nothing():
    one = robot()
    rest, behind, up = np.zeros(2), np.array([0.020, 0.0]), np.array([0.0, 0.010])
    assert feet_load(one, [behind, behind])[0] < feet_load(one, [rest, rest])[0]
    alone = feet_load(one, [rest, up])
    assert alone[1] == 0.0
    assert alone[0] > feet_load(one, [rest, rest])[0]


def test_an_antenna_ahead_takes_weight_off_the_feet():
    one = explorer()
    rest = [np.zeros(2)] * 2
    assert feet_load(one, rest).sum() < feet_load(replace(one, antennas=()), rest).sum()


def test_without_gravity_nothing_is_carried():
    one = robot(floor=Floor(gravity=0.0))
    rest = [np.zeros(2)] * 2
    feet = feet_load(one, rest)
    assert feet == pytest.approx([0.0, 0.0])
    assert supports_load(one, rest, feet) == pytest.approx([0.0, 0.0, 0.0])


def test_a_body_leans_from_the_leg_that_would_lift_onto_the_one_that_would_step():
    one = robot(0.005, 0.020)
    even = feet_load(one, [np.zeros(2)] * 2)
    left, right = leaning(one)
    assert left < even[0]
    assert right > even[1]
    assert left + right == pytest.approx(even.sum(), rel=0.2)
    assert leaning(robot(0.012)) == pytest.approx(even)


def test_a_little_leaning_makes_what_the_last_cells_lack_equal():
    one = robot(0.0148, 0.0152)
    lacks = [leg.chain.levers[1].force_0 - leg.chain.levers[0].force_0 for leg in one.legs]
    held = leaning(one) * float(one.foot.lever(0.0))
    assert lacks[0] - held[0] == pytest.approx(lacks[1] - held[1])
    assert held[0] != pytest.approx(held[1])
