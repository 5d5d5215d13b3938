"""The page loses no design and moves no anchor that was not moved."""

import json
import random
import re
from pathlib import Path

import pytest

from sizes import cases
from stepwell import files
from studio.browser import (
    Opened,
    anchors,
    drag,
    field,
    handle,
    leave,
    link,
    middle,
    output,
    settled,
    without,
)

from playwright.sync_api import Page, expect  # isort: skip


def button(page: Page, name: str):
    return page.get_by_role("button", name=name, exact=True)


def card(page: Page, name: str):
    return page.locator(f'.card[data-name="{name}"]')


def zoom(page: Page) -> float:
    """Pixels in a millimetre of the drawing."""
    drawing = page.locator(".drawing svg").first
    drawing.wait_for()  # before it is laid out, it has no size
    return drawing.evaluate("(svg) => svg.getScreenCTM().a")


def test_undo_comes_back_from_a_card_of_the_gallery(page: Page):
    drag(page, "q", "outer", -40, 20)
    moved = anchors(page, "outer")
    button(page, "Gallery").click()
    card(page, "balloon").click()
    expect(page.get_by_role("heading", name="balloon")).to_be_visible()
    button(page, "Undo").click()
    expect(output(page, "sequence")).to_be_visible()
    settled(page)
    assert anchors(page, "outer") == moved
    button(page, "Redo").click()
    expect(page.get_by_role("heading", name="balloon")).to_be_visible()


def test_a_changed_design_is_kept_and_stands_first_in_the_gallery(page: Page):
    drag(page, "q", "outer", -40, 20)
    moved = anchors(page, "outer")
    button(page, "Gallery").click()
    card(page, "balloon").click()
    # The gallery closes once the design is there.
    expect(page.get_by_role("heading", name="balloon")).to_be_visible()
    settled(page)
    button(page, "Gallery").click()
    kept = page.locator(".card.kept")
    # Designs of the gallery that were not changed need no place there.
    expect(kept).to_have_count(1)
    expect(page.locator(".gallery h2").first).to_have_text("Your last designs")
    kept.click()
    settled(page)
    assert anchors(page, "outer") == moved


def test_at_most_ten_designs_are_kept_and_tabs_keep_theirs(
    shared: Opened, beside: Opened, empty_address: str
):
    for page, first in ((shared.page, 10), (beside.page, 30)):
        for k in range(6):
            design = files.tables_in(files.preset_text("paper-forward"), "paper-forward")
            design["title"] = f"design {first + k}"
            # After the first the address changes, and the page stays.
            page.goto(link(empty_address, design))
            page.get_by_role("heading", name=f"design {first + k}", exact=True).wait_for()
            settled(page)
    titles = [one["design"]["title"] for one in kept(beside.page)]
    assert titles == [f"design {k}" for k in (35, 34, 33, 32, 31, 30, 15, 14, 13, 12)]


def kept(page: Page) -> list[dict]:
    return json.loads(page.evaluate("localStorage.getItem('stepwell.designs')"))


def test_the_last_design_is_offered_where_another_one_opens(page: Page, empty_address: str):
    drag(page, "q", "outer", -40, 20)
    moved = anchors(page, "outer")
    leave(page)
    page.goto(link(empty_address, "three-wave"))
    offer = page.get_by_text("Your last design here:")
    expect(offer).to_be_visible()
    button(page, "Open it").click()
    settled(page)
    assert anchors(page, "outer") == moved
    expect(offer).to_have_count(0)


def test_back_and_a_new_link_in_the_address_are_followed(page: Page):
    page.evaluate(
        "(hash) => { location.hash = hash; }", link("", "paper-backward").removeprefix("#")
    )
    expect(output(page, "sequence")).to_have_attribute("data-value", "00>01>11>10>00")
    settled(page)
    page.go_back()
    expect(output(page, "sequence")).to_have_attribute("data-value", "00>10>11>01>00")


@pytest.mark.parametrize("state", ["slider", "graph", "play"])
def test_a_drag_moves_the_anchor_by_what_the_pointer_moved(page: Page, state: str):
    if state == "slider":
        page.get_by_role("slider", name="Stroke").fill("60")
    elif state == "graph":
        button(page, "Go to state 01").click()
        page.get_by_role("slider", name="Stroke").press("End")
    else:
        button(page, "Play").click()
        page.wait_for_timeout(300)
        button(page, "Pause").click()
    settled(page)
    before, others = anchors(page, "outer"), anchors(page, "inner")
    scale = zoom(page)
    drag(page, "q", "outer", 24, -12)
    after = anchors(page, "outer")
    assert after[0] == before[0] and anchors(page, "inner") == others
    # The second cell is mirrored: its x is downwards, across the stroke, and its y along it.
    assert after[1][0] - before[1][0] == pytest.approx(-12 / scale, abs=0.011)
    assert after[1][1] - before[1][1] == pytest.approx(24 / scale, abs=0.011)


