"""What every command promises: exit codes, clean interruption, plain text, a light start."""

import json
import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import typer
from typer.main import get_command
from typer.testing import CliRunner

import stepwell
from sizes import SIZE
from stepwell.cli import app, ranges
from stepwell.cli.screen import EXIT_CODES, FORMER_OPTIONS, SYNONYMS

COMMAND = Path(sys.executable).with_name("stepwell")
COMMANDS = [command.name for command in app.registered_commands]
ENVIRONMENT = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "FORCE_COLOR")}
posix = pytest.mark.skipif(os.name != "posix", reason="signals and terminals as POSIX has them")


def installed(*arguments, cwd, **options) -> subprocess.CompletedProcess[str]:
    """The installed command, in a process of its own."""
    options = {"env": ENVIRONMENT, "text": True, "capture_output": True} | options
    return subprocess.run([COMMAND, *arguments], cwd=cwd, timeout=300, **options)


def patched(patch: str, *arguments, cwd) -> subprocess.CompletedProcess[str]:
    """The command with a line of Python run before it."""
    script = (
        f"import sys; sys.argv[1:] = {[*arguments]!r}\n{patch}\n"
        "from stepwell.__main__ import main; main()"
    )
    return subprocess.run(
        [sys.executable, "-c", script], cwd=cwd, env=ENVIRONMENT, text=True, capture_output=True
    )


# All commands write their folders alike; this one has the fewest figures.
PROGRAM = ("program", "preset:paper-forward", "--target", "01", "--out", "out")


def in_terminal(*arguments, cwd, env) -> str:
    """What the installed command shows in a terminal of 100 columns."""
    import pty

    ours, theirs = pty.openpty()
    process = subprocess.Popen(
        [COMMAND, *arguments], cwd=cwd, env=env, stdout=theirs, stderr=theirs, stdin=theirs
    )
    os.close(theirs)
    shown = b""
    while True:
        try:
            piece = os.read(ours, 65536)
        except OSError:  # Linux says so when the other side is gone
            break
        if not piece:
            break
        shown += piece
    os.close(ours)
    assert process.wait() == 0
    return shown.decode()


