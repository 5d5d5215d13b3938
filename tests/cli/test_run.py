"""`stepwell run`: what it prints, writes and refuses."""

import csv
import json
import math

import pytest

import stepwell as sw
from cli.folders import written
from stepwell import reports
from stepwell.statics import StaticsError

FILES = {
    *("design.toml", "path.csv", "report.html", "result.json"),
    *(f"{name}.{kind}" for name in ("force-stroke", "travel-stroke", "landscape", "mechanism",
      "margins", "around", "yield") for kind in ("png", "svg")),
}  # fmt: skip


def numbers(value) -> list[float]:
    if isinstance(value, dict):
        return [n for item in value.values() for n in numbers(item)]
    if isinstance(value, list):
        return [n for item in value for n in numbers(item)]
    return [value] if isinstance(value, float) else []


def test_it_prints_what_the_cycle_says(stepwell):
    result = stepwell("run", "forward.toml")
    cycle = sw.load("forward.toml").cycle()
    assert result.exit_code == 0
    lines = result.stdout.splitlines()
    assert "Sequence    00>10>11>01>00" in lines
    assert "Pathway     clockwise" in lines
    assert f"Peak force  {cycle.peak_force:.4g} N" in lines
    assert f"Dissipated  {cycle.dissipated * 1e3:.4g} mJ in a cycle" in lines
    for snap in cycle.snaps:
        (line,) = (
            text for text in lines if {"snap", f"{snap.stroke * 1e3:.4g}"} <= {*text.split()}
        )
        assert f"{snap.released * 1e3:.4g}" in line
    for cell, name in zip(cycle.chain.cells, cycle.chain.names, strict=True):
        assert any(
            text.split()[:3] == [name, f"{cell.force_0:.4g}", f"{cell.force_1:.4g}"]
            for text in lines
        )


def test_landings_are_asked_within_a_ratio_of_mobilities(stepwell):
    line = "Landings    all hold for mobility ratios up to {}: proved\n"
    assert line.format(10) in stepwell("run", "forward.toml").stdout
    assert line.format(1000) in stepwell("run", "forward.toml", "--mobility-ratio", 1e3).stdout
    record = json.loads(stepwell("run", "forward.toml", "--mobility-ratio", 3, "--json").stdout)
    assert [landing["ratio"] for landing in record["landings"]] == [3.0, 3.0]


@pytest.mark.parametrize("ratio", ["0.999", "1000.1", "nan", "-2"])
def test_a_ratio_of_mobilities_past_its_ends_is_refused_before_anything_is_written(
    stepwell, tmp_path, ratio
):
    result = stepwell("run", "forward.toml", f"--mobility-ratio={ratio}", "--out", "out")
    assert result.exit_code == 2
    assert "--mobility-ratio: ratio = " in " ".join(result.stderr.split())
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("ratio", ["1", "1000"])
def test_a_ratio_of_mobilities_may_be_at_its_ends(stepwell, ratio):
    assert stepwell("run", "forward.toml", "--mobility-ratio", ratio).exit_code == 0


def test_the_output_of_a_pipe_is_plain(stepwell):
    text = stepwell("run", "forward.toml").stdout
    assert "\x1b" not in text
    assert all(line == line.rstrip() for line in text.split("\n"))


def test_the_margin_is_printed_with_the_way_to_change_and_what_comes_then(stepwell):
    margin = sw.margin(sw.load("preset:paper-forward"))
    text = stepwell("run", "forward.toml").stdout
    assert f"Margin      {min(margin.anchors) * 1e3:.4g} mm of an anchor" in text
    for change in margin.changes:
        (line,) = (
            text
            for text in text.splitlines()
            if text.startswith(margin.chain.names[change.cell]) and change.parameter in text
        )
        scale = 1e3 if change.parameter == "anchor" else 100
        assert f"{change.distance * scale:.4g}" in line
        assert line.endswith(change.becomes)


