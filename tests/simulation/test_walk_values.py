"""What a walk says of its samples: gaits, advance, turn, slip; and the samples as a file."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import xarray as xr

from facts import refuses
from simulation.robots import explorer, robot, walked
from stepwell.robot import Drive
from stepwell.simulation import Integrator, Linkage, Settings, Walk, walk
from stepwell.simulation.engine import RunSamples

S = 0.020  # full travel of a cell, and u_max of a leg with one stepping cell [m]


def invented(cycles: int = 2, period: float = 2.0, **given: Any) -> Walk:
    """A walk with given samples, every 20 ms from 0.5 s before its first cycle."""
    one, settings = robot(drive=Drive(period=period)), Settings()
    steps = round((cycles * period + 0.5) / settings.time_step)
    time: np.ndarray = np.arange(1, steps // 20 + 1, dtype=np.float64) * 0.02 - 0.5
    n = len(time)
    zero, legs = np.zeros(n), np.zeros((n, 2))
    values: dict[str, Any] = dict.fromkeys(
        ("x", "y", "z", "yaw", "pitch", "roll", "command", "stroke", "actuator_force"), zero
    )
    values |= dict.fromkeys(("foot_height", "foot_force", "foot_speed"), legs)
    values |= {"travel": np.zeros((n, 2, 2)), "support_force": np.zeros((n, 3))}
    values |= {name: np.zeros((n, 0)) for name in ("antenna", "touch", "obstacle_force")}
    values |= {name: value(time) if callable(value) else value for name, value in given.items()}
    samples = RunSamples(
        time=time,
        data=np.zeros((n, 0)),
        positions=np.zeros((n, 0)),
        where={},
        stopped=given.get("stopped", ""),
        state=np.zeros(0),
        steps=steps,
        begin=-0.5,
        time_step=settings.time_step,
        every=20,
        warm=np.zeros(0),
        pending=np.zeros((0, 0)),
    )
    values.setdefault("stopped", "")
    return Walk(robot=one, settings=settings, arena=None, time=time, _samples=samples, **values)


def visits(*states: str, period: float = 2.0):
    """Travels of both legs that rest in these states for equal shares of a cycle."""

    def travel(time):
        index = np.clip((time / period % 1.0 * len(states)).astype(int), 0, len(states) - 1)
        rows = np.array([[float(c) * S for c in states[i]] for i in np.where(time < 0, 0, index)])
        return np.repeat(rows[:, None, :], 2, axis=1)

    return travel


def test_a_gait_lists_the_states_in_the_order_of_their_visits():
    seen = invented(travel=visits("00", "10", "11", "01", "00"))
    assert seen.gait("left", 1) == "00>10>11>01>00"
    assert seen.gaits["right"] == ("00>10>11>01>00",) * 2


@pytest.mark.parametrize(("share", "gait"), [(0.19, "00>11>00"), (0.21, "11")])
def test_a_cell_held_short_by_a_fifth_of_its_travel_still_counts_as_there(share, gait):
    def travel(time):
        whole = visits("00", "11", "00")(time)
        return np.maximum(whole, share * S)

    assert invented(travel=travel).gait("left", 0) == gait


def test_a_cell_in_transit_is_in_no_state():
    moving = invented(travel=lambda time: np.full((len(time), 2, 2), S / 2))
    assert moving.gait("left", 0) == ""
    assert moving.state("left", 1.0) is None


def test_advance_is_measured_along_the_heading_at_each_cycles_start_over_u_max():
    # 12 mm a cycle towards 30° on the floor, facing 90°.
    angle, step = math.radians(30), 0.012
    seen = invented(
        x=lambda t: step * math.cos(angle) * t / 2,
        y=lambda t: step * math.sin(angle) * t / 2,
        yaw=lambda t: np.full_like(t, math.pi / 2),
    )
    assert seen.advance == pytest.approx([0.6 * math.cos(math.radians(60))] * 2)
    assert seen.sideways == pytest.approx([-0.6 * math.sin(math.radians(60))] * 2)


def test_turn_counts_on_past_half_a_turn():
    seen = invented(cycles=4, yaw=lambda t: np.radians(170.0) + np.radians(15.0) * t / 2)
    assert np.degrees(seen.turn) == pytest.approx([15.0] * 4)


@pytest.mark.parametrize("period", [2.0, 1.13, 0.777])
def test_every_whole_cycle_is_counted_whatever_the_period(period):
    # A period need not be a whole number of samples, nor of time steps.
    seen = invented(cycles=3, period=period, x=lambda t: 0.010 * t / period)
    assert seen.cycles == 3
    assert seen.advance[:2] == pytest.approx([0.5] * 2, rel=1e-6)
    # The last sample may come before the last cycle's end, by less than a sample.
    assert 0.5 * (1 - 0.021 / period) < seen.advance[2] <= 0.5 * (1 + 1e-9)


def test_a_short_period_walks_and_counts():
    seen = walk(robot(drive=Drive(period=1.13)), 3)
    assert seen.cycles == 3
    assert seen.advance[1:] == pytest.approx(0.71, abs=0.08)


def test_a_walk_that_stopped_counts_only_the_cycles_it_finished():
    seen = invented(cycles=2)
    late = seen.time < 3.9
    samples = {
        name: getattr(seen, name)[late]
        for name in ("time", "x", "y", "z", "yaw", "pitch", "roll", "travel")
    }
    assert replace(seen, **samples, stopped="at 3.900 s").cycles == 1


def test_work_is_the_force_over_the_stroke():
    # 0.5 N out and 0.2 N back, over 40 mm.
    def force(t):
        return np.where(t % 2.0 < 1.0, 0.5, 0.2)

    seen = invented(
        cycles=1,
        stroke=lambda t: robot().drive.stroke(t),
        actuator_force=force,
        x=lambda t: 0.02 * np.maximum(t, 0) / 2,
    )
    assert seen.work == pytest.approx((0.5 - 0.2) * 0.040, rel=0.03)
    assert seen.cost_of_transport == pytest.approx(
        seen.work / (seen.robot.weight * 0.020), rel=1e-6
    )


def test_slip_counts_only_feet_that_carry_weight():
    seen = invented(
        cycles=2,
        foot_speed=lambda t: np.where(t[:, None] > 0, [0.003, 0.003], 0.0),
        foot_force=lambda t: np.tile([0.5, 0.0], (len(t), 1)),
    )
    assert seen.slip == pytest.approx([0.006, 0.0], abs=5e-5)


def test_questions_about_what_is_not_there_say_what_is():
    seen = invented()
    with refuses(ValueError, "cycle = 2", "0 to 1"):
        seen.gait("left", 2)
    with refuses(ValueError, "leg = 'middle'", "'left', 'right'"):
        seen.state("middle", 0.0)


def test_a_walk_says_how_it_went():
    assert repr(walked(0.020, 0.020)).startswith("Walk(4 cycles, d/u_max 0.7")
    assert "turn 15" in repr(walked(0.005, 0.020))


def test_the_samples_agree_with_one_another():
    one = walked(0.005, 0.020)
    n = len(one.time)
    assert one.travel.shape == (n, 2, 2)
    assert one.foot_force.shape == one.foot_height.shape == one.foot_speed.shape == (n, 2)
    assert one.support_force.shape == (n, 3)
    assert one.travel.sum(axis=2) == pytest.approx(np.stack([one.stroke] * 2, axis=1), abs=1e-9)
    assert np.diff(one.time) == pytest.approx(0.02)


@pytest.mark.parametrize("one", [robot(), explorer()], ids=["plain", "antennas"])
def test_netcdf_gives_back_the_samples_with_their_units(one, tmp_path):
    seen = walk(one, 0.1)
    file = tmp_path / "walk.nc"
    seen.to_netcdf(file)
    with xr.open_dataset(file) as opened:
        back = opened.load()
    whole = seen.to_xarray()
    none = [name for name, size in whole.sizes.items() if size == 0]
    xr.testing.assert_identical(back, whole.drop_dims(none))
    assert back["actuator_force"].units == "N"
    assert back["travel"].dims == ("time", "leg", "cell")
    assert list(back["leg"].values) == ["left", "right"]
    assert ("antenna" in back) == bool(one.antennas)
    assert back.attrs["linkage"] == "rods"


def test_a_walk_that_broke_at_once_can_be_kept_too(tmp_path):
    seen = walk(robot(), 2, settings=Settings(time_step=0.01, contact_time=0.02))
    assert seen.stopped
    seen.to_netcdf(tmp_path / "walk.nc")
    with xr.open_dataset(tmp_path / "walk.nc") as back:
        assert back.attrs["stopped"] == seen.stopped


def test_progress_runs_up_to_the_whole_time():
    reported: list[tuple[float, float]] = []
    walk(robot(), 1, progress=lambda done, total: reported.append((done, total)))
    assert [total for _, total in reported] == pytest.approx([2.5] * len(reported))
    done = [one for one, _ in reported]
    assert done == sorted(done)
    assert done[-1] == pytest.approx(2.5)


@pytest.mark.parametrize("cycles", [0, -1, float("nan")])
def test_a_walk_of_no_cycles_is_refused(cycles):
    with pytest.raises(ValueError, match=f"cycles = {cycles}: must be > 0"):
        walk(robot(), cycles)


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"time_step": 0.0}, r"time_step = 0.* must be"),
        ({"time_step": float("nan")}, r"time_step = nan"),
        ({"settle": -0.1}, r"settle = -0.1"),
        ({"integrator": "leapfrog"}, r"integrator = 'leapfrog': must be one of 'euler', "),
        ({"linkage": "cams"}, r"linkage = 'cams': must be one of 'rods', 'hinges'"),
        ({"contact_time": 1e-3}, r"contact_time = 0.001 s: must be >= 0.002 s"),
        ({"sample": 1e-4}, r"sample = 0.0001 s: must be >= 0.001 s"),
    ],
)
def test_settings_out_of_range_are_refused_with_what_is_allowed(given, says):
    with pytest.raises(ValueError, match=says):
        Settings(**given)


def test_settings_take_words():
    named = Settings(integrator="rk4", linkage="hinges")  # pyright: ignore[reportArgumentType]
    assert named.integrator is Integrator.RK4
    assert named.linkage is Linkage.HINGES


@pytest.mark.slow
@pytest.mark.parametrize(
    "settings",
    [
        Settings(time_step=5e-4),
        Settings(integrator=Integrator.IMPLICIT),
        Settings(integrator=Integrator.EULER),
        Settings(contact_time=4e-3),
        Settings(sample=0.005),
    ],
    ids=["half the step", "implicit", "euler", "softer contacts", "denser samples"],
)
def test_a_result_does_not_hang_on_the_settings(settings):
    other = walk(robot(), 3, settings=settings)
    assert other.advance[1:].mean() == pytest.approx(
        walked(0.02, 0.02).advance[1:].mean(), abs=0.04
    )
    assert other.gaits["left"] == walked(0.020, 0.020).gaits["left"][:3]
