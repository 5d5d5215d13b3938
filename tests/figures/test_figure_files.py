"""Figures as files: the same figure gives the same bytes, and never half of them."""

import pytest
from PIL import Image

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
    with pytest.raises(ValueError, match=r"must end in \.png, \.svg or \.pdf, not '\.xyz'"):
        figures.save(figure, tmp_path / "force.xyz")
    assert list(tmp_path.iterdir()) == []