def test_json_alone_says_everything_and_is_finite(stepwell):
    result = stepwell("run", "forward.toml", "--json")
    record = json.loads(result.stdout, parse_constant=pytest.fail)
    cycle = sw.load("forward.toml").cycle()
    assert record["schema"] == "stepwell.run/1"
    assert record["sequence"] == str(cycle.sequence)
    assert record["pathway"] == "clockwise"
    assert record["dissipated_mJ"] == cycle.dissipated * 1e3
    assert [e["stroke_mm"] for e in record["events"]] == [e.stroke * 1e3 for e in cycle.events]
    assert record["actuator"] == {"control": "stroke", "stiffness_N_per_m": None}
    assert record["files"] == []
    assert all(map(math.isfinite, numbers(record)))


@pytest.mark.parametrize("name", ["paper-cell-10-0", "paper-identical", "four-shuffle"])
def test_json_stays_finite_where_results_are_not(stepwell, name):
    # A single cell has no other sequence at any distance, and equal cells no distance at all.
    record = json.loads(stepwell("run", f"preset:{name}", "--json").stdout)
    assert all(map(math.isfinite, numbers(record)))
    changes = record["margin"]["changes"]
    anchors = [change["distance_mm"] for change in changes if change["parameter"] == "anchor"]
    assert (None in anchors) == (name == "paper-cell-10-0")
    assert bool(record["ties"]) == (name == "paper-identical")


def test_force_control_reports_the_drive_in_newtons(stepwell):
    record = json.loads(stepwell("run", "preset:force-control", "--json").stdout)
    assert record["actuator"] == {"control": "force", "stiffness_N_per_m": 0.0}
    assert all("drive_N" in event and "drive_mm" not in event for event in record["events"])


def test_ties_are_printed_with_advice_and_are_no_error(stepwell):
    result = stepwell("run", "preset:paper-identical")
    assert result.exit_code == 0
    assert "Too close to call\ninner and outer tie at drive 0 mm" in result.stdout


