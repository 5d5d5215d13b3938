"""The accounts of recordings: each number once, the same in every form."""

import json
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import stepwell as sw
from accounts.schemas import violations
from lab.machine import pair, recording, tension, there, unit
from lab.values import of_recordings
from stepwell import lab, reports
from stepwell.accounts import About, account, card, page, terminal
from stepwell.base import percent
from stepwell.files import manifest

RESULTS = "AsBuilt", "BandFit", "Batch", "Calibration", "Comparison"
PARTS = "BandTest", "CellTest", "PairTest", "Recording"


def _text(found) -> str:
    return "\n".join(line.text for line in terminal(found, full=True))


@pytest.mark.slow
@pytest.mark.parametrize("name", RESULTS)
def test_the_record_keeps_to_the_generated_schema_and_every_form_can_be_made(name):
    found = account(of_recordings()[name])
    assert violations(found.record) == []
    for form in (_text(found), card(found), page(found)):
        assert found.title in form


@pytest.mark.parametrize("name", PARTS)
def test_a_part_has_a_card_and_no_folder(name):
    found = account(of_recordings()[name])
    assert found.kind == "" and found.title in card(found)
    with pytest.raises(sw.StepwellError, match="must be one of"):
        reports.write(found, "nowhere")


@pytest.mark.parametrize("name", ["AsBuilt", "Batch"])
def test_a_folder_has_the_record_and_keeps_to_the_schema_of_folders(name, tmp_path):
    found = account(of_recordings()[name])
    written = reports.write(found, tmp_path / "out")
    (record,) = (one for one in written if one.endswith(".json") and one != "stepwell.json")
    kept = json.loads((tmp_path / "out" / record).read_text("utf-8"))
    assert kept == json.loads(json.dumps(found.record))
    assert violations(manifest(tmp_path / "out")) == []


def test_oddities_of_recordings_are_in_the_record_and_on_the_screen():
    runs = [recording(f"a_{k}.txt", there(0.020), np.zeros(len(there(0.020)))) for k in (1, 3)]
    found = account(lab.Batch(tuple(runs), (), ("film.mp4",)))
    assert violations(found.record) == []
    assert [one["odd"] for one in found.record["recordings"]] == [
        [],
        ["number 2 is missing before it"],
    ]
    assert found.record["ignored"] == ["film.mp4"]
    for words in ("number 2 is missing", "1 .mp4"):
        assert words in _text(found) and words in page(found)


@pytest.mark.parametrize(
    ("points", "shown"),
    [
        ([0.0, 20.0], "0 to 20"),
        ([0.0, 19.9, 0.0], "0 to 19.9 to 0"),
        ([0.0, 9.0, 1.0, 8.0], "0 to 9 to 1 to 8"),
        ([0.0, 9.0, 1.0] + [8.0, 2.0] * 4, "0 to 9 to 1 to ... to 8 to 2"),
    ],
)
def test_a_stroke_is_shown_with_the_points_where_it_turned(points, shown):
    pieces = [np.linspace(a, b, 9)[:-1] for a, b in pairwise(points)]
    stroke = np.append(np.concatenate(pieces), points[-1]) * 1e-3
    one = recording("pull.csv", stroke, np.full(len(stroke), 0.1))
    assert f">{shown}<" in page(account(lab.Batch((one,), ())))


def _fit(samples: int, gauge: float | None = 0.015) -> lab.BandFit:
    noise = np.random.default_rng(0).normal(0, 0.003, 4000)
    runs = [tension(k + 1, 5, lambda u: 28.5 * (u + 0.005), noise=noise) for k in range(samples)]
    test = lab.band_test(runs)
    return lab.fit_bands(test, lab.choose_law(test, gauge))


@pytest.mark.slow
@pytest.mark.parametrize(("samples", "gauge"), [(1, 0.015), (1, None), (3, 0.015)])
def test_one_band_has_its_own_interval_and_several_have_theirs(samples, gauge):
    fit = _fit(samples, gauge)
    found = account(fit, About(source="mine", data_sha256={"a": "b"}))
    record = found.record
    assert violations(record) == []
    assert record["data_sha256"] == {"a": "b"}
    assert record["table"] == lab.band_table(fit, "mine")
    assert (record["this_band"] is None) == (samples > 1)
    assert (record["stiffness_N_per_m"]["low"] is None) == (samples == 1)
    alone = record["this_band"]
    if samples == 1:
        assert fit.alone is not None
        assert alone["stiffness_N_per_m"]["low"] == fit.alone.stiffness.low
        assert (alone["rest_length_mm"] is None) == (gauge is None)
    if samples == 1 and gauge is not None:
        assert alone["rest_length_mm"]["value"] == pytest.approx(10.0, abs=0.2)
        assert "Rest length" in _text(found)
    for form in (_text(found), card(found), page(found)):
        assert f"{fit.stiffness.value:.4g} N/m" in form


def _to(fit: lab.BandFit, start: float, end: float) -> float:
    ends = ((one.stiffness, one.start, one.end) for one in fit.windows)
    return next(k for k, a, b in ends if a == start and abs(b - end) < 1e-9)


@pytest.mark.slow
def test_the_stiffness_by_window_is_in_the_record_and_in_a_table():
    fit = _fit(2)
    found = account(fit)
    windows = found.record["windows"]
    assert len(windows) == len(fit.windows) > 20
    one = fit.windows[3]
    assert windows[3] == {
        "from_mm": one.start * 1e3,
        "to_mm": one.end * 1e3,
        "k_N_per_m": one.stiffness,
    }
    assert f">{_to(fit, 0.0, 0.025):.4g}<" in page(found)


