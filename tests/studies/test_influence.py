"""First-order influences: known fractions, no false influences by chance, reports."""

import json
from functools import partial

import numpy as np
import pytest
from hypothesis import given, strategies as st

import stepwell as sw
from facts import refuses
from figures.drawn import untidy
from stepwell import figures, reports
from stepwell.accounts import account

pytest.importorskip("zarr", reason="studies are not tested: zarr is not installed")

from stepwell.studies import Axis, GapError, How, Space, decided, opened, status, sweep
from stepwell.studies.influence import explained

pytestmark = pytest.mark.slow

LEG = sw.preset("paper-forward")


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    axes = (
        Axis("outer.q.x", 0.0, 0.020),
        Axis("outer.q.y", -0.015, 0.015),
        Axis("2.lever", 0.012, 0.3),
    )
    folder = tmp_path_factory.mktemp("influence") / "study.zarr"
    return sweep(LEG, "cycle", Space(axes, How.RANDOM, 300, 1), folder, workers=0)


def test_shares_of_a_known_function_are_those_that_are_known():
    """Ishigami and Homma 1990, with 7 and 0.1: 0.3139, 0.4424 and 0."""
    x = np.random.default_rng(1).uniform(-np.pi, np.pi, (2**16, 3))
    y = np.sin(x[:, 0]) + 7 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])
    shares = [explained(x[:, k], y)[0] for k in range(3)]
    assert shares == pytest.approx([0.3139, 0.4424, 0.0], abs=0.01)


@given(st.integers(0, 2**32 - 1), st.integers(60, 400), st.integers(1, 30))
def test_shares_are_what_a_loop_over_the_classes_gives(seed, n, levels):
    rng = np.random.default_rng(seed)
    x, y = rng.integers(0, levels, n).astype(float), rng.standard_normal(n)
    share, classes = explained(x, y)
    if len(np.unique(x)) > round(n ** (1 / 3)):
        assert 1 <= classes <= round(n ** (1 / 3))
        return
    parts = [y[x == level] for level in np.unique(x)]
    assert classes == len(parts)
    if classes < 2:
        assert share == 0.0
        return
    within = sum(((part - part.mean()) ** 2).sum() for part in parts) / (n - classes)
    assert share == pytest.approx(1 - within / y.var(ddof=1), abs=1e-9)


def test_chance_alone_decides_in_about_one_study_of_twenty():
    from stepwell.studies import influence

    rng, surely = np.random.default_rng(0), 0
    for _ in range(200):
        varied = {str(k): rng.random(200) for k in range(6)}
        y = rng.standard_normal(200)
        result = influence._decided("y", "", y, np.ones(200, bool), varied)
        assert result is not None
        surely += bool(result.sure)
    assert surely <= 20


def test_an_anchor_decides_the_cycle_and_its_share_is_that_of_the_store(study):
    by_column = {one.column: one for one in decided(study.study)}
    cycle = by_column["sequence"]
    assert cycle.value in set(study.study.values("sequence"))
    assert cycle.sure[0].name == "outer.q.y"
    low, high = (study.study.values(cycle.influences[0].name)[k] for k in (0, 1))
    assert low != high
    record = account(study).record
    (first,) = [one for one in record["outcomes"] if one["value"] == cycle.value]
    assert first["fraction"] == np.mean(study.study.values("sequence") == cycle.value)
    assert first["fraction_low"] < first["fraction"] < first["fraction_high"]


def test_a_grid_is_no_sample_and_few_designs_say_nothing(tmp_path):
    result = sweep(
        LEG, "cycle", Space((Axis("outer.q.x", 0.0, 0.020, 5),)), tmp_path / "a.zarr", workers=0
    )
    record = account(result).record
    assert record["decided"] == []
    assert {one["fraction_low"] for one in record["outcomes"]} == {None}


def test_a_report_of_what_is_done_so_far_can_be_had(study, tmp_path):
    names = reports.write(study, tmp_path / "out")
    assert {"report.html", "outcomes.svg", "influences.svg", "study.csv", "study.json"} <= {*names}
    page = (tmp_path / "out" / "report.html").read_text("utf-8")
    assert "outer.q.y" in page and "problem" not in page
    record = json.loads((tmp_path / "out" / "study.json").read_text("utf-8"))
    assert record["decided"][0]["influences"][0]["fraction"] > 0
    # As if it were not finished: fewer designs, and the page says so.
    (study.study.folder / "snaps" / "c" / "1").rename(tmp_path / "kept")
    try:
        half = status(opened(study.study.folder))
        with pytest.raises(GapError, match="are missing"):
            reports.write(half, tmp_path / "half")
        reports.write(half, tmp_path / "half", partial=True)
        page = (tmp_path / "half" / "report.html").read_text("utf-8")
        assert "4 of 5 chunks" in page and "are missing: " in page
    finally:
        (tmp_path / "kept").rename(study.study.folder / "snaps" / "c" / "1")


@pytest.mark.parametrize("width", [85.0, 180.0])
def test_figures_of_a_study_are_read_on_a_phone_too(study, width):
    influences = decided(study.study)
    for draw in (partial(figures.outcomes, study.study), partial(figures.influences, influences)):
        assert untidy(figures.compose([draw], width=width)) == []


def test_a_plane_of_two_numbers_is_drawn_as_one_and_what_is_alike_is_refused(tmp_path):
    axes = Axis("outer.q.x", 0.0, 0.020, 5), Axis("outer.q.y", -0.015, 0.015, 5)
    plane = sweep(LEG, "cycle", Space(axes), tmp_path / "plane.zarr", workers=0).study
    drawn = figures.outcomes(plane)
    first = drawn.axes[0]
    assert (first.get_xlabel(), first.get_ylabel()) == ("outer.q.x [mm]", "outer.q.y [mm]")
    # A few whole numbers are classes with a colour each, and no scale.
    (key,) = drawn.legends
    texts = [text.get_text() for text in key.get_texts()]
    assert {*texts[texts.index("Snaps") + 1 :][:2]} == {"0", "2"}
    alike = Space((Axis("outer.q.x", 0.018, 0.0181, 2),))
    same = sweep(LEG, "graph", alike, tmp_path / "same.zarr", workers=0).study
    with refuses(ValueError, "all designs", "same"):
        figures.outcomes(same)


def test_an_atlas_has_no_report_of_a_study(tmp_path):
    from stepwell.studies import atlas

    cell = sw.Cell(sw.Band(p=(-0.01, 0.0), q=(0.01, 0.0), stiffness=28.5, rest_length=0.01))
    status = atlas(
        sw.Chain([cell] * 2), (Axis("1.q.x", 0.0, 0.02),), 1000, tmp_path / "a.zarr", workers=0
    )
    with pytest.raises(ValueError, match="stepwell atlas show"):
        reports.write(status, tmp_path / "out")
