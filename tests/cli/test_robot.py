"""`stepwell robot`, `export` and `view`: a robot's numbers, varied and taken elsewhere."""

import csv
import json
from importlib import import_module
from typing import Any

import pytest
import xarray

from cli.folders import written
from docs.pages import ROOT, steps
from facts import says
from stepwell import files
from stepwell.cli import robots, screen
from stepwell.simulation import Settings, mjcf, walk
from stepwell.simulation.simulator import mujoco


@pytest.mark.slow
def test_show_lists_every_number_with_unit_and_source_draws_the_robot_and_keeps_its_design(
    stepwell, tmp_path
):
    result = stepwell("robot", "show", "robot-explorer", "--full", "--out", "out")
    assert result.exit_code == 0
    names = written(tmp_path / "out")
    drawn = {f"{name}{kind}" for name in ("robot", "prediction") for kind in (".png", ".svg")}
    assert names == {"report.html", "robot.toml", "robot.json"} | drawn
    record = json.loads((tmp_path / "out" / "robot.json").read_text("utf-8"))
    assert record["prediction"]["motion"] == "forward"
    assert [leg["gait"] for leg in record["prediction"]["legs"]] == ["00>10>11>01>00"] * 2
    rows = {line.split()[0]: line.split()[1:] for line in result.stdout.splitlines() if line}
    assert rows["foot.link_mm"] == ["35", "mm", "authors'", "notes"]
    assert rows["foot.below_mm"] == ["0.9", "mm", "assumed"]
    assert rows["leg.*.chain.cell.outer.band.stiffness_N_per_m"] == ["47", "N/m", "measured"]
    for key in ("leg.left.at_mm", "antenna.right.moves_mm", "drive.period_s"):
        assert key in rows


def test_no_number_is_lost_or_changed_where_they_are_put_together():
    for name in ("robot-forward", "robot-left", "robot-explorer"):
        robot = files.preset(name)
        values = sorted(
            (one.source, one.unit, value) for one in files.provenance(robot) for value in one.values
        )
        every = {(one.source, one.unit, *one.values) for one in files.parameters(robot)}
        assert set(values) == every
        again = {
            one.path: one.values[0] if len(one.values) == 1 else one.values
            for one in files.provenance(robot)
            if one.path != "body.supports_mm"  # a list of pairs, told as six numbers
        }
        assert files.vary(robot, again) == robot


@pytest.mark.slow
def test_a_sweep_over_two_keys_is_a_grid_and_says_what_each_robot_did(stepwell, tmp_path):
    result = stepwell(
        "robot", "sweep", "robot-forward", "chain.cell.outer.q_mm[0]=5:20:2",
        "foot.below_mm=-1:1:2", "--cycles", 2, "--out", "out",
    )  # fmt: skip
    assert result.exit_code == 0
    names = written(tmp_path / "out")
    assert names == {
        *("report.html", "sweep.csv", "sweep.json", "sweep.nc", "sweep.png", "sweep.svg")
    }
    with open(tmp_path / "out" / "sweep.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["foot.below_mm"]) for row in rows] == [-1, 1, -1, 1]
    # Feet above the supports: no robot, and the reason stands in its row.
    assert all("foot.below_mm = -1" in row["stopped"] for row in rows[::2])
    assert [row["gait_1"] for row in rows[1::2]] == ["00>01>11>10>00", "00>10>11>01>00"]
    data = xarray.load_dataset(tmp_path / "out" / "sweep.nc")
    assert float(data["advance"][3]) == pytest.approx(
        float(rows[3]["advance_over_u_max"]), abs=1e-6
    )
    assert "2 of 4 runs" in result.stdout


@pytest.mark.slow
def test_draws_come_from_their_seed(stepwell):
    def drawn(number, seed):
        result = stepwell(
            "robot", "sweep", "robot-forward", "foot.below_mm=0:0.5", "--random", number,
            "--seed", seed, "--cycles", 1, "--json", "--out", f"{number}-{seed}",
        )  # fmt: skip
        return json.loads(result.stdout)["trials"]

    two = drawn(2, 5)
    assert drawn(3, 5)[:2] == two
    assert drawn(1, 6) != two[:1]
    assert all(0 <= trial["values"][0] <= 0.5 for trial in two)


@pytest.mark.slow
def test_an_interrupted_sweep_goes_on_where_it_stopped(stepwell, tmp_path, monkeypatch):
    arguments = (
        "robot", "sweep", "robot-forward", "foot.below_mm=0.2:0.8:3", "--cycles", 1, "--json",
    )  # fmt: skip
    whole = json.loads(stepwell(*arguments, "--out", "whole").stdout)

    # One robot at a time, and no second one.
    module = import_module("stepwell.simulation.sweeps")
    monkeypatch.setattr(module, "cores", lambda: 1)
    monkeypatch.setattr(module, "PER_CORE", 1)
    add, added = module._Kept.add, []

    def once(self, trials):
        add(self, trials)
        added.append(trials)
        raise KeyboardInterrupt

    monkeypatch.setattr(module._Kept, "add", once)
    assert stepwell(*arguments, "--out", "out").exit_code == 130
    assert not (tmp_path / "out" / "sweep.csv").exists()
    assert len(list((tmp_path / "out" / "unfinished").glob("part-*.json"))) == 1

    monkeypatch.setattr(
        module._Kept, "add", lambda self, trials: (add(self, trials), added.append(trials))
    )
    record = json.loads(stepwell(*arguments, "--out", "out").stdout)
    assert [sorted(trials) for trials in added] == [[0], [1], [2]]
    assert record["trials"] == whole["trials"]
    assert not (tmp_path / "out" / "unfinished").exists()


@pytest.mark.parametrize(
    ("ranges", "message"),
    [
        (("foot.blow_mm=0:1:3",), "robot-forward: foot.blow_mm: selects none"),
        (("foot.below_mm=0:1",), "must be KEY=FROM:TO:COUNT"),
        (("foot.below_mm=0:1:3", "--random", "2"), "must be KEY=FROM:TO with --random"),
        (("foot.below_mm=0:one:3",), "must be KEY=FROM:TO:COUNT"),
        (("foot.below_mm=1:1:3",), "must be a range of two numbers"),
        (("foot.below_mm=0:nan:3",), "must be a range of two numbers"),
        (("foot.below_mm=0:1:1",), "the count must be 2 or more"),
        (("foot.below_mm=0:1:2", "foot.below_mm=0:1:3"), "is given twice"),
        (("foot.below_mm=0:1:999", "floor.drag_N=0:1:999"), "998001 robots"),
        (("foot.below_mm=-2:-1:3",), "foot.below_mm = -2"),
    ],
)
def test_a_wrong_range_is_reported_before_anything_runs(stepwell, tmp_path, ranges, message):
    result = stepwell("robot", "sweep", "robot-forward", *ranges, "--out", "out")
    assert (result.exit_code, result.stdout) == (2, "")
    assert message in " ".join(result.stderr.split())
    assert not (tmp_path / "out").exists()


def test_export_writes_a_model_that_mujoco_opens_standing_at_its_start(stepwell, tmp_path):
    result = stepwell("export", "robot-explorer", "-o", "model.xml", "--arena", "cylinder")
    assert (result.exit_code, result.stdout) == (0, "Wrote model.xml\n")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "model.xml"))
    assert model.key("start").id == 0
    assert model.nu == 1
    # Bands, levers, links and antennas are there to be seen.
    assert model.ntendon > 0
    assert (model.tendon_rgba[:, 3] > 0).any()


