"""The force plane: cells at their end forces, rows in the order of motion, the narrowest step."""

import numpy as np
import pytest
from matplotlib.text import Annotation

from facts import refuses
from figures.drawn import collisions, legend_of, lines, points, says, untidy
from figures.shapes import boxes
from sizes import cases
from stepwell import figures, files
from stepwell.mechanism import Band, Cell, Chain

WAVE = files.preset("three-wave")
SHUFFLE = files.preset("four-shuffle")
SIX = Chain([Cell(Band((-0.010, 0.0), (0.001 + 0.0035 * i, 0.001 * (i % 3)))) for i in range(6)])
OUTLINE = np.array([(-0.1, -0.37), (0.34, -0.97), (0.97, -0.34), (0.37, 0.1)])


def forces(chain: Chain) -> np.ndarray:
    return np.array([(cell.force_0, cell.force_1) for cell in chain.levers])


def cloud(chain: Chain, n: int = 400) -> np.ndarray:
    """Pairs as built: sheared, so that an upright ellipse would not do."""
    draws = np.random.default_rng(1).normal(size=(n, len(chain), 2))
    shear = np.array([[0.03, -0.02], [0.0, 0.02]])
    return forces(chain) + draws @ shear


@pytest.mark.slow
@pytest.mark.parametrize(
    "chain", cases([WAVE, SHUFFLE, SIX, files.preset("paper-forward")], [SHUFFLE, SIX])
)
def test_words_stay_apart_and_on_the_page(chain):
    figure = figures.force_plane(chain, region=[OUTLINE], clouds=cloud(chain))
    assert untidy(figure, 7.0) == []


def test_cells_stand_at_their_end_forces_in_newton():
    figure = figures.force_plane(WAVE)
    ax = figure.axes[0]
    drawn = np.concatenate([points(line) for line in lines(figure, "cells")])
    assert drawn == pytest.approx(forces(WAVE))
    assert ax.get_xlabel() == "$F_0$, at 0 [N]"
    assert ax.get_ylabel() == "$F_1$, at 1 [N]"
    # In the plane, in a row above it and in a column beside it.
    for name in WAVE.names:
        assert says(figure).count(name) == 3


@pytest.mark.slow
def test_friction_moves_both_forces_apart():
    chain = files.preset("friction")
    drawn = np.concatenate([points(line) for line in lines(figures.force_plane(chain), "cells")])
    rub = np.array([cell.friction for cell in chain.cells])
    assert drawn == pytest.approx(forces(chain) + np.column_stack([rub, -rub]))
    assert "+f" in figures.force_plane(chain).axes[0].get_xlabel()


def test_rows_are_the_order_of_loading_and_columns_that_of_unloading():
    cycle = SHUFFLE.cycle()
    _, above, right = figures.force_plane(SHUFFLE).axes
    rows = [label.get_text() for label in above.get_yticklabels()]
    columns = [label.get_text() for label in right.get_xticklabels()]
    assert rows == [SHUFFLE.names[i] for i in cycle.loading_order]
    assert columns == [SHUFFLE.names[i] for i in cycle.unloading_order]
    # A right order is a staircase.
    steps = np.concatenate(
        [points(line) for line in above.get_lines() if line.get_gid() == "order"]
    )
    assert np.all(np.diff(steps[:, 0]) > 0)
    assert above.yaxis_inverted()


@pytest.mark.slow
@pytest.mark.parametrize("chain", cases([WAVE, SHUFFLE, SIX], [SHUFFLE]))
def test_rows_and_columns_share_the_axes_of_the_plane(chain):
    ax, above, right = figures.force_plane(chain, clouds=cloud(chain)).axes
    assert above.get_xlim() == ax.get_xlim()
    assert right.get_ylim() == ax.get_ylim()


def test_the_narrowest_step_is_marked_and_reported():
    figure = figures.force_plane(SHUFFLE)
    cycle = SHUFFLE.cycle()
    f = forces(SHUFFLE)
    up, down = f[list(cycle.loading_order), 0], -f[list(cycle.unloading_order), 1]
    least = min(np.diff(up).min(), np.diff(down).min())
    assert f"smallest force gap {least:.3g} N" in legend_of(figure)
    (band,) = boxes(figure, "smallest force gap")
    assert min(band.get_width(), band.get_height()) == pytest.approx(least)


