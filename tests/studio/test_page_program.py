"""The plan of the actuator in a browser: drawn, planned, kept, and each time what Python says."""

import re

import pytest

import stepwell as sw
from stepwell import files
from studio.browser import middle, output, settled

from playwright.sync_api import Page, expect  # isort: skip


@pytest.fixture
def tab(page: Page) -> Page:
    page.get_by_role("tab", name="Program").click()
    expect(output(page, "states visited")).to_be_visible()
    return page


def turn(page: Page, name: str):
    return page.get_by_role("slider", name=name, exact=True)


def drawn(page: Page) -> list[float]:
    """The turning points that the page shows [mm], without the first."""
    sliders = page.get_by_role("group", name="Program of the actuator").get_by_role("slider").all()
    return [float(one.get_attribute("aria-valuenow") or "") for one in sliders]


def visited(points: list[float], start: str = "00") -> str:
    chain = sw.preset("paper-forward")
    program = sw.Program.given(chain, [point / 1e3 for point in points], start=start)
    return str(program.sequence)


def test_a_turn_that_is_dragged_does_what_python_says(tab: Page):
    x, y = middle(turn(tab, "Turn 1").locator(".dot"))
    tab.mouse.move(x, y)
    tab.mouse.down()
    for k in range(1, 6):
        tab.mouse.move(x, y + 16 * k)
    tab.mouse.up()
    points = [0.0, *drawn(tab)]
    assert points[1] < 35
    says = visited(points)
    expect(output(tab, "states visited")).to_have_attribute("data-value", says)


def test_a_plan_goes_by_the_keyboard_alone(tab: Page):
    turn(tab, "Turn 1").press("Shift+ArrowDown")
    turn(tab, "Turn 1").press("ArrowUp")
    tab.get_by_role("button", name="Add a turn").click()
    expect(turn(tab, "Turn 2")).to_be_visible()
    expect(output(tab, "states visited")).to_have_attribute(
        "data-value", visited([0.0, *drawn(tab)])
    )
    turn(tab, "Turn 2").press("Delete")
    expect(turn(tab, "Turn 2")).to_have_count(0)


def test_it_is_brought_to_a_state_and_kept_in_the_design(tab: Page):
    tab.get_by_role("textbox", name="Target state").fill("01")
    tab.get_by_role("button", name="Plan", exact=True).click()
    expect(output(tab, "ends in")).to_have_text("01")
    points = [0.0, *drawn(tab)]
    expect(output(tab, "states visited")).to_have_attribute("data-value", visited(points))
    tab.get_by_role("button", name="Keep in the design").click()
    settled(tab)
    with tab.expect_download() as saved:
        tab.get_by_role("button", name="Save").click()
    text = saved.value.path().read_text("utf-8")
    program = files.loads(text).program
    assert program is not None
    assert [point * 1e3 for point in program.turning_points] == pytest.approx(points)
    assert program.ends == "01"
    tab.get_by_role("button", name="Undo").click()
    settled(tab)


def test_a_state_that_is_none_is_refused_in_words(tab: Page):
    tab.get_by_role("textbox", name="Target state").fill("07")
    tab.get_by_role("button", name="Plan", exact=True).click()
    expect(tab.get_by_role("alert")).to_have_text(re.compile("one digit a cell"))
