"""Actuators of great stiffness do what a prescribed stroke does; one of -κ exactly is a tie."""

import math
from dataclasses import replace

import numpy as np
import pytest

import stepwell as sw
from facts import says
from sizes import examples
from statics.open_cells import any_open, happened
from stepwell.mechanism import trilinear

NEUTRAL = ((0.0, 0.004, 0.014, 0.018), (0.0, 0.6, -0.4, 0.8))  # falls with 100 N/m


@pytest.mark.parametrize("stiffness", [1e6, 1e9, 1e11, 1e12])
def test_a_stiff_actuator_does_what_a_prescribed_stroke_does(stiffness):
    rng = np.random.default_rng(int(math.log10(stiffness)))
    for _ in range(examples(6)):
        chain = sw.Chain([any_open(rng) for _ in range(rng.integers(1, 4))])
        rigid = chain.cycle().path
        stiff = replace(chain, actuator_stiffness=stiffness).cycle().path
        assert happened(stiff) == happened(rigid)
        # λ differs by no more than the forces there are, and with it the stroke by F/K.
        force = max(abs(rigid.peak_force), 1.0)
        strokes = [[event.stroke for event in path.events] for path in (rigid, stiff)]
        assert strokes[1] == pytest.approx(strokes[0], abs=30 * force / stiffness + 1e-12)


def test_an_element_that_rests_below_its_first_travel_starts_behind_a_stiff_actuator():
    # Drive and stroke were both negative, and their rounding was taken for none.
    stiff = sw.Chain([trilinear()], actuator_stiffness=1e11).cycle()
    rigid = sw.Chain([trilinear()]).cycle()
    assert str(stiff.sequence) == str(rigid.sequence)
    assert stiff.dissipated == pytest.approx(rigid.dissipated, abs=1e-9)


def test_an_actuator_as_stiff_as_a_cell_falls_is_a_tie_as_another_cell_is():
    element = sw.Element.from_points(*NEUTRAL)
    alone = sw.Chain([element], actuator_stiffness=100.0).cycle()
    spring = sw.Element.from_points((-0.020, 0.0, 0.020), (-2.0, 0.0, 2.0))
    pair = sw.Chain([element, spring]).cycle()
    assert len(alone.degenerate) == len(pair.degenerate) == 2
    assert all(snap.tie and snap.released < 1e-11 for snap in alone.snaps)


@pytest.mark.parametrize("share", [0.9, 0.999, 1.001, 1.1])
def test_an_actuator_of_another_stiffness_is_no_tie(share):
    element = sw.Element.from_points(*NEUTRAL)
    cycle = sw.Chain([element], actuator_stiffness=100.0 * share).cycle()
    assert not cycle.degenerate
    assert (len(cycle.snaps) > 0) == (share < 1.0)


def test_the_advice_on_a_neutral_actuator_ends_the_tie():
    element = sw.Element.from_points(*NEUTRAL)
    chain = sw.Chain([element], actuator_stiffness=100.0)
    says(chain.cycle().degenerate[0].advice, "Scale the forces", "cell 1", "a percent")
    for scale in (0.99, 1.01):
        other = replace(chain, cells=[replace(element, force_scale=scale)])
        assert not other.cycle().degenerate
