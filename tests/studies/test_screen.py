"""A screen chooses what is computed, once; what it says is compared with what was computed."""

import os
import re
from typing import Any

import numpy as np
import pytest

import stepwell as sw
from facts import refuses
from studies_bytes import bytes_of

pytest.importorskip("zarr", reason="studies are not tested: zarr is not installed")
pytest.importorskip("mujoco", reason="robots' studies are not tested: mujoco is not installed")

from accounts.schemas import violations
from stepwell.accounts import account, terminal
from stepwell.base import ExtraError, InputError, extras
from stepwell.robot import Robot
from stepwell.simulation import Outcome, Trial
from stepwell.studies import (
    WORKS,
    Axis,
    Space,
    Study,
    begun,
    decided,
    estimate,
    planned_study,
    screened,
    status,
    store,
)
from stepwell.studies.fill import columns_of, fill
from stepwell.studies.work import Screen, Work

ROBOT = sw.preset("robot-forward")
COUNT, CHUNK = 20, 10
SPACE = Space((Axis("foot.below_mm", 0.2, 1.4, COUNT),))
GIVEN = {"engine": "warp", "wanted": "A"}


def below(robot: Any) -> float:
    return float(robot.foot.below * 1e3)


def does(robot: Any) -> str:
    return "A" if below(robot) < 0.8 else "B"


class Wrong:
    """A screen with prescribed errors, and an error in every second call."""

    def __init__(self, errs: tuple[int, ...] = (), untold: tuple[int, ...] = ()):
        self.errs, self.untold, self.asked = errs, untold, 0

    def verdicts(self, robots: Any) -> list[str]:
        self.asked += 1
        numbers = [round((below(one) - 0.2) / 1.2 * (COUNT - 1)) for one in robots]
        other = {"A": "B", "B": "A"}
        return [
            "" if k in self.untold else other[does(one)] if k in self.errs else does(one)
            for k, one in zip(numbers, robots, strict=True)
        ]


@pytest.fixture
def make(tmp_path, monkeypatch):
    """A study of a robot that does A or B, screened by somebody."""

    def made(screen: Any, name: str = "s.zarr") -> Study:
        def work(engine: str = "cpu", wanted: str = "") -> Work:
            return Work(
                {"depth": "m", "gaits": "text"},
                lambda robot, _seed: {"depth": below(robot) / 1e3, "gaits": does(robot)},
                Screen(screen.verdicts, lambda row: str(row["gaits"]), lambda v: v == wanted, str),
            )

        monkeypatch.setitem(WORKS, "walk", (Robot, work))
        monkeypatch.setattr(store, "ONE_OF", 3)  # of so few designs
        return begun(planned_study(ROBOT, "walk", SPACE, tmp_path / name, given=GIVEN, chunk=CHUNK))

    return made


def filled(study: Study) -> Study:
    for chunk in range(study.chunks):
        fill(str(study.folder), study.identity, chunk)
    return study


@pytest.mark.slow
def test_kept_undecided_and_some_random_designs_are_computed_and_no_other(make):
    study = filled(make(Wrong(untold=(13, 18))))
    data = study.to_xarray()
    lot = np.array([study.by_lot(k) for k in range(COUNT)])
    kept = data.screened.values == "A"
    known = data.screened.values != ""
    assert 0 < lot.sum() < COUNT and np.array_equal(data.lot.values, lot)
    assert np.flatnonzero(~known).tolist() == [13, 18]
    assert np.array_equal(data.again.values == 1, kept | ~known | lot)
    # A number that is there was computed, and by nobody else than who computes all.
    there = np.isfinite(data.depth.values)
    assert np.array_equal(there, data.again.values == 1)
    depths = data["foot.below_mm"].values[there] / 1e3
    assert data.depth.values[there] == pytest.approx(depths, rel=1e-12)


