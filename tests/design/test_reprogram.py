"""The displacement found does what is wanted, and none that is shorter does."""

import csv
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st

import stepwell as sw
from chains import any_cell, concave_chain
from facts import refuses, says
from sizes import examples
from stepwell.design.margins.nearest import sequence
from stepwell.design.margins.reprogramming import Reprogramming, Resistance, reprogram
from stepwell.design.parameters import parameter

CLOCKWISE = "00>10>11>01>00"
COUNTERCLOCKWISE = "00>01>11>10>00"
VIA_01 = "00>01>11>01>00"
VIA_10 = "00>10>11>10>00"
REACH = 0.006


def cell(x: float, y: float, **band) -> sw.Cell:
    return sw.Cell(sw.Band((-0.010, 0.0), (x * 1e-3, y * 1e-3), **band))


PAIR = sw.Chain((cell(10, 0), cell(15, 10)))


def displaced(chain: sw.Chain, by: str, move: tuple[float, float]) -> sw.Chain:
    return parameter(chain, by).displaced(chain, move)


def does(chain: sw.Chain, by: str, move: tuple[float, float]) -> str:
    """By the closed form where it is proved, else by the engine."""
    return str(sequence(displaced(chain, by, move)))


def somewhere(rng: np.random.Generator, most: float) -> tuple[float, float]:
    away, angle = most * math.sqrt(rng.random()), rng.uniform(0, 2 * math.pi)
    return away * math.cos(angle), away * math.sin(angle)


def tasks(seed: int, count: int) -> list[tuple[sw.Chain, str, str, float]]:
    """Chains, an anchor, a target that some displacement reaches, and how long that one is."""
    rng = np.random.default_rng(seed)
    chosen: list[tuple[sw.Chain, str, str, float]] = []
    while len(chosen) < count:
        chain = concave_chain(rng, int(rng.integers(2, 5)))
        by = f"{1 + rng.integers(len(chain))}.{rng.choice(['p', 'q'])}"
        move = somewhere(rng, REACH)
        target = does(chain, by, move)
        if target != str(chain.cycle().sequence):
            chosen.append((chain, by, target, math.hypot(*move)))
    return chosen


@pytest.mark.slow
def test_the_target_is_done_just_past_the_displacement_and_reached_no_later_than_known():
    for chain, by, target, known in tasks(1, examples(10, full=500)):
        result = reprogram(chain, target, by, reach=REACH)
        assert result.distance <= known + 1e-12
        assert math.hypot(*result.move) == pytest.approx(result.distance, rel=1e-12)
        assert result.after == target
        assert result.chain_after is not None
        assert str(result.chain_after.cycle().sequence) == target
        assert result.before == str(chain.cycle().sequence)


@pytest.mark.slow
def test_no_shorter_displacement_in_the_plane_does_the_target():
    rng = np.random.default_rng(2)
    exact = 0
    for chain, by, target, _ in tasks(2, examples(8, full=240)):
        result = reprogram(chain, target, by, reach=REACH)
        if result.method != "exact":
            continue
        exact += 1
        for _ in range(100):
            assert does(chain, by, somewhere(rng, 0.9999 * result.distance)) != target
    assert exact > 6


@pytest.mark.slow
def test_any_other_sequence_is_as_near_as_the_margin_says():
    rng = np.random.default_rng(3)
    for _ in range(examples(5, full=240)):
        chain = concave_chain(rng, int(rng.integers(2, 6)))
        for change in sw.margin(chain, reach=REACH).changes:
            if change.parameter != "anchor" or change.method != "exact":
                continue
            result = reprogram(chain, None, f"{change.cell + 1}.q", reach=REACH)
            assert result.method == "exact"
            assert result.distance == pytest.approx(change.distance, rel=1e-9)
            assert result.after == change.becomes
            if math.isfinite(change.distance):
                assert result.displacement == pytest.approx(change.move, abs=1e-9)


