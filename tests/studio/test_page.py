"""The page in a browser: what is dragged, typed and read there is what Python says."""

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator

import pytest

from stepwell import files
from stepwell.mechanism import Chain

REQUIRED = os.environ.get("STEPWELL_REQUIRE_BROWSER") == "1"
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
QUIET = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
)
SERVE = """
import sys
from stepwell.files import preset_text, tables_in
from stepwell.studio.server import serve

if __name__ == "__main__":
    name = sys.argv[1]
    design = tables_in(preset_text(name), name) if name else None
    serve(design, opened=lambda address: print(address, flush=True))
"""

if not REQUIRED:
    if CHROMIUM is None:
        pytest.skip(
            "the page is not tested: there is no chromium here. STEPWELL_REQUIRE_BROWSER=1 makes "
            "that a failure.",
            allow_module_level=True,
        )
    for package in ("playwright", "starlette", "uvicorn", "websockets"):
        pytest.importorskip(package, reason=f"the page is not tested: {package} is not installed")

from playwright.sync_api import (  # noqa: E402, where it is missing the tests are skipped above
    Browser,
    Page,
    WebSocketRoute,
    expect,
    sync_playwright,
)

# A busy machine is no failure.
expect.set_options(timeout=30_000)


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(QUIET))
        yield browser
        browser.close()


def served(tmp_path_factory: pytest.TempPathFactory, preset: str) -> Iterator[str]:
    script = tmp_path_factory.mktemp("studio") / "serve.py"
    script.write_text(SERVE)
    command = [sys.executable, str(script), preset]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        yield server.stdout.readline().strip()
        server.terminate()


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    yield from served(tmp_path_factory, "paper-forward")


@pytest.fixture(scope="module")
def empty_address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    yield from served(tmp_path_factory, "")


class Opened:
    """A page with what went wrong in it and what it asked for."""

    def __init__(self, page: Page):
        self.page = page
        self.wrong: list[str] = []
        self.asked: list[str] = []
        page.on("pageerror", lambda error: self.wrong.append(str(error)))
        page.on(
            "console",
            lambda said: self.wrong.append(said.text) if said.type == "error" else None,
        )
        page.on("request", lambda request: self.asked.append(request.url))


@pytest.fixture
def opened(browser: Browser) -> Iterator[Opened]:
    context = browser.new_context(viewport={"width": 1280, "height": 800}, color_scheme="light")
    found = Opened(context.new_page())
    yield found
    context.close()
    assert not found.wrong
    elsewhere = [url for url in found.asked if not re.match(r"(http://127\.0\.0\.1:|data:)", url)]
    assert not elsewhere


@pytest.fixture
def page(opened: Opened, address: str) -> Page:
    opened.page.goto(address)
    expect(output(opened.page, "sequence")).to_be_visible()
    return opened.page


def output(page: Page, name: str):
    return page.get_by_role("status", name=name, exact=True)


def number(page: Page, name: str) -> float:
    return float(output(page, name).inner_text().replace("−", "-"))


def shown_as(value: float) -> float:
    return float(f"{value:.4g}")


def field(page: Page, anchor: str, cell: str, axis: str):
    return page.get_by_role("spinbutton", name=f"{anchor} of {cell}, {axis} in mm")


def handle(page: Page, anchor: str, cell: str):
    return page.get_by_role("button", name=f"{anchor} of {cell}", exact=True)


def anchors(page: Page, cell: str) -> list[list[float]]:
    return [
        [float(field(page, anchor, cell, axis).input_value()) for axis in "xy"] for anchor in "pq"
    ]


def chain_shown(page: Page) -> Chain:
    """The chain that Python makes of the anchors that the page shows."""
    design = files.tables_in(files.preset_text("paper-forward"), "paper-forward")
    for cell in design["chain"]["cell"]:
        cell["p_mm"], cell["q_mm"] = anchors(page, cell["name"])
    text = f"[chain]\nlever_mm = {design['chain']['lever_mm']}\nlimit_deg = 45\n"
    text += "band = { stiffness_N_per_m = 28.5, rest_length_mm = 10 }\n"
    for cell in design["chain"]["cell"]:
        text += f"[[chain.cell]]\nname = {json.dumps(cell['name'])}\n"
        text += f"p_mm = {cell['p_mm']}\nq_mm = {cell['q_mm']}\n"
    return files.loads_chain(text)


