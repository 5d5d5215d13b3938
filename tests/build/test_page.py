"""Promises about pages: SVG and PDF show the same, at the size that is drawn."""

import math
import re
import xml.etree.ElementTree as ET
from typing import Any

import numpy as np
import pypdfium2
import pytest

from build.shapes import lever
from stepwell.build.exports.page import Page, Pen, broken, pdf_bytes, width_of

DOTS = 10.0  # pixels a millimetre
_SCALE: Any = DOTS * 25.4 / 72.0
SVG = "{http://www.w3.org/2000/svg}"


def pixels(content: bytes, number: int = 0) -> np.ndarray:
    """The page as grey values, 10 pixels a millimetre, y up."""
    page = pypdfium2.PdfDocument(content)[number]
    image = page.render(scale=_SCALE, no_smoothpath=True).to_pil().convert("L")
    return np.asarray(image)[::-1]


def extent(grey: np.ndarray) -> list[float]:
    """x and y of the first and last dark pixels [mm]."""
    rows, columns = np.nonzero(grey < 128)
    return [one / DOTS for one in (columns.min(), rows.min(), columns.max() + 1, rows.max() + 1)]


def page() -> Page:
    made = Page(100.0, 60.0)
    part = lever()
    made.contours([part.outline, *part.openings], (30.0, 20.0), Pen(None, "#000000"))
    return made


def test_a_page_of_a_pdf_file_is_1_to_1():
    made, part = page(), lever()
    grey = pixels(pdf_bytes([made], "lever"))
    assert grey.shape == pytest.approx((600, 1000), abs=1)
    x0, y0, x1, y1 = (1e3 * one for one in part.outline.bounds)
    assert extent(grey) == pytest.approx([30 + x0, 20 + y0, 30 + x1, 20 + y1], abs=0.11)
    area = (grey < 128).sum() / DOTS**2
    assert area == pytest.approx(1e6 * part.area, rel=0.01)


def test_arcs_of_svg_and_pdf_files_are_those_of_the_contour():
    made, part = page(), lever()
    (path,) = ET.fromstring(made.svg("lever")).iter(f"{SVG}path")
    corners = re.findall(
        r"[MLA](?:[\d.]+ [\d.]+ 0 [01] [01] )?(-?[\d.]+) (-?[\d.]+)", path.get("d", "")
    )
    ours = [point for one in (part.outline, *part.openings) for point in one.points]
    theirs = [((float(x) - 30) / 1e3, (60 - float(y) - 20) / 1e3) for x, y in corners]
    for point in ours:
        assert min(math.dist(point, other) for other in theirs) < 2e-7


def test_equal_pages_have_equal_pdf_files_with_embedded_fonts():
    made = page()
    made.text((10.0, 50.0), "lever 1a: 3.1 mm ± 0.05, 45°", 4.0, bold=True)
    assert pdf_bytes([made], "lever") == pdf_bytes([made], "lever")
    document = pypdfium2.PdfDocument(pdf_bytes([made, made], "lever"))
    assert len(document) == 2
    assert "3.1 mm ± 0.05, 45°" in document[0].get_textpage().get_text_bounded()
    assert b"/FontFile2" in pdf_bytes([made], "lever")
    assert b"/PrintScaling /None" in pdf_bytes([made], "lever")


def test_lines_of_a_paragraph_are_no_wider_than_asked():
    text = "Put the bottom plates of all blocks on a table with their marks up. " * 3
    lines = broken(text, 60.0, 3.0)
    assert " ".join(lines) == text.strip()
    assert max(width_of(line, 3.0) for line in lines) <= 60.0
