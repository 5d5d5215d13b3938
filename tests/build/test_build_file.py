"""Promises about build files: presets, files on a preset, errors."""

import pytest

from facts import refuses, says
from stepwell.build import build_presets, load_build_file, loads_build_file, preset_text
from stepwell.files import DesignError


def test_presets_are_named_by_material_and_thickness():
    assert build_presets() == ["acrylic-3mm", "pla-3mm", "plywood-3mm"]


@pytest.mark.parametrize("name", build_presets())
def test_every_preset_is_valid_and_names_itself_in_si(name):
    made = load_build_file(name)
    assert name.startswith(made.sheet.material)
    assert made.sheet.thickness == 0.003
    assert made.sheet.kerf_x == made.sheet.kerf_y == 0.0  # until a coupon was measured
    assert load_build_file(f"preset:{name}") == made


@pytest.mark.parametrize("name", build_presets())
def test_every_number_of_a_preset_has_a_source_or_is_called_an_assumption(name):
    lines = preset_text(name).splitlines()
    keys = [line for line in lines if "=" in line and not line.startswith("#")]
    about = [line for line in keys if "_mm" in line or "_MPa" in line or "_kg" in line]
    undescribed = [line for line in about if "#" not in line]
    # The second number of a pair shares the comment of the first.
    shared = {"kerf_y_mm", "head_width_mm", "pitch_mm", "thickness_mm", "faces_to_deg"}
    assert {line.split()[0] for line in undescribed} <= shared


def test_a_file_changes_single_numbers_of_its_preset():
    made = loads_build_file('base = "plywood-3mm"\n[lever]\nwidth_mm = 9\n')
    assert made.sheet.material == "plywood"
    assert (made.lever.width, made.lever.spacing) == (0.009, 0.020)
    assert made.title.startswith("Plywood")


def test_a_file_without_a_base_changes_acrylic(tmp_path):
    file = tmp_path / "own.toml"
    file.write_text("[sheet]\nthickness_mm = 4\n")
    made = load_build_file(file)
    assert (made.sheet.material, made.sheet.thickness) == ("acrylic", 0.004)


@pytest.mark.parametrize(
    ("text", "facts"),
    [
        ("[lever]\nwidht_mm = 9\n", ["lever.widht_mm", "width_mm"]),
        ("[sheet]\nthickness_mm = 300\n", ["sheet.thickness_mm = 300", "0.5", "30"]),
        ('[pin]\ndiameter_mm = "a"\n', ["pin.diameter_mm", "a", "0.05"]),
        ("[lever]\nwidth_mm = 4\n", ["lever.width_mm = 4", "6.1", "3.1 mm"]),
        ("[lever]\nspacing_mm = 6\n", ["lever.spacing_mm = 6", "lever.width_mm", "8"]),
        ("[pin]\ndiameter_mm = 1\n", ["pin.diameter_mm = 1", "1.5", "thickness_mm"]),
        ("[screw]\nhole_mm = 2\n", ["screw.hole_mm = 2", "screw.diameter_mm"]),
        ("[block]\nedge_mm = 2\n", ["block.edge_mm = 2", "3.1"]),
        ("[sheet]\nbed_mm = [0, 300]\n", ["sheet.bed_mm", "> 0"]),
        ('[sheet]\nmaterial = "../x"\n', ["sheet.material", "../x", "letters"]),
        ("[grid]\npitch_mm = 0.05\n", ["grid.pitch_mm = 0.05", "4.5", "1.5"]),
        ("[hook]\ndiameter_mm = 3.9271\n", ["grid.pitch_mm = 5", ">= 5.43", "3.927 mm"]),
        ("[grid]\nside_mm = 900\ndepth_mm = 900\n", ["900", "pitch", "at most 1000"]),
        ('base = "acryl"\n', ["base", "acryl", "acrylic-3mm"]),
        ("", ["empty"]),
    ],
)
def test_errors_name_the_key_the_value_and_what_is_allowed(text, facts):
    with refuses(DesignError, "own.toml", *facts):
        loads_build_file(text, "own.toml")


def test_an_unknown_preset_gets_the_nearest_name():
    with refuses(DesignError, "acrylic-3", "acrylic-3mm"):
        load_build_file("acrylic-3")


def test_lengths_are_changed_by_table_and_field():
    made = load_build_file("acrylic-3mm").with_lengths(lever__width=0.009)
    assert made.lever.width == 0.009
    with refuses(ValueError, "lever__widht", "lever__width"):
        made.with_lengths(lever__widht=0.009)
    says(repr(made), "Acrylic")
