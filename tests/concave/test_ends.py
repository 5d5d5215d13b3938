"""Slopes of end forces are slopes, and bounds are bounds: against numbers that share nothing."""

import math

import numpy as np
import pytest

from sizes import examples
from stepwell.concave import Simple, end_force, end_forces, most_bend, slopes_by_sizes
from stepwell.concave.certificate import steepest


def any_taut(rng: np.random.Generator) -> Simple:
    return Simple(
        rng.uniform(0.008, 0.035),
        rng.uniform(-0.02, 0.02),
        rng.uniform(15, 60),
        rng.uniform(0.0, 0.006),
        rng.uniform(0.008, 0.020),
        math.sin(rng.uniform(0.2, 1.2)),
    )


def written_out(s: Simple, theta: np.ndarray) -> np.ndarray:
    """F by Eqs. 1 and 2 as they are printed."""
    length = np.hypot(s.lever * np.cos(theta) + s.dx, s.lever * np.sin(theta) + s.dy)
    return s.stiffness * (1 - s.rest / length) * (s.dy - s.dx * np.tan(theta))


def test_slopes_of_end_forces_by_anchor_rest_length_and_lever_are_differences():
    rng = np.random.default_rng(1)
    for _ in range(examples(50)):
        s = any_taut(rng)
        for side in (-1, 1):
            value, *by_anchor = end_force(s, side, s.dx, s.dy)
            slopes = [*by_anchor, *slopes_by_sizes(s, side, s.dx, s.dy)]
            end = side * math.asin(s.sin_limit)
            assert value == pytest.approx(float(written_out(s, np.array(end))), rel=1e-11)
            assert value == pytest.approx(end_forces(s)[side > 0], rel=1e-12)
            for name, slope in zip(("dx", "dy", "rest", "lever"), slopes, strict=True):
                h = 1e-7
                ends = [
                    float(written_out(s._replace(**{name: getattr(s, name) + step}), np.array(end)))
                    for step in (h, -h)
                ]
                assert slope == pytest.approx((ends[0] - ends[1]) / (2 * h), rel=1e-5, abs=1e-4)


def test_no_slope_on_a_disc_is_above_its_bound():
    rng = np.random.default_rng(2)
    for _ in range(examples(50)):
        s, side = any_taut(rng), int(rng.choice([-1, 1]))
        radius = rng.uniform(0, 0.004)
        bound = steepest(s, side, s.dx, s.dy, radius)
        for angle in np.linspace(0, 2 * math.pi, 16):
            away = radius * math.sqrt(rng.random())
            x, y = s.dx + away * math.cos(angle), s.dy + away * math.sin(angle)
            assert math.hypot(*end_force(s, side, x, y)[1:]) <= bound * (1 + 1e-12)


def test_no_bend_of_the_force_is_above_its_bound():
    rng = np.random.default_rng(3)
    for _ in range(examples(50)):
        s = any_taut(rng)
        travel = np.linspace(0.0, 2 * s.lever * s.sin_limit, 401)[1:-1]
        force = written_out(s, np.arcsin(travel / s.lever - s.sin_limit))
        bend = np.diff(force, 2) / (travel[1] - travel[0]) ** 2
        assert np.max(np.abs(bend)) <= most_bend(s) * (1 + 1e-6)
