"""A yield counts mechanisms as a workshop would make them, and counts each one right."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.special import ndtri
from scipy.stats import norm

import stepwell as sw
from chains import LEVER, LIMIT, any_chain, concave_chain
from facts import refuses, says
from sizes import examples
from stepwell.concave import ASK, DrawJudge
from stepwell.design.orders import numbered_cycle, orders_of
from stepwell.design.tolerances import draws as _draws, sensitivity, tally
from stepwell.design.tolerances.draws import Draws, Tolerances
from stepwell.design.tolerances.tally import NO_ANSWER, NOT_BUILT, TIED, simulated_outcomes
from stepwell.design.tolerances.yields import Yield, yields

CLOCKWISE = "00>10>11>01>00"
ALL = Tolerances(anchor=0.002, stiffness=0.08, rest_length=0.08, lever=0.0008, friction=0.05)


def cell(x: float, y: float = 0.0, **band) -> sw.Cell:
    return sw.Cell(sw.Band((-0.010, 0.0), (x * 1e-3, y * 1e-3), **band))


def leg() -> sw.Chain:
    return sw.Chain((cell(10), cell(14)))


def judged(draws: Draws, n: int):
    """Verdicts and the cycles they stand for, of the first n mechanisms."""
    judge = DrawJudge.of(draws.chain, draws.spread, np.tile(np.arange(len(draws.chain)), (2, 1)))
    assert judge is not None
    verdicts = [judge(piece) for piece in draws.chunks(n)]
    verdict = np.concatenate([f.verdict for f in verdicts])
    does = np.concatenate([f.does for f in verdicts])
    return verdict, [numbered_cycle(int(d), len(draws.chain)) for d in does]


def with_levers(chain: sw.Chain, rng: np.random.Generator) -> sw.Chain:
    cells = [replace(c, lever=c.lever * rng.uniform(0.6, 1.6)) for c in chain.levers]
    return replace(chain, cells=tuple(cells))


def with_friction(chain: sw.Chain, rng: np.random.Generator) -> sw.Chain:
    cells = [replace(c, friction=rng.choice([0.0, rng.uniform(0, 0.5)])) for c in chain.cells]
    return replace(chain, cells=tuple(cells))


# --- each mechanism is judged right -----------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("actuator", [math.inf, 200.0, 0.0])
@pytest.mark.parametrize("friction", [0.0, 0.05])
@pytest.mark.parametrize("lever", [0.0, 0.0008])
def test_every_mechanism_does_by_the_engine_what_the_closed_form_says(actuator, friction, lever):
    rng = np.random.default_rng(1)
    tolerances = replace(ALL, lever=lever, friction=friction)
    proved = 0
    for cells in (2, 3, 4, 6):
        chain = replace(concave_chain(rng, cells), actuator_stiffness=actuator)
        if friction:
            chain = with_friction(chain, rng)
        if lever:
            chain = with_levers(chain, rng)
        draws = Draws(chain, tolerances, 3)
        verdict, does = judged(draws, examples(25, full=1000))
        for number in np.flatnonzero(verdict != ASK).tolist():
            proved += 1
            assert str(draws.sample(number).cycle().sequence) == does[number]
    # A soft actuator and unequal travels together have no closed form.
    assert (proved > 0) == (lever == 0 or actuator != 200.0)


@pytest.mark.slow
@given(seed=st.integers(0, 2**32 - 1), cells=st.integers(2, 5))
def test_one_mechanism_of_any_concave_chain_is_judged_as_the_engine_does(seed, cells):
    rng = np.random.default_rng(seed)
    chain = with_friction(with_levers(concave_chain(rng, cells), rng), rng)
    draws = Draws(chain, ALL, seed % 97)
    verdict, does = judged(draws, 3)
    for number in np.flatnonzero(verdict != ASK).tolist():
        assert str(draws.sample(number).cycle().sequence) == does[number]


@pytest.mark.parametrize("seed", [0, 2])
def test_one_yield_whether_the_closed_form_counts_or_the_engine(seed):
    # With friction landings form a continuum, and half of these were once called ties.
    chain = concave_chain(np.random.default_rng([seed, 6]), 6)
    wanted = str(chain.cycle().sequence)
    tolerances = Tolerances(anchor=0.0003, rest_length=0.03, lever=0.0003, friction=0.05)
    draws = Draws(chain, tolerances, 0)
    verdict, says = judged(draws, 60)
    rows = np.concatenate([piece.copy() for piece in draws.chunks(60)])
    does = [*simulated_outcomes(draws, rows)]
    assert np.all(verdict != ASK)
    assert sum(text == wanted for text in does) == sum(text == wanted for text in says)


@pytest.mark.slow
@pytest.mark.parametrize("tolerances", [ALL, replace(ALL, lever=0.0, friction=0.0)])
def test_the_share_is_that_of_the_engine_run_on_the_same_mechanisms(tolerances):
    rng = np.random.default_rng(2)
    for cells in (2, 3, 4):
        result = yields(
            concave_chain(rng, cells), tolerances, samples=examples(80, full=4000), seed=5
        )
        done = [str(result.mechanism(i).cycle().sequence) for i in range(result.samples)]
        assert result.successes == done.count(result.target)
        for sequence, times in result.outcomes.items():
            assert done.count(sequence) == times
        assert result.successes + sum(result.outcomes.values()) == result.samples


def test_where_the_closed_form_is_not_proved_the_engine_decides():
    # Anchors that the tolerance brings to where the force no longer falls all the way.
    chain = sw.Chain((cell(-3, 4), cell(12)))
    result = yields(chain, Tolerances(anchor=0.004), samples=60)
    assert 0 < result.by_engine < result.samples
    done = [str(result.mechanism(i).cycle().sequence) for i in range(result.samples)]
    assert result.successes == done.count(result.target)
    says(str(result), f"{result.by_engine} by simulation")


@pytest.mark.slow
def test_an_independent_formula_finds_the_same_orders():
    # Draws, tolerances and forces written anew, after the docstrings alone.
    rng = np.random.default_rng(4)
    n = examples(2000)
    for cells in (2, 3, 4):
        chain = concave_chain(rng, cells)
        tolerances = Tolerances(0.001, 0.05, 0.03, friction=0.05)
        u = np.random.Generator(np.random.PCG64(9)).random((n, 8 * cells))
        area, angle, area_q, angle_q = (u[:, i : 4 * cells : 4] for i in range(4))

        def z(block: int, u=u, cells=cells) -> np.ndarray:
            low = norm.cdf(-4)
            return ndtri(low + u[:, block * cells : (block + 1) * cells] * (1 - 2 * low))

        away_p, away_q = 0.001 * np.sqrt(area), 0.001 * np.sqrt(area_q)
        d = np.array([c.bands[0].d for c in chain.levers])
        dx = d[:, 0] + away_q * np.cos(2 * np.pi * angle_q) - away_p * np.cos(2 * np.pi * angle)
        dy = d[:, 1] + away_q * np.sin(2 * np.pi * angle_q) - away_p * np.sin(2 * np.pi * angle)
        k = np.array([c.bands[0].stiffness for c in chain.levers]) * (1 + 0.05 * z(4))
        rest = np.array([c.bands[0].rest_length for c in chain.levers]) * (1 + 0.03 * z(5))
        rub = 0.05 * u[:, 7 * cells :]

        def force(theta: float, dx=dx, dy=dy, k=k, rest=rest) -> np.ndarray:
            length = np.hypot(LEVER * math.cos(theta) + dx, LEVER * math.sin(theta) + dy)
            return k * (1 - rest / length) * (dy - dx * math.tan(theta))

        loading = np.argsort(force(-LIMIT) + rub, axis=1)
        unloading = np.argsort(rub - force(LIMIT), axis=1)
        verdict, does = judged(Draws(chain, tolerances, 9), n)
        proved = verdict != ASK
        assert np.mean(proved) > 0.5
        for i in np.flatnonzero(proved):
            orders = orders_of(does[i])
            assert orders is not None
            assert orders.tolist() == [loading[i].tolist(), unloading[i].tolist()]


def test_cells_in_another_order_change_nothing_but_their_names():
    # The same parts in other places along the chain: series order does not matter.
    rng = np.random.default_rng(6)
    chain = concave_chain(rng, 4)
    order = [2, 0, 3, 1]
    other = replace(chain, cells=tuple(chain.cells[i] for i in order))
    draws, moved = Draws(chain, ALL, 0), Draws(other, ALL, 0)
    wanted = orders_of(str(chain.cycle().sequence))
    assert wanted is not None
    here = DrawJudge.of(chain, draws.spread, wanted)
    renamed = np.array([[order.index(i) for i in side] for side in wanted])
    there = DrawJudge.of(other, moved.spread, renamed)
    assert here is not None and there is not None
    piece = next(draws.chunks(2000)).copy()
    columns = [4 * i + j for i in order for j in range(4)]
    columns += [4 * block + i for block in (4, 5, 6, 7) for i in order]
    a, b = here(piece), there(np.ascontiguousarray(piece[:, columns]))
    np.testing.assert_array_equal(a.verdict, b.verdict)
    np.testing.assert_array_equal(a.gap, b.gap)
    np.testing.assert_array_equal(a.wrong, b.wrong)


# --- the share is a probability ---------------------------------------------------------------


def test_the_interval_covers_a_probability_known_on_paper():
    # Both bands straight: F1 = -F0 in each cell, so one comparison of two normal forces decides.
    chain = leg()
    a, b = (c.force_0 for c in chain.levers)
    truth = norm.cdf((b - a) / (0.12 * math.hypot(a, b)))
    assert 0.8 < truth < 0.99
    result = yields(chain, Tolerances(stiffness=0.12), samples=examples(200_000))
    assert result.target == CLOCKWISE
    low, high = result.interval
    assert low < result.fraction < high and low < truth < high
    assert list(result.outcomes) == ["00>01>11>10>00"]


@pytest.mark.slow
def test_nineteen_intervals_in_twenty_cover_it():
    times = examples(80, full=200)
    chain = leg()
    a, b = (c.force_0 for c in chain.levers)
    truth = norm.cdf((b - a) / (0.12 * math.hypot(a, b)))
    covered = 0
    for seed in range(times):
        low, high = yields(chain, Tolerances(stiffness=0.12), samples=500, seed=seed).interval
        covered += low <= truth <= high
    assert covered >= 0.925 * times


def test_exact_parts_always_work():
    rng = np.random.default_rng(7)
    for cells in (1, 2, 3):
        result = yields(concave_chain(rng, cells), Tolerances(), samples=1000)
        assert result.fraction == 1.0 and not result.outcomes
        assert result.interval[1] == 1.0 and 0.99 < result.interval[0] < 1.0


def test_wider_tolerances_yield_less():
    shares = [
        yields(leg(), Tolerances(anchor=r), samples=20_000).fraction for r in (0.001, 0.003, 0.006)
    ]
    assert shares[0] > shares[1] > shares[2]


def test_two_equal_cells_do_either_thing():
    chain = sw.Chain((cell(10), cell(10)))
    result = yields(chain, Tolerances(stiffness=0.05), samples=20_000, target=CLOCKWISE)
    assert result.interval[0] < 0.5 < result.interval[1]
    says(yields(chain, Tolerances(stiffness=0.05), samples=10).assumptions, "nominal", "tie")


def test_a_tie_is_no_success():
    result = yields(sw.Chain((cell(10), cell(10))), Tolerances(), samples=100, target=CLOCKWISE)
    assert result.successes == 0 and dict(result.outcomes) == {TIED: 100}


# --- the same seed, the same mechanisms -------------------------------------------------------


def test_the_same_seed_gives_the_same_answer():
    first, again = (yields(leg(), ALL, samples=3000, seed=8) for _ in range(2))
    assert (first.successes, first.outcomes) == (again.successes, again.outcomes)
    other = yields(leg(), ALL, samples=3000, seed=9)
    assert (first.successes, first.outcomes) != (other.successes, other.outcomes)


def test_more_mechanisms_keep_the_first_ones_however_they_are_cut(monkeypatch):
    draws = Draws(leg(), ALL, 1)
    few = np.concatenate([piece.copy() for piece in draws.chunks(700)])
    monkeypatch.setattr(_draws, "_AT_ONCE", 1700)
    many = np.concatenate([piece.copy() for piece in draws.chunks(2000)])
    np.testing.assert_array_equal(few, many[:700])
    for number in (0, 1, 699, 1999):
        made, rebuilt = draws.sample(number), draws.built(many[number])
        assert made == rebuilt


def test_a_part_keeps_its_numbers_whichever_tolerances_are_given():
    one = Draws(leg(), Tolerances(anchor=0.001), 2).sample(5)
    more = Draws(leg(), Tolerances(anchor=0.001, stiffness=0.05, friction=0.1), 2).sample(5)
    assert [c.bands[0].q for c in one.levers] == [c.bands[0].q for c in more.levers]
    assert [c.bands[0].stiffness for c in one.levers] != [c.bands[0].stiffness for c in more.levers]


@pytest.mark.slow
def test_parts_are_distributed_as_the_tolerances_say():
    chain = sw.Chain((sw.Cell((cell(10).bands[0], cell(12).bands[0])), cell(14)))
    draws = Draws(chain, ALL, 0)
    made = [draws.sample(i) for i in range(2000)]
    drawn = [b for c in chain.levers for b in c.bands]
    most = ALL.most
    for number, band in enumerate(drawn):
        bands = [[b for c in m.levers for b in c.bands][number] for m in made]
        for end in ("p", "q"):
            off = np.array([getattr(b, end) for b in bands]) - getattr(band, end)
            away = np.hypot(*off.T)
            assert away.max() <= most.anchor
            # Even over the disc: mean square R²/2, no direction preferred.
            assert np.mean(away**2) == pytest.approx(most.anchor**2 / 2, rel=0.04)
            assert np.all(np.abs(off.mean(0)) < 0.06 * most.anchor)
        for part, spread in (("stiffness", most.stiffness), ("rest_length", most.rest_length)):
            ratio = np.array([getattr(b, part) for b in bands]) / getattr(band, part) - 1
            assert np.std(ratio) == pytest.approx(spread, rel=0.06)
            assert np.max(np.abs(ratio)) <= 4 * spread * (1 + 1e-12)
    for i, c in enumerate(chain.levers):
        lever = np.array([m.levers[i].lever for m in made]) - c.lever
        friction = np.array([m.cells[i].friction for m in made])
        assert np.max(np.abs(lever)) <= most.lever and abs(np.mean(lever)) < 0.06 * most.lever
        assert np.std(lever) == pytest.approx(most.lever / math.sqrt(3), rel=0.05)
        assert friction.min() >= 0 and friction.max() <= most.friction
        assert np.mean(friction) == pytest.approx(most.friction / 2, rel=0.06)


# --- chains without a closed form -------------------------------------------------------------


def test_chains_without_a_closed_form_go_to_the_engine_whole():
    rng = np.random.default_rng(11)
    for _ in range(examples(4)):
        chain = any_chain(rng, 2)
        if DrawJudge.of(chain, np.zeros((2, 5)), np.zeros((2, 2), np.int64)) is not None:
            continue
        result = yields(chain, replace(ALL, lever=0.0002), samples=12)
        assert result.by_engine == 12 and result.critical is None
        says(result.assumptions, "all 12", "simulated")
        draws = Draws(chain, replace(ALL, lever=0.0002), 0)
        done = [*simulated_outcomes(draws, next(draws.chunks(12)))]
        assert result.successes == done.count(result.target)


def test_what_cannot_be_built_or_followed_is_a_failure_with_a_name():
    # A measured force with more noise than the engine follows.
    zigzag = tuple(0.01 * (i % 2) + 1e-4 * i for i in range(8000))
    extension = np.linspace(0, 0.04, len(zigzag)).tolist()
    rubber = sw.Band.from_table((-0.010, 0.0), (0.010, 0.0), 0.01, extension, zigzag)
    result = yields(
        sw.Chain((sw.Cell(rubber), cell(20))), Tolerances(), samples=3, target=CLOCKWISE
    )
    assert dict(result.outcomes) == {NO_ANSWER: 3}
    # A spring that may push, and whose ends meet if q is off by half a millimetre.
    spring = sw.Band((0.0, 0.0), (-LEVER - 0.0005, 0.0), rest_length=0.005, two_sided=True)
    draws = Draws(sw.Chain((sw.Cell(spring), cell(20))), Tolerances(anchor=0.001), 0)
    unlucky = np.zeros(draws.columns)
    unlucky[2] = 0.25
    assert [*simulated_outcomes(draws, unlucky[None])] == [NOT_BUILT]


@pytest.mark.slow
def test_chains_too_long_to_tell_orders_apart_still_count_successes():
    rng = np.random.default_rng(12)
    chain = concave_chain(rng, 12)
    result = yields(chain, Tolerances(stiffness=0.001), samples=40)
    done = [str(result.mechanism(i).cycle().sequence) for i in range(result.samples)]
    assert result.successes == done.count(result.target)
    assert sum(result.outcomes.values()) == result.samples - result.successes
    assert len(repr(result)) < 400


def test_rare_outcomes_are_counted_as_one(monkeypatch):
    monkeypatch.setattr(tally, "_MOST_OUTCOMES", 3)
    chain = sw.Chain([cell(x) for x in (10, 10.2, 10.4, 10.6)])
    result = yields(chain, Tolerances(stiffness=0.1), samples=500)
    assert len(result.outcomes) == 4 and list(result.outcomes)[-1] == tally.ANOTHER
    assert result.successes + sum(result.outcomes.values()) == 500


# --- what is wanted ---------------------------------------------------------------------------


def test_a_sequence_that_the_drawing_does_not_do_may_be_wanted():
    result = yields(leg(), Tolerances(anchor=0.0005), samples=500, target="00>01>11>10>00")
    assert result.fraction == 0.0 and dict(result.outcomes) == {CLOCKWISE: 500}
    assert result.critical is not None and result.critical.fraction == 1.0
    with_spaces = yields(leg(), Tolerances(), samples=5, target="00 > 10 > 11 > 01 > 00")
    assert with_spaces.fraction == 1.0 and with_spaces.target == CLOCKWISE


def test_two_cells_at_once_is_no_cycle_of_concave_cells():
    result = yields(leg(), ALL, samples=500, target="00>11>00")
    assert result.fraction == 0.0 and result.critical is None
    assert CLOCKWISE in result.outcomes


@pytest.mark.parametrize(
    ("wanted", "advice"),
    [
        ("00>10>1>01>00", "2 characters 0 or 1"),
        ("000>100>110>111>110>100>000", "2 characters 0 or 1"),
        ("00>1x>11>01>00", "'1x' must be"),
        ("", "2 characters 0 or 1"),
        ("00>10>11", "begins and ends with all cells at 0"),
        ("00>10>00", "includes the state with all at 1"),
        ("00>10>10>11>01>00", "twice in a row"),
    ],
)
def test_a_sequence_that_is_no_full_cycle_is_refused_with_an_example(wanted, advice):
    with pytest.raises(ValueError, match=advice) as refused:
        yields(leg(), Tolerances(), target=wanted)
    assert "'00>10>11>01>00'" in str(refused.value)


@pytest.mark.parametrize(
    ("arguments", "advice"),
    [
        ({"samples": 0}, "samples = 0: must be a whole number >= 1"),
        ({"samples": 2.5}, "samples = 2.5"),
        ({"seed": -1}, "seed = -1"),
        ({"tolerances": 0.05}, "must be Tolerances, for example"),
        ({"tolerances": Tolerances(lever=0.02)}, "must be smaller than the lever of"),
        ({"sensitivity": True, "target": "00>11>00"}, "changes one cell per step"),
    ],
)
def test_what_cannot_be_meant_is_refused_with_advice(arguments, advice):
    arguments = {"tolerances": Tolerances(), **arguments}
    with pytest.raises(ValueError, match=advice):
        yields(leg(), arguments.pop("tolerances"), **arguments)


# --- which cells, which parts -----------------------------------------------------------------


@pytest.mark.slow
def test_the_critical_pair_is_the_one_that_changes_places_most_often():
    chain = sw.Chain([cell(x) for x in (10, 14, 14.6, 19)])
    result = yields(chain, Tolerances(stiffness=0.03), samples=examples(300, full=1000))
    critical = result.critical
    assert critical is not None
    assert {critical.first, critical.second} == {1, 2}
    # Straight bands: F1 = -F0, so loading and unloading go wrong together, by the same factor.
    forces = result.end_forces(result.samples)
    assert critical.fraction == np.mean(forces[:, 1, 0] > forces[:, 2, 0])
    assert critical.names == ("cell 2", "cell 3") or critical.names == ("cell 3", "cell 2")
    says(str(critical), "cell ", "cell ", critical.way, "%", "reverse")


def test_where_nothing_fails_the_critical_pair_is_the_nearest():
    critical = yields(
        sw.Chain([cell(x) for x in (10, 14, 15)]), Tolerances(1e-5), samples=50
    ).critical
    assert critical is not None
    assert critical.fraction == 0.0 and critical.narrowest > 0.3
    assert {critical.first, critical.second} == {1, 2}
    assert yields(sw.Chain((cell(10),)), Tolerances(1e-5), samples=5).critical is None


def test_sensitivities_of_two_stiffnesses_are_those_on_paper():
    # The gap of straight bands is k2 b - k1 a: additive, each share is its own variance.
    chain = leg()
    indices = yields(chain, Tolerances(stiffness=0.05), samples=10, sensitivity=True).sensitivities
    assert indices is not None
    a, b = (c.force_0 for c in chain.levers)
    shares = np.array([a * a, b * b]) / (a * a + b * b)
    assert indices.parameters == ("inner.stiffness", "outer.stiffness")
    np.testing.assert_allclose(indices.first_order, shares, atol=0.01)
    np.testing.assert_allclose(indices.total, shares, atol=0.01)
    assert indices.deviation == pytest.approx(0.05 * math.hypot(a, b), rel=0.01)


def test_sensitivities_share_out_the_variance_and_rank_the_obvious_first():
    chain = sw.Chain((cell(10), replace(cell(16), name="far")))
    tolerances = Tolerances(0.0001, stiffness=0.1, rest_length=0.001, lever=1e-6, friction=1e-4)
    indices = yields(chain, tolerances, samples=10, sensitivity=True).sensitivities
    assert indices is not None
    assert len(indices.parameters) == 10 and "far.d" in indices.parameters
    order = np.argsort(-indices.total)
    assert [indices.parameters[i] for i in order[:2]] == ["far.stiffness", "inner.stiffness"]
    assert np.all(indices.first_order > -0.02) and np.all(indices.total > -0.02)
    assert 0.9 < indices.first_order.sum() < 1.02 and indices.total.sum() > 0.98
    assert str(indices).startswith("far.stiffness: 0.")
    assert "and 4 more" in str(indices)


def test_sensitivities_do_not_depend_on_how_often_a_mechanism_is_made():
    few, many = (yields(leg(), ALL, samples=n, sensitivity=True).sensitivities for n in (1, 500))
    assert few is not None and many is not None
    np.testing.assert_array_equal(few.total, many.total)


def test_a_gap_that_does_not_vary_is_said_to():
    still = yields(leg(), Tolerances(), samples=5, sensitivity=True).sensitivities
    assert still is not None
    assert still.deviation == 0.0 and still.parameters == ()
    assert "does not vary" in str(still) and "does not vary" in repr(still)
    # A rest length of nothing has no spread either.
    chain = sw.Chain((cell(10, rest_length=0.0), cell(14, rest_length=0.0)))
    none = yields(chain, Tolerances(rest_length=0.1), samples=5, sensitivity=True).sensitivities
    assert none is not None
    assert none.deviation == 0.0 and np.all(none.total == 0.0) and len(none.parameters) == 2


def test_a_single_cell_has_no_gap_to_vary():
    alone = yields(
        sw.Chain((cell(10),)), Tolerances(0.001), samples=5, sensitivity=True
    ).sensitivities
    assert alone is not None and alone.deviation == 0.0 and "does not vary" in str(alone)


def test_cells_of_one_name_are_distinguished_by_number():
    chain = sw.Chain([replace(cell(x), name="leg") for x in (10, 14)])
    indices = yields(chain, Tolerances(lever=1e-4), samples=5, sensitivity=True).sensitivities
    assert indices is not None and indices.parameters == ("1.lever", "2.lever")


# --- the result -------------------------------------------------------------------------------


def full_result() -> Yield:
    return yields(leg(), ALL, samples=400, sensitivity=True)


def test_a_result_reads_like_a_sentence():
    result = full_result()
    text = str(result)
    says(text, "400 samples", CLOCKWISE, "95 % confidence")
    says(text, "critical: ", "variance", "independent parameters: ")
    assert repr(result).startswith(f"Yield({CLOCKWISE}: ")
    assert "100 %" in str(yields(leg(), Tolerances(), samples=5))
    # Rounding must not turn nearly certain into certain.
    nearly = yields(leg(), Tolerances(stiffness=0.06), samples=20_000)
    assert 0.9999 > nearly.fraction > 0.99
    assert "100.00 %" not in str(nearly)


@pytest.mark.slow
def test_a_result_can_be_kept(tmp_path):
    result = full_result()
    result.to_csv(tmp_path / "yield.csv")
    lines = (tmp_path / "yield.csv").read_text().splitlines()
    assert lines[0] == "outcome,count,fraction_1"
    assert lines[1].startswith(f"{CLOCKWISE},{result.successes},")
    data = result.to_xarray()
    assert int(data["count"].sum()) == 400
    assert str(data.outcome.values[0]) == CLOCKWISE
    assert result.sensitivities is not None
    assert tuple(data.parameter.values) == result.sensitivities.parameters
    assert data.attrs["fraction"] == result.fraction
    data.to_netcdf(tmp_path / "yield.nc", engine="scipy")


@pytest.mark.slow
def test_clouds_are_the_forces_at_which_cells_let_go():
    result = full_result()
    cloud = result.end_forces(20)
    assert cloud.shape == (20, 2, 2)
    for i in (0, 7, 19):
        for c, (up, down) in zip(result.mechanism(i).levers, cloud[i], strict=True):
            assert (up, down) == (c.force_0 + c.friction, c.force_1 - c.friction)
    assert result.end_forces(10_000).shape == (400, 2, 2)


def test_only_mechanisms_that_were_made_can_be_looked_at():
    with refuses(ValueError, "number = 400", "0 and 399"):
        full_result().mechanism(400)


def test_progress_rises_to_all():
    calls: list[tuple[int, int]] = []
    chain = sw.Chain((cell(-3, 4), cell(12)))
    yields(chain, Tolerances(anchor=0.004), samples=40, progress=lambda a, b: calls.append((a, b)))
    done = [a for a, _ in calls]
    assert done == sorted(done) and calls[-1] == (40, 40) and len(calls) > 1
    assert {b for _, b in calls} == {40}


# --- what one stroke cannot do, and cells that have no closed form ----------------------------


@pytest.mark.parametrize(
    ("wanted", "words"),
    [
        ("00>11>00", "00>11 moves 2 cells at once"),
        ("00>10>01>11>00", "from 10 to 01 the stroke does not rise"),
        ("00>10>11>10>01>00", "from 10 to 01 the stroke does not fall"),
        ("00>10>11>00", "11>00 moves 2 cells at once"),
    ],
)
def test_a_cycle_that_one_stroke_cannot_make_says_so_and_what_to_ask(wanted, words):
    result = yields(leg(), Tolerances(anchor=0.0003), samples=50, target=wanted)
    assert result.fraction == 0.0
    says(result.advice, "one full cycle", "cannot")
    assert words in result.advice and result.advice in str(result)
    assert "stepwell program" in result.advice


def test_any_other_cycle_that_none_makes_comes_with_one_that_the_drawing_makes():
    result = yields(leg(), Tolerances(anchor=0.0003), samples=50, target="00>01>11>10>00")
    says(result.advice, "such as", CLOCKWISE, "nominal")
    assert "cannot" not in result.advice
    assert yields(leg(), Tolerances(anchor=0.0003), samples=50).advice == ""


def test_cells_that_move_together_are_not_reported_as_impossible():
    rising = sw.Cell(sw.Band((0.0, 0.0), (-0.009, 0.012), 30.0, 0.0))
    stiffer = sw.Cell(sw.Band((0.0, 0.0), (-0.009, 0.012), 31.0, 0.0))
    pair = sw.Chain((rising, stiffer))
    result = yields(pair, Tolerances(anchor=0.0002), samples=5, target=CLOCKWISE)
    assert result.by_engine == 5
    assert "cells of falling force" not in result.advice


def tables(rest: float = 0.010) -> sw.Chain:
    """A pair whose bands are measured, at more and more extension by Hooke's law."""
    extension = [0.0, 0.010, 0.020, 0.040]
    band = [
        sw.Band.from_table((-0.010, 0.0), (x, 0.0), rest, extension, [28.5 * e for e in extension])
        for x in (0.010, 0.014)
    ]
    return sw.Chain([sw.Cell(one) for one in band])


