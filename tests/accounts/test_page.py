"""The page of a result: complete in itself, readable anywhere, and safe with any text."""

import base64
import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest

import stepwell as sw
from accounts.forms import plain
from golden.sketching import sketched
from stepwell import reports
from stepwell.accounts import Account, FigurePair, account, card, page
from stepwell.accounts.parts import Level, Picture, RecordTable, Warned
from stepwell.accounts.rendering.page import MOST_ROWS, Image
from stepwell.accounts.words import assumptions
from stepwell.base import Quantity
from stepwell.design import Run
from stepwell.mechanism import Band, Cell, Chain, Cubic, Load

VOID = {"meta", "img", "br", "hr", "link", "source"}


class Page(HTMLParser):
    """The page's tags, texts and tables; fails on tags that do not match."""

    def __init__(self, text: str):
        super().__init__()
        self.open: list[str] = []
        self.tags: list[str] = []
        self.headings: list[str] = []
        self.tables: list[list[list[str]]] = []
        self.images: list[dict[str, str | None]] = []
        self.links: list[str] = []
        self.frames: list[dict[str, str | None]] = []
        self.text = plain(text)
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.links += [
            value for name, value in attrs if name in ("href", "src", "srcset") and value
        ]
        if tag not in VOID:
            self.open.append(tag)
        if tag == "img":
            self.images.append(dict(attrs))
        if tag == "iframe":
            self.frames.append(dict(attrs))
        if tag == "table":
            self.tables.append([])
        if tag == "tr":
            self.tables[-1].append([])
        if tag in ("td", "th"):
            self.tables[-1][-1].append("")
        if tag == "h2":
            self.headings.append("")

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open[-1:] in (["td"], ["th"]):
            self.tables[-1][-1][-1] += data
        if self.open[-1:] == ["h2"]:
            self.headings[-1] += data


@pytest.fixture(scope="module")
def run():
    return Run.of(sw.preset("paper-forward"))


@pytest.fixture(scope="module")
def written(run, tmp_path_factory):
    folder = tmp_path_factory.mktemp("written")
    reports.write(run, folder)
    return (folder / "report.html").read_text("utf-8")


def _rows(count: int) -> Account:
    rows = [{"what": str(k)} for k in range(count)]
    table = RecordTable([Quantity("what", head="what")], lambda: rows, more="things")
    return Account(None, "Many", sections={"All of them": table})


@pytest.mark.slow
def test_a_page_has_its_sections_in_order_and_the_answer_first(run, written):
    made, found = Page(written), account(run)
    headings = list(found.sections)
    assert [one for one in headings if one in made.headings] == made.headings
    assert {"Switches and snaps", "Cells, innermost first", "Motion", "Assumptions"} <= set(
        made.headings
    )
    assert made.text.index(found.answer) < made.text.index("Switches and snaps")


@pytest.mark.slow
def test_nothing_is_fetched_or_run_but_the_replay_in_a_frame_of_its_own(written):
    made = Page(written)
    assert "script" not in made.tags
    icon, *pictures = made.links
    assert icon == "data:,"
    assert pictures
    assert all(link.startswith("data:image/svg+xml;base64,") for link in pictures)
    (frame,) = made.frames
    assert frame["sandbox"] == "allow-scripts"
    outside = written.replace(frame["srcdoc"] or "", "")
    outside = re.sub(r'srcdoc="[^"]*"', "", outside)
    assert not re.search(r"url\(|@import|https?://", outside)
    assert "default-src 'none'; img-src data:" in outside


@pytest.mark.slow
def test_every_figure_is_a_whole_picture_with_its_caption(run, written):
    captions = [
        part.caption
        for _, parts in account(run).within(Level.PAGE)
        for part in parts
        if isinstance(part, Picture)
    ]
    images = Page(written).images
    assert {image["alt"] for image in images} <= set(captions)
    assert len(images) >= 7
    for image in images:
        data = (image["src"] or "").removeprefix("data:image/svg+xml;base64,")
        assert base64.b64decode(data, validate=True).startswith(b"<svg")


