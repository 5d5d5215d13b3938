"""A hopper is checked by statics before anything is simulated, and its bound is a closed form."""

import math
from dataclasses import replace

import numpy as np
import pytest

import stepwell as sw
from facts import refuses, says
from hoppers import hopper
from stepwell.base import GRAVITY
from stepwell.files import dumps, load, loads
from stepwell.robot import (
    Hopper,
    Springs,
    Task,
    bound_of,
    hopper_springs,
    impacts,
    landing_length,
    longest_stretch,
    predicted_stop,
    release,
    snap_of,
    wire_springs,
)


def test_a_hopper_is_read_from_its_file_and_survives_being_written():
    for name in ("hopper", "hopper-forward"):
        made = sw.load(f"preset:{name}")
        assert isinstance(made, Hopper)
        assert loads(dumps(made)).hopper == made
        assert load(f"preset:{name}").chain == made.chain == sw.preset(name)
        assert hash(made) == hash(hopper(name))


def test_a_chain_without_the_table_is_no_hopper():
    with refuses(ValueError, "paper-forward", "no table [hopper]", "stepwell new"):
        _ = load("preset:paper-forward").hopper


def test_the_energy_of_a_snap_is_the_difference_of_the_springs_energies_less_the_lift():
    made = hopper()
    snap = snap_of(made)
    travels = zip(made.whole.cells, snap.before, snap.after, strict=True)
    free = sum(float(cell.energy_at(a)) - float(cell.energy_at(b)) for cell, a, b in travels)
    assert snap.of_springs == pytest.approx(free, rel=1e-9)
    assert snap.energy == pytest.approx(free - made.load * snap.foot_travel, rel=1e-9)
    unit = 2 * 450 * 0.040**2
    assert snap.ratio == pytest.approx(free / unit, rel=1e-9)
    # The stroke is fixed while the cells exchange their travels.
    assert sum(snap.before) == pytest.approx(snap.stroke) == pytest.approx(sum(snap.after))


def test_the_bound_shares_the_momentum_with_the_foot():
    made = hopper()
    snap = snap_of(made)
    bound = bound_of(made, snap)
    body, mass = made.body_mass, made.mass
    assert bound.height == pytest.approx(body / mass * snap.energy / (mass * 9.81), rel=1e-9)
    assert bound.speed == pytest.approx(body / mass * bound.speed_at_stop, rel=1e-9)
    stop, landing, _ = impacts(made, bound)
    assert stop.energy == pytest.approx((1 - body / mass) * snap.energy, rel=1e-9)
    assert landing.energy == pytest.approx(mass * 9.81 * bound.height, rel=1e-9)


def test_without_damper_and_friction_the_model_is_the_bound():
    cells = [replace(cell, friction=0.0) for cell in hopper().chain.levers]
    ideal = hopper(chain=replace(hopper().chain, cells=tuple(cells)), damping=0.0)
    ideal = replace(ideal, springs=replace(ideal.springs, loss=0.0))
    snap = snap_of(ideal)
    stop = bound_of(ideal, snap).speed_at_stop
    assert predicted_stop(ideal, snap) == pytest.approx(stop, rel=1e-4)
    damped = predicted_stop(replace(ideal, damping=2.0), snap)
    lossy = predicted_stop(replace(ideal, springs=replace(ideal.springs, loss=0.2)), snap)
    assert max(damped, lossy) < 0.97 * predicted_stop(ideal, snap)


def test_a_tilted_jump_flies_a_parabola_and_a_thrown_ball_takes_its_share():
    made = hopper("hopper-forward")
    bound = bound_of(made, snap_of(made))
    up, along = bound.speed * math.cos(made.tilt), bound.speed * math.sin(made.tilt)
    assert bound.height == pytest.approx(up**2 / 2 / made.gravity)
    assert bound.distance == pytest.approx(2 * up * along / made.gravity)
    thrown = hopper(task="throw", ball_mass=0.02)
    snap = snap_of(thrown)
    moved = thrown.foot_mass + 0.02
    assert bound_of(thrown, snap).energy == pytest.approx(0.02 / moved * snap.energy)
    struck = hopper(task=Task.STRIKE)
    assert bound_of(struck, snap_of(struck)).energy == pytest.approx(snap_of(struck).energy)


def test_copies_are_as_strong_as_stiffer_bands():
    alone = hopper(copies=1)
    bands = [replace(c, band=replace(c.bands[0], stiffness=900.0)) for c in alone.chain.levers]
    cells = [replace(cell, friction=0.2) for cell in bands]
    stiff = replace(alone, chain=replace(alone.chain, cells=tuple(cells)))
    assert snap_of(stiff).energy == pytest.approx(snap_of(hopper()).energy, rel=1e-9)


