"""A design for states reaches these and no others, and its yield counts those that do so too."""

import math
from collections.abc import Iterable

import numpy as np
import pytest

import stepwell as sw
from chains import concave_chain
from facts import says
from oracle import OracleCell, follow
from sizes import examples
from stepwell.design.synthesis.designed import Design, Impossible
from stepwell.design.synthesis.inverse import design
from stepwell.design.synthesis.region import AnchorBox, BandType
from stepwell.design.targets import reached
from stepwell.design.tolerances.draws import Tolerances
from stepwell.design.tolerances.yields import yields

# Cell 1 precedes cell 2, cell 3 is free.
WANTED = ["000", "001", "100", "101", "110", "111"]
CROSSING = (
    AnchorBox(0.0070, 0.0074, -0.0058, -0.0054),
    AnchorBox(0.0064, 0.0074, -0.0069, -0.0059),
    AnchorBox(0.0265, 0.0275, 0.0009, 0.0019),
)
STOCKS = (BandType(26.3, 0.0006), BandType(48.7, 0.0084), BandType(50.8, 0.013))
# Much like these, but some places in them do it.
PARTLY = (
    AnchorBox(0.0077, 0.0081, -0.0060, -0.0056),
    AnchorBox(0.0062, 0.0066, -0.0054, -0.0050),
    AnchorBox(0.0290, 0.0294, 0.0, 0.0004),
)
OTHERS = (BandType(22.2, 0.0008), BandType(47.4, 0.0078), BandType(45.8, 0.0124))
FINE = Tolerances(anchor=0.0001, stiffness=0.01)


def crossed() -> sw.Chain:
    """The chain of the theory page in which the second cell overtakes the first in a snap."""
    return sw.Chain(
        [
            sw.Cell(sw.Band((0, 0), (0.0080, -0.00644), stiffness=23.7, rest_length=0.0006)),
            sw.Cell(sw.Band((0, 0), (0.0069, -0.00480), stiffness=51.5, rest_length=0.0080)),
            sw.Cell(sw.Band((0, 0), (0.0285, -0.0008), stiffness=44.2, rest_length=0.0131)),
        ]
    )


def in_reach(chain: sw.Chain) -> set[str]:
    """All vertices of the graph from all cells at 0."""
    return {label for label in chain.graph(start="0" * len(chain)) if "-" not in label}


def by_random_strokes(chain: sw.Chain, rng: np.random.Generator, strokes: int) -> set[str]:
    """Vertices that the independent follower passes on strokes that turn back anywhere."""
    cells = []
    for cell in chain.levers:
        (band,) = cell.bands
        dx, dy = band.d
        k, rest = band.stiffness, band.rest_length
        cells.append(OracleCell(cell.lever, cell.limit, [(dx, dy, k, rest, 0, 0, False)]))
    full = sum(cell.span for cell in cells)
    points = [0.0, *rng.uniform(0, full, strokes), 0.0, full]
    run = follow(cells, points, steps=200)
    return set(run.sequence.split(">"))


@pytest.mark.slow
def test_small_boxes_and_stocks_in_which_a_cell_overtakes_give_no_design_that_reaches_more():
    # What the end forces alone would have chosen is in the wanted orders.
    with pytest.raises(Impossible, match="also reaches 011") as refusal:
        design(states=WANTED, within=CROSSING, bands=STOCKS, p=(0, 0), tolerances=FINE, samples=20)
    assert not refusal.value.proved
    says(str(refusal.value), "random choices", "target orders")


@pytest.mark.slow
def test_where_only_some_placements_overtake_another_is_taken():
    made = design(states=WANTED, within=PARTLY, bands=OTHERS, p=(0, 0), tolerances=FINE, samples=20)
    says(made.method, "simulation", "reaches 011")
    assert in_reach(made.chain) == set(WANTED) == set(made.states)
    assert made.reached.whole


@pytest.mark.slow
@pytest.mark.parametrize("states", [WANTED, ["000", "100", "110", "111"]])
def test_a_complete_search_of_the_nominal_design_is_reported(states):
    made = design(states=states, samples=20)
    assert in_reach(made.chain) == set(states) == set(made.states)
    assert made.reached.whole
    assert made.yield_.states == made.states
    assert made.yield_.target == f"states {' '.join(made.states)}"


@pytest.mark.slow
def test_the_yield_is_the_share_of_mechanisms_with_exactly_that_set():
    rough = Tolerances(anchor=0.002, stiffness=0.15)
    made = design(states=WANTED, tolerances=rough, samples=examples(30))
    right = 0
    for number in range(made.yield_.samples):
        right += in_reach(made.yield_.mechanism(number)) == set(WANTED)
    assert made.yield_.successes == right
    assert made.yield_.successes + sum(made.yield_.outcomes.values()) == made.yield_.samples


