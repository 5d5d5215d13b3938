"""Plots in a browser: read-out, zoom, files; one frame serves them all."""

import re

import numpy as np
import pytest

import stepwell as sw
from stepwell.studio.motion import drawn
from studio.browser import Opened, chain_shown, drag, output, settled, shown_as

from playwright.sync_api import Locator, Page, expect  # isort: skip


def plot(page: Page, name: str) -> Locator:
    return page.get_by_role("application", name=re.compile(f"^{name}"))


def reading(page: Page, title: str) -> str:
    return output(page, f"reading of {title}").inner_text().replace("−", "-")


def file_of(page: Page, title: str) -> str:
    """The SVG file that the menu of a plot saves."""
    page.get_by_label(f"Menu of the plot {title}", exact=True).click()
    with page.expect_download() as saved:
        page.get_by_role("button", name="Save SVG").locator("visible=true").click()
    assert saved.value.suggested_filename.endswith(".svg")
    page.get_by_label(f"Menu of the plot {title}", exact=True).click()
    return saved.value.path().read_text("utf-8")


def ticks(svg: str) -> tuple[list[str], list[str]]:
    """Texts of the ticks on the horizontal and on the vertical axis of a file."""
    texts = re.findall(r'<text [^>]*text-anchor="(\w+)"[^>]*>([^<]+)</text>', svg)
    names = [text for _, text in texts if "[" in text]
    assert names, "an axis has its unit"
    marks = [(anchor, text) for anchor, text in texts if re.match(r"[−\d]|start$|end$", text)]
    across = [text for anchor, text in marks if anchor == "middle"]
    return across, [text for anchor, text in marks if anchor == "end"]


def inside(page: Page, name: str) -> tuple[float, float, float, float]:
    """Left, top, width and height inside the axes of a plot."""
    plot(page, name).evaluate("one => one.scrollIntoView({ block: 'center' })")
    box = plot(page, name).bounding_box()
    assert box is not None
    return box["x"] + 50, box["y"] + 22, box["width"] - 62, box["height"] - 56


def test_the_pointer_reads_value_and_event(page: Page):
    cycle = sw.preset("paper-forward").cycle()
    snap = next(event for event in cycle.path.events if event.kind.name == "SNAP")
    left, top, wide, tall = inside(page, "Force")
    force = cycle.path.force
    low, high = force.min(), force.max()
    low, high = low - 0.06 * (high - low), high + 0.06 * (high - low)
    x = left + wide * snap.stroke / cycle.path.stroke.max()
    page.mouse.move(x, top + tall * (1 - (snap.force_before - low) / (high - low)))
    text = reading(page, "Force")
    assert f"stroke {snap.stroke * 1e3:.4g} mm, force {snap.force_before:.4g} N" in text
    assert f"Snap at {snap.stroke * 1e3:.4g} mm, loading" in text
    page.mouse.move(0, 0)
    expect(output(page, "reading of Force")).to_have_count(0)


def test_the_arrow_keys_read_each_cell(page: Page):
    travel = plot(page, "Travel")
    travel.press("ArrowRight")
    assert "inner, loading" in reading(page, "Travel")
    travel.press("ArrowDown")
    assert "outer, loading" in reading(page, "Travel")


def test_a_box_zooms_and_a_double_click_shows_the_whole_plot(page: Page):
    left, top, wide, tall = inside(page, "Energy")
    whole = ticks(file_of(page, "Energy of each cell"))
    left, top, wide, tall = inside(page, "Energy")
    page.mouse.move(left + 0.3 * wide, top + 0.3 * tall)
    page.mouse.down()
    page.mouse.move(left + 0.4 * wide, top + 0.6 * tall)
    page.mouse.up()
    part = ticks(file_of(page, "Energy of each cell"))
    assert part != whole and all(len(one) >= 3 for one in part)
    left, top, wide, tall = inside(page, "Energy")
    page.mouse.dblclick(left + 0.5 * wide, top + 0.5 * tall)
    assert ticks(file_of(page, "Energy of each cell")) == whole


PLOTS = (("", "Force"), ("", "Travel"), ("Program", "Program"), ("Map", "Map"))


def test_each_plot_has_three_ticks_an_axis_and_a_file_with_title_and_units(page: Page):
    for tab, title in PLOTS:
        if tab:
            page.get_by_role("tab", name=tab).click()
        expect(plot(page, title)).to_be_visible()
        if title == "Map":
            page.get_by_role("list", name="Sequences on the map").locator("li").first.wait_for()
        svg = file_of(page, title)
        assert (
            f"<title>Forward leg: clockwise, the inner cell moves first both ways: {title}" in svg
        )
        assert all(len(one) >= 3 for one in ticks(svg)), title
        plot(page, title).press("+")
        assert ticks(file_of(page, title)) != ticks(svg) or title == "Program"


def test_a_plot_is_copied_as_an_image_or_the_reason_is_given(shared: Opened):
    page = shared.page
    page.get_by_label("Menu of the plot Force").click()
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.get_by_role("button", name="Copy", exact=True).locator("visible=true").click()
    expect(page.get_by_text("Copied as an image.")).to_be_visible()
    page.context.clear_permissions()
    page.evaluate("() => { navigator.clipboard.write = () => Promise.reject(new Error('no')) }")
    page.get_by_role("button", name="Copy", exact=True).locator("visible=true").click()
    expect(page.get_by_text("Use “Save PNG”")).to_be_visible()


def test_a_finger_scrolls_the_page_over_a_plot(page: Page):
    assert plot(page, "Force").evaluate("one => getComputedStyle(one).touchAction") == "pan-y"


# What was asked of the cycle, and whether for a move of a hand.
ASKED = """() => {
  window.asked = [];
  const send = WebSocket.prototype.send;
  WebSocket.prototype.send = function (text) {
    const { type, ask } = JSON.parse(text);
    if (type === "evaluate") window.asked.push(ask.moves === true);
    send.call(this, text);
  };
}"""
# Places of the marks of snaps below the slider, as parts of the stroke: as painted, and as clicked.
MARKS = """() => [
  [...document.querySelectorAll(".marks path")].flatMap((one) =>
    [...one.getAttribute("d").matchAll(/M([\\d.]+) /g)].map(([, x]) => Number(x) / 1000)),
  [...document.querySelectorAll(".marks button")].map((one) => parseFloat(one.style.left) / 100),
]"""


def test_moves_are_answered_in_brief_and_after_them_all_is_known_of_each_snap(page: Page):
    page.evaluate(ASKED)
    drag(page, "q", "outer", -30, 14)
    settled(page)
    asked = page.evaluate("asked")
    assert asked[0] and not asked[-1]
    cycle = chain_shown(page).cycle()
    path = drawn(cycle.path)
    snaps = [event for event in cycle.events if event.kind.name == "SNAP"]
    at = [k / (len(path.drive) - 1) for k in np.flatnonzero(path.snap_after).tolist()]
    painted, clicked = page.evaluate(MARKS)
    assert sorted(painted) == pytest.approx(at, abs=1e-4)
    assert clicked == pytest.approx(at, abs=1e-4)
    said = page.locator(".marks button").evaluate_all("(all) => all.map((one) => one.title)")
    for title, snap in zip(said, snaps, strict=True):
        way = "loading" if snap.direction > 0 else "unloading"
        assert title.startswith(f"Snap at {shown_as(snap.stroke * 1e3):g} mm, {way}: ")
        assert title.count("→") + title.count(" at ") - 1 == len(snap.cells)
