"""`stepwell yield`: shares, files, programs, refusals."""

import csv
import json
from importlib import import_module

import pytest

import stepwell as sw
from cli.folders import written
from stepwell.accounts import account, terminal
from stepwell.design import Tolerances, survival, yields

ROUGH = ("--anchor", 2, "--stiffness-tolerance", 10, "--samples", 20_000)


def test_the_account_of_the_yield_is_printed(stepwell):
    result = stepwell("yield", "forward.toml", *ROUGH)
    expected = yields(sw.load("forward.toml"), Tolerances(0.002, 0.1), samples=20_000)
    assert result.exit_code == 0
    assert result.stdout.splitlines() == [line.text for line in terminal(account(expected))]


def test_json_alone_says_everything(stepwell):
    result = stepwell("yield", "forward.toml", *ROUGH, "--json")
    record = json.loads(result.stdout, parse_constant=pytest.fail)
    expected = yields(sw.load("forward.toml"), Tolerances(0.002, 0.1), samples=20_000)
    assert record["schema"] == "stepwell.yield/2"
    assert record["fraction"] == expected.fraction
    assert (record["fraction_low"], record["fraction_high"]) == expected.interval
    assert {one["outcome"]: one["count"] for one in record["outcomes"]} == expected.outcomes
    assert record["tolerances"]["anchor_mm"] == 2
    assert record["tolerances"]["stiffness_percent"] == 10
    assert record["sensitivities"] is None
    assert record["files"] == []


def test_every_tolerance_has_its_option(stepwell):
    options = ("--rest-length-tolerance", 4, "--lever-tolerance", 0.5, "--friction", 0.02)
    result = stepwell("yield", "forward.toml", *ROUGH, *options, "--seed", 3, "--json")
    record = json.loads(result.stdout)
    given = Tolerances(0.002, 0.1, 0.04, 0.0005, 0.02)
    expected = yields(sw.load("forward.toml"), given, samples=20_000, seed=3)
    assert record["fraction"] == expected.fraction
    tolerances = record["tolerances"]
    assert (
        tolerances["rest_length_percent"],
        tolerances["lever_mm"],
        tolerances["friction_N"],
    ) == (4, 0.5, 0.02)
    shown = stepwell("yield", "forward.toml", *ROUGH, *options).stdout
    assert all(part in shown for part in ("±4 %", "±0.5 mm", "0.02 N"))


def test_another_cycle_may_be_wanted(stepwell):
    options = ("--target", "00>01>11>10>00", "--samples", 1000, "--json")
    assert json.loads(stepwell("yield", "forward.toml", *options).stdout)["fraction"] == 0


def test_what_one_stroke_cannot_do_is_said_with_what_to_ask_instead(stepwell):
    text = stepwell("yield", "forward.toml", "--target", "00>11>00", "--samples", 50).stdout
    assert text.split("\n\n")[1].startswith("No sample reproduces the target")
    assert "One full cycle cannot give the target: 00>11 moves 2 cells at once" in text
    assert "stepwell program --target 11" in text.replace("\n", " ")


def test_states_may_be_wanted(stepwell):
    options = ("--target", "00,10,01,11", "--samples", 20, "--json")
    record = json.loads(stepwell("yield", "forward.toml", *options).stdout)
    assert record["fraction"] == 1
    assert record["target_states"] == ["00", "10", "01", "11"]
    assert record["advice"] == ""


@pytest.mark.slow
def test_sensitivities_of_a_band_with_a_table_come_with_how_well_they_tell(
    stepwell, tmp_path, monkeypatch
):
    # Of fewer mechanisms than usual, for it is not these numbers that count.
    monkeypatch.setattr(import_module("stepwell.design.tolerances.sensitivity"), "_POWER_BUILT", 5)
    text = (
        (tmp_path / "forward.toml")
        .read_text()
        .replace("stiffness_N_per_m = 28.5", "table_mm_N = [[0, 0], [10, 0.285], [40, 1.14]]")
    )
    (tmp_path / "table.toml").write_text(text)
    shown = stepwell("yield", "table.toml", "--sensitivity", "--samples", 4).stdout
    assert "in 100 % of the samples" in " ".join(shown.split())


def test_sensitivities_are_sorted_and_never_below_zero(stepwell):
    text = stepwell("yield", "forward.toml", *ROUGH, "--sensitivity").stdout
    table = text.split("with others\n")[1].split("\n\n")[0]
    rows = [line.split() for line in table.splitlines()]
    assert {row[0] for row in rows} == {
        *("inner.d", "outer.d"),
        *("inner.stiffness", "outer.stiffness"),
    }
    totals = [float(row[2]) for row in rows]
    assert totals == sorted(totals, reverse=True)
    assert min(float(cell) for row in rows for cell in row[1:]) >= 0


