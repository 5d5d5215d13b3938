"""An element from a recording: its phases come back, noise makes none, and doubts are stated."""

import math
from dataclasses import replace

import numpy as np
import pytest

import stepwell as sw
from accounts.schemas import violations
from facts import refuses, says
from lab import known_curves
from lab.machine import recording
from sizes import examples
from stepwell import figures, lab
from stepwell.accounts import account, card, page, terminal
from stepwell.accounts.chain import ERROR_BAND

_X = np.linspace(0.0, 0.011, 1000)
_PEAK, _VALLEY = 2.2654e-3, 6.3060e-3


def law(x):
    t = x / 0.010
    return 3.0 * t - 9.0 * t**2 + 7.0 * t**3


def noise(seed, size=1000, sd=0.01) -> np.ndarray:
    return sd * np.random.default_rng(seed).standard_normal(size)


def taken(stroke, force, **options) -> lab.MeasuredElement:
    return lab.measure_element(recording("clip_1.csv", stroke, force), **options)


def there_and_back(friction=0.05, seed=0) -> tuple[np.ndarray, np.ndarray]:
    force = np.concatenate([law(_X) + friction, law(_X)[::-1] - friction])
    return np.concatenate([_X, _X[::-1]]), force + noise(seed, 2000)


def turns(measured) -> tuple[float, float]:
    (_, peak), (valley, _) = measured.phases
    return peak, valley


@pytest.mark.parametrize("count", [25, pytest.param(examples(75, 200), marks=pytest.mark.slow)])
def test_known_phases_come_back_from_white_noise_to_five_percent_of_the_drop(count):
    counts = known_curves.of_snaps(count, 0)
    assert counts.right >= 0.97 * count
    assert counts.placed >= 0.9 * count
    assert counts.inside >= 0.9 * count


@pytest.mark.parametrize("count", [25, pytest.param(examples(75, 200), marks=pytest.mark.slow)])
def test_white_noise_makes_no_phase(count):
    assert known_curves.invented(count, 1) == (0, 0)


@pytest.mark.parametrize("factor", [0.9, 0.98, 0.995])
def test_correlated_noise_is_refused_and_makes_no_phase(factor):
    phases, refused = known_curves.invented(25, 1, factor)
    assert phases == 0 and refused > 0


def test_the_mean_of_both_halves_is_the_curve_and_half_their_difference_friction():
    found = taken(*there_and_back())
    assert (found.half, found.rows) == ("both", 2000)
    assert found.friction == pytest.approx(0.05, abs=0.001)
    assert found.noise == pytest.approx(0.01, rel=0.1)
    assert turns(found) == pytest.approx((_PEAK, _VALLEY), abs=1e-4)
    assert np.max(np.abs(found.element.force_at(_X) - law(_X))) < found.error_band


def test_one_half_is_used_where_it_is_asked_for():
    stroke, force = there_and_back()
    up, down = (taken(stroke, force, half=half) for half in ("loading", "unloading"))
    assert (len(up.unloading), len(down.loading)) == (0, 0)
    assert up.friction == down.friction == 0.0
    peak = up.element.phases[0].force_high - down.element.phases[0].force_high
    assert peak == pytest.approx(0.1, abs=0.01)


def test_travel_before_contact_is_left_out_and_its_force_is_zero():
    far = np.linspace(-0.005, 0.0, 400, endpoint=False)
    stroke = np.concatenate([far, _X])
    force = 0.3 + np.concatenate([np.zeros(400), law(_X)]) + noise(1, 1400)
    found = taken(stroke, force)
    assert found.approach == pytest.approx(5e-3, abs=1e-4)
    assert found.element.phases[0].force_high == pytest.approx(law(_PEAK), abs=found.error_band)
    says(found.notes, "without contact")


def test_signs_counted_negative_are_turned_and_reported():
    stroke, force = there_and_back()
    found = taken(-stroke, -force)
    assert turns(found) == pytest.approx((_PEAK, _VALLEY), abs=1e-4)
    says(found.notes, "signs are turned")


def test_outliers_are_replaced_and_counted():
    force = law(_X) + noise(2)
    force[[100, 400, 700]] += [0.5, 0.6, -0.8]
    found = taken(_X, force)
    assert found.outliers == 3
    assert turns(found) == pytest.approx((_PEAK, _VALLEY), abs=1e-4)


