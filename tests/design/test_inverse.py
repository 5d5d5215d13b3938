"""A design is a promise: it does what was wanted, from what was allowed, and none is better."""

import math
import re
from collections.abc import Callable, Iterable
from itertools import combinations, islice, pairwise, permutations, product

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from hypothesis.extra.numpy import arrays

import stepwell as sw
from facts import refuses, says
from sizes import SIZE, cases, examples
from stepwell import sequences
from stepwell.design.margins.robustness import robustness
from stepwell.design.orders import Orders, checked_cycle, of_states
from stepwell.design.synthesis import attempt, candidates, holes, placement
from stepwell.design.synthesis.designed import Design, Impossible
from stepwell.design.synthesis.inverse import DEFAULT_TOLERANCES, design
from stepwell.design.synthesis.region import (
    PAPER_BAND,
    PAPER_BOX,
    PAPER_LEVER,
    AnchorBox,
    AnchorPolygon,
    BandType,
    HoleGrid,
    drilled,
    fits_grid,
    lattice,
    usual_box,
)
from stepwell.design.tolerances.draws import Tolerances
from stepwell.design.tolerances.yields import yields

PAIRS = [(a, b) for a in permutations(range(3)) for b in permutations(range(3))]
NESTED = "000>100>110>111>011>001>000"
FEW = 200  # mechanisms, where a yield is not what is tested


def cycle(loading: Iterable[int], unloading: Iterable[int]) -> str:
    """The sequence in which cells load and unload in these orders, written independently."""
    loading, unloading = list(loading), list(unloading)
    state = ["0"] * len(loading)
    states = ["".join(state)]
    for order, to in ((loading, "1"), (unloading, "0")):
        for cell in order:
            state[cell] = to
            states.append("".join(state))
    return ">".join(states)


def paper_cell(x: float, y: float) -> sw.Cell:
    return sw.Cell(sw.Band((-0.010, 0.0), (x, y)), unusual=True)  # an anchor at 0.01 mm


def refuses_nothing(made: Design, wanted: str) -> None:
    """The engine, asked anew, finds the wanted sequence without a tie."""
    cycle = made.chain.cycle()
    assert str(cycle.sequence) == made.sequence == wanted
    assert not cycle.degenerate


# Found and verified ---------------------------------------------------------------------------


@pytest.mark.parametrize(("loading", "unloading"), cases(PAIRS, PAIRS[::7]))
def test_each_cycle_of_three_cells_is_found_in_the_papers_box_with_the_papers_band(
    loading, unloading
):
    wanted = cycle(loading, unloading)
    made = design(wanted, samples=FEW)
    refuses_nothing(made, wanted)
    assert np.all(PAPER_BOX.holds(made.anchors))
    for cell in made.chain.levers:
        (band,) = cell.bands
        assert (band.stiffness, band.rest_length, band.p) == (28.5, 0.010, (-0.010, 0.0))
        assert (cell.lever, cell.limit) == (PAPER_LEVER, math.pi / 4)
    assert made.yield_.target == wanted
    assert made.yield_.fraction == 1.0


@pytest.mark.slow
@pytest.mark.parametrize("cells", [1, 2, 4, 5, 6, 8])
def test_random_cycles_of_more_cells_are_found(cells):
    rng = np.random.default_rng(cells)
    for _ in range(examples(1, full=60)):
        loading, unloading = (rng.permutation(cells).tolist() for _ in range(2))
        wanted = cycle(loading, unloading)
        made = design(wanted, samples=FEW)
        refuses_nothing(made, wanted)
        assert (made.loading, made.unloading) == (tuple(loading), tuple(unloading))
        assert np.all(PAPER_BOX.holds(made.anchors))


def test_the_end_forces_stand_in_the_wanted_orders():
    made = design("0000>0100>0101>1101>1111>0111>0110>0010>0000", samples=FEW)
    assert np.argsort(made.forces[:, 0]).tolist() == [1, 3, 0, 2] == list(made.loading)
    assert np.argsort(-made.forces[:, 1]).tolist() == [0, 3, 1, 2] == list(made.unloading)


@pytest.mark.slow
def test_which_cell_is_which_does_not_matter_to_where_anchors_go():
    one = design(cycle((0, 1, 2, 3), (2, 0, 3, 1)), samples=1)
    label = [2, 0, 3, 1]
    other = design(cycle(label, [label[i] for i in (2, 0, 3, 1)]), samples=1)
    np.testing.assert_allclose(other.anchors[label], one.anchors, atol=1e-9)


def test_a_design_is_the_same_every_time():
    first, second = design(NESTED, samples=FEW), design(NESTED, samples=FEW)
    np.testing.assert_array_equal(first.anchors, second.anchors)
    assert first.yield_.successes == second.yield_.successes


# As sure as can be ----------------------------------------------------------------------------


ROUGH = Tolerances(anchor=0.0015, stiffness=0.12)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("loading", "unloading"), [((0, 1, 2), (0, 1, 2)), ((0, 1, 2, 3), (1, 3, 0, 2))]
)
def test_no_anchor_a_millimetre_elsewhere_yields_more(loading, unloading):
    wanted, n = cycle(loading, unloading), 20_000
    made = design(wanted, tolerances=ROUGH, samples=n)
    assert 0.5 < made.yield_.fraction < 0.9999
    noise = 3 * math.sqrt(made.yield_.fraction * (1 - made.yield_.fraction) / n)
    for i, move in product(range(len(loading)), ((1, 0), (-1, 0), (0, 1), (0, -1))):
        q = made.anchors.copy()
        q[i] = PAPER_BOX.clamped(q[i : i + 1] + 0.001 * np.array(move))[0]
        moved = sw.Chain([paper_cell(*place) for place in q.tolist()])
        # The same seed makes the same errors, so that only the move counts.
        other = yields(moved, ROUGH, samples=n, target=wanted)
        assert other.fraction < made.yield_.fraction + noise


@pytest.mark.parametrize(
    ("cells", "tolerances", "more"),
    # So many cells take a search that is worth the compiler.
    [(4, ROUGH, 0.02), pytest.param(8, DEFAULT_TOLERANCES, 0.05, marks=pytest.mark.slow)],
)
def test_a_designed_yield_is_above_those_of_obvious_designs(cells, tolerances, more):
    equal = [(x, 0.0) for x in np.linspace(0, 0.020, cells).tolist()]
    obvious = sw.Chain([paper_cell(*place) for place in equal])
    made = design(cycle(range(cells), range(cells)), tolerances=tolerances, samples=20_000)
    assert str(obvious.cycle().sequence) == made.sequence
    assert made.yield_.fraction > yields(obvious, tolerances, samples=20_000).fraction + more


