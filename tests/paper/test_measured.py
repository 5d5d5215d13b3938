"""Claims that recordings decide: other recordings, other verdicts."""

import re
import shutil

import numpy as np
import pytest

from facts import refuses, says
from lab.machine import pair, saved, tension, unit
from stepwell import lab, paper
from stepwell.lab.series import paper_cell
from stepwell.mechanism import Chain
from stepwell.paper import Judgement, measured as _measured

pytestmark = pytest.mark.slow
CELL = paper_cell()
MM = CELL.with_anchors(q=(0.010, 0.0))
CELLS = {"MB": (0.0, 0.0), "MT": (0.020, 0.0), "MRB": (0.0, -0.015)}
PAIRS = {"MMT": (0.020, 0.0), "MML": (0.010, 0.015)}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Recordings that say what the paper says."""
    folder = tmp_path_factory.mktemp("recorded")
    rng = np.random.default_rng(0)

    def still():
        return rng.normal(0.0, 0.002, 4000)

    for sample in (1, 2, 3):
        run = tension(sample, 5, lambda u: 28.52 * u, noise=still())
        saved(run, folder / "Rubber_bands")
    for number in range(1, 21):
        k = 39.6 if 6 <= number <= 10 else 47.0
        run = tension(1, 1, lambda u, k=k: k * u, length=0.030, noise=still())
        file = saved(run, folder / "Rubber_bands_robot")
        file.rename(file.with_name(f"robot_rubbers_{number}.txt"))
    saved(unit("1unit/f/friction_1.txt", None), folder)
    for code, q in CELLS.items():
        saved(unit(f"1unit/x/1unit_{code}_1.txt", CELL.with_anchors(q=q), noise=0.001), folder)
    saved(pair("2unit_00_11/f/2unit_friction_1.txt", None), folder)
    for code, q in PAIRS.items():
        chain = Chain([MM, CELL.with_anchors(q=q)])
        saved(pair(f"2unit_00_11/x/2unit_{code}_1.txt", chain), folder)
    return folder


@pytest.fixture
def changed(folder, tmp_path):
    """A copy to put other recordings into."""
    return shutil.copytree(folder, tmp_path / "changed")


def judge(name, folder) -> paper.ClaimVerdict:
    (claim,) = (claim for claim in paper.claims(folder) if claim.id == name)
    return claim.judge()


@pytest.mark.parametrize("name", _measured.IDS)
def test_recordings_that_say_what_the_paper_says_agree(folder, name):
    verdict = judge(name, folder)
    assert verdict.verdict is Judgement.AGREES, verdict.reason
    assert verdict.ours


def test_without_recordings_every_one_says_what_it_needs():
    for name in _measured.IDS:
        verdict = judge(name, None)
        assert verdict.verdict is Judgement.NEEDS_DATA
        says(verdict.reason, "stepwell paper", "--data PATH")


def test_bands_of_another_stiffness_differ(changed):
    rng = np.random.default_rng(0)
    for sample in (1, 2, 3):
        run = tension(sample, 5, lambda u: 28.7 * u, noise=rng.normal(0, 0.002, 4000))
        saved(run, changed / "Rubber_bands")
    assert judge("measured-stiffness", changed).verdict is Judgement.DIFFERS


def test_a_cell_of_the_wrong_class_differs(changed):
    saved(unit("1unit/x/1unit_MB_1.txt", CELL.with_anchors(q=(0.0, 0.015))), changed)
    verdict = judge("measured-class", changed)
    assert verdict.verdict is Judgement.DIFFERS
    assert "MB, 1 band, loading" in verdict.reason
    assert verdict.ours == "2 of 3 series"


def test_a_force_that_rises_differs_and_is_named(changed):
    run = unit("1unit/x/1unit_MB_1.txt", CELL.with_anchors(q=(0.0, 0.0)))
    bump = 0.05 * np.exp(-(((run.stroke - 0.012) / 8e-4) ** 2))
    saved(lab.Recording(run.source, run.time, run.stroke, run.force + bump), changed)
    verdict = judge("measured-falling", changed)
    assert verdict.verdict is Judgement.DIFFERS
    says(verdict.reason, "MB, 1 band", "loading")


def test_forces_far_from_the_model_differ(changed):
    for code, q in CELLS.items():
        cell = paper_cell().with_anchors(q=q)
        run = unit(f"1unit/x/1unit_{code}_1.txt", cell, friction=0.0)
        force = 0.6 * run.force + 0.05 * (1 + 0.5 * run.stroke / 0.020)
        saved(lab.Recording(run.source, run.time, run.stroke, force), changed)
    assert judge("measured-unit-cell", changed).verdict is Judgement.DIFFERS


def test_the_wrong_order_differs(changed):
    way = np.linspace(0.0, 0.040, 1500)
    outer = CELL.with_anchors(q=(0.020, 0.0))
    force = np.where(
        way <= 0.020,
        outer.force(outer.angle(np.minimum(way, 0.020))),
        MM.force(MM.angle(np.maximum(way - 0.020, 0.0))),
    )
    run = lab.Recording("2unit_00_11/x/2unit_MMT_1.txt", np.arange(1500) / 25, way, force)
    saved(run, changed)
    assert judge("measured-order", changed).verdict is Judgement.DIFFERS


def test_a_missing_snap_and_an_invented_one_differ(changed):
    way = np.linspace(0.0, 0.040, 1500)
    smooth = np.interp(way, [0, 0.020, 0.0205, 0.040], [0.39, -0.39, 0.64, -0.3])
    time = np.arange(1500) / 25
    saved(lab.Recording("2unit_00_11/x/2unit_MMT_1.txt", time, way, smooth), changed)
    verdict = judge("measured-snaps", changed)
    assert verdict.verdict is Judgement.DIFFERS
    says(verdict.reason, "no snap", "predicted", "37.23 mm")
    jump = smooth + 0.2 * (way > 0.030)
    saved(lab.Recording("2unit_00_11/x/2unit_MML_1.txt", time, way, jump), changed)
    assert judge("measured-undirected", changed).verdict is Judgement.DIFFERS


def test_a_folder_without_recordings_is_reported(tmp_path):
    with refuses(lab.LabError, str(tmp_path), "no recording", "Rubber_bands"):
        judge("measured-stiffness", tmp_path)


def test_the_robots_fourth_band_is_reported_beside_the_three(folder):
    verdict = judge("measured-robot-stiffness", folder)
    assert re.fullmatch(r"47\.0\d N/m .*three.* 45\.1\d .*four", verdict.ours)
    assert "which has 39.5" in verdict.reason
