"""An arena: what is touched, which antenna is pressed, and the gait that this changes."""

import math

import numpy as np
import pytest

from facts import says
from simulation.robots import FORWARD, explorer, robot
from sizes import SIZE
from stepwell.files import load
from stepwell.robot import Arena, Cylinder, Goal, Wall, other_start
from stepwell.simulation import Outcome, Settings, maze

# A wall across the way, nearer on the left, so that the left antenna meets it first.
SLANT = math.radians(60)
ALONG = (0.5 * math.cos(SLANT), -0.5 * math.sin(SLANT))
WALL = Wall((0.3 - ALONG[0], -ALONG[1]), (0.3 + ALONG[0], ALONG[1]))
FAR = Wall((2.0, -1.0), (2.0, 1.0))


@pytest.fixture(scope="module")
def met():
    """An antenna robot that meets a wall with its left antenna."""
    return maze(explorer(), Arena([WALL, FAR]), limit=24.0)


@pytest.mark.slow
def test_a_wall_on_the_left_presses_the_left_antenna_and_the_robot_turns_right(met):
    assert met.outcome is Outcome.TIMED_OUT
    assert met.contacts
    assert met.contacts[0].antenna == "left"
    turned = np.degrees(met.walk.yaw[-1])
    assert turned < -20.0
    assert "away from wall 1" in met.ending and "to the right" in met.ending


@pytest.mark.slow
def test_touches_name_the_obstacle_and_its_first_time(met):
    assert list(met.touched) == ["wall 1", "wall 2"]
    assert met.touched["wall 2"] is None
    first = met.touched["wall 1"]
    assert first is not None
    before = met.walk.time < first
    assert met.walk.obstacle_force[before].max() <= 1e-3
    assert abs(first - met.contacts[0].begin) < 2.0


@pytest.mark.slow
def test_contacts_are_where_an_antenna_is_turned(met):
    walk = met.walk
    for contact in met.contacts:
        column = ["left", "right"].index(contact.antenna)
        inside = (walk.time >= contact.begin) & (walk.time <= contact.end)
        assert walk.antenna[inside, column].max() == contact.swing
        assert 0.05 * 1.2 < contact.swing <= 1.2 + 0.05
    begins = [contact.begin for contact in met.contacts]
    assert begins == sorted(begins)


@pytest.mark.slow
def test_the_press_changes_the_gait_of_the_opposite_leg_and_of_no_other(met):
    first = met.changes[0]
    assert (first.leg, first.before) == ("right", FORWARD)
    assert first.time >= met.contacts[0].begin - 2.0
    assert {change.leg for change in met.changes} == {"right"}
    free = met.walk.gaits["right"][: int(met.contacts[0].begin / 2.0)]
    assert set(free) == {FORWARD}


@pytest.mark.slow
def test_the_same_touch_changes_no_gait_where_the_antennas_lead_to_no_anchor(met):
    blind = maze(explorer(connected=False), Arena([WALL, FAR]), limit=24.0)
    assert blind.contacts[0].antenna == "left"
    assert blind.contacts[0].begin == pytest.approx(met.contacts[0].begin, abs=0.5)
    assert blind.changes == ()
    assert set(blind.walk.gaits["right"]) == {FORWARD}


def test_a_goal_that_is_reached_ends_the_way():
    reached = maze(robot(), Arena(goal=Goal((0.10, 0.0), 0.05)), limit=60.0)
    assert reached.outcome is Outcome.REACHED
    assert reached.arena.goal is not None
    assert reached.arena.goal.reached(reached.walk.x[-1], reached.walk.y[-1])
    assert reached.duration < 15.0
    assert "reached the goal" in repr(reached)


def test_a_run_that_ends_before_its_goal_has_the_distance_to_it():
    late = maze(robot(), Arena(goal=Goal((1.0, 0.0), 0.05)), limit=2.0)
    distance = math.dist((late.walk.x[-1], late.walk.y[-1]), (1.0, 0.0))
    says(late.ending, "2 s", f"{distance:.2f} m", "goal")


