"""Recordings in the page: chosen, compared with the design shown, and their fit taken."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from chromium import nothing_found
from lab.exports import xlsx
from lab.machine import export, pair
from stepwell import files, lab
from stepwell.mechanism import Chain
from studio.browser import Opened, anchors, field, number, output, settled, shown_as

from playwright.sync_api import Page, expect  # isort: skip


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    chain = files.preset("paper-forward")
    assert isinstance(chain, Chain)
    cells = [
        replace(cell, band=tuple(replace(band, stiffness=38.0) for band in cell.bands))
        for cell in chain.levers
    ]
    both = [
        pair("mine_1.txt", Chain(cells)),
        pair("back_1.txt", Chain(cells), unloading=True),
        pair("friction_1.txt", None),
        pair("back_friction_1.txt", None, unloading=True),
    ]
    folder = tmp_path_factory.mktemp("runs")
    return [export(folder / one.source, one.time, one.stroke, one.force) for one in both]


def choose(page: Page, *chosen: Path) -> None:
    page.get_by_role("tab", name="Measured").click()
    page.get_by_label("Recordings of a test machine").set_input_files(list(chosen))
    done(page)


def done(page: Page) -> None:
    expect(page.get_by_text("Comparing with the design…")).to_have_count(0, timeout=60_000)


def compared(page: Page, runs: list[Path]) -> lab.Comparison:
    from studio.browser import chain_shown

    return lab.compare([lab.read(run) for run in runs], [chain_shown(page)], as_designed=True)


def test_verdict_snaps_and_fit_are_the_labs_and_the_fit_is_taken(page: Page, runs: list[Path]):
    choose(page, *runs)
    expect(output(page, "fitted stiffness")).to_be_visible(timeout=60_000)
    comparison = compared(page, runs)
    fit = lab.refit(comparison)
    assert number(page, "fitted stiffness") == shown_as(fit.stiffness)
    assert number(page, "fitted rest length") == shown_as(fit.rest_length * 1e3)
    assert number(page, "RMS before the fit") == float(f"{fit.before:.3g}")
    assert number(page, "RMS after the fit") == float(f"{fit.after:.3g}")
    rows = page.get_by_role("table", name="Snaps").get_by_role("row")
    for k, test in enumerate(comparison.pairs):
        name = test.series.name
        expect(output(page, f"verdict on {name}")).to_have_text(test.verdict)
        assert number(page, f"RMS difference of {name}") == shown_as(test.rmse * test.series.scale)
        ((measured,),), (predicted,) = test.snaps, test.snaps_predicted
        texts = [cell.inner_text() for cell in rows.nth(k + 1).get_by_role("cell").all()]
        assert texts[1:3] == [f"{predicted * 1e3:.4g}", f"{measured * 1e3:.4g}"]
        difference = (measured - predicted) * 1e3
        assert float(texts[3].replace("−", "-")) == float(f"{difference:.3g}")
    # It is taken in one step that can be undone.
    before = anchors(page, "inner")
    peak = number(page, "peak force")
    page.get_by_role("button", name="Use the fit").click()
    settled(page)
    assert number(page, "peak force") > 1.2 * peak
    assert anchors(page, "inner") == before
    done(page)
    expect(output(page, "fitted stiffness")).to_be_visible(timeout=60_000)
    assert number(page, "RMS before the fit") < 0.02
    page.get_by_role("button", name="Undo").click()
    settled(page)
    assert number(page, "peak force") == peak
    # The design in the page is the one compared.
    done(page)
    first = output(page, "RMS difference of mine, loading")
    expect(first).to_be_visible(timeout=60_000)
    before = first.inner_text()
    field(page, "q", "outer", "x").fill("17")
    field(page, "q", "outer", "x").press("Enter")
    expect(first).not_to_have_text(before, timeout=60_000)
    done(page)
    test = compared(page, runs).pairs[0]
    assert number(page, "RMS difference of mine, loading") == shown_as(
        test.rmse * test.series.scale
    )


def test_recordings_are_dropped_stay_while_another_tab_is_open_and_can_be_left_out(
    page: Page, runs: list[Path]
):
    page.get_by_role("tab", name="Measured").click()
    data = page.evaluate_handle(
        """(texts) => {
          const data = new DataTransfer();
          for (const [name, text] of texts) data.items.add(new File([text], name));
          return data;
        }""",
        [(run.name, run.read_text()) for run in runs[:2]],
    )
    page.get_by_role("group", name="Recordings").dispatch_event("drop", {"dataTransfer": data})
    expect(output(page, "verdict on mine, loading")).to_be_visible(timeout=60_000)
    page.get_by_role("tab", name="Graph").click()
    page.get_by_role("tab", name="Measured").click()
    expect(page.get_by_text("mine_1.txt").first).to_be_visible()
    page.get_by_role("button", name="Leave mine_1.txt out").click()
    done(page)
    expect(output(page, "verdict on mine, loading")).to_have_count(0)
    expect(output(page, "verdict on back, unloading")).to_be_visible(timeout=60_000)
    page.get_by_role("button", name="Leave back_1.txt out").click()
    expect(page.get_by_role("table", name="Snaps")).to_have_count(0)


DROPPED = """([name, text]) => {
  const dataTransfer = new DataTransfer();
  dataTransfer.items.add(new File([text], name));
  document.body.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true }));
}"""


def test_a_file_dropped_anywhere_is_read_as_the_lab_reads_it_and_becomes_an_element(
    page: Page, tmp_path: Path, axe: str
):
    x = np.linspace(0, 20, 300)
    force = 0.5 * np.sin(x / 20 * 2 * np.pi) + 0.05 * x
    rows = (
        f"{a:.4f},{0.9 * a + 0.3 * np.sin(a):.4f},{b:.5f}" for a, b in zip(x, force, strict=True)
    )
    file = tmp_path / "clip.csv"
    file.write_text("\n".join(["A (mm),B (mm),Load (N)", *rows]))
    page.evaluate(DROPPED, [file.name, file.read_text()])
    table = page.get_by_role("table", name="Columns of clip.csv")
    expect(table).to_be_visible(timeout=60_000)
    nothing_found(page, axe, "[role=tabpanel]")
    # What the file leaves open is asked with a field for it.
    expect(page.get_by_role("alert")).to_contain_text("could both be the stroke")
    page.get_by_label("Column of the stroke").select_option("1")
    expect(page.get_by_role("alert")).to_have_count(0, timeout=60_000)
    reading = lab.Reading(stroke=1)
    page.get_by_text("Columns of clip.csv").click()
    with page.expect_download() as saved:
        page.get_by_role("button", name="Save reading").click()
    assert saved.value.suggested_filename == lab.READING_FILE
    folder = lab.save_reading(reading, tmp_path)
    assert saved.value.path().read_text("utf-8") == folder.read_text("utf-8")
    page.get_by_role("button", name="Make an element from clip.csv").click()
    measured = lab.measure_element(lab.read(file, reading))
    expect(page.get_by_text(str(measured))).to_be_visible(timeout=60_000)
    expect(page.get_by_role("heading", level=1)).to_have_text("clip")
    page.get_by_role("button", name="Undo").click()
    expect(page.get_by_role("heading", level=1)).to_contain_text("Forward leg")


def test_a_workbook_dropped_on_the_gallery_opens_the_panel(blank: Opened, empty_address: str):
    pytest.importorskip("python_calamine")
    x = np.linspace(0, 20, 50)
    book = xlsx([x, x * (20 - x) / 200], ["Displacement (mm)", "Force (N)"])
    page = blank.page
    page.goto(empty_address)
    page.locator(".card").first.wait_for()
    # The bytes of the file come to the page as numbers.
    page.evaluate(DROPPED.replace("[text]", "[Uint8Array.from(text)]"), ["a.xlsx", [*book]])
    expect(page.get_by_role("tab", name="Measured")).to_have_attribute("aria-selected", "true")
    expect(page.get_by_text("stroke: column 1 'Displacement'")).to_be_visible(timeout=60_000)


def test_what_is_no_recording_is_reported_and_stops_no_other(
    page: Page, runs: list[Path], tmp_path: Path
):
    picture, long = tmp_path / "picture.txt", tmp_path / "long.csv"
    picture.write_bytes(b"\x89PNG\0\0" * 50)
    row = b"1.000000,2.000000,3.000000\n"
    long.write_bytes(b"Time (s),Displacement (mm),Force (N)\n" + row * 1_000_000)
    choose(page, picture, runs[0], long)
    said = page.get_by_role("alert")
    expect(said).to_contain_text("picture.txt: is binary", timeout=60_000)
    expect(said).to_contain_text("long.csv: 26 MiB, and at most 16 MiB can be taken.")
    expect(output(page, "verdict on mine, loading")).to_be_visible()
