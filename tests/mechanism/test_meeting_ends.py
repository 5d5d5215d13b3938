"""Bands whose two ends meet: smooth without a rest length, refused where the force has a jump."""

import math

import numpy as np
import pytest

import stepwell as sw

R = 0.010 * math.sqrt(2.0)
OTHER = sw.Cell(sw.Band((-0.010, 0.0), (0.010, 0.0)))
LAWS = [sw.Linear(), sw.Cubic(50.0, 2000.0), sw.Table((0.0, 0.01, 0.03), (0.0, 0.012, 0.02))]
MEETS = [-math.pi / 4, -0.3, 0.0, 0.2, math.pi / 4]


def meeting(theta: float, law=LAWS[0], rest: float = 0.0, two_sided: bool = False) -> sw.Cell:
    """A cell whose band has no length at θ [rad]."""
    q = (-R * math.cos(theta), -R * math.sin(theta))
    return sw.Cell(sw.Band((0.0, 0.0), q, 28.5, rest, law, two_sided))


@pytest.mark.parametrize("theta", MEETS)
def test_a_linear_band_without_rest_length_pulls_as_the_square_of_its_length_falls(theta):
    # E = k l²/2 is smooth in the travel, and its slope is k (d_y - d_x tan θ).
    cell = meeting(theta)
    dx, dy = cell.bands[0].d
    at = np.append(np.linspace(-cell.limit, cell.limit, 101), theta)
    assert cell.force(at) == pytest.approx(28.5 * (dy - dx * np.tan(at)), abs=1e-15)
    length = np.hypot(R * np.cos(at) + dx, R * np.sin(at) + dy)
    assert cell.energy(at) == pytest.approx(28.5 * length**2 / 2, abs=1e-17)
    assert float(cell.force(theta)) == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: type(law).__name__)
@pytest.mark.parametrize("theta", MEETS)
def test_the_engine_follows_cells_whose_bands_have_no_length_on_the_way(theta, law):
    chain = sw.Chain([meeting(theta, law), OTHER])
    path = chain.cycle().path
    assert np.max(path.residual) < 1e-12
    # What the drive did is what was lost: forces are the slopes of the energies all the way.
    smooth = np.diff(path.branch) == 0
    work = np.sum((0.5 * (path.force[1:] + path.force[:-1]) * np.diff(path.stroke))[smooth])
    assert work == pytest.approx(path.dissipated, abs=3e-6)


def test_slopes_stay_those_of_the_force_next_to_where_the_ends_meet():
    from stepwell.mechanism.law import law, packed

    cell = meeting(math.pi / 4)
    laws, row = packed([cell])[0], np.array([0, -1])
    for before in (0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3):
        travel = cell.full_travel - before
        sin = travel / R - cell.sin_limit
        cos = math.sqrt(1.0 - sin * sin)
        dx, _ = cell.bands[0].d
        _, slope, bend = law(laws, 0, row, travel)
        assert slope == pytest.approx(-28.5 * dx / (R * cos**3), rel=1e-12)
        assert bend == pytest.approx(-28.5 * 3 * dx * sin / (R**2 * cos**5), rel=1e-9)


@pytest.mark.parametrize(
    ("make", "advice"),
    [
        (lambda: meeting(0.2, rest=0.004, two_sided=True), "two_sided=False"),
        (lambda: meeting(0.2, rest=1e-4, two_sided=True), "set rest_length = 0|two_sided=False"),
    ],
)
def test_a_band_that_pushes_where_its_ends_meet_is_refused_and_the_advice_helps(make, advice):
    with pytest.raises(ValueError, match=f"θ = 11.46°.*no direction.*{advice}"):
        make()
    for way in ({"two_sided": False}, {"rest": 0.0, "two_sided": True}):
        assert meeting(0.2, **{"rest": 0.004, **way}).force_0 < 0.0
