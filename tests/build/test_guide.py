"""Promises about the assembly guide: its steps, pictures, places on sheets, and last page."""

import re
from html import escape
from itertools import pairwise

import numpy as np
import pypdfium2
import pytest

from build import chains
from build.test_page import extent, pixels
from docs.build_pictures import FOLDER, pictures
from stepwell.build import layout, load_build_file
from stepwell.build.exports.before import expected
from stepwell.build.exports.guide import guide, guide_html, guide_pages, guide_pdf
from stepwell.build.exports.page import pdf_bytes
from stepwell.build.exports.picture import ObliqueView
from stepwell.build.exports.sheets import sheets
from stepwell.build.exports.steps import steps_of
from stepwell.build.part import Part
from stepwell.build.robots.making import Bought

CHAINS = {"pair": chains.pair(), "slotted": chains.slotted(), "crossed": chains.crossed()}
ACRYLIC = load_build_file("acrylic-3mm")
every_chain = pytest.mark.parametrize("name", CHAINS)


@pytest.fixture(scope="module")
def layouts():
    return {name: layout(chain, ACRYLIC) for name, chain in CHAINS.items()}


@pytest.fixture(scope="module")
def content(layouts):
    pair = layouts["pair"]
    nested = sheets(pair.parts, pair.build_file.sheet.bed, seconds=0)
    return guide(pair, nested, title="Pair <1>", sequence="00>10>11>01>00", draft="too thin")


@every_chain
def test_every_part_fastener_and_band_is_added_in_exactly_one_step(layouts, name):
    made = layouts[name]
    added = [id(one) for step in steps_of(made) for one in (*step.new, *step.hidden)]
    items = [*made.parts, *made.fasteners, *made.bands]
    assert sorted(added) == sorted(map(id, items))


@every_chain
def test_steps_go_upwards_and_pins_come_after_the_plates_that_hold_them(layouts, name):
    steps = steps_of(layouts[name])
    new = [one for step in steps for one in step.new if not isinstance(one, Bought)]
    lows = [one.base if isinstance(one, Part) else one.low for one in new]
    assert all(one <= two + 1e-9 for one, two in pairwise(lows))
    kinds = [step.kind for step in steps]
    assert kinds.index("block") < kinds.index("pin") < kinds.index("lever")
    assert kinds.index("hook") < kinds.index("band") < kinds.index("cap")


@every_chain
def test_pictures_are_within_their_pages(layouts, name):
    made = layouts[name]
    view = ObliqueView(made, made.angles("0" * len(made.cells)), (186.0, 128.0))
    items = [*made.parts, *made.fasteners, *made.bands]
    for page in (view.picture(items, ()), view.picture((), items), view.picture(items, items)):
        frame = page.width, page.height
        grown = type(page)(frame[0] + 20.0, frame[1] + 20.0)
        grown.insert(page, (10.0, 10.0))
        x0, y0, x1, y1 = extent(pixels(pdf_bytes([grown], name)))
        assert min(x0, y0) >= 9.5
        assert x1 <= frame[0] + 10.5 and y1 <= frame[1] + 10.5


def test_the_new_part_alone_is_coloured(layouts):
    pair = layouts["pair"]
    view = ObliqueView(pair, pair.angles("00"), (186.0, 128.0))
    top = pair.part("block-1-top")
    old = [part for part in pair.parts if part is not top]
    document = pypdfium2.PdfDocument(pdf_bytes([view.picture(old, [top])], "top"))
    colours = np.asarray(document[0].render(scale=2).to_pil()).astype(int)
    orange = (colours[..., 0] - colours[..., 2]) > 100
    whole = (colours.min(axis=2) < 250).sum()
    assert 0.2 < orange.sum() / whole < 0.6


def test_every_step_with_parts_shows_their_places_on_the_sheet(content):
    for shown in content.steps:
        parts = [one for one in shown.step.new if isinstance(one, Part)]
        captions = [caption for _, caption in shown.maps]
        if parts:
            (page, caption), *_ = shown.maps
            assert "acrylic-3mm-1" in caption
            marks = {text for _, _, text, *_ in page.texts}
            assert marks == {part.mark for part in parts}
        elif shown.step.kind != "band":
            assert any("full size" in caption for caption in captions)


