"""Races: snaps of three cells and more, the error of their integration, other landings."""

import math
from dataclasses import replace

import numpy as np
import pytest

import stepwell as sw
from chains import any_cell, contest
from races import NoRest, Race
from sizes import examples
from statics.test_against_oracle import as_oracle
from stepwell.statics import EventKind, SegmentKind

# Chains of four cells with friction, each with a race that was up to 1e-4 of a travel off before
# every event ended a step of the integration; the worst of 400.
WORST = (5, 35, 107, 149, 164)


def rubbing(seed: int, count: int = 4) -> sw.Chain:
    """Any cells, seven in ten of them with friction."""
    rng = np.random.default_rng([seed, count, 32])
    cells = [any_cell(rng) for _ in range(count)]
    rubs = [float(rng.uniform(0.005, 0.1)) if rng.random() < 0.7 else 0.0 for _ in cells]
    return sw.Chain([replace(c, friction=f) for c, f in zip(cells, rubs, strict=True)])


def races(chain: sw.Chain):
    """(start, segment, landing) of every snap in which three cells or more moved."""
    path = chain.cycle().path
    travel = np.array(path.start)
    for segment in path.segments():
        before = travel.copy()
        travel[list(segment.cells)] = segment.after
        if segment.kind is SegmentKind.SNAP and len(segment.cells) > 2:
            yield before, segment, travel.copy()


def compared(chain: sw.Chain):
    """(how far the engine lands from where SciPy does, its own estimate) of every race, shares."""
    race = Race([as_oracle(cell) for cell in chain.cells])
    for before, segment, landing in races(chain):
        try:
            there = race.land(before, segment.direction, segment.drive[0])
        except NoRest:
            continue
        yield float(np.max(np.abs(there - landing) / race.span)), segment.error / np.min(race.span)


@pytest.mark.slow
def test_races_with_friction_land_within_a_millionth_of_a_travel_of_where_scipy_does():
    seeds = [*WORST, *range(200, 200 + examples(0, full=200))]
    differences = np.array([pair for seed in seeds for pair in compared(rubbing(seed))])
    assert len(differences) > 8
    off, estimate = differences.T
    assert np.max(off) < 1e-6
    # Brute force itself sets out a hundred-millionth of a travel off.
    assert np.all(off <= np.maximum(estimate, 1e-7))
    assert np.max(estimate) < 1e-5


def dipping(least: float) -> sw.Chain:
    """A pair, the first of which snaps through past a second peak that all but holds it."""
    # The other one is a spring of 100 N/m: at 4 mm it carries 1 N and lets go 10 mm of travel.
    second = 1.0 - 100.0 * (0.010 - 0.004) - least
    weak = sw.Element.from_points(
        [0.0, 0.004, 0.008, 0.010, 0.016, 0.020], [0.0, 1.0, 0.2, second, -1.0, 1.2]
    )
    return sw.Chain([weak, sw.Element.from_points([0.0, 0.010], [0.0, 1.0])])


@pytest.mark.parametrize("least", [0.05, 0.01, 1e-4])
def test_along_a_line_the_distance_is_the_least_pull_on_the_way(least):
    chain = dipping(least)
    snap = next(snap for snap in chain.cycle().snaps if snap.direction > 0)
    assert snap.error == 0.0
    assert snap.after[snap.cells.index(0)] > 0.010
    assert snap.distance_force == pytest.approx(least, rel=1e-6)


def contested(mobility: float, friction: float):
    """The second snap of the cycle, in which the two race."""
    return contest(mobility, friction).cycle().snaps[1]


@pytest.fixture(scope="module", params=[0.0, 0.004])
def border(request):
    """(friction, the mobility of `right` from which on it wins)."""
    low, high = 1.0, 3.0
    lost = list(contested(low, request.param).arrivals)
    assert lost != list(contested(high, request.param).arrivals)
    for _ in range(45):
        middle = 0.5 * (low + high)
        if list(contested(middle, request.param).arrivals) == lost:
            low = middle
        else:
            high = middle
    return request.param, low


@pytest.mark.slow
def test_the_distance_to_another_landing_vanishes_where_the_landing_changes(border):
    friction, mobility = border
    distances = []
    for away in (1e-1, 1e-3, 1e-5, 1e-7):
        near = [contested(mobility * (1.0 + side * away), friction) for side in (-1, 1)]
        # Nearer than the integration is accurate, both sides are reported as ties.
        assert near[0].arrivals != near[1].arrivals or (away < 1e-6 and near[0].tie and near[1].tie)
        distances.append([snap.distance_force for snap in near])
    fell = np.array(distances)
    assert np.all(fell[1:] < 0.5 * fell[:-1])
    assert np.all(fell[-1] < 1e-4)


def test_a_landing_that_the_error_of_the_integration_could_change_is_a_tie(border):
    friction, mobility = border
    snap = contested(mobility, friction)
    assert snap.tie
    assert not contested(mobility * 1.01, friction).tie
    assert not contested(mobility * 0.99, friction).tie


def test_what_never_snaps_is_at_no_distance_from_another_landing():
    switches = [
        event for event in contest(1.0, 0.0).cycle().events if event.kind is EventKind.SWITCH
    ]
    assert switches
    assert all(event.distance_force == math.inf and event.error == 0.0 for event in switches)