@pytest.mark.slow
def test_each_objective_wins_by_its_own_measure():
    nested = cycle(range(6), range(6))
    sure = design(nested, samples=20_000)
    worst = design(nested, samples=20_000, objective="worst")
    assert sure.yield_.fraction > worst.yield_.fraction
    assert sure.robustness is not None and worst.robustness is not None
    assert worst.robustness.radius > 1.1 * sure.robustness.radius


@pytest.mark.slow
@pytest.mark.parametrize(
    "x", [(0.0, 20 / 3, 40 / 3, 20.0), (0.01, 9.82, 19.97)][: examples(1, full=2)]
)
def test_programmable_chains_are_as_robust_as_the_ones_known_or_more_so(x):
    known = robustness(sw.Chain([paper_cell(mm * 1e-3, 0.0) for mm in x]))
    made = design(states="all", cells=len(x), objective="worst", samples=FEW)
    assert len(made.states) == 2 ** len(x)
    assert made.robustness is not None
    assert made.robustness.radius > known.radius
    assert made.robustness.radius > {3: 0.00407, 4: 0.00271}[len(x)]


@pytest.mark.slow
def test_a_search_from_anywhere_finds_nothing_more_robust():
    rng = np.random.default_rng(7)
    kind = candidates.Kind(PAPER_BAND, PAPER_LEVER, math.pi / 4)
    rule = candidates.Rule((-0.010, 0.0), (kind,), DEFAULT_TOLERANCES, math.inf, True, PAPER_BOX)
    both = ((0, 1, 2), (1, 0, 2)), ((0, 1, 2), (2, 1, 0))
    for loading, unloading in both[: examples(1, full=2)]:
        orders = Orders(loading, unloading)
        made = attempt.from_lattice(rule, orders, (PAPER_BOX,) * 3, None).refined()
        assert made.best is not None
        table = made.tables[0]
        search = placement.Search(rule, orders, (PAPER_BOX,) * 3)
        for _ in range(examples(1, full=60)):
            start = placement.measured(rule, orders, table.take(rng.integers(len(table.q), size=3)))
            start, _ = search.settle(start, lambda i, now, table=table: table, 50)
            other = search.refine(start, 0.001)
            assert other.smallest < 1.002 * made.best.smallest


@pytest.mark.slow
def test_the_worst_case_between_two_candidates_is_the_robustness_of_such_a_pair():
    kind = candidates.Kind(PAPER_BAND, PAPER_LEVER, math.pi / 4)
    rule = candidates.Rule((-0.010, 0.0), (kind,), Tolerances(), math.inf, True, PAPER_BOX)
    table = rule.everything(PAPER_BOX, lattice(PAPER_BOX, 0.005))
    gaps = rule.gaps(table)
    ended = 0
    for a, b in combinations(range(0, len(table.q), 2), 2):
        pair = sw.Chain([paper_cell(*table.q[i].tolist()) for i in (a, b)])
        # F0 and F1 may have them in either order.
        sure = [max(gaps[end, a, b], gaps[end, b, a]) for end in (0, 1)]
        if min(sure) == -math.inf:
            continue
        result = robustness(pair)
        ended += result.limit == "proof"
        # What is proved of a disc stops a little short of its edge.
        assert result.radius == pytest.approx(
            min(sure), rel=0.1 if result.cell is not None else 1e-5
        )
    assert ended > 10


@pytest.mark.slow
def test_small_tolerances_do_not_stop_the_search():
    # Every chance is 1 to the last digit; the gaps are still made as wide as can be.
    exact = design(states="all", cells=3, tolerances=Tolerances(), samples=1)
    tiny = design(states="all", cells=3, tolerances=Tolerances(anchor=1e-6), samples=1)
    for made in (exact, tiny):
        assert made.robustness is not None
        assert made.robustness.radius > 0.0039


@pytest.mark.slow
def test_first_order_deviations_are_those_of_mechanisms_made_at_random():
    tolerances = Tolerances(0.0004, 0.04, 0.03, 0.0002, 0.01)
    kind = candidates.Kind(PAPER_BAND, PAPER_LEVER, math.pi / 4)
    q = np.array([(0.010, 0.0), (0.003, 0.008), (0.018, -0.012)])
    rule = candidates.Rule((-0.010, 0.0), (kind,), tolerances, math.inf, False, PAPER_BOX)
    nominal = rule.everything(PAPER_BOX, q)
    chain = sw.Chain([paper_cell(*place) for place in q.tolist()])
    n = examples(1500, full=4000)
    made = yields(chain, tolerances, samples=n).end_forces(n)
    np.testing.assert_allclose(nominal.down, np.std(made, axis=0), rtol=0.06)
    np.testing.assert_array_equal(nominal.up, nominal.down)
    # Friction raises all F0 alike, and lowers all F1.
    mean = np.mean(made, axis=0) - np.array([0.005, -0.005])
    np.testing.assert_allclose(nominal.force, mean, atol=0.003)


# Holes: found or proved impossible ------------------------------------------------------------


