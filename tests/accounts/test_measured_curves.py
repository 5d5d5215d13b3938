"""What the scatter of measured points and the error band of a curve mean for a result."""

from dataclasses import replace

import numpy as np
import pytest

import stepwell as sw
from facts import refuses, says
from stepwell.accounts import account, card, page, terminal
from stepwell.accounts.chain import ERROR_BAND
from stepwell.design import Run

_X = np.linspace(0.0, 0.011, 40)


def points(sd: float) -> tuple[np.ndarray, np.ndarray]:
    t = _X / 0.010
    force = 3.0 * t - 9.0 * t**2 + 7.0 * t**3
    return _X, force + sd * np.random.default_rng(3).standard_normal(len(_X))


def chain(sd: float, **options) -> sw.Chain:
    table = sw.Element.from_table(*points(sd), "clip", stops=True, **options)
    return sw.Chain([table, sw.elements.trilinear(name="spring")])


def _text(result) -> str:
    return "\n".join(line.text for line in terminal(account(result)))


RESULTS = {
    "run": Run.of,
    "cycle": lambda one: one.cycle(),
    "graph": lambda one: one.graph(),
    "program": lambda one: one.program("00"),
}


@pytest.mark.parametrize("result", RESULTS)
def test_scatter_of_points_is_a_warning_of_every_result(result):
    found = RESULTS[result](chain(0.02))
    says(_text(found), "Measured curves", "scatter", "noise_N")


@pytest.mark.parametrize("result", RESULTS)
def test_exact_points_have_no_warning(result):
    assert "Measured curves" not in _text(RESULTS[result](chain(0.0)))


def test_the_noise_that_the_warning_names_removes_it_and_gives_a_band():
    noisy = Run.of(chain(0.02))
    (note,) = account(noisy).record["curve_notes"]
    smooth = Run.of(chain(0.02, noise=float(note.partition("noise_N = ")[2].split()[0])))
    assert account(smooth).record["curve_notes"] == []
    assert smooth.dissipated_range is not None
    low, high = smooth.dissipated_range
    exact = Run.of(chain(0.0)).cycle.dissipated
    assert low < exact < high
    says(card(account(smooth)), "within error bands")


def test_a_band_that_can_hide_a_phase_is_reported():
    wide = sw.Element.from_table(*points(0.0), noise=0.15, stops=True)
    says(_text(sw.Chain([wide]).cycle()), "Measured curves", "error band", "hide")


def test_a_run_without_measured_curves_has_no_band():
    run = Run.of(chain(0.0))
    assert run.dissipated_range is None and run.within_bands == ()
    assert account(run).record["dissipated_low_mJ"] is None


def test_an_order_that_the_band_decides_is_reported():
    one, two = (sw.Element.from_table(*points(0.0), name, noise=0.01) for name in "AB")
    run = Run.of(sw.Chain([one, replace(two, force_scale=1.005)]))
    assert run.other_sequences
    says(_text(run), "Measured curves", "error bands")


def test_a_band_moves_peaks_up_and_valleys_down():
    element = sw.Element.from_table(*points(0.0), noise=0.01)
    band = element.error_band
    (up, down), (more, less) = element.fields[0], element.at_band(1.0).fields[0]
    assert (more - up, down - less) == pytest.approx((band, band))
    wide = sw.Element.from_table(*points(0.0), noise=0.2)
    if len(wide.phases) > 1:
        with refuses(ValueError, "error_band"):
            wide.at_band(-1.0)


def test_points_in_millimetres_are_a_slip_of_unit():
    with refuses(ValueError, "travel"):
        sw.Element.from_points([0, 1, 2, 3], [0, 1, -1, 2])


def loose(sd: float = 0.0, **options) -> sw.Chain:
    table = sw.Element.from_table(*points(sd), "clip", **options)
    stiff = sw.Element.from_table(*points(sd), "stiff", **options)
    return sw.Chain([table, replace(stiff, force_scale=8.0)])


def test_travel_past_the_end_of_a_measured_curve_is_a_warning():
    run, program = Run.of(loose()), loose().program("11")
    assert isinstance(program, sw.sequences.Program)
    for found, path in ((run, run.cycle.path), (program, program.path)):
        says(_text(found), "Extrapolated curves", "Element clip", "0 to 11 mm", "extrapolated")
        ends = [travel for cell, travel in path.extrapolated if cell == 0]
        travels = path.travel[:, 0]
        assert ends and set(ends) <= {travels.min(), travels.max()}
        past = account(found).record["extrapolated"]
        assert [one["used_mm"] for one in past if one["cell"] == "clip"] == [1e3 * x for x in ends]
    says(_text(run.cycle), "Extrapolated curves", "Element clip")


def test_stops_and_straight_ends_are_not_extrapolated():
    assert loose(stops=True).cycle().path.extrapolated == ()
    assert sw.preset("trilinear").cycle().path.extrapolated == ()
    assert "Extrapolated" not in _text(Run.of(chain(0.0)))


def test_the_error_band_has_one_definition():
    run = account(Run.of(chain(0.02, noise=0.02)))
    assert run.record["cells"][0]["error_band_N"] > 0.0
    assert ERROR_BAND in page(run)
