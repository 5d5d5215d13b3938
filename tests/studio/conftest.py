"""Studios to look at, and pages opened on them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

    from chromium import Opened


@pytest.fixture(scope="session")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which a studio is served."""
    return tmp_path_factory.mktemp("studio")


@pytest.fixture(scope="session")
def address(home: Path) -> Iterator[str]:
    from studio.browser import served

    with served(home, "paper-forward") as found:
        yield found


@pytest.fixture(scope="session")
def empty_address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    from studio.browser import served

    with served(tmp_path_factory.mktemp("studio"), "") as found:
        yield found


@pytest.fixture
def opened(browser: Browser) -> Iterator[Opened]:
    from chromium import Opened

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
    from chromium import Opened

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