def holes_by_brute_force(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    cells = [paper_cell(x, y) for x, y in q.tolist()]
    return np.array([c.force_0 for c in cells]), np.array([c.force_1 for c in cells])


def any_choice(f0: np.ndarray, f1: np.ndarray, loading, unloading) -> bool:
    """Whether three of the holes meet both orders, by trying all of them."""
    axes = [(-1, 1, 1), (1, -1, 1), (1, 1, -1)]
    a, b = ([f.reshape(shape) for shape in axes] for f in (f0, f1))
    hair = 1e-9 * max(np.abs(f0).max(), np.abs(f1).max())
    good = np.ones((len(f0),) * 3, bool)
    for i, j in pairwise(loading):
        good &= a[j] - a[i] > hair
    for i, j in pairwise(unloading):
        good &= b[i] - b[j] > hair
    return bool(good.any())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("within", "pitch", "possible"),
    [
        (PAPER_BOX, 0.005, 36),
        (PAPER_BOX, 0.010, 36),
        (AnchorBox(0.0, 0.006, 0.0, 0.006), 0.003, 36),
        (AnchorBox(0.001, 0.007, 0.0, 0.004), 0.003, 12),
        (AnchorBox(0.0, 0.020, 0.0, 0.001), 0.005, 6),
        (AnchorBox(0.0, 0.0001, -0.015, 0.015), 0.005, 6),
        (AnchorBox(0.0, 0.008, 0.0, 0.008), 0.006, 12),
        (PAPER_BOX, 0.021, 0),
    ],
)
def test_on_holes_a_cycle_is_found_exactly_where_trying_all_of_them_finds_one(
    within, pitch, possible
):
    f0, f1 = holes_by_brute_force(drilled(within, HoleGrid(pitch)))
    count = 0
    for number, (loading, unloading) in enumerate(PAIRS):
        wanted = cycle(loading, unloading)
        there = any_choice(f0, f1, loading, unloading)
        count += there
        if SIZE == "ci" and number % 3:
            continue
        if there:
            made = design(wanted, within=within, holes=pitch, samples=1)
            refuses_nothing(made, wanted)
            assert made.proved
            steps = made.anchors / pitch
            np.testing.assert_allclose(steps, np.round(steps), atol=1e-9)
            assert np.all(within.holds(made.anchors))
        else:
            with pytest.raises(Impossible, match="complete search") as refusal:
                design(wanted, within=within, holes=pitch, samples=1)
            proof = refusal.value
            assert proof.proved
            assert proof.largest_gap == 0.0 < proof.gap_needed
            np.testing.assert_allclose(proof.region[0], np.column_stack([f0, f1]), rtol=1e-12)
    assert count == possible


def test_where_each_cell_has_its_own_holes_the_certificate_says_by_how_much_they_fail():
    # Cell 1 is to have the smallest F0, but all its places give the largest.
    apart = (AnchorBox(0.018, 0.020, 0.0, 0.001), AnchorBox(0.0, 0.002, 0.0, 0.001))
    with pytest.raises(Impossible) as refusal:
        design("00>10>11>01>00", within=apart, holes=0.002, samples=1)
    right, left = (holes_by_brute_force(drilled(region, HoleGrid(0.002))) for region in apart)
    best = max(
        min(b0 - a0, a1 - b1)
        for (a0, a1), (b0, b1) in product(zip(*right, strict=True), zip(*left, strict=True))
    )
    assert best < 0
    assert refusal.value.largest_gap == pytest.approx(best, rel=1e-12)
    assert len(refusal.value.region) == 2


@pytest.mark.slow
@pytest.mark.parametrize("objective", ["yield", "worst"])
def test_among_holes_no_choice_is_better_by_the_objective(objective):
    kind = candidates.Kind(PAPER_BAND, PAPER_LEVER, math.pi / 4)
    worst = objective == "worst"
    # The holes at the edge of the proof stay, for the worst case to weigh.
    rough = Tolerances() if worst else Tolerances(anchor=0.001, stiffness=0.24)
    rule = candidates.Rule((-0.010, 0.0), (kind,), rough, math.inf, worst, PAPER_BOX)
    table = rule.everything(PAPER_BOX, drilled(PAPER_BOX, HoleGrid(0.010)))
    for loading, unloading in PAIRS[: examples(1, full=6)]:
        orders = Orders(loading, unloading)
        made = attempt.from_lattice(rule, orders, (PAPER_BOX,) * 3, HoleGrid(0.010))
        assert made.best is not None and made.complete
        every = [
            placement.measured(rule, orders, table.take(np.array(picks)))
            for picks in product(range(len(table.q)), repeat=3)
        ]
        if worst:
            # The radii between neighbours are exact in a placement that is looked at anew.
            search = placement.Search(rule, orders, (PAPER_BOX,) * 3)
            good = sorted(every, key=lambda p: p.smallest)[-200:]
            best = max(search.recomputed(p).smallest for p in good)
            assert search.recomputed(made.best).smallest == pytest.approx(best, rel=1e-6)
        else:
            best = max(p.quality(False) for p in every if p.smallest > 0)
            assert made.best.quality(False)[0] == pytest.approx(best[0], rel=1e-9)


@pytest.mark.slow
@given(
    arrays(float, (2, 5, 5), elements=st.floats(-4, 4).map(lambda v: -np.inf if v < -1 else v)),
    st.lists(st.booleans(), min_size=15, max_size=15),
    st.permutations(range(3)),
    st.permutations(range(3)),
    st.booleans(),
)
def test_the_complete_search_is_as_good_as_trying_everything(gap, some, loading, unloading, add):
    allowed = np.array(some).reshape(3, 5)
    orders = Orders(tuple(loading), tuple(unloading))

    def worth(picks: tuple[int, ...]) -> float:
        if not all(allowed[i, c] for i, c in enumerate(picks)):
            return -math.inf
        gaps = [
            gap[end, picks[a], picks[b]]
            for end, order in enumerate(orders.rising)
            for a, b in pairwise(order)
        ]
        return float(sum(gaps)) if add else float(min(gaps))

    best = max(worth(picks) for picks in product(range(5), repeat=3))
    choice = holes.best_choice(gap, holes.Offered.freely(allowed), orders, add=add)
    assert choice.complete
    assert choice.value == pytest.approx(best, abs=1e-9)
    assert (len(choice.picks) > 0) == (best > -math.inf)
    if len(choice.picks):
        assert worth(tuple(choice.picks.tolist())) == pytest.approx(best, abs=1e-9)


@pytest.mark.slow
@given(
    arrays(float, (2, 5, 5), elements=st.floats(-4, 4).map(lambda v: -np.inf if v < -1 else v)),
    st.lists(st.integers(0, 1), min_size=5, max_size=5),
    st.lists(st.integers(1, 3), min_size=5, max_size=5),
    st.tuples(st.integers(1, 5), st.integers(1, 5)),
    st.booleans(),
)
def test_within_packs_the_complete_search_is_as_good_as_trying_everything(
    gap, band, uses, room, add
):
    orders = Orders((0, 1, 2), (1, 0, 2))
    packs = holes.Packs(np.array(band), np.array(uses), np.array(room))

    def worth(picks: tuple[int, ...]) -> float:
        used = [sum(uses[c] for c in picks if band[c] == one) for one in (0, 1)]
        gaps = [
            gap[end, picks[a], picks[b]]
            for end, order in enumerate(orders.rising)
            for a, b in pairwise(order)
        ]
        fits = used[0] <= room[0] and used[1] <= room[1]
        return float(sum(gaps) if add else min(gaps)) if fits else -math.inf

    best = max(worth(picks) for picks in product(range(5), repeat=3))
    offered = holes.Offered(np.ones((3, 5), bool), packs)
    choice = holes.best_choice(gap, offered, orders, add=add)
    assert choice.complete
    assert (choice.value == best == -math.inf) or choice.value == pytest.approx(best, abs=1e-9)
    if len(choice.picks):
        assert worth(tuple(choice.picks.tolist())) == pytest.approx(best, abs=1e-9)


