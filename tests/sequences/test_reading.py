"""A reading names what is there: loops, memory, scrambling, counting, latches."""

import itertools
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
from stepwell.sequences import counting as counting_module, reading as reading_module
from stepwell.sequences.cycles import sequence_of
from stepwell.sequences.fields import from_switching_fields
from stepwell.sequences.mesostates import Routes, atlas
from stepwell.sequences.reading import read_memory
from stepwell.sequences.transition_graph import TransitionGraph, graph
from stepwell.statics import StaticsError

SEEDS = st.integers(0, 2**32 - 1)
LEVERS = st.floats(0.012, 0.022)
DRIVES = st.one_of(st.sampled_from(["stroke", "force"]), st.floats(5, 3000))


def straight(*d_x: float) -> sw.Chain:
    """Cells of the paper's band, anchored d_x [mm] apart."""
    return sw.Chain([sw.Cell(sw.Band((0.0, 0.0), (x / 1e3, 0.0))) for x in d_x])


NESTED = straight(10, 20, 30)
# The first cycle hands what is left in transit from one cell to another, and so does the second.
COUNTER = straight(10, 11, 16, 30)


def drawn(seed: int, cells: int, drive, concave: bool = True) -> TransitionGraph:
    """The graph of a random chain; the draw is dropped where the engine cannot tell."""
    rng = np.random.default_rng(seed)
    chain = concave_chain(rng, cells) if concave else any_chain(rng, cells, friction=False)
    try:
        t_graph = graph(chain, drive, start="0" * cells)
    except StaticsError:
        assume(False)
        raise
    assume(not t_graph.ties)
    return t_graph


def stands(t_graph: TransitionGraph, drives) -> np.ndarray:
    assert t_graph.chain is not None
    return np.asarray(t_graph.chain.path(drives).end)


def state_of(t_graph: TransitionGraph, travels) -> str:
    assert t_graph.chain is not None
    full = [cell.full_travel for cell in t_graph.chain.cells]
    return "".join(
        "0" if s == 0 else "1" if s == f else "-" for s, f in zip(travels, full, strict=True)
    )


def hysterons(rule, n: int) -> TransitionGraph:
    """The graph of switching fields given as rule(state, cell)."""
    rows = [
        [rule(state, cell) for cell in range(n)] for state in itertools.product((0, 1), repeat=n)
    ]
    return from_switching_fields(np.array(rows, float))


# --- loops ----------------------------------------------------------------------------------


def test_the_main_loop_is_what_full_strokes_visit():
    assert str(graph(NESTED).reading.main_loop) == str(NESTED.cycle().sequence)
    loop = graph(NESTED, "force").reading.main_loop
    assert loop.up == ("000", "100", "110", "111") and loop.down == ("111", "011", "001", "000")
    assert loop.vertices == ("000", "100", "110", "111", "011", "001")


def test_loops_of_three_nested_relays_written_out_by_hand():
    # A rises 0, 1, 2; B falls: every pair of loops is nested, so all eight states are reached.
    reading = hysterons(lambda state, i: -1 - i if state[i] else 1 + i, 3).reading
    assert reading.sub_loops is not None
    assert {str(loop) for loop in reading.sub_loops} == {
        "000>100>000",
        "000>100>110>010>000",
        "001>101>001",
        "001>101>111>011>001",
        "010>110>010",
        "011>111>011",
    }
    assert reading.sub_loop_count == 6
    widest = max(reading.sub_loops, key=lambda loop: loop.high - loop.low)
    assert (widest.low, widest.high) == (-2, 2)
    assert repr(widest) == "Loop(000>100>110>010>000, drive -2 to 2)"


@pytest.mark.slow
@settings(max_examples=examples(10, full=400))
@given(SEEDS, st.integers(2, 5), DRIVES)
def test_going_to_and_fro_between_its_drives_goes_round_a_loop(seed, cells, drive):
    t_graph = drawn(seed, cells, drive)
    assert t_graph.chain is not None
    branches = atlas(t_graph)
    routes = Routes(branches.mesostates, branches.bottom)
    for loop in (t_graph.reading.sub_loops or ())[:5]:
        begin = routes.turns(int(branches.branch_of[t_graph.nodes.find(loop.up[0])]), loop.low)
        gap = 1e-6 * (loop.high - loop.low)
        round_it = [loop.high + gap, loop.low - gap]
        once = stands(t_graph, [*begin, *round_it])
        again = t_graph.chain.path([loop.low - gap, *round_it], start=once.tolist())
        np.testing.assert_allclose(again.end, once, atol=1e-9)
        passed = {state for state in sequence_of(again).states if "-" not in state}
        assert passed == {t_graph.node(label).state for label in loop.vertices}


