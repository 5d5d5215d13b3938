"""The balloon against the energy of its rubber and the known limits of stretch."""

import math

import numpy as np
import pytest

from stepwell.base import InputError, Measure
from stepwell.mechanism import balloon

RADIUS, THICKNESS, C1, C2 = 0.020, 0.0002, 150e3, 20e3
UNSTRETCHED = 4 / 3 * math.pi * RADIUS**3


def stored(stretch: np.ndarray) -> np.ndarray:
    """Energy [J] of a Mooney-Rivlin membrane, c1 (I1 - 3) + c2 (I2 - 3) over its volume."""
    first = 2 * stretch**2 + stretch**-4
    second = stretch**4 + 2 / stretch**2
    return 4 * math.pi * RADIUS**2 * THICKNESS * (C1 * (first - 3) + C2 * (second - 3))


def test_its_pressure_is_the_slope_of_its_energy_by_volume():
    blown = balloon(RADIUS, THICKNESS, C1, C2)
    assert blown.measure is Measure.VOLUME
    stretch = np.linspace(1.01, 4.9, 101)
    volume = UNSTRETCHED * (stretch**3 - 1)
    step = 1e-5 * volume
    more, less = (np.cbrt(1 + (volume + sign * step) / UNSTRETCHED) for sign in (1, -1))
    slope = (stored(more) - stored(less)) / (2 * step)
    assert blown.force_at(volume) == pytest.approx(slope, rel=1e-5)
    assert blown.energy_at(volume) == pytest.approx(stored(stretch), rel=1e-5)


def test_a_neo_hookean_balloon_peaks_at_the_sixth_root_of_seven():
    # d(1/λ - 1/λ⁷)/dλ = 0: λ⁶ = 7.
    blown = balloon(c2=0.0)
    first = blown.phases[0]
    assert np.cbrt(1 + first.high / UNSTRETCHED) == pytest.approx(7 ** (1 / 6), rel=1e-4)


@pytest.mark.parametrize(("ratio", "phases"), [(0.2140, 2), (0.2150, 1)])
def test_it_snaps_below_a_ratio_of_moduli_of_0_2145(ratio, phases):
    # (1/λ - 1/λ⁷)(1 + K λ²) is level where K = (λ⁶ - 7)/(λ² (λ⁶ + 5)); for K above the largest of
    # these, nowhere.
    stretch = np.linspace(1.4, 3.0, 200001)
    largest = np.max((stretch**6 - 7) / (stretch**2 * (stretch**6 + 5)))
    assert largest == pytest.approx(0.2145, abs=1e-4)
    blown = balloon(c1=C1, c2=ratio * C1)
    assert len(blown.phases) == phases


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"thickness": 0.003}, "a tenth of the radius"),
        ({"stretch": 1.0}, "must be > 1"),
        ({"c2": -1.0}, "c2 = -1.0 Pa: must be >= 0"),
    ],
)
def test_what_is_no_balloon_is_refused(wrong, message):
    with pytest.raises(InputError, match=message):
        balloon(**wrong)
