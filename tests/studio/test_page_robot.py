"""A robot's page in a browser: walked, sent through an arena, edited by hand."""

import re
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("mujoco")

import stepwell as sw
from stepwell import files
from stepwell.robot import Robot
from stepwell.simulation import Maze
from stepwell.studio.standalone import replay
from studio.browser import Opened, begun, middle, number, output, settled, shown_as, without
from studio.test_page_photo import png

from playwright.sync_api import Page, expect  # isort: skip

# A process of its own has to start first, and compile.
PATIENT = 120_000


# No file is read before the test lets it be.
UNREAD = """
const allowed = new Promise((allow) => { window.allow = allow; });
const { text } = Blob.prototype, { readAsDataURL } = FileReader.prototype;
Blob.prototype.text = async function () { await allowed; return text.call(this); };
FileReader.prototype.readAsDataURL = async function (blob) {
  await allowed;
  readAsDataURL.call(this, blob);
};
const { set } = Object.getOwnPropertyDescriptor(HTMLImageElement.prototype, "src");
Object.defineProperty(HTMLImageElement.prototype, "src", {
  async set(url) { await allowed; set.call(this, url); },
});
"""


@pytest.fixture
def robot_page(blank: Opened, empty_address: str) -> Page:
    """A robot with antennas: predictions and the view in space are looked at in one test."""
    page = begun(blank.page, empty_address, "robot-explorer")
    expect(button(page, "Walk")).to_be_enabled()
    return page


# Of a dot the middle, of the plan the corner.
BOX = """{ const { x, y, width, height } = each.getBoundingClientRect();
  return each === one ? [x + width / 2, y + height / 2] : [x, y]; }"""


def button(page: Page, name: str) -> Any:
    return page.get_by_role("button", name=name, exact=True)


def plan(page: Page) -> Any:
    return page.get_by_role("group", name="The robot on the floor, top view")


def drag(page: Page, begin: tuple[float, float], end: tuple[float, float]) -> None:
    page.mouse.move(*begin)
    page.mouse.down()
    for k in range(1, 9):
        page.mouse.move(*(a + (b - a) * k / 8 for a, b in zip(begin, end, strict=True)))
    page.mouse.up()
    page.wait_for_timeout(100)


def typed(page: Page, name: str, value: str) -> None:
    field = page.get_by_role("spinbutton", name=name, exact=True)
    field.fill(value)
    field.press("Enter")


def arena_kept(page: Page) -> dict[str, Any]:
    return page.evaluate("JSON.parse(localStorage.getItem('stepwell.arena'))")


def design_kept(page: Page) -> Robot:
    settled(page)
    kept = page.evaluate("JSON.parse(localStorage.getItem('stepwell.designs'))")[0]["design"]
    return files.loads_tables(kept).robot


