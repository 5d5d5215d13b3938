"""The pair on holes whose snap sets the most energy free, against the engine and bounds."""

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest

import stepwell as sw
from chains import concave_chain
from facts import refuses
from stepwell.design import BandType, Impossible, Means, strongest_snap
from stepwell.statics import EventKind

BAND = BandType(630.0, 0.010)
FEW = Means(pitch=0.010, depth=0.020, side=0.015, stretch=5.6)


def released(chain: sw.Chain) -> float:
    """Energy of the strongest snap of loading over k S² [1]."""
    events = chain.cycle().path.events
    snaps = [e.released for e in events if e.kind is EventKind.SNAP and e.direction > 0]
    return max(snaps, default=0.0)


def pair(*anchors: tuple[float, float]) -> sw.Chain:
    bands = [sw.Band((0.0, 0.0), d, BAND.stiffness, BAND.rest_length) for d in anchors]
    return sw.Chain([sw.Cell(band, unusual=True) for band in bands])


@pytest.fixture(scope="module")
def best():
    return strongest_snap(BAND, FEW)


def test_no_pair_on_these_holes_sets_more_energy_free(best):
    rng, across, along = np.random.default_rng(0), (0, 0.01, 0.02, 0.03, 0.04), (-0.02, 0.0, 0.02)
    ends = [*product(across, along)]
    for _ in range(30):
        one, other = rng.choice(len(ends), 2, replace=False)
        chain = pair(ends[one], ends[other])
        bands = [band for cell in chain.levers for band in cell.bands]
        angles = np.linspace(-math.pi / 4, math.pi / 4, 41)
        longest = max(np.max(b.length(angles, 0.010 * math.sqrt(2.0))) for b in bands)
        stretch = max(cell.largest_stretch for cell in chain.levers)
        assert longest <= stretch * BAND.rest_length * (1.0 + 1e-12)
        falls = all(np.all(np.diff(c.force(angles)) < 0.0) for c in chain.levers)
        if longest <= FEW.stretch * BAND.rest_length and falls:
            assert released(chain) <= best.released * (1.0 + 1e-6)


def test_the_engine_finds_the_energy_and_the_stretch(best):
    assert released(best.chain) == pytest.approx(best.released)
    assert best.stretch <= FEW.stretch
    assert best.energy == best.released <= best.bound
    for cell in best.chain.cells:
        steps = [x / FEW.pitch for b in cell.bands for x in (*b.p, *b.q)]
        assert steps == pytest.approx(np.round(steps))


def test_the_pair_of_the_feasibility_study_sets_free_1_47():
    # Issue 39: d = (40, -10) and (8, 30) mm, ℓ0 = 10 mm, S = 20 mm.
    chain = pair((0.040, -0.010), (0.008, 0.030))
    assert released(chain) / (BAND.stiffness * 0.020**2) == pytest.approx(1.47, abs=0.005)


def test_a_weak_actuator_and_short_bands_limit_it(best):
    weak = strongest_snap(BAND, FEW._replace(force=0.5 * abs(best.peak_force)))
    short = strongest_snap(BAND, FEW._replace(stretch=4.0))
    assert abs(weak.peak_force) <= 0.5 * abs(best.peak_force) * (1.0 + 1e-9)
    assert weak.released < best.released
    assert short.released < best.released
    assert weak.bound == pytest.approx(2.0 * 0.5 * abs(best.peak_force) * 0.020)


@pytest.mark.parametrize(
    ("means", "load", "facts"),
    [
        ({"force": 0.1}, 0.0, ("with any force", "none within 0.1 N", "softer band")),
        ({"stretch": 2.0}, 0.0, ("0 of these with", "longer stretch")),
        ({}, 100.0, ("none with 100 N", "stiffer band")),
    ],
)
def test_without_a_pair_the_reason_has_the_anchors_of_each_condition(means, load, facts):
    with refuses(Impossible, "differences q - p", *facts):
        strongest_snap(BAND, FEW._replace(**means), load=load)


def test_the_latch_carries_the_load_and_friction_acts_on_both_cells(best):
    heavy = strongest_snap(BAND, FEW, load=6.0)
    assert heavy.energy == pytest.approx(heavy.released - 6.0 * heavy.foot_travel)
    assert heavy.energy < best.energy
    latch, spring = heavy.chain.levers
    loaded = sw.Chain([replace(latch, load=sw.Load.constant(6.0)), spring])
    assert released(loaded) == pytest.approx(heavy.energy, rel=1e-6)
    rough = strongest_snap(BAND, FEW._replace(friction=0.2))
    assert [cell.friction for cell in rough.chain.levers] == [0.2, 0.2]
    assert rough.energy < best.energy
    with refuses(ValueError, "must be > 6 N"):
        strongest_snap(BAND, FEW._replace(force=6.0), load=6.0)


def test_no_pair_of_cells_exceeds_the_bound_of_the_stretch():
    # Theory, "Energy of one snap": a band gets shorter by at most the travel of its cell.
    rng, full = np.random.default_rng(7), 0.020
    for _ in range(20):
        chain = pair(*rng.uniform((0.0, -0.03), (0.04, 0.03), (2, 2)))
        reach = (max(cell.largest_stretch for cell in chain.levers) - 1.0) * BAND.rest_length
        most = BAND.stiffness * (reach**2 - max(reach - full, 0.0) ** 2)
        unit = BAND.stiffness * full**2
        assert released(chain) * unit <= most


def test_more_cells_set_no_more_energy_free_than_two_of_them():
    # Theory, "Energy of one snap": before and after a snap the same cells but two are full.
    rng = np.random.default_rng(5)
    for _ in range(8):
        chain = concave_chain(rng, int(rng.integers(3, 6)))
        full = chain.cells[0].full_travel
        s = np.linspace(0.0, full, 401)
        energies = [cell.energy_at(s) for cell in chain.cells]
        pairs = [np.max(a[-1] - a + b - b[-1]) for a in energies for b in energies if a is not b]
        assert released(chain) <= max(pairs) * (1.0 + 1e-4)
