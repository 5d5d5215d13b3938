"""What every figure keeps to: readable words, one meaning a colour, no global state."""

import subprocess
import sys
from functools import cache

import matplotlib as mpl
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from figures.drawn import PRESETS, cut_off, says, untidy
from sizes import SIZE, cases
from stepwell import figures, files
from stepwell.mechanism import Band, Cell, Chain
from stepwell.sequences import Cycle

# One of two cells, one of three, one behind a spring.
QUICK = ("paper-forward", "three-wave", "compliant-actuator")
OF_A_PATH = (figures.force_stroke, figures.travel_stroke, figures.landscape)


@cache
def cycle_of(name: str) -> Cycle:
    """Several tests draw the same cycle."""
    return files.preset(name).cycle()


@cache
def standard_of(name: str) -> dict[str, Figure]:
    """Several tests look at the same figures."""
    return figures.standard(cycle_of(name))


@cache
def overview_of(name: str) -> Figure:
    """Several tests look at the same overview."""
    return figures.overview(cycle_of(name))


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[pytest.mark.slow] * (name != "paper-forward")) for name in PRESETS],
)
def test_no_word_covers_another_or_leaves_the_page(name):
    drawn = {"overview": overview_of(name)}
    if name in QUICK or SIZE == "full":
        # What the overview holds, each by itself.
        drawn |= standard_of(name)
    for kind, figure in drawn.items():
        assert untidy(figure, 7.0 if name == "paper-forward" else 0.0) == [], kind


def test_words_on_each_other_off_the_page_or_too_small_are_seen():
    figure = Figure()
    assert untidy(figure) == []
    for x, word in ((0.5, "one"), (0.5, "other"), (0.99, "far out")):
        figure.text(x, 0.5, word, fontsize=9 if word != "other" else 5)
    assert untidy(figure, 7.0) == [
        "one covers other",
        "far out leaves the page",
        "other is too small",
    ]


@pytest.mark.slow
def test_words_stay_apart_in_longer_chains_too():
    cells = [Cell(Band((-0.010, 0.0), (0.004 + 0.002 * i, 0.001 * (i % 3)))) for i in range(6)]
    cycle = Chain(tuple(cells)).cycle()
    for figure in figures.standard(cycle).values():
        assert untidy(figure) == []


def test_every_axis_with_a_dimension_names_its_unit():
    drawn = [
        standard_of("paper-forward")[kind]
        for kind in ("force_stroke", "travel_stroke", "landscape")
    ]
    drawn.append(overview_of("paper-forward"))
    units = ("[mm]", "[N]", "[mJ]")
    for figure in drawn:
        for ax in figure.axes:
            if ax.axison:
                names = [ax.get_xlabel(), ax.get_ylabel()]
                assert all(name.endswith(units) for name in names if name)
                assert any(names)


def test_figures_fit_the_columns_of_a_journal_page():
    drawn = standard_of("paper-forward")
    widths = {name: 25.4 * figure.get_size_inches()[0] for name, figure in drawn.items()}
    assert widths == pytest.approx(
        {"mechanism": 180.0, "landscape": 85.0, "force_stroke": 85.0, "travel_stroke": 85.0}
    )


@pytest.mark.slow
def test_drawing_leaves_the_settings_of_matplotlib_alone(tmp_path):
    cycle = cycle_of("paper-forward")
    before = dict(mpl.rcParams)
    for figure in figures.standard(cycle).values():
        figures.svg(figure)
    figures.unit_cell_force(cycle.chain.cells)
    figures.unit_cell_energy(cycle.chain.cells)
    figures.animation(cycle, tmp_path / "cycle.gif", seconds=0.5, fps=4)
    assert dict(mpl.rcParams) == before


@pytest.mark.slow
def test_settings_of_the_user_do_not_change_the_figures():
    cycle = cycle_of("paper-forward")
    plain = figures.svg(figures.force_stroke(cycle))
    with mpl.rc_context({"font.size": 20, "lines.linewidth": 9, "axes.grid": True}):
        assert figures.svg(figures.force_stroke(cycle)) == plain


@pytest.mark.parametrize("draw", OF_A_PATH)
def test_given_axes_are_drawn_into(draw):
    cycle = cycle_of("paper-forward")
    figure = Figure()
    left, right = figure.subplots(1, 2)
    assert draw(cycle, ax=right) is figure
    assert right.has_data()
    assert not left.has_data()
    assert len(figure.axes) == 2


def test_axes_of_a_subfigure_give_the_whole_figure():
    figure = Figure()
    ax = figure.add_subfigure(figure.add_gridspec(1, 2)[1]).subplots()
    assert figures.force_stroke(cycle_of("paper-forward"), ax=ax) is figure


def test_axes_without_a_figure_are_refused_with_advice():
    figure = Figure()
    ax: Axes = figure.subplots()
    ax.remove()
    with pytest.raises(ValueError, match="make it with figure"):
        figures.force_stroke(cycle_of("paper-forward"), ax=ax)


@pytest.mark.slow
def test_no_figure_needs_pyplot():
    script = (
        "import sys; from stepwell import figures, files;"
        "cycle = files.preset('paper-forward').cycle();"
        "[figures.svg(f) for f in figures.standard(cycle).values()];"
        "sys.exit('matplotlib.pyplot' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == 0


@pytest.mark.slow
def test_a_chain_of_one_cell_has_every_figure_but_the_landscape():
    name = "paper-cell-0-m15"
    assert list(standard_of(name)) == ["mechanism", "force_stroke", "travel_stroke"]
    assert "1" in says(overview_of(name))


@pytest.mark.slow
@pytest.mark.parametrize("count", cases([1, 2, 5, 12], [5, 12]))
def test_an_overview_can_be_read_with_any_number_of_cells(count):
    anchors = [0.001 + 0.021 * i / count for i in range(count)]
    cycle = Chain([Cell(Band((-0.010, 0.0), (q, 0.0))) for q in anchors]).cycle()
    figure = figures.overview(cycle)
    assert untidy(figure, 7.0) == []
    # The force loop is not drawn out to a row of lines.
    loop = figure.axes[-1].get_window_extent()
    assert loop.height <= 1.05 * loop.width


@pytest.mark.slow
def test_a_chain_too_long_to_draw_keeps_the_figures_that_can_be_read():
    cells = [Cell(Band((-0.010, 0.0), (0.004 + 0.0005 * i, 0.0))) for i in range(13)]
    cycle = Chain(tuple(cells)).cycle()
    assert list(figures.standard(cycle)) == ["force_stroke", "travel_stroke"]
    assert cut_off(figures.overview(cycle)) == []
