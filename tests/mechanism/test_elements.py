"""Elements as values: curves from points, tables, laws and folds; their phases; side by side."""

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.integrate import quad

import stepwell as sw
from facts import refuses

SNAP = [0.0, 1e-3, 3e-3, 5e-3], [0.0, 1.0, -1.0, 1.5]


def wave(s):
    return np.sin(2e3 * s) + 50.0 * s


def test_points_are_joined_by_lines_that_go_on_past_the_open_ends():
    snap = sw.Element.from_points(*SNAP)
    assert snap.force_at([-1e-3, 0.5e-3, 2e-3, 6e-3]) == pytest.approx([-1.0, 0.5, 0.0, 2.75])
    assert snap.fields == ((1.0, -1.0),)
    first, last = snap.phases
    assert (first.low, first.high, last.low, last.high) == (-math.inf, 1e-3, 3e-3, math.inf)


def test_a_stop_that_the_force_falls_from_is_a_phase_of_its_own():
    cell = sw.Element.from_points([0.0, 0.01], [0.3, -0.2], stops=True)
    assert [(p.low, p.high) for p in cell.phases] == [(0.0, 0.0), (0.01, 0.01)]
    assert cell.fields == ((0.3, -0.2),)
    assert cell.is_bistable


def test_a_table_of_a_lever_cells_force_is_that_cell():
    cell = sw.Cell(sw.Band((-0.010, 0.0), (0.016, 0.004)), name="lever")
    s = np.linspace(0.0, cell.full_travel, 400)
    element = sw.Element.from_table(s, cell.force_at(s), "table", stops=True)
    other = sw.Cell(sw.Band((-0.010, 0.0), (0.010, 0.0)))
    lever, table = (sw.Chain([one, other]).cycle() for one in (cell, element))
    assert str(lever.sequence) == str(table.sequence)
    assert [e.drive for e in table.events] == pytest.approx(
        [e.drive for e in lever.events], rel=1e-5
    )
    assert table.dissipated == pytest.approx(lever.dissipated, rel=1e-4)


def test_levers_are_all_cells_of_a_chain_or_the_first_element_is_named():
    lever = sw.Cell(sw.Band((-0.010, 0.0), (0.016, 0.004)), name="lever")
    assert sw.Chain([lever, lever]).levers == (lever, lever)
    dome, other = (sw.Element.from_points(*SNAP, name) for name in ("dome", "other"))
    with refuses(ValueError, "cells[1] = Element('dome'", "a Cell"):
        _ = sw.Chain([lever, dome, other]).levers


@pytest.mark.slow
@settings(deadline=None, max_examples=25)
@given(st.integers(0, 2**32 - 1))
def test_force_is_the_slope_of_energy_and_phases_hold_where_it_rises(seed):
    rng = np.random.default_rng(seed)
    s = np.cumsum(rng.uniform(0.5e-3, 2e-3, 8))
    force = rng.normal(0.0, 1.0, 8)
    element = sw.Element.from_table(s, force, stops=True)
    a, b = np.sort(rng.uniform(s[0], s[-1], 2))
    work = quad(element.force_at, a, b, points=s[1:-1], limit=200)[0]
    assert element.energy_at(b) - element.energy_at(a) == pytest.approx(work, abs=1e-9)
    for phase in element.phases:
        inside = np.linspace(phase.low, phase.high, 50)
        assert np.all(np.diff(element.force_at(inside)) >= -1e-12)
    # Between two phases it falls all the way.
    for one, two in zip(element.phases, element.phases[1:], strict=False):
        between = element.force_at(np.linspace(one.high, two.low, 50))
        assert np.all(np.diff(between) <= 1e-12)
        assert (one.force_high, two.force_low) == pytest.approx((between[0], between[-1]))


def test_a_law_is_met_to_the_accuracy_that_was_asked_for():
    s = np.linspace(0.0, 6e-3, 2001)
    for accuracy in (1e-5, 1e-9):
        element = sw.Element.from_law(wave, 0.0, 6e-3, accuracy=accuracy)
        assert (
            np.max(np.abs(element.force_at(s) - wave(s))) <= 2.0 * accuracy * element.largest_force
        )
        assert len(element.phases) == 3


def test_a_kink_is_found_and_costs_less_where_it_is_named():
    def kinked(s):
        return np.where(s < 0.7e-3, s, 1.4e-3 - s) * 1e3

    named = sw.Element.from_law(kinked, 0.0, 2e-3, kinks=[0.7e-3], stops=True)
    searched = sw.Element.from_law(kinked, 0.0, 2e-3, stops=True)
    assert len(named.phases) == len(searched.phases) == 2
    assert len(named.sheets[0].rows) < len(searched.sheets[0].rows)
    assert searched.fields[0] == pytest.approx(named.fields[0], abs=1e-6)


