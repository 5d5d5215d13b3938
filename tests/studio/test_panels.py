"""What the page is told is what Python says, number by number."""

import json
from typing import Any

import numpy as np
import pytest

import stepwell as sw
from stepwell.files import DesignError, loads, loads_tables, preset_text, presets, tables_in
from stepwell.statics import EventKind
from stepwell.studio.answering import answered
from stepwell.studio.wire import Message, unpacked
from studio.pages import FORWARD, Answer

CHAINS = [name for name in presets() if not name.startswith("robot-")]


def ask(kind: str, design: Any = None, **keys: Any) -> Answer:
    """What a panel answers, through the wire and back."""
    design = json.loads(json.dumps(design, allow_nan=False))
    return Answer(*unpacked(answered(Message(kind, 1, design, keys))))


def tables(name: str) -> dict[str, Any]:
    return tables_in(preset_text(name))


def test_the_gallery_lists_what_comes_along():
    found = ask("gallery").header["designs"]
    assert {one["name"]: one["title"] for one in found} == presets()
    forward, robot = (
        next(o for o in found if o["name"] == n) for n in ("paper-forward", "robot-left")
    )
    assert (forward["kind"], forward["cells"]) == ("chain", 2)
    assert robot["kind"] == "robot"


@pytest.mark.parametrize("name", presets())
def test_a_design_of_the_gallery_opens(name: str):
    header = ask("open", preset=name).header
    assert header["title"] == presets()[name]
    assert loads_tables(header["design"])[0] == sw.preset(name)


def test_the_text_of_a_file_opens_and_a_wrong_one_is_told_as_by_a_command():
    text = preset_text("three-wave")
    assert ask("open", toml=text).header["design"] == tables_in(text)
    for wrong in (text.replace("q_mm", "q_mmm", 1), "[chain", ""):
        with pytest.raises(DesignError) as error:
            loads(wrong)
        problems = ask("open", toml=wrong).header["problems"]
        assert tuple(one["text"] for one in problems) == error.value.problems


@pytest.mark.parametrize(
    "keys", [{}, {"preset": "x", "toml": ""}, {"preset": 3}, {"path": "a.toml"}]
)
def test_opening_needs_a_name_or_a_text(keys: Any):
    assert ask("open", **keys).header["ok"] is False


@pytest.mark.parametrize("name", ["/etc/passwd", "../presets/paper-forward", "paper-forward.toml"])
def test_a_path_is_no_name_of_the_gallery(name: str):
    problem = ask("open", preset=name).header["problems"][0]
    assert "no such design" in problem["text"]


@pytest.mark.parametrize("name", CHAINS)
def test_file_and_script_make_the_same_chain(name: str):
    header = ask("text", tables(name)).header
    assert loads(header["toml"]) == sw.preset(name)
    made: dict[str, Any] = {}
    exec(header["python"].replace("print(chain.cycle())", ""), made)
    assert made["chain"] == sw.preset(name)


def test_a_design_keeps_its_program_as_text():
    assert "[program]" in ask("text", tables("combination-lock")).header["toml"]


@pytest.mark.parametrize("name", ["paper-forward", "friction", "three-wave", "countdown", "slack"])
def test_every_number_of_a_chain_of_levers_is_pythons(name: str):
    chain = sw.preset(name)
    cycle = chain.cycle()
    header, blocks = ask("evaluate", tables(name))
    assert header["sequence"] == str(cycle.sequence)
    assert header["pathway"] == (cycle.pathway.label if cycle.pathway else "")
    assert header["peak_force_N"] == cycle.peak_force
    assert header["dissipated_mJ"] == cycle.dissipated * 1e3
    assert header["full_stroke_mm"] == chain.full_stroke * 1e3
    path = cycle.path.resampled(_points(cycle.path, len(blocks["drive"])))
    for block, array in (
        ("drive", path.drive * 1e3),
        ("stroke", path.stroke * 1e3),
        ("force", path.force),
        ("energy", path.energy * 1e3),
        ("travel", path.travel * 1e3),
        ("segment", path.branch),
        ("direction", path.direction),
    ):
        np.testing.assert_array_equal(blocks[block], array, err_msg=block)
    for i, cell in enumerate(chain.levers):
        told = header["cells"][i]
        np.testing.assert_array_equal(
            blocks["angle"][:, i], np.degrees(cell.angle(path.travel[:, i]))
        )
        np.testing.assert_array_equal(
            blocks["landscape_energy"][:, i],
            cell.energy_at(np.linspace(0.0, cell.full_travel, 65)) * 1e3,
        )
        assert (told["force_0_N"], told["force_1_N"]) == (cell.force_0, cell.force_1)
        assert told["full_travel_mm"] == cell.full_travel * 1e3
        assert told["bands"][0]["q_mm"] == [x * 1e3 for x in cell.bands[0].q]
        assert (told["stable"] == [0, 1]) == cell.is_bistable


