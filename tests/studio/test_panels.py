"""What the page is told is what Python says, number by number."""

import json
import random
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from copy import deepcopy
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import stepwell as sw
from stepwell.accounts import account
from stepwell.base import StepwellError, display_unit
from stepwell.design import DEFAULT_TOLERANCES
from stepwell.files import DesignError, loads, loads_tables, preset_text, presets, tables_in
from stepwell.sequences import to_dot
from stepwell.statics import EventKind
from stepwell.studio.aside import answered
from stepwell.studio.ask import PageDesign
from stepwell.studio.message import Message, unpacked
from stepwell.studio.motion import drawn
from studio.pages import FORWARD, Answer, long_chain

CHAINS = [name for name in presets() if not name.startswith("robot-")]


def ask(kind: str, design: Any = None, *, leg: Any = 0, **keys: Any) -> Answer:
    """What a panel answers, through the wire and back."""
    design = json.loads(json.dumps(design, allow_nan=False))
    return Answer(*unpacked(answered(Message(kind, 1, design, keys, leg))))


def tables(name: str) -> dict[str, Any]:
    return tables_in(preset_text(name))


def test_the_gallery_lists_what_comes_along():
    designs = ask("gallery").header["designs"]
    assert {one["name"]: one["title"] for one in designs} == presets()
    for one in designs:
        design = sw.preset(one["name"])
        chain = design if isinstance(design, sw.Chain) else design.legs[0].chain
        assert one["kind"] == ("chain" if design is chain else "robot")
        assert one["cells"] == len(chain)


@pytest.mark.parametrize("name", presets())
def test_a_design_of_the_gallery_opens(name: str):
    header = ask("open", preset=name).header
    assert header["title"] == presets()[name]
    assert loads_tables(header["design"]).subject == sw.preset(name)


def test_the_text_of_a_file_opens_and_a_wrong_one_is_reported_as_by_a_command():
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


@pytest.mark.slow
@pytest.mark.parametrize("name", CHAINS)
def test_file_and_script_make_the_same_chain(name: str):
    header = ask("text", tables(name)).header
    assert loads(header["toml"]).subject == sw.preset(name)
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
        ("travel", path.travel * 1e3),
        ("segment", path.branch),
        ("direction", path.direction),
    ):
        np.testing.assert_array_equal(blocks[block], array, err_msg=block)
    for i, cell in enumerate(chain.levers):
        cell_header = header["cells"][i]
        # As the page turns a lever: by its travel from the stop 0.
        along = blocks["travel"][:, i] / cell_header["lever_mm"]
        sine = along - np.sin(np.radians(cell_header["limit_deg"]))
        np.testing.assert_allclose(sine, np.sin(cell.angle(path.travel[:, i])), rtol=0, atol=1e-14)
        np.testing.assert_array_equal(
            blocks["landscape_energy"][:, i],
            cell.energy_at(np.linspace(0.0, cell.full_travel, 65)) * 1e3,
        )
        assert (cell_header["force_0_N"], cell_header["force_1_N"]) == (cell.force_0, cell.force_1)
        assert cell_header["full_travel_mm"] == cell.full_travel * 1e3
        assert cell_header["bands"][0]["q_mm"] == [x * 1e3 for x in cell.bands[0].q]
        assert (cell_header["stable"] == [0, 1]) == cell.is_bistable


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
    measure = chain.measure
    units = measure.travel_unit, measure.force_unit, chain.drive_unit
    unit, force, drive = (display_unit(one)[1] for one in units)
    before = -1
    for event_header, event in zip(header["events"], events, strict=True):
        assert event_header["kind"] == event.kind.name.lower()
        assert event_header["cells"] == list(event.cells)
        assert event_header["direction"] == event.direction
        assert event_header["stroke_mm"] == event.stroke * unit
        k = event_header["sample"]
        assert k >= before
        before = k
        assert blocks["drive"][k] == event.drive * drive
        if event.kind is EventKind.SNAP:
            # A jump between two samples, and never a piece of a curve.
            assert blocks["segment"][k] != blocks["segment"][k + 1]
            assert blocks["drive"][k] == blocks["drive"][k + 1]
            np.testing.assert_allclose(
                blocks["force"][k], event.force_before * force, rtol=1e-9, atol=1e-9
            )
    # The page reads the snaps of a design that moves under a hand off the samples.
    jumps = np.flatnonzero(np.diff(blocks["segment"])).tolist()
    assert jumps == [one["sample"] for one in header["events"] if one["kind"] == "snap"]
    moving = ask("evaluate", tables(name), moves=True)
    assert "events" not in moving.header
    every_second_sample(moving.blocks, blocks, jumps)


