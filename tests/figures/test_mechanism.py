"""The drawing of the mechanism: true to length in every state."""

import math
from typing import Any, cast

import numpy as np
import pytest
from hypothesis import given, strategies as st
from matplotlib.collections import PolyCollection

from figures.drawn import legend_of, lines, points, says, untidy
from stepwell import figures, files
from stepwell.figures.cells.linkage import Drawing
from stepwell.figures.common import words
from stepwell.figures.common.sheet import blank, place
from stepwell.mechanism import Band, Cell, Chain
from stepwell.mechanism.layout import ChainLayout

mm = st.integers(-20, 20).map(lambda n: n * 1e-3)
bands = st.builds(
    Band, st.tuples(st.just(-0.010), mm), st.tuples(st.integers(1, 25).map(lambda n: n * 1e-3), mm)
)
cells = st.builds(
    Cell,
    st.one_of(bands, st.tuples(bands, bands)),
    lever=st.sampled_from([0.008, 0.0141, 0.030]),
    limit=st.sampled_from([0.3, math.pi / 4, 1.2]),
)
chains = st.lists(cells, min_size=1, max_size=6).map(tuple).map(Chain)
shares = st.lists(st.floats(0, 1), min_size=6, max_size=6)


def travels_of(chain: Chain, share: list[float]) -> list[float]:
    return [cell.full_travel * part for cell, part in zip(chain.cells, share, strict=False)]


@given(chains, shares)
def test_bands_and_levers_are_drawn_true_to_length(chain, share):
    travels = travels_of(chain, share)
    pose = ChainLayout(chain).pose(travels)
    drawn = np.hypot(*(pose.bands[:, 1] - pose.bands[:, 0]).T)
    expected = [
        float(band.length(cell.angle(s), cell.lever))
        for cell, s in zip(chain.cells, travels, strict=True)
        for band in cell.bands
    ]
    assert drawn == pytest.approx(expected, rel=1e-9)
    levers = np.hypot(*(pose.levers[:, 1] - pose.levers[:, 0]).T)
    assert levers == pytest.approx(np.repeat([cell.lever for cell in chain.cells], 2), rel=1e-9)


@pytest.mark.slow
@given(chains, shares)
def test_the_outermost_block_moves_by_the_stroke(chain, share):
    linkage = ChainLayout(chain)
    travels = travels_of(chain, share)
    start = linkage.pose([0.0] * len(chain)).blocks[-1]
    now = linkage.pose(travels).blocks[-1]
    assert now[0] - start[0] == pytest.approx(math.fsum(travels), abs=1e-12)


@given(chains, shares)
def test_blocks_of_one_row_never_touch(chain, share):
    blocks = ChainLayout(chain).pose(travels_of(chain, share)).blocks
    for row in (blocks[0::2], blocks[1::2]):
        assert np.all(row[1:, 0] > row[:-1, 2])


def test_a_thicker_band_pulls_harder_and_a_dashed_one_is_slack():
    chain = files.preset("slack").cycle().chain
    figure = blank(100, 60)
    drawing = Drawing(place(figure, 0, 0, 100, 60), ChainLayout(chain), (0.0, 0.0), 1.0)
    for state in ((0.0, 0.0), (0.0, chain.cells[1].full_travel)):
        pose = drawing.move(state)
        width = np.asarray(drawing.bands.get_linewidth())
        assert np.argmax(width) == np.argmax(pose.tension)
    # The outer band of this preset goes slack on its way to state 1.
    assert list(pose.slack) == [False, True]
    assert pose.tension[1] == 0.0
    (_, taut), (_, dashes) = cast("list[Any]", drawing.bands.get_linestyle())
    assert taut is None
    assert dashes


def test_a_slack_band_is_explained_in_the_key():
    chain = files.preset("slack")
    figure = figures.mechanism(chain, ["00", "01"])
    assert "slack band" in legend_of(figure)
    taut = figures.mechanism(files.preset("paper-forward"), ["00", "11"])
    assert "slack band" not in legend_of(taut)


def test_states_are_named_with_their_stroke_and_joined_by_arrows():
    cycle = files.preset("paper-forward").cycle()
    figure = figures.mechanism(cycle.chain, cycle.sequence)
    said = says(figure)
    assert [text for text in said if text in {"00", "10", "11", "01"}] == list(cycle.sequence)
    strokes = [text for text in said if text.startswith("$u$")]
    assert strokes == [f"$u$ = {u} mm" for u in (0, 20, 40, 20, 0)]
    assert len(lines(figure, "arrow")) == 4
    assert {"inner", "outer"} <= set(said)


