"""`stepwell lab`: thin commands over the room, files whole, advice instead of tracebacks."""

import json

import numpy as np
import pytest
import xarray as xr

from cli.folders import written
from lab.machine import pair, saved, tension, unit
from stepwell import files
from stepwell.lab.series import paper_cell
from stepwell.mechanism import Chain

CELL = paper_cell()
ANCHORS = {"MB": (0.0, 0.0), "MM": (0.010, 0.0), "MT": (0.020, 0.0)}


@pytest.fixture
def data(tmp_path):
    """A folder of recordings beside which the command runs."""
    folder = tmp_path / "data"
    runs = [unit(f"1unit/friction/friction_{k}.txt", None, seed=k) for k in (1, 2)]
    for code, q in ANCHORS.items():
        cell = CELL.with_anchors(q=q)
        runs += [unit(f"1unit/x/1unit_{code}_{k}.txt", cell, noise=0.002, seed=k) for k in (1, 2)]
    chain = Chain([CELL, CELL.with_anchors(q=(0.020, 0.0))])
    runs += [pair(f"2unit_00_11/x/2unit_MMT_{k}.txt", chain, seed=k) for k in (1, 2)]
    runs += [pair("2unit_00_11/f/2unit_friction_1.txt", None)]
    rng = np.random.default_rng(0)
    runs += [
        tension(s, c, lambda u: 28.5 * (u + 0.005), noise=rng.normal(0, 0.003, 4000))
        for s in (1, 2, 3)
        for c in (5, 6)
    ]
    for run in runs[:-6]:
        saved(run, folder)
    for run in runs[-6:]:
        saved(run, tmp_path / "bands")
    return folder


@pytest.mark.slow
def test_reading_tells_what_is_there_and_what_cannot_be_read(stepwell, data, tmp_path):
    (data / "broken.txt").write_bytes(b"\x00\x01")
    (data / "film.mp4").write_bytes(b"")
    result = stepwell("lab", "read", "data", "--full", "--out", "table")
    assert result.exit_code == 0
    assert "data/broken.txt: is binary, not text" in result.stdout
    assert "1 .mp4" in result.stdout
    assert "samples read; 1 file could not be read" in result.stdout
    assert "Written into table: recordings.csv, recordings.json, recordings.nc" in result.stdout
    rows = xr.load_dataset(tmp_path / "table" / "recordings.nc", engine="scipy")
    assert rows["stroke"].attrs["units"] == "m"
    record = json.loads(stepwell("lab", "read", "data", "--json").stdout)
    assert record["schema"] == "stepwell.lab.read/1"
    assert [r["problem"][:9] for r in record["refused"]] == ["is binary"]


def test_nothing_to_read_is_an_error_that_is_reported(stepwell):
    result = stepwell("lab", "read", "gone.txt")
    assert (result.exit_code, "gone.txt: no such file." in result.stdout) == (2, True)
    result = stepwell("lab", "compare", "gone")
    assert result.exit_code == 2
    assert "holds no recording that can be read" in result.stderr


@pytest.mark.slow
def test_a_band_table_is_written_and_can_be_used(stepwell, data, tmp_path):
    result = stepwell("lab", "band", "bands", "--gauge", "15", "--out", "band")
    assert result.exit_code == 0, result.stderr
    assert result.stdout.startswith("Stiffness 28.")
    text = (tmp_path / "band" / "band.toml").read_text("utf-8")
    chain = files.loads(f"[chain]\n{text}[[chain.cell]]\np_mm = [-10, 0]\nq_mm = [10, 0]\n").chain
    (band,) = chain.levers[0].bands
    assert band.stiffness == pytest.approx(28.5, abs=0.1)
    assert band.rest_length == pytest.approx(0.010, abs=2e-4)
    names = sorted(written(tmp_path / "band"))
    assert names == ["band.json", "band.toml", "laws.png", "laws.svg", "report.html"]