@pytest.mark.slow
def test_what_a_screen_says_first_stays_whatever_it_would_say_next(make, tmp_path):
    screen = Wrong(errs=(3,))
    study = filled(make(screen))
    whole, said = bytes_of(study.folder), screen.asked
    assert said == study.chunks
    for name in ("gaits", "screened", "depth"):
        (study.folder / name / "c" / "0").unlink()
    screen.errs = (1, 2, 5)
    fill(str(study.folder), study.identity, 0)
    assert bytes_of(study.folder) == whole and screen.asked == said


def test_of_two_that_screen_a_chunk_at_once_the_first_is_heard_by_both(make):
    study = make(Wrong())

    def slow() -> list[str]:
        assert study.once("screened", 0, lambda: ["first"]) == ["first"]
        return ["second"]

    assert study.once("screened", 0, slow) == ["first"]
    assert [one for one in os.listdir(study.folder / "screened") if one.startswith(".")] == [
        ".found-0-10.json"
    ]


@pytest.mark.slow
def test_agreement_is_what_counting_gives(make):
    errs = tuple(range(0, COUNT, 3))
    study = filled(make(Wrong(errs=errs, untold=(7, 15))))
    agreement = screened(study)
    assert agreement is not None
    rows = range(COUNT)
    truth = ["A" if 0.2 + 1.2 * k / (COUNT - 1) < 0.8 else "B" for k in rows]
    said = [
        "" if k in (7, 15) else {"A": "B", "B": "A"}[truth[k]] if k in errs else truth[k]
        for k in rows
    ]
    lot = [k for k in rows if study.by_lot(k) and said[k]]
    kept = [k for k in rows if said[k] == "A"]
    missed = [k for k in lot if said[k] == "B"]
    assert (agreement.designs, agreement.kept) == (COUNT - 2, len(kept))
    assert agreement.computed == len({*kept, 7, 15, *(k for k in rows if study.by_lot(k))})
    for share, times, of in (
        (agreement.alike, sum(said[k] == truth[k] for k in lot), len(lot)),
        (agreement.held, sum(truth[k] == "A" for k in kept), len(kept)),
        (agreement.missed, sum(truth[k] == "A" for k in missed), len(missed)),
    ):
        assert share is not None and (share.times, share.of) == (times, of) and of > 0


@pytest.mark.slow
def test_fractions_are_reported_for_random_designs_and_not_for_chosen_ones(make):
    study = filled(make(Wrong()))
    record = account(status(study)).record
    lot = [k for k in range(COUNT) if study.by_lot(k)]
    assert sum(one["designs"] for one in record["outcomes"]) == len(lot)
    assert record["decided"] == [] and decided(study) == ()
    assert [one["column"] for one in record["numbers"]] == ["depth"]
    assert violations(record) == []
    shown = " ".join(line.text for line in terminal(account(status(study))))
    assert "warp keeps 10 of 20" in shown and "drawn at random: " in shown


def test_a_study_that_is_not_screened_has_no_screen_and_asks_for_what_it_asked_before(tmp_path):
    study = planned_study(ROBOT, "walk", SPACE, tmp_path / "s.zarr", given={"cycles": 1})
    assert screened(study) is None and dict(study.given) == {"cycles": 1}
    assert not {"screened", "again", "lot"} & study.columns.keys()


@pytest.fixture
def simulated(monkeypatch) -> dict[str, Any]:
    """Prescribed results of robots instead of simulations."""
    from stepwell import simulation

    results: dict[str, Any] = {"trial": trial(), "outcomes": []}
    monkeypatch.setattr(simulation, "walk", lambda _robot, _cycles: None)
    monkeypatch.setattr(simulation.Trial, "of", lambda _walk: results["trial"])
    monkeypatch.setattr(extras, "find_spec", lambda _name: True)
    return results


def trial(stopped: str = "") -> Trial:
    return Trial(0.7, 0.0, 0.0, ("00>10>11>01>00", ""), 0.017, stopped)


