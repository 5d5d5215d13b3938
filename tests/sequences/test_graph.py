"""The transition graph: every node stands where it says, every edge is what the chain does."""

import itertools
import math
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st

import stepwell as sw
from chains import any_chain, concave_chain
from facts import says
from oracle import OracleCell, follow
from sizes import examples
from stepwell.concave import relays
from stepwell.sequences.branches import Branches
from stepwell.sequences.fields import from_switching_fields, preisach
from stepwell.sequences.nodes import Node, TransitionKind
from stepwell.sequences.passages import order_kept
from stepwell.sequences.transition_graph import TransitionGraph, _assembled, graph
from stepwell.statics import EventKind, StaticsError

SEEDS = st.integers(0, 2**32 - 1)
# Stiffnesses between a rigid actuator and none.
DRIVES = st.one_of(st.sampled_from(["stroke", "force"]), st.floats(5, 3000))


def straight(*d_x: float) -> sw.Chain:
    """Cells of the paper's band, anchored d_x [mm] apart."""
    return sw.Chain([sw.Cell(sw.Band((0.0, 0.0), (x / 1e3, 0.0))) for x in d_x])


def stacked(count: int) -> sw.Chain:
    """Cells that come back in the order in which they went, so that few states are reached."""
    heights = np.linspace(-0.015, 0.015, count).tolist()
    return sw.Chain([sw.Cell(sw.Band((-0.010, 0.0), (0.010, y))) for y in heights])


def drawn(seed: int, cells: int, drive, kind=any_chain) -> TransitionGraph:
    """The graph of a random chain; the draw is dropped where statics does not tell.

    It does not where two cells can be slack at once: then each may stand anywhere.
    """
    rng = np.random.default_rng(seed)
    chain = kind(rng, cells, friction=False) if kind is any_chain else kind(rng, cells)
    grids = [cell.angle(np.linspace(0, cell.full_travel, 2000)) for cell in chain.cells]
    forces = [cell.force(grid) for cell, grid in zip(chain.cells, grids, strict=True)]
    assume(sum(np.any(force == 0) for force in forces) < 2)
    assume(any(np.any(force) for force in forces))
    try:
        t_graph = graph(chain, drive)
    except StaticsError:
        assume(False)
        raise
    assume(not t_graph.ties)
    return t_graph


def state_at(chain: sw.Chain, travels) -> str:
    full = [cell.full_travel for cell in chain.cells]
    return "".join(
        "0" if s == 0 else "1" if s == f else "-" for s, f in zip(travels, full, strict=True)
    )


def states(n: int) -> list[str]:
    return ["".join(bits) for bits in itertools.product("01", repeat=n)]


def by_engine(chain: sw.Chain) -> TransitionGraph:
    """The whole graph, with every branch followed."""
    branches = Branches(chain)
    places = [branches.vertex(state) for state in states(len(chain))]
    first = [branches.at(*place) for place in places if place is not None]
    return _assembled(branches, sorted(branches.all_from(first)), None)


def is_ideal(state: str, up, down) -> bool:
    """Every cell that goes up before and comes down after one at 1 is at 1."""
    return not any(
        state[j] == "1" and state[i] == "0" and up[i] < up[j] and down[i] < down[j]
        for i in range(len(state))
        for j in range(len(state))
    )


def is_flat(node: Node) -> bool:
    """Whether a slack cell goes through at one force: there it may stand anywhere."""
    return "-" in node.state and node.high - node.low < 1e-9


def within(node: Node, share: float) -> float:
    return node.low + share * (node.high - node.low)


@pytest.mark.slow
@settings(max_examples=examples(8, full=800))
@given(SEEDS, st.integers(1, 4), DRIVES)
def test_every_node_stands_from_one_end_to_the_other_with_nothing_happening(seed, cells, drive):
    t_graph = drawn(seed, cells, drive)
    assert t_graph.chain is not None
    for label in t_graph:
        node = t_graph.node(label)
        if is_flat(node):
            continue
        inside = t_graph.chain.path(
            [within(node, 0.5), within(node, 0.999)], start=middle(t_graph, node)
        )
        assert state_at(t_graph.chain, inside.end) == node.state
        assert not inside.events
        down = t_graph.chain.path([within(node, 0.5), within(node, 0.001)], start=inside.start)
        assert state_at(t_graph.chain, down.end) == node.state
        assert not down.events