def test_an_order_that_the_chain_does_not_have_is_reported():
    figure = figures.force_plane(WAVE, loading=[1, 0, 2])
    gap = WAVE.cells[1].force_0 - WAVE.cells[0].force_0
    assert f"order violated by {gap:.3g} N" in legend_of(figure)


def test_ellipses_hold_most_of_their_cloud():
    built = cloud(WAVE, 4000)
    figure = figures.force_plane(WAVE, clouds=built)
    for i, outline in enumerate(lines(figure, "cloud")):
        around = points(outline)
        # Points on the outline are all as far from the middle, in its own measure.
        centre = around[:-1].mean(axis=0)
        spread = np.linalg.inv(np.cov((around[:-1] - centre).T))
        reach = np.max(np.einsum("ni,ij,nj->n", around - centre, spread, around - centre))
        far = np.einsum("ni,ij,nj->n", built[:, i] - centre, spread, built[:, i] - centre)
        assert np.mean(far <= reach) == pytest.approx(0.95, abs=0.01)


def test_mechanisms_that_cannot_be_built_are_left_out():
    built = cloud(WAVE)
    built[::7] = np.nan
    figure = figures.force_plane(WAVE, clouds=built)
    for outline in lines(figure, "cloud") + lines(figure, "spread"):
        assert np.isfinite(points(outline)).all()


def test_the_region_is_closed_and_single_places_are_dots():
    figure = figures.force_plane(WAVE, region=[OUTLINE])
    (edge,) = lines(figure, "region")
    assert points(edge) == pytest.approx(np.concatenate([OUTLINE, OUTLINE[:1]]))
    assert "feasible anchors" in legend_of(figure)
    dots = figures.force_plane(WAVE, places=OUTLINE)
    assert any(len(points(line)) == len(OUTLINE) for line in lines(dots, "places"))


def test_orders_and_chains_that_cannot_be_drawn_are_refused():
    with refuses(ValueError, "loading = [0, 0, 1]", "0..2", "once"):
        figures.force_plane(WAVE, loading=[0, 0, 1])
    with refuses(ValueError, "17 cells", "at most 16"):
        figures.force_plane(Chain([Cell(Band((-0.010, 0.0), (0.010, 0.0)))] * 17))


LABELLED = [(count, built) for count in (1, 2, 5, 12, 16) for built in (False, True)]


@pytest.mark.slow
@pytest.mark.parametrize(("count", "built"), cases(LABELLED, [(1, False), (5, True), (16, True)]))
def test_every_label_lies_at_its_own_dot(count, built):
    anchors = [(0.001 + 0.021 * i / count, 0.001 * (i * 5 % 3)) for i in range(count)]
    chain = Chain([Cell(Band((-0.010, 0.0), q)) for q in anchors])
    figure = figures.force_plane(chain, clouds=cloud(chain) if built else None)
    assert untidy(figure, 7.0) == []
    ax = figure.axes[0]
    spots = dict(zip(chain.names, ax.transData.transform(forces(chain)), strict=True))
    texts = [text for text in ax.texts if isinstance(text, Annotation)]
    led = {text.xy for text in texts if text.get_gid() == "leader"}
    dots = {str(points(line)[0]): line.get_color() for line in lines(figure, "cells")}
    labels = [text for text in texts if text.get_text()]
    assert sorted(text.get_text() for text in labels) == sorted(chain.names)
    for text in labels:
        box = text.get_window_extent()
        far = {
            name: np.hypot(*(spot - np.clip(spot, box.min, box.max)))
            for name, spot in spots.items()
        }
        own = text.get_text()
        # In the colour of its dot and its outline, and nearest to it or joined to it by a line.
        assert text.get_color() == dots[str(np.array(text.xy))]
        assert far[own] == min(far.values()) or text.xy in led, own


def test_one_cell_has_no_step():
    figure = figures.force_plane(files.preset("paper-cell-10-0"))
    assert legend_of(figure) == []
    assert collisions(figure) == []
