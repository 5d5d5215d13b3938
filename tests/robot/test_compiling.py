"""Compiled behaviours: the closed form agrees with the engine, and conflicts are the smallest."""

from dataclasses import replace
from functools import cache
from itertools import product
from typing import Any

import numpy as np
import pytest

import stepwell as sw
from facts import refuses
from stepwell.robot import (
    CURVE,
    STEPS,
    BehaviourRow,
    LegNumbers,
    RobotBehaviour,
    RobotChoice,
    compile_behaviour,
    predicted_gaits,
    rows_of,
)
from stepwell.robot.behaviour import Action, LegGait
from stepwell.robot.behaviour_search import DesignSearch, PairSearch, pressed, row_margins
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


def test_a_row_that_is_left_open_limits_neither_margin_nor_yield():
    table, robot = behaviour(("forward", "turn right", "turn left", "any")), compiled().robot
    wiring = compiled().designs[0].places.wiring
    closed, rows = rows_of(behaviour(), robot, wiring), rows_of(table, robot, wiring)
    assert [one.force for one in rows[:3]] == [one.force for one in closed[:3]]
    assert rows[3].force == rows[3].anchor == np.inf
    found = compile_behaviour(table, samples=20).designs[0]
    assert 0.0 < found.margin == min(one.force for one in found.rows[:3])


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
        ([(one, "any") for one in ("free", "left", "right", "both")], ("all of them",)),
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


def follower(**given) -> RobotBehaviour:
    """A table that no two equal legs have, with few holes."""
    keys = {"pitch": 0.01, "inner_bands": (1, 2), "outer_bands": (1, 2), "directions": 2}
    choice = replace(FEW, below=(0.001,), **keys | given)
    return behaviour(("veer right", "any", "back left", "back left"), choice)


@cache
def unequal():
    return compile_behaviour(follower(inner_bands=(2,)), samples=50)


def every_pair(table: RobotBehaviour) -> dict[Any, float]:
    """Smallest margin of all rows, for every pair of usable legs, one pair after another."""
    choice, robot, margins = table.choice, table.robot, {}
    rules = GaitRules.at_depth(robot, choice.below[0])
    band = robot.legs[0].chain.levers[-1].bands[0]
    holes = [np.array(one) for one in choice.holes]

    def bands(cell: int, hole: Any, count: int) -> Bands:
        d = hole - np.array(robot.legs[0].chain.levers[cell].bands[0].p)
        return Bands(d[0], d[1], count * band.stiffness, band.rest_length, band.law)

    moves, legs = np.array(choice.displacements[1]), []
    for inner, outer in product(holes, holes):
        for i, o in product(choice.inner_bands, choice.outer_bands):
            rest, lifts = bands(0, inner, i), bands(1, outer, o)
            moved = rest.displaced(*moves)
            fall = all(rules.falling(one) for one in (rest, moved, lifts))
            if fall and all(rules.returned(one, moves) for one in (rest, moved)):
                key = LegNumbers(tuple(inner), tuple(outer), i, o)
                legs.append((key, (rules.forces(rest, lifts), rules.forces(moved, lifts))))
    for wiring in ((1, 0), (0, 1)):
        rows = [(row.motion, pressed(table, wiring, row.contact)) for row in table.rows]
        for (one, left), (other, right) in product(legs, legs):
            margins[one, other, wiring] = float(row_margins(rules, rows, (left, right))[0].min())
    return margins


def test_bounds_leave_out_no_pair_of_legs_with_a_larger_margin():
    table = follower(left=0.01, bottom=0.0, top=0.01, inner_bands=(2,))
    margins = every_pair(table)
    search = PairSearch(table)
    assert search.run(10**9, None) == search.total == table.choice.pairs
    found = {(*places.legs, places.wiring): places for places in search.best()}
    best = sorted((margin for margin in margins.values() if margin > 0), reverse=True)
    ours = sorted((margins[key] for key in found), reverse=True)
    assert ours == pytest.approx(best[: len(ours)]) and len(ours) == min(len(best), 200)


