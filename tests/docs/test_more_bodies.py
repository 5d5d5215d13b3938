"""Four and six legs, and the gripper: what the page promises, and its tables."""

import json
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="no robot walks: mujoco is not installed")

import stepwell as sw
from docs.more_bodies import (
    COPIES,
    DRAG,
    FILE,
    FRICTION,
    NAMES,
    PAGE,
    SHARES,
    failures,
    page,
    phases,
)
from stepwell.robot import Robot

RECORD = json.loads(FILE.read_text("utf-8"))


@pytest.fixture(scope="module")
def walk():
    """A walk of the robot with four legs."""
    return sw.preset("robot-four-legs").walk(3)


def test_the_tables_of_the_page_are_those_of_the_record():
    text = PAGE.read_text("utf-8")
    assert page(text, RECORD) == text, "run it with --page"
    assert [one["name"] for one in RECORD["robots"]] == [*NAMES]
    for one in RECORD["robots"]:
        assert len(one["copies"]) == COPIES and len(one["floors"]) == len(DRAG) * len(FRICTION)


def test_hind_feet_lift_and_land_before_front_feet(walk):
    assert [*failures(walk)] == []
    (lift,), (land,) = phases(walk)["left hind"]
    # A foot is 1 mm above the floor 5 mm of stroke after the travels of the first and inner cell,
    # and lands as long before that of the first cell.
    assert lift == pytest.approx((8 + 10 + 5) / 80, abs=0.02)
    assert land == pytest.approx(1 - (8 + 5) / 80, abs=0.02)


def test_feet_that_land_together_are_found_out(walk):
    robot: Robot = walk.robot
    # Two cells in every leg: travels of the first and the inner cell in one.
    legs = []
    for leg in robot.legs:
        *_, inner, outer = leg.chain.levers
        step = leg.stroke
        lever = max(inner.lever, step / np.sqrt(2))
        wide = replace(inner, lever=lever, limit=float(np.arcsin(step / 2 / lever)))
        legs.append(replace(leg, chain=sw.Chain([wide, outer])))
    found = [*failures(replace(robot, legs=legs, sources={}).walk(3))]
    assert "feet land in a wave" in found and "feet lift in a wave" not in found


def test_the_gripper_closes_stays_without_force_and_opens():
    chain = sw.preset("two-finger-gripper")
    closed = chain.path([0.0, 0.048, 0.040])
    assert closed.end == pytest.approx(chain.full_travels)
    assert closed.force[-1] == pytest.approx(0.0, abs=1e-9)
    # The second finger follows the first one, and opens first.
    assert str(chain.cycle().sequence) == "00>10>11>10>00"
    assert chain.path([0.0, 0.048, 0.0]).end == pytest.approx([0.0, 0.0])


def test_the_first_finger_stays_at_its_stop_whatever_the_second_one_presses_with():
    first, second = sw.preset("two-finger-gripper").levers
    pressed = -second.force(np.linspace(-second.limit, second.limit, 101))
    assert -first.force_1 > 1.5 * pressed.max()


def test_the_record_of_the_gripper_holds_what_friction_holds():
    for one in RECORD["gripper"]["objects"]:
        assert one["runs"][0]["force"] == pytest.approx(one["predicted"], rel=0.02)
        for share, run in zip(SHARES, one["runs"], strict=True):
            # Close to its limit friction gives way as the lift begins.
            assert share == 0.9 or run["held"] == (share < 1), (one["width_mm"], share)
