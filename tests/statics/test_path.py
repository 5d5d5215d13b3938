"""Paths: where they start, what they export, what they say when something is wrong."""

import csv
import math
from dataclasses import replace

import numpy as np
import pytest

import stepwell as sw
from chains import concave_chain
from facts import refuses, says
from sizes import examples
from stepwell.mechanism.law import packed
from stepwell.statics import Cause, EventKind, run
from stepwell.statics.sorted_cycle import sorted_cycle

INNER = sw.Cell(sw.Band((-0.010, 0.0), (0.010, 0.0)))
OUTER = INNER.with_anchors(q=(0.020, 0.0))
LEG = sw.Chain([INNER, OUTER])


@pytest.mark.parametrize("lever", [0.01414, math.sqrt(0.0002), 0.014142])
def test_of_an_equal_pull_and_push_the_peak_force_is_the_pull(lever):
    leg = sw.Chain([replace(cell, lever=lever) for cell in LEG.levers])
    assert leg.cycle().peak_force == pytest.approx(0.6476, abs=1e-3)


def test_the_paper_forward_leg_snaps_near_both_ends_and_takes_the_stated_strokes():
    # Kamp et al. 2024, Fig. 2E: the directed pathway snaps near 11 and near 00. The outer cell
    # lets go where its force has fallen to F1 of the inner one: F_out(s) = F1_in.
    cycle = LEG.cycle()
    loading, unloading = cycle.snaps
    s = loading.stroke - 0.020
    assert float(OUTER.force(OUTER.angle(s))) == pytest.approx(INNER.force_1, abs=1e-12)
    assert (loading.direction, unloading.direction) == (1, -1)
    assert unloading.stroke == pytest.approx(0.040 - loading.stroke, abs=1e-15)
    assert loading.cause is Cause.RELEASE and loading.arrivals == ((1, 1),)
    assert loading.released == pytest.approx(
        float(
            OUTER.energy(OUTER.angle(s)) - OUTER.energy(OUTER.limit)
            + INNER.energy(INNER.limit) - INNER.energy(INNER.angle(s))
        ),
        abs=1e-15,
    )  # fmt: skip


def test_turning_back_past_the_first_snap_reaches_the_branch_that_full_strokes_do_not():
    snap = LEG.cycle().snaps[0].stroke
    just_before = LEG.path([0.0, snap - 1e-6, 0.020])
    just_after = LEG.path([0.0, snap + 1e-6, 0.020])
    assert np.array_equal(just_before.end, [INNER.full_travel, 0.0])
    assert np.allclose(just_after.end, [0.0, 0.020], atol=1e-12)


def test_a_path_may_start_at_any_admissible_state():
    for start in ("10", [0.020, 0.0]):
        path = LEG.path([0.020, 0.0], start=start)
        assert np.array_equal(path.end, [0, 0])
    inside = LEG.path([0.005, 0.0], start=[0.005, 0.0])
    assert inside.force[0] == pytest.approx(float(INNER.force(INNER.angle(0.005))), abs=1e-12)


@pytest.mark.parametrize(
    ("points", "start", "message"),
    [
        ([0.0, 0.050], None, "50 mm is out of reach: must be between 0 and 40 mm"),
        ([0.0, math.nan], None, "must be one or more finite numbers"),
        ([], None, "must be one or more finite numbers"),
        ([0.010, 0.0], None, "the start has its cells at a stroke of 0 mm"),
        ([0.020, 0.0], "1", "must be 2 characters 0 or 1"),
        ([0.020, 0.0], "1x", "must be 2 characters 0 or 1"),
        ([0.020, 0.0], [0.030, -0.010], "inner at 30 mm: must be between 0 and 20 mm"),
        ([0.020, 0.0], [0.020], r"must be \(2,\) travels"),
        ([0.015, 0.0], [0.010, 0.005], "start is no equilibrium"),
        ([0.020, 0.0], [0.010, 0.010], "start is an unstable equilibrium"),
    ],
)
def test_a_wrong_start_or_turning_point_is_refused_with_what_is_allowed(points, start, message):
    with pytest.raises(ValueError, match=message):
        LEG.path(points, start=start)


def test_prefer_must_name_every_cell_once():
    with refuses(ValueError, "prefer = [0, 0]", "each", "0..1"):
        LEG.cycle(prefer=[0, 0])


def test_identical_cells_are_reported_as_a_tie_and_prefer_settles_it():
    twins = sw.Chain([INNER, INNER])
    cycle = twins.cycle()
    assert cycle.degenerate and "prefer=" in str(cycle.degenerate[0])
    says(str(cycle.degenerate[0]), "Move an anchor", "outer", "mm")
    assert str(cycle.sequence) == "00>10>11>01>00"
    assert str(twins.cycle(prefer=[1, 0]).sequence) == "00>01>11>10>00"
    assert not LEG.cycle().degenerate


