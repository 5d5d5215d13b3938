"""A study loses nothing: whatever is killed, damaged or done twice, the store ends the same."""

import math
import multiprocessing
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st

import stepwell as sw
from dying import marked
from facts import refuses, says
from sizes import examples
from studies_bytes import bytes_of

pytest.importorskip("zarr", reason="studies are not tested: zarr is not installed")

from stepwell.accounts import account
from stepwell.studies import (
    Axis,
    CancelledError,
    How,
    ListedDesigns,
    Space,
    Study,
    StudyError,
    SweepError,
    Workshop,
    begun,
    cancel,
    estimate,
    extended,
    function_of,
    opened,
    planned_study,
    read_table,
    resumed,
    status,
    store,
    sweep,
    unit_in,
)
from stepwell.studies.fill import fill
from stepwell.studies.work import work_of

AXES = (Axis("outer.q.x", 0.0, 0.020, 9), Axis("outer.q.y", -0.015, 0.015, 7))
GRID = Space(AXES)
LEG = sw.preset("paper-forward")
CHUNK = 8

CLIENT = """
import sys
import stepwell as sw
from stepwell.studies import Axis, Space, sweep

if __name__ == "__main__":
    axes = Axis("outer.q.x", 0.0, 0.020, 9), Axis("outer.q.y", -0.015, 0.015, 7)
    folder, workers = sys.argv[1], int(sys.argv[2])
    sweep(sw.preset("paper-forward"), "cycle", Space(axes), folder, chunk=8, workers=workers)
"""


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Study:
    """The whole grid, computed by two processes: nothing is written there any more."""
    folder = tmp_path_factory.mktemp("undisturbed") / "study.zarr"
    result = sweep(LEG, "cycle", GRID, folder, chunk=CHUNK, workers=2)
    assert result.finished
    return result.study


@pytest.fixture(scope="module")
def undisturbed(whole) -> dict[str, str]:
    return bytes_of(whole.folder)


def client(folder: Path, workers: int = 1, **options) -> Any:
    script = folder.parent / "client.py"
    script.write_text(CLIENT)
    command = [sys.executable, str(script), str(folder), str(workers)]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, **options)


def children(pid: int) -> list[int]:
    file = Path(f"/proc/{pid}/task/{pid}/children")
    return [int(one) for one in file.read_text().split()] if file.exists() else []


@given(st.sampled_from(list(How)), st.integers(0, 2**63), st.integers(0, 60), st.integers(1, 63))
def test_a_design_is_the_same_for_every_worker(how, seed, first, count):
    space = Space(AXES, how, 63, seed)
    last = min(first + count, 63)
    whole = space.points(0, 63)
    assert np.array_equal(space.points(first, last), whole[first:last])
    low, high = np.array([[a.low, a.high] for a in AXES]).T
    assert np.all((low <= whole) & (whole <= high))


def test_a_latin_hypercube_has_one_design_in_every_slice():
    points = Space(AXES, How.LATIN, 50, 1).points(0, 50)
    for axis, values in zip(AXES, points.T, strict=True):
        shares = (values - axis.low) / (axis.high - axis.low)
        assert sorted(np.floor(shares * 50).astype(int)) == list(range(50))


@pytest.mark.slow
def test_a_store_holds_what_the_engine_says(whole):
    data = whole.to_xarray()
    assert data.peak_force.attrs["units"] == "N" and data["outer.q.x"].attrs["units"] == "m"
    for row in range(0, GRID.count, 5):
        x, y = float(data["outer.q.x"][row]), float(data["outer.q.y"][row])
        inner, outer = LEG.cells
        cycle = sw.Chain([inner, outer.with_anchors(q=(x, y))]).cycle()
        assert str(data.sequence.values[row]) == str(cycle.sequence)
        assert float(data.peak_force[row]) == abs(cycle.peak_force)
    assert not any(data.problem.values)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("what", "columns"),
    [("margin", ["anchor", "stiffness"]), ("yield", ["fraction"]), ("graph", ["states"])],
)
def test_other_things_are_computed_too(tmp_path, what, columns):
    axes = (Axis("outer.q.x", 0.018, 0.022, 2),)
    data = sweep(LEG, what, Space(axes), tmp_path / "s.zarr", workers=0).study.to_xarray()
    for name in columns:
        assert np.all(np.isfinite(data[name].values))


