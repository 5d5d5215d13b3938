"""Key paths: every number of a robot can be named, told where it comes from, and changed."""

import math
from dataclasses import replace

import numpy as np
import pytest

from facts import refuses
from sizes import SIZE
from stepwell.files import (
    DesignError,
    RobotParameter,
    loads,
    parameters,
    preset,
    preset_text,
    presets,
    vary,
)
from stepwell.mechanism import Band, Cell, Chain, Cubic, Table
from stepwell.robot import Leg, Robot

FORWARD: Robot = preset("robot-forward")
EXPLORER: Robot = preset("robot-explorer")


def source_of(robot: Robot) -> dict[str, str]:
    return {parameter.path: parameter.source for parameter in parameters(robot)}


def value_of(robot: Robot) -> dict[str, float]:
    return {parameter.path: parameter.values[0] for parameter in parameters(robot)}


def answer(values: dict) -> str:
    with pytest.raises(DesignError) as caught:
        vary(FORWARD, values)
    return str(caught.value).removeprefix(f"{FORWARD.title}: ")


def test_every_number_is_listed_with_its_unit_and_its_source_defaults_too():
    listed = parameters(FORWARD)
    assert RobotParameter("foot.link_mm", (35.0,), "mm", "authors' notes") in listed
    assert RobotParameter("body.mass_g", (FORWARD.body.mass * 1e3,), "g", "assumed") in listed
    lever = next(p for p in listed if p.path == "leg.left.chain.cell.inner.lever_mm")
    assert (lever.values[0], lever.unit) == (pytest.approx(10 * math.sqrt(2)), "mm")
    friction = RobotParameter("leg.right.chain.cell.outer.friction_N", (0.0,), "N", "assumed")
    assert friction in listed
    assert str(friction) == "leg.right.chain.cell.outer.friction_N = 0 N (assumed)"
    units = {p.path.split(".")[-1].split("[")[0]: p.unit for p in parameters(EXPLORER)}
    assert units["gravity_m_per_s2"] == "m/s²"
    assert units["damping_N_m_s_per_rad"] == "N m s/rad"
    assert units["damping_N_s_per_m"] == "N s/m"
    assert units["foot_friction"] == ""
    assert len({p.path for p in listed}) == len(listed)


@pytest.mark.slow
@pytest.mark.parametrize("robot", [FORWARD, EXPLORER], ids=["forward", "explorer"])
def test_every_listed_number_can_be_varied_by_its_path_and_nothing_else_changes(robot):
    before = value_of(robot)
    # In the quick size both sides of a robot stand for each other, and every third number for all.
    for parameter in parameters(robot)[:: 1 if SIZE == "full" else 3]:
        same = vary(robot, {parameter.path: parameter.values[0]})
        assert same == robot
        # A trifle, so that the robot still stands; a stroke can only shrink, travels only grow.
        step = -1e-3 if "stroke" in parameter.path else 1e-3
        to = parameter.values[0] + step * max(abs(parameter.values[0]), 1.0)
        path = parameter.path
        for key in ("lever_mm", "limit_deg"):  # all legs need the same full stroke
            path = f"chain.{key}" if path.endswith(key) else path
        other = vary(robot, {path: to})
        after = value_of(other)
        changed = {p for p, v in after.items() if v != before[p]}
        assert parameter.path in changed
        assert changed == {parameter.path} or path.startswith("chain.")
        # An angle passes through radians, which have other neighbours.
        assert after[parameter.path] == pytest.approx(to, rel=1e-15)


def test_a_value_is_in_the_unit_of_its_key_to_the_last_bit():
    robot = vary(EXPLORER, {"foot.below_mm": 0.35, "antenna.left.swing_deg": 45})
    assert robot.foot.below == 0.00035
    assert robot.antennas[0].swing == math.pi / 4
    assert robot.antennas[1] == EXPLORER.antennas[1]


def test_a_path_without_names_means_all_legs_and_cells():
    for path in ("leg.*.chain.cell.outer.q_mm[0]", "chain.cell.outer.q_mm[0]",
                 "chain.cell[1].q_mm[0]", "leg[*].chain.cell[1].q_mm[0]"):  # fmt: skip
        robot = vary(FORWARD, {path: 14})
        assert [leg.chain.levers[1].bands[0].q for leg in robot.legs] == [(0.014, 0.0)] * 2
    robot = vary(FORWARD, {"leg.right.chain.band.stiffness_N_per_m": 47})
    stiffness = [[c.bands[0].stiffness for c in leg.chain.levers] for leg in robot.legs]
    assert stiffness == [[30.0, 30.0], [47.0, 47.0]]


