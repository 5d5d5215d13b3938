"""The gallery in a browser: groups, a field to find by, and designs that move."""

from collections.abc import Iterator
from typing import Literal

import pytest

from sizes import cases
from stepwell.files import loads_tables, preset_text, presets, tables_in
from stepwell.mechanism import Chain
from studio.browser import Opened, output, without
from studio.test_access import nothing_found

from playwright.sync_api import Browser, Locator, Page, ViewportSize, expect  # isort: skip

WIDE: ViewportSize = {"width": 1280, "height": 800}


@pytest.fixture
def listed(blank: Opened, empty_address: str) -> Page:
    """Where nothing moves."""
    blank.page.goto(empty_address)
    cards(blank.page).first.wait_for()
    expect(cards(blank.page)).to_have_count(len(presets()))
    return blank.page


@pytest.fixture(scope="module")
def come(browser: Browser, empty_address: str) -> Iterator[Page]:
    """One page for all, which was left for a design as soon as it was there."""
    context = browser.new_context(viewport=WIDE, color_scheme="light", reduced_motion="reduce")
    # The design that it is left for has a yield.
    context.add_init_script(without("yield"))
    page = context.new_page()
    page.goto(empty_address)
    card(page, "three-wave").click()
    expect(output(page, "sequence")).to_have_attribute("data-value", "000>100>110>111>011>001>000")
    page.get_by_role("button", name="Gallery").click()
    expect(cards(page)).to_have_count(len(presets()))
    expect(sequence(page, "robot-right")).to_contain_text("left")
    yield page
    context.close()


@pytest.fixture
def gallery(come: Page) -> Iterator[Page]:
    """As it is when it has just come; it moves while it is looked at."""
    come.set_viewport_size(WIDE)
    come.emulate_media(color_scheme="light", reduced_motion="no-preference")
    come.evaluate("scrollTo(0, 0)")
    yield come
    come.emulate_media(reduced_motion="reduce")


def cards(page: Page) -> Locator:
    return page.locator(".card[data-name]")


def card(page: Page, name: str) -> Locator:
    return page.locator(f'.card[data-name="{name}"]')


def sequence(page: Page, name: str) -> Locator:
    return card(page, name).locator(".sequence")


def outermost(page: Page, name: str) -> Locator:
    """The block that moves farthest."""
    return card(page, name).locator("rect.block").last


def height(page: Page, name: str) -> str:
    y = outermost(page, name).get_attribute("y")
    assert y is not None
    return y


def names(page: Page) -> list[str]:
    return cards(page).evaluate_all("(all) => all.map((one) => one.dataset.name)")


def pictures(page: Page) -> list[str]:
    return page.locator(".thumbnail").evaluate_all("(all) => all.map((one) => one.innerHTML)")


def test_designs_stand_in_groups_with_their_cells_and_sequences(gallery: Page):
    headings = gallery.locator(".gallery h2")
    expect(headings).to_have_count(4)
    for heading, first in (
        ("Designs of the paper", "paper-backward"),
        ("Further chains", "antenna-leg"),
        ("Other elements", "balloon"),
        ("Robots", "robot-15"),
    ):
        group = gallery.get_by_role("group", name=heading, exact=True)
        expect(group.locator(".card").first).to_have_attribute("data-name", first)
    for name in ("three-wave", "combination-lock", "dome"):
        file = loads_tables(tables_in(preset_text(name)))
        chain, written = file.subject, file.program
        assert isinstance(chain, Chain)
        result = chain.cycle() if written is None else written.on(chain)
        text = str(result.sequence).replace(">", " → ")
        expect(sequence(gallery, name)).to_have_text(text)
        named = gallery.get_by_role("button", name=f"{presets()[name]} {len(chain)} cells")
        expect(named).to_have_attribute("data-name", name)


def test_what_is_in_view_moves(gallery: Page):
    before = height(gallery, "paper-forward")
    expect(outermost(gallery, "paper-forward")).not_to_have_attribute("y", before)


