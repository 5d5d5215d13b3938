"""Whether a snap lands where it does for other mobilities: replayed, proved, sampled."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binom

import stepwell as sw
from chains import any_cell, any_chain, contest
from facts import says
from sizes import examples
from stepwell.statics import EventKind, Landing, OtherLanding, Proof
from stepwell.statics.following.snap import COARSE
from stepwell.statics.landings.proofs import goes_one_way
from stepwell.statics.landings.sampling import corners_of, factors_of, land_all
from stepwell.statics.landings.start import snaps_of

PAPER = sw.Cell(sw.Band((-0.010, 0.0), (0.010, 0.0)))
# Its last snap leaves the inner cell or the outer one in transit: whichever is quicker to go.
RACE = sw.Chain(
    [PAPER.with_anchors(q=(x * 1e-3, y * 1e-3)) for x, y in ((10, 3), (22, 7), (13, 1))]
)

# `right` is slow: about one in twenty of mobilities up to 4.5 apart make it win a race.
RARE = contest(mobility=0.5).cycle().path


def snaps(path):
    return [event for event in path.events if event.kind is EventKind.SNAP]


def starts(path):
    return list(
        snaps_of(path._problem, path._log, np.array(path.start), np.array(path.start_sheet))
    )


def any_element(rng):
    """A straight rise, a straight fall and a straight rise, or such a curve folded back."""
    top = rng.uniform(0.5e-3, 3e-3)
    bottom = top + rng.uniform(1e-3, 6e-3)
    peak, valley = rng.uniform(0.2, 1.0), rng.uniform(-1.0, 0.1)
    s, force = np.array([0.0, top, bottom, bottom + top]), np.array([0.0, peak, valley, peak])
    rub = rng.uniform(0.01, 0.1) if rng.random() < 0.2 else 0.0
    if rng.random() < 0.6:
        return sw.Element.from_points(s, force, friction=rub)
    # A spring in series, softer than the fall is steep, folds it back.
    more = 4.0 * top * (peak - valley) / peak
    dense = np.linspace(-more, bottom + more, 400)
    ends = (
        [-more, *s[:3], bottom + more],
        [-more * peak / top, *force[:3], valley + more * peak / top],
    )
    curve = np.interp(dense, *ends)
    softness = rng.uniform(1.2, 3.0) * (bottom - top) / (peak - valley)
    return sw.Element.from_curve(dense + softness * curve, curve, friction=rub)


def mixed(seed):
    """A chain of anything, under a stroke, a spring or a force, each cell with its mobility."""
    rng = np.random.default_rng([14, seed])
    kinds = rng.random(int(rng.integers(2, 7)))
    cells = [any_cell(rng) if kind < 0.5 else any_element(rng) for kind in kinds]
    spread = float(rng.choice([1.0, 10.0, 100.0]))
    cells = [replace(cell, mobility=spread ** rng.uniform(-0.5, 0.5)) for cell in cells]
    stiffness = (math.inf, math.inf, 200.0, 30.0, 0.0)[seed % 5]
    return sw.Chain(cells, actuator_stiffness=stiffness), rng


def paths(seeds):
    """A cycle of each of many chains, and a path that turns back at random."""
    for seed in seeds:
        chain, rng = mixed(seed)
        try:
            cycle = chain.cycle().path
            yield cycle
            low, high = min(cycle.turning_points), max(cycle.turning_points)
            begin = cycle.turning_points[0]
            yield chain.path([begin, *rng.uniform(low, high, 4)])
        except sw.StepwellError:
            continue


# --- replay --------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_snap_done_again_lands_where_the_path_did():
    again = apart = 0
    for path in paths(range(examples(20, full=800))):
        full = path._problem.laws.full
        for snap in starts(path):
            landed = land_all(path._problem, snap.start, np.ones((1, len(full))))
            again += 1
            same = landed.settled[0] and np.array_equal(landed.sheet[0], snap.sheet)
            apart += not same or np.max(np.abs(landed.travel[0] - snap.travel) / full) > 1e-9
    assert again > 50
    assert apart <= 1e-3 * again


@pytest.mark.slow
@pytest.mark.parametrize("name", ["four-shuffle", "countdown", "curved-beam", "friction", "slack"])
def test_the_snaps_of_a_preset_done_again_land_where_they_did(name):
    path = sw.files.load(f"preset:{name}").chain.cycle().path
    for snap in starts(path):
        landed = land_all(path._problem, snap.start, np.ones((1, len(path.chain))))
        assert landed.travel[0] == pytest.approx(snap.travel, abs=1e-15)


def test_looking_at_landings_leaves_the_path_as_it_was():
    path, same = RACE.cycle().path, RACE.cycle().path
    path.landings()
    assert path == same
    assert np.array_equal(path.travel, same.travel)
    assert path.resampled(5) == same.resampled(5)


# --- what samples find ---------------------------------------------------------------------------


def test_a_landing_that_hangs_on_mobilities_is_found_with_mobilities_that_lead_elsewhere():
    path = RACE.cycle().path
    landings = path.landings()
    assert [landing.event for landing in landings] == snaps(path)
    assert [landing.holds for landing in landings] == [True, True, True, False]
    (there,) = landings[-1].elsewhere
    assert there.state == "00-"
    assert there.mobility == pytest.approx([1.0, 10.0, 10.0])
    # About one in twenty of mobilities at random; corners do not count.
    assert 0.01 < there.fraction < 0.2


@pytest.mark.slow
def test_a_chain_with_the_mobilities_that_were_found_lands_where_they_say():
    looked = 0
    for seed in range(examples(20, full=800)):
        chain = any_chain(np.random.default_rng(seed), 4, friction=False)
        path = chain.cycle().path
        own = starts(path)
        for k, landing in enumerate(path.landings(bound=0.2)):
            for there in landing.elsewhere:
                moved = with_mobility(chain, there.mobility).cycle().path
                others = starts(moved)
                # An earlier landing may hang on these mobilities as well.
                if len(others) > k and same_place(others[k].start, own[k].start):
                    looked += 1
                    assert others[k].travel == pytest.approx(there.travel, abs=1e-8)
    assert looked > 3


def with_mobility(chain, mobility):
    cells = zip(chain.cells, mobility, strict=True)
    return replace(chain, cells=[replace(cell, mobility=times) for cell, times in cells])


def same_place(one, two):
    return np.allclose(one.travel, two.travel, rtol=0.0, atol=1e-9) and one.drive == two.drive


def test_given_mobilities_are_where_the_factors_begin():
    given = (1.0, 10.0, 10.0)
    landing = with_mobility(RACE, given).cycle().path.landings(1.0)[-2]
    assert landing.holds
    (there,) = with_mobility(RACE, given).cycle().path.landings(10.0)[-2].elsewhere
    assert there.state == "-00"


@pytest.mark.slow
def test_a_ratio_of_one_finds_nothing_but_the_landing_itself():
    for path in paths(range(12)):
        assert all(landing.holds for landing in path.landings(1.0, bound=0.5))


def test_the_same_seed_tries_the_same_mobilities():
    path = RACE.cycle().path
    assert path.landings(seed=3) == path.landings(seed=3)
    assert path.landings(seed=3)[-1] != path.landings(seed=4)[-1]


def test_random_mobilities_are_log_uniform_within_the_ratio():
    factors = factors_of(5, 10.0, 4000, 0)
    assert factors.shape == (4000, 5)
    assert np.min(factors) >= 1.0 and np.max(factors) <= 10.0
    share = np.log10(factors)
    assert np.mean(share, axis=0) == pytest.approx(0.5, abs=0.02)
    assert np.std(share, axis=0) == pytest.approx(12**-0.5, abs=0.02)
    assert np.array_equal(factors[:7], factors_of(5, 10.0, 7, 0))


@pytest.mark.parametrize("count", [2, 3, 5])
def test_of_few_cells_all_corners_of_the_range_are_tried(count):
    corners = corners_of(np.array([0, 1]), count, 10.0, 0)
    assert len({tuple(row) for row in corners.tolist()}) == len(corners) == 2**count - 2
    assert set(corners.ravel().tolist()) == {1.0, 10.0}


def test_of_more_cells_each_is_fast_alone_and_slow_alone_first():
    corners = corners_of(np.array([1, 3]), 6, 10.0, 0)
    assert corners.shape == (32, 6)
    assert set(corners.ravel().tolist()) == {1.0, 10.0}
    assert corners[:4].tolist() == [
        [1, 10, 1, 1, 1, 1],
        [1, 1, 1, 10, 1, 1],
        [10, 1, 10, 10, 10, 10],
        [10, 10, 10, 1, 10, 10],
    ]
    assert not np.array_equal(corners, corners_of(np.array([1, 3]), 6, 10.0, 1))
    assert corners_of(np.arange(40), 40, 10.0, 0).shape == (32, 40)


# --- what samples are worth ----------------------------------------------------------------------


@pytest.mark.parametrize(("bound", "samples"), [(0.5, 5), (0.1, 29), (0.05, 59), (0.01, 299)])
def test_samples_that_agree_are_as_many_as_the_bound_needs(bound, samples):
    held = RARE.landings(2.0, bound=bound)[1]
    assert (held.holds, held.samples) == (True, samples)
    assert 0.9 * bound < held.bound <= bound
    # By hand: with that share elsewhere, one time in twenty none of the samples shows it.
    assert (1.0 - held.bound) ** samples == pytest.approx(0.05)


@pytest.mark.parametrize("bound", [0.0, 0.0009, 0.51, 1.0, math.nan, "x"])
def test_other_bounds_are_refused(bound):
    with pytest.raises(sw.InputError, match="bound"):
        RACE.cycle().path.landings(bound=bound)


@pytest.mark.slow
def test_a_landing_of_five_per_cent_is_within_the_bound_nineteen_times_in_twenty():
    """What a sampled landing claims, against the truth of many more samples, seed by seed."""
    path, ratio = RARE, 4.5
    snap = starts(path)[1]

    def elsewhere(factors):
        landed = land_all(path._problem, snap.start, factors, COARSE)
        assert np.all(landed.settled)
        return np.max(np.abs(landed.travel - snap.travel), axis=1) > 1e-4

    count = examples(2000, full=20_000)
    truth = np.mean(elsewhere(factors_of(3, ratio, count, seed=10**6)))
    assert truth == pytest.approx(0.05, abs=0.015)
    seeds = examples(60, full=1000)
    draws = [factors_of(3, ratio, 59, seed) for seed in range(seeds)]
    hits = np.sum(elsewhere(np.concatenate(draws)).reshape(seeds, 59), axis=1)
    bounds = [claim(int(k)).bound for k in hits]
    covered = int(np.sum(np.array(bounds) >= truth))
    # No worse than nineteen in twenty, but for what chance may do one time in a thousand.
    assert covered >= binom.ppf(1e-3, seeds, 0.95)
    # And what is claimed is what the same samples give.
    assert path.landings(ratio, seed=7)[1].bound == pytest.approx(bounds[7])


def claim(elsewhere: int) -> Landing:
    """A landing that 59 samples found, of which some lead elsewhere."""
    event = snaps(RACE.cycle().path)[-1]
    there = OtherLanding((1.0, 1.0, 2.0), (0.0, 0.0, 0.0), (0, 0, 0), "00-", elsewhere / 59)
    return Landing(event, 4.5, None, 6, 59, (there,) if elsewhere else ())


def test_friction_makes_no_other_landing_of_a_place_in_the_same_phases():
    """Where three cells rub they rest a little elsewhere with every mobility, in one state."""
    rubbed = [replace(cell, friction=0.02) for cell in RACE.cells]
    landings = sw.Chain(rubbed).cycle().path.landings()
    assert all(there.state != "" for landing in landings for there in landing.elsewhere)
    for landing in landings:
        states = [there.state for there in landing.elsewhere]
        assert len(set(states)) == len(states)


# --- what is proved ------------------------------------------------------------------------------


def test_under_a_force_no_landing_hangs_on_mobilities():
    chain = replace(RACE, actuator_stiffness=0.0)
    landings = chain.cycle().path.landings(1e3)
    assert landings
    assert all(landing.proof is Proof.FREEDOM and landing.samples == 0 for landing in landings)


def test_a_pair_at_a_prescribed_stroke_has_one_way_to_go():
    pair = sw.Chain([PAPER, PAPER.with_anchors(q=(0.020, 0.0))])
    landings = pair.cycle().path.landings(1e3)
    assert landings
    assert all(landing.proof is Proof.FREEDOM for landing in landings)


def test_a_cell_behind_a_spring_has_one_way_to_go():
    alone = sw.Chain([PAPER], actuator_stiffness=30.0)
    landings = alone.cycle().path.landings(1e3)
    assert landings
    assert all(landing.proof is Proof.FREEDOM for landing in landings)


def test_a_pair_that_a_third_cell_may_join_is_not_proved_by_its_freedom():
    path = RACE.cycle().path
    for landing, snap in zip(path.landings(), starts(path), strict=True):
        free = goes_one_way(path._problem, snap.start, snap.travel, 10.0)
        assert free <= landing.holds
        assert free == (landing.event.cells == (0, 2))
    # Where they hardly differ nobody joins.
    one = starts(path)[1]
    assert goes_one_way(path._problem, one.start, one.travel, 1.01)


@pytest.mark.slow
def test_what_is_proved_no_sample_contradicts():
    proved = 0
    for path in paths(range(examples(12, full=800))):
        full, n = path._problem.laws.full, len(path.chain)
        factors = factors_of(n, 10.0, examples(60, full=500), 0)
        for landing, snap in zip(path.landings(bound=0.5), starts(path), strict=True):
            if landing.proof is None:
                continue
            proved += 1
            landed = land_all(path._problem, snap.start, factors)
            assert np.all(landed.settled)
            assert np.all(landed.sheet == snap.sheet)
            assert np.max(np.abs(landed.travel - snap.travel) / full) < 1e-6
    assert proved > examples(15, full=25)


@pytest.mark.slow
def test_the_landings_of_a_long_sorted_cycle_are_looked_at_too():
    anchors = np.random.default_rng(0).uniform((5, -3), (22, 3), (16, 2)) * 1e-3
    path = sw.Chain([PAPER.with_anchors(q=tuple(q)) for q in anchors]).cycle().path
    landings = path.landings(1.05, bound=0.5)
    assert [landing.event for landing in landings] == snaps(path)
    assert any(landing.proof is Proof.FREEDOM for landing in landings)


# --- what it says --------------------------------------------------------------------------------


def test_a_landing_says_in_words_whether_it_holds():
    texts = [str(landing) for landing in RACE.cycle().path.landings()]
    says(texts[0], "holds", "mobility ratios", "10")
    says(texts[-1], "elsewhere", "00-", "5%")
    says(repr(RACE.cycle().path.landings()[-1]), "SNAP", "4.693 mm", "unloading")


@pytest.mark.slow
def test_snaps_that_leave_a_saddle_at_once_have_one_landing():
    """Two and two alike cells creep into saddles, which only rounding tells how to leave."""
    rng = np.random.default_rng(133)
    one, two = any_cell(rng), any_cell(rng)
    path = sw.Chain([one, two, one, two]).cycle().path
    begins = starts(path)
    assert max(snap.rows for snap in begins) == 2
    assert sum(snap.rows for snap in begins) == len(snaps(path))
    landings = path.landings(bound=0.5)
    assert [landing.event.drive for landing in landings] == [snap.start.drive for snap in begins]
    again = land_all(path._problem, begins[0].start, np.ones((1, 4)))
    assert again.travel[0] == pytest.approx(begins[0].travel, abs=1e-12)


@pytest.mark.parametrize("ratio", [1.0, 1e3])
def test_ratios_from_one_to_a_thousand_are_looked_at(ratio):
    assert RACE.cycle().path.landings(ratio, bound=0.5)[0].ratio == ratio


@pytest.mark.parametrize("ratio", [0.999, 1001.0, math.inf, math.nan, "x"])
def test_other_ratios_are_refused(ratio):
    with pytest.raises(sw.InputError, match="ratio"):
        RACE.cycle().path.landings(ratio)


def test_a_path_without_a_snap_has_no_landings():
    assert sw.files.load("preset:paper-backward").chain.path([0.0, 1e-3]).landings() == ()
