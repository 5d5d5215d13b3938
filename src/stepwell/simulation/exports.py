"""Robots for other programs: MJCF with a control script, SDF, and meshes."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as Xml

import numpy as np

from stepwell.base import Floats
from stepwell.robot import Arena, Drive, Robot
from stepwell.simulation.model import spec
from stepwell.simulation.sdf import sdf_text
from stepwell.simulation.simulator import Linkage, Model, Settings, Spec, mujoco

SCRIPT = "control_script.py"  # the source of walk.py, in this folder
SAMPLES = 256  # of one cycle of a command; corners of all piecewise linear profiles are among them


def mjcf(robot: Robot, arena: Arena | None = None, settings: Settings | None = None) -> str:
    """The model as MJCF, which MuJoCo's own viewer opens; arguments and errors as for `spec`.

    A second keyframe, "settled", is the position after `settings.settle`; from it the first cycle
    is like the next ones. The custom fields "phase" and "stroke" are the command of one cycle.
    """
    return _walking(robot, arena, settings or Settings()).to_xml()


def sdf(robot: Robot, arena: Arena | None = None, settings: Settings | None = None) -> str:
    """The model as a world in SDF 1.11, for Gazebo and Drake; arguments and errors as for `spec`.

    Levers and links are bodies on hinges, whose loops are closed by ball joints. Meshes are files
    in `meshes/`. SDF has no elastic bands: they are written as elements of an own namespace.
    """
    hinged = replace(settings or Settings(), linkage=Linkage.HINGES)
    compiled = spec(robot, arena, hinged).compile()
    return sdf_text(compiled, _at_start(compiled), mesh_files(compiled), robot.title or "robot")


def exchange(
    robot: Robot, arena: Arena | None = None, settings: Settings | None = None
) -> dict[str, str]:
    """Files of a robot for other programs, as text by name; arguments and errors as for `spec`.

    `robot.xml` is the MJCF, `walk.py` a script that walks it in MuJoCo, `robot.sdf` the SDF, and
    `meshes/` contains the meshes of both as OBJ files.
    """
    settings = settings or Settings()
    model = _walking(robot, arena, settings)
    compiled = model.compile()
    files = mesh_files(compiled)
    return {
        "robot.xml": _with_files(model.to_xml(), files),
        "walk.py": Path(__file__).with_name(SCRIPT).read_text("utf-8"),
        "robot.sdf": sdf(robot, arena, settings),
        **{file: obj(compiled, number) for number, file in enumerate(files.values())},
    }


def mesh_files(model: Model) -> dict[str, str]:
    """The file of each mesh of a model, by the mesh's name, in the model's order."""
    names = [model.mesh(i).name for i in range(model.nmesh)]
    return {name: f"meshes/{re.sub(r'[^A-Za-z0-9.-]+', '-', name)}.obj" for name in names}


def obj(model: Model, number: int) -> str:
    """A mesh as an OBJ file [m], in the frame in which it was given to the model."""
    m = model
    # MuJoCo turns and moves a mesh into its principal axes.
    turn = np.empty(9)
    mujoco.mju_quat2Mat(turn, m.mesh_quat[number])
    back = turn.reshape(3, 3).T

    def part(values: Any, begin: Any, count: Any) -> Any:
        return values[begin[number] : begin[number] + count[number]]

    vertices = part(m.mesh_vert, m.mesh_vertadr, m.mesh_vertnum) @ back + m.mesh_pos[number]
    normals = part(m.mesh_normal, m.mesh_normaladr, m.mesh_normalnum) @ back
    corners = part(m.mesh_face, m.mesh_faceadr, m.mesh_facenum) + 1
    upright = part(m.mesh_facenormal, m.mesh_faceadr, m.mesh_facenum) + 1
    lines = [f"v {x:.8g} {y:.8g} {z:.8g}" for x, y, z in vertices]
    lines += [f"vn {x:.6g} {y:.6g} {z:.6g}" for x, y, z in normals]
    lines += [
        "f " + " ".join(f"{v}//{n}" for v, n in zip(face, own, strict=True))
        for face, own in zip(corners, upright, strict=True)
    ]
    return "\n".join(lines) + "\n"


def _walking(robot: Robot, arena: Arena | None, settings: Settings) -> Spec:
    """The model with the keyframe "settled" and the numbers of its command."""
    model = spec(robot, arena, settings)
    compiled = model.compile()
    data = _at_start(compiled)
    while data.time < settings.settle:
        mujoco.mj_step(compiled, data)
    model.add_key(name="settled", qpos=data.qpos)
    phase, stroke = _corners(robot.drive)
    numbers = {
        "period": [robot.drive.period],
        "settle": [settings.settle],
        "u_max": [robot.u_max],
        "phase": phase,
        "stroke": stroke,
    }
    for name, values in numbers.items():
        model.add_numeric(name=name, data=values, size=len(values))
    model.compile()
    return model


def _at_start(model: Model) -> Any:
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    return data


def _corners(drive: Drive) -> tuple[Floats, Floats]:
    """Phases [1] and strokes [m] of a cycle between which the command is linear."""
    phase = np.arange(SAMPLES + 1) / SAMPLES
    stroke = drive.stroke(phase * drive.period)
    bent = np.abs(np.diff(stroke, 2)) > 1e-9 * drive.amplitude
    kept = np.concatenate([[True], bent, [True]])
    return phase[kept], stroke[kept]


def _with_files(text: str, files: dict[str, str]) -> str:
    """The MJCF with its meshes in files, instead of in the text."""
    if not files:
        return text
    tree = Xml.fromstring(text)
    for mesh in tree.iter("mesh"):
        for part in ("vertex", "normal", "face", "facenormal"):
            mesh.attrib.pop(part, None)
        mesh.set("file", files[mesh.attrib["name"]])
    return Xml.tostring(tree, encoding="unicode") + "\n"
