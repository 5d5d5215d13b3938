"""The report: complete, readable anywhere, and safe with any text in the design."""

import base64
import math
import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest

from stepwell import figures, files, results
from stepwell.design import Change, margin
from stepwell.mechanism import Band, Cell, Chain, Cubic, Load
from stepwell.reports.page import report
from stepwell.results.head import tie_notes

VOID = {"meta", "img", "br", "hr", "link"}


class Page(HTMLParser):
    """The page's text and tables; fails on tags that do not match."""

    def __init__(self, text: str):
        super().__init__()
        self.open: list[str] = []
        self.tags: list[str] = []
        self.words: list[str] = []
        self.tables: list[list[list[str]]] = []
        self.images: list[dict[str, str | None]] = []
        self.links: list[str] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.links += [value for name, value in attrs if name in ("href", "src") and value]
        if tag not in VOID:
            self.open.append(tag)
        if tag == "img":
            self.images.append(dict(attrs))
        if tag == "table":
            self.tables.append([])
        if tag == "tr":
            self.tables[-1].append([])
        if tag in ("td", "th"):
            self.tables[-1][-1].append("")

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if "style" not in self.open:
            self.words.append(data)
        if self.open[-1:] in (["td"], ["th"]):
            self.tables[-1][-1][-1] += data

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())


def page_of(chain: Chain, source: str | None = None) -> Page:
    return Page(report(chain.cycle(), margin(chain), {}, source))


@pytest.fixture(scope="module")
def forward():
    cycle = files.preset("paper-forward").cycle()
    drawn = {"Force & stroke": figures.force_stroke(cycle), "Landscape": figures.landscape(cycle)}
    return cycle, report(cycle, margin(cycle.chain), drawn, "forward.toml")


def test_head_says_what_the_design_does(forward):
    cycle, html = forward
    text = Page(html).text
    assert "00 → 10 → 11 → 01 → 00" in text
    assert "Pathway clockwise." in text
    assert "Cells load in the order inner, outer, and unload in the order inner, outer." in text
    assert "Design file forward.toml" in text
    assert f"Peak actuator force {cycle.peak_force:.4g} N" in text
    assert f"Dissipated in a cycle {cycle.dissipated * 1e3:.4g} mJ" in text
    assert "Snaps 2" in text


def test_cells_are_listed_with_f0_and_f1(forward):
    _, html = forward
    cells = Page(html).tables[0]
    assert cells[0][2:6] == ["F0 [N]", "F1 [N]", "F0/(kr)", "F1/(kr)"]
    # Kamp et al. 2024: ±0.967 and ±1.607.
    assert [float(row[4]) for row in cells[1:]] == pytest.approx([0.967, 1.607], abs=1e-3)
    assert [row[0] for row in cells[1:]] == ["inner", "outer"]


def test_every_event_has_its_row(forward):
    cycle, html = forward
    events = Page(html).tables[1][1:]
    assert len(events) == len(cycle.events)
    for row, event in zip(events, cycle.events, strict=True):
        assert row[1] == event.kind.name.lower()
        assert float(row[2]) == float(f"{event.stroke * 1e3:.4g}")
        snap = event.kind.name == "SNAP"
        assert (row[6] != "") == snap
        if snap:
            assert float(row[6]) == pytest.approx(event.released * 1e3, rel=1e-3)


def test_margins_come_nearest_first_with_the_sequence_past_them(forward):
    cycle, html = forward
    rows = Page(html).tables[2][1:]
    limits = margin(cycle.chain)
    nearest = min(limits.changes, key=lambda change: change.distance)
    assert rows[0][0] == cycle.chain.names[nearest.cell]
    assert rows[0][4] == nearest.becomes
    assert len(rows) == len(limits.changes)


@pytest.mark.parametrize("count", [12, 13])
def test_long_chains_are_told_distances_without_a_cycle_for_each(count, monkeypatch):
    cells = tuple(Cell(Band((-0.010, 0.0), (0.004 + 0.001 * i, 0.0))) for i in range(count))
    cycle = Chain(cells).cycle()
    limits = margin(cycle.chain)
    asked = []
    monkeypatch.setattr(Change, "becomes", property(lambda change: asked.append(change) or "1>0"))
    table = Page(report(cycle, limits, {})).tables[2]
    changes = results.run_record(cycle, limits)["margin"]["changes"]
    spelled = count <= 12
    assert ("Sequence past it" in table[0]) == spelled
    assert {len(row) for row in table} == {len(table[0])}
    assert {change["becomes"] for change in changes} == {"1>0" if spelled else None}
    assert len(asked) == (4 * count if spelled else 0)
    assert len(table) == 1 + 2 * count == 1 + len(changes)


def test_nothing_is_fetched_or_run(forward):
    _, html = forward
    page = Page(html)
    assert "script" not in page.tags
    assert page.links
    assert all(link.startswith("data:image/svg+xml;base64,") for link in page.links)
    assert not re.search(r"url\(|@import|https?://", html)


def test_figures_are_whole_pictures_with_their_caption(forward):
    _, html = forward
    images = Page(html).images
    assert [image["alt"] for image in images] == ["Force & stroke", "Landscape"]
    for image in images:
        data = (image["src"] or "").removeprefix("data:image/svg+xml;base64,")
        assert base64.b64decode(data, validate=True).startswith(b"<svg")


