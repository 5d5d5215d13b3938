"""The tilting bar: virtual work, and how little it does."""

import math

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


def test_a_bar_of_no_length_is_refused():
    with pytest.raises(ValueError, match="bar = 0 m: must be > 0"):
        Rig(0)
