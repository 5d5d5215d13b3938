"""Whether a stroke program survives what a workshop does to a design."""

import math
from dataclasses import replace

import pytest

import stepwell as sw
from stepwell.design import Tolerances, survival

LEG = sw.preset("paper-forward")
PROGRAM = (0.020, 0.0386, 0.020)


def test_without_tolerances_every_mechanism_does_what_the_drawing_does():
    made = survival(LEG, PROGRAM, "01", Tolerances(), start="10", samples=3)
    assert made.fraction == 1 and made.interval[1] == 1
    assert survival(LEG, PROGRAM, "10", Tolerances(), start="10", samples=3).successes == 0


@pytest.mark.slow
def test_the_mechanisms_are_those_of_yields():
    wide = Tolerances(anchor=0.004, stiffness=0.1)
    made = survival(LEG, PROGRAM, "01", wide, start="10", samples=60, seed=3)
    drawn = LEG.yields(wide, samples=60, seed=3)
    count = 0
    for number in range(60):
        end = drawn.mechanism(number).path(PROGRAM, start="10").end
        count += end[0] < 1e-9 and end[1] > 0.01
    assert made.successes == count and 0 < count < 60


def test_levers_that_differ_move_the_stops_and_the_actuator_stops_with_them():
    made = survival(LEG, (0.0, 0.040, 0.0), "00", Tolerances(lever=0.0005), samples=20)
    assert made.fraction == 1


def test_a_prescribed_force_runs_its_program_too():
    pulled = replace(LEG, actuator_stiffness=0.0)
    program = pulled.program("01")
    built = survival(pulled, program.turning_points, "01", Tolerances(stiffness=0.02), samples=20)
    assert built.fraction == 1


def test_it_says_how_sure_it_is():
    made = survival(LEG, PROGRAM, "01", Tolerances(anchor=0.001), start="10", samples=50)
    low, high = made.interval
    assert low < made.fraction <= high
    assert "of 50" in repr(made) and "10 to 01" in repr(made)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"target": "011"}, "target = '011': must be 2 characters"),
        ({"target": "01", "start": "x0"}, "start = 'x0'"),
        ({"target": "01", "samples": 0}, "samples = 0: must be 1 or more"),
    ],
)
def test_a_question_without_sense_is_refused(given, words):
    with pytest.raises(ValueError, match=words):
        survival(LEG, PROGRAM, tolerances=Tolerances(), **given)


def test_progress_ends_at_the_number_of_mechanisms():
    calls = []
    survival(
        LEG, PROGRAM, "01", Tolerances(), start="10", samples=2, progress=lambda *a: calls.append(a)
    )
    assert calls[-1] == (2, 2) and math.isclose(calls[0][0], 0)