def compare(page: Page) -> None:
    """Every number on the page with the one that Python gives."""
    from stepwell.studio.panels.evaluate import drawn

    chain = chain_shown(page)
    cycle, margin = chain.cycle(), chain.margin()
    expect(output(page, "sequence")).to_have_attribute("data-value", str(cycle.sequence))
    assert number(page, "peak force") == shown_as(cycle.peak_force)
    assert number(page, "dissipated") == shown_as(cycle.dissipated * 1e3)
    assert number(page, "margin") == shown_as(min(margin.anchors) * 1e3)
    path = drawn(cycle.path)
    slider = page.get_by_role("slider", name="Stroke")
    for k in (0, 40, len(path.drive) - 20):
        slider.fill(str(k))
        assert number(page, "stroke") == shown_as(path.stroke[k] * 1e3)
        assert number(page, "force") == shown_as(path.force[k])
        for i, name in enumerate(chain.names):
            assert number(page, f"travel of {name}") == shown_as(path.travel[k, i] * 1e3)


def settled(page: Page) -> None:
    """All that was changed is answered and kept."""
    page.wait_for_timeout(50)  # a drag is read once a frame
    expect(page.locator("main")).to_have_attribute("aria-busy", "false", timeout=30_000)


def drag(page: Page, anchor: str, cell: str, dx: int, dy: int) -> None:
    box = handle(page, anchor, cell).locator(".dot").bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    for k in range(1, 11):
        page.mouse.move(x + dx * k / 10, y + dy * k / 10)
    page.mouse.up()
    settled(page)


def test_every_number_is_pythons(page: Page):
    compare(page)


def test_every_number_after_a_drag_is_pythons(page: Page):
    before = anchors(page, "outer")
    drag(page, "q", "outer", -70, 30)
    assert anchors(page, "outer") != before
    compare(page)


def test_an_anchor_on_the_moving_block_follows_the_pointer(page: Page):
    page.get_by_role("slider", name="Stroke").fill("60")
    dot = handle(page, "q", "inner").locator(".dot")
    before = dot.bounding_box()
    drag(page, "q", "inner", 24, -16)
    after = dot.bounding_box()
    assert before is not None
    assert after is not None
    # The cycle changes with the anchor, and so the block under it a little.
    assert after["x"] - before["x"] == pytest.approx(24, abs=6)
    assert after["y"] - before["y"] == pytest.approx(-16, abs=6)


def test_one_drag_is_one_undo(page: Page):
    before = anchors(page, "outer")
    drag(page, "q", "outer", -40, 20)
    after = anchors(page, "outer")
    page.get_by_role("button", name="Undo").click()
    assert anchors(page, "outer") == before
    expect(page.get_by_role("button", name="Undo")).to_be_disabled()
    page.get_by_role("button", name="Redo").click()
    assert anchors(page, "outer") == after


def test_an_anchor_moves_by_the_keyboard_alone(page: Page):
    for _ in range(40):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.getAttribute('aria-label')") == "q of outer":
            break
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Shift+ArrowUp")
    settled(page)
    assert anchors(page, "outer")[1] == [20.1, 1.0]
    compare(page)
    page.keyboard.press("Control+z")
    page.keyboard.press("Control+z")
    assert anchors(page, "outer")[1] == [20.0, 0.0]


def test_a_refusal_is_the_files_and_one_can_go_back(page: Page):
    drawn = handle(page, "p", "inner").locator(".dot")
    before = drawn.bounding_box()
    field(page, "q", "outer", "x").fill("9999999")
    field(page, "q", "outer", "x").press("Enter")
    said = page.get_by_role("alert")
    expect(said).to_contain_text("chain.cell[1].q_mm")
    expect(field(page, "q", "outer", "x")).to_have_attribute("aria-invalid", "true")
    settled(page)
    assert drawn.bounding_box() == before
    expect(output(page, "sequence")).to_be_visible()
    field(page, "q", "outer", "x").fill("15")
    field(page, "q", "outer", "x").press("Enter")
    expect(said).to_have_count(0)
    settled(page)
    compare(page)


def test_a_locked_anchor_stays(page: Page):
    before = anchors(page, "outer")
    page.get_by_role("button", name="Lock q of outer").click()
    drag(page, "q", "outer", -40, 20)
    assert anchors(page, "outer") == before


def test_anchors_snap_to_the_holes(page: Page):
    pitch = page.get_by_role("spinbutton", name="Snap to holes")
    pitch.fill("2.5")
    pitch.press("Enter")
    drag(page, "q", "outer", -33, 21)
    x, y = anchors(page, "outer")[1]
    assert x % 2.5 == 0
    assert y % 2.5 == 0


