"""Bands: what was put in comes out, inside the stated interval, with what was used and dropped."""

from functools import cache

import numpy as np
import pytest

from facts import refuses, says
from lab.machine import recording, tension, there
from sizes import cases, examples
from stepwell import files, lab
from stepwell.lab.bands.laws import LAWS

DRAWS = examples(80)
OFTEN = 0.90
TRUE = {"stiffness": 28.5, "onset": -0.005}


def noise(rng, size=4000) -> np.ndarray:
    return rng.normal(0.0, 0.005, size)


def line(stiffness, onset=TRUE["onset"]):
    return lambda u: stiffness * (u - onset)


def softening(factor):
    # The curve of the paper's bands: tangent 47, 22.5 and 65 N/m at 5, 15 and 35 mm.
    return lambda u: (
        factor * (56.3 * (u + 0.0013) - 1905 * (u + 0.0013) ** 2 + 35720 * (u + 0.0013) ** 3)
    )


def curves(shape, samples=3, scatter=0.03, seed=0, cycles=(5, 6)):
    """A test of bands that scatter in stiffness."""
    rng = np.random.default_rng(seed)
    recordings = []
    for sample in range(1, samples + 1):
        factor = rng.normal(1.0, scatter)
        recordings += [tension(sample, c, shape(factor), noise=noise(rng)) for c in cycles]
    return lab.band_test(recordings)


@cache
def softened(scatter=0.03):
    """A test of rubber that several tests look at."""
    return curves(softening, scatter=scatter)


@cache
def chosen(gauge=None):
    """The choice of a law for it, which takes half a second."""
    return lab.choose_law(softened(), gauge=gauge)


def test_stiffness_is_the_slope_inside_the_window():
    test = curves(lambda f: line(f * 28.5), scatter=0.0)
    found = lab.stiffness(test)
    assert found.value == pytest.approx(28.5, abs=0.02)
    assert len(found.each) == 3


@pytest.mark.slow
def test_the_stated_interval_of_the_stiffness_holds_the_truth():
    inside = one_more = 0
    for seed in range(DRAWS):
        rng = np.random.default_rng(seed)
        k = rng.normal(28.5, 0.7, 4)
        up = np.linspace(0.0, 0.04, 60)
        runs = [
            recording(f"Samp{s}_{5}.txt", up, line(k[s])(up) + noise(rng, 60)) for s in (0, 1, 2)
        ]
        found = lab.stiffness(lab.band_test(runs, window=(0.005, 0.035)))
        inside += found.low <= 28.5 <= found.high
        one_more += found.next_low <= k[3] <= found.next_high
    assert inside >= OFTEN * DRAWS
    assert one_more >= OFTEN * DRAWS


@pytest.mark.slow
# A polynomial, one with a rest length and one with an exponent; the others are of these kinds.
@pytest.mark.parametrize("name", cases([law.name for law in lab.LAWS], ["cubic", "Yeoh", "Ogden"]))
def test_numbers_of_every_law_are_found_again_inside_their_intervals(name):
    # With the length at stroke 0 known, so that every number can be told.
    gauge, truth = (
        0.022,
        {
            "linear": (-0.005, np.nan, np.nan, [28.5]),
            "neo-Hookean": (-0.002, 0.020, np.nan, [0.6]),
            "cubic": (-0.0013, np.nan, np.nan, [56.3, -1905.0, 35720.0]),
            "Ogden": (-0.002, 0.020, 3.0, [0.4]),
            "Yeoh": (-0.002, 0.020, np.nan, [0.4, -0.03, 0.006]),
        }[name],
    )
    law = next(law for law in LAWS if law.name == name)
    onset, length, exponent, coefficients = truth
    u = np.linspace(0.005, 0.035, 61)
    basis = law.basis(u - onset, length, exponent)
    inside: dict[str, int] = {}
    # To fit exponents takes ten times as long.
    draws = examples(20 if name == "Ogden" else 40, full=1600)
    for seed in range(draws):
        rng = np.random.default_rng(seed)
        each: dict[str, dict[int, float]] = {}
        for sample in range(3):
            c = np.array(coefficients) * rng.normal(1.0, 0.02)
            force = basis @ c + rng.normal(0.0, 0.001, len(u))
            for key, value in lab.fit(law, u, force, gauge).values.items():
                each.setdefault(key, {})[sample] = value
        true = {"onset [m]": onset, "rest length [m]": length, "exponent [1]": exponent}
        true |= {
            f"{n} [{unit}]": v for (n, unit), v in zip(law.coefficients, coefficients, strict=True)
        }
        for key, values in each.items():
            found = lab_estimate(values)
            inside[key] = inside.get(key, 0) + (found.low <= true[key] <= found.high)
    assert min(inside.values()) >= OFTEN * draws, inside