def middle(t_graph: TransitionGraph, node: Node) -> list[float]:
    """Travels half-way along a node, coming from an end or from the node before."""
    assert t_graph.chain is not None
    goal = within(node, 0.5)
    ways = [([node.low, goal], node.travel_low), ([node.high, goal], node.travel_high)]
    for points, travels in ways:
        try:
            path = t_graph.chain.path(points, start=travels)
        except ValueError:
            continue  # that end is a fold, where an equilibrium is only just stable
        if state_at(t_graph.chain, path.end) == node.state:
            return path.end.tolist()
    for label, target, way in t_graph.transitions():
        if target != node.label:
            continue
        before = t_graph.node(label)
        beyond = way.drive + 1e-3 * ((node.high if way.direction > 0 else node.low) - way.drive)
        points = [within(before, 0.5), beyond, goal]
        path = t_graph.chain.path(points, start=middle(t_graph, before))
        if state_at(t_graph.chain, path.end) == node.state:
            return path.end.tolist()
    raise AssertionError(f"nothing leads to {node}")


@pytest.mark.slow
@settings(max_examples=examples(8, full=800))
@given(SEEDS, st.integers(1, 4), DRIVES)
def test_every_edge_is_what_the_engine_does_across_the_end_of_a_node(seed, cells, drive):
    t_graph = drawn(seed, cells, drive)
    chain = t_graph.chain
    assert chain is not None
    for label, direction in itertools.product(t_graph, (+1, -1)):
        node, way = t_graph.node(label), t_graph.transition(label, direction)
        if way is None:
            assert set(node.state) == {"1" if direction > 0 else "0"}
            continue
        target, end = t_graph.node(way[0]), way[1]
        if is_flat(node) or is_flat(target):
            continue
        assert end.drive == pytest.approx(node.high if direction > 0 else node.low, abs=1e-12)
        beyond = (end.drive + (target.high if direction > 0 else target.low)) / 2
        path = chain.path([within(node, 0.5), beyond], start=middle(t_graph, node))
        assert state_at(chain, path.end) == target.state
        snaps = [event for event in path.events if event.kind is EventKind.SNAP]
        assert len(snaps) == (end.kind is TransitionKind.SNAP)
        assert path.released == pytest.approx(end.released, rel=1e-6, abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(examples(1, full=60)))
@pytest.mark.parametrize("control", ["stroke", 120.0])
def test_edges_are_what_a_brute_force_follower_does(seed, control):
    rng = np.random.default_rng(seed)
    chain = concave_chain(rng, 3)
    t_graph = graph(chain, control)
    cells = [
        OracleCell(c.lever, c.limit, [(*b.d, b.stiffness, b.rest_length, 0.0, 0.0, False)])
        for c in chain.levers
        for b in c.bands
    ]
    for label in t_graph.vertices:
        node = t_graph.node(label)
        for direction in (+1, -1):
            way = t_graph.transition(label, direction)
            # Leaving a vertex of a rigid chain is a switch; its snap comes after that.
            while way is not None and way[1].kind is TransitionKind.SWITCH:
                way = t_graph.transition(way[0], direction)
            if way is None:
                continue
            target, end = t_graph.node(way[0]), way[1]
            # Far enough past the end for a drive step, and not to the next event.
            beyond = end.drive + 0.5 * ((target.high if direction > 0 else target.low) - end.drive)
            if abs(beyond - end.drive) < 2e-4:
                continue
            points = [(node.low + node.high) / 2, beyond]
            run = follow(cells, points, start=node.travel_low, control=control, steps=400)
            expected = _followed(t_graph, label, direction, beyond)
            np.testing.assert_allclose(run.travel[-1], expected, atol=2e-4)


def _followed(t_graph: TransitionGraph, label: str, direction: int, drive: float):
    """Travels where the graph says that the chain stands at a drive."""
    while True:
        node = t_graph.node(label)
        if node.low <= drive <= node.high:
            break
        way = t_graph.transition(label, direction)
        assert way is not None
        label = way[0]
    assert t_graph.chain is not None
    return t_graph.chain.path([within(node, 0.5), drive], start=middle(t_graph, node)).end


