"""The palette: one colour per cell, distinct for all types of colour vision, and constant."""

from itertools import combinations

import numpy as np
import pytest
from matplotlib.colors import to_hex, to_rgb

from figures.drawn import legend_of, points
from figures.robots import explorer, three_cells
from stepwell import figures, files
from stepwell.figures.common.style import LOADING, UNLOADING, cell_colours, cell_dashes
from stepwell.mechanism import Band, Cell

# Linear RGB as people without one kind of cone see it (Machado et al. 2009, severity 1).
EYES = {
    "all cones": [(1, 0, 0), (0, 1, 0), (0, 0, 1)],
    "protanope": [
        (0.152286, 1.052583, -0.204868),
        (0.114503, 0.786281, 0.099216),
        (-0.003882, -0.048116, 1.051998),
    ],
    "deuteranope": [
        (0.367322, 0.860646, -0.227968),
        (0.280085, 0.672501, 0.047413),
        (-0.011820, 0.042940, 0.968881),
    ],
    "tritanope": [
        (1.255528, -0.076749, -0.178779),
        (-0.078411, 0.930809, 0.147602),
        (0.004733, 0.691367, 0.303900),
    ],
}
XYZ = np.array([(0.4124, 0.3576, 0.1805), (0.2126, 0.7152, 0.0722), (0.0193, 0.1192, 0.9505)])


def lab(colour, eye) -> np.ndarray:
    """CIELAB under D65, as that eye sees it."""
    rgb = np.array(to_rgb(colour))
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    xyz = XYZ @ np.clip(np.array(EYES[eye]) @ linear, 0.0, 1.0) / (0.9505, 1.0, 1.089)
    x, y, z = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def apart(a, b, eye) -> float:
    return float(np.hypot.reduce(lab(a, eye) - lab(b, eye)))


@pytest.mark.parametrize("eye", EYES)
def test_no_two_of_twenty_cells_look_alike(eye):
    looks = list(zip(cell_colours(20), map(str, cell_dashes(20)), strict=True))
    for (a, one), (b, other) in combinations(looks, 2):
        # Lines of one style, and so all that six cells have, differ in colour by far.
        assert one != other or apart(a, b, eye) > 15.0, (a, b)
    # Dots have no dashes.
    for count, least in ((12, 14.0), (18, 10.0)):
        for a, b in combinations(cell_colours(count), 2):
            assert apart(a, b, eye) > least, (a, b)


def test_a_cell_keeps_its_colour_in_a_chain_of_any_length():
    for count in range(1, 20):
        assert cell_colours(count) == cell_colours(20)[:count]


def test_no_cell_has_the_colour_of_loading_or_unloading():
    for a in cell_colours(20):
        assert all(apart(a, b, "all cones") > 15.0 for b in (LOADING, UNLOADING)), a


def test_twelve_cells_have_twelve_lines_in_the_legend():
    cells = [Cell(Band((-0.010, 0.0), (0.001 + 0.0015 * i, 0.0))) for i in range(12)]
    figure = figures.unit_cell_force(cells)
    (ax,) = figure.axes
    drawn = [line for line in ax.get_lines() if len(points(line)) > 100]
    assert len({(line.get_color(), str(line.get_linestyle())) for line in drawn}) == 12
    assert len([text for text in legend_of(figure) if text.endswith("mm")]) == 12


def test_parts_that_can_be_cut_have_the_same_colours_in_a_drawing_and_in_a_video():
    pytest.importorskip("mujoco")
    from stepwell.figures.robots.build import _COLOURS
    from stepwell.simulation.solids import COLOURS

    for role, colour in COLOURS.items():
        assert colour[:3] == pytest.approx(to_rgb(_COLOURS[role]), abs=0.006), role


def test_the_ground_has_the_same_colours_in_a_figure_and_in_a_video():
    pytest.importorskip("mujoco")
    from stepwell.figures.robots import parts as drawn
    from stepwell.simulation import parts

    for name in ("STEP", "GROOVE", "OTHER_FRICTION", "PLATE"):
        assert getattr(parts, name)[:3] == getattr(drawn, name)


@pytest.mark.parametrize("robot", [explorer(), three_cells(), files.preset("robot-explorer")])
def test_a_robot_has_the_same_colours_in_a_picture_and_in_a_video(robot):
    pytest.importorskip("mujoco")
    from stepwell.figures.robots.robot import ANTENNA, FOOT, SUPPORT
    from stepwell.simulation import parts

    for name, colour in (
        ("FOOT", FOOT),
        ("LINK", FOOT),
        ("SUPPORT", SUPPORT),
        ("ANTENNA", ANTENNA),
    ):
        assert getattr(parts, name)[:3] == pytest.approx(to_rgb(colour), abs=0.006)
    for seen, colour in zip(parts.BANDS, cell_colours(len(parts.BANDS)), strict=True):
        assert seen[:3] == pytest.approx(to_rgb(colour), abs=0.006)
    figure = figures.robot_above(robot)
    drawn = {
        line.get_color()
        for ax in figure.axes
        for line in ax.get_lines()
        if line.get_gid() == "band"
    }
    cells = max(len(leg.chain) for leg in robot.legs)
    assert {to_hex(colour) for colour in drawn} == {to_hex(c) for c in cell_colours(cells)}
