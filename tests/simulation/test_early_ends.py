"""A run that goes wrong ends with the time and the reason, and keeps what is sound."""

import os
import re
from pathlib import Path

import numpy as np
import pytest

import stepwell as sw
from facts import says
from simulation.robots import cell, robot
from stepwell.robot import Body, Leg, Robot
from stepwell.simulation import Linkage, Settings, Walk, engine, walk

SAMPLED = (
    "x",
    "y",
    "z",
    "yaw",
    "pitch",
    "roll",
    "stroke",
    "travel",
    "foot_force",
    "actuator_force",
)


def ended_early(one: Walk) -> str:
    """Check what every early end promises; returns the reason."""
    match = re.fullmatch(r"Stopped at (-?\d+\.\d{3}) s: (.+)\.", one.stopped)
    assert match, one.stopped
    time, reason = float(match[1]), match[2]
    assert (one.time < time).all()
    for name in SAMPLED:
        assert np.isfinite(getattr(one, name)).all(), name
    assert np.nanmax(np.abs(one.travel), initial=0.0) < 1.0
    assert one.stopped in repr(one)
    return reason


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    """MuJoCo would leave its log file where the user works."""
    monkeypatch.chdir(tmp_path)


def with_stiff_bands(stiffness: float) -> Robot:
    """A robot with a band that no rod can hold against."""
    chain = sw.Chain([cell("inner", 0.010), cell("outer", 0.020, k=stiffness)])
    legs = [Leg("left", chain, (0.008, 0.0575)), Leg("right", chain, (0.008, -0.0575))]
    return Robot(legs, unusual=True)


def test_a_time_step_far_too_long_breaks_a_rod_and_says_which_and_when():
    broken = walk(robot(), 2, settings=Settings(time_step=0.01, contact_time=0.02))
    assert re.fullmatch(r"the rod '(left|right)\.\w+\.\w+' .* length", ended_early(broken))


def test_a_rod_that_stretches_is_named_while_the_run_is_still_finite():
    one = robot()
    run = engine.SimulatedRun(one, None, Settings())
    run.advance(0.1)
    rods = dict(run.rods)
    name = "right.link.out"
    column, length = rods[name]
    data = run.samples().data
    data[3:, column] = length + 1.5e-3
    time = np.linspace(0.0, 0.02 * (len(data) - 1), len(data))
    index, why = engine.stopped_at(time, data, run.where, rods)
    assert index == 3
    says(why, "0.060 s", f"rod {name!r}", "length")


def test_of_two_reasons_at_the_same_time_the_one_that_explains_more_is_given():
    run = engine.SimulatedRun(robot(), None, Settings())
    run.advance(0.1)
    data = run.samples().data
    time = np.linspace(0.0, 0.02 * (len(data) - 1), len(data))
    column, length = run.rods["left.inner.lever"]
    data[2:, column] = length + 2e-3
    data[2:, run.where["body.attitude"]] = (0.0, 1.0, 0.0, 0.0)
    _, why = engine.stopped_at(time, data, run.where, run.rods)
    assert "'left.inner.lever'" in why
    data[2:, 0] = np.nan
    _, why = engine.stopped_at(time, data, run.where, run.rods)
    assert "overflowed" in why


@pytest.mark.parametrize("linkage", list(Linkage))
@pytest.mark.parametrize("stiffness", [1e5, 1e8])
def test_a_run_that_blows_up_is_reported_and_keeps_finite_samples(linkage, stiffness):
    broken = walk(with_stiff_bands(stiffness), 2, settings=Settings(linkage=linkage))
    assert ended_early(broken)
    assert broken.cycles == 0


def test_a_robot_that_falls_over_is_reported():
    # Its weight is 250 mm above the pivots and just inside the supports.
    fallen = walk(robot(body=Body(centre=(0.037, 0.0, 0.25))), 4)
    says(ended_early(fallen), "robot fell over")
    assert len(fallen.time) > 20


def test_a_walk_without_samples_answers_every_question():
    broken = walk(with_stiff_bands(1e6), 2)
    assert len(broken.time) == 0
    assert broken.cycles == 0
    assert broken.gaits == {"left": (), "right": ()}
    for values in (broken.advance, broken.sideways, broken.turn):
        assert values.shape == (0,)
    assert broken.work == broken.distance == 0.0
    assert broken.cost_of_transport == float("inf")
    assert not broken.slip.any()
    with pytest.raises(ValueError, match=r"no samples.*Stopped at"):
        broken.state("left", 0.0)
    assert broken.to_xarray().attrs["stopped"] == broken.stopped


def test_a_run_that_diverges_leaves_no_log_file_where_the_user_works():
    before = engine.mujoco.get_mju_user_warning()
    walk(with_stiff_bands(1e6), 1)
    assert os.listdir(Path.cwd()) == []
    assert engine.mujoco.get_mju_user_warning() is before
