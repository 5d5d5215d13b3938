"""`stepwell build`, and the build file of `yield`, `check` and `design`."""

import json
from pathlib import Path

import pytest

import stepwell as sw
from build import chains
from facts import says
from stepwell.build import layout, load_build_file, loads_build_file, tolerances_of
from stepwell.files import dumps, manifest

QUICK = ("--samples", 20, "--nest", 0)


def names(folder: Path) -> set[str]:
    return set(manifest(folder)["files"])


@pytest.fixture
def steep(stepwell):
    Path("steep.toml").write_text(dumps(chains.steep()), "utf-8")
    return "steep.toml"


def test_a_build_is_written_with_drawings_sheets_template_lists_and_guide(stepwell):
    result = stepwell("build", "forward.toml", *QUICK, "--out", "parts")
    assert result.exit_code == 0, result.output
    files = names(Path("parts"))
    assert {"build.json", "guide.html", "parts.csv", "coupon.dxf", "layers.svg"} <= files
    made = layout(chains.pair(), load_build_file("acrylic-3mm"))
    assert {f"parts/{part.name}.dxf" for part in made.parts} <= files
    assert json.loads(Path("parts/build.json").read_text("utf-8"))["can_be_built"]
    text = Path("parts/build.toml").read_text("utf-8")
    assert loads_build_file(text, "build.toml") == load_build_file("acrylic-3mm")
    says(result.stdout, "Written into parts", "parts/ (42 files)")


def test_a_second_build_replaces_the_files_of_the_first(stepwell):
    stepwell("build", "forward.toml", *QUICK, "--out", "parts")
    again = stepwell("build", "preset:paper-cell-10-0", *QUICK, "--out", "parts", "--r12")
    assert again.exit_code == 0, again.output
    files = names(Path("parts"))
    assert "parts/block-1-top.dxf" in files
    assert not any("block-2" in name for name in files)
    assert not Path("parts/parts/block-2-top.dxf").exists()


def test_a_design_that_cannot_be_built_writes_nothing_and_ends_with_code_3(stepwell, steep):
    result = stepwell("build", steep, *QUICK, "--out", "parts")
    assert result.exit_code == 3
    says(result.stdout, "1 finding")
    says(result.stdout, "lever.width_mm = 6.8")
    says(result.stderr, "parts", "--draft")
    assert not Path("parts").exists()


def test_of_many_findings_the_first_is_on_the_first_screen(stepwell):
    Path("weak.toml").write_text("[actuator]\ntravel_mm = 20\nforce_N = 0.1\n", "utf-8")
    result = stepwell("build", "forward.toml", *QUICK, "--material", "weak.toml")
    assert result.exit_code == 3
    says(result.stdout, "2 findings", "actuator.travel_mm = 40 instead of 20", "1 more finding")


def test_drafts_are_named_and_end_with_code_3(stepwell, steep):
    result = stepwell("build", steep, *QUICK, "--out", "parts", "--draft")
    assert result.exit_code == 3
    assert "parts/DRAFT-lever-1a.dxf" in names(Path("parts"))
    for name in ("design.toml", "build.toml"):
        assert Path("parts", name).read_text("utf-8").startswith("# DRAFT: ")
    assert sw.load("parts/design.toml") == sw.load(steep)


def test_available_bands_that_suit_are_named_in_the_list_of_bands(stepwell):
    Path("red.toml").write_text("band = { rest_length_mm = 10, stiffness_N_per_m = 29 }\n", "utf-8")
    options = ("--out", "parts", "--band", "red.toml", "--band", "40:10")
    result = stepwell("build", "preset:paper-cell-10-0", *QUICK, *options)
    assert result.exit_code == 0, result.output
    (row,) = Path("parts/bands.csv").read_text("utf-8").splitlines()[1:]
    assert row.endswith(",red.toml (+1.8 %)")


def test_another_material_and_a_target_change_the_result(stepwell):
    Path("own.toml").write_text('base = "plywood-3mm"\n[sheet]\nthickness_mm = 4\n', "utf-8")
    result = stepwell(
        *("build", "forward.toml", "--material", "own.toml", "--samples", 20, "--json"),
        *("--target", "00>01>11>10>00"),
    )
    record = json.loads(result.stdout)
    assert (record["material"], record["thickness_mm"]) == ("plywood", 4)
    assert record["yield"]["fraction"] == 0.0


@pytest.mark.parametrize(
    ("arguments", "facts"),
    [
        (("build", "preset:balloon"), ["cells[0]", "Cell"]),
        (("build", "forward.toml", "--material", "acryl"), ["acryl", "acrylic-3mm"]),
        (("yield", "preset:balloon", "--build", "acrylic-3mm"), ["--build", "Cell"]),
        (("design", "2-1", "--build", "acrylic-3mm", "--holes", 5), ["--build", "--holes"]),
    ],
)
def test_wrong_use_names_the_option(stepwell, arguments, facts):
    result = stepwell(*arguments)
    assert result.exit_code == 2
    says(result.stderr, *facts)


def test_yield_and_check_take_the_errors_of_a_build(stepwell):
    expected = tolerances_of(layout(chains.pair(), load_build_file("pla-3mm"))).most
    for command in ("yield", "check"):
        result = stepwell(command, "forward.toml", "--build", "pla-3mm", "--samples", 20, "--json")
        given = json.loads(result.stdout)["tolerances"]
        assert given["anchor_mm"] == pytest.approx(1e3 * expected.anchor)
        assert given["lever_mm"] == pytest.approx(1e3 * expected.lever)
        assert given["rest_length_percent"] == 2


def test_what_is_designed_on_the_grid_of_a_build_file_can_be_drilled_there(stepwell):
    result = stepwell(
        *("design", "00>10>11>01>00", "--build", "acrylic-3mm", "--samples", 20, "--json")
    )
    record = json.loads(result.stdout)
    assert record["holes_mm"] == 5
    bands = [
        sw.Cell(chains.band(cell["p_mm"], cell["q_mm"]), name=cell["name"])
        for cell in record["cells"]
    ]
    made = layout(sw.Chain(bands), load_build_file("acrylic-3mm"))
    # Every hook is in a hole of the grid: no name of a hole off the grid.
    assert not any("X" in hole for path in made.bands for hole in path.holes)


@pytest.mark.slow
def test_a_robot_is_built_with_its_masses_and_its_shortest_period(stepwell):
    result = stepwell("build", "robot-forward", "--nest", 0, "--out", "parts")
    assert result.exit_code == 0, result.output
    says(result.stdout, "61 parts", "acrylic")
    says(result.stdout, "Shortest period", "3.48 s", "80 mm")
    record = json.loads(Path("parts/build.json").read_text("utf-8"))
    assert record["can_be_built"] and record["schema"] == "stepwell.robot_build/1"
    assert sum(one["mass_g"] for one in record["masses"]) == pytest.approx(record["mass_g"])
    assert {"parts.svg", "guide.html", "parts/body-plate.dxf"} <= names(Path("parts"))
    assert sw.load("parts/design.toml") == sw.preset("robot-forward")


def test_options_of_the_yield_are_refused_for_a_robot(stepwell):
    result = stepwell("build", "robot-forward", "--samples", 20)
    assert result.exit_code == 2
    says(result.stderr, "--samples", "chain")
