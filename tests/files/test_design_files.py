"""Reading design files: what every key means in SI."""

import math
import textwrap

import pytest

from stepwell.files import DesignError, load, loads
from stepwell.files.schema.chain import LAWS, BandKeys
from stepwell.mechanism import MOBILITIES, Band, Cell, Chain, Cubic, Linear, Load, Table

FORWARD = """
title = "Forward-walking leg"

[chain]
lever_mm = 14.142135623730951
limit_deg = 45
band = { stiffness_N_per_m = 28.5, rest_length_mm = 10 }   # shared by the cells below

[[chain.cell]]
name = "inner"
p_mm = [-10, 0]
q_mm = [10, 0]

[[chain.cell]]
name = "outer"
p_mm = [-10, 0]
q_mm = [20, 0]
"""


def only_cell(text: str, shared: str = "") -> Cell:
    (cell,) = loads(f"[chain]\n{shared}\n[[chain.cell]]\n{textwrap.dedent(text)}").chain.levers
    return cell


def placed(text: str, shared: str = "") -> Cell:
    return only_cell(f"p_mm = [-10, 0]\nq_mm = [10, 0]\n{text}", shared)


def test_the_forward_leg_of_the_documentation_reads_as_it_is_meant():
    lever = 0.014142135623730951
    expected = Chain(
        (
            Cell(Band((-0.01, 0), (0.01, 0), 28.5, 0.01), lever, math.pi / 4, name="inner"),
            Cell(Band((-0.01, 0), (0.02, 0), 28.5, 0.01), lever, math.pi / 4, name="outer"),
        ),
        title="Forward-walking leg",
    )
    assert loads(FORWARD).subject == expected


def test_a_file_reads_like_its_text(tmp_path):
    (tmp_path / "forward.toml").write_text(FORWARD)
    assert (
        load(tmp_path / "forward.toml").subject
        == load(str(tmp_path / "forward.toml")).subject
        == loads(FORWARD).subject
    )


def test_windows_line_ends_and_byte_order_marks_change_nothing(tmp_path):
    (tmp_path / "a.toml").write_bytes(b"\xef\xbb\xbf" + FORWARD.replace("\n", "\r\n").encode())
    assert load(tmp_path / "a.toml").subject == loads(FORWARD).subject


def test_what_a_file_leaves_out_is_the_papers_cell():
    assert placed("") == Cell(Band((-0.01, 0), (0.01, 0)))


def test_millimetres_are_the_floats_one_would_write_in_metres():
    # Multiplying by 0.001 would give a neighbouring float for some of these.
    for mm, metres in [("9.95", 0.00995), ("-17", -0.017), ("0.1", 0.0001), ("1e2", 0.1)]:
        assert only_cell(f"p_mm = [-10, 0]\nq_mm = [{mm}, 3]").bands[0].q == (metres, 0.003)


@pytest.mark.parametrize(("degrees", "angle"), [(45, math.pi / 4), (60, 1.0471975511965977462)])
def test_degrees_are_the_nearest_radians(degrees, angle):
    # math.pi / 3 is a neighbour of π/3, whose digits stand above.
    assert placed(f"limit_deg = {degrees}").limit == angle


def test_a_cell_can_differ_from_its_chain_in_every_shared_key():
    shared = "lever_mm = 10\nlimit_deg = 40\nband = { stiffness_N_per_m = 20, rest_length_mm = 5 }"
    text = """
    lever_mm = 12
    limit_deg = 30
    band = { rest_length_mm = 7, two_sided = true }
    """
    cell = placed(textwrap.dedent(text), shared)
    assert (cell.lever, cell.limit) == (0.012, 0.52359877559829887307)
    assert cell.band == Band((-0.01, 0), (0.01, 0), 20.0, 0.007, two_sided=True)


def test_several_bands_take_from_the_cell_and_then_from_the_chain():
    shared = "band = { stiffness_N_per_m = 20, rest_length_mm = 5 }"
    cell = only_cell(
        """
        band = { rest_length_mm = 7 }
        bands = [
            { p_mm = [-10, 0], q_mm = [10, 0] },
            { p_mm = [0, 1], q_mm = [20, 2], stiffness_N_per_m = 40 },
        ]
        """,
        shared,
    )
    assert cell.bands == (
        Band((-0.01, 0), (0.01, 0), 20.0, 0.007),
        Band((0, 0.001), (0.02, 0.002), 40.0, 0.007),
    )


