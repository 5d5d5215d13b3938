"""The rig of a test machine as a file: all of it comes back, and nonsense is refused in words."""

import math

import pytest
from hypothesis import given, strategies as st

from stepwell.files import DesignError, loads_rig, rig_toml
from stepwell.lab import Rig


def number(low, high):
    return st.floats(low, high, allow_subnormal=False)


@given(
    st.builds(
        Rig,
        st.one_of(st.just(math.inf), number(0.02, 1000.0)),
        number(0.5, 2.0),
        number(-0.01, 0.01),
        number(-0.01, 0.01),
        number(0.0, 1.0),
        number(0.0, 1e6),
    )
)
def test_a_rig_comes_back_as_it_was(rig):
    again = loads_rig(rig_toml(rig))
    for name in ("bar", "stretch", "start_loading", "start_unloading", "compliance", "friction"):
        assert getattr(again, name) == pytest.approx(getattr(rig, name), rel=1e-12, abs=1e-300)


def test_what_is_left_out_is_as_drawn():
    assert loads_rig("stretch = 1.02") == Rig(stretch=1.02)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("", "is empty"),
        ("stretch = 0.49", "stretch = 0.49: must be > 0 (0.5 to 2)"),
        ("stretch = 2.01", "stretch = 2.01: must be > 0 (0.5 to 2)"),
        ("stretch = nan", "stretch = NaN: must be a finite number"),
        ("bar_mm = 19", "bar_mm = 19: must be from 20 to 1e6"),
        ("start_loading_mm = -10.1", "start_loading_mm = -10.1: must be from -10 to 10"),
        ("start_unloading_mm = 10.1", "start_unloading_mm = 10.1: must be from -10 to 10"),
        ("compliance_mm_per_N = -0.1", "compliance_mm_per_N = -0.1: must be from 0 to 1e3"),
        ("compliance_mm_per_N = 1001", "compliance_mm_per_N = 1001: must be from 0 to 1e3"),
        ("friction_N = true", "friction_N = true: must be a number"),
        ("frictions_N = 1", "did you mean friction_N?"),
        ("stretch = [1]", "must be a number"),
        ("stretch", "line 1"),
    ],
)
def test_what_no_rig_can_be_is_said(text, problem):
    with pytest.raises(DesignError) as found:
        loads_rig(text, "rig.toml")
    assert problem.lower() in str(found.value).lower()
    assert str(found.value).startswith("rig.toml: ")
