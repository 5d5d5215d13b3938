"""Rods of fixed length against levers and links that are hinged bodies."""

import numpy as np
import pytest

from simulation.robots import explorer, leg_of_three, robot, walked
from sizes import SIZE
from stepwell.robot import Robot
from stepwell.simulation import Linkage, Settings, spec, walk
from stepwell.simulation.simulator import mujoco

HINGES = Settings(linkage=Linkage.HINGES)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("left", "right"),
    # The first has legs of both kinds, and other tests walk it too.
    [
        (0.005, 0.020),
        *[(0.020, 0.020), (0.005, 0.005), (0.020, 0.005), (0.015, 0.015)] * (SIZE == "full"),
    ],
)
def test_both_linkages_walk_alike(left, right):
    rods, hinges = walked(left, right), walked(left, right, linkage=Linkage.HINGES)
    assert hinges.gaits == rods.gaits
    assert hinges.advance[1:] == pytest.approx(rods.advance[1:], abs=0.05)
    assert np.degrees(hinges.turn[1:]) == pytest.approx(np.degrees(rods.turn[1:]), abs=2.0)


@pytest.mark.slow
@pytest.mark.parametrize("swing", [0.48, *[0.0] * (SIZE == "full")])
def test_both_linkages_walk_alike_with_antennas(swing):
    one = explorer().pressed({"left": swing})
    rods, hinges = walk(one, 3), walk(one, 3, settings=HINGES)
    assert hinges.gaits == rods.gaits
    assert hinges.advance[1:] == pytest.approx(rods.advance[1:], abs=0.05)
    assert np.degrees(hinges.turn[1:]) == pytest.approx(np.degrees(rods.turn[1:]), abs=2.0)


@pytest.mark.parametrize("one", [robot(), explorer()], ids=["plain", "antennas"])
def test_both_linkages_weigh_what_the_robot_weighs(one):
    for linkage in Linkage:
        model = spec(one, settings=Settings(linkage=linkage)).compile()
        # The parts that slide with an antenna's anchor are no part of the robot's weight.
        anchors = 0.002 * len(one.antennas)
        assert model.body("body").subtreemass[0] - anchors == pytest.approx(one.mass, rel=1e-9)


@pytest.mark.parametrize("linkage", list(Linkage))
@pytest.mark.parametrize(
    "one",
    [robot(), Robot([leg_of_three("left"), leg_of_three("right")])],
    ids=["two cells", "three cells"],
)
def test_every_constraint_holds_at_the_start(one, linkage):
    model = spec(one, settings=Settings(linkage=linkage)).compile()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    mujoco.mj_forward(model, data)
    held = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
    assert held.sum() > 0
    assert np.abs(data.efc_pos[held]).max() < 1e-9


@pytest.mark.slow
def test_levers_stay_parallel_by_themselves_and_end_at_the_stops():
    model = spec(robot(), settings=HINGES).compile()
    hinges = walked(0.005, 0.020, linkage=Linkage.HINGES)
    joints = [model.joint(i).name for i in range(model.njnt)]
    place = {name: int(model.joint(name).qposadr[0]) for name in joints}
    positions = hinges._samples.positions
    limit = np.pi / 4
    for leg in ("left", "right"):
        for cell in ("inner", "outer"):
            name = f"{leg}.{cell}"
            front, back = (positions[:, place[f"{name}.lever.{end}"]] for end in ("front", "back"))
            assert np.abs(front - back).max() < np.radians(0.3)
            assert np.abs(positions[:, place[f"{name}.yaw"]]).max() < np.radians(0.3)
            # They go all the way, and no further than the stops give.
            assert np.abs(front).max() == pytest.approx(limit, abs=np.radians(0.5))


def test_links_and_levers_keep_their_lengths_on_the_way():
    for linkage in Linkage:
        one = walked(0.005, 0.020, linkage=linkage)
        samples = one._samples
        for leg in one.robot.legs:
            rods = {f"{leg.name}.{cell}.lever": 0.010 * 2**0.5 for cell in ("inner", "outer")}
            rods |= {f"{leg.name}.link.{end}": 0.035 for end in ("in", "out")}
            for name, length in rods.items():
                measured = samples.data[:, samples.where[f"{name}.length"]]
                assert measured == pytest.approx(length, abs=1e-4), name
