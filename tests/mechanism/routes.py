"""Every way by which the package comes from a band to a number, each as a few numbers.

Run as a program, it prints them all as JSON.
"""

import json
import math
import sys
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any
from unittest import mock

import numpy as np

import stepwell as sw
from stepwell import lab, robot
from stepwell.concave import (
    DrawJudge,
    SortedChain,
    certify,
    concave_disc,
    end_force,
    end_forces,
    force_at,
    simple,
    slopes_by_sizes,
)
from stepwell.design import BoundaryKind, boundaries, map_boundaries, parameter_boundaries
from stepwell.design.margins.reprogramming import Resistance
from stepwell.design.margins.robustness import robustness
from stepwell.design.plane import Box
from stepwell.design.synthesis.candidates import Kind, Rule
from stepwell.design.synthesis.region import BandType
from stepwell.robot import leg_cycles

FORCE, OVER_FORCE, PLACE = 1, -1, 0  # a number goes as the force to this power
ROUTES: dict[str, tuple[int | None, Callable[[], Any]]] = {}


def route(name: str, power: int | None):
    """A way to numbers that go as the force to this power (N, N/m; m; 1/N), or to none of them."""

    def kept(way: Callable[[], Any]):
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
    numbers = simple(one)
    assert numbers is not None
    return numbers


@cache
def many() -> sw.Chain:
    x = np.random.default_rng(0).permutation(np.linspace(8.0, 20.0, 16))
    return sw.Chain([cell(float(v), 0.0) for v in x])


@cache
def sorted_many() -> SortedChain:
    chain = SortedChain.of(many())
    assert chain is not None
    return chain


@route("force of a cell", FORCE)
def _():
    rubber = [c.force(np.array([-0.5, 0.2])) for c in RUBBER.levers]
    return [*INNER.force(np.array([-0.7, 0.1, 0.6])), *np.ravel(rubber)]


@route("energy of a cell", FORCE)
def _():
    rubber = [c.energy(np.array([-0.5, 0.2])) for c in RUBBER.levers]
    return [*INNER.energy(np.array([-0.7, 0.1, 0.6])), *np.ravel(rubber)]


@route("force of a path that is followed", FORCE)
def _():
    path = RUBBER.path([0.0, RUBBER.full_stroke, 0.0])
    return [path.force.max(), path.force.min()]


@route("snaps of a path that is followed", PLACE)
def _():
    return [event.stroke for event in RUBBER.cycle().snaps + PAIR.cycle().snaps]


@route("travel at which a band goes slack", PLACE)
def _():
    loose = sw.Chain([cell(-18, 0)])
    path = loose.path([0.0, loose.full_stroke])
    return path.stroke[np.flatnonzero(path.force == 0.0)[[0, -1]]]


@route("force of a full cycle by sorting", FORCE)
def _():
    path = many().cycle().path
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
    chain = sorted_many()
    return [*chain.forces[0][:3], *chain.forces[1][:3], chain.smallest_gap()]


@cache
def _margin() -> sw.Margin:
    return PAIR.margin()


def _of(parameter: str) -> list[float]:
    return [c.distance for c in _margin().changes if c.parameter == parameter]


@route("margin of an anchor", PLACE)
def _():
    return _of("anchor")


@route("margin of a stiffness", PLACE)
def _():
    return _of("stiffness")


@route("smallest displacement that reprograms", PLACE)
def _():
    tilted = sw.Chain((INNER, cell(18, 6)))
    return [tilted.reprogram(None, "outer.q", along=(1, 0)).move[0]]


@route("pull against the displacement of an anchor", PLACE)
def _():
    # The tension itself, along the displacement: no force along travel.
    return Resistance.of(INNER, "q", (0.002, 0.003)).force_0


@route("robustness", PLACE)
def _():
    return [robustness(sw.Chain((cell(50, 0), cell(53, 4)))).radius]


@cache
def _map():
    return sw.transition_map(PAIR, cell=1, x=np.array([0.015, 0.019]), y=np.array([-0.002, 0.003]))


@route("margins of a transition map", FORCE)
def _():
    return _map().margin.values


@route("snaps of a transition map", PLACE)
def _():
    return [v for v in np.ravel(_map().snap_loading.values) if not math.isnan(v)]