def test_two_slack_cells_share_the_motion_and_are_reported_as_a_tie():
    slack = sw.Cell(sw.Band((0, 0), (0.001, 0.0), rest_length=0.030))
    cycle = sw.Chain([slack, slack]).cycle()
    assert cycle.degenerate
    assert np.allclose(cycle.path.travel[:, 0], cycle.path.travel[:, 1], atol=1e-12)
    assert cycle.dissipated == 0


def test_slack_chains_reach_their_far_stop():
    # A regression: with ℓ0 = 22 mm the vertex 11 was stepped over.
    inner = sw.Cell(sw.Band((-0.010, 0.0), (0.010, 0.0), rest_length=0.022))
    outer = inner.with_anchors(q=(-0.0075, -0.015))
    cycle = sw.Chain([inner, outer]).cycle()
    assert "11" in cycle.sequence.states
    assert np.all(cycle.path.end == 0)


def test_friction_widens_the_loop_by_twice_its_force():
    spring = sw.Band((0, 0), (-0.030, 0.0), rest_length=0.001)
    rubbing = sw.Chain([sw.Cell(spring, friction=0.05)])
    cycle = rubbing.cycle()
    assert not cycle.snaps
    assert cycle.dissipated == pytest.approx(2 * 0.05 * 0.020, rel=1e-9)
    path = cycle.path
    up, down = path.direction > 0, path.direction < 0
    middle = []
    for way in (up, down):
        order = np.argsort(path.stroke[way])
        middle.append(np.interp(0.01, path.stroke[way][order], path.force[way][order]))
    assert middle[0] - middle[1] == pytest.approx(0.10, abs=1e-3)


def test_a_resampled_path_keeps_its_events_and_its_ends():
    path = LEG.cycle().path
    fine = path.resampled(200)
    assert fine.events == path.events
    assert len(fine.stroke) > len(path.stroke)
    assert fine.stroke[-1] == path.stroke[-1] == 0
    with pytest.raises(ValueError, match="must be >= 2"):
        path.resampled(1)


def test_jumps_are_marked_and_nothing_else_is_one():
    path = LEG.cycle().path
    jumps = np.flatnonzero(path.snap_after)
    assert len(jumps) == 2
    for k in jumps:
        assert path.drive[k] == path.drive[k + 1] and path.branch[k + 1] == path.branch[k] + 1
    smooth = np.abs(np.diff(path.travel, axis=0)).max(1)[~path.snap_after[:-1]]
    assert np.all(smooth < 0.002)


