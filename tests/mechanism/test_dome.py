"""The rubber dome: the numbers it was measured with."""

import pytest

from facts import refuses
from stepwell.base import InputError
from stepwell.mechanism import dome


def test_it_collapses_at_the_force_that_was_measured():
    # The recording peaks with 57.0 gf from 1.395 to 1.450 mm and is lowest after that with 47.2 gf
    # at 3.200 mm; it first rises at 0.190 mm.
    pressed = dome()
    (fields,) = pressed.fields
    assert fields == pytest.approx((57.0 * 9.80665e-3, 47.3 * 9.80665e-3), rel=1e-9)
    first, last = pressed.phases
    assert first.high == pytest.approx(1.24e-3) and last.low == pytest.approx(3.015e-3)
    assert not pressed.is_bistable


def test_domes_side_by_side_add_up():
    assert dome(3).largest_force == pytest.approx(3 * dome().largest_force)
    with refuses(InputError, "count = 0", "whole number >= 1"):
        dome(0)
