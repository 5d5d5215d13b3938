"""The shell completes commands, options, and the names of presets, robots, arenas and results."""

import os
import shutil
import subprocess
import sys

import pytest
from typer.testing import CliRunner

from sizes import cases
from stepwell.cli import app, options

START = [sys.executable, "-c", "import stepwell.cli as c; c.main()"]
SHELLS = ("bash", "zsh", "fish")


def asking(shell: str, line: str) -> dict[str, str]:
    """By what its own script asks what a shell is offered after a line."""
    words = line.split(" ")
    given = {
        "bash": {"COMP_WORDS": "\n".join(words), "COMP_CWORD": str(len(words) - 1)},
        "zsh": {"_TYPER_COMPLETE_ARGS": line},
        "fish": {"_TYPER_COMPLETE_ARGS": line, "_TYPER_COMPLETE_FISH_ACTION": "get-args"},
    }[shell]
    return given | {"_STEPWELL_COMPLETE": f"complete_{shell}"}


@pytest.mark.slow
@pytest.mark.parametrize("shell", SHELLS)
def test_a_shell_is_offered_commands_options_and_names(shell, tmp_path, monkeypatch):
    (tmp_path / "mine.toml").write_text("", "utf-8")
    monkeypatch.chdir(tmp_path)

    def asked(line: str) -> str:
        return CliRunner().invoke(app, env=asking(shell, line), prog_name="stepwell").stdout

    offered = asked("stepwell yi")
    assert "yield" in offered
    # As a shell asks, in the quick run for one of them; the script of each is asked for below.
    if shell in cases(SHELLS, SHELLS[:1]):
        env = os.environ | asking(shell, "stepwell yi")
        assert subprocess.run(START, env=env, capture_output=True, text=True).stdout == offered
    assert "--mobility-ratio" in asked("stepwell run x --mob")
    presets = asked("stepwell run preset:paper-f").replace("\\", "")
    assert "preset:paper-forward" in presets and "three-wave" not in presets
    assert "mine.toml" in asked("stepwell run m")
    arenas = asked("stepwell maze robot-explorer c")
    assert "cylinder" in arenas and "pen" not in arenas
    assert "lab.read" in asked("stepwell schema lab.r")


@pytest.mark.slow
@pytest.mark.parametrize("shell", SHELLS)
def test_the_script_for_a_shell_is_one_that_it_reads(shell, tmp_path):
    given = {"_STEPWELL_COMPLETE": f"source_{shell}"}
    done = subprocess.run(START, env=os.environ | given, capture_output=True, text=True)
    assert done.returncode == 0 and "_STEPWELL_COMPLETE" in done.stdout
    if shutil.which(shell):
        script = tmp_path / "script"
        script.write_text(done.stdout, "utf-8")
        subprocess.run([shell, "-n", str(script)], check=True)


def test_names_begin_as_they_were_begun_and_folders_can_be_looked_into(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "robots").mkdir()
    (tmp_path / "robots" / "robot.toml").write_text("", "utf-8")
    (tmp_path / "robots" / "notes.md").write_text("", "utf-8")
    assert options.designs("preset:three-w") == ["preset:three-wave"]
    assert options.robots("robot-e") == ["robot-explorer"]
    assert options.robots("preset:robot-e") == ["preset:robot-explorer"]
    assert options.presets("robot-e") == ["robot-explorer"]
    assert options.designs("robots") == ["robots/"]
    assert options.designs("robots/") == ["robots/robot.toml"]
    assert options.designs("gone/") == []
    assert options.results("lab.c") == ["lab.calibrate", "lab.compare"]
