"""The figure of a sweep shows every robot, whatever was varied and whatever went wrong."""

from functools import partial

import numpy as np
import pytest

from figures.drawn import untidy_on_a_phone
from stepwell import figures, files
from stepwell.figures.robots.gaits import axis_words
from stepwell.simulation import Sweep, Trial

GAITS = ("00>10>11>01>00", "00>01>11>10>00", "00>01>11>01>00")


def trial(i: int) -> Trial:
    gait = GAITS[i % 3]
    return Trial(0.1 * i - 0.5, 0.0, np.radians(i), (gait, gait), 0.018, "")


def swept(*columns, trials=None) -> Sweep:
    values = {
        f"key.{name}_mm": list(column) for name, column in zip("abcdefghij", columns, strict=False)
    }
    return Sweep(values, tuple(trials or [trial(i) for i in range(len(columns[0]))]))


def shown(figure) -> list[int]:
    """How many robots each axes shows."""
    return [
        sum(len(line.get_xdata()) for line in ax.lines if line.get_gid() == "robots")
        for ax in figure.axes
    ]


def test_over_one_key_advance_and_turn_of_every_robot_are_shown():
    figure = figures.sweep(swept(np.arange(7.0)))
    assert shown(figure) == [7, 7]
    lower, upper = figure.axes
    assert lower.get_xlabel() == "A of key [mm]"
    assert lower.get_xlim() == upper.get_xlim()


def test_over_two_keys_every_robot_stands_at_its_values_with_its_numbers():
    x, y = (axis.ravel() for axis in np.meshgrid([0.0, 1.0, 2.0], [5.0, 6.0]))
    figure = figures.sweep(swept(x, y))
    assert shown(figure) == [6]
    texts = [text.get_text() for text in figure.axes[0].texts]
    assert len(texts) == 6
    assert untidy_on_a_phone(partial(figures.sweep, swept(x, y))) == []
    assert "\N{MINUS SIGN}0.50\n0.0°" in texts


def test_draws_of_two_keys_are_too_many_for_numbers():
    rng = np.random.default_rng(1)
    figure = figures.sweep(swept(rng.random(200), rng.random(200)))
    assert shown(figure) == [200]
    assert len(figure.axes[0].texts) == 0


@pytest.mark.slow
@pytest.mark.parametrize(("keys", "panels"), [(3, 3), (5, 5), (10, 8)])
def test_over_more_keys_each_has_a_panel_up_to_eight(keys, panels):
    rng = np.random.default_rng(keys)
    result = swept(*rng.random((keys, 20)))
    assert shown(figures.sweep(result)) == [20] * panels
    assert untidy_on_a_phone(partial(figures.sweep, result)) == []


def test_pathways_have_their_colours_and_rare_gaits_share_one():
    gaits = [f"00>0{i}>11>{j}0>00" for i in range(4) for j in range(4)]
    trials = [Trial(0.5, 0.0, 0.0, (gait, GAITS[0]), 0.018, "") for gait in gaits]
    trials += [trial(0), Trial(np.nan, np.nan, np.nan, ("", ""), np.nan, "it fell over")]
    figure = figures.sweep(swept(np.arange(18.0), trials=trials))
    (legend,) = figure.legends
    labels = [text.get_text() for text in legend.get_texts()]
    assert {GAITS[0], "any other", "did not walk to the end"} <= set(labels)
    assert len(labels) <= 10


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ("chain.cell.outer.q_mm[0]", "$q_x$ of outer [mm]"),
        ("leg.*.chain.cell.outer.q_mm[0]", "$q_x$ of outer, every leg [mm]"),
        ("leg.left.chain.cell.inner.band.rest_length_mm", "Rest length of inner, left leg [mm]"),
        ("foot.below_mm", "Depth of foot [mm]"),
        ("blocks.damping_N_s_per_m", "Damping of blocks [N s/m]"),
        ("body.supports_mm[1][0]", "Supports 2 $x$ of body [mm]"),
        ("floor.gravity_m_per_s2", "Gravity of floor [m/s²]"),
        ("floor.foot_friction", "Foot friction of floor"),
    ],
)
def test_axes_say_what_a_key_means(key, said):
    assert axis_words(key) == said


def test_no_key_of_a_robot_is_written_raw():
    for parameter in files.parameters(files.preset("robot-explorer")):
        said = axis_words(parameter.path)
        assert "_mm" not in said
        assert "." not in said
        assert said.endswith(f"[{parameter.unit}]") or not parameter.unit, said


def test_nothing_to_show_is_refused():
    with pytest.raises(ValueError, match="the sweep is empty"):
        figures.sweep(Sweep({}, ()))
