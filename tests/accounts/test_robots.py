"""The accounts of robots: predicted, walked, in an arena, many of them, at several time steps."""

import math
from dataclasses import replace
from importlib import import_module

import pytest

pytest.importorskip("mujoco")

import stepwell as sw
from accounts.schemas import violations
from facts import says
from stepwell import files
from stepwell.accounts import About, account, card, page, terminal
from stepwell.accounts.robots.robot import depth_words
from stepwell.paper import AssumedRange, AssumedRanges
from stepwell.robot import leg_cycles, predict
from stepwell.simulation import Convergence, Resolution, Sweep, Trial, compare_gaits

# A wall that the robot meets in its second cycle.
_WALL = {"from_mm": [180, -120], "to_mm": [330, 120], "thickness_mm": 20}
_ARENA = {"start_mm": [0, 0], "wall": [_WALL], "goal": {"at_mm": [150, 0], "radius_mm": 60}}


@pytest.fixture(scope="module")
def prediction():
    return sw.preset("robot-forward").predict()


def test_a_depth_at_which_the_gait_is_uncertain_is_no_range():
    text = depth_words(sw.preset("robot-forward"), [(9e-4, 9e-4), (0.0, 1e-3)])
    says(text, "left uncertain", "right 0.00", "1.00 mm")


@pytest.fixture(scope="module")
def walk():
    return sw.preset("robot-forward").walk(2)


@pytest.fixture(scope="module")
def maze():
    return sw.preset("robot-explorer").maze(files.loads_arena_tables(_ARENA), limit=12)


@pytest.fixture(scope="module")
def sweep():
    nothing = float("nan")
    trials = (
        Trial(0.72, -0.1, 0.3, ("00>10>11>01>00", ""), 0.0021, ""),
        Trial(nothing, nothing, nothing, ("", ""), nothing, "foot.below_mm = -1: must be >= 0."),
    )
    return Sweep({"foot.below_mm": [0.9, -1.0]}, trials)


@pytest.fixture(scope="module")
def convergence():
    rows = (Resolution(1e-3, 0.752, 0.0, 0.0015, 0.025), Resolution(5e-4, 0.75, 0.0, 0.0, 0.011))
    return Convergence(sw.preset("robot-forward"), rows)


@pytest.fixture(scope="module")
def ranges():
    """Ranges of two numbers: one ends above, the other nowhere."""
    rows = (
        AssumedRange("rail [N]", ("blocks.rail_friction_N",), 0.0, 0.0, 0.0328, "", "00>01>11"),
        AssumedRange("mass [g]", ("body.mass_g",), 260.0, 52.0, 1300.0, "", ""),
    )
    return AssumedRanges(sw.preset("robot-forward"), ("00>10>11>01>00",) * 2, rows)


def text_of(found) -> str:
    return "\n".join(line.text for line in terminal(found, full=True))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["prediction", "walk", "maze", "sweep", "convergence", "ranges"])
def test_every_record_keeps_to_the_generated_schema(name, request):
    found = account(request.getfixturevalue(name))
    assert violations(found.record) == []
    assert found.record["schema"] == f"stepwell.{found.kind}"
    assert text_of(found) and card(found) and page(found)


@pytest.mark.slow
def test_a_robot_with_antennas_keeps_to_the_schema_too():
    robot = sw.preset("robot-explorer")
    found = account(robot.predict())
    assert violations(found.record) == []
    assert violations(account(robot.walk(1)).record) == []
    assert all(leg["flips"] for leg in found.record["prediction"]["legs"])
    assert "earliest" in text_of(found)


@pytest.mark.slow
def test_every_form_of_a_prediction_has_motion_gait_and_margin(prediction):
    found = account(prediction)
    leg = found.record["prediction"]["legs"][0]
    margin = f"{leg['margin_mN']:.3g}"
    for form in (text_of(found), card(found), page(found)):
        assert "Walks forward" in form or "Walks forward".lower() in form
        assert f"{prediction.advance:.2f}" in form
        assert margin in form and leg["gait"] in form.replace("&gt;", ">")
    assert f"{prediction.robot.weight:.4g} N" in text_of(found)
    # Every number with its source.
    assert {one["source"] for one in found.record["parameters"]} >= {"assumed", "paper"}
    assert all(one["key"] in page(found) for one in found.record["parameters"])


def test_a_leg_that_may_have_another_gait_and_a_soft_drive_are_warned_of(prediction):
    legs = tuple(replace(leg, alternatives=("00>01>00",)) for leg in prediction.legs)
    found = account(replace(prediction, legs=legs, too_soft="the drive is too soft"))
    notes = [note for warned in found.warnings for note in warned.lines]
    assert len(notes) == len(legs) + 1
    for form in (text_of(found), card(found), page(found)):
        assert "00>01>00" in form.replace("&gt;", ">") and "drive is too soft" in form


