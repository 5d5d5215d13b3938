"""What unequal mobilities must change, and what they must not."""

import math
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st

import stepwell as sw
from chains import any_chain, concave_chain
from facts import refuses
from stepwell.mechanism import MOBILITIES, mobilities_of

seeds = st.integers(0, 2**32 - 1)
sizes = st.integers(2, 6)
stiffnesses = st.sampled_from([math.inf, 500.0, 50.0])


def constant(force: float, *, mobility: float = 1.0) -> sw.Element:
    """A constant force [N] between two stops 10 mm apart."""
    return sw.Element.from_points([0, 0.010], [force, force], stops=True, mobility=mobility)


def trilinear(peak: float, mobility: float = 1.0) -> sw.Element:
    return sw.Element.from_points(
        [0.0, 1e-3, 3e-3, 5e-3], [0.0, peak, -peak, peak], mobility=mobility
    )


def chain_of(seed: int, cells: int, stiffness: float = math.inf, mobilities=(1.0,)) -> sw.Chain:
    """A chain of levers, in places of elements, with these mobilities over and over."""
    rng = np.random.default_rng(seed)
    parts: list[sw.Cell | sw.Element] = [*any_chain(rng, cells).cells]
    parts[::3] = [trilinear(rng.uniform(0.3, 1.5)) for _ in parts[::3]]
    return moved(sw.Chain(parts, actuator_stiffness=stiffness), mobilities)


def moved(chain: sw.Chain, mobilities) -> sw.Chain:
    """The same chain with these mobilities, over and over."""
    mobility = np.resize(mobilities, len(chain)).tolist()
    cells = [replace(c, mobility=m) for c, m in zip(chain.cells, mobility, strict=True)]
    return replace(chain, cells=cells)


def spread(seed: int, cells: int, ratio: float) -> list[float]:
    return (ratio ** np.random.default_rng(seed).uniform(-0.5, 0.5, cells)).tolist()


def differs(one: sw.Path, other: sw.Path) -> bool:
    """Whether two paths differ by a bit, in events, force or travels."""
    return (
        [repr(e) for e in one.events] != [repr(e) for e in other.events]
        or not np.array_equal(one.travel, other.travel)
        or not np.array_equal(one.force, other.force)
    )


@pytest.mark.slow
@given(seeds, sizes, stiffnesses, st.floats(*MOBILITIES))
def test_a_common_mobility_of_any_value_changes_no_bit(seed, cells, stiffness, mobility):
    chain = chain_of(seed, cells, stiffness)
    assert not differs(chain.cycle().path, moved(chain, [mobility]).cycle().path)


@pytest.mark.slow
@given(seeds, sizes, stiffnesses, st.integers(-4, 4))
def test_scaling_all_mobilities_by_a_power_of_two_changes_no_bit(seed, cells, stiffness, power):
    mobilities = np.array(spread(seed, cells, 30.0))
    chain = chain_of(seed, cells, stiffness, mobilities)
    assert not differs(chain.cycle().path, moved(chain, mobilities * 2.0**power).cycle().path)


@pytest.mark.slow
@given(seeds, sizes, stiffnesses, st.floats(0.1, 10.0))
def test_scaling_all_mobilities_changes_no_landing(seed, cells, stiffness, factor):
    mobilities = np.array(spread(seed, cells, 30.0))
    chain = chain_of(seed, cells, stiffness, mobilities)
    ours, theirs = chain.cycle(), moved(chain, mobilities * factor).cycle()
    assume(not ours.degenerate and not theirs.degenerate)
    assert [e.arrivals for e in ours.events] == [e.arrivals for e in theirs.events]
    # With friction every place near by is a rest too: where a snap ends among them is as good as
    # the integration, whose way out of an unstable state rounding decides. In 400 chains at random
    # the largest difference was 5e-5 of the stroke.
    blur = 1e-4 if any(cell.friction for cell in chain.cells) else 1e-9
    for a, b in zip(ours.events, theirs.events, strict=True):
        assert a.after == pytest.approx(b.after, abs=blur * chain.full_stroke)


