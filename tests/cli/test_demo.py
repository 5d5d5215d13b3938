"""The demo tells what the engine says, on one page that moves and needs nothing else."""

import os
import shlex
import signal
import subprocess
import sys
import webbrowser
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pytest
from typer.testing import CliRunner

import stepwell as sw
from cli.folders import written
from stepwell import files, reports
from stepwell.base import install
from stepwell.cli import app, screen
from stepwell.reports.story import steps

if TYPE_CHECKING:
    from playwright.sync_api import Browser

    from chromium import Opened

pytestmark = pytest.mark.slow
pytest.importorskip("mujoco", reason="the demo's robots need MuJoCo")


class AxisQuantity(NamedTuple):
    folder: Path
    words: str
    page: str


class Seen(HTMLParser):
    """What a page says, by the element it stands in, and which files of others it names."""

    def __init__(self, text: str):
        super().__init__()
        self.named: list[str] = []
        self.commands: list[str] = []
        self.words: list[str] = []
        self.frames = 0
        self._in_commands = False
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self.named += [value for key in ("src", "href", "data") if (value := given.get(key))]
        self.frames += tag == "iframe"
        self._in_commands |= given.get("class") == "commands"
        if self._in_commands and tag == "code":
            self.commands.append("")

    def handle_endtag(self, tag):
        self._in_commands &= tag != "pre"

    def handle_data(self, data):
        self.words.append(data)
        if self._in_commands and self.commands:
            self.commands[-1] += data


@pytest.fixture(scope="module")
def story(tmp_path_factory) -> AxisQuantity:
    """One demo, told once for all that is asked of it."""
    folder = tmp_path_factory.mktemp("demo") / "out"
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("COLUMNS", "80")
        result = CliRunner().invoke(app, ["demo", "--out", str(folder)], prog_name="stepwell")
    assert result.exit_code == 0, result.output
    return AxisQuantity(folder, result.stdout, (folder / "index.html").read_text("utf-8"))


@pytest.fixture
def opened(story, browser: "Browser") -> Iterator["Opened"]:
    """The page in a browser that has no network."""
    from chromium import Opened

    context = browser.new_context(offline=True, viewport={"width": 360, "height": 780})
    page = Opened(context.new_page())
    page.page.goto((story.folder / "index.html").as_uri())
    yield page
    context.close()


def test_it_says_what_the_engine_says(story):
    words = " ".join(story.words.split())
    leg, other = (files.load(story.folder / f"{n}.toml").chain for n in ("leg", "leg-reversed"))
    for chain in (leg, other):
        assert str(chain.cycle().sequence) in words
        assert f"{chain.margin().anchors[1] * 1e3:.4g} mm" in words
    assert str(leg.cycle().sequence) != str(other.cycle().sequence)
    wish = files.load(story.folder / "wish.toml").chain
    assert str(wish.cycle().sequence) == steps._TARGET
    built = wish.yields(sw.Tolerances(anchor=1e-3, stiffness=0.05))
    assert f"{built.successes:,} of {built.samples:,} random samples" in words
    turning = files.load(story.folder / "robot-turning.toml").robot.walk(cycles=steps._CYCLES)
    assert f"{np.degrees(turning.turn[1:].mean()):.3g}°" in words
    assert turning.turn[1:].mean() > np.radians(10)


def test_the_fingers_program_puts_up_one_finger_alone(story):
    hand = files.load(story.folder / "fingers.toml").chain
    plan = files.load(story.folder / "fingers.toml").program
    assert plan is not None
    program = plan.on(hand)
    up = [name for name, state in zip(hand.names, program.target, strict=True) if state == "1"]
    assert up == [steps._FINGER]
    assert program.arrives == program.target
    for point in program.turning_points[1:]:
        assert f"{point * 1e3:.4g} " in story.words


def test_the_lines_it_shows_of_a_design_file_are_in_it(story):
    text = {file.name: file.read_text("utf-8") for file in story.folder.glob("*.toml")}
    shown = "".join(Seen(story.page).words)
    anchors = [line for line in text["wish.toml"].splitlines() if line.startswith("q_mm")]
    assert len(anchors) == 3 and all(f"{line} # " in shown for line in anchors)
    assert text["fingers.toml"].partition("[program]")[2].strip() in shown
    name, gone, come = steps._moved("", *steps._legs())
    assert name in text["leg.toml"] and name in text["robot-turning.toml"]
    assert gone[1:] in text["leg.toml"] and gone[1:] not in text["leg-reversed.toml"]
    assert come[1:] in text["leg-reversed.toml"] and come[1:] in text["robot-turning.toml"]


def test_the_page_is_self_contained_and_has_a_section_for_each_step(story):
    page = Seen(story.page)
    assert all(name.startswith("data:") for name in page.named)
    assert "url(" not in story.page.partition("</style>")[0]
    words = " ".join(" ".join(page.words).split())
    for telling in reports.STEPS:
        assert telling.title in words and telling.title in story.words
    assert {step.removesuffix(".toml") for step in written(story.folder)} >= {"leg", "wish"}
    assert written(story.folder) == set(files.OUTPUTS["demo"])