@pytest.mark.slow
@settings(max_examples=examples(10, full=400))
@given(SEEDS, st.integers(1, 6))
def test_all_that_relays_reach_lies_on_the_main_loop_and_its_sub_loops(seed, n):
    # Terzi and Mungan 2020.
    rng = np.random.default_rng(seed)
    up, down = rng.uniform(0, 1, n), rng.uniform(-1, 0, n)
    t_graph = hysterons(lambda state, i: down[i] if state[i] else up[i], n)
    loops = [t_graph.reading.main_loop, *(t_graph.reading.sub_loops or ())]
    assert {v for loop in loops for v in loop.vertices} == set(t_graph.reachable())


def test_more_loops_than_anyone_reads_are_counted_only(monkeypatch):
    monkeypatch.setattr(reading_module, "MOST_LOOPS", 5)
    reading = read_memory(graph(NESTED, "force"))
    assert reading.sub_loops is None and reading.sub_loop_count == 6
    assert "sub-loops            6\n" in str(reading)


# --- memory ---------------------------------------------------------------------------------


def test_three_nested_cells_forget_a_turning_point():
    t_graph = graph(NESTED)
    memory = t_graph.reading.return_point_memory
    assert not memory.holds and memory.witness is not None
    witness = memory.witness
    assert (witness.first, witness.later) == ("-11", "1-1")
    first, later = stands(t_graph, witness.turns[:-2]), stands(t_graph, witness.turns)
    assert state_of(t_graph, first) == "-11" and state_of(t_graph, later) == "1-1"
    assert witness.before <= witness.excursion < witness.at
    assert witness.before == 0
    # The example of the theory page lies in the same windows.
    for drives, travels in (
        ((0, 0.0542), (14.2, 20, 20)),
        ((0, 0.0542, 0.020, 0.0542), (20, 14.2, 20)),
    ):
        np.testing.assert_allclose(stands(t_graph, drives) * 1e3, travels, atol=0.01)


@pytest.mark.slow
def test_a_soft_actuator_remembers_what_a_stiff_one_forgets():
    # The stiffness at which that changes, by bisection between two that are looked at below.
    low, high = 53.0, 53.1
    while high - low > 1e-5:
        middle = (low + high) / 2
        if graph(NESTED, middle, start="000").reading.return_point_memory.holds:
            low = middle
        else:
            high = middle
    assert (low + high) / 2 == pytest.approx(53.03939, abs=2e-5)
    for stiffness in (0.5, 5, 20, 45, 53):
        assert graph(NESTED, stiffness, start="000").reading.return_point_memory.holds
    for stiffness in (53.1, 100, 1e3, 1e6):
        assert not graph(NESTED, stiffness, start="000").reading.return_point_memory.holds


@pytest.mark.slow
@settings(max_examples=examples(12, full=600))
@given(SEEDS, st.tuples(LEVERS, LEVERS))
def test_two_concave_cells_remember_under_a_prescribed_stroke_whatever_their_travels(seed, levers):
    # Proved on the theory page: they are one relay at most.
    rng = np.random.default_rng(seed)
    chain = sw.Chain(
        [
            replace(cell, lever=lever)
            for cell, lever in zip(concave_chain(rng, 2).cells, levers, strict=True)
        ]
    )
    assume(relays(chain) is not None)
    t_graph = graph(chain, start="00")
    assert t_graph.reading.return_point_memory.holds
    assert t_graph.reading.branches <= 2


