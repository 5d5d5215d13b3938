"""Calibration: what was put in comes out, geometries are left out whole, ties are told."""

import json
from dataclasses import replace

import numpy as np
import pytest

from facts import refuses, says
from lab.machine import unit
from sizes import examples
from stepwell import files, lab
from stepwell.accounts import account, terminal
from stepwell.lab.fit_model import force, law_of, rows
from stepwell.lab.series import paper_cell
from stepwell.mechanism import Band, Cell, Chain, Cubic

DRAWS = examples(10, 200)
OFTEN = 0.90
D = [(10, 0), (10, 15), (10, -15), (20, 0), (20, 15), (20, -15), (30, 0), (30, 15), (30, -15)]
TRUE = {
    "stiffness_1": 23.0,
    "stiffness_2": 28.0,
    "rest_length": 0.007,
    "loss": 0.25,
    "loss_length": 0.003,
    "friction": 0.004,
}
CUBIC = TRUE | {"rest_length": 0.010, "stiffness_1": 35.0, "quadratic": -20.0, "cubic": 400.0}


def of(truth, sample):
    """F of the model along a sample [N]."""
    return force(truth, rows([sample]), law_of("cubic", truth, {}))


def fitted(data, law=None):
    return lab.calibrate(lab.Prepared(tuple(data)), law)


def samples(truth, rng, *, noise=0.002, scatter=0.01, unloading=False, points=20):
    """Series of nine geometries and two numbers of bands; each piece of rubber differs a little."""
    found = []
    for d in D:
        for bands in (1, 2):
            cell = Cell(Band((0.0, 0.0), (d[0] * 1e-3, d[1] * 1e-3)))
            travel = np.linspace(0.0005, 0.0195, points)
            way = (cell.full_travel - travel)[::-1] if unloading else travel
            name = f"{d}, {bands}"
            empty = np.zeros(points)
            at = (d[0] * 1e-3, d[1] * 1e-3)
            sample = lab.Sample(name, at, bands, cell, way, empty, unloading, at)
            told = of(truth, sample) * rng.normal(1.0, scatter)
            found.append(replace(sample, force=told + rng.normal(0.0, noise, points)))
    return found


@pytest.mark.parametrize("unloading", [False, True])
@pytest.mark.parametrize(("law", "truth"), [("linear", TRUE), ("cubic", CUBIC)])
def test_clean_curves_give_their_numbers_back(law, truth, unloading):
    data = samples(truth, np.random.default_rng(0), noise=0.0, scatter=0.0, unloading=unloading)
    found = fitted(data, law)
    for name, value in truth.items():
        if name in {p.name for p in found.parameters}:
            assert found[name].value == pytest.approx(value, rel=1e-3, abs=1e-5), name
    assert found.mean_error(1) < 1e-4 and found.mean_error(2) < 1e-4


@pytest.mark.slow
def test_the_stated_intervals_hold_the_truth():
    inside = dict.fromkeys(TRUE, 0)
    for seed in range(DRAWS):
        found = fitted(samples(TRUE, np.random.default_rng(seed), points=12), "linear")
        for name, value in TRUE.items():
            inside[name] += found[name].low <= value <= found[name].high
    assert min(inside.values()) >= OFTEN * DRAWS, inside


@pytest.mark.slow
def test_the_stated_intervals_of_the_cubic_law_hold_the_truth():
    inside: dict[str, int] = {}
    for seed in range(DRAWS):
        data = samples(CUBIC, np.random.default_rng(seed), points=12, scatter=0.005, noise=0.001)
        found = fitted(data, "cubic")
        for p in found.parameters:
            inside[p.name] = inside.get(p.name, 0) + (p.low <= CUBIC[p.name] <= p.high)
    assert min(inside.values()) >= OFTEN * DRAWS, inside


@pytest.mark.slow
def test_the_law_that_predicts_better_is_taken_by_default():
    rng = np.random.default_rng(1)
    assert fitted(samples(CUBIC, rng, scatter=0.0)).law == "cubic"
    assert fitted(samples(TRUE, rng, noise=0.004)).law == "linear"


@pytest.mark.slow
def test_a_geometry_is_left_out_with_all_its_bands_and_directions():
    rng = np.random.default_rng(2)
    data = samples(TRUE, rng) + samples(TRUE, rng, unloading=True)
    # One geometry is of other rubber: by itself it cannot be predicted, and nothing else tells.
    odd = [replace(s, force=2 * s.force) if s.geometry == (0.02, 0.0) else s for s in data]
    found = fitted(odd, "linear")
    errors = {k: [] for k in (True, False)}
    for sample, error in zip(found.samples, found.left_out_error, strict=True):
        errors[sample.geometry == (0.02, 0.0)].append(error)
    assert min(errors[True]) > 3 * max(errors[False])
    assert len(errors[True]) == 4
    assert np.all(found.left_out_error[[s.geometry == (0.02, 0.0) for s in odd]] > 0.1)


@pytest.mark.slow
def test_numbers_that_the_data_cannot_tell_apart_are_named():
    found = fitted(samples(CUBIC, np.random.default_rng(3)), "cubic")
    assert any({"quadratic", "cubic"} == {a, b} for a, b, _ in found.tied)
    assert np.diag(found.correlations) == pytest.approx(1.0)
    assert "separately" in lab.calibrated_table(found)


