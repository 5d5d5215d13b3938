"""Maps, boundaries, jumps, wishes and yields: what the page is told is what Python says."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

import stepwell as sw
from stepwell.accounts import account
from stepwell.design import DEFAULT_TOLERANCES, Yield, check, parameter, parameters
from stepwell.files import loads_tables, preset_text, presets, tables_in
from stepwell.studio.aside import answered
from stepwell.studio.ask import Ask, PageDesign, View
from stepwell.studio.message import Message, unpacked
from studio.pages import FORWARD, Answer

PLANE: dict[str, Any] = {"x": "2.q.x", "y": "2.q.y", "x_range": [0, 30], "y_range": [-15, 15]}
MAP = PLANE | {"pixels": [60, 40]}


def ask(kind: str, design: Any = None, **keys: Any) -> Answer:
    return Answer(*unpacked(answered(Message(kind, 1, json.loads(json.dumps(design)), keys))))


def tables(name: str) -> dict[str, Any]:
    return tables_in(preset_text(name))


@pytest.mark.parametrize(
    ("keys", "factors"),
    [
        ({}, (1e-3, 1e-3)),
        ({"x": "2.p.x", "x_range": [-30, 0]}, (1e-3, 1e-3)),
        ({"x": "1.stiffness", "x_range": [15, 40]}, (1.0, 1e-3)),
        ({"x": "1.q.x", "y": "2.rest_length", "y_range": [2, 15]}, (1e-3, 1e-3)),
    ],
)
def test_every_pixel_of_a_map_is_what_python_says(keys: Any, factors: Any):
    wanted = MAP | keys
    header, blocks = ask("map", FORWARD, **wanted)
    assert blocks["image"].shape == (40, 60)
    assert sum(header["fractions"]) == pytest.approx(1)
    forward = sw.preset("paper-forward")
    for row, column in ((0, 0), (20, 30), (39, 59), (5, 50), (33, 12)):
        chain = forward
        for letter, k, factor in (("x", column, factors[0]), ("y", row, factors[1])):
            cell, _, part = wanted[letter].partition(".")
            one = parameter(chain, f"{chain.names[int(cell) - 1]}.{part}")
            chain = one.changed(chain, blocks[letter][k] * factor)
        said = header["sequences"][blocks["image"][row, column]]
        assert said == str(chain.cycle().sequence)


def test_a_coarse_map_is_smaller():
    assert ask("map", FORWARD, **MAP, coarse=4).blocks["image"].shape == (10, 15)


def test_a_map_stays_while_the_design_moves_on_it():
    moved = json.loads(json.dumps(FORWARD))
    moved["chain"]["cell"][1]["q_mm"] = [12.5, -3]
    np.testing.assert_array_equal(
        ask("map", FORWARD, **MAP).blocks["image"], ask("map", moved, **MAP).blocks["image"]
    )
    assert ask("border", moved, **PLANE).header["here"] == pytest.approx([12.5, -3])


def test_the_distance_on_the_plane_of_an_anchor_is_its_margin():
    header, blocks = ask("border", FORWARD, **PLANE)
    margin = sw.margin(sw.preset("paper-forward"))
    (way,) = header["nearest"]
    assert way["unit"] == "mm"
    assert way["distance"] == pytest.approx(margin.anchors[1] * 1e3, rel=1e-3)
    assert "00>10>11>01>00" in way["sequences"]
    assert {one["method"] for one in header["boundaries"]} == {"exact"}
    assert blocks[header["boundaries"][0]["block"]].shape[1] == 2


def test_unlike_parameters_have_a_distance_along_each_axis():
    keys = PLANE | {"x": "2.stiffness", "x_range": [10, 60], "y_range": [-15, 15]}
    header = ask("border", FORWARD, **keys).header
    ways = {one["along"]: one for one in header["nearest"]}
    assert set(ways) <= {"x", "y"}
    assert ways
    for letter, way in ways.items():
        k = "xy".index(letter)
        assert way["unit"] == ("N/m", "mm")[k] == header["units"][k]
        # A hair beyond it does something else, and a hair before it does not.
        sequences = set()
        for beyond in (-1e-3, 1e-3):
            at = list(header["here"])
            at[k] += (way["at"][k] - at[k]) * (1 + beyond)
            there = ask("jump", FORWARD, x=keys["x"], y=keys["y"], at=at).header["chain"]
            chain = loads_tables({"chain": there}).chain
            assert isinstance(chain, sw.Chain)
            sequences.add(str(chain.cycle().sequence))
        assert sequences == set(way["sequences"])


@pytest.mark.slow
def test_what_no_closed_form_tells_is_followed_aside_coarse_first():
    slack = tables("slack")
    keys = {**MAP, "pixels": [12, 10]}
    assert ask("map", slack, **keys).header["aside"] is True
    assert ask("border", slack, **PLANE).header["aside"] is True
    from stepwell.studio.aside import answer

    shown: list[View] = []
    last = answer("map_followed", PageDesign(slack), Ask(keys, show=shown.append))
    assert len(shown) > 1
    assert shown[0].header["coarse"] > shown[-1].header["coarse"]
    image = last.blocks["image"]
    chain = sw.preset("slack")
    for row, column in ((0, 0), (image.shape[0] // 2, image.shape[1] // 2)):
        place = last.blocks["x"][column] / 1e3, last.blocks["y"][row] / 1e3
        there = parameter(chain, "outer.q").changed(chain, place)
        said = last.header["sequences"][image[row, column]]
        assert said == str(there.cycle().sequence)
    changes = [one for one in last.header["boundaries"] if one["kind"] != "bistable"]
    assert {one["method"] for one in changes} == {"search"}


@pytest.mark.parametrize("name", presets())
def test_every_number_of_a_design_has_a_range_that_holds_it(name: str):
    design = sw.preset(name)
    chain = design if isinstance(design, sw.Chain) else design.legs[0].chain
    listed = ask("parameters", tables(name)).header["parameters"]
    assert len(listed) == sum(not one.is_anchor for one in parameters(chain))
    assert len({one["key"] for one in listed}) == len(listed)
    for one in listed:
        low, high = one["range"]
        assert low < high
        assert one["value"] is None or low <= one["value"] <= high


def test_a_jump_changes_two_parameters_and_nothing_else():
    table = ask("jump", FORWARD, x="2.q.x", y="1.stiffness", at=[12.5, 20]).header["chain"]
    chain = loads_tables({"title": FORWARD["title"], "chain": table}).chain
    forward = sw.preset("paper-forward")
    wanted = parameter(forward, "outer.q.x").changed(forward, 0.0125)
    assert chain == parameter(wanted, "inner.stiffness").changed(wanted, 20.0)


@pytest.mark.parametrize(
    ("keys", "at"),
    [
        ({"x": "3.q.x"}, "ask.x"),
        ({"y": "2.r"}, "ask.y"),
        ({"x_range": [3, 3]}, "ask.x_range"),
        ({"y_range": [5, None]}, "ask.y_range"),
        ({"pixels": [0, 10]}, "ask.pixels"),
        ({"pixels": [10**6, 10]}, "ask.pixels"),
        ({"coarse": 0}, "ask.coarse"),
    ],
)
def test_a_map_is_asked_within_bounds(keys: Any, at: str):
    assert ask("map", FORWARD, **(MAP | keys)).header["problems"][0]["at"] == at


def test_a_map_that_cannot_be_is_refused_in_the_words_of_python():
    for keys, words in (
        ({"y": "2.q.x"}, "use two different parameters"),
        ({"x": "2.friction", "x_range": [-1, 1]}, "friction"),
    ):
        assert words in ask("map", FORWARD, **(MAP | keys)).header["problems"][0]["text"]


@pytest.mark.slow
def test_a_set_of_states_is_granted_as_by_python():
    states = ["00", "10", "11"]
    header, blocks = ask("wish", states=" ".join(states), seed=3, objective="worst")
    result = sw.design(states=states, seed=3, objective="worst")
    record = json.loads(json.dumps(account(result).record))
    assert {key: header[key] for key in record} == record
    assert sorted(header["states"]) == states
    # What is shown of it is what is shown of any design.
    shown, same = ask("evaluate", header["design"])
    assert header["shown"]["sequence"] == shown["sequence"]
    np.testing.assert_array_equal(blocks["travel"], same["travel"])


@pytest.mark.slow
def test_a_wish_takes_tolerances_force_and_all_states():
    header = ask(
        "wish", states="all", cells=2, anchor_mm=0.2, stiffness_percent=2, most_force_N=0.5
    ).header
    tolerances = sw.Tolerances(anchor=0.2e-3, stiffness=0.02)
    result = sw.design(states="all", cells=2, tolerances=tolerances, most_force=0.5)
    assert header["yield"]["fraction"] == result.yield_.fraction
    assert loads_tables(header["design"]).subject == result.chain


def test_what_cannot_be_had_comes_with_its_proof():
    text = ask("wish", sequence="00>10>11>01>00", most_force_N=0.01).header["problems"][0]["text"]
    with pytest.raises(ValueError, match="00>10>11>01>00") as error:
        sw.design("00>10>11>01>00", most_force=0.01)
    assert text == str(error.value)


@pytest.mark.parametrize(
    "keys",
    [
        {},
        {"sequence": "00>10>11>01>00", "states": "00 10"},
        {"states": "000000000 111111111"},
        {"states": "all"},
        {"sequence": "00>10>11>01>00", "objective": "luck"},
        {"sequence": "00>10>11>01>00", "most_force_N": 0},
    ],
)
def test_a_wish_is_asked_within_bounds(keys: Any):
    assert ask("wish", **keys).header["problems"][0]["at"].startswith("ask")


@pytest.mark.slow
def test_a_yield_shows_few_first_and_is_pythons():
    from stepwell.studio.aside import answer

    shown: list[View] = []
    last = answer("yield", PageDesign(FORWARD), Ask({"anchor_mm": 3}, show=shown.append))
    tolerances = sw.Tolerances(anchor=3e-3, stiffness=DEFAULT_TOLERANCES.stiffness)
    chain = sw.preset("paper-forward")
    assert last.header == _judged(chain, chain.yields(tolerances))
    assert [one.header for one in shown] == [_judged(chain, chain.yields(tolerances, samples=1000))]


def _judged(chain: sw.Chain, result: Yield) -> dict[str, Any]:
    """The record of a yield, and the verdict on what the drawing does."""
    checked = check(chain, tolerances=result.tolerances, samples=result.samples, seed=result.seed)
    return {**account(result).record, "verdict": checked.verdict}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "verdict"),
    [("paper-forward", "robust"), ("paper-identical", "fails"), ("paper-via-01", "robust")],
)
def test_the_verdict_is_that_of_check(name: str, verdict: str):
    chain = sw.preset(name)
    header = ask("yield", tables(name)).header
    assert header["verdict"] == verdict == check(chain).verdict


@pytest.mark.slow
def test_where_each_has_to_be_followed_a_thousand_are_enough():
    header = ask("yield", tables("slack")).header
    assert header["samples"] == header["by_engine"] == 1000
    assert header["fraction"] == sw.preset("slack").yields(samples=1000).fraction