COLUMN = AnchorBox(0.010, 0.0101, -0.010, 0.010)


def in_packs(packs: tuple[int | None, int | None], most: int) -> set[tuple[int, ...]]:
    """Numbers of cycles of `PAIRS` of three cells in the holes of a column, by trying all."""
    cells = [
        (band, count, sw.Cell(sw.Band((-0.010, 0.0), (0.010, y), count * k, 0.010)))
        for band, k in enumerate((28.5, 47.0))
        for count in range(1, most + 1)
        for y in (-0.010, 0.0, 0.010)
    ]
    found = set()
    for chosen in product(cells, repeat=3):
        used = [sum(count for band, count, _ in chosen if band == one) for one in (0, 1)]
        if any(pack is not None and n > pack for n, pack in zip(used, packs, strict=True)):
            continue
        first, last = (
            [getattr(cell, name) for _, _, cell in chosen] for name in ("force_0", "force_1")
        )
        if min(len({round(one, 9) for one in ends}) for ends in (first, last)) == 3:
            loading = tuple(sorted(range(3), key=lambda i: first[i]))
            found.add((loading, tuple(sorted(range(3), key=lambda i: -last[i]))))
    return found


@pytest.mark.slow
@pytest.mark.parametrize(("packs", "most"), [((None, 1), 1), ((1, 2), 2), ((2, 1), 1)])
def test_in_packs_a_cycle_is_found_exactly_where_trying_all_choices_finds_one(packs, most):
    kinds = [
        BandType(k, 0.010, name=name, pack=pack)
        for k, name, pack in zip((28.5, 47.0), "ab", packs, strict=True)
    ]
    there = in_packs(packs, most)
    assert there and len(there) < len(PAIRS)
    for number, pair in enumerate(PAIRS):
        if SIZE == "ci" and number % 4:
            continue
        how = {"within": COLUMN, "holes": 0.010, "bands": kinds, "most_bands": most, "samples": 1}
        if pair in there:
            made = design(cycle(*pair), **how)
            refuses_nothing(made, cycle(*pair))
            for kind in kinds:
                used = sum(count for band, count in made.bands if band == kind)
                assert kind.pack is None or used <= kind.pack
            stiffness = [one.bands[0].stiffness for one in made.chain.levers]
            assert stiffness == [count * band.stiffness for band, count in made.bands]
        else:
            with pytest.raises(Impossible) as refusal:
                design(cycle(*pair), **how)
            assert refusal.value.proved


def test_packs_of_the_same_band_are_one_pack():
    apart = design(
        "000>100>110>111>110>100>000", bands=[BandType(pack=1), BandType(pack=2)], samples=1
    )
    whole = design("000>100>110>111>110>100>000", bands=[BandType(pack=3)], samples=1)
    assert apart.bands == whole.bands and apart.chain == whole.chain


def test_fewer_bands_than_cells_are_a_proof_and_a_pack_that_is_too_small_says_what_is_missing():
    with refuses(Impossible, "3 cells", "packs hold 2") as refusal:
        design(NESTED, bands=[BandType(pack=1), BandType(47.0, pack=1)])
    assert refusal.value.proved
    # Two of the cells need the stronger band.
    wanted, strong = cycle((0, 1, 2), (0, 2, 1)), BandType(47.0, name="strong", pack=1)
    how = {"within": COLUMN, "holes": 0.010, "samples": 1}
    with refuses(Impossible, "packs of bands", "takes") as refusal:
        design(wanted, bands=[BandType(pack=2), strong], **how)
    assert refusal.value.proved
    assert design(wanted, bands=[BandType(), BandType(47.0)], **how).bands_used == ""


def test_a_search_that_gave_up_proves_nothing():
    rng = np.random.default_rng(0)
    gap = rng.uniform(0, 1, (2, 12, 12))
    orders = Orders((0, 1, 2, 3, 4), (2, 0, 4, 1, 3))
    offered = holes.Offered.freely(np.ones((5, 12), bool))
    choice = holes.best_choice(gap, offered, orders, add=True, most_nodes=7)
    assert not choice.complete
    assert choice.nodes == 7


# Sets of states -------------------------------------------------------------------------------


def ideals(loading: tuple[int, ...], unloading: tuple[int, ...]) -> set[str]:
    """States in which every cell at 1 has all at 1 that load before and unload after it."""
    n = len(loading)
    needs = [
        (i, j)
        for i, j in permutations(range(n), 2)
        if loading.index(i) < loading.index(j) and unloading.index(i) > unloading.index(j)
    ]
    every = ("".join(bits) for bits in product("01", repeat=n))
    return {s for s in every if all(s[i] == "1" or s[j] == "0" for i, j in needs)}


def one_by_one(states: set[str], state: str) -> bool:
    """Whether some of the states lead on to all cells at 1, one cell at a time."""
    if "0" not in state:
        return True
    following = (state[:i] + "1" + state[i + 1 :] for i, c in enumerate(state) if c == "0")
    return any(one_by_one(states, other) for other in following if other in states)


@pytest.mark.slow
@pytest.mark.parametrize("cells", [2, 3])
def test_each_set_of_states_of_few_cells_is_had_or_refused_with_the_engine_as_witness(cells):
    every = ["".join(bits) for bits in product("01", repeat=cells)]
    orders = list(permutations(range(cells)))
    possible = {frozenset(ideals(a, b)) for a in orders for b in orders}
    inner = every[1:-1]
    for size in range(len(inner) + 1):
        # The quick run takes every second set of a size.
        for middle in islice(combinations(inner, size), 0, None, examples(2, full=1)):
            wanted = {every[0], every[-1], *middle}
            if frozenset(wanted) not in possible:
                with pytest.raises(Impossible) as refusal:
                    design(states=wanted, samples=1)
                # A cell that overtakes might reach more than orders tell; but no concave chain
                # goes on without a way from all at 0 to all at 1, one cell at a time.
                assert refusal.value.proved == (not one_by_one(wanted, every[0]))
                continue
            made = design(states=wanted, samples=1)
            assert set(made.states) == wanted
            for state in every:
                if state in wanted:
                    program = sequences.program(made.chain, state)
                    assert program.target == state
                else:
                    with pytest.raises(sequences.Unreachable):
                        sequences.program(made.chain, state)


