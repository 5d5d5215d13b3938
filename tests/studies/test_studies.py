"""A study loses nothing: whatever is killed, damaged or done twice, the store ends the same."""

import hashlib
import os
import random
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st

import stepwell as sw
from dying import marked
from sizes import examples

pytest.importorskip("zarr", reason="studies are not tested: zarr is not installed")

from stepwell.studies import (
    Axis,
    How,
    Space,
    Study,
    StudyError,
    SweepError,
    opened,
    resumed,
    status,
    store,
    sweep,
)

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
    sweep(sw.preset("paper-forward"), "cycle", Space(axes), sys.argv[1], chunk=8, workers=2)
"""


def bytes_of(folder: Path) -> dict[str, str]:
    """The digest of every file of a store; drafts that somebody left are none of it."""
    return {
        file.relative_to(folder).as_posix(): hashlib.sha256(file.read_bytes()).hexdigest()
        for file in sorted(folder.rglob("*"))
        if file.is_file() and not file.name.endswith(".partial")
    }


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory) -> dict[str, str]:
    folder = tmp_path_factory.mktemp("undisturbed") / "study.zarr"
    assert sweep(LEG, "cycle", GRID, folder, chunk=CHUNK, workers=2).finished
    return bytes_of(folder)


def client(folder: Path, **told) -> subprocess.Popen[bytes]:
    script = folder.parent / "client.py"
    script.write_text(CLIENT)
    command = [sys.executable, str(script), str(folder)]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, **told)


def children(pid: int) -> list[int]:
    file = Path(f"/proc/{pid}/task/{pid}/children")
    return [int(one) for one in file.read_text().split()] if file.exists() else []


@given(st.sampled_from(list(How)), st.integers(0, 2**63), st.integers(0, 60), st.integers(1, 63))
def test_a_design_is_the_same_whoever_asks_for_it(how, seed, first, count):
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


def test_a_store_holds_what_the_engine_says(tmp_path):
    found = sweep(LEG, "cycle", GRID, tmp_path / "s.zarr", chunk=CHUNK, workers=2)
    data = found.study.to_xarray()
    assert data.peak_force.attrs["units"] == "N" and data["outer.q.x"].attrs["units"] == "m"
    for row in range(0, GRID.count, 5):
        x, y = float(data["outer.q.x"][row]), float(data["outer.q.y"][row])
        inner, outer = LEG.cells
        cycle = sw.Chain([inner, outer.with_anchors(q=(x, y))]).cycle()
        assert str(data.sequence.values[row]) == str(cycle.sequence)
        assert float(data.peak_force[row]) == cycle.peak_force
    assert not any(data.problem.values)


@pytest.mark.parametrize(
    ("what", "columns"),
    [("margin", ["anchor", "stiffness"]), ("yield", ["share"]), ("graph", ["states"])],
)
def test_other_things_are_computed_too(tmp_path, what, columns):
    axes = (Axis("outer.q.x", 0.018, 0.022, 2),)
    data = sweep(LEG, what, Space(axes), tmp_path / "s.zarr", workers=1).study.to_xarray()
    for name in columns:
        assert np.all(np.isfinite(data[name].values))


@pytest.mark.slow
def test_workers_and_clients_killed_at_random_leave_the_same_bytes(tmp_path, undisturbed):
    dice, folder, kills = random.Random(5), tmp_path / "study.zarr", 0
    wanted = examples(12, 100)
    while kills < wanted:
        running = client(folder)
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


def test_what_is_damaged_or_gone_is_told_and_done_again(tmp_path, undisturbed):
    folder = tmp_path / "study.zarr"
    study = sweep(LEG, "cycle", GRID, folder, chunk=CHUNK, workers=2).study
    cut, flipped, gone = (folder / name for name in ("sequence/c/1", "snaps/c/3", "problem/c/5"))
    cut.write_bytes(cut.read_bytes()[:-3])
    spoilt = bytearray(flipped.read_bytes())
    spoilt[len(spoilt) // 2] ^= 4
    flipped.write_bytes(bytes(spoilt))
    gone.unlink()
    assert study.missing() == [1, 3, 5] and status(folder).done == study.chunks - 3
    assert resumed(opened(folder), 2).finished
    assert bytes_of(folder) == undisturbed


def test_a_full_disk_ends_it_with_a_word_and_room_lets_it_go_on(tmp_path, undisturbed):
    folder = tmp_path / "study.zarr"
    store.begun(Study(folder, "cycle", sw.files.dumps(LEG), GRID, CHUNK))

    def little() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (60, 60))

    full = client(folder, preexec_fn=little)
    told = full.communicate()[1].decode()
    assert full.returncode == 1 and "File too large" in told and "goes on with the others" in told
    assert not status(folder).finished
    assert resumed(opened(folder), 2).finished
    assert bytes_of(folder) == undisturbed


def test_two_clients_at_once_write_the_same(tmp_path, undisturbed):
    folder = tmp_path / "study.zarr"
    both = [client(folder), client(folder)]
    for one in both:
        assert one.communicate()[1] == b"" and one.returncode == 0
    assert bytes_of(folder) == undisturbed


def test_a_design_that_cannot_be_has_a_problem_and_the_others_go_on(tmp_path):
    axes = (Axis("outer.lever", -0.010, 0.020, 4),)
    found = sweep(LEG, "cycle", Space(axes), tmp_path / "s.zarr", workers=1)
    data = found.study.to_xarray()
    assert [bool(one) for one in data.problem.values] == [True, True, False, False]
    assert np.isnan(data.peak_force.values[:2]).all() and np.isfinite(data.peak_force[3])
    assert found.finished and sum(found.problems.values()) == 2


def test_another_study_and_another_version_are_refused(tmp_path):
    folder, text = tmp_path / "study.zarr", sw.files.dumps(LEG)
    store.begun(Study(folder, "cycle", text, GRID, CHUNK))
    with pytest.raises(StudyError, match="holds another study"):
        sweep(LEG, "margin", GRID, folder, chunk=CHUNK)
    with pytest.raises(StudyError, match=r"begun by Stepwell .*, and this is 9\.9: numbers of two"):
        store.begun(Study(folder, "cycle", text, GRID, CHUNK, version="9.9"))
    with pytest.raises(StudyError, match="holds no study"):
        opened(tmp_path)


def test_a_call_whose_process_always_dies_is_told_and_no_other_is_lost(tmp_path):
    from stepwell.studies import mapped

    calls = {}
    for (name,), raised in mapped(marked, [(str(tmp_path / n),) for n in "abcdie"], 2):
        calls[Path(name).name] = raised
    assert {name for name, raised in calls.items() if raised is None} == set("abce")
    assert "died 3 times" in str(calls["d"]) and "SIGKILL" in str(calls["d"])
    assert isinstance(calls["i"], OSError)


def test_a_study_that_fails_says_how_far_it_is(tmp_path, monkeypatch):
    folder = tmp_path / "s.zarr"
    study = store.begun(Study(folder, "cycle", sw.files.dumps(LEG), GRID, CHUNK))
    folder.joinpath("zarr.json").write_text("{}")
    with pytest.raises(SweepError, match=r"0 of 8 chunks are done\. chunk 0: .*holds no study"):
        resumed(study, 1)
