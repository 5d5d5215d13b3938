"""The shell completes commands, options, and the names of presets, robots, arenas and results."""

import os
import shutil
import subprocess
import sys

import pytest

from sizes import SIZE
from stepwell.cli import options

START = [sys.executable, "-c", "import stepwell.cli as c; c.main()"]
SHELLS = ("bash", "zsh", "fish")


def asked(shell: str, line: str, folder) -> str:
    """What a shell is offered after a line, by the way that its own script asks."""
    words = line.split(" ")
    given = {
        "bash": {"COMP_WORDS": "\n".join(words), "COMP_CWORD": str(len(words) - 1)},
        "zsh": {"_TYPER_COMPLETE_ARGS": line},
        "fish": {"_TYPER_COMPLETE_ARGS": line, "_TYPER_COMPLETE_FISH_ACTION": "get-args"},
    }[shell]
    given["_STEPWELL_COMPLETE"] = f"complete_{shell}"
    done = subprocess.run(
        START, env=os.environ | given, cwd=folder, capture_output=True, text=True, check=False
    )
    return done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("shell", SHELLS)
def test_a_shell_is_offered_commands_options_and_names(shell, tmp_path):
    (tmp_path / "mine.toml").write_text("", "utf-8")
    assert "yield" in asked(shell, "stepwell yi", tmp_path)
    # What is offered is the same for all; how a shell asks and is answered is not.
    if shell != "bash" and SIZE == "ci":
        return
    assert "--mobility-ratio" in asked(shell, "stepwell run x --mob", tmp_path)
    presets = asked(shell, "stepwell run preset:paper-f", tmp_path).replace("\\", "")
    assert "preset:paper-forward" in presets and "three-wave" not in presets
    assert "mine.toml" in asked(shell, "stepwell run m", tmp_path)
    arenas = asked(shell, "stepwell maze robot-explorer c", tmp_path)
    assert "cylinder" in arenas and "pen" not in arenas
    assert "lab.read" in asked(shell, "stepwell schema lab.r", tmp_path)


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
