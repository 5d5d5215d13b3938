"""Unit cells: golden numbers of the paper's designs, checks at the door, forces and energies."""

import math
from dataclasses import replace

import numpy as np
import pytest

import stepwell as sw
from stepwell.mechanism.law import packed

CELL = sw.Cell(sw.Band((-0.010, 0.0), (0.010, 0.0)))
KR = 28.5 * CELL.lever

# F0/(k r) and F1/(k r) of Kamp et al. 2024, the six designs of Fig. 1, by hand from Eqs. 1 and 2.
GOLDEN = {
    (10, 0): (0.967, -0.967),
    (20, 0): (1.607, -1.607),
    (0, 0): (0.391, -0.391),
    (10, -15): (0.263, -1.661),
    (20, 15): (2.393, -0.836),
    (0, -15): (-0.243, -0.910),
}


def paper_cell(q):
    return CELL.with_anchors(q=(q[0] * 1e-3, q[1] * 1e-3))


@pytest.mark.parametrize("q", GOLDEN)
def test_the_six_paper_designs_have_the_end_forces_of_the_paper(q):
    cell = paper_cell(q)
    assert (cell.force_0 / KR, cell.force_1 / KR) == pytest.approx(GOLDEN[q], abs=6e-4)


@pytest.mark.parametrize("q", GOLDEN)
def test_energy_peaks_where_equation_3_says_and_that_decides_bistability(q):
    cell = paper_cell(q)
    dx, dy = cell.bands[0].d
    assert cell.peak_angle == math.atan2(dy, dx)
    assert cell.is_bistable == (abs(math.atan2(dy, dx)) < cell.limit)
    theta = np.linspace(-cell.limit, cell.limit, 20_001)
    highest = theta[np.argmax(cell.energy(theta))]
    peak = min(max(cell.peak_angle, -cell.limit), cell.limit)
    assert highest == pytest.approx(peak, abs=1e-4)


def test_the_barrier_is_the_climb_from_state_0_to_the_peak():
    cell = paper_cell((10, 0))
    expected = float(cell.energy(0.0) - cell.energy(-cell.limit))
    assert cell.barrier == pytest.approx(expected, rel=1e-12)
    assert paper_cell((0, -15)).barrier == 0


def test_travel_and_angle_are_inverse_and_meet_the_stops():
    theta = np.linspace(-CELL.limit, CELL.limit, 101)
    assert np.allclose(CELL.angle(CELL.travel(theta)), theta, atol=1e-12)
    assert CELL.full_travel == pytest.approx(0.020, rel=1e-15)
    assert CELL.travel(-CELL.limit) == 0
    assert CELL.travel(CELL.limit) == pytest.approx(CELL.full_travel, rel=1e-15)


def test_what_the_engine_reads_has_the_travels_of_the_cells_to_the_last_digit():
    cells = [replace(CELL, limit=limit) for limit in np.linspace(0.2, 1.5, 200).tolist()]
    assert packed(cells)[0].full.tolist() == [cell.full_travel for cell in cells]


def test_a_slack_band_carries_nothing_and_a_two_sided_one_pushes():
    short = sw.Band((0, 0), (0.001, -0.008), rest_length=0.012)
    pushing = sw.Band((0, 0), (0.001, -0.008), rest_length=0.012, two_sided=True)
    theta = np.linspace(-CELL.limit, CELL.limit, 400)
    slack = short.length(theta, CELL.lever) < 0.012
    assert slack.any() and not slack.all()
    ours, theirs = sw.Cell(short), sw.Cell(pushing)
    assert np.all(ours.force(theta)[slack] == 0) and np.all(ours.energy(theta)[slack] == 0)
    assert np.all(theirs.energy(theta)[slack] > 0)
    # The two agree wherever the band is taut.
    assert np.array_equal(ours.force(theta)[~slack], theirs.force(theta)[~slack])


def test_only_the_difference_of_the_anchors_matters():
    moved = sw.Cell(sw.Band((0.003, 0.004), (0.023, 0.004)))
    theta = np.linspace(-CELL.limit, CELL.limit, 50)
    assert np.allclose(moved.force(theta), CELL.force(theta), rtol=1e-12)


def test_several_bands_and_a_load_add_up():
    bands = (sw.Band((0, 0), (0.02, 0.003)), sw.Band((0, 0), (0.015, -0.01), stiffness=40))
    load = sw.Load((0.0, 0.020), (0.1, 0.3))
    cell = sw.Cell(bands, load=load)
    theta = np.linspace(-CELL.limit, CELL.limit, 50)
    single = sum(sw.Cell(band).force(theta) for band in bands)
    weight = 0.1 + 10.0 * cell.travel(theta)
    assert np.allclose(cell.force(theta), single + weight, rtol=1e-12)
    assert cell.energy(-cell.limit) == pytest.approx(
        sum(float(sw.Cell(band).energy(-cell.limit)) for band in bands)
    )