@pytest.mark.slow
def test_without_processes_the_bytes_are_the_same(tmp_path, undisturbed):
    before = multiprocessing.active_children()
    study = sweep(LEG, "cycle", GRID, tmp_path / "s.zarr", chunk=CHUNK, workers=0).study
    assert multiprocessing.active_children() == before
    assert bytes_of(study.folder) == undisturbed
    with refuses(sw.InputError, "workers = -1", "0 or more"):
        resumed(study, -1)


@pytest.mark.slow
def test_workers_and_clients_killed_at_random_leave_the_same_bytes(tmp_path, undisturbed):
    dice, folder, kills = random.Random(5), tmp_path / "study.zarr", 0
    wanted = examples(2, 100)
    while kills < wanted:
        running = client(folder, workers=2)
        time.sleep(dice.uniform(0.3, 4.0))
        for one in children(running.pid):
            if dice.random() < 0.6:
                os.kill(one, signal.SIGKILL)
                kills += 1
        time.sleep(dice.uniform(0.0, 1.0))
        if running.poll() is None:
            running.kill()
            kills += 1
        running.communicate()
        if folder.exists() and status(folder).finished and kills < wanted:
            # It was faster than the kills: some of it is lost again.
            for file in dice.sample([*folder.rglob("c/*")], 10):
                file.unlink()
    last = client(folder)
    assert last.communicate()[1] == b"" and last.returncode == 0
    assert bytes_of(folder) == undisturbed


@pytest.mark.slow
def test_what_is_damaged_or_gone_is_reported_and_done_again(tmp_path, whole, undisturbed):
    folder = shutil.copytree(whole.folder, tmp_path / "study.zarr")
    study = opened(folder)
    cut, flipped, gone = (folder / name for name in ("sequence/c/1", "snaps/c/3", "problem/c/5"))
    cut.write_bytes(cut.read_bytes()[:-3])
    spoilt = bytearray(flipped.read_bytes())
    spoilt[len(spoilt) // 2] ^= 4
    flipped.write_bytes(bytes(spoilt))
    gone.unlink()
    assert study.missing() == [1, 3, 5] and status(folder).done == study.chunks - 3
    # What holds can be read meanwhile.
    numbers = {one["column"]: one for one in account(status(folder)).record["numbers"]}
    assert numbers["snaps"]["designs"] == GRID.count - CHUNK
    assert study.to_csv(tmp_path / "some.csv", partial=True) == GRID.count - 3 * CHUNK
    assert resumed(opened(folder), 0).finished
    assert bytes_of(folder) == undisturbed


@pytest.mark.slow
def test_a_full_disk_ends_it_with_a_word_and_room_lets_it_go_on(tmp_path, undisturbed):
    folder = tmp_path / "study.zarr"
    store.begun(Study(folder, "cycle", sw.files.dumps(LEG), GRID, CHUNK))

    def little() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (60, 60))

    full = client(folder, preexec_fn=little)
    stderr = full.communicate()[1].decode()
    assert full.returncode == 1
    says(stderr.replace("\n", " "), "chunks", "File too large", "same command")
    assert not status(folder).finished
    assert resumed(opened(folder), 0).finished
    assert bytes_of(folder) == undisturbed


@pytest.mark.slow
def test_two_clients_at_once_write_the_same(tmp_path, undisturbed):
    folder = tmp_path / "study.zarr"
    # Each by itself: that workers write together is looked at above.
    both = [client(folder, workers=0), client(folder, workers=0)]
    for one in both:
        assert one.communicate()[1] == b"" and one.returncode == 0
    assert bytes_of(folder) == undisturbed


