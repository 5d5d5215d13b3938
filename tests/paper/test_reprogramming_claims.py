"""What the antennas have to do follows from the bands, and another robot is judged otherwise."""

from dataclasses import replace

import pytest

from facts import says
from stepwell.paper import Judgement, steering as _antennas
from stepwell.sequences import Pathway


def verdict(q_mm: int):
    (claim,) = (claim for claim in _antennas.ANTENNA_CLAIMS if claim.id == f"antennas-bench-{q_mm}")
    return claim.judge()


@pytest.mark.parametrize(
    ("q_mm", "bands", "p_mm"),
    # With one band on each cell both are alike, so both need the same q - p.
    [
        *((20, 1.0, -20.0), (20, 1.25, -16.622), (20, 2.0, -11.243)),
        *((14, 1.0, -14.0), (14, 1.25, -11.625), (14, 2.0, -7.808)),
    ],
)
def test_the_place_that_turns_the_pair_round(q_mm, bands, p_mm):
    change = _antennas.turning(q_mm * 1e-3, bands)
    assert change.method == "exact"
    assert change.anchor_at[0] * 1e3 == pytest.approx(p_mm, abs=1e-3)
    assert change.anchor_at[1] == 0.0
    assert change.before == Pathway.CLOCKWISE.value
    assert change.after == Pathway.COUNTERCLOCKWISE.value


@pytest.mark.parametrize("bands", [1.0, 1.25, 2.0])
def test_the_outer_force_is_the_inner_one_there(bands):
    # F0 = k (1 - ℓ0/ℓ) d_x at 45° and d_y = 0; ℓ = |(10 + d_x, 10)| mm.
    change = _antennas.turning(0.020, bands)
    dx = 10.0 - change.anchor_at[0] * 1e3
    length = ((10.0 + dx) ** 2 + 100.0) ** 0.5
    outer = (1 - 22.0 / (40.0**2 + 100.0) ** 0.5) * 30.0
    assert bands * (1 - 22.0 / length) * dx == pytest.approx(outer, rel=1e-9)


def test_how_many_bands_there_are_decides_and_is_not_said():
    for q_mm, places in ((20, ("-20.0", "-16.6", "-11.2")), (14, ("-14.0", "-11.6", "-7.8"))):
        judged = verdict(q_mm)
        assert judged.verdict is Judgement.UNDETERMINED
        for place, label in zip(places, _antennas.BANDS, strict=True):
            assert f"{place} mm ({label})" in judged.ours
        says(judged.reason, "not say", "how many bands")


@pytest.mark.parametrize(("bands", "most"), [(1.25, 13.25), (2.0, 19.57)])
def test_with_the_anchor_pressed_the_largest_outer_anchor_is_the_one_of_equal_force(bands, most):
    largest = _antennas.largest_outer(bands)
    assert largest * 1e3 == pytest.approx(most, abs=0.01)
    for q_out, pathway in (
        (largest - 1e-5, Pathway.COUNTERCLOCKWISE),
        (largest + 1e-5, Pathway.CLOCKWISE),
    ):
        assert _antennas.pair(q_out, bands, pressed=True).cycle().pathway is pathway


def test_a_claim_is_decided_only_where_all_numbers_of_bands_say_the_same():
    assert _antennas._turned_round(0.011).verdict is Judgement.AGREES
    assert _antennas.decided([True, True], "1", "why").verdict is Judgement.AGREES
    assert _antennas.decided([False, True], "1", "why").verdict is Judgement.UNDETERMINED
    assert _antennas.decided([False, False], "1", "why").verdict is Judgement.DIFFERS


def test_a_band_of_another_length_is_noticed(monkeypatch):
    real = _antennas.robot("antennas")
    inner, outer = real.legs[0].chain.levers
    longer = replace(outer, band=replace(outer.bands[0], rest_length=0.028))
    leg = replace(real.legs[0], chain=replace(real.legs[0].chain, cells=(inner, longer)))
    other = replace(real, legs=(leg, *real.legs[1:]))
    before = verdict(20).ours
    monkeypatch.setattr(_antennas, "robot", lambda name: other)
    assert verdict(20).ours != before