def test_a_cubic_law_is_given_per_millimetre():
    law = placed("band = { quadratic_per_mm = -0.0389, cubic_per_mm2 = 7.19e-4 }").bands[0].law
    assert law == Cubic(-38.9, 719.0)


def test_one_coefficient_is_enough_for_a_cubic_law():
    assert placed("band = { cubic_per_mm2 = 1e-3 }").bands[0].law == Cubic(0.0, 1000.0)
    assert placed("band = { quadratic_per_mm = 1 }").bands[0].law == Cubic(1000.0, 0.0)


def test_a_table_in_newtons_sets_law_and_stiffness():
    band = placed("band = { table_mm_N = [[0, 0], [10, 0.3], [30, 0.6]], rest_length_mm = 8 }").band
    rows = (0.0, 0.01, 0.03), (0.0, 0.3, 0.6)
    assert band == Band.from_table((-0.01, 0), (0.01, 0), 0.008, *rows)


def test_a_shape_is_scaled_by_the_stiffness():
    band = placed("band = { stiffness_N_per_m = 30, shape_mm = [[0, 0], [10, 12], [30, 28]] }").band
    law = Table((0.0, 0.01, 0.03), (0.0, 0.012, 0.028))
    assert band == Band((-0.01, 0), (0.01, 0), 30.0, law=law)


def test_every_key_of_a_band_belongs_to_a_law_or_to_every_band():
    of_laws = set().union(*LAWS.values())
    of_all = {"stiffness_N_per_m", "rest_length_mm", "two_sided"}
    assert set(BandKeys.model_fields) == of_laws | of_all, "name the keys of a law in LAWS"


def test_a_law_of_its_own_replaces_the_shared_law_whole():
    shared = "band = { quadratic_per_mm = 0.1, cubic_per_mm2 = 0.1, stiffness_N_per_m = 20 }"
    band = placed("band = { table_mm_N = [[0, 0], [20, 0.5]] }", shared).bands[0]
    assert band.law == Table((0.0, 0.02), (0.0, 0.02))
    assert band.stiffness == 25.0
    assert placed("band = { cubic_per_mm2 = 1 }", shared).bands[0].law == Cubic(0.0, 1e6)


def test_bands_are_linear_and_one_sided_unless_the_file_says_otherwise():
    band = placed("").bands[0]
    assert (band.law, band.two_sided) == (Linear(), False)


def test_a_load_is_a_number_or_a_table_over_travel():
    assert placed("load_N = -0.02").load == Load.constant(-0.02)
    rows = placed("load_mm_N = [[0, 0.02], [20, 0.05]]").load
    assert rows == Load((0.0, 0.02), (0.02, 0.05))


def test_friction_is_in_newtons():
    assert placed("friction_N = 0.02").friction == 0.02


@pytest.mark.parametrize("given", MOBILITIES)
def test_a_mobility_is_a_number_beside_those_of_the_other_cells(given):
    assert placed("").mobility == 1.0
    assert placed(f"mobility = {given:g}").mobility == given


@pytest.mark.parametrize("given", ["0.000999", "1001", "-1", "nan", "true"])
def test_a_mobility_past_its_ends_is_refused(given):
    with pytest.raises(DesignError, match=r"chain.cell\[0\].mobility = .+: must be"):
        placed(f"mobility = {given}")


@pytest.mark.parametrize(("text", "stiffness"), [("0", 0.0), ("35.5", 35.5), ('"rigid"', math.inf)])
def test_the_actuator_is_a_force_a_spring_or_rigid(text, stiffness):
    chain = loads(FORWARD.replace("[chain]", f"[chain]\nactuator_stiffness_N_per_m = {text}")).chain
    assert chain.actuator_stiffness == stiffness
    assert loads(FORWARD).chain.actuator_stiffness == math.inf