def test_a_design_that_cannot_be_has_a_problem_and_the_others_go_on(tmp_path):
    axes = (Axis("outer.lever", -0.010, 0.020, 4),)
    result = sweep(LEG, "cycle", Space(axes), tmp_path / "s.zarr", workers=0)
    data = result.study.to_xarray()
    assert [bool(one) for one in data.problem.values] == [True, True, False, False]
    assert np.isnan(data.peak_force.values[:2]).all() and np.isfinite(data.peak_force[3])
    assert result.finished and sum(result.problems.values()) == 2


def test_another_study_and_another_version_are_refused(tmp_path):
    folder, text = tmp_path / "study.zarr", sw.files.dumps(LEG)
    store.begun(Study(folder, "cycle", text, GRID, CHUNK))
    with pytest.raises(StudyError, match="another study"):
        sweep(LEG, "margin", GRID, folder, chunk=CHUNK)
    with refuses(StudyError, str(folder), "Stepwell", "this is 9.9", "another"):
        store.begun(Study(folder, "cycle", text, GRID, CHUNK, version="9.9"))
    with pytest.raises(StudyError, match="contains no study"):
        opened(tmp_path)


@pytest.mark.slow
def test_a_call_whose_process_always_dies_is_reported_and_no_other_is_lost(tmp_path):
    from stepwell.studies import mapped

    calls = {}
    for (name,), raised in mapped(marked, [(str(tmp_path / n),) for n in "abcdie"], 2):
        calls[Path(name).name] = raised
    assert {name for name, raised in calls.items() if raised is None} == set("abce")
    assert "died 3 times" in str(calls["d"]) and "SIGKILL" in str(calls["d"])
    assert isinstance(calls["i"], OSError)


@pytest.mark.slow
def test_a_study_that_fails_says_how_far_it_is(tmp_path, monkeypatch):
    folder = tmp_path / "s.zarr"
    study = store.begun(Study(folder, "cycle", sw.files.dumps(LEG), GRID, CHUNK))
    folder.joinpath("zarr.json").write_text("{}")
    with refuses(SweepError, str(folder), "0 of 8", "chunk 0", "no study", "same command"):
        resumed(study, 1)


@pytest.mark.slow
def test_a_study_that_grows_ends_as_if_it_had_been_so_large_from_the_start(tmp_path):
    small, large = (Space((Axis("outer.q.x", 0.0, 0.02),), How.SOBOL, n, seed=3) for n in (4, 9))
    grown, whole = tmp_path / "grown.zarr", tmp_path / "whole.zarr"
    result = sweep(LEG, "yield", small, grown, chunk=CHUNK, workers=0)
    before = result.study.column("fraction")[:]
    after = resumed(extended(result.study, 9), 0)
    sweep(LEG, "yield", large, whole, chunk=CHUNK, workers=0)
    assert bytes_of(grown) == bytes_of(whole)
    assert after.finished and (after.study.column("fraction")[:4] == before).all()
    with pytest.raises(StudyError, match="8 would be fewer"):
        extended(after.study, 8)


@pytest.mark.slow
def test_a_worker_that_has_a_study_open_sees_that_it_has_grown_or_is_another(tmp_path):
    folder, space = tmp_path / "s.zarr", Space((Axis("outer.q.x", 0.0, 0.020),), How.RANDOM, 4, 1)
    study = begun(planned_study(LEG, "cycle", space, folder, chunk=4))
    fill(str(folder), study.identity, 0)
    grown = extended(study, 8)
    fill(str(folder), study.identity, 1)
    assert grown.done_chunks() == [0, 1]
    assert not np.isnan(grown.values("outer.q.x")).any()
    shutil.rmtree(folder)
    with pytest.raises(StudyError, match="contains no study"):
        fill(str(folder), study.identity, 1)
    other = begun(planned_study(LEG, "cycle", replace(space, seed=2), folder, chunk=4))
    with pytest.raises(StudyError, match="another study"):
        fill(str(folder), study.identity, 0)
    assert other.done_chunks() == []


