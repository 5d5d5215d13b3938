"""Force and energy of single cells, as in the paper's Figs. 1D and 1E."""

import numpy as np
import pytest

from figures.drawn import legend_of, lines, points, untidy
from stepwell import figures
from stepwell.mechanism import Band, Cell

# Kamp et al. 2024, the six designs of Fig. 1, and F0/(kr), F1/(kr) of each.
PAPER = {
    (10, 0): (0.967, -0.967),
    (0, 0): (0.391, -0.391),
    (20, 0): (1.607, -1.607),
    (10, -15): (0.263, -1.661),
    (20, 15): (2.393, -0.836),
    (0, -15): (-0.243, -0.910),
}
CELLS = [Cell(Band((-0.010, 0.0), (x * 1e-3, y * 1e-3))) for x, y in PAPER]


def test_marks_stand_at_the_papers_f0_and_f1():
    figure = figures.unit_cell_force(CELLS)
    for gid, column, side in (("end <", 0, -45.0), ("end >", 1, 45.0)):
        drawn = np.concatenate([points(line) for line in lines(figure, gid)])
        expected = [(side, forces[column]) for forces in PAPER.values()]
        assert drawn == pytest.approx(np.array(expected), abs=1e-3)


@pytest.mark.slow
def test_only_bistable_cells_have_their_peak_marked():
    for draw in (figures.unit_cell_force, figures.unit_cell_energy):
        assert len(lines(draw(CELLS), "peak")) == sum(cell.is_bistable for cell in CELLS) == 5


def test_the_peak_is_where_the_force_is_zero_and_the_energy_highest():
    for line in lines(figures.unit_cell_force(CELLS), "peak"):
        assert points(line)[0, 1] == pytest.approx(0.0, abs=1e-9)
    figure = figures.unit_cell_energy(CELLS)
    curves = {line.get_color(): line for line in figure.axes[0].get_lines() if not line.get_gid()}
    for line in lines(figure, "peak"):
        curve = points(curves[line.get_markeredgecolor()])[:, 1]
        assert 0 <= points(line)[0, 1] - curve.max() < 1e-3


def test_energy_is_scaled_by_k_r_squared():
    cell = CELLS[0]
    (curve,) = (x for x in figures.unit_cell_energy([cell]).axes[0].get_lines() if not x.get_gid())
    degrees, energy = points(curve).T
    theta = np.radians(degrees)
    expected = cell.energy(np.clip(theta, -cell.limit, cell.limit)) / (28.5 * cell.lever**2)
    assert energy == pytest.approx(expected, rel=1e-9)


def test_axes_and_legend_speak_the_papers_language():
    figure = figures.unit_cell_force(CELLS)
    (ax,) = figure.axes
    assert ax.get_xlabel() == "Lever angle $\\theta$ [°]"
    assert ax.get_ylabel() == "Force $F/(kr)$"
    assert "$q$ = (10, \N{MINUS SIGN}15) mm" in legend_of(figure)
    assert figures.unit_cell_energy(CELLS).axes[0].get_ylabel() == "Energy $E/(kr^2)$"


def test_cells_are_called_by_their_name_or_by_what_tells_them_apart():
    named = Cell(Band((-0.010, 0.0), (0.010, 0.0)), name="stiff")
    moved = Cell(Band((-0.007, 0.0), (0.010, 0.0)))
    assert legend_of(figures.unit_cell_force([named, moved]))[-2:] == ["stiff", "$d$ = (17, 0) mm"]


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, 2, 6])
def test_words_stay_apart(count):
    for draw in (figures.unit_cell_force, figures.unit_cell_energy):
        figure = draw(CELLS[:count])
        assert untidy(figure) == []


def test_no_cells_are_refused():
    with pytest.raises(ValueError, match="cells is empty"):
        figures.unit_cell_force([])