@pytest.mark.slow
def test_a_robot_is_exported_as_it_is_cut_with_its_meshes(stepwell, tmp_path):
    words = ("export", "robot-forward", "--material", "acrylic-3mm")
    result = stepwell(*words, "--out", "robot")
    assert result.exit_code == 0, result.output
    says(result.stdout, "robot.sdf", "walk.py", "meshes/")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "robot" / "robot.xml"))
    assert model.nmesh > 20
    plain = mujoco.MjModel.from_xml_string(mjcf(files.preset("robot-forward")))
    body = model.body("body").id
    assert model.body_subtreemass[body] != pytest.approx(plain.body_subtreemass[body], rel=0.01)
    alone = stepwell(*words, "--out", "robot.sdf")
    assert (alone.exit_code, (tmp_path / "robot.sdf").exists()) == (2, False)
    says(alone.stderr, "robot.sdf", "folder")


@pytest.mark.slow
def test_the_complete_script_of_the_page_needs_only_the_exported_file(stepwell):
    stepwell("export", "robot-forward")
    page = (ROOT / "docs" / "how-to" / "own-mujoco-script.md").read_text("utf-8")
    script = next(step.body for step in steps(page) if step.body.startswith("import mujoco"))
    names: dict[str, Any] = {}
    exec(script, names)
    assert names["steps"] == pytest.approx([0.75] * 3, abs=0.01)


@pytest.mark.slow
def test_the_viewers_command_is_the_one_that_walks(stepwell):
    robot = files.load("preset:robot-forward").robot
    settings = Settings()
    model, data = robots.model(robot, None)
    control = robots.command(robot, settings.settle)
    for _ in range(round((settings.settle + robot.drive.period) / settings.time_step)):
        control(model, data)
        mujoco.mj_step(model, data)
    assert float(data.qpos[0]) == pytest.approx(walk(robot, 1).x[-1], abs=2e-4)


def test_export_refuses_a_file_that_mujoco_does_not_read(stepwell, tmp_path):
    result = stepwell("export", "robot-forward", "-o", "r.txt")
    assert (result.exit_code, (tmp_path / "r.txt").exists()) == (2, False)
    says(result.stderr, "r.txt", ".xml")


def test_view_without_a_display_says_so_in_a_line(stepwell, monkeypatch):
    monkeypatch.setattr(screen, "has_display", lambda: False)
    result = stepwell("view", "robot-forward")
    assert (result.exit_code, result.stdout) == (1, "")
    assert result.stderr.startswith("The viewer needs a display")
    assert result.stderr.count("\n") == 1