@pytest.mark.slow
def test_two_concave_cells_behind_a_spring_can_forget():
    # The chain of the theory page, found by a search; and one of equal travels.
    apart = sw.Chain(
        [
            sw.Cell(sw.Band((0, 0), (0.0308, -0.0034), 9.8, 0.009), lever=0.024),
            sw.Cell(sw.Band((0, 0), (0.0212, 0.0105), 8.0, 0.006), lever=0.022),
        ],
        actuator_stiffness=4.0,
    )
    alike = sw.Chain(
        [
            sw.Cell(sw.Band((0, 0), (0.0109, 0.0032), 27.9, 0.008), lever=0.008),
            sw.Cell(sw.Band((0, 0), (0.0370, 0.0080), 5.5, 0.012), lever=0.008),
        ],
        actuator_stiffness=39.0,
    )
    for chain, first, later in ((apart, "11", "10"), (alike, "11", "1-")):
        assert relays(chain) is not None
        witness = graph(chain).reading.return_point_memory.witness
        assert witness is not None
        assert (witness.first, witness.later) == (first, later)
        # The independent follower forgets there too.
        cells = [
            OracleCell(c.lever, c.limit, [(*b.d, b.stiffness, b.rest_length, 0.0, 0.0, False)])
            for c in chain.levers
            for b in c.bands
        ]
        stiffness = chain.actuator_stiffness
        for turns in (witness.turns[:-2], witness.turns):
            run = follow(cells, turns, control=stiffness, steps=400)
            np.testing.assert_allclose(run.travel[-1], chain.path(turns).end, atol=2e-5)


@pytest.mark.slow
@settings(max_examples=examples(10, full=400))
@given(SEEDS, st.integers(1, 5), st.booleans())
def test_cells_under_a_force_remember_whatever_they_are(seed, cells, concave):
    # Each is alone with the force.
    assert drawn(seed, cells, "force", concave).reading.return_point_memory.holds


@pytest.mark.slow
@settings(max_examples=examples(12, full=1200))
@given(SEEDS, st.integers(3, 5), DRIVES, st.booleans())
def test_a_witness_of_forgetting_is_what_the_engine_does(seed, cells, drive, concave):
    t_graph = drawn(seed, cells, drive, concave)
    witness = t_graph.reading.return_point_memory.witness
    if witness is None:
        return
    first, later = stands(t_graph, witness.turns[:-2]), stands(t_graph, witness.turns)
    assert state_of(t_graph, first) == t_graph.node(witness.first).state
    assert state_of(t_graph, later) == t_graph.node(witness.later).state
    assert float(np.max(np.abs(first - later))) > 1e-7
    ends = sorted((witness.before, witness.at))
    assert ends[0] <= witness.excursion <= ends[1]


@pytest.mark.slow
@settings(max_examples=examples(12, full=1200))
@given(SEEDS, st.integers(2, 4), DRIVES, st.booleans())
def test_what_is_said_to_remember_does_so_for_random_turning_points(seed, cells, drive, concave):
    t_graph = drawn(seed, cells, drive, concave)
    assume(t_graph.reading.return_point_memory.holds)
    loop = t_graph.reading.main_loop
    rng = np.random.default_rng(seed)
    for _ in range(10):
        points = [loop.low, *rng.uniform(loop.low, loop.high, rng.integers(1, 4))]
        before, at = points[-1], rng.uniform(loop.low, loop.high)
        excursion = rng.uniform(min(before, at), max(before, at))
        first, later = stands(t_graph, [*points, at]), stands(t_graph, [*points, at, excursion, at])
        np.testing.assert_allclose(later, first, atol=1e-9)


@pytest.mark.slow
def test_hysterons_that_drag_each_other_forget():
    # Found at random: the fields of each depend on the others at both signs.
    rng = np.random.default_rng(2)
    forgets = 0
    for _ in range(60):
        up, down, pull = rng.uniform(0, 1, 3), rng.uniform(-1, 0, 3), rng.normal(0, 0.3, (3, 3))
        np.fill_diagonal(pull, 0)
        try:
            t_graph = hysterons(lambda s, i: (down if s[i] else up)[i] - pull[i] @ s, 3)  # noqa: B023
        except ValueError:
            continue
        witness = t_graph.reading.return_point_memory.witness
        if witness is not None:
            forgets += 1
            assert walk(t_graph, witness.turns[:-2]) == witness.first
            assert walk(t_graph, witness.turns) == witness.later
    assert forgets > 5


def walk(t_graph: TransitionGraph, drives) -> str:
    """Where the drive leads by the graph itself, from all cells at 0."""
    label = "0" * t_graph.cells
    for drive in drives:
        while not t_graph.node(label).low <= drive <= t_graph.node(label).high:
            way = t_graph.transition(label, +1 if drive > t_graph.node(label).high else -1)
            assert way is not None
            label = way[0]
    return label


# --- counting -------------------------------------------------------------------------------


