"""The turning points of a computed path are strokes of that chain, however far open ends go on."""

import math

import numpy as np
import pytest

import stepwell as sw
from facts import refuses
from sizes import examples
from statics.open_cells import any_open, happened
from stepwell.mechanism import trilinear


@pytest.mark.parametrize("stiffness", [math.inf, 0.0, 1e-3, 100.0, 1e6])
def test_the_turning_points_of_a_path_are_no_slip_of_unit_and_give_it_again(stiffness):
    rng = np.random.default_rng(8)
    # A curve that goes on with 1 N/m past its end, beside others that need far more force.
    soft = sw.Element.from_points((0.0, 0.003, 0.006), (0.0, 0.3, 0.303), stops=(True, False))
    for _ in range(examples(3)):
        chain = sw.Chain([soft, any_open(rng)], actuator_stiffness=stiffness)
        path = chain.cycle().path
        begin = sw.statics.Configuration(path.start, path.start_sheet)
        again = chain.path(path.turning_points, start=begin)
        assert again.turning_points == path.turning_points
        assert happened(again) == happened(path)
        assert again.end == pytest.approx(path.end, abs=1e-12)


def test_a_stroke_in_mm_is_still_a_slip_of_unit_for_an_open_curve():
    chain = sw.Chain([trilinear(), trilinear()])
    with refuses(ValueError, "turning_points[1] = 20 m", "0.02 m"):
        chain.path([0.0, 20.0])
