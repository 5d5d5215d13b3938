"""`stepwell design`: anchors found, certificates, files, refusals."""

import json

import pytest
import typer

import stepwell as sw
from cli.folders import written
from facts import says
from stepwell.cli.design import band_of, bands_of, between, elements_of, target_of
from stepwell.cli.ranges import Range, span
from stepwell.design import BandType, Tolerances, yields

BACK = "00>01>11>10>00"
FEW = ("--samples", 2000)


@pytest.mark.slow
def test_what_is_found_does_it_and_runs(stepwell, tmp_path):
    result = stepwell("design", BACK, *FEW, "--out", "out")
    assert result.exit_code == 0
    assert result.stdout.startswith(f"{BACK}, yield")
    names = {"design.toml", "design.json", "report.html", "yield.csv"}
    names |= {"force-plane.png", "force-plane.svg", "holes.png", "holes.svg"}
    assert written(tmp_path / "out") == names
    assert str(sw.load("out/design.toml").cycle().sequence) == BACK
    assert stepwell("run", "out/design.toml").stdout.startswith(f"{BACK}, ")


@pytest.mark.slow
def test_json_alone_says_everything(stepwell, tmp_path):
    result = stepwell("design", "all:3", *FEW, "--holes", 5, "--out", "out", "--json")
    record = json.loads(result.stdout, parse_constant=pytest.fail)
    chain = sw.load("out/design.toml")
    assert record["schema"] == "stepwell.design/2"
    assert record["possible"]
    assert record["proved"]
    assert len(record["states"]) == record["state_count"] == 8
    assert all(v % 5 == 0 for cell in record["cells"] for v in cell["q_mm"])
    for cell, row in zip(chain.cells, record["cells"], strict=True):
        assert row["F0_N"] == pytest.approx(cell.force_0)
        assert row["q_mm"] == pytest.approx([v * 1e3 for v in cell.bands[0].q])
    again = yields(chain, Tolerances(0.0003, 0.05), samples=2000)
    assert record["yield"]["fraction"] == again.fraction
    assert len(record.pop("files")) == 8
    assert record == json.loads((tmp_path / "out" / "design.json").read_text())


def test_the_grid_of_the_holes_passes_through_its_origin(stepwell):
    ask = ("design", BACK, "--samples", 20, "--holes", 3, "--origin", "-1cm:0")
    record = json.loads(stepwell(*ask, "--json").stdout)
    assert (record["holes_mm"], record["origin_mm"], record["off_grid"]) == (3, [-10, 0], "")
    for cell in record["cells"]:
        steps = (cell["q_mm"][0] + 10) / 3, cell["q_mm"][1] / 3
        assert steps == pytest.approx([round(one) for one in steps])
    says(" ".join(stepwell(*ask).stdout.split()), "3 mm apart", "through (-10, 0) mm")


def test_a_set_of_states_is_reached_and_no_other(stepwell):
    record = json.loads(stepwell("design", "00,10,11", "--samples", 20, "--json").stdout)
    assert set(record["states"]) == {"00", "10", "11"}
    assert record["state_count"] == 3


@pytest.mark.slow
def test_the_states_of_long_chains_are_counted_and_not_listed(stepwell):
    record = json.loads(stepwell("design", "all:13", "--samples", 10, "--json").stdout)
    assert record["state_count"] == 2**13
    assert record["states"] is None
    assert "\n8192 states\n" in stepwell("design", "all:13", "--samples", 10, "--full").stdout


@pytest.mark.slow
def test_the_largest_displacement_of_all_anchors_may_be_the_objective(stepwell):
    by = {
        objective: json.loads(
            stepwell("design", "all:2", *FEW, "--objective", objective, "--json").stdout
        )["robustness"]["radius_mm"]
        for objective in ("yield", "worst")
    }
    assert by["worst"] >= by["yield"]