@pytest.mark.slow
@settings(max_examples=examples(6, full=500))
@given(SEEDS, st.integers(1, 6))
def test_concave_cells_under_a_force_have_the_engines_graph_in_closed_form(seed, cells):
    rng = np.random.default_rng(seed)
    chain = sw.Chain(concave_chain(rng, cells).cells, actuator_stiffness=0.0)
    fields = relays(chain)
    assume(fields is not None)
    assert fields is not None
    ours, engine = preisach(chain, fields), by_engine(chain)
    assert list(ours) == list(engine)
    assert set(ours.networkx.edges) == set(engine.networkx.edges)
    for label in ours:
        a, b = ours.node(label), engine.node(label)
        assert (a.state, a.branch, a.travel_low, a.travel_high) == (
            b.state,
            b.branch,
            b.travel_low,
            b.travel_high,
        )
        for name in ("low", "high", "force_low", "force_high"):
            assert getattr(a, name) == pytest.approx(getattr(b, name), abs=1e-12)
        for direction in (+1, -1):
            one, other = ours.transition(label, direction), engine.transition(label, direction)
            assert (one is None) == (other is None)
            if one is not None and other is not None:
                assert one[0] == other[0]
                assert (one[1].kind, one[1].cells) == (other[1].kind, other[1].cells)
                assert one[1].drive == pytest.approx(other[1].drive, abs=1e-12)
                assert one[1].released == pytest.approx(other[1].released, abs=1e-12)


def test_fourteen_cells_under_a_force_are_seen_whole():
    x = np.random.default_rng(0).permutation(np.linspace(10, 30, 14))
    t_graph = graph(straight(*x), "force")
    assert len(t_graph) == len(t_graph.vertices) == 2**14
    assert len(t_graph.reachable()) == 2**14


def falling_subsequences(down: list[float]) -> int:
    """How many there are, the empty one included: each ends somewhere."""
    ending = []
    for k, value in enumerate(down):
        ending.append(1 + sum(ending[i] for i in range(k) if down[i] > value))
    return 1 + sum(ending)


def relay_graph(up, down) -> TransitionGraph:
    """The graph of relays with these fields."""
    at_1 = np.array([[c == "1" for c in state] for state in states(len(up))])
    return from_switching_fields(np.where(at_1, down, up))


@pytest.mark.slow
@pytest.mark.parametrize("n", range(1, examples(5, full=6) + 1))
def test_relays_reach_as_many_states_as_there_are_falling_subsequences(n):
    # Terzi and Mungan 2020; all permutations.
    for order in itertools.permutations(range(n)):
        down = [-1.0 - rank for rank in order]
        t_graph = relay_graph(np.arange(1.0, n + 1), np.array(down))
        assert len(t_graph) == 2**n
        assert len(t_graph.reachable()) == falling_subsequences(down)


@pytest.mark.parametrize("n", [7, 8, 9, 10])
def test_so_do_random_ones_up_to_ten_and_both_extremes(n):
    rng = np.random.default_rng(n)
    up = np.arange(1.0, n + 1)
    rising = -1.0 - np.arange(n)[::-1]
    assert len(relay_graph(up, rising).reachable()) == n + 1
    assert len(relay_graph(up, rising[::-1]).reachable()) == 2**n
    for _ in range(3):
        down = rng.permutation(rising)
        assert len(relay_graph(up, down).reachable()) == falling_subsequences(down.tolist())


@pytest.mark.slow
@settings(max_examples=examples(5, full=400))
@given(SEEDS, st.integers(2, 5), DRIVES)
def test_from_all_0_every_ideal_is_reached_and_nothing_else_if_the_order_is_kept(
    seed, cells, drive
):
    t_graph = drawn(seed, cells, drive, concave_chain)
    assert t_graph.chain is not None
    fields = relays(t_graph.chain)
    assume(fields is not None)
    assert fields is not None
    ideals = {v for v in states(cells) if is_ideal(v, fields.up, fields.down)}
    reached = {v for v in t_graph.reachable() if "-" not in v}
    assert reached >= ideals
    if drive == "force" or (drive == "stroke" and order_kept(t_graph.chain, fields).only_ideals):
        assert reached == ideals
        assert len(ideals) == falling_subsequences(fields.down[np.argsort(fields.up)].tolist())


