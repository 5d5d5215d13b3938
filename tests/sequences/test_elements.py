"""Chains of elements: graphs, readings and programs in phases, against equilibria found one by one."""

import itertools
import json
import math

import numpy as np
import pytest

import stepwell as sw
from equilibria import Curve, landed, places
from stepwell.concave import fewest_strokes, relays
from stepwell.sequences import Unreachable
from stepwell.sequences.branches.branches import Branches
from stepwell.sequences.graphs.exchange import (
    from_dot,
    from_graphml,
    from_json,
    to_dot,
    to_graphml,
    to_json,
)
from stepwell.sequences.graphs.fields import from_switching_fields, preisach, switching_fields
from stepwell.sequences.graphs.node import TransitionKind
from stepwell.sequences.graphs.transition_graph import TransitionGraph, _assembled, graph

WAYS = [(to_json, from_json), (to_graphml, from_graphml), (to_dot, from_dot)]


def curve(*points: tuple[float, float], stops: tuple[bool, bool] = (False, False)) -> Curve:
    """Straight between these points [mm, N]."""
    travel, force = zip(*points, strict=True)
    return Curve(tuple(s * 1e-3 for s in travel), force, stops)


EARLY = curve((0, 0), (1, 0.8), (3, -0.9), (5, 1.6))
LATE = curve((0, 0), (1.2, 1.3), (2.5, -0.3), (4, 1.4))
STEEP = curve((0, 0), (0.7, 1.05), (2, -1.4), (5, 2.0))
THREE = curve((0, 0), (1, 1.0), (2, -0.6), (3, 1.2), (4.2, -0.2), (6, 1.5))
SKIPS = curve((0, 0), (1, 1.4), (2, -1.0), (3, 0.7), (4.2, -0.2), (6, 1.5))
STOPPED = curve((0, 0.5), (4, -0.45), stops=(True, True))
HALF = curve((0, 0.1), (1, 0.9), (3, -0.7), stops=(True, True))
CHAINS = {
    "two unlike peaks": (EARLY, LATE),
    "three unlike peaks": (STEEP, LATE, EARLY),
    "three phases": (THREE, EARLY),
    "a phase that is passed by": (SKIPS, LATE),
    "stops": (STOPPED, EARLY),
    "stops and rising ends": (HALF, LATE, STOPPED),
}
DRIVES = ["stroke", "force", 150.0, 900.0]


def element(one: Curve, name: str = "") -> sw.Element:
    return sw.Element.from_points(one.travel, one.force, name, stops=one.stops)


def chain_of(*curves: Curve) -> sw.Chain:
    return sw.Chain([element(one) for one in curves])


def weights(drive) -> tuple[float, float]:
    return {"stroke": (1.0, 0.0), "force": (0.0, 1.0)}.get(drive) or (1.0, 1.0 / drive)


def by_engine(chain: sw.Chain) -> TransitionGraph:
    """The whole graph, with every branch followed."""
    branches = Branches(chain)
    phases = [range(int(last) + 1) for last in chain.last_state]
    every = ["".join(map(str, one)) for one in itertools.product(*phases)]
    stands = [branches.vertex(state) for state in every]
    first = [branches.at(*place) for place in stands if place is not None]
    return _assembled(branches, sorted(branches.all_from(first)), None)


def inside(place, found: TransitionGraph) -> tuple[float, float]:
    """The drives of a place, as far as the graph goes."""
    ends = [found.node(label) for label in found]
    return max(place.low, min(n.low for n in ends)), min(place.high, max(n.high for n in ends))


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("name", CHAINS)
def test_every_node_is_a_family_of_equilibria_and_every_vertex_is_one(name, drive):
    curves = CHAINS[name]
    found = graph(chain_of(*curves), drive)
    known = places(list(curves), *weights(drive))
    slip = 1e-9 * (max(found.node(v).high for v in found) - min(found.node(v).low for v in found))
    for label in found:
        node = found.node(label)
        assert any(
            place.state == node.state
            and inside(place, found) == pytest.approx((node.low, node.high), rel=0, abs=slip)
            for place in known
        ), node
    stand = sorted(place.state for place in known if "-" not in place.state)
    assert sorted(found.node(label).state for label in found.vertices) == stand


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("name", CHAINS)
def test_every_snap_lands_where_a_flow_in_small_steps_does(name, drive):
    curves = CHAINS[name]
    if drive == "stroke" and any(any(one.stops) for one in curves):
        pytest.skip("the flow knows no stops under a prescribed stroke")
    found = graph(chain_of(*curves), drive)
    alpha, beta = weights(drive)
    snaps = 0
    for label, target, transitions in found.edges(data="transitions"):
        for one in transitions:
            if one.kind is not TransitionKind.SNAP:
                continue
            snaps += 1
            node = found.node(label)
            begin = node.travel_high if one.direction > 0 else node.travel_low
            past = one.drive + one.direction * (1e-7 if alpha else 1e-4)
            travel = landed(list(curves), begin, past, alpha, beta)
            there = "".join(c.digit(s) for c, s in zip(curves, travel, strict=True))
            assert there == found.node(target).state, (label, target, one)
    assert snaps > 0


