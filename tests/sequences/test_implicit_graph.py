"""The graph that is not listed: state by state and in its counts it is the listed one."""

import math
from dataclasses import replace
from itertools import islice

import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st

import stepwell as sw
from chains import any_chain, concave_cell, concave_chain
from facts import refuses, says
from sizes import SIZE, examples
from stepwell.concave import relays
from stepwell.sequences import ImplicitGraph, TransitionGraph
from stepwell.sequences.implicit import shown_count
from stepwell.statics import StaticsError

SEEDS = st.integers(0, 2**32 - 1)


def bumps(rng: np.random.Generator, count: int) -> sw.Element:
    """An element whose force rises and falls so many times, in twentieths of a newton."""
    travels, forces = [0.0], [0.0]
    for _ in range(count):
        up = forces[-1] + rng.integers(6, 30) / 20
        forces += [up, up - rng.integers(6, 40) / 20]
    forces.append(forces[-1] + 2.0)
    travels = np.cumsum(rng.uniform(0.5e-3, 2e-3, len(forces)))
    return sw.Element.from_points(travels - travels[0], forces)


def any_relays(rng: np.random.Generator, cells: int) -> sw.Chain:
    """Cells and elements of up to four phases, under a force."""
    own = [
        concave_cell(rng) if rng.random() < 0.5 else bumps(rng, int(rng.integers(1, 4)))
        for _ in range(cells)
    ]
    return sw.Chain(own, actuator_stiffness=0.0)


def forced(seed: int, cells: int, kind=any_relays) -> sw.Chain:
    return replace(kind(np.random.default_rng(seed), cells), actuator_stiffness=0.0)


def assert_the_same(implicit: ImplicitGraph, listed: TransitionGraph):
    """Every node and every way of a listed graph of vertices, and every number of them."""
    for label in listed:
        ours, node = implicit.node(label), listed.node(label)
        assert replace(ours, branch=node.branch) == node
        for direction, way in ((+1, implicit.up(label)), (-1, implicit.down(label))):
            other = listed.transition(label, direction)
            assert (way is None) == (other is None)
            if way is None or other is None:
                continue
            assert way[0] == other[0]
            assert (way[1].kind, way[1].cells) == (other[1].kind, other[1].cells)
            assert way[1].drive == other[1].drive
            assert way[1].released == pytest.approx(other[1].released, rel=1e-9, abs=1e-12)
    assert implicit.vertex_count == len(listed.vertices) == len(listed)
    assert implicit.transition_count == listed.transition_count
    assert implicit.garden_count == len(listed.reading.garden_of_eden or ())
    if implicit.reached_count is None:
        assert implicit.sub_loop_count is None
    else:
        assert implicit.reached_count == len(listed.reachable())
        assert implicit.sub_loop_count == listed.reading.sub_loop_count
    walked = [node.label for node in implicit.walk()]
    assert len(walked) == len(set(walked))
    assert set(walked) == listed.reachable()


@pytest.mark.slow
@settings(max_examples=examples(6, full=500))
@given(SEEDS, st.integers(1, 7))
def test_under_a_force_it_is_the_listed_graph(seed, cells):
    chain = forced(seed, cells)
    assume(relays(chain) is not None)
    assume(math.prod(map(len, chain.phases)) <= 1 << 10)
    implicit, listed = chain.implicit_graph(), chain.graph()
    assert implicit.by_fields
    assert_the_same(implicit, listed)
    assert implicit.listed() == listed
    assert (implicit.names, implicit.cells, implicit.unit, implicit.actuator, implicit.zero) == (
        listed.names,
        listed.cells,
        listed.unit,
        listed.actuator,
        listed.zero,
    )


@pytest.mark.slow
@pytest.mark.parametrize("cells", [9, 10] if SIZE == "full" else [10])
def test_of_ten_cells_too(cells):
    for seed in range(examples(1, full=40)):
        chain = forced(seed, cells, concave_chain)
        assert_the_same(chain.implicit_graph(), chain.graph())


def test_so_it_is_where_one_field_is_another_but_for_rounding():
    chain = forced(1_000_003, 4)
    ups, downs = np.array([pair for one in chain.elements for pair in one.fields]).T
    assert np.min(np.abs(ups[:, None] - downs)) < 1e-15
    assert_the_same(chain.implicit_graph(), chain.graph())


def test_where_all_states_stand_branches_have_the_numbers_of_the_listed_graph():
    chain = sw.Chain([band(d) for d in (0.010, 0.014, 0.020)], actuator_stiffness=0.0)
    implicit, listed = chain.implicit_graph(), chain.graph()
    assert [implicit.node(label) for label in listed] == [listed.node(label) for label in listed]


