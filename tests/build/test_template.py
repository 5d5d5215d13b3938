"""Promises about drilling templates, measured in rendered pages."""

import math
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pypdfium2
import pytest

from build.shapes import block, lever
from build.test_page import DOTS, pixels
from stepwell.build import Contour, Hole, Part
from stepwell.build.exports.page import PAPERS, pdf_bytes
from stepwell.build.exports.template import alike, template_page, template_pages


def plate(width: float, height: float) -> Part:
    outline = Contour.of([(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)])
    corners = [(x, y) for x in (0.01, width - 0.01) for y in (0.01, height - 0.01)]
    holes = tuple(Hole(at, 0.003, f"H{i}", "screw") for i, at in enumerate(corners))
    return Part("plate", "plywood", 0.003, outline, holes)


def dark_runs(line: np.ndarray) -> list[tuple[float, float]]:
    """Begin and end of each dark stretch of a row of pixels [mm]."""
    edges = np.flatnonzero(np.diff(np.r_[False, line < 128, False].astype(int)))
    return [(a / DOTS, b / DOTS) for a, b in zip(edges[::2], edges[1::2], strict=True)]


@pytest.mark.parametrize("paper", ["A4", "letter"])
def test_the_bar_of_every_page_is_100_mm_long(paper):
    content = pdf_bytes(template_pages([block(), plate(0.3, 0.4)], paper), "template")
    for number in range(len(pypdfium2.PdfDocument(content))):
        grey = pixels(content, number)
        assert grey.shape == pytest.approx(tuple(DOTS * x for x in PAPERS[paper][::-1]), abs=1)
        longest = max(b - a for a, b in dark_runs(grey[round(15.0 * DOTS)]))
        assert longest == pytest.approx(100.2, abs=0.15)  # with the line's own width


def test_parts_and_holes_are_at_full_size_on_paper():
    grey = pixels(pdf_bytes(template_pages([plate(0.12, 0.05)]), "template"))
    wide = [y for y in range(len(grey)) if _wide(grey[y], 120.25)]
    # The dimension, the lower edge and the upper edge, each a few rows of pixels.
    *_, low, high = (y for y in wide if y - 1 not in wide)
    assert (high - low) / DOTS == pytest.approx(50.0, abs=0.15)
    centre = low + round(10.0 * DOTS)
    runs = dark_runs(grey[centre - 3 : centre + 4].min(axis=0))
    centres = [(a + b) / 2 for a, b in runs if 3.0 < b - a < 6.0]
    edges = [(a + b) / 2 for a, b in runs if b - a < 0.6]
    assert centres[1] - centres[0] == pytest.approx(100.0, abs=0.2)
    assert centres[0] - edges[0] == pytest.approx(10.0, abs=0.2)


def _wide(row: np.ndarray, width: float) -> bool:
    return any(abs(b - a - width) < 0.3 for a, b in dark_runs(row))


def test_every_hole_is_listed_from_the_corner_of_the_part():
    content = pdf_bytes(template_pages([block()]), "template")
    text = pypdfium2.PdfDocument(content)[0].get_textpage().get_text_bounded()
    words = text.split()
    x0, y0, *_ = block().outline.bounds
    for hole in block().holes:
        x, y = hole.centre
        row = [hole.name, f"{1e3 * (x - x0):.2f}", f"{1e3 * (y - y0):.2f}"]
        assert any(words[i : i + 3] == row for i in range(len(words)))


def test_tiles_of_a_large_part_share_crosses_and_show_every_hole():
    part = plate(0.30, 0.40)
    pages = [page for page in template_pages([part]) if "tile" in page.texts[0][2]]
    assert len(pages) == 4
    named = [text for page in pages for _, _, text, *_ in page.texts]
    assert all(hole.name in named for hole in part.holes)
    # Crosses of neighbours are at the same place of the part: tiles are 180 mm apart along x.
    arcs = ([steps[1] for steps, _ in page.shapes if steps[1][0] == "A"] for page in pages[:2])
    circles = [[step[1][0] for step in steps if step[3] == 2.0] for steps in arcs]
    step = PAPERS["A4"][0] - 20.0 - 10.0
    shared = [x for x in circles[0] if any(abs(x - step - other) < 1e-9 for other in circles[1])]
    assert len(shared) >= 2


def test_equal_parts_share_a_page():
    parts = [block(), lever(), *(replace(lever(), name=f"lever-{i}") for i in (2, 3))]
    shapes = alike(parts)
    assert [one.names for one in shapes] == [("block-1-top",), ("lever-1a", "lever-2", "lever-3")]
    assert len(template_pages(parts)) == 2


def test_a_template_as_svg_is_1_to_1():
    root = ET.fromstring(template_page(lever()).svg("lever"))
    width = float(root.get("width", "").removesuffix("mm"))
    assert width == float(root.get("viewBox", "").split()[2])
    assert math.isclose(width, 100.0 + 44.0)
