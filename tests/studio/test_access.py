"""The page keeps nobody out: axe finds nothing, by all of its rules and in all that is shown."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from chromium import nothing_found
from sizes import SIZE, cases
from stepwell import files
from studio.browser import ANSWERED, COUNTED, HASTY, begun, field, leave, output, settled, without

from playwright.sync_api import Browser, Page, expect  # isort: skip

ALL = {
    "light": {"viewport": {"width": 1280, "height": 800}, "color_scheme": "light"},
    "dark": {"viewport": {"width": 1280, "height": 800}, "color_scheme": "dark"},
    "narrow": {"viewport": {"width": 390, "height": 844}, "color_scheme": "light"},
    "narrow and dark": {"viewport": {"width": 390, "height": 844}, "color_scheme": "dark"},
}
# Both widths and both schemes, if not each with each.
WINDOWS = ALL if SIZE == "full" else {name: ALL[name] for name in ("light", "narrow and dark")}


# What is behind these tabs before anything is opened there is the same for all designs.
ALIKE = "Measured", "Atlas"


def each_tab(page: Page, axe: str, *passed: str) -> None:
    """All that is shown with each tab open, whatever tabs there are; some are passed by."""
    tabs = [tab for tab in page.get_by_role("tab").all() if tab.inner_text() not in passed]
    assert len(tabs) > 3
    for k, tab in enumerate(tabs):
        tab.click()
        settled(page)
        page.evaluate(ANSWERED, 700)  # what follows the design is asked after a rest
        # A tab changes its panel alone: in the quick run the whole page is examined once.
        nothing_found(page, axe, None if k == 0 or SIZE == "full" else "[role=tabpanel]")


@pytest.fixture(scope="module", params=WINDOWS)
def window(request: pytest.FixtureRequest, browser: Browser) -> Iterator[Page]:
    with loaded(browser, **WINDOWS[request.param]) as page:
        yield page


@pytest.fixture(scope="module")
def laptop(browser: Browser) -> Iterator[Page]:
    """One page for all designs but the paper's."""
    with loaded(browser, **ALL["light"]) as page:
        yield page


@contextmanager
def loaded(browser: Browser, **look: Any) -> Iterator[Page]:
    """A page that is soon told all that it asks; motions and an atlas would not come in time."""
    context = browser.new_context(**look)
    for script in (HASTY, COUNTED, without("thumbnails", "atlas")):
        context.add_init_script(script)
    yield context.new_page()
    context.close()


def test_the_gallery(window: Page, empty_address: str, axe: str):
    window.goto(empty_address)
    window.get_by_role("button", name="Three cells, a wave").wait_for()
    nothing_found(window, axe)


def test_a_chain_with_each_tab_open(window: Page, address: str, axe: str):
    leave(window)
    window.goto(address)
    output(window, "sequence").wait_for()
    each_tab(window, axe)
    assert window.evaluate("document.documentElement.scrollWidth") <= window.evaluate("innerWidth")


@pytest.mark.parametrize(
    "design",
    cases(
        ["balloon", "robot-forward", "friction", "paper-forward-double"],
        ["balloon", "robot-forward", "both"],
    ),
)
def test_elements_robots_searched_margins_and_several_bands(
    laptop: Page, empty_address: str, axe: str, design: str
):
    leave(laptop)
    begun(laptop, empty_address, rubbing_bands() if design == "both" else design)
    each_tab(laptop, axe, *cases((), ALIKE))


def rubbing_bands() -> dict[str, Any]:
    """A margin that is searched for, and several bands on a cell."""
    design = files.tables_in(files.preset_text("paper-forward-double"))
    for cell in design["chain"]["cell"]:
        cell["friction_N"] = 0.02
    return design


def test_a_problem_a_lock_and_holes(page: Page, axe: str):
    page.get_by_role("button", name="Lock p of inner").click()
    page.get_by_role("spinbutton", name="Snap to holes").fill("2.5")
    field(page, "q", "outer", "x").fill("9999999")
    field(page, "q", "outer", "x").press("Enter")
    expect(page.get_by_role("alert")).to_be_visible()
    nothing_found(page, axe)


@pytest.mark.parametrize("scheme", cases(["light", "dark"], ["dark"]))
def test_the_design_as_text(page: Page, axe: str, scheme: str):
    if scheme == "dark":
        page.get_by_role("button", name="Dark colours").click()
    page.get_by_role("button", name="Show me the Python").click()
    expect(page.get_by_label("Python", exact=True).last).to_contain_text("import stepwell")
    nothing_found(page, axe)


def test_a_way_to_a_state(page: Page, axe: str):
    page.get_by_role("button", name="Go to state 01").click()
    expect(output(page, "turning points")).to_be_visible()
    nothing_found(page, axe)
