"""The prediction as a figure: margins, drags and flips where it says they are."""

import math

import pytest

from figures.drawn import lines, points, says, untidy
from figures.robots import explorer, walker
from figures.shapes import boxes
from stepwell import figures
from stepwell.figures.common.style import VERMILLION

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def predictions():
    return {"forward": walker(title="forward").predict(), "antennas": explorer().predict()}


@pytest.fixture(scope="module")
def drawn(predictions):
    """The figure of each, drawn once."""
    return {name: figures.prediction(prediction) for name, prediction in predictions.items()}


@pytest.mark.parametrize("name", ["forward", "antennas"])
def test_words_stay_apart_and_axes_name_their_units(name, drawn):
    figure = drawn[name]
    assert untidy(figure) == []
    assert all(ax.get_xlabel().endswith(("[mN]", "[N]", "[mm]")) for ax in figure.axes)


def test_each_leg_has_its_gait_and_its_margin(predictions, drawn):
    prediction, figure = predictions["antennas"], drawn["antennas"]
    for leg in prediction.legs:
        assert any(text.startswith(f"{leg.name}: {leg.gait}") for text in says(figure))
        if math.isfinite(leg.margin):
            (mark,) = lines(figure, f"margin {leg.name}")
            assert points(mark)[0, 0] == pytest.approx(leg.margin * 1e3)


def test_each_push_shows_the_drag_that_it_overcomes(predictions, drawn):
    prediction, figure = predictions["forward"], drawn["forward"]
    for leg in prediction.legs:
        drawn = boxes(figure, f"drag {leg.name}")
        finite = [push.largest_drag for push in leg.pushes if math.isfinite(push.largest_drag)]
        widths = [bar.get_width() for bar in drawn]
        assert len(drawn) == len(leg.pushes)
        assert widths[: len(finite)] == pytest.approx(finite)
    (floor,) = lines(figure, "floor")
    assert points(floor)[:, 0] == pytest.approx(0.39)


def test_each_flip_stands_at_its_displacement(predictions, drawn):
    prediction, figure = predictions["antennas"], drawn["antennas"]
    assert prediction.flips
    for antenna in prediction.robot.antennas:
        marks = [points(line)[0, 0] for line in lines(figure, f"flip {antenna.name}")]
        flips = [flip for flip in prediction.flips if flip.antenna == antenna.name]
        assert marks == pytest.approx([flip.displacement * 1e3 for flip in flips])
    assert len(drawn["forward"].axes) == 3


@pytest.mark.parametrize("name", ["forward", "antennas"])
def test_each_leg_shows_the_depths_of_the_feet_at_which_its_gait_stays(name, predictions, drawn):
    prediction, figure = predictions[name], drawn[name]
    for leg, (least, most) in zip(prediction.legs, prediction.depths, strict=True):
        (bar,) = boxes(figure, f"depths {leg.name}")
        assert bar.get_x() == pytest.approx(least * 1e3)
        assert bar.get_x() + bar.get_width() == pytest.approx(most * 1e3)
        assert f"{least * 1e3:.2f} to {most * 1e3:.2f} mm" in says(figure)
    (below,) = lines(figure, "below")
    assert points(below)[:, 0] == pytest.approx(prediction.robot.foot.below * 1e3)


@pytest.mark.parametrize("name", ["forward", "antennas"])
def test_no_leg_has_the_colour_of_what_is_in_doubt(name, drawn):
    figure = drawn[name]
    legs = {
        line.get_color()
        for ax in figure.axes
        for line in ax.get_lines()
        if (line.get_gid() or "").startswith(("margin", "flip"))
    }
    assert len(legs) >= 2
    assert VERMILLION not in legs
    doubtful = any(text.get_color() == VERMILLION for ax in figure.axes for text in ax.texts)
    assert ("this colour: uncertain" in says(figure)) == doubtful
