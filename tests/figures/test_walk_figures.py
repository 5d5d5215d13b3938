"""Gait, trajectory and contacts of a walk: its numbers, whole or cut short."""

import itertools
import math
import warnings
from functools import cache, partial

import numpy as np
import pytest

from figures.drawn import legend_of, lines, points, says, untidy, untidy_on_a_phone
from figures.robots import cut, explorer, four_legs, three_cells, walker
from figures.shapes import boxes, ends, strips
from sizes import cases
from stepwell import figures
from stepwell.figures.robots.walks import (
    BACKWARD,
    FORWARD,
    LEFT,
    RIGHT,
    _cell_looks,
    direction,
    motions,
)
from stepwell.simulation import walk

DRAWINGS = (figures.gait, figures.trajectory, figures.contacts)


@pytest.fixture(scope="module")
def forward():
    return walk(walker(title="forward"), 3)


@pytest.fixture(scope="module")
def turning():
    return walk(walker(0.005, 0.020), 2)


@pytest.fixture(scope="module")
def walks(forward, turning):
    return {
        "forward": forward,
        "turning": turning,
        "antennas": walk(explorer(), 2),
        "three cells": walk(three_cells(), 2),
        "four legs": walk(four_legs(), 2),
        "a part of a cycle": walk(walker(), 0.4),
        "7¾ cycles": walk(walker(), 1.75),
        "stopped": cut(forward, 130, "Stopped at 2.600 s: the robot fell over."),
        "one sample": cut(forward, 1),
        "gone on": walk(forward.robot, 1, start=forward),
    }


@pytest.fixture(scope="module")
def drawn(forward, turning):
    """Figures of the two walks at which most tests look: each is drawn once."""
    of = {"forward": forward, "turning": turning}
    return cache(lambda draw, name: draw(of[name]))


KINDS = (
    "forward", "turning", "antennas", "three cells", "four legs", "a part of a cycle",
    "7¾ cycles", "stopped", "one sample", "gone on",
)  # fmt: skip


# Each kind of walk, in the figure that has most to say of it.
HARDEST = [
    *((figures.gait, kind) for kind in ("antennas", "three cells", "four legs", "one sample")),
    *((figures.trajectory, kind) for kind in ("forward", "a part of a cycle", "gone on")),
    *((figures.contacts, kind) for kind in ("turning", "four legs", "7¾ cycles", "stopped")),
]


@pytest.mark.slow
@pytest.mark.parametrize(("draw", "kind"), cases(itertools.product(DRAWINGS, KINDS), HARDEST))
def test_every_walk_is_drawn_with_words_apart_on_a_page_and_on_a_phone(draw, kind, walks):
    assert untidy(draw(walks[kind]), 7.0) == []
    assert untidy_on_a_phone(partial(draw, walks[kind])) == []


@pytest.mark.parametrize("draw", DRAWINGS)
def test_every_axis_with_a_dimension_names_its_unit(draw, drawn):
    none = {"Cycle", "Advance $d/u_\\mathrm{max}$", "", "Stance"}
    for ax in drawn(draw, "forward").axes:
        for name in (ax.get_xlabel(), ax.get_ylabel()):
            assert name in none or name.endswith(("[mm]", "[s]", "[N]", "[mJ]", "[°]")), name


@pytest.mark.parametrize("draw", DRAWINGS)
def test_a_walk_without_samples_is_refused(draw, forward):
    none = cut(forward, 0, "Stopped at 0.000 s: a number overflowed.")
    with pytest.raises(ValueError, match=r"no samples.*a number overflowed"):
        draw(none)


@pytest.mark.parametrize("draw", [figures.gait, figures.contacts])
def test_cycles_to_show_are_positive(draw, forward):
    with pytest.raises(ValueError, match="cycles = 0: must be > 0"):
        draw(forward, cycles=0)


def test_a_leg_with_fewer_cells_has_the_colours_of_their_names():
    listed = ("first", "inner", "outer")
    first, inner, outer = _cell_looks(listed, listed)
    assert _cell_looks(("inner", "outer"), listed) == [inner, outer]
    assert _cell_looks(("inner", "another"), listed) == [first, inner]


def test_the_gait_shows_every_cell_in_millimetres(forward):
    figure = figures.gait(forward, cycles=2)
    shown = forward.time > forward.time[-1] - 4.0 - 1e-9
    for i, leg in enumerate(("left", "right")):
        for cell in (0, 1):
            (line,) = lines(figure, f"{leg} cell {cell}")
            assert points(line)[:, 0] == pytest.approx(forward.time[shown])
            assert points(line)[:, 1] == pytest.approx(forward.travel[shown, i, cell] * 1e3)
    (stroke,) = lines(figure, "stroke")
    assert points(stroke)[:, 1].max() == pytest.approx(40.0, abs=0.5)