@pytest.mark.slow
@given(seeds, sizes)
def test_under_a_force_nothing_depends_on_mobility(seed, cells):
    chain = chain_of(seed, cells, 0.0)
    ours, theirs = chain.cycle(), moved(chain, spread(seed, cells, 1e4)).cycle()
    # Slack cells that carry no force together share what there is to go: a tie.
    assume(not ours.degenerate)
    assert not differs(ours.path, theirs.path)


@pytest.mark.slow
@given(seeds, st.floats(-2.0, 2.0))
def test_a_pair_under_a_stroke_lands_the_same_whatever_its_mobilities(seed, decades):
    chain = any_chain(np.random.default_rng(seed), 2, friction=False)
    ours = chain.cycle()
    theirs = moved(chain, [1.0, 10.0**decades]).cycle()
    assume(not ours.degenerate and not theirs.degenerate)
    assert ours.sequence == theirs.sequence
    for a, b in zip(ours.events, theirs.events, strict=True):
        assert (a.kind, a.cells, a.drive) == (b.kind, b.cells, b.drive)
        assert a.after == pytest.approx(b.after, abs=1e-9 * chain.full_stroke)
        assert a.released == pytest.approx(b.released, abs=1e-9)


@pytest.mark.slow
@given(seeds, st.integers(2, 6), st.floats(1.0, 1e3))
def test_concave_cells_snap_in_the_order_of_their_forces_unless_a_third_one_joins(
    seed, cells, ratio
):
    chain = concave_chain(np.random.default_rng(seed), cells)
    uneven = moved(chain, spread(seed, cells, ratio))
    ours, theirs = chain.cycle(), uneven.cycle()
    assume(not ours.degenerate and not theirs.degenerate)
    assume(all(len(e.cells) <= 2 for cycle in (ours, theirs) for e in cycle.snaps))
    assert ours.sequence == theirs.sequence
    for a, b in zip(ours.events, theirs.events, strict=True):
        assert a.after == pytest.approx(b.after, abs=1e-9 * chain.full_stroke)


# At 45.985 mm the third of these cells sets off a snap, and the first one joins it: then that is
# the one left in transit. Where it is slow, or where the second one takes up travel so slowly that
# λ hardly dips, it does not leave its stop.
THREE = ((9.405, 2.068, 53.935), (18.983, -8.699, 55.823), (8.011, -10.351, 15.018))
JOINS = {0: 5.985e-3, 1: 20e-3, 2: 20e-3}
PAIR = {1: 20e-3, 2: 5.985e-3}
LANDINGS = [
    ((1.0, 1.0, 1.0), JOINS),
    ((1.0, 1.0, 0.01), JOINS),
    ((0.01, 1.0, 1.0), PAIR),
    ((1.0, 0.01, 1.0), PAIR),
]


@pytest.mark.parametrize(("mobility", "landing"), LANDINGS)
def test_where_a_third_cell_joins_a_snap_mobility_decides_where_it_lands(mobility, landing):
    cells = [
        sw.Cell(sw.Band((0, 0), (x * 1e-3, y * 1e-3), stiffness=k), mobility=m)
        for (x, y, k), m in zip(THREE, mobility, strict=True)
    ]
    snap = next(snap for snap in sw.Chain(cells).cycle().snaps if snap.drive > 40e-3)
    assert snap.drive == pytest.approx(45.985e-3, abs=1e-6)
    assert dict(zip(snap.cells, snap.after, strict=True)) == pytest.approx(landing, abs=1e-6)


