"""The drawing of the robot: true to its values and to what is simulated."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from figures.drawn import lines, points, says, untidy
from figures.robots import explorer, four_legs, three_cells, walker
from sizes import cases
from stepwell import figures
from stepwell.figures.robots.parts import antenna_line, in_world, leg_parts
from stepwell.simulation import spec
from stepwell.simulation.simulator import mujoco

ROBOTS = {
    "two cells": walker(),
    "antennas": explorer(),
    "levers taken off": explorer(connected=False),
    "three cells": three_cells(),
    "four legs": four_legs(),
}
DRAWINGS = (figures.robot_drawing, figures.robot_above, figures.robot_side)


@pytest.mark.slow
@pytest.mark.parametrize("name", cases(ROBOTS, ["levers taken off", "three cells", "four legs"]))
@pytest.mark.parametrize("draw", DRAWINGS)
def test_every_robot_is_drawn_with_words_apart(draw, name):
    figure = draw(ROBOTS[name])
    assert untidy(figure, 7.0) == []


@pytest.mark.parametrize("name", ["two cells", "antennas", "three cells", "four legs"])
def test_parts_stand_where_the_simulation_has_them(name):
    robot = ROBOTS[name]
    model = spec(robot).compile()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    mujoco.mj_kinematics(model, data)
    body = data.body("body").xpos

    def at(site: str) -> np.ndarray:
        return data.site(site).xpos - body

    for leg in robot.legs:
        parts = leg_parts(robot, leg, [0.0] * len(leg.chain))
        bands = iter(parts.bands)
        for i, (cell, each) in enumerate(zip(leg.chain.names, leg.chain.levers, strict=True)):
            for end, joint in zip(("in", "out"), parts.levers[i], strict=True):
                assert joint == pytest.approx(at(f"{leg.name}.{cell}.lever.{end}")[:2], abs=1e-9)
            for j in range(len(each.bands)):
                label = "band" if len(each.bands) == 1 else f"band{j + 1}"
                for end, anchor in zip("pq", next(bands), strict=True):
                    site = at(f"{leg.name}.{cell}.{label}.{end}")[:2]
                    assert anchor == pytest.approx(site, abs=1e-9)
        pivots = [at(f"{leg.name}.pivot.{end}")[0] for end in ("in", "out")]
        assert parts.pivots == pytest.approx(pivots, abs=1e-9)
        tip = at(f"{leg.name}.tip")
        assert parts.tip == pytest.approx((tip[0], tip[2]), abs=1e-9)
    for antenna in robot.antennas:
        assert antenna_line(antenna)[0] == pytest.approx(at(f"{antenna.name}.feeler")[:2], abs=1e-9)


@given(st.lists(st.floats(0, 1), min_size=3, max_size=3))
def test_levers_and_bands_keep_their_lengths_at_any_travel(shares):
    robot = ROBOTS["three cells"]
    for leg in robot.legs:
        cells = leg.chain.levers
        travels = [c.full_travel * share for c, share in zip(cells, shares, strict=True)]
        parts = leg_parts(robot, leg, travels)
        assert np.hypot(*np.ptp(parts.levers, axis=1).T) == pytest.approx([c.lever for c in cells])
        expected = [
            float(band.length(cell.angle(travel), cell.lever))
            for cell, travel in zip(cells, travels, strict=True)
            for band in cell.bands
        ]
        assert np.hypot(*np.ptp(parts.bands, axis=1).T) == pytest.approx(expected)
        reach = [np.hypot(pivot - parts.tip[0], parts.tip[1]) for pivot in parts.pivots]
        assert reach == pytest.approx([robot.foot.link] * 2)


def test_feet_supports_and_centre_stand_at_their_values():
    robot = ROBOTS["antennas"]
    figure = figures.robot_above(robot)
    feet = [points(line)[0] for line in lines(figure, "foot")]
    assert feet == pytest.approx(np.array([leg.at for leg in robot.legs]) * 1e3)
    # Inner and outer cell open: the foot goes back by the inner's travel and half the outer's.
    moved = [points(line)[0] for line in lines(figure, "foot at 1")]
    assert moved == pytest.approx(np.array(feet) - (30.0, 0.0))
    supports = [points(line)[0] for line in lines(figure, "support")]
    assert supports == pytest.approx(np.array(robot.body.supports) * 1e3)
    (centre,) = lines(figure, "centre of mass")
    assert points(centre)[0] == pytest.approx((24.0, 0.0))


def test_the_side_shows_how_far_the_feet_stand_below_the_supports():
    figure = figures.robot_side(ROBOTS["two cells"])
    assert points(lines(figure, "foot")[0])[0] == pytest.approx((8.0, 0.0))
    assert {points(line)[0, 1] for line in lines(figure, "support")} == {0.9}
    # Kamp et al. 2024: links of 35 mm, 40 mm apart, then 60: the foot rises from 28.7 to 18.0.
    lifted = points(lines(figure, "foot at 1")[0])[0]
    assert lifted == pytest.approx((-22.0, 28.723 - 18.028), abs=1e-3)
    assert "feet 0.9 mm below\nthe supports" in says(figure)
    assert {"40 mm", "links 35 mm", "28.7 mm", "rises 10.7 mm"} <= set(says(figure))


def test_links_are_as_long_as_they_are():
    figure = figures.robot_side(ROBOTS["two cells"])
    for gid in ("link", "link at 1"):
        for line in lines(figure, gid):
            assert np.hypot(*np.ptp(points(line), axis=0)) == pytest.approx(35.0)


def test_antennas_sweep_back_from_rest_by_their_swing():
    robot = ROBOTS["antennas"]
    figure = figures.robot_above(robot)
    for antenna, rod, arc in zip(
        robot.antennas, lines(figure, "antenna"), lines(figure, "swing"), strict=True
    ):
        pivot = np.array(antenna.pivot) * 1e3
        assert points(rod)[0] == pytest.approx(pivot)
        way = points(arc) - pivot
        angles = np.degrees(np.arctan2(way[:, 1], way[:, 0]))
        assert angles[0] == pytest.approx(np.degrees(antenna.angle))
        assert abs(angles[-1]) - abs(angles[0]) == pytest.approx(np.degrees(antenna.swing))
        assert np.hypot(*way.T) == pytest.approx(130.0)
    assert any("left: 130 mm, swing 68.8°" in text for text in says(figure))
    assert any("moves $p$ of right inner by 10 mm" in text for text in says(figure))


def test_the_anchor_that_an_antenna_moves_goes_where_a_press_puts_it():
    robot = ROBOTS["antennas"]
    moved = lines(figures.robot_above(robot), "moved anchor")
    assert len(moved) == 2
    for antenna, mark in zip(robot.antennas, moved, strict=True):
        pressed = robot.pressed({antenna.name: antenna.swing})
        leg = pressed.leg(antenna.leg)
        anchor = leg_parts(pressed, leg, [0.0, 0.0]).bands[0, 0]
        assert points(mark)[0] == pytest.approx(anchor * 1e3)
    assert not lines(figures.robot_above(ROBOTS["levers taken off"]), "moved anchor")


def test_the_scale_bar_has_the_length_it_says():
    figure = figures.robot_drawing(ROBOTS["two cells"])
    (bar,) = lines(figure, "scale bar")
    assert np.ptp(points(bar)[:, 0]) == pytest.approx(50.0)
    assert "50 mm" in says(figure)
    first, second = (ax.get_position().width / np.ptp(ax.get_xlim()) for ax in figure.axes)
    assert first == pytest.approx(second)


@pytest.mark.slow
def test_given_axes_are_drawn_into():
    figure = figures.robot_drawing(ROBOTS["two cells"])
    extra = figure.add_subplot()
    for draw in (figures.robot_above, figures.robot_side):
        assert draw(ROBOTS["two cells"], ax=extra) is figure


def test_a_turned_frame_turns_to_the_left():
    turned = in_world(np.array([(1.0, 0.0), (0.0, 1.0)]), 2.0, 3.0, np.pi / 2)
    assert turned == pytest.approx(np.array([(2.0, 4.0), (1.0, 3.0)]))
