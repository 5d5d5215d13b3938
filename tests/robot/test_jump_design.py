"""A designed hopper: the best pair on its holes, refusals before the search, and its file."""

from dataclasses import replace

import pytest

import stepwell as sw
from facts import refuses
from hoppers import hopper
from stepwell.design import BandType, Impossible
from stepwell.files import dumps, loads
from stepwell.robot import design_jump, longest_stretch, usual_means

COARSE = usual_means(hopper(), hopper().chain.levers[0].lever)._replace(pitch=0.010)
SAMPLED = (20, 0)


@pytest.fixture(scope="module")
def made():
    return design_jump(hopper(), means=COARSE, sampling=SAMPLED)


def test_the_designed_hopper_beats_the_shipped_one_within_its_means(made):
    shipped, made_yield = sw.robot.snap_of(hopper()), hopper().chain.yields(samples=200).fraction
    assert made.snap.energy * made.yield_.fraction > shipped.energy * made_yield
    assert made.snap.energy == pytest.approx(2 * made.found.energy, rel=1e-6)
    assert made.snap.peak_force <= hopper().actuator.force
    assert longest_stretch(made.hopper.chain) <= hopper().springs.stretch
    assert made.snap.energy < made.energy_bound
    assert made.flight == sw.robot.bound_of(made.hopper, made.snap)


def test_masses_friction_and_task_stay_and_the_file_is_read_again(made):
    old = hopper()
    assert replace(made.hopper, chain=old.chain) == old
    assert [cell.friction for cell in made.hopper.chain.levers] == [0.1, 0.1]
    assert loads(dumps(made.hopper)).hopper == made.hopper


def test_the_best_of_several_bands_is_taken(made):
    weak, own = BandType(100.0, 0.040), BandType(450.0, 0.040)
    both = design_jump(hopper(), [weak, own], COARSE, sampling=SAMPLED)
    assert both.found.chain == made.found.chain


def test_a_hopper_that_no_pair_helps_is_refused_before_the_search():
    lever = hopper().chain.levers[0].lever
    weak = replace(hopper().actuator, force=2.0)
    with refuses(ValueError, "actuator.force = 2 N", "must be > 2.26 N", "less mass"):
        design_jump(hopper(actuator=weak), means=usual_means(hopper(actuator=weak), lever))
    with refuses(ValueError, "foot_length = 60 mm", "turns over"):
        design_jump(hopper("hopper-forward", foot_length=0.06), means=COARSE)
    with refuses(Impossible, "none with", "N of load", "stiffer band"):
        strong = replace(hopper().actuator, force=500.0)
        design_jump(hopper(body_mass=20.0, actuator=strong), means=COARSE._replace(force=500.0))
