"""Walks against their predictions: the same gaits, or the reason why not."""

import pytest

from facts import says
from simulation.robots import FORWARD, robot
from sizes import SIZE
from stepwell.robot import Drive
from stepwell.simulation import compare_gaits, walk
from stepwell.simulation.comparison import _same_cycle


def test_a_walk_in_its_predicted_gait_says_so():
    comparison = compare_gaits(walk(robot(), 2))
    assert (comparison.same, comparison.text) == (True, "gaits as predicted")
    assert comparison.predicted == (FORWARD, FORWARD)


@pytest.mark.slow
def test_a_robot_on_a_soft_drive_gets_stuck_as_predicted():
    one = walk(robot(drive=Drive(stiffness=50.0)), 3)
    assert one.gaits["left"] == ("00>10", "10", "10")
    assert one.advance[0] == pytest.approx(0.82, abs=0.02)
    assert one.advance[1:] == pytest.approx(0.0, abs=2e-3)
    comparison = compare_gaits(one)
    assert comparison.same
    says(comparison.text, "stuck", "state 10")


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [70.0, *[300.0] * (SIZE == "full")])
def test_the_drive_pushes_and_pulls_as_hard_as_predicted(stiffness):
    one = robot(drive=Drive(stiffness=stiffness))
    walked, needs = walk(one, 2), one.predict().drive_needs
    assert walked.actuator_force.max() == pytest.approx(needs.push, rel=0.06)
    assert -walked.actuator_force.min() == pytest.approx(needs.pull, rel=0.06)


@pytest.mark.slow
def test_a_walk_that_differs_says_why():
    # Between 60 N/m and what statics takes for enough the simulated robot comes back too late.
    one = walk(robot(drive=Drive(stiffness=60.0)), 2)
    comparison = compare_gaits(one)
    assert comparison.same is False
    says(comparison.text, "left", "10", "instead of 00>10>00")
    says(comparison.text, "too soft", "60 N/m")
    says(comparison.text, "carriage", "mm")


def test_a_walk_without_a_whole_cycle_is_not_compared():
    comparison = compare_gaits(walk(robot(), 0.3))
    assert comparison.same is None and "no whole cycle" in comparison.text


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        ("00>10>11>01>00", "00>10>11>01>00", True),
        ("01>00>10>11>01", "00>10>11>01>00", True),
        ("00>10>11>01", "00>10>11>01>00", True),
        ("00>01>11>10>00", "00>10>11>01>00", False),
        ("10", "00>10>00", False),
        ("", "10", False),
        ("10", "10", True),
    ],
)
def test_a_gait_is_the_same_wherever_its_cycle_begins(one, other, same):
    assert _same_cycle(one, other) is same
