"""Files of a robot for other programs, opened there."""

import logging
import re
import subprocess
import sys
from dataclasses import replace
from functools import cache
from importlib import import_module
from pathlib import Path
from xml.etree import ElementTree as Xml

import numpy as np
import pytest

import stepwell as sw
from robot import robots
from robot.made import parts
from simulation.robots import explorer, robot, walked
from stepwell.robot import Drive, Profile, Robot, with_parts
from stepwell.simulation import (
    Linkage,
    Settings,
    control_script,
    exchange,
    exports,
    mujoco,
    sdf,
    spec,
)
from stepwell.simulation.live import LiveParts


def into(folder: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, "utf-8")
    return folder


@pytest.mark.slow
def test_the_script_of_the_folder_walks_like_ours_and_needs_no_stepwell(tmp_path):
    way = walked(0.020, 0.020)
    into(tmp_path, exchange(way.robot))
    script = (tmp_path / "walk.py").read_text()
    assert set(re.findall(r"^(?:from|import) (\w+)", script, re.M)) <= {
        *("argparse", "itertools", "pathlib", "typing", "mujoco", "numpy")
    }
    words = [sys.executable, "-I", "walk.py", "--headless", "--cycles", "2"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=True)
    advance = [float(number) for number in re.findall(r"advance (\S+) u_max", done.stdout)]
    # The file has six digits of each number.
    assert advance == pytest.approx(way.advance[:2].tolist(), abs=2e-3)
    assert len(advance) == 2 and advance[0] > 0.5


@pytest.mark.parametrize("profile", list(Profile))
def test_the_command_in_the_model_is_that_of_the_drive(profile):
    drive = Drive(profile=profile)
    model = mujoco.MjModel.from_xml_string(exchange(robot(drive=drive))["robot.xml"])
    phase = np.linspace(0.0, 1.0, 1001)
    command = np.interp(phase, model.numeric("phase").data, model.numeric("stroke").data)
    assert command == pytest.approx(drive.stroke(phase * drive.period), abs=5e-6)
    assert model.numeric("phase").size <= (257 if profile is Profile.SINE else 6)


@pytest.fixture
def with_a_mesh(monkeypatch):
    """The model has a tetrahedron far from its body's origin, which MuJoCo moves and turns."""

    def meshed(*given):
        model = spec(*given)
        corners = [0.1, 0, 0, 0.11, 0, 0, 0.1, 0.02, 0, 0.1, 0, 0.031]
        faces = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]
        model.add_mesh(name="left.inner block", uservert=corners, userface=faces)
        model.body("carriage").add_geom(
            type=mujoco.mjtGeom.mjGEOM_MESH,
            meshname="left.inner block",
            pos=(0.0, 0.0, 0.05),
            mass=0.0,
            contype=0,
            conaffinity=0,
        )
        return model

    monkeypatch.setattr(exports, "spec", meshed)
    return np.array([[0.1, 0, 0], [0.11, 0, 0], [0.1, 0.02, 0], [0.1, 0, 0.031]])


def test_meshes_are_files_that_both_formats_place_alike(tmp_path, with_a_mesh):
    files = exchange(robot())
    into(tmp_path, files)
    name = "meshes/left.inner-block.obj"
    written = [line.split()[1:] for line in files[name].splitlines() if line.startswith("v ")]
    corners = np.array(written, float)
    assert corners == pytest.approx(with_a_mesh, abs=1e-7)
    assert "vertex=" not in files["robot.xml"] and f'file="{name}"' in files["robot.xml"]
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "robot.xml"))
    geom = int(np.flatnonzero(model.geom_dataid >= 0)[0])
    turn = np.empty(9)
    mujoco.mju_quat2Mat(turn, model.geom_quat[geom])
    placed = model.mesh_vert @ turn.reshape(3, 3).T + model.geom_pos[geom]
    assert {tuple(one) for one in np.round(placed, 6)} == {
        tuple(one) for one in np.round(np.add(with_a_mesh, [0, 0, 0.05]), 6)
    }
    tree = Xml.fromstring(files["robot.sdf"])
    [visual] = [one for one in tree.iter("visual") if one.find("geometry/mesh") is not None]
    assert visual.findtext("geometry/mesh/uri") == name
    pose = [float(number) for number in (visual.findtext("pose") or "").split()]
    assert pose == pytest.approx([0, 0, 0.05, 0, 0, 0, 1], abs=1e-7)


def drake(given: str | Path, caplog):
    """The plant that Drake reads, with Gazebo's parser, and the messages of this parser."""
    why = "Drake reads SDF files, where it can be installed"
    parsing = pytest.importorskip("pydrake.multibody.parsing", reason=why)
    plant = import_module("pydrake.multibody.plant").MultibodyPlant(1e-3)
    with caplog.at_level(logging.INFO):
        if isinstance(given, Path):
            parsing.Parser(plant).AddModels(str(given))
        else:
            parsing.Parser(plant).AddModelsFromString(given, "sdf")
    own = "Ignoring unsupported SDFormat element"
    return plant, [one.getMessage() for one in caplog.records if own not in one.getMessage()]


def test_gazebos_parser_reads_every_link_and_joint_without_a_remark(caplog):
    one, arena = explorer(), sw.load_arena("three-walls")
    text = sdf(one, arena)
    plant, remarks = drake(text, caplog)
    assert remarks == []
    model = spec(one, arena, Settings(linkage=Linkage.HINGES)).compile()
    robot = plant.GetModelInstanceByName(one.title or "robot")
    around = plant.GetModelInstanceByName("surroundings")
    moving = int((model.body_rootid == model.body("body").id).sum())
    carriers = text.count('.carrier">')
    assert len(plant.GetBodyIndices(robot)) == moving + carriers
    assert len(plant.GetBodyIndices(around)) == 1 + len(arena.walls) + len(arena.cylinders)
    # Every joint but that of the body to the world, and one for each loop.
    loops = int((model.eq_type == mujoco.mjtEq.mjEQ_CONNECT).sum())
    assert len(plant.GetJointIndices(robot)) == model.njnt - 1 + loops
    assert loops == 12


