"""Promises about the parts of a whole robot: places, motion and masses."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import trimesh

import stepwell as sw
from stepwell.build import load_build_file
from stepwell.build.robots.masses import box_solids, fastener_solid, in_robot
from stepwell.build.robots.robot_layout import robot_layout
from stepwell.build.robots.solids import part_mesh

NAMES = ("robot-forward", "robot-antennas")


@cache
def made(name, material="acrylic-3mm"):
    """The build of a preset."""
    return sw.build(sw.preset(name), material)


def random_poses(layout, count):
    """Poses at random angles of all cells and antennas."""
    draw = np.random.default_rng(38)
    for _ in range(count):
        yield {k: draw.uniform(low, high) for k, (low, high) in layout.motions.ranges().items()}


def at(layout, body, point, pose):
    """Where a point of the reference pose is after the motion of its body."""
    (dx, dy), turn, (hx, hy) = (
        one if i else one[0] for i, one in enumerate(layout.moved(body, pose))
    )
    c, s = math.cos(turn[0]), math.sin(turn[0])
    x, y = point[0] - hx, point[1] - hy
    return np.array([hx + c * x - s * y + dx, hy + s * x + c * y + dy])


@pytest.mark.parametrize("name", NAMES)
def test_bands_are_as_long_as_the_engine_says_at_any_angles(name):
    layout = made(name).layout
    for pose in random_poses(layout, 20):
        pose |= {k: 0.0 for k in pose if k[0] == "antenna"}
        for path in layout.bands:
            cell = layout.cell(path)
            p, q = (
                at(layout, b, x, pose) for b, x in zip(path.bodies, (path.p, path.q), strict=True)
            )
            length = float(
                cell.bands[path.number].length(pose[path.leg, path.cell % 2], cell.lever)
            )
            assert math.dist(p, q) == pytest.approx(length, abs=1e-12)


def test_levers_stay_on_the_joints_of_both_blocks():
    layout = made("robot-forward").layout
    joints = {}
    for one in layout.fasteners:
        if one.joint and one.use == "pin" and not one.upright:
            joints.setdefault(one.joint, []).append(one)
    for pose in random_poses(layout, 10):
        for (cell, number), pins in joints.items():
            lever = f"{cell}.lever {number + 1}"
            for pin in pins:
                on_block = at(layout, str(pin.block), pin.centre, pose)
                on_lever = at(layout, lever, pin.centre, pose)
                assert on_lever == pytest.approx(on_block, abs=1e-12)


def test_links_stay_on_their_pivots_and_meet_at_the_foot():
    layout = made("robot-forward").layout
    apex = next(one for one in layout.fasteners if one.name == "left-foot-pin").centre
    for pose in random_poses(layout, 10):
        ends = [
            at(layout, body, apex, pose)
            for body in ("left.foot", "left.link front", "left.link rear")
        ]
        assert ends[1] == pytest.approx(ends[0], abs=1e-12)
        assert ends[2] == pytest.approx(ends[0], abs=1e-12)


def test_an_antenna_moves_its_anchor_by_the_displacement_of_the_design_at_full_swing():
    layout = made("robot-antennas").layout
    for antenna in layout.robot.antennas:
        (path,) = (b for b in layout.bands if b.bodies[0] == f"{antenna.name}.crank")
        rest, end = (
            at(layout, path.bodies[0], path.p, layout.pose(swings={antenna.name: swing}))
            for swing in (0.0, antenna.swing)
        )
        side = layout.robot.leg(antenna.leg).side
        assert end - rest == pytest.approx((0.0, side * antenna.moves[0]), abs=1e-9)


def test_a_cord_keeps_its_length_within_a_tenth_of_a_millimetre():
    layout = made("robot-antennas").layout
    for cord in layout.cords:
        swing = layout.robot.antennas[0].swing
        lengths = []
        for angle in np.linspace(0.0, swing, 9):
            pose = layout.pose(swings={cord.antenna: angle})
            start, end = (
                at(layout, body, point, pose)
                for body, point in ((cord.hub, cord.start), (cord.crank, cord.end))
            )
            lengths.append(math.hypot(*(end - start), cord.end[2] - cord.start[2]))
        assert max(lengths) - min(lengths) < 1e-4


@pytest.mark.parametrize("name", NAMES)
def test_masses_centres_and_inertias_are_those_of_the_meshes(name):
    layout, density = made(name).layout, made(name).build_file.sheet.density
    for one in made(name).made.masses:
        bought = [fastener_solid(f) for f in layout.fasteners if f.block == one.body]
        bought += [solid for _, solid in box_solids(layout, one.body)]
        meshes = []
        for part in layout.parts:
            if layout.body[part.name] == one.body:
                mesh = trimesh.Trimesh(*part_mesh(layout, part, 1e-6), process=False)
                assert mesh.is_watertight and mesh.volume > 0.0
                mesh.density = density
                meshes.append(mesh)
        mass = sum(m.mass for m in meshes) + sum(b.mass for b in bought)
        centre = sum(m.mass * m.center_mass for m in meshes) + sum(
            b.mass * b.centre for b in bought
        )
        assert one.mass == pytest.approx(mass, rel=1e-4)
        assert one.centre == pytest.approx(centre / mass, abs=5e-5)
        inertia = np.zeros((3, 3))
        rows = [(m.mass, m.center_mass, m.moment_inertia) for m in meshes]
        for m, c, i in [*rows, *((b.mass, b.centre, b.inertia) for b in bought)]:
            away = c - one.centre
            inertia += i + m * (away @ away * np.eye(3) - np.outer(away, away))
        assert one.inertia == pytest.approx(inertia, abs=1e-3 * np.abs(inertia).max())


def test_masses_are_within_a_few_grams_of_the_swept_study():
    # FIELD study, acrylic: body 174 g with actuator, middle block with slider 23.2, outer block
    # 6.8, carriage 19.5, foot and links 5.5, total 270. Here the carriage has the rod and its
    # bracket, and the middle block has steel pins and hooks.
    parts = made("robot-forward").made

    def grams(*names):
        return 1e3 * sum(parts.of(f"left.{name}").mass for name in names)

    assert 1e3 * parts.of("body").mass == pytest.approx(174, abs=8)
    assert grams("inner.block", "slider") == pytest.approx(23.2, abs=5)
    assert grams("outer.block") == pytest.approx(6.8, abs=2)
    assert 1e3 * parts.of("carriage").mass == pytest.approx(19.5, abs=7)
    assert grams("foot", "link front", "link rear") == pytest.approx(5.5, abs=0.6)
    assert 1e3 * parts.mass == pytest.approx(270, abs=15)
    assert 1e3 * parts.centre[0] == pytest.approx(26, abs=4)


def test_the_robot_of_a_build_has_the_masses_of_its_parts_and_a_period_for_its_actuator():
    one = made("robot-antennas")
    assert one.robot.mass == pytest.approx(one.mass)
    assert one.robot.made is one.made
    # 80 mm of travel a cycle at 23 mm/s.
    assert one.robot.drive.period == pytest.approx(0.080 / 0.023)
    assert one.robot.foot.radius == one.build_file.robot.foot_radius


def test_feet_and_supports_stand_on_one_floor_with_the_preload_depth_of_the_design():
    layout = made("robot-forward").layout
    floor = layout.plan.heights.floor
    foot = layout.robot.foot
    sole = -float(foot.depth(0.0)) - layout.build_file.robot.foot_radius
    assert floor - sole == pytest.approx(foot.below)
    heads = [one for one in layout.fasteners if one.use == "head" and "support" in one.name]
    assert [one.low for one in heads] == pytest.approx([floor] * 3)
    assert sorted(one.centre for one in heads) == sorted(layout.robot.body.supports)


def test_an_upright_part_is_drawn_upright():
    layout = made("robot-forward").layout
    place = layout.places["left-link-front"]
    ends = in_robot(np.array([[0.0, 0.0, 0.0], [layout.robot.foot.link, 0.0, 0.0]]), place)
    assert ends[0] == pytest.approx((0.028, 0.0, 0.0))
    assert ends[1] == pytest.approx((0.008, 0.0, -float(layout.robot.foot.depth(0.0))))


@pytest.mark.parametrize("material", ["acrylic-3mm", "plywood-3mm"])
def test_every_part_has_a_body_of_the_robot(material):
    layout = robot_layout(sw.preset("robot-antennas"), load_build_file(material))
    known = set(sw.robot.body_names(layout.robot))
    owners = {*layout.body.values(), *(f.block for f in layout.fasteners)}
    assert owners | {b.body for b in layout.boxes} == known


def test_bands_of_one_cell_lie_one_above_the_other_on_hooks_of_their_own():
    robot = sw.preset("robot-forward")
    assert isinstance(robot, sw.Robot)
    inner, outer = robot.legs[0].chain.levers
    one, two = outer.bands[0], replace(outer.bands[0], p=(-0.010, -0.005), q=(0.020, 0.005))
    chain = replace(robot.legs[0].chain, cells=(inner, replace(outer, band=(one, two))))
    layout = robot_layout(
        replace(robot, legs=[replace(leg, chain=chain) for leg in robot.legs]),
        load_build_file("acrylic-3mm"),
    )
    first, second = (band for band in layout.bands if band.leg == "left" and band.cell == 1)
    assert second.low - first.high == pytest.approx(1e-3)
    hooks = {fast.name: fast for fast in layout.fasteners if fast.use == "hook"}
    for band in (first, second):
        for name, at in zip(band.holes, (band.p, band.q), strict=True):
            assert hooks[name].centre == pytest.approx(at, abs=1e-9)
            assert hooks[name].high > second.high