def test_the_sequence_across_the_nearest_boundary_is_reached_there():
    change = sw.margin(PAIR).changes[2]
    result = reprogram(PAIR, change.becomes, "outer.q")
    assert (result.method, change.method) == ("exact", "exact")
    assert result.distance == pytest.approx(change.distance, rel=1e-12)
    assert result.displacement == pytest.approx(change.move, abs=1e-12)


@pytest.mark.slow
def test_an_exact_place_has_equal_forces_to_rounding():
    met = 0
    for chain, by, target, _ in tasks(4, examples(7, full=300)):
        result = reprogram(chain, target, by, reach=REACH)
        if result.method != "exact":
            continue
        moved = displaced(chain, by, result.move).levers
        own, scale = moved[result.cell], moved[0].bands[0].stiffness * moved[0].lever
        gaps = [
            abs(getattr(own, end) - getattr(other, end)) / scale
            for other in moved
            if other is not own
            for end in ("force_0", "force_1")
        ]
        assert min(gaps) < 1e-13
        met += sum(gap < 1e-13 for gap in gaps) > 1
    # Some lie on one curve, some where two of them meet.
    assert met > 0


def test_moving_p_is_moving_q_the_other_way():
    for target in (None, CLOCKWISE):
        q = reprogram(PAIR, target, "outer.q")
        p = reprogram(PAIR, target, "outer.p")
        assert p.distance == pytest.approx(q.distance, rel=1e-12)
        assert p.move == pytest.approx((-q.move[0], -q.move[1]))
        assert p.after == q.after
        np.testing.assert_allclose(p.resistance.peak, q.resistance.peak, rtol=1e-9)
        assert p.resistance.work_0 == pytest.approx(q.resistance.work_0, rel=1e-9)


@pytest.mark.slow
def test_on_a_line_a_brute_force_scan_finds_nothing_nearer():
    rng = np.random.default_rng(5)
    finite = 0
    for chain, by, target, _ in tasks(5, examples(5, full=240)):
        angle = rng.uniform(0, 2 * math.pi)
        along = np.array([math.cos(angle), math.sin(angle)])
        result = reprogram(chain, target, by, along=tuple(along), reach=REACH)
        scan = [
            abs(step)
            for step in np.linspace(-REACH, REACH, 401)
            if does(chain, by, tuple(step * along)) == target
        ]
        nearest = min(scan, default=math.inf)
        if math.isinf(nearest):
            # What the scan steps over is no wider than its step.
            continue
        finite += 1
        assert nearest - REACH / 200 < result.distance <= nearest
        assert abs(np.cross((*along, 0), (*result.move, 0))[2]) < 1e-15
    assert finite > 1


def test_a_line_is_never_shorter_than_the_plane_and_one_way_never_than_both():
    plane = reprogram(PAIR, COUNTERCLOCKWISE, "outer.q").distance
    both = reprogram(PAIR, COUNTERCLOCKWISE, "outer.q", along=(2.0, 1.0)).distance
    there = reprogram(PAIR, COUNTERCLOCKWISE, "outer.q", along=(2, 1), one_way=True).distance
    back = reprogram(PAIR, COUNTERCLOCKWISE, "outer.q", along=(-2, -1), one_way=True).distance
    assert plane < both == min(there, back)


def test_the_way_is_the_shortest_that_the_plane_offers_in_its_own_direction():
    plane = reprogram(PAIR, CLOCKWISE, "outer.q")
    line = reprogram(PAIR, CLOCKWISE, "outer.q", along=plane.move, one_way=True)
    assert line.distance == pytest.approx(plane.distance, rel=1e-12)


def test_what_is_done_already_needs_no_displacement():
    result = reprogram(PAIR, str(PAIR.cycle().sequence), "outer.q")
    assert result.distance == 0.0
    assert result.displacement == (0.0, 0.0)
    assert result.chain_after == PAIR
    assert result.resistance.work_0 == result.resistance.largest == 0.0
    assert "already" in repr(result)


