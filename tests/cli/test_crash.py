"""Whatever goes wrong ends in one line, an exit code, and a file to report it with."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from sizes import SIZE
from stepwell.cli import app
from stepwell.crash import report
from stepwell.files import preset_text

COMMAND = Path(sys.executable).with_name("stepwell")


@pytest.fixture
def logs(tmp_path, monkeypatch) -> Path:
    monkeypatch.setattr(report, "_folders", lambda: iter([tmp_path / "logs"]))
    return tmp_path / "logs"


def raised(error: BaseException) -> BaseException:
    try:
        raise error
    except BaseException as caught:
        return caught


def test_a_report_has_the_command_the_design_the_versions_the_settings_and_the_trace(
    tmp_path, logs, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("STEPWELL_KERNELS", "interpreted")
    monkeypatch.setenv("PASSWORD", "hunter2")
    Path("leg.toml").write_text(preset_text("paper-forward"), "utf-8")
    arguments = ["run", "leg.toml", "gone.toml", "--scheduler", "tcp://me:hunter2@here:1"]
    line = report.reported(raised(KeyError("a\nb")), arguments)
    (file,) = logs.iterdir()
    assert line == f"KeyError: 'a\\nb' (unexpected). To report this error, attach {file}"
    text = file.read_text("utf-8")
    for part in (
        "stepwell run leg.toml", preset_text("paper-forward").rstrip(), "STEPWELL_KERNELS=inter",
        "\nnumpy ", "\nPython 3", "Traceback (most recent", "KeyError: 'a\\nb'", "not available",
    ):  # fmt: skip
        assert part in text, part
    assert "hunter2" not in text
    assert os.name != "posix" or file.stat().st_mode & 0o777 == 0o600


def test_only_the_last_reports_are_kept(logs):
    logs.mkdir()
    for k in range(30):
        (logs / f"stepwell-20200101-0000{k:02d}-1.txt").write_text("")
    line = report.reported(raised(ValueError()), [])
    kept = sorted(file.name for file in logs.iterdir())
    assert len(kept) == report.KEPT
    assert line.startswith("ValueError (unexpected)") and line.endswith(kept[-1])


def test_where_no_report_can_be_written_the_line_says_so(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(report, "_folders", lambda: iter([tmp_path / "file"]))
    line = report.reported(raised(ValueError("x" * 999)), [])
    assert "no report could be written" in line
    assert len(line.splitlines()) == 1 and len(line) < 600


def test_every_output_is_a_place_on_this_machine(stepwell, tmp_path):
    """Options and arguments that name what is written, of every command."""

    def commands(command, words):
        if hasattr(command, "commands"):
            for name, one in command.commands.items():
                yield from commands(one, (*words, name))
        else:
            yield command, words

    from typer.main import get_command

    outputs = [
        (words, option)
        for command, words in commands(get_command(app), ())
        for one in command.params
        for option in one.opts
        if option in ("--out", "--studies")
    ]
    assert len(outputs) > 20
    for words, option in outputs:
        for place in ("memory://x", "file:///x", "s3:/x"):
            result = stepwell(*words, option, place)
            assert result.exit_code == 2, words
            assert "is an address" in result.stderr, (words, result.stderr)
    assert "is an address" in stepwell("new", "memory://x.toml").stderr
    assert os.listdir(tmp_path) == ["forward.toml"]


@pytest.mark.slow
def test_help_is_the_same_where_python_forgets_docstrings(stepwell, monkeypatch):
    monkeypatch.setenv("COLUMNS", "90")
    pages = ([], ["run"], ["lab"], ["lab", "read"], ["sweep", "cycle"])
    script = (
        "from typer.testing import CliRunner\nfrom stepwell.cli import app\n"
        f"for words in {pages!r}:\n"
        "    print(CliRunner().invoke(app, [*words, '--help'], prog_name='stepwell').output)\n"
    )
    optimized = subprocess.run(
        [sys.executable, "-OO", "-c", script], capture_output=True, check=True, encoding="utf-8"
    ).stdout
    plain = "".join(f"{stepwell(*words, '--help').output}\n" for words in pages)
    assert "List the extremes, jumps, work" in " ".join(plain.split())
    assert plain == optimized


@pytest.mark.slow
@pytest.mark.parametrize("system", ["bogus", *(["osmesa"] if SIZE == "full" else [])])
def test_what_draws_nothing_needs_nothing_that_draws(tmp_path, system):
    pytest.importorskip("mujoco")
    words = ("export", "robot-forward", "--out", "robot.xml")
    env = {**os.environ, "MUJOCO_GL": system}
    done = subprocess.run([COMMAND, *words], cwd=tmp_path, env=env, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