def compare(page: Page, walk: Any) -> None:
    """Time, states and antennas at the cursor with those of Python."""
    slider = page.get_by_role("slider", name="Time in the run")
    expect(slider).to_be_enabled()
    for sample in (0, len(walk.time) // 2, len(walk.time) - 1):
        slider.fill(str(sample))
        assert number(page, "time") == shown_as(walk.time[sample])
        assert number(page, "stroke of the robot") == float(f"{walk.stroke[sample] * 1e3:.3g}")
        for k, leg in enumerate(walk.robot.legs):
            state = walk.state(leg.name, walk.time[sample]) or "in transit"
            expect(output(page, f"state of leg {leg.name}")).to_have_text(state)
            shown = number(page, f"force under foot {leg.name}")
            assert shown == float(f"{walk.foot_force[sample, k]:.3g}")


# Moves the cursor to the start in the moment in which a run has ended. A run of which nothing
# arrived before it ended has a cursor only then.
AT_ONCE = """() => new MutationObserver((_, watch) => {
  const slider = document.querySelector('[aria-label="Time in the run"]');
  if (!slider || slider.disabled) return;
  watch.disconnect();
  slider.value = "0";
  slider.dispatchEvent(new Event("input", { bubbles: true }));
  document.body.dataset.moved = "yes";
}).observe(document.body, { subtree: true, childList: true, attributeFilter: ["disabled"] })"""


def test_a_robot_of_the_gallery_shows_its_legs_and_walks_as_python_says(
    opened: Opened, empty_address: str
):
    page = opened.page
    page.add_init_script(without("yield", "thumbnails"))
    page.goto(empty_address)
    page.get_by_role("button", name=re.compile("walks forward: q")).first.click()
    legs = page.get_by_role("group", name="Leg whose chain is shown below")
    expect(legs.get_by_role("button")).to_have_text(["leg left", "leg right"])
    robot = sw.preset("robot-forward")
    prediction = robot.predict()
    expect(output(page, "prediction")).to_have_text(
        f"{prediction.motion.value}, predicted d/u_max {prediction.advance:.3g}", timeout=PATIENT
    )
    expect(page.locator("canvas[data-ready]")).to_be_visible()
    assert [url for url in opened.asked if url.endswith("scene.js")]
    # There is no run yet that could be exported, and no cursor.
    button(page, "Export").click()
    expect(button(page, "Save page of the run")).to_have_count(0)
    button(page, "Close").click()
    expect(button(page, "Close")).to_have_count(0)
    typed(page, "Cycles to walk", "2")
    expect(page.get_by_role("slider", name="Time in the run")).to_have_count(0)
    page.evaluate(AT_ONCE)
    button(page, "Walk").click()
    page.locator("body[data-moved]").wait_for(timeout=PATIENT)
    moved = number(page, "time")
    page.wait_for_timeout(400)  # twice as long as the picture takes to catch up
    assert number(page, "time") == moved < 0.1
    walk = robot.walk(2)
    from stepwell.accounts import account

    record = account(walk).record
    assert number(page, "cycles") == 2
    assert number(page, "advance") == shown_as(record["mean_advance_over_u_max"])
    assert number(page, "turn") == shown_as(record["mean_turn_deg"])
    assert number(page, "distance") == shown_as(record["distance_mm"])
    compare(page, walk)
    button(page, "Export").click()
    with page.expect_download(timeout=PATIENT) as saved:
        button(page, "Save page of the run").click()
    assert saved.value.suggested_filename.endswith("-run.html")
    assert saved.value.path().read_text("utf-8") == replay(walk)
    button(page, "Close").click()
    # A phone needs no sideways scrolling.
    page.set_viewport_size({"width": 390, "height": 844})
    page.get_by_text("Dimensions of the arena").click()
    page.wait_for_timeout(200)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390


def test_a_wall_is_drawn_and_the_robot_sent_past_it(robot_page: Page):
    page = robot_page
    page.get_by_role("combobox", name="Arena", exact=True).select_option("open")
    expect(button(page, "Through the arena")).to_be_enabled()
    button(page, "Draw walls").click()
    x, y = middle(page.get_by_role("button", name="start", exact=True).locator(".dot"))
    box = plan(page).bounding_box()
    assert box is not None
    wide = box["width"] * 0.06
    drag(page, (x + 3.4 * wide, y + wide), (x + 4.4 * wide, y - 1.5 * wide))
    arena = arena_kept(page)
    assert len(arena["wall"]) == 1
    typed(page, "Time limit in s", "15")
    button(page, "Through the arena").click()
    expect(output(page, "outcome")).to_be_visible(timeout=PATIENT)
    maze: Maze = sw.preset("robot-explorer").maze(files.loads_arena_tables(arena), limit=15)
    expect(output(page, "outcome")).to_have_text(maze.ending)
    assert number(page, "contacts") == len(maze.contacts)
    assert number(page, "gait changes") == len(maze.changes)
    assert number(page, "distance") == shown_as(maze.walk.distance * 1e3)
    compare(page, maze.walk)
    button(page, "Back to the start").click()
    page.get_by_role("button", name="second end of wall 1").press("Shift+ArrowLeft")
    assert arena_kept(page)["wall"][0]["to_mm"][0] == arena["wall"][0]["to_mm"][0] - 10
    page.get_by_role("button", name="wall 1", exact=True).press("Delete")
    assert arena_kept(page)["wall"] == []


def test_files_are_read_although_their_fields_are_gone(robot_page: Page, tmp_path: Path):
    page = robot_page
    page.evaluate(UNREAD)
    page.get_by_role("tab", name="Measured").click()
    arena, recording = tmp_path / "arena.toml", tmp_path / "mine.txt"
    arena.write_text(files.arena_text("three-walls"))
    recording.write_text("no recording")
    chosen = {
        "Open an arena file": arena,
        "Recordings of a test machine": recording,
        "Choose a photo to trace": png(tmp_path / "leg.png", 60, 40),
    }
    for label, file in chosen.items():
        page.get_by_label(label).set_input_files(file)
    button(page, "Gallery").click()
    for label in chosen:
        expect(page.get_by_label(label)).to_have_count(0)
    page.evaluate("allow()")
    button(page, "Gallery").click()
    expect(page.locator("image")).to_have_attribute("href", re.compile("^blob:"))
    expect(button(page, "Leave mine.txt out")).to_be_visible()
    expect(page.get_by_role("button", name="wall 1", exact=True)).to_be_visible()
    assert arena_kept(page)["title"] == "Three walls in the open"
    # What a page throws is looked at by the fixture.


def test_a_run_can_be_ended_and_what_is_known_of_it_stays(robot_page: Page):
    page = robot_page
    typed(page, "Cycles to walk", "1000")
    button(page, "Walk").click()
    slider = page.get_by_role("slider", name="Time in the run")
    expect(slider).to_be_visible(timeout=PATIENT)
    button(page, "Cancel").click()
    expect(page.get_by_text("Ended before it was done.")).to_be_visible()
    expect(slider).to_be_enabled()
    expect(button(page, "Walk")).to_be_enabled()


def test_an_antenna_is_dragged_and_one_undo_takes_it_back(robot_page: Page):
    page = robot_page
    tip = page.get_by_role("button", name="tip of antenna left")
    before = design_kept(page).antennas[0]
    x, y = middle(tip.locator(".dot"))
    first = plan(page).bounding_box()
    drag(page, (x, y), (x + 20, y - 10))
    after = design_kept(page).antennas[0]
    assert after.length > before.length
    assert after.pivot == before.pivot
    ends = (("x", x), ("y", y))
    length = page.get_by_role("spinbutton", name="length of antenna left in mm").input_value()
    assert float(length) == pytest.approx(after.length * 1e3)
    boxes = f"(one) => [one, one.closest('svg')].map((each) => {BOX})"
    placed, last = tip.locator(".dot").evaluate(boxes)
    # Words above the plan, which come later, may move all of it.
    assert first is not None
    moved = [placed[k] - last[k] - (one - first[key]) for k, (key, one) in enumerate(ends)]
    assert moved == pytest.approx([20, -10], abs=3)
    button(page, "Undo").click()
    assert design_kept(page).antennas[0] == before
    tip.press("ArrowUp")
    assert design_kept(page).antennas[0] != before
    button(page, "Undo").click()


def test_a_wrong_antenna_is_reported_at_its_field(robot_page: Page):
    page, name = robot_page, "length of antenna left in mm"
    typed(page, name, "-1")
    field = page.get_by_role("spinbutton", name=name)
    expect(field).to_have_attribute("aria-invalid", "true")
    expect(page.get_by_role("alert").first).to_contain_text("antenna[0].length_mm")
    typed(page, name, "130")
    expect(page.get_by_role("alert")).to_have_count(0)


def test_an_arena_that_cannot_be_is_reported_and_can_be_mended(robot_page: Page):
    page = robot_page
    page.get_by_role("combobox", name="Arena", exact=True).select_option("open")
    expect(button(page, "Through the arena")).to_be_enabled()
    page.get_by_text("Dimensions of the arena").click()
    button(page, "Add a cylinder").click()
    typed(page, "cylinder 1, x in mm", "0")
    expect(page.get_by_role("alert")).to_contain_text("inside an obstacle")
    button(page, "Remove cylinder 1").click()
    expect(page.get_by_role("alert")).to_have_count(0)


def test_three_dimensions_are_loaded_for_robots_alone(page: Page, shared: Opened):
    assert not [url for url in shared.asked if url.endswith("scene.js")]
    assert page.get_by_role("region", name="Robot").count() == 0
