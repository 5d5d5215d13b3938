"""Slips of unit in files: the key, the value as it stands, what was probably meant."""

import numpy as np
import pytest

import stepwell as sw
from facts import says
from stepwell.files import DesignError, loads
from stepwell.files.write import dumps

CELL = "[[chain.cell]]\np_mm = [-10, 0]\nq_mm = [10, 0]\n"
CHAIN = f"[chain]\n{CELL}"


def answer(text: str) -> str:
    with pytest.raises(DesignError) as caught:
        loads(text, "leg.toml")
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "key", "meant"),
    [
        (
            CHAIN.replace("[-10, 0]", "[-0.010, 0]").replace("[10, 0]", "[0, 0]"),
            "p_mm = [-0.01, 0]",
            "[-10, 0] mm",
        ),
        (CHAIN.replace("[10, 0]", "[5000, 0]"), "q_mm = [5000, 0]", "[5, 0] mm"),
        (f"{CHAIN}limit_deg = 0.785", "limit_deg = 0.785", "44.9772 deg"),
        (f"{CHAIN}lever_mm = 14142", "lever_mm = 14142", "14.142 mm"),
        (f"{CHAIN}friction_N = 50", "friction_N = 50", "0.05 N"),
        (f"{CHAIN}load_N = -65", "load_N = -65", "-0.065 N"),
        (f"{CHAIN}load_mm_N = [[0, 0], [0.02, 0]]", "load_mm_N, travel = 0.02", "20 mm"),
        (f"{CHAIN}load_mm_N = [[0, 0], [20, 90]]", "load_mm_N, force = 90", "0.09 N"),
        (
            f"{CHAIN}band = {{ stiffness_N_per_m = 0.0285 }}",
            "stiffness_N_per_m = 0.0285",
            "28.5 N/m",
        ),
        (f"{CHAIN}band = {{ rest_length_mm = 0.01 }}", "rest_length_mm = 0.01", "10 mm"),
        (
            f"{CHAIN}band = {{ table_mm_N = [[0, 0], [10, 300], [30, 800]] }}",
            "table_mm_N, tension = 800",
            "0.8 N",
        ),
        (f"{CHAIN}band = {{ quadratic_per_mm = -30 }}", "quadratic_per_mm = -30", "-0.03 1/mm"),
        (f"{CHAIN}band = {{ cubic_per_mm2 = 1000 }}", "cubic_per_mm2 = 1000", "0.001 1/mm²"),
    ],
)
def test_a_slip_of_unit_is_answered_with_its_key_and_what_was_meant(text, key, meant):
    told = answer(text)
    assert told.startswith(f"leg.toml: chain.cell[0].{key}: ")
    assert f"Did you mean {meant}?" in told
    says(told, "unusual = true", "table", "cell")
    assert loads(text.replace("[chain]\n", "[chain]\nunusual = true\n", 1)).subject.unusual


def test_one_of_several_bands_is_reported_by_its_place():
    bands = "bands = [{ p_mm = [-10, 0], q_mm = [10, 0] }, { p_mm = [0, 0], q_mm = [0.01, 0] }]"
    told = answer(f"[chain]\n[[chain.cell]]\n{bands}")
    assert told.startswith("leg.toml: chain.cell[0].bands[1].q_mm = [0.01, 0]: ")


def test_a_cell_says_for_itself_what_is_unusual():
    odd = CELL.replace("[10, 0]", "[5000, 0]")
    text = f"[chain]\nunusual = true\n{CELL}{odd}"
    assert loads(text).chain.cells[1].unusual
    assert "chain.cell[1].q_mm" in answer(f"{text}unusual = false")


def test_a_tension_below_zero_is_refused():
    told = answer(f"{CHAIN}band = {{ table_mm_N = [[0, 0], [10, -0.3], [30, 0.8]] }}")
    says(told, "table_mm_N", "row 2", "negative", "0.3?")


def test_a_program_in_metres_is_asked_and_one_of_small_strokes_has_a_way_through():
    program = "[program]\nturning_points_mm = [0, 0.015, 0]\n"
    told = answer(CHAIN + program)
    assert "program.turning_points_mm = [0, 0.015, 0]: stays within" in told
    says(told, "[0, 15, 0]?", "unusual = true", "[program]")
    loads(f"{CHAIN}{program}unusual = true")
    assert answer(CHAIN + program.replace("0.015", "15000")).endswith("Did you mean 15?")


def test_what_the_program_made_is_read_again_however_odd():
    cell = sw.Cell(sw.Band((-0.010, 0.0), (0.010, 0.0)))
    chain = sw.Chain([cell.with_anchors(p=(0.0, 0.0), q=(1e-5, 0.0)), cell])
    text = dumps(chain)
    assert text.count("unusual = true") == 1
    assert loads(text).subject == chain
    assert "unusual" not in dumps(sw.preset("paper-forward"))


def test_no_preset_is_unusual():
    for name in sw.presets():
        design = sw.preset(name)
        chains = [leg.chain for leg in design.legs] if hasattr(design, "legs") else [design]
        assert not any(chain.unusual for chain in chains)


def test_a_mechanism_of_any_ordinary_size_is_read_without_a_word():
    rng = np.random.default_rng(3)
    for size in (0.2, 14.0, 1000.0):
        x = rng.uniform(0.1, 2.0, 3) * size
        band = f"band = {{ rest_length_mm = {size / 2} }}\n"
        loads(
            f"[chain]\nlever_mm = {size}\n{band}[[chain.cell]]\np_mm = [{-x[0]}, 0]\n"
            f"q_mm = [{x[1]}, {x[2]}]"
        )
