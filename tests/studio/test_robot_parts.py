"""The panel of a robot in its parts: solids and places are those of Python's build."""

import json
from functools import cache

import numpy as np
import pytest

import stepwell as sw
from facts import says
from stepwell.accounts import account
from stepwell.build import RobotBuild
from stepwell.files import preset_text, tables_in
from stepwell.studio.aside import answered
from stepwell.studio.ask import Ask, View
from stepwell.studio.message import Message, unpacked
from stepwell.studio.motion import drawn
from studio.pages import Answer

pytest.importorskip("manifold3d")

NAME = "robot-antennas"


@cache
def parts() -> Answer:
    return asked("robot_parts", NAME)


@cache
def made() -> RobotBuild:
    built = sw.build(sw.preset(NAME))
    assert isinstance(built, RobotBuild)
    return built


def asked(kind: str, name: str, leg: int = 0, ask: Ask | None = None, **keys: object) -> Answer:
    message = Message(kind, 1, tables_in(preset_text(name)), keys, leg)
    return Answer(*unpacked(answered(message, ask)))


def placed(k: int) -> np.ndarray:
    """All corners [mm] at a sample, as the page places them."""
    header, blocks = parts()
    owners = np.repeat(
        [one["body"] for one in header["parts"]], [one["corners"] for one in header["parts"]]
    )
    found = np.empty((len(owners), 3))
    for number, body in enumerate(header["bodies"]):
        rows = owners == number
        hinge, row = np.array(body["hinge_mm"]), blocks["moved"][k, number].astype(float)
        axes = [0, 2 if body["upright"] else 1]
        off = blocks["corners"][rows] - hinge
        c, s = np.cos(row[3]), np.sin(row[3])
        off[:, axes] = off[:, axes] @ np.array([[c, s], [-s, c]])
        found[rows] = off + hinge + row[:3]
    return found


def test_the_solids_are_the_drawn_shapes_of_the_build():
    header, blocks = parts()
    shapes = [one for one in made().made.shapes if not one.collides]
    names = [one["name"] for one in header["bodies"]]
    for one, shape in zip(header["parts"], shapes, strict=True):
        assert (one["name"], names[one["body"]]) == (shape.part, shape.body)
        assert one["role"] == shape.colour.value
    corners = np.concatenate([1e3 * one.vertices for one in shapes])
    np.testing.assert_allclose(blocks["corners"], corners, atol=1e-4)
    volume = np.linalg.det(blocks["corners"][blocks["triangles"]]).sum() / 6.0
    own = sum(np.linalg.det(one.vertices[one.faces]).sum() / 6.0 for one in shapes)
    assert volume == pytest.approx(1e9 * own, rel=1e-5)
    assert header["mass_g"] == pytest.approx(1e3 * made().mass)


@pytest.mark.parametrize("share", [0.0, 0.2, 0.45, 0.8])
def test_every_part_is_where_the_build_has_it_at_a_sample(share: float):
    layout = made().layout
    path = drawn(made().drawing.legs[0].chain.cycle().path)
    k = int(share * (len(path.drive) - 1))
    cells = enumerate(made().drawing.legs[0].chain.levers)
    angles = [float(cell.angle(path.travel[k, i])) for i, cell in cells]
    pose = layout.pose() | {
        (leg, i): angle for leg in ("left", "right") for i, angle in enumerate(angles)
    }
    frames, rest = layout.frames(pose), layout.frames(layout.pose())
    at, header, first = placed(k), parts().header, 0
    for one in header["parts"]:
        rows = slice(first, first + one["corners"])
        first = rows.stop
        if one["name"] not in frames:
            continue
        # In the frame of the part its corners are the same as at rest.
        seen = []
        for frame, corners in (
            (frames[one["name"]], at[rows]),
            (rest[one["name"]], parts().blocks["corners"][rows]),
        ):
            plane = corners[:, [0, 2 if frame.upright else 1]] - 1e3 * np.array((frame.x, frame.y))
            c, s = np.cos(frame.angle), np.sin(frame.angle)
            seen.append(plane @ np.array([[c, -s], [s, c]]))
        np.testing.assert_allclose(*seen, atol=1e-3, err_msg=one["name"])


def test_bands_end_at_their_hooks_and_have_the_length_and_tension_of_their_cells():
    blocks = parts().blocks
    lengths = np.hypot(*(blocks["ends"][:, :, 2:] - blocks["ends"][:, :, :2]).transpose(2, 0, 1))
    path = drawn(made().drawing.legs[0].chain.cycle().path)
    tensions = []
    for k, band in enumerate(made().layout.bands):
        cell = made().layout.cell(band)
        own = cell.bands[band.number]
        theta = cell.angle(path.travel[:, band.cell % 2])
        length = own.length(theta, cell.lever)
        # The crank of an antenna that is at rest holds the anchor where the design has it.
        np.testing.assert_allclose(lengths[:, k], 1e3 * length, atol=1e-3)
        tensions.append(own.tension(length))
    shares = np.stack(tensions, axis=1)
    np.testing.assert_allclose(blocks["tension"] * shares.max(), shares, rtol=2e-3)
    assert 0.9 < blocks["tension"].max() <= 1.0 + 1e-6


def test_legs_of_other_chains_are_at_the_same_stroke():
    for leg in (0, 1):
        header, blocks = asked("robot_parts", "robot-left", leg)
        robot = sw.preset("robot-left")
        assert isinstance(robot, sw.Robot)
        path = drawn(robot.legs[leg].chain.cycle().path)
        np.testing.assert_allclose(blocks["drive"], 1e3 * path.drive)
        moved = {one["name"]: -blocks["moved"][:, i, 0] for i, one in enumerate(header["bodies"])}
        for one in robot.legs:
            np.testing.assert_allclose(
                moved[f"{one.name}.{one.chain.names[1]}.block"], 1e3 * path.stroke, atol=0.3
            )


def test_the_record_of_the_whole_robot_is_that_of_the_command():
    shown: list[View] = []
    header, _ = asked("build", NAME, ask=Ask({"whole": True}, show=shown.append))
    assert shown[0].header == {"sweep": {"free": True}, "overlaps": []}
    record = json.loads(json.dumps(account(made()).record))
    for key in ("can_be_built", "parts", "bands", "findings", "notes"):
        assert header[key] == record[key], key


def test_a_robot_that_cannot_be_cut_is_refused_with_its_part():
    answer = asked("robot_parts", "robot-explorer")
    says(answer.header["problems"][0]["text"], "right-body-top", "openings", "Move")
    chain = asked("robot_parts", "paper-forward")
    says(chain.header["problems"][0]["text"], "needs a robot")
