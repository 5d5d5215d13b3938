"""Promises about the errors of a build and its yield."""

import math

import pytest

import stepwell as sw
from build import chains
from stepwell.build import build_yield, layout, load_build_file, tolerances_of
from stepwell.build.tolerances import anchor_of_stop, lever_error, stop_error

ACRYLIC = load_build_file("acrylic-3mm")
NONE = dict.fromkeys(
    ("tolerance__hole", "tolerance__joint", "tolerance__stop", "tolerance__kerf"), 0.0
)


def only(chain, **errors):
    """The layout with these errors alone."""
    return layout(chain, ACRYLIC.with_lengths(**{**NONE, **errors}))


def degrees(made):
    return math.degrees(stop_error(made.cells[0], made))


def test_a_stop_off_by_a_tenth_of_a_millimetre_is_off_by_the_angles_of_the_study():
    # Travel error e cot θc by faces, e cos θc by a slot; at 45° and 10√2 mm.
    assert degrees(only(chains.pair(), tolerance__stop=1e-4)) == pytest.approx(0.573, abs=1e-3)
    slot = ACRYLIC.with_lengths(**{**NONE, "tolerance__stop": 1e-4, "stop__faces_to": 0.7})
    assert degrees(layout(chains.pair(), slot)) == pytest.approx(0.405, abs=1e-3)


def test_an_uncorrected_kerf_adds_twice_its_width_to_the_travel_at_45_degrees():
    made = only(chains.pair(), tolerance__kerf=0.18e-3)
    cell = made.cells[0].cell
    # Both ends of the travel, each by r cos θc times the error of the angle.
    added = 2.0 * cell.lever * math.cos(cell.limit) * stop_error(made.cells[0], made)
    assert added == pytest.approx(0.36e-3, abs=1e-6)


def test_joint_slop_changes_travel_by_the_amounts_of_the_study():
    made = only(chains.pair(), tolerance__joint=1e-4)
    cell = made.cells[0].cell
    assert lever_error(made) == pytest.approx(1e-4)
    # S = 2 sqrt(r² - D²) with a face distance D: dS = -2 dr / sin θc.
    faces = 2.0 * 1e-4 * math.sin(cell.limit) + 2.0 * (
        cell.lever * math.cos(cell.limit) * stop_error(made.cells[0], made)
    )
    assert faces == pytest.approx(0.28e-3, abs=3e-6)
    slot = layout(
        chains.pair(),
        ACRYLIC.with_lengths(**{**NONE, "tolerance__joint": 1e-4, "stop__faces_to": 0.7}),
    )
    assert stop_error(slot.cells[0], slot) == 0.0


def test_the_anchor_error_of_a_stop_changes_an_end_force_as_much_as_the_stop_does():
    made = only(chains.pair(), tolerance__stop=1e-4)
    plan = made.cells[0]
    cell, error = plan.cell, stop_error(made.cells[0], made)
    radius = anchor_of_stop(plan, made)
    by_stop = max(
        abs(
            float(sw.Cell(cell.band, limit=cell.limit - error).force(-cell.limit + error))
            - cell.force_0
        ),
        abs(cell.force_1 - float(cell.force(cell.limit - error))),
    )
    by_anchor = max(
        abs(
            cell.with_anchors(q=(0.010 + radius * math.cos(turn), radius * math.sin(turn))).force_0
            - cell.force_0
        )
        for turn in [math.radians(one) for one in range(0, 360, 3)]
    )
    assert by_anchor == pytest.approx(by_stop, rel=0.05)


def test_a_build_without_errors_always_keeps_the_sequence():
    made = only(chains.pair(), tolerance__stiffness=0.0, tolerance__rest_length=0.0)
    given = tolerances_of(made)
    assert (given.anchor, given.lever, given.stiffness) == (0.0, 0.0, 0.0)
    assert build_yield(made, samples=200).fraction == 1.0


def test_larger_errors_make_fewer_builds_keep_the_sequence():
    chain = sw.load("preset:countdown")
    yields = [
        build_yield(only(chain, tolerance__hole=hole), samples=500).fraction
        for hole in (0.0, 0.5e-3, 2e-3)
    ]
    assert yields == sorted(yields, reverse=True)
    assert yields[-1] < 0.9 < yields[0]