def test_what_is_out_of_view_waits(gallery: Page):
    robot = card(gallery, "robot-forward").locator("svg")
    before = robot.get_attribute("viewBox")
    assert before is not None
    gallery.wait_for_timeout(500)
    expect(robot).to_have_attribute("viewBox", before)
    robot.scroll_into_view_if_needed()
    expect(robot).not_to_have_attribute("viewBox", before)
    above = height(gallery, "paper-forward")
    gallery.wait_for_timeout(500)
    assert height(gallery, "paper-forward") == above


def test_animations_stop_if_reduced_motion_is_preferred(gallery: Page):
    hold = gallery.get_by_role("button", name="Pause animations")
    hold.click()
    expect(hold).to_have_attribute("aria-pressed", "true")
    gallery.wait_for_timeout(200)
    before = pictures(gallery)
    gallery.wait_for_timeout(500)
    assert pictures(gallery) == before
    hold.click()
    expect(outermost(gallery, "paper-forward")).not_to_have_attribute(
        "y", height(gallery, "paper-forward")
    )


def test_nothing_moves_for_those_who_want_no_motion(gallery: Page):
    gallery.emulate_media(reduced_motion="reduce")
    expect(gallery.get_by_role("button", name="Pause animations")).to_have_count(0)
    before = pictures(gallery)
    assert all("block" in one or "robot" in one for one in before)
    gallery.wait_for_timeout(800)
    assert pictures(gallery) == before


def test_designs_are_found_by_name_title_and_cells(listed: Page):
    words = listed.get_by_role("searchbox", name="Find a design")
    for text, matches in (
        ("three", ["countdown", "three-stack", "three-wave", "curved-beam", "trilinear"]),
        (
            "3 cells",
            [
                *("second-touch", "three-stack", "three-wave", "two-point-gate"),
                *("curved-beam", "trilinear", "robot-four-legs", "robot-six-legs"),
            ],
        ),
        ("3 cells wave", ["three-wave", "robot-six-legs"]),
        ("KRES", ["kresling"]),
        ("robot turns", ["robot-left", "robot-right"]),
        ("nothing of that name", []),
    ):
        words.fill(text)
        counted = f"{len(matches)} of {len(presets())} designs"
        expect(output(listed, "designs found")).to_have_text(counted)
        assert names(listed) == matches
    listed.get_by_role("button", name="Show all").click()
    expect(cards(listed)).to_have_count(len(presets()))


def test_arrow_keys_go_from_card_to_card(listed: Page):
    own = names(listed)
    here = listed.locator(".card:focus")
    card(listed, "paper-backward").focus()
    for key, at in (
        ("ArrowRight", 1),
        ("ArrowRight", 2),
        ("ArrowLeft", 1),
        ("End", -1),
        ("Home", 0),
    ):
        listed.keyboard.press(key)
        expect(here).to_have_attribute("data-name", own[at])
    first = here.bounding_box()
    listed.keyboard.press("ArrowDown")
    below = here.bounding_box()
    assert first is not None and below is not None
    assert below["x"] == first["x"] and below["y"] > first["y"]
    listed.keyboard.press("ArrowUp")
    expect(here).to_have_attribute("data-name", own[0])
    listed.keyboard.press("Enter")
    expect(output(listed, "sequence")).to_have_attribute("data-value", "00>01>11>10>00")


def test_every_design_has_its_own_picture(gallery: Page, empty_address: str):
    again = gallery.context.new_page()
    again.goto(empty_address)
    own = """(all) => document.querySelectorAll(".card").length >= all
      && !document.querySelector(".sketch")"""
    # A first picture of the robot is the robot's own.
    again.wait_for_function(own, arg=len(presets()))
    assert card(again, "robot-15").locator("g.robot").count() == 1
    again.close()


# In light colours the gallery is examined with all that may keep people out of the studio.
@pytest.mark.parametrize("scheme", cases(["light", "dark"], ["dark"]))
def test_motions_are_accessible_and_no_wider_than_a_phone(
    gallery: Page, axe: str, scheme: Literal["light", "dark"]
):
    gallery.set_viewport_size({"width": 390, "height": 844})
    gallery.emulate_media(color_scheme=scheme)
    expect(gallery.locator("html")).to_have_attribute("data-theme", scheme)
    assert gallery.evaluate("document.documentElement.scrollWidth") == 390
    nothing_found(gallery, axe)
