"""The tornado: bars as long as the effects, the longest on top."""

import math

import numpy as np
import pytest

from figures.drawn import lines, points, untidy
from figures.shapes import boxes, ends
from stepwell import figures
from stepwell.paper import Effect, Sensitivity

EFFECTS = (
    Effect("period [s]", 1.0, 4.0, 0.75, 0.74),
    Effect("feet below supports [mm]", 0.5, 1.5, 0.60, 0.78),
    Effect("foot friction", 0.3, 0.8, 0.70, 0.745),
)
FORWARD = Sensitivity("Forward $d/u_\\mathrm{max}$", 0.744, EFFECTS, (0.63, 0.79))


def test_bars_run_from_the_nominal_result_to_each_value():
    figure = figures.tornado(FORWARD)
    for effect in EFFECTS:
        for name, value in (("low", effect.at_low), ("high", effect.at_high)):
            (bar,) = boxes(figure, f"{name} {effect.parameter}")
            assert ends(bar) == pytest.approx(sorted((0.744, value)))
    (nominal,) = lines(figure, "nominal")
    assert points(nominal)[:, 0] == pytest.approx(0.744)


def test_the_widest_effect_is_on_top_and_names_its_values():
    (ax,) = figures.tornado(FORWARD).axes
    names = [text.get_text() for text in ax.get_yticklabels()]
    assert names == [
        "feet below supports [mm]  0.5 to 1.5",
        "foot friction  0.3 to 0.8",
        "period [s]  1 to 4",
    ]
    low, high = ax.get_ylim()
    assert low > high
    assert ax.get_xlabel() == FORWARD.result


def test_the_target_is_shaded():
    figure = figures.tornado(FORWARD)
    (band,) = boxes(figure, "target")
    assert ends(band) == pytest.approx((0.63, 0.79))
    low, high = figure.axes[0].get_xlim()
    assert low < 0.60 and high > 0.79
    bare = Sensitivity("d", 0.744, EFFECTS)
    assert boxes(figures.tornado(bare), "target") == []


def test_two_effects_to_one_side_do_not_hide_each_other():
    one = Sensitivity("d", 0.5, [Effect("a", 1, 2, 0.6, 0.7)])
    figure = figures.tornado(one)
    low, high = (boxes(figure, f"{name} a")[0] for name in ("low", "high"))
    assert low.get_y() + low.get_height() < high.get_y() + 0.05


def test_a_missing_result_is_marked_and_comes_first():
    lost = Effect("body mass [g]", 200, 320, math.nan, 0.74)
    figure = figures.tornado(Sensitivity("d", 0.744, (*EFFECTS, lost)))
    assert figure.axes[0].get_yticklabels()[0].get_text().startswith("body mass")
    assert len(lines(figure, "missing")) == 1
    assert "no result" in [text.get_text() for text in figure.legends[0].get_texts()]


@pytest.mark.parametrize("count", [1, 2, 3])
def test_several_results_have_a_panel_each_and_words_apart(count):
    shown = [
        Sensitivity(f"result {i} [°]", 10.0 * (i + 1), [
            Effect(e.parameter, e.low, e.high, 10 * (i + 1) * e.at_low, 10 * (i + 1) * e.at_high)
            for e in EFFECTS[: 3 - i]
        ])
        for i in range(count)
    ]  # fmt: skip
    figure = figures.tornado(shown)
    assert len(figure.axes) == count
    assert untidy(figure) == []
    for ax in figure.axes:
        assert ax.get_position().width > 0.15


def test_no_effect_at_all_is_drawn_too():
    figure = figures.tornado(Sensitivity("d", 0.0, [Effect("a", 1, 2, 0.0, 0.0)]))
    assert np.ptp(figure.axes[0].get_xlim()) > 0


@pytest.mark.parametrize("nothing", [[], Sensitivity("d", 1.0, [])])
def test_nothing_to_show_is_refused(nothing):
    with pytest.raises(ValueError, match="results is empty"):
        figures.tornado(nothing)
