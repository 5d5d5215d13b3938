"""Chains of elements: graphs, readings and programs in phases, against a brute force."""

import itertools
import json
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import stepwell as sw
from equilibria import Curve, landed, places
from facts import refuses
from sizes import SIZE, examples
from stepwell.base import Measure
from stepwell.concave import relays
from stepwell.sequences import ProgramMethod, Unreachable, planning as plan
from stepwell.sequences.branches import Branches
from stepwell.sequences.cycles import sequence_of
from stepwell.sequences.exchange import (
    from_dot,
    from_graphml,
    from_json,
    to_dot,
    to_graphml,
    to_json,
)
from stepwell.sequences.fields import from_switching_fields, preisach, switching_fields
from stepwell.sequences.mesostates import Routes, atlas
from stepwell.sequences.nodes import TransitionKind
from stepwell.sequences.planning import _plan_by_relays, _task
from stepwell.sequences.transition_graph import TransitionGraph, _assembled, graph

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
# The quick run takes each chain and each drive, not each of one with each of the other.
EACH = [
    (name, drive)
    for k, name in enumerate(CHAINS)
    for j, drive in enumerate(DRIVES)
    if SIZE == "full" or (k + j) % 3 == 0
]


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


def any_curve(rng: np.random.Generator) -> Curve:
    """One bump or two, open or stopped at either end, which may be where the force falls."""
    points = [(0.0, 0.0)]
    for _ in range(int(rng.integers(1, 3))):
        for rise in (rng.uniform(0.3, 1.5), -rng.uniform(0.3, 2.0)):
            points.append((points[-1][0] + rng.uniform(0.5, 1.5), points[-1][1] + rise))
    points.append((points[-1][0] + rng.uniform(0.5, 2), points[-1][1] + rng.uniform(0.5, 2.5)))
    stops = bool(rng.random() < 0.3), bool(rng.random() < 0.3)
    begin = int(stops[0] and rng.random() < 0.5)
    end = len(points) - int(stops[1] and rng.random() < 0.5)
    return curve(*points[begin:end], stops=stops)


def inside(place, t_graph: TransitionGraph) -> tuple[float, float]:
    """The drives of a place, as far as the graph goes."""
    ends = [t_graph.node(label) for label in t_graph]
    return max(place.low, min(n.low for n in ends)), min(place.high, max(n.high for n in ends))


@pytest.mark.slow
@pytest.mark.parametrize(("name", "drive"), EACH)
def test_every_node_is_a_family_of_equilibria_and_every_vertex_is_one(name, drive):
    assert_enumerated(CHAINS[name], drive)


@pytest.mark.slow
@settings(max_examples=examples(12, full=1200))
@given(
    seed=st.integers(0, 2**32 - 1),
    cells=st.integers(1, 3),
    drive=st.one_of(st.sampled_from(["stroke", "force"]), st.floats(50, 3000)),
)
def test_so_is_every_node_of_random_elements(seed, cells, drive):
    rng = np.random.default_rng(seed)
    t_graph = assert_enumerated([any_curve(rng) for _ in range(cells)], drive)
    assert t_graph.reading.main_loop.up[0] == t_graph.zero


def assert_enumerated(curves, drive) -> TransitionGraph:
    """The graph, whose nodes are among all families of equilibria, and its vertices all."""
    t_graph = graph(chain_of(*curves), drive)
    known = places(list(curves), *weights(drive))
    slip = 1e-9 * (
        max(t_graph.node(v).high for v in t_graph) - min(t_graph.node(v).low for v in t_graph)
    )
    for label in t_graph:
        node = t_graph.node(label)
        assert any(
            place.state == node.state
            and inside(place, t_graph) == pytest.approx((node.low, node.high), rel=0, abs=slip)
            for place in known
        ), node
    stand = sorted(place.state for place in known if "-" not in place.state)
    assert sorted(t_graph.node(label).state for label in t_graph.vertices) == stand
    return t_graph