def lab_estimate(values):
    from stepwell.lab.bands.halves import of_samples

    return of_samples(values)


@pytest.mark.slow
@pytest.mark.parametrize("draw", range(examples(1, full=20)))
def test_the_law_that_made_the_curves_is_chosen_before_richer_ones(draw):
    straight = curves(lambda f: line(f * 28.5), samples=2, seed=draw)
    assert lab.choose_law(straight).chosen.law.name == "linear"
    cubic = lab.choose_law(curves(softening, seed=draw)) if draw else chosen()
    assert cubic.chosen.law.name == "cubic"
    assert cubic.named("linear").score > 5 * cubic.chosen.score
    assert cubic.folds == "sample"


@pytest.mark.slow
def test_a_single_sample_is_said_to_show_no_scatter():
    test = curves(softening, samples=1, cycles=(5, 6, 7))
    found = lab.stiffness(test)
    assert np.isnan(found.low) and "not known" in repr(found)
    choice = lab.choose_law(test)
    assert choice.folds == "cycle"
    says(lab.band_table(lab.fit_bands(test, choice)), "95 %", "one sample")


@pytest.mark.slow
def test_with_one_curve_the_law_is_chosen_by_what_it_explains_and_it_is_reported():
    test = curves(softening, samples=1, cycles=(5,))
    choice = lab.choose_law(test)
    assert choice.chosen.law.name == "cubic"
    assert choice.folds == "nothing"
    says(choice.reason, "Chosen: cubic", "Schwarz", "independent readings")
    says(lab.band_table(lab.fit_bands(test, choice)), "cubic", "no other curve")
    assert min(law.above_best for law in choice.candidates) == 0


@pytest.mark.slow
def test_the_rest_length_is_said_to_be_unknown_unless_the_gauge_is_given():
    test, unknown = softened(), chosen()
    assert unknown.rest_length is None
    assert "cannot be identified" in unknown.rest_length_reason()
    text = lab.band_table(lab.fit_bands(test, unknown))
    assert "rest_length_mm =" not in text
    says(text, "rest_length_mm", "10 mm")
    known = chosen(gauge=0.0213)
    assert known.rest_length == pytest.approx(0.020, abs=2e-4)
    assert "rest_length_mm = " in lab.band_table(lab.fit_bands(test, known))
    with pytest.raises(ValueError, match="gauge = -1 m: must be > 0"):
        lab.choose_law(test, gauge=-1)


@pytest.mark.slow
@pytest.mark.parametrize("law", [law.name for law in lab.LAWS])
def test_the_table_can_be_pasted_into_a_design_file_and_gives_the_fitted_tension(law):
    test, choice = softened(), chosen(gauge=0.0213)
    text = lab.band_table(lab.fit_bands(test, choice, law), "my bands")
    says(text, "# From", "my bands", "stepwell ")
    says(text, "1, 2, 3", "5 to 9", "loading", "0 to 45 mm")
    chain = files.loads(f"[chain]\n{text}[[chain.cell]]\np_mm = [-10, 0]\nq_mm = [10, 0]\n").chain
    (band,) = chain.levers[0].bands
    stroke = np.linspace(0.006, 0.034, 9)
    fitted = choice.named(law).fitted.tension(stroke)
    assert band.tension(0.0213 + stroke) == pytest.approx(fitted, abs=0.006)


