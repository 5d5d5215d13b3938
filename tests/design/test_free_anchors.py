"""Promises about which anchors the designer places, and about bands whose law bends."""

import itertools
import math

import numpy as np
import pytest

import stepwell as sw
from facts import refuses
from stepwell.design import AnchorBox, BandType, Impossible
from stepwell.design.synthesis.candidates import Kind

CYCLE = "00>10>11>01>00"
THREE = "000>100>110>111>011>001>000"
HOLES = 0.005


def test_placing_p_beside_a_fixed_q_is_placing_q_in_the_mirror():
    over = {"holes": HOLES, "samples": 20}
    q_placed = sw.design(THREE, **over)
    p_placed = sw.design(THREE, free="p", **over)
    np.testing.assert_allclose(p_placed.forces, q_placed.forces, rtol=1e-12)
    assert p_placed.proved == q_placed.proved
    assert p_placed.chain.cycle().sequence == THREE
    for ours, theirs in zip(p_placed.chain.cells, q_placed.chain.cells, strict=True):
        assert isinstance(ours, sw.Cell)
        assert isinstance(theirs, sw.Cell)
        assert ours.bands[0].q == (0.010, 0.0)
        assert ours.bands[0].d == pytest.approx(theirs.bands[0].d)
    assert "p (" in str(p_placed)


def test_a_fixed_q_may_be_anywhere():
    designed = sw.design(CYCLE, free="p", q=(0.012, 0.002), samples=20)
    for cell in designed.chain.cells:
        assert isinstance(cell, sw.Cell)
        assert cell.bands[0].q == (0.012, 0.002)
        x, y = cell.bands[0].p
        assert -0.020 <= x <= 0.0
        assert -0.015 <= y <= 0.015


@pytest.mark.slow
def test_both_anchors_are_mirror_images_and_no_other_choice_of_holes_is_surer():
    box = AnchorBox(0.0, 0.010, -0.005, 0.005)
    designed = sw.design(CYCLE, free="both", within=box, holes=HOLES, objective="worst", samples=20)
    assert designed.proved
    assert designed.robustness is not None
    for cell in designed.chain.cells:
        assert isinstance(cell, sw.Cell)
        (px, py), (qx, qy) = cell.bands[0].p, cell.bands[0].q
        assert (px, py) == (-qx, -qy)
    places = itertools.product((0.0, 0.005, 0.010), (-0.005, 0.0, 0.005))
    cells = [sw.Cell(sw.Band((-x, -y), (x, y))) for x, y in places if x > 0.0]
    surest = 0.0
    for pair in itertools.permutations(cells, 2):
        chain = sw.Chain(pair)
        if chain.cycle().sequence != CYCLE or chain.cycle().degenerate:
            continue
        try:
            surest = max(surest, chain.robustness().radius)
        except ValueError:
            continue
    assert designed.robustness.radius == pytest.approx(surest, rel=1e-6)


def test_what_is_free_is_reported_where_no_design_exists():
    box = AnchorBox(-0.011, -0.009, -0.001, 0.001)
    with refuses(Impossible, "anchors p", "holes", "2 mm apart", "-11 to -9", "mm"):
        sw.design(CYCLE, free="p", within=box, holes=0.002, most_force=0.1)
    with pytest.raises(ValueError, match=r"free = 'd': .*\('q', 'p', 'both'\)"):
        sw.design(CYCLE, free="d")


def rubber() -> sw.Band:
    """A band that softens and stiffens again, as a table of a tension test has it."""
    extension = np.linspace(0.0, 0.05, 12)
    tension = 28.5 * extension * (1.0 - 8.0 * extension + 90.0 * extension**2)
    return sw.Band.from_table((0.0, 0.0), (0.0, 0.0), 0.010, extension.tolist(), tension.tolist())


def test_what_a_bent_law_gives_is_what_its_cells_do():
    band = rubber()
    kind = Kind(BandType.of(band), 0.014, math.pi / 4)
    rng = np.random.default_rng(0)
    d = rng.uniform((0.01, -0.015), (0.03, 0.015), (20, 2))
    force, slope = kind.ends(d)
    by_rest, by_lever = kind.by_sizes(d)
    step = 1e-7

    def ends(dx: float, dy: float, rest: float = 0.010, lever: float = 0.014) -> np.ndarray:
        made = sw.Band((0.0, 0.0), (dx, dy), band.stiffness, rest, band.law)
        cell = sw.Cell(made, lever)
        return np.array([cell.force_0, cell.force_1])

    for i, (dx, dy) in enumerate(d.tolist()):
        here = ends(dx, dy)
        np.testing.assert_allclose(force[i], here, rtol=1e-9)
        np.testing.assert_allclose(slope[i, :, 0], (ends(dx + step, dy) - here) / step, rtol=1e-3)
        np.testing.assert_allclose(slope[i, :, 1], (ends(dx, dy + step) - here) / step, rtol=1e-3)
        np.testing.assert_allclose(
            by_rest[i], (ends(dx, dy, 0.010 + step) - here) / step, rtol=1e-3
        )
        longer = ends(dx, dy, lever=0.014 + step)
        np.testing.assert_allclose(by_lever[i], (longer - here) / step, rtol=1e-3, atol=1e-3)


def test_a_straight_law_is_the_same_by_looking_as_in_closed_form():
    kind = Kind(BandType(), 0.014, math.pi / 4)

    class Bent(Kind):
        @property
        def bends(self):
            return True

    bent = Bent(BandType(), 0.014, math.pi / 4)
    d = np.random.default_rng(1).uniform((0.01, -0.015), (0.03, 0.015), (40, 2))
    for closed, looked in zip(
        (*kind.ends(d), *kind.by_sizes(d)), (*bent.ends(d), *bent.by_sizes(d)), strict=True
    ):
        np.testing.assert_allclose(looked, closed, rtol=1e-6, atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("holes", [None, HOLES])
def test_measured_bands_are_placed_and_the_engine_decides(holes):
    designed = sw.design(THREE, bands=[BandType.of(rubber(), 0.04)], holes=holes, samples=20)
    assert designed.chain.cycle().sequence == THREE
    assert not designed.proved
    assert "no proof" in designed.assumptions
    assert designed.yield_.by_engine == 20
    assert designed.yield_.tolerances.stiffness == 0.04
    for cell in designed.chain.cells:
        assert isinstance(cell, sw.Cell)
        assert cell.bands[0].law == rubber().law


def test_nothing_is_called_impossible_of_measured_bands_but_what_the_engine_has_tried():
    box = AnchorBox(0.009, 0.021, -0.001, 0.001)
    with pytest.raises(Impossible) as why:
        sw.design("00>10>11>10>00", bands=[BandType.of(rubber())], within=box, holes=0.010)
    assert "simulated" in str(why.value) and why.value.proved


def test_the_worst_case_is_refused_of_a_bent_law():
    with refuses(ValueError, "objective = 'worst'", "linear bands", "'yield'"):
        sw.design(CYCLE, bands=[BandType.of(rubber())], objective="worst")
