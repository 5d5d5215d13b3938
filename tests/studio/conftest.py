"""A browser, studios to look at, and pages opened on them."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

    from studio.browser import Opened


ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def sources(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page's sources in a folder of their own, with what builds and tests them."""
    npm = shutil.which("npm")
    if npm is None and os.environ.get("STEPWELL_REQUIRE_BROWSER") != "1":
        pytest.skip("npm is not installed: the studio's page is not built anew, nor run by axe")
    assert npm is not None, "STEPWELL_REQUIRE_BROWSER=1, and npm is not installed"
    found = tmp_path_factory.mktemp("sources") / "studio"
    shutil.copytree(ROOT / "studio", found, ignore=shutil.ignore_patterns("node_modules"))
    words = [npm, "ci", "--no-audit", "--no-fund", "--ignore-scripts"]
    done = subprocess.run(words, cwd=found, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return found


@pytest.fixture(scope="session")
def axe(request: pytest.FixtureRequest) -> str:
    """The script that looks for what keeps people out: what is installed here, or comes now."""
    inside = Path("node_modules", "axe-core", "axe.min.js")
    here = ROOT / "studio" / inside
    found = here if here.exists() else request.getfixturevalue("sources") / inside
    return found.read_text()


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    from playwright.sync_api import sync_playwright

    from studio.browser import CHROMIUM, QUIET

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(QUIET))
        yield browser
        browser.close()


@pytest.fixture(scope="session")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    from studio.browser import served

    with served(tmp_path_factory.mktemp("studio"), "paper-forward") as found:
        yield found


@pytest.fixture(scope="session")
def empty_address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    from studio.browser import served

    with served(tmp_path_factory.mktemp("studio"), "") as found:
        yield found


@pytest.fixture
def opened(browser: Browser) -> Iterator[Opened]:
    from studio.browser import Opened

    context = browser.new_context(viewport={"width": 1280, "height": 800}, color_scheme="light")
    found = Opened(context.new_page())
    yield found
    context.close()
    assert not found.wrong
    elsewhere = [
        url for url in found.asked if not re.match(r"(http://127\.0\.0\.1:|data:|blob:)", url)
    ]
    assert not elsewhere


@pytest.fixture
def offline(browser: Browser) -> Iterator[Opened]:
    """A page without a network, which may load one file and nothing else."""
    from studio.browser import Opened

    context = browser.new_context(offline=True, viewport={"width": 1280, "height": 800})
    found = Opened(context.new_page())
    yield found
    context.close()
    assert not found.wrong
    # The page itself, and the empty icon that stands in it.
    assert all(url.startswith(("file://", "data:")) for url in found.asked)
    assert sum(url.startswith("file://") for url in found.asked) == 1


@pytest.fixture
def page(opened: Opened, address: str) -> Page:
    from playwright.sync_api import expect

    from studio.browser import output

    opened.page.goto(address)
    expect(output(opened.page, "sequence")).to_be_visible()
    return opened.page