@given(st.integers(1, 6).flatmap(lambda n: st.tuples(*[st.permutations(range(n))] * 2)))
def test_whatever_two_orders_reach_is_found_to_need_orders_that_reach_it(pair):
    loading, unloading = (tuple(order) for order in pair)
    states = ideals(loading, unloading)
    assert set(Orders(loading, unloading).states) == states
    target_orders = of_states(states, None, alike=False)
    assert all(ideals(o.loading, o.unloading) == states for o in target_orders.orders)
    if target_orders.complete:
        assert Orders(loading, unloading) in target_orders.orders


@pytest.mark.slow
def test_all_orders_of_a_set_of_states_are_tried():
    every = list(permutations(range(4)))
    for loading, unloading in product(every[: examples(2, full=6)], every):
        states = ideals(loading, unloading)
        same = {(a, b) for a, b in product(every, every) if ideals(a, b) == states}
        target_orders = of_states(states, None, alike=False)
        assert target_orders.complete == (len(same) < 24)
        if target_orders.complete:
            assert {(o.loading, o.unloading) for o in target_orders.orders} == same
        alike = of_states(states, None, alike=True)
        patterns = {Orders(a, b).pattern for a, b in same}
        assert alike.complete
        assert {o.pattern for o in alike.orders} == patterns


@pytest.mark.parametrize(
    ("states", "reason"),
    [
        (["10", "11"], "00 is not among the target states"),
        (["00", "10"], "11 is not among the target states"),
        (["000", "100", "010", "111"], "010 and 100 also reaches 110"),
        (["000", "110", "011", "111"], "011 and 110 also reaches 010"),
        (["000", "110", "111"], "cells 1 and 2 are in the same state"),
    ],
)
def test_states_that_no_chain_reaches_alone_are_refused_with_the_reason(states, reason):
    with pytest.raises(Impossible, match=reason) as refusal:
        design(states=states)
    assert refusal.value.proved
    assert refusal.value.region == ()


def test_a_partial_order_of_dimension_three_is_refused():
    # The standard example: cell 3 + i needs all of cells 0 to 2 but i (Dushnik & Miller 1941).
    states = [
        "".join(bits)
        for bits in product("01", repeat=6)
        if all(
            bits[3 + i] == "0" or all(bits[j] == "1" for j in range(3) if j != i) for i in range(3)
        )
    ]
    with pytest.raises(Impossible, match="dimension above two"):
        design(states=states)


def test_programmable_chains_have_every_pair_of_loops_nested():
    made = design(states="all", cells=4, samples=FEW)
    assert made.loading == made.unloading
    by_f0 = made.forces[np.argsort(made.forces[:, 0])]
    assert np.all(np.diff(by_f0[:, 1]) < 0)
    assert len(set(made.states)) == 16


def test_on_holes_states_are_found_or_proved_impossible_too():
    made = design(states="all", cells=4, holes=0.005, samples=FEW)
    assert made.proved
    assert len(made.states) == 16
    with pytest.raises(Impossible) as refusal:
        design(states="all", cells=4, holes=0.015, within=AnchorBox(0.0, 0.015, 0.0, 0.015))
    assert refusal.value.proved


# What is allowed ------------------------------------------------------------------------------


L_SHAPE = AnchorPolygon(
    ((0, -0.010), (0.020, -0.010), (0.020, 0), (0.005, 0), (0.005, 0.010), (0, 0.010))
)
TRIANGLE = AnchorPolygon(((0, -0.012), (0.020, -0.002), (0.004, 0.014)))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("within", "objective"),
    [(L_SHAPE, "worst"), (TRIANGLE, "yield")]
    if SIZE == "ci"
    else list(product([L_SHAPE, TRIANGLE], ["yield", "worst"])),
)
def test_anchors_stay_in_a_polygon(within, objective):
    made = design(NESTED, within=within, objective=objective, samples=FEW)
    refuses_nothing(made, NESTED)
    away = np.linalg.norm(within.clamped(made.anchors) - made.anchors, axis=1)
    assert np.all(away < 1e-6)


@pytest.mark.slow
def test_each_cell_may_have_its_own_region():
    within = (
        AnchorBox(0.015, 0.020, -0.002, 0.002),
        AnchorBox(0.0, 0.020, -0.002, 0.002),
        AnchorPolygon(((0, -0.015), (0.020, -0.015), (0.020, 0.015))),
    )
    made = design(NESTED, within=within, samples=FEW)
    refuses_nothing(made, NESTED)
    for region, q in zip(within, made.anchors, strict=True):
        assert np.linalg.norm(region.clamped(q[None])[0] - q) < 1e-6
    # For states any order will do, and the best one is not that of the cells' numbers.
    free = design(states="all", cells=3, within=within, samples=FEW)
    assert free.loading[0] != 0
    assert free.yield_.fraction > made.yield_.fraction


def test_holes_on_the_edge_of_a_polygon_count():
    triangle = AnchorPolygon(((0.001, 0.002), (0.004, 0.002), (0.001, 0.005)))
    for places in (lattice(triangle, 0.001), drilled(triangle, HoleGrid(0.001))):
        assert np.round(places * 1e3, 6).tolist() == [
            [1, 2], [2, 2], [3, 2], [4, 2], [1, 3], [2, 3], [3, 3], [1, 4], [2, 4], [1, 5],
        ]  # fmt: skip
    assert len(lattice(PAPER_BOX, 0.005)) == 35
    assert np.array_equal(drilled(PAPER_BOX, HoleGrid(0.005)), lattice(PAPER_BOX, 0.005))