def test_cells_of_constant_force_share_the_stroke_by_mobility():
    chain = sw.Chain([constant(0.1, mobility=m) for m in (1.0, 3.0, 0.5)])
    path = chain.path([0.0, 0.0135, 0.018])
    at = {round(u, 9): s for u, s in zip(path.stroke.tolist(), path.travel, strict=True)}
    assert at[0.0135] == pytest.approx([0.003, 0.009, 0.0015])
    # The second one is full at 15 mm, the others share what is left, 2 to 1.
    assert path.end == pytest.approx([0.010 / 3 + 0.002, 0.010, 0.005 / 3 + 0.001])
    alike = moved(chain, [1.0]).path([0.0, 0.0135])
    assert alike.end == pytest.approx([0.0045] * 3)


def test_of_cells_of_constant_force_the_preferred_one_goes_first_however_slow_it_is():
    chain = sw.Chain([constant(0.1, mobility=m) for m in (1.0, 1e2)])
    assert chain.path([0.0, 0.008], prefer=[0, 1]).end == pytest.approx([0.008, 0.0])


def test_side_by_side_dampers_add_up():
    elements = [trilinear(1.0, 2.0), trilinear(0.5, 0.5), trilinear(0.8, 4.0)]
    together = sw.Element.side_by_side(elements)
    assert 1 / together.mobility == pytest.approx(sum(1 / e.mobility for e in elements))
    assert sw.Element.side_by_side(elements[:1] * 2).mobility == 1.0
    # In whatever order they are put together.
    for first, second in combinations(range(3), 2):
        (third,) = {0, 1, 2} - {first, second}
        pair = sw.Element.side_by_side([elements[first], elements[second]])
        nested = sw.Element.side_by_side([pair, elements[third]])
        assert nested.mobility == pytest.approx(together.mobility)


MAKERS = {
    "from_points": lambda m: sw.Element.from_points([0, 1e-3], [0, 1.0], mobility=m),
    "from_table": lambda m: sw.Element.from_table([0, 1e-3, 2e-3], [0, 1.0, 3.0], mobility=m),
    "from_law": lambda m: sw.Element.from_law(lambda s: 1e3 * s, 0.0, 1e-3, mobility=m),
    "from_curve": lambda m: sw.Element.from_curve([0, 1e-3, 2e-3], [0, 1.0, 3.0], mobility=m),
    "cell": lambda m: sw.Cell(sw.Band((0, 0), (0.010, 0.005)), mobility=m),
}


@pytest.mark.parametrize("maker", list(MAKERS))
def test_mobility_is_kept_replaced_and_bounded(maker):
    make = MAKERS[maker]
    assert make(2.5).mobility == 2.5
    assert replace(make(1.0), mobility=0.25) == make(0.25) != make(1.0)
    assert replace(make(7), friction=0.01).mobility == 7.0
    for bound in MOBILITIES:
        assert make(bound).mobility == bound
    for beyond in (MOBILITIES[0] * 0.999, MOBILITIES[1] * 1.001, 0.0, -1.0):
        with refuses(ValueError, "mobility = ", "0.01 and 100", "ratio"):
            make(beyond)
    for nothing in (math.nan, math.inf):
        with pytest.raises(ValueError, match="mobility"):
            make(nothing)


def test_mobilities_are_reported_beside_the_fastest():
    cells = [trilinear(1.0, m) for m in (0.5, 2.0, 1.0)]
    assert mobilities_of(cells).tolist() == [0.25, 1.0, 0.5]


@pytest.mark.slow
@given(seeds, st.integers(3, 6), stiffnesses, st.integers(0, 5))
def test_one_slow_cell_beside_fast_ones_lands_and_is_certified(seed, cells, stiffness, which):
    mobilities = [1.0] * cells
    mobilities[which % cells] = MOBILITIES[0]
    chain = chain_of(seed, cells, stiffness, mobilities)
    path = chain.cycle().path
    scale = float(np.max(np.abs(path.force)))
    assert np.max(path.residual) <= 1e-8 * max(scale, 1.0)
    assert path.work == pytest.approx(
        path.dissipated, abs=1e-8 * max(scale, 1.0) * chain.full_stroke
    )
    assert all(snap.released >= -1e-12 * max(scale, 1.0) for snap in path.events)
