"""The von Mises truss against its closed forms."""

from typing import Any

import numpy as np
import pytest

from stepwell.base import InputError
from stepwell.mechanism import von_mises_truss

WIDTH, HEIGHT, STIFFNESS = 0.030, 0.012, 2000.0


def test_its_peak_force_is_the_closed_form():
    # dF/dy = 0 where L³ = L0 w²: F = 2 k L0 (1 - cos^(2/3) α)^(3/2), tan α = h/w.
    truss = von_mises_truss(WIDTH, HEIGHT, STIFFNESS)
    rest, cosine = np.hypot(WIDTH, HEIGHT), WIDTH / np.hypot(WIDTH, HEIGHT)
    peak = 2 * STIFFNESS * rest * (1 - cosine ** (2 / 3)) ** 1.5
    ((up, down),) = truss.fields
    assert (up, down) == (pytest.approx(peak, rel=1e-6), pytest.approx(-peak, rel=1e-6))


def test_its_energy_is_that_of_its_springs():
    truss = von_mises_truss(WIDTH, HEIGHT, STIFFNESS)
    travel = np.linspace(-HEIGHT / 5, 2.2 * HEIGHT, 57)
    stretch = np.hypot(WIDTH, HEIGHT - travel) - np.hypot(WIDTH, HEIGHT)
    stored = truss.energy_at(travel) - truss.energy_at(0.0)
    assert stored == pytest.approx(STIFFNESS * stretch**2, abs=1e-9)


def test_it_rests_above_and_below_its_pivots():
    truss = von_mises_truss()
    at_rest = truss.force_at([0.0, 0.012, 0.024])
    assert at_rest == pytest.approx(0.0, abs=1e-6)
    assert truss.is_bistable and len(truss.phases) == 2


@pytest.mark.parametrize("size", ["half_width", "height", "stiffness"])
def test_sizes_that_no_truss_has_are_refused(size):
    wrong: dict[str, Any] = {size: -1.0}
    with pytest.raises(InputError, match=f"{size} = -1.0"):
        von_mises_truss(**wrong)