@given(
    st.tuples(*[st.integers(-40, 40)] * 2),
    st.tuples(*[st.integers(1, 25)] * 2),
    st.sampled_from([0.1e-3, 0.3e-3, 0.7e-3, 1.1e-3, 0.0025, 0.005]),
)
def test_holes_with_edges_on_the_grid_are_all_multiples_of_the_spacing(low, steps, pitch):
    # The same edges, computed in other ways, differ in their last digits.
    edges = [(pitch * k, pitch * (k + n)) for k, n in zip(low, steps, strict=True)]
    other = [(pitch * k, pitch * k + sum([pitch] * n)) for k, n in zip(low, steps, strict=True)]
    for (left, right), (bottom, top) in (edges, other):
        box = AnchorBox(left, right, bottom, top)
        places = drilled(box, HoleGrid(pitch))
        assert len(places) == (steps[0] + 1) * (steps[1] + 1)
        np.testing.assert_allclose(places / pitch, np.round(places / pitch), atol=1e-7)
        assert np.array_equal(box.clamped(places), places)


@given(
    st.tuples(*[st.floats(-0.05, 0.05)] * 2),
    st.tuples(*[st.floats(0.001, 0.05)] * 2),
    st.floats(0.001, 0.02),
)
def test_holes_of_any_area_are_the_multiples_inside_it(corner, size, pitch):
    box = AnchorBox(corner[0], corner[0] + size[0], corner[1], corner[1] + size[1])
    places = drilled(box, HoleGrid(pitch))
    numbers = np.arange(-100, 101) * pitch
    columns = np.sum((numbers >= box.left - 0.5e-6) & (numbers <= box.right + 0.5e-6))
    rows = np.sum((numbers >= box.bottom - 0.5e-6) & (numbers <= box.top + 0.5e-6))
    assert len(places) == columns * rows
    np.testing.assert_allclose(places, np.round(places / pitch) * pitch, atol=0.51e-6)
    assert np.array_equal(box.clamped(places), places)


def test_chosen_holes_pass_through_the_middle_of_the_joints():
    made = design(NESTED, lever=0.040, holes=0.005, samples=1)
    np.testing.assert_allclose(made.anchors / 0.005, np.round(made.anchors / 0.005), atol=1e-9)
    assert usual_box(0.040).clamped(made.anchors) == pytest.approx(made.anchors)
    assert not made.off_grid


def test_an_anchor_beside_the_grid_of_holes_is_named_and_stays():
    assert fits_grid((-0.010, 0.0), HoleGrid(0.005)) and not fits_grid(
        (-0.010, 0.0), HoleGrid(0.003)
    )
    made = design(NESTED, holes=0.003, samples=1)
    says(made.off_grid, "p (-10, 0) mm", "--free both", "--origin -10:0")
    assert {cell.bands[0].p for cell in made.chain.levers} == {(-0.010, 0.0)}
    both = design(NESTED, holes=0.003, free="both", samples=1)
    assert not both.off_grid
    other = design(NESTED, holes=0.003, free="p", samples=1)
    says(other.off_grid, "q (10, 0) mm", "--free both")


@given(
    st.floats(0.0015, 0.006),
    st.tuples(st.floats(-0.02, -0.005), st.floats(-0.005, 0.005)),
    st.sampled_from(["q", "p"]),
)
@settings(max_examples=examples(8, full=60))
def test_a_grid_through_the_fixed_anchor_has_every_anchor_in_a_hole(pitch, at, free):
    p, q = (at, (0.010, 0.0)) if free == "q" else ((-0.010, 0.0), (-at[0], at[1]))
    fixed = p if free == "q" else q
    try:
        made = design(NESTED, holes=pitch, origin=fixed, free=free, p=p, q=q, samples=1)
    except Impossible as why:
        says(str(why), "through (")
        return
    assert not made.off_grid
    for cell in made.chain.levers:
        steps = (np.array([cell.bands[0].p, cell.bands[0].q]) - fixed) / pitch
        # A hole up to half a micrometre outside the area is moved onto its edge.
        assert np.abs(steps - np.round(steps)).max() <= 0.51e-6 / pitch


def test_a_grid_with_its_mirror_image_elsewhere_has_no_hole_for_both_anchors():
    with refuses(ValueError, "p = -q", "multiples of 1.5 mm"):
        design(NESTED, holes=0.003, origin=(-0.010, 0.0), free="both", samples=1)
    shifted = design(NESTED, holes=0.003, origin=(0.0015, 0.0), free="both", samples=1)
    assert not shifted.off_grid
    assert np.all(np.round(shifted.anchors[:, 0] / 0.0015) % 2 == 1)
    assert "--free both" not in design(NESTED, holes=0.003, origin=(0.001, 0), samples=1).off_grid
    with refuses(ValueError, "origin", "needs `holes`"):
        design(NESTED, origin=(0.001, 0.0))
    with refuses(ValueError, "origin", "finite"):
        design(NESTED, holes=0.003, origin=(0.0, math.inf))


def test_an_area_between_the_holes_is_refused_and_the_advice_works():
    between = AnchorBox(0.001, 0.004, -0.004, 0.004)
    with pytest.raises(ValueError, match=r"none is in AnchorBox.* 2\.5 mm apart"):
        design("0>1>0", within=between, holes=0.005, samples=1)
    assert len(drilled(between, HoleGrid(0.0025))) == 3
    assert design("0>1>0", within=between, holes=0.0025, samples=1).sequence == "0>1>0"


@given(
    st.lists(st.tuples(st.floats(0, 1), st.floats(0, 1)), min_size=3, max_size=6, unique=True),
    arrays(float, (8, 2), elements=st.floats(-0.5, 1.5)),
)
def test_the_nearest_place_in_a_polygon_is_in_it_and_none_on_its_sides_is_nearer(corners, q):
    try:
        polygon = AnchorPolygon(corners)
    except ValueError:
        return
    near = polygon.clamped(q)
    away = np.linalg.norm(near - q, axis=1)
    assert np.all(away[polygon.holds(q)] == 0.0)
    t = np.linspace(0, 1, 50)[:, None]
    ends = zip(corners, corners[1:] + corners[:1], strict=True)
    sides = np.concatenate([(1 - t) * a + t * np.array(b) for a, b in ends])
    nearest = np.min(np.linalg.norm(sides - q[:, None], axis=2), axis=1)
    assert np.all(away <= nearest + 1e-12)
    outside = ~polygon.holds(q)
    assert np.all(nearest[outside] <= away[outside] + 0.02 * math.sqrt(2))


