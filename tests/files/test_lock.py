"""One process writes into a folder at a time; what killed processes left is removed."""

from __future__ import annotations

import errno
import logging
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from facts import refuses, says
from stepwell.files import BusyError, folder, manifest, staged_folder, write_atomic
from stepwell.files.folder import only_writer

posix = pytest.mark.skipif(os.name != "posix", reason="signals and flock")

WRITER = """
import sys
from stepwell.files import staged_folder
word = sys.argv[1]
with staged_folder("out", "run", names=("a", "b", "of-red", "of-blue")) as draft:
    print("begun", flush=True)
    sys.stdin.readline()
    for name in ("a", "b", f"of-{word}"):
        (draft / name).write_text(word)
"""


def begun(place: Path, word: str) -> subprocess.Popen[str]:
    """A process that writes into `place`/out as soon as it gets a line."""
    pipe = subprocess.PIPE
    return subprocess.Popen(
        [sys.executable, "-c", WRITER, word],
        cwd=place, stdin=pipe, stdout=pipe, stderr=pipe, text=True,
    )  # fmt: skip


def write(out: Path, word: str) -> None:
    with staged_folder(out, "run", names=("a",)) as draft:
        (draft / "a").write_text(word)


@pytest.fixture
def impatient(monkeypatch):
    monkeypatch.setattr(
        folder, "only_writer", lambda file, shown, *_: only_writer(file, shown, 0.0)
    )


@pytest.mark.slow
@pytest.mark.parametrize("there", [False, True], ids=["a new folder", "a folder that is there"])
def test_writers_of_one_folder_wait_for_each_other_and_all_results_are_whole(tmp_path, there):
    out = tmp_path / "out"
    if there:
        out.mkdir()
    writers = [begun(tmp_path, word) for word in ("red", "blue")]
    for one in writers:
        assert one.stdin is not None
        one.stdin.write("\n")
        one.stdin.flush()
    ended = [one.communicate() for one in writers]
    assert [one.returncode for one in writers] == [0, 0], ended
    whole = manifest(out)["files"]
    (word,) = {(out / name).read_text() for name in whole}
    assert set(whole) == {"a", "b", f"of-{word}"}
    assert set(os.listdir(out)) == {*whole, "stepwell.json"}
    assert os.listdir(tmp_path) == ["out"]


@posix
@pytest.mark.slow
@pytest.mark.parametrize("there", [False, True], ids=["a new folder", "a folder that is there"])
def test_what_a_killed_writer_left_is_removed_and_its_lock_is_free(tmp_path, there, impatient):
    out = tmp_path / "out"
    if there:
        out.mkdir()
    one = begun(tmp_path, "red")
    assert one.stdout is not None
    assert one.stdout.readline() == "begun\n"
    with refuses(BusyError, "out", "another stepwell command", "0 s", "Wait", "remove", ".lock"):
        write(out, "blue")
    one.kill()
    one.communicate()
    write(out, "blue")
    assert set(os.listdir(out)) == {"a", "stepwell.json"}
    assert os.listdir(tmp_path) == ["out"]


def test_drafts_of_a_writer_that_is_alive_are_kept(tmp_path):
    out = tmp_path / "out"
    with staged_folder(out, "run", names=("a",)) as draft:
        (draft / "a").write_text("first")
        out.mkdir()  # by hand: who comes now writes inside it
        write(out, "second")
        assert draft.is_dir()
    assert (out / "a").read_text() == "first"
    assert os.listdir(tmp_path) == ["out"]


def test_who_waits_reports_it_in_one_line(tmp_path, caplog, impatient):
    with staged_folder(tmp_path / "out", "run", names=("a",)) as draft:
        (draft / "a").write_text("a")
        file = tmp_path / ".out.lock"
        with (
            caplog.at_level(logging.WARNING, "stepwell"),
            refuses(BusyError, "out", "1 s", "Wait", "another place"),
            only_writer(file, "out", 0.6),
        ):
            pytest.fail("two at once")
    (line,) = caplog.messages
    says(line, "out: ", "another stepwell command", "1 s")


@posix
@pytest.mark.parametrize("answer", [errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP])
def test_a_disk_without_locks_is_written_by_one_process_at_a_time_too(
    tmp_path, monkeypatch, impatient, answer
):
    import fcntl

    def none_here(*_):
        raise OSError(answer, "No locks available")

    monkeypatch.setattr(fcntl, "flock", none_here)
    out = tmp_path / "out"
    with staged_folder(out, "run", names=("a",)) as draft:
        (draft / "a").write_text("a")
        with pytest.raises(BusyError, match=r"remove .*\.locked\."):
            write(out, "b")
    write(out, "c")
    assert (out / "a").read_text() == "c"
    assert set(os.listdir(out)) == {"a", "stepwell.json"}
    assert os.listdir(tmp_path) == ["out"]


@posix
@pytest.mark.skipif(os.name == "posix" and os.geteuid() == 0, reason="root writes everywhere")
def test_a_folder_that_may_not_be_written_is_named(tmp_path):
    out = tmp_path / "out"
    out.mkdir(0o500)
    with refuses(PermissionError, "name a folder") as caught:
        write(out, "a")
    assert caught.value.filename == str(out)


def test_a_file_that_two_write_at_once_is_that_of_one_of_them(tmp_path):
    texts = ("a" * 9999, "b" * 9999)
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda text: write_atomic(tmp_path / "x.png", text), texts * 10))
    assert (tmp_path / "x.png").read_text() in texts
    assert os.listdir(tmp_path) == ["x.png"]
