"""Simulated jumps: close to statics, with a balance of energy that closes, and repeatable."""

import csv
from dataclasses import replace

import numpy as np
import pytest

from facts import refuses
from hoppers import hopper, jumped
from stepwell import simulation
from stepwell.robot import Task
from stepwell.simulation import JumpSettings

TASKS = ("jump", "throw", "strike")


def test_the_hopper_jumps_ten_centimetres_below_the_bound_and_near_the_model():
    jump = jumped()
    assert jump.model is not None
    assert 0.100 < jump.first.height < jump.bound.height
    assert jump.first.speed == pytest.approx(jump.model.speed, rel=0.03)
    # Lift-off comes after the snap, and the actuator adds little by then.
    assert 0.02 < jump.first.lift_off - jump.first.snap < 0.06
    assert jump.first.flow.actuator < 0.01 * jump.first.flow.released


@pytest.mark.parametrize("task", TASKS)
def test_the_energy_balance_closes_to_one_percent_in_every_run(task):
    jump = jumped(task=task)
    assert jump.balance < 0.01
    for hop in jump.hops:
        assert hop.flow.error < 0.01
        assert hop.flow.stored > hop.flow.released > hop.flow.flight > 0.0


@pytest.mark.parametrize("task", TASKS)
def test_halving_the_step_changes_the_speed_by_less_than_one_percent(task):
    coarse, fine = jumped(task=task).halved
    assert fine.time_step == coarse.time_step / 2
    assert fine.speed == pytest.approx(coarse.speed, rel=0.01)
    assert fine.error < 0.01


def test_the_contact_time_within_its_bounds_hardly_matters_to_the_height():
    heights = [
        simulation.jump(hopper(), settings=JumpSettings(contact_time=t), halve=0).first.height
        for t in (2e-4, 5e-4)
    ]
    assert np.ptp(heights) < 0.015 * heights[0]


def test_a_tilted_hopper_jumps_five_times_forward_and_lands_on_its_foot():
    jump = simulation.jump(hopper("hopper-forward"), 5, halve=0)
    assert [hop.landed for hop in jump.hops] == [True] * 5
    distances = [hop.distance for hop in jump.hops]
    assert min(distances) > 0.1 and np.ptp(distances) < 0.01
    assert max(hop.flow.error for hop in jump.hops) < 0.01
    assert jump.balance < 0.01


def test_a_foot_that_statics_calls_too_small_turns_over():
    short = hopper("hopper-forward", foot_length=0.03)
    jump = _forced(short)
    assert not jump.hops[-1].landed


def _forced(made):
    """A run in spite of the refusal: the foot of the model alone is short."""
    long = replace(made, foot_length=0.160)
    run = simulation.hoppers.run.HopperRun
    snap = simulation.hoppers.jumps.snap_of(long)
    bound = simulation.hoppers.jumps.bound_of(long, snap)
    one = run(made, snap, bound, JumpSettings())
    one.simulate(1, None)
    return replace(jumped("hopper-forward"), hops=one.hops())


def test_losses_and_dampers_take_what_they_should():
    lossy = hopper(springs=replace(hopper().springs, loss=0.25), damping=0.0)
    flow = simulation.jump(lossy, halve=0).first.flow
    assert flow.dampers == 0.0
    # A quarter of the work that the contracting band of the spring cell gives, and some more.
    assert 0.2 * flow.released < flow.springs < 0.4 * flow.released
    assert flow.error < 0.01


def test_a_ball_is_thrown_to_its_height_and_a_hammer_takes_all_that_is_left():
    thrown, struck = jumped(task="throw"), jumped(task="strike")
    assert thrown.model is not None and struck.model is not None
    assert thrown.first.height == pytest.approx(thrown.model.height, rel=0.03)
    assert struck.first.speed == pytest.approx(struck.model.speed, rel=0.03)
    assert thrown.first.flow.flight < 0.1 * struck.first.flow.flight
    assert thrown.factors == () == struck.factors
    assert thrown.hopper.task is Task.THROW


def test_the_factors_against_the_record_multiply_to_the_energy_that_flies():
    jump = jumped()
    *each, together, flown = jump.factors
    assert np.prod([one.ours for one in each]) == pytest.approx(flown.ours, rel=1e-9)
    assert together.ours == pytest.approx(np.prod([one.ours for one in each[1:]]), rel=1e-9)
    assert flown.ours == pytest.approx(jump.first.speed**2 / 2, rel=1e-9)
    assert flown.ratio == pytest.approx((each[0].ratio or 0.0) * (together.ratio or 0.0))
    assert flown.record == pytest.approx(9.80665 * 32.9)


def test_the_same_jump_twice_gives_the_same_numbers():
    again = simulation.jump(hopper())
    assert again == jumped()


def test_steps_that_are_too_coarse_are_refused():
    with refuses(ValueError, "time_step = 0.001 s", "<= 0.0001"):
        JumpSettings(time_step=1e-3)
    with refuses(ValueError, "contact_time = 0.002 s"):
        JumpSettings(contact_time=2e-3)
    with refuses(ValueError, "gravity = 0", "jump"):
        simulation.jump(hopper(gravity=0.0))


def test_a_chain_of_three_cells_jumps_too_without_a_model():
    latch, spring = hopper().chain.levers
    cells = (latch, spring, replace(spring, name="more"))
    jump = simulation.jump(hopper(chain=replace(hopper().chain, cells=cells)), halve=0)
    assert jump.model is None and jump.travels.shape[1] == 3
    assert "3 cells" in jump.model_reason and not jumped().model_reason
    # The block between both springs has a mass too, which the bound leaves out.
    assert 0.5 * jump.bound.height < jump.first.height < jump.bound.height
    assert jump.balance < 0.01


def test_without_gravity_a_ball_flies_on():
    jump = simulation.jump(hopper(task="throw", gravity=0.0), halve=0)
    assert jump.first.height == np.inf and jump.first.speed > jumped(task="throw").first.speed


def test_samples_are_written_with_their_units(tmp_path):
    jumped().to_csv(tmp_path / "jump.csv")
    with open(tmp_path / "jump.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == [
        *("time_s", "forward_mm", "height_mm", "travel_latch_mm", "travel_spring_mm")
    ]
    highest = max(float(row["height_mm"]) for row in rows)
    assert highest == pytest.approx(1e3 * jumped().centre[:, 1].max(), rel=1e-6)


@pytest.mark.slow
def test_a_jump_is_filmed(tmp_path):
    try:
        files = simulation.jump_video(
            jumped(), tmp_path / "jump.gif", width=96, height=64, fps=2, speed=0.2
        )
    except simulation.VideoError as error:
        pytest.skip(str(error))
    assert files[0].read_bytes().startswith(b"GIF8")
    with refuses(ValueError, "jump.avi", ".mp4 or .gif"):
        simulation.jump_video(jumped(), tmp_path / "jump.avi")
    with refuses(ValueError, "speed = 0"):
        simulation.jump_video(jumped(), tmp_path / "jump.gif", speed=0.0)