def _points(path: Any, size: int) -> int:
    return next(points for points in range(2, 34) if len(path.resampled(points).drive) == size)


@pytest.mark.parametrize(
    "name", ["paper-forward", "friction", "countdown", "balloon", "force-control"]
)
def test_every_event_is_pythons_and_lies_at_its_sample(name: str):
    chain = sw.preset(name)
    header, blocks = ask("evaluate", tables(name))
    events = chain.cycle().events
    assert len(header["events"]) == len(events)
    before = -1
    for told, event in zip(header["events"], events, strict=True):
        assert told["kind"] == event.kind.name.lower()
        assert told["cause"] == event.cause.name.lower()
        assert told["cells"] == list(event.cells)
        assert told["released_mJ"] == event.released * 1e3
        k = told["sample"]
        assert k >= before
        before = k
        assert blocks["drive"][k] == told["drive_mm"]
        if event.kind is EventKind.SNAP:
            # A jump between two samples, and never a piece of a curve.
            assert blocks["segment"][k] != blocks["segment"][k + 1]
            assert blocks["drive"][k] == blocks["drive"][k + 1]
            np.testing.assert_allclose(
                blocks["force"][k], told["force_before_N"], rtol=1e-9, atol=1e-9
            )
    jumps = np.count_nonzero(np.diff(blocks["segment"]))
    assert jumps >= sum(one["kind"] == "snap" for one in header["events"])


@pytest.mark.parametrize("name", ["paper-forward", "three-wave", "countdown"])
def test_margins_are_pythons(name: str):
    header = ask("evaluate", tables(name)).header
    margin = sw.margin(sw.preset(name))
    assert header["method"] == margin.method.name.lower() == "exact"
    for told, change in zip(header["margins"], margin.changes, strict=True):
        assert (told["cell"], told["what"]) == (change.cell, change.parameter)
        if change.parameter == "anchor" and isinstance(change.move, tuple):
            assert told["reach_mm"] == change.distance * 1e3
            assert told["move_mm"] == [x * 1e3 for x in change.move]
            assert told["becomes"] == change.becomes
        else:
            assert told["reach_percent"] == change.distance * 100
    assert header["margin"]["reach_mm"] == float(np.min(margin.anchors)) * 1e3


def test_a_margin_that_has_to_be_searched_is_asked_for_aside():
    assert ask("evaluate", tables("slack")).header["margins"] == []
    header = ask("margin", tables("slack")).header
    margin = sw.margin(sw.preset("slack"))
    assert header["method"] == "search"
    assert header["margin"]["reach_mm"] == float(np.min(margin.anchors)) * 1e3


@pytest.mark.parametrize(
    "name", ["balloon", "dome", "curved-beam", "kresling", "compliant-actuator"]
)
def test_elements_have_units_of_their_own_and_no_angles(name: str):
    header, blocks = ask("evaluate", tables(name))
    chain = sw.preset(name)
    for i, cell in enumerate(header["cells"]):
        assert np.isnan(blocks["angle"][:, i]).all() == (cell["kind"] == "element")
    units = ("mL", "kPa") if name == "balloon" else ("mm", "N")
    assert (header["units"]["travel"], header["units"]["force"]) == units
    assert len(blocks["drive"]) < 2500
    assert header["sequence"] == str(chain.cycle().sequence)


@pytest.mark.parametrize(
    ("key", "value", "at"),
    [
        ("q_mm", [20], "chain.cell[1].q_mm"),
        ("q_mmm", [20, 0], "chain.cell[1].q_mmm"),
        ("lever_mm", 0, "chain.cell[1].lever_mm"),
        ("friction_N", None, "chain.cell[1].friction_N"),
        ("table_csv", "secret.csv", "chain.cell[1].table_csv"),
        ("q_mm", [2e5, 0], "chain.cell[1].q_mm"),
    ],
)
@pytest.mark.parametrize("kind", ["evaluate", "text", "margin"])
def test_what_is_wrong_with_a_design_is_told_at_its_key(kind: str, key: str, value: Any, at: str):
    design = json.loads(json.dumps(FORWARD))
    design["chain"]["cell"][1][key] = value
    header = ask(kind, design).header
    with pytest.raises(DesignError) as error:
        loads_tables(design)
    assert tuple(one["text"] for one in header["problems"]) == error.value.problems
    assert header["problems"][0]["at"] == at


def test_robots_missing_designs_and_long_chains_are_refused_in_words():
    long = {"chain": FORWARD["chain"] | {"cell": FORWARD["chain"]["cell"] * 40}}
    for design, words in (
        (tables("robot-left"), "is a robot"),
        (None, "is missing"),
        (long, "80 cells"),
    ):
        assert words in ask("evaluate", design).header["problems"][0]["text"]
    problem = ask("evaluate", FORWARD, wanted="x").header["problems"][0]
    assert problem["at"] == "" and "unknown key" in problem["text"]
