"""Robots as environments of Gymnasium."""

import subprocess
import sys
import warnings
from importlib import import_module

import numpy as np
import pytest

import stepwell as sw

gymnasium = pytest.importorskip("gymnasium", reason="environments need the extra env")
checker = import_module("gymnasium.utils.env_checker")


@pytest.fixture
def make():
    """Environments that are closed after the test."""
    made = []

    def one(robot="robot-antennas", arena="three-walls", **more):
        made.append(sw.make_env(robot, arena, **more))
        return made[-1]

    yield one
    for env in made:
        env.close()


@pytest.mark.parametrize(("arena", "random_start"), [("three-walls", True), (None, False)])
def test_gymnasiums_own_check_has_no_remark(make, graphics, arena, random_start):
    drawn = graphics is not None
    env = make(arena=arena, random_start=random_start, render_mode="rgb_array" if drawn else None)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        checker.check_env(env.unwrapped, skip_render_check=not drawn)


def test_the_drives_own_strokes_walk_like_the_robot(make):
    robot = sw.preset("robot-antennas")
    env = make(robot, None)
    env.reset(seed=0)
    gains = []
    for k in range(40):
        stroke = robot.drive.stroke(0.1 * (k + 1)) / robot.drive.amplitude
        gains.append(env.step(np.array([2.0 * stroke - 1.0], np.float32))[1])
    advance = robot.walk(2).advance
    # Actions have single precision.
    assert [sum(gains[:20]), sum(gains[20:])] == pytest.approx(advance.tolist(), abs=1e-3)
    assert advance.min() > 0.5


def test_an_action_is_a_share_of_the_stroke_and_is_reached_at_the_speed_of_the_drive(make):
    env = make(arena=None)
    observation, _ = env.reset()
    names = env.unwrapped.names
    assert observation[names.index("stroke [m]")] == pytest.approx(0.0, abs=1e-4)
    strokes = [env.step(np.array([0.0], np.float32))[0][0] for _ in range(12)]
    # 40 mm/s for half a second, then at rest in the middle.
    assert strokes[2] == pytest.approx(0.012, abs=2e-3)
    assert strokes[-1] == pytest.approx(0.020, abs=1e-3)


def test_an_observation_has_a_name_with_a_unit_for_each_number_and_stays_in_its_bounds(make):
    env = make()
    space, names = env.observation_space, env.unwrapped.names
    assert len(names) == len(set(names)) == space.shape[0]
    assert all(name.endswith(("[m]", "[1]", "[N]", "[rad]")) for name in names)
    observation, _ = env.reset(seed=1)
    state = dict(zip(names, observation, strict=True))
    assert state["left.inner travel over full travel [1]"] == pytest.approx(0.0, abs=0.02)
    arena = sw.load_arena("three-walls")
    assert arena.goal is not None
    away = np.subtract(arena.goal.at, arena.start)
    ahead = away @ [np.cos(arena.heading), np.sin(arena.heading)]
    assert state["goal ahead [m]"] == pytest.approx(ahead, abs=0.01)
    env.action_space.seed(2)
    for _ in range(20):
        assert env.step(env.action_space.sample())[0] in space


def test_the_same_seed_gives_the_same_numbers_and_another_one_another_start(make):
    env = make(random_start=True)
    runs = []
    for seed in (5, 5, 6):
        env.reset(seed=seed)
        env.action_space.seed(1)
        runs.append(np.array([env.step(env.action_space.sample())[0] for _ in range(5)]))
    assert np.array_equal(runs[0], runs[1])
    where = [env.unwrapped.names.index(name) for name in ("x [m]", "y [m]")]
    assert np.abs(runs[0][0, where] - runs[2][0, where]).max() > 1e-4


def test_an_episode_ends_at_the_goal_with_the_distance_as_its_reward(make, tmp_path):
    (tmp_path / "near.txt").write_text("cell 200 mm\n.......\n.>G....\n.......\n")
    arena = sw.load_arena(tmp_path / "near.txt")
    robot = sw.preset("robot-forward")
    env = make(robot, arena)
    env.reset()
    total, done, late, info = 0.0, False, False, {}
    for k in range(100):
        stroke = robot.drive.stroke(0.1 * (k + 1)) / robot.drive.amplitude
        _, reward, done, late, info = env.step(np.array([2.0 * stroke - 1.0], np.float32))
        total += reward
        if done:
            break
    assert done and not late and info["outcome"] == "reached the goal"
    goal = arena.goal
    assert goal is not None
    gained = (np.hypot(*np.subtract(goal.at, arena.start)) - goal.radius) / robot.u_max
    assert total == pytest.approx(gained, abs=0.2)


def test_an_episode_is_truncated_at_its_limit(make):
    env = make(arena=None, limit=0.3)
    env.reset()
    ends = [env.step(np.zeros(1, np.float32))[2:4] for _ in range(3)]
    assert ends == [(False, False), (False, False), (False, True)]


@pytest.mark.usefixtures("drawable")
def test_a_rendered_picture_shows_the_robot_and_moves_with_it(make):
    env = make(arena=None, render_mode="rgb_array", size=(320, 180))
    env.reset()
    first = env.render()
    for _ in range(8):
        env.step(np.ones(1, np.float32))
    second = env.render()
    assert first.shape == second.shape == (180, 320, 3) and first.dtype == np.uint8
    assert ((first[..., 0].astype(int) - first[..., 2]) > 90).sum() > 10
    assert not np.array_equal(first, second)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"interval": 0.0015}, "multiple of the time step"),
        ({"limit": 0.0}, "limit = 0"),
        ({"reward": "speed"}, "reward = 'speed'"),
        ({"reward": "goal"}, "has no goal"),
    ],
)
def test_options_out_of_range_are_refused(options, words):
    with pytest.raises(ValueError, match=words):
        sw.make_env("robot-forward", None, **options)


def test_a_step_before_the_reset_is_refused():
    from stepwell.simulation import RobotEnv

    with pytest.raises(ValueError, match=r"call reset\(\) first"):
        RobotEnv(sw.preset("robot-forward")).step([0.0])


def test_it_has_an_id_of_its_own():
    name = "stepwell.simulation.environment:stepwell/Robot-v0"
    env = gymnasium.make(name, robot=sw.preset("robot-forward"))
    assert env.unwrapped.reward == "advance"


def test_the_simulation_opens_gymnasium_only_for_an_environment():
    code = (
        "import sys, stepwell as sw; sw.simulation.walk; assert 'gymnasium' not in sys.modules; "
        "sw.make_env; sw.simulation.make_env; assert 'gymnasium' in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