def test_where_another_cell_overtakes_the_leader_more_than_the_ideals_is_reached():
    bands = [((5.8, -4.9), 21.0, 0.9), ((7.5, -6.4), 40.3, 11.9), ((30.9, -0.7), 58.2, 13.8)]
    chain = sw.Chain(
        [
            sw.Cell(sw.Band((0, 0), (x / 1e3, y / 1e3), stiffness=k, rest_length=rest / 1e3))
            for (x, y), k, rest in bands
        ]
    )
    fields = relays(chain)
    assert fields is not None and fields.precedes(0, 1)
    assert not is_ideal("011", fields.up, fields.down)
    assert "011" in graph(chain).reachable()
    assert "011" not in graph(chain, "force").reachable()


def without_predecessor(up, down) -> set[str]:
    """States that stand and in whose window of forces no cell of theirs has come to be as it is."""
    starts: set[str] = set()
    for state in states(len(up)):
        at_1 = np.array([c == "1" for c in state])
        low, high = np.max(down[at_1], initial=-np.inf), np.min(up[~at_1], initial=np.inf)
        entered = np.any((low <= up[at_1]) & (up[at_1] < high))
        entered |= np.any((low < down[~at_1]) & (down[~at_1] <= high))
        if low <= high and not entered:
            starts.add(state)
    return starts


def swept(up, down) -> set[str]:
    """Standing states that no drive brings relays to from another, by moving it bit by bit."""
    levels = np.sort(np.concatenate([up, down]))
    drives = np.concatenate([[levels[0] - 1], (levels[1:] + levels[:-1]) / 2, [levels[-1] + 1]])
    standing: set[str] = set()
    come_to: set[str] = set()
    for state, (begin, drive) in itertools.product(states(len(up)), enumerate(drives)):
        now = np.array([c == "1" for c in state])
        if np.any(now & (drive < down)) or np.any(~now & (drive > up)):
            continue
        standing.add(state)
        for way in (drives[begin + 1 :], drives[:begin][::-1]):
            now = np.array([c == "1" for c in state])
            for field in way:
                now = (now | (field > up)) & ~(field < down)
                come_to |= {"".join("1" if c else "0" for c in now)} - {state}
    return standing - come_to


@pytest.mark.slow
@pytest.mark.parametrize("n", range(2, 7))
def test_relays_have_no_predecessor_where_no_cell_switches_in_the_window_of_the_state(n):
    rng = np.random.default_rng(n)
    simple = 0
    for _ in range(examples(6)):
        fields = np.sort(rng.permutation(2 * n).reshape(n, 2) - float(n), axis=1)
        down, up = fields.T
        expected = without_predecessor(up, down)
        assert swept(up, down) == expected
        assert set(relay_graph(up, down).reading.garden_of_eden or ()) == expected
        lone = {s for s in states(n) if s[np.argmin(up)] == "0" and s[np.argmax(down)] == "1"}
        simple += expected == lone
        # Where every B is below every A the ends of the orders say it all.
        up = up + 4 * n
        assert without_predecessor(up, down) == swept(up, down) == lone
    assert simple < examples(6)


def test_the_counter_example_of_the_theory_page_has_gardens_that_the_ends_of_the_orders_miss():
    up, down = np.array([0.1, 0.6, 0.4]), np.array([-0.5, 0.2, -0.2])
    assert swept(up, down) == without_predecessor(up, down) == {"110", "001"}


@pytest.mark.slow
@settings(max_examples=examples(5, full=400))
@given(SEEDS, st.integers(2, 6), DRIVES)
def test_a_garden_of_eden_is_out_of_reach_and_under_a_force_the_fields_tell_which(
    seed, cells, drive
):
    t_graph = drawn(seed, cells, drive, concave_chain)
    assert t_graph.chain is not None
    gardens = set(t_graph.reading.garden_of_eden or ())
    assert not gardens & t_graph.reachable()
    fields = relays(t_graph.chain)
    assume(fields is not None)
    assert fields is not None
    if drive == "force":
        assert gardens == without_predecessor(fields.up, fields.down)


def test_a_prescribed_stroke_can_come_to_what_a_force_cannot():
    # The chain of the theory page: its first cell has the least A, its second the largest B.
    chain = sw.Chain(
        [
            sw.Cell(sw.Band((0, 0), (0.0058, -0.0049), stiffness=21.0, rest_length=0.0009)),
            sw.Cell(sw.Band((0, 0), (0.0075, -0.0064), stiffness=40.3, rest_length=0.0119)),
            sw.Cell(sw.Band((0, 0), (0.0309, -0.0007), stiffness=58.2, rest_length=0.0138)),
        ]
    )
    assert all(cell.is_bistable for cell in chain.cells)
    assert graph(chain, "force").reading.garden_of_eden == ("010", "011")
    assert graph(chain, "stroke").reading.garden_of_eden == ()


