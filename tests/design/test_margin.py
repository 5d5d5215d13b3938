"""A margin is a promise: nearer nothing changes, just past it the named sequence happens."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize

import stepwell as sw
from chains import concave_chain
from facts import says
from sizes import examples
from stepwell.design import Change, Method, proved_margin
from stepwell.design.margins.margin import number_change
from stepwell.design.margins.nearest import Aim, nearest
from stepwell.design.margins.search import Displacements
from stepwell.design.parameters import of_cell


def cell(x: float, y: float, **band) -> sw.Cell:
    return sw.Cell(sw.Band((-0.010, 0.0), (x * 1e-3, y * 1e-3), **band))


def shifted(chain: sw.Chain, number: int, move: tuple[float, float]) -> sw.Chain:
    return of_cell(chain, number, "q").displaced(chain, move)


def stiffened(chain: sw.Chain, number: int, ratio: float) -> sw.Chain:
    return of_cell(chain, number, "stiffness").scaled(chain, ratio)


def sequence(chain: sw.Chain) -> str:
    return str(chain.cycle().sequence)


def anchors(margin: sw.Margin) -> list[Change]:
    return [c for c in margin.changes if c.parameter == "anchor"]


def stiffnesses(margin: sw.Margin) -> list[Change]:
    return [c for c in margin.changes if c.parameter == "stiffness"]


def concave_margins(seed: int, count: int) -> list[tuple[sw.Chain, sw.Margin]]:
    rng = np.random.default_rng(seed)
    chains = [concave_chain(rng, int(rng.integers(2, 6))) for _ in range(count)]
    return [(chain, sw.margin(chain)) for chain in chains]


@pytest.mark.slow
def test_a_margin_that_is_proved_is_the_margin():
    for chain, margin in concave_margins(3, examples(10)):
        proved = proved_margin(chain)
        assert proved is None or proved == margin
        assert (proved is None) == (margin.method is not Method.EXACT)
    for name, exact in (("paper-backward", True), ("paper-counterclockwise", False)):
        assert (proved_margin(sw.preset(name)) is not None) is exact


@pytest.mark.slow
def test_nearer_than_the_margin_no_displacement_changes_the_sequence():
    for chain, margin in concave_margins(1, examples(2)):
        now = sequence(chain)
        for change in anchors(margin):
            if math.isinf(change.distance):
                continue
            for angle in np.linspace(0, 2 * np.pi, 64, endpoint=False):
                away = 0.99 * change.distance
                move = away * math.cos(angle), away * math.sin(angle)
                assert sequence(shifted(chain, change.cell, move)) == now


@pytest.mark.slow
def test_past_the_margin_the_sequence_is_the_predicted_one():
    for chain, margin in concave_margins(2, examples(10)):
        now = sequence(chain)
        for change in anchors(margin):
            assert isinstance(change.move, tuple)
            if math.isinf(change.distance):
                continue
            x, y = change.move
            assert math.hypot(x, y) == pytest.approx(change.distance, rel=1e-12)
            past = 1.0 + 1e-6 + 1e-8 / change.distance
            assert sequence(shifted(chain, change.cell, (x * past, y * past))) == change.becomes
            assert change.becomes != now


@pytest.mark.slow
def test_an_exact_anchor_meets_another_force_to_rounding_and_squarely():
    exact = 0
    for chain, margin in concave_margins(3, examples(10)):
        scale = chain.levers[0].bands[0].stiffness * chain.levers[0].lever
        for change in anchors(margin):
            if change.method != "exact" or math.isinf(change.distance):
                continue
            exact += 1

            def gaps(x: float, y: float, chain=chain, number=change.cell) -> np.ndarray:
                moved = shifted(chain, number, (x, y)).levers[number]
                others = [c for i, c in enumerate(chain.levers) if i != number]
                return np.array(
                    [moved.force_0 - c.force_0 for c in others]
                    + [moved.force_1 - c.force_1 for c in others]
                )

            assert isinstance(change.move, tuple)
            x, y = change.move
            nearest_line = np.argmin(np.abs(gaps(x, y)))
            assert abs(gaps(x, y)[nearest_line]) < 1e-13 * scale
            # The circle through the nearest point touches the curve there and does not cross it.
            for turn in (-0.05, 0.05):
                c, s = math.cos(turn), math.sin(turn)
                beside = gaps(c * x - s * y, s * x + c * y)[nearest_line]
                assert beside * gaps(0.0, 0.0)[nearest_line] > 0
    assert exact > 10


@pytest.mark.slow
def test_the_nearest_anchor_is_the_one_a_general_optimiser_finds():
    rng = np.random.default_rng(4)
    for _ in range(examples(1, full=120)):
        chain = concave_chain(rng, 2)
        change = anchors(sw.margin(chain))[0]
        if change.method != "exact":
            continue
        inner, outer = chain.levers
        distances = []
        for end in ("force_0", "force_1"):
            wanted = getattr(outer, end)

            def gap(mm: np.ndarray, end=end, wanted=wanted, inner=inner) -> float:
                q = inner.bands[0].q
                moved = inner.with_anchors(q=(q[0] + mm[0] * 1e-3, q[1] + mm[1] * 1e-3))
                return 10 * (getattr(moved, end) - wanted)

            for start in ((1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)):
                optimum = minimize(
                    lambda mm: float(mm @ mm),
                    np.array(start),
                    method="SLSQP",
                    constraints={"type": "eq", "fun": gap},
                    options={"ftol": 1e-14, "maxiter": 500},
                )
                if optimum.success and abs(gap(optimum.x)) < 1e-9:
                    distances.append(math.sqrt(float(optimum.fun)) * 1e-3)
        assert change.distance == pytest.approx(min(distances), rel=1e-5)


@pytest.mark.slow
def test_stiffness_may_change_up_to_its_margin_either_way_and_not_beyond():
    for chain, margin in concave_margins(5, examples(10)):
        now = sequence(chain)
        for change in stiffnesses(margin):
            if math.isinf(change.distance):
                continue
            assert isinstance(change.move, float)
            for size in (-0.99, -0.5, 0.5, 0.99):
                ratio = 1 + size * change.distance
                if ratio > 0:
                    assert sequence(stiffened(chain, change.cell, ratio)) == now
            past = change.move * (1 + 1e-6) + math.copysign(1e-7, change.move)
            assert sequence(stiffened(chain, change.cell, 1 + past)) == change.becomes != now


@pytest.mark.slow
def test_no_stiffness_reaches_a_force_of_the_other_sign():
    # F0 and F1 are both negative in one cell and both positive in the other.
    chain = sw.Chain((cell(0, -15), cell(0, 15)))
    assert np.all(np.isinf(sw.margin(chain).stiffness))
    assert sequence(stiffened(chain, 0, 50.0)) == sequence(chain)
    assert sequence(stiffened(chain, 0, 0.02)) == sequence(chain)


def test_a_single_cell_cannot_do_anything_else():
    margin = sw.margin(sw.Chain((cell(10, 0),)))
    assert np.all(np.isinf(margin.anchors))
    assert np.all(np.isinf(margin.stiffness))
    assert math.isinf(margin.gap)
    assert [c.becomes for c in margin.changes] == ["", ""]
    assert "none within reach" in str(margin)
    assert "more than 20 mm" in repr(margin)
    # Nothing is asked: where the actuator is rigid it is so for every force.
    assert (margin.method, margin.resolution) == ("exact", "")


def test_two_equal_cells_have_no_margin_and_either_way_out_is_named():
    chain = sw.Chain((cell(10, 0), cell(10, 0)))
    margin = sw.margin(chain)
    assert margin.gap == 0.0
    assert margin.anchors.tolist() == [0.0, 0.0]
    assert margin.stiffness.tolist() == [0.0, 0.0]
    for change in margin.changes:
        assert change.becomes != sequence(chain)
        assert change.design is not None
        assert not change.design.cycle().degenerate


def test_the_gap_is_the_smallest_of_neighbouring_end_forces():
    for chain, margin in concave_margins(6, 5):
        forces = np.array([(c.force_0, c.force_1) for c in chain.levers])
        scale = chain.levers[0].bands[0].stiffness * chain.levers[0].lever
        gap = np.min(np.diff(np.sort(forces, axis=0), axis=0))
        assert margin.gap == pytest.approx(gap / scale, rel=1e-9)


def test_moving_the_inner_anchor_the_opposite_way_is_the_same_change():
    chain = sw.Chain((cell(10, 0), cell(15, 10)))
    change = anchors(sw.margin(chain))[1]
    assert isinstance(change.past, tuple)
    band = chain.levers[1].bands[0]
    p = band.p[0] - change.past[0], band.p[1] - change.past[1]
    moved = sw.Chain((chain.levers[0], chain.levers[1].with_anchors(p=p)))
    assert sequence(moved) == change.becomes


def test_where_the_proof_holds_a_search_finds_the_same_to_its_resolution():
    chain = sw.Chain((cell(10, 0), cell(15, 10)))
    exact = sw.margin(chain)
    assert exact.method == "exact"
    now = chain.cycle().sequence
    ways = Displacements.of(None, False, 0.020)
    for number in range(2):
        change = nearest(Aim(chain, now, of_cell(chain, number, "q"), None), None, ways)
        assert change.method == "search"
        assert exact.anchors[number] - 1e-9 <= change.distance
        assert change.distance <= exact.anchors[number] + 1.5e-7
        stiff = number_change(chain, None, now, number, "stiffness")
        assert stiff.distance == pytest.approx(exact.stiffness[number], abs=2e-6)


@pytest.mark.slow
@pytest.mark.parametrize(
    "chain",
    [
        sw.Chain((replace(cell(10, 0), friction=0.05), cell(15, 10))),
        sw.Chain((cell(10, 0), cell(15, 10)), actuator_stiffness=30.0),
        sw.Chain((cell(10, 0), cell(15, 10, law=sw.Cubic(-10.0, 500.0)))),
        sw.Chain((cell(10, 0), replace(cell(20, 0), limit=0.5))),
    ],
    ids=["friction", "compliant", "rubber", "unequal limits"],
)
def test_without_a_closed_form_the_margin_is_searched_and_says_so(chain):
    now = sequence(chain)
    margin = sw.margin(chain)
    assert margin.method == "search"
    assert margin.resolution in str(margin)
    assert math.isnan(margin.gap)
    assert np.all(np.isfinite(margin.anchors))
    for change in margin.changes:
        assert change.becomes != now
        assert change.method == "search"
        assert isinstance(change.move, tuple | float)
        if isinstance(change.move, tuple):
            x, y = change.move
            nearer = shifted(chain, change.cell, (0.99 * x, 0.99 * y))
        else:
            nearer = stiffened(chain, change.cell, 1 + 0.99 * change.move)
        assert sequence(nearer) == now


@pytest.mark.slow
def test_friction_widens_the_gap_that_two_forces_must_cross():
    # Cell i leaves 0 at F0 + f: rubbing in the second cell to load sets the two further apart.
    plain = sw.margin(sw.Chain((cell(10, 0), cell(15, 0))))
    rubbing = sw.Chain((cell(10, 0), replace(cell(15, 0), friction=0.05)))
    assert sw.margin(rubbing).anchors[1] > plain.anchors[1]


def test_all_bands_of_a_cell_move_together():
    double = replace(cell(10, 0), band=(cell(10, 0).bands[0], cell(12, 3).bands[0]))
    moved = shifted(sw.Chain((double,)), 0, (0.001, -0.002)).levers[0]
    np.testing.assert_allclose([b.q for b in moved.bands], [(0.011, -0.002), (0.013, 0.001)])


@pytest.mark.slow
def test_a_chain_of_hundreds_has_an_exact_margin_for_every_cell():
    margin = sw.margin(concave_chain(np.random.default_rng(9), 300))
    assert margin.method == "exact"
    assert margin.anchors.shape == margin.stiffness.shape == (300,)
    assert margin.anchors.max() < 0.002


@pytest.mark.parametrize("reach", [0.0, -0.001, math.inf, math.nan])
def test_a_reach_that_is_no_distance_is_refused(reach):
    with pytest.raises(ValueError, match=r"reach = .* must be > 0"):
        sw.margin(sw.Chain((cell(10, 0),)), reach=reach)


def test_nothing_beyond_the_reach_is_reported():
    chain = sw.Chain((cell(10, 0), cell(20, 0)))
    near = sw.margin(chain, reach=0.001)
    assert near.method == "exact"
    assert np.all(np.isinf(near.anchors))
    assert sw.margin(chain, reach=0.009).anchors == pytest.approx(sw.margin(chain).anchors)


def test_a_printed_margin_names_the_cell_the_move_and_what_comes_of_it():
    text = str(sw.margin(sw.Chain((cell(10, 0), cell(15, 10)))))
    first = text.splitlines()[0]
    says(first, "outer", "anchor", "2.179 mm", "move q", "(+1.676, -1.393) mm", "00>10>11>01>00")


def test_progress_counts_the_changes():
    calls: list[tuple[int, int]] = []
    chain = sw.Chain((cell(10, 0), cell(20, 0)))
    sw.margin(chain, progress=lambda *done: calls.append(done))
    assert calls[0] == (0, 4)
    assert calls[-1] == (4, 4)