def test_the_papers_robot_cannot_jump_and_the_message_has_both_forces():
    leg = sw.preset("robot-forward").legs[0].chain
    robot = Hopper(leg, body_mass=0.25, foot_mass=0.01, copies=2, springs=Springs(stretch=5.0))
    assert max(cell.force_0 for cell in robot.whole.levers) < robot.load
    with refuses(ValueError, "no snap", "1.36 N at most", "2.45 N"):
        snap_of(robot)


def test_too_weak_for_its_load_says_how_stiff_bands_must_be():
    heavy = hopper(body_mass=8.0)
    with pytest.raises(sw.InputError) as caught:
        snap_of(heavy)
    says(str(caught.value), "too weak", "78.5 N", "times the stiffness")
    factor = float(str(caught.value).partition("bands of ")[2].split()[0])
    cells = [
        replace(c, band=replace(c.bands[0], stiffness=1.01 * factor * 450.0))
        for c in heavy.chain.levers
    ]
    stronger = replace(heavy, chain=replace(heavy.chain, cells=tuple(cells)))
    assert release(stronger.whole, 1, stronger.load) is not None


def test_bands_beyond_their_stretch_are_refused_with_a_rest_length_that_suffices():
    made = hopper(springs=Springs(stretch=2.0))
    with refuses(ValueError, "latch", "2.21 times", "44.2 mm"):
        snap_of(made)
    cells = [replace(c, band=replace(c.bands[0], rest_length=0.0442)) for c in made.chain.levers]
    assert longest_stretch(replace(made.chain, cells=tuple(cells))) <= 2.0


def test_an_actuator_that_cannot_hold_the_peak_is_refused_with_bands_that_it_holds():
    weak = hopper(actuator=replace(hopper().actuator, force=22.0))
    with pytest.raises(sw.InputError) as caught:
        snap_of(weak)
    says(str(caught.value), "actuator.force = 22 N", "29.9 N", "times the stiffness")
    factor = float(str(caught.value).partition("at most ")[2].split()[0])
    cells = [
        replace(c, band=replace(c.bands[0], stiffness=factor * 450.0)) for c in weak.chain.levers
    ]
    assert snap_of(replace(weak, chain=replace(weak.chain, cells=tuple(cells)))).peak_force <= 22.0


def test_a_foot_too_small_to_land_on_is_refused():
    made = hopper("hopper-forward")
    least = landing_length(made, snap_of(made))
    with refuses(ValueError, "foot_length = 60 mm", "turns over"):
        snap_of(replace(made, foot_length=0.06))
    assert snap_of(replace(made, foot_length=least * 1.001))
    with refuses(ValueError, "tilt = 45 deg", "slips"):
        snap_of(replace(made, tilt=math.pi / 4, foot_length=1.0))


def test_springs_of_steel_have_the_rate_and_the_load_of_the_bands():
    (latch, _), every = hopper().chain.levers, hopper_springs(hopper().chain.levers)
    assert 0.0009 in [pytest.approx(one.wire) for one in every]
    for one in every:
        turns = 8.0 * one.coil**3 * one.coils
        assert 81.5e9 * one.wire**4 / turns == pytest.approx(one.rate) == pytest.approx(450.0)
        assert one.body_length <= 0.040 and one.stress <= one.allowed
        assert one.load == pytest.approx(450.0 * 0.040 * (latch.largest_stretch - 1.0))
    # A soft and short band has no room for coils.
    assert wire_springs(sw.Band((0.0, 0.0), (0.02, 0.0), 28.5, 0.010), 0.050) == ()


@pytest.mark.parametrize(
    ("changes", "part"),
    [
        ({"foot_after": 2}, "foot_after = 2"),
        ({"body_mass": 0.05}, "body_mass = 50 g"),
        ({"tilt": 2.0}, "tilt = 114.592 deg"),
        ({"task": "fly"}, "task = 'fly'"),
        ({"copies": 0}, "copies = 0"),
    ],
)
def test_impossible_values_are_refused(changes, part):
    with refuses(ValueError, part):
        hopper(**changes)


@pytest.mark.parametrize(
    ("line", "facts"),
    [
        ("foot_mass_g = -1", ("hopper.foot_mass_g = -1", "> 0")),
        ("foot_mas_g = 1", ("hopper.foot_mas_g", "foot_mass_g?")),
        ('task = "thro"', ("hopper.task", "throw?")),
        ("copies = 1.5", ("hopper.copies = 1.5", "whole number")),
    ],
)
def test_a_wrong_key_is_named_with_its_path(line, facts):
    text = dumps(sw.preset("paper-forward")) + f"[hopper]\nbody_mass_g = 100\n{line}\n"
    with refuses(ValueError, *facts):
        loads(text)


def test_the_unit_of_a_load_is_that_of_the_weight():
    made = hopper(gravity=GRAVITY)
    assert made.load == pytest.approx(0.190 * GRAVITY)
    loaded = made.loaded.levers
    extra = loaded[0].force_at(np.array([0.01])) - made.whole.levers[0].force_at(np.array([0.01]))
    assert extra == pytest.approx(made.load)
    assert loaded[1] == made.whole.levers[1]
