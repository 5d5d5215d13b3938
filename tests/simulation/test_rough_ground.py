"""Rough ground: slopes, patches of another level or friction, loose plates."""

import math
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given, strategies as st

from facts import refuses
from simulation.robots import robot
from stepwell.robot import Arena, Floor, Patch, Plate, Slope
from stepwell.simulation import mjcf, mujoco, sdf, spec, sweep
from stepwell.simulation.arenas.surroundings import FAR, remainder


def floor(**more):
    return Patch((-1.0, -1.0), (1.0, 1.0), **more)


def across(begin, end=1.0, **more):
    return Patch((begin, -1.0), (end, 1.0), **more)


GROUNDS = {
    "bare": Arena(),
    "seams": Arena(patches=[Patch((0.0, -0.02), (0.05, 1.0)), Patch((0.05, -0.02), (0.3, 0.05))]),
    "raised": Arena(patches=[floor(level=0.005)]),
    "uphill": Arena(slope=Slope(math.radians(5))),
    "downhill": Arena(slope=Slope(math.radians(-5))),
    "turned": Arena(slope=Slope(math.radians(5), uphill=1.0), heading=1.0),
    "steep": Arena(slope=Slope(math.radians(8))),
    "cross": Arena(slope=Slope(math.radians(5), uphill=math.pi / 2)),
    "low step": Arena(patches=[across(0.06, level=1e-4)]),
    "step": Arena(patches=[across(0.06, level=5e-4)]),
    "groove": Arena(patches=[across(0.06, 0.07, level=-1e-3)]),
    "rubber": Arena(patches=[floor(drag=0.79)]),
    "ice on the left": Arena(patches=[Patch((-1.0, 0.0), (1.0, 1.0), foot_friction=0.1)]),
    "plate": Arena(plates=[Plate((0.08, 0.0), (0.06, 0.20), 1e-3, 0.010)]),
}
CYCLES = 5


@pytest.fixture(scope="module")
def walks():
    """Advance per cycle of a robot that walks forward on each ground, as d/u_max."""
    trials = sweep([robot()] * len(GROUNDS), arenas=[*GROUNDS.values()], cycles=CYCLES)
    return dict(zip(GROUNDS, trials.trials, strict=True))


def test_patches_like_the_floor_and_a_raised_floor_change_no_walk(walks):
    for same in ("seams", "raised"):
        assert walks[same].advance == pytest.approx(walks["bare"].advance, abs=0.01)
        assert walks[same].turn == pytest.approx(0.0, abs=0.005)
        assert walks[same].gaits == walks["bare"].gaits


def test_a_robot_walks_less_uphill_and_more_downhill_whatever_way_it_heads(walks):
    uphill, bare, downhill = (walks[name].advance for name in ("uphill", "bare", "downhill"))
    assert uphill < bare - 0.1 < bare < downhill
    assert walks["turned"].advance == pytest.approx(uphill, abs=0.01)


def test_a_robot_slides_down_where_the_drag_of_its_supports_is_less_than_its_weight_downhill(walks):
    # tan α = D/W at 7.4°: at 7° the robot climbs, at 8° it slides.
    still = robot()
    limit = math.degrees(math.atan(still.floor.drag / still.weight))
    assert 7.0 < limit < 8.0
    assert walks["steep"].advance < -1.0


def test_a_cross_slope_moves_a_robot_downhill(walks):
    assert walks["cross"].sideways < -0.02
    assert walks["cross"].turn < 0
    assert walks["cross"].advance > 0.6


def test_a_step_of_a_tenth_of_a_millimetre_is_passed_and_one_of_half_a_millimetre_is_not(walks):
    assert walks["low step"].advance == pytest.approx(walks["bare"].advance, abs=0.03)
    assert walks["step"].advance < 0.3
    assert walks["groove"].advance < 0.6


