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
def empty_address(home: Path) -> Iterator[str]:
    """A studio that begins with the gallery: one for all pages of a process."""
    from studio.browser import served

    with served(home, "") as address:
        yield address


@pytest.fixture(scope="session")
def address(empty_address: str) -> str:
    """There the paper's leg."""
    from studio.browser import link

    return link(empty_address, "paper-forward")


def blameless(opened_page: Opened) -> None:
    """Nothing went wrong in a page, and all that it asked for is of this machine."""
    assert not opened_page.wrong
    elsewhere = [
        url for url in opened_page.asked if not re.match(r"(http://127\.0\.0\.1:|data:|blob:)", url)
    ]
    assert not elsewhere


@pytest.fixture
def opened(browser: Browser) -> Iterator[Opened]:
    from chromium import Opened

    context = browser.new_context(viewport=WIDE, color_scheme="light")
    opened_page = Opened(context.new_page())
    yield opened_page
    context.close()
    blameless(opened_page)


@pytest.fixture(scope="session")
def only(browser: Browser) -> Iterator[Opened]:
    """One page for most tests of a process: to open another takes as long as such a test."""
    from chromium import Opened
    from studio.browser import FLAT, HASTY, without

    context = browser.new_context(viewport=WIDE, color_scheme="light", reduced_motion="reduce")
    # Yields, predictions, motions and spaces keep a core busy for seconds; those who look at one
    # open a page of their own.
    for script in (HASTY, FLAT, without()):
        context.add_init_script(script)
    yield Opened(context.new_page())
    context.close()


@pytest.fixture
def blank(only: Opened) -> Iterator[Opened]:
    """The page of most tests before anything was opened."""
    from studio.browser import leave

    only.wrong.clear()
    only.asked.clear()
    only.page.set_viewport_size(WIDE)
    yield only
    # Nothing that is kept after a rest is kept for the next.
    only.page.evaluate("localStorage.clear(); Storage.prototype.setItem = () => {}")
    only.page.mouse.move(0, 0)
    leave(only.page)
    blameless(only)


@pytest.fixture
def shared(blank: Opened, address: str) -> Opened:
    """The page of most tests with the leg."""
    from studio.browser import output

    blank.page.goto(address)
    output(blank.page, "sequence").wait_for()
    return blank


@pytest.fixture
def beside(shared: Opened) -> Iterator[Opened]:
    """Another page of the same visitor, where nothing was opened yet."""
    from chromium import Opened

    second = Opened(shared.page.context.new_page())
    yield second
    second.page.close()
    blameless(second)


@pytest.fixture(scope="session")
def unconnected(browser: Browser) -> Iterator[Opened]:
    from chromium import Opened

    context = browser.new_context(offline=True, viewport=WIDE)
    yield Opened(context.new_page())
    context.close()


@pytest.fixture
def offline(unconnected: Opened) -> Iterator[Opened]:
    """A page without a network, which may load one file and nothing else."""
    opened_page = unconnected
    opened_page.wrong.clear()
    opened_page.asked.clear()
    yield opened_page
    assert not opened_page.wrong
    # The page itself, and the empty icon that stands in it.
    assert all(url.startswith(("file://", "data:")) for url in opened_page.asked)
    assert sum(url.startswith("file://") for url in opened_page.asked) == 1
    opened_page.page.mouse.move(0, 0)
    opened_page.page.goto("about:blank")
    opened_page.page.set_viewport_size(WIDE)
    opened_page.page.emulate_media(color_scheme="light", reduced_motion="no-preference")


@pytest.fixture
def page(shared: Opened) -> Page:
    return shared.page