@pytest.mark.slow
def test_a_grid_a_list_and_a_hypercube_are_not_extended(tmp_path):
    for k, designs in enumerate(
        (GRID, ListedDesigns(("outer.q.x",), np.array([[0.01]])), Space(AXES[:1], How.LATIN, 4))
    ):
        study = store.begun(Study(tmp_path / str(k), "cycle", sw.files.dumps(LEG), designs, 4))
        with refuses(StudyError, "change", "extended"):
            extended(study, 400)


@pytest.mark.slow
def test_mechanisms_as_built_are_those_that_a_yield_judges(tmp_path):
    from stepwell.design import Draws

    within = sw.Tolerances(anchor=0.002, stiffness=0.1, friction=0.01)
    data = sweep(LEG, "cycle", Workshop(within, 12, seed=5), tmp_path / "s.zarr", workers=0)
    drawn, table = Draws(LEG, within, 5), data.study.to_xarray()
    for k in range(12):
        chain = drawn.sample(k)
        assert table.sequence.values[k] == str(chain.cycle().sequence)
        assert table.peak_force.values[k] == abs(chain.cycle().peak_force)
        assert table["2.q.x"].values[k] == chain.levers[1].bands[0].q[0]
        assert table["1.friction"].values[k] == chain.cells[0].friction


@pytest.mark.slow
def test_a_table_that_was_exported_is_a_list_of_the_same_designs(tmp_path):
    first = sweep(LEG, "margin", Space(AXES, How.RANDOM, 5), tmp_path / "a.zarr", workers=0)
    first.study.to_csv(tmp_path / "all.csv")
    lines = (tmp_path / "all.csv").read_text().splitlines()
    kept = "\n".join(",".join(line.split(",")[:3]) for line in lines)
    (tmp_path / "list.csv").write_text(kept + "\n")
    listed = read_table(tmp_path / "list.csv", LEG)
    assert listed.columns == ("outer.q.x", "outer.q.y")
    again = sweep(LEG, "margin", listed, tmp_path / "b.zarr", workers=0).study
    assert np.allclose(again.column("anchor")[:], first.study.column("anchor")[:], rtol=1e-9)
    group = opened(tmp_path / "b.zarr").group
    group["listed"][0] = 0.5
    with refuses(StudyError, "b.zarr", "list", "damaged"):
        opened(tmp_path / "b.zarr")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("outer.q.x_mm\n1\nx\n", "line 3, outer.q.x = 'x': must be a number"),
        ("outer.q.x_mm\n1,2\n", "line 2 has 2 cells: must have 1"),
        ("outer.q.z_mm\n1\n", "column 'outer.q.z_mm'"),
        ("outer.q.x_N\n1\n", "column 'outer.q.x_N'"),
        ("outer.q.x_mm,outer.q.x\n1,2\n", "each once"),
        ("outer.q.x_mm\nnan\n", "must be finite"),
        ("", "must be one or more"),
    ],
)
def test_a_list_that_cannot_be_read_says_which_line_and_why(tmp_path, text, message):
    (tmp_path / "list.csv").write_text(text)
    with pytest.raises(ValueError, match=message):
        read_table(tmp_path / "list.csv", LEG)


@pytest.mark.slow
def test_a_study_that_is_cancelled_stops_and_goes_on_later(tmp_path, undisturbed):
    folder = tmp_path / "study.zarr"
    study = store.begun(Study(folder, "cycle", sw.files.dumps(LEG), GRID, CHUNK))

    def stop(_done: int, _all: int) -> None:
        cancel(study)

    with pytest.raises(CancelledError, match="It was cancelled"):
        resumed(study, 1, progress=stop)
    assert 0 < status(folder).done < study.chunks
    assert resumed(study, 0).finished and bytes_of(folder) == undisturbed