# The flow in small steps knows no stops under a prescribed stroke.
FLOWS = [(name, drive) for name in CHAINS for drive in DRIVES if "stop" not in name]
FLOWS += [(name, drive) for name in CHAINS for drive in DRIVES[1:] if "stop" in name]
FLOWS = [one for one in FLOWS if one in EACH]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "drive"), FLOWS)
def test_every_snap_lands_where_a_flow_in_small_steps_does(name, drive):
    curves = CHAINS[name]
    t_graph = graph(chain_of(*curves), drive)
    alpha, beta = weights(drive)
    snaps = 0
    for label, target, one in t_graph.transitions():
        if one.kind is not TransitionKind.SNAP:
            continue
        snaps += 1
        node = t_graph.node(label)
        begin = node.travel_high if one.direction > 0 else node.travel_low
        past = one.drive + one.direction * (1e-7 if alpha else 1e-4)
        travel = landed(list(curves), begin, past, alpha, beta)
        there = "".join(c.digit(s) for c, s in zip(curves, travel, strict=True))
        assert there == t_graph.node(target).state, (label, target, one)
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
    t_graph = graph(chain)
    assert t_graph.method.startswith("closed form")
    assert len(t_graph.vertices) == 3 * 2 * 2
    assert_alike(t_graph, by_engine(chain))


def assert_alike(one: TransitionGraph, other: TransitionGraph) -> None:
    assert set(one) == set(other)
    scale = max(abs(one.node(label).high) for label in one)
    for label in one:
        a, b = one.node(label), other.node(label)
        assert (a.low, a.high) == pytest.approx((b.low, b.high), rel=0, abs=1e-9 * scale)
        for mine, its in ((a.travel_low, b.travel_low), (a.travel_high, b.travel_high)):
            assert mine == pytest.approx(its, rel=0, abs=1e-9)
        for direction in (+1, -1):
            way, its_way = one.transition(label, direction), other.transition(label, direction)
            if way is None or its_way is None:
                assert way is its_way
                continue
            (to, mine), (its_to, its) = way, its_way
            assert to == its_to and mine.cells == its.cells and mine.kind is its.kind
            assert mine.drive == pytest.approx(its.drive, rel=1e-9, abs=1e-9 * scale)
            assert mine.released == pytest.approx(its.released, rel=1e-6, abs=1e-9)


@pytest.mark.slow
def test_a_chain_of_sixteen_phases_and_more_is_seen_whole_under_a_force():
    peaks = np.linspace(0.81, 1.21, 9)
    cells = [element(curve((0, 0), (1, p), (3, -p / 2), (6, 2))) for p in peaks]
    t_graph = graph(sw.Chain([*cells, element(THREE)]), "force")
    assert len(t_graph.vertices) == 2**9 * 3
    assert t_graph.reading.return_point_memory.holds and not t_graph.reading.scrambling


def test_too_many_states_are_refused_by_their_number(monkeypatch):
    monkeypatch.setenv("STEPWELL_LIMITS", "graph_cells=3,relays=3")
    chain = chain_of(THREE, SKIPS, EARLY)
    with refuses(sw.InputError, "5 cells", "2", "at most 3"):
        graph(chain)
    assert len(graph(chain, start="000").vertices) > 3


@pytest.mark.slow
def test_a_folded_element_is_the_element_in_front_of_its_spring():
    # A trilinear snap behind 400 N/m inside the element: the same drives as with both in the chain.
    inner = np.linspace(0, 5e-3, 401)
    force = np.interp(inner, EARLY.travel, EARLY.force)
    folded = sw.Element.from_curve((inner + force / 400).tolist(), force.tolist())
    assert len(folded.laws) == 2
    spring = Curve((0.0, 1e-3), (0.0, 0.4))
    for drive in ("stroke", 900.0):
        t_graph = graph(sw.Chain([folded, element(LATE)]), drive)
        known = places([EARLY, spring, LATE], *weights(drive))
        vertices = {p.state: inside(p, t_graph) for p in known if "-" not in p.state}
        for label in t_graph.vertices:
            node = t_graph.node(label)
            apart = vertices[f"{node.state[0]}0{node.state[1]}"]
            assert (node.low, node.high) == pytest.approx(apart, rel=0, abs=1e-9)
        assert len(t_graph.vertices) == len(vertices) == 4


