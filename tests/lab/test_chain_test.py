"""Chains of elements on a test machine: snaps with errors and a verdict, never a traceback."""

import json
from functools import cache

import numpy as np
import pytest
from typer.testing import CliRunner

from facts import refuses, says
from lab.machine import recording, saved, there
from lab.values import calibration
from stepwell import elements, lab
from stepwell.accounts import account, page, terminal
from stepwell.cli import app
from stepwell.lab.series import paper_cell
from stepwell.mechanism import Chain, Element

TRAVEL = [0.0, 4e-3, 6e-3, 12e-3]  # of a clip [m]
LINES = 25  # of a screen


@cache
def clips() -> Chain:
    """Two clips in series, the second with 1.25 times the force; both snap when pulled."""
    weak, strong = (
        Element.from_points(TRAVEL, [0.0, s * 1.2, s * 0.3, s * 1.5], f"clip {s:g}")
        for s in (1.0, 1.25)
    )
    return Chain([weak, strong])


def pulled(chain: Chain, name="clips_1.csv", stretch=1.0, scale=1.0, noise=0.002, seed=0):
    """A recording of the model, at a factor of its strokes and of its forces."""
    path = chain.path([0.0, chain.full_stroke]).resampled(2000)
    stroke = there(chain.full_stroke)
    force = scale * np.interp(stroke / stretch, path.stroke, path.force)
    return recording(
        name, stroke, force + np.random.default_rng(seed).normal(0, noise, len(stroke))
    )


def test_a_chain_that_is_its_model_agrees_with_the_error_of_every_snap():
    found = lab.compare([pulled(clips())], [clips()])
    (test,) = found.chains
    assert test.agrees and len(test.jumps) == 2
    for jump in test.jumps:
        assert abs(jump.error) < 1e-4 and jump.runs == 1
    says(test.verdict, "agrees", "N", "snap at", "predicted at", "σ")
    assert test.slips == ((),)


@pytest.mark.parametrize(("stretch", "scale"), [(1.05, 1.0), (1.0, 1.3)])
def test_other_strokes_or_forces_differ(stretch, scale):
    (test,) = lab.compare([pulled(clips(), stretch=stretch, scale=scale)], [clips()]).chains
    assert not test.agrees
    says(test.verdict, "differs")
    if stretch > 1:
        assert test.jumps[0].error == pytest.approx(0.05 * test.jumps[0].predicted, abs=2e-4)


def test_a_snap_that_is_not_recorded_is_reported():
    chain = clips()
    stroke = there(chain.full_stroke)
    run = recording("clips_1.csv", stroke, np.full(len(stroke), 0.5))
    (test,) = lab.compare([run], [chain]).chains
    assert not test.agrees and all(jump.runs == 0 for jump in test.jumps)
    says(test.verdict, "differs", "no snap measured")


def test_repeats_are_averaged_and_each_snap_has_its_runs():
    runs = [pulled(clips(), f"clips_{k}.csv", seed=k) for k in (1, 2, 3)]
    (test,) = lab.compare(runs, [clips()]).chains
    assert [jump.runs for jump in test.jumps] == [3, 3] and test.agrees


def test_a_steep_continuous_fall_is_no_predicted_snap():
    # The force of the clip falls by 300 N/m, and the spring in series is as stiff as 310 N/m.
    clip = elements.trilinear((0.004, 1.24), (0.008, 0.04), 310.0, 310.0)
    chain = Chain([clip, Element.from_points([0.0, 12e-3], [0.0, 3.72], "spring")])
    (test,) = lab.compare([pulled(chain)], [chain]).chains
    assert test.agrees and test.snaps_predicted == () and test.snaps == test.slips == ((),)
    (fall,) = test.jumps
    assert fall.continuous and abs(fall.error) < 1e-4
    says(test.verdict, "continuous fall", "no snap")
    stroke = there(chain.full_stroke)
    flat = recording("clips_1.csv", stroke, np.full(len(stroke), 0.5))
    says(lab.compare([flat], [chain]).chains[0].verdict, "no steep fall", "no snap")


@pytest.mark.parametrize("count", [3, 4])
def test_chains_of_three_cells_or_more_are_compared(count):
    cell = paper_cell()
    anchors = ((0.010, 0.0), (0.020, 0.0), (0.0, 0.0), (0.015, 0.0))
    chain = Chain([cell.with_anchors(q=q) for q in anchors[:count]])
    (test,) = lab.compare([pulled(chain, "mine/pull_1.txt")], [chain]).chains
    assert test.agrees


def test_one_element_is_compared_too():
    chain = Chain([clips().cells[0]])
    (test,) = lab.compare([pulled(chain)], [chain]).chains
    assert test.agrees and test.jumps == ()
    says(test.verdict, "agrees", "no snap predicted")


def test_a_chain_of_volume_and_pressure_is_refused_in_one_line():
    chain = Chain([elements.balloon()])
    stroke = np.linspace(0.0, chain.full_stroke, 500)
    with refuses(lab.LabError, "clips_1.csv", "volume", "pressure") as refused:
        lab.compare([recording("clips_1.csv", stroke, stroke)], [chain])
    assert "\n" not in str(refused.value)


def test_nothing_is_fitted_to_a_chain_of_elements():
    with refuses(lab.LabError, "elements", "nothing is fitted"):
        lab.refit(lab.compare([pulled(clips())], [clips()]))


def test_every_form_has_the_verdict_and_the_screen_has_at_most_25_lines():
    runs = [pulled(clips(), f"clips_{k}.csv", seed=k) for k in (1, 2, 3)]
    found = account(lab.compare(runs, [clips()]))
    assert len(terminal(found)) <= LINES
    says(found.answer, "1 of 1 chain")
    (series,) = found.record["series"]
    assert json.loads(json.dumps(found.record, allow_nan=False)) == found.record
    assert len(series["jumps"]) == 2 and series["agrees"] is True
    assert "agrees" in page(found)


def test_names_of_the_authors_do_not_change_a_design_of_elements():
    (test,) = lab.compare([pulled(clips(), "2unit_MMB_1.csv")], [clips()]).chains
    assert test.agrees


def test_bands_are_not_calibrated_on_elements():
    with refuses(lab.LabError, "clip 1", "is an element"):
        calibration().applied(clips())


def test_a_recording_of_force_is_no_observation_of_a_pressure(tmp_path):
    saved(pulled(clips()), tmp_path)
    given = ["lab", "as-built", "preset:balloon", "--data", str(tmp_path / "clips_1.csv")]
    ran = CliRunner().invoke(app, given)
    assert ran.exit_code == 2
    says(ran.output, "clips_1.csv", "volume", "pressure")


@pytest.mark.slow
def test_elements_as_built_follow_from_a_recording_and_progress_is_reported():
    # Every second pull: with fewer observations the population needs fewer generations.
    pulls = lab.pulls_of(pulled(clips(), scale=1.05), clips().full_stroke)[::2]
    seen = lab.Observed(pulls=pulls, scale=0.02)
    calls = []
    built = lab.as_built(clips(), seen, samples=100, progress=lambda *now: calls.append(now))
    scales = [one for one in built.known if one.parameter.name.endswith("force_scale")]
    assert [one.value for one in scales] == pytest.approx([1.05, 1.05 * 1.0], rel=0.05)
    assert calls and calls == sorted(calls) and calls[-1][0] <= calls[-1][1]
    assert len(terminal(account(built))) <= LINES
