"""Figures as files: the same figure gives the same bytes, and never half of them."""

import base64
import io
import re
from xml.etree import ElementTree

import pytest
from fontTools.ttLib import TTFont
from PIL import Image

import stepwell as sw
from facts import refuses
from figures.drawn import says
from sizes import cases
from stepwell import figures, files


@pytest.fixture(scope="module")
def figure():
    return figures.force_stroke(files.preset("paper-forward").cycle())


def test_a_png_has_the_size_of_its_column(figure, tmp_path):
    figures.save(figure, tmp_path / "force.png", dpi=254)
    with Image.open(tmp_path / "force.png") as image:
        assert image.size[0] == pytest.approx(850, abs=1)


@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".svg", ".pdf", ".png"])
def test_the_same_figure_gives_the_same_file(suffix, tmp_path):
    for name in ("a", "b"):
        cycle = files.preset("paper-forward").cycle()
        figures.save(figures.landscape(cycle), tmp_path / f"{name}{suffix}")
    assert (tmp_path / f"a{suffix}").read_bytes() == (tmp_path / f"b{suffix}").read_bytes()


def test_svg_text_is_only_the_picture(figure):
    text = figures.svg(figure)
    assert text.startswith("<svg")
    assert text.rstrip().endswith("</svg>")
    assert "<script" not in text


def test_an_unknown_kind_is_refused_and_nothing_is_written(figure, tmp_path):
    with refuses(ValueError, "force.xyz", ".png, .svg", ".pdf", "'.xyz'"):
        figures.save(figure, tmp_path / "force.xyz")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_text_of_an_svg_is_text_in_fonts_that_it_brings_along(figure, tmp_path):
    figures.save(figure, tmp_path / "force.svg")
    svg = (tmp_path / "force.svg").read_text()
    words = "".join(ElementTree.fromstring(svg).itertext())
    assert "Actuator force [N]" in words
    faces = re.findall(r"@font-face \{ font-family: '([^']*)';[^}]*base64,([^)]*)\)", svg)
    assert faces
    letters: set[str] = set()
    for family, data in faces:
        font = TTFont(io.BytesIO(base64.b64decode(data)))
        assert family == font["name"].getDebugName(1)
        letters |= set(map(chr, font.getBestCmap() or {}))
    # All that is shown, and not the whole alphabet.
    shown = {letter for text in says(figure) for letter in text} - set("$\\{}_^\u200b\n")
    assert shown <= letters
    assert len(letters) < 80


def test_outlines_need_no_font(figure, tmp_path):
    figures.save(figure, tmp_path / "force.svg", text=False)
    assert "<text" not in (tmp_path / "force.svg").read_text()


@pytest.mark.slow
def test_text_is_text_in_every_svg_of_a_report(tmp_path):
    names = sw.reports.write(files.preset("paper-forward").program("01"), tmp_path)
    drawings = [name for name in names if name.endswith(".svg")]
    page = (tmp_path / "report.html").read_text("utf-8")
    embedded = re.findall(r"data:image/svg\+xml;base64,([^\"']*)", page)
    texts = [(tmp_path / name).read_text("utf-8") for name in drawings]
    texts += [base64.b64decode(data).decode() for data in embedded]
    assert drawings
    assert embedded
    for text in texts:
        root = ElementTree.fromstring(text)
        assert [*root.iter("{http://www.w3.org/2000/svg}text")]
        # Outlines of letters are symbols that are used by their name.
        assert not re.search(r"<use[^>]*#DejaVu", text)


@pytest.mark.slow
def test_fonts_of_a_pdf_are_in_it_as_truetype(figure, tmp_path):
    figures.save(figure, tmp_path / "force.pdf")
    pdf = (tmp_path / "force.pdf").read_bytes()
    fonts = re.findall(rb"/FontDescriptor \d+ 0 R|/FontFile2 \d+ 0 R", pdf)
    assert {font.split()[0] for font in fonts} == {b"/FontDescriptor", b"/FontFile2"}
    assert b"/Subtype /Type3" not in pdf
    # What turns glyphs back into letters, for who searches or copies.
    assert b"/ToUnicode" in pdf


@pytest.mark.slow
def test_a_png_tells_how_large_it_is(figure, tmp_path):
    figures.save(figure, tmp_path / "force.png", dpi=figures.PRINT_DPI)
    with Image.open(tmp_path / "force.png") as image:
        assert image.info["dpi"] == pytest.approx((600, 600), abs=0.1)


@pytest.mark.slow
def test_text_in_an_svg_is_the_same_every_time(figure, tmp_path):
    for name in ("a.svg", "b.svg"):
        figures.save(figure, tmp_path / name)
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


WIDTHS = sorted({one.width for one in figures.JOURNAL_WIDTHS.values()})


@pytest.mark.slow
@pytest.mark.parametrize("width", cases(WIDTHS, [WIDTHS[0], WIDTHS[len(WIDTHS) // 2], WIDTHS[-1]]))
@pytest.mark.parametrize("preset", ["paper-forward", "three-wave", "curved-beam", "robot-forward"])
def test_the_default_figure_of_a_design_fits_a_page_of_every_journal(preset, width):
    drawn = sw.reports.figure(sw.preset(preset), width=width)
    assert drawn.get_size_inches()[1] * 25.4 <= sw.reports.TALLEST
