"""Bands of another kind are never mixed in silently: they are warned of, or all is refused."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from facts import refuses, says
from lab.machine import recording, saved, there
from stepwell import lab
from stepwell.cli import app
from stepwell.lab.bands.halves import LoadingRun, kinds

UP = there(0.040)
STROKE = np.concatenate([UP, UP[::-1]])


def run(name: str, stiffness: float) -> lab.Recording:
    return recording(name, STROKE, stiffness * (STROKE + 0.005))


def samples(*stiffnesses: float) -> list[lab.Recording]:
    return [run(f"Samp{n}_45mm_5.txt", k) for n, k in enumerate(stiffnesses, 1)]


@pytest.mark.parametrize("seed", range(20))
def test_bands_of_a_kind_scatter_by_ten_percent_and_are_no_reason_to_warn(seed):
    rng = np.random.default_rng(seed)
    one_kind = 30.0 * np.exp(rng.normal(0.0, 0.10, 5))
    test = lab.band_test(samples(*one_kind))
    assert test.warnings == ()
    assert lab.stiffness(test).value == pytest.approx(np.mean(one_kind))


def test_a_cycle_is_the_same_band_however_much_it_softens_first():
    # As rubber does: half is gone after the first cycle, then a few percent in each.
    each = [84.0, 40.0, 34.0, 32.0, 30.4, 29.3, 28.7, 28.2]
    runs = [run(f"Samp1_45mm_{n}.txt", k) for n, k in enumerate(each, 1)]
    assert lab.band_test(runs, cycles=(1, 8)).warnings == ()


@pytest.mark.parametrize("odd", [0.8, 12.0, 57.0, 85.5, -3.0])
def test_one_of_another_kind_is_left_out_and_warned_of_with_file_factor_and_what_to_do(odd):
    test = lab.band_test(samples(28.0, 29.0, odd, 28.5))
    (warning,) = test.warnings
    assert test.samples == (1, 2, 4)
    assert lab.stiffness(test).value == pytest.approx(28.5)
    says(warning, "one kind", "3 of 4", "28.5 N/m", "Samp3", "--drop 3", "folder")
    if odd > 0:
        factor = odd / 28.5 if odd > 28.5 else 28.5 / odd
        assert f"{factor:.3g} times as {'stiff' if odd > 28.5 else 'soft'}" in warning
    says(test.notes, "sample 3", "5 not used", "another kind")
    dropped = lab.band_test(samples(28.0, 29.0, odd, 28.5), drop=(3,))
    assert dropped.warnings == ()
    assert lab.stiffness(dropped).value == pytest.approx(28.5)


def test_twice_as_stiff_is_said_to_be_two_bands():
    (warning,) = lab.band_test(samples(28.0, 57.0, 29.0)).warnings
    says(warning, "2 times", "stiff", "2 bands", "1?")


@pytest.mark.parametrize("each", [(0.8, 57.0), (20.0, 20.5, 46.0, 46.5), (10.0, 20.0, 40.0)])
def test_without_a_majority_no_stiffness_is_reported(each):
    with pytest.raises(lab.LabError) as told:
        lab.band_test(samples(*each))
    line = str(told.value)
    says(line, "one kind", "majority", "Samp1_45mm_5.txt", "N/m", "--drop")
    assert "\n" not in line


def test_files_of_one_name_that_are_two_bands_are_distinguished_by_a_jump_that_rubber_never_makes():
    with refuses(lab.LabError, "pull_3.txt, pull_4.txt: ", "45.5 N/m", "2.32 times", "stiff"):
        lab.band_test([run(f"pull_{n}.txt", k) for n, k in enumerate((20, 19.6, 46, 45), 1)])


def test_a_band_that_pushes_is_refused():
    with refuses(lab.LabError, "a.txt", "rise"):
        lab.band_test([recording("a.txt", UP, 1.0 - 10.0 * UP)])


@pytest.mark.parametrize("seed", range(30))
def test_kinds_are_those_that_every_pair_shows(seed):
    # Brute force: two bands are of a kind if a walk of small steps leads from one to the other.
    rng = np.random.default_rng(seed)
    stiff = np.exp(rng.uniform(0.0, 4.0, 9))
    near = np.abs(np.log(stiff[:, None] / stiff[None, :])) <= np.log(1.4)
    for _ in range(9):
        near = (near.astype(int) @ near.astype(int)) > 0
    wanted = {frozenset(np.flatnonzero(row).tolist()) for row in near}
    found = kinds(LoadingRun(n, 1, str(n), k) for n, k in enumerate(stiff.tolist()))
    assert {frozenset(run.sample for run in kind.runs) for kind in found} == wanted
    assert found[0].bands == max(map(len, wanted))


@pytest.mark.slow
def test_the_warning_stands_first_on_the_screen_in_json_and_on_the_page(tmp_path):
    for one in samples(28.0, 57.0, 29.0):
        saved(one, tmp_path / "bands")
    out = tmp_path / "out"
    arguments = ["lab", "band", str(tmp_path / "bands")]
    shown = CliRunner().invoke(app, [*arguments, "--out", str(out)], env={"COLUMNS": "80"})
    text = " ".join(shown.stdout.split())
    says(text, "one kind", "2 of 3", "28.5 N/m")
    assert text.index("one kind of") < text.index("Rest length")
    assert max(map(len, shown.stdout.partition("For a design file")[0].splitlines())) <= 80
    record = json.loads((out / "band.json").read_text("utf-8"))
    says(record["warnings"][0], "one kind", "2 of 3", "28.5 N/m", "Samp2")
    assert list(record).index("warnings") < list(record).index("stiffness_N_per_m")
    page = (out / "report.html").read_text("utf-8")
    assert page.index("one kind of") < page.index("Force laws")
    says((out / "band.toml").read_text("utf-8"), "# WARNING", "one kind", "2 of 3", "28.5 N/m")


def test_the_published_bands_are_each_of_one_kind_and_mixed_they_are_not(kamp2024):
    bands = lab.read_all([kamp2024 / "Rubber_bands"]).recordings
    test = lab.band_test(bands, window=(0.005, 0.035))
    assert test.warnings == ()
    assert lab.stiffness(test).value == pytest.approx(28.549, abs=0.0005)
    robot = lab.read_all([kamp2024 / "Rubber_bands_robot"]).recordings
    options = {"window": (0.010, 0.020), "cycles": (2, 5), "cycles_per_sample": 5}
    assert lab.band_test(robot, **options).warnings == ()
    three = lab.band_test(robot, **options, drop=(2,))
    assert lab.stiffness(three).value == pytest.approx(47.05, abs=0.005)
    with refuses(lab.LabError, "one kind", "majority", "N/m", "--drop"):
        lab.band_test(lab.read_all([kamp2024 / "1unit_2"]).recordings)
