"""The same robot walks the same way: again, in pieces, as a mirror image, as a file."""

from dataclasses import replace

import numpy as np
import pytest

from simulation.robots import explorer, mirrored, robot, walked
from sizes import SIZE
from stepwell.simulation import Linkage, Settings, engine, mjcf, spec, walk
from stepwell.simulation.simulator import mujoco

TURNS = 0.005, 0.020

READINGS = (
    *("time", "x", "y", "z", "yaw", "pitch", "roll", "stroke", "travel", "actuator_force"),
    *("foot_force", "support_force"),
)


@pytest.mark.slow
def test_the_same_walk_twice_gives_the_same_numbers():
    one, again = walked(*TURNS, 2), walk(robot(*TURNS), 2)
    for name in READINGS:
        assert np.array_equal(getattr(one, name), getattr(again, name)), name


@pytest.mark.slow
def test_how_often_a_run_is_looked_at_changes_no_number(monkeypatch):
    whole = walked(*TURNS, 2)
    monkeypatch.setattr(engine, "CHUNK", 0.13)
    pieces = walk(robot(*TURNS), 2)
    for name in READINGS:
        assert np.array_equal(getattr(whole, name), getattr(pieces, name)), name


@pytest.mark.slow
@pytest.mark.parametrize("first", [1.0, 0.7553], ids=["a cycle", "between two samples"])
def test_a_walk_that_goes_on_from_another_gives_the_numbers_of_one_walk(first):
    whole = walked(*TURNS, 2)
    begun = walk(robot(*TURNS), first)
    rest = walk(robot(*TURNS), 2 - first, start=begun)
    for name in READINGS:
        pieces = np.concatenate([getattr(begun, name), getattr(rest, name)])
        assert np.array_equal(getattr(whole, name), pieces), name


@pytest.mark.slow
def test_a_walk_that_goes_on_counts_its_own_cycles():
    begun = walked(0.020, 0.020, 1)
    rest = walk(robot(), 2, start=begun)
    whole = walk(robot(), 3)
    assert (begun.cycles, rest.cycles) == (1, 2)
    # It has no sample at its very beginning, which is the earlier walk's last.
    assert rest.advance == pytest.approx(whole.advance[1:], abs=0.01)
    assert rest.gaits["left"] == whole.gaits["left"][1:]


@pytest.mark.slow
def test_an_anchor_moved_on_the_way_changes_the_gait_from_there_on():
    begun = walked(0.020, 0.020, 1)
    other = robot().with_anchors("left", "outer", q=(0.005, 0.0))
    turning = walk(other, 3, start=begun)
    assert turning.time[0] > begun.time[-1]
    assert turning.x[0] == pytest.approx(begun.x[-1], abs=1e-3)
    assert np.degrees(turning.turn[1:]) == pytest.approx(15.0, abs=2.5)


def test_a_walk_goes_on_neither_from_other_parts_nor_from_a_broken_one():
    begun = walk(robot(), 0.1)
    with pytest.raises(ValueError, match="robot of other parts"):
        walk(explorer(), 1, start=begun)
    broken = replace(begun, stopped="Stopped at 0.100 s: the robot fell over.")
    with pytest.raises(ValueError, match=r"ended early.*fell over"):
        walk(robot(), 1, start=broken)


@pytest.mark.slow
def test_a_mirror_image_of_a_robot_walks_the_mirror_image_of_its_way():
    for one in (robot(*TURNS), *[robot(0.020, 0.012)] * (SIZE == "full")):
        way, image = walk(one, 2), walk(mirrored(one), 2)
        for name in ("x", "z", "pitch", "stroke", "actuator_force"):
            assert getattr(image, name) == pytest.approx(getattr(way, name), abs=1e-7), name
        for name in ("y", "yaw", "roll"):
            assert getattr(image, name) == pytest.approx(-getattr(way, name), abs=1e-7), name
        assert image.travel == pytest.approx(way.travel[:, ::-1], abs=1e-7)


@pytest.mark.slow
def test_a_mirror_image_of_the_robot_with_antennas_turns_the_other_way():
    one = explorer()
    left, right = walk(one.pressed({"left": 0.48}), 2), walk(one.pressed({"right": 0.48}), 2)
    assert left.turn == pytest.approx(-right.turn, abs=1e-3)
    assert left.advance == pytest.approx(right.advance, abs=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("linkage", list(Linkage))
def test_plain_mujoco_steps_the_model_to_the_same_numbers(linkage):
    way = walked(0.005, 0.020, linkage=linkage)
    model = spec(way.robot, settings=Settings(linkage=linkage)).compile()
    readings = stepped(model, way, cycles=2)
    forces = [
        way._samples.where[name].start
        for name in ("left.sole", "right.sole", "support 1", "support 2", "support 3")
    ]
    others = np.setdiff1d(np.arange(readings.shape[1]), forces)
    every = round(way.settings.sample / way.settings.time_step)
    sampled = readings[every - 1 :: every]
    n = len(sampled)
    assert np.array_equal(sampled[:, others], way._samples.data[:n, others])
    # What the floor carries is the mean over the steps that lead up to it.
    means = readings[: n * every, forces].reshape(n, every, -1).mean(axis=1)
    assert means == pytest.approx(way._samples.data[:n, forces], abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("linkage", list(Linkage))
def test_the_exported_file_walks_the_same_way_in_plain_mujoco(linkage):
    way = walked(0.005, 0.020, linkage=linkage)
    text = mjcf(way.robot, settings=Settings(linkage=linkage))
    every = round(way.settings.sample / way.settings.time_step)
    readings = stepped(mujoco.MjModel.from_xml_string(text), way, cycles=2)[every - 1 :: every]
    # MuJoCo writes numbers with six digits, and a walk carries the difference along.
    n = len(readings)
    assert readings[:, way._samples.where["body.position"]] == pytest.approx(
        np.stack([way.x, way.y, way.z], axis=1)[:n], abs=2e-4
    )


def stepped(model, way, cycles: int) -> np.ndarray:
    """(steps, sensors) readings of a model stepped by hand with the same command."""
    settings, drive = way.settings, way.robot.drive
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    mujoco.mj_forward(model, data)
    steps = round((settings.settle + cycles * drive.period) / settings.time_step)
    time = np.arange(1, steps + 1) * settings.time_step - settings.settle
    readings = []
    for command in drive.stroke(time - settings.time_step):
        data.ctrl[0] = command
        mujoco.mj_step(model, data)
        readings.append(data.sensordata.copy())
    return np.array(readings)


def test_the_exported_file_names_its_bands_and_opens_standing():
    text = mjcf(explorer())
    model = mujoco.MjModel.from_xml_string(text)
    names = {model.tendon(i).name for i in range(model.ntendon)}
    for leg in ("left", "right"):
        for cell in ("inner", "outer"):
            assert {f"{leg}.{cell}.band", f"{leg}.{cell}.lever"} <= names
    assert model.key("start").id == 0
    band = model.tendon("left.inner.band").id
    assert model.tendon_stiffness[band] == 58.75
    assert model.tendon_lengthspring[band] == pytest.approx([0.0, 0.022], abs=1e-9)