def test_a_prescribed_stroke_can_leave_more_gardens_of_eden_than_a_force():
    # In snaps from states set by hand a third cell may join; then no order of A and B decides.
    bands = [((10.2455, -7.2223), 54.1541, 4.57999), ((19.0881, -11.7884), 40.5005, 2.76796)]
    bands += [((10.5401, 9.02917), 25.976, 2.49003)]
    chain = sw.Chain(
        [
            sw.Cell(sw.Band((0, 0), (x / 1e3, y / 1e3), stiffness=k, rest_length=rest / 1e3))
            for (x, y), k, rest in bands
        ]
    )
    assert graph(chain, "force").reading.garden_of_eden == ("001", "011")
    assert graph(chain, "stroke").reading.garden_of_eden == ("001", "101", "011")


def test_a_graph_from_one_state_is_part_of_the_whole():
    chain = straight(10, 20, 30)
    whole, part = graph(chain), graph(chain, start="110")
    assert whole.is_whole and not part.is_whole
    assert {(n.state, n.low, n.high) for n in map(part.node, part)} == {
        (n.state, n.low, n.high) for n in map(whole.node, whole)
    }


def test_a_graph_tells_what_it_is_of():
    chain = sw.Chain([sw.Cell(sw.Band((0, 0), (0.010, 0)), name="inside"), straight(30).cells[0]])
    rigid, soft, force = graph(chain), graph(chain, 50.0), graph(chain, "force")
    assert (rigid.actuator, soft.actuator, force.actuator) == (
        "stroke",
        "spring of 50 N/m",
        "force",
    )
    assert (rigid.unit, soft.unit, force.unit) == ("m", "m", "N")
    assert rigid.chain == chain and rigid.cells == 2 and rigid.names == ("inside", "outer")
    assert rigid.ties == () and "engine" in rigid.method and "closed form" in force.method
    assert force.vertices == ("00", "10", "01", "11")
    says(repr(force), "TransitionGraph(", "2 cells", "4 vertices", "4 nodes", "6 snaps")
    says(repr(rigid.node("00")), "Node(00", "0 to 0", "branch 0")
    way = force.transition("00", 1)
    assert way is not None
    says(repr(way[1]), "Transition(SNAP", "up", "0.157")
    assert force.transition("00", -1) is None
    assert force.reachable("nowhere") == frozenset()
    assert force.reachable("11") == frozenset(force)


def test_a_graph_cannot_be_changed():
    import networkx

    t_graph = graph(straight(10), "force")
    with pytest.raises(networkx.NetworkXError, match="rozen"):
        t_graph.networkx.add_node("2")
    with pytest.raises(ValueError, match="read-only"):
        t_graph.target[0, 0] = 1


@pytest.mark.parametrize("drive", ["stroke", "force", 50.0])
def test_its_graph_of_networkx_holds_the_same_nodes_and_transitions(drive):
    t_graph = graph(straight(10, 20, 15), drive)
    net = t_graph.networkx
    assert list(net) == list(t_graph)
    assert [net.nodes[label]["node"] for label in net] == list(t_graph.nodes)
    triples = {(a, b, one) for a, b, together in net.edges(data="transitions") for one in together}
    assert triples == set(t_graph.transitions()) and len(triples) == t_graph.transition_count
    for label in t_graph:
        assert t_graph.node(label).label == label
        for direction in (+1, -1):
            way = t_graph.transition(label, direction)
            out = [one for a, b, one in triples if a == label and one.direction == direction]
            assert out == ([] if way is None else [way[1]])
            assert way is None or way[0] in net[label]
    with pytest.raises(KeyError, match="nowhere"):
        t_graph.node("nowhere")


def test_a_graph_of_sixty_thousand_states_is_small_until_its_nodes_are_asked_for():
    x = np.random.default_rng(0).permutation(np.linspace(10, 30, 16))
    chain = sw.Chain(straight(*x).cells, actuator_stiffness=0.0)
    fields = relays(chain)
    assert fields is not None
    tracemalloc.start()
    t_graph = preisach(chain, fields)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(t_graph) == 2**16 and most < 200 * 2**16  # bytes a state
    state = "0110100110010110"
    assert t_graph.node(state).state == state and "networkx" not in vars(t_graph)