def test_bands_levers_box_and_actuator_are_as_asked(stepwell):
    options = (
        *("--x", "5:18", "--y", "-3:3", "--band", "47:22", "--band", "robot"),
        *("--lever", 13, "--drive", 500, "--force-limit", 1),
    )
    record = json.loads(stepwell("design", BACK, *FEW, *options, "--json").stdout)
    assert record["actuator"] == {"control": "spring", "stiffness_N_per_m": 500}
    for cell in record["cells"]:
        x, y = cell["q_mm"]
        assert 5 <= x <= 18
        assert -3 <= y <= 3
        assert (cell["stiffness_N_per_m"], cell["rest_length_mm"]) in {(47, 22), (30, 10)}
        assert cell["lever_mm"] == pytest.approx(13)
        assert max(abs(cell["F0_N"]), abs(cell["F1_N"])) <= 1


def test_what_cannot_be_had_is_certified_and_ends_in_code_3(stepwell, tmp_path):
    result = stepwell("design", BACK, "--holes", 40, "--out", "out")
    assert result.exit_code == 3
    assert "impossible" in result.stdout
    assert not (tmp_path / "out").exists()
    result = stepwell("design", BACK, "--holes", 40, "--json")
    record = json.loads(result.stdout, parse_constant=pytest.fail)
    assert result.exit_code == 3
    assert not record["possible"]
    assert record["proved"]
    assert record["gap_needed_N"] > 0


def test_a_target_is_a_cycle_a_list_of_states_or_all_of_them():
    assert target_of("00>10>11>01>00") == {"sequence": "00>10>11>01>00"}
    assert target_of("00, 10,11") == {"states": ["00", "10", "11"]}
    assert target_of("all:12") == {"states": "all", "cells": 12}
    with pytest.raises(typer.BadParameter, match="must be a sequence such as"):
        target_of("all")


def test_a_band_is_named_or_measured():
    assert band_of("paper") == BandType(28.5, 0.010, name="paper")
    assert band_of("30:12") == BandType(30.0, 0.012)
    assert band_of("30:12:7") == BandType(30.0, 0.012, 0.07)


def test_the_bands_of_a_design_file_can_be_had_measured_ones_too(tmp_path):
    assert bands_of("paper") == [band_of("paper")]
    assert bands_of("preset:paper-forward") == [BandType(28.5, 0.010)]
    file = tmp_path / "rubber.toml"
    file.write_text(
        "[chain]\nband = { rest_length_mm = 10, table_mm_N = [[0, 0], [10, 0.2], [40, 1.1]] }\n"
        "[[chain.cell]]\np_mm = [-10, 0]\nq_mm = [10, 0]\n"
        "[[chain.cell]]\np_mm = [-10, 0]\nq_mm = [20, 0]\n"
    )
    (rubber,) = bands_of(str(file))
    table = tmp_path / "band.toml"
    table.write_text("# measured\nband = { rest_length_mm = 62, stiffness_N_per_m = 51.35 }\n")
    assert bands_of(str(table)) == [BandType(51.35, 0.062)]
    assert isinstance(rubber.law, sw.Table)
    assert rubber.stiffness * rubber.law.shape[-1] == pytest.approx(1.1)


@pytest.mark.slow
def test_measured_bands_are_placed(stepwell, tmp_path):
    (tmp_path / "rubber.toml").write_text(
        "[chain]\nband = { rest_length_mm = 10, table_mm_N = [[0, 0], [10, 0.3], [40, 1.1]] }\n"
        "[[chain.cell]]\np_mm = [-10, 0]\nq_mm = [10, 0]\n"
    )
    result = stepwell("design", BACK, "--band", "rubber.toml", "--samples", 5, "--out", "out")
    assert result.exit_code == 0
    chain = sw.load("out/design.toml")
    assert str(chain.cycle().sequence) == BACK
    assert all(isinstance(cell.bands[0].law, sw.Table) for cell in chain.cells)


@pytest.mark.parametrize("free", ["p", "both"])
def test_other_anchors_are_placed_on_request(stepwell, free):
    result = stepwell("design", BACK, "--free", free, "--samples", 5, "--json")
    for cell in json.loads(result.stdout)["cells"]:
        if free == "p":
            assert cell["q_mm"] == [10.0, 0.0]
            assert -20 <= cell["p_mm"][0] <= 0
        else:
            assert cell["p_mm"] == pytest.approx([-value for value in cell["q_mm"]])