@pytest.mark.slow
def test_the_folder_holds_design_json_outcomes_and_figure(stepwell, tmp_path):
    result = stepwell("yield", "forward.toml", *ROUGH, "--out", "out", "--json")
    record = json.loads(result.stdout)
    out = tmp_path / "out"
    names = {"design.toml", "report.html", "yield.json", "yield.csv"}
    names |= {f"{name}.{kind}" for name in ("yield", "force-plane") for kind in ("png", "svg")}
    assert written(out) == names
    assert {tmp_path / name for name in record.pop("files")} == {out / name for name in names}
    assert record == json.loads((out / "yield.json").read_text())
    assert (out / "design.toml").read_text() == (tmp_path / "forward.toml").read_text()
    with open(out / "yield.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert sum(int(row["count"]) for row in rows) == 20_000


@pytest.mark.slow
def test_a_design_with_a_program_is_judged_by_what_the_program_does(stepwell, tmp_path):
    options = ("--program", "--anchor", 3, "--samples", 30, "--json", "--out", "out")
    record = json.loads(stepwell("yield", "preset:finger-selector", *options).stdout)
    expected = survival(
        sw.preset("finger-selector"),
        (0.0, 0.060, 0.020),
        "00100",
        Tolerances(anchor=0.003, stiffness=0.05),
        samples=30,
    )
    assert record["schema"] == "stepwell.survival/2"
    assert record["successes"] == expected.successes
    assert 0 < expected.successes < 30
    assert record["turning_points_mm"] == [0, 60, 20]
    assert written(tmp_path / "out") == {"design.toml", "report.html", "survival.json"}
    assert (record["from"], record["target"]) == ("00000", "00100")
    text = stepwell("yield", "preset:finger-selector", *options[:-3]).stdout
    assert "00000 to 00100 by the program" in text


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--anchor", -1), "--anchor"),
        (("--stiffness-tolerance", 25), "--stiffness-tolerance"),
        (("--samples", 0), "--samples"),
        (("--anchor", "inf"), "anchor = inf [m]: must be >= 0 and finite."),
        (("--target", "00>11"), "00>11"),
        (("--target", "000>111"), "000>111"),
        (("--program",), "forward.toml: has no table [program]"),
        (("--program", "--sensitivity"), "--sensitivity: cannot be combined with --program."),
        (("--lever-tolerance", 20), "must be smaller than the lever of"),
    ],
)
def test_wrong_input_ends_in_code_2_with_what_is_allowed(stepwell, arguments, message):
    result = stepwell("yield", "forward.toml", *arguments)
    assert result.exit_code == 2
    assert message in result.output


def test_robust_counts_what_works_for_all_mobilities_and_says_how_that_is_known(stepwell):
    arguments = "yield", "forward.toml", *ROUGH, "--robust", 10
    record = json.loads(stepwell(*arguments, "--json").stdout)
    plain = json.loads(stepwell("yield", "forward.toml", *ROUGH, "--json").stdout)
    assert (plain["robust"], plain["proved"]) == (None, None)
    assert (record["robust"], record["proved"]) == (10, record["successes"])
    # Of concave cells end forces decide, whatever the mobilities.
    assert record["successes"] == plain["successes"]
    shown = " ".join(stepwell(*arguments, "--full").stdout.split())
    assert f"up to 10 ({record['proved']} proved" in shown


def test_robust_is_not_asked_of_a_program(stepwell):
    refused = stepwell("yield", "preset:finger-selector", "--program", "--robust", 10)
    assert refused.exit_code == 2
    assert "--robust" in refused.stderr


def test_tolerances_are_given_cell_by_cell(stepwell):
    each = ("--anchor", "2,0.5mm", "--stiffness-tolerance", "10%,0", "--friction", "0,0.02")
    record = json.loads(stepwell("yield", "forward.toml", *each, "--json").stdout)
    tolerances = Tolerances((0.002, 0.0005), (0.1, 0.0), friction=(0.0, 0.02))
    assert record["fraction"] == yields(sw.load("forward.toml"), tolerances).fraction
    assert record["tolerances"]["anchor_mm"] is None
    assert record["tolerances"]["lever_mm"] == 0.0
    by_cell = record["tolerances"]["by_cell"]
    assert [one["anchor_mm"] for one in by_cell] == [2.0, 0.5]
    assert [one["friction_N"] for one in by_cell] == [0.0, 0.02]
    assert "anchors ±2 / 0.5 mm" in stepwell("yield", "forward.toml", *each).stdout


@pytest.mark.parametrize(
    ("given", "facts"),
    [
        (("--anchor", "1,1,1"), ("3 tolerances for 2 cells",)),
        (("--anchor", "1,"), ("--anchor", "''")),
        (("--friction", "0,-1"), ("--friction", "'-1'")),
        (("--stiffness-tolerance", "5,nan"), ("--stiffness-tolerance", "'nan'")),
    ],
)
def test_wrong_tolerances_of_cells_are_refused(stepwell, given, facts):
    result = stepwell("yield", "forward.toml", *given)
    assert result.exit_code == 2
    assert all(fact in " ".join(result.stderr.split()) for fact in facts)
