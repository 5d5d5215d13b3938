"""Robots that the paper did not build: more cells, more legs, other bands."""

import math
from dataclasses import replace

import numpy as np
import pytest

import stepwell as sw
from facts import refuses
from simulation.robots import FORWARD, cell, explorer, leg_of_three, robot
from stepwell.robot import Body, Drive, Floor, Leg, Profile, Robot
from stepwell.simulation import Linkage, Settings, mjcf, spec, walk
from stepwell.simulation.simulator import mujoco

AIR = Floor(gravity=0.0)
LINKAGES = [Settings(linkage=linkage) for linkage in Linkage]


@pytest.mark.slow
@pytest.mark.parametrize("settings", LINKAGES, ids=list(Linkage))
def test_legs_of_three_cells_follow_their_sequence_in_the_air(settings):
    legs = [leg_of_three("left"), leg_of_three("right")]
    one = Robot(legs, floor=AIR, drive=Drive(amplitude=0.060, period=4.0))
    seen = walk(one, 1, settings=settings)
    assert not seen.stopped
    wanted = str(one.legs[0].chain.cycle().sequence)
    assert seen.gaits == {"left": (wanted,), "right": (wanted,)}
    assert seen.travel.shape[1:] == (2, 3)
    assert seen.travel.sum(axis=2) == pytest.approx(np.stack([seen.stroke] * 2, 1), abs=1e-9)


@pytest.mark.slow
def test_legs_of_three_cells_walk_forward():
    body = Body(supports=((-0.080, 0.0), (0.038, 0.045), (0.038, -0.045)))
    legs = [leg_of_three("left"), leg_of_three("right")]
    one = Robot(legs, body=body, drive=Drive(amplitude=0.060, period=4.0))
    seen = walk(one, 2)
    assert not seen.stopped
    # u_max is the travel of both stepping cells, 40 mm.
    assert one.legs[0].stroke == pytest.approx(0.040)
    assert seen.advance[1:].min() > 0.25


@pytest.mark.slow
@pytest.mark.parametrize("settings", LINKAGES, ids=list(Linkage))
def test_four_legs_walk(settings):
    chain = sw.Chain([cell("inner", 0.010), cell("outer", 0.020)])
    at = {"left": 0.060, "mid-left": 0.025, "mid-right": -0.025, "right": -0.060}
    legs = [Leg(name, chain, (0.008, y)) for name, y in at.items()]
    body = Body(supports=((-0.055, 0.0), (0.038, 0.043), (0.038, -0.043)), mass=0.300)
    seen = walk(Robot(legs, body=body), 2, settings=settings)
    assert not seen.stopped
    assert seen.gaits == dict.fromkeys(at, (FORWARD,) * 2)
    assert seen.advance[1:].min() > 0.5
    assert np.degrees(np.abs(seen.turn)).max() < 1.0


@pytest.mark.parametrize(
    "law", [sw.Linear(), sw.Cubic(-20.0, 800.0), sw.Cubic(15.0, 0.0)], ids=repr
)
def test_a_band_pulls_with_the_tension_of_its_law(law):
    band = sw.Band((-0.010, 0.0), (0.010, 0.0), 28.5, 0.010, law)
    chain = sw.Chain([sw.Cell(band, name="inner"), cell("outer", 0.020)])
    legs = [Leg("left", chain, (0.008, 0.0575)), Leg("right", chain, (0.008, -0.0575))]
    model = spec(Robot(legs, floor=AIR)).compile()
    data = mujoco.MjData(model)
    tendon = model.tendon("left.inner.band").id
    side = model.joint("left.inner.side")
    for shift in np.linspace(-0.025, 0.020, 19):
        data.qpos[:] = model.qpos0
        data.qpos[side.qposadr[0]] += shift
        mujoco.mj_forward(model, data)
        length = float(data.ten_length[tendon])
        joint = side.dofadr[0]
        # Two bands end at this block: this one and the outer cell's, which is moved along with it.
        alone = spring_force(model, data, tendon)
        assert alone == pytest.approx(float(band.tension(length)), rel=1e-9, abs=1e-12)
        assert np.isfinite(data.qfrc_passive[joint])


def spring_force(model, data, tendon: int) -> float:
    """Pull of one line [N] as the simulator has it, all others cut."""
    kept = model.tendon_stiffness.copy(), model.tendon_stiffnesspoly.copy()
    others = np.arange(model.ntendon) != tendon
    model.tendon_stiffness[others] = 0.0
    model.tendon_stiffnesspoly[others] = 0.0
    mujoco.mj_forward(model, data)
    # Along the block's sideways slide the band pulls with its tension times its direction.
    joint = model.joint("left.inner.side").dofadr[0]
    p, q = (data.site(f"left.inner.band.{end}").xpos for end in "pq")
    direction = (q - p) / np.linalg.norm(q - p)
    force = -data.qfrc_spring[joint] / direction[1]
    model.tendon_stiffness[:], model.tendon_stiffnesspoly[:] = kept
    return float(force)


def test_a_tabulated_band_is_refused_with_what_to_do_instead():
    band = sw.Band.from_table((-0.010, 0.0), (0.010, 0.0), 0.010, (0.0, 0.01), (0.0, 0.3))
    chain = sw.Chain([sw.Cell(band), cell("outer", 0.020)])
    legs = [Leg("left", chain, (0.008, 0.0575)), Leg("right", chain, (0.008, -0.0575))]
    for settings in LINKAGES:
        with pytest.raises(ValueError, match=r"law = Table: .*fit a cubic"):
            spec(Robot(legs), settings=settings)


def test_a_load_on_a_cell_is_refused_with_the_leg_and_the_cell():
    heavy = replace(cell("inner", 0.010), load=sw.Load.constant(0.1))
    chain = sw.Chain([heavy, cell("outer", 0.020)])
    legs = [Leg("left", chain, (0.008, 0.0575)), Leg("right", chain, (0.008, -0.0575))]
    with refuses(ValueError, "leg 'left'", "cell 'inner'", "a load"):
        mjcf(Robot(legs))


def test_an_antenna_on_an_outer_cell_is_refused():
    one = explorer()
    antennas = [replace(antenna, cell="outer") for antenna in one.antennas]
    with refuses(ValueError, "antenna ", "outer", "innermost cell"):
        walk(replace(one, antennas=antennas), 1)


@pytest.mark.parametrize("profile", list(Profile))
def test_every_profile_of_the_drive_walks(profile):
    seen = walk(robot(drive=Drive(profile=profile)), 2)
    assert seen.gaits["left"] == (FORWARD,) * 2
    assert seen.advance[1:].min() > 0.5
    assert seen.command.max() == pytest.approx(0.040, abs=1e-6)
    assert seen.command.min() == 0.0


def test_a_lever_of_another_length_and_limit_simulates_on_both_linkages():
    inner = replace(cell("inner", 0.012), lever=0.012, limit=math.radians(50))
    outer = replace(cell("outer", 0.016), lever=0.016, limit=math.radians(35))
    chain = sw.Chain([inner, outer])
    legs = [Leg("left", chain, (0.008, 0.0575)), Leg("right", chain, (0.008, -0.0575))]
    one = Robot(legs, floor=AIR, drive=Drive(amplitude=chain.full_stroke))
    gaits = [walk(one, 1, settings=settings).gaits["left"] for settings in LINKAGES]
    assert gaits == [(str(chain.cycle().sequence),)] * 2