@pytest.mark.slow
def test_programs_are_found_of_every_design_or_proved_impossible(tmp_path):
    space = Space((Axis("outer.q.x", 0.0, 0.02, 5),))
    from stepwell.design import parameter

    given = {"start": "00", "target": "01"}
    data = sweep(LEG, "program", space, tmp_path / "p.zarr", given=given, workers=0)
    table = data.study.to_xarray()
    for k, x in enumerate(np.linspace(0.0, 0.02, 5)):
        chain = parameter(LEG, "outer.q.x").changed(LEG, x)
        try:
            wanted = chain.program("01", start="00").strokes
        except sw.Unreachable:
            wanted = 0
        assert table.found.values[k] == (wanted > 0)
        assert not wanted or table.strokes.values[k] == wanted


OWN = """
def measure(chain, seed):
    if chain.cells[1].bands[0].q[0] > 0.015:
        raise KeyError("too far")
    return {"seed": float(seed), "cells": len(chain), "name": chain.title}

measure.units = {"seed": "s"}

def other(chain, seed):
    return {"x": 1.0} if seed else {"y": 1.0}

def wrong(chain, seed):
    return 3
"""


def test_a_function_of_ones_own_is_called_on_every_design_and_kept_as_it_was(tmp_path):
    file = tmp_path / "own.py"
    file.write_text(OWN)
    space = Space((Axis("outer.q.x", 0.0, 0.02, 3),))
    given = function_of(f"{file}:measure", sw.preset("three-wave"))
    folder = tmp_path / "s.zarr"
    result = sweep(LEG, "call", space, folder, given=given, workers=0)
    data = result.study.to_xarray()
    assert result.problems == {"KeyError": 1} and "too far" in data.problem.values[2]
    assert data.seed.attrs["units"] == "s" and data.cells.values[0] == 2
    assert [int(one) for one in data.seed.values[:2]] == [result.study.seed_of(k) for k in (0, 1)]
    given = function_of(f"{file}:other", LEG)
    result = sweep(LEG, "call", space, tmp_path / "o.zarr", given=given, workers=0)
    assert result.problems == {"StudyError": 3}  # another name than on the design as it was
    (folder / "seed" / "c" / "0").unlink()
    file.write_text(OWN + "# changed\n")
    with refuses(ValueError, str(file), "SHA-256"):
        resumed(opened(folder), 1)
    assert not (tmp_path / "__pycache__").exists()
    (tmp_path / "broken.py").write_text("1 / 0\n")
    with refuses(ValueError, "broken.py:f", "ZeroDivisionError"):
        function_of(f"{tmp_path / 'broken.py'}:f", LEG)
    for name, message in (
        ("wrong", "must give values by name"),
        ("none", "no function of that name"),
    ):
        with pytest.raises(ValueError, match=message):
            function_of(f"{file}:{name}", LEG)


@pytest.mark.slow
def test_robots_walk_and_find_their_way_as_they_do_alone(tmp_path):
    pytest.importorskip("mujoco", reason="robots' studies are not tested: mujoco is not installed")
    from stepwell.simulation import Trial, walk

    robot = sw.preset("robot-forward")
    space = Space((Axis("foot.below_mm", 0.3, 0.6, 2),))
    data = sweep(robot, "walk", space, tmp_path / "w.zarr", given={"cycles": 1}, workers=0)
    table = data.study.to_xarray()
    alone = Trial.of(walk(sw.files.vary(robot, {"foot.below_mm": 0.6}), 1))
    assert table.advance.values[1] == alone.advance and table["foot.below_mm"].units == "mm"
    data.study.to_csv(tmp_path / "w.csv")
    head, first, _ = (tmp_path / "w.csv").read_text().splitlines()
    assert head.startswith("design,foot.below_mm,advance") and first.startswith("0,0.3,")
    (spanned,) = account(data).record["varied"]
    assert (spanned["from"], spanned["to"]) == (0.3, 0.6)
    arena = sw.files.dumps(sw.load_arena("pen"))
    given = {"arena": arena, "limit": 1.0, "layouts": 2}
    ways = sweep(robot, "maze", space, tmp_path / "m.zarr", given=given, workers=0).study
    assert ways.to_xarray().outcomes.values.tolist() == ["timed out, timed out"] * 2


