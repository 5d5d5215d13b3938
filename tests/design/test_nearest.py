"""One search for the nearest displacement, against regions whose nearest point is known."""

import math
from dataclasses import replace

import numpy as np
import pytest

import stepwell as sw
from chains import any_chain, concave_chain
from sizes import examples
from stepwell.base import bisected
from stepwell.design.margins.reprogramming import reprogram
from stepwell.design.margins.search import Displacements, nearest_found

REACH = 0.020
PLANE = Displacements.of(None, False, REACH)
CLOSE = 1.5e-7  # m: where bisection stops, and the last turn of the ray


def directions(rng: np.random.Generator, count: int) -> np.ndarray:
    angle = rng.uniform(0, 2 * math.pi, count)
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


@pytest.mark.slow
def test_beyond_several_lines_the_nearest_one_is_found():
    rng = np.random.default_rng(1)
    for _ in range(examples(60)):
        normal = directions(rng, 4)
        away = REACH * rng.uniform(0.001, 0.99, 4)
        place = nearest_found(
            lambda u, n=normal, a=away: bool(np.any(n @ u > a)), PLANE, REACH, False
        )
        assert place is not None
        assert 0 <= np.linalg.norm(place) - away.min() < CLOSE


@pytest.mark.slow
def test_in_the_corner_between_two_lines_the_tip_is_found():
    rng = np.random.default_rng(2)
    for _ in range(examples(60)):
        tip = REACH * rng.uniform(0.05, 0.6) * directions(rng, 1)[0]
        # The corner opens away from here, by 50 to 80 degrees to either side.
        middle, side = math.atan2(tip[1], tip[0]), rng.uniform(0.9, 1.4, 2)
        turns = middle + side[0] - math.pi / 2, middle - side[1] + math.pi / 2
        normal = np.array([(math.cos(t), math.sin(t)) for t in turns])
        place = nearest_found(
            lambda u, n=normal, t=tip: bool(np.all(n @ (u - t) > 0)), PLANE, REACH, True
        )
        assert place is not None
        assert 0 <= np.linalg.norm(place) - np.linalg.norm(tip) < 1e-3 * np.linalg.norm(tip)


@pytest.mark.slow
def test_of_two_islands_the_nearer_is_found_and_none_farther_than_asked():
    rng = np.random.default_rng(3)
    for _ in range(examples(40)):
        middle = directions(rng, 2) * REACH * rng.uniform(0.3, 0.8, (2, 1))
        radius = rng.uniform(0.0012, 0.004, 2)
        nearest = float(np.min(np.linalg.norm(middle, axis=1) - radius))

        def does(u: np.ndarray, middle=middle, radius=radius) -> bool:
            return bool(np.any(np.linalg.norm(u - middle, axis=1) < radius))

        place = nearest_found(does, PLANE, REACH, True)
        assert place is not None
        assert 0 <= np.linalg.norm(place) - nearest < CLOSE
        assert nearest_found(does, PLANE, 0.99 * nearest, True) is None


@pytest.mark.parametrize("one_way", [False, True])
def test_on_a_line_the_first_place_is_found_in_either_sense(one_way):
    line = Displacements.of((1.0, 2.0), one_way, REACH)
    place = nearest_found(lambda u: u[0] < -0.003 or u[0] > 0.0051, line, REACH, True)
    assert place is not None
    assert place[0] == pytest.approx(0.0051 if one_way else -0.003, abs=CLOSE)


def rubbing(rng: np.random.Generator) -> sw.Chain:
    cells = concave_chain(rng, 3).cells
    return sw.Chain([replace(cell, friction=rng.uniform(0.002, 0.1)) for cell in cells])


def compliant(rng: np.random.Generator) -> sw.Chain:
    return sw.Chain(concave_chain(rng, 2).cells, actuator_stiffness=rng.uniform(10, 100))


@pytest.mark.parametrize(
    ("some", "method"),
    [
        (lambda rng: concave_chain(rng, int(rng.integers(3, 6))), "exact"),
        pytest.param(rubbing, "search", marks=pytest.mark.slow),
        (compliant, "search"),
        (lambda rng: any_chain(rng, 2), "search"),
    ],
    ids=["concave", "friction", "compliant", "any"],
)
def test_a_margin_and_a_reprogramming_to_anything_else_are_one_answer(some, method):
    rng = np.random.default_rng(4)
    for _ in range(examples(4) if method == "exact" else examples(1)):
        chain = some(rng)
        margin = sw.margin(chain, reach=0.003)
        anchors = [c for c in margin.changes if c.parameter == "anchor"]
        for change in anchors if method == "exact" else anchors[-1:]:
            other = reprogram(chain, None, f"{change.cell + 1}.q", reach=0.003)
            assert (other.distance, other.method) == (change.distance, change.method)
            assert other.after == change.becomes
            if other.method == "search":
                assert other.resolution in margin.resolution
        assert margin.method == method


def test_bisection_keeps_a_place_that_holds_and_one_that_does_not():
    for edge in (0.3, 0.7):
        good, bad = bisected(lambda at, edge=edge: at < edge, 0.0, 1.0, 20)
        assert good < edge <= bad
        assert bad - good == 0.5**20
    assert bisected(lambda at: at > 2.0, 3.0, 1.0, 1) == (3.0, 2.0)