def test_the_folder_holds_figures_data_report_and_the_design(stepwell, tmp_path):
    result = stepwell("run", "forward.toml", "--out", "deep/out")
    out = tmp_path / "deep" / "out"
    assert result.exit_code == 0
    assert written(out) == FILES
    assert all(name in result.stdout.splitlines()[-1] for name in FILES)
    assert {file.name for file in tmp_path.iterdir()} == {"forward.toml", "deep"}
    assert [file.name for file in (tmp_path / "deep").iterdir()] == ["out"]

    assert (out / "design.toml").read_text() == (tmp_path / "forward.toml").read_text()
    assert (out / "mechanism.png").read_bytes().startswith(b"\x89PNG")
    assert "<svg" in (out / "landscape.svg").read_text("utf-8")
    assert "00 → 10 → 11 → 01 → 00" in (out / "report.html").read_text("utf-8")
    with open(out / "path.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    path = sw.load(out / "design.toml").cycle().path
    assert [float(row["force_N"]) for row in rows] == pytest.approx(path.force, rel=1e-11)


@pytest.mark.slow
def test_the_json_in_the_folder_is_the_json_of_the_screen(stepwell, tmp_path):
    screen = json.loads(stepwell("run", "forward.toml", "--json", "--out", "out").stdout)
    written = json.loads((tmp_path / "out" / "result.json").read_text())
    assert {tmp_path / name for name in screen.pop("files")} == {
        tmp_path / "out" / name for name in FILES
    }
    assert screen == written


def test_a_preset_is_a_design(stepwell):
    assert stepwell("run", "preset:paper-forward").stdout == stepwell("run", "forward.toml").stdout


def chain_file(cells: int) -> str:
    anchors = (f"p_mm = [-10, 0]\nq_mm = [{5 + 0.2 * i}, 0]\n" for i in range(cells))
    return "[chain]\n" + "".join(f"[[chain.cell]]\n{text}" for text in anchors)


def test_long_chains_are_cut_on_the_screen_and_whole_in_json(stepwell, tmp_path):
    (tmp_path / "long.toml").write_text(chain_file(66))
    text = stepwell("run", "long.toml").stdout
    assert "and 26 more; --json shows all" in text
    assert "Loading     cell 1, cell 2, " in text
    assert " and 54 more" in text
    record = json.loads(stepwell("run", "long.toml", "--json").stdout)
    assert len(record["cells"]) == 66
    assert len(record["margin"]["changes"]) == 132
    assert record["sequence"] is None
    assert record["loading_order"] == list(sw.load("long.toml").cycle().loading_order)


@pytest.mark.slow
def test_a_chain_too_long_to_draw_misses_that_figure_alone(stepwell, tmp_path):
    (tmp_path / "long.toml").write_text(chain_file(13))
    assert stepwell("run", "long.toml", "--out", "out").exit_code == 0
    drawings = {"landscape", "mechanism", "around", "yield"}
    expected = {name for name in FILES if name.partition(".")[0] not in drawings}
    assert written(tmp_path / "out") == expected


def test_a_wrong_file_ends_in_code_2_with_every_problem_and_writes_nothing(stepwell, tmp_path):
    text = (tmp_path / "forward.toml").read_text()
    (tmp_path / "wrong.toml").write_text(text.replace("q_mm", "q_mmm"))
    for extra in ((), ("--json",)):
        result = stepwell("run", "wrong.toml", "--out", "out", *extra)
        assert result.exit_code == 2
        assert result.output == (
            "wrong.toml: chain.cell[0].q_mmm: unknown key. Did you mean q_mm?\n"
            "wrong.toml: chain.cell[1].q_mmm: unknown key. Did you mean q_mm?\n"
        )
    assert not (tmp_path / "out").exists()


def test_a_missing_file_ends_in_code_2_with_the_nearest(stepwell):
    result = stepwell("run", "foward.toml")
    assert (result.exit_code, result.output) == (
        2,
        "foward.toml: no such file. Did you mean forward.toml?\n",
    )


def test_work_that_fails_ends_in_code_1_with_its_advice(stepwell, tmp_path, monkeypatch):
    def fail(*_, **__):
        raise StaticsError("two cells balance to the last digit. Move an anchor by 0.01 mm.")

    monkeypatch.setattr("stepwell.design.margin", fail)
    result = stepwell("run", "forward.toml", "--out", "out")
    assert result.exit_code == 1
    assert result.output == "two cells balance to the last digit. Move an anchor by 0.01 mm.\n"
    assert not (tmp_path / "out").exists()


def test_a_folder_that_cannot_be_made_ends_in_code_1(stepwell):
    result = stepwell("run", "preset:paper-cell-10-0", "--out", "forward.toml/out")
    assert result.exit_code == 1
    assert "forward.toml" in result.output


def test_a_file_in_place_of_the_folder_is_wrong_usage(stepwell, tmp_path):
    before = (tmp_path / "forward.toml").read_bytes()
    assert stepwell("run", "forward.toml", "--out", "forward.toml").exit_code == 2
    assert (tmp_path / "forward.toml").read_bytes() == before


@pytest.mark.slow
def test_results_from_python_are_written_with_a_design_file_made_for_them(tmp_path):
    chain = sw.preset("paper-via-10")
    names = reports.write_run(chain.cycle(), sw.margin(chain), tmp_path / "out")
    assert set(names) == FILES
    assert sw.load(tmp_path / "out" / "design.toml") == chain


@pytest.mark.slow
def test_a_chain_too_long_for_lanes_is_written_without_them(tmp_path):
    cell = sw.preset("paper-cell-10-0").cells[0]
    chain = sw.Chain([cell.with_anchors(q=(0.01 + 1e-4 * k, 0.0)) for k in range(61)])
    names = reports.write_run(chain.cycle(), sw.margin(chain), tmp_path / "out")
    assert "force-stroke.svg" in names
    assert not any(name.startswith("travel-stroke") for name in names)


def test_progress_counts_up_to_the_number_of_files(tmp_path):
    chain, seen = sw.preset("paper-cell-10-0"), []
    reports.write_run(
        chain.cycle(),
        sw.margin(chain),
        tmp_path / "out",
        progress=lambda done, total: seen.append((done, total)),
    )
    assert [done for done, _ in seen] == list(range(1, len(seen) + 1))
    assert {total for _, total in seen} == {len(seen)}