def test_every_form_of_a_walk_has_distance_advance_and_transport(walk):
    found = account(walk)
    record = found.record
    # Kamp et al. 2024, Fig. 3C: 0.71 of the largest step in a cycle.
    assert record["mean_advance_over_u_max"] == pytest.approx(0.71, abs=0.08)
    assert record["as_predicted"] is True
    for form in (text_of(found), card(found), page(found)):
        assert f"{record['distance_mm']:.4g} mm" in form
        assert f"{record['mean_advance_over_u_max']:.3f}" in form
        assert f"{record['cost_of_transport']:.3g}" in form
    legs = [leg["feet_mm"] for leg in record["legs"]]
    assert all(f"{least:.2f} to {most:.2f} mm" in text_of(found) for least, most in legs)
    assert sum(one["source"] == "assumed" for one in record["parameters"]) > 0


def test_a_walk_that_ended_early_is_warned_of_in_every_form(walk):
    found = account(replace(walk, stopped="Stopped at 3 s: it fell over."))
    for form in (text_of(found), card(found), page(found)):
        assert "it fell over" in form


def test_a_maze_has_its_seeds_outcome_contacts_and_which_leg_they_change(maze):
    robot = maze.walk.robot
    found = account(maze, About(robot, seeds={"start_seed": 3, "layout_seed": None}))
    record = found.record
    assert violations(record) == []
    assert (record["start_seed"], record["layout_seed"]) == (3, None)
    assert record["contacts"] and record["outcome"] in ("reached", "timed_out")
    assert record["end_mm"] == pytest.approx([1e3 * one for one in maze.end])
    for form in (text_of(found), card(found), page(found)):
        assert str(maze.outcome) in form.lower()
        assert f"1 of {len(maze.touched)}" in form
    assert "reprograms" in text_of(found)
    off = replace(robot, antennas=[replace(one, connected=False) for one in robot.antennas])
    apart = account(replace(maze, walk=replace(maze.walk, robot=off)))
    assert "levers disconnected: left, right" in text_of(apart)
    assert "nothing" in text_of(apart)


def test_a_sweep_has_the_reason_of_every_robot_that_stopped(sweep):
    found = account(sweep, About(seeds={"values": 4}))
    assert found.record["seed"] == 4
    good, bad = found.record["trials"]
    assert good["values"] == [0.9] and good["advance_over_u_max"] == 0.72
    assert math.isclose(good["turn_deg"], math.degrees(0.3)) and good["work_mJ"] == 2.1
    assert bad["advance_over_u_max"] is None
    for form in (text_of(found), card(found), page(found)):
        assert "1 of 2 runs" in form and "0.720" in form
        assert "must be" in form


def test_a_convergence_has_the_largest_deviation_and_its_definition(convergence):
    found = account(convergence)
    assert found.record["time_steps"][0]["forces_off_percent"] == pytest.approx(0.15)
    for form in (text_of(found), card(found), page(found)):
        assert "0.750 to 0.752" in form and "0.15 %" in form
    assert "root mean square" in text_of(found).lower()


def test_ranges_have_the_gait_that_stays_and_the_states_outside(ranges):
    found = account(ranges)
    rail, mass = found.record["ranges"]
    assert (rail["low"], rail["high"], rail["above"]) == (0.0, 0.0328, "00>01>11")
    assert mass["keys"] == ["body.mass_g"] and not mass["above"]
    for form in (text_of(found), card(found), page(found)):
        assert "1 of these end" in form and "0.0328" in form


def test_robots_and_arenas_have_cards_of_their_own():
    robot, arena = sw.preset("robot-explorer"), sw.load_arena("cylinder")
    assert f"{robot.mass * 1e3:.4g} g" in card(account(robot))
    assert "0 walls and 1 cylinder" in card(account(arena))


def test_a_card_of_a_walk_compares_nothing_and_accounts_simulate_nothing(
    prediction, walk, monkeypatch
):
    def refuse(*_, **__):
        raise AssertionError("an account calls the engine")

    comparing = import_module(compare_gaits.__module__)
    predicting = import_module(predict.__module__)
    fresh = replace(walk)
    with monkeypatch.context() as patched:
        patched.setattr(comparing, "compare_gaits", refuse)
        assert "Cost of transport" in card(account(fresh))
        with pytest.raises(AssertionError, match="calls the engine"):
            _ = fresh.comparison
    # What is computed when it is first asked for is kept in the value.
    assert account(walk).record and account(prediction).record
    for name in ("leg_cycles", "run_leg_cycle", "run_leg_cycles"):
        monkeypatch.setattr(leg_cycles, name, refuse)
    for name in ("slide", "changes"):
        monkeypatch.setattr(predicting, name, refuse)
    monkeypatch.setattr(comparing, "compare_gaits", refuse)
    for value in (walk, prediction):
        found = account(value)
        assert found.record and terminal(found) and card(found) and page(found)
