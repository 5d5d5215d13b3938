"""The system's own browser: whether there is one, how it is started, and a page opened in it."""

from __future__ import annotations

import os
import shutil
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from playwright.sync_api import Page

REQUIRED = os.environ.get("STEPWELL_REQUIRE_BROWSER") == "1"
# The one without windows does the same with a third less work.
_NAMES = "chromium-headless-shell", "chromium", "chromium-browser"
CHROMIUM = next(filter(None, map(shutil.which, _NAMES)), None)
QUIET = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
)
# By its text and not by a tag, for a page's own rules may forbid scripts that it did not bring.
RUN_AXE = """
async (within) => {
  const { violations } = await axe.run(within ?? document, { resultTypes: ["violations"] });
  return violations.map(({ id, help, nodes }) =>
    `${id}: ${help}: ` + nodes.map((one) => one.html.slice(0, 160)).join(" | "));
}
"""


def needed(*packages: str) -> None:
    """Skip the module that calls this where there is no browser, or one of the packages is missing.

    STEPWELL_REQUIRE_BROWSER=1 makes that a failure.
    """
    if REQUIRED:
        return
    if CHROMIUM is None:
        pytest.skip(
            "the page is not tested: there is no chromium here. STEPWELL_REQUIRE_BROWSER=1 makes "
            "that a failure.",
            allow_module_level=True,
        )
    for package in ("playwright", *packages):
        pytest.importorskip(package, reason=f"the page is not tested: {package} is not installed")


def nothing_found(page: Page, axe: str, within: str | None = None) -> None:
    """What keeps people out is not on the page, by all rules of axe.

    Args:
        page: the page.
        axe: its script, which is loaded once for each document.
        within: selector of a part, if the rest of the page has been examined.
    """
    if not page.evaluate("'axe' in window"):
        page.evaluate(axe)
    found = page.evaluate(RUN_AXE, within)
    assert not found, "\n".join(found)


class Opened:
    """A page with what went wrong in it and what it asked for."""

    def __init__(self, page: Page):
        self.page = page
        self.wrong: list[str] = []
        self.asked: list[str] = []
        page.on("pageerror", lambda error: self.wrong.append(str(error)))
        page.on(
            "console", lambda said: self.wrong.append(said.text) if said.type == "error" else None
        )
        page.on("request", lambda request: self.asked.append(request.url))