def test_a_law_that_jumps_or_has_no_numbers_is_refused():
    with refuses(ValueError, "jumps", "bends"):
        sw.Element.from_law(lambda s: s + (s > 0.7e-3), 0.0, 2e-3)
    with refuses(ValueError, "no finite number"):
        sw.Element.from_law(lambda s: 1.0 / (s - 1e-3), 0.0, 2e-3)
    with pytest.raises(ValueError, match="must be above low"):
        sw.Element.from_law(wave, 1.0, 0.0)


def test_noise_is_smoothed_within_a_reported_band():
    rng = np.random.default_rng(3)
    s = np.linspace(0.0, 6e-3, 300)
    noisy = wave(s) + rng.normal(0.0, 0.03, len(s))
    with refuses(ValueError, "noise"):
        sw.Element.from_table(s, noisy)
    smooth = sw.Element.from_table(s, noisy, noise=0.03)
    assert len(smooth.phases) == 3
    assert np.max(np.abs(smooth.force_at(s) - wave(s))) < smooth.error_band < 0.15


def test_a_fall_smaller_than_the_noise_is_no_snap_and_the_band_holds_it():
    s = np.linspace(0.0, 6e-3, 400)
    force = 200 * s + 0.02 * np.sin(s * 2e4)
    smooth = sw.Element.from_table(s, force, noise=0.2)
    assert len(smooth.phases) == 1
    assert np.max(np.abs(smooth.force_at(s) - force)) < smooth.error_band
    with refuses(ValueError, "from its noise"):
        sw.Element.from_table(s, force, noise=10.0)


@pytest.mark.parametrize(
    ("points", "options", "words"),
    [
        (([0, 1e-3, 0.5e-3, 2e-3], [0, 1, 0.5, 2]), {}, "force is no function of travel"),
        (([0, 1e-3, 1e-3, 2e-3], [0, 1, 0.5, 2]), {}, "force is no function of travel"),
        (([0, 1e-3], [0, 1]), {}, "2 points: must have 3 or more"),
        (([0, 1e-3, 2e-3], [0, 1]), {}, "force has 2 values, travel 3"),
        (([0, 1e-3, 2e-3], [0, math.nan, 1]), {}, r"force\[1\] = nan: must be finite"),
        (([0, 1e-3, 2e-3], [0, 0, 0]), {}, "force is 0 everywhere"),
        (
            ([0, 1e-3, 2e-3], [0, 1, 0.5]),
            {},
            "at the high end of the curve the force does not rise",
        ),
        (([0, 1e-3, 2e-3], [1, 0, 0.5]), {}, "at the low end of the curve the force does not rise"),
        (([0, 1e-3, 2e-3], [0, 1, 2]), {"noise": 0.0}, "noise = 0.0 N: must be > 0"),
        (([0, 1e-3, 2e-3], [0, 1, 2]), {"noise": 0.1}, "3 points: must have 5 or more"),
        (([0, 1e-3, 2e-3], [0, 1, 2]), {"friction": -1.0}, "friction = -1.0 N: must be >= 0"),
        (([0, 1e-3, 2e-3], [0, 1, 2]), {"stops": (True,)}, "two of them for the low and high end"),
    ],
)
def test_a_table_that_is_no_element_is_refused_with_the_reason(points, options, words):
    with pytest.raises(ValueError, match=words):
        sw.Element.from_table(*points, **options)


def fold(k=400.0, many=200):
    s = np.linspace(0.0, 5e-3, many)
    force = np.interp(s, *SNAP)
    return s + force / k, force


def test_a_curve_that_folds_back_keeps_its_stable_sheets_and_where_they_lead():
    element = sw.Element.from_curve(*fold())
    low, high = element.sheets
    assert (low.below, low.above, high.below, high.above) == (None, 1, 0, None)
    assert [p.sheet for p in element.phases] == [0, 1]
    # A jump at one travel loses what the areas under the curve say.
    lost = element.energy_at(low.end, 0) - element.energy_at(low.end, 1)
    s = np.linspace(0.0, 5e-3, 400_001)
    force = np.interp(s, *SNAP)
    u = s + force / 400.0
    energy = np.concatenate([[0.0], np.cumsum(np.diff(u) * (force[1:] + force[:-1]) / 2)])
    top = np.argmax(force * (s < 2e-3))
    landing = np.argmax((u >= u[top]) & (s > 3e-3))
    assert lost == pytest.approx(energy[top] - energy[landing], rel=0.02)