# Fewer nodes than between which these curves are looked for, for the interpreter.
COARSE = mock.patch.object(map_boundaries, "_GRID", 21)


@route("boundaries of a map over two parameters", PLACE)
def _():
    with COARSE:
        lines = parameter_boundaries(
            PAIR, ("inner.q.x", (0.006, 0.016)), ("outer.q.y", (-0.012, -0.002)), search=5
        )
    # One of the two is that of the grid.
    return [np.sum(line.points[0]) for line in lines]


@route("boundaries of an anchor's map", PLACE)
def _():
    with COARSE:
        lines = boundaries(PAIR, 1, x=(0.006, 0.026), y=(-0.012, 0.008), search=5)
    orders = BoundaryKind.LOADING_ORDER, BoundaryKind.UNLOADING_ORDER
    # Where they cross may stay where it is.
    return [np.sum(line.points[len(line.points) // 2]) for line in lines if line.kind in orders]


@route("end forces of many that are made", FORCE)
def _():
    return PAIR.yields(samples=20).end_forces(3)


@route("gaps of many that are made", FORCE)
def _():
    draws = np.random.default_rng(0).random((3, 16))
    spread = np.array(2 * [[3e-4, 0.0, 0.0, 1e-4, 0.0]])
    judge = DrawJudge.of(PAIR, spread, np.array([[0, 1], [0, 1]]))
    assert judge is not None
    return judge(draws).gap


@route("fields of the graph of relays", FORCE)
def _():
    graph = PAIR.graph("force")
    drives = [one.drive for *_, one in graph.transitions()]
    return sorted(drives)


@route("drives of the graph that is followed", PLACE)
def _():
    graph = PAIR.graph("stroke")
    drives = [one.drive for *_, one in graph.transitions()]
    # But for those of a whole travel.
    return [drive for drive in sorted(drives) if 1e-3 < abs(drive - 0.02) < 0.019]


@route("turning points of a program", PLACE)
def _():
    return PAIR.program("01").turning_points[1:-1]


@cache
def _candidates():
    band = BandType(28.5, 0.010)
    kind = Kind(band, INNER.lever, INNER.limit)
    box = Box(0.005, 0.02, -0.01, 0.01)
    sizes = sw.Tolerances(anchor=1e-4, stiffness=0.02, rest_length=0.02, lever=1e-4)
    rule = Rule((-0.010, 0.0), (kind,), sizes, 10.0, False, box)
    return rule, np.array([[0.011, 0.002], [0.016, -0.004]])


@route("end forces of places for an anchor", FORCE)
def _():
    rule, q = _candidates()
    return rule.kinds[0].ends(rule.differences(q))[0]


@route("deviations of places for an anchor", FORCE)
def _():
    rule, q = _candidates()
    return rule.these(q, np.zeros(2, int)).down


@route("stiffness of a calibration", OVER_FORCE)
def _():
    recorded = np.linspace(0.2, -0.3, 12)
    samples = []
    for x, y in ((10, 0), (20, 5), (20, -5)):
        one = cell(x, y)
        way, d = np.linspace(0.001, 0.019, 12), one.bands[0].d
        samples.append(lab.Sample("", d, 1, one, way, recorded, False, d))
    return [lab.calibrate(lab.Prepared(tuple(samples)), "linear")["stiffness_1"].value]


@route("snap of the gait that is predicted", None)
def _():
    legs = [
        robot.Leg(side, sw.Chain((INNER, replace(OUTER, name=""))), (0.008, way * 0.0575))
        for side, way in (("left", 1), ("right", -1))
    ]
    # What `predict` is made of, in one pass; its doubts would take the interpreter a minute.
    with mock.patch.object(leg_cycles, "PASSES", 1):
        travel = leg_cycles.leg_cycles(robot.Robot(legs))[0].halves[0].travel
    jump = np.argmax(np.abs(np.diff(travel[:, -1])))
    return [np.sum(travel[jump])]


def answer(way: Callable[[], Any]) -> list[float] | str:
    """The numbers, or what went wrong."""
    try:
        return np.ravel(way()).tolist()
    except Exception as error:
        return repr(error)


if __name__ == "__main__":
    json.dump({name: answer(way) for name, (_, way) in ROUTES.items()}, sys.stdout)
