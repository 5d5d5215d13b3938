"""Figures as panels of a page: each at its place and its size, and all of it can be read."""

from functools import partial

import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

from facts import refuses
from figures.drawn import points, says, untidy
from lab.machine import recording, there
from sizes import cases
from stepwell import figures, files
from stepwell.mechanism import Band, Cell, Chain
from stepwell.paper import Effect, Sensitivity

WIDTHS = (85.0, 120.0, 180.0)


@pytest.fixture(scope="module")
def cycle():
    return files.preset("paper-forward").cycle()


def of(cycle):
    """A panel of every kind that chains of this length have."""
    chain, count = cycle.chain, len(cycle.chain)
    drawn = [partial(draw, cycle) for draw in (figures.force_stroke, figures.travel_stroke)]
    if count <= 12:
        drawn.insert(0, partial(figures.mechanism, chain, cycle.sequence))
    if count == 2:
        drawn.append(partial(figures.landscape, cycle))
    if count <= 5:
        drawn.append(partial(figures.force_plane, chain))
        drawn.append(partial(figures.transition_graph, chain.graph()))
    return [*drawn, partial(figures.unit_cell_energy, chain.cells)]


def chain_of(count):
    anchors = [0.001 + 0.021 * i / count for i in range(count)]
    return Chain([Cell(Band((-0.010, 0.0), (q, 0.0))) for q in anchors])


def height(figure):
    return 25.4 * float(figure.get_size_inches()[1])


# In the quick run every width and the lengths with the most panels and the most cells.
PAGES = [(count, width) for count in (1, 2, 5, 12, 20) for width in WIDTHS]
QUICK = [(2, 180.0), (5, 85.0), (20, 120.0)]


@pytest.mark.slow
@pytest.mark.parametrize(("count", "width"), cases(PAGES, QUICK))
def test_a_page_can_be_read_at_every_width_with_any_number_of_cells(count, width):
    figure = figures.compose(of(chain_of(count).cycle()), width=width)
    assert 25.4 * figure.get_size_inches()[0] == pytest.approx(width)
    assert [each for part in figure.subfigs for each in untidy(part, 6.0)] == []


@pytest.mark.slow
@pytest.mark.parametrize("width", cases(WIDTHS, [85.0]))
def test_a_robot_can_be_read_at_every_width(width):
    robot = files.load("preset:robot-explorer").robot
    panels = [partial(figures.robot_drawing, robot), partial(figures.prediction, robot.predict())]
    figure = figures.compose(panels, width=width)
    assert [each for part in figure.subfigs for each in untidy(part, 6.0)] == []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("letters", "written"),
    [("A", ["A", "B"]), ("a", ["a", "b"]), ("(a)", ["(a)", "(b)"]), ("none", [])],
)
def test_panels_are_lettered_in_reading_order(cycle, letters, written):
    panels = [partial(figures.force_stroke, cycle), partial(figures.travel_stroke, cycle)]
    figure = figures.compose(panels, letters=letters)
    letter_texts = [text for text in figure.findobj(Text) if text.get_gid() == "letter"]
    assert [text.get_text() for text in letter_texts] == written


def test_one_panel_has_no_letter_and_its_own_legend(cycle):
    figure = figures.compose([partial(figures.force_stroke, cycle)])
    assert not [text for text in figure.findobj(Text) if text.get_gid() == "letter"]
    assert figure.legends == []
    assert figure.subfigs[0].axes[0].get_legend() is not None


def test_what_panels_have_in_common_is_stated_once(cycle):
    panels = [partial(draw, cycle) for draw in (figures.force_stroke, figures.landscape)]
    figure = figures.compose(panels)
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["loading", "unloading", "snap"]
    assert not [ax for part in figure.subfigs for ax in part.axes if ax.get_legend()]


@pytest.mark.slow
def test_panels_of_a_row_stand_beside_each_other_and_rows_below(cycle):
    force, travel = (partial(d, cycle) for d in (figures.force_stroke, figures.travel_stroke))
    figure = figures.compose({"first": [force, travel], "second $x$": [force]}, width=120)
    a, b, c = (part.bbox for part in figure.subfigs)
    assert a.x1 < b.x0
    assert a.y1 == pytest.approx(b.y1)
    assert c.y1 < a.y0
    assert c.width == pytest.approx(120 / 25.4 * figure.dpi)
    assert {"first", "second \\$x\\$"} <= {text.get_text() for text in figure.texts}


@pytest.mark.slow
def test_a_panel_is_drawn_as_by_itself_where_it_has_that_size(cycle):
    alone = figures.force_stroke(cycle)
    figure = figures.compose([partial(figures.force_stroke, cycle)], width=85.0)
    (part,) = figure.subfigs
    assert says(part) == says(alone)