def test_friction_of_a_patch_counts_instead_of_that_of_the_floor(walks):
    rubber = robot(floor=Floor(drag=0.79))
    (trial,) = sweep([rubber], cycles=CYCLES).trials
    assert walks["rubber"].advance == pytest.approx(trial.advance, abs=0.01)
    assert walks["ice on the left"].turn > math.radians(2)


def test_a_loose_plate_is_pushed_and_the_body_of_the_robot_stays_first_in_the_state():
    arena = GROUNDS["plate"]
    walk = robot().walk(4, arena=arena)
    model = spec(walk.robot, arena).compile()
    plate = model.joint("plate 1").qposadr[0]
    assert model.joint("body").qposadr[0] == 0
    pushed = walk.positions[-1, plate] - arena.plates[0].at[0]
    assert 0.005 < pushed < 0.08
    assert walk.positions[:, plate + 2].max() < 0.002
    assert walk.x[-1] == pytest.approx(walk.positions[-1, 0], abs=1e-4)


def test_a_plate_slides_down_exactly_if_the_slope_is_steeper_than_its_friction():
    for angle, slides in ((15, False), (30, True)):
        plate = Plate((0.5, 0.0), (0.05, 0.05), 1e-3, 0.010, friction=0.4)
        slope = Slope(math.radians(angle))
        model = spec(robot(), Arena(slope=slope, plates=[plate])).compile()
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, 0)
        mujoco.mj_step(model, data, 300)
        moved = data.body("plate 1").xpos[0] - 0.5
        assert (moved < -0.05) == slides
        # Sliding without rotation from rest: a = g (sin α - µ cos α).
        if slides:
            a = 9.81 * (math.sin(slope.angle) - 0.4 * math.cos(slope.angle))
            assert -moved == pytest.approx(a * 0.3**2 / 2, rel=0.1)


def test_a_robot_at_rest_stands_on_the_level_of_its_patch():
    model = spec(robot(), GROUNDS["raised"]).compile()
    bare = spec(robot()).compile()
    assert model.key_qpos[0, 2] == pytest.approx(bare.key_qpos[0, 2] + 0.005)


corners = st.lists(st.integers(-4, 4), min_size=2, max_size=2, unique=True).map(sorted)


@given(st.lists(st.tuples(corners, corners), max_size=5), st.data())
def test_the_rest_of_a_floor_covers_every_point_once_that_no_patch_covers(rectangles, data):
    chosen = []
    for (left, right), (low, high) in rectangles:
        patch = Patch((float(left), float(low)), (float(right), float(high)))
        if not any(patch.overlaps(other) for other in chosen):
            chosen.append(patch)
    rest = list(remainder([(one.low, one.high) for one in chosen]))
    point = [data.draw(st.integers(-5, 4)) + 0.5 for _ in range(2)]

    def covers(low, high):
        return all(a < x < b for x, a, b in zip(point, low, high, strict=True))

    inside = sum(covers(one.low, one.high) for one in chosen)
    assert sum(covers(*one) for one in rest) == 1 - inside
    far = (FAR - 0.5, -FAR + 0.5)
    assert sum(all(a < x < b for x, a, b in zip(far, *one, strict=True)) for one in rest) == 1


def test_exports_contain_the_ground():
    arena = Arena(slope=Slope(0.05), patches=[across(0.1)], plates=GROUNDS["plate"].plates)
    own = robot()
    assert 'name="plate 1"' in mjcf(own, arena)
    world = ElementTree.fromstring(sdf(own, arena)).find("world")
    assert world is not None
    assert [model.get("name") for model in world.findall("model")][1:] == [
        "plate 1",
        "surroundings",
    ]
    gravity = np.array((world.findtext("gravity") or "").split(), float)
    assert gravity == pytest.approx([-9.81 * math.sin(0.05), 0.0, -9.81 * math.cos(0.05)])


def test_a_sweep_needs_an_arena_for_each_robot():
    with refuses(ValueError, "arenas has 1 arenas", "must have 2"):
        sweep([robot()] * 2, arenas=[Arena()])