def test_the_pdf_has_a_page_for_each_step_and_the_values_to_measure(content):
    document = pypdfium2.PdfDocument(guide_pdf(content))
    texts = [page.get_textpage().get_text_bounded() for page in document]
    assert len(texts) >= len(content.steps) + 2
    for number, shown in enumerate(content.steps, 1):
        heading = f"Step {number} of {len(content.steps)}: {shown.step.title}"
        assert sum(heading in text for text in texts) == 1
    assert "Before you pull" in texts[-1]
    assert "20.00" in texts[-1] and "41.23" in texts[-1]
    assert all("DRAFT: too thin" in text for text in texts)


@pytest.mark.slow
@pytest.mark.parametrize("paper", ["A4", "letter"])
def test_all_content_is_within_the_margins_of_the_paper(content, paper):
    pages = guide_pages(content, paper)
    data = pdf_bytes(pages, "guide")
    for number, page in enumerate(pages):
        x0, y0, x1, y1 = extent(pixels(data, number))
        assert x0 >= 9.0 and y0 >= 4.0
        assert x1 <= page.width - 9.0 and y1 <= page.height - 2.0


def test_the_html_guide_is_one_file_without_links_and_scripts(content):
    text = guide_html(content)
    assert "Pair &lt;1&gt;" in text
    assert not re.search(r"<script|<link|href=|src=|<img", text)
    assert text.count('role="img"') == 1 + sum(1 + len(shown.maps) for shown in content.steps)
    for check in content.checks:
        assert escape(check.value) in text
    assert text.count("DRAFT: too thin") >= len(content.steps)


def test_expected_values_are_those_of_the_mechanism(layouts):
    pair = layouts["pair"]
    rows = expected(pair, "00>10>11>01>00")
    inner, outer = chains.pair().cells
    values = [row.value.replace("\u00a0", " ") for row in rows]
    assert values.count("20.00 mm") == 2  # travels
    for cell in (inner, outer):
        length = float(cell.bands[0].length(cell.limit, cell.lever))
        assert sum(f"{1e3 * length:.2f} mm" in value for value in values) == 2
        assert any(f"pull {cell.force_0:.2f} N" in value for value in values)
        assert any(f"push {-cell.force_1:.2f} N" in value for value in values)
    assert values[-1] == "00 > 10 > 11 > 01 > 00"


def test_a_wrong_travel_is_explained_by_what_stops_the_cell():
    said = [
        expected(layout(chain, load_build_file("acrylic-3mm")), None)[0].meaning
        for chain in (chains.pair(), chains.slotted())
    ]
    assert ["faces" in one for one in said] == [True, False]
    assert ["arc slot" in one for one in said] == [False, True]


def test_tolerances_of_forces_grow_with_the_errors_of_the_bands(layouts):
    pair = layouts["pair"]
    worse = layout(pair.chain, ACRYLIC.with_lengths(tolerance__stiffness=0.2))
    tolerances = []
    for one in (pair, worse):
        rows = [row for row in expected(one, None) if "leaves state 0" in row.what]
        tolerances.append(float(re.findall(r"[\d.]+", rows[1].tolerance)[0]))
    assert tolerances[1] > 2.0 * tolerances[0] > 0.0
    # 20 % of the force, and little more.
    assert tolerances[1] == pytest.approx(0.2 * pair.chain.cells[1].force_0, rel=0.1)


def test_the_pictures_of_the_page_are_those_of_this_version():
    for name, text in pictures().items():
        assert (FOLDER / name).read_text("utf-8") == text, "python tests/docs/build_pictures.py"


def test_maps_without_room_come_on_further_pages():
    made = layout(chains.eight(), ACRYLIC)
    nested = sheets(made.parts, made.build_file.sheet.bed, seconds=0)
    content = guide(made, nested, title="Eight")
    document = pypdfium2.PdfDocument(guide_pdf(content))
    text = "".join(page.get_textpage().get_text_bounded() for page in document)
    for block in range(9):
        assert f"block-{block}-top from above" in " ".join(text.split())
    assert "continued" in text
