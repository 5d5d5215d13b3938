"""Arenas: how far a point is from the nearest obstacle, and what an arena refuses."""

import math

import pytest
from hypothesis import given, strategies as st

from facts import refuses
from stepwell.robot import Arena, Cylinder, Goal, Patch, Plate, Slope, Wall

places = st.tuples(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0))
ARENA = Arena(
    walls=[Wall((1.0, -1.0), (1.0, 1.0)), Wall((-1.0, 0.5), (0.3, 1.5), thickness=0.1)],
    cylinders=[Cylinder((0.5, -0.5))],
)


@pytest.mark.parametrize(
    ("point", "gap"),
    [
        ((0.0, 0.0), math.hypot(0.5, 0.5) - 0.025),
        ((0.9, 0.3), 0.09),  # the wall is 20 mm thick
        ((1.0, 1.2), 0.19),  # beyond its end, round the end
        ((1.0, 0.0), -0.01),
        ((0.5, -0.5), -0.025),
    ],
)
def test_clearance_is_the_distance_to_the_nearest_surface(point, gap):
    assert ARENA.clearance(*point) == pytest.approx(gap)


@given(places, places)
def test_clearance_changes_no_faster_than_the_point_moves(a, b):
    assert abs(ARENA.clearance(*a) - ARENA.clearance(*b)) <= math.dist(a, b) + 1e-9


def test_an_empty_arena_is_clear_everywhere():
    assert Arena().clearance(3.0, -7.0) == math.inf


def test_a_start_inside_an_obstacle_is_refused_with_how_deep_it_lies():
    with refuses(ValueError, "start = (500, -500)", "25 mm", "inside"):
        ARENA.from_start((0.5, -0.5), 0.0)


def test_the_same_arena_is_entered_elsewhere():
    moved = ARENA.from_start((0.1, 0.2), 0.3)
    assert (moved.start, moved.heading, moved.walls) == ((0.1, 0.2), 0.3, ARENA.walls)


@given(places)
def test_a_goal_is_reached_inside_its_disc(place):
    goal = Goal((0.2, 0.1), radius=0.5)
    assert goal.reached(*place) == (math.dist(place, (0.2, 0.1)) <= 0.5)


def test_a_wall_has_length_and_direction():
    wall = Wall((0.0, 0.0), (0.3, 0.4))
    assert wall.length == pytest.approx(0.5)
    assert wall.angle == pytest.approx(math.atan2(4, 3))


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Wall((0.1, 0.1), (0.1, 0.1)), "two different ends"),
        (lambda: Wall((0.0, 0.0), (0.1, 0.1), thickness=0.0), "thickness"),
        (lambda: Cylinder((0.0, 0.0), radius=-1.0), "radius"),
        (lambda: Goal((0.0, 0.0), radius=0.0), "radius"),
    ],
)
def test_an_obstacle_of_no_size_is_refused(make, says):
    with pytest.raises(ValueError, match=says):
        make()


def test_the_level_of_the_ground_is_that_of_its_patch_and_of_plates_on_it():
    patches = [Patch((0.3, 0.2), (0.1, -0.2), level=0.002), Patch((-1.0, -1.0), (0.0, 1.0), -0.001)]
    plate = Plate((0.2, 0.0), (0.10, 0.02), 0.001, 0.005, heading=math.pi / 2)
    arena = Arena(patches=patches, plates=[plate])
    places = {(0.05, 0.0): 0.0, (0.25, 0.1): 0.002, (-0.5, 0.5): -0.001, (0.2, 0.04): 0.003}
    for place, level in places.items():
        assert arena.ground_level(*place) == pytest.approx(level)
    assert arena.ground_level(0.24, 0.0) == 0.002  # beside the plate, which is 20 mm wide
    assert arena.ground_level(0.24, 0.0, reach=0.035) == 0.003


def test_a_ground_out_of_range_is_refused():
    with refuses(ValueError, "angle = 50 deg", "from -45 to 45"):
        Slope(math.radians(50))
    with refuses(ValueError, "level = 11 mm", "from -10 to 10"):
        Patch((0.0, 0.0), (1.0, 1.0), level=0.011)
    with refuses(ValueError, "patch[0]", "patch[2]", "overlap"):
        one, other = Patch((0.0, 0.0), (1.0, 1.0)), Patch((1.0, 0.0), (2.0, 1.0))
        Arena(patches=[one, other, Patch((0.5, 0.5), (0.6, 0.6))])


def test_an_arena_prints_its_ground():
    arena = Arena(slope=Slope(math.radians(5)), patches=[Patch((0.0, 0.0), (1.0, 1.0))])
    assert repr(arena) == "Arena(0 walls, 0 cylinders, slope 5°, 1 patch)"