def test_a_phase_that_is_passed_by_leaves_only_what_is_reached_uncounted():
    hump = sw.Element.from_points(
        [0, 0.001, 0.002, 0.003, 0.0042, 0.006], [0, 1.4, -1.0, 0.7, -0.2, 1.5]
    )
    late = sw.Element.from_points([0, 0.0012, 0.0025, 0.004], [0, 1.3, -0.3, 1.4])
    chain = sw.Chain([hump, late], actuator_stiffness=0.0)
    implicit = chain.implicit_graph()
    assert implicit.reached_count is implicit.sub_loop_count is None
    assert_the_same(implicit, chain.graph())


def assert_the_same_but_for_ties(implicit: ImplicitGraph, listed: TransitionGraph):
    """The same where the engine takes cells that tie one after the other, or together."""
    led_to = set()
    for label in listed:
        ours, node = implicit.node(label), listed.node(label)
        assert (ours.low, ours.high) == pytest.approx((node.low, node.high), abs=1e-9)
        for direction in (+1, -1):
            way, (target, drive, cells, heat) = (
                implicit.transition(label, direction),
                settled(listed, label, direction),
            )
            if way is None:
                assert target == label
                continue
            assert (way[0], set(way[1].cells)) == (target, cells)
            assert (way[1].drive, way[1].released) == pytest.approx((drive, heat), abs=1e-9)
            led_to.add(target)
    assert implicit.vertex_count == len(listed)
    assert implicit.garden_count == len(set(listed) - led_to)
    walked = {node.label for node in implicit.walk()}
    assert implicit.reached_count == len(walked)
    assert walked <= listed.reachable()


def settled(listed: TransitionGraph, label: str, direction: int):
    """Where all transitions at one drive lead, and the cells and the heat of them together."""
    first, cells, heat = None, set(), 0.0
    while (way := listed.transition(label, direction)) is not None:
        first = way[1].drive if first is None else first
        if abs(way[1].drive - first) > 1e-9:
            break
        label, cells, heat = way[0], cells | {*way[1].cells}, heat + way[1].released
    return label, first, cells, heat


def band(reach: float) -> sw.Cell:
    """The paper's band, anchored so far apart [m]."""
    return sw.Cell(sw.Band((0.0, 0.0), (reach, 0.0)))


@pytest.mark.slow
@pytest.mark.parametrize("order", [(0, 0), (0, 1, 0), (0, 0, 0), (1, 0, 2, 0), (0, 1, 1, 0)])
def test_cells_whose_fields_tie_leave_together(order):
    kinds = band(0.020), band(0.015), band(0.010)
    chain = sw.Chain([kinds[k] for k in order], actuator_stiffness=0.0)
    assert relays(chain) is None
    implicit, listed = chain.implicit_graph(), chain.graph()
    assert "engine" in listed.method
    assert implicit.by_fields
    assert_the_same_but_for_ties(implicit, listed)


@pytest.mark.slow
@settings(max_examples=examples(10))
@given(SEEDS, st.integers(2, 4))
def test_elements_whose_fields_tie_in_one_way_of_the_force_only_do_likewise(seed, cells):
    rng = np.random.default_rng(seed)
    # Few values, so that many are equal.
    curves = [(rng.integers(1, 3) / 2, -rng.integers(1, 4) / 4) for _ in range(cells)]
    own = [
        sw.Element.from_points([0, 0.001, 0.003, 0.006], [0, up, down, 2.0]) for up, down in curves
    ]
    chain = sw.Chain(own, actuator_stiffness=0.0)
    assume(relays(chain) is None)
    assert_the_same_but_for_ties(chain.implicit_graph(), chain.graph())


@pytest.mark.slow
@settings(max_examples=examples(8, full=300))
@given(SEEDS, st.integers(1, 4), st.sampled_from(["stroke", 60.0, 900.0, "force"]))
def test_along_branches_it_is_the_listed_graph(seed, cells, drive):
    chain = any_chain(np.random.default_rng(seed), cells, friction=False)
    try:
        listed = chain.graph(drive)
    except StaticsError:
        assume(False)
        raise
    assume(not listed.ties)
    implicit = chain.implicit_graph(drive)
    assert implicit.vertex_count == len({listed.node(v).state for v in listed.vertices})
    if implicit.by_fields:
        return

    def alike(one, other) -> bool:
        """Nodes but for their labels and the number of their branch."""
        ends = np.array([[node.low, node.high] for node in (one, other)])
        slip = 1e-6 * max(1e-3, *(abs(listed.node(v).high) for v in listed))
        return one.state == other.state and bool(np.all(np.abs(np.diff(ends, axis=0)) <= slip))

    for start in listed.vertices:
        if "#" in start:
            continue
        walked = {node.label: node for node in implicit.walk(start)}
        expected = [listed.node(label) for label in listed.reachable(start)]
        assert len(walked) == len(expected)
        for label, node in walked.items():
            assert any(alike(node, other) for other in expected)
            assert implicit.node(label) == node
            for direction in (+1, -1):
                way = implicit.transition(label, direction)
                others = [
                    listed.transition(other.label, direction)
                    for other in expected
                    if alike(node, other)
                ]
                assert any(
                    other[0].partition("#")[0] == way[0].partition("#")[0]
                    and (other[1].kind, other[1].cells) == (way[1].kind, way[1].cells)
                    if way and other
                    else way is None and other is None
                    for other in others
                )


