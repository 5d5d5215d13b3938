"""Options of a reading: printed, refused with columns, asked at a terminal, kept in a folder."""

import sys

import numpy as np
import pytest

from facts import says
from lab.exports import ASKED, FORCE, READ, TIME, WAY, table
from stepwell import lab
from stepwell.cli import readings

TWO, BARE = ASKED["two forces"][0], ASKED["no header"][0]


@pytest.fixture
def folder(tmp_path):
    """A folder of recordings with two columns of force."""
    (tmp_path / "runs").mkdir()
    for name in ("a.csv", "b.csv"):
        (tmp_path / "runs" / name).write_text(TWO, "utf-8")
    return tmp_path / "runs"


def test_the_reading_is_printed_once_for_files_that_are_read_alike(stepwell, folder):
    for name in ("a.csv", "b.csv"):
        (folder / name).write_text(str(READ["raw first"]), "utf-8")
    result = stepwell("lab", "read", "runs")
    assert result.exit_code == 0
    says(result.stderr, "a.csv and 1 more", "stroke: column 4", "force: column 5", "signs: ")


def test_a_choice_is_refused_with_numbered_columns_and_options_settle_it(stepwell, folder):
    refused = stepwell("lab", "read", "runs")
    assert refused.exit_code == 2
    says(refused.stderr, "Columns of", "1  Displacement", "2  Force A", "3  Force B")
    for option in (("--force", "2"), ("--force=Force A",), ("--force-column", "2")):
        read = stepwell("lab", "read", "runs", *option)
        assert read.exit_code == 0
        says(read.stderr, "force: column 2")


def test_force_without_a_number_still_overwrites(stepwell, folder, tmp_path):
    (folder / "a.csv").write_text(str(READ["plain"]), "utf-8")
    (tmp_path / "tidy").mkdir()
    (tmp_path / "tidy" / "recordings.csv").write_text("mine", "utf-8")
    for force, code in (((), 2), (("--force",), 0)):
        result = stepwell("lab", "read", "runs/a.csv", "--out", "tidy", *force)
        assert result.exit_code == code


def test_a_saved_reading_is_used_by_other_commands_and_by_designs(stepwell, folder, tmp_path):
    saved = stepwell("lab", "read", "runs", "--force", "3", "--flip", "none", "--save-reading")
    assert saved.exit_code == 0
    says(saved.stderr, "recording.toml: written")
    assert lab.read(folder / "a.csv").force == pytest.approx(2 * FORCE)
    assert stepwell("lab", "band", "runs").exit_code == 0
    (tmp_path / "clip.toml").write_text(
        '[[chain.cell]]\ntable_csv = "runs/a.csv"\nhalf = "loading"\n', "utf-8"
    )
    assert stepwell("run", "clip.toml").exit_code == 0
    empty = stepwell("lab", "read", "runs", "--save-reading")
    assert empty.exit_code == 2
    says(empty.stderr, "--save-reading", "--stroke")


def test_at_a_terminal_columns_and_units_are_asked(stepwell, folder, monkeypatch):
    answers = iter([2, 3, "mm,N"])
    monkeypatch.setattr(readings, "_asks", lambda: True)
    monkeypatch.setattr(readings.typer, "prompt", lambda *_, **__: next(answers))
    (folder / "a.csv").write_text(BARE, "utf-8")
    result = stepwell("lab", "read", "runs/a.csv")
    assert result.exit_code == 0
    says(result.stderr, "--stroke 2", "--force 3", "--unit mm,N")


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        (("--unit", "mm"), "must be two units"),
        (("--flip", "up"), "none, stroke, force"),
        (("--half", "upper"), "loading, unloading"),
        (("--stroke", "2", "--force", "2"), "another column"),
        (("--decimal", ";"), "must be one"),
    ],
)
def test_a_wrong_option_is_refused_before_anything_is_read(stepwell, options, problem):
    result = stepwell("lab", "read", "gone.csv", *options)
    assert result.exit_code == 2 and problem in result.stderr


def test_a_part_of_a_recording_is_fitted(stepwell, tmp_path):
    three = [np.concatenate([c + k * a for k in range(3)]) for c, a in ((TIME, 13), (WAY, 0))]
    force = np.concatenate([FORCE, 1.1 * FORCE, 1.2 * FORCE])
    text = table("Time (s),Displacement (mm),Force (N)", [*three, force])
    (tmp_path / "pull.csv").write_text(text, "utf-8")
    for cycle, stiffness in ((1, 50), (2, 55), (3, 60)):
        result = stepwell("lab", "band", "pull.csv", "--cycle", cycle, "--half", "loading")
        says(result.stdout, f"Stiffness {stiffness} N/m")
    assert sys.stderr.isatty() is False
