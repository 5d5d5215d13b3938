"""A robot as a value: what it weighs, what it refuses, and what its antennas do to it."""

from dataclasses import replace

import pytest
from hypothesis import given, strategies as st

import stepwell as sw
from facts import refuses, says
from robot.robots import cell, explorer, leg, robot
from stepwell.robot import Body, Drive, Floor, Foot, Leg, Robot


def test_a_robot_weighs_the_sum_of_its_parts():
    one = explorer()
    # Body, carriage, four blocks, two feet, two antennas.
    assert one.mass == pytest.approx(0.260 + 0.010 + 4 * 0.006 + 2 * 0.0066 + 2 * 0.003)
    assert one.weight == pytest.approx(one.mass * 9.81)


@given(st.floats(0.0, 1.0))
def test_the_friction_under_the_supports_gives_the_floors_drag_to_the_whole_weight(drag):
    one = robot(floor=Floor(drag=drag))
    assert one.support_friction * one.weight == pytest.approx(drag)


def test_the_pivots_stand_as_high_as_the_foot_hangs_less_what_it_stands_below():
    one = robot(foot=Foot(below=0.0005))
    assert one.pivot_height == pytest.approx(float(one.foot.depth(0.0)) - 0.0005)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Robot([leg("left", 0.02)]), "a robot has 2 or more"),
        (lambda: Robot([leg("left", 0.02), replace(leg("right", 0.02), name="left")]), "two have"),
        (
            lambda: Robot([leg("left", 0.02), replace(leg("right", 0.02), at=(0.008, 0.04))]),
            "collide: their feet are 17.5 mm apart sideways",
        ),
        (lambda: robot(foot=Foot(below=0.012)), "foot.below = 12 mm"),
        (lambda: robot(foot=Foot(link=0.029)), "two links of 29 mm reach 58 mm"),
        (lambda: robot(drive=Drive(amplitude=0.045)), "drive.amplitude = 45 mm: must be <= 40 mm"),
        (
            lambda: robot(body=Body(centre=(0.06, 0.0, 0.0))),
            r"centre = \(60, 0\) mm lies 22 mm outside its supports",
        ),
        (
            lambda: robot(body=Body(supports=((-0.05, 0.0), (-0.05, 0.0), (0.04, 0.04)))),
            "is given twice",
        ),
        (
            lambda: robot(body=Body(supports=((-0.1, 0.0), (0.04, 0.04), (-0.01, -0.0575)))),
            "its foot runs into the support",
        ),
    ],
)
def test_a_robot_that_cannot_walk_is_refused_with_the_reason(make, says):
    with pytest.raises(ValueError, match=says):
        make()


def test_legs_of_different_strokes_cannot_share_an_actuator():
    short = sw.Cell(sw.Band((-0.01, 0.0), (0.01, 0.0), 30.0), lever=0.012)
    other = Leg("right", sw.Chain([short, cell("outer", 0.02)]), (0.008, -0.0575))
    with refuses(ValueError, "full stroke", "'left' 40 mm", "'right' 36.97", "mm"):
        Robot([leg("left", 0.02), other], drive=Drive(amplitude=0.036))


def test_every_reason_is_found_at_once():
    with pytest.raises(ValueError, match=r"body\.centre") as refused:
        robot(body=Body(centre=(0.06, 0.0, 0.0)), drive=Drive(amplitude=0.045))
    assert len(str(refused.value).splitlines()) == 2


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"leg": "middle"}, "leg = 'middle': must be one of 'left', 'right'"),
        ({"cell": "knee"}, "no cell 'knee'"),
    ],
)
def test_an_antenna_on_no_leg_or_cell_is_refused(change, says):
    one = explorer()
    with pytest.raises(ValueError, match=says):
        replace(one, antennas=(replace(one.antennas[0], **change), one.antennas[1]))


def test_two_antennas_cannot_move_one_anchor():
    one = explorer()
    with refuses(ValueError, "antennas", "two", "anchor", "leg"):
        replace(one, antennas=(one.antennas[0], replace(one.antennas[0], name="again")))


@given(st.floats(0.0, 1.0))
def test_a_pressed_antenna_moves_the_anchor_in_proportion(share):
    one = explorer()
    pressed = one.pressed({"left": share * 1.2})
    p = pressed.leg("right").chain.levers[0].bands[0].p
    assert p == pytest.approx((-0.007 - share * 0.010, 0.0))
    assert pressed.leg("left") == one.leg("left")


def test_an_antenna_whose_lever_is_off_moves_nothing():
    one = explorer(connected=False)
    assert one.pressed({"left": 1.0, "right": 0.5}) == one


@pytest.mark.parametrize(
    ("swings", "says"),
    [
        ({"top": 0.1}, "antenna = 'top'"),
        ({"left": 1.3}, "swing = 74.48"),
        ({"left": -0.1}, "swing"),
    ],
)
def test_an_antenna_that_is_not_there_or_turns_too_far_is_refused(swings, says):
    with pytest.raises(ValueError, match=says):
        explorer().pressed(swings)


def test_moving_one_anchor_leaves_the_other_leg():
    one = robot()
    moved = one.with_anchors("right", "outer", q=(0.005, 0.0))
    assert moved == robot(0.020, 0.005)
    with refuses(ValueError, "leg = 'middle'", "'left', 'right'"):
        one.with_anchors("middle", 0)


def test_a_robot_names_its_legs_weight_and_stroke():
    text = repr(replace(robot(), title="Walker"))
    says(text, "Robot('Walker'", "left, right", "307 g", "40 mm", "2 s")
