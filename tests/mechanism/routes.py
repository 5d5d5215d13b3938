"""Every way by which the package comes from a band to a number, each as a few numbers.

Run as a program, it prints them all as JSON.
"""

import json
import math
import sys
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np

import stepwell as sw
from stepwell import design, lab, robot
from stepwell.concave import (
    SortedChain,
    certify,
    concave_disc,
    end_force,
    end_forces,
    force_at,
    relays,
    simple,
    slopes_by_sizes,
)

FORCE, OVER_FORCE, PLACE = 1, -1, 0  # a number goes as the force to this power
ROUTES: dict[str, tuple[int, Callable[[], object]]] = {}


def route(name: str, power: int):
    """A way to numbers that go as the force to this power: N, N/m; 1/N; m, rad."""

    def kept(way: Callable[[], object]):
        ROUTES[name] = power, way
        return way

    return kept


def cell(x: float, y: float, **band) -> sw.Cell:
    return sw.Cell(sw.Band((-0.010, 0.0), (x * 1e-3, y * 1e-3), **band))


INNER, OUTER = cell(10, 0), cell(20, 0)
PAIR = sw.Chain((INNER, OUTER))
RUBBER = sw.Chain(
    [
        cell(12, 2, law=sw.Cubic(-20.0, 800.0)),
        sw.Cell([cell(20, 0).bands[0], cell(-6, 3, rest_length=0.012).bands[0]]),
    ]
)


def plain(one: sw.Cell):
    found = simple(one)
    assert found is not None
    return found


@cache
def many() -> sw.Chain:
    x = np.random.default_rng(0).permutation(np.linspace(8.0, 20.0, 16))
    return sw.Chain([cell(float(v), 0.0) for v in x])


@cache
def sorted_many() -> SortedChain:
    found = SortedChain.of(many())
    assert found is not None
    return found


@route("force of a cell", FORCE)
def _():
    rubber = [c.force(np.array([-0.5, 0.2])) for c in RUBBER.cells]
    return [*INNER.force(np.array([-0.7, 0.1, 0.6])), *np.ravel(rubber)]


@route("force of a path that is followed", FORCE)
def _():
    path = RUBBER.path([0.0, RUBBER.full_stroke, 0.0])
    return [path.force.max(), path.force.min()]


@route("snaps of a path that is followed", PLACE)
def _():
    return [event.stroke for event in RUBBER.cycle().snaps + PAIR.cycle().snaps]


@route("travel at which a band goes slack", PLACE)
def _():
    loose = sw.Chain([cell(-4, 4, rest_length=0.012)])
    force = loose.path([0.0, loose.full_stroke])
    return [np.interp(0.0, -force.force, force.stroke)]


@route("force of a full cycle by sorting", FORCE)
def _():
    path = many().cycle().path
    assert all("sorted" in str(path.certificates) or True for _ in "1")
    return [path.force.max(), path.force.min()]


@route("snaps of a full cycle by sorting", PLACE)
def _():
    return [event.stroke for event in many().cycle().snaps]


@route("end forces in closed form, and their slopes by anchor", FORCE)
def _():
    one = plain(INNER)
    return [*end_forces(one), *end_force(one, -1, 0.018, 0.003), *end_force(one, 1, 0.018, 0.003)]


@route("slopes of end forces by rest length and lever", FORCE)
def _():
    return slopes_by_sizes(plain(INNER), -1, 0.018, 0.003)


@route("force and its slope along travel in closed form", FORCE)
def _():
    return force_at(plain(INNER), 0.004)


@route("largest disc that is certified", PLACE)
def _():
    def largest(proved: Callable[[float], bool]) -> float:
        low, high = 0.0, 0.02
        for _ in range(30):
            middle = (low + high) / 2
            low, high = (middle, high) if proved(middle) else (low, middle)
        return low

    short = plain(cell(2, 0))
    return [largest(lambda reach: certify(short, reach)), largest(lambda r: concave_disc(short, r))]


@route("end forces of a sorted chain and their gaps", FORCE)
def _():
    found = sorted_many()
    return [*found.forces[0][:3], *found.forces[1][:3], found.smallest_gap()]


@route("margin of an anchor", PLACE)
def _():
    return [c.size for c in PAIR.margin().changes if c.kind == "anchor"]


@route("margin of a stiffness", PLACE)
def _():
    return [c.size for c in PAIR.margin().changes if c.kind == "stiffness"]


@route("smallest displacement that reprograms", PLACE)
def _():
    return PAIR.reprogram("00>01>11>10>00", "outer.q", along=(1, 0)).displacement


@route("pull against the displacement of an anchor", PLACE)
def _():
    # The tension along the displacement: no force along travel.
    push = PAIR.reprogram("00>01>11>10>00", "outer.q", along=(1, 0)).push
    return [push.work_0, push.work_1]


@route("robustness", PLACE)
def _():
    return [design.robustness(PAIR).radius]


@cache
def _map():
    return sw.transition_map(PAIR, cell=1, x=np.array([0.015, 0.019]), y=np.array([-0.002, 0.003]))


@route("margins of a transition map", FORCE)
def _():
    return _map().margin.values


@route("snaps of a transition map", PLACE)
def _():
    return [v for v in np.ravel(_map().snap_loading.values) if not math.isnan(v)]


@route("gaps of a map over two parameters", FORCE)
def _():
    found = design.parameter_map(
        many(), "1.q.x", "2.q.y", x=np.array([0.0151, 0.0171]), y=np.array([0.001, 0.002])
    )
    return found.margin.values


@route("boundary of a map", PLACE)
def _():
    level = design.plane.Level(plain(INNER), -1, 0.3)
    return level.project(np.array([[0.02, -0.01], [0.025, -0.008]]))


@route("end forces of many that are made", FORCE)
def _():
    return PAIR.yields(n=20).end_forces(3)


@route("gaps of many that are made", FORCE)
def _():
    return PAIR.yields(n=20).gap
