"""Many robots at once: each does what it does alone, and an interrupted sweep goes on."""

from dataclasses import replace

import numpy as np
import pytest

import stepwell as sw
from facts import refuses
from simulation.robots import cell, explorer, robot, walked
from stepwell.simulation import sweep
from stepwell.simulation.sweeps import Trial

ANCHORS = (0.005, 0.015, 0.020)


@pytest.mark.slow
def test_each_robot_of_a_sweep_does_what_it_does_alone():
    swept = sweep([robot(q) for q in ANCHORS], values={"q_m": ANCHORS}, cycles=2, threads=2)
    for q, trial in zip(ANCHORS, swept.trials, strict=True):
        alone = Trial.of(walked(q, q, 2))
        assert trial.gaits == alone.gaits
        assert trial.advance == pytest.approx(alone.advance, abs=1e-3)
        assert trial.turn == pytest.approx(alone.turn, abs=1e-3)
        assert trial.work == pytest.approx(alone.work, rel=1e-3)


@pytest.mark.slow
def test_the_number_of_threads_changes_no_number():
    robots = [robot(q) for q in ANCHORS] + [explorer()]
    assert sweep(robots, cycles=1, threads=1).trials == sweep(robots, cycles=1, threads=3).trials


@pytest.mark.slow
def test_a_sweep_that_was_interrupted_takes_up_only_what_is_missing(tmp_path, monkeypatch):
    robots = [robot(q) for q in np.linspace(0.005, 0.020, 10)]
    whole = sweep(robots, cycles=1, threads=1)

    def interrupt(done: int, total: int) -> None:
        assert total == len(robots)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sweep(robots, cycles=1, threads=1, keep=tmp_path, progress=interrupt)
    reported: list[int] = []
    again = sweep(
        robots, cycles=1, threads=1, keep=tmp_path, progress=lambda done, _: reported.append(done)
    )
    assert reported == [10]
    assert again.trials == whole.trials
    with pytest.raises(ValueError, match="holds another sweep"):
        sweep(robots, cycles=2, threads=1, keep=tmp_path)


@pytest.mark.slow
def test_a_robot_that_breaks_spoils_no_other():
    chain = sw.Chain([cell("inner", 0.010), cell("outer", 0.020, k=1e6)])
    broken = replace(robot(), legs=tuple(replace(leg, chain=chain) for leg in robot().legs))
    swept = sweep([robot(), broken, robot()], cycles=2, threads=1)
    assert [bool(trial.stopped) for trial in swept.trials] == [False, True, False]
    assert np.isnan(swept.trials[1].advance)
    assert swept.trials[0] == swept.trials[2] == sweep([robot()], cycles=2).trials[0]
    assert "1 stopped early" in repr(swept)


def test_a_sweep_is_a_table_with_units(tmp_path):
    swept = sweep([robot(q) for q in ANCHORS], values={"q_mm": (5, 15, 20)}, cycles=1)
    table = swept.to_xarray()
    assert table["turn"].units == "rad"
    assert list(table["q_mm"].values) == [5, 15, 20]
    swept.to_csv(tmp_path / "sweep.csv")
    lines = (tmp_path / "sweep.csv").read_text("utf-8").splitlines()
    head = "q_mm,advance_over_u_max,sideways_over_u_max,turn_deg,work_mJ,gait_1,gait_2,stopped"
    assert lines[0] == head
    assert [line.split(",")[0] for line in lines[1:]] == ["5.0", "15.0", "20.0"]


def test_a_sweep_refuses_values_that_do_not_match_its_robots():
    with refuses(ValueError, "values['q']", "2 numbers", "3"):
        sweep([robot(q) for q in ANCHORS], values={"q": (1, 2)})
    with pytest.raises(ValueError, match=r"cycles = 0: must be >= 1"):
        sweep([robot()], cycles=0)