def test_a_start_and_a_heading_are_where_the_robot_begins():
    arena = Arena(start=(0.3, -0.2), heading=math.radians(120))
    begun = maze(robot(), arena, limit=4.0)
    walk = begun.walk
    assert (walk.x[0], walk.y[0]) == pytest.approx((0.3, -0.2), abs=1e-3)
    assert np.degrees(walk.yaw[0]) == pytest.approx(120.0, abs=0.5)
    assert walk.advance[1] == pytest.approx(0.71, abs=0.08)
    assert begun.ending == "walked for 4 s, no goal in the arena"
    assert np.degrees(np.arctan2(walk.y[-1] + 0.2, walk.x[-1] - 0.3)) == pytest.approx(120, abs=2)


@pytest.mark.slow
def test_a_robot_without_antennas_is_held_by_a_wall_and_does_not_pass_through():
    held = maze(robot(), Arena([Wall((0.20, -0.5), (0.20, 0.5))]), limit=24.0)
    # The body reaches 50 mm ahead of its origin, and the wall 10 mm towards it.
    assert held.walk.x.max() < 0.20 - 0.010 - 0.050 + 0.001
    assert held.touched["wall 1"] is not None


@pytest.mark.slow
def test_from_some_starts_the_second_of_two_cylinders_in_a_row_is_met_too():
    # From straight behind the first it is never met: the robot has turned away for good.
    row = (Cylinder((0.36, 0.0)), Cylinder((0.86, 0.0)))
    aside = Arena((), row, start=(0.0, -0.160), heading=math.radians(6))
    coarse = Settings(time_step=2e-3, contact_time=4e-3) if SIZE == "ci" else None
    both = maze(load("preset:robot-antennas").robot, aside, limit=100.0, settings=coarse)
    first, second = both.touched["cylinder 1"], both.touched["cylinder 2"]
    assert first is not None
    assert second is not None
    assert second > first + 10.0


@pytest.mark.skipif(SIZE == "ci", reason="five minutes of walking: set STEPWELL_TESTS=full")
def test_a_corridor_of_600_mm_that_bends_can_trap_the_robot():
    half, on = 0.300, 1.500
    walls = [
        *(Wall((-0.3, -half), (1 + half, -half)), Wall((1 + half, -half), (1 + half, on))),
        *(Wall((-0.3, half), (1 - half, half)), Wall((1 - half, half), (1 - half, on))),
    ]
    corridor = Arena(walls, goal=Goal((1.0, on - 0.1), 0.250))
    stuck = maze(load("preset:robot-explorer").robot, other_start(corridor, 0), limit=400.0)
    assert stuck.outcome is Outcome.TRAPPED
    assert stuck.walk.x[-1] > 1.0 > stuck.walk.y[-1] + 0.5


@pytest.mark.slow
def test_cylinders_come_after_walls():
    arena = Arena([FAR], [Cylinder((0.25, 0.05))])
    seen = maze(explorer(), arena, limit=12.0)
    assert list(seen.touched) == ["wall 1", "cylinder 1"]
    assert seen.touched["cylinder 1"] is not None


def test_a_run_that_breaks_in_an_arena_says_so():
    broken = maze(robot(), Arena(), limit=5.0, settings=Settings(time_step=0.01, contact_time=0.02))
    assert broken.outcome is Outcome.STOPPED
    assert broken.walk.stopped
    assert broken.duration == 0.0


def test_samples_further_apart_than_two_looks_are_no_trouble():
    seen = maze(robot(), Arena(), limit=3.0, settings=Settings(sample=1.0))
    assert seen.outcome is Outcome.TIMED_OUT
    assert seen.walk.time == pytest.approx([0.5, 1.5, 2.5])


def test_a_way_without_time_is_refused():
    with pytest.raises(ValueError, match=r"limit = 0 s: must be > 0"):
        maze(robot(), Arena(), limit=0)
