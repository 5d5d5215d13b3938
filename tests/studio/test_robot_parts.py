"""The panel of a robot in its parts: solids and places are those of Python's build."""

import json
from functools import cache
from typing import Any

import numpy as np
import pytest

import stepwell as sw
from facts import says
from stepwell.accounts import account
from stepwell.build import MotionSweep, RobotBuild, RobotOverlap
from stepwell.files import preset_text, tables_in
from stepwell.mechanism.layout import greatest_tension
from stepwell.robot import body_names
from stepwell.studio.aside import answered
from stepwell.studio.ask import Ask, View
from stepwell.studio.message import Message, unpacked
from stepwell.studio.motion import drawn
from stepwell.studio.panels.parts import _robot_overlaps
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


def with_antennas(pressed: int) -> sw.Robot:
    """The robot with its antennas at rest or pressed."""
    robot = made().drawing
    return robot.pressed({one.name: pressed * one.swing for one in robot.antennas})


def greatest() -> float:
    """The greatest tension of any band [N]."""
    cells = [leg.chain.levers for k in (0, 1) for leg in with_antennas(k).legs]
    return max(greatest_tension(cell) for every in cells for cell in every)


def asked(kind: str, name: str, leg: int = 0, ask: Ask | None = None, **keys: object) -> Answer:
    message = Message(kind, 1, tables_in(preset_text(name)), keys, leg)
    return Answer(*unpacked(answered(message, ask)))


def at_sample(points: np.ndarray, body: int, k: int, pressed: int = 0) -> np.ndarray:
    """Points (m, 3) [mm] of a body at a sample, as the page places them."""
    header, blocks = parts()
    one = header["bodies"][body]
    hinge, row = np.array(one["hinge_mm"]), blocks["moved"][pressed, k, body].astype(float)
    axes = [0, 2 if one["upright"] else 1]
    off = points - hinge
    c, s = np.cos(row[3]), np.sin(row[3])
    off[:, axes] = off[:, axes] @ np.array([[c, s], [-s, c]])
    return off + hinge + row[:3]


def placed(k: int, pressed: int = 0) -> np.ndarray:
    """All corners [mm] at a sample."""
    header, blocks = parts()
    owners = np.repeat(
        [one["body"] for one in header["parts"]], [one["corners"] for one in header["parts"]]
    )
    found = np.empty((len(owners), 3))
    for number in range(len(header["bodies"])):
        rows = owners == number
        found[rows] = at_sample(blocks["corners"][rows], number, k, pressed)
    return found


def ends_of(line: dict[str, Any], k: int, pressed: int) -> np.ndarray:
    """The two ends (2, 3) [mm] of a band or a cord at a sample."""
    ends = zip(line["at_mm"], line["bodies"], strict=True)
    return np.concatenate([at_sample(np.array([at]), body, k, pressed) for at, body in ends])


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


@pytest.mark.parametrize(("share", "pressed"), [(0.0, 0), (0.2, 1), (0.45, 0), (0.8, 1)])
def test_every_part_is_where_the_build_has_it_at_a_sample(share: float, pressed: int):
    layout = made().layout
    robot = with_antennas(pressed)
    path = drawn(made().drawing.legs[0].chain.cycle().path)
    k = int(share * (len(path.drive) - 1))
    pose = layout.pose(swings={one.name: pressed * one.swing for one in robot.antennas})
    for leg in robot.legs:
        own = drawn(leg.chain.cycle().path)
        rows = own.direction == path.direction[k]
        near = rows.nonzero()[0][np.abs(own.drive[rows] - path.drive[k]).argmin()]
        for i, cell in enumerate(leg.chain.levers):
            # Legs at rest have the samples of the page, others lie between two of their own.
            travel = path.travel[k, i] if not pressed else own.travel[near, i]
            pose[leg.name, i] = float(cell.angle(travel))
    frames, rest = layout.frames(pose), layout.frames(layout.pose())
    at, header, first = placed(k, pressed), parts().header, 0
    for one in header["parts"]:
        rows = slice(first, first + one["corners"])
        first = rows.stop
        own_pose = not pressed or header["bodies"][one["body"]]["antenna"]
        if one["name"] not in frames or not own_pose:
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
        np.testing.assert_allclose(*seen, atol=0.3 if pressed else 1e-3, err_msg=one["name"])