def test_a_chain_of_four_cells_counts_to_two():
    t_graph = graph(COUNTER, start="0000")
    counted = t_graph.reading.counting
    assert counted.exhaustive
    best = counted.accumulators[0]
    assert best.transient == 2 and best.period == 1
    assert len(best.states) == 4 and best.states[2] == best.states[3]
    for cycles, label in enumerate(best.states):
        travels = stands(t_graph, best.drives(cycles)) if len(best.drives(cycles)) > 1 else None
        if travels is not None:
            assert state_of(t_graph, travels) == t_graph.node(label).state
    assert repr(best).startswith(f"Accumulator({'>'.join(best.states)}, drive ")
    assert "in cycles of " in str(t_graph.reading)


@pytest.mark.slow
def test_the_countdown_of_the_gallery_is_found_to_count_from_three_when_set_by_hand():
    t_graph = graph(sw.preset("countdown"))
    counts = [a for a in t_graph.reading.counting.accumulators if a.transient == 3]
    assert all(a.by_hand and a.period == 1 for a in counts)
    states = {tuple(t_graph.node(label).state for label in a.states) for a in counts}
    assert any("01001" in names[0] or names[0].count("1") <= 2 for names in states)
    # The program of the preset lies within the extremes of one of them.
    assert any(a.low - a.slack <= 0.040 <= a.low + a.slack for a in counts)
    assert "(set by hand)" in str(t_graph.reading)
    assert graph(sw.preset("countdown"), start="00000").reading.counting.accumulators == ()


def test_the_extremes_of_a_count_may_be_off_by_its_slack():
    t_graph = graph(COUNTER, start="0000")
    best = max(t_graph.reading.counting.accumulators, key=lambda a: a.slack)
    assert best.slack > 1e-5
    low, high = (best.low, best.high) if best.direction > 0 else (best.high, best.low)
    for a, b in itertools.product((-0.99, 0.99), repeat=2):
        drives = [*best.turns[:-1], low + a * best.slack]
        for cycles, label in enumerate(best.states):
            pair = [high + b * best.slack, low + a * best.slack]
            travels = stands(t_graph, drives + pair * cycles)
            assert state_of(t_graph, travels) == t_graph.node(label).state, cycles


@pytest.mark.slow
@settings(max_examples=examples(7, full=600))
@given(SEEDS, st.integers(2, 4), DRIVES)
def test_where_no_accumulator_is_found_random_cycles_settle_after_one(seed, cells, drive):
    t_graph = drawn(seed, cells, drive)
    counted = t_graph.reading.counting
    assume(counted.exhaustive and not counted.accumulators)
    loop, rng = t_graph.reading.main_loop, np.random.default_rng(seed)
    for _ in range(5):
        begin = [loop.low, *rng.uniform(loop.low, loop.high, 2)]
        cycle = list(rng.uniform(loop.low, loop.high, 2))
        once = stands(t_graph, [*begin, cycle[0], *cycle[::-1]])
        twice = stands(t_graph, [*begin, cycle[0], *cycle[::-1] * 2])
        np.testing.assert_allclose(twice, once, atol=1e-9)


@pytest.mark.slow
def test_hysterons_that_alternate_are_said_to_have_a_period_of_two():
    # Bense and van Hecke 2021 describe such subharmonic answers. Cells 1 and 2 hand a 1 to each
    # other: whichever is up goes down on the way down only if the other ... found at random.
    rng = np.random.default_rng(0)
    periods = set()
    for _ in range(4000):
        fields = rng.uniform(-1, 1, (8, 3))
        bits = np.array(list(itertools.product((0, 1), repeat=3)))
        fields = np.where(bits == 1, fields - 0.6, fields + 0.6)
        try:
            t_graph = from_switching_fields(fields)
        except ValueError:
            continue
        for a in [a for a in t_graph.reading.counting.accumulators if not a.by_hand][:1]:
            periods.add(a.period)
            for cycles, label in enumerate(a.states):
                assert walk(t_graph, a.drives(cycles)) == label
        if len(periods) > 1:
            break
    assert 2 in periods


def test_a_search_that_is_cut_short_says_so(monkeypatch):
    monkeypatch.setattr(counting_module, "_BUDGET", 100.0)
    reading = graph(COUNTER, start="0000").reading
    assert not reading.counting.exhaustive
    assert "searched in part" in str(reading) and "searched in part" in repr(reading.counting)


# --- scrambling, latches, gardens -----------------------------------------------------------