def test_a_table_that_is_not_its_mirror_image_has_legs_that_differ():
    design = unequal().designs[0]
    assert not unequal().equal_legs and design.places.right is not None
    assert unequal().total == unequal().behaviour.choice.pairs
    left, right = (leg.chain.levers[0].bands[0].q for leg in design.robot.legs)
    assert (left, right) == tuple(one.inner for one in design.places.legs)
    assert predicted_gaits(design.robot) == tuple(gait.states for gait in design.rows[0].gaits)
    few = compile_behaviour(unequal().behaviour, most=1)
    assert (few.decided, few.searched < few.total, few.designs) == (False, True, ())


def test_a_curve_is_a_difference_of_steps_and_counts_in_the_yield():
    choice = replace(FEW, below=(0.001,), directions=2, pitch=0.01)
    table = behaviour(("curve right", "any", "turn left", "any"), choice)
    found = compile_behaviour(table, samples=50)
    design = found.designs[0]
    rules = GaitRules(design.robot)
    left, right = (
        float(rules.step(*(bands_of(leg.chain.levers[i].bands[0]) for i in (0, 1))))
        for leg in design.robot.legs
    )
    least, most = CURVE
    assert least <= -rules.turn(left, right) <= most
    assert all(gait == STEPS for gait in design.rows[0].gaits)
    # The mirrored table has the mirrored designs.
    other = PairSearch(behaviour(("curve left", "turn right", "any", "any"), choice))
    assert other.run(10**9, None) == found.total and other.met == found.met


def bands_of(band: Any) -> Bands:
    dx, dy = band.d
    return Bands(dx, dy, band.stiffness, band.rest_length, band.law)


def test_one_touch_reverses_no_two_legs_and_both_antennas_turn_as_one_of_them():
    # One antenna moves one leg; the order in which the other unloads stays as it is.
    table = behaviour(("forward", "backward", "any", "any"))
    assert not table.is_mirrored
    assert contradiction(table) == ("free", "left")
    # The right leg, displaced, would have to unload in both orders.
    table = behaviour(("forward", "turn right", "turn left", "turn left"))
    assert contradiction(table) == ("left", "both")
    assert contradiction(behaviour(("forward", "any", "turn left", "turn left"))) == ()


def test_the_smallest_conflict_of_unequal_legs_is_among_all_pairs():
    table = follower(left=0.02, bottom=0.0, inner_bands=(1,), outer_bands=(1,), directions=1)
    found = compile_behaviour(table)
    assert found.searched == found.total and not found.designs and not found.proved
    margins = every_pair(follower(left=0.02, bottom=0.0, inner_bands=(1,), outer_bands=(1,)))
    assert max(margins.values(), default=-1.0) < 0
    assert found.conflict


def test_no_band_holds_an_anchor_displaced_that_it_returns_at_rest():
    # The energy of a band that only pulls is convex along a straight displacement of its anchor:
    # here from the energy itself, with anchors that need not be those of a bistable cell.
    random = np.random.default_rng(4)
    lever, rest, shares = 0.01414, 0.022, np.linspace(0.0, 1.0, 21)
    law = sw.preset("robot-antennas").legs[0].chain.levers[0].bands[0].law
    for _ in range(300):
        dx, dy = random.uniform(-0.03, 0.03, 2)
        x, y = random.uniform(-0.01, 0.01, 2)
        theta = random.uniform(-0.78, 0.78)
        along = lever * np.cos(theta) + dx - shares * x, lever * np.sin(theta) + dy - shares * y
        energy = np.maximum(np.hypot(*along) - rest, 0.0) ** 2
        slopes = np.diff(energy)
        assert (np.diff(slopes) >= -1e-15).all()
        band = Bands(dx, dy, 47.0, rest, law)
        pulls = [
            float(band.displaced(s * x, s * y).pull(theta, lever, (x, y))) for s in (0.0, 0.5, 1.0)
        ]
        assert pulls[0] <= pulls[1] + 1e-12 and pulls[1] <= pulls[2] + 1e-12
