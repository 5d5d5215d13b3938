"""The guided tour goes to its end, and every number on its way is Python's."""

import base64
import json
import re

from stepwell.files import loads_tables
from stepwell.robot import Robot
from studio.browser import FLAT, Opened, number, output, settled, shown_as, without

from playwright.sync_api import Page, expect  # isort: skip


def design_in(address: str):
    """What the address of a page says that it shows."""
    match = re.search(r"#design=([\w-]+)", address)
    assert match is not None
    data = base64.urlsafe_b64decode(match[1] + "=" * (-len(match[1]) % 4))
    return loads_tables(json.loads(data)).subject


def compare(page: Page) -> None:
    settled(page)
    design = design_in(page.url)
    chain = design.legs[0].chain if isinstance(design, Robot) else design
    cycle = chain.cycle()
    expect(output(page, "sequence")).to_have_attribute("data-value", str(cycle.sequence))
    assert number(page, "peak force") == shown_as(cycle.peak_force)
    assert number(page, "dissipated") == shown_as(cycle.dissipated * 1e3)


def test_the_tour_shows_what_it_says(opened: Opened, empty_address: str):
    page = opened.page
    page.emulate_media(reduced_motion="reduce")
    page.add_init_script(without("thumbnails", "predict"))
    page.add_init_script(FLAT)
    page.goto(empty_address + "&demo=step")
    count = int(page.get_by_text(re.compile(r"of \d+$")).inner_text().split()[-1])
    assert count > 5
    for k in range(count):
        page.get_by_role("button", name="Next").click()
        done = page.locator(f'[data-step="{k + 1}"][data-done="true"]')
        done.and_(output(page, "tour")).wait_for(timeout=180_000)
        compare(page)
    page.get_by_role("button", name="Next").click()
    expect(page.get_by_text("The tour is over.")).to_be_visible()


def test_the_tour_can_be_held_and_ended(blank: Opened, empty_address: str):
    page = blank.page
    page.goto(empty_address + "&demo=1")
    page.get_by_role("button", name="Wait").click()
    page.get_by_role("button", name="Go on").click()
    page.get_by_role("button", name="End the tour").click()
    expect(page.get_by_label("Guided tour")).to_have_count(0)
