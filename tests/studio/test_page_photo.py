"""A photo to trace lies under the mechanism, in millimetres, and never leaves the page."""

import re
import struct
import zlib
from pathlib import Path

import pytest

from studio.browser import Opened, compare, settled

from playwright.sync_api import Page, expect  # isort: skip


def png(path: Path, wide: int, tall: int, rows: int | None = None) -> Path:
    """A grey picture; with fewer rows than it says, one that only claims to be that tall."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    raw = (b"\0" + b"\x80" * wide) * (tall if rows is None else rows)
    head = struct.pack(">IIBBBBB", wide, tall, 8, 0, 0, 0, 0)
    parts = chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b"")
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + parts)
    return path


def choose(page: Page, path: Path) -> None:
    page.get_by_label("Choose a photo to trace").set_input_files(path)


def value(page: Page, name: str) -> float:
    return float(page.get_by_role("spinbutton", name=name).input_value())


@pytest.fixture
def traced(page: Page, tmp_path: Path) -> Page:
    choose(page, png(tmp_path / "leg.png", 600, 400))
    expect(page.locator("image")).to_have_attribute("href", re.compile("^blob:"))
    return page


def test_it_is_moved_turned_scaled_hidden_and_removed(traced: Page, shared: Opened):
    page = traced
    sent = len([url for url in shared.asked if not url.startswith("blob:")])
    page.get_by_role("button", name="Move", exact=True).click()
    page.get_by_role("button", name="The photo: arrow keys").focus()
    before = value(page, "Middle of the photo, x in mm")
    page.keyboard.press("Shift+ArrowRight")
    page.keyboard.press("<")
    page.keyboard.press("+")
    assert value(page, "Middle of the photo, x in mm") == pytest.approx(before + 5, abs=0.01)
    assert value(page, "Turn of the photo in degrees") == pytest.approx(1)
    box = page.locator(".drawing svg").bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + 40
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 40, y, steps=3)
    page.mouse.up()
    assert value(page, "Middle of the photo, x in mm") > before + 6
    page.get_by_role("button", name="Hide").click()
    expect(page.locator("image")).to_have_count(0)
    page.get_by_role("button", name="Hide").click()
    page.get_by_role("slider", name="Opacity of the photo").fill("0.3")
    expect(page.locator("image")).to_have_attribute("opacity", "0.3")
    page.get_by_role("button", name="Remove the photo").click()
    expect(page.locator("image")).to_have_count(0)
    settled(page)
    compare(page)
    assert len([url for url in shared.asked if not url.startswith("blob:")]) == sent


def test_two_points_of_a_known_distance_set_its_scale(traced: Page):
    page = traced
    page.get_by_role("button", name="Set scale").click()
    box = page.locator(".drawing svg").bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    before = value(page, "Width of the photo in mm")
    scale = page.evaluate("document.querySelector('.drawing svg').getScreenCTM().a")
    page.mouse.click(x - 50, y)
    page.mouse.click(x + 50, y)
    known = page.get_by_role("spinbutton", name="Distance of the two points in mm")
    known.fill(str(2 * 100 / scale))
    known.press("Enter")
    assert value(page, "Width of the photo in mm") == pytest.approx(2 * before, rel=1e-3)


def test_a_hostile_file_is_refused_in_words(page: Page, tmp_path: Path):
    text, svg, broken = (tmp_path / name for name in ("a.txt", "a.svg", "broken.png"))
    text.write_text("no photo")
    svg.write_text('<svg xmlns="http://www.w3.org/2000/svg"><script>alert(1)</script></svg>')
    broken.write_bytes(b"\x89PNG\r\n\x1a\nnonsense")
    for path in (text, svg, png(tmp_path / "bomb.png", 30000, 30000, rows=1), broken):
        choose(page, path)
        expect(page.get_by_role("alert")).to_contain_text(path.name)
        expect(page.locator("image")).to_have_count(0)
        page.get_by_role("button", name="Dismiss").click()
    compare(page)
