"""No command replaces what it did not write, and it says so before its work begins."""

import json

import pytest

from stepwell import files

EVERY = {
    "demo": (),
    "run": ("forward.toml",),
    "map": ("forward.toml",),
    "program": ("forward.toml", "--target", "01"),
    "design": ("00>10>11>01>00",),
    "yield": ("forward.toml",),
    "check": ("forward.toml",),
    "build": ("forward.toml",),
    "reprogram": ("forward.toml", "--by", "inner.p"),
    "robot show": ("robot-forward",),
    "sweep report": ("study.zarr",),
    "atlas show": (),
    "robot sweep": ("robot-forward", "foot.below_mm=0.3:0.6:2"),
    "walk": ("robot-forward",),
    "maze": ("robot-explorer", "cylinder"),
    "jump": ("hopper",),
    "compile": ("turn-away",),
    "export": ("robot-forward",),
    "paper": (),
    "lab read": (".",),
    "lab band": (".",),
    "lab element": (".",),
    "lab compare": (".",),
    "lab calibrate": (".",),
    "lab as-built": ("forward.toml",),
}
OWN = {"paper": "claims.json", "design": "design.toml"}


@pytest.fixture
def no_work(monkeypatch):
    """Whatever comes after the look at the folder is a failure."""

    def looked(*given, check=files.check_folder, **named):
        check(*given, **named)
        pytest.fail("the work began")

    monkeypatch.setattr(files, "check_folder", looked)


def test_every_command_with_a_folder_is_tried_here():
    assert EVERY.keys() == files.OUTPUTS.keys() | {"paper"}


@pytest.mark.parametrize("command", EVERY)
def test_every_command_keeps_a_file_of_mine_and_says_so_before_its_work(
    stepwell, tmp_path, no_work, command
):
    own = OWN.get(command) or files.OUTPUTS[command][0]
    (tmp_path / "proj").mkdir()
    (tmp_path / "proj" / own).write_text("my own")
    result = stepwell(*command.split(), *EVERY[command], "--out", "proj")
    assert result.exit_code == 2, result.output
    assert result.stderr.startswith(f"proj: `stepwell {command}` did not write {own} with this")
    assert "--force" in result.stderr
    assert {file.name: file.read_text() for file in (tmp_path / "proj").iterdir()} == {
        own: "my own"
    }


@pytest.mark.slow
def test_the_same_command_replaces_its_own_and_another_one_does_not(stepwell, tmp_path):
    program = ("program", "forward.toml", "--target", "01", "--out", "out")
    assert [stepwell(*program).exit_code for _ in range(2)] == [0, 0]
    result = stepwell("reprogram", "forward.toml", "--by", "inner.p", "--out", "out")
    assert (result.exit_code, result.stdout) == (2, "")
    assert files.manifest(tmp_path / "out")["command"] == "program"
    with open(tmp_path / "out" / "program.csv", "a") as table:
        table.write("remark\n")
    assert stepwell(*program).exit_code == 2
    assert stepwell(*program, "--force").exit_code == 0
    assert "remark" not in (tmp_path / "out" / "program.csv").read_text()


@pytest.mark.slow
def test_a_folder_may_hold_the_design_that_is_run(stepwell, tmp_path):
    before = (tmp_path / "forward.toml").read_bytes()
    (tmp_path / "design.toml").write_bytes(before)
    plan = ("--target", "01", "--out", "plan")
    assert stepwell("program", "forward.toml", *plan).exit_code == 0
    assert stepwell("program", "plan/design.toml", *plan).exit_code == 0
    result = stepwell("program", "design.toml", "--target", "01", "--out", ".")
    assert result.exit_code == 2
    assert "design.toml" in result.stderr
    assert (tmp_path / "design.toml").read_bytes() == before


@pytest.mark.parametrize(
    ("arguments", "file"),
    [
        (("new", "mine.toml"), "mine.toml"),
        (("graph", "forward.toml", "-o", "mine.svg"), "mine.svg"),
        (("graph", "forward.toml", "-o", "mine.json"), "mine.json"),
        (("animate", "forward.toml"), "cycle.gif"),
        (("export", "robot-forward"), "robot.xml"),
    ],
)
def test_a_single_file_is_kept_until_it_is_forced(stepwell, tmp_path, arguments, file):
    (tmp_path / file).write_text("my own")
    result = stepwell(*arguments)
    assert result.exit_code == 2
    assert f"{file}: exists" in result.stderr
    assert (tmp_path / file).read_text() == "my own"
    if arguments[0] != "animate":
        assert stepwell(*arguments, "--force").exit_code == 0
        assert (tmp_path / file).read_text() != "my own"


def test_a_result_names_the_very_file_it_was_computed_from(stepwell, tmp_path):
    before = json.loads(stepwell("graph", "forward.toml", "--json").stdout)
    assert before["design_sha256"] == files.digest((tmp_path / "forward.toml").read_bytes())
    with open(tmp_path / "forward.toml", "a") as design:
        design.write("# another remark\n")
    after = json.loads(stepwell("graph", "forward.toml", "--json").stdout)
    assert after["design_sha256"] == files.digest((tmp_path / "forward.toml").read_bytes())
    assert before["design_sha256"] != after["design_sha256"]
