"""Reports in a browser: on phones and laptops, light and dark, they keep nobody out."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from chromium import needed
from sizes import SIZE
from stepwell import files
from stepwell.design import Run, yields
from stepwell.reports import write

needed()

from playwright.sync_api import Browser, Page  # noqa: E402, where it is missing the tests are skipped above # isort: skip

ALL = {
    "laptop": {"viewport": {"width": 1280, "height": 800}, "color_scheme": "light"},
    "laptop, dark": {"viewport": {"width": 1280, "height": 800}, "color_scheme": "dark"},
    "phone": {"viewport": {"width": 360, "height": 740}, "color_scheme": "light"},
    "phone, dark": {"viewport": {"width": 360, "height": 740}, "color_scheme": "dark"},
}
# Both widths and both schemes, if not each with each.
WINDOWS = ALL if SIZE == "full" else {name: ALL[name] for name in ("laptop", "phone, dark")}
# What is in a frame is another page, which has its own tests.
RUN = """
async () => {
  const { violations } = await axe.run(document, { resultTypes: ["violations"], iframes: false });
  return violations.map(({ id, help, nodes }) =>
    `${id}: ${help}: ` + nodes.map((one) => one.html.slice(0, 160)).join(" | "));
}
"""


@pytest.fixture(scope="module")
def reports(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("reports")
    for name in ("paper-forward", "paper-identical"):
        write(Run.of(files.preset(name)), folder / name)
    write(yields(files.preset("friction"), samples=200, sensitivity=True), folder / "yield")
    return {one.parent.name: one for one in folder.glob("*/report.html")}


@pytest.fixture(scope="module", params=WINDOWS)
def window(request: pytest.FixtureRequest, browser: Browser) -> Iterator[Page]:
    # The page's own policy would keep axe out, too.
    context = browser.new_context(**WINDOWS[request.param], bypass_csp=True)
    yield context.new_page()
    context.close()


@pytest.mark.parametrize("name", ["paper-forward", "paper-identical", "yield"])
def test_axe_finds_nothing_and_nothing_forces_the_page_sideways(
    window: Page, reports: dict[str, Path], axe: str, name: str
):
    window.goto(reports[name].as_uri())
    window.evaluate(axe)
    assert window.evaluate(RUN) == []
    assert window.evaluate("document.documentElement.scrollWidth <= innerWidth")
    broken = "[...document.images].filter((one) => one.naturalWidth === 0).map((one) => one.alt)"
    window.wait_for_function("[...document.images].every((one) => one.complete)")
    assert window.evaluate(broken) == []


def test_figures_on_a_phone_are_not_shrunk(browser: Browser, reports: dict[str, Path]):
    """One column of a page, 85 mm, is 321 px: narrower than a phone's text."""
    page = browser.new_page(viewport={"width": 360, "height": 740})
    page.goto(reports["paper-forward"].as_uri())
    page.wait_for_function("[...document.images].every((one) => one.complete)")
    shares = page.evaluate("[...document.images].map((one) => one.clientWidth / one.naturalWidth)")
    page.close()
    assert len(shares) > 5
    assert min(shares) >= 0.99


def test_the_motion_plays_inside_the_report_and_nothing_is_fetched(
    browser: Browser, reports: dict[str, Path]
):
    page = browser.new_page(viewport={"width": 1280, "height": 800})
    asked: list[str] = []
    problems: list[str] = []
    page.on("request", lambda one: asked.append(one.url))
    page.on("pageerror", lambda error: problems.append(str(error)))
    page.goto(reports["paper-forward"].as_uri())
    page.locator("iframe").scroll_into_view_if_needed()
    frame = page.frame_locator("iframe")
    frame.get_by_role("slider").first.wait_for()
    page.close()
    assert problems == []
    assert [url for url in asked if not url.startswith(("file:", "data:", "about:"))] == []
