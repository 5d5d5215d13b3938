"""The page in a browser: what is dragged, typed and read there is what Python says."""

import io
import re
from contextlib import redirect_stdout

import pytest

from stepwell import files
from stepwell.studio.motion import drawn, sample_near
from studio.browser import (
    Opened,
    anchors,
    begun,
    chain_shown,
    compare,
    drag,
    field,
    handle,
    middle,
    number,
    output,
    settled,
)

from playwright.sync_api import Page, WebSocketRoute, expect  # isort: skip


def test_every_number_is_pythons(page: Page):
    compare(page)


def test_every_number_after_a_drag_is_pythons(page: Page):
    before = anchors(page, "outer")
    drag(page, "q", "outer", -70, 30)
    assert anchors(page, "outer") != before
    compare(page)
    changes = chain_shown(page).margin().changes
    least = min(changes, key=lambda one: (one.parameter != "anchor", one.distance))
    expect(page.locator(".summary")).to_contain_text(f"then {least.becomes}")


def test_an_anchor_on_the_moving_block_follows_the_pointer(page: Page):
    page.get_by_role("slider", name="Stroke").fill("60")
    dot = handle(page, "q", "inner").locator(".dot")
    x, y = middle(dot)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 24, y - 16, steps=8)
    settled(page)
    box = dot.bounding_box()
    assert box is not None
    # The cycle changes with the anchor, and so the block under it a little.
    assert box["x"] + box["width"] / 2 == pytest.approx(x + 24, abs=6)
    assert box["y"] + box["height"] / 2 == pytest.approx(y - 16, abs=6)
    page.mouse.up()


# A hand that moves to and fro until some margins have been shown meanwhile; their number.
FOLLOWED = """
async ([x, y, moves]) => {
  const margins = new Set();
  const shown = document.querySelector("output[aria-label=margin]");
  const read = new MutationObserver(() => margins.add(shown.textContent));
  read.observe(shown, { childList: true, characterData: true, subtree: true });
  const dot = document.elementFromPoint(x, y).closest("[role=button]");
  for (let k = 1; k <= moves && margins.size < 4; k += 1) {
    const to = { clientX: x - 20 - 20 * Math.sin(k / 7), clientY: y + (k % 9), bubbles: true };
    dot.dispatchEvent(new PointerEvent("pointermove", { ...to, pointerId: 1, buttons: 1 }));
    await new Promise(requestAnimationFrame);
    await new Promise(requestAnimationFrame);
  }
  return margins.size;
}
"""


def test_margins_follow_a_hand_that_moves(page: Page):
    x, y = middle(handle(page, "q", "outer").locator(".dot"))
    page.mouse.move(x, y)
    page.mouse.down()
    assert page.evaluate(FOLLOWED, [x, y, 600]) == 4
    page.mouse.up()
    settled(page)
    compare(page)


def test_one_drag_is_one_undo(page: Page):
    before = anchors(page, "outer")
    drag(page, "q", "outer", -40, 20)
    after = anchors(page, "outer")
    page.get_by_role("button", name="Undo").click()
    assert anchors(page, "outer") == before
    expect(page.get_by_role("button", name="Undo")).to_be_disabled()
    page.get_by_role("button", name="Redo").click()
    assert anchors(page, "outer") == after


PRESSED = """
() => new Promise((done) => addEventListener("pointerdown", ({ target }) => {
  const options = target.getContext?.("2d").getContextAttributes();
  done([target.nodeName, options?.desynchronized, target.closest("[role=button]").ariaLabel]);
}, { once: true }))
"""


def test_a_mouse_presses_an_anchor_where_its_moves_are_reported_at_once(page: Page):
    x, y = middle(handle(page, "q", "outer").locator(".dot"))
    page.evaluate(f"() => {{ window.pressed = ({PRESSED})(); }}")
    page.mouse.move(x, y)
    page.mouse.down()
    assert page.evaluate("window.pressed") == ["CANVAS", True, "q of outer"]
    # While it is held, nothing lies over the drawing.
    expect(page.locator(".press")).to_be_hidden()
    page.mouse.up()


@pytest.mark.parametrize("sample", [20, 123, 200, 290])
def test_the_cursor_keeps_its_stroke_through_a_drag(page: Page, sample: int):
    slider = page.get_by_role("slider", name="Stroke")
    before = drawn(chain_shown(page).cycle().path)
    slider.fill(str(sample))
    for dx, dy in ((-40, 20), (25, -15), (-10, 5)):
        drag(page, "q", "outer", dx, dy)
    after = drawn(chain_shown(page).cycle().path)
    wanted = sample_near(after, before.drive[sample] * 1e3, int(before.direction[sample]))
    assert int(slider.input_value()) == wanted