@pytest.mark.slow
@settings(max_examples=examples(15))
@given(SEEDS, st.integers(2, 5))
def test_under_a_stroke_what_is_reached_is_counted_where_it_is_proved(seed, cells):
    chain = concave_chain(np.random.default_rng(seed), cells)
    implicit = chain.implicit_graph()
    counted = implicit.reached_count
    listed = chain.graph()
    assert implicit.vertex_count == len({listed.node(v).state for v in listed.vertices})
    reached = {v.partition("#")[0] for v in listed.reachable() if "-" not in v}
    assert counted is None or counted == len(reached)


def test_of_nested_loops_under_a_stroke_all_states_are_reached_of_any_number_of_cells():
    chain = sw.Chain([band(0.010 + 0.0005 * k) for k in range(24)])
    implicit = chain.implicit_graph()
    assert implicit.vertex_count == implicit.reached_count == 2**24
    assert implicit.garden_count is implicit.sub_loop_count is implicit.transition_count is None
    first, second = islice(implicit.walk(), 2)
    assert (first.label, second.label) == ("0" * 24, "-" + 23 * "0")


@pytest.mark.slow
@pytest.mark.parametrize("cells", [24, 100, 1000])
def test_any_number_of_cells_answers_under_a_force(cells):
    chain = forced(cells, cells, concave_chain)
    implicit = chain.implicit_graph()
    counts = (implicit.reached_count, implicit.garden_count, implicit.vertex_count)
    assert all(count is not None and count > 0 for count in counts)
    assert implicit.vertex_count <= 2**cells
    nodes = list(implicit.walk(most=50))
    assert len(nodes) == len({node.label for node in nodes}) == 50
    assert nodes[0].label == implicit.zero
    # Up from all at 0 cells go in the order of their F0.
    order = np.argsort([cell.force_0 for cell in chain.levers])
    label = implicit.zero
    for cell in order[:5].tolist():
        way = implicit.up(label)
        assert way is not None and way[1].cells == (cell,)
        assert way[1].drive == pytest.approx(chain.levers[cell].force_0)
        label = way[0]


@pytest.mark.slow
def test_of_twenty_four_cells_every_state_that_stands_is_counted_once():
    # All 2^24 of them, by the window of each and nothing else.
    chain = forced(3, 24, concave_chain)
    force_0 = np.array([cell.force_0 for cell in chain.levers])
    force_1 = np.array([cell.force_1 for cell in chain.levers])
    low, high = np.array([-np.inf]), np.array([np.inf])
    for up, down in zip(force_0, force_1, strict=True):
        low = np.concatenate([low, np.maximum(low, down)])
        high = np.concatenate([np.minimum(high, up), high])
    assert chain.implicit_graph().vertex_count == np.count_nonzero(low <= high)


def test_a_walk_ends_at_its_limit_and_takes_near_states_first():
    chain = forced(1, 6, concave_chain)
    implicit = chain.implicit_graph()
    whole = [node.label for node in implicit.walk()]
    assert [node.label for node in implicit.walk(most=5)] == whole[:5]
    steps = {whole[0]: 0}
    for label in whole:
        for way in (implicit.up(label), implicit.down(label)):
            if way is not None:
                steps.setdefault(way[0], steps[label] + 1)
    distances = [steps[label] for label in whole]
    assert distances == sorted(distances)
    assert list(implicit.walk(most=0)) == []
    assert next(implicit.walk("1" * 6)).label == "1" * 6


@pytest.mark.slow
def test_two_strokes_go_round_the_main_loop():
    for chain in (forced(4, 6), concave_chain(np.random.default_rng(4), 4)):
        implicit, loop = chain.implicit_graph(), chain.graph().reading.main_loop
        up = [label for label, _ in implicit.stroke(implicit.zero, +1)]
        down = [label for label, _ in implicit.stroke(up[-1], -1)]
        bare = [[label.partition("#")[0] for label in way] for way in (loop.up, loop.down)]
        assert [implicit.zero, *(label.partition("#")[0] for label in up)] == bare[0]
        assert [bare[0][-1], *(label.partition("#")[0] for label in down)] == bare[1]