@pytest.mark.parametrize("name", CHAINS)
def test_under_a_force_elements_have_the_engines_graph_in_closed_form(name):
    chain = sw.Chain(chain_of(*CHAINS[name]).cells, actuator_stiffness=0.0)
    fields = relays(chain)
    assert fields is not None
    assert_alike(preisach(chain, fields), by_engine(chain))


def test_levers_and_elements_in_one_chain_are_relays_under_a_force_together():
    lever = sw.Cell(sw.Band((0.0, 0.0), (0.020, 0.003)))
    chain = sw.Chain([element(THREE), lever, element(STOPPED)], actuator_stiffness=0.0)
    found = graph(chain)
    assert found.method.startswith("closed form")
    assert len(found.vertices) == 3 * 2 * 2
    assert_alike(found, by_engine(chain))


def assert_alike(one: TransitionGraph, other: TransitionGraph) -> None:
    assert set(one) == set(other)
    scale = max(abs(one.node(label).high) for label in one)
    for label in one:
        a, b = one.node(label), other.node(label)
        assert (a.low, a.high) == pytest.approx((b.low, b.high), rel=0, abs=1e-9 * scale)
        for mine, its in ((a.travel_low, b.travel_low), (a.travel_high, b.travel_high)):
            assert mine == pytest.approx(its, rel=0, abs=1e-9)
        for direction in (+1, -1):
            ways = one.transition(label, direction), other.transition(label, direction)
            if ways[0] is None or ways[1] is None:
                assert ways == (None, None)
                continue
            (to, mine), (its_to, its) = ways
            assert to == its_to and mine.cells == its.cells and mine.kind is its.kind
            assert mine.drive == pytest.approx(its.drive, rel=1e-9, abs=1e-9 * scale)
            assert mine.released == pytest.approx(its.released, rel=1e-6, abs=1e-9)


def test_a_chain_of_sixteen_phases_and_more_is_seen_whole_under_a_force():
    peaks = np.linspace(0.81, 1.21, 9)
    cells = [element(curve((0, 0), (1, p), (3, -p / 2), (6, 2))) for p in peaks]
    found = graph(sw.Chain([*cells, element(THREE)]), "force")
    assert len(found.vertices) == 2**9 * 3
    assert found.reading.return_point_memory.holds and not found.reading.scrambling


def test_too_many_states_are_refused_by_their_number(monkeypatch):
    monkeypatch.setenv("STEPWELL_LIMITS", "graph_cells=3,relays=3")
    chain = chain_of(THREE, SKIPS, EARLY)
    with pytest.raises(sw.InputError, match="as many states as 5 cells of which all 2"):
        graph(chain)
    assert len(graph(chain, start="000").vertices) > 3


def test_a_folded_element_is_the_element_in_front_of_its_spring():
    # A trilinear snap behind 400 N/m inside the element: the same drives as with both in the chain.
    inner = np.linspace(0, 5e-3, 401)
    force = np.interp(inner, EARLY.travel, EARLY.force)
    folded = sw.Element.from_curve(inner + force / 400, force)
    assert len(folded.laws) == 2
    spring = Curve((0.0, 1e-3), (0.0, 0.4))
    for drive in ("stroke", 900.0):
        found = graph(sw.Chain([folded, element(LATE)]), drive)
        known = places([EARLY, spring, LATE], *weights(drive))
        vertices = {p.state: inside(p, found) for p in known if "-" not in p.state}
        for label in found.vertices:
            node = found.node(label)
            apart = vertices[f"{node.state[0]}0{node.state[1]}"]
            assert (node.low, node.high) == pytest.approx(apart, rel=0, abs=1e-9)
        assert len(found.vertices) == len(vertices) == 4
