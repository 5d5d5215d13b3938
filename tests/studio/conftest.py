"""Studios to look at, and pages opened on them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page, ViewportSize

    from chromium import Opened

WIDE: ViewportSize = {"width": 1280, "height": 800}


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


def blameless(found: Opened) -> None:
    """Nothing went wrong in a page, and all that it asked for is of this machine."""
    assert not found.wrong
    elsewhere = [
        url for url in found.asked if not re.match(r"(http://127\.0\.0\.1:|data:|blob:)", url)
    ]
    assert not elsewhere


@pytest.fixture
def opened(browser: Browser) -> Iterator[Opened]:
    from chromium import Opened

    context = browser.new_context(viewport=WIDE, color_scheme="light")
    found = Opened(context.new_page())
    yield found
    context.close()
    blameless(found)


@pytest.fixture(scope="session")
def only(browser: Browser) -> Iterator[Opened]:
    """One page for most tests of a process: to open another takes as long as such a test."""
    from chromium import Opened
    from studio.browser import HASTY, without

    context = browser.new_context(viewport=WIDE, color_scheme="light")
    found = Opened(context.new_page())
    found.page.add_init_script(HASTY)
    # A yield keeps a process busy for a second; those who look at one open a page of their own.
    found.page.add_init_script(without("yield"))
    yield found
    context.close()


@pytest.fixture
def shared(only: Opened, address: str) -> Iterator[Opened]:
    """The page of most tests with the leg, as if nothing had been opened before."""
    from playwright.sync_api import expect

    from studio.browser import output

    only.wrong.clear()
    only.asked.clear()
    only.page.set_viewport_size(WIDE)
    only.page.goto(address)
    expect(output(only.page, "sequence")).to_be_visible()
    yield only
    # Nothing that is kept after a rest is kept for the next.
    only.page.evaluate("localStorage.clear(); Storage.prototype.setItem = () => {}")
    only.page.mouse.move(0, 0)
    only.page.goto("about:blank")
    blameless(only)


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
def page(shared: Opened) -> Page:
    return shared.page
