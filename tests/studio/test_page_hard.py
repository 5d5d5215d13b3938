"""The page under hard use: many steps, touch, two tabs, keys alone, no server, a long drag."""

import json
import re
import socket
from pathlib import Path
from typing import Literal

import pytest

from chromium import nothing_found
from sizes import cases, examples
from studio.browser import (
    Opened,
    anchors,
    chain_shown,
    compare,
    expect,
    field,
    handle,
    middle,
    output,
    served,
    settled,
    without,
)

from playwright.sync_api import Browser, Page  # isort: skip

STEPS = 100
# Pressed by the page itself, once a frame: a button, or a key on what has the focus. Each word to
# a browser takes as long as many steps. What stands in the fields of these names after each.
PRESSED = """async (element, [times, key, names]) => {
  const rows = [];
  // Steps of one handle in quick succession are one step of undo.
  const dots = ["q of outer", "p of outer"].map((name) =>
    document.querySelector(`.handle[aria-label="${name}"]`));
  for (let k = 0; k < times; k += 1) {
    if (key) dots[k % 2].dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
    else element.click();
    await new Promise(requestAnimationFrame);
    const field = (name) => document.querySelector(`input[aria-label=${JSON.stringify(name)}]`);
    rows.push(names.map((name) => Number(field(name).value)));
  }
  return rows;
}"""


def focus(page: Page, name: str, most: int = 60) -> None:
    """Reach what has a name by the Tab key alone."""
    for _ in range(most):
        page.keyboard.press("Tab")
        focused = page.evaluate(
            "(document.activeElement.getAttribute('aria-label') ?? "
            "document.activeElement.innerText ?? '').trim()"
        )
        if focused.startswith(name):
            return
    pytest.fail(f"{name} is not reached by Tab")


@pytest.mark.slow
def test_a_hundred_steps_are_undone_and_the_first_is_not(page: Page):
    names = [f"{anchor} of outer, x in mm" for anchor in "qp"]
    dot = handle(page, "q", "outer")
    begin = [anchors(page, "outer")[k][0] for k in (1, 0)]
    states = dot.evaluate(PRESSED, [STEPS, "ArrowDown", names])
    handle(page, "q", "outer").press("ArrowDown")
    last = [states[-1][0] + 0.1, states[-1][1]]
    assert [anchors(page, "outer")[k][0] for k in (1, 0)] == pytest.approx(last)
    assert states[0] != begin and len({tuple(one) for one in states}) == STEPS
    undo = page.get_by_role("button", name="Undo")
    undo.click()
    assert [anchors(page, "outer")[k][0] for k in (1, 0)] == states[-1]
    assert undo.evaluate(PRESSED, [STEPS - 1, "", names]) == states[-2::-1]
    expect(undo).to_be_disabled()
    page.keyboard.press("Control+z")
    assert [anchors(page, "outer")[k][0] for k in (1, 0)] == states[0]
    settled(page)
    compare(page)
    redo = page.get_by_role("button", name="Redo")
    assert redo.evaluate(PRESSED, [STEPS, "", names])[-1] == pytest.approx(last)
    expect(redo).to_be_disabled()


@pytest.mark.parametrize("scheme", cases(["light", "dark"], ["dark"]))
def test_a_finger_moves_an_anchor_and_not_the_page_which_is_no_wider_than_a_phone(
    browser: Browser, address: str, scheme: Literal["light", "dark"]
):
    context = browser.new_context(
        viewport={"width": 390, "height": 844}, has_touch=True, color_scheme=scheme
    )
    page = context.new_page()
    page.add_init_script(without())
    page.goto(address)
    output(page, "sequence").wait_for()
    settled(page)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    expect(page.locator("html")).to_have_attribute("data-theme", scheme)
    before = anchors(page, "outer")
    x, y = middle(handle(page, "q", "outer").locator(".dot"))
    drawing = page.locator(".drawing svg").first
    before_it = drawing.bounding_box()
    fingers = context.new_cdp_session(page)

    def touch(kind: str, *points: dict[str, float]) -> None:
        fingers.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": list(points)})

    touch("touchStart", {"x": x, "y": y})
    for k in range(1, 11):
        touch("touchMove", {"x": x - 3 * k, "y": y - 4 * k})
    touch("touchEnd")
    settled(page)
    after_it = drawing.bounding_box()
    # What came above the drawing may be taller; the drawing stays where the finger was.
    assert before_it is not None
    assert after_it is not None
    assert after_it["y"] == pytest.approx(before_it["y"], abs=3)
    after = anchors(page, "outer")
    assert after[0] == before[0]
    assert after[1][0] < before[1][0] - 2
    assert after[1][1] < before[1][1] - 2
    page.get_by_role("button", name="Undo").tap()
    assert anchors(page, "outer") == before
    handle(page, "q", "outer").locator(".dot").tap()
    context.close()


def test_two_tabs_of_one_studio_have_their_own_numbers(
    shared: Opened, beside: Opened, address: str
):
    pages = [shared.page, beside.page]
    beside.page.goto(address)
    output(beside.page, "sequence").wait_for()
    for x, page in zip((15, 12), pages, strict=True):
        field(page, "q", "outer", "x").fill(str(x))
        field(page, "q", "outer", "x").press("Enter")
    for x, page in zip((15, 12), pages, strict=True):
        settled(page)
        assert anchors(page, "outer")[1] == [x, 0.0]
        compare(page)