def test_states_under_the_axis_are_the_gait_of_each_leg(turning):
    figure = figures.gait(turning, cycles=1)
    for leg, ax in zip(("left", "right"), figure.axes[1:], strict=True):
        texts = [t for t in ax.texts if t.get_gid() == "state"]
        said = ">".join(t.get_text() for t in sorted(texts, key=lambda t: t.get_position()[0]))
        assert said == turning.gait(leg, 1)
        for text in texts:
            assert turning.state(leg, text.get_position()[0]) == text.get_text()


def test_shading_is_where_the_foot_carries_weight(forward, drawn):
    figure = drawn(figures.gait, "forward")
    for i, ax in enumerate(figure.axes[1:]):
        shaded = np.zeros(len(forward.time), bool)
        for low, high in map(ends, boxes(ax, "stance")):
            shaded |= (forward.time >= low - 1e-9) & (forward.time <= high + 1e-9)
        assert (shaded == (forward.foot_force[:, i] > 0.02))[forward.time > 1e-9].all()


@pytest.mark.slow
def test_cycles_are_numbered_on_from_an_earlier_walk(walks):
    assert "cycle 4" in says(figures.gait(walks["gone on"]))
    (bar,) = boxes(figures.trajectory(walks["gone on"]).axes[1])
    assert np.mean(ends(bar)) == pytest.approx(4)


@pytest.mark.parametrize("kind", ["forward", "turning", "gone on", "stopped"])
def test_bars_are_displacement_and_turn_of_every_cycle(kind, walks):
    one = walks[kind]
    figure = figures.trajectory(one)
    _, moved, turned = figure.axes
    assert [bar.get_height() for bar in boxes(moved)] == pytest.approx(one.advance)
    assert [bar.get_height() for bar in boxes(turned)] == pytest.approx(np.degrees(one.turn))
    (dots,) = lines(figure, "sideways")
    assert points(dots)[:, 1] == pytest.approx(one.sideways)
    assert len(one.advance) > 0


def test_the_path_is_the_bodys_with_a_tick_to_its_heading_each_cycle(turning, drawn):
    figure = drawn(figures.trajectory, "turning")
    (path,) = lines(figure, "path")
    assert points(path) == pytest.approx(np.column_stack([turning.x, turning.y]) * 1e3)
    ticks = [np.diff(points(line), axis=0)[0] for line in lines(figure, "heading")]
    angles = [math.degrees(math.atan2(y, x)) for x, y in ticks]
    # One cycle turns by about 15° (Kamp et al. 2024), and the robot sets out straight ahead.
    assert np.diff(angles)[-1] == pytest.approx(math.degrees(turning.turn[1]), abs=0.2)
    assert len(angles) == 3
    assert figure.axes[0].get_aspect() == 1.0


@pytest.mark.slow
def test_several_walks_share_one_scale_and_keep_their_names(walks):
    shown = {kind: walks[kind] for kind in ("forward", "turning", "a part of a cycle")}
    figure = figures.trajectories(shown)
    assert set(shown) <= set(says(figure))
    assert "no whole cycle" in says(figure)
    scales = [ax.get_window_extent().width / np.ptp(ax.get_xlim()) for ax in figure.axes[::3]]
    assert scales == pytest.approx([scales[0]] * 3)
    for column in (1, 2):
        assert len({ax.get_ylim() for ax in figure.axes[column::3]}) == 1
    assert untidy(figure) == []


def test_no_walks_are_refused():
    with pytest.raises(ValueError, match="walks is empty"):
        figures.trajectories({})


def test_bars_of_contact_are_where_feet_and_t_foot_stand(forward, drawn):
    bars = drawn(figures.contacts, "forward").axes[0]
    loads = [*forward.foot_force.T, forward.support_force.sum(axis=1)]
    names = [text.get_text() for text in bars.get_yticklabels()]
    assert names == ["left", "right", "T-foot"]
    for name, load in zip(names, loads, strict=True):
        covered = np.zeros(len(forward.time), bool)
        for low, high in strips(bars, name):
            covered |= (forward.time > low) & (forward.time < high)
        assert (covered == (load > 0.02))[forward.time > 1e-9].all()


def test_forces_under_feet_and_t_foot_are_those_of_the_walk(forward):
    figure = figures.contacts(forward, cycles=1)
    shown = forward.time > forward.time[-1] - 2.0 - 1e-9
    (left,) = lines(figure, "force left")
    assert points(left)[:, 1] == pytest.approx(forward.foot_force[shown, 0])
    (weight,) = lines(figure, "weight")
    assert points(weight)[:, 1] == pytest.approx(forward.robot.weight)


