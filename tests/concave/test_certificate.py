"""The closed forms hold where they say so, and say so where they should."""

import math
from dataclasses import replace

import numpy as np
import pytest

import stepwell as sw
from chains import LEVER, LIMIT, concave_cell
from sizes import examples
from stepwell.concave import Simple, certify, end_forces, force_at, simple, travel_at

PAPER = [(10, 0), (0, 0), (20, 0), (10, -15), (20, 15), (0, -15)]


def any_simple(rng: np.random.Generator) -> Simple:
    """A cell with one linear band anywhere, concave or not."""
    return Simple(
        rng.uniform(-0.010, 0.035),
        rng.uniform(-0.030, 0.030),
        rng.uniform(15, 60),
        rng.choice([0.0, rng.uniform(0.0, 0.025)]),
        rng.uniform(0.008, 0.020),
        math.sin(rng.uniform(0.2, 1.3)),
    )


def falls_and_is_taut(s: Simple) -> bool:
    """Dense sampling of the condition, straight from the energy."""
    theta = np.linspace(-1, 1, 4001) * math.asin(s.sin_limit)
    length = np.hypot(s.lever * np.cos(theta) + s.dx, s.lever * np.sin(theta) + s.dy)
    force = (1 - s.rest / length) * (s.dy - s.dx * np.tan(theta))
    return bool(length.min() > s.rest and np.all(np.diff(force) < 0))


def simple_cell(q: tuple[float, float]) -> sw.Cell:
    return sw.Cell(sw.Band((-0.010, 0.0), (q[0] * 1e-3, q[1] * 1e-3)))


def numbers(cell: sw.Cell) -> Simple:
    cell_numbers = simple(cell)
    assert cell_numbers is not None
    return cell_numbers


@pytest.mark.slow
def test_a_certified_cell_is_taut_and_its_force_falls():
    rng = np.random.default_rng(1)
    cells = [any_simple(rng) for _ in range(examples(1000))]
    certified = [s for s in cells if certify(s, 0.0)]
    assert len(certified) > len(cells) // 10
    assert [s for s in certified if not falls_and_is_taut(s)] == []


@pytest.mark.slow
def test_almost_every_concave_cell_is_certified():
    rng = np.random.default_rng(2)
    concave = [s for s in (any_simple(rng) for _ in range(examples(1000))) if falls_and_is_taut(s)]
    missed = [s for s in concave if s.dx > 0 and not certify(s, 0.0)]
    assert len(missed) < 0.01 * len(concave)


@pytest.mark.parametrize("q", PAPER)
def test_the_papers_cells_are_certified(q):
    assert certify(numbers(simple_cell(q)), 0.0)


@pytest.mark.slow
def test_a_proof_for_a_disc_holds_for_every_anchor_in_it():
    rng = np.random.default_rng(3)
    discs = 0
    for _ in range(examples(300)):
        s = any_simple(rng)
        reach = rng.uniform(0, 0.006)
        if not certify(s, reach):
            continue
        discs += 1
        for angle in np.linspace(0, 2 * np.pi, 12, endpoint=False):
            away = reach * math.sqrt(rng.random())
            near = s._replace(dx=s.dx + away * np.cos(angle), dy=s.dy + away * np.sin(angle))
            assert falls_and_is_taut(near)
    assert discs > 20


@pytest.mark.parametrize("change", [{"dx": -0.01}, {"dx": 0.0}, {"dx": math.nan}, {"rest": 0.03}])
def test_a_folded_slack_or_undefined_band_is_not_certified(change):
    good = Simple(0.020, 0.0, 28.5, 0.010, LEVER, math.sin(LIMIT))
    assert certify(good, 0.0)
    assert not certify(good._replace(**change), 0.0)


def test_only_one_linear_band_without_load_and_friction_is_simple():
    cell = simple_cell((10, 0))
    band = cell.bands[0]
    assert simple(cell) is not None
    assert simple(replace(cell, friction=0.01)) is None
    assert simple(replace(cell, load=sw.Load.constant(0.0))) is None
    assert simple(replace(cell, band=(band, band))) is None
    assert simple(replace(cell, band=replace(band, law=sw.Cubic(1.0, 0.0)))) is None


def test_forces_and_their_slope_are_those_of_the_cell():
    rng = np.random.default_rng(4)
    for _ in range(50):
        cell = concave_cell(rng)
        s = numbers(cell)
        ends = cell.force_0, cell.force_1
        assert end_forces(s) == pytest.approx(ends, rel=1e-12, abs=1e-14)
        travel = rng.uniform(0.01, 0.99) * cell.full_travel
        force, slope = force_at(s, travel)
        assert force == pytest.approx(float(cell.force(cell.angle(travel))), abs=1e-13)
        step = 1e-6
        difference = (force_at(s, travel + step)[0] - force_at(s, travel - step)[0]) / (2 * step)
        assert slope == pytest.approx(difference, rel=1e-5)


@pytest.mark.slow
def test_the_travel_at_a_force_is_exact_to_rounding():
    rng = np.random.default_rng(5)
    for _ in range(examples(300)):
        s = numbers(concave_cell(rng))
        f0, f1 = end_forces(s)
        fraction = rng.choice([rng.random(), 1e-9 * rng.random(), 1 - 1e-9 * rng.random()])
        force = f1 + (f0 - f1) * fraction
        # Bisection in extended precision.
        dx, dy, k, rest, r, sin_limit = (np.longdouble(v) for v in s)
        low, high = np.longdouble(0), 2 * r * sin_limit
        for _ in range(80):
            middle = (low + high) / 2
            t = middle / r - sin_limit
            c = np.sqrt(1 - t * t)
            length = np.sqrt((r * c + dx) ** 2 + (r * t + dy) ** 2)
            if k * (1 - rest / length) * (dy - dx * t / c) > force:
                low = middle
            else:
                high = middle
        rounding = 4e-16 * (abs(f0) + abs(f1)) / abs(force_at(s, float(low))[1])
        assert abs(travel_at(s, force, f0, f1) - float(low)) <= rounding + 4e-16 * float(2 * r)


def test_a_force_beyond_the_end_forces_gives_the_stop():
    s = numbers(simple_cell((10, 0)))
    f0, f1 = end_forces(s)
    assert travel_at(s, f0 + 1.0, f0, f1) == 0.0
    assert travel_at(s, f1 - 1.0, f0, f1) == 2 * s.lever * s.sin_limit