def test_no_end_force_is_beyond_the_actuators():
    made = design(NESTED, most_force=0.4, samples=FEW)
    refuses_nothing(made, NESTED)
    assert np.all(np.abs(made.forces) <= 0.4)
    assert abs(made.chain.cycle().peak_force) <= 0.4 + 1e-9
    with refuses(Impossible, "band", "actuator", "stronger actuator") as refusal:
        design(NESTED, most_force=0.05, samples=FEW)
    # A lattice is not every place: this is no proof, and among holes it is.
    assert not refusal.value.proved
    assert "not found" in str(refusal.value)
    with pytest.raises(Impossible) as refusal:
        design(NESTED, most_force=0.05, holes=0.005, samples=FEW)
    assert refusal.value.proved


def test_bands_that_fold_back_are_left_out():
    with refuses(Impossible, "band", "falling force", "another band"):
        design(NESTED, within=AnchorBox(-0.03, -0.012, 0.0, 0.010))


def test_every_cell_is_proved_taut_and_concave_within_the_tolerances():
    from stepwell.concave import certify, simple

    wide = AnchorBox(-0.010, 0.020, -0.015, 0.015)
    made = design(NESTED, within=wide, tolerances=ROUGH, samples=FEW)
    for cell in made.chain.cells:
        numbers = simple(cell)
        assert numbers is not None
        assert certify(numbers, 2 * ROUGH.most.anchor)


@pytest.mark.slow
def test_the_catalogue_is_used_and_the_less_scattered_of_two_bands_is_taken():
    loose, tight = BandType(28.5, 0.010, 0.10, "loose"), BandType(28.5, 0.010, 0.01, "tight")
    made = design(NESTED, bands=(loose, tight), samples=FEW)
    assert made.yield_.tolerances.stiffness == 0.01
    # With bands of other strength there is more to choose from.
    nested = cycle(range(8), range(8))
    one = design(nested, bands=(BandType(),), tolerances=ROUGH, samples=5000)
    three = tuple(BandType(k) for k in (15.0, 28.5, 60.0))
    several = design(nested, bands=three, tolerances=ROUGH, samples=5000)
    assert {cell.bands[0].stiffness for cell in several.chain.levers} <= {15.0, 28.5, 60.0}
    assert several.yield_.fraction > one.yield_.fraction + 0.1


@pytest.mark.slow
def test_of_several_levers_one_is_chosen_for_all():
    made = design(NESTED, lever=(0.010, 0.018), within=PAPER_BOX, samples=FEW)
    assert len({cell.lever for cell in made.chain.levers}) == 1
    each = [design(NESTED, lever=r, within=PAPER_BOX, samples=FEW) for r in (0.010, 0.018)]
    assert any(np.array_equal(made.anchors, one.anchors) for one in each)
    assert "2 combinations" in made.method


@pytest.mark.slow
def test_unequal_levers_are_taken_only_if_the_engine_agrees():
    mixed = design(NESTED, lever=(0.012, 0.018), equal_levers=False, samples=FEW)
    refuses_nothing(mixed, NESTED)
    assert len({cell.lever for cell in mixed.chain.levers}) == 2
    assert mixed.robustness is None
    # A lever five times as long empties the short one in a snap; the next best is taken.
    made = design("00>10>11>01>00", lever=(0.004, 0.020), equal_levers=False, samples=FEW)
    refuses_nothing(made, "00>10>11>01>00")
    says(made.method, "simulation", "(00>10>01>11>01>10>00)")


@pytest.mark.parametrize("stiffness", [0.0, 5.0, 30.0, 500.0])
def test_the_cycle_is_verified_with_the_actuator_there_will_be(stiffness):
    made = design("000>010>011>111>110>010>000", actuator_stiffness=stiffness, samples=50)
    assert made.chain.actuator_stiffness == stiffness
    refuses_nothing(made, "000>010>011>111>110>010>000")
    assert made.robustness is None


@pytest.mark.slow
def test_if_the_engine_disagrees_nothing_is_sold_as_a_design(monkeypatch):
    from stepwell.design import targets as target

    real: Callable[..., sequences.Cycle] = target.cycle
    other = real(sw.Chain((paper_cell(0.0, 0.0), paper_cell(0.010, 0.0))))
    monkeypatch.setattr(target, "cycle", lambda chain: other)
    with refuses(Impossible, "00>01>11>10>00", "00>10>11>01>00", "simulation") as refusal:
        design("00>01>11>10>00", samples=1)
    assert not refusal.value.proved
    assert len(refusal.value.region) == 1


# Texts ---------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_region_holds_the_end_forces_of_all_allowed_anchors_and_no_others():
    made = design(NESTED, samples=FEW)
    (outline,) = made.region
    round_it = AnchorPolygon([tuple(point) for point in outline.tolist()[:-1]])
    rng = np.random.default_rng(0)
    q = rng.uniform((0, -0.015), (0.020, 0.015), (400, 2))
    inside = np.column_stack(holes_by_brute_force(q))
    hair = np.linalg.norm(round_it.clamped(inside) - inside, axis=1)
    assert np.all(hair < 1e-3)
    # Half a millimetre outside the box is outside.
    edge = np.linspace(-0.014, 0.014, 40)
    beyond = np.column_stack(holes_by_brute_force(np.column_stack([0.0205 + 0 * edge, edge])))
    assert not np.any(round_it.holds(beyond))
    assert np.all(round_it.holds(made.forces * 0.999 + 0.001 * inside.mean(axis=0)))


def test_a_design_tells_what_was_searched_and_what_it_stands_on():
    made = design(NESTED, samples=FEW)
    assert "local optimum" in made.method
    assert not made.proved
    assert "concave" in made.assumptions and "simulation" in made.assumptions
    assert repr(made).startswith(f"Design({NESTED}: q (")
    assert made.critical is made.yield_.critical
    text = str(made)
    says(text, "yield 100 %", "95 % confidence", " to ")
    assert made.robustness is not None
    says(text, "all anchors", f"{made.robustness.radius * 1e3:.4g} mm")
    assert all(f"{name}: q (" in text for name in made.chain.names)
    assert made.chain.title == f"Designed for {NESTED}"


# Orders as targets ----------------------------------------------------------------------------


def test_a_target_may_be_two_orders_by_number_or_name():
    full = design(order="2-1/1-2", samples=FEW)
    assert full.sequence == "00>01>11>01>00"
    assert design("outer-inner/inner-outer", samples=1).sequence == full.sequence
    for target in ("2-1/1-2", "outer-inner/inner-outer"):
        assert full.chain.yields(samples=FEW, target=target).target == full.sequence
        assert sw.check(full.chain, target, samples=FEW).meets_target


