"""The tilting bar: virtual work, and how little it does."""

import math
import re

import numpy as np
import pytest

from stepwell.lab import PAPER_RIG, Rig
from stepwell.mechanism import Band, Cell

CELL = Cell(Band((-0.010, 0.0), (0.010, 0.0)))
THETA = np.linspace(-CELL.limit, CELL.limit, 2001)


@pytest.mark.parametrize("bar", [0.03, 0.07, 0.5])
def test_the_force_at_the_machine_does_the_work_that_the_cell_stores(bar):
    rig = Rig(bar)
    stroke = rig.stroke(CELL, THETA)
    force = CELL.force(THETA) * rig.factor(CELL, THETA)
    work = np.concatenate([[0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(stroke))])
    stored = CELL.energy(THETA) - CELL.energy(THETA[0])
    assert work == pytest.approx(stored, abs=1e-6 * np.max(np.abs(stored)))


def test_the_factor_is_that_of_the_theory_with_a_plus():
    b = PAPER_RIG.tilt(CELL, THETA)
    assert PAPER_RIG.factor(CELL, THETA) == pytest.approx(1 / (1 + b * np.tan(THETA)))
    # The bar follows a block that moves sideways by r (cos θ - cos θc).
    side = CELL.lever * (np.cos(THETA) - math.cos(CELL.limit))
    assert np.sin(np.arctan(b)) * 0.070 == pytest.approx(side)


def test_the_papers_bar_changes_forces_by_two_percent_at_most():
    factor = PAPER_RIG.factor(CELL, THETA)
    assert 0.015 < np.max(np.abs(factor - 1)) <= 0.02
    assert factor[[0, 1000, 2000]] == pytest.approx(1.0)


def test_angles_follow_from_the_stroke_of_the_machine():
    for rig in (Rig(), PAPER_RIG):
        assert rig.angle(CELL, rig.stroke(CELL, THETA)) == pytest.approx(THETA, abs=1e-4)


@pytest.mark.parametrize("unloading", [False, True])
def test_a_rig_as_drawn_shows_the_stroke_of_the_mechanism(unloading):
    stroke = np.linspace(0.0, 0.04, 9)
    assert np.array_equal(PAPER_RIG.at_machine(stroke, 3.0 + stroke, 0.04, unloading), stroke)


def test_the_machine_is_ahead_of_the_mechanism_in_the_direction_of_the_motion():
    # 1 N to push and 0.2 N of friction on 0.5 mm/N; stops 2 % farther apart; 0.3 mm of slack.
    rig = Rig(0.07, 1.02, 0.3e-3, 0.3e-3, 0.5e-3, 0.2)
    out = rig.at_machine(0.010, 1.0, 0.04, unloading=False)
    assert out == pytest.approx(0.010 * 1.02 + 0.3e-3 + 1.2 * 0.5e-3)
    # Going back it has come 30 mm, and the mechanism that pushes back helps.
    back = rig.at_machine(0.010, 1.0, 0.04, unloading=True)
    assert back == pytest.approx(0.04 - (0.030 * 1.02 + 0.3e-3 + (-1.0 + 0.2) * 0.5e-3))


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ({"bar": 0.0}, "bar = 0.0 m: must be > 0"),
        ({"stretch": 0.0}, "stretch = 0.0: must be > 0 and finite"),
        ({"stretch": math.inf}, "stretch = inf: must be > 0 and finite"),
        ({"start_loading": math.nan}, "start_loading = nan m: must be finite"),
        ({"start_unloading": math.inf}, "start_unloading = inf m: must be finite"),
        ({"compliance": -1e-9}, "compliance = -1e-09 m/N: must be >= 0 and finite"),
        ({"friction": math.inf}, "friction = inf N: must be >= 0 and finite"),
    ],
)
def test_what_no_rig_can_be_is_refused(wrong, told):
    with pytest.raises(ValueError, match=re.escape(told)):
        Rig(**wrong)