@pytest.mark.slow
def test_the_height_of_the_page_is_taken_by_panels_that_can(cycle):
    panels = [partial(figures.landscape, cycle), partial(figures.force_stroke, cycle)]
    plain = figures.compose(panels, width=85.0, columns=1)
    high = figures.compose(panels, width=85.0, columns=1, height=height(plain) + 20.0)
    assert height(high) == pytest.approx(height(plain) + 20.0)
    grown = [
        (after.bbox.height - before.bbox.height) / plain.dpi * 25.4
        for before, after in zip(plain.subfigs, high.subfigs, strict=True)
    ]
    assert grown == pytest.approx([0.0, 20.0], abs=1e-6)


@pytest.mark.parametrize(
    ("how", "says_why"),
    [
        ({"letters": "B"}, "must be one of A, a"),
        ({"width": 30.0}, "need 40 mm or more"),
        ({"height": 20.0}, "these panels need .* mm or more"),
        ({"columns": 0}, "must be 1 to 26"),
    ],
)
def test_a_page_that_cannot_be_is_refused(cycle, how, says_why):
    with pytest.raises(ValueError, match=says_why):
        figures.compose([partial(figures.force_stroke, cycle)] * 2, **how)
    with pytest.raises(ValueError, match="panels has 0 entries"):
        figures.compose([])


def test_rows_of_rigid_panels_have_no_other_height(cycle):
    with refuses(ValueError, "height = 200 mm", "fixed height", "leave out"):
        figures.compose([partial(figures.landscape, cycle)], height=200.0)


def test_a_panel_that_needs_a_page_says_so(cycle):
    effect = Effect("friction", 0.1, 0.2, 0.3, 0.4)
    tornado = partial(figures.tornado, Sensitivity("fraction", 0.35, [effect]))
    with refuses(ValueError, "width: ", "180 mm", "88 mm"):
        figures.compose([tornado], width=88.0)
    with pytest.raises(ValueError, match="must be a function of"):
        figures.compose([Figure])


def test_a_refusal_leaves_later_figures_alone(cycle):
    with pytest.raises(ValueError, match="height = "):
        figures.compose([partial(figures.landscape, cycle)], height=200.0)
    assert 25.4 * figures.force_stroke(cycle).get_size_inches()[0] == pytest.approx(85.0)


def test_recordings_lie_behind_the_force_by_their_names(cycle):
    up = there(0.020)
    runs = [recording(f"day/run_{k}.txt", up, 0.2 + 0.0 * up) for k in range(2)]
    figure = figures.force_stroke(cycle, measured=runs)
    (ax,) = figure.axes
    ghosts = [line for line in ax.get_lines() if line.get_gid() == "measured"]
    assert [float(points(line)[-1, 0]) for line in ghosts] == pytest.approx([20.0, 20.0])
    assert len({line.get_linestyle() for line in ghosts}) == 2
    assert {"measured: run_0", "measured: run_1"} <= set(says(figure))
    assert untidy(figure) == []


def test_recordings_that_cannot_be_distinguished_or_compared_are_refused(cycle):
    run = recording("run.txt", there(0.020), 0.0 * there(0.020))
    with pytest.raises(ValueError, match="at most 4"):
        figures.force_stroke(cycle, measured=[run] * 5)
    with refuses(ValueError, "measured: ", "pressure over volume"):
        figures.force_stroke(files.preset("balloon").cycle(), measured=[run])


@pytest.mark.parametrize(
    ("text", "mm"),
    [("88mm", 88.0), ("8.8 cm", 88.0), ("3.5in", 88.9), ("252pt", 88.9), ("nature-single", 89.0)],
)
def test_widths_are_read_in_their_units_and_by_name(text, mm):
    assert figures.length(text) == pytest.approx(mm)


@pytest.mark.parametrize(
    ("text", "says_why"),
    [
        ("88", "write 88mm"),
        ("88px", "unknown unit 'px'"),
        ("natur-single", "Did you mean nature-single"),
        ("9mm", "must be 40 to 400 mm"),
        ("1.2.3mm", "must be a length"),
        ("", "must be a length"),
    ],
)
def test_other_widths_are_refused_with_what_was_meant(text, says_why):
    with pytest.raises(ValueError, match=says_why):
        figures.length(text)


def test_journals_have_columns_that_pages_can_have():
    for name, one in figures.JOURNAL_WIDTHS.items():
        assert figures.length(name) == one.width
        assert one.source