def test_page_follows_the_reader_into_the_dark(forward):
    _, html = forward
    assert "prefers-color-scheme: dark" in html


def test_no_text_of_the_user_becomes_markup():
    evil = '<script>alert("1")</script> & $title'
    cell = Cell(Band((-0.010, 0.0), (0.010, 0.0)), name=evil)
    outer = Cell(Band((-0.010, 0.0), (0.020, 0.0)), name='"><img src=x>')
    cycle = Chain((cell, outer), title=evil).cycle()
    drawn = {evil: figures.force_stroke(cycle)}
    html = report(cycle, margin(cycle.chain), drawn, evil)
    page = Page(html)
    assert "script" not in page.tags
    assert len(page.images) == 1
    assert page.images[0]["alt"] == evil
    assert page.tables[0][1][0] == evil


def test_a_tie_is_told_with_its_advice():
    cycle = files.preset("paper-identical").cycle()
    text = Page(report(cycle, None, {})).text
    assert "Too close to call." in text
    for note in tie_notes(cycle.degenerate, cycle.chain):
        assert " ".join(note.split()) in text
    assert "Too close to call." not in page_of(files.preset("paper-forward")).text


def test_without_a_margin_the_page_says_so():
    text = Page(report(files.preset("paper-forward").cycle(), None, {})).text
    assert "Margin Not computed." in text
    assert "Nearest other sequence" not in text


BAND = Band((-0.010, 0.0), (0.010, 0.0))
OUTER = Cell(Band((-0.010, 0.0), (0.020, 0.0)))
PLAIN = (
    "The actuator is rigid: it prescribes the stroke.",
    "Bands pull and never push: a slack band carries nothing.",
    "Bands are linear: tension is stiffness times extension, without hysteresis.",
    "No friction between blocks.",
    "No weight or other load acts on a cell.",
)


def test_common_assumptions_stand_beside_the_results():
    text = page_of(Chain((Cell(BAND), OUTER))).text
    for line in (*PLAIN, "Quasi-static", "Levers and blocks are rigid", "overdamped flow"):
        assert line in text
    assert "leads it, every travel being equally mobile;" in text


def test_unlike_mobilities_stand_beside_the_results():
    text = page_of(Chain((Cell(BAND, mobility=3.0), OUTER))).text
    assert "leads it, every cell with its own mobility: inner 3, all others 1;" in text
    text = page_of(Chain((Cell(BAND, mobility=3.0), replace(OUTER, mobility=0.5)))).text
    assert "every cell with its own mobility: inner 3, outer 0.5;" in text
    alike = Chain((Cell(BAND, mobility=3.0), replace(OUTER, mobility=3.0)))
    assert "every travel being equally mobile" in page_of(alike).text


@pytest.mark.parametrize(
    ("chain", "line", "instead"),
    [
        (Chain((Cell(BAND, friction=0.02), OUTER)), "friction against travel: inner 0.02 N.", 3),
        (
            Chain((Cell(replace(BAND, two_sided=True)), OUTER)),
            "Bands of inner are two-sided springs that also push; the others pull only.",
            1,
        ),
        (
            Chain((Cell(replace(BAND, two_sided=True)),)),
            "Bands are two-sided springs, as in the paper: below rest length they push.",
            1,
        ),
        (
            Chain((Cell(replace(BAND, law=Cubic(-20.0, 600.0))), OUTER)),
            "Bands of inner follow a nonlinear law; the others are linear.",
            2,
        ),
        (Chain((Cell(replace(BAND, law=Cubic(-20.0, 600.0))),)), "follow a nonlinear law.", 2),
        (
            Chain((Cell(BAND), replace(OUTER, load=Load.constant(0.01)))),
            "A load that depends on its travel acts on outer.",
            4,
        ),
        (
            Chain((Cell(BAND), OUTER), actuator_stiffness=500.0),
            "The actuator has a stiffness of 500 N/m in series.",
            0,
        ),
        (
            Chain((Cell(BAND), OUTER), actuator_stiffness=0.0),
            "The actuator prescribes the force, not the stroke.",
            0,
        ),
    ],
)
def test_special_assumptions_replace_the_common_ones(chain, line, instead):
    text = Page(report(chain.cycle(), None, {})).text
    assert line in text
    assert PLAIN[instead] not in text


def test_long_tables_are_cut_and_say_so():
    cells = tuple(
        Cell(Band((-0.010, 0.0), (0.004 + 0.0001 * i, 0.0)), friction=0.001 if i == 3 else 0.0)
        for i in range(201)
    )
    chain = Chain(cells)
    path = chain.path([0.0])
    from stepwell.sequences import Cycle

    page = Page(report(Cycle(path), None, {}))
    assert len(page.tables[0]) == 1 + 200
    assert "The first 200 of 201 are shown." in page.text


def test_a_distance_out_of_reach_is_said_in_words():
    chain = files.preset("paper-cell-10-0")
    limits = margin(chain)
    assert all(math.isinf(change.distance) for change in limits.changes)
    page = Page(report(chain.cycle(), limits, {}))
    assert "none within reach" in page.text
    assert "inf" not in page.text.replace("information", "")
    assert "nan" not in page.text