def every_second_sample(
    moving: Mapping[str, Any], blocks: Mapping[str, Any], jumps: list[int]
) -> None:
    """The arrays of a move are every second sample of all, with the ends of all jumps."""
    drives, few = blocks["drive"].tolist(), moving["drive"].tolist()
    assert len(drives) / 2 < len(few) <= len(drives)
    rows, at = [], 0
    for k, one in enumerate(few):
        way = moving["segment"][k], moving["direction"][k]
        while (blocks["segment"][at], blocks["direction"][at]) != way or abs(drives[at] - one) > (
            1e-12 * max(np.ptp(drives), 1.0)
        ):
            at += 1
        rows.append(at)
        at += 1
    assert {rows[k] for k in np.flatnonzero(np.diff(moving["segment"]))} == set(jumps)
    for name_of, block in moving.items():
        whole = blocks[name_of]
        wanted = whole if name_of.startswith("landscape") else whole[rows]
        if name_of == "travel":  # each cell's in 2^16 - 1 steps
            assert (np.abs(block - wanted) <= 0.51 * np.ptp(wanted, axis=0) / (2**16 - 1)).all()
            continue
        np.testing.assert_allclose(block, wanted, rtol=1e-6, atol=1e-7, err_msg=name_of)


# Values that are equal and not the same, and values that no cell has.
OTHERS = (1, True, 1.0, -0.0, 0, None, "a", [1, 2], {"x": 1}, 1e9, -3, [10, 0], [True, 0])


@pytest.mark.parametrize("seed", range(4))
def test_a_design_after_another_is_read_as_if_it_were_the_first(seed: int):
    def read(read: Callable[[], Any]) -> Any:
        try:
            return read()
        except StepwellError as error:
            return str(error)

    rng, design, kinds = random.Random(seed), dict[str, Any](), Counter[bool]()
    for k in range(150):
        if k % 50 == 0:
            design = tables(rng.choice([*presets()]))
        other = deepcopy(design)
        for _ in range(rng.choice((1, 1, 2))):
            table, key = rng.choice([*_places(other)])
            if rng.random() < 0.9 and type(table[key]) is float:
                table[key] *= rng.uniform(0.8, 1.2)
            else:
                table[key] = deepcopy(rng.choice(OTHERS))
        after = read(lambda: PageDesign(other).read)  # noqa: B023
        alone = read(lambda: loads_tables(other))  # noqa: B023
        assert after == alone
        kinds[isinstance(alone, str)] += 1
        design = design if isinstance(alone, str) else other
    assert min(kinds[True], kinds[False]) > 10


def _places(value: Any) -> Iterator[tuple[Any, Any]]:
    listed = isinstance(value, list)
    for key in range(len(value)) if listed else [*value] if isinstance(value, dict) else ():
        yield value, key
        yield from _places(value[key])


@pytest.mark.parametrize("name", ["paper-forward", "three-wave", "countdown"])
def test_margins_are_pythons(name: str):
    header = ask("evaluate", tables(name)).header
    margin = sw.margin(sw.preset(name))
    assert header["method"] == margin.method.name.lower() == "exact"
    for shown, change in zip(header["margins"], margin.changes, strict=True):
        assert (shown["cell"], shown["what"]) == (change.cell, change.parameter)
        if change.parameter == "anchor" and isinstance(change.move, tuple):
            assert shown["reach_mm"] == change.distance * 1e3
            assert shown["move_mm"] == [x * 1e3 for x in change.move]
        else:
            assert shown["reach_percent"] == change.distance * 100
    least = min(margin.changes, key=lambda one: (one.parameter != "anchor", one.distance))
    assert header["margin"]["reach_mm"] == float(np.min(margin.anchors)) * 1e3
    assert header["margin"]["becomes"] == least.becomes
    # Under a hand that drags, the motion comes first, then the margins, and that sequence at rest.
    assert "margin" not in ask("evaluate", tables(name), moves=True).header
    moving = ask("limits", tables(name)).header
    assert (moving["margins"], moving["method"]) == (header["margins"], "exact")
    assert moving["margin"] == {k: v for k, v in header["margin"].items() if k != "becomes"}
    assert ask("margin", tables(name)).header["margin"] == header["margin"]


