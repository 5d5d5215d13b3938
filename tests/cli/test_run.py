"""`stepwell run`: what it prints, writes and refuses."""

import csv
import json
from pathlib import Path

import pytest

import stepwell as sw
from cli.folders import written
from sizes import SIZE
from stepwell import reports
from stepwell.accounts import About, Account, account, terminal
from stepwell.design import Run
from stepwell.statics import StaticsError

FILES = {
    *("design.toml", "path.csv", "report.html", "result.json"),
    *(f"{name}.{kind}" for name in ("force-stroke", "travel-stroke", "landscape", "mechanism",
      "margins", "around", "yield") for kind in ("png", "svg")),
}  # fmt: skip

# Of chains of up to twelve cells.
DRAWINGS = {"landscape", "mechanism", "around", "yield"}


def _screen(account: Account) -> str:
    return "\n".join(line.text for line in terminal(account)) + "\n"


def test_it_prints_the_account_and_as_json_its_record(stepwell):
    text, chain = Path("forward.toml").read_text("utf-8"), sw.load("forward.toml")
    expected = account(Run.of(chain), About(text, "forward.toml"))
    result = stepwell("run", "forward.toml")
    assert (result.exit_code, result.stdout) == (0, _screen(expected))
    read = json.loads(stepwell("run", "forward.toml", "--json").stdout, parse_constant=pytest.fail)
    assert read == expected.record | {"files": []}


def test_landings_are_asked_within_a_ratio_of_mobilities(stepwell):
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


@pytest.mark.slow
def test_the_folder_holds_figures_data_report_and_the_design(stepwell, tmp_path):
    # What the screen says of them stands on the page of the commands.
    result = stepwell("run", "forward.toml", "--json", "--out", "deep/out")
    out = tmp_path / "deep" / "out"
    assert result.exit_code == 0
    assert written(out) == FILES
    screen = json.loads(result.stdout)
    assert {tmp_path / name for name in screen.pop("files")} == {out / name for name in FILES}
    assert screen == json.loads((out / "result.json").read_text())
    assert {file.name for file in tmp_path.iterdir()} == {"forward.toml", "deep"}
    assert [file.name for file in (tmp_path / "deep").iterdir()] == ["out"]

    assert (out / "design.toml").read_text() == (tmp_path / "forward.toml").read_text()
    assert (out / "mechanism.png").read_bytes().startswith(b"\x89PNG")
    assert "<svg" in (out / "landscape.svg").read_text("utf-8")
    assert "00 → 10 → 11 → 01 → 00" in (out / "report.html").read_text("utf-8")
    with open(out / "path.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    # It is the design, too, that Python reads.
    path = sw.load(out / "design.toml").cycle().path
    assert [float(row["force_N"]) for row in rows] == pytest.approx(path.force, rel=1e-11)


def test_a_preset_is_a_design(stepwell):
    assert stepwell("run", "preset:paper-forward").stdout == stepwell("run", "forward.toml").stdout


def chain_file(cells: int) -> str:
    anchors = (f"p_mm = [-10, 0]\nq_mm = [{5 + 0.2 * i}, 0]\n" for i in range(cells))
    return "[chain]\n" + "".join(f"[[chain.cell]]\n{text}" for text in anchors)


# In the quick run a chain of 61 misses that figure, and another one.
@pytest.mark.slow
@pytest.mark.skipif(SIZE == "ci", reason="a chain of 61 is written")
def test_a_chain_too_long_to_draw_misses_that_figure_alone(stepwell, tmp_path):
    (tmp_path / "long.toml").write_text(chain_file(13))
    assert stepwell("run", "long.toml", "--out", "out").exit_code == 0
    expected = {name for name in FILES if name.partition(".")[0] not in DRAWINGS}
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


def test_a_tie_is_no_error(stepwell):
    result = stepwell("run", "preset:paper-identical", "--json")
    assert result.exit_code == 0
    assert json.loads(result.stdout)["ties"]


@pytest.mark.slow
def test_results_from_python_are_written_with_a_design_file_and_without_lanes_of_too_many_cells(
    tmp_path,
):
    cell = sw.preset("paper-cell-10-0").cells[0]
    chain = sw.Chain([cell.with_anchors(q=(0.01 + 1e-4 * k, 0.0)) for k in range(61)])
    seen = []
    names = reports.write(
        Run.of(chain), tmp_path / "out", progress=lambda done, total: seen.append((done, total))
    )
    assert {name.partition(".")[0] for name in FILES - set(names)} == DRAWINGS | {"travel-stroke"}
    assert set(names) <= FILES
    assert sw.load(tmp_path / "out" / "design.toml") == chain
    assert seen == [(done, len(names)) for done in range(1, len(names) + 1)]