# --- as text --------------------------------------------------------------------------------


def pouches() -> sw.Chain:
    """Two that are filled with volume."""
    rises = [([0, 1, 3, 5], [0, 4.0, 1.5, 6.0]), ([0, 2, 3, 6], [0, 5.0, 2.0, 7.0])]
    return sw.Chain(
        [
            sw.Element.from_points(
                [v * 1e-6 for v in volume], [p * 1e3 for p in pressure], measure=Measure.VOLUME
            )
            for volume, pressure in rises
        ]
    )


@pytest.mark.parametrize(("out", "back"), WAYS)
@pytest.mark.parametrize("drive", ["stroke", "force"])
def test_graphs_of_more_phases_and_other_measures_come_back_the_same(out, back, drive):
    for chain in (chain_of(THREE, EARLY), pouches()):
        t_graph = graph(chain, drive)
        again = back(out(t_graph))
        assert again.nodes == t_graph.nodes
        assert list(again.transitions()) == list(t_graph.transitions())
        assert (again.unit, again.measure) == (t_graph.unit, chain.measure)
        assert str(again.reading) == str(t_graph.reading)


def test_keys_and_labels_tell_the_units_of_the_measure():
    by_volume, by_pressure = graph(pouches(), "volume"), graph(pouches(), "pressure")
    data = json.loads(to_json(by_volume))
    assert (data["actuator"], data["drive_unit"]) == ("volume", "m³")
    assert {"low_m3", "force_high_Pa", "travel_low_m3"} < set(data["nodes"][0])
    assert "drive_Pa" in json.loads(to_json(by_pressure))["edges"][0]
    assert "4 kPa" in to_dot(by_pressure) and " mL" in to_dot(by_volume)
    assert "driven by pressure" in str(by_pressure.reading)
    stiffness = 2e9
    assert graph(pouches(), stiffness).actuator == "spring of 2 kPa/mL"


def test_dot_ranks_vertices_by_the_sum_of_their_phases():
    text = to_dot(graph(chain_of(THREE, EARLY), "force"))
    ranks = re.findall(r"rank=same; (.*?); }", text)
    assert [rank.replace('"', "").split("; ") for rank in ranks] == [
        ["00"],
        ["10", "01"],
        ["20", "11"],
        ["21"],
    ]


# --- switching fields -----------------------------------------------------------------------


@pytest.mark.parametrize("drive", ["force", 30.0])
def test_elements_of_two_phases_are_the_hysterons_of_their_switching_fields(drive):
    t_graph = graph(chain_of(EARLY, LATE, STEEP), drive)
    again = from_switching_fields(switching_fields(t_graph))
    assert set(again) == set(t_graph)
    for a, b, one in t_graph.transitions():
        way = again.transition(a, one.direction)
        assert way is not None and way[0] == b
        assert way[1].drive == pytest.approx(one.drive, rel=1e-9)


def test_an_element_of_three_phases_has_no_switching_fields_of_a_hysteron():
    with refuses(sw.InputError, "inner", "3 phases", "two", "`fields`"):
        switching_fields(graph(chain_of(THREE, EARLY), "force"))
    with refuses(sw.InputError, "rest", "phases", "chain.graph('force')", "5000"):
        switching_fields(graph(chain_of(EARLY, LATE), 5000.0))


# --- memory ---------------------------------------------------------------------------------