def test_elements_are_named_and_their_scales_lie_between_two_numbers():
    (dome,) = elements_of("dome")
    assert (dome.name, len(dome.phases)) == ("dome", 2)
    assert between("0.5:2") == Range(0.5, 2.0)
    assert between("1:1") == Range(1.0, 1.0)
    with pytest.raises(typer.BadParameter, match="has no elements"):
        elements_of("preset:paper-forward")


def test_elements_of_one_shape_cannot_do_everything_and_that_is_proved(stepwell):
    result = stepwell("design", "00>10>11>10>00", "--element", "trilinear", "--drive", "force")
    assert result.exit_code == 3
    assert "impossible" in result.stdout
    result = stepwell(
        "design", "00>10>11>10>00", "--element", "trilinear", "--drive", "force", "--json"
    )
    record = json.loads(result.stdout)
    assert (result.exit_code, record["possible"], record["proved"]) == (3, False, True)


def test_how_far_pressures_are_from_doing_it_is_reported_in_their_unit(stepwell):
    result = stepwell("design", BACK, "--element", "balloon", "--drive", "force", "--json")
    record = json.loads(result.stdout)
    assert record["gap_needed_kPa"] == pytest.approx(1e-5, rel=0.1)
    assert "largest_gap_N" not in record and record["cells"] is None


@pytest.mark.slow
def test_the_allowed_deviation_of_all_forces_is_reported_for_elements(stepwell):
    options = "--element", "preset:von-mises-truss", "--drive", "force", "--samples", 50
    found = json.loads(stepwell("design", BACK, *options, "--json").stdout)["robustness"]
    assert 0.0 < found["fraction"] < 1.0
    assert found["radius_mm"] is None
    told = f"All forces may deviate by {found['fraction'] * 100:.4g} % at once"
    assert told in " ".join(stepwell("design", BACK, *options).stdout.split())


def test_a_span_rises():
    assert span("-15:1.5") == Range(-15.0, 1.5)
    assert str(Range(-15, 15)) == "-15:15"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--element", "dome", "--holes", 5, BACK), "elements have no anchors"),
        (("--element", "dome", "--force-scale", "2:1", BACK), "must be FROM:TO, both above 0"),
        (("forward",), "'forward': must be a sequence such as 00>10>11>01>00"),
        (("00>11>00",), "'00>11>00'"),
        (("all:0",), "cells = 0"),
        (("00,1",), "all of one length"),
        (("all:2", "--x", "20:0"), "'20:0': must rise"),
        (("all:2", "--y", "low"), "'low': must be FROM:TO in mm, as in 0:20."),
        (
            ("all:2", "--band", "caoutchouc"),
            "'caoutchouc': must be paper, robot, antennas, or K:LENGTH",
        ),
        (("all:2", "--band", "-3:10"), "stiffness = -3.0 N/m: must be > 0 and finite."),
        (("all:2", "--objective", "best"), "best"),
        (("all:2", "--force-limit", 0), "must be > 0"),
        (("all:2", "--holes", 0), "0"),
        (("all:2", "--origin", "-10:0"), "--origin: needs --holes LENGTH"),
        (("all:2", "--holes", 5, "--origin", "-10"), "'-10': must be X:Y in mm, as in -10:0"),
        (("all:2", "--holes", 5, "--origin", "0:inf"), "'0:inf': must be finite"),
        (("all:2", "--drive", "soft"), "'soft': must be stroke, force"),
    ],
)
def test_wrong_input_ends_in_code_2_with_what_is_allowed(stepwell, arguments, message):
    result = stepwell("design", *arguments)
    assert result.exit_code == 2
    assert message in result.output.replace("\n", " ")


