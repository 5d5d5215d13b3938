"""The small motions of the gallery are Python's own, and every design has one."""

import builtins
from functools import cache
from typing import Any

import numpy as np
import pytest

import stepwell as sw
from stepwell.base import ExtraError, display_unit
from stepwell.files import loads_tables, preset_text, presets, tables_in
from stepwell.mechanism import Chain
from stepwell.robot import Robot
from stepwell.statics import EventKind
from stepwell.studio import gallery
from stepwell.studio.aside import answered
from stepwell.studio.message import Message, packed, unpacked
from stepwell.studio.motion import arrays_of, cells_of, drawn
from studio.pages import Answer

CHAINS = [name for name in presets() if not name.startswith("robot-")]
ROBOTS = [name for name in presets() if name.startswith("robot-")]


def listed() -> list[dict[str, Any]]:
    return unpacked(answered(Message("gallery", 1)))[0]["designs"]


@cache
def motions() -> dict[str, Answer]:
    """Every motion computed now, as the page reads it."""
    views = {name: gallery.moving(name, tables_in(preset_text(name))) for name in presets()}
    return {name: Answer(*unpacked(packed("", 1, view))) for name, view in views.items()}


def test_the_gallery_is_in_groups_by_what_designs_are():
    groups = [one["group"] for one in listed()]
    assert list(dict.fromkeys(groups)) == ["paper", "further", "elements", "robots"]
    assert groups == sorted(groups, key=["paper", "further", "elements", "robots"].index)
    for one in listed():
        design = sw.preset(one["name"])
        assert (one["group"] == "robots") == isinstance(design, Robot)
        if isinstance(design, Chain):
            assert (one["group"] == "elements") == bool(design.elements)
            assert (one["group"] == "paper") == one["name"].startswith("paper-")


def test_the_list_has_one_motion_a_design_and_all_are_small():
    header, blocks = unpacked(answered(Message("gallery", 1)))
    assert all(one["motion"]["name"] == one["name"] for one in header["designs"])
    assert {key.split("/")[0] for key in blocks} == set(presets())
    assert sum(block.nbytes for block in blocks.values()) < 350e3


@pytest.mark.parametrize("name", CHAINS)
def test_the_motions_of_the_package_are_those_computed_now(name: str):
    stored = gallery.motions().get(name)
    assert stored is not None, "the design was changed: run `make motions`"
    header, blocks = motions()[name]
    assert _rounded(stored.header) == _rounded({key: header[key] for key in stored.header})
    for key, block in stored.blocks.items():
        np.testing.assert_allclose(block, blocks[key], atol=1e-4, rtol=1e-6)


def _rounded(value: Any) -> Any:
    """With nine digits of each float: other processors round the last ones otherwise."""
    if isinstance(value, dict):
        return {key: _rounded(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [_rounded(part) for part in value]
    return float(f"{value:.9g}") if isinstance(value, float) else value


@pytest.mark.parametrize("name", CHAINS)
def test_every_sample_of_a_small_motion_is_on_the_path(name: str):
    file = loads_tables(tables_in(preset_text(name)))
    chain, written = file.subject, file.program
    assert isinstance(chain, Chain)
    result = chain.cycle() if written is None else written.on(chain)
    header, blocks = motions()[name]
    arrays = arrays_of(drawn(result.path))
    whole = np.column_stack([arrays["drive"], arrays["direction"], arrays["travel"]])
    few = np.column_stack([blocks["drive"], blocks["direction"], blocks["travel"]])
    rows = _in_order(few, whole)
    np.testing.assert_array_equal(whole[rows], few)
    np.testing.assert_array_equal(arrays["segment"][rows], blocks["segment"])
    assert (rows[0], rows[-1]) == (0, len(whole) - 1)
    assert header["sequence"] == str(result.sequence)
    assert header["cells"] == cells_of(chain, range(len(chain)))


def _in_order(few: np.ndarray[Any, Any], whole: np.ndarray[Any, Any]) -> list[int]:
    """The rows of the whole that are the few, one after another."""
    rows, at = list[int](), 0
    for one in few[:-1]:
        at += int(np.argmax((whole[at:] == one).all(axis=1)))
        rows.append(at)
    return [*rows, len(whole) - 1]


@pytest.mark.parametrize("name", CHAINS)
def test_between_two_samples_there_is_a_snap_or_a_small_step(name: str):
    header, blocks = motions()[name]
    snaps = {event["sample"] for event in header["events"]}
    full = [cell["full_travel_mm"] for cell in header["cells"]]
    steps = np.abs(np.diff(blocks["travel"], axis=0) / full).max(axis=1)
    for k, step in enumerate(steps):
        if k in snaps:
            assert blocks["segment"][k] != blocks["segment"][k + 1]
        else:
            assert step < 0.25


@pytest.mark.parametrize("name", CHAINS)
def test_every_snap_of_the_path_is_seen(name: str):
    file = loads_tables(tables_in(preset_text(name)))
    chain, written = file.subject, file.program
    assert isinstance(chain, Chain)
    path = (chain.cycle() if written is None else written.on(chain)).path
    header, blocks = motions()[name]
    snaps = [event for event in path.events if event.kind is EventKind.SNAP]
    assert len(header["events"]) == len(snaps)
    unit = display_unit(chain.measure.travel_unit)[1]
    for one, snap in zip(header["events"], snaps, strict=True):
        for k, travels in ((one["sample"], snap.before), (one["sample"] + 1, snap.after)):
            of_snap = blocks["travel"][k, list(snap.cells)]
            np.testing.assert_allclose(of_snap, np.array(travels) * unit, rtol=1e-6, atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("name", ROBOTS)
def test_a_robot_walks_as_its_simulation_does(name: str):
    pytest.importorskip("mujoco")
    from stepwell.simulation import walk
    from stepwell.studio.scene import Scene

    robot = sw.preset(name)
    assert isinstance(robot, Robot)
    scene, answer = Scene(robot), walk(robot, 2.0)
    header, blocks = motions()[name]
    assert {key: header[key] for key in ("parts", "lines")} == scene.shape()
    whole = scene.placed(answer.positions)
    for k, place in enumerate(blocks["place"]):
        (row,) = np.flatnonzero((whole["place"] == place).all(axis=(1, 2)))
        np.testing.assert_array_equal(whole["turn"][row], blocks["turn"][k])
        assert answer.time[row] >= answer.time[-1] - robot.drive.period
    for leg in robot.legs:
        assert str(leg.chain.cycle().sequence) in header["sequence"]


def test_without_the_simulator_a_robot_of_the_page_shows_its_first_leg(
    monkeypatch: pytest.MonkeyPatch,
):
    imported = builtins.__import__

    def none_of_it(name: str, *rest: Any, **more: Any) -> Any:
        if name in ("stepwell.simulation", "stepwell.studio.scene"):
            raise ExtraError("not installed", name="mujoco")
        return imported(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", none_of_it)
    view = gallery.moving("own", tables_in(preset_text("robot-forward")))
    robot = sw.preset("robot-forward")
    assert isinstance(robot, Robot)
    assert view.header["cells"] == cells_of(robot.legs[0].chain, range(len(robot.legs[0].chain)))
    assert view.blocks["travel"].shape[1] == len(robot.legs[0].chain)


def test_thumbnails_take_no_question():
    ask = {"designs": [{"name": "x", "design": {}}], "name": "x"}
    problem = unpacked(answered(Message("thumbnails", 1, None, ask)))[0]["problems"][0]
    assert "unknown key" in problem["text"]
