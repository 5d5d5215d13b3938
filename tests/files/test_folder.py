"""A folder of results is of one run, says whether it is whole, and replaces nobody's work."""

import errno
import json
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from facts import refuses
from stepwell import files
from stepwell.files import (
    DesignError,
    IncompleteError,
    OverwriteError,
    check_folder,
    manifest,
    staged_folder,
)

OLD = {"design.toml": "old", "result.json": "old", "walk.mp4": "old", "same": "same"}
NEW = {"design.toml": "new", "result.json": "new", "path.csv": "new", "same": "same"}
NAMES = (*OLD, *NEW)


def write(out, texts, command="run", **options) -> None:
    with staged_folder(out, command, {"seed": 3}, names=NAMES, **options) as draft:
        for name, text in texts.items():
            (draft / name).write_text(text)


def held(out) -> dict[str, str]:
    """What a folder holds, without what it says of itself."""
    theirs = (p for p in out.iterdir() if p.is_file() and not p.name.startswith("stepwell."))
    return {p.name: p.read_text() for p in theirs}


class Killed(BaseException):
    pass


STEPS = ("replace", "rename", "unlink", "mkdir", "rmdir", "open", "fsync")


def killed_at(step: int, monkeypatch, work) -> bool:
    """Whether `work` was killed before its so-many-th change of the disk; the dead tidy nothing."""
    done = 0

    def counted(call):
        def until(*args, **kwargs):
            nonlocal done
            if done == step:
                raise Killed
            done += 1
            return call(*args, **kwargs)

        return until

    with monkeypatch.context() as patch:
        for name in STEPS:
            patch.setattr(os, name, counted(getattr(os, name)))
        try:
            work()
        except Killed:
            return True
    return False


@pytest.mark.slow
@pytest.mark.parametrize("before", [{}, OLD], ids=["a new folder", "an old result"])
def test_a_kill_at_any_step_leaves_one_result_or_a_folder_called_incomplete(
    tmp_path, monkeypatch, before
):
    monkeypatch.setattr(os, "fsync", lambda _: None)  # a kill needs none, and disks are slow
    seen = set()
    for step in range(1000):
        out = tmp_path / str(step) / "out"
        out.parent.mkdir()
        if before:
            write(out, before)
            (out / "mine").write_text("mine")
        killed = killed_at(step, monkeypatch, lambda out=out: write(out, NEW))
        try:
            whole = manifest(out)["files"]
            found = {name: (out / name).read_text() for name in whole}
            assert found in (OLD, NEW)
            seen.add("old" if found == OLD else "new")
        except IncompleteError as error:
            seen.add("incomplete" if "was stopped" in str(error) else "nothing")
            if "was stopped" in str(error):
                # What both results have in common may be read, what differs may not.
                assert files.text_of(out / "same") == "same"
                if (out / "design.toml").exists():
                    with pytest.raises(DesignError, match="is incomplete"):
                        files.text_of(out / "design.toml")
        # The same command mends it, without being forced, and leaves nothing behind.
        write(out, NEW)
        mine = {"mine": "mine"} if before else {}
        assert held(out) == NEW | mine
        assert manifest(out)["files"].keys() == NEW.keys()
        assert not (out / "stepwell.unfinished.json").exists()
        assert os.listdir(out.parent) == ["out"]
        shutil.rmtree(out.parent)
        if not killed:
            break
    else:
        pytest.fail("it never ended")
    assert seen == ({"old", "incomplete", "new"} if before else {"nothing", "new"})


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="SIGKILL")
def test_a_process_that_is_killed_while_it_replaces_files_is_found_out(tmp_path):
    out = tmp_path / "out"
    write(out, OLD)
    script = (
        "import os, signal, sys\n"
        "from stepwell.files import staged_folder\n"
        "with staged_folder('out', 'run', names=('design.toml', 'result.json')) as draft:\n"
        "    for name in ('design.toml', 'result.json'):\n"
        "        (draft / name).write_text('new')\n"
        "    replace = os.replace\n"
        "    def last(a, b):\n"
        "        replace(a, b)\n"
        "        if os.path.basename(b) == 'design.toml':\n"
        "            os.kill(os.getpid(), signal.SIGKILL)\n"
        "    os.replace = last\n"
    )
    done = subprocess.run([sys.executable, "-c", script], cwd=tmp_path)
    assert done.returncode == -signal.SIGKILL
    texts = held(out)
    assert (texts["design.toml"], texts["result.json"]) == ("new", "old")
    with refuses(IncompleteError, "`stepwell run`", "stopped"):
        manifest(out)
    write(out, NEW)
    assert held(out) == NEW


def refused(out, *names, command="run", texts=NEW) -> None:
    """Both the look beforehand and the writing refuse, name these, and change nothing."""
    before = {p: p.read_bytes() for p in out.rglob("*") if p.is_file()}
    for attempt in (
        lambda: check_folder(out, command, names=texts),
        lambda: write(out, texts, command),
    ):
        with pytest.raises(OverwriteError) as caught:
            attempt()
        for name in (*names, "--force"):
            assert name in str(caught.value)
        assert {p: p.read_bytes() for p in out.rglob("*") if p.is_file()} == before


def test_a_file_that_was_there_before_is_kept_until_it_is_forced(tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "design.toml").write_text("my own")
    refused(out, "design.toml")
    write(out, NEW, force=True)
    assert held(out) == NEW


def test_a_result_that_was_edited_is_kept_until_it_is_forced(tmp_path):
    out = tmp_path / "out"
    write(out, OLD)
    (out / "result.json").write_text("old, with a remark")
    with refuses(IncompleteError, "result.json"):
        manifest(out)
    refused(out, "result.json")
    write(out, NEW, force=True)
    assert held(out) == NEW


