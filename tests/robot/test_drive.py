"""A drive that gives: how far it takes the legs, what it needs for a gait, what becomes of it."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import stepwell as sw
from facts import refuses, says
from robot.robots import FORWARD, leg, robot
from sizes import examples
from stepwell.robot import Blocks, Drive, Floor, Motion, Robot
from stepwell.robot.leg_cycles import leg_cycles
from stepwell.robot.prediction import DriveNeeds, drive_needs, predicted_gaits, too_soft
from stepwell.robot.stance import Spring, largest

# Without weight and lag the legs are their chains and nothing else.
BARE = {"floor": Floor(gravity=0.0), "blocks": Blocks(damping=1e-9)}


def driven(stiffness: float, left: float = 0.020, right: float | None = None, **more) -> Robot:
    return robot(left, right, drive=Drive(stiffness=stiffness), **more)


@cache
def needed() -> DriveNeeds:
    """What the paper's robot needs of its drive."""
    return drive_needs(robot())


def strokes(one: Robot) -> tuple[float, float]:
    """Where the first cycle turns and ends [m]."""
    return leg_cycles(one)[0].first.turns[1:]


def engine(chain: sw.Chain) -> tuple[float, float]:
    """The same of a chain behind its actuator."""
    out, back = (chain.path(turns).end for turns in ([0.0, 0.04], [0.0, 0.04, 0.0]))
    return float(out.sum()), float(back.sum())


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_alike_legs_go_as_far_as_one_leg_behind_half_of_the_spring(seed):
    rng = np.random.default_rng(seed)
    for _ in range(examples(2)):
        stiffness, q = np.exp(rng.uniform(3.0, 6.0)), rng.uniform(0.004, 0.024)
        chain = replace(leg("left", q).chain, actuator_stiffness=stiffness / 2)
        assert strokes(driven(stiffness, q, **BARE)) == pytest.approx(engine(chain), abs=2e-5)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_unlike_legs_go_as_far_as_two_elements_side_by_side(seed):
    rng = np.random.default_rng(10 + seed)
    for _ in range(examples(1)):
        stiffness, q = np.exp(rng.uniform(3.0, 6.0)), rng.uniform(0.004, 0.024, 2)
        legs = [sw.Element.from_chain(leg("left", one).chain) for one in q]
        chain = sw.Chain([sw.Element.side_by_side(legs)], actuator_stiffness=stiffness)
        assert strokes(driven(stiffness, *q, **BARE)) == pytest.approx(engine(chain), abs=2e-5)


def test_a_spring_holds_the_carriage_where_it_gives_what_the_legs_ask_for():
    # One leg whose force rises by 1 N over 10 mm, falls by 2 N at a snap and rises again.
    stroke = np.array([0.0, 0.010, 0.010, 0.030])
    force = np.array([0.0, 1.0, -1.0, 1.0])
    ways = [(stroke, force)]
    # Behind 50 N/m the command is past 40 mm by (1 N)/(50 N/m) - 10 mm at the end.
    assert Spring(0.050, 50.0).stops(ways, 1) == pytest.approx(0.030)
    assert Spring(0.045, 50.0).stops(ways, 1) == pytest.approx(0.030 - 0.005 / 3)
    # Up to the snap the command is at 3 u, and past it at 3 u - 40 mm.
    assert Spring(0.029, 50.0).stops(ways, 1) == pytest.approx(0.010 * 29 / 30)
    assert Spring(0.031, 50.0).stops(ways, 1) == pytest.approx(0.071 / 3)
    assert Spring(0.050, 50.0, more=0.5).stops(ways, 1) == pytest.approx(0.030 - 0.010 / 3)
    assert largest(ways, 1) == 1.0
    back = [(stroke[::-1], force[::-1])]
    assert largest(back, -1) == 1.0
    # On the way back it stops where the legs pull the carriage out with K u.
    assert Spring(0.050, 200.0).stops(back, -1) == 0.0
    assert Spring(0.050, 50.0).stops(back, -1) == pytest.approx(0.040 / 3)


@pytest.mark.slow
def test_a_drive_that_is_too_soft_leaves_the_robot_in_a_state_after_the_first_step():
    # Its own simulation: 0.82 of a step in the first cycle and 0.00 after it, carriage at 20.1 mm.
    one = driven(50.0)
    prediction = one.predict()
    assert prediction.motion is Motion.NONE and prediction.advance == pytest.approx(0.0, abs=1e-3)
    assert prediction.first_advance == pytest.approx(0.82, abs=0.1)
    assert [each.first_gait for each in prediction.legs] == ["00>10"] * 2
    assert [each.gait for each in prediction.legs] == ["10"] * 2
    assert [each.rigid_gait for each in prediction.legs] == [FORWARD] * 2
    assert prediction.strokes == pytest.approx((0.020, 0.020), abs=1e-6)
    says(prediction.too_soft, "too soft", "50 N/m", "state 10")
    assert prediction.too_soft in repr(prediction)


@pytest.mark.slow
def test_the_least_stiffness_parts_drives_that_keep_the_gait_from_those_that_do_not():
    needs = needed()
    # The simulated robot walks at 70 N/m and not at 60.
    assert 60.0 < needs.stiffness < 70.0
    for share, keeps in ((1.01, True), (0.98, False)):
        one = driven(share * needs.stiffness)
        assert (predicted_gaits(one) == (FORWARD, FORWARD)) == keeps
        assert (too_soft(one) == "") == keeps
    # It does not hang on the stiffness that the robot has.
    assert drive_needs(driven(50.0)).stiffness == pytest.approx(needs.stiffness, rel=0.01)


def test_a_drive_needs_the_forces_of_both_legs():
    # Unloaded legs: the largest F0 on the way out, the least F1 on the way back, of both.
    inner, outer = leg("left", 0.020).chain.levers
    needs = drive_needs(driven(2000.0, **BARE))
    assert needs.push == pytest.approx(2 * max(inner.force_0, outer.force_0), rel=1e-6)
    assert needs.pull == pytest.approx(-2 * min(inner.force_1, outer.force_1), rel=1e-6)


@pytest.mark.slow
def test_a_drive_near_its_least_stiffness_is_too_close_to_call():
    least = needed().stiffness
    assert not driven(1.02 * least).predict().confident
    # As stiff as it usually is, which other tests predict too.
    assert robot().drive.stiffness > 2 * least and robot().predict().confident


@pytest.mark.parametrize(
    ("profile", "least"), [("triangle", 4.0), ("sine", 2.0 * np.pi), ("trapezoid", 16.0 / 3.0)]
)
def test_a_slow_actuator_sets_the_shortest_period_of_each_profile(profile, least):
    # 80 mm a cycle at 20 mm/s; a sine is π/2 as fast as its mean, and a trapezoid rests.
    drive = Drive(period=7.0, profile=profile, speed=0.020)
    assert drive.least_period == pytest.approx(least)
    assert replace(drive, period=least).period == least
    stroke = drive.stroke(np.linspace(0.0, 7.0, 20001))
    fastest = np.abs(np.diff(stroke)).max() / (7.0 / 20000)
    assert fastest * 7.0 == pytest.approx(0.020 * least, rel=1e-3)
    with refuses(ValueError, "period = 2 s", f"{least:.4g} s", "20 mm/s", "longer period"):
        replace(drive, period=2.0)


def test_without_a_speed_every_period_is_allowed():
    assert Drive(period=1e-3).least_period == 0.0
