"""One curve alone: the law that made it is chosen, and its numbers lie in their intervals."""

import numpy as np
import pytest

from sizes import SIZE, examples
from stepwell import lab
from stepwell.lab.bands.choice import criterion, independent, this_band

REST, GAUGE = 0.010, 0.012
# Tension [N] over extension [m]; the neo-Hookean band is 20 mm long, so that it bends.
TRUE = {
    "linear": lambda e: 28.5 * e,
    "cubic": lambda e: 56.3 * e - 1905 * e**2 + 35720 * e**3,
    "neo-Hookean": lambda e: 0.19 * ((1 + e / 0.020) - (1 + e / 0.020) ** -2),
}


def curve(law: str, n: int, noise: float, drift: float, seed: int) -> lab.BandTest:
    """One loading half with noise [N], and a smooth drift, a share of the largest force."""
    rng = np.random.default_rng(seed)
    u = np.linspace(0.0, 0.036, n)
    turns, phase = rng.uniform(0.5, 2.0), rng.uniform(0.0, 2 * np.pi)
    force = TRUE[law](u + GAUGE - REST)
    force += rng.normal(0.0, noise, n) + drift * np.max(force) * np.sin(
        2 * np.pi * turns * u / 0.036 + phase
    )
    return lab.band_test([lab.Recording("pull.csv", np.arange(n) / 50, u, force)])


READINGS = [
    (7, 0.0005, 0.0),
    (60, 0.005, 0.0),
    (60, 0.0005, 0.002),
    (5000, 0.020, 0.0),
    (5000, 0.005, 0.002),
]
# The quick run takes each law and each kind of readings, not each of one with each of the other.
CURVES = [
    (law, *readings)
    for k, law in enumerate(TRUE)
    for j, readings in enumerate(READINGS)
    if SIZE == "full" or (k + j) % 3 == 0
]


@pytest.mark.slow
@pytest.mark.parametrize(("law", "n", "noise", "drift"), CURVES)
def test_the_law_that_made_one_curve_is_chosen_with_noise_and_with_drift(law, n, noise, drift):
    draws = examples(1, full=40)
    right = 0
    for seed in range(draws):
        choice = lab.choose_law(curve(law, n, noise, drift, seed))
        right += choice.chosen.law.name == law
        assert choice.folds == "nothing"
    assert right >= 0.9 * draws


@pytest.mark.slow
def test_a_clean_curve_that_bends_is_no_line_and_its_rest_length_is_not_that_of_one():
    # A line leaves 6 mN and a cubic the noise; the rest length is 10 mm.
    rng = np.random.default_rng(0)
    u = np.linspace(0.0, 0.036, 300)
    e = u + GAUGE - REST
    force = 40.0 * e - 500 * e**2 + 8500 * e**3 + rng.normal(0.0, 0.002, len(u))
    test = lab.band_test([lab.Recording("pull.csv", np.arange(300) / 10, u, force)])
    choice = lab.choose_law(test, GAUGE)
    line = choice.named("linear")
    assert line.fitted.rmse > 3 * choice.chosen.fitted.rmse
    assert choice.chosen.law.name == "cubic"
    assert choice.rest_length == pytest.approx(REST, abs=3e-4)
    assert abs(GAUGE + line.fitted.onset - REST) > 3e-4
    assert "independent readings" in choice.reason and "linear leaves" in choice.reason
    told = this_band(test, choice)
    assert told is not None
    _, onset = told
    assert onset.low <= REST - GAUGE <= onset.high


@pytest.mark.slow
@pytest.mark.parametrize("noise", [0.0005, 0.020])
def test_the_intervals_of_one_curve_hold_the_truth(noise):
    draws, inside = examples(6, full=200), np.zeros(2)
    for seed in range(draws):
        test = curve("linear", 400, noise, 0.0, seed)
        told = this_band(test, lab.choose_law(test, GAUGE))
        assert told is not None
        slope, onset = told
        inside += [slope.low <= 28.5 <= slope.high, onset.low <= REST - GAUGE <= onset.high]
    assert min(inside) >= 0.8 * draws


@pytest.mark.parametrize("alike", [0.0, 0.5, 0.9])
def test_as_many_readings_are_independent_as_make_the_mean_as_sure(alike):
    # Brute force: the variance of the mean of many such series, in readings of variance 1.
    rng = np.random.default_rng(1)
    n, series = 300, 400
    noise = rng.normal(0.0, np.sqrt(1 - alike**2), (n, series))
    values = np.empty_like(noise)
    values[0] = rng.normal(0.0, 1.0, series)
    for k in range(1, n):
        values[k] = alike * values[k - 1] + noise[k]
    wanted = 1.0 / np.var(values.mean(axis=0))
    found = np.median([independent(one) for one in values.T])
    assert found == pytest.approx(wanted, rel=0.25)


def test_a_number_that_explains_nothing_never_pays():
    rng = np.random.default_rng(2)
    for n in (7, 20, 60):
        left = rng.normal(0.0, 1.0, n)
        scores = [criterion(left, numbers, n, 0.0) for numbers in (2, 3, 4, 5)]
        assert scores == sorted(scores)
        assert criterion(0.1 * left, 4, n, 0.0) < scores[0]
