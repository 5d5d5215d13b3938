"""Studies and the atlas in a browser: what is opened, walked to and taken is Python's."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from chromium import nothing_found
from sizes import SIZE
from stepwell import files, studies
from stepwell.accounts import account
from stepwell.design import parameter
from stepwell.mechanism import Chain
from stepwell.studies import Study
from studio.browser import anchors, number, output, settled, shown_as

pytest.importorskip("zarr", reason="studies in the page are not tested: zarr is not installed")

from studio.stores import filled, plane, small_atlas

from playwright.sync_api import Page, expect  # isort: skip

SLOW = 120_000  # ms: a busy machine is no failure
CELLS = """(rows) =>
  rows.map((row) => [...row.querySelectorAll("th, td")].map((cell) => cell.innerText.trim()))
"""


@pytest.fixture(scope="module")
def study(home: Path) -> Study:
    return filled(plane(home / "studies", 64))


@pytest.fixture(scope="module")
def charted(home: Path) -> studies.Atlas:
    return studies.charted(small_atlas(home / "studies" / "two.zarr"))


def opened_study(page: Page, study: Study) -> None:
    page.get_by_role("tab", name="Study").click()
    page.get_by_role("button", name=study.folder.name, exact=True).click()
    expect(page.get_by_role("table", name="Outcomes")).to_be_visible(timeout=SLOW)


def cells(page: Page, table: str) -> list[list[str]]:
    return page.get_by_role("table", name=table).locator("tbody tr").evaluate_all(CELLS)


@pytest.fixture(scope="module")
def line(home: Path) -> Study:
    leg = files.preset("paper-forward")
    space = studies.Space((studies.Axis("outer.q.y", -0.015, 0.015, 12),))
    return filled(
        studies.planned_study(leg, "cycle", space, home / "studies" / "line.zarr", chunk=12)
    )


def test_a_study_of_one_parameter_is_a_strip_with_exact_boundaries(page: Page, line: Study):
    opened_study(page, line)
    strip = page.get_by_role("region", name="Intervals of sequence along outer.q.y [mm]")
    runs = studies.intervals(line)
    rows = dict.fromkeys(run.value for run in runs)
    expect(strip.locator("code")).to_have_text([*rows])
    wide = strip.locator(".rows").evaluate("(one) => one.getBoundingClientRect().width")
    for bar, run in zip(strip.locator(".bar span").all(), runs, strict=True):
        begin, end = run.first, run.last
        begin, end = begin if run.low is None else run.low, end if run.high is None else run.high
        share = bar.evaluate("(one) => one.getBoundingClientRect().width") / wide
        assert share == pytest.approx((end - begin) / 30.0, abs=0.01)
    expect(strip.locator(".exact")).to_have_count(len(runs) - 1)
    expect(strip.locator(".between")).to_have_count(0)


def number_of(text: str) -> float:
    return float(text.split()[0].replace("−", "-"))


def test_an_open_study_shows_what_the_command_prints_and_its_table_is_downloaded(
    page: Page, study: Study, tmp_path: Path
):
    opened_study(page, study)
    record = account(studies.status(study)).record
    expect(output(page, "progress of the study")).to_have_text("64 designs, all done")
    for row, one in zip(cells(page, "Outcomes"), record["outcomes"], strict=True):
        assert row[0] == one["value"] and int(row[1]) == one["designs"]
        assert number_of(row[2]) == float(f"{one['fraction'] * 100:.3g}")
    for row, one in zip(cells(page, "Numbers"), record["numbers"], strict=True):
        assert row[0].startswith(one["column"])
        assert [number_of(text) for text in row[1:]] == [
            shown_as(one[key]) for key in ("least", "median", "most")
        ]
    for row, one in zip(cells(page, "Influence of the parameters"), record["decided"], strict=True):
        sure = [each for each in one["influences"] if each["fraction"] > one["floor"]]
        said = re.findall(r"(\S+) ([\d.]+) %", row[1])
        assert [(name, float(share)) for name, share in said] == [
            (each["parameter"], float(f"{each['fraction'] * 100:.3g}")) for each in sure
        ]
    with page.expect_download(timeout=SLOW) as coming:
        page.get_by_role("button", name="Export CSV").click()
    study.to_csv(tmp_path / "by-command.csv")
    assert coming.value.suggested_filename == "plane.csv"
    assert coming.value.path().read_bytes() == (tmp_path / "by-command.csv").read_bytes()


def test_a_design_that_is_pointed_at_is_taken_and_undone(page: Page, study: Study):
    opened_study(page, study)
    before = anchors(page, "outer")
    cloud = page.get_by_role("application", name=re.compile("^Designs over"))
    cloud.press("ArrowRight")
    first = output(page, "number of the design").inner_text()
    cloud.press("ArrowRight")
    expect(output(page, "number of the design")).not_to_have_text(first)
    one = int(output(page, "number of the design").inner_text())
    cloud.press("Enter")
    expect(page.get_by_text(f"Design {one} is in the editor")).to_be_visible(timeout=SLOW)
    settled(page)
    x, y = (float(study.values(name)[one]) * 1e3 for name in ("outer.q.x", "outer.q.y"))
    assert anchors(page, "outer")[1] == pytest.approx([x, y], abs=1e-9)
    expect(output(page, "sequence")).to_have_attribute(
        "data-value", str(study.values("sequence")[one])
    )
    page.get_by_role("button", name="Undo").click()
    settled(page)
    assert anchors(page, "outer") == before


@pytest.mark.slow
def test_a_study_is_begun_in_the_page_and_ends_there(page: Page, home: Path):
    page.get_by_role("tab", name="Study").click()
    group = page.get_by_role("group", name="Parameters to vary")
    expect(group).to_be_visible(timeout=SLOW)
    for name, value in (("from", "4"), ("to", "16")):
        page.get_by_role("spinbutton", name=f"x of q of outer, {name}, in mm").fill(value)
    page.get_by_role("spinbutton", name="x of q of outer, values on the grid").fill("3")
    page.get_by_role("button", name="Do not vary y of q of outer").click()
    expect(page.get_by_text("3 designs", exact=True)).to_be_visible()
    page.get_by_role("button", name="Start", exact=True).click()
    expect(output(page, "progress of the study")).to_have_text("3 designs, all done", timeout=SLOW)
    (folder,) = (home / "studies").glob("forward-leg-cycle-*.zarr")
    study = studies.opened(folder)
    assert study.values("2.q.x").tolist() == pytest.approx([0.004, 0.010, 0.016])
    leg = study.subject
    assert isinstance(leg, Chain)
    for x, said in zip((4, 10, 16), study.values("sequence"), strict=True):
        there = parameter(leg, "outer.q.x").changed(leg, x / 1e3)
        assert str(there.cycle().sequence) == str(said)


def opened_atlas(page: Page) -> None:
    page.get_by_role("tab", name="Atlas").click()
    page.get_by_role("combobox", name="Atlas").select_option("two.zarr", timeout=SLOW)
    expect(output(page, "graph class")).to_be_visible(timeout=SLOW)


def test_one_walks_from_graph_class_to_graph_class_finds_some_and_takes_one(
    page: Page, charted: studies.Atlas
):
    opened_atlas(page)
    known = {one.name: one for one in charted.graph_classes}
    expect(output(page, "graph class")).to_have_text(charted.graph_classes[0].name)
    seen, ground = set(), page.get_by_role("application", name="Map of 3 graph classes")
    for key in ("ArrowRight", "ArrowLeft", "ArrowLeft", "ArrowUp", "ArrowDown", "Home"):
        graph_class = known[output(page, "graph class").inner_text()]
        seen.add(graph_class.name)
        assert output(page, "cycle of the graph class").inner_text() == graph_class.cycle
        assert number(page, "fraction of the graph class") == shown_as(
            graph_class.fraction.estimate * 100
        )
        assert number(page, "yield of the graph class") == shown_as(graph_class.kept.estimate * 100)
        ground.press(key)
    assert len(seen) > 1
    expect(output(page, "graph class")).to_have_text(charted.graph_classes[0].name)
    # A query lights up what Python finds, and a wrong one is told.
    query = page.get_by_label("Which graph class")
    query.fill("reaches every state")
    query.press("Enter")
    names = {one.name for one in studies.find(charted, "reaches every state")}
    assert 0 < len(names) < 3
    expect(output(page, "matches")).to_contain_text(f"{len(names)} of 3 graph classes")
    lit = page.locator(".graph-class.match")
    assert {one.get_attribute("data-name") for one in lit.all()} == names
    query.fill("reaches all")
    query.press("Enter")
    expect(page.get_by_role("alert")).to_contain_text("must be a cycle such as")
    page.get_by_role("button", name="Show all").click()
    expect(lit).to_have_count(0)
    ground.press("Home")
    expect(output(page, "graph class")).to_have_text(charted.graph_classes[0].name)
    page.get_by_role("list", name="Neighbours").get_by_role("button").first.click()
    graph_class = known[output(page, "graph class").inner_text()]
    assert graph_class != charted.graph_classes[0]
    page.get_by_role("button", name="Use this design").click()
    settled(page)
    expect(output(page, "sequence")).to_have_attribute(
        "data-value", str(graph_class.chain.cycle().sequence)
    )


def test_the_page_is_accessible(page: Page, study: Study, charted: studies.Atlas, axe: str):
    opened_study(page, study)
    page.get_by_role("application", name=re.compile("^Designs over")).press("ArrowRight")
    page.get_by_text("Location, and the command for a terminal").click()
    page.get_by_text("A new study of this design").click()
    in_every_window(page, axe)
    opened_atlas(page)
    page.get_by_label("Minimum yield in percent").fill("99")
    page.get_by_role("button", name="Find", exact=True).click()
    expect(output(page, "matches")).to_be_visible()
    in_every_window(page, axe)


def in_every_window(page: Page, axe: str) -> None:
    # A tab changes its panel alone; the rest of the page is examined with all other tabs.
    within = None if SIZE == "full" else "[role=tabpanel]"
    # In the quick run both widths and both schemes, if not each with each.
    for wide, last in ((1280, "Light colours"), (390, "Dark colours")):
        page.set_viewport_size({"width": wide, "height": 844})
        for colours in ("Dark colours", "Light colours"):
            page.get_by_role("button", name=colours).click()
            if SIZE == "full" or colours == last:
                nothing_found(page, axe, within)
        inside = "document.documentElement.scrollWidth <= innerWidth"
        assert page.evaluate(inside)
    page.set_viewport_size({"width": 1280, "height": 844})
