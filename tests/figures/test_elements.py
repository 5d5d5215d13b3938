"""Elements in figures: their curves, their symbols, and every figure of a chain that has some."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.patches import Rectangle
from PIL import Image

import stepwell as sw
from facts import refuses
from figures.drawn import legend_of, lines, marks, points, says, untidy
from figures.shapes import boxes, ends
from sizes import cases
from stepwell import figures
from stepwell.base import Measure
from stepwell.figures.common.style import LOADING, UNLOADING
from stepwell.mechanism.layout import ChainLayout, Symbol, rest_of
from stepwell.sequences import Cycle


def snapping(name: str, peak: float = 1.0, valley: float = -1.0, **how) -> sw.Element:
    """An open element of two phases, 0 to 4 mm and 12 to 20 mm."""
    travel, force = [0.0, 4e-3, 12e-3, 20e-3], [0.0, peak, valley, 1.5 * peak]
    return sw.Element.from_points(travel, force, name, **how)


def folded() -> sw.Element:
    """An element whose curve folds back: two sheets."""
    inside = np.linspace(0.0, 5e-3, 200)
    force = np.interp(inside, [0.0, 1e-3, 3e-3, 5e-3], [0.0, 1.0, -1.0, 1.5])
    return sw.Element.from_curve((inside + force / 400).tolist(), force.tolist(), "folded")


CELL = sw.preset("paper-forward").cells[0]
THREE = sw.Element.from_law(lambda s: np.sin(s * 1e3) + 50 * s, 0.0, 12e-3, "three")
HINGE = sw.Element.from_points(
    [0.0, 0.3, 0.9, 1.5], [0.0, 0.01, -0.01, 0.015], "hinge", measure=Measure.ANGLE
)
CHAINS = {
    "pair": sw.Chain([snapping("a"), snapping("b", 1.4, -0.6)]),
    "mixed": sw.Chain([CELL, snapping("dome", 0.8)]),
    "three": sw.Chain([THREE, snapping("x", 1.1)]),
    "folded": sw.Chain([folded(), snapping("x", 0.8)]),
    "balloons": sw.Chain([sw.elements.balloon(), sw.elements.balloon(thickness=3e-4, name="o")]),
    "hinges": sw.Chain([HINGE, replace(HINGE, force_scale=1.3, name="other")]),
}


@cache
def cycle_of(name: str) -> Cycle:
    """Several tests draw the same cycle."""
    return CHAINS[name].cycle()


# Levers too, three phases, a curve that folds back, another measure.
@pytest.mark.slow
@pytest.mark.parametrize("name", cases(CHAINS, ["mixed", "three", "folded", "hinges"]))
def test_no_word_covers_another_or_leaves_the_page(name):
    cycle = cycle_of(name)
    drawn = figures.standard(cycle) | {"overview": figures.overview(cycle)}
    assert "element_curves" in drawn
    for kind, figure in drawn.items():
        assert untidy(figure, 7.0) == [], kind


@pytest.mark.slow
@pytest.mark.parametrize("name", sw.elements.LIBRARY)
def test_curves_of_the_library_can_be_read(name):
    entry = sw.elements.LIBRARY[name]
    figure = figures.element_curve(entry.make(), source=entry.source)
    assert untidy(figure, 7.0) == []
    assert entry.source in says(figure)


def test_circles_stand_where_an_element_leaves_its_phases_friction_included():
    figure = figures.element_curve(replace(snapping("a", 1.0, -0.5), friction=0.1))
    up, down = lines(figure, "fields")
    assert points(up)[0] == pytest.approx([4.0, 1.1])
    assert points(down)[0] == pytest.approx([12.0, -0.6])
    assert (up.get_markeredgecolor(), down.get_markeredgecolor()) == (LOADING, UNLOADING)
    assert {"1.1 N", "\N{MINUS SIGN}0.6 N"} <= set(says(figure))
    assert "friction" in legend_of(figure)


def test_phases_are_shaded_and_numbered():
    ax = figures.element_curve(THREE).axes[0]
    shown = [ends(box) for box in boxes(ax, "phases")]
    inner = [edge for low_high in shown for edge in low_high][1:-1]
    expected = [edge * 1e3 for p in THREE.phases for edge in (p.low, p.high)][1:-1]
    assert inner == pytest.approx(expected)
    digits = [text.get_text() for text in ax.texts if text.get_gid() == "digit"]
    assert digits == ["0", "1", "2"]


def test_the_curve_is_the_elements_and_goes_on_dotted_past_open_ends_only():
    element = snapping("a", stops=(True, False))
    force, energy = figures.element_curve(element).axes
    for ax, law, factor in ((force, element.force_at, 1.0), (energy, element.energy_at, 1e3)):
        (curve,) = [line for line in ax.get_lines() if line.get_gid() == "curve"]
        x, y = points(curve).T
        assert y == pytest.approx(np.asarray(law(x * 1e-3)) * factor, abs=1e-9)
        (past,) = [line for line in ax.get_lines() if line.get_gid() == "extrapolated"]
        assert points(past)[0, 0] == pytest.approx(20.0)
        assert len(boxes(ax, "stop")) == 1


def test_jumps_of_a_curve_that_folds_back_lead_from_sheet_to_sheet():
    element = folded()
    figure = figures.element_curve(element)
    jumps = [points(line) for line in lines(figure, "jumps")]
    for jump, (start, sheet, other) in zip(
        sorted(jumps, key=lambda jump: -jump[0, 0]),
        ((element.laws[0].end, 0, 1), (element.laws[1].begin, 1, 0)),
        strict=True,
    ):
        assert jump[:, 0] == pytest.approx([start * 1e3] * 2)
        assert jump[:, 1] == pytest.approx([element.force_at(start, k) for k in (sheet, other)])


@pytest.mark.slow
def test_an_error_band_and_a_single_phase_are_shown_as_what_they_are():
    travel = np.linspace(0.0, 10e-3, 60)
    scatter = 0.05 * np.sin(37.0 * np.arange(60))
    force = 2 * np.sin(travel * 700) + 300 * travel + scatter
    noisy = sw.Element.from_table(travel.tolist(), force.tolist(), noise=0.04, stops=True)
    assert "error band" in legend_of(figures.element_curve(noisy))
    spring = sw.Element.from_points([0.0, 1e-3], [0.0, 1.0])
    assert legend_of(figures.element_curve(spring)) == ["phase", "extrapolated"]


@pytest.mark.slow
def test_other_measures_have_their_own_words_and_units():
    ax, below = figures.element_curve(sw.elements.balloon()).axes
    assert (ax.get_ylabel(), below.get_xlabel()) == ("Pressure $p$ [kPa]", "Volume $v$ [mL]")
    cycle = cycle_of("balloons")
    (ax,) = figures.force_stroke(cycle).axes
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("Volume $V$ [mL]", "Actuator pressure [kPa]")
    assert figures.landscape(cycle).axes[0].get_xlabel() == "Volume of balloon [mL]"
    (ax,) = figures.travel_stroke(cycle_of("hinges")).axes
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("Angle $Φ$ [deg]", "Angle $φ$ [deg]")
    assert "$V$ = 0 mL" in says(figures.mechanism(cycle.chain, ["00"]))


@pytest.mark.slow
def test_curves_can_be_drawn_into_axes_and_side_by_side():
    figure = figures.element_curves({"one": THREE, "other": folded()})
    assert {"one", "other"} <= set(says(figure))
    own = figures.element_curve(THREE)
    ax = own.axes[1]
    ax.clear()
    assert figures.element_curve(THREE, ax=ax) is own
    assert ax.get_ylabel() == "Force $F$ [N]"
    with pytest.raises(ValueError, match="elements is empty"):
        figures.element_curves({})


def test_an_element_has_no_lever_angle():
    with refuses(ValueError, "cells[1]", "an Element", "element_curve"):
        figures.unit_cell_force([CELL, THREE])


@pytest.mark.slow
def test_at_rest_a_phase_has_no_force_or_the_least_there_is():
    for element in (snapping("a"), THREE, folded(), *(e.make() for e in
                    sw.elements.LIBRARY.values())):  # fmt: skip
        for phase in element.phases:
            travel = rest_of(element, phase)
            force = float(element.force_at(travel, phase.sheet))
            least = max(phase.force_low, 0.0) if phase.force_low > 0 else min(phase.force_high, 0.0)
            assert phase.low <= travel <= phase.high
            if not (travel in (element.low, element.high) and any(element.stopped)):
                assert force == pytest.approx(least, abs=1e-9 * element.largest_force)


def test_an_open_end_rests_past_the_curve_where_the_force_would_be_zero():
    element = sw.Element.from_points([1e-3, 2e-3], [1.0, 2.0])
    assert rest_of(element, element.phases[0]) == pytest.approx(0.0, abs=1e-15)
    below = sw.Element.from_points([0.0, 1e-3], [-2.0, -1.0])
    assert rest_of(below, below.phases[0]) == pytest.approx(2e-3)
    held = sw.Element.from_points([0.0, 1e-3], [1.0, 2.0], stops=True)
    assert rest_of(held, held.phases[0]) == 0.0


@pytest.mark.parametrize("name", CHAINS)
def test_the_outermost_block_moves_by_the_stroke(name):
    chain = CHAINS[name]
    linkage = ChainLayout(chain)
    start, end = ([getattr(cell, side) for cell in chain.cells] for side in ("low", "high"))
    moved = linkage.pose(end).blocks[-1] - linkage.pose(start).blocks[-1]
    assert moved[0] == pytest.approx(linkage.unit * (math.fsum(end) - math.fsum(start)))
    blocks, symbols = linkage.pose(start).blocks, linkage.pose(start).boxes
    assert len(symbols) == len(chain.elements)
    assert linkage.unit == 1.0 or len(chain.elements) == len(chain)
    for left, _, right, _ in symbols:
        assert not np.any((blocks[:, 0] < right) & (blocks[:, 2] > left) & (blocks[:, 0] > left))


def test_the_mark_in_a_symbol_lies_on_its_curve():
    for element in (snapping("a"), folded()):
        symbol = Symbol(element)
        for sheet, curve in enumerate(symbol.curves):
            law = element.laws[sheet]
            for travel in np.linspace(law.begin, law.end, 7):
                x, y = symbol.at(travel, sheet)
                assert y == pytest.approx(np.interp(x, *curve.T), abs=2e-3)


def test_states_of_elements_are_named_by_their_phases():
    chain = CHAINS["three"]
    assert "21" in says(figures.mechanism(chain, ["00", "21"]))
    with refuses(ValueError, "'31'", "2 characters", "0 to 2"):
        figures.mechanism(chain, ["31"])
    # Without levers nothing has a length to compare with.
    assert not lines(figures.mechanism(chain, ["00"]), "scale bar")
    assert lines(figures.mechanism(CHAINS["mixed"], ["00"]), "scale bar")


@pytest.mark.slow
@pytest.mark.parametrize("name", CHAINS)
def test_snaps_and_states_of_the_cycle_are_in_its_figures(name):
    cycle = cycle_of(name)
    figure = figures.force_stroke(cycle)
    assert marks(figure, "snap starts") == len(cycle.snaps)
    assert set(cycle.sequence) <= set(says(figure))
    drawn = marks(figures.travel_stroke(cycle), "snap starts")
    assert drawn == sum(len(event.cells) for event in cycle.snaps)


def test_lanes_shade_the_phases_of_elements_and_reach_as_far_as_they_went():
    path = cycle_of("mixed").path
    (ax,) = figures.travel_stroke(path).axes
    shades = [box for box in ax.patches if box.get_gid() == "phases"]
    assert len(shades) == 2
    low, high = path.travel[:, 1].min() * 1e3, path.travel[:, 1].max() * 1e3
    assert low < 0.0
    heights = [shade.get_height() for shade in shades if isinstance(shade, Rectangle)]
    assert heights == pytest.approx([4.0 - low, max(high, 20.0) - 12.0])


def test_a_landscape_frames_the_states_and_numbers_the_phases():
    figure = figures.landscape(cycle_of("three"))
    frames = [points(line) for line in lines(figure, "states")]
    assert len(frames) == 6
    digits = [text.get_text() for text in figure.axes[0].texts if text.get_gid() == "digit"]
    assert digits == ["0", "1", "2", "0", "1"]


def test_energy_where_a_curve_folds_back_is_the_least():
    from stepwell.figures.motion.overview import _energy

    element = folded()
    travel = np.linspace(element.low, element.high, 101)
    both = np.full((2, 101), np.inf)
    for sheet, law in enumerate(element.laws):
        here = (travel >= law.begin) & (travel <= law.end)
        both[sheet, here] = element.energy_at(travel[here], sheet)
    assert _energy(element, travel) == pytest.approx(both.min(axis=0))


def test_the_plane_of_forces_has_a_point_for_each_switch_of_an_element():
    chain = CHAINS["three"]
    figure = figures.force_plane(chain)
    cells = np.concatenate([points(line) for line in lines(figure, "cells")])
    expected = [pair for element in chain.elements for pair in element.fields]
    assert cells == pytest.approx(np.array(expected))
    assert {"three 0>1", "three 1>2", "x"} <= set(says(figure))
    assert untidy(figure) == []
    balloons = figures.force_plane(CHAINS["balloons"]).axes[0]
    assert balloons.get_xlabel() == "Pressure up to the next phase [kPa]"
    spring = sw.Chain([sw.Element.from_points([0.0, 1e-3], [0.0, 1.0])])
    with refuses(ValueError, "two phases", "bistable"):
        figures.force_plane(spring)


@pytest.mark.parametrize("name", cases(["mixed", "three", "folded"], ["three", "folded"]))
def test_states_of_a_graph_stand_by_the_sum_of_their_digits(name):
    graph = CHAINS[name].graph()
    figure = figures.transition_graph(graph)
    assert untidy(figure) == []
    texts = {text.get_text(): text for ax in figure.axes for text in ax.texts}
    columns: dict[int, set[float]] = {}
    for label in graph.vertices:
        columns.setdefault(sum(map(int, label)), set()).add(round(texts[label].get_position()[0]))
    assert all(len(places) == 1 for places in columns.values())
    order = [min(columns[k]) for k in sorted(columns)]
    assert order == sorted(order)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["mixed", "three"])
def test_a_program_shows_its_states_and_the_travels_of_elements(name):
    chain = CHAINS[name]
    program = chain.program(chain.last_state)
    figure = figures.stroke_program(program)
    assert untidy(figure) == []
    assert chain.last_state in says(figure)
    assert figure.axes[1].get_ylabel() == "Travel $s$ [mm]"


@pytest.mark.slow
def test_elements_move_in_a_gif_and_keep_their_colours(tmp_path):
    cycle = cycle_of("folded")
    file = figures.animation(cycle, tmp_path / "a.gif", seconds=1, fps=4)
    with Image.open(file) as movie:
        assert getattr(movie, "n_frames", 1) == 4
        colours = movie.convert("RGB").getcolors(1 << 20) or []
    wanted = np.array([int(to_hex("#009E73")[k : k + 2], 16) for k in (1, 3, 5)])
    assert min(np.abs(np.array(rgb) - wanted).max() for _, rgb in colours) < 12


def test_elements_that_are_compared_share_their_force_axis_unless_one_would_be_flat():
    beam = sw.elements.curved_beam()
    alike = figures.element_curves({"one": beam, "two": replace(beam, force_scale=2.0)})
    assert len({ax.get_ylim() for ax in alike.axes}) == 1
    far = figures.element_curves({"one": beam, "two": replace(beam, force_scale=100.0)})
    assert len({ax.get_ylim() for ax in far.axes}) == 2