def test_a_jump_is_designed_and_its_file_is_a_hopper(stepwell, tmp_path):
    ask = ("design", "jump", "--holes", 10, "--samples", 20, "--out", "out")
    done = stepwell(*ask)
    assert done.exit_code == 0, done.stderr
    says(done.stdout.splitlines()[0], "in one snap", "mm high")
    record = json.loads((tmp_path / "out" / "design.json").read_text())
    made = sw.load("out/design.toml")
    assert record["snap"]["energy_mJ"] == pytest.approx(1e3 * sw.robot.snap_of(made).energy)
    assert record["bound_mJ"] >= record["snap"]["energy_mJ"]
    assert made.chain.cycle().path.peak_force
    for row, cell in zip(record["cells"], made.chain.levers, strict=True):
        assert row["q_mm"] == pytest.approx([1e3 * x for x in cell.bands[0].q])
        assert all(abs(x / 10 - round(x / 10)) < 1e-9 for x in (*row["p_mm"], *row["q_mm"]))


def test_a_strike_has_another_load_and_options_of_sequences_are_refused(stepwell):
    ask = ("--holes", 10, "--samples", 20, "--json")
    record = json.loads(stepwell("design", "strike", *ask).stdout)
    assert record["task"] == "strike"
    assert record["snap"]["load_N"] == pytest.approx(0.170 * 9.81)
    says(stepwell("design", "jump", "--x", "0:20").stderr, "--x", "throw or strike")
    says(stepwell("design", "2-1-3", "--stretch", 2).stderr, "--stretch", "jump or throw")
    failed = stepwell("design", "jump", "--force-limit", 3, *ask)
    assert failed.exit_code == 3
    says(json.loads(failed.stdout)["reason"], "none within", "actuator")


def test_two_actuators_are_reported_with_positions_and_written_with_both_sides(stepwell):
    text = ("design", "00>10>00>01>00", "--actuators", 2, "--samples", 50)
    run = stepwell(*text, "-o", "two")
    says(run.stdout.splitlines(), "between cells 1 and 2")
    assert sw.load("two/design.toml") and sw.load("two/beyond.toml")
    refused = stepwell(*text, "--drive", "force")
    assert refused.exit_code == 2 and "--actuators 2" in refused.stderr
    none = stepwell("design", "000>100>000>010>000>001>000", "--actuators", 2, "--samples", 50)
    assert none.exit_code == 3


def test_json_has_the_band_and_the_number_of_bands_of_each_cell(stepwell):
    packs = ("--band", "4xpaper", "--band", "2xantennas", "--most-bands", 2, "--holes", 10)
    record = json.loads(
        stepwell("design", "00>10>11>01>00", *packs, "--samples", 20, "--json").stdout
    )
    for cell, band in zip(record["cells"], record["bands"], strict=True):
        assert band["name"] in ("paper", "antennas") and band["count"] in (1, 2)
        assert cell["stiffness_N_per_m"] == band["count"] * band["stiffness_N_per_m"]
        assert cell["rest_length_mm"] == band["rest_length_mm"]
    walk = ("design", "00>10>00>01>00", "--actuators", 2, *packs, "--samples", 20, "--json")
    tapped = json.loads(stepwell(*walk).stdout)
    assert len(tapped["bands"]) == len(tapped["cells"]) == 2
    assert {one["name"] for one in tapped["bands"]} <= {"paper", "antennas"}


@pytest.mark.parametrize("band", ["2.5xpaper", "x:paper", "sixxpaper"])
def test_a_band_that_cannot_be_read_is_refused_with_the_form_of_a_pack(stepwell, band):
    result = stepwell("design", "00>10>11>01>00", "--band", band)
    assert result.exit_code == 2
    says(" ".join(result.stderr.split()), "--band", band, "whole number", "6xpaper")


def test_levers_of_each_cell_are_given_with_commas(stepwell):
    given = ("--lever", "12,2cm", "--anchor", "0.3,0", "--holes", 5, "--samples", 20, "--json")
    record = json.loads(stepwell("design", "00>10>11>01>00", *given).stdout)
    assert [cell["lever_mm"] for cell in record["cells"]] == [12.0, 20.0]
    by_cell = record["yield"]["tolerances"]["by_cell"]
    assert [one["anchor_mm"] for one in by_cell] == [0.3, 0.0]
    wrong = stepwell("design", "00>10>11>01>00", "--lever", "12,20,16")
    assert wrong.exit_code == 2
    says(" ".join(wrong.stderr.split()), "lever", "3 lengths", "2 cells")