def test_designs_are_kept_that_do_as_the_design_itself(simulated, tmp_path):
    def study(**given: Any) -> Study:
        return planned_study(
            ROBOT, "walk", SPACE, tmp_path / "s.zarr", given={"engine": "warp"} | given
        )

    mine = study()
    assert mine.given["wanted"] == "00>10>11>01>00 | none" and mine.chunk == 256
    screen = mine.work.screen
    assert screen is not None and screen.kept("00>10>11>01>00 | none")
    assert not screen.kept("00>10>11>01>00 | 00>10>11>01>00") and not screen.kept("stopped")
    assert study(wanted="stopped").given["wanted"] == "stopped"  # who says it is heard
    simulated["trial"] = trial("Stopped at 1.000 s: the robot fell over.")
    with refuses(InputError, "walk: ", "engine = 'warp'", "stops early"):
        study()
    with refuses(InputError, "engine = 'gpu'", "cpu, warp"):
        study(engine="gpu")
    with pytest.raises(InputError, match="number of designs selected by a screen"):
        estimate(mine, 1)


def test_a_screened_walk_says_what_a_walk_says_and_nothing_where_it_cannot(monkeypatch, tmp_path):
    from stepwell import simulation

    trials = (trial(), None, trial("Stopped at 1.000 s: the robot fell over."))
    monkeypatch.setattr(simulation, "screen_walks", lambda _robots, cycles: trials)
    given = {"engine": "warp", "wanted": "", "cycles": 2}
    screen = planned_study(ROBOT, "walk", SPACE, tmp_path / "s.zarr", given=given).work.screen
    assert screen is not None
    assert screen.verdicts([ROBOT] * 3) == ["00>10>11>01>00 | none", "", "stopped"]


def test_a_screened_maze_wants_as_many_layouts_reached_as_the_design_itself(monkeypatch, tmp_path):
    from stepwell import simulation

    reached, late = Outcome.REACHED, Outcome.TIMED_OUT
    ends = (reached, late, reached, None, reached, reached)
    monkeypatch.setattr(simulation, "screen_mazes", lambda _entries, limit: ends)
    arena = sw.files.dumps(sw.load_arena("pen"))
    given = {"engine": "warp", "arena": arena, "layouts": 2, "wanted": 2}
    study = planned_study(ROBOT, "maze", SPACE, tmp_path / "s.zarr", given=given)
    screen = study.work.screen
    assert screen is not None and study.chunk == 128
    assert screen.verdicts([ROBOT] * 3) == ["reached, timed out", "", "reached, reached"]
    assert not screen.kept("reached, timed out") and screen.kept("reached, reached")
    assert screen.aim("reached, timed out") == 1
    with refuses(InputError, "nominal", "no goal"):
        screen.aim("timed out, timed out")


def test_without_the_extra_a_screened_study_says_which_one_before_it_begins(monkeypatch, tmp_path):
    known = extras.find_spec
    gone = {"mujoco_warp"}
    monkeypatch.setattr(extras, "find_spec", lambda one: None if one in gone else known(one))
    place = tmp_path / "s.zarr"
    with pytest.raises(ExtraError, match=re.escape(extras.install("gpu"))):
        planned_study(ROBOT, "walk", SPACE, place, given={"engine": "warp"})
    assert not place.exists()


def test_a_design_that_cannot_be_is_not_screened_and_its_problem_is_reported(tmp_path, monkeypatch):
    seen: list[int] = []

    def verdicts(robots: Any) -> list[str]:
        seen.append(len(robots))
        return ["A"] * len(robots)

    screen = Screen(verdicts, lambda row: str(row["gaits"]), lambda verdict: verdict == "A", str)
    work = Work({"gaits": "text"}, lambda robot, _seed: {"gaits": does(robot)}, screen)
    monkeypatch.setitem(WORKS, "walk", (Robot, lambda engine="cpu", wanted="": work))
    axes = (Axis("body.mass_g", -50.0, 250.0, 2),)
    study = begun(planned_study(ROBOT, "walk", Space(axes), tmp_path / "s.zarr", given=GIVEN))
    columns = columns_of(study, 0)
    assert seen == [1] and list(columns["screened"]) == ["", "A"]
    assert str(columns["problem"][0]) and not str(columns["problem"][1])
