"""Figures of measured data: all text legible, measurement and model distinct."""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

from facts import refuses
from figures.drawn import legend_of, lines, marks, says, untidy, untidy_on_a_phone
from lab.machine import pair, tension, unit
from stepwell import figures, lab
from stepwell.lab.series import paper_cell
from stepwell.mechanism import Chain

CELL = paper_cell()
CODES = {"MB": (0, 0), "MM": (10, 0), "MT": (20, 0), "MLB": (0, 15)}


def doubled(cell):
    return replace(cell, band=replace(cell.bands[0], stiffness=2 * cell.bands[0].stiffness))


@pytest.fixture(scope="module")
def comparison():
    runs = [
        unit("1unit/f/friction_1.txt", None),
        unit("1unit/f/friction_2.txt", None, unloading=True),
    ]
    for code, (x, y) in CODES.items():
        cell = CELL.with_anchors(q=(x * 1e-3, y * 1e-3))
        runs += [unit(f"1unit/x/1unit_{code}_{k}.txt", cell, noise=0.002, seed=k) for k in (1, 2)]
        runs += [unit(f"1unit/x/1unit_{code}_4.txt", doubled(cell), noise=0.002)]
    runs += [unit("1unit/y/1unit_MB_1.txt", CELL.with_anchors(q=(0.0, 0.0)), unloading=True)]
    chain = Chain([CELL, CELL.with_anchors(q=(0.020, 0.0))])
    for way, folder in ((False, "2unit_00_11"), (True, "2unit_11_00")):
        runs += [
            pair(f"{folder}/x/2unit_MMT_{k}.txt", chain, unloading=way, seed=k) for k in (1, 2)
        ]
        runs += [pair(f"{folder}/f/2unit_friction_1.txt", None, unloading=way)]
    return lab.compare(runs)


@pytest.fixture(scope="module")
def band():
    rng = np.random.default_rng(0)

    def curve(u):
        return 56.3 * u - 1905 * u**2 + 35720 * u**3

    return lab.band_test(
        [tension(s, c, curve, noise=rng.normal(0, 0.005, 4000)) for s in (1, 2) for c in (4, 5, 6)]
    )


@pytest.fixture(scope="module")
def draws(comparison, band):
    fit = lab.calibrate(lab.prepare([t.series for t in comparison.cells]), "cubic")
    return {
        "forces": partial(figures.measured_forces, comparison.cells),
        "energies": partial(figures.measured_energies, comparison.cells),
        "pairs": partial(figures.measured_pairs, comparison.pairs),
        "laws": partial(figures.band_laws, band, lab.choose_law(band)),
        "calibration": partial(figures.calibration, fit),
    }


@pytest.fixture(scope="module")
def drawn(draws):
    return {name: draw() for name, draw in draws.items()}


NAMES = ("forces", "energies", "pairs", "laws", "calibration")


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_no_word_covers_another_or_leaves_the_page_or_the_phone(draws, drawn, name):
    assert untidy(drawn[name], 7.0) == []
    # Correlations are as small as their squares.
    assert untidy_on_a_phone(draws[name], 7.0 if name != "calibration" else 4.0) == []


@pytest.mark.parametrize("name", NAMES)
def test_every_label_names_its_unit(drawn, name):
    labels = {
        label for ax in drawn[name].axes for label in (ax.get_xlabel(), ax.get_ylabel()) if label
    }
    assert labels
    for label in labels:
        assert label.endswith("]") or "/(k" in label, label


def test_points_are_measured_and_the_line_is_the_model(comparison, drawn):
    figure = drawn["forces"]
    test = comparison.cells[0]
    (points, *_) = lines(figure, "measured")
    scale = test.series.scale
    for x, y in np.asarray(points.get_xydata(), float):
        theta = np.radians(x)
        force = np.interp(theta, test.plain.theta, test.plain.force)
        assert y == pytest.approx(force / scale, abs=1e-3)
    assert marks(figure, "extrapolated") > 0
    assert {"model", "1 band", "2 bands"} <= {
        text.get_text() for legend in figure.legends for text in legend.get_texts()
    }


def test_snaps_of_runs_and_of_the_model_are_marked(drawn):
    assert marks(drawn["pairs"], "snaps") == 4
    assert marks(drawn["pairs"], "snaps predicted") == 2


def test_snaps_in_the_legend_have_the_colour_of_their_marks(comparison):
    for test in comparison.pairs:
        figure = figures.measured_pairs([test])
        handles: list[Any] = figure.legends[0].legend_handles
        (mark,) = [handle for handle in handles if handle.get_label() == "snap, measured"]
        assert {mark.get_color()} == {line.get_color() for line in lines(figure, "snaps")}


def test_both_directions_are_named(drawn):
    shown = [t.get_text() for legend in drawn["pairs"].legends for t in legend.get_texts()]
    assert {"measured, loading", "measured, unloading"} <= set(shown)
    assert any("unloading" in text for text in says(drawn["forces"]))


def test_the_chosen_law_is_named_in_the_legend(drawn):
    assert "cubic (chosen)" in legend_of(drawn["laws"])


@pytest.mark.slow
def test_correlations_keep_their_sign(comparison, drawn):
    fit = lab.calibrate(lab.prepare([t.series for t in comparison.cells]), "cubic")
    texts = [t for t in drawn["calibration"].axes[1].texts if t.get_gid() == "correlation"]
    assert any(text.get_text().startswith("\N{MINUS SIGN}") for text in texts)
    for text in texts:
        column, row = (round(x) for x in text.get_position())
        shown = float(text.get_text().replace("\N{MINUS SIGN}", "-"))
        assert shown == pytest.approx(fit.correlations[row, column], abs=0.0051)


def test_the_measurement_is_seen_on_both_sides_of_the_model(drawn):
    for ax in drawn["pairs"].axes:
        width = {line.get_gid(): line.get_linewidth() for line in ax.get_lines()}
        assert width["measured"] >= 3 * width["model"]


def test_nothing_to_draw_is_refused():
    with refuses(ValueError, "tests", "empty", "one unit cell"):
        figures.measured_forces([])
    with refuses(ValueError, "tests", "empty", "one pair"):
        figures.measured_pairs([])