def test_a_chain_that_reaches_more_is_no_success_and_the_outcome_says_what():
    chain, exact = crossed(), Tolerances()
    result = yields(chain, exact, samples=3, target=WANTED)
    assert result.fraction == 0.0
    assert dict(result.outcomes) == {"also reaches 011": 3}
    assert yields(chain, exact, samples=3, target=[*WANTED, "011"]).fraction == 1.0
    lacking = yields(chain, exact, samples=3, target=[*WANTED, "011", "010"])
    assert dict(lacking.outcomes) == {"does not reach 010": 3}
    assert "the nominal design reaches 000 100 001 110 101 011 111" in lacking.advice


@pytest.mark.slow
def test_the_independent_follower_reaches_nothing_else():
    rng = np.random.default_rng(5)
    assert by_random_strokes(crossed(), rng, 60) <= {*WANTED, "011"}
    for cells in (2, 3):
        for _ in range(examples(1, full=40)):
            chain = concave_chain(rng, cells)
            states = reached(chain)
            assert states.whole
            assert by_random_strokes(chain, rng, 30) <= set(states.states)


@pytest.mark.slow
def test_all_states_are_reported_by_orders_alone_only_where_that_is_proved():
    rng = np.random.default_rng(2)
    every = [f"{k:03b}" for k in range(8)]
    rough = Tolerances(anchor=0.003, stiffness=0.1)
    made = design(states="all", cells=3, tolerances=rough, samples=200)
    some = rng.choice(200, 25, replace=False).tolist()
    done = [set(every) == in_reach(made.yield_.mechanism(i)) for i in some]
    text = made.yield_.assumptions
    says(text, "proved", "all states")
    for number, right in zip(some, done, strict=True):
        alone = yields(made.yield_.mechanism(number), Tolerances(), samples=1, target=every)
        assert (alone.successes == 1) == right
    # Levers that differ are beyond the proof: then each is followed.
    levers = yields(made.chain, Tolerances(lever=0.0001), samples=5, target=every)
    assert levers.by_engine == 5


@pytest.mark.slow
def test_what_cannot_be_searched_whole_says_so():
    def assumptions(made: Design) -> str:
        return str(made) + made.reached.how + made.assumptions

    nine = ["1" * k + "0" * (9 - k) for k in range(10)]
    long = design(states=nine, samples=20)
    assert not long.reached.whole
    assert set(long.states) == set(nine)
    says(str(long), "at least")
    assert "8 cells" in assumptions(long)
    assert long.yield_.states is None and long.yield_.target == long.sequence
    says(long.assumptions, "yield", "cycle")
    rubbing = design(states=WANTED, tolerances=Tolerances(anchor=0.0003, friction=0.01), samples=20)
    assert rubbing.reached.whole  # as drawn it has none
    assert rubbing.yield_.states is None
    says(rubbing.assumptions, "with friction", "a chain stops")
    nested = design(states="all", cells=9, samples=20)
    assert nested.reached.whole and nested.reached.count == 512 == len(nested.states)


@pytest.mark.parametrize(
    ("chain", "tolerances", "wanted", "words"),
    [
        (crossed(), Tolerances(friction=0.1), WANTED, "with friction"),
        (crossed(), Tolerances(), ["00", "11"], "3 characters 0 or 1"),
        (crossed(), Tolerances(), [], "3 characters 0 or 1"),
        (sw.Chain([*crossed().cells] * 3), Tolerances(), ["0" * 9, "1" * 9], "up to 8 cells only"),
    ],
)
def test_states_that_cannot_be_counted_are_refused(chain, tolerances, wanted, words):
    with pytest.raises(ValueError, match=words):
        yields(chain, tolerances, samples=1, target=wanted)


def ideals(up: Iterable[float], down: Iterable[float]) -> set[str]:
    """States in which every cell at 1 has those at 1 that come before and go after it."""
    up, down = list(up), list(down)
    n = len(up)
    states = set()
    for number in range(2**n):
        state = f"{number:0{n}b}"
        if all(
            state[i] == "1"
            for i in range(n)
            for j in range(n)
            if state[j] == "1" and up[i] < up[j] and down[i] < down[j]
        ):
            states.add(state)
    return states


@pytest.mark.slow
def test_concave_chains_reach_their_ideals_at_least():
    rng = np.random.default_rng(8)
    for cells in (2, 3, 4, 5):
        for stiffness in (math.inf, 100.0):
            for _ in range(examples(2)):
                chain = sw.Chain(concave_chain(rng, cells).cells, stiffness)
                surely = ideals(
                    (c.force_0 for c in chain.levers), (c.force_1 for c in chain.levers)
                )
                assert surely <= set(reached(chain).states)


@pytest.mark.parametrize("cells", [9, 40])
def test_under_a_force_what_long_chains_reach_is_known_whole(cells):
    chain = concave_chain(np.random.default_rng(cells), cells)
    forced = sw.Chain(chain.cells, actuator_stiffness=0.0)
    states = reached(forced)
    assert states.whole
    assert states.count == forced.implicit_graph().reached_count
    if cells == 9:
        listed = forced.graph()
        assert set(states.states) == listed.reachable()
