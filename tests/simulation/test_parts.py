"""A robot made of parts in the simulation: what it weighs, meets, shows, and how it walks."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

pytest.importorskip("mujoco")

import stepwell as sw
from robot.made import parts
from robot.robots import BACKWARD, FORWARD, VIA_01, cell, explorer, robot
from stepwell.build import MotionSweep, RobotBuild
from stepwell.robot import Arena, Blocks, Drive, Leg, Robot, RobotParts, Wall, with_parts
from stepwell.simulation import Linkage, Settings, Walk, mjcf, walk
from stepwell.simulation.live import FRAMES, SLACK, LiveParts, tension_colour
from stepwell.simulation.model import spec
from stepwell.simulation.simulator import mujoco

LEGS = {"left": 0.0575, "right": -0.0575}
LINKAGES = pytest.mark.parametrize("linkage", Linkage)


def legs_with(stiffness: float) -> list[Leg]:
    """Forward legs with other bands: those of the paper are near a change of gait."""
    cells = [cell("inner", 0.010, k=stiffness), cell("outer", 0.020, k=stiffness)]
    return [Leg(name, sw.Chain(cells), (0.008, y)) for name, y in LEGS.items()]


def parts_of(robot: Robot) -> RobotParts:
    """The parts of a robot that has some."""
    assert robot.made is not None
    return robot.made


@cache
def made(antennas: bool = False) -> Robot:
    one = explorer() if antennas else Robot(legs_with(75.0), drive=Drive(period=3.8))
    return with_parts(one, parts(one))


@cache
def walked(linkage: Linkage = Linkage.RODS) -> Walk:
    return walk(made(), 2, settings=Settings(linkage=linkage))


@pytest.fixture(params=[False, True], ids=["legs alone", "with antennas"])
def one(request) -> Robot:
    return made(request.param)


def model_of(one: Robot, linkage: Linkage = Linkage.RODS):
    model = spec(one, None, Settings(linkage=linkage)).compile()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    return model, data


@LINKAGES
def test_the_model_has_the_mass_and_the_centre_of_mass_of_the_parts(one, linkage):
    model, data = model_of(one, linkage)
    body = model.body("body").id
    assert model.body_subtreemass[body] == pytest.approx(one.mass, rel=1e-9)
    centre = data.subtree_com[body] - data.xpos[body]
    # The parts of the test are boxes at about their places, and its anchors are on sliders.
    assert centre == pytest.approx(one.made.centre, abs=2e-5)


@LINKAGES
def test_the_inertia_about_every_axis_is_that_of_the_parts(linkage):
    model, data = model_of(made(), linkage)
    whole = np.zeros((3, 3))
    for i in range(model.body("body").id, model.nbody):
        off = data.xipos[i] - data.subtree_com[1]
        turn = data.ximat[i].reshape(3, 3)
        whole += turn @ np.diag(model.body_inertia[i]) @ turn.T
        whole += model.body_mass[i] * (off @ off * np.eye(3) - np.outer(off, off))
    wanted, centre = np.zeros((3, 3)), parts_of(made()).centre
    for part in parts_of(made()).masses:
        off = part.centre - centre
        wanted += part.inertia + part.mass * (off @ off * np.eye(3) - np.outer(off, off))
    # On rods a lever is two points at its joints, which turn no worse than a rod does.
    assert np.diag(whole) == pytest.approx(np.diag(wanted), rel=0.01)


def test_rods_and_hinged_levers_walk_alike():
    rods, hinges = (walked(linkage) for linkage in Linkage)
    assert rods.gaits["left"][-1] == hinges.gaits["left"][-1] == FORWARD
    assert rods.advance[-1] == pytest.approx(hinges.advance[-1], abs=0.02)


def test_parts_that_weigh_as_much_as_the_numbers_walk_as_these_do():
    plain = walk(replace(made(), made=None), 2)
    assert plain.gaits["left"][-1] == walked().gaits["left"][-1] == FORWARD
    assert walked().advance[-1] == pytest.approx(plain.advance[-1], abs=0.05)


def test_a_shape_that_collides_meets_a_wall_and_the_plain_outline_does_not():
    wide = made()
    ahead = Arena(walls=[Wall((0.088, -0.5), (0.088, 0.5), 0.01)])
    # The plate of the parts ends at 99 mm, the plain outline of the body at 50 mm.
    met = walk(wide, 1, arena=ahead)
    plain = walk(replace(wide, made=None), 1, arena=ahead)
    assert met.obstacle_force.max() > 0.05
    assert plain.obstacle_force.max() == 0.0


def test_a_model_of_parts_is_exported_and_steps_alone(tmp_path):
    model = mujoco.MjModel.from_xml_string(mjcf(made(antennas=True)))
    assert model.nmesh == len(parts_of(made(antennas=True)).shapes) - sum(
        shape.collides and shape.body.split(".")[-1] in ("lever 1", "lever 2")
        for shape in parts_of(made(antennas=True)).shapes
    )


def test_a_run_steps_the_same_model_without_what_is_only_drawn():
    drawn, stepped = spec(made()).compile(), spec(made(), drawn=False).compile()
    assert stepped.nmocap == 0 < drawn.nmocap
    assert stepped.nmesh == sum(shape.collides for shape in parts_of(made()).shapes)
    assert stepped.nq == drawn.nq
    assert stepped.body_subtreemass[1] == drawn.body_subtreemass[1]


def frames(one: Robot, way: Walk):
    """The live parts at every sample of a walk, and the data they moved."""
    model = spec(one, None, way.settings).compile()
    data, live = mujoco.MjData(model), LiveParts(model)
    for position in way.positions:
        data.qpos[:] = position
        mujoco.mj_kinematics(model, data)
        live.update(data)
        yield model, data, live


def test_drawn_levers_links_and_cranks_reach_from_joint_to_joint(one):
    way = walk(one, 0.5)
    for model, data, live in [*frames(one, way)][::20]:
        assert len(live.followers) == 2 * 6 + len(one.antennas)
        for (mocap, near, far), rest in zip(live.followers, live.rest, strict=True):
            body = int(np.flatnonzero(model.body_mocapid == mocap)[0])
            tip = data.xpos[body] + data.xmat[body].reshape(3, 3) @ rest
            assert data.xpos[body] == pytest.approx(data.site_xpos[near], abs=1e-9)
            # Rods stretch by hundredths of a millimetre, anchors slide on a line and not on an arc.
            assert np.linalg.norm(tip - data.site_xpos[far]) < 3e-3 if one.antennas else 1e-4


def test_bands_are_coloured_by_their_tension_and_none_is_beyond_the_scale():
    for model, data, live in frames(made(), walked()):
        for band in live.bands:
            share = live.tension(band, data) / live.most
            assert share < 1.0 + 1e-3
            assert model.tendon_rgba[band] == pytest.approx(tension_colour(share), abs=1e-6)


def test_tension_is_that_of_the_band_law():
    model, data = model_of(made())
    live, inner = LiveParts(model), made().legs[0].chain.levers[0]
    mujoco.mj_tendon(model, data)
    band = inner.bands[0]
    along = inner.lever * np.sin(inner.limit)
    stretch = np.hypot(0.02 + inner.lever * np.cos(inner.limit), along) - band.rest_length
    assert live.tension(live.bands[0], data) == pytest.approx(band.stiffness * stretch, rel=1e-6)


def test_colours_of_tension_grow_lighter_and_slack_bands_are_grey():
    # Lightness alone orders them, so that readers need no hue.
    light = [
        np.dot(tension_colour(share)[:3], (0.21, 0.72, 0.07)) for share in np.linspace(0.01, 1, 9)
    ]
    assert (np.diff(light) > 0).all()
    assert tension_colour(0.0) == tension_colour(-1.0) == SLACK


def test_a_block_that_snaps_is_lit_and_dark_again_after_some_frames():
    lit = np.array([live.lit.copy() for _, _, live in frames(made(), walked())])
    times, cells = np.nonzero(lit == 1.0)
    assert len(times) > 0
    # A forward leg snaps near both ends of its stroke, and not all the time.
    assert (lit > 0).mean() < 0.3
    for time, which in zip(times, cells, strict=True):
        if (later := lit[time + 1 : time + FRAMES + 1, which]).max() < 1.0:
            assert (np.diff(later) < 0).all()
            assert len(later) < FRAMES or later[-1] < 1e-9


def test_a_robot_without_parts_has_no_mesh_and_keeps_its_colours():
    plain = walk(robot(), 0.25)
    model = spec(robot()).compile()
    assert model.nmesh == model.nmocap == 0
    before = model.tendon_rgba.copy(), model.geom_rgba.copy()
    for model, _, live in frames(robot(), plain):
        assert not live.made
        assert (model.tendon_rgba == before[0]).all()
        assert (model.geom_rgba == before[1]).all()


def acrylic(outer_anchor: float, **blocks: float) -> Robot:
    given = Blocks(mass=0.0232, outer=0.0068, carriage=0.0195, **blocks)
    return robot(outer_anchor, blocks=given, drive=Drive(period=3.8))


@pytest.mark.slow
@pytest.mark.parametrize(("friction", "gait"), [(0.0, FORWARD), (0.08, VIA_01)])
def test_rail_friction_stops_the_forward_gait_of_soft_bands_in_both_models(friction, gait):
    one = acrylic(0.020, rail_friction=friction)
    assert one.predict().legs[0].gait == walk(one, 2).gaits["left"][-1] == gait
    # Friction of the inner cell's rail makes a backward gait surer, and it stays.
    back = acrylic(0.005, rail_friction=friction)
    assert back.predict().legs[0].gait == walk(back, 2).gaits["left"][-1] == BACKWARD


def test_rail_friction_is_felt_by_the_inner_cell_alone():
    assert Blocks(rail_friction=0.1).rails(2) == (0.1, 0.0)
    assert Blocks(rail_friction=0.1).rails(3) == pytest.approx((0.2, 0.1, 0.0))
    model = spec(acrylic(0.020, rail_friction=0.1)).compile()
    held = {model.joint(int(i)).name for i in np.flatnonzero(model.dof_frictionloss[6:]) + 1}
    assert held == {"left.inner.block", "right.inner.block"}


def test_a_robot_of_a_build_shows_cords_and_bands_as_loops_around_hooks_below_their_caps():
    pytest.importorskip("manifold3d")
    built = sw.build(sw.preset("robot-antennas"), swept=MotionSweep(True, (), (), (), 0, 0))
    assert isinstance(built, RobotBuild)
    one = built.robot
    model, data = model_of(one)
    live = LiveParts(model)
    live.update(data)
    mujoco.mj_forward(model, data)
    body = data.xpos[model.body("body").id]
    assert [*parts_of(one).cords] == ["left", "right"]
    for antenna, ends in parts_of(one).cords.items():
        sites = [data.site(f"drawn cord {antenna} {k}").xpos - body for k in (1, 2)]
        # Anchors slide on a line, cranks turn on an arc.
        assert np.abs(np.array(sites) - [point for _, point in ends]).max() < 1e-3
    shapes = parts_of(one).shapes
    below = min(shape.vertices[:, 2].min() for shape in shapes if shape.part.startswith("cap "))
    bands = [model.tendon(i).name for i in live.bands]
    assert len(bands) == len(built.layout.bands) == 4
    for name, strands in zip(bands, live.drawn, strict=True):
        assert model.tendon_rgba[model.tendon(name).id, 3] == 0 and len(strands) == 2
        ends = [[data.site(f"strand of {name} {k}.{end}").xpos for end in "pq"] for k in (1, 2)]
        apart = np.array(ends[0]) - np.array(ends[1])
        assert np.linalg.norm(apart, axis=1) == pytest.approx(0.005, abs=1e-6)
        assert np.array(ends)[..., 2].max() - body[2] < below
        tension = live.tension(model.tendon(name).id, data)
        for strand in strands:
            assert model.tendon_rgba[strand] == pytest.approx(tension_colour(tension / live.most))
