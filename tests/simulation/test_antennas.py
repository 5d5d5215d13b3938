"""Antennas pass each other in layers, meet each other and the legs, and say what they move."""

import math
from itertools import product

import numpy as np
import pytest

from simulation.robots import explorer
from stepwell.robot import Arena, Cylinder
from stepwell.simulation import Linkage, Settings, maze, spec
from stepwell.simulation.simulator import mujoco


def owners(model, kind: str) -> list[int]:
    """Shapes of the bodies whose name ends like this."""
    return [
        geom
        for geom in range(model.ngeom)
        if model.body(model.geom_bodyid[geom]).name.endswith(kind)
    ]


def meets(model, one: int, other: int) -> bool:
    """Whether two shapes of different bodies are looked at for contact."""
    return bool(
        model.geom_contype[one] & model.geom_conaffinity[other]
        or model.geom_contype[other] & model.geom_conaffinity[one]
    )


@pytest.mark.parametrize("linkage", list(Linkage))
def test_crossed_antennas_pass_each_other_however_far_they_swing(linkage):
    model = spec(explorer(), settings=Settings(linkage=linkage)).compile()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    left, right = owners(model, "left.antenna"), owners(model, "right.antenna")
    assert len(left) == len(right) == 2
    crossed = False
    for swings in product(np.linspace(0.0, 1.2, 5), repeat=2):
        for name, swing in zip(("left", "right"), swings, strict=True):
            data.qpos[model.joint(f"{name}.antenna").qposadr[0]] = swing
        mujoco.mj_forward(model, data)
        apart = min(
            mujoco.mj_geomDistance(model, data, a, b, 1.0, None) for a, b in product(left, right)
        )
        assert apart >= 0.002
        crossed |= apart < 0.004
    assert crossed


def test_antennas_meet_each_other_and_what_moves_of_a_leg_but_not_body_and_carriage():
    model = spec(explorer()).compile()
    (rod, *_), (other, *_) = owners(model, "left.antenna"), owners(model, "right.antenna")
    assert meets(model, rod, other)
    for kind in ("inner.block", ".foot"):
        for shape in owners(model, kind):
            assert meets(model, rod, shape), kind
    for kind in ("body", "carriage"):
        assert not any(meets(model, rod, shape) for shape in owners(model, kind)), kind


@pytest.mark.parametrize("swing", [60.0, 68.0])
def test_an_antenna_swung_back_all_the_way_meets_its_leg(swing):
    model = spec(explorer()).compile()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    data.qpos[model.joint("left.antenna").qposadr[0]] = math.radians(swing)
    mujoco.mj_forward(model, data)
    met = {
        model.body(model.geom_bodyid[shape]).name
        for contact in data.contact
        if contact.dist < 0
        for shape in (contact.geom1, contact.geom2)
    }
    assert met == (set() if swing < 64 else {"left.antenna", "left.inner.block"})


@pytest.mark.slow
def test_a_contact_says_how_far_it_moved_the_anchor():
    one = explorer()
    arena, coarse = Arena((), [Cylinder((0.30, 0.04))]), Settings(time_step=2e-3, contact_time=4e-3)
    way = maze(one, arena, limit=30.0, settings=coarse)
    assert way.contacts
    for contact in way.contacts:
        assert contact.moved == pytest.approx(contact.swing / 1.2 * 0.010)
    # The robot has turned away by the time an antenna has swung half its way.
    assert 0.002 < max(contact.moved for contact in way.contacts) < 0.006
    loose = maze(explorer(connected=False), arena, limit=30.0, settings=coarse)
    assert loose.contacts
    assert {contact.moved for contact in loose.contacts} == {0.0}