@pytest.mark.slow
def test_exports_carry_units_and_the_same_numbers(tmp_path):
    path = LEG.cycle().path
    data = path.to_xarray()
    assert data.travel.dims == ("sample", "cell") and data.force.attrs["units"] == "N"
    assert list(data.cell.values) == ["inner", "outer"]
    path.to_csv(tmp_path / "path.csv")
    with open(tmp_path / "path.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(path.stroke)
    strokes = [float(row["stroke_mm"]) for row in rows]
    assert np.allclose(strokes, path.stroke * 1e3, atol=1e-9)
    assert float(rows[3]["travel_inner_mm"]) == pytest.approx(path.travel[3, 0] * 1e3)
    assert list(tmp_path.iterdir()) == [tmp_path / "path.csv"]


def test_results_cannot_be_changed_by_accident():
    path = LEG.cycle().path
    with pytest.raises(ValueError, match="read-only"):
        path.force[0] = 1.0
    with pytest.raises(AttributeError):
        path.points = 3  # type: ignore[misc]


@pytest.mark.parametrize("cells", [16, 40])
def test_sorting_and_following_give_the_same_cycle(cells, monkeypatch):
    x = np.random.default_rng(cells).permutation(np.linspace(0.010, 0.030, cells))
    chain = sw.Chain([sw.Cell(sw.Band((0, 0), (float(v), 0))) for v in x])
    assert sorted_cycle(packed(chain.cells)[0]) is not None
    fast = chain.cycle()
    monkeypatch.setattr(run.sorted_cycle, "WORTH_SORTING", 10**9)
    slow = chain.cycle()
    assert fast.sequence == slow.sequence
    assert len(fast.snaps) == 2 * (cells - 1)
    for ours, theirs in zip(fast.events, slow.events, strict=True):
        assert ours.kind == theirs.kind
        assert ours.stroke == pytest.approx(theirs.stroke, abs=1e-12)
        assert ours.released == pytest.approx(theirs.released, abs=1e-10)
    assert np.max(fast.path.residual) < 1e-12


def test_cells_whose_curves_cross_that_of_a_leader_with_a_head_start_are_sorted(monkeypatch):
    found = 0
    for seed in range(examples(40)):
        rng = np.random.default_rng([9, seed])
        spread = rng.choice([2e-4, 1e-3, 3e-3])
        x = rng.choice([12e-3, 20e-3], int(rng.integers(16, 24)))
        bands = [
            sw.Band((-0.010, 0), (a + rng.normal() * spread, rng.normal() * spread)) for a in x
        ]
        chain = sw.Chain([sw.Cell(band) for band in bands])
        if sorted_cycle(packed(chain.cells)[0]) is None:
            continue
        found += 1
        fast = chain.cycle().path.events
        with monkeypatch.context() as patch:
            patch.setattr(run.sorted_cycle, "WORTH_SORTING", 10**9)
            slow = sw.Chain(chain.cells).cycle().path.events
        for ours, theirs in zip(fast, slow, strict=True):
            assert ours.kind == theirs.kind and abs(ours.stroke - theirs.stroke) < 1e-10
            after = [dict(zip(one.cells, one.after, strict=True)) for one in (ours, theirs)]
            assert after[0] == pytest.approx(after[1], abs=1e-9)
    # Without the head start 29 of the first 40.
    assert found >= 0.9 * examples(40)


def test_a_chain_whose_landings_are_contested_is_not_sorted_but_followed():
    chain = concave_chain(np.random.default_rng(1), 24)
    assert sorted_cycle(packed(chain.cells)[0]) is None
    cycle = chain.cycle()
    assert list(cycle.loading_order) == list(np.argsort([c.force_0 for c in chain.levers]))


def test_a_snap_keeps_the_stroke_where_a_cell_leaves_its_stop_and_is_called_back_at_once():
    # Two full cells whose F1 differ by 10 mN: the second comes off its stop while the first
    # gives travel back, and is pressed onto it again within one step of the flow.
    bands = [
        ((0.012142493811, 0.009040944517), 38.76790629, 0.01343052253),
        ((0.013137159700, 0.009386791658), 15.21563347, 0.00084877168),
        ((0.023595215835, 0.018846076005), 22.69459663, 0.00762265549),
    ]
    chain = sw.Chain([sw.Cell(sw.Band((0, 0), d, k, rest)) for d, k, rest in bands])
    path = chain.path([0.0, chain.full_stroke, 0.0])
    snaps = [e for e in path.events if e.kind is EventKind.SNAP]
    assert snaps
    for snap in snaps:
        assert sum(snap.after) == pytest.approx(sum(snap.before), abs=1e-12)
    assert str(chain.cycle().sequence).startswith("000>100>110>111")


def test_a_cell_that_lets_go_at_no_force_at_all_is_no_tie():
    # F0 of the inner cell is 0, and there the outer cell's force goes through 0 as well: that is
    # where its law is cut in two, and nothing arrives.
    bands = [sw.Band((0, 0), d) for d in ((0.010, -0.010), (0.030, -0.005))]
    chain = sw.Chain([sw.Cell(band) for band in bands])
    assert abs(chain.levers[0].force_0) < 1e-15
    cycle = chain.cycle()
    assert cycle.degenerate == ()
    assert str(cycle.sequence) == "00>10>11>01>00"


@pytest.mark.slow
def test_ten_thousand_cells_cycle_in_sorted_order(monkeypatch):
    cells = examples(10_000, full=100_000)
    monkeypatch.setenv("STEPWELL_LIMITS", f"cells={cells}")  # on purpose
    x = np.random.default_rng(0).permutation(np.linspace(0.010, 0.030, cells))
    chain = sw.Chain([sw.Cell(sw.Band((0, 0), (float(v), 0))) for v in x])
    path = chain.cycle().path
    assert np.all(path.end == 0)
    assert int(np.sum(path._log.segments[:, 0] == 3)) == 2 * (len(x) - 1)


def test_a_compliant_actuator_tells_position_from_stroke():
    soft = sw.Chain([INNER, OUTER], actuator_stiffness=100.0)
    path = soft.cycle().path
    assert np.allclose(path.force, 100.0 * (path.drive - path.stroke), atol=1e-9)


def test_events_print_what_happened_in_millimetres():
    snap = next(e for e in LEG.cycle().events if e.kind is EventKind.SNAP)
    says(repr(snap), "SNAP", "37.23 mm", "loading", "cell 1", "20→17.23 mm")