def test_two_equal_cells_do_anything_after_a_hair():
    chain = sw.Chain((cell(10, 0), cell(10, 0)))
    for target in (COUNTERCLOCKWISE, VIA_01):
        result = reprogram(chain, target, "inner.p")
        assert result.distance < 1e-15
        assert result.after == target


def test_where_the_other_cells_do_not_do_their_part_there_is_no_displacement():
    chain = sw.Chain((cell(10, 0), cell(20, 0), cell(15, 0)))
    # The middle cell comes before the last one both ways, whatever the first one does.
    wanted = "000>100>110>111>101>100>000"
    result = reprogram(chain, wanted, "1.q", reach=0.004)
    assert math.isinf(result.distance)
    assert result.method == "exact"
    assert (result.chain_after, result.after) == (None, "")
    assert np.all(np.isnan([result.displacement, result.place]))
    assert len(result.resistance.peak) == 0
    assert math.isnan(result.resistance.largest)
    says(repr(result), "cell 1.q", "4 mm", wanted, "exact")


def test_beyond_the_reach_nothing_is_reported():
    assert reprogram(PAIR, CLOCKWISE, "outer.q", reach=0.003).distance < 0.003
    near = reprogram(PAIR, CLOCKWISE, "outer.q", reach=0.002)
    assert math.isinf(near.distance)
    assert near.method == "exact"


def test_a_target_that_no_sorted_chain_does_is_not_found_where_the_proof_holds():
    result = reprogram(PAIR, "00>11>00", "outer.q", reach=0.004)
    assert math.isinf(result.distance)
    assert result.method == "exact"


@pytest.mark.slow
@pytest.mark.parametrize(
    "chain",
    [
        sw.Chain((replace(cell(10, 0), friction=0.02), cell(15, 10))),
        sw.Chain(PAIR.cells, actuator_stiffness=30.0),
        sw.Chain((cell(10, 0), cell(15, 10, law=sw.Cubic(-10.0, 500.0)))),
    ],
    ids=["friction", "compliant", "rubber"],
)
def test_without_a_closed_form_it_is_searched_and_says_so(chain):
    rng = np.random.default_rng(6)
    for target in (None, CLOCKWISE):
        result = reprogram(chain, target, "outer.q", reach=REACH)
        assert result.method == "search"
        assert result.resolution in str(result)
        assert result.after != result.before
        assert target in (None, result.after)
        for _ in range(examples(7, full=600)):
            near = does(chain, "outer.q", somewhere(rng, 0.98 * result.distance))
            assert near == result.before if target is None else near != target
        on_line = reprogram(chain, target, "outer.q", along=(1, -1), reach=REACH)
        assert on_line.method == "search"
        assert on_line.distance >= result.distance - 2e-6


@pytest.mark.slow
def test_a_search_finds_what_is_exact_where_both_hold():
    # Friction so small that it changes no order, and takes the closed form away.
    rubbing = sw.Chain((replace(PAIR.cells[0], friction=1e-7), PAIR.cells[1]))
    for along in (None, (1.0, -1.0)):
        exact = reprogram(PAIR, CLOCKWISE, "outer.q", along=along)
        searched = reprogram(rubbing, CLOCKWISE, "outer.q", along=along)
        assert (exact.method, searched.method) == ("exact", "search")
        assert exact.distance - 1e-6 < searched.distance < exact.distance * 1.0005 + 2e-6