@pytest.mark.parametrize("pressed", [0, 1])
def test_bands_end_at_their_hooks_and_have_the_length_and_tension_of_their_cells(pressed: int):
    header, blocks = parts()
    robot = with_antennas(pressed)
    for k in (0, 40, len(blocks["drive"]) - 40):
        for one, band in zip(header["bands"], made().layout.bands, strict=True):
            cell = robot.leg(band.leg).chain.levers[band.cell % 2]
            own = cell.bands[band.number]
            low, high = ends_of(one, k, pressed)
            length = np.hypot(*(high - low)[:2])
            # The crank of an antenna, at rest or pressed, holds the anchor where the design has it.
            lengths = own.length(np.linspace(-cell.limit, cell.limit, 4001), cell.lever)
            assert np.abs(1e3 * lengths - length).min() < 0.02
            tension = abs(float(own.tension(1e-3 * length)))
            shown = blocks["tension"][pressed, k, header["bands"].index(one)]
            assert shown * greatest() == pytest.approx(tension, rel=2e-3, abs=1e-4)
    assert 0.9 < blocks["tension"].max() <= 1.0 + 1e-6


def test_cords_run_from_the_hubs_of_antennas_to_their_cranks_and_keep_their_length():
    header, _ = parts()
    assert [one["name"] for one in header["cords"]] == ["cord of left", "cord of right"]
    for one, cord in zip(header["cords"], made().layout.cords, strict=True):
        rest, pressed = (ends_of(one, 0, k) for k in (0, 1))
        np.testing.assert_allclose(rest, 1e3 * np.array([cord.start, cord.end]), atol=1e-3)
        lengths = [np.linalg.norm(np.diff(ends, axis=0)) for ends in (rest, pressed)]
        assert lengths[1] == pytest.approx(lengths[0], rel=5e-3)
        assert np.linalg.norm(pressed[0] - rest[0]) > 4.0


def test_legs_of_other_chains_are_at_the_same_stroke():
    for leg in (0, 1):
        header, blocks = asked("robot_parts", "robot-left", leg)
        robot = sw.preset("robot-left")
        assert isinstance(robot, sw.Robot)
        path = drawn(robot.legs[leg].chain.cycle().path)
        np.testing.assert_allclose(blocks["drive"], 1e3 * path.drive)
        moved = {
            one["name"]: -blocks["moved"][0, :, i, 0] for i, one in enumerate(header["bodies"])
        }
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


def test_an_overlap_of_a_robot_has_the_places_of_all_bodies_at_its_deepest_pose():
    layout = made().layout
    pose = layout.pose({"left": "10", "right": "10"}, {"left": 1.0})
    hit = RobotOverlap(("rod", "left-crank"), 1e-3, (), (), tuple(pose.items()))
    built = sw.build(made().drawing, swept=MotionSweep(False, (hit,) * 13, (), (), 0, 0))
    assert isinstance(built, RobotBuild)
    first, *_, last = _robot_overlaps(built)
    assert first["parts"] == ("rod", "left-crank") and "moved" not in last
    moved = dict(zip(body_names(made().drawing), first["moved"], strict=True))
    assert moved["carriage"] == pytest.approx([-20.0, 0.0, 0.0, 0.0])
    assert moved["left.antenna"][3] == pytest.approx(made().drawing.antennas[0].side)
    assert abs(moved["left.crank"][3]) > 0.1 > abs(moved["right.crank"][3])


def test_a_robot_that_cannot_be_cut_is_refused_with_its_part():
    answer = asked("robot_parts", "robot-explorer")
    says(answer.header["problems"][0]["text"], "right-body-top", "left-stop-2", "antenna.moves_mm")
    chain = asked("robot_parts", "paper-forward")
    says(chain.header["problems"][0]["text"], "needs a robot")
