"""Force, travel and landscape figures show the values of the engine."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from matplotlib.text import Annotation

from facts import refuses
from figures.drawn import PRESETS, legend_of, line_of, lines, marks, points, says, untidy
from sizes import cases
from stepwell import figures, files
from stepwell.figures.common.style import LOADING, UNLOADING
from stepwell.mechanism import Band, Cell, Chain
from stepwell.sequences import Cycle


@cache
def cycle_of(name: str) -> Cycle:
    """Several tests draw the same cycle."""
    return files.preset(name).cycle()


@pytest.mark.slow
@pytest.mark.parametrize("name", PRESETS)
def test_every_snap_of_the_cycle_is_marked(name):
    cycle = cycle_of(name)
    assert marks(figures.force_stroke(cycle), "snap starts") == len(cycle.snaps)
    if len(cycle.chain) == 2:
        assert marks(figures.landscape(cycle), "snap starts") == len(cycle.snaps)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["paper-forward", "three-wave", "four-shuffle"])
def test_a_snap_is_marked_in_the_lane_of_every_cell_that_moves_in_it(name):
    cycle = cycle_of(name)
    drawn = marks(figures.travel_stroke(cycle), "snap starts")
    assert drawn == sum(len(event.cells) for event in cycle.snaps)


def test_snaps_stand_where_the_events_say():
    cycle = cycle_of("paper-forward")
    figure = figures.force_stroke(cycle)
    starts = np.concatenate([points(line) for line in lines(figure, "snap starts")])
    expected = [(event.stroke * 1e3, event.force_before) for event in cycle.snaps]
    assert starts == pytest.approx(np.array(expected), abs=1e-9)


def test_snaps_run_along_lines_of_equal_stroke_under_a_rigid_actuator():
    cycle = cycle_of("paper-forward")
    for line in lines(figures.landscape(cycle), "snaps"):
        # Start, end, gap for every snap.
        stroke = points(line).sum(axis=1).reshape(-1, 3)
        assert stroke[:, 0] == pytest.approx(stroke[:, 1], abs=1e-9)


def test_force_curves_are_the_path():
    path = cycle_of("paper-forward").path
    (ax,) = figures.force_stroke(path).axes
    for direction, colour in ((1, LOADING), (-1, UNLOADING)):
        drawn = line_of(ax, colour)
        mine = path.direction == direction
        expected = np.column_stack([path.stroke[mine] * 1e3, path.force[mine]])
        # A turning point is drawn in both colours.
        assert len(expected) <= len(drawn) <= len(expected) + 1
        assert drawn[-len(expected) :] == pytest.approx(expected, abs=1e-12)


def test_force_axes_say_newton_against_millimetre():
    (ax,) = figures.force_stroke(cycle_of("paper-forward")).axes
    assert ax.get_xlabel() == "Stroke $u$ [mm]"
    assert ax.get_ylabel() == "Actuator force [N]"


def test_force_figure_names_every_state_of_the_sequence():
    cycle = cycle_of("four-shuffle")
    assert set(cycle.sequence) <= set(says(figures.force_stroke(cycle)))


@pytest.mark.slow
@pytest.mark.parametrize("draw", [figures.force_stroke, figures.landscape, figures.travel_stroke])
def test_the_legend_lists_what_there_is_and_nothing_else(draw):
    snapping = cycle_of("paper-forward")
    assert legend_of(draw(snapping)) == ["loading", "unloading", "snap"]
    smooth = cycle_of("paper-via-10")
    assert legend_of(draw(smooth)) == ["loading", "unloading"]
    half = snapping.chain.path([0.0, 0.010])
    assert legend_of(draw(half)) == ["loading"]


@pytest.mark.parametrize("draw", [figures.force_stroke, figures.landscape, figures.travel_stroke])
def test_partial_strokes_are_drawn_too(draw):
    path = files.preset("paper-forward").path([0.0, 0.038, 0.010, 0.030, 0.0])
    figure = draw(path)
    assert marks(figure, "snap starts") >= int(path.snap_after.sum()) > 0


def test_each_cell_has_a_lane_innermost_on_top():
    cycle = cycle_of("three-wave")
    (ax,) = figures.travel_stroke(cycle).axes
    names = list(cycle.chain.names)
    placed = {
        t.get_text(): t.xy[1]
        for t in ax.texts
        if isinstance(t, Annotation) and t.get_text() in names
    }
    assert sorted(placed, key=lambda name: -placed[name]) == names
    assert ax.get_ylabel() == "Travel $s$ [mm]"


@pytest.mark.slow
@pytest.mark.parametrize("count", cases([1, 2, 5, 12, 20], [5, 20]))
def test_legend_and_lanes_stay_on_the_page(count):
    cells = [Cell(Band((-0.010, 0.0), (0.001 + 0.021 * i / count, 0.0))) for i in range(count)]
    figure = figures.travel_stroke(Chain(cells).cycle())
    assert untidy(figure, 7.0) == []


def test_lanes_show_the_travel_of_their_cell():
    path = cycle_of("paper-forward").path
    (ax,) = figures.travel_stroke(path).axes
    loading = [line for line in ax.get_lines() if line.get_color() == LOADING]
    loading = [line for line in loading if line.get_gid() is None]
    assert len(loading) == 2
    for i, line in enumerate(loading):
        y = points(line)[:, 1]
        rise = y[np.isfinite(y)] - np.nanmin(y)
        mine = path.travel[path.direction > 0, i] * 1e3
        assert rise[: len(mine)] == pytest.approx(mine, abs=1e-9)


def test_more_lanes_than_can_be_distinguished_are_refused():
    cells = (Cell(Band((-0.010, 0.0), (0.010, 0.0))),) * 61
    path = Chain(cells).path([0.0])
    with refuses(ValueError, "61 cells", "at most 60"):
        figures.travel_stroke(path)


@pytest.mark.slow
def test_landscape_is_the_energy_of_both_cells():
    cycle = cycle_of("paper-forward")
    figure = figures.landscape(cycle)
    ax, bar = figure.axes
    assert ax.get_xlabel() == "Travel of inner [mm]"
    assert ax.get_ylabel() == "Travel of outer [mm]"
    assert bar.get_ylabel() == "Energy [mJ]"
    cells = [cell for cell in cycle.chain.cells if isinstance(cell, Cell)]
    assert len(cells) == 2
    highest = sum(cell.energy(cell.peak_angle) for cell in cells) * 1e3
    lowest = float(cycle.path.energy.min()) * 1e3
    low, high = bar.get_ylim()
    step = (high - low) / 10
    assert low <= lowest < low + step
    assert high - step < highest <= high


def test_landscape_path_keeps_to_the_travels():
    path = cycle_of("paper-backward").path
    ax = figures.landscape(path).axes[0]
    drawn = line_of(ax, UNLOADING)
    mine = path.travel[path.direction < 0] * 1e3
    assert drawn[-len(mine) :] == pytest.approx(mine, abs=1e-12)
    assert {"00", "01", "10", "11"} <= {text.get_text() for text in ax.texts}


def test_landscape_refuses_a_chain_it_cannot_show():
    with refuses(ValueError, "3 cells", "exactly 2", "force_stroke", "travel_stroke"):
        figures.landscape(cycle_of("three-wave"))


def test_loading_stays_visible_under_unloading_where_both_go_the_same_way():
    for draw in (figures.force_stroke, figures.landscape):
        ax = draw(cycle_of("paper-via-10")).axes[0]
        width = {
            line.get_color(): line.get_linewidth()
            for line in ax.get_lines()
            if line.get_gid() is None
        }
        assert width[LOADING] > 1.5 * width[UNLOADING]


def test_names_of_many_cells_are_text_too():
    cell = files.preset("paper-cell-10-0").cells[0]
    chain = Chain([replace(cell, name=f"${k}$") for k in range(13)])
    (ax,) = figures.travel_stroke(chain.path([0.0, 0.001])).axes
    assert [label.get_text() for label in ax.get_yticklabels()][:2] == [r"\$0\$", r"\$1\$"]


@pytest.mark.slow
@pytest.mark.parametrize("draw", [figures.overview, figures.travel_stroke])
def test_names_of_a_dozen_lanes_stand_between_them(draw):
    cells = [Cell(Band((-0.010, 0.0), (0.004 + 0.001 * i, 0.001 * (i % 3)))) for i in range(12)]
    cycle = Chain(tuple(cells)).cycle()
    figure = draw(cycle)
    figure.draw_without_rendering()
    (ax,) = (ax for ax in figure.axes if ax.get_ylabel().startswith("Travel"))
    names = [text for text in ax.texts if text.get_text().startswith("cell ")]
    ticks = [ax.transData.transform((0.0, y))[1] for y in sorted(ax.get_yticks())]
    assert len(names) == 12
    for name in names:
        box = name.get_window_extent()
        assert not any(box.y0 <= tick <= box.y1 for tick in ticks), name
