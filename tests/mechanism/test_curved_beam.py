"""The curved beam against the paper's numbers, and against energy minimised by brute force."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq, minimize

from facts import refuses
from stepwell.base import InputError
from stepwell.mechanism import curved_beam
from stepwell.mechanism.elements import beam_force, beam_kinks


def brute_force(depth: float, q: float, modes: int = 15) -> tuple[float, float]:
    """Least energy over E I h²/l³ of a beam pushed by `depth`, by quadrature and descent.

    With it the largest strain over t h/l² of that shape.

    Nothing of modes being orthogonal, of buckling loads or of branches is used: the shape is a sum
    of 1 - cos 2πmX with its middle held at 1 - depth, and stretches and bends as it must.
    """
    x = (np.arange(400) + 0.5) / 400
    m = np.arange(1, modes + 1)[:, None]
    slope = 2 * math.pi * m * np.sin(2 * math.pi * m * x)
    bend = (2 * math.pi * m) ** 2 * np.cos(2 * math.pi * m * x)
    middle = 1 - np.cos(math.pi * m[:, 0])
    made = np.zeros(modes)
    made[0] = 0.5
    # All but the first are free; the first sees to it that the middle is where it is.
    free = np.vstack([-middle[1:] / middle[0], np.eye(modes - 1)])
    start = np.zeros(modes)
    start[0] = (1 - depth) / 2

    def energy(rest: np.ndarray) -> tuple[float, np.ndarray]:
        a = start + free @ rest
        curvature = (a - made) @ bend
        long = np.mean((a @ slope) ** 2 - (made @ slope) ** 2) / 2
        value = np.mean(curvature**2) / 2 + 12 * q**2 * long**2 / 2
        by_a = bend @ curvature / 400 + 12 * q**2 * long * (slope @ (a @ slope)) / 400
        return float(value), free.T @ by_a

    # Either sign of the mode with a node in the middle, a little off, and more.
    tries = [np.r_[first, np.zeros(modes - 2)] for first in (0.02, -0.02, 0.2)]
    minima = (
        minimize(energy, one, jac=True, method="BFGS", options={"gtol": 1e-9}) for one in tries
    )
    best = min(minima, key=lambda one: one.fun)
    a = start + free @ best.x
    long = np.mean((a @ slope) ** 2 - (made @ slope) ** 2) / 2
    return best.fun, float(np.max(np.abs((a - made) @ bend)) / 2 + q * abs(long))


@pytest.mark.slow
@pytest.mark.parametrize("q", [1.5, 3.0, 6.25])
def test_its_force_is_the_slope_of_the_least_energy(q):
    step = 1e-3
    for depth in (-0.04, 0.05, 0.3, 0.9, 1.4, 1.8, 2.05):
        above, below = (brute_force(depth + sign * step, q)[0] for sign in (1, -1))
        slope = (above - below) / (2 * step)
        # Fifteen modes against all of them, and a difference for a slope.
        assert beam_force(depth, q) == pytest.approx(slope, rel=3e-3, abs=0.5)


@pytest.mark.slow
def test_peak_valley_and_places_are_those_of_the_paper():
    # Qiu, Lang & Slocum 2004: 740 and -370 E I h/l³ at 0.16 h and 1.92 h, rest again at 1.99 h.
    depth = np.linspace(0.0, 2.0, 2001)
    force = beam_force(depth, 9.0)
    top, bottom = np.argmax(force), np.argmin(force)
    assert force[top] == pytest.approx(740, rel=0.005)
    assert force[bottom] == pytest.approx(-370, rel=0.02)
    assert (depth[top], depth[bottom]) == pytest.approx((0.16, 1.92), abs=0.01)
    assert brentq(lambda d: beam_force(d, 9.0), 1.92, 2.0) == pytest.approx(1.99, abs=0.01)


def test_with_one_mode_the_middle_branch_is_straight_to_four_thirds():
    # Qiu, Lang & Slocum 2004 have F = 8π⁴ - 6π⁴ Δ there; all modes together, 64π² (4/3 - Δ).
    first, last = beam_kinks(6.25)
    depth = np.linspace(first, last, 9)
    assert beam_force(depth, 6.25) == pytest.approx(64 * math.pi**2 * (4 / 3 - depth), rel=1e-9)


@pytest.mark.slow
def test_strain_on_the_way_is_what_the_docstring_says():
    # Larger than as bent from rest to rest, 2 π² t h/l², for the node in the middle bends more.
    worst = max(brute_force(depth, 6.25)[1] for depth in np.linspace(0.5, 1.6, 12))
    assert worst == pytest.approx(3.4 * math.pi**2, rel=0.03)


@pytest.mark.parametrize(("q", "rests"), [(2.30, False), (2.32, True)])
def test_it_rests_again_for_q_above_2_31(q, rests):
    # Qiu, Lang & Slocum 2004; with the first mode alone the bound is 4/√3 = 2.309.
    assert bool((beam_force(np.linspace(1.4, 1.6, 401), q) < 0).any()) is rests


@pytest.mark.slow
def test_beams_add_up_and_scale():
    one, two = curved_beam(beams=1), curved_beam(beams=2)
    travel = np.linspace(0.0, 0.010, 21)
    assert two.force_at(travel) == pytest.approx(2 * one.force_at(travel), rel=1e-12)
    unit = 1.7e9 * 0.005 * 0.0008**3 / 12 * 0.005 / 0.080**3
    assert one.force_at(travel) == pytest.approx(unit * beam_force(travel / 0.005, 6.25), abs=1e-5)


@pytest.mark.slow
def test_a_flat_beam_is_an_element_without_a_snap():
    assert len(curved_beam(height=0.0008).phases) == 1
    assert curved_beam().is_bistable and len(curved_beam().phases) == 2


def test_sizes_that_no_beam_has_are_refused():
    with refuses(InputError, "thickness = 0.0 m", "> 0"):
        curved_beam(thickness=0)
    with refuses(InputError, "beams = 1.5", "whole number >= 1"):
        curved_beam(beams=1.5)  # pyright: ignore[reportArgumentType]
