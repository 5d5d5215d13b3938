"""The trilinear spring: its corners, its wells, what it refuses."""

import numpy as np
import pytest

from stepwell.base import InputError
from stepwell.mechanism import trilinear


def test_its_branches_pass_its_corners_with_their_stiffness():
    spring = trilinear((0.003, 2.0), (0.007, 0.5), first=800.0, last=300.0)
    travel = np.array([0.002, 0.003, 0.005, 0.007, 0.009, 0.050])
    force = [2.0 - 800 * 0.001, 2.0, 1.25, 0.5, 0.5 + 300 * 0.002, 0.5 + 300 * 0.043]
    assert spring.force_at(travel) == pytest.approx(force, rel=1e-12)
    (fields,) = spring.fields
    assert fields == pytest.approx((2.0, 0.5))
    assert not spring.is_bistable


def test_equal_wells_of_opposite_forces_are_equally_deep():
    # A force odd about its middle, as of the bi-stable springs of Puglisi & Truskinovsky 2000.
    spring = trilinear()
    assert spring.is_bistable
    assert spring.energy_at(0.016) - spring.energy_at(0.0) == pytest.approx(0.0, abs=1e-15)
    # Two triangles of 1 N over 8 mm, cut in two at zero force, stand between the wells.
    barrier = spring.energy_at(0.008) - spring.energy_at(0.0)
    assert barrier == pytest.approx(0.5 * 1.0 * 0.008, rel=1e-12)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"valley": (0.003, -1.0)}, "must be at a larger travel"),
        ({"valley": (0.012, 1.0)}, "a smaller force"),
        ({"peak": (0.004,)}, "must be two numbers"),
        ({"last": 0.0}, "last = 0.0 N/m: must be > 0"),
    ],
)
def test_what_does_not_snap_is_refused(wrong, message):
    with pytest.raises(InputError, match=message):
        trilinear(**wrong)
