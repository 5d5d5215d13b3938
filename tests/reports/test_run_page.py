"""The report of a run: complete, readable anywhere, and safe with any text in the design."""

import base64
import math
import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest
from stepwell.results.head import tie_notes

from stepwell import figures, files, results
from stepwell.design import Change, margin
from stepwell.mechanism import Band, Cell, Chain, Cubic, Load
from stepwell.reports import report, write_run
from stepwell.studio.replay import replay

VOID = {"meta", "img", "br", "hr", "link", "source"}


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
        self.frames: list[dict[str, str | None]] = []
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
    assert text.index("Pulled out and let back, it goes 00 → 10 → 11 → 01 → 00.") < 400
    ways = "On the way out inner moves first, then outer; on the way back inner moves first, then"
    assert f"{ways} outer. It snaps twice, and a cycle loses 1.11 mJ. The pathway is" in text
    assert "Design file forward.toml" in text
    assert f"Peak actuator force {cycle.peak_force:.4g} N" in text
    assert f"Lost in a cycle {cycle.dissipated * 1e3:.4g} mJ" in text
    assert "Snaps 2" in text


def test_cells_are_listed_with_f0_and_f1(forward):
    _, html = forward
    cells = Page(html).tables[1]
    assert cells[0][2:6] == ["F0 [N]", "F1 [N]", "F0/(kr)", "F1/(kr)"]
    # Kamp et al. 2024: ±0.967 and ±1.607.
    assert [float(row[4]) for row in cells[1:]] == pytest.approx([0.967, 1.607], abs=1e-3)
    assert [row[0] for row in cells[1:]] == ["inner", "outer"]


def test_every_event_has_its_row(forward):
    cycle, html = forward
    events = Page(html).tables[2][1:]
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
    rows = Page(html).tables[0][1:]
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
    table = Page(report(cycle, limits, {})).tables[0]
    changes = results.run_record(cycle, limits)["margin"]["changes"]
    spelled = count <= 12
    assert ("Sequence past it" in table[0]) == spelled
    assert {len(row) for row in table} == {len(table[0])}
    assert {change["becomes"] for change in changes} == {"1>0" if spelled else None}
    # The two nearest are told in the head as well.
    assert len(asked) == (4 * count + 2 if spelled else 0)
    assert len(table) == 1 + 2 * count == 1 + len(changes)


def test_nothing_is_fetched_or_run(forward):
    _, html = forward
    page = Page(html)
    assert "script" not in page.tags
    icon, *pictures = page.links
    assert icon == "data:,"
    assert pictures
    assert all(link.startswith("data:image/svg+xml;base64,") for link in pictures)
    assert not re.search(r"url\(|@import|https?://", html)
    assert "default-src 'none'; img-src data:" in html


def test_the_only_script_is_that_of_the_replay_in_a_frame_of_its_own(forward):
    cycle, _ = forward
    motion = replay(cycle.chain, title="A motion")
    page = Page(report(cycle, None, {}, replay=motion))
    assert "script" not in page.tags
    (frame,) = page.frames
    assert frame["sandbox"] == "allow-scripts"
    assert frame["srcdoc"] == motion
    assert frame["title"] == cycle.chain.title


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
    assert page.tables[1][1][0] == evil


def test_a_tie_is_told_with_its_advice():
    cycle = files.preset("paper-identical").cycle()
    text = Page(report(cycle, None, {})).text
    assert "Too close to call." in text
    for note in tie_notes(cycle.degenerate, cycle.chain):
        assert " ".join(note.split()) in text
    assert "Too close to call." not in page_of(files.preset("paper-forward")).text


def test_without_a_margin_the_page_says_so():
    text = Page(report(files.preset("paper-forward").cycle(), None, {})).text
    assert "How nearly it does something else Not computed." in text
    assert "It would go" not in text
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
    assert "Show 200 rows" in page.text


def test_a_distance_out_of_reach_is_said_in_words():
    chain = files.preset("paper-cell-10-0")
    limits = margin(chain)
    assert all(math.isinf(change.distance) for change in limits.changes)
    page = Page(report(chain.cycle(), limits, {}))
    assert "none within reach" in page.text
    assert "inf" not in page.text.replace("information", "")
    assert "nan" not in page.text


def test_the_head_says_how_nearly_it_does_something_else(forward):
    cycle, html = forward
    limits = margin(cycle.chain)
    anchor = min(
        (c for c in limits.changes if c.parameter == "anchor"), key=lambda change: change.distance
    )
    told = f"if the anchor q of {cycle.chain.names[anchor.cell]} were moved by"
    becomes = anchor.becomes.replace(">", " → ")
    text = Page(html).text
    assert f"It would go {becomes} {told} {anchor.distance * 1e3:.3g} mm, or" in text
    assert text.index("It would go") < text.index("Switches and snaps")


def test_a_tie_is_said_to_stand_between_two_sequences():
    text = page_of(files.preset("paper-identical")).text
    assert "It stands between two sequences: any change at all decides which it takes." in text


def test_without_another_sequence_the_head_says_so():
    text = page_of(files.preset("paper-cell-10-0")).text
    assert "No change of an anchor within 20 mm, and none of one number alone" in text


@pytest.fixture(scope="module")
def written(tmp_path_factory) -> Page:
    chain, folder = files.preset("paper-forward"), tmp_path_factory.mktemp("written")
    write_run(chain.cycle(), margin(chain), folder)
    return Page((folder / "report.html").read_text("utf-8"))


def test_a_folder_s_report_draws_the_margins_and_plays_the_motion(written):
    captions = [image["alt"] for image in written.images]
    first, second, third, *_ = captions
    assert first == "How far each thing may be changed before it does something else"
    assert second == "What it does with the most sensitive anchor elsewhere"
    assert third == "What those built do"
    assert len(written.frames) == 1


def test_a_folder_s_report_counts_those_built(written):
    text = written.text
    assert "Built 20 000 times by chance within anchors ±0.3 mm and bands ±5 %" in text
    assert "Of those built do it 100 %" in text


def test_what_is_wider_than_a_phone_is_drawn_for_one_too(written):
    """Figures of one column fill a phone; wider ones have another form there."""
    for image in written.images:
        assert (
            int(image["width"] or 0) <= 322
            or image["alt"] == "The mechanism in the states of its cycle"
        )
    assert written.tags.count("source") == 1


def test_long_chains_say_what_was_not_computed(tmp_path):
    cells = tuple(Cell(Band((-0.010, 0.0), (0.004 + 0.001 * i, 0.0))) for i in range(13))
    chain = Chain(cells)
    write_run(chain.cycle(), margin(chain), tmp_path)
    page = Page((tmp_path / "report.html").read_text("utf-8"))
    assert page.frames == []
    assert "Not computed here: the command stepwell yield counts them." in page.text
    assert "The motion is not played here: the command stepwell replay" in page.text
