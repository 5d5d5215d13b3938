"""A store that lacks designs is told from a whole one by every command, and by its exit code."""

import json
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

from stepwell.cli import app
from stepwell.files import preset_text

pytest.importorskip("zarr", reason="studies are not tested: zarr is not installed")
pytestmark = pytest.mark.slow

SWEEP = ("sweep", "cycle", "forward.toml", "--vary", "outer.q.x=0:20:12", "--chunk", "3")


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A study of 4 chunks."""
    folder = tmp_path_factory.mktemp("whole")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        Path("forward.toml").write_text(preset_text("paper-forward"), "utf-8")
        words = [*SWEEP, "--workers", "0", "--out", "study.zarr"]
        assert CliRunner().invoke(app, words).exit_code == 0
    return folder / "study.zarr"


@pytest.fixture
def damaged(stepwell, whole):
    """`stepwell`, in a folder with the study: its second chunk is damaged, the last is gone."""
    shutil.copytree(whole, "study.zarr")
    file = Path("study.zarr/snaps/c/1")
    spoilt = bytearray(file.read_bytes())
    spoilt[len(spoilt) // 2] ^= 4
    file.write_bytes(bytes(spoilt))
    Path("study.zarr/sequence/c/3").unlink()
    return stepwell


MISSING = "6 of 12 designs are missing: 3 to 5 (damaged), 9 to 11 (missing)"


@pytest.mark.parametrize(
    "arguments",
    [
        ("export", "--out", "all.csv"),
        ("export", "--out", "best.csv", "--best", "2", "--rank-by", "snaps"),
        ("report", "--out", "report"),
    ],
    ids=["export", "best", "report"],
)
def test_it_is_refused_unless_it_is_asked_for(damaged, arguments):
    command, *others = arguments
    result = damaged("sweep", command, "study.zarr", *others)
    assert (result.exit_code, result.stdout) == (1, "")
    assert f"study.zarr: {MISSING}." in result.stderr
    assert "`stepwell sweep resume study.zarr`" in result.stderr
    assert not Path(others[1]).exists()
    assert damaged("sweep", command, "study.zarr", *others, "--partial").exit_code == 0
    if command == "report":
        assert MISSING in Path("report/report.html").read_text("utf-8")
    elif "--best" not in others:
        assert len(Path("all.csv").read_text("utf-8").splitlines()) == 1 + 6


def test_a_figure_of_a_study_with_gaps_needs_to_be_asked_for(damaged):
    words = ("figure", "study.zarr", "--out", "f.svg")
    refused = damaged(*words)
    assert refused.exit_code == 1 and "--partial" in refused.stderr
    assert damaged(*words, "--partial").exit_code == 0


def test_a_study_has_a_figure_of_its_strip_as_one_file(stepwell, whole):
    words = ("figure", str(whole), "--panels", "sequence", "--width", "nature-single")
    result = stepwell(*words, "--out", "strip.svg")
    assert result.exit_code == 0, result.stderr
    assert "89 mm wide" in result.stdout
    assert Path("strip.svg").is_file()


def test_a_folder_with_the_name_of_a_figure_is_refused(stepwell, whole):
    result = stepwell("sweep", "report", str(whole), "--out", "strip.pdf")
    assert result.exit_code == 2
    assert "`stepwell figure`" in " ".join(result.stderr.split())
    assert not Path("strip.pdf").exists()


def test_the_status_names_what_is_missing_and_fails_where_something_is_damaged(damaged):
    result = damaged("sweep", "status", "study.zarr")
    assert result.exit_code == 1
    assert MISSING in " ".join(result.stdout.split())
    record = json.loads(damaged("sweep", "status", "study.zarr", "--json").stdout)
    assert record["missing"] == [
        {"first": 3, "last": 5, "damaged": True},
        {"first": 9, "last": 11, "damaged": False},
    ]


def test_once_it_is_computed_again_nothing_is_missing(damaged):
    assert damaged("sweep", "resume", "study.zarr", "--workers", "0").exit_code == 0
    result = damaged("sweep", "export", "study.zarr", "--out", "all.csv")
    assert (result.exit_code, result.stdout) == (0, "Written into all.csv: 12 designs.\n")