def test_halves_of_two_branches_are_refused_and_one_half_is_an_element():
    up, down = (np.where(at > _X, 250 * _X, 250 * (_X - 3e-3)) for at in (4e-3, 2.5e-3))
    stroke = np.concatenate([_X, _X[::-1]])
    force = np.concatenate([up, down[::-1]]) + noise(3, 2000)
    with refuses(lab.LabError, "no curve", "--half loading"):
        taken(stroke, force)
    assert len(taken(stroke, force, half="loading").phases) == 2


@pytest.mark.parametrize(
    ("stop", "shape", "stops"),
    [("high", law(_X[:600]), (False, True)), ("both", -law(_X), (True, True))],
)
def test_an_end_that_falls_names_the_stops_that_are_missing(stop, shape, stops):
    force = shape + noise(4, len(shape))
    with refuses(lab.LabError, f"--stops {stop}"):
        taken(_X[: len(shape)], force)
    assert taken(_X[: len(shape)], force, stops=stops).element.stops == stops


def test_a_random_walk_is_refused_until_the_least_drop_is_given():
    walk = 100.0 * _X + np.cumsum(noise(0))
    with refuses(lab.LabError, "correlated", "--least-drop"):
        taken(_X, walk)
    found = taken(_X, walk, least_drop=0.5)
    assert len(found.phases) == 1 and found.correlated
    says(found.notes, "correlated")


def test_a_change_as_small_as_the_error_band_is_called_uncertain():
    wavy = 100.0 * _X + 0.12 * np.sin(2.0 * math.pi * _X / 0.0055)
    found = taken(_X, wavy + noise(5, sd=0.02))
    assert len(found.phases) > 1
    says(found.notes, "phase is uncertain")


@pytest.mark.parametrize(
    ("force", "fact"),
    [
        (np.ones(1000), "everywhere"),
        (1.0 + noise(6), "from its noise"),
        (law(_X) + 0.1 * np.sin(2.0e4 * _X) + noise(1), "vibration"),
    ],
)
def test_a_force_that_shows_no_element_is_refused(force, fact):
    with refuses(lab.LabError, fact):
        taken(_X, force)


def test_few_rows_need_the_noise():
    with refuses(lab.LabError, "7 rows", "noise="):
        taken(_X[::160], law(_X[::160]))
    assert len(taken(_X[::160], law(_X[::160]), noise=0.01).phases) == 2


def test_a_recording_in_metres_is_refused():
    with refuses(lab.LabError, "11 m", "0.011 m"):
        taken(1000.0 * _X, law(_X) + noise(7))


def test_an_element_comes_from_a_file_and_its_curve_is_read_again(tmp_path):
    rows = zip(_X * 1e3, law(_X) + noise(8), strict=True)
    text = "Displacement (mm),Force (N)\n" + "".join(f"{x:.4f},{y:.5f}\n" for x, y in rows)
    (tmp_path / "clip.csv").write_text(text, "utf-8")
    element = sw.Element.from_recording(tmp_path / "clip.csv", "clip")
    found = lab.measure_element(lab.read(tmp_path / "clip.csv"), "clip")
    assert element == found.element and element.error_band > 0.0
    found.to_csv(tmp_path / "element.csv")
    again = sw.load_element(tmp_path / "element.csv", "clip")
    assert replace(again, error_band=element.error_band) == element
    sw.save(found.chain, tmp_path / "clip.toml")
    assert sw.load(tmp_path / "clip.toml").cells == (element,)


def test_the_account_the_schema_and_the_figure_have_the_phases():
    found = taken(*there_and_back())
    record = account(found).record
    assert violations(record) == []
    assert [one["phase"] for one in record["phases"]] == [0, 1]
    for form in ("\n".join(line.text for line in terminal(account(found))), card(account(found))):
        says(form, "2 phases", "error band")
    says(page(account(found)), "2 phases", "Friction")
    assert ERROR_BAND[1:] in page(account(found))
    says("\n".join(line.text for line in terminal(account(found))), "Up at", "previous")
    (ax, *_) = figures.plot(found).axes
    assert {"0", "1"} <= {one.get_text() for one in ax.texts}


def test_a_force_that_only_rises_is_reported_without_snap_through():
    says(str(taken(_X, 100.0 * _X + noise(9))), "1 phase", "monotone", "no snap-through")