@pytest.mark.slow
def test_a_law_that_is_not_known_is_refused():
    test = softened()
    with refuses(ValueError, "law = 'quartic'", "linear, "):
        lab.fit_bands(test, chosen(), "quartic")


def test_the_loss_of_every_cycle_is_reported():
    test = curves(lambda f: line(f * 28.5, 0.0), cycles=(1, 5), scatter=0.0)
    loss = lab.hysteresis(test)
    assert loss.sel(sample=2, cycle=5).item() == pytest.approx(0.25, abs=0.01)
    assert dict(loss.sizes) == {"sample": 3, "cycle": 2}


def test_stiffness_depends_on_the_window_and_the_table_says_how():
    table = lab.stiffness_by_window(softened(0.0))
    low, high = (
        table.sel(start=0.010, end=0.020, method="nearest"),
        table.sel(start=0.025, end=0.035, method="nearest"),
    )
    assert low.item() < 25 < 40 < high.item()
    # 5 to 35 mm of a cubic has the slope of its least-squares line.
    u = np.linspace(0.005, 0.035, 500)
    assert table.sel(start=0.005, end=0.035, method="nearest").item() == pytest.approx(
        np.polyfit(u, softening(1.0)(u), 1)[0], abs=0.1
    )


def test_what_is_used_and_what_is_dropped_is_reported():
    rng = np.random.default_rng(0)
    runs = [tension(s, c, line(28.5), noise=noise(rng)) for s in (1, 2) for c in (4, 5, 6)]
    test = lab.band_test(runs, drop=(2,))
    assert test.samples == (1,)
    says(test.notes, "sample 1", "5, 6", "4")
    says(test.notes, "Samp2_45mm_5.txt: ", "sample 2")


def test_files_that_only_count_are_distinguished_by_cycles_per_sample():
    up = there(0.04)
    stroke = np.concatenate([up, up[::-1]])

    def run(n, k):
        return recording(f"robot_{n}.txt", stroke, line(k)(stroke))

    runs = [run(n, 47.0 if n <= 2 else 40.0) for n in (1, 2, 3, 4)]
    test = lab.band_test(runs, cycles=(1, 2), cycles_per_sample=2)
    assert lab.stiffness(test).each == pytest.approx({1: 47.0, 2: 40.0})
    mixed = lab.band_test([run(1, 40.0), run(2, 40.0), run(3, 47.0)], cycles=(1, 3))
    assert mixed.samples == (1,)
    assert any(line.endswith("another sample?") for line in mixed.notes)


def test_one_recording_may_hold_several_cycles():
    up = there(0.04)
    stroke = np.concatenate([up, up[::-1]] * 3)
    test = lab.band_test([recording("long.txt", stroke, line(30.0)(stroke))], cycles=(2, 3))
    assert [loop.cycle for loop in test.loops] == [1, 2, 3]
    assert lab.stiffness(test).value == pytest.approx(30.0)


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        ({"cycles": (8, 9)}, "cycles 8 to 9 .* cycles 5 to 6"),
        ({"window": (0.005, 0.060)}, "0 to 45 mm .* window of 5 to 60 mm"),
        ({"window": (0.02, 0.01)}, "two rising strokes"),
        ({"drop": (1,)}, "no loading half"),
        ({"cycles": (0, 3)}, "rising numbers"),
    ],
)
def test_a_test_that_cannot_be_fitted_says_what_to_do(options, problem):
    rng = np.random.default_rng(0)
    runs = [tension(1, c, line(28.5), noise=noise(rng)) for c in (5, 6)]
    with pytest.raises(lab.LabError, match=problem):
        lab.band_test(runs, **options)