@pytest.mark.parametrize("keeps", ["stepwell run", "stepwell program", "stepwell map"])
def test_its_commands_can_be_typed_in_its_folder(story, keeps, tmp_path, monkeypatch):
    _copy_designs(story.folder, tmp_path)
    monkeypatch.chdir(tmp_path)
    lines = [line for line in Seen(story.page).commands if line.startswith(keeps)]
    assert lines
    for line in lines:
        result = CliRunner().invoke(app, shlex.split(line)[1:], prog_name="stepwell")
        assert result.exit_code == 0, result.output


def _copy_designs(source: Path, target: Path) -> None:
    for file in source.glob("*.toml"):
        (target / file.name).write_bytes(file.read_bytes())


def test_every_command_on_the_page_is_one(story):
    lines = Seen(story.page).commands
    assert len(lines) >= len(reports.STEPS)
    for line in lines:
        words = shlex.split(line.strip())
        known = [file for file in words if file.endswith(".toml")]
        assert all((story.folder / name).exists() for name in known), line
        help_ = CliRunner().invoke(app, [words[1], "--help"], prog_name="stepwell").stdout
        assert all(word in help_ for word in words if word.startswith("--")), line


def test_all_that_moves_plays_with_the_network_off(story, opened):
    from playwright.sync_api import expect

    page = opened.page
    assert page.evaluate("document.documentElement.scrollWidth") <= 360
    frames = page.locator("iframe")
    moving = [step for step in reports.STEPS if "tables" not in step.needs]
    assert frames.count() == Seen(story.page).frames >= len(moving)
    for k in range(frames.count()):
        frames.nth(k).scroll_into_view_if_needed()
        slider = frames.nth(k).content_frame.get_by_role("slider").first
        # It plays by itself while it is seen.
        expect(slider).not_to_have_value("0")
        reached = slider.input_value()
        expect(slider).not_to_have_value(reached)
    assert not opened.wrong
    assert [url for url in opened.asked if not url.startswith(("data:", "about:"))] == [
        (story.folder / "index.html").as_uri()
    ]


def test_a_folder_of_others_is_left_alone_until_it_is_forced(tmp_path, monkeypatch):
    monkeypatch.setattr(reports, "STEPS", reports.STEPS[:1])
    (tmp_path / "index.html").write_text("my own")
    arguments = ["demo", "--out", str(tmp_path)]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 2 and "did not write index.html" in result.stderr
    assert result.stdout == ""
    assert (tmp_path / "index.html").read_text() == "my own"
    assert CliRunner().invoke(app, [*arguments, "--force"]).exit_code == 0
    assert written(tmp_path) == {"index.html", "leg.toml"}


@pytest.mark.parametrize("screen", [True, False])
@pytest.mark.parametrize("terminal", [True, False])
@pytest.mark.parametrize("wanted", [True, False])
def test_the_page_opens_only_where_somebody_sits(tmp_path, monkeypatch, screen, terminal, wanted):
    monkeypatch.setattr(reports, "STEPS", ())
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    if screen:
        monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr("stepwell.cli.screen.at_terminal", lambda: terminal)
    asked: list[str] = []
    monkeypatch.setattr(webbrowser, "open", asked.append)
    arguments = ["demo", "--out", str(tmp_path / "a b"), *([] if wanted else ["--no-open"])]
    assert CliRunner().invoke(app, arguments).exit_code == 0
    page = (tmp_path / "a b" / "index.html").resolve()
    assert asked == ([page.as_uri()] if screen and terminal and wanted else [])


def test_what_is_not_installed_is_left_out_and_said_first(tmp_path, monkeypatch):
    monkeypatch.setattr(reports, "STEPS", (reports.STEPS[0], *reports.STEPS[-2:]))
    monkeypatch.setattr("stepwell.base.extras.find_spec", lambda name: None)
    result = CliRunner().invoke(app, ["demo", "--out", str(tmp_path / "out")])
    assert result.exit_code == 0, result.output
    missing = [telling.title for telling in reports.STEPS[1:]]
    first = result.stdout.partition("\n1  ")[0]
    assert all(title in " ".join(first.split()) for title in missing)
    assert install("all") in " ".join(first.split())
    assert written(tmp_path / "out") == {"index.html", "leg.toml"}
    page = " ".join(Seen((tmp_path / "out" / "index.html").read_text("utf-8")).words)
    assert all(title in page for title in missing)


@pytest.mark.skipif(os.name != "posix", reason="a terminal's Ctrl-C goes to a group")
def test_ctrl_c_leaves_nothing(tmp_path):
    command = Path(sys.executable).parent / "stepwell"
    process = subprocess.Popen(
        [str(command), "demo", "--out", "out"], cwd=tmp_path, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip
    assert process.stdout is not None
    # Once a step is told the next one is being made.
    for line in process.stdout:
        if line.startswith("2  "):
            break
    os.killpg(process.pid, signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130
    assert said.startswith("Interrupted") and "nothing was written" in said
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("columns", [40, 80])
def test_no_line_is_longer_than_the_terminal(tmp_path, monkeypatch, columns):
    monkeypatch.setattr(reports, "STEPS", reports.STEPS[:2])
    monkeypatch.setenv("COLUMNS", str(columns))
    monkeypatch.setattr(screen, "styled", lambda: False)
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(app, ["demo"])
    assert result.exit_code == 0, result.output
    assert max(map(len, result.stdout.splitlines())) <= columns
    assert result.stdout.rstrip().endswith("stepwell-demo/index.html")