@pytest.mark.parametrize(
    ("what", "given", "message"),
    [
        ("cycle", {"cycles": 2}, "takes nothing else, not cycles"),
        ("program", {}, "target: must be a state"),
        ("walk", {}, "needs a robot"),
        ("cicle", {}, "Did you mean cycle"),
        ("call", {"file": "gone.py", "name": "f"}, "must be FILE.py:NAME"),
    ],
)
def test_what_cannot_be_computed_is_refused_before_anything_is_written(
    tmp_path, what, given, message
):
    with pytest.raises(ValueError, match=message):
        sweep(LEG, what, GRID, tmp_path / "s.zarr", given=given)
    assert not (tmp_path / "s.zarr").exists()


@pytest.mark.slow
def test_a_name_that_is_no_folder_is_no_column_and_the_number_of_the_cell_is(tmp_path):
    for name in ("a/b", "..", "a\\b", "__init"):
        cells = [replace(cell, name=name + str(k)) for k, cell in enumerate(LEG.cells)]
        leg = replace(LEG, cells=tuple(cells))
        with refuses(ValueError, "column", "1.q.x"):
            sweep(leg, "cycle", Space((Axis(f"{name}1.q.x", 0.0, 0.02, 2),)), tmp_path / "s")
        assert not (tmp_path / "s").exists()
    assert sweep(
        leg, "cycle", Space((Axis("2.q.x", 0.0, 0.02, 2),)), tmp_path / "s", workers=0
    ).finished


@pytest.mark.parametrize(
    "change",
    [
        {"format": "1"},
        {"chunk": 0},
        {"chunk": "many"},
        {"design": "nonsense"},
        {"designs": {"axes": [], "how": "grid", "count": 1, "seed": 0}},
        {"designs": {"columns": ["outer.q.x"], "sha256": "0"}},
        {"other": 1},
        {"given": None},
    ],
)
def test_a_description_that_was_changed_by_hand_is_refused(tmp_path, change):
    study = store.begun(Study(tmp_path / "s", "cycle", sw.files.dumps(LEG), GRID, CHUNK))
    study.group.attrs["stepwell_study"] = study.asked() | change
    with pytest.raises(StudyError):
        opened(tmp_path / "s")


@pytest.mark.slow
def test_an_estimate_is_of_all_designs_and_its_disk_is_an_upper_bound(tmp_path):
    study = Study(tmp_path / "s.zarr", "cycle", sw.files.dumps(LEG), GRID, CHUNK)
    result = estimate(study, 2)
    assert result.designs == 63 and result.sample == 8 and result.each > 0
    assert result.seconds == pytest.approx(result.each * 63 / 2)
    done = resumed(store.begun(study), 0).study
    chunks = (done.folder / name / "c" for name in done.columns)
    assert not any(file.stat().st_size > result.disk for one in chunks for file in one.iterdir())


@pytest.mark.slow
def test_the_best_of_a_study_are_a_list_that_another_study_takes(tmp_path, whole):
    first = whole
    snaps, peak = first.values("snaps"), first.values("peak_force")
    best = first.best(5, ["snaps", "-peak_force"])
    wanted = sorted(range(GRID.count), key=lambda k: (-snaps[k], peak[k], k))[:5]
    assert np.array_equal(best.rows, GRID.points(0, GRID.count)[wanted])
    best.to_csv(tmp_path / "best.csv", LEG)
    listed = read_table(tmp_path / "best.csv", LEG)
    again = sweep(LEG, "cycle", listed, tmp_path / "b.zarr", workers=0).study
    assert np.allclose(again.values("peak_force"), peak[wanted], rtol=1e-9)
    for count, by in ((0, ["snaps"]), (1, []), (1, ["sequence"]), (1, ["snap"])):
        with pytest.raises(ValueError, match=r"must be"):
            first.best(count, by)


