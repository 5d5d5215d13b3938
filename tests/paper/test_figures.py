"""The paper's figures come from the model, whole or not at all, and can be read."""

from functools import cache, partial

import pytest
from matplotlib.figure import Figure
from PIL import Image

from cli.folders import written
from facts import refuses
from figures.drawn import says, untidy_parts
from stepwell import paper, reports
from stepwell.reports import paper as figures

DRAWN = figures.FIGURES | figures.ROBOT_FIGURES


@cache
def drawn(name: str) -> Figure:
    """A figure of the paper, which nothing changes."""
    return DRAWN[name]()


@pytest.mark.slow
@pytest.mark.parametrize("name", DRAWN)
def test_no_word_covers_another_or_leaves_the_page(name):
    assert untidy_parts(drawn(name)) == []


@pytest.mark.slow
def test_every_page_of_the_paper_is_there():
    every = figures.FIGURES | figures.ROBOT_FIGURES | figures.MANY_RUNS
    assert [name for name in every if name.startswith("fig")] == [
        "fig1", "fig2", "fig2c", "fig3", "fig4"
    ]  # fmt: skip
    for name in figures.FIGURES:
        wide, high = drawn(name).get_size_inches() * 25.4
        assert wide <= 180.1
        assert high <= 247.0


@pytest.mark.slow
def test_six_cells_are_distinguished_by_their_anchors():
    for part in drawn("fig1").subfigs:
        anchors = [text for text in says(part) if "mm" in text]
        assert len(set(anchors)) == len(anchors) == 6


@pytest.mark.slow
def test_a_figure_is_asked_for_by_its_name():
    assert reports.figure_of("fig1").subfigs
    with refuses(ValueError, "'fig2d'", "no such figure", "fig2?"):
        reports.figure_of("fig2d")


@pytest.mark.slow
def test_the_map_names_all_four_pathways_and_marks_the_four_pairs():
    written = says(drawn("fig2c"))
    assert {"clockwise", "counterclockwise", "via 01", "via 10"} <= set(written)
    assert {"(20, 0)", "(0, 0)", "(10, \N{MINUS SIGN}15)", "(10, 15)"} <= set(written)


@pytest.mark.slow
def test_the_folder_holds_a_picture_and_a_drawing_of_each(tmp_path, monkeypatch, known_verdicts):
    chosen = {name: partial(drawn, name) for name in ("fig1", "fig2c")}
    monkeypatch.setattr(figures, "FIGURES", chosen)
    monkeypatch.setattr(figures, "ROBOT_FIGURES", {})
    reported = []
    progress = lambda done, total: reported.append((done, total))  # noqa: E731
    reports.write(paper.run(), tmp_path / "out", progress=progress)
    assert written(tmp_path / "out") == {
        "claims.json",
        "report.html",
        *(f"{name}{suffix}" for name in chosen for suffix in (".png", ".svg")),
    }
    with Image.open(tmp_path / "out" / "fig2c.png") as picture:
        assert picture.size[0] == pytest.approx(85 / 25.4 * 300, abs=1)
    assert reported[-1] == (len(reported), len(reported))
    assert len(reported) == 2 * len(chosen) + 2


@pytest.mark.slow
def test_a_figure_that_fails_leaves_an_old_folder_as_it_was(tmp_path, monkeypatch, known_verdicts):
    def fails():
        raise RuntimeError("no ink")

    monkeypatch.setattr(figures, "FIGURES", {"fig2c": partial(drawn, "fig2c"), "broken": fails})
    out = tmp_path / "out"
    out.mkdir()
    (out / "claims.json").write_text("old")
    with pytest.raises(RuntimeError, match="no ink"):
        reports.write(paper.run(), out, force=True)
    assert (out / "claims.json").read_text() == "old"
    assert [file.name for file in tmp_path.rglob("*.*")] == ["claims.json"]
