"""Progress: a bar at a terminal, a line every half minute elsewhere, nothing with --json."""

import io
import os
import re
import subprocess
import sys
from contextlib import contextmanager, suppress
from importlib import import_module
from operator import attrgetter
from time import sleep

import pytest

import stepwell as stepwell_package
from stepwell import simulation
from stepwell.cli.screen import progress


class Terminal(io.StringIO):
    def isatty(self):
        return True


def at_a_terminal(monkeypatch) -> Terminal:
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.delenv("NO_COLOR", raising=False)
    screen = Terminal()
    monkeypatch.setattr(sys, "stderr", screen)
    return screen


def recorder(reported):
    """In the place of `progress`: keeps the reported numbers."""

    @contextmanager
    def kept(_):
        yield lambda done, total: reported.append((done, total))

    return kept


def shown(text: str) -> str:
    return re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", text)


def test_a_terminal_sees_how_far_it_is_and_how_long_it_will_take(monkeypatch):
    screen = at_a_terminal(monkeypatch)
    with progress("walking") as tell:
        assert tell is not None
        for done in (1, 2, 3):
            tell(done, 1000)
            sleep(0.11)
    bar = shown(screen.getvalue())
    assert "walking" in bar
    # 0.11 s for one: some two minutes for the rest.
    left = [int(m) * 60 + int(s) for m, s in re.findall(r"0:(\d\d):(\d\d)", bar)]
    assert left and all(100 <= seconds <= 600 for seconds in left)


def test_without_a_terminal_long_work_writes_a_line_every_half_minute(monkeypatch):
    pipe = io.StringIO()
    monkeypatch.setattr(sys, "stderr", pipe)
    now = 0.0
    monkeypatch.setattr(import_module("stepwell.base.bar"), "monotonic", lambda: now)
    with progress("walking") as tell:
        for done in range(1, 9):
            now += 10.0
            tell(done, 8)
    lines = pipe.getvalue().splitlines()
    assert [re.findall(r"\d+(?=%)", line) for line in lines] == [["38"], ["75"]]
    assert all(line.startswith("walking: ") for line in lines)


def test_short_work_without_a_terminal_writes_nothing(monkeypatch):
    pipe = io.StringIO()
    monkeypatch.setattr(sys, "stderr", pipe)
    with progress("walking") as tell:
        tell(1, 2)
    assert pipe.getvalue() == ""


def test_a_million_small_steps_move_the_bar_now_and_then(monkeypatch):
    at_a_terminal(monkeypatch)
    now = 0.0
    monkeypatch.setattr(import_module("stepwell.base.bar"), "monotonic", lambda: now)
    from rich.progress import Progress

    moved: list[float] = []
    monkeypatch.setattr(Progress, "update", lambda *_, completed, **_rest: moved.append(completed))
    with progress("yield") as tell:
        assert tell is not None
        for done in range(10_001):
            now = done * 1e-4  # a second in all
            tell(done, 10_000)
    assert len(moved) <= 12
    assert (moved[0], moved[-1]) == (0, 10_000)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("module", "arguments"),
    [
        ("design", ("reprogram", "preset:friction", "--by", "outer.q", "--reach", "1")),
        ("screen", ("graph", "preset:three-stack")),
        ("screen", ("robot", "converge", "preset:robot-forward")),
    ],
    ids=["reprogram", "graph", "robot"],
)
def test_commands_that_may_take_long_tell_their_progress(stepwell, module, arguments, monkeypatch):
    reported: list[tuple[float, float]] = []
    monkeypatch.setattr(f"stepwell.cli.{module}.progress", recorder(reported))
    if arguments[1] == "converge":
        few = simulation.convergence
        monkeypatch.setattr(
            simulation, "convergence", lambda robot, **rest: few(robot, (1e-3, 5e-4), **rest)
        )
    assert stepwell(*arguments).exit_code in (0, 3)
    assert len(reported) > 3
    assert all(0 <= done <= total + 1e-6 for done, total in reported)


@pytest.fixture
def bars(monkeypatch):
    """Labels of the bars of commands, as at a terminal: all of them, and those that are open."""
    shown: list[str] = []
    open_now: list[str] = []

    @contextmanager
    def on_terminal(label):
        shown.append(label())
        open_now.append(label())
        yield lambda *_: None
        open_now.pop()

    monkeypatch.setattr("stepwell.cli.screen.on_terminal", on_terminal)
    return shown, open_now


# Commands, each with the functions that take its time.
LONG = [
    (("animate", "preset:paper-forward", "--fps", "1"), ["figures.animation", "Chain.cycle"]),
    (("figure", "preset:paper-forward"), ["reports.figure", "figures.save"]),
    (("figure", "paper:fig1"), ["reports.figure_of", "figures.save"]),
    (("graph", "preset:three-wave", "--out", "wave.svg"), ["reports.write_graph"]),
    (("robot", "show", "robot-forward"), ["Robot.predict"]),
    (("export", "robot-forward"), ["simulation.mjcf"]),
    (("doctor",), ["cli.about.installation"]),
]


@pytest.mark.parametrize(("arguments", "functions"), LONG, ids=lambda one: "-".join(one[:2]))
def test_computing_and_writing_show_a_bar(stepwell, bars, arguments, functions, monkeypatch):
    called: list[tuple[str, bool]] = []

    def watched(name, function):
        def call(*given, **named):
            called.append((name, bool(bars[1])))
            return function(*given, **named)

        return call

    for name in functions:
        place, attribute = name.rpartition(".")[::2]
        owner = attrgetter(place)(stepwell_package)
        monkeypatch.setattr(owner, attribute, watched(name, getattr(owner, attribute)))
    result = stepwell(*arguments)
    assert result.exit_code == 0, result.output
    assert {*called} == {(name, True) for name in functions}


def test_json_at_a_terminal_has_no_bar(stepwell, bars):
    shown, _ = bars
    assert stepwell("run", "preset:paper-forward", "--json").exit_code == 0
    assert shown == []
    # A call of Python in the same process has its bar again.
    with progress("after"):
        pass
    assert shown == ["after"]
    assert stepwell("run", "preset:paper-forward").exit_code == 0
    assert "following" in shown


@pytest.mark.slow
def test_an_animation_shows_its_frames_at_a_terminal_and_nothing_in_a_pipe(tmp_path):
    pty = pytest.importorskip("pty", reason="there is no pseudo-terminal here")
    words = [sys.executable, "-c", "import stepwell.cli as c; c.main()", "animate"]
    words += ["preset:paper-forward", "--seconds", "1", "--force"]
    env = {**os.environ, "TERM": "xterm-256color"}
    ours, theirs = pty.openpty()
    printed = b""
    with subprocess.Popen(words, cwd=tmp_path, stdout=subprocess.PIPE, stderr=theirs, env=env):
        os.close(theirs)
        # The end of a terminal is an error on Linux.
        with suppress(OSError), os.fdopen(ours, "rb", buffering=0) as terminal:
            while part := terminal.read(1 << 16):
                printed += part
    at_terminal = shown(printed.decode())
    piped = subprocess.run(words, cwd=tmp_path, capture_output=True, env=env, check=True)
    assert "frames" in at_terminal and "%" in at_terminal
    assert piped.stderr == b""