def test_a_journey_by_keys_alone(blank: Opened, empty_address: str):
    page = blank.page
    page.goto(empty_address)
    expect(page.get_by_role("button", name="Three cells, a wave")).to_be_visible()
    focus(page, "Forward leg: clockwise, the inner")
    page.keyboard.press("Enter")
    expect(output(page, "sequence")).to_be_visible()
    settled(page)
    focus(page, "q of outer")
    page.keyboard.press("Shift+ArrowUp")
    settled(page)
    assert anchors(page, "outer")[1] == [19.0, 0.0]
    focus(page, "Graph")
    page.keyboard.press("Enter")
    expect(page.get_by_role("button", name="Go to state 01")).to_be_visible()
    focus(page, "Go to state 01")
    page.keyboard.press("Enter")
    turns = [point * 1e3 for point in chain_shown(page).program("01").turning_points]
    text = " → ".join(f"{point:.4g}" for point in turns)
    expect(output(page, "turning points")).to_have_text(f"{text} mm")
    focus(page, "Back to the full cycle")
    page.keyboard.press("Space")
    focus(page, "Play")
    page.keyboard.press("Enter")
    expect(page.get_by_role("button", name="Pause")).to_be_visible()
    page.keyboard.press("Enter")
    expect(page.get_by_role("button", name="Play")).to_be_visible()
    focus(page, "Show me the Python")
    page.keyboard.press("Enter")
    expect(page.get_by_label("Python", exact=True).last).to_contain_text("import stepwell as sw")
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog")).to_have_count(0)
    page.keyboard.press("Control+z")
    settled(page)
    assert anchors(page, "outer")[1] == [20.0, 0.0]
    compare(page)


def test_what_a_lost_server_leaves_is_saved_and_goes_on_in_the_next_at_its_port(
    opened: Opened, tmp_path: Path, axe: str
):
    page = opened.page
    page.add_init_script(without())
    with served(tmp_path, "paper-forward") as address:
        page.goto(address)
        expect(output(page, "sequence")).to_be_visible()
        field(page, "q", "outer", "x").fill("17")
        field(page, "q", "outer", "x").press("Enter")
        settled(page)
    expect(page.get_by_text("No connection to the server.")).to_be_visible()
    port = re.search(r":(\d+)/", address)
    assert port is not None
    expect(page.get_by_text(f"stepwell studio --port {port[1]}")).to_be_visible()
    nothing_found(page, axe)
    field(page, "q", "outer", "x").fill("15")
    field(page, "q", "outer", "x").press("Enter")
    assert anchors(page, "outer")[1] == [15.0, 0.0]
    page.wait_for_timeout(400)  # what is kept is kept after a rest
    assert "#design=" in page.url
    with page.expect_download() as download:
        page.get_by_role("button", name="Save").click()
    saved = tmp_path / download.value.suggested_filename
    download.value.save_as(saved)
    assert saved.suffix == ".json"
    assert json.loads(saved.read_text())["chain"]["cell"][1]["q_mm"] == [15, 0]
    page.goto("about:blank")
    opened.wrong.clear()  # the browser tells of every socket that did not open
    with served(tmp_path, "", int(port[1])) as address:
        page.goto(address)
        page.locator(".card.kept").first.click()
        expect(output(page, "sequence")).to_be_visible()
        settled(page)
        assert anchors(page, "outer")[1] == [15.0, 0.0]
        field(page, "q", "outer", "x").fill("17")
        field(page, "q", "outer", "x").press("Enter")
        page.get_by_label("Open a design file").set_input_files(saved)
        expect(field(page, "q", "outer", "x")).to_have_value("15")
        settled(page)
        assert anchors(page, "outer")[1] == [15.0, 0.0]
        compare(page)
        page.goto("about:blank")


def test_a_page_goes_on_by_itself_with_the_next_server_at_its_port(
    opened: Opened, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    page = opened.page
    page.add_init_script(without())
    with served(tmp_path, "paper-forward", port) as address:
        page.goto(address)
        expect(output(page, "sequence")).to_be_visible()
        settled(page)
    gone = page.get_by_text("No connection to the server.")
    expect(gone).to_be_visible()
    field(page, "q", "outer", "x").fill("15")
    field(page, "q", "outer", "x").press("Enter")
    with served(tmp_path, "paper-forward", port) as again:
        assert again == address
        expect(gone).to_have_count(0)
        settled(page)
        assert anchors(page, "outer")[1] == [15.0, 0.0]
        compare(page)
        page.goto("about:blank")
    opened.wrong.clear()  # the browser reports every socket that did not open


@pytest.mark.slow
def test_a_long_drag_leaves_the_page_as_large_as_it_was(page: Page):
    inside = page.context.new_cdp_session(page)

    def heap() -> float:
        inside.send("HeapProfiler.collectGarbage")
        return inside.send("Runtime.getHeapUsage")["usedSize"] / 2**20

    x, y = middle(handle(page, "q", "outer").locator(".dot"))
    page.mouse.move(x, y)
    page.mouse.down()

    def moved(count: int) -> float:
        for k in range(count):
            page.mouse.move(x + (k % 40) * 1.3 - 26, y + (k % 23) - 11)
        return heap()

    before = moved(60)
    after = moved(examples(100, 400))
    page.mouse.up()
    settled(page)
    # 10 kB a move.
    assert after - before < examples(1, 4)
    compare(page)