@pytest.mark.slow
def test_options_of_the_band_command_reach_the_fit(stepwell, data):
    options = [
        "--window",
        "10:20",
        "--fit-cycles",
        "6:6",
        "--drop",
        "2",
        "--law",
        "cubic",
        "--json",
    ]
    record = json.loads(stepwell("lab", "band", "bands", *options, "--json").stdout)
    assert record["window_mm"] == pytest.approx([10, 20])
    assert (record["cycles"], record["samples"]) == ([6, 6], [1, 3])
    assert "cubic_per_mm2" in record["table"]
    assert record["rest_length_mm"] is None


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--window", "20"], "must be FROM:TO"),
        (["--fit-cycles", "1.5:2"], "two whole numbers"),
        (["--fit-cycles", "8:9"], "the recordings contain cycles 5 to 6"),
        (["--law", "quartic"], "must be one of linear"),
        (["--gauge", "-3"], "must be > 0"),
    ],
)
def test_wrong_options_get_advice(stepwell, data, options, words):
    result = stepwell("lab", "band", "bands", *options)
    assert result.exit_code == 2
    assert words in result.stderr.replace("\n", " ")


@pytest.mark.slow
def test_comparison_gives_a_verdict_for_every_series_and_writes_figures(stepwell, data, tmp_path):
    result = stepwell("lab", "compare", "data", "--out", "seen")
    assert result.exit_code == 0, result.stderr
    record = json.loads((tmp_path / "seen" / "compare.json").read_text("utf-8"))
    verdicts = {one["series"].partition(",")[0]: one["verdict"] for one in record["series"]}
    assert verdicts.keys() == {*ANCHORS, "MMT"}
    assert all(verdicts[code].startswith("agrees") for code in ANCHORS)
    assert verdicts["MMT"].startswith("order agrees: inner then outer")
    names = written(tmp_path / "seen")
    kinds = {
        f"{name}.{kind}" for name in ("forces", "energies", "pairs") for kind in ("png", "svg")
    }
    assert names == {"compare.json", "curves.csv", "report.html"} | kinds


@pytest.mark.slow
def test_baselines_and_designs_can_be_given(stepwell, data, tmp_path):
    plain = json.loads(stepwell("lab", "compare", "data", "--json").stdout)
    none = json.loads(stepwell("lab", "compare", "data", "--no-baseline", "--json").stdout)
    given = json.loads(
        stepwell(
            "lab", "compare", "data/1unit", "--baseline", "data/1unit/friction", "--json"
        ).stdout
    )
    errors = [record["series"][0]["rmse_over_kr"] for record in (plain, none, given)]
    assert errors[0] == errors[2] < 0.5 * errors[1]
    both = stepwell("lab", "compare", "data", "--no-baseline", "--baseline", "data")
    assert both.exit_code == 2
    stepwell("lab", "compare", "data/1unit", "preset:paper-cell-10-0", "--bar", "inf")
    wrong = stepwell("lab", "compare", "data/1unit", "preset:nothing")
    assert wrong.exit_code == 2


def test_a_design_can_overrule_the_names(stepwell, data):
    options = ["preset:paper-cell-20-0", "--as-designed", "--json"]
    record = json.loads(stepwell("lab", "compare", "data/1unit", *options).stdout)
    rmse = {row["series"].split(",")[0]: row["rmse_over_kr"] for row in record["series"]}
    assert rmse["1unit_MT"] < 0.02 < 0.2 < rmse["1unit_MB"]


@pytest.mark.slow
def test_calibration_writes_a_band_and_its_errors(stepwell, data, tmp_path):
    result = stepwell("lab", "calibrate", "data", "--law", "linear", "--out", "fit", "--json")
    assert result.exit_code == 0, result.stderr
    text = (tmp_path / "fit" / "band.toml").read_text("utf-8")
    chain = files.loads(f"[chain]\n{text}[[chain.cell]]\np_mm = [-10, 0]\nq_mm = [10, 0]\n").chain
    assert chain.levers[0].bands[0].stiffness == pytest.approx(28.5, rel=0.05)
    record = json.loads(result.stdout)
    assert record["schema"] == "stepwell.lab.calibrate/2"
    # Three unit cells, and both cells of a pair.
    assert [one["in_pair"] for one in record["errors"]] == [False] * 3 + [True] * 2


@pytest.mark.slow
def test_a_failure_leaves_no_folder_behind(stepwell, data, tmp_path, monkeypatch):
    from stepwell import figures

    def fails(tests):
        raise OSError("no room")

    monkeypatch.setattr(figures, "measured_forces", fails)
    assert stepwell("lab", "compare", "data", "--out", "seen").exit_code == 1
    assert not (tmp_path / "seen").exists()