def test_gazebos_parser_refuses_an_element_that_sdf_lacks(caplog):
    text = sdf(robot()).replace("max_step_size>", "largest_step>")
    with pytest.raises(RuntimeError, match=r"largest_step.* not defined in SDF"):
        drake(text, caplog)


def test_drake_has_every_link_where_mujoco_has_it_and_as_heavy(caplog):
    one = explorer()
    tree = Xml.fromstring(sdf(one))
    robot = tree.find("world/model")
    assert robot is not None
    # Drake moves trees only: without its closing joints the robot is one.
    for joint in [joint for joint in robot.iter("joint") if joint.get("type") == "ball"]:
        robot.remove(joint)
    plant, _ = drake(Xml.tostring(tree, encoding="unicode"), caplog)
    plant.Finalize()
    context = plant.CreateDefaultContext()
    model = spec(one, None, Settings(linkage=Linkage.HINGES)).compile()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    name = robot.attrib["name"]
    where = plant.GetModelInstanceByName(name)
    for body in range(1, model.nbody):
        frame = plant.GetBodyByName(model.body(body).name, where)
        pose = plant.EvalBodyPoseInWorld(context, frame)
        assert pose.translation() == pytest.approx(data.xpos[body], abs=1e-7)
        assert pose.rotation().matrix().ravel() == pytest.approx(data.xmat[body], abs=1e-7)
        assert frame.get_mass(context) == pytest.approx(model.body_mass[body], rel=1e-6)
    centre = plant.CalcCenterOfMassPositionInWorld(context, [where])
    assert centre == pytest.approx(data.subtree_com[model.body("body").id], abs=1e-5)


def test_links_with_two_parents_close_the_loops_that_a_urdf_cannot_have():
    tree = Xml.fromstring(sdf(robot()))
    children = [joint.findtext("child") for joint in tree.iter("joint")]
    closed = {name for name in children if children.count(name) > 1}
    assert closed >= {"left.link.in", "left.link.out", "right.inner.lever.front"}


def test_bands_and_the_lever_of_an_antenna_are_in_the_sdf():
    tree = Xml.fromstring(sdf(explorer()))
    bands = {one.get("name"): one for one in tree.iter("{urn:stepwell}band")}
    assert set(bands) == {
        f"{leg}.{cell}.band" for leg in ("left", "right") for cell in ("inner", "outer")
    }
    inner = bands["left.inner.band"]
    assert float((inner.findtext("{urn:stepwell}stiffness") or "").split()[0]) == 58.75
    assert float(inner.findtext("{urn:stepwell}rest_length") or "") == pytest.approx(0.022)
    assert len(inner.findall("{urn:stepwell}end")) == 2
    mimics = {one.get("name"): one.find("axis/mimic") for one in tree.iter("joint")}
    follower = mimics["left.anchor.joint"]
    assert follower is not None and follower.get("joint") == "left.antenna.joint"
    gear = explorer().antennas[0].gear
    assert float(follower.findtext("multiplier") or "") == pytest.approx(gear)


@cache
def made() -> Robot:
    """A robot with antennas made of parts."""
    one = robots.explorer()
    return with_parts(one, parts(one))


def test_a_robot_made_of_parts_is_exported_with_every_part(tmp_path, caplog):
    one, files = made(), exchange(made())
    assert one.made is not None
    into(tmp_path, files)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "robot.xml"))
    assert model.nmesh == len(one.made.shapes) == sum(name.endswith(".obj") for name in files)
    whole = spec(one).compile()
    assert model.geom_pos == pytest.approx(whole.geom_pos, abs=2e-6)
    assert model.body_mass == pytest.approx(whole.body_mass, rel=1e-5)
    # Faces stay flat: every corner has the normal of its face.
    assert model.nmeshnormal == whole.nmeshnormal
    plant, remarks = drake(tmp_path / "robot.sdf", caplog)
    assert remarks == []
    place = plant.GetModelInstanceByName(one.title or "robot")
    hinged = spec(one, None, Settings(linkage=Linkage.HINGES)).compile()
    moving = (hinged.body_rootid == hinged.body("body").id).sum()
    assert len(plant.GetBodyIndices(place)) == moving + files["robot.sdf"].count('.carrier">')
    seen = {shape.part for shape in one.made.shapes if not shape.collides}
    assert all(f'{part}"' in files["robot.sdf"] for part in seen)


def test_the_script_moves_parts_that_are_only_drawn_as_our_pictures_do(tmp_path):
    into(tmp_path, exchange(made()))
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "robot.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    for step in range(1200):
        data.ctrl[0] = control_script.stroke(model, step * 0.001)
        mujoco.mj_step(model, data)
    mujoco.mj_kinematics(model, data)
    control_script.Followers(model).update(data)
    poses = data.mocap_pos.copy(), data.mocap_quat.copy()
    LiveParts(model).update(data)
    assert len(poses[0]) > 4
    assert poses[0] == pytest.approx(data.mocap_pos, abs=1e-9)
    same = np.abs(np.sum(poses[1] * data.mocap_quat, axis=1))
    assert same == pytest.approx(1.0, abs=1e-9)


def test_a_loose_antenna_follows_nothing():
    one = explorer()
    loose = tuple(replace(antenna, connected=False) for antenna in one.antennas)
    assert "<mimic" not in sdf(replace(one, antennas=loose))