def test_a_folder_is_for_the_results_of_one_command(tmp_path):
    out = tmp_path / "out"
    write(out, {"path.csv": "old"})
    refused(out, "`stepwell run`", command="yield", texts={"design.toml": "new"})
    write(out, {"design.toml": "new"}, command="yield", force=True)
    assert held(out) == {"design.toml": "new"}


def test_what_an_earlier_result_had_and_a_new_one_has_not_goes_unless_it_was_changed(tmp_path):
    out = tmp_path / "out"
    write(out, OLD)
    write(out, NEW)
    assert "walk.mp4" not in held(out)
    write(out, OLD)
    (out / "walk.mp4").write_text("cut")
    write(out, NEW)
    assert held(out) == NEW | {"walk.mp4": "cut"}


def test_a_file_that_says_the_same_already_is_no_obstacle_and_stays_its_owners(tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "design.toml").write_text("new")
    check_folder(out, "run", names=NAMES, texts={"design.toml": "new"})
    write(out, NEW)
    assert "design.toml" not in manifest(out)["files"]
    write(out, {"path.csv": "new"})
    assert held(out) == {"design.toml": "new", "path.csv": "new"}


@pytest.mark.skipif(not hasattr(os, "symlink"), reason="links")
def test_a_link_and_a_folder_in_the_way_are_not_replaced(tmp_path):
    out = tmp_path / "out"
    write(out, OLD)
    (tmp_path / "elsewhere").write_text("old")
    (out / "design.toml").unlink()
    (out / "design.toml").symlink_to(tmp_path / "elsewhere")
    refused(out, "design.toml")
    (out / "design.toml").unlink()
    (out / "design.toml").mkdir()
    with refuses(OverwriteError, "design.toml", "a folder"):
        write(out, NEW, force=True)


@pytest.mark.parametrize(
    "text", ["", "[" * 9999, "{}", "[]", '{"schema": "stepwell.folder/1"}', "\udcff"]
)
def test_a_manifest_that_is_none_of_ours_is_kept(tmp_path, text):
    out = tmp_path / "out"
    out.mkdir()
    (out / "stepwell.json").write_bytes(text.encode("utf-8", "surrogateescape"))
    refused(out, "stepwell.json")


@pytest.mark.parametrize("name", ["../victim", "a/../../victim", "/etc/x", "..\\victim", "C:x"])
def test_a_manifest_cannot_name_files_outside_its_folder(tmp_path, name):
    out = tmp_path / "out"
    write(out, OLD)
    (tmp_path / "victim").write_text("old")
    record = json.loads((out / "stepwell.json").read_text())
    record["files"][name] = record["files"]["result.json"]
    (out / "stepwell.json").write_text(json.dumps(record))
    with pytest.raises(OverwriteError):
        write(out, NEW)
    write(out, NEW, force=True)
    assert (tmp_path / "victim").read_text() == "old"


def test_a_full_disk_is_reported_with_the_file_and_changes_nothing(tmp_path, monkeypatch):
    out = tmp_path / "out"
    write(out, OLD)

    def full(_):
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        with pytest.raises(OSError, match="No space left") as caught:
            write(out, NEW)
        assert str(caught.value.filename).startswith(str(out))
        with pytest.raises(OSError, match="No space left") as caught:
            files.write_atomic(tmp_path / "one.svg", "x")
        assert caught.value.filename == str(tmp_path / "one.svg")
    assert held(out) == OLD
    assert os.listdir(tmp_path) == ["out"]


def test_a_folder_that_cannot_be_made_is_reported_before_the_work(tmp_path):
    (tmp_path / "file").write_text("")
    with refuses(OSError, "name a folder") as caught:
        check_folder(tmp_path / "file" / "out", "run")
    assert caught.value.filename == str(tmp_path / "file" / "out")
    with pytest.raises(NotADirectoryError, match="give a folder"):
        check_folder(tmp_path / "file", "run")
    check_folder(tmp_path / "deep" / "out", "run")
    assert os.listdir(tmp_path) == ["file"]


def test_a_draft_that_was_removed_is_an_error_and_the_old_result_stays(tmp_path):
    out = tmp_path / "out"
    write(out, OLD)

    def removed():
        with staged_folder(out, "run", names=NAMES) as draft:
            shutil.rmtree(draft)

    with refuses(OSError, "draft", "removed"):
        removed()
    assert held(out) == OLD


def test_no_writer_adds_a_file_that_the_look_beforehand_does_not_know(tmp_path):
    with pytest.raises(AssertionError, match=r"odd\.txt"):
        write(tmp_path / "out", {"odd.txt": ""})
    assert os.listdir(tmp_path) == []


def test_the_manifest_holds_what_anyone_can_check(tmp_path):
    out = tmp_path / "out"
    chain = files.load("preset:paper-forward").subject
    record = {"design_sha256": files.digest(files.dumps(chain)), "seed": 7}
    with staged_folder(out, "yield", record) as draft:
        files.write_atomic(draft / "design.toml", files.dumps(chain))
    told = manifest(out)
    assert (told["schema"], told["command"], told["seed"]) == ("stepwell.folder/1", "yield", 7)
    assert told["files"] == {"design.toml": told["design_sha256"]}
    (out / "design.toml").unlink()
    with pytest.raises(IncompleteError, match=r"design\.toml is missing"):
        manifest(out)
    with pytest.raises(IncompleteError, match="no complete results"):
        manifest(Path(tmp_path))