@pytest.mark.parametrize("drive", ["stroke", 150.0, 900.0])
def test_scrambled_flips_are_those_that_a_list_of_all_shows(drive):
    t_graph = graph(chain_of(THREE, LATE, EARLY), drive)
    seen: set[tuple[int, tuple[int, int], tuple[int, int]]] = set()
    for vertex in t_graph.vertices:
        for direction in (+1, -1):
            label = vertex
            while (way := t_graph.transition(label, direction)) and "-" in (label := way[0]):
                pass
            if "-" in label:
                continue
            last = graph_last(t_graph)
            pairs = zip(vertex, label, last, strict=True)
            moves = [(int(a), int(b), int(top)) for a, b, top in pairs]
            able = [(i, m) for i, m in enumerate(moves) if m[0] != (m[2] if direction > 0 else 0)]
            for i, (a, b, _) in able:
                for j, (c, d, _) in able:
                    if direction * (b - a) > 0 and direction * (d - c) <= 0:
                        seen.add((direction, (i, a), (j, c)))
    both = {(way, *sorted((i, j))) for way, i, j in seen if (way, j, i) in seen}
    scramblings = t_graph.reading.scrambling
    assert len(scramblings) == len(both)
    assert sorted((one.direction, one.cells) for one in scramblings) == sorted(
        (way, (i[0], j[0])) for way, i, j in both
    )


def graph_last(t_graph: TransitionGraph) -> str:
    return max(t_graph.vertices, key=lambda label: t_graph.node(label).level)


@pytest.mark.parametrize("drive", ["stroke", 150.0])
@pytest.mark.parametrize("name", ["three phases", "three unlike peaks"])
def test_a_loop_between_phases_is_gone_round_by_the_engine(name, drive):
    t_graph = graph(chain_of(*CHAINS[name]), drive)
    branches = atlas(t_graph)
    routes = Routes(branches.mesostates, branches.bottom)
    loops = t_graph.reading.sub_loops or ()
    assert loops or drive == "stroke"
    for loop in loops:
        assert t_graph.chain is not None
        gap = 1e-6 * (loop.high - loop.low)
        begin = routes.turns(
            int(branches.branch_of[t_graph.nodes.find(loop.up[0])]), loop.low + gap
        )
        round_it = [loop.high + gap, loop.low - gap]
        once = t_graph.chain.path([*begin, *round_it], start=t_graph.node(t_graph.zero).travel_low)
        again = t_graph.chain.path([loop.low - gap, *round_it], start=once.end.tolist())
        np.testing.assert_allclose(again.end, once.end, atol=1e-9)
        passed = {state for state in sequence_of(again).states if "-" not in state}
        assert passed == {t_graph.node(label).state for label in loop.vertices}


# --- programs -------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(("name", "drive"), EACH)
def test_a_program_leads_to_each_state_that_the_graph_reaches_and_to_no_other(name, drive):
    t_graph = graph(chain_of(*CHAINS[name]), drive)
    chain = t_graph.chain
    assert chain is not None
    reached = t_graph.reachable()
    for to in t_graph.vertices:
        if to not in reached:
            with pytest.raises(Unreachable) as caught:
                chain.program(to)
            assert caught.value.proved
            continue
        program = chain.program(to)
        assert program.arrives == program.sequence[-1] == to
        node = t_graph.node(to)
        assert node.low - 1e-9 <= program.low <= program.high <= node.high + 1e-9
        for low in (False, True):
            points = [program.begin, *(edge(turn, low) for turn in program.turns)]
            end = edge(program, low)
            assert state_at(chain, [*points, end]) == to


def edge(window, low: bool) -> float:
    """Just within an end of a window."""
    share = 1e-3 if low else 1 - 1e-3
    return window.low + share * (window.high - window.low)


def state_at(chain: sw.Chain, points: list[float]) -> str:
    return sw.sequences.cycles.arrival(chain.path(points))


def test_a_vertex_of_elements_is_held_over_a_range_of_strokes():
    program = chain_of(EARLY, LATE).program("11")
    assert program.high - program.low > 1e-3
    still = chain_of(EARLY, LATE).program("00")
    assert still.strokes == 0 and still.low < still.begin < still.high


