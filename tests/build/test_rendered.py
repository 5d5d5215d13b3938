"""Cutting files and guide in a browser: drawings are 1:1 in pixels, and the guide is readable."""

import io

import numpy as np
import pytest

from build import chains
from build.shapes import block, lever
from chromium import Opened, needed
from stepwell.build import layout, load_build_file
from stepwell.build.exports.cutting import cutting
from stepwell.build.exports.guide import guide, guide_html
from stepwell.build.exports.sheets import sheets
from stepwell.build.exports.svg import svg_text

needed()
pytestmark = pytest.mark.slow
# A CSS pixel is 1/96 inch; the screen has four pixels for each.
ZOOM = 4
DOTS = ZOOM * 96.0 / 25.4  # pixels a millimetre


def rendered(browser, svg: str) -> np.ndarray:
    """The drawing as RGB values, y up."""
    from PIL import Image

    page = browser.new_page(viewport={"width": 600, "height": 400}, device_scale_factor=ZOOM)
    page.set_content(f"<style>body{{margin:0}} svg{{display:block}}</style>{svg}")
    image = page.screenshot()
    page.close()
    return np.asarray(Image.open(io.BytesIO(image)).convert("RGB")).astype(int)


@pytest.mark.parametrize("part", [block(), lever()], ids=lambda part: part.name)
def test_a_cutting_file_has_the_size_of_the_part_in_a_browser(browser, part):
    colours = rendered(browser, svg_text(cutting(part), part.name, margin=0.002))
    green = (colours[..., 1] - colours[..., 0]) > 60  # outlines
    red = (colours[..., 0] - colours[..., 1]) > 60  # openings
    x0, y0, x1, y1 = (1e3 * one for one in part.outline.bounds)
    rows, columns = np.nonzero(green)
    line = 0.1  # width of the line [mm]
    assert (np.ptp(columns) + 1) / DOTS == pytest.approx(x1 - x0 + line, abs=0.08)
    assert (np.ptp(rows) + 1) / DOTS == pytest.approx(y1 - y0 + line, abs=0.08)
    # The leftmost hole from the left edge.
    first = min(one.bounds[0] for one in part.openings) * 1e3 - x0
    _, inner = np.nonzero(red)
    assert (inner.min() - columns.min()) / DOTS == pytest.approx(first, abs=0.08)


def test_the_guide_opens_without_errors_and_fits_a_phone(browser):
    made = layout(chains.pair(), load_build_file("acrylic-3mm"))
    nested = sheets(made.parts, made.build_file.sheet.bed, seconds=0)
    content = guide(made, nested, title="Pair", sequence="00>10>11>01>00")
    page = browser.new_page(viewport={"width": 390, "height": 800})
    opened = Opened(page)
    page.set_content(guide_html(content))
    assert page.locator("section").count() == len(content.steps) + 1
    assert page.locator("svg").first.bounding_box()["width"] <= 390
    # Words of the table may be wider than a phone, pictures and texts are not.
    assert page.evaluate("document.querySelector('section').scrollWidth") <= 390
    assert opened.wrong == [] and opened.asked == []
    page.close()
