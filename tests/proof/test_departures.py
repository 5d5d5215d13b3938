"""Curves along which snaps of several cells leave their rests, against the flow of SciPy."""

from collections.abc import Iterator
from contextlib import suppress
from copy import copy
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import chains
from races import Race
from sizes import cases
from statics.test_against_oracle import as_oracle
from stepwell.proof import landing, leaving
from stepwell.proof.balls import UndecidedError, ball, hull, number
from stepwell.proof.leaving import _Curve, leave
from stepwell.proof.walk import FOLD, EnclosedWalk
from stepwell.statics import problem_of

# Random chains with snaps of three moving cells: from folds, and from other rests.
SEEDS = cases([28, 40, 61, 250, 259], [40, 250])


class Departure:
    """A snap that begins with several cells from a smooth rest: its curve, and an end of it."""

    def __init__(self, race: Race, walk: EnclosedWalk, direction: int, leader: int):
        self.race, self.fold = race, walk.due == FOLD
        self.rest = np.array([number(stand.travel) for stand in walk.stands])
        self.moving = walk.active()
        # The walk goes on.
        still = copy(walk)
        still.stands = [replace(stand) for stand in walk.stands]
        begun = leave(still, direction, leader)
        places, radius = begun.places, begun.radius
        self.end = np.array([number(places[i]) for i in self.moving])
        self.radius = number(radius)
        self.root = np.sqrt([walk.mobility[i] for i in self.moving])
        lead = leader, direction
        w = None if self.fold else leaving._direction(walk, self.moving, self.root, lead)
        self.curve = _Curve(still, self.moving, lead, w)

    def forces(self, travel: np.ndarray) -> np.ndarray:
        whole = self.rest.copy()
        whole[self.moving] = travel
        return self.race.forces(whole)[self.moving]

    def rates(self, _: float, travel: np.ndarray) -> np.ndarray:
        m, force = self.root**2, self.forces(travel)
        return m * (np.sum(m * force) / np.sum(m) - force)

    def start(self) -> tuple[np.ndarray, np.ndarray]:
        """A place next to the rest, and the direction to it, by differences of forces."""
        rest = self.rest[self.moving]
        step = 1e-7 * np.min(self.race.span)
        ahead = np.sign(self.end - rest) * step
        slopes = [
            (self.forces(rest + ahead * one) - self.forces(rest))[i] / ahead[i]
            for i, one in enumerate(np.eye(len(rest)))
        ]
        n = self.root / np.linalg.norm(self.root)
        p = np.eye(len(n)) - np.outer(n, n)
        matrix = -p @ np.diag(self.root**2 * slopes) @ p - 1e6 * np.outer(n, n)
        w = np.linalg.eigh(matrix)[1][:, -1]
        w = w * np.sign(w @ ((self.end - rest) / self.root))
        return rest + 1e-4 * np.min(self.race.span) * w * self.root, w


@cache
def departures_of(seed: int) -> list[Departure]:
    rng, out = np.random.default_rng([41, seed]), []
    chain = chains.any_chain(rng, int(rng.integers(2, 7)), friction=False)
    race = Race([as_oracle(cell) for cell in chain.cells])

    def spy(walk, direction, leader):
        with suppress(UndecidedError):
            out.append(Departure(race, walk, direction, leader))
        raise UndecidedError("here the flow would begin")

    def no_flow(*_):
        raise UndecidedError("a flow")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(landing, "leave", spy)
        # No other flow is followed here.
        patch.setattr(landing, "follow", no_flow)
        chain.cycle().path.prove()
    return out


def departures() -> Iterator[Departure]:
    for seed in SEEDS:
        yield from departures_of(seed)


def test_the_flow_of_scipy_ends_where_a_snap_is_enclosed_to_begin():
    kinds = set()
    for one in departures():
        place, w = one.start()
        there = w @ (one.end / one.root)

        def beyond(_, travel, w=w, root=one.root, there=there) -> float:
            return w @ (travel / root) - there

        beyond.terminal = True  # pyright: ignore[reportFunctionMemberAccess]
        flow = solve_ivp(
            *(one.rates, (0.0, 1e9), place), "LSODA", events=beyond, rtol=1e-11, atol=1e-16
        )
        assert flow.status == 1
        miss = np.abs(flow.y[:, -1] - one.end)
        # SciPy begins on the direction, not on the curve: what it misses dies out on the way.
        assert np.all(miss <= one.radius * one.root + 1e-7 * np.min(one.race.span))
        kinds.add(one.fold)
    assert kinds == {True, False}


def test_a_snap_from_a_smooth_rest_begins_where_the_flow_is_known_to_rounding():
    assert sum(one.fold for one in departures()) >= 2
    for one in departures():
        assert one.radius < 1e-11 * np.linalg.norm((one.end - one.rest[one.moving]) / one.root)


def test_a_curve_that_is_off_has_a_radius_that_holds_the_right_one():
    rng, found = np.random.default_rng(41), 0
    for one in departures():
        right, way = one.curve.phi, 1e-4 * float(np.min(one.race.span))
        known = one.curve.end(way)
        for size in (1e-6, 1e-3, 0.3):
            one.curve.phi = [[x * (1.0 + size * rng.normal()) for x in row] for row in right]
            one.curve.phi = [one.curve._across(row) for row in one.curve.phi]
            try:
                off = one.curve.end(way)
            except UndecidedError:
                continue
            gaps = [number(off.places[i] - known.places[i]) for i in one.moving]
            apart = np.linalg.norm(gaps / one.root)
            assert apart <= number(off.radius + known.radius)
            found += apart > 1e3 * number(known.radius)
        one.curve.phi = right
    assert found >= 8


@pytest.mark.parametrize("degree", [7, 13])
def test_a_power_series_with_its_last_term_over_a_span_holds_the_force(degree):
    chain = chains.any_chain(np.random.default_rng([5, 29]), 3, friction=False)
    kept = 0
    for cell in EnclosedWalk(chain, problem_of(chain)).cells:
        for part in (0.2, 0.5, 0.8):
            at, x = ball(part * cell.size), ball(0.02 * cell.size)
            thin, wide = cell.taylor(at, degree), cell.taylor(hull(at, at + x), degree)
            if thin is None or wide is None:
                continue
            force = sum((c * x**k for k, c in enumerate(thin[:-1])), wide[-1] * x**degree)
            # Two enclosures of one number overlap, and no term is left out.
            assert cell.law(at + x)[0].overlaps(force)
            assert not any(c.is_zero() for c in (*thin, *wide))
            kept += 1
    assert kept >= 3
