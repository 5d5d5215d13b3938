"""The Kresling fold against its geometry, and against energy minimised by brute force."""

import math

import numpy as np
import pytest

from stepwell.base import InputError
from stepwell.mechanism import kresling
from stepwell.mechanism.elements import crease_lengths

FOLDS = [(6, 0.030, 0.015, 0.040), (4, 0.025, 0.020, 0.030), (8, 0.040, 0.0, 0.050)]


def corners(sides: int, radius: float, height: float, turn: float) -> tuple[float, float]:
    """Length [m] of both creases between corners of two polygons, the upper one turned."""
    low = np.array([radius, 0.0, 0.0])
    mountain, valley = (
        float(np.linalg.norm([radius * math.cos(a), radius * math.sin(a), height] - low))
        for a in (turn, turn + math.tau / sides)
    )
    return mountain, valley


@pytest.mark.parametrize(("sides", "radius", "folded", "deployed"), FOLDS)
def test_both_heights_are_free_of_energy(sides, radius, folded, deployed):
    rest = crease_lengths(sides, radius, folded, deployed)
    # The two twists that geometry gives: x and π - x, π/n less for the mountain crease.
    x = math.acos((deployed**2 - folded**2) / (4 * radius**2 * math.cos(math.pi / sides)))
    for height, turn in ((deployed, x), (folded, math.pi - x)):
        distances = corners(sides, radius, height, turn - math.pi / sides)
        assert distances == pytest.approx(rest, rel=1e-12)
    fold = kresling(sides, radius, folded, deployed)
    assert fold.force_at([0.0, deployed - folded]) == pytest.approx(0.0, abs=1e-5)
    assert fold.energy_at(deployed - folded) == pytest.approx(0.0, abs=1e-8)


@pytest.mark.parametrize(("sides", "radius", "folded", "deployed"), FOLDS)
@pytest.mark.parametrize("softer", [1.0, 0.05, 20.0])
def test_its_energy_is_the_least_over_all_twists(sides, radius, folded, deployed, softer):
    mountain, valley = 3000.0, 3000.0 * softer
    rest = crease_lengths(sides, radius, folded, deployed)
    fold = kresling(sides, radius, folded, deployed, mountain, valley)
    turns = np.linspace(0.0, math.pi - math.tau / sides, 40001)
    for part in (0.05, 0.3, 0.6, 0.9, 1.0):
        travel = part * fold.high
        height = folded + travel
        first = np.sqrt(height**2 + 2 * radius**2 * (1 - np.cos(turns)))
        second = np.sqrt(height**2 + 2 * radius**2 * (1 - np.cos(turns + math.tau / sides)))
        energy = sides / 2 * (mountain * (first - rest[0]) ** 2 + valley * (second - rest[1]) ** 2)
        near = 1e-6 * fold.largest_force * fold.high
        assert fold.energy_at(travel) == pytest.approx(energy.min(), rel=1e-5, abs=near)


def test_a_fold_that_lies_flat_has_the_creases_of_its_angle_ratio():
    # Bhovad, Kaufmann & Li 2019: with φ = π/2 - π/n, valley 2 R cos φ(1 - λ), and the mountain
    # crease closes the triangle with a side, at the angle λφ.
    sides, radius, ratio = 8, 0.040, 0.8
    phi = math.pi / 2 - math.pi / sides
    side = 2 * radius * math.sin(math.pi / sides)
    valley = 2 * radius * math.cos(phi * (1 - ratio))
    mountain = math.sqrt(side**2 + valley**2 - 2 * side * valley * math.cos(ratio * phi))
    x = math.pi / sides + (math.pi - math.tau / sides) * (1 - ratio)
    deployed = 2 * radius * math.sqrt(math.cos(x) * math.cos(math.pi / sides))
    assert crease_lengths(sides, radius, 0.0, deployed) == pytest.approx((mountain, valley))
    assert deployed == pytest.approx(math.sqrt(mountain**2 + valley**2 - 4 * radius**2))


def test_it_has_two_phases_and_a_stop_where_it_is_folded():
    fold = kresling()
    assert len(fold.phases) == 2
    assert fold.stopped == (True, False)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"sides": 3}, "sides = 3: must be a whole number >= 4"),
        ({"folded": 0.040}, "must be more than folded"),
        ({"deployed": 0.080}, "the mountain creases stand upright"),
    ],
)
def test_what_is_no_fold_is_refused(wrong, message):
    with pytest.raises(InputError, match=message):
        kresling(**wrong)