def test_an_anchor_moves_by_arrow_keys(page: Page):
    handle(page, "q", "outer").focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Shift+ArrowUp")
    settled(page)
    assert anchors(page, "outer")[1] == [19.0, 0.1]
    compare(page)
    page.keyboard.press("Control+z")
    page.keyboard.press("Control+z")
    assert anchors(page, "outer")[1] == [20.0, 0.0]


def test_a_refusal_is_the_files_and_one_can_go_back(page: Page):
    drawn = handle(page, "p", "inner").locator(".dot")
    before = drawn.get_attribute("cx")
    assert before
    field(page, "q", "outer", "x").fill("9999999")
    field(page, "q", "outer", "x").press("Enter")
    said = page.get_by_role("alert")
    expect(said).to_contain_text("chain.cell[1].q_mm")
    expect(field(page, "q", "outer", "x")).to_have_attribute("aria-invalid", "true")
    settled(page)
    assert drawn.get_attribute("cx") == before
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


def test_the_design_is_kept_while_the_server_is_gone(beside: Opened, address: str):
    page = beside.page
    sockets: list[WebSocketRoute] = []

    def through(socket: WebSocketRoute) -> None:
        sockets.append(socket)
        if len(sockets) != 2:
            socket.connect_to_server()

    page.route_web_socket(re.compile("/socket"), through)
    page.goto(address)
    expect(output(page, "sequence")).to_be_visible()
    sockets[0].close()
    gone = page.get_by_text("No connection to the server.")
    expect(gone).to_be_visible()
    field(page, "q", "outer", "x").fill("15")
    field(page, "q", "outer", "x").press("Enter")
    for _ in range(300):
        if len(sockets) > 1:
            break
        page.wait_for_timeout(20)
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


def test_the_gallery_comes_first(blank: Opened, empty_address: str):
    page = blank.page
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
    assert files.load(saved).subject == files.preset("paper-backward")


def test_the_python_of_a_design_runs(page: Page):
    page.get_by_role("button", name="Show me the Python").click()
    text = page.get_by_label("Python", exact=True).last
    expect(text).to_contain_text("import stepwell as sw")
    printed = io.StringIO()
    with redirect_stdout(printed):
        exec(text.inner_text(), {})
    assert printed.getvalue() == f"{files.preset('paper-forward').cycle()}\n"


def test_play_goes_through_the_cycle(page: Page):
    page.get_by_role("button", name="Play").click()
    slider = page.get_by_role("slider", name="Stroke")
    for _ in range(300):
        if float(slider.input_value()) > 5:
            break
        page.wait_for_timeout(20)
    page.get_by_role("button", name="Pause").click()
    assert float(slider.input_value()) > 5


def test_handles_out_of_view_wait_while_it_plays_and_are_in_place_after_it(
    blank: Opened, empty_address: str
):
    band = {"stiffness_N_per_m": 28.5, "rest_length_mm": 10}
    cells = [{"p_mm": [-10, 0], "q_mm": [10 + k, 0]} for k in range(12)]
    chain = {"lever_mm": 16, "limit_deg": 45, "band": band, "cell": cells}
    page = begun(blank.page, empty_address, {"chain": chain})
    places = "(dots) => dots.map((dot) => [dot.getAttribute('cx'), dot.getAttribute('cy')])"
    dots = page.locator(".drawing .dot")
    slider = page.get_by_role("slider", name="Stroke")
    seen = dots.evaluate_all(places)
    page.get_by_role("button", name="Play").click()
    # The innermost cell moves first, and comes back at the end of the cycle.
    page.wait_for_function("(slider) => Number(slider.value) > 10", arg=slider.element_handle())
    later = dots.evaluate_all(places)
    page.get_by_role("button", name="Pause").click()
    still = dots.evaluate_all(places)
    waiting = sum(a == b != c for a, b, c in zip(seen, later, still, strict=True))
    assert 0 < waiting < len(still) and seen[1] != later[1]
    # All of them are in view now: none may be where it was before.
    page.get_by_role("button", name="Fit the whole mechanism").click()
    assert dots.evaluate_all(places) == still


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
