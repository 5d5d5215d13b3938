"""A robot's replay: one file that plays without a server, with Python's numbers."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco")

import stepwell as sw
from stepwell import files
from stepwell.accounts import simulation_assumptions
from stepwell.robot import Robot
from stepwell.simulation import Maze, Walk, maze, walk
from stepwell.studio.standalone import replay
from studio.browser import Opened, number, opens, output

from playwright.sync_api import Page, expect  # isort: skip

# What a replay rounds to, and what is shown of it.
ROUNDED = 1e-3


@pytest.fixture(scope="module")
def left() -> Walk:
    robot = sw.preset("robot-left")
    assert isinstance(robot, Robot)
    return walk(robot, 4)


@pytest.fixture(scope="module")
def pressed() -> Maze:
    """A robot that has come to a wall."""
    robot = sw.preset("robot-explorer")
    assert isinstance(robot, Robot)
    return maze(robot, files.load_arena("wall"), limit=40.0)


def near(page: Page, name: str, value: float, off: float = ROUNDED) -> None:
    """A number on the page is Python's, but for what was rounded of it."""
    assert number(page, name) == pytest.approx(value, rel=5e-3, abs=off)


def at(page: Page, run: Walk, slider_value: int) -> int:
    """Bring the cursor there; the sample of the run that is shown."""
    page.get_by_role("slider", name="Time in the run").fill(str(slider_value))
    return int(np.argmin(np.abs(run.time - number(page, "time"))))


def test_every_number_of_a_walk_is_pythons_and_nothing_is_loaded(
    offline: Opened, tmp_path: Path, left: Walk
):
    text = replay(left)
    assert len(text.encode()) < 200_000
    page = opens(offline, tmp_path, text)
    begin = int(np.searchsorted(left.time, 0.0))
    count = len(left.time) - begin
    expect(page.get_by_role("slider", name="Time in the run")).to_have_attribute(
        "max", str(count - 1)
    )
    for k in (0, count // 3, count - 1):
        sample = at(page, left, k)
        assert sample == begin + k
        near(page, "stroke of the robot", left.stroke[sample] * 1e3)
        turned = np.degrees(left.yaw[sample] - left.yaw[begin])
        near(page, "turned", turned, 0.06)
        heading = left.yaw[begin]
        ahead = np.cos(heading) * (left.x[sample] - left.x[begin]) + np.sin(heading) * (
            left.y[sample] - left.y[begin]
        )
        near(page, "moved ahead", ahead * 1e3, 0.06)
        for i, leg in enumerate(left.robot.legs):
            state = left.state(leg.name, left.time[sample]) or "in transit"
            expect(output(page, f"state of leg {leg.name}")).to_have_text(state)
            near(page, f"force under foot {leg.name}", left.foot_force[sample, i])
    near(page, "turn", np.degrees(left.turn[1:].mean()))
    for line in simulation_assumptions(left):
        expect(page.get_by_role("listitem").filter(has_text=line)).to_be_visible()


def test_a_walk_plays_to_its_end_and_goes_by_the_keyboard(
    offline: Opened, tmp_path: Path, left: Walk
):
    page = opens(offline, tmp_path, replay(left))
    slider = page.get_by_role("slider", name="Time in the run")
    slider.press("ArrowRight")
    expect(slider).to_have_value("1")
    page.get_by_label("Playback speed").select_option("16")
    page.get_by_role("button", name="Play the run").press("Enter")
    expect(page.get_by_role("button", name="Play the run")).to_be_visible()
    expect(slider).to_have_value(slider.get_attribute("max") or "")


def test_the_way_through_an_arena_has_its_walls_and_what_it_touched(
    offline: Opened, tmp_path: Path, pressed: Maze
):
    page = opens(offline, tmp_path, replay(pressed))
    expect(output(page, "outcome")).to_have_text(pressed.ending)
    when = pressed.touched["wall 1"]
    assert when is not None
    expect(output(page, "touched")).to_have_text(f"wall 1 at {when:.3g} s")
    walls = page.locator("polygon.obstacle")
    expect(walls).to_have_count(len(pressed.arena.walls))
    expect(page.locator("polygon.touched")).to_have_count(0)
    slider = page.get_by_role("slider", name="Time in the run")
    slider.fill(slider.get_attribute("max") or "")
    expect(page.locator("polygon.touched")).to_have_count(1)
    (contact, *_) = pressed.contacts
    most = (contact.begin + contact.end) / 2
    sample = at(page, pressed.walk, round(most / pressed.walk.settings.sample))
    k = [one.name for one in pressed.walk.robot.antennas].index(contact.antenna)
    near(page, f"swing of antenna {contact.antenna}", np.degrees(pressed.walk.antenna[sample, k]))


def test_a_robot_is_seen_whole_on_a_phone(offline: Opened, tmp_path: Path, pressed: Maze):
    offline.page.set_viewport_size({"width": 360, "height": 740})
    page = opens(offline, tmp_path, replay(pressed))
    expect(output(page, "outcome")).to_be_visible()
    assert page.evaluate("document.documentElement.scrollWidth") <= 360


# Cells of tables that are wider than the page or cut off, and those whose label is indented.
CELLS = """
() => [...document.querySelectorAll("td")].filter((one) =>
  one.getBoundingClientRect().right > innerWidth || one.scrollWidth > one.clientWidth + 1
  || getComputedStyle(one).paddingLeft !== "0px").map((one) => one.textContent)
"""


@pytest.mark.parametrize("run", ["left", "pressed"], ids=["walk", "maze"])
def test_the_report_of_a_run_fits_a_phone(offline: Opened, tmp_path: Path, run: str, request):
    sw.reports.write(request.getfixturevalue(run), tmp_path, video=False)
    page = offline.page
    page.set_viewport_size({"width": 390, "height": 844})
    page.goto((tmp_path / "report.html").as_uri())
    page.evaluate("document.querySelectorAll('details').forEach((one) => one.open = true)")
    assert page.locator("td:visible").count() > 100
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    assert page.evaluate(CELLS) == []
    page.locator("iframe").scroll_into_view_if_needed()
    slider = page.frame_locator("iframe").get_by_role("slider", name="Time in the run")
    expect(slider).to_be_visible()


def test_a_run_that_was_over_at_once_is_refused(left: Walk):
    from dataclasses import fields, replace

    none = {
        field.name: getattr(left, field.name)[:0]
        for field in fields(left)
        if isinstance(getattr(left, field.name), np.ndarray)
    }
    with pytest.raises(ValueError, match=r"no samples\. Stopped at once\."):
        replay(replace(left, **none, stopped="Stopped at once."))