@pytest.mark.slow
@pytest.mark.parametrize("name", ["three unlike peaks", "three phases", "stops and rising ends"])
def test_the_plan_of_relays_is_as_short_as_a_search_under_a_force(name):
    chain = replace(chain_of(*CHAINS[name]), actuator_stiffness=0.0)
    t_graph = graph(chain)
    for start, to in itertools.permutations(t_graph.vertices, 2):
        task = _task(chain, start, to)
        try:
            searched = chain.program(to, start=start)
        except Unreachable:
            with refuses(Unreachable, "smaller", "up", "down"):
                _plan_by_relays(task)
            continue
        planned = _plan_by_relays(task)
        assert planned is not None and planned.method is ProgramMethod.RELAYS
        assert planned.strokes == searched.strokes and planned.arrives == to


def test_where_a_phase_is_passed_by_relays_do_not_plan():
    chain = replace(chain_of(SKIPS, LATE), actuator_stiffness=0.0)
    fields = relays(chain)
    assert fields is not None and fields.skips
    assert _plan_by_relays(_task(chain, "00", "11")) is None
    # Phase 1 is held on the way down only.
    assert chain.program("10").strokes == 2


def test_eight_elements_are_planned_without_looking_at_every_branch():
    cells = [element(curve((0, 0), (1, p), (3, -p / 2), (6, 3))) for p in np.linspace(0.8, 1.5, 7)]
    chain = sw.Chain([*cells, element(THREE)], actuator_stiffness=0.0)
    assert len(chain) > plan._LOOKED_AT
    program = chain.program("01010101")
    assert program.shortest and program.arrives == "01010101"


def test_what_relays_forbid_under_a_force_is_reported_in_forces_and_phases():
    low = curve((0, 0), (1, 0.5), (2, 0.1), (4, 2.0))
    high = curve((0, 0), (1, 1.5), (2, 0.3), (4, 2.5))
    chain = replace(chain_of(low, high), actuator_stiffness=0.0)
    with refuses(Unreachable, "inner", "1", "before outer", "0", "after"):
        chain.program("01")
    others = [element(curve((0, 0), (1, p), (3, -p), (6, 2))) for p in np.linspace(0.8, 1.2, 5)]
    longer = sw.Chain([*chain.cells, *others], actuator_stiffness=0.0)
    with refuses(Unreachable, "cell 1", "smaller", "up") as caught:
        longer.program("0100000")
    assert caught.value.proved and "F0" not in str(caught.value)


def test_a_state_that_no_force_holds_is_refused_in_forces_of_phases():
    pulls = curve((0, -3), (1, -2), (3, -4), (5, 0))
    pushes = curve((0, 2), (1, 5), (3, 3), (5, 6))
    chain = chain_of(pulls, pushes)
    words = "01", "no equilibrium", "1 outer", "at least 3 N", "0 inner", "-2 N"
    with refuses(Unreachable, *words):
        chain.program("01")
    with refuses(sw.InputError, "01", "force", "every cell", "phase"):
        graph(chain, start="01")


@pytest.mark.parametrize("drive", ["stroke", "force"])
def test_with_friction_a_program_is_searched_that_the_engine_follows(drive):
    cells = [replace(element(one), friction=0.05) for one in (THREE, EARLY)]
    chain = sw.Chain(cells, actuator_stiffness=0.0 if drive == "force" else float("inf"))
    for to in ("01", "11", "21"):
        program = chain.program(to)
        assert program.method is ProgramMethod.FRICTION and program.arrives == to
    with pytest.raises(sw.InputError, match=r"inner has friction 0.05 N"):
        graph(chain)


def test_a_program_of_pouches_is_reported_in_their_units(tmp_path):
    program = pouches().program("11")
    assert str(program).endswith(" mL") and program.arrives == "11"
    program.to_csv(tmp_path / "program.csv")
    assert (tmp_path / "program.csv").read_text().startswith("what,drive_mL,low_mL,high_mL")
    given = sw.Program.given(pouches(), [0.0, program.end])
    assert given.start == "00" and given.target == "11"
