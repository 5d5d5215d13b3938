"""The parts in a browser: they follow the stroke, show collisions, and are downloaded."""

import re
import zipfile

import pytest

import stepwell as sw
from build import chains
from stepwell.build import layout, loads_build_file, preset_text
from stepwell.files import dumps, tables_in
from stepwell.studio.motion import drawn
from studio.browser import Opened, begun, drag, output

from playwright.sync_api import Locator, Page, expect  # isort: skip

SLOW = 120_000  # ms: a busy machine is no failure
# Sheets are nested for 10 s; here parts are set in rows.
ROWS = """() => {
  const send = WebSocket.prototype.send;
  WebSocket.prototype.send = function (message) {
    const { type, ask, ...more } = JSON.parse(message);
    const rows = type === "parts_files" ? { seconds: 0 } : {};
    send.call(this, JSON.stringify({ type, ask: { ...ask, ...rows }, ...more }));
  };
}"""


@pytest.fixture
def parts(page: Page) -> Page:
    page.get_by_role("tab", name="Parts").click()
    plan(page).wait_for()
    return page


def plan(page: Page) -> Locator:
    return page.get_by_role("group", name="Plan of the parts")


def places(page: Page) -> dict[str, list[float]]:
    """x, y and angle of each part as drawn [mm, degrees, y up]."""
    rows = (
        plan(page)
        .locator("path[data-name]")
        .evaluate_all(
            "(all) => all.map((one) => [one.dataset.name, one.getAttribute('transform')])"
        )
    )
    found = {}
    for name, text in rows:
        x, y, angle, *_ = [*map(float, re.findall(r"-?[\d.]+(?:e-\d+)?", text)), 0.0]
        found[name] = [x, -y, -angle]
    return found


def test_the_parts_follow_the_stroke(parts: Page):
    chain = sw.preset("paper-forward")
    assert isinstance(chain, sw.Chain)
    made = layout(chain, loads_build_file(preset_text("acrylic-3mm")))
    path = drawn(chain.cycle().path)
    for k in (0, 60, len(path.drive) - 20):
        parts.get_by_role("slider", name="Stroke").fill(str(k))
        angles = [float(cell.angle(path.travel[k, i])) for i, cell in enumerate(chain.levers)]
        shown = places(parts)
        for name, (x, y, angle) in made.frames(angles).items():
            expected = [1e3 * x, 1e3 * y, angle * 57.29577951308232]
            assert shown[name] == pytest.approx(expected, abs=1e-5), name


def test_a_dragged_anchor_moves_its_hook_in_the_plan(parts: Page):
    band = plan(parts).locator('path[data-name="band 1 of cell 2"]')
    before = band.get_attribute("transform")
    drag(parts, "q", "outer", 30, 0)
    expect(band).not_to_have_attribute("transform", before or "")


def test_a_part_has_its_name_and_a_layer_can_be_hidden(parts: Page):
    plan(parts).locator('path[data-name="block-1-top"]').hover(position={"x": 60, "y": 8})
    expect(output(parts, "part")).to_contain_text(re.compile(r"block-1-top: .* mm, [\d.]+ g"))
    parts.get_by_role("checkbox", name="Top plates").uncheck()
    expect(plan(parts).locator('path[data-name="block-1-top"]')).to_have_count(0)
    parts.get_by_role("checkbox", name="Top plates").check()


def test_a_collision_is_red_and_its_files_are_drafts(blank: Opened, empty_address: str):
    page = begun(blank.page, empty_address, tables_in(dumps(chains.steep())))
    page.evaluate(ROWS)
    page.get_by_role("tab", name="Parts").click()
    findings = page.get_by_role("list", name="Findings")
    expect(findings).to_contain_text("lever-1a and lever-1b overlap by 1.16 mm", timeout=SLOW)
    findings.get_by_role("button", name="Show").click()
    overlap = plan(page).locator("path.overlap")
    expect(overlap).to_have_count(1)
    # As Python has it: the levers meet at the stops.
    assert overlap.evaluate("(one) => getComputedStyle(one).fill") == "rgb(179, 38, 30)"
    with page.expect_download() as saved:
        page.get_by_role("button", name="Download as draft").click()
    assert saved.value.suggested_filename.endswith("-parts-draft.zip")
    with zipfile.ZipFile(saved.value.path()) as packed:
        assert "parts/DRAFT-lever-1a.dxf" in packed.namelist()


def test_a_mark_of_the_gallery_opens_a_design_with_its_parts(blank: Opened, empty_address: str):
    blank.page.goto(empty_address)
    mark = blank.page.get_by_role("button", name="Parts of three-wave")
    mark.click()
    built = output(blank.page, "parts")
    expect(built).to_contain_text("It can be built: 19 parts", timeout=SLOW)
    expect(blank.page.get_by_role("button", name="Download parts")).to_be_enabled()


def test_elements_have_no_parts_and_the_page_says_why(blank: Opened, empty_address: str):
    page = begun(blank.page, empty_address, "balloon")
    page.get_by_role("tab", name="Parts").click()
    expect(output(page, "parts")).to_contain_text("has no levers or bands")
    expect(plan(page)).to_have_count(0)
