"""Every actuator between a prescribed force and a prescribed stroke, down to both of them."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st

import stepwell as sw
from chains import any_chain, concave_chain
from facts import refuses
from sizes import examples
from stepwell.mechanism import SOFTEST, STIFFEST
from stepwell.sequences.transition_graph import TransitionGraph, graph
from stepwell.statics import StaticsError

SEEDS = st.integers(0, 2**32 - 1)
# Of any stiffness, in powers of ten.
SOFT = st.floats(math.log10(SOFTEST), -4)
STIFF = st.floats(8, math.log10(STIFFEST))


def edges(t_graph: TransitionGraph) -> set[tuple[str, str, int]]:
    """From a state to a state, and which way the drive goes."""
    return {
        (t_graph.node(a).state, t_graph.node(b).state, t.direction)
        for a, b, t in t_graph.transitions()
    }


def sets_of_states(t_graph: TransitionGraph) -> tuple[set[str], set[str]]:
    """Vertices there are, and those that can be reached."""
    reached = {label for label in t_graph.reachable() if "-" not in label}
    return set(t_graph.vertices), {t_graph.node(label).state for label in reached}


def untied(chain: sw.Chain, drive: str) -> TransitionGraph:
    """The graph at a limit; the draw is dropped where it hangs on a tie or nothing has a force."""
    try:
        t_graph = graph(chain, drive)
    except StaticsError:
        assume(False)
        raise
    nodes = [t_graph.node(label) for label in t_graph]
    assume(max(abs(force) for n in nodes for force in (n.force_low, n.force_high)) > 1e-6)
    assume(not t_graph.ties)
    return t_graph


@pytest.mark.slow
@settings(max_examples=examples(6, full=300))
@given(SEEDS, st.integers(1, 4), SOFT)
def test_behind_the_softest_springs_concave_cells_are_the_relays_of_a_prescribed_force(
    seed, cells, power
):
    chain = concave_chain(np.random.default_rng(seed), cells)
    stiffness = 10.0**power
    limit, t_graph = untied(chain, "force"), graph(chain, stiffness)
    assert edges(t_graph) == edges(limit)
    for label in limit:
        exact, node = limit.node(label), t_graph.node(label)
        # The spring's last snap leaves it shorter by a travel of each cell at most.
        less = stiffness * chain.full_stroke
        for name in ("force_low", "force_high"):
            if set(label) != {"0"} and set(label) != {"1"}:
                assert getattr(node, name) == pytest.approx(getattr(exact, name), abs=less + 1e-12)
    assert t_graph.chain is not None
    loss = replace(chain, actuator_stiffness=0.0).cycle().dissipated
    # Each cell's snap, one up and one down, lets the spring go by its travel: K S²/2.
    lets_go = stiffness * sum(cell.full_travel**2 for cell in chain.cells)
    assert loss - t_graph.chain.cycle().dissipated == pytest.approx(lets_go, abs=1e-12)
    for way, same in zip(limit.reading.main_loop.up, t_graph.reading.main_loop.up, strict=True):
        assert limit.node(way).state == t_graph.node(same).state
    assert t_graph.reading.return_point_memory.holds


@pytest.mark.slow
@settings(max_examples=examples(6, full=300))
@given(SEEDS, st.integers(1, 4), SOFT)
def test_behind_the_softest_springs_any_cells_do_as_under_a_prescribed_force(seed, cells, power):
    chain = any_chain(np.random.default_rng(seed), cells, friction=False)
    limit, t_graph = untied(chain, "force"), graph(chain, 10.0**power)
    assume(not t_graph.ties)
    assert sets_of_states(t_graph) == sets_of_states(limit)
    assert {t_graph.node(label).state for label in t_graph} == {limit.node(x).state for x in limit}


@pytest.mark.slow
@settings(max_examples=examples(6, full=300))
@given(SEEDS, st.integers(1, 4), STIFF, st.booleans())
def test_behind_the_stiffest_springs_a_chain_does_as_under_a_prescribed_stroke(
    seed, cells, power, concave
):
    rng = np.random.default_rng(seed)
    chain = concave_chain(rng, cells) if concave else any_chain(rng, cells, friction=False)
    limit, t_graph = untied(chain, "stroke"), graph(chain, 10.0**power)
    assume(not t_graph.ties)
    assert sets_of_states(t_graph) == sets_of_states(limit)
    holds = limit.reading.return_point_memory.holds
    assert t_graph.reading.return_point_memory.holds == holds
    assert t_graph.chain is not None
    ours, exact = t_graph.chain.cycle().snaps, chain.cycle().snaps
    assert [snap.cells for snap in ours] == [snap.cells for snap in exact]
    for snap, like in zip(ours, exact, strict=True):
        assert snap.stroke == pytest.approx(like.stroke, abs=1e-7)
        assert snap.released == pytest.approx(like.released, rel=1e-4, abs=1e-9)


@pytest.mark.slow
@settings(max_examples=examples(10, full=400))
@given(SEEDS, st.integers(1, 5), st.floats(math.log10(SOFTEST), math.log10(STIFFEST)))
def test_equilibrium_and_energy_hold_to_rounding_behind_every_spring(seed, cells, power):
    chain = any_chain(np.random.default_rng(seed), cells, friction=False)
    looks = [cell.force(cell.angle(np.linspace(0, cell.full_travel, 99))) for cell in chain.levers]
    assume(np.any(looks))
    try:
        path = replace(chain, actuator_stiffness=10.0**power).cycle().path
    except StaticsError:
        assume(False)
        raise
    scale = float(np.max(np.abs(looks)))
    assert np.max(path.residual) <= 1e-9 * scale
    energy = scale * chain.full_stroke
    for event in path.events:
        assert event.released >= -1e-12 * energy


PRESETS = ("compliant-actuator", "three-stack", "used-before", "four-shuffle")


@pytest.mark.slow
@pytest.mark.parametrize("name", PRESETS)
def test_the_presets_reach_from_a_prescribed_force_to_a_prescribed_stroke(name):
    chain = sw.preset(name)
    for limit, stiffnesses in (
        ("force", (SOFTEST, 3e-6, 1e-5)),
        ("stroke", (1e8, 3e8, 1e10, STIFFEST)),
    ):
        exact = sets_of_states(graph(chain, limit))
        for stiffness in stiffnesses:
            assert sets_of_states(graph(chain, stiffness)) == exact, stiffness


@pytest.mark.parametrize("stiffness", [0.0, SOFTEST, 3e-6, 1.0, 60.0, 1e4, 3e8, STIFFEST, math.inf])
def test_the_compliant_actuator_comes_from_10_to_01_behind_every_spring(stiffness):
    chain = replace(sw.preset("compliant-actuator"), actuator_stiffness=stiffness)
    program = chain.program("01", start="10")
    assert program.sequence[-1] == "01" and program.shortest
    for turn, way in itertools.product(program.turns, (0.01, 0.99)):
        at = turn.low + way * (turn.high - turn.low)
        path = chain.path([program.begin, at, program.end], start="10")
        assert path.end.tolist() == program.path.end.tolist()


@pytest.mark.parametrize(
    ("stiffness", "words"),
    [
        (1e-7, r"= 1e-07 N/m: must be from 1e-6 to 1e12; use math.inf for a prescribed stroke"),
        (5e-324, "must be from 1e-6"),
        (1e13, r"= 1e\+13 N/m: must be from .* and 0 for a prescribed force"),
        (1e300, "must be from 1e-6"),
        (-1.0, "= -1 N/m: must be from 1e-6"),
        (math.nan, "must be finite"),
        ("soft", r"actuator_stiffness = 'soft': must be a number \[N/m\]"),
        (None, "must be a number"),
    ],
)
def test_a_stiffness_that_no_actuator_has_is_refused_with_what_is_allowed(stiffness, words):
    with pytest.raises(ValueError, match=words):
        sw.Chain(sw.preset("three-stack").cells, actuator_stiffness=stiffness)


@pytest.mark.parametrize("written", ["50", 50, np.float64(50)])
def test_a_stiffness_is_read_like_every_other_number(written):
    chain = sw.Chain(sw.preset("three-stack").cells, actuator_stiffness=written)
    assert repr(chain.actuator_stiffness) == "50.0"


def test_a_spring_too_stiff_for_the_cells_is_refused_and_not_decided_by_the_last_digit():
    # Forces of 1e-4 N over 40 m: λ/K is below the rounding of the stroke.
    band = sw.Band((-10.0, 0.0), (10.0, 0.0), stiffness=1e-6, rest_length=10.0)
    chain = sw.Chain([sw.Cell(band, lever=14.0, unusual=True)] * 2, actuator_stiffness=STIFFEST)
    with refuses(ValueError, "actuator_stiffness = ", "N/m", "N on", "m", "math.inf", "'rigid'"):
        chain.path([0.0, 1.0])


def test_a_cell_without_force_behind_a_spring_is_refused_too():
    slack = sw.Cell(sw.Band((0, 0), (-0.0085, 0.0007), rest_length=0.0156))
    assert not np.any(slack.force(slack.angle(np.linspace(0, slack.full_travel, 99))))
    with refuses(ValueError, "no cell", "force", "math.inf", "'rigid'"):
        graph(sw.Chain([slack]), 1e4)
    assert graph(sw.Chain([slack])).vertices == ("0", "1")