@pytest.mark.parametrize("cells", cases([1, 3, 16, 40], [1, 40]))
def test_the_nearest_anchor_is_the_one_that_moves(beside: Opened, empty_address: str, cells: int):
    page = beside.page
    where = random.Random(cells)
    cell = [
        {
            "p_mm": [round(where.uniform(-12, -8), 2), round(where.uniform(-3, 3), 2)],
            "q_mm": [round(where.uniform(9, 25), 2), round(where.uniform(-3, 3), 2)],
        }
        for _ in range(cells)
    ]
    band = {"stiffness_N_per_m": 28.5, "rest_length_mm": 10}
    design = {"chain": {"lever_mm": 14.14, "limit_deg": 45, "band": band, "cell": cell}}
    page.goto(link(empty_address, design))
    output(page, "sequence").wait_for()
    settled(page)
    dots, drawing = page.locator(".handle .dot"), page.locator(".drawing svg").first
    # To take hold of what is in view moves nothing.
    seen = drawing.get_attribute("viewBox")
    page.mouse.move(*middle(dots.first))
    page.mouse.down()
    assert drawing.get_attribute("viewBox") == seen
    page.mouse.up()
    chosen = cells  # an anchor in the middle of the chain, which the focus brings into view
    page.locator(".handle").nth(chosen).focus()
    middle(dots.nth(chosen))
    places = dots.evaluate_all(
        "(all) => all.map((one) => { const b = one.getBoundingClientRect();"
        " return [b.x + b.width / 2, b.y + b.height / 2]; })"
    )
    before = tables(page)
    x, y = middle(dots.nth(chosen))
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 3, y + 2)
    page.mouse.up()
    settled(page)
    nearest = min(
        range(len(places)), key=lambda k: abs(complex(places[k][0] - x, places[k][1] - y))
    )
    changed = [k for k, (a, b) in enumerate(zip(before, tables(page), strict=True)) if a != b]
    assert changed == [nearest]


def tables(page: Page) -> list[list[float]]:
    """All anchors in the order of the handles."""
    design = json.loads(
        page.evaluate("atob(location.hash.slice(8).replaceAll('-', '+').replaceAll('_', '/'))")
    )
    return [cell[key] for cell in design["chain"]["cell"] for key in ("p_mm", "q_mm")]


def test_a_drag_is_cancelled_by_escape_and_undo(page: Page):
    before = anchors(page, "outer")
    for way in ("Escape", "Control+z"):
        x, y = middle(handle(page, "q", "outer").locator(".dot"))
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x - 40, y + 20, steps=4)
        page.keyboard.press(way)
        page.mouse.move(x - 60, y + 20, steps=4)
        page.mouse.up()
        settled(page)
        assert anchors(page, "outer") == before, way
        expect(button(page, "Undo")).to_be_disabled()
        expect(button(page, "Redo")).to_be_disabled()


def test_a_run_of_arrow_keys_is_one_step_of_undo(page: Page):
    before = anchors(page, "outer")
    handle(page, "q", "outer").focus()
    for _ in range(5):
        page.keyboard.press("ArrowRight")
    assert anchors(page, "outer") != before
    page.keyboard.press("Control+z")
    assert anchors(page, "outer") == before


BROKEN = {
    "null-cell.json": '{"chain": {"cell": [null]}}',
    "number-cell.json": '{"chain": {"cell": [1, 2]}}',
    "empty-leg.json": '{"leg": []}',
    "bands-str.json": '{"chain": {"cell": [{"bands": "two"}]}}',
    "leg-null.json": '{"leg": [null]}',
    "title-obj.json": json.dumps(
        files.tables_in(files.preset_text("paper-forward"), "x") | {"title": {"a": 1}}
    ),
    "typo.toml": "[chain]\nlevers_mm = 14\n[[chain.cell]]\np_mm = [-10, 0]\nq_mm = [10, 0]\n",
    "cells.toml": files.preset_text("paper-forward")
    + "[[chain.cell]]\np_mm = [-10, 0]\nq_mm = [20, 1]\n" * 80,
    "large.toml": "# " + "x" * 1_200_000 + "\n" + files.preset_text("paper-forward"),
}


def test_a_file_that_cannot_be_opened_leaves_the_design(page: Page, tmp_path: Path):
    drag(page, "q", "outer", -40, 20)
    before = anchors(page, "outer")
    said = page.get_by_role("alert")
    for name, text in BROKEN.items():
        file = tmp_path / name
        file.write_text(text)
        page.get_by_label("Open a design file").set_input_files(file)
        expect(said).to_be_visible()
        assert "[object" not in said.inner_text(), name
        if name == "large.toml":
            expect(said).to_contain_text("1.2 MB")
        settled(page)
        assert anchors(page, "outer") == before, name
        expect(page.get_by_text("No connection to the server")).to_have_count(0)
        page.get_by_role("button", name="Dismiss").click()
        expect(said).to_have_count(0)