@pytest.mark.slow
def test_the_installed_command_runs_a_design_to_a_folder(tmp_path):
    result = installed(*PROGRAM, "--json", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert json.loads(result.stdout)["arrives"] == "01"
    assert (tmp_path / "out" / "report.html").exists()


def test_a_wrong_file_goes_to_standard_error_and_nothing_to_standard_output(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(app, ["run", "leg.toml", "--json"])
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr == "leg.toml: no such file.\n"


def test_the_version_is_the_packages(stepwell_help, tmp_path):
    assert stepwell_help("--version") == f"stepwell {stepwell.__version__}\n"


@pytest.fixture
def stepwell_help():
    return lambda *arguments: CliRunner().invoke(app, [*arguments], prog_name="stepwell").stdout


@pytest.mark.parametrize("command", [None, *COMMANDS])
def test_every_help_page_ends_with_the_exit_codes(stepwell_help, command):
    text = stepwell_help(*([command] if command else []), "--help")
    assert " ".join(text.split()).endswith(EXIT_CODES)
    assert text == stepwell_help(*([command] if command else []), "-h")


def leaves(command, *names):
    """Every command with its names, those of groups included."""
    inner = getattr(command, "commands", None)
    if inner is None:
        yield names, command
        return
    for name, one in inner.items():
        yield from leaves(one, *names, name)


LEAVES = dict(leaves(get_command(app)))
VERBS = ("Add", "Check", "Compare", "Compute", "Export", "Fit", "List", "Open", "Plot")
VERBS += ("Print", "Run", "Search", "Simulate", "Stop", "Write")


@pytest.mark.parametrize("names", LEAVES, ids=" ".join)
def test_every_help_begins_with_a_verb_and_ends_with_an_example_that_is_understood(names):
    text = LEAVES[names].help
    assert text is not None
    assert text.split()[0] in VERBS
    example = text.strip().splitlines()[-1]
    program, *arguments = shlex.split(example.removeprefix("Example: "))
    assert (program, *arguments[: len(names)]) == ("stepwell", *names), example
    # Typer reads the arguments as it does before it calls the command.
    context = LEAVES[names].make_context(" ".join(names), arguments[len(names) :])
    assert not context.args


# Defaults that differ on purpose: what is drawn where, and the tolerances of a first build.
OWN_DEFAULTS = {"--out", "--samples", "--cycles", "--anchor", "--stiffness-tolerance"}
OWN_DEFAULTS |= {"--material", "--travel-tolerance", "--drive", "--x", "--y", "--holes"}


def test_an_option_has_one_default_in_all_commands():
    defaults_of: dict[str, set[str]] = {}
    for command in LEAVES.values():
        for parameter in command.params:
            if not parameter.required:
                defaults_of.setdefault(parameter.opts[0], set()).add(str(parameter.default))
    unlike = {name for name, defaults in defaults_of.items() if len(defaults) > 1}
    assert {name for name in unlike if name.startswith("--")} <= OWN_DEFAULTS


# One name in place of several, by which an option is no longer called.
FORMER = {"--wanted", "--want", "--to", "--start", "--stiffness", "--rest-length", "--travel"}


def options() -> Iterator[tuple[str, str, Any]]:
    """Every option of every command, with the command and its longest name."""
    for names, command in LEAVES.items():
        for one in command.params:
            if one.opts[0].startswith("-"):
                yield " ".join(names), max(one.opts, key=len), one


def kind_of(option: Any) -> str:
    """What an option takes; a range with a count is a range."""
    kind = option.metavar or str(option.type_descriptor.annotation)
    return {"NAME=FROM:TO:COUNT": "NAME=FROM:TO", "FROM:TO:COUNT": "FROM:TO"}.get(kind, kind)


def test_one_option_name_takes_one_thing_in_all_commands():
    kinds: dict[str, dict[str, str]] = {}
    for command, name, option in options():
        kinds.setdefault(name, {}).setdefault(kind_of(option), command)
    unlike = {name: of for name, of in kinds.items() if len(of) > 1}
    # The rest of what commands write is a folder, or one file, or for other programs either.
    assert unlike.pop("--out").keys() == {"DIR", "FILE", "PATH"}
    assert unlike == {}
    assert not FORMER & kinds.keys()


def test_one_option_name_has_one_meaning_in_all_commands():
    # Behind a comma or the like, a command adds its own default or example.
    heads: dict[tuple[str, str], dict[str, str]] = {}
    for command, name, option in options():
        head = re.split(r"[,;:.(\[]", option.help)[0].strip()
        key = (name, option.metavar if name == "--out" else "")
        heads.setdefault(key, {}).setdefault(head, command)
    assert {key: of for key, of in heads.items() if len(of) > 1} == {}


@pytest.mark.parametrize(
    ("words", "name"),
    [
        (("plot", "forward.toml"), "'stepwell figure'"),
        (("calibrate",), "'stepwell lab calibrate'"),
        (("yield", "forward.toml", "--wanted", "0>1>0"), "--target"),
        (("check", "forward.toml", "--stiffness-spread", "3"), "--stiffness-tolerance"),
        (("sweep", "cycle", "forward.toml", "--built", "3"), "--monte-carlo"),
        (("graph", "forward.toml", "--start", "00"), "--from"),
        (("new", "my.toml", "--from", "paper-forward"), "--preset"),
    ],
)
def test_a_former_or_usual_name_is_answered_with_the_present_one(stepwell, words, name):
    result = stepwell(*words)
    assert result.exit_code == 2
    assert name in result.output


@pytest.mark.parametrize("name", sorted({*SYNONYMS.values()}))
def test_every_suggested_command_exists(name):
    assert name.startswith("--") or tuple(name.split()) in {*LEAVES} | {(one[0],) for one in LEAVES}


def test_every_suggested_option_exists():
    names = {name for _, name, _ in options()}
    assert {one for meant in FORMER_OPTIONS.values() for one in meant} <= names


@pytest.mark.parametrize("name", ["three-wave", "preset:three-wave"])
def test_a_preset_is_read_by_its_name_alone(stepwell, name):
    assert stepwell("map", name, "--x", "0:20:2", "--y", "0:10:2").exit_code == 0
    assert stepwell("graph", name).exit_code == 0
    assert stepwell("new", "copy.toml", "--preset", name, "--force").exit_code == 0


@pytest.mark.parametrize("length", ["5", "5mm", "0.5cm", "5e-3m", "0.19685039370078740in"])
def test_a_length_has_a_unit_or_is_in_millimetres(length):
    assert ranges.length()(length) == pytest.approx(5)
    ends = ranges.span(f"-{length}:{length}")
    assert (ends.start, ends.stop) == (pytest.approx(-5), pytest.approx(5))


@pytest.mark.parametrize("length", ["5 furlongs", "mm", "-5", "nan", "5m5"])
def test_a_wrong_length_is_refused(length):
    with pytest.raises(typer.BadParameter, match="must be a length of at least 0 mm"):
        ranges.length()(length)


@pytest.mark.slow
def test_help_and_version_load_none_of_the_heavy_packages(tmp_path):
    # Not pydantic: some versions of Typer use it themselves.
    heavy = {"numba", "scipy", "xarray", "matplotlib", "rich"}
    # One process for all: what any of them loaded would be there at the end.
    script = """
import sys
from stepwell.cli import main
for words in (["--help"], ["run", "--help"], ["design", "--help"], ["--version"]):
    sys.argv[1:] = words
    try:
        main()
    except SystemExit as end:
        assert not end.code, words
print(*{name.partition('.')[0] for name in sys.modules}, file=sys.stderr)
"""
    result = subprocess.run([sys.executable, "-c", script], text=True, capture_output=True)
    assert result.returncode == 0, result.stderr
    assert result.stdout.count("Usage:") == 3
    assert "stepwell" in result.stderr.split() and not heavy & set(result.stderr.split())


@pytest.mark.slow
@pytest.mark.parametrize(
    "setting", ["STEPWELL_KERNELS=fast", *(["STEPWELL_LIMITS=cels=3"] if SIZE == "full" else [])]
)
def test_a_setting_that_is_none_ends_in_one_line(tmp_path, setting):
    name, _, value = setting.partition("=")
    result = subprocess.run(
        [COMMAND, "run", "preset:paper-forward"], cwd=tmp_path, capture_output=True, text=True,
        env={**os.environ, name: value},
    )  # fmt: skip
    assert result.returncode == 2
    assert len(result.stderr.splitlines()) == 1 and result.stderr.startswith(name)


@pytest.mark.slow
@pytest.mark.parametrize("where", ["a command", "a package"])
def test_a_bug_ends_in_one_line_and_a_report_and_is_no_user_error(tmp_path, where):
    patch = (
        "import stepwell.design as d\ndef f(*a, **k): raise KeyError('bug')\nd.margin = f"
        if where == "a command"
        else "sys.modules['typer'] = type('T', (), {'__getattr__': lambda s, n: {}['bug']})()"
    )
    folder = (
        "import stepwell.crash.report as r, pathlib\n"
        f"r._folders = lambda: [pathlib.Path({str(tmp_path)!r})]\n"
    )
    result = patched(folder + patch, "run", "preset:paper-forward", cwd=tmp_path)
    (report,) = tmp_path.iterdir()
    assert (result.returncode, result.stdout) == (1, "")
    assert result.stderr == (
        f"KeyError: 'bug' (unexpected). To report this error, attach {report}\n"
    )
    assert "Traceback" in report.read_text("utf-8")


@pytest.mark.slow
@posix
@pytest.mark.parametrize(
    ("name", "code"),
    # The other one, in the quick run, comes while an animation is drawn.
    [("SIGTERM", 143), *([("SIGINT", 130)] if SIZE == "full" else [])],
)
def test_an_interruption_leaves_the_folder_as_it_was(tmp_path, name, code):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "mine.csv").write_text("old")
    # The signal comes when the first figure has been written.
    patch = (
        "import os, signal, stepwell.figures as f\nsave = f.save\n"
        f"f.save = lambda *a, **k: (save(*a, **k), os.kill(os.getpid(), signal.{name}))"
    )
    result = patched(patch, *PROGRAM, cwd=tmp_path)
    assert result.returncode == code
    assert "Traceback" not in result.stderr
    assert os.listdir(tmp_path) == ["out"]
    assert os.listdir(tmp_path / "out") == ["mine.csv"]
    assert (tmp_path / "out" / "mine.csv").read_text() == "old"


@pytest.mark.slow
@posix
def test_an_interrupted_animation_leaves_no_file(tmp_path):
    patch = (
        "import os, signal\nfrom PIL import Image\nquantize = Image.Image.quantize\n"
        "Image.Image.quantize = lambda *a, **k: (quantize(*a, **k),"
        " os.kill(os.getpid(), signal.SIGINT))[0]"
    )
    result = patched(patch, "animate", "preset:paper-forward", cwd=tmp_path)
    assert result.returncode == 130
    assert os.listdir(tmp_path) == []


@pytest.mark.slow
@posix
def test_a_reader_that_leaves_early_is_no_error_message(tmp_path):
    process = subprocess.Popen(
        [COMMAND, "presets"], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    assert process.stdout is not None
    process.stdout.close()
    assert process.stderr is not None
    assert process.stderr.read() == b""
    process.stderr.close()
    assert process.wait() == 141


@pytest.mark.slow
def test_letters_that_the_output_cannot_hold_are_escaped(tmp_path):
    env = ENVIRONMENT | {"PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"}
    result = installed("run", "preset:paper-forward", cwd=tmp_path, env=env)
    assert result.returncode == 0
    assert r"20 \u2192 17.23" in result.stdout


@pytest.mark.slow
@posix
def test_a_terminal_gets_bold_heads_and_no_color_keeps_them_plain(tmp_path):
    env = ENVIRONMENT | {"TERM": "xterm-256color", "COLUMNS": "80"}
    shown = in_terminal("presets", cwd=tmp_path, env=env)
    assert "\x1b[1mNames and titles\x1b[0m" in shown
    plain = in_terminal("presets", cwd=tmp_path, env=env | {"NO_COLOR": "1"})
    piped = CliRunner().invoke(app, ["presets"], env={"COLUMNS": "80"}).stdout
    assert plain.replace("\r\n", "\n") == piped


# In the quick run tests/cli/test_progress.py has the bar, and the heads above a real terminal.
@pytest.mark.slow
@posix
@pytest.mark.skipif(SIZE == "ci", reason="an animation, twice")
def test_a_terminal_sees_progress_and_a_pipe_does_not(tmp_path, monkeypatch):
    env = ENVIRONMENT | {"TERM": "xterm-256color", "COLUMNS": "100"}
    arguments = ("animate", "preset:paper-forward", "--seconds", "1", "--fps", "5")
    assert "frames" in in_terminal(*arguments, cwd=tmp_path, env=env)
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(app, [*arguments, "--force"])
    assert (result.stdout, result.stderr) == ("Wrote cycle.gif\n", "")