def test_a_wide_figure_has_another_form_for_phones():
    wide, narrow = Image("data:wide", 700, 300), Image("data:narrow", 321, 500)
    found = Account(None, "One", sections={"Figure": Picture("it", "A figure")})
    made = Page(page(found, {"it": FigurePair(wide, narrow)}))
    assert {"data:wide", "data:narrow"} <= set(made.links)
    assert "(max-width:" in page(found, {"it": FigurePair(wide, narrow)})
    # Without one it is scrolled by itself, with keys too.
    assert 'class="scroll"' in page(found, {"it": FigurePair(wide)})
    assert "data:wide" not in page(found)


@pytest.mark.slow
def test_the_page_follows_the_reader_into_the_dark_and_onto_paper(written):
    assert "prefers-color-scheme: dark" in written
    assert "@media print" in written


def test_long_tables_are_folded_and_very_long_ones_cut_with_their_count():
    assert "details" not in Page(page(_rows(24))).tags
    assert "details" in Page(page(_rows(25))).tags
    made = Page(page(_rows(MOST_ROWS + 1)))
    assert len(made.tables[0]) == 1 + MOST_ROWS
    assert f"{MOST_ROWS} of {MOST_ROWS + 1}" in made.text


def test_no_text_of_a_user_becomes_markup():
    evil = '<script>alert("1")</script> & $title'
    cell = Cell(Band((-0.010, 0.0), (0.010, 0.0)), name=evil)
    outer = Cell(Band((-0.010, 0.0), (0.020, 0.0)), name='"><img src=x>')
    found = account(Chain((cell, outer), title=evil).cycle())
    found = replace(found, warnings=[Warned(evil, evil, [evil])])
    found = replace(found, sections={**found.sections, evil: Picture("it", evil)})
    made = Page(page(found, {"it": FigurePair(Image("data:image", 10, 10))}))
    assert "script" not in made.tags
    assert [image["alt"] for image in made.images] == [evil]
    assert made.headings[-1] == evil
    assert any(evil in cell for table in made.tables for row in table for cell in row)
    assert "<script" not in card(found)


@pytest.mark.slow
def test_of_long_chains_what_is_not_computed_or_played_is_said(tmp_path):
    cells = tuple(Cell(Band((-0.010, 0.0), (0.004 + 0.001 * i, 0.0))) for i in range(13))
    # Only the words of the page count.
    with sketched(words=False):
        reports.write(Run.of(Chain(cells)), tmp_path)
    made = Page((tmp_path / "report.html").read_text("utf-8"))
    assert made.frames == []
    # Each names the command that does it.
    assert "stepwell yield" in made.text and "stepwell replay" in made.text


BAND = Band((-0.010, 0.0), (0.010, 0.0))
OUTER = Cell(Band((-0.010, 0.0), (0.020, 0.0)))


@pytest.mark.parametrize(
    ("chain", "words"),
    [
        (Chain((Cell(BAND, friction=0.02), OUTER)), ["friction", "inner 0.02 N"]),
        (Chain((Cell(replace(BAND, two_sided=True)), OUTER)), ["of inner", "two-sided", "others"]),
        (Chain((Cell(replace(BAND, two_sided=True)),)), ["two-sided", "push"]),
        (Chain((Cell(replace(BAND, law=Cubic(-20.0, 600.0))), OUTER)), ["of inner", "nonlinear"]),
        (Chain((Cell(replace(BAND, law=Cubic(-20.0, 600.0))),)), ["nonlinear"]),
        (Chain((Cell(BAND), replace(OUTER, load=Load.constant(0.01)))), ["load", "outer"]),
        (Chain((Cell(BAND), OUTER), actuator_stiffness=500.0), ["actuator", "500 N/m"]),
        (Chain((Cell(BAND), OUTER), actuator_stiffness=0.0), ["actuator", "the force, not"]),
        (Chain((Cell(BAND, mobility=3.0), OUTER)), ["mobility", "inner 3, all others 1"]),
        (
            Chain((Cell(BAND, mobility=3.0), replace(OUTER, mobility=0.5))),
            ["mobility", "inner 3, outer 0.5"],
        ),
    ],
)
def test_what_a_chain_has_of_its_own_takes_the_place_of_the_common_assumption(chain, words):
    usual, own = assumptions(Chain((Cell(BAND), OUTER))), assumptions(chain)
    (special,) = [line for line in own if line not in usual] or [""]
    assert all(word in special for word in words)
    assert len(own) == len(usual)
    assert set(own) - {special} < set(usual)
