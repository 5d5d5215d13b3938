"""Who waits at a terminal is told how far it is and how long it will take; nobody else is."""

import io
import re
import sys
from contextlib import contextmanager
from importlib import import_module
from time import sleep

import pytest

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


def telling(reported):
    """In the place of `progress`: keeps what is told."""

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


def test_other_clients_receive_nothing(monkeypatch):
    pipe = io.StringIO()
    monkeypatch.setattr(sys, "stderr", pipe)
    with progress("walking") as tell:
        assert tell is None
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
    monkeypatch.setattr(f"stepwell.cli.{module}.progress", telling(reported))
    if arguments[1] == "converge":
        few = simulation.convergence
        monkeypatch.setattr(
            simulation, "convergence", lambda robot, **rest: few(robot, (1e-3, 5e-4), **rest)
        )
    assert stepwell(*arguments).exit_code in (0, 3)
    assert len(reported) > 3
    assert all(0 <= done <= total + 1e-6 for done, total in reported)