def test_designs_are_ranked_by_value_then_by_the_next_column_and_never_without_a_value():
    from stepwell.studies.screen import ranked

    share, time = [0.5, 1.0, math.nan, 1.0, 0.5, 1.0], [3.0, 9.0, 1.0, math.nan, 3.0, 2.0]
    columns = {"fraction": np.array(share), "time": np.array(time)}
    assert ranked(columns, ["fraction", "-time"]) == [5, 1, 3, 0, 4]
    assert ranked(columns, ["-fraction"]) == [0, 4, 1, 3, 5]
    assert ranked(columns, ["time"]) == [1, 0, 4, 5, 2]


def test_keys_of_a_robot_take_a_number_together_each_with_its_sign():
    robot, name = sw.preset("robot-antennas"), "antenna.left.angle_deg,-antenna.right.angle_deg"
    space = Space((Axis(name, 40.0, 85.0, 2), Axis("antenna.*.hook_mm", 5.0, 9.0, 2)))
    assert space.names(robot) == (name, "antenna.*.hook_mm")
    (_, design), *_ = space.made(robot, 1, 2)
    assert isinstance(design, sw.Robot)
    assert [math.degrees(one.angle) for one in design.antennas] == pytest.approx([40.0, -40.0])
    assert [one.hook for one in design.antennas] == pytest.approx([0.009, 0.009])
    assert unit_in(robot, name) == "deg"
    with refuses(ValueError, "antenna.left.length_mm", "in deg", "in mm"):
        unit_in(robot, "antenna.left.angle_deg,antenna.left.length_mm")
    with pytest.raises(ValueError, match="leg"):
        unit_in(robot, 'leg."a,b".at_mm[0]')


def test_the_layouts_of_a_maze_differ_by_as_much_as_is_asked(monkeypatch):
    simulation = pytest.importorskip("stepwell.simulation")
    seen = []
    end = SimpleNamespace(outcome=simulation.Outcome.TIMED_OUT)
    monkeypatch.setattr(simulation, "maze", lambda _robot, arena, **_: seen.append(arena) or end)
    robot, arena = sw.preset("robot-antennas"), sw.load_arena("three-walls")
    given = {"arena": sw.files.dumps(arena), "layouts": 2, "first": 7}
    for spread in ({}, {"place": 0.1, "angle": 1.0}, {"place": 0.0, "angle": 0.0}):
        work_of("maze", given | spread, robot).row(robot, 0)
        for k, met in enumerate(seen[-2:], 7):
            assert met.walls == sw.robot.other_layout(arena, k, **spread).walls
            assert met.start == sw.robot.other_start(arena, k).start
    with refuses(ValueError, "place = -1.0", ">= 0"):
        work_of("maze", given | {"place": -1.0}, robot)
    with refuses(ValueError, "angle", "layouts = 0"):
        work_of("maze", given | {"layouts": 0, "angle": 1.0}, robot)


@pytest.mark.slow
def test_parquet_holds_what_csv_holds(tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet", reason="Parquet is not tested: no pyarrow")
    study = sweep(LEG, "cycle", Space(AXES, How.RANDOM, 5), tmp_path / "a.zarr", workers=0).study
    assert study.to_parquet(tmp_path / "a.parquet") == study.to_csv(tmp_path / "a.csv") == 5
    table = parquet.read_table(tmp_path / "a.parquet")
    head, *lines = (tmp_path / "a.csv").read_text().splitlines()
    assert table.column_names == head.split(",")
    assert table["peak_force_N"][2].as_py() == pytest.approx(float(lines[2].split(",")[5]))