def test_legs_that_carry_the_same_are_both_seen(drawn):
    figure = drawn(figures.contacts, "forward")
    (left,), (right,) = (lines(figure, f"force {leg}") for leg in ("left", "right"))
    assert points(left)[:, 1] == pytest.approx(points(right)[:, 1], abs=0.05)
    # The wider one below, the other dashed above it.
    assert left.get_linewidth() >= 2 * right.get_linewidth()
    assert left.get_linestyle() == "-"
    assert right.get_linestyle() == "--"
    assert left.get_color() != right.get_color()


@pytest.mark.slow
def test_a_walk_straight_on_says_so_where_its_bars_have_no_height(forward, drawn):
    straight, turned = (drawn(figures.trajectory, name) for name in ("forward", "turning"))
    assert any(text.startswith("straight:") for text in says(straight))
    assert not any(text.startswith("straight:") for text in says(turned))
    (dots,) = lines(straight, "turns")
    assert points(dots)[:, 1] == pytest.approx(np.degrees(forward.turn))


def test_headings_point_ahead_and_keep_apart(drawn):
    headings = lines(drawn(figures.trajectory, "forward"), "heading")
    for (start, tip), (after, _) in itertools.pairwise(map(points, headings)):
        assert tip[0] - start[0] > 10 * abs(tip[1] - start[1])
        assert tip[0] <= after[0] + 1e-9


@pytest.mark.slow
def test_headings_of_a_robot_that_turns_where_it_stands_spread_like_a_fan(drawn):
    def long(name: str) -> float:
        figure = drawn(figures.trajectory, name)
        ax = figure.axes[0]
        ends = ax.transData.transform(points(lines(figure, "heading")[0]))
        return float(np.hypot(*(ends[1] - ends[0]))) / figure.dpi * 25.4

    assert long("turning") > 2 * long("forward")


def test_a_long_name_is_not_crossed_by_how_the_walk_ended(walks):
    long = "a robot whose name goes on over all of the panels that there are to its right"
    figure = figures.trajectories({long: walks["stopped"]})
    assert untidy(figure, 7.0) == []
    assert f"{long}, stopped early" in says(figure)


def test_work_of_the_cycles_adds_up_to_the_walks(forward, drawn):
    bars = boxes(drawn(figures.contacts, "forward").axes[3])
    assert len(bars) == 3
    total = sum(bar.get_height() for bar in bars)
    # The walk's own sum begins one sample after the first cycle does.
    assert total == pytest.approx(forward.work * 1e3, rel=0.01)


def test_the_loop_is_force_against_stroke_out_and_back(forward, drawn):
    figure = drawn(figures.contacts, "forward")
    gids = ("loading", "unloading")
    whole = np.concatenate([points(line) for gid in gids for line in lines(figure, gid)])
    whole = whole[np.isfinite(whole).all(axis=1)]
    every = np.column_stack([forward.stroke * 1e3, forward.actuator_force])
    for sample in every:
        assert np.abs(whole - sample).sum(axis=1).min() < 1e-9


def test_directions_of_steps_are_read_from_the_states():
    # Kamp et al. 2024, Fig. 3: clockwise steps forward, counterclockwise backward.
    assert direction("00>10>11>01>00") == 1
    assert direction("00>01>11>10>00") == -1
    assert direction("00>10>11>10>00") == direction("00>01>11>01>00") == direction("") == 0
    assert direction("000>100>110>111>011>001>000") == 1
    assert direction("000>001>011>111>110>100>000") == -1


def test_motions_are_named_as_the_robot_moves(walks):
    assert motions(walks["forward"]) == [FORWARD] * 3
    assert motions(walks["turning"]) == [LEFT] * 2
    assert walks["turning"].turn.min() > 0
    assert motions(walk(walker(0.020, 0.005), 1)) == [RIGHT]
    assert motions(walk(walker(0.005, 0.005), 1)) == [BACKWARD]


def test_the_legend_names_what_is_drawn(drawn):
    named = ["inner", "outer", "stance", "stroke", "command"]
    (legend, *_) = drawn(figures.gait, "forward").legends
    assert [text.get_text() for text in legend.get_texts()] == named
    assert legend_of(drawn(figures.contacts, "forward"))[-2:] == ["loading", "unloading"]


@pytest.mark.slow
def test_figures_of_a_walk_are_the_same_every_time(forward):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for draw in DRAWINGS:
            assert figures.svg(draw(forward)) == figures.svg(draw(forward))
