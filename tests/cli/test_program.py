"""`stepwell program`: found, proved to be none, played, written, refused."""

import csv
import json
from pathlib import Path

import pytest

import stepwell as sw
from cli.folders import written
from stepwell import files
from stepwell.accounts import About, account, terminal

OUT = {"design.toml", "program.csv", "program.json", "program.png", "program.svg", "report.html"}


def test_it_prints_the_account_and_as_json_its_record(stepwell):
    text, chain = Path("forward.toml").read_text("utf-8"), sw.load("forward.toml")
    for begin in ((), ("--from", "10")):
        program = chain.program("01", start="".join(begin[1:]) or None)
        expected = account(program, About(text, "forward.toml"))
        arguments = "program", "forward.toml", *begin, "--target", "01"
        result = stepwell(*arguments)
        shown = "\n".join(line.text for line in terminal(expected))
        assert (result.exit_code, result.stdout) == (0, f"{shown}\n")
        assert json.loads(stepwell(*arguments, "--json").stdout) == expected.record | {"files": []}


def test_the_start_is_all_cells_at_0_by_default(stepwell):
    record = json.loads(stepwell("program", "forward.toml", "--target", "01", "--json").stdout)
    assert (record["from"], record["target"]) == ("00", "01")


def test_a_state_out_of_reach_is_proved_and_ends_in_code_3(stepwell, tmp_path):
    arguments = ("program", "preset:used-before", "--target", "01", "--out", "out")
    result = stepwell(*arguments)
    assert result.exit_code == 3
    assert not (tmp_path / "out").exists()
    result = stepwell(*arguments, "--json")
    record = json.loads(result.stdout)
    assert result.exit_code == 3
    assert not record["meets_target"]
    assert record["proved"]
    assert record["arrives"] is record["turning_points_mm"] is None


@pytest.mark.slow
def test_the_folder_holds_figure_table_json_and_the_design_with_its_program(stepwell, tmp_path):
    result = stepwell("program", "forward.toml", "--target", "01", "--out", "out", "--json")
    record = json.loads(result.stdout)
    out = tmp_path / "out"
    assert written(out) == OUT
    assert {tmp_path / name for name in record.pop("files")} == {out / name for name in OUT}
    assert record == json.loads((out / "program.json").read_text())
    with open(out / "program.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["what"] for row in rows] == ["begin", "turn 1", "end"]
    assert float(rows[1]["low_mm"]) == pytest.approx(record["turns"][0]["low_mm"])
    text = (out / "design.toml").read_text("utf-8")
    assert text.startswith(files.preset_text("paper-forward").rstrip("\n"))
    assert files.loads(text).chain == sw.load("forward.toml")


@pytest.mark.slow
def test_what_was_written_is_played_and_does_it_again(stepwell, tmp_path):
    stepwell("program", "preset:three-wave", "--target", "001", "--out", "out")
    result = stepwell("program", "out/design.toml", "--json", "--out", "again")
    record = json.loads(result.stdout)
    assert result.exit_code == 0
    assert (record["from"], record["target"], record["arrives"]) == ("000", "001", "001")
    assert record["reason"] == "as it was given"
    assert not record["proved"]
    assert written(tmp_path / "again") == OUT


def test_a_program_that_does_not_arrive_ends_in_code_3(stepwell, tmp_path):
    wrong = files.WrittenProgram("00", (0.0, 0.030, 0.020), "01")
    files.save(sw.load("forward.toml"), tmp_path / "wrong.toml", program=wrong)
    result = stepwell("program", "wrong.toml", "--json")
    assert result.exit_code == 3
    record = json.loads(result.stdout)
    assert (record["meets_target"], record["target"], record["arrives"]) == (False, "01", "10")


def test_a_program_without_a_target_arrives_where_it_ends(stepwell, tmp_path):
    written = files.WrittenProgram("00", (0.0, 0.030))
    files.save(sw.load("forward.toml"), tmp_path / "half.toml", program=written)
    result = stepwell("program", "half.toml", "--json")
    assert result.exit_code == 0
    record = json.loads(result.stdout)
    assert (record["meets_target"], record["strokes"], record["arrives"]) == (True, 1, "1-")


def test_the_slack_of_a_turn_off_the_middle_is_to_the_nearer_end(stepwell, tmp_path):
    written = files.WrittenProgram("00", (0.0, 0.039, 0.020), "01")
    files.save(sw.load("forward.toml"), tmp_path / "late.toml", program=written)
    record = json.loads(stepwell("program", "late.toml", "--json").stdout)
    assert record["slack_mm"] == pytest.approx(40 - 39)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ("forward.toml",),
            "forward.toml: has no table [program]: pass --target STATE to plan one.",
        ),
        (("forward.toml", "--from", "10"), "--from: needs --target STATE, the state to end in."),
        (("forward.toml", "--target", "012"), "'012': must be 2 characters 0 or 1, inner cell"),
        (("forward.toml", "--from", "1", "--target", "01"), "--from: '1': must be 2 characters"),
        (("preset:robot-forward", "--target", "01"), "is a robot, and this needs a chain"),
    ],
)
def test_wrong_input_ends_in_code_2_with_what_is_allowed(stepwell, arguments, message):
    result = stepwell("program", *arguments)
    assert result.exit_code == 2
    assert message in result.output