def test_a_cubic_law_and_a_table_of_it_pull_alike():
    law = sw.Cubic(-20.0, 800.0)
    e = np.linspace(0, 0.04, 400)
    tension = 28.5 * (e - 20 * e**2 + 800 * e**3)
    cubic = sw.Band((0, 0), (0.02, 0.0), law=law)
    table = sw.Band.from_table((0, 0), (0.02, 0.0), 0.010, tuple(e), tuple(tension))
    theta = np.linspace(-CELL.limit, CELL.limit, 100)
    assert np.allclose(sw.Cell(cubic).force(theta), sw.Cell(table).force(theta), atol=1e-6)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: sw.Band((0, 0), (0.02, 0), stiffness=0), "stiffness = 0.0 N/m: must be > 0"),
        (lambda: sw.Band((0, 0), (0.02, 0), rest_length=-3), "rest_length = -3.0 m: must be >= 0"),
        (lambda: sw.Band((0, math.nan), (0.02, 0)), r"p\[1\] = nan: must be finite"),
        (lambda: sw.Band((0,), (0.02, 0)), "must be two numbers"),  # pyright: ignore[reportArgumentType]
        (lambda: sw.Cell(sw.Band((0, 0), (0.02, 0)), limit=1.6), "0.01° to 89.9°"),
        (lambda: sw.Cell(()), "must be a Band or a sequence of Bands"),
        (lambda: sw.Cell("band"), "must be a Band or a sequence"),  # pyright: ignore[reportArgumentType]
        (lambda: sw.Cell(sw.Band((0, 0), (0.02, 0)), friction=-1), "friction = -1.0 N"),
        (
            lambda: sw.Cell(sw.Band((0, 0), (-CELL.lever, 0), two_sided=True)),
            "of a band with a rest length of 10 mm has no direction",
        ),
        (lambda: sw.Table((0.0, 0.01), (0.1, 0.2)), r"must start at \(0, 0\)"),
        (lambda: sw.Table((0.0, 0.0), (0.0, 0.2)), "values must rise"),
        (lambda: sw.Load((0.0,), (1.0, 2.0)), "must be equal"),
        (lambda: sw.Chain([]), "one cell or more"),
        (lambda: sw.Chain([CELL], actuator_stiffness=-1), "use math.inf"),
        (lambda: CELL.force(1.0), "must be between the stops"),
        (lambda: CELL.angle(0.021), "must be between 0 and 20 mm"),
        (
            lambda: sw.Band((0, 0), (0.02, 0), law=sw.Table((0, 0.01), (0, 0.01)), two_sided=True),
            "a table has no values for compression",
        ),
    ],
)
def test_wrong_input_is_refused_with_the_value_and_what_is_allowed(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_values_print_themselves_in_the_units_of_the_workshop():
    assert repr(CELL) == "Cell(d=(20, 0) mm k=28.5 N/m ℓ0=10 mm, r=14.14 mm, θc=45°)"
    assert "actuator 50 N/m" in repr(sw.Chain([CELL], actuator_stiffness=50))
    assert sw.Chain([CELL, CELL]).names == ("inner", "outer")
    assert sw.Chain([CELL] * 3).names == ("cell 1", "cell 2", "cell 3")


@pytest.mark.parametrize(
    "d", [(0.02, 0.0), (0.01, 0.03), (0.0, -0.03), (-0.02, 0.005), (-0.02, -0.0), (-0.03, -0.02)]
)
@pytest.mark.parametrize("limit_deg", [10.0, 45.0, 89.0])
def test_the_least_and_largest_length_of_a_band_are_exact(d, limit_deg):
    band, lever, limit = sw.Band((0.0, 0.0), d), 0.014, math.radians(limit_deg)
    lengths = band.length(np.linspace(-limit, limit, 4001), lever)
    least, most = band.lengths(lever, limit)
    # The grid misses an extremum by less than its step squared.
    assert (least, most) == pytest.approx((lengths.min(), lengths.max()), rel=1e-6)
    assert least <= lengths.min() * (1.0 + 1e-15) and most >= lengths.max() * (1.0 - 1e-15)
    assert band.largest_stretch(lever, limit) == most / band.rest_length
