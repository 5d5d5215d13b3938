"""What must hold for every chain, whatever its cells."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st

import stepwell as sw
from chains import any_chain, concave_chain
from sizes import examples
from stepwell.statics import Cause

seeds = st.integers(0, 2**32 - 1)
sizes = st.integers(2, 4)


def chain_of(seed: int, cells: int, *, friction: bool = True, stiffness: float = math.inf):
    chain = any_chain(np.random.default_rng(seed), cells, friction)
    return replace(chain, actuator_stiffness=stiffness)


def scale_of(chain: sw.Chain) -> float:
    """Largest force of any cell [N]."""
    return max(
        float(np.max(np.abs(c.force(np.linspace(-c.limit, c.limit, 200))))) for c in chain.levers
    )


def mirrored(cell: sw.Cell) -> sw.Cell:
    bands = tuple(replace(b, q=(b.q[0], 2 * b.p[1] - b.q[1])) for b in cell.bands)
    load = None
    if cell.load is not None:
        travel = tuple(cell.full_travel - s for s in reversed(cell.load.travel))
        load = sw.Load(travel, tuple(-f for f in reversed(cell.load.force)))
    return replace(cell, band=bands, load=load)


def scaled(cell: sw.Cell, factor: float) -> sw.Cell:
    bands = tuple(replace(b, stiffness=b.stiffness * factor) for b in cell.bands)
    load = cell.load and replace(cell.load, force=tuple(f * factor for f in cell.load.force))
    return replace(cell, band=bands, load=load, friction=cell.friction * factor)


@given(seeds)
def test_force_is_the_derivative_of_energy(seed):
    cell = any_chain(np.random.default_rng(seed), 1).levers[0]
    step = 1e-5 * cell.full_travel
    s = np.linspace(2 * step, cell.full_travel - 2 * step, 500)

    def energy(travel):
        return cell.energy(cell.angle(travel))

    slope = (8 * (energy(s + step) - energy(s - step)) - energy(s + 2 * step)
             + energy(s - 2 * step)) / (12 * step)  # fmt: skip
    force = cell.force(cell.angle(s))
    # A kink between the points of the difference costs half its jump in slope times the step.
    assert np.allclose(slope, force, atol=1e-4 * max(np.max(np.abs(force)), 1e-3))


@pytest.mark.slow
@given(seeds, sizes)
def test_every_point_is_a_certified_stable_equilibrium(seed, cells):
    chain = chain_of(seed, cells)
    path = chain.cycle().path
    assert np.max(path.residual) <= 1e-9 * scale_of(chain)
    stiffest = scale_of(chain) / min(c.full_travel for c in chain.cells)
    # At a fold the least stiffness is zero, but for rounding; at a kink from which the chain snaps
    # that of the softer side is below.
    lost = {tuple(travel) for travel in path.travel[path.snap_after]}
    kept = [tuple(travel) not in lost for travel in path.travel]
    assert np.min(path.stability[kept]) >= -1e-5 * stiffest


@pytest.mark.slow
@given(seeds, sizes)
def test_travels_add_up_to_the_stroke_and_stay_between_the_stops(seed, cells):
    chain = chain_of(seed, cells)
    path = chain.cycle().path
    assert np.allclose(path.drive, path.stroke, rtol=0, atol=1e-9 * chain.full_stroke)
    full = np.array([c.full_travel for c in chain.cells])
    assert np.all(path.travel >= 0) and np.all(path.travel <= full)
    assert np.all(path.end == 0)


@pytest.mark.slow
@given(seeds, sizes, st.sampled_from([math.inf, 500.0, 50.0, 0.0]))
def test_energy_falls_at_every_snap(seed, cells, stiffness):
    chain = chain_of(seed, cells, stiffness=stiffness)
    for snap in chain.cycle().snaps:
        assert snap.released >= -1e-12 * scale_of(chain) * chain.full_stroke


# Samples of a stretch: the trapezoids are then within 1e-5 of the scale (measured on 120 chains),
# and the tests ask for 2e-4.
SAMPLES = 150


@pytest.mark.slow
@given(seeds, sizes, st.sampled_from([math.inf, 500.0, 50.0]))
def test_work_over_a_closed_cycle_equals_the_dissipation(seed, cells, stiffness):
    chain = chain_of(seed, cells, stiffness=stiffness)
    cycle = chain.cycle()
    path = cycle.path.resampled(SAMPLES)
    # Integrated from the samples alone, so that the engine's own books are not asked.
    work = float(np.trapezoid(path.force, path.drive))
    unit = scale_of(chain) * chain.full_stroke
    assert work == pytest.approx(cycle.dissipated, abs=2e-4 * unit)
    assert cycle.path.work == pytest.approx(cycle.dissipated, abs=1e-9 * unit)


@pytest.mark.slow
@given(seeds, sizes)
def test_work_is_booked_on_open_paths_too(seed, cells):
    chain = chain_of(seed, cells)
    path = chain.path([0.0, 0.7 * chain.full_stroke, 0.3 * chain.full_stroke]).resampled(SAMPLES)
    work = float(np.trapezoid(path.force, path.drive))
    assert work == pytest.approx(path.work, abs=2e-4 * scale_of(chain) * chain.full_stroke)


@pytest.mark.slow
@given(seeds, st.integers(1, 3))
def test_tabulated_bands_are_followed_as_exactly_as_formulas(seed, cells):
    rng = np.random.default_rng(seed)
    made = []
    for cell in any_chain(rng, cells).levers:
        # Any curve through a handful of points, falling stretches included.
        extension = np.concatenate([[0.0], np.sort(rng.uniform(0.002, 0.04, 5))])
        assume(np.min(np.diff(extension)) > 1e-4)
        shape = np.concatenate([[0.0], rng.uniform(0.0, 0.03, 5)])
        table = sw.Table(tuple(extension), tuple(shape))
        bands = tuple(replace(b, law=table, two_sided=False) for b in cell.bands)
        made.append(replace(cell, band=bands))
    chain = sw.Chain(made)
    cycle = chain.cycle()
    path = cycle.path.resampled(SAMPLES)
    unit = scale_of(chain)
    assert np.max(path.residual) <= 1e-9 * unit
    assert all(snap.released >= -1e-12 * unit * chain.full_stroke for snap in cycle.snaps)
    work = float(np.trapezoid(path.force, path.drive))
    assert work == pytest.approx(cycle.dissipated, abs=2e-4 * unit * chain.full_stroke)


@pytest.mark.slow
@given(seeds, sizes)
def test_turning_the_machine_over_swaps_loading_and_unloading(seed, cells):
    chain = chain_of(seed, cells)
    cycle = chain.cycle()
    turned = replace(chain, cells=tuple(mirrored(c) for c in chain.levers)).cycle()
    assume(not cycle.degenerate and not turned.degenerate)
    full = chain.full_stroke
    # What friction takes in a snap of three cells or more is integrated, not exact.
    exact = all(cell.friction == 0 for cell in chain.cells)
    blur = (1e-6 if exact else 1e-4) * scale_of(chain) * full
    for way in (1, -1):
        ours = [(e.kind, e.stroke, e.released) for e in cycle.events if e.direction == way]
        theirs = [
            (e.kind, full - e.stroke, e.released) for e in turned.events if e.direction != way
        ]
        assert [o[0] for o in ours] == [t[0] for t in theirs]
        for (_, u, released), (_, v, twin) in zip(ours, theirs, strict=True):
            assert u == pytest.approx(v, abs=1e-7 * full)
            assert released == pytest.approx(twin, abs=blur)


@pytest.mark.slow
@given(seeds, sizes, st.floats(-0.02, 0.02), st.floats(-0.02, 0.02))
def test_shifting_both_anchors_together_changes_nothing(seed, cells, x, y):
    chain = any_chain(np.random.default_rng(seed), cells)
    moved = replace(
        chain,
        cells=tuple(
            replace(
                c,
                band=tuple(
                    replace(b, p=(b.p[0] + x, b.p[1] + y), q=(b.q[0] + x, b.q[1] + y))
                    for b in c.bands
                ),
            )
            for c in chain.levers
        ),
    )
    ours, theirs = chain.cycle(), moved.cycle()
    assume(not ours.degenerate)
    assert ours.sequence == theirs.sequence
    assert ours.dissipated == pytest.approx(theirs.dissipated, rel=1e-6, abs=1e-12)


@pytest.mark.slow
@given(seeds, sizes, st.floats(0.01, 100.0))
def test_scaling_every_force_scales_the_forces_and_leaves_the_sequence(seed, cells, factor):
    chain = chain_of(seed, cells)
    stiffer = replace(chain, cells=tuple(scaled(c, factor) for c in chain.levers))
    ours, theirs = chain.cycle(), stiffer.cycle()
    assume(not ours.degenerate)
    assert ours.sequence == theirs.sequence
    assert theirs.peak_force == pytest.approx(factor * ours.peak_force, rel=1e-9)
    strokes = [e.stroke for e in ours.events]
    assert [e.stroke for e in theirs.events] == pytest.approx(strokes, abs=1e-7 * chain.full_stroke)


@pytest.mark.slow
@given(seeds, sizes, st.randoms(use_true_random=False))
def test_permuting_the_cells_permutes_the_sequence(seed, cells, random):
    chain = chain_of(seed, cells)
    order = list(range(cells))
    random.shuffle(order)
    shuffled = replace(chain, cells=tuple(chain.cells[i] for i in order))
    ours, theirs = chain.cycle(), shuffled.cycle()
    assume(not ours.degenerate and not theirs.degenerate)
    expected = ["".join(state[i] for i in order) for state in ours.sequence]
    assert list(theirs.sequence) == expected


@pytest.mark.slow
@given(seeds, sizes, st.floats(0.05, 0.95), st.floats(0.05, 0.95))
def test_a_stretch_without_event_is_retraced_exactly(seed, cells, at, share):
    chain = chain_of(seed, cells, friction=False)
    there = chain.cycle()
    assume(not there.degenerate)
    marks = sorted({0.0, *(e.drive for e in there.events if e.direction > 0), chain.full_stroke})
    k = min(int(at * (len(marks) - 1)), len(marks) - 2)
    low, high = marks[k], marks[k + 1]
    assume(high - low > 1e-3 * chain.full_stroke)
    near, far = low + 0.1 * share * (high - low), low + 0.9 * (high - low)
    straight = chain.path([0.0, near])
    back = chain.path([0.0, far, near])
    assume(not straight.degenerate and not back.degenerate)
    assert np.allclose(straight.end, back.end, rtol=0, atol=1e-9 * chain.full_stroke)


@pytest.mark.slow
@given(seeds, sizes, st.sampled_from([math.inf, 300.0]))
def test_every_snap_meets_its_stated_condition(seed, cells, stiffness):
    chain = chain_of(seed, cells, friction=False, stiffness=stiffness)
    cycle = chain.cycle()
    softness = 0.0 if math.isinf(stiffness) else 1.0 / stiffness
    for snap in cycle.snaps:
        inside = [
            (chain.levers[c], s)
            for c, s in zip(snap.cells, snap.before, strict=True)
            if 1e-6 < s / chain.levers[c].full_travel < 1 - 1e-6
        ]
        if snap.cause is Cause.FOLD:
            slopes = [_slopes(cell, s) for cell, s in inside]
            if not smooth_fold(slopes, softness):
                # At a kink the slope jumps: stable with one side's slopes, not with another's.
                verdicts = {is_stable(sides, softness) for sides in itertools.product(*slopes)}
                assert verdicts == {True, False}
        else:
            at_stop = [
                (chain.levers[c], s)
                for c, s in zip(snap.cells, snap.before, strict=True)
                if s in (0.0, chain.levers[c].full_travel)
            ]
            assert any(
                float(c.force(c.angle(s))) == pytest.approx(snap.force_before, abs=1e-8)
                for c, s in at_stop
            )


def smooth_fold(slopes: list[tuple[float, float]], softness: float) -> bool:
    """Whether Σ 1/κ + 1/K vanishes next to its own terms."""
    inverse = [1.0 / sides[0] if sides[0] else 1e300 for sides in slopes]
    return abs(softness + sum(inverse)) <= 1e-3 * sum(map(abs, inverse))


def is_stable(slopes: tuple[float, ...], softness: float) -> bool:
    """The rule of the theory page, from finite differences."""
    falling = sum(slope < 0 for slope in slopes)
    compliance = softness + sum(1.0 / slope if slope else 1e300 for slope in slopes)
    return falling == 0 or (falling == 1 and compliance < 0)


def _slopes(cell: sw.Cell, s: float) -> tuple[float, float]:
    step = 1e-6 * cell.full_travel

    def force(travel):
        return float(cell.force(cell.angle(travel)))

    return (force(s) - force(s - step)) / step, (force(s + step) - force(s)) / step


@pytest.mark.slow
@given(seeds, st.integers(2, 8))
def test_concave_cells_load_by_ascending_f0_and_unload_by_descending_f1(seed, cells):
    chain = concave_chain(np.random.default_rng(seed), cells)
    cycle = chain.cycle()
    assume(not cycle.degenerate)
    f0 = [c.force_0 for c in chain.levers]
    f1 = [c.force_1 for c in chain.levers]
    assert list(cycle.loading_order) == list(np.argsort(f0))
    assert list(cycle.unloading_order) == list(np.argsort(f1)[::-1])
    assert len(cycle.sequence) == 2 * cells + 1


@pytest.mark.slow
@given(seeds, sizes)
def test_a_very_stiff_actuator_acts_like_a_prescribed_stroke(seed, cells):
    chain = concave_chain(np.random.default_rng(seed), cells)
    rigid = chain.cycle()
    assume(not rigid.degenerate)
    stiff = replace(chain, actuator_stiffness=1e8).cycle()
    assert stiff.sequence == rigid.sequence
    assert stiff.dissipated == pytest.approx(rigid.dissipated, abs=1e-6)


@pytest.mark.slow
@given(seeds, st.integers(1, 6), st.sampled_from([0.0, 1e-3]))
def test_a_prescribed_force_and_a_very_soft_actuator_make_a_preisach_set(seed, cells, stiffness):
    rng = np.random.default_rng(seed)
    chain = replace(concave_chain(rng, cells), actuator_stiffness=stiffness)
    f0 = np.array([c.force_0 for c in chain.levers])
    f1 = np.array([c.force_1 for c in chain.levers])
    low, high = min(f1.min(), f0.min()) - 0.1, max(f0.max(), f1.max()) + 0.1
    fields = np.array([low, *rng.uniform(low, high, 12)])
    # A soft spring's force still falls by K times the stroke: keep that far from a threshold.
    blur = stiffness * chain.full_stroke
    assume(np.min(np.abs(np.subtract.outer(fields, np.concatenate([f0, f1])))) > 2 * blur + 1e-9)
    state = np.zeros(cells, bool)
    for n, field in enumerate(fields):
        # A plain Preisach simulation: each hysteron for itself, no mechanics.
        rising = n == 0 or field > fields[n - 1]
        state = state | (field >= f0) if rising else state & (field > f1)
    path = chain.path((fields if stiffness == 0 else fields / stiffness).tolist())
    full = np.array([c.full_travel for c in chain.cells])
    assert np.array_equal(path.end, state * full)


@pytest.mark.slow
@settings(max_examples=examples(40, full=2000))
@given(seeds, st.integers(1, 6), st.sampled_from([math.inf, 1000.0, 100.0, 20.0, 0.0]))
def test_no_chain_and_no_list_of_turning_points_defeats_the_follower(seed, cells, stiffness):
    chain = chain_of(seed, cells, stiffness=stiffness)
    rng = np.random.default_rng(seed)
    cycle = chain.cycle()
    points = [cycle.path.turning_points[0]]
    points += list(rng.uniform(points[0], cycle.path.turning_points[1], 6))
    path = chain.path(points)
    assert np.max(path.residual) <= 1e-8 * scale_of(chain)
    assert path.drive[-1] == pytest.approx(points[-1], abs=1e-9 * max(map(abs, points)))