def test_a_start_that_cannot_stand_is_wrong_input(stepwell, tmp_path):
    cell = "[[chain.cell]]\np_mm = [-10, 0]\nq_mm = {}\n"
    text = "[chain]\n" + cell.format("[0, 15]") + cell.format("[0, -15]")
    (tmp_path / "up.toml").write_text(text)
    result = stepwell("program", "up.toml", "--from", "10", "--target", "11")
    assert result.exit_code == 2
    assert "is no equilibrium" in result.output
    (tmp_path / "own.toml").write_text(
        f'{text}\n[program]\nstart = "10"\nturning_points_mm = [20, 40]\n'
    )
    result = stepwell("program", "own.toml")
    assert result.exit_code == 2
    assert result.output.startswith("own.toml: program: start ")


@pytest.fixture
def race() -> sw.Chain:
    """Three elements of which two race once; its design stands in race.toml."""
    chain = sw.Chain(
        [
            sw.elements.trilinear((0.003, 1.3), (0.010, 0.8), 100.0, 800.0, "first"),
            sw.elements.trilinear((0.005, 0.3), (0.008, 0.0), 200.0, 300.0, "second"),
            sw.elements.trilinear((0.004, 1.1), (0.015, -0.3), 400.0, 100.0, "third"),
        ]
    )
    return chain


def test_a_robust_program_is_found_or_proved_to_be_none(stepwell, race):
    Path("race.toml").write_text(files.dumps(race), "utf-8")
    arguments = "program", "race.toml", "--robust", 10, "--target"
    refused = stepwell(*arguments, "111", "--json")
    assert refused.exit_code == 3
    record = json.loads(refused.stdout)
    assert (record["robust"], record["meets_target"], record["proved"]) == (10.0, False, True)
    result = stepwell(*arguments, "010", "--json")
    assert result.exit_code == 0
    record = json.loads(result.stdout)
    assert (record["robust"], record["meets_target"]) == (10.0, True)
    record = json.loads(stepwell("program", "race.toml", "--target", "010", "--json").stdout)
    assert record["robust"] is None


def test_the_designs_own_program_is_asked_too(stepwell, race):
    assert stepwell("program", "preset:finger-selector", "--robust", 10).exit_code == 0
    text = files.dumps(race, program=files.WrittenProgram.of(race.program("111")))
    Path("race.toml").write_text(text, "utf-8")
    assert stepwell("program", "race.toml").exit_code == 0
    refused = stepwell("program", "race.toml", "--robust", 10, "--json")
    assert refused.exit_code == 3
    assert not json.loads(refused.stdout)["meets_target"]


def test_a_ratio_below_one_is_refused(stepwell):
    refused = stepwell("program", "forward.toml", "--target", "01", "--robust", 0.5)
    assert refused.exit_code == 2
    assert "--robust" in refused.stderr


def test_strokes_of_a_state_machine_are_searched_and_tabulated(stepwell):
    Path("last.toml").write_text('language = "(up | down)* up"', "utf-8")
    result = stepwell("program", "forward.toml", "--machine", "last.toml", "--json")
    record = json.loads(result.stdout)
    assert result.exit_code == 0 and [one["input"] for one in record["inputs"]] == ["up", "down"]
    states = {one["state"] for one in record["replies"]}
    assert all(
        record["replies"][k]["state"] in states for one in record["replies"] for k in one["after"]
    )
    # The last input decides the output.
    for one in record["replies"]:
        assert [record["replies"][k]["output"] for k in one["after"]] == ["yes", "no"]


def test_a_machine_excludes_a_target(stepwell):
    Path("last.toml").write_text('language = "(up | down)* up"', "utf-8")
    result = stepwell("program", "forward.toml", "--machine", "last.toml", "--target", "01")
    assert result.exit_code == 2 and "--machine" in result.stderr
