"""Compiled behaviours in the simulation: walks row by row, arenas, and the robot as made."""

from dataclasses import replace
from functools import cache

import pytest

import stepwell as sw
from accounts.schemas import violations
from facts import says
from stepwell.accounts import account, page, terminal
from stepwell.robot import Action, BehaviourRow, Compiled
from stepwell.simulation import CompiledRobot, RowTrial, Trial, behaviour_trials, verified

pytest.importorskip("mujoco")


@cache
def compiled() -> Compiled:
    table = sw.files.load_behaviour("turn-away")
    choice = replace(table.choice, inner_bands=(2,), below=(0.0008,), moves=(0.004,))
    return sw.robot.compile_behaviour(replace(table, choice=choice), samples=50)


@cache
def result() -> CompiledRobot:
    return verified(compiled())


def test_the_best_design_with_the_paper_s_displacement_has_all_rows_in_the_simulation():
    found = result()
    assert found.verified and len(found.trials) == 1 and found.design is not None
    free, left, right, both = found.walked
    assert free.trial.advance > 0.5 and abs(free.trial.turn) < 0.01
    assert left.trial.turn < -0.2 and right.trial.turn > 0.2
    assert both.trial.advance < -0.5
    for row, margin in zip(found.walked, found.design.rows, strict=True):
        assert row.trial.gaits == tuple(gait.states for gait in margin.gaits)


def test_the_arenas_and_the_parts_of_a_result_are_of_its_robot():
    found = result().in_arenas([sw.load_arena("wall")], limit=3)
    assert found.arenas[0].walk.robot == found.robot
    # The parts have other masses: here the feet are heavier.
    heavy = replace(found.robot, foot=replace(found.robot.foot, mass=0.012))
    made = found.with_parts(heavy)
    assert found.design is not None
    assert made.made == heavy and len(made.made_trials) == len(made.made_rows) == 4
    assert made.made_rows[0].orders != found.design.rows[0].orders


def test_without_walks_a_result_is_not_verified_and_without_a_design_nothing_walks():
    assert not verified(compiled(), most=0).verified
    rows = [BehaviourRow(row.contact, Action.STOP) for row in compiled().behaviour.rows]
    table = replace(compiled().behaviour, rows=rows)
    found = verified(replace(nothing(), behaviour=table))
    assert (found.design, found.walked, found.robot) == (None, (), table.robot)
    assert found.with_parts(found.robot) == found


@pytest.mark.parametrize(
    ("motion", "advance", "turn", "right"),
    [
        ("forward", 0.5, 0.0, True),
        ("forward", 0.5, 0.2, False),
        ("forward", 0.05, 0.0, False),
        ("backward", -0.5, 0.0, True),
        ("turn left", -0.1, 0.3, True),
        ("turn left", -0.1, -0.3, False),
        ("veer right", 0.4, -0.1, True),
        ("stop", 0.02, 0.01, True),
        ("stop", 0.5, 0.01, False),
        ("any", 0.5, 0.3, True),
    ],
)
def test_a_row_is_right_if_the_robot_moves_as_it_says(motion, advance, turn, right):
    row, trial = BehaviourRow("free", Action(motion)), Trial(advance, 0.0, turn, ("", ""), 0.0, "")
    assert RowTrial(row, trial).right is right
    assert not RowTrial(row, replace(trial, stopped="fell")).right


def test_a_robot_of_another_table_is_refused():
    robot = sw.preset("robot-forward")
    with pytest.raises(KeyError):
        behaviour_trials(compiled().behaviour, [robot])


def test_the_forms_of_a_result_agree_and_keep_to_the_schema():
    found = account(result())
    assert violations(found.record) == []
    text = "\n".join(line.text for line in terminal(found, full=True))
    margin = f"{found.record['design']['margin_mN']:.3g}"
    assert all(margin in form for form in (text, page(found)))
    says(text, "all rows", "in simulation")
    assert violations(account(result().with_parts(result().robot)).record) == []
    assert violations(account(CompiledRobot(nothing(), ())).record) == []


def nothing() -> Compiled:
    return replace(compiled(), designs=())
