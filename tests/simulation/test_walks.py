"""The paper's gaits, from one set of assumed numbers: nothing is scripted, so they must emerge."""

import numpy as np
import pytest

from simulation.robots import BACKWARD, FORWARD, explorer, robot, walked
from stepwell.robot import Floor
from stepwell.simulation import walk

pytestmark = pytest.mark.slow
# After the first cycle, which begins from rest.
LATER = slice(1, None)


def test_two_forward_legs_walk_as_far_as_the_papers_robot():
    # Kamp et al. 2024, Fig. 3: d/u_max 0.71 per cycle.
    forward = walked(0.020, 0.020)
    assert forward.advance[LATER] == pytest.approx(0.71, abs=0.08)
    assert np.degrees(forward.turn[LATER]) == pytest.approx(0.0, abs=0.5)
    assert forward.gaits == {"left": (FORWARD,) * 4, "right": (FORWARD,) * 4}


def test_two_backward_legs_walk_as_far_as_the_papers_robot():
    # Kamp et al. 2024, Fig. 3: d/u_max 0.96 per cycle, backward.
    backward = walked(0.005, 0.005)
    assert backward.advance[LATER] == pytest.approx(-0.96, abs=0.04)
    assert backward.gaits == {"left": (BACKWARD,) * 4, "right": (BACKWARD,) * 4}


@pytest.mark.parametrize(("left", "right", "turn"), [(0.005, 0.020, 15.0), (0.020, 0.005, -15.0)])
def test_one_leg_of_each_turns_the_robot_on_the_spot_towards_the_backward_leg(left, right, turn):
    # Kamp et al. 2024, Fig. 3: π/12 per cycle.
    turning = walked(left, right)
    assert np.degrees(turning.turn[LATER]) == pytest.approx(turn, abs=2.5)
    assert np.abs(turning.advance[LATER]).max() < 0.15


def test_the_leg_at_15_mm_steps_clockwise_in_the_air_and_does_not_walk_on_the_floor():
    # Kamp et al. 2024: clockwise on the bench, and yet the robot did not step forward.
    air = robot(0.015, floor=Floor(gravity=0.0))
    hung = walk(air, 2)
    assert str(air.legs[0].chain.cycle().sequence) == FORWARD
    assert hung.gaits == {"left": (FORWARD,) * 2, "right": (FORWARD,) * 2}
    stood = walked(0.015, 0.015)
    assert np.abs(stood.advance[LATER]).max() < 0.1
    assert FORWARD not in stood.gaits["left"] + stood.gaits["right"]


def test_a_robot_in_the_air_goes_nowhere():
    hung = walk(robot(0.005, 0.020, floor=Floor(gravity=0.0)), 2)
    # What moves inside it moves the body a little; momentum is kept, so it comes back. Angular
    # momentum is kept too, but as with a falling cat that leaves room for a little rotation.
    assert np.abs(hung.advance).max() < 1e-3
    assert np.degrees(np.abs(hung.turn)).max() < 0.5
    assert hung.foot_force.max() == hung.support_force.max() == 0.0


def test_after_seven_and_three_quarter_cycles_the_legs_stand_as_in_the_papers_figure():
    # Kamp et al. 2024, Fig. 3: the forward leg in 01, the backward leg in 10.
    turning = walk(robot(0.005, 0.020), 7.75)
    assert turning.cycles == 7
    assert turning.state("right", 7.75 * 2.0) == "01"
    assert turning.state("left", 7.75 * 2.0) == "10"


def test_a_pressed_antenna_turns_the_opposite_leg_round_and_the_robot_away():
    one = explorer()
    free = walk(one, 3)
    assert free.gaits == {"left": (FORWARD,) * 3, "right": (FORWARD,) * 3}
    assert free.advance[LATER].min() > 0.6
    for name, side, opposite in (("left", 1, "right"), ("right", -1, "left")):
        # Where its anchor stands 4 mm further out, the paper's (-11, 0).
        pressed = walk(one.pressed({name: 0.48}), 3)
        assert pressed.gait(opposite, 2) == BACKWARD
        assert pressed.gait(name, 2) == FORWARD
        assert np.degrees(-side * pressed.turn[LATER]).min() > 10.0


def test_a_connected_antenna_rests_where_it_should_and_a_disconnected_one_leads_to_no_anchor():
    free = walk(explorer(), 1)
    assert np.abs(free.antenna).max() < 0.05 * 1.2
    loose = explorer(connected=False)
    assert loose.pressed({"left": 1.0}).legs == loose.legs