@pytest.mark.parametrize("cells", [1, 5, 8])
def test_what_is_reached_under_a_force_is_listed_without_the_rest(cells):
    rng = np.random.default_rng(cells)
    chain = sw.Chain(concave_chain(rng, cells).cells, actuator_stiffness=0.0)
    whole, part = graph(chain), graph(chain, start="0" * cells)
    assert set(part) == whole.reachable() and not part.is_whole
    for label in part:
        one, other = part.node(label), whole.node(label)
        assert replace(one, branch=0) == replace(other, branch=0)
        assert part.transition(label, +1) == whole.transition(label, +1)
        assert part.transition(label, -1) == whole.transition(label, -1)


def test_of_more_cells_than_can_be_listed_what_is_reached_from_one_state_is():
    chain = stacked(24)
    t_graph = graph(chain, "force", start="0" * 24)
    assert len(t_graph) == chain.implicit_graph("force").reached_count == 25
    with pytest.raises(ValueError, match=r"24 cells.*at most 20"):
        graph(chain, "force")


def test_what_has_no_graph_is_refused_with_advice():
    chain = straight(10, 20)
    rubbing = sw.Chain([sw.Cell(sw.Band((0, 0), (0.010, 0)), friction=0.1)])
    with pytest.raises(ValueError, match=r"friction 0\.1 N.*program"):
        graph(rubbing)
    with pytest.raises(ValueError, match=r"drive = 'strok'.*'stroke', 'force'"):
        graph(chain, "strok")
    with pytest.raises(ValueError, match=r"start = '2'.*2 characters"):
        graph(chain, start="2")
    pushes = sw.Cell(sw.Band((0, 0), (0.010, -0.015)))
    pulls = sw.Cell(sw.Band((0, 0), (0.020, 0.015)))
    with pytest.raises(ValueError, match="no equilibrium"):
        graph(sw.Chain([pushes, pulls, sw.Cell(sw.Band((0, 0), (0.010, 0.015)))]), start="001")
    with pytest.raises(ValueError, match=r"11 cells.*at most 10.*start="):
        graph(straight(*range(10, 21)))
    with pytest.raises(ValueError, match=r"21 cells.*at most 20.*start="):
        graph(straight(*range(10, 31)), "force")


def test_progress_is_reported():
    calls: list[tuple[int, int]] = []
    graph(straight(10, 20), progress=lambda done, total: calls.append((done, total)))
    # Starts, then branches: those followed, of those known so far.
    assert calls[:4] == [(0, 4), (1, 4), (2, 4), (3, 4)]
    assert calls[-1] == (2, 2)
    assert calls[4:] == sorted(calls[4:])
    assert all(0 <= done <= total == 2 for done, total in calls[4:])


def test_slack_cells_that_share_a_motion_leave_ties_and_still_a_graph():
    # Statics does not decide where two slack cells stand, so the way back may differ.
    slack = sw.Cell(sw.Band((0, 0), (0.001, 0.0), rest_length=0.017))
    looser = sw.Cell(sw.Band((0, 0), (0.0012, 0.0), rest_length=0.0172))
    t_graph = graph(sw.Chain([slack, looser, straight(20).cells[0]]))
    assert t_graph.ties
    assert t_graph.reading.main_loop.up[0].startswith("000")
    assert "ties" in str(t_graph.reading)
    assert math.isclose(t_graph.node(t_graph.reading.main_loop.up[-1]).high, 0.06, rel_tol=1e-9)


def test_a_fold_that_rounding_finds_twice_is_left_by_one_snap():
    # The engine's path has a snap of some nanometres there, and one at the same drive after it.
    chain = any_chain(np.random.default_rng(1366), 3, friction=False)
    t_graph = graph(chain)
    for _, _, transition in t_graph.transitions():
        if transition.kind is TransitionKind.SNAP:
            assert transition.released > 1e-12


def test_slack_cells_come_back_to_other_places_of_their_branch():
    chain = any_chain(np.random.default_rng(3673), 3, friction=False)
    t_graph = graph(chain)
    assert t_graph.ties
    assert len(t_graph.reachable()) == len(t_graph)
