"""`stepwell walk`: a robot simulated, shown and written."""

import json
import re
import subprocess
import sys
from dataclasses import replace
from importlib import import_module

import pytest
import xarray

import stepwell as sw
from cli.folders import written
from facts import says
from golden.sketching import filmed_blank
from sizes import SIZE
from stepwell.base import install
from stepwell.build import RobotBuild
from stepwell.files import load, preset_text
from stepwell.reports import contents

FIGURES = {
    f"{name}{kind}" for name in ("contacts", "gait", "trajectory") for kind in (".png", ".svg")
}
WRITTEN = {"report.html", "robot.toml", "walk.json", "walk.nc"} | FIGURES


@pytest.mark.slow
def test_a_walk_shows_its_gaits_and_how_many_numbers_are_assumed(stepwell):
    result = stepwell("walk", "robot-forward", "--cycles", 3)
    assert result.exit_code == 0
    lines = result.stdout.splitlines()
    assert any(line.split()[:5] == ["left", "1", "to", "3", "00>10>11>01>00"] for line in lines)
    assert re.search(r"^Assumed numbers +\d+ of \d+$", result.stdout, re.M)
    assert "body.mass_g" not in result.stdout


@pytest.mark.slow
def test_the_json_is_that_of_the_paper(stepwell):
    record = json.loads(stepwell("walk", "preset:robot-forward", "--cycles", 4, "--json").stdout)
    assert record["schema"] == "stepwell.walk/1"
    # Kamp et al. 2024, Fig. 3C: 0.71 of the largest step in a cycle.
    assert record["mean_advance_over_u_max"] == pytest.approx(0.71, abs=0.08)
    assert record["cycles"] == len(record["advance_over_u_max"]) == 4
    assert record["cost_of_transport"] == pytest.approx(
        record["work_mJ"] / record["weight_N"] / record["distance_mm"]
    )
    assert {one["source"] for one in record["parameters"]} == {"paper", "authors' notes", "assumed"}
    assert record["files"] == []


@pytest.mark.slow
def test_a_folder_gets_figures_samples_numbers_and_the_design(stepwell, tmp_path):
    result = stepwell("walk", "robot-left", "--cycles", 2, "--out", "out", "--no-video")
    assert result.exit_code == 0
    assert written(tmp_path / "out") == WRITTEN
    assert (tmp_path / "out" / "robot.toml").read_text("utf-8") == preset_text("robot-left")
    samples = xarray.load_dataset(tmp_path / "out" / "walk.nc")
    record = json.loads((tmp_path / "out" / "walk.json").read_text("utf-8"))
    assert float(samples["time"][-1]) == pytest.approx(record["duration_s"]) == pytest.approx(4.0)
    # One leg steps backward: it turns, by about 15° a cycle (Kamp et al. 2024, Fig. 3E).
    assert record["turn_deg"] == pytest.approx([15.0, 15.0], abs=2.5)


@pytest.mark.slow
def test_a_part_of_a_cycle_is_a_walk_too_and_a_video_is_written_where_frames_can_be_drawn(
    stepwell, tmp_path, bare
):
    result = stepwell("walk", "robot-forward", "--cycles", 0.1, "--out", "out")
    assert result.exit_code == 0
    assert "in 0.1 cycles of 2 s" in result.stdout
    record = json.loads((tmp_path / "out" / "walk.json").read_text("utf-8"))
    assert record["mean_advance_over_u_max"] is None
    names = written(tmp_path / "out")
    if "No video" in result.stderr:
        assert names == WRITTEN - FIGURES
        pytest.skip(result.stderr.strip())
    assert names == WRITTEN - FIGURES | {"walk.mp4", "walk.gif", "still.png"}
    assert "walk.gif" in result.stdout


def test_a_view_that_does_not_exist_is_refused_before_the_walk(stepwell, tmp_path):
    result = stepwell("walk", "robot-forward", "--view", "sid", "--out", "out")
    assert (result.exit_code, (tmp_path / "out").exists()) == (2, False)
    says(result.stderr, "--view", "mean side?")


@pytest.fixture
def bare(monkeypatch):
    """Folders of walks without the figures, which other tests look at."""
    whole = contents.CONTENTS["Walk"]
    monkeypatch.setitem(
        contents.CONTENTS, "Walk", lambda *walk, **how: replace(whole(*walk, **how), draws={})
    )


