"""Files are written whole or not at all."""

import os
import stat

import pytest

from stepwell.files import staged_folder, write_atomic


class Broken(Exception):
    pass


def breaking(*_):
    raise Broken


def test_text_and_bytes_arrive_unchanged(tmp_path):
    write_atomic(tmp_path / "a", "θ\r\n")
    write_atomic(tmp_path / "b", b"\x00\xff")
    assert (tmp_path / "a").read_bytes() == "θ\r\n".encode()
    assert (tmp_path / "b").read_bytes() == b"\x00\xff"
    assert sorted(os.listdir(tmp_path)) == ["a", "b"]


@pytest.mark.parametrize("call", ["fsync", "replace"])
def test_a_failure_leaves_the_old_file_and_nothing_else(tmp_path, monkeypatch, call):
    write_atomic(tmp_path / "a", "old")
    monkeypatch.setattr(os, call, breaking)
    with pytest.raises(Broken):
        write_atomic(tmp_path / "a", "new")
    assert os.listdir(tmp_path) == ["a"]
    assert (tmp_path / "a").read_text() == "old"


def test_the_new_file_is_on_the_disk_before_it_takes_the_name(tmp_path, monkeypatch):
    calls = []
    fsync, replace = os.fsync, os.replace
    monkeypatch.setattr(os, "fsync", lambda fd: (calls.append("sync"), fsync(fd)))
    monkeypatch.setattr(os, "replace", lambda a, b: (calls.append("rename"), replace(a, b)))
    write_atomic(tmp_path / "a", "x")
    assert calls == ["sync", "rename", "sync"]  # the last one is the folder


def test_a_missing_folder_is_an_oserror_and_no_folder_appears(tmp_path):
    with pytest.raises(FileNotFoundError) as caught:
        write_atomic(tmp_path / "no" / "a", "x")
    assert caught.value.filename == str(tmp_path / "no" / "a")
    assert os.listdir(tmp_path) == []


def test_permissions_are_those_of_any_new_file_or_of_the_file_replaced(tmp_path):
    (tmp_path / "plain").write_text("")
    write_atomic(tmp_path / "new", "x")
    os.chmod(tmp_path / "plain", 0o640)
    write_atomic(tmp_path / "plain", "x")
    mode = {name: stat.S_IMODE((tmp_path / name).stat().st_mode) for name in ("plain", "new")}
    (tmp_path / "other").write_text("")
    other = stat.S_IMODE((tmp_path / "other").stat().st_mode)
    assert mode == {"plain": 0o640, "new": other}


def test_a_link_stays_a_link(tmp_path):
    (tmp_path / "real").write_text("old")
    (tmp_path / "link").symlink_to("real")
    write_atomic(tmp_path / "link", "new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_text() == "new"


def test_a_staged_folder_appears_whole_beside_what_was_there(tmp_path):
    out, names = tmp_path / "deep" / "out", ("a.csv", "figures/b.svg")
    with staged_folder(out, "run", names=names) as draft:
        (draft / "a.csv").write_text("1")
        assert not out.exists()
    (out / "mine.txt").write_text("mine")
    with staged_folder(out, "run", names=names) as draft:
        (draft / "a.csv").write_text("2")
        (draft / "figures").mkdir()
        (draft / "figures" / "b.svg").write_text("b")
        assert (out / "a.csv").read_text() == "1"
    assert {str(p.relative_to(out)) for p in out.rglob("*.*")} == {
        "a.csv",
        "mine.txt",
        "stepwell.json",
        os.path.join("figures", "b.svg"),
    }
    assert (out / "a.csv").read_text() == "2"
    assert os.listdir(tmp_path / "deep") == ["out"]


def test_a_staged_folder_that_fails_leaves_the_old_one(tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "b.csv").write_text("old")

    def broken():
        with staged_folder(out, "run", names=("a.csv",)) as draft:
            (draft / "a.csv").write_text("new")
            raise Broken

    with pytest.raises(Broken):
        broken()
    assert os.listdir(tmp_path) == ["out"]
    assert os.listdir(out) == ["b.csv"]
    assert (out / "b.csv").read_text() == "old"


def test_a_file_in_the_way_of_a_folder_is_an_error(tmp_path):
    (tmp_path / "out").write_text("mine")
    with (
        pytest.raises(NotADirectoryError, match="give a folder"),
        staged_folder(tmp_path / "out", "run"),
    ):
        pytest.fail("the block must not run")
    assert (tmp_path / "out").read_text() == "mine"
