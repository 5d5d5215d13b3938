"""Compiled behaviours: the closed form agrees with the engine, and conflicts are the smallest."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import stepwell as sw
from facts import refuses
from stepwell.robot import (
    BehaviourRow,
    RobotBehaviour,
    RobotChoice,
    compile_behaviour,
    predicted_gaits,
    rows_of,
)
from stepwell.robot.behaviour import Action, LegGait
from stepwell.robot.behaviour_search import DesignSearch, pressed
from stepwell.robot.compiling import contradiction
from stepwell.robot.gait_rules import Bands, GaitRules
from stepwell.robot.stance import Leaning, leaning

FEW = RobotChoice(inner_bands=(2,), below=(0.0009,), moves=(0.004,))
TURN_AWAY = ("forward", "turn right", "turn left", "backward")


def behaviour(motions=TURN_AWAY, choice=FEW) -> RobotBehaviour:
    contacts = ("free", "left", "right", "both")
    rows = [
        BehaviourRow(contact, Action(motion))
        for contact, motion in zip(contacts, motions, strict=True)
    ]
    return RobotBehaviour(rows, sw.preset("robot-antennas"), choice)


@cache
def compiled():
    return compile_behaviour(behaviour())


def test_gaits_of_the_closed_form_are_those_that_statics_follows():
    # Two designs, all rows of a table; each pair of gaits is followed through its equilibria.
    for design in compiled().designs[:2]:
        swings = {one.name: one.swing for one in design.robot.antennas}
        for row in design.rows[:2]:
            names = compiled().behaviour.touched(row.row.contact)
            robot = design.robot.pressed({name: swings[name] for name in names})
            assert predicted_gaits(robot) == tuple(gait.states for gait in row.gaits)


def test_a_design_with_a_negative_margin_has_another_gait():
    design = compiled().designs[0]
    # An outer band that closes late: its F1 is beyond that of the inner cell.
    robot = design.robot.with_anchors("left", 1, q=(0.0, 0.0))
    robot = robot.with_anchors("right", 1, q=(0.0, 0.0))
    rows = rows_of(compiled().behaviour, robot, design.places.wiring)
    assert rows[0].force < 0
    assert predicted_gaits(robot) != ("00>10>11>01>00",) * 2


def test_the_weight_on_each_foot_is_that_of_the_engine():
    robot = compiled().designs[0].robot
    robot = robot.pressed({"left": robot.antennas[0].swing})
    cells = [leg.chain.levers for leg in robot.legs]
    lacks = np.array([outer.force_0 - inner.force_0 for inner, outer in cells])
    assert Leaning.of(robot).force(lacks) == pytest.approx(leaning(robot))


def test_forces_of_many_bands_are_those_of_their_cells():
    cell = sw.preset("robot-antennas").legs[0].chain.levers[0]
    band = cell.bands[0]
    dx, dy = band.d
    many = Bands(dx, dy, band.stiffness, band.rest_length, band.law)
    for angle in np.linspace(-cell.limit, cell.limit, 5):
        assert many.force(angle, cell.lever) == pytest.approx(float(cell.force(angle)), abs=1e-12)


def test_the_paper_s_displacement_is_enough_and_the_best_design_has_two_inner_bands():
    choice = RobotChoice(below=(0.0009,), moves=(0.004,))
    found = compile_behaviour(behaviour(choice=choice), samples=50)
    one, two = found.displaced
    assert (one.inner_bands, two.inner_bands) == (1, 2)
    # Half of the smaller change of F0 and F1, which the number of bands multiplies.
    assert two.bound == pytest.approx(2 * one.bound)
    assert one.bound / found.force == pytest.approx(0.118, abs=0.001)
    assert two.margin > one.margin > 0
    assert found.designs[0].places.inner_bands == 2


def test_margins_are_distances_to_the_loss_of_a_row():
    design, table = compiled().designs[0], compiled().behaviour
    row = min(design.rows, key=lambda one: one.anchor)
    reach = 1.05 * row.anchor
    lost = []
    for leg in ("left", "right"):
        for cell in (0, 1):
            q = design.robot.leg(leg).chain.levers[cell].bands[0].q
            for angle in np.linspace(0.0, 2 * np.pi, 24):
                at = (q[0] + reach * np.cos(angle), q[1] + reach * np.sin(angle))
                robot = design.robot.with_anchors(leg, cell, q=at)
                rows = rows_of(table, robot, design.places.wiring)
                lost.append(min(one.force for one in rows) < 0)
    # Slopes are linear, and the margin is 1 to 2 mm.
    assert any(lost) and not all(lost)


def test_a_band_returns_the_anchor_only_from_displacements_away_from_it():
    moves = {design.places.moves for design in compiled().designs}
    assert all(x < 0 for x, _ in moves)


def test_one_touch_that_reverses_both_legs_is_proved_to_exclude_a_free_walk():
    table = behaviour(("forward", "backward", "backward", "any"))
    found = compile_behaviour(table)
    assert (found.conflict, found.proved, found.searched) == (("free", "left"), True, 0)
    assert contradiction(behaviour()) == ()


def test_a_conflict_is_the_smallest_set_of_rows():
    table = behaviour(("forward", "turn right", "turn left", "stop"))
    found = compile_behaviour(table)
    assert found.searched == found.total and not found.designs and not found.proved
    assert found.conflict
    open_rows = dict.fromkeys(("free", "left", "right", "both"), "any")
    for left_out in found.conflict:
        motions = {row.contact: row.motion for row in table.rows if row.contact in found.conflict}
        motions = open_rows | motions | {left_out: "any"}
        search = DesignSearch(behaviour(tuple(motions.values())))
        assert search.run(found.total, None) == found.total
        assert search.met > 0, left_out


def test_a_budget_that_is_too_small_decides_nothing():
    table = behaviour(("forward", "turn right", "turn left", "stop"))
    found = compile_behaviour(table, most=10)
    assert (found.decided, found.conflict, found.designs, found.searched) == (False, (), (), 0)


def test_the_robot_of_a_result_is_read_back_from_its_file(tmp_path):
    robot = compiled().robot
    sw.save(robot, tmp_path / "robot.toml")
    assert sw.load(tmp_path / "robot.toml") == robot
    assert {one.moves for one in robot.antennas} == {compiled().designs[0].places.moves}
    before = compiled().behaviour.robot
    assert robot.antennas[0].gear == pytest.approx(before.antennas[0].gear)
    assert robot.body == before.body


def test_yields_are_reproducible_and_fall_with_the_tolerances():
    wide = sw.Tolerances(anchor=0.002, stiffness=0.2)
    few = replace(FEW, outer_bands=(1,))
    narrow = compile_behaviour(behaviour(choice=few), samples=40).designs[0]
    again = compile_behaviour(behaviour(choice=few), samples=40).designs[0]
    worse = compile_behaviour(behaviour(choice=few), samples=40, tolerances=wide).designs[0]
    assert again == narrow
    assert worse.built.estimate < narrow.built.estimate


def test_a_gait_in_words_has_the_states_of_its_orders():
    assert LegGait(True, True).states == "00>10>11>01>00"
    assert LegGait(False, False).states == "00>01>11>10>00"
    assert LegGait(True, False).states == "00>10>11>10>00"
    assert Action("turn left").mirrored is Action("turn right")
    assert behaviour().is_mirrored


def test_both_wirings_of_the_antennas_are_possible():
    assert pressed(behaviour(), (1, 0), "left") == (False, True)
    assert pressed(behaviour(), (0, 1), "left") == (True, False)
    assert pressed(behaviour(), (0, 1), "both") == (True, True)


@pytest.mark.parametrize(
    ("rows", "facts"),
    [
        ([("free", "forward")], ("'left' has no", "'right' has no", "'both' has no")),
        ([("free", "forward")] * 2, ("'free' has 2 rows",)),
        ([("rear", "forward")], ("'rear'", "no such antenna", "'left'")),
    ],
)
def test_a_table_with_a_row_missing_or_twice_or_without_an_antenna_is_refused(rows, facts):
    with refuses(sw.InputError, facts[0]) as error:
        RobotBehaviour([BehaviourRow(*row) for row in rows], sw.preset("robot-antennas"))
    for fact in facts:
        assert fact in str(error.value)


def test_a_robot_without_antennas_and_numbers_out_of_range_are_refused():
    with refuses(sw.InputError, "0 antennas"):
        RobotBehaviour([BehaviourRow("free", Action("forward"))], sw.preset("robot-forward"))
    numbers: list[dict[str, Any]] = [{"moves": (0.0,)}, {"moves": ()}, {"directions": 0}]
    numbers.append({"left": 1.0})
    for keys in numbers:
        with pytest.raises(sw.InputError):
            RobotChoice(**keys)


def test_rules_hold_the_rail_friction_against_the_inner_cell():
    robot = compiled().designs[0].robot
    rubbing = replace(robot, blocks=replace(robot.blocks, rail_friction=0.05))
    before, after = GaitRules(robot), GaitRules(rubbing)
    assert (before.rail, after.rail) == (0.0, 0.05)
    wiring = compiled().designs[0].places.wiring
    forward = [rows_of(compiled().behaviour, one, wiring)[0].force for one in (robot, rubbing)]
    assert forward[1] == pytest.approx(forward[0] - 0.05, abs=0.01)
