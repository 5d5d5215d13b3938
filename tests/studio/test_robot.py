"""What the page is told of robots is what Python says of them."""

import json
from typing import Any

import numpy as np
import pytest

pytest.importorskip("mujoco")

import stepwell as sw
from stepwell import files
from stepwell.accounts import account
from stepwell.studio.aside import LONG, answer
from stepwell.studio.ask import Ask, PageDesign, View
from stepwell.studio.standalone import replay
from studio.test_panels import ask, tables

WALL = {"from_mm": [180, -120], "to_mm": [330, 120], "thickness_mm": 20}
SMALL = {"start_mm": [0, 0], "wall": [WALL], "goal": {"at_mm": [150, 0], "radius_mm": 60}}


def run(kind: str, design: str, **keys: Any) -> tuple[dict[str, Any], dict[str, Any], list[View]]:
    """The last answer of a run with the samples of all of them, and what was shown before."""
    shown: list[View] = []
    last = answer(kind, PageDesign(tables(design)), Ask(keys, show=shown.append))
    parts = [*shown, last]
    blocks = {name: np.concatenate([one.blocks[name] for one in parts]) for name in last.blocks}
    return as_told(last.header), blocks, parts


def as_told(record: Any) -> Any:
    return json.loads(json.dumps(record))


@pytest.mark.slow
def test_a_walk_is_pythons_number_by_number():
    header, blocks, _ = run("walk", "robot-forward", cycles=2)
    walk = sw.preset("robot-forward").walk(2)
    assert header["record"] == as_told(account(walk).record)
    np.testing.assert_array_equal(blocks["time"], walk.time)
    np.testing.assert_array_equal(blocks["x"], walk.x * 1e3)
    np.testing.assert_array_equal(blocks["yaw"], np.degrees(walk.yaw))
    np.testing.assert_array_equal(blocks["foot_force"], walk.foot_force)
    for k, leg in enumerate(walk.robot.legs):
        for sample in range(0, len(walk.time), 7):
            state = walk.state(leg.name, walk.time[sample])
            code = -1 if state is None else int(state, 2)
            assert blocks["state"][sample, k] == code


@pytest.mark.slow
def test_a_maze_is_pythons_and_its_antennas_move_their_anchors():
    header, blocks, _ = run("maze", "robot-explorer", arena=SMALL, limit_s=12)
    robot = sw.preset("robot-explorer")
    maze = robot.maze(files.loads_arena_tables(SMALL), limit=12)
    assert header["record"] == as_told(account(maze).record)
    assert header["outcome"] == maze.ending
    assert maze.contacts
    gear = robot.antennas[0].gear
    np.testing.assert_allclose(blocks["moved"][:, 0], maze.walk.antenna[:, 0] * gear * 1e3)