@pytest.mark.slow
def test_recordings_are_calibrated_from_end_to_end(tmp_path):
    recordings = [unit(f"1unit/friction/friction_{k}.txt", None, seed=k) for k in (1, 2)]
    rubber = paper_cell()
    for code, q in {"MB": (0, 0), "MM": (10, 0), "MT": (20, 0), "MRB": (0, -15)}.items():
        cell = rubber.with_anchors(q=(q[0] * 1e-3, q[1] * 1e-3))
        recordings += [
            unit(f"1unit/{code}/1unit_{code}_{k}.txt", cell, loss=0.2, noise=0.002, seed=k)
            for k in (1, 2)
        ]
    series = lab.sort_series(recordings).series
    found = lab.calibrate(lab.prepare(series), "linear")
    assert found["stiffness_1"].value == pytest.approx(28.5, rel=0.05)
    assert found["loss"].value == pytest.approx(0.2, abs=0.05)
    assert found.mean_error(1) < 0.02
    text = lab.calibrated_table(found, "my cells")
    chain = files.loads(f"[chain]\n{text}[[chain.cell]]\np_mm = [-10, 0]\nq_mm = [10, 0]\n").chain
    (band,) = chain.levers[0].bands
    assert band.stiffness == pytest.approx(found["stiffness_1"].value, rel=1e-4)
    says(text, "in unloading", "0.")


@pytest.mark.slow
def test_the_calibrated_band_is_the_model_while_it_loads():
    found = fitted(samples(CUBIC, np.random.default_rng(0), noise=0, scatter=0), "cubic")
    band = found.band(2)
    assert isinstance(band.law, Cubic)
    length = np.linspace(0.02, 0.04, 5)
    e = length - 0.010
    assert band.tension(length) == pytest.approx(28.0 * (e - 20 * e**2 + 400 * e**3), rel=1e-3)


def test_without_loss_and_friction_the_model_is_the_force_of_a_cell():
    truth = CUBIC | {"loss": 0.0, "friction": 0.0}
    for sample in samples(truth, np.random.default_rng(0), noise=0.0, scatter=0.0):
        k = truth[f"stiffness_{sample.bands}"]
        cell = Cell(Band((0.0, 0.0), sample.geometry, k, 0.010, Cubic(-20.0, 400.0)))
        expected = sample.bands * cell.force(cell.angle(sample.way))
        assert sample.force == pytest.approx(expected, rel=1e-12)


def test_too_few_geometries_are_refused():
    data = [s for s in samples(TRUE, np.random.default_rng(0)) if s.geometry[0] == 0.01][:4]
    with refuses(lab.LabError, "2", "q - p", "3 or more"):
        fitted(data)
    with refuses(lab.LabError, "'quartic'", "linear, cubic"):
        fitted(samples(TRUE, np.random.default_rng(0)), "quartic")


@pytest.mark.slow
def test_a_calibration_goes_to_xarray_and_json():
    found = fitted(samples(TRUE, np.random.default_rng(0)), "linear")
    data = found.to_xarray()
    assert data.sizes == {"series": 18, "parameter": 6, "other": 6}
    record = account(found).record
    assert json.loads(json.dumps(record, allow_nan=False)) == record
    with refuses(KeyError, "stiffness_3", "stiffness_1"):
        found["stiffness_3"]


def vague(truth, rng, d=((10, 0), (11, 0), (12, 1))):
    """Samples of nearly one geometry: they do not identify stiffness and rest length."""
    near = [s for s in samples(truth, rng, noise=0.0, scatter=0.0) if s.bands == 1][:3]
    made = []
    for sample, (x, y) in zip(near, d, strict=True):
        at = (x * 1e-3, y * 1e-3)
        cell = Cell(Band((0.0, 0.0), at))
        one = replace(sample, name=f"{at}", geometry=at, fold=at, cell=cell)
        made.append(replace(one, force=of(truth, one) + rng.normal(0.0, 0.004, len(one.force))))
    return made


def test_a_law_that_the_data_do_not_identify_is_written_as_tension_at_their_lengths():
    found = fitted(vague(CUBIC, np.random.default_rng(4)), "cubic")
    assert found.unknown
    text = lab.calibrated_table(found)
    says(text, "do not identify", "mm", "%")
    assert "quadratic_per_mm" not in text and "stiffness_N_per_m" not in text
    curve = found.tensions[0]
    true = Band((0.0, 0.0), (1.0, 0.0), 35.0, 0.010, Cubic(-20.0, 400.0)).tension(curve.length)
    if found.missing:
        assert "band = " not in text
        with refuses(lab.LabError, "calibration", "known to"):
            found.applied(Chain([Cell(Band((0.0, 0.0), (0.010, 0.0)))]))
    else:
        says(text, "table_mm_N")
        band = found.band()
        assert band.tension(curve.length) == pytest.approx(true, abs=0.05 * np.max(true))
    wide = curve.high - curve.tension + 0.01 * np.max(true)
    assert np.all(np.abs(curve.tension - true) <= wide)
    assert len(terminal(account(found))) <= 25


def test_a_law_that_the_data_identify_is_written_as_itself():
    found = fitted(samples(TRUE, np.random.default_rng(5), scatter=0.0, noise=0.001), "linear")
    assert found.unknown == () and found.missing == ""
    says(lab.calibrated_table(found), "stiffness_N_per_m", "rest_length_mm")
    for curve in found.tensions:
        k = TRUE[curve.rubber]
        assert curve.tension == pytest.approx(k * (curve.length - 0.007), rel=0.02)
        assert curve.known and curve.width < 0.05


@pytest.mark.slow
def test_the_band_of_curves_holds_the_true_tension():
    inside = []
    for seed in range(DRAWS):
        found = fitted(samples(TRUE, np.random.default_rng(seed), points=12), "linear")
        for curve in found.tensions:
            true = TRUE[curve.rubber] * (curve.length - 0.007)
            inside.append(np.mean((curve.low <= true) & (true <= curve.high)))
    assert np.mean(inside) >= OFTEN