def test_a_list_takes_as_many_values_as_it_has():
    robot = vary(FORWARD, {"leg.left.chain.cell.inner.p_mm": (-9, 0.5)})
    assert robot.leg("left").chain.levers[0].bands[0].p == (-0.009, 0.0005)
    corners = np.array([[-60.0, 0.0], [40.0, 50.0], [40.0, -50.0]])
    robot = vary(FORWARD, {"body.supports_mm": corners})
    assert robot.body.supports == ((-0.06, 0.0), (0.04, 0.05), (0.04, -0.05))


def test_switches_and_words_can_be_varied_too():
    robot = vary(EXPLORER, {"antenna.*.connected": False, "drive.profile": "sine"})
    assert [antenna.connected for antenna in robot.antennas] == [False, False]
    assert robot.drive.profile == "sine"


def test_a_later_path_counts_where_two_mean_the_same_number():
    robot = vary(FORWARD, {"leg.*.at_mm[0]": 9, "leg.left.at_mm[0]": 10})
    assert [leg.at[0] for leg in robot.legs] == [0.010, 0.009]


def test_the_text_of_a_file_does_as_well_as_a_robot():
    text = preset_text("robot-forward")
    assert vary(text, {"foot.below_mm": 0.5}) == vary(FORWARD, {"foot.below_mm": 0.5})
    with refuses(DesignError, "a chain", "a robot"):
        vary(preset_text("paper-forward"), {})


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (
            {"foot.link": 30},
            "foot.link: selects none of this robot's numbers. Did you mean foot.link_mm?",
        ),
        (
            {"fot.link_mm": 30},
            "fot.link_mm: selects none of this robot's numbers. Did you mean foot.link_mm?",
        ),
        (
            {"leg.left.chain.cell.iner.q_mm[0]": 1},
            "leg.left.chain.cell.iner.q_mm[0]: selects none of this robot's numbers. Did you mean "
            "leg.left.chain.cell.inner.q_mm[0]?",
        ),
        (
            {"leg[2].at_mm[0]": 1},
            "leg[2].at_mm[0]: selects none of this robot's numbers. Known after leg: left, right.",
        ),
        (
            {"foot.link_mm[0]": 1},
            "foot.link_mm[0]: selects none of this robot's numbers: foot.link_mm is one number, "
            "leave out the rest.",
        ),
        (
            {"leg.left.at_mm": 1},
            "leg.left.at_mm: 1 does not match leg.left.at_mm: name one number of it, such as "
            "leg.left.at_mm[0], or give all of its numbers.",
        ),
        (
            {"leg.left.at_mm": [1, 2, 3]},
            "leg.left.at_mm: [1, 2, 3] does not match leg.left.at_mm: name one number of it, "
            "such as leg.left.at_mm[0], or give all of its numbers.",
        ),
        (
            {"foot..link": 1},
            "foot..link: is no key path; one looks like foot.link_mm, leg.left.at_mm[0] or "
            "chain.cell.inner.q_mm[0].",
        ),
        ({"foot.link_mm": -1}, "foot.link_mm = -1: must be > 0 (1e-6 to 1e6)."),
        ({"foot.link_mm": None}, "foot.link_mm: None is no number."),
        (
            {"foot.link_mm": math.nan},
            "foot.link_mm = nan: must be a finite number > 0 (1e-6 to 1e6).",
        ),
        (
            {"drive.stroke_mm": 41},
            "drive.stroke_mm = 41 mm: must be <= 40 mm, the full stroke of the legs' chains; a "
            "longer one pushes against their stops.",
        ),
    ],
)
def test_what_cannot_be_varied_is_answered_like_a_wrong_file(values, message):
    assert answer(values) == message


def test_every_problem_is_said_at_once():
    with pytest.raises(DesignError) as caught:
        vary(FORWARD, {"foot.link": 1, "zzz": 2, "": 3})
    assert len(caught.value.problems) == 3