@pytest.mark.slow
def test_where_the_proof_ends_on_the_way_the_closed_form_is_checked_by_asking():
    # The antenna robot's bands: slack cells lie nearer than the target, on the other side.
    inner = sw.Cell(sw.Band((-0.007, 0.0), (0.010, 0.0), stiffness=47.0, rest_length=0.022))
    chain = sw.Chain((inner, inner.with_anchors(p=(-0.010, 0.0), q=(0.020, 0.0))))
    result = reprogram(chain, COUNTERCLOCKWISE, "inner.p")
    assert result.method == "search"
    # Equal bands: p_in has to make the inner band as long as the outer one.
    assert result.place == result.anchor_at == pytest.approx((-0.020, 0.0), abs=1e-9)
    one_way = reprogram(chain, COUNTERCLOCKWISE, "inner.p", along=(-1, 0), one_way=True)
    assert one_way.method == "exact"
    assert one_way.distance == pytest.approx(0.013, rel=1e-12)
    # The other way along the line the band goes slack before that.
    both = reprogram(chain, COUNTERCLOCKWISE, "inner.p", along=(-1, 0))
    assert both.method == "search"
    assert both.distance == pytest.approx(one_way.distance, abs=1e-12)


@pytest.mark.slow
@given(st.integers(0, 2**32 - 1), st.sampled_from("pq"))
def test_the_push_is_the_slope_of_the_bands_energy_at_fixed_travel(seed, anchor):
    rng = np.random.default_rng(seed)
    loose = any_cell(rng)
    move = somewhere(rng, 0.004)
    assume(math.hypot(*move) > 1e-4)

    def energy(part: float) -> np.ndarray:
        """At state 0 and at state 1."""
        try:
            design = displaced(sw.Chain((loose,)), f"1.{anchor}", (part * move[0], part * move[1]))
        except ValueError:
            assume(False)
            raise
        return design.levers[0].energy(np.array([-loose.limit, loose.limit]))

    push = Resistance.of(loose, anchor, move)
    here, there = energy(0.0), energy(1.0)
    scale = np.max(np.abs([here, there])) + 1e-9
    assert push.work_0 == pytest.approx(there[0] - here[0], abs=1e-12 * scale)
    assert push.work_1 == pytest.approx(there[1] - here[1], abs=1e-12 * scale)
    away = math.hypot(*move)
    for i in (5, 20, 35):
        step = 1e-4
        slope = (energy(push.fraction[i] + step) - energy(push.fraction[i] - step)) / (
            2 * step * away
        )
        # A band that goes slack within the step has a kink in its force.
        assert push.force_0[i] == pytest.approx(slope[0], rel=1e-4, abs=1e-2 * step * 60)
        assert push.force_1[i] == pytest.approx(slope[1], rel=1e-4, abs=1e-2 * step * 60)


def test_the_force_at_the_start_is_tension_along_the_displacement():
    # d = (20, 0) mm at state 1: from p to q (30, 10) mm.
    chain = sw.Chain((cell(10, 0), cell(20, 0)))
    push = Resistance.of(chain.levers[0], "p", (-0.001, 0.0))
    length = math.hypot(0.030, 0.010)
    pull = 28.5 * (length - 0.010) * 0.030 / length
    assert push.force_1[0] == pytest.approx(pull, rel=1e-12)
    assert push.force_0[0] == pytest.approx(pull, rel=1e-12)
    # Straight levers stretch the band most along x.
    straight = 28.5 * (0.010 * math.sqrt(2) + 0.020 - 0.010)
    assert push.peak[0] == pytest.approx(straight, rel=1e-9)
    # The other way round it helps.
    assert Resistance.of(chain.levers[0], "p", (0.001, 0.0)).force_1[0] == pytest.approx(-pull)


def test_the_peak_is_the_largest_over_the_travel_and_the_work_lies_under_the_force():
    result = reprogram(PAIR, CLOCKWISE, "inner.p")
    push = result.resistance
    assert push.largest == np.max(push.peak)
    assert np.all(push.peak >= np.maximum(push.force_0, push.force_1))
    for force, work in ((push.force_0, push.work_0), (push.force_1, push.work_1)):
        assert np.trapezoid(force, push.fraction * result.distance) == pytest.approx(work, rel=1e-3)