@pytest.mark.slow
def test_sensitivities_of_cells_with_a_table_are_those_of_the_law_that_it_holds(monkeypatch):
    monkeypatch.setattr(sensitivity, "_POWER_BUILT", examples(9, full=10))
    tolerances = Tolerances(anchor=0.002, stiffness=0.05, rest_length=0.02)
    indices = yields(tables(), tolerances, samples=20, sensitivity=True).sensitivities
    closed = yields(leg(), tolerances, samples=20, sensitivity=True).sensitivities
    assert indices is not None and closed is not None
    assert indices.parameters == closed.parameters
    assert (indices.points, closed.points) == (2 ** examples(9, full=10), 4096)
    np.testing.assert_allclose(indices.first_order, closed.first_order, atol=0.06)
    np.testing.assert_allclose(indices.total, closed.total, atol=0.06)
    assert indices.deviation == pytest.approx(closed.deviation, rel=0.05)
    assert closed.agreed is None
    assert indices.agreed == 1.0
    says(str(indices), "gap", "simulation", "100.0 %")


@pytest.mark.slow
def test_parts_of_several_bands_in_a_cell_are_one_part(monkeypatch):
    monkeypatch.setattr(sensitivity, "_POWER_BUILT", examples(7, full=10))
    two = sw.Cell((*cell(10).bands, *cell(12).bands))
    chain = sw.Chain((two, cell(18)), 100.0)
    indices = yields(chain, Tolerances(stiffness=0.05), samples=5, sensitivity=True).sensitivities
    assert indices is not None
    assert indices.parameters == ("inner.stiffness", "outer.stiffness")
    assert np.all(indices.total > 0.05)
    assert indices.first_order.sum() == pytest.approx(1.0, abs=0.1)