def test_the_narrowest_path_says_where_a_number_comes_from():
    said = source_of(EXPLORER)
    cell = "leg.right.chain.cell"
    assert said[f"{cell}.inner.lever_mm"] == "paper"
    assert said[f"{cell}.outer.band.stiffness_N_per_m"] == "measured"
    assert said[f"{cell}.inner.band.stiffness_N_per_m"] == "authors' notes"
    assert said[f"{cell}.inner.p_mm[0]"] == "assumed"
    assert said["leg.left.chain.cell.inner.p_mm[0]"] == "paper"
    assert said["body.mass_g"] == "assumed"


def test_no_robot_of_the_package_claims_more_than_is_known():
    # The paper gives stroke, anchors, the cell and the bands' rest length; its authors' notes the
    # stiffness of the bands, links, span, foot mass and drag.
    given = {
        "paper": {
            "stroke_mm",
            "p_mm",
            "q_mm",
            "lever_mm",
            "limit_deg",
            "rest_length_mm",
            "moves_mm",
        },
        "authors' notes": {"link_mm", "span_mm", "mass_g", "drag_N", "stiffness_N_per_m"},
        "measured": {"stiffness_N_per_m"},
    }
    for name in (name for name in presets() if name.startswith("robot-")):
        for parameter in parameters(preset(name)):
            key = parameter.path.split(".")[-1].split("[")[0]
            assert parameter.source == "assumed" or key in given[parameter.source], parameter
            if parameter.path.startswith(("body", "blocks", "drive.stiff", "antenna.left.length")):
                assert parameter.source == "assumed"


def test_a_number_that_was_changed_is_assumed_from_then_on():
    robot = vary(FORWARD, {"foot.link_mm": 36, "leg.left.chain.cell.outer.q_mm[0]": 19})
    said, before = source_of(robot), source_of(FORWARD)
    changed = {"foot.link_mm", "leg.left.chain.cell.outer.q_mm[0]"}
    assert {path for path in said if said[path] != before[path]} == changed
    assert {said[path] for path in changed} == {"assumed"}


def test_names_that_are_no_plain_words_stand_in_quotes_and_nameless_things_have_numbers():
    inner = Cell(Band((-0.01, 0), (0.01, 0)), name="a.b")
    chain = Chain((inner, replace(inner, name="a.b")))
    legs = (Leg("hind left", chain, (0.008, 0.0575)), Leg('"', chain, (0.008, -0.0575)))
    robot = Robot(legs)
    paths = value_of(robot)
    assert 'leg."hind left".chain.cell[1].q_mm[0]' in paths
    assert 'leg."\\"".at_mm[0]' in paths
    for path, value in paths.items():
        assert vary(robot, {path: value}) == robot
    moved = vary(robot, {'leg."hind left".at_mm[0]': 7})
    assert [leg.at[0] for leg in moved.legs] == [0.007, 0.008]
    assert loads_back(moved) == moved


def test_several_bands_and_measured_laws_have_paths():
    table = Table((0.0, 0.01, 0.03), (0.0, 0.012, 0.028))
    inner = Cell((Band((-0.01, 0), (0.01, 0), law=table), Band((-0.01, 0), (0.01, 0.002))))
    outer = Cell(Band((-0.01, 0), (0.02, 0), law=Cubic(-38.9, 719.0)))
    legs = [Leg(n, Chain((inner, outer)), (0.008, y)) for n, y in (("l", 0.0575), ("r", -0.0575))]
    robot = Robot(legs)
    units = {p.path: p.unit for p in parameters(robot)}
    assert units["leg.l.chain.cell.outer.band.cubic_per_mm2"] == "1/mm²"
    rows = [p for p in units if "_mm_N[1]" in p or "shape_mm[1]" in p]
    assert {units[p] for p in rows} <= {"mm", "N"}
    assert rows
    stiff = vary(robot, {"leg.l.chain.cell.inner.bands[1].stiffness_N_per_m": 40})
    assert [b.stiffness for b in stiff.leg("l").chain.levers[0].bands][1] == 40.0
    long = vary(robot, {"chain.band.rest_length_mm": 9})
    bands = [b for leg in long.legs for cell in leg.chain.levers for b in cell.bands]
    assert {band.rest_length for band in bands} == {0.009}


def loads_back(robot: Robot) -> Robot:
    from stepwell.files import dumps

    return loads(dumps(robot)).robot