def test_a_link_that_cannot_be_read_leaves_the_design(page: Page):
    before = anchors(page, "outer")
    for name in ("leg-null.json", "null-cell.json", "number-cell.json"):
        page.evaluate("(hash) => { location.hash = hash; }", link("", json.loads(BROKEN[name]))[1:])
        page.wait_for_timeout(300)
        settled(page)
        assert anchors(page, "outer") == before, name


def test_a_dropped_file_opens(page: Page):
    page.evaluate(
        """(text) => {
          const data = new DataTransfer();
          data.items.add(new File([text], "own.toml"));
          const all = { bubbles: true, cancelable: true, dataTransfer: data };
          const over = new DragEvent("dragover", all);
          document.body.dispatchEvent(over);
          if (!over.defaultPrevented) throw new Error("the browser would leave the page");
          document.body.dispatchEvent(new DragEvent("drop", all));
        }""",
        files.preset_text("paper-backward"),
    )
    expect(output(page, "sequence")).to_have_attribute("data-value", "00>01>11>10>00")


TYPED = {"12,5": 12.5, "-100.25": -100.25, "−3": -3.0, "1e1": 10.0, ".5": 0.5}


def test_a_field_takes_numbers_as_people_write_them_and_shows_all_digits(page: Page):
    own = field(page, "q", "outer", "x")
    for typed, value in TYPED.items():
        own.fill(typed)
        own.press("Enter")
        settled(page)
        assert anchors(page, "outer")[1][0] == value
        assert own.evaluate("(one) => one.scrollWidth <= one.clientWidth"), typed


def test_an_entry_that_is_no_number_is_reported_and_the_old_one_returns(page: Page):
    own = field(page, "q", "outer", "x")
    for typed in ("", "abc", "1,234.5", "12 13", "Infinity", "0x10"):
        own.fill(typed)
        own.press("Tab")
        said = f"“{typed or 'nothing'}” is not a number"
        expect(page.get_by_role("alert")).to_contain_text(said)
        expect(own).to_have_value("20")
        assert anchors(page, "outer")[1][0] == 20


def test_undo_in_a_field_is_that_of_the_page_once_the_entry_is_taken(page: Page):
    own = field(page, "q", "outer", "x")
    own.fill("17")
    own.press("Enter")
    settled(page)
    own.press("Control+z")
    settled(page)
    expect(own).to_have_value("20")
    assert re.search(r"#design=", page.url)
    assert anchors(page, "outer")[1][0] == 20


def test_a_refused_number_of_a_request_is_named_in_words(opened: Opened, address: str):
    page = opened.page
    page.add_init_script(without("predict", "thumbnails", "atlas"))
    page.goto(address)
    own = page.get_by_role("spinbutton", name="Tolerance of the stiffness in percent")
    own.fill("80")
    own.press("Enter")
    expect(page.get_by_text("Stiffness [%] = 80: must be from 0 to 24.9")).to_be_visible()
    expect(page.get_by_text("ask.")).to_have_count(0)


def test_a_long_chain_is_named_below_the_pointer_and_zoomed_to_a_cell(
    page: Page, empty_address: str
):
    cell = [{"name": f"c{k}", "p_mm": [-10, 0], "q_mm": [10 + k / 8, 0]} for k in range(32)]
    band = {"stiffness_N_per_m": 28.5, "rest_length_mm": 10}
    page.goto(
        link(
            empty_address,
            {"chain": {"lever_mm": 14.14, "limit_deg": 45, "band": band, "cell": cell}},
        )
    )
    output(page, "sequence").wait_for()
    settled(page)
    drawing = page.get_by_role("group", name="Drawing: plus and minus")
    close = zoom(page)
    page.get_by_role("button", name="Fit the whole mechanism").click()
    whole = zoom(page)
    assert whole < close / 3
    # A cell of the overview fills the drawing, and its name stands where the pointer is.
    box = page.locator(".overview svg").bounding_box()
    mark = page.locator(".overview rect").nth(20).bounding_box()
    assert box is not None and mark is not None
    page.mouse.click(mark["x"] + mark["width"] / 2, box["y"] + box["height"] / 2)
    assert zoom(page) == pytest.approx(close)
    seen = drawing.bounding_box()
    assert seen is not None
    page.mouse.move(seen["x"] + seen["width"] / 2, seen["y"] + seen["height"] - 4)
    expect(drawing.get_by_text("c20: travel 0 mm")).to_be_visible()
    drawing.press("Escape")
    assert zoom(page) == pytest.approx(whole)