@pytest.mark.slow
def test_what_is_known_of_a_run_is_shown_once_and_in_order(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("stepwell.studio.scene._EVERY", 0.0)
    _, blocks, parts = run("walk", "robot-forward", cycles=2)
    assert len(parts) > 3
    counts = np.cumsum([0, *(len(one.blocks["time"]) for one in parts)])
    assert [one.header["first"] for one in parts] == counts[:-1].tolist()
    monkeypatch.setattr("stepwell.studio.scene._EVERY", 1e9)
    _, at_once, parts = run("walk", "robot-forward", cycles=2)
    assert len(parts) == 1
    for name, block in at_once.items():
        np.testing.assert_array_equal(blocks[name], block, err_msg=name)


@pytest.mark.parametrize("name", ["robot-forward", "robot-explorer"])
def test_the_robot_stands_where_its_simulation_starts(name: str):
    arena = {"start_mm": [100, -50], "heading_deg": 90}
    header, blocks = ask("robot", tables(name), arena=arena)
    robot = sw.preset(name)
    assert [leg["name"] for leg in header["legs"]] == [leg.name for leg in robot.legs]
    assert [one["name"] for one in header["antennas"]] == [one.name for one in robot.antennas]
    assert blocks["place"][0, 0, :2] == pytest.approx([100, -50])
    assert blocks["turn"][0, 0] == pytest.approx([np.sqrt(0.5), 0, 0, np.sqrt(0.5)])
    bands = [(one["leg"], one["cell"]) for one in header["lines"] if one["cell"] is not None]
    assert sorted(bands) == [(0, 0), (0, 1), (1, 0), (1, 1)]
    assert all(part["body"] < blocks["place"].shape[1] for part in header["parts"])


def test_a_prediction_is_pythons_and_blocks_no_other_request():
    header = ask("predict", tables("robot-forward")).header
    robot = sw.preset("robot-forward")
    prediction = robot.predict()
    assert header["motion"] == str(prediction.motion.value)
    assert header["record"] == as_told(account(prediction).record)
    assert {"predict", "walk", "maze"} <= LONG
    assert "robot" not in LONG


def test_arenas_are_listed_opened_and_written():
    listed = ask("arenas").header["arenas"]
    assert {one["name"]: one["title"] for one in listed} == files.arenas()
    for name in files.arenas():
        opened = ask("arena", name=name).header["arena"]
        assert files.loads_arena_tables(opened) == files.load_arena(name)
        assert ask("arena", text=files.arena_text(name)).header["arena"] == opened
        written = ask("arena", arena=opened).header["toml"]
        assert files.loads_arena(written) == files.load_arena(name)


@pytest.mark.parametrize("name", ["/etc/passwd", "../arenas/pen", "pen.txt", ""])
def test_a_path_is_no_name_of_an_arena(name: str):
    assert "no such arena" in ask("arena", name=name).header["problems"][0]["text"]


@pytest.mark.parametrize(
    ("kind", "keys", "said"),
    [
        ("maze", {}, "ask.arena: is missing"),
        ("maze", {"arena": 3}, "ask.arena = 3: must be an object"),
        ("maze", {"arena": {"wall": [{"from_mm": [1, 2]}]}}, "wall[0].to_mm: is missing"),
        ("maze", {"arena": {"walls": []}}, "Did you mean wall?"),
        ("robot", {"arena": {"wall": [{**WALL, "to_mm": [180, -120]}]}}, "two different ends"),
        ("robot", {"arena": {"start_mm": None}}, "start_mm = null"),
        ("walk", {"cycles": 0}, "must be from 0.01 to 1000"),
        ("maze", {"arena": {}, "limit_s": 1e9}, "must be from 1 to 3600"),
        ("arena", {"text": ""}, "ask.text: is empty"),
        ("arena", {"text": "x" * 10}, "line 1"),
    ],
)
def test_what_cannot_be_is_reported_in_words(kind: str, keys: Any, said: str):
    header = ask(kind, tables("robot-forward"), **keys).header
    assert header["ok"] is False
    assert said in " ".join(one["text"] for one in header["problems"])


@pytest.mark.parametrize("kind", ["robot", "predict", "walk"])
def test_a_chain_is_no_robot(kind: str):
    problem = ask(kind, tables("paper-forward")).header["problems"][0]
    assert "this needs a robot" in problem["text"]


@pytest.mark.slow
def test_the_replay_of_a_run_is_pythons():
    def page(**keys: Any) -> str:
        view = answer("replay", PageDesign(tables("robot-explorer")), Ask(keys))
        return view.blocks["file"].tobytes().decode()

    robot = sw.preset("robot-explorer")
    assert page(cycles=1) == replay(robot.walk(1))
    arena = files.loads_arena_tables(SMALL)
    assert page(arena=SMALL, limit_s=3) == replay(robot.maze(arena, limit=3.0))
    # Without either it is the leg that moves.
    assert page() == replay(robot.legs[0].chain)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"limit_s": 3}, "ask.arena: is missing"),
        ({"cycles": 1e9}, "ask.cycles"),
        ({"cycles": 1, "turning_points_mm": [0, 1]}, "turning_points_mm': unknown key"),
    ],
)
def test_a_replay_that_cannot_be_is_refused(keys: dict[str, Any], words: str):
    with pytest.raises(ValueError, match=words):
        answer("replay", PageDesign(tables("robot-explorer")), Ask(keys))