def test_the_answer_to_a_move_of_a_long_chain_is_short():
    chain = long_chain(32)
    moves = {"moves": True, "cells": [5], "drive": 200.0, "direction": 1}
    answer = answered(Message("evaluate", 1, chain, moves))
    header, blocks = unpacked(answer)
    assert len(answer) < 32_000
    assert len(answer) - sum(block.nbytes for block in blocks.values()) < 6_000
    # The drawing and the curves have what they show.
    assert set(blocks) == {
        *("drive", "stroke", "force", "travel", "segment", "direction"),
        *("tension_now", "pull", "landscape_travel", "landscape_energy"),
    }
    assert len(header["cells"]) == 1
    limits, _ = unpacked(answered(Message("limits", 2, chain)))
    assert len(limits["margins"]) == 64


@pytest.mark.parametrize("cells", [1, 2, 8, 12, 24, 32, 64])
def test_a_move_of_a_long_chain_has_few_samples_and_all_ends_of_segments(cells: int):
    path = PageDesign(long_chain(cells)).chain.cycle().path
    full, few = drawn(path), drawn(path, moves=True)
    fewest = 2 * len(path.move_spans) + 1
    assert len(few.drive) <= max(361, fewest)
    assert len(few.drive) <= max(0.56 * len(full.drive), fewest)
    places = [np.stack([one.drive, one.branch], axis=1).round(9) for one in (full, few)]
    have, want = ({*map(tuple, rows.tolist())} for rows in places)
    assert want <= have
    for branch in np.unique(full.branch):
        ends = [one.drive[one.branch == branch][[0, -1]] for one in (full, few)]
        np.testing.assert_allclose(*ends, rtol=0, atol=1e-12)


@pytest.mark.slow
def test_a_margin_that_has_to_be_searched_is_asked_for_aside():
    assert ask("evaluate", tables("slack")).header["margins"] == []
    assert ask("limits", tables("slack")).header["method"] == "search"
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
    for cell in header["cells"]:
        assert ("limit_deg" in cell) == (cell["kind"] == "lever")
    units = ("mL", "kPa") if name == "balloon" else ("mm", "N")
    assert (header["units"]["travel"], header["units"]["force"]) == units
    assert len(blocks["drive"]) < 2700
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
def test_what_is_wrong_with_a_design_is_reported_at_its_key(
    kind: str, key: str, value: Any, at: str
):
    design = json.loads(json.dumps(FORWARD))
    design["chain"]["cell"][1][key] = value
    header = ask(kind, design).header
    with pytest.raises(DesignError) as error:
        loads_tables(design)
    assert tuple(one["text"] for one in header["problems"]) == error.value.problems
    assert header["problems"][0]["at"] == at


def test_the_chain_of_a_leg_is_the_robots():
    robot = sw.preset("robot-left")
    for k, leg in enumerate(robot.legs):
        header = ask("evaluate", tables("robot-left"), leg=k).header
        assert header["sequence"] == str(leg.chain.cycle().sequence)
        assert header["names"] == list(leg.chain.names)
    problem = ask("evaluate", tables("robot-left"), leg=2).header["problems"][0]
    assert problem == {"at": "leg[2]", "text": "leg[2]: there are 2."}


@pytest.mark.slow
def test_the_python_of_a_robot_makes_it():
    header = ask("text", tables("robot-left")).header
    made: dict[str, object] = {}
    exec(header["python"], made)
    assert made["robot"] == sw.preset("robot-left")


def test_missing_designs_and_long_chains_are_refused_in_words():
    long = {"chain": FORWARD["chain"] | {"cell": FORWARD["chain"]["cell"] * 40}}
    for design, words in ((None, "is missing"), (long, "80 cells")):
        assert words in ask("evaluate", design).header["problems"][0]["text"]
    problem = ask("evaluate", FORWARD, target="x").header["problems"][0]
    assert problem["at"] == "" and "unknown key" in problem["text"]