def test_an_order_that_depends_on_a_third_cell_is_scrambled():
    # The first cell, once at 1, lifts the field of the second above that of the third.
    def rule(state, i):
        if state[i]:
            return (-10, -3, -2)[i]
        return (3.0, 2.5 if state[0] else 1.5, 2.0)[i]

    reading = hysterons(rule, 3).reading
    assert [(s.cells, s.direction) for s in reading.scrambling] == [((1, 2), 1)]
    scrambled = reading.scrambling[0]
    assert (scrambled.i_first, scrambled.j_first, scrambled.reachable) == ("000", "100", True)
    says(repr(scrambled), "Scrambling(", "up", "2", "before 3", "000", "100")
    says(str(reading).splitlines(), "cell 2", "up", "before cell 3", "000", "after", "100")


def test_relays_are_never_scrambled():
    assert graph(straight(10, 14, 20, 30), "force").reading.scrambling == ()


@pytest.mark.slow
@settings(max_examples=examples(4, full=300))
@given(SEEDS, st.integers(3, 5))
def test_what_is_scrambled_flips_in_either_order_by_the_engine(seed, cells):
    rng = np.random.default_rng(seed)
    chain = concave_chain(rng, cells)
    t_graph = graph(chain)
    for scrambled in t_graph.reading.scrambling[:3]:
        i, j = scrambled.cells
        for label, first, other in ((scrambled.i_first, i, j), (scrambled.j_first, j, i)):
            at = t_graph.node(label).low
            end = t_graph.reading.main_loop.high if scrambled.direction > 0 else 0.0
            sequence = _sequence(chain, at, end, label)
            flipped = "1" if scrambled.direction > 0 else "0"
            following = sequence[1]
            assert following[first] == flipped and following[other] != flipped


def _sequence(chain: sw.Chain, at: float, end: float, start: str) -> tuple[str, ...]:
    return sequence_of(chain.path([at, end], start=start)).states


def test_gardens_of_eden_are_unreachable_and_leave_by_latches():
    # d = (10, 0) goes up first, d = (20, 15) comes down last: neither order is nested.
    chain = straight(10, 20)
    other = sw.Cell(sw.Band((0, 0), (0.020, 0.015)))
    reading = graph(sw.Chain([*chain.cells, other]), "force").reading
    assert reading.garden_of_eden is not None
    assert set(reading.garden_of_eden) <= set(reading.unreachable)
    left = {label for latch in reading.latches for label in latch.nodes}
    assert left == set(reading.unreachable)
    for latch in reading.latches:
        for a, b, _ in latch.ways:
            assert a in latch.nodes and b not in latch.nodes
            assert a not in reading.graph.reachable(b)
    assert repr(reading.latches[0]).endswith("for good)")


def test_what_was_not_examined_is_not_reported():
    reading = graph(NESTED, start="000").reading
    assert reading.garden_of_eden is None and "not known" in str(reading)
    assert reading.latches == () and reading.unreachable == ()


@pytest.mark.slow
def test_every_vertex_alone_without_predecessor_is_a_garden_of_eden():
    rng = np.random.default_rng(4)
    chain = concave_chain(rng, 4)
    for drive in ("stroke", 60.0, "force"):
        t_graph = graph(chain, drive)
        expected = {
            v
            for v in t_graph.vertices
            if not any(v in t_graph.reachable(w) for w in t_graph.vertices if w != v)
        }
        assert set(t_graph.reading.garden_of_eden or ()) == expected


def test_a_reading_is_printed_in_millimetres_or_newtons():
    text = str(graph(NESTED).reading)
    assert "0 → 54.23 → 15.77 → 54.23 mm" in text and "main loop            000>100>" in text
    says(text.splitlines()[0], "3 cells", "stroke", "8 vertices", "4 branches")
    says(repr(graph(NESTED).reading), "MemoryReading(", "3 cells", "4 branches", "2 sub-loops")
    says(repr(graph(NESTED).reading), "0 unreachable", "forgets", "0 scrambled", "0 accumulators")
    memory = repr(graph(NESTED).reading.return_point_memory)
    says(memory, "ReturnPointMemory(Forgetting(", "-11", "1-1", "0, 0.05423, 0.01577, 0.05423")
    assert repr(graph(NESTED, "force").reading.return_point_memory) == "ReturnPointMemory(holds)"
    assert repr(graph(NESTED, "force").reading.counting) == "Counting(0 accumulators)"


def test_a_long_list_is_cut_when_printed():
    # A and B both rise: only six of 32 states are reached.
    reading = hysterons(lambda state, i: i - 10 if state[i] else 1 + i, 5).reading
    assert len(reading.unreachable) == 26
    says(str(reading).splitlines(), "not from", "all at 0", "and 20 more")
