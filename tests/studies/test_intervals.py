"""Intervals of outcomes along one parameter: those of the designs, with exact boundaries."""

from functools import partial
from itertools import pairwise

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.patches import Rectangle

import stepwell as sw
from facts import refuses
from figures.drawn import untidy
from stepwell import figures
from stepwell.accounts import account
from stepwell.design import parameter
from stepwell.figures.common.style import PATHWAY
from stepwell.mechanism import Chain
from stepwell.studies import Axis, How, Space, Study, intervals, status, sweep

LEG, BEAMS = sw.preset("paper-forward"), sw.preset("curved-beam")
assert isinstance(LEG, Chain)
assert isinstance(BEAMS, Chain)


def swept(chain: Chain, folder, *axes: Axis, **how) -> Study:
    return sweep(chain, "cycle", Space(axes, **how), folder / "s.zarr", workers=0).study


@pytest.fixture(scope="module")
def anchors(tmp_path_factory) -> Study:
    """The outer anchor moves along the stroke, at random places."""
    axis = Axis("outer.q.y", -0.015, 0.015)
    folder = tmp_path_factory.mktemp("anchors")
    return swept(LEG, folder, axis, how=How.RANDOM, count=40, seed=1)


@pytest.fixture(scope="module")
def beams(tmp_path_factory) -> Study:
    """The thin beam becomes the strongest of the three."""
    axis = Axis("thin.force_scale", 0.8, 3.0, 12)
    return swept(BEAMS, tmp_path_factory.mktemp("beams"), axis)


@pytest.mark.parametrize("name", ["anchors", "beams"])
def test_every_design_is_in_the_interval_of_its_outcome(name, request):
    study = request.getfixturevalue(name)
    (axis,) = study.varied
    _, factor = study.display_unit(axis)
    runs = intervals(study)
    words, along = study.values("sequence"), study.values(axis) * factor
    assert len(runs) > 1
    assert sum(run.designs for run in runs) == sum(words != "")
    for run in runs:
        inside = (along >= run.first) & (along <= run.last) & (words != "")
        assert set(words[inside]) == {run.value}
        assert sum(inside) == run.designs
    assert all(a.last < b.first and a.value != b.value for a, b in pairwise(runs))


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [("outer.q.y", -0.015, 0.015), ("inner.stiffness", 15.0, 60.0), ("outer.q.x", 0.001, 0.02)],
)
def test_the_sequence_changes_exactly_at_a_boundary(tmp_path, name, low, high):
    study = swept(LEG, tmp_path, Axis(name, low, high, 9))
    _, factor = study.display_unit(name)
    runs = intervals(study)
    assert len(runs) > 1
    one = parameter(LEG, name)
    for below, above in pairwise(runs):
        assert below.high == above.low
        assert below.high is not None
        assert below.last <= below.high <= above.first
        at, step = below.high / factor, 1e-7 * (high - low)
        for value, run in ((at - step, below), (at + step, above)):
            assert str(one.changed(LEG, value).cycle().sequence) == run.value


def test_a_boundary_of_elements_lies_between_two_designs(beams):
    runs = intervals(beams)
    assert {end for run in runs for end in (run.low, run.high)} == {None}


def test_two_parameters_have_no_intervals(tmp_path):
    axes = Axis("outer.q.x", 0.0, 0.020, 3), Axis("outer.q.y", -0.015, 0.015, 3)
    assert intervals(swept(LEG, tmp_path, *axes)) == ()


def test_the_record_has_the_intervals_in_their_unit(anchors):
    rows = account(status(anchors)).record["intervals"]
    assert [row["value"] for row in rows] == [run.value for run in intervals(anchors)]
    assert {row["unit"] for row in rows} == {"mm"}
    assert [row["boundary_above"] for row in rows[:-1]] == [
        row["boundary_below"] for row in rows[1:]
    ]


def rectangles(ax: Axes, kind: str) -> list[Rectangle]:
    return [one for one in ax.patches if isinstance(one, Rectangle) and one.get_gid() == kind]


def bars(study: Study) -> list[tuple[float, float, str]]:
    """Begin, end and colour of the bars of a strip."""
    return [
        (one.get_x(), one.get_x() + one.get_width(), to_hex(one.get_facecolor()).upper())
        for one in rectangles(figures.outcomes(study).axes[0], "interval")
    ]


def test_a_strip_has_a_bar_for_each_interval_up_to_its_exact_boundaries(anchors):
    runs = sorted(intervals(anchors), key=lambda run: run.first)
    drawn = sorted(bars(anchors))
    for (begin, end, colour), run in zip(drawn, runs, strict=True):
        assert begin == pytest.approx(run.first if run.low is None else run.low)
        assert end == pytest.approx(run.last if run.high is None else run.high)
        assert colour == PATHWAY[run.value].upper()
    ax = figures.outcomes(anchors).axes[0]
    lines = [line for line in ax.lines if line.get_gid() == "exact boundary"]
    at = sorted(float(np.asarray(line.get_xdata())[0]) for line in lines)
    assert at == pytest.approx([run.high for run in runs[:-1]])


def test_a_strip_without_exact_boundaries_is_grey_between_two_designs(beams):
    ax = figures.outcomes(beams).axes[0]
    grey = rectangles(ax, "between designs")
    spans = sorted((one.get_x(), one.get_x() + one.get_width()) for one in grey)
    gaps = [(a.last, b.first) for a, b in pairwise(intervals(beams))]
    assert np.array(spans) == pytest.approx(np.array(gaps))


@pytest.mark.parametrize("width", [85.0, 180.0])
@pytest.mark.parametrize("name", ["anchors", "beams"])
def test_a_strip_names_every_outcome_and_is_legible(name, width, request):
    study = request.getfixturevalue(name)
    figure = figures.compose([partial(figures.outcomes, study)], width=width)
    assert untidy(figure) == []
    assert figure.get_size_inches()[1] * 25.4 <= sw.reports.TALLEST
    texts = [text.get_text() for text in figure.subfigs[0].axes[0].texts]
    for run in intervals(study):
        assert any(text.startswith(run.value) for text in texts)


def test_the_names_of_a_strip_cross_no_exact_boundary_and_counts_have_whole_ticks(anchors):
    figure = figures.outcomes(anchors)
    figure.draw_without_rendering()
    ax, counts = figure.axes[:2]
    lines = [line for line in ax.lines if line.get_gid() == "exact boundary"]
    names = [text for text in ax.texts if text.get_gid() == "outcome"]
    assert lines and names
    for text in names:
        box = text.get_window_extent()
        for line in lines:
            x = ax.transData.transform((np.asarray(line.get_xdata())[0], 0.0))[0]
            assert not box.x0 - 1.0 < x < box.x1 + 1.0, text.get_text()
    assert counts.get_ylabel() == "Snaps"
    assert all(tick % 1 == 0 for tick in counts.get_yticks())


def test_chosen_results_of_a_study_have_their_own_figure(anchors):
    (strip,) = figures.outcomes(anchors, columns=["sequence"]).axes
    assert rectangles(strip, "interval")
    with refuses(ValueError, "'slips'", "sequence, snaps"):
        figures.outcomes(anchors, columns=["slips"])