@pytest.mark.parametrize("name", ["balloon", "kresling"])
def test_states_of_elements_are_the_points_of_the_force_curve(name):
    cycle = files.preset(name).cycle()
    (dots,) = lines(figures.force_stroke(cycle), "states")
    stroke = words.stroke(cycle.chain.measure)
    shown = [stroke.value(x / stroke.factor) for x in points(dots)[:, 0]]
    figure = figures.mechanism(cycle.chain, cycle)
    said = says(figure)
    assert [text for text in said if text in shown] == shown
    assert [text for text in said if text in {*cycle.sequence}] == list(cycle.sequence)
    assert "state, middle of its range" in legend_of(figure)


def test_cells_in_equilibrium_have_their_marks_at_one_height():
    cycle = files.preset("balloon").cycle()
    path = cycle.path
    linkage = ChainLayout(cycle.chain, path.travel)
    for travel, sheet in zip(path.travel[::20], path.sheet[::20], strict=True):
        inner, outer = linkage.pose(travel, sheet.tolist()).dots[:, 1] / linkage.box
        assert inner == pytest.approx(outer, abs=0.01)


@pytest.mark.slow
def test_no_rounding_error_is_reported_as_a_stroke():
    cycle = files.preset("curved-beam").cycle()
    said = says(figures.mechanism(cycle.chain, cycle.sequence))
    assert said.count("$u$ = 0 mm") == 2
    assert not any("e\N{MINUS SIGN}" in text for text in said)


def test_the_scale_bar_is_as_long_as_it_says():
    figure = figures.mechanism(files.preset("paper-forward"), ["00"])
    (bar,) = lines(figure, "scale bar")
    page = np.ptp(points(bar)[:, 0])
    assert "10 mm" in says(figure)
    ax = figure.axes[0]
    (blocks,) = (c for c in ax.collections if isinstance(c, PolyCollection))
    drawn = np.ptp(np.asarray(blocks.get_paths()[0].vertices)[:, 0])
    linkage = ChainLayout(files.preset("paper-forward"))
    assert page / drawn == pytest.approx(0.010 / (2 * linkage.reach))


def test_travels_between_the_stops_can_be_drawn():
    chain = files.preset("paper-forward")
    said = says(figures.mechanism(chain, [(0.005, 0.0), (0.0175, 0.012)]))
    assert "$s$ = 5, 0 mm" in said
    assert "$u$ = 29.5 mm" in said


def test_columns_can_be_chosen():
    cycle = files.preset("paper-forward").cycle()
    tall = figures.mechanism(cycle.chain, cycle.sequence, columns=1)
    wide = figures.mechanism(cycle.chain, cycle.sequence, columns=3)
    assert tall.get_size_inches()[1] > 2 * wide.get_size_inches()[1]


def spread(count: int) -> Chain:
    return Chain(
        [Cell(Band((-0.010, 0.0), (0.001 + 0.021 * i / count, 0.0))) for i in range(count)]
    )


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, 2, 5, 12])
def test_arrows_point_the_way_that_the_stroke_goes(count):
    cycle = spread(count).cycle()
    figure = figures.mechanism(cycle.chain, cycle.sequence)
    ways = [np.sign(np.diff(points(arrow)[:, 0])[0]) for arrow in lines(figure, "arrow")]
    assert ways == [1.0] * count + [-1.0] * count
    # And each lies on that side of the state to which it leads.
    titles = [t.get_position() for t in figure.axes[0].texts if t.get_text() in cycle.sequence]
    for arrow, way, (x, y) in zip(lines(figure, "arrow"), ways, titles[1:], strict=True):
        assert np.sign(x - points(arrow)[:, 0].mean()) == way
        assert 0.0 < y - points(arrow)[0, 1] < 40.0


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, 2, 5, 12])
def test_a_page_holds_all_states_of_a_cycle(count):
    cycle = spread(count).cycle()
    figure = figures.mechanism(cycle.chain, cycle.sequence)
    wide, tall = 25.4 * figure.get_size_inches()
    assert wide == pytest.approx(180.0)
    assert tall <= 275.0
    assert untidy(figure, 7.0) == []


@pytest.mark.parametrize(
    ("states", "message"),
    [
        (["0"], "state '0': must be 2 characters"),
        (["0x"], "state '0x': must be 2 characters"),
        ([(0.0,)], "a state has 1 travels: must be 2"),
        ([], "states has 0 entries: must be 1 to 30"),
        (["00"] * 31, "states has 31 entries"),
        ([(0.0, 0.021)], "must be between 0 and 20 mm"),
    ],
)
def test_states_of_another_chain_are_refused(states, message):
    with pytest.raises(ValueError, match=message):
        figures.mechanism(files.preset("paper-forward"), states)


def test_a_chain_too_long_to_see_is_refused_with_advice():
    chain = Chain((Cell(Band((-0.010, 0.0), (0.010, 0.0))),) * 13)
    with pytest.raises(ValueError, match="13 cells: at most 12"):
        figures.mechanism(chain, ["0" * 13])
