"""The window of a band test, laws that are wrong on it, and tension that is counted negative."""

import json

import numpy as np
import pytest

from facts import says
from lab.machine import recording, there
from stepwell import lab
from stepwell.accounts import account, page, terminal

LINES = 25  # of a screen


def soft(stroke):
    """Tension [N] that softens within the first quarter of 160 mm."""
    return 1.0 - np.exp(-stroke / 0.025) + 3.0 * stroke


def pulled(curve, length, noise=0.002, sign=1.0, start=0.0, name="soft.csv"):
    up = there(length)
    force = curve(up) + np.random.default_rng(0).normal(0.0, noise, len(up))
    return recording(name, sign * up + start, sign * force)


def fitted(run, window=None, law=None):
    test = lab.band_test([run], window=window)
    return lab.fit_bands(test, lab.choose_law(test), law)


def test_the_window_is_the_whole_test_and_the_written_band_holds_at_its_end():
    fit = fitted(pulled(soft, 0.160))
    assert fit.test.window == pytest.approx((0.0, 0.160), abs=2e-3)
    assert fit.written.fitted.tension(np.array([0.160]))[0] == pytest.approx(1.48, rel=0.05)


def test_a_law_that_is_wrong_outside_of_its_window_is_reported_with_the_place():
    fit = fitted(pulled(soft, 0.160), (0.005, 0.035), "cubic")
    wrong = fit.wrong
    assert wrong is not None and wrong.law == "cubic"
    assert wrong.stroke == pytest.approx(0.160, abs=2e-3)
    assert abs(wrong.predicted - wrong.measured) > 3 * wrong.error
    assert wrong.start <= 0.006 and 0.034 <= wrong.end < 0.08
    says(fit.warnings, "cubic", "159 mm", "--window")
    found = account(fit)
    assert len(terminal(found)) <= LINES
    assert found.record["law_wrong"]["stroke_mm"] == pytest.approx(160, abs=2)
    says([line.text for line in terminal(found)], "cubic law", "wrong")
    assert json.loads(json.dumps(found.record, allow_nan=False)) == found.record


@pytest.mark.parametrize("noise", [0.0, 0.005])
def test_a_law_that_holds_on_the_test_has_no_warning(noise):
    for window in (None, (0.005, 0.035)):
        fit = fitted(pulled(lambda stroke: 30 * stroke, 0.060, noise), window)
        assert fit.wrong is None and fit.warnings == ()


def test_a_stroke_may_begin_anywhere():
    fit = fitted(pulled(lambda stroke: 30 * stroke, 0.004, start=0.100, noise=0.0))
    assert fit.stiffness.value == pytest.approx(30, rel=1e-3)


def test_tension_and_stroke_that_are_counted_negative_give_the_same_band():
    plain, turned = (fitted(pulled(soft, 0.060, sign=sign)) for sign in (1.0, -1.0))
    assert turned.stiffness.value == pytest.approx(plain.stiffness.value, rel=1e-9)
    assert turned.test.window == pytest.approx(plain.test.window)


def test_the_screen_has_the_band_of_a_design_file_and_the_page_all_laws():
    found = account(fitted(pulled(soft, 0.060)))
    lines = [line.text for line in terminal(found)]
    assert len(lines) <= LINES
    says(lines, "band = {", "}")
    for law in ("linear", "cubic", "neo-Hookean", "Ogden", "Yeoh"):
        assert law in page(found)