def test_cells_are_added_mirrored_reordered_removed(page: Page):
    page.get_by_role("button", name="Add a cell").click()
    expect(handle(page, "q", "cell 3")).to_be_visible()
    expect(output(page, "sequence")).to_have_attribute("data-value", re.compile("^000>"))
    page.get_by_role("button", name="Remove cell 3").click()
    expect(handle(page, "q", "cell 3")).to_have_count(0)
    page.get_by_role("button", name="Move inner outward").click()
    expect(output(page, "sequence")).to_have_attribute("data-value", "00>01>11>10>00")
    field(page, "q", "outer", "y").fill("3")
    field(page, "q", "outer", "y").press("Enter")
    page.get_by_role("button", name="Mirror outer").click()
    assert anchors(page, "outer")[1] == [20.0, -3.0]


def test_the_design_is_kept_while_the_server_is_gone(opened: Opened, address: str):
    page = opened.page
    sockets: list[WebSocketRoute] = []

    def through(socket: WebSocketRoute) -> None:
        sockets.append(socket)
        if len(sockets) != 2:
            socket.connect_to_server()

    page.route_web_socket(re.compile("/socket"), through)
    page.goto(address)
    expect(output(page, "sequence")).to_be_visible()
    sockets[0].close()
    gone = page.get_by_text("The server is gone; your design is kept here.")
    expect(gone).to_be_visible()
    field(page, "q", "outer", "x").fill("15")
    field(page, "q", "outer", "x").press("Enter")
    if len(sockets) > 1:
        sockets[1].close()
    else:
        page.wait_for_timeout(800)
        sockets[1].close()
    expect(gone).to_have_count(0)
    settled(page)
    compare(page)


def test_a_reload_shows_the_same_design(page: Page):
    field(page, "q", "outer", "x").fill("15")
    field(page, "q", "outer", "x").press("Enter")
    settled(page)
    assert "#design=" in page.url
    page.reload()
    expect(output(page, "sequence")).to_be_visible()
    assert anchors(page, "outer")[1] == [15.0, 0.0]


def test_the_gallery_comes_first(opened: Opened, empty_address: str):
    page = opened.page
    page.goto(empty_address)
    page.get_by_role("button", name="Three cells, a wave").click()
    expect(output(page, "sequence")).to_have_attribute("data-value", re.compile("^000>"))


def test_a_file_is_opened_and_saved(page: Page, tmp_path):
    written = tmp_path / "own.toml"
    written.write_text(files.preset_text("paper-backward"))
    page.get_by_label("Open a design file").set_input_files(written)
    expect(output(page, "sequence")).to_have_attribute("data-value", "00>01>11>10>00")
    with page.expect_download() as download:
        page.get_by_role("button", name="Save").click()
    saved = tmp_path / "saved.toml"
    download.value.save_as(saved)
    assert files.load(saved) == files.preset("paper-backward")


def test_the_python_of_a_design_runs(page: Page):
    page.get_by_role("button", name="Show me the Python").click()
    text = page.get_by_label("Python", exact=True).last
    expect(text).to_contain_text("import stepwell as sw")
    script = text.inner_text()
    subprocess.run([sys.executable, "-c", script], check=True, capture_output=True)


def test_play_goes_through_the_cycle(page: Page):
    page.get_by_role("button", name="Play").click()
    slider = page.get_by_role("slider", name="Stroke")
    for _ in range(300):
        if float(slider.input_value()) > 5:
            break
        page.wait_for_timeout(100)
    page.get_by_role("button", name="Pause").click()
    assert float(slider.input_value()) > 5


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_narrow_window_needs_no_scrolling_sideways(browser: Browser, address: str, scheme):
    context = browser.new_context(
        viewport={"width": 390, "height": 844}, has_touch=True, color_scheme=scheme
    )
    page = context.new_page()
    page.goto(address)
    expect(output(page, "sequence")).to_be_visible()
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    expect(page.locator("html")).to_have_attribute("data-theme", scheme)
    handle(page, "q", "outer").locator(".dot").tap()
    context.close()


def test_a_click_on_a_state_brings_the_mechanism_there(page: Page):
    page.get_by_role("button", name="Go to state 01").click()
    program = files.preset("paper-forward").program("01")
    turns = " → ".join(f"{point * 1e3:.4g}" for point in program.turning_points)
    expect(output(page, "turning points")).to_have_text(f"{turns} mm")
    slider = page.get_by_role("slider", name="Stroke")
    slider.press("End")
    assert number(page, "travel of inner") == 0
    assert number(page, "travel of outer") == 20
    page.get_by_role("button", name="Back to the full cycle").click()
    compare(page)