def test_the_graph_is_pythons():
    header = ask("graph", tables("three-wave")).header
    graph = sw.preset("three-wave").graph()
    assert header["dot"] == to_dot(graph)
    assert [node["label"] for node in header["nodes"]] == list(graph)
    assert {n["label"] for n in header["nodes"] if n["reached"]} == graph.reachable()
    for shown, label in zip(header["nodes"], graph, strict=True):
        node = graph.node(label)
        assert (shown["low_mm"], shown["high_mm"]) == (node.low * 1e3, node.high * 1e3)
    assert len(header["edges"]) == np.count_nonzero(graph.target >= 0)
    for edge in header["edges"]:
        transition = graph.transition(edge["from"], edge["direction"])
        assert transition is not None
        to, way = transition
        assert (edge["to"], edge["kind"]) == (to, way.kind.name.lower())
        assert edge["drive_mm"] == way.drive * 1e3


def test_a_graph_that_cannot_be_is_reported_in_the_words_of_the_command():
    problem = ask("graph", tables("friction")).header["problems"][0]["text"]
    with pytest.raises(ValueError, match="friction") as error:
        sw.preset("friction").graph()
    assert problem == str(error.value)


def test_the_program_to_a_state_is_pythons():
    header, blocks = ask("program", FORWARD, target="01")
    program = sw.preset("paper-forward").program("01")
    assert header["turning_points_mm"] == [x * 1e3 for x in program.turning_points]
    assert header["states"] == list(program.sequence.states)
    assert header["meets_target"] and header["proved"] is program.shortest
    assert blocks["drive"][-1] == program.turning_points[-1] * 1e3
    again, _ = ask("program", FORWARD, turning_points_mm=header["turning_points_mm"])
    assert again["arrives"] == "01"


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({}, "ask.target = nothing"),
        ({"target": "1x"}, "one digit a cell"),
        ({"target": "02"}, "one digit a cell"),
        ({"target": "01", "start": "0"}, "one digit a cell"),
        ({"turning_points_mm": []}, "a list of 1 to 100 numbers"),
        ({"turning_points_mm": [0, "x"]}, "ask.turning_points_mm"),
        ({"turning_points_mm": [0, 99]}, "out of reach"),
    ],
)
def test_a_program_that_cannot_be_is_refused(keys: Any, words: str):
    assert words in ask("program", FORWARD, **keys).header["problems"][0]["text"]


def test_the_yield_is_pythons():
    header = ask("yield", FORWARD, anchor_mm=0.5, stiffness_percent=3, samples=2000).header
    tolerances = sw.Tolerances(anchor=0.5e-3, stiffness=0.03)
    record = account(sw.preset("paper-forward").yields(tolerances, samples=2000)).record
    expected = json.loads(json.dumps(record))
    assert {key: header[key] for key in expected} == expected


@pytest.mark.parametrize(
    ("keys", "at"),
    [
        ({"anchor_mm": -1}, "ask.anchor_mm"),
        ({"stiffness_percent": 25}, "ask.stiffness_percent"),
        ({"samples": 0}, "ask.samples"),
        ({"samples": 10**9}, "ask.samples"),
        ({"samples": 2.5}, "ask.samples"),
        ({"seed": True}, "ask.seed"),
    ],
)
def test_a_yield_is_asked_within_bounds(keys: Any, at: str):
    assert ask("yield", FORWARD, **keys).header["problems"][0]["at"] == at


@pytest.mark.slow
def test_a_wish_is_granted_as_by_python():
    header = ask("wish", sequence="00>01>11>10>00", anchor_mm=0.2, holes_mm=5).header
    result = sw.design(
        "00>01>11>10>00", holes=0.005, tolerances=replace(DEFAULT_TOLERANCES, anchor=0.2e-3)
    )
    record = json.loads(json.dumps(account(result).record))
    assert {key: header[key] for key in record} == record
    assert loads_tables(header["design"]).subject == result.chain
    assert ask("evaluate", header["design"]).header["sequence"] == "00>01>11>10>00"


def test_a_wish_that_no_chain_grants_is_reported_why():
    for sequence in ("00>11>10>00", "00>x", "0" * 20):
        assert ask("wish", sequence=sequence).header["ok"] is False