def test_what_it_says_names_what_it_cannot_count():
    chain = sw.Chain([band(0.010 + 0.0005 * k) for k in range(24)])
    assert str(chain.implicit_graph("force")).splitlines() == [
        "24 cells driven by force: 16777216 vertices, not listed",
        "main loop, up        cell 1, cell 2, cell 3, cell 4, cell 5, cell 6, ...",
        "main loop, down      cell 1, cell 2, cell 3, cell 4, cell 5, cell 6, ...",
        "transitions          33554430",
        "from all at 0        16777216",
        "sub-loops            16777214",
        "Garden of Eden       0",
        "return-point memory  holds",
        "avalanches           none",
    ]
    assert str(chain.implicit_graph("stroke")).splitlines() == [
        "24 cells driven by stroke: 16777216 vertices, not listed",
        "from all at 0        16777216",
        "not counted          transitions, sub-loops, Garden of Eden: needs every branch to be "
        "followed",
    ]


def test_it_follows_no_branch_that_is_not_asked_for(monkeypatch):
    runs = []
    kept = sw.statics.path
    monkeypatch.setattr(
        sw.statics, "path", lambda *args, **more: runs.append(1) or kept(*args, **more)
    )
    implicit = concave_chain(np.random.default_rng(2), 8).implicit_graph()
    assert implicit.vertex_count > 0
    assert not runs
    implicit.node("0" * 8)
    assert len(runs) == 2
    implicit.up("0" * 8)
    assert len(runs) == 2


def test_ties_are_reported_as_far_as_branches_were_followed():
    alike = sw.Chain([band(0.02), band(0.02)])
    implicit = alike.implicit_graph()
    assert implicit.ties == ()
    implicit.up("00")
    assert implicit.ties
    forced = alike.implicit_graph("force")
    assert len(list(forced.walk())) == 2
    assert forced.ties == ()


def test_it_is_what_its_chain_is():
    one, other = (sw.Chain([band(0.02), band(0.01)]).implicit_graph("force") for _ in range(2))
    assert list(one.walk())
    assert one == other
    assert hash(one) == hash(other)
    says(repr(one), "ImplicitGraph(", "2 cells", "force")


@pytest.mark.parametrize(
    ("label", "message"),
    [
        ("0", r"must be 2 characters 0 or 1"),
        ("02", r"must be 2 characters 0 or 1"),
        ("-1", r"must be 2 characters|is not visited yet: begin with a state .* such as '00'"),
    ],
)
@pytest.mark.parametrize("drive", ["force", "stroke"])
def test_a_state_that_cannot_be_is_refused(label, message, drive):
    implicit = sw.Chain([band(0.02), band(0.01)]).implicit_graph(drive)
    for ask in (implicit.node, implicit.up, implicit.down, lambda one: next(implicit.walk(one))):
        with pytest.raises(sw.InputError, match=message):
            ask(label)


@pytest.mark.parametrize("drive", ["force", "stroke"])
def test_a_state_that_cannot_stand_is_refused(drive):
    cells = [sw.Cell(sw.Band((0.0, 0.0), d)) for d in ((0.0, 0.015), (0.0, -0.015))]
    implicit = sw.Chain(cells).implicit_graph(drive)
    assert implicit.vertex_count == 3
    with refuses(sw.InputError, "10", "no equilibrium", "1", "0"):
        implicit.node("10")


def test_friction_has_no_graph_of_either_kind():
    rubs = replace(band(0.02), friction=0.02)
    with pytest.raises(sw.InputError, match=r"has friction 0\.02 N"):
        sw.Chain([rubs]).implicit_graph()


def test_what_cannot_be_listed_says_who_still_answers():
    chain = forced(0, 24, concave_chain)
    assert not chain.implicit_graph().is_listable
    with refuses(
        sw.InputError, "24 cells", "chain.implicit_graph()", "start=", "chain.program(target=...)"
    ):
        chain.implicit_graph().listed()
    with pytest.raises(sw.InputError, match=r"24 cells .* at most 10"):
        chain.graph("stroke")


@pytest.mark.parametrize(
    ("count", "text"),
    [
        (0, "0"),
        (1, "1"),
        (16777216, "16777216"),
        (10**15 - 1, "999999999999999"),
        (10**15, "1.000e15"),
        (2**100, "1.268e30"),
        (10**400 - 1, "1.000e400"),
        (2**1000, "1.072e301"),
    ],
)
def test_numbers_of_states_can_be_read(count, text):
    assert shown_count(count) == text


def test_even_a_number_that_python_does_not_write_can_be_read():
    assert shown_count(3**10_000) == "1.631e4771"