def test_the_result_exports_its_way(tmp_path):
    result = reprogram(PAIR, CLOCKWISE, "inner.p")
    data = result.to_xarray()
    assert data.sizes == {"fraction": len(result.resistance.fraction)}
    assert data.force_0.attrs["units"] == "N"
    assert float(data.x[-1]) == result.move[0]
    assert data.attrs["distance_m"] == result.distance
    result.to_csv(tmp_path / "way.csv")
    with open(tmp_path / "way.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(result.resistance.fraction)
    assert float(rows[-1]["x_mm"]) == pytest.approx(result.move[0] * 1e3)
    assert float(rows[0]["force_0_N"]) == pytest.approx(result.resistance.force_0[0])


def test_a_result_reads_as_what_to_do():
    result = reprogram(PAIR, CLOCKWISE, "outer.q")
    assert isinstance(result, Reprogramming)
    says(str(result).splitlines()[0], "outer.q", "(+1.676, -1.393) mm", "2.179 mm")
    says(str(result).splitlines()[0], "00>10>11>10>00", "00>10>11>01>00", "exact")
    says(repr(result), "push", "0.6133 N", "1.254 mJ", "state 0")
    assert result.cell == 1
    assert result.anchor == "q"
    helped = reprogram(PAIR, CLOCKWISE, "inner.p")
    says(str(helped), "band", "pulls", "mJ", "state 0", "mJ", "state 1")


@pytest.mark.parametrize(
    "target", ["", "00", "00>10>11", "00>10>01>00", "000>111>000", "00>20>11>00", "clockwise"]
)
def test_a_target_that_is_no_full_cycle_is_refused(target):
    with pytest.raises(ValueError, match=r"target = .*(full cycle|2 characters)"):
        reprogram(PAIR, target, "inner.p")


def test_a_state_that_follows_itself_is_refused():
    with refuses(ValueError, "target = '00>10>10>11>01>00'", "twice"):
        reprogram(PAIR, "00>10>10>11>01>00", "inner.p")


@pytest.mark.parametrize("by", ["inner.stiffness", "inner.p.x", "actuator_stiffness"])
def test_what_is_no_anchor_is_refused(by):
    with refuses(ValueError, f"by = {by!r}", "anchor", "'inner.p'", "'outer.q'"):
        reprogram(PAIR, CLOCKWISE, by)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"along": (0.0, 0.0)}, "must be a direction"),
        ({"along": (1.0, 0.0, 0.0)}, "must be a direction"),
        ({"along": (math.nan, 0.0)}, "must be a direction"),
        ({"one_way": True}, "needs a direction"),
        ({"reach": 0.0}, "must be > 0"),
        ({"reach": math.inf}, "must be > 0"),
    ],
)
def test_ways_that_are_none_are_refused(options, words):
    with pytest.raises(ValueError, match=words):
        reprogram(PAIR, CLOCKWISE, "inner.p", **options)


def test_a_sequence_may_be_given_as_it_comes_from_a_cycle():
    target = sw.Chain((cell(10, 0), cell(20, 0))).cycle().sequence
    assert reprogram(PAIR, target, "outer.q").after == CLOCKWISE


def test_the_design_past_a_tie_runs_through_the_target():
    # Where both anchors are in one place, the cells are equal, and friction would decide.
    law = sw.Table((0.0, 0.005, 0.056), (0.0, 0.4, 3.0))
    pair = sw.Chain(
        [cell(20, 0, rest_length=0.005, law=law), cell(15, 0, rest_length=0.005, law=law)]
    )
    change = reprogram(pair, CLOCKWISE, "outer.q", along=(1.0, 0.0))
    assert change.distance == pytest.approx(0.005, abs=1e-6)
    assert change.chain_after is not None
    again = sw.files.loads(sw.files.dumps(change.chain_after)).chain.cycle()
    assert str(again.sequence) == CLOCKWISE == change.after
    assert not again.degenerate