def test_countersnapping_jumps_to_the_larger_force():
    """Ducarme et al. 2025: the curve crosses itself, and where it ends the force goes up."""
    t = np.linspace(0.0, 1.0, 400)
    points = np.array([[0, 0], [1.0, 0.6], [0.75, 0.3], [0.5, 0.0], [0.9, 0.1], [1.6, 4.9]])
    x, y = (np.interp(t, np.linspace(0, 1, len(points)), points[:, k]) for k in (0, 1))
    element = sw.Element.from_curve(x * 1e-2, y)
    cycle = sw.Chain([element]).cycle()
    up = cycle.snaps[0]
    assert up.cause.name == "END"
    assert up.force_after > up.force_before
    assert up.released > 0.0


@pytest.mark.parametrize(
    ("curve", "words"),
    [
        (([0, 1e-3, 0.5e-3, 2e-3], [0, 1, -1, -3]), "nowhere to land|does not rise"),
        (([0, 1e-3, 0.2e-3, 2e-3], [0, -1, 1, 4]), "must begin at a stable end"),
        (([0, 1e-3, 1e-3, 2e-3], [0, 1, 0, 2]), "neighbouring points of a curve must differ"),
        (([0, 1e-3, 0.4e-3], [0, 1, -1]), "nowhere to land"),
    ],
)
def test_a_curve_that_no_element_can_have_is_refused_with_the_reason(curve, words):
    with pytest.raises(ValueError, match=words):
        sw.Element.from_curve(*curve)


def test_side_by_side_forces_add_up_and_stops_are_kept():
    one = sw.Element.from_points(*SNAP, "one")
    two = sw.Element.from_law(wave, 0.0, 6e-3, "two")
    stopped = sw.Element.from_points([-1e-3, 4e-3], [0.0, 2.0], stops=(False, True))
    s = np.linspace(-2e-3, 4e-3, 101)
    both = sw.Element.side_by_side([one, two, stopped])
    assert both.stopped == (False, True)
    assert both.high == 4e-3
    total = one.force_at(s) + two.force_at(s) + stopped.force_at(s)
    assert both.force_at(s) == pytest.approx(total, abs=1e-12)
    work = one.energy_at(s) + two.energy_at(s) + stopped.energy_at(s)
    assert np.ptp(both.energy_at(s) - work) < 1e-15


def test_side_by_side_a_fold_stays_a_fold():
    folded, spring = sw.Element.from_curve(*fold()), sw.Element.from_points([0, 1e-3], [0, 0.1])
    both = sw.Element.side_by_side([folded, spring])
    assert [(s.begin, s.end, s.below, s.above) for s in both.sheets] == [
        (pytest.approx(s.begin), pytest.approx(s.end), s.below, s.above) for s in folded.sheets
    ]
    one, two = sw.Chain([folded]).cycle(), sw.Chain([both]).cycle()
    assert [e.drive for e in two.snaps] == pytest.approx([e.drive for e in one.snaps])
    assert two.dissipated == pytest.approx(one.dissipated)


def test_what_cannot_stand_side_by_side_is_refused():
    snap = sw.Element.from_points(*SNAP)
    with pytest.raises(ValueError, match="two or more"):
        sw.Element.side_by_side([snap])
    with refuses(ValueError, "parallel", "one kind"):
        sw.Element.side_by_side([snap, sw.elements.balloon()])
    far = sw.Element.from_points([0.1, 0.2], [1.0, -1.0], stops=True)
    with pytest.raises(ValueError, match="no common travel"):
        sw.Element.side_by_side([sw.Element.from_points([0, 0.01], [1.0, -1.0], stops=True), far])


def test_scales_stretch_travel_and_force():
    snap = sw.Element.from_points(*SNAP)
    scaled = replace(snap, force_scale=2.0, travel_scale=3.0)
    assert scaled.force_at([3e-3, 9e-3]) == pytest.approx([2.0, -2.0])
    assert scaled.energy_at(3e-3) == pytest.approx(6.0 * snap.energy_at(1e-3))
    assert scaled.fields == ((2.0, -2.0),)


def test_a_chain_refuses_to_mix_what_is_measured():
    snap, balloon = sw.Element.from_points(*SNAP), sw.elements.balloon()
    words = r"cells\[1\] has volume and pressure, cells\[0\] has travel and force"
    with pytest.raises(ValueError, match=words):
        sw.Chain([snap, balloon])
    chain = sw.Chain([balloon, balloon])
    assert (chain.measure, chain.drive_unit) == (sw.Measure.VOLUME, "m³")
    assert replace(chain, actuator_stiffness=0.0).drive_unit == "Pa"


def test_an_element_is_a_value():
    one, two = sw.Element.from_points(*SNAP, "a"), sw.Element.from_points(*SNAP, "a")
    assert one == two
    assert hash(one) == hash(two)
    assert pickle.loads(pickle.dumps(one)) == one
    assert one != replace(one, force_scale=2.0)
    assert "2 phases" in repr(one)
    with pytest.raises(ValueError, match="curve ends"):
        replace(one, stops=True).force_at(6e-3)
