"""What the antennas have to do follows from the bands, and another robot is judged otherwise."""

from dataclasses import replace

import pytest

from stepwell.paper import Judgement, _antennas
from stepwell.sequences import Pathway


def verdict(q_mm: int):
    (claim,) = (claim for claim in _antennas.CLAIMS if claim.id == f"antennas-bench-{q_mm}")
    return claim.judge()


@pytest.mark.parametrize(
    ("q_mm", "factor", "p_mm"),
    # Without the factor both bands are alike, so both cells need the same q - p.
    [(20, False, -20.0), (14, False, -14.0), (20, True, -16.622), (14, True, -11.625)],
)
def test_the_place_that_turns_the_pair_round(q_mm, factor, p_mm):
    found = _antennas.turning(q_mm * 1e-3, factor=factor)
    assert found.method == "exact"
    assert found.place[0] * 1e3 == pytest.approx(p_mm, abs=1e-3)
    assert found.place[1] == 0.0
    assert found.before == Pathway.CLOCKWISE.value
    assert found.after == Pathway.COUNTERCLOCKWISE.value


@pytest.mark.parametrize("factor", [True, False])
def test_the_outer_force_is_the_inner_one_there(factor):
    # F0 = k (1 - ℓ0/ℓ) d_x at 45° and d_y = 0; ℓ = |(10 + d_x, 10)| mm.
    found = _antennas.turning(0.020, factor=factor)
    dx = 10.0 - found.place[0] * 1e3
    length = ((10.0 + dx) ** 2 + 100.0) ** 0.5
    outer = (1 - 22.0 / (40.0**2 + 100.0) ** 0.5) * 30.0
    assert (1.25 if factor else 1.0) * (1 - 22.0 / length) * dx == pytest.approx(outer, rel=1e-9)


def test_eleven_millimetres_do_not_do_it_and_the_claim_says_what_does():
    for q_mm, place in ((20, "-16.62 mm"), (14, "-11.62 mm")):
        found = verdict(q_mm)
        assert found.verdict is Judgement.DIFFERS
        assert found.ours.startswith("at -11 mm 00>10>11>01>00")
        assert place in found.reason
        assert f"-{q_mm}.00 mm without it" in found.reason
        assert "in any direction of the plane" in found.reason


def test_with_the_anchor_pressed_the_largest_outer_anchor_is_the_one_of_equal_force():
    largest = _antennas.largest_outer()
    assert largest * 1e3 == pytest.approx(13.25, abs=0.01)
    for q_out, pathway in (
        (largest - 1e-5, Pathway.COUNTERCLOCKWISE),
        (largest + 1e-5, Pathway.CLOCKWISE),
    ):
        assert _antennas.pressed(q_out).cycle().pathway is pathway


def test_a_robot_with_its_outer_anchor_further_in_would_agree():
    finding = _antennas._turned_round(0.013)
    assert finding.verdict is Judgement.AGREES
    assert "turned round from -10.8 mm on" in finding.ours


def test_softer_outer_bands_are_noticed(monkeypatch):
    real = _antennas.robot("antennas")
    inner, outer = real.legs[0].chain.cells
    soft = replace(outer, band=replace(outer.bands[0], stiffness=20.0))
    leg = replace(real.legs[0], chain=replace(real.legs[0].chain, cells=(inner, soft)))
    other = replace(real, legs=(leg, *real.legs[1:]))
    monkeypatch.setattr(_antennas, "robot", lambda name: other)
    assert verdict(14).verdict is Judgement.AGREES
