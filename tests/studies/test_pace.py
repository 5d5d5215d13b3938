"""The speed of a study follows from the times of its chunk files."""

import os
from pathlib import Path

import pytest

import stepwell as sw
from stepwell.studies import Axis, How, Space, pace, planned_study

AXES = (Axis("outer.q.x", 0.0, 0.020),)


def written(tmp_path: Path, *times: float, count: int = 1000):
    """A study of chunks of 10 designs, each written at that time."""
    designs = Space(AXES, How.RANDOM, count)
    study = planned_study(
        sw.preset("paper-forward"), "cycle", designs, tmp_path / "a.zarr", chunk=10
    )
    folder = study.folder / "problem" / "c"
    folder.mkdir(parents=True)
    for chunk, at in enumerate(times):
        (folder / str(chunk)).touch()
        os.utime(folder / str(chunk), (at, at))
    return study


def test_a_rate_is_that_of_the_last_stretch_without_a_pause(tmp_path):
    before = [1000.0 + k for k in range(5)]
    after = [90_000.0 + 0.5 * k for k in range(9)]
    speed = pace(written(tmp_path, *before, *after), now=90_005.0)
    assert speed is not None
    assert speed.rate == pytest.approx(10 / 0.5)
    assert speed.since == pytest.approx(1.0)
    assert speed.at_work


def test_paused_work_is_distinguished_from_slow_work(tmp_path):
    quick = pace(written(tmp_path / "a", 0.0, 1.0, 2.0), now=100.0)
    slow = pace(written(tmp_path / "b", 0.0, 90.0, 180.0), now=300.0)
    assert quick is not None and not quick.at_work
    assert slow is not None and slow.at_work
    assert slow.rate == pytest.approx(10 / 90)


def test_the_last_chunk_counts_as_the_designs_that_it_has(tmp_path):
    speed = pace(written(tmp_path, 0.0, 1.0, 2.0, count=25), now=3.0)
    assert speed is not None and speed.rate == pytest.approx(15 / 2)


@pytest.mark.parametrize("times", [(), (5.0,), (5.0, 5.0), (0.0, 1.0, 1e6)])
def test_too_little_says_nothing(tmp_path, times):
    assert pace(written(tmp_path, *times), now=1e6 + 1) is None


def test_what_is_not_begun_has_no_pace(tmp_path):
    study = planned_study(sw.preset("paper-forward"), "cycle", Space(AXES), tmp_path / "none.zarr")
    assert pace(study) is None