def test_a_series_has_the_numbers_of_its_kind_and_null_for_the_other_kind():
    compared = of_recordings()["Comparison"]
    series = account(compared).record["series"]
    (cell, *_), (two, *_) = ([s for s in series if s["kind"] == k] for k in ("cell", "pair"))
    assert cell.keys() == two.keys()
    assert cell["order_shown"] is None and two["F0_N"] is None
    test = compared.cells[0]
    assert cell["F0_N"] == {"measured": test.plain.force_0, "model": test.cell.force_0}
    assert cell["barrier_mJ"]["measured"] == test.plain.barrier * 1e3
    assert two["snaps_mm"] == [[u * 1e3 for u in run] for run in compared.pairs[0].snaps]
    assert two["order_shown"] == ["inner", "outer"]


def test_rising_forces_and_the_rig_of_the_machine_are_reported():
    bump = recording("1unit_MLB_1.txt", way := there(0.020), 300.0 * way)
    found = account(lab.compare([unit("friction_1.txt", None), bump]))
    assert violations(found.record) == []
    (rise,) = found.record["series"][0]["rises"]
    assert rise["by_N"] > 1 and f"by {rise['by_N']:.2g} N" in _text(found)
    rig = lab.Rig(0.070, 1.02, -0.0002, 0.0003, 0.0003, 0.06)
    runs = [pair("2unit_MMT_1.txt", sw.preset("paper-forward"))]
    moved = account(lab.compare(runs, rig=rig))
    assert moved.record["rig"]["compliance_mm_per_N"] == pytest.approx(0.3)
    assert "1.02 times nominal" in _text(moved) and "0.3 mm/N" in _text(moved)


def test_a_calibration_has_its_errors_notes_and_correlated_parameters():
    found = of_recordings()["Calibration"]
    record = account(found).record
    assert record["notes"] == list(found.notes) != []
    assert [list(one.values()) for one in record["strongly_correlated"]] == [
        list(t) for t in found.tied
    ]
    assert record["errors"][0]["d_mm"] == [x * 1e3 for x in found.samples[0].geometry]
    assert record["snap_errors_mm"] == {"plain": None, "fitted": None, "left_out": None}
    for line in record["summary"]:
        assert line in _text(account(found)).replace("\n", " ")


@pytest.mark.slow
def test_a_calibration_on_pairs_keeps_to_the_schema():
    runs = [pair("2unit_friction_1.txt", None), pair("2unit_MMT_1.txt", sw.preset("paper-forward"))]
    (cell,) = sw.preset("paper-cell-10-0").cells
    for code, q in {"MB": (0.0, 0.0), "MM": (0.010, 0.0), "MT": (0.020, 0.0)}.items():
        runs.append(unit(f"1unit_{code}_1.txt", cell.with_anchors(q=q)))
    found = lab.calibrate(lab.prepare(lab.sort_series(runs).series), "linear")
    record = account(found).record
    assert found.weighing is not None and violations(record) == []
    assert record["snaps"][0]["measured_mm"] == found.snaps[0].measured * 1e3
    assert record["weighing"]["weight_N"] == found.weighing.weight
    assert record["intervals_that_hold"] == {"of": found.coverage[1], "hold": found.coverage[0]}


def test_a_build_has_its_advice_its_yield_and_what_was_seen():
    built = of_recordings()["AsBuilt"]
    found = account(built)
    assert found.record["seed"] == built.seed and found.record["design_sha256"]
    assert found.record["fraction"] == built.fraction
    for form in (_text(found), card(found), page(found)):
        assert built.advice[1:15] in form and percent(built.fraction) in form


@pytest.mark.slow
@pytest.mark.parametrize(
    ("design", "seen", "keys"),
    [
        (
            "paper-forward",
            lab.Observed(out=(0.0355,), pulls=(lab.Pull(1, 0.005, 0.3),)),
            {"snaps_out_mm": [35.5], "ruler_mm": 1.0, "stroke_mm": 5.0, "force_N": 0.3},
        ),
        (
            "balloon",
            lab.Observed(back=(), pulls=(lab.Pull(1, 5e-6, 1e3),), ruler=1e-6, scale=300.0),
            {"snaps_back_mL": [], "scale_kPa": 0.3, "volume_mL": 5.0, "pressure_kPa": 1.0},
        ),
        (
            "force-control",
            lab.Observed(out=(0.4,), ruler=0.01),
            {"snaps_out_N": [0.4], "ruler_N": 0.01, "scale_N": 0.02},
        ),
    ],
)
def test_what_was_seen_of_a_build_is_in_the_units_of_its_design(design, seen, keys):
    drawing = sw.preset(design)
    built = replace(
        of_recordings()["AsBuilt"], drawing=drawing, seen=seen, known=(), moves=(), wrong=()
    )
    found = account(built)
    assert violations(found.record) == []
    record = found.record["seen"] | dict(*found.record["seen"]["pulls"])
    for key, value in keys.items():
        assert record[key] == pytest.approx(value), key
    assert _text(found) and page(found)


def test_an_account_of_recordings_computes_nothing(monkeypatch):
    values = {name: of_recordings()[name] for name in RESULTS}

    def refuse(*_, **__):
        raise AssertionError("an account calls the engine")

    for name in ("path", "cycle", "margin", "program", "graph"):
        monkeypatch.setattr(sw.Chain, name, refuse)
    for name in ("choose_law", "compare", "calibrate", "as_built", "fit_bands"):
        monkeypatch.setattr(lab, name, refuse)
    for value in values.values():
        found = account(value)
        assert found.record and terminal(found) and card(found) and page(found)
