"""Figures of a jump: where the energy goes, and the motion over time."""

import numpy as np
import pytest

from figures.drawn import legend_of, lines, points, says, untidy, untidy_on_a_phone
from hoppers import jumped
from stepwell import figures

DRAWS = (figures.energy_flow, figures.flight)


@pytest.mark.parametrize("draw", DRAWS)
@pytest.mark.parametrize("task", ["jump", "throw", "strike"])
def test_all_words_can_be_read_on_a_page_and_on_a_phone(draw, task):
    jump = jumped(task=task)
    assert untidy(draw(jump), 7.0) == []
    assert untidy_on_a_phone(lambda: draw(jump)) == []


def test_the_flows_are_labelled_with_their_energies_and_fractions():
    jump = jumped()
    flow, words = jump.first.flow, says(figures.energy_flow(jump))
    texts = [text.replace("\n", " ") for text in words]
    assert f"set free {flow.released * 1e3:.0f} mJ" in texts
    shown = [text for text in texts if text.startswith("flight ")]
    assert shown == [f"flight {flow.flight * 1e3:.0f} mJ, {flow.efficiency:.1%}".replace("%", " %")]


def test_a_flow_of_nothing_is_left_out():
    words = " ".join(says(figures.energy_flow(jumped(task="strike"))))
    assert "stops, until" not in words and "dampers" in words


def test_the_flight_has_lift_off_and_bound_of_each_jump():
    jump = jumped()
    drawn = figures.flight(jump)
    (lift_off,), (bound,) = lines(drawn, "lift-off"), lines(drawn, "bound")
    assert points(lift_off)[0, 0] == jump.first.lift_off
    (height,) = lines(drawn, "height")
    rise = points(bound)[0, 1] - points(lift_off)[0, 1]
    assert rise == pytest.approx(jump.bound.height * 1e3, rel=1e-9)
    top = np.max(points(height)[:, 1])
    assert top - points(lift_off)[0, 1] == pytest.approx(jump.first.height * 1e3, rel=0.01)
    assert {"bound", "lift-off", "latch", "spring"} <= {*legend_of(drawn)}


def test_the_travels_of_a_blow_stand_alone():
    drawn = figures.flight(jumped(task="strike"))
    assert lines(drawn, "height") == [] and len(lines(drawn, "travel")) == 2
