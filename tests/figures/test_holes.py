"""The plates to drill: anchors, holes, origin and axes as the values state them."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

import stepwell as sw
from facts import refuses, says
from figures import drawn
from figures.drawn import Array, lines, marks, points, untidy
from stepwell import figures

PITCH = 0.005
LEG = sw.preset("paper-forward")


def from_origin(figure, gid: str) -> Array:
    """(n, 2) anchors of the first plate from its origin [m]; the lever gives the scale."""
    one, other = (points(line) for line in lines(figure, "lever")[:2])
    middle = (one + other) / 2
    scale = LEG.levers[0].lever / np.hypot(*np.diff(middle, axis=0)[0])
    at = points(lines(figure, gid)[0])
    return (at - middle[int(gid == "q")]) * scale


@pytest.mark.parametrize("pitch", [None, PITCH])
def test_both_anchors_are_drawn_at_their_places_and_named_with_them(pitch):
    figure = figures.holes(LEG, pitch)
    (band,) = LEG.levers[0].bands
    assert from_origin(figure, "p") == pytest.approx(np.array([band.p]))
    assert from_origin(figure, "q") == pytest.approx(np.array([band.q]))
    for cell in LEG.levers:
        (band,) = cell.bands
        for name, (x, y) in (("p", band.p), ("q", band.q)):
            number = f"({x * 1e3:g}, {y * 1e3:g})".replace("-", "\N{MINUS SIGN}")
            says(drawn.says(figure), f"{name} {number} mm")
    (key,) = figure.legends
    says([text.get_text() for text in key.get_texts()], "origin", "middle", "joints")
    says(drawn.says(figure), "on the back")


def test_the_pitch_is_a_dimension_and_no_holes_are_drawn_without_it():
    figure = figures.holes(LEG, PITCH)
    says(drawn.says(figure), "5 mm")
    low, high = (points(line)[0, 1] for line in lines(figure, "pitch")[:2])
    lever = points(lines(figure, "lever")[0])
    page = np.ptp(lever[:, 0]) / LEG.levers[0].lever
    assert (high - low) / page == pytest.approx(PITCH)
    assert marks(figure, "hole") > 20
    bare = figures.holes(LEG)
    assert not lines(bare, "hole")
    assert not lines(bare, "pitch")


@pytest.mark.parametrize("origin", [(-0.010, 0.0), (0.0007, -0.0012), (0.0, 0.0015)])
def test_the_drawn_grid_passes_through_its_origin_and_no_joint_covers_a_hole(origin):
    pitch = 0.003
    figure = figures.holes(LEG, pitch, origin)
    x, y = (f"{one * 1e3:g}".replace("-", "\N{MINUS SIGN}") for one in origin)
    says(" ".join(drawn.says(figure)), f"through ({x}, {y})")
    steps = (from_origin(figure, "hole") - origin) / pitch
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)
    (one, _), (other, _) = (points(line) for line in lines(figure, "lever")[:2])
    scale = LEG.levers[0].lever / np.ptp(points(lines(figure, "lever")[0])[:, 0])
    joints = np.array([one, other]) * scale - (one + other) / 2 * scale
    apart = from_origin(figure, "hole")[:, None] - joints
    assert np.hypot(*apart.T).min() > 0.24 * pitch


@pytest.mark.parametrize("name", ["paper-forward", "three-wave", "four-shuffle"])
@pytest.mark.parametrize("width", [57.0, 89.0, 120.0, 183.0])
def test_no_word_covers_another_or_leaves_the_page(name, width):
    for pitch in (None, PITCH):
        draw = partial(figures.holes, sw.preset(name), pitch)
        assert untidy(figures.compose([draw], width=width), 7.0) == []


def test_plates_that_would_cover_each_other_are_drawn_further_apart():
    cell = LEG.levers[0]
    wide = replace(cell, band=sw.Band((0.010, 0.0), (-0.015, 0.005)))
    says(drawn.says(figures.holes(sw.Chain((wide,)))), "drawn longer")
    assert not any("drawn longer" in text for text in drawn.says(figures.holes(LEG)))


def test_chains_without_anchors_or_too_long_are_refused():
    with refuses(ValueError, "elements", "mechanism"):
        figures.holes(sw.preset("balloon"))
    with refuses(ValueError, "13 cells", "12"):
        figures.holes(sw.Chain(LEG.levers[:1] * 13))
    with refuses(ValueError, "pitch", "> 0"):
        figures.holes(LEG, 0.0)