def test_a_loading_order_leaves_unloading_free():
    made = design(order=[2, 1], samples=FEW)
    assert made.loading == (1, 0)
    with refuses(ValueError, "2-1", "00>01>11", "2-1/2-1"):
        made.chain.yields(samples=FEW, target="2-1")


@pytest.mark.parametrize("target", ["2>1>3", "2-1-3", "2, 1, 3", "2 1 3"])
def test_an_order_that_is_no_sequence_is_refused_with_its_states(target):
    with refuses(ValueError, "2-1-3", "000>010>110>111") as refusal:
        checked_cycle(target, "111")
    # The advice holds: both forms that the message gives are accepted.
    states, orders = re.findall(r"'([^']+)'", str(refusal.value))[-2:]
    assert checked_cycle(states, "111") == checked_cycle(orders, "111") == states


@pytest.mark.parametrize(
    ("order", "fault"),
    [
        ("2-1-4", "cell 3 is missing"),
        ("2-2", "cell 2 appears twice"),
        ("0-1", "'0' is no cell"),
        ("1-", "number is missing"),
        ("2-1-3/1-2", "1-2: cell 3"),
        ("outer-middle", "'middle' is no cell"),
    ],
)
def test_a_wrong_order_is_refused_with_what_is_wrong(order, fault):
    with pytest.raises(ValueError, match=fault):
        design(order)


def test_an_order_for_other_cells_is_refused():
    with refuses(ValueError, "no cell 3"):
        checked_cycle("1-2-3/1-2-3", "11")


@pytest.mark.parametrize("order", [[2, 2], [1], "3-1", []])
def test_what_is_no_order_is_refused(order):
    with refuses(ValueError, "order", "[2, 1, 3]"):
        design(order=order)


def test_drawn_anchors_are_whole_micrometres():
    made = design(NESTED, samples=1)
    um = made.anchors * 1e6
    np.testing.assert_allclose(um, np.round(um), atol=1e-6)


@pytest.mark.slow
def test_progress_never_goes_back_and_arrives():
    calls: list[tuple[int, int]] = []
    design(
        states="all", cells=3, lever=(0.012, 0.014), samples=1, progress=lambda *c: calls.append(c)
    )
    done = [c[0] for c in calls]
    assert done == sorted(done)
    assert calls[-1][0] == calls[-1][1]
    assert len({c[1] for c in calls}) == 1


@pytest.mark.parametrize(
    ("how", "words"),
    [
        ({}, "give one target"),
        ({"sequence": NESTED, "states": ["0", "1"]}, "give one target"),
        ({"sequence": "00>10>11>01"}, "begins and ends with all cells at 0"),
        ({"sequence": "00>10>00"}, "includes the state with all at 1"),
        ({"sequence": "00>1>11>01>00"}, "must be 2 characters 0 or 1"),
        ({"sequence": "00-01-11"}, "write > between states, 00>01>11, or name each cell"),
        ({"sequence": "00>10>01>11>01>00"}, "one at a time"),
        ({"sequence": "000>110>111>011>001>000"}, "one at a time"),
        ({"sequence": ""}, "must be"),
        ({"states": "some"}, 'must be "all" or a list'),
        ({"states": "all"}, "give the number"),
        ({"states": ["00", "1"]}, "all of one length"),
        ({"states": []}, "must be states of 0 and 1"),
        ({"states": ["00", "10", "11"], "cells": 3}, "leave `cells` out"),
        ({"sequence": NESTED, "within": ()}, "must be an AnchorBox or an AnchorPolygon"),
        ({"sequence": NESTED, "within": (PAPER_BOX,) * 2}, "2 regions for 3 cells"),
        ({"sequence": NESTED, "holes": 0.0}, "pitch = 0.0 m: must be > 0"),
        ({"sequence": NESTED, "holes": 1e-9, "unusual": True}, "must make at most"),
        ({"sequence": NESTED, "bands": ()}, "must be one BandType or more"),
        ({"sequence": NESTED, "lever": -0.01}, "must be > 0"),
        ({"sequence": NESTED, "lever": ()}, "must be > 0"),
        ({"sequence": NESTED, "limit": 1.6}, "between 0 and π/2"),
        ({"sequence": NESTED, "p": (0.0, math.nan)}, "must be two finite numbers"),
        ({"sequence": NESTED, "tolerances": 0.001}, "must be Tolerances"),
        ({"sequence": NESTED, "objective": "best"}, "must be one of"),
        ({"sequence": NESTED, "most_force": 0.0}, "most_force = 0.0 N: must be > 0"),
        ({"sequence": NESTED, "samples": 0}, "samples = 0"),
        ({"sequence": NESTED, "actuator_stiffness": -1.0}, "actuator_stiffness"),
    ],
)
def test_a_wish_that_makes_no_sense_is_refused_with_advice(how, words):
    with pytest.raises(ValueError, match=words) as refusal:
        design(**how)
    assert not isinstance(refusal.value, Impossible)


@pytest.mark.parametrize(
    "make",
    [
        lambda: AnchorBox(0.02, 0.0, 0.0, 0.01),
        lambda: AnchorBox(0.0, math.inf, 0.0, 0.01),
        lambda: AnchorPolygon(((0, 0), (1, 1))),
        lambda: AnchorPolygon(((0, 0), (1, 1), (2, 2))),
        lambda: AnchorPolygon(((0, 0), (0, 0), (1, 0), (0, 1))),
        lambda: AnchorPolygon(((0, 0), (1, 0), (0, math.nan))),
        lambda: AnchorPolygon((1, 2, 3)),  # pyright: ignore[reportArgumentType]
        lambda: BandType(0.0),
        lambda: BandType(28.5, -0.01),
        lambda: BandType(28.5, 0.01, 0.5),
    ],
)
def test_regions_and_bands_that_cannot_be_are_refused(make):
    with pytest.raises(ValueError, match=r"must"):
        make()


def test_regions_and_bands_print_in_millimetres():
    assert repr(PAPER_BOX) == "AnchorBox(x 0..20, y -15..15 mm)"
    triangle = AnchorPolygon(((0, 0), (0.02, 0), (0, 0.01)))
    assert repr(triangle) == "AnchorPolygon((0, 0), (20, 0), (0, 10) mm)"
    named = BandType(28.5, 0.010, 0.05, "No. 8")
    assert repr(named) == "BandType('No. 8', k=28.5 N/m, ℓ0=10 mm, ±5 %)"