@pytest.mark.slow
def test_without_pyav_there_is_the_gif_and_a_line_that_says_what_to_install(
    stepwell, tmp_path, monkeypatch, bare
):
    monkeypatch.setitem(sys.modules, "av", None)
    with filmed_blank():
        result = stepwell("walk", "robot-forward", "--cycles", 0.1, "--out", "out")
    assert result.exit_code == 0
    assert written(tmp_path / "out") == WRITTEN - FIGURES | {"walk.gif", "still.png"}
    (line,) = result.stderr.splitlines()
    assert install("video") in line and "libx264" in line and "GPL" in line


@pytest.mark.slow
def test_without_a_graphics_system_a_line_says_so_and_the_rest_is_there(
    stepwell, tmp_path, monkeypatch, bare
):
    monkeypatch.setattr(
        import_module("stepwell.simulation.drawing"), "SYSTEMS", ("no such system",)
    )
    result = stepwell("walk", "robot-forward", "--cycles", 0.1, "--out", "out")
    assert result.exit_code == 0
    assert result.stderr.startswith("No video: frames cannot be drawn off screen.")
    assert written(tmp_path / "out") == WRITTEN - FIGURES


@pytest.mark.slow
@pytest.mark.parametrize(
    ("centre_mm", "names"),
    [
        # Tips over its front supports in the first step.
        ("24, 0, 300", WRITTEN),
        # Cannot even stand.
        ("37, 0, 2000", WRITTEN - FIGURES),
    ],
)
def test_a_robot_that_falls_over_ends_with_a_message_and_keeps_what_it_has(
    stepwell, tmp_path, centre_mm, names
):
    text = preset_text("robot-forward")
    body = f"[body]\ncentre_mm = [{centre_mm}]\n\n[foot]"
    (tmp_path / "tall.toml").write_text(text.replace("[foot]", body), "utf-8")
    result = stepwell("walk", "tall.toml", "--cycles", 3, "--out", "out", "--no-video")
    assert result.exit_code == 1
    assert result.stderr.startswith("Stopped at ")
    assert written(tmp_path / "out") == names
    record = json.loads((tmp_path / "out" / "walk.json").read_text("utf-8"))
    assert record["stopped"] == result.stderr.strip()
    assert (record["duration_s"] > 0) == (names == WRITTEN)
    assert record["duration_s"] < 6


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("robot-foward",), "robot-foward: no such file."),
        (("forward.toml",), "forward.toml: is a chain, and this needs a robot"),
        (("robot-forward", "--cycles", "0"), "Invalid value for '--cycles'"),
    ],
)
def test_wrong_usage_is_reported_in_a_line(stepwell, arguments, message):
    result = stepwell("walk", *arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    assert message in result.stderr


@pytest.mark.slow
def test_a_file_of_the_users_counts_before_a_preset_of_that_name(stepwell, tmp_path):
    (tmp_path / "robot-forward").write_text(preset_text("robot-backward"), "utf-8")
    record = json.loads(stepwell("walk", "robot-forward", "--cycles", 2, "--json").stdout)
    assert record["title"] == load("preset:robot-backward").robot.title
    assert record["mean_advance_over_u_max"] < 0


@pytest.mark.slow
@pytest.mark.parametrize("command", ["walk", *(["export", "view"] if SIZE == "full" else [])])
def test_without_mujoco_one_line_says_what_to_install(tmp_path, command):
    script = (
        "import sys; sys.modules['mujoco'] = None\n"
        f"sys.argv[1:] = {[command, 'robot-forward']!r}\n"
        "import stepwell.cli as c; c.main()"
    )
    result = subprocess.run(
        [sys.executable, "-c", script],
        cwd=tmp_path, text=True, capture_output=True, env={"DISPLAY": ":0", "PATH": ""},
    )  # fmt: skip
    assert (result.returncode, result.stdout) == (1, "")
    assert result.stderr.count("\n") == 1
    assert install("robot") in result.stderr


def test_a_robot_walks_as_it_is_cut_with_the_masses_of_its_parts_and_its_actuators_period(stepwell):
    pytest.importorskip("manifold3d")
    words = ("walk", "robot-forward", "--cycles", 0.1, "--material", "acrylic-3mm", "--json")
    record = json.loads(stepwell(*words).stdout)
    made = sw.build(sw.preset("robot-forward"))
    assert isinstance(made, RobotBuild)
    assert record["title"].endswith(", cut from acrylic-3mm")
    assert record["period_s"] == pytest.approx(made.least_period)
    assert record["weight_N"] == pytest.approx(9.81 * made.mass, rel=1e-4)
