"""Numbers of bands: what the files contain first, then the force with the design's own number."""

from dataclasses import replace

import numpy as np
import pytest

from facts import says
from lab.machine import pair, unit
from stepwell import files, lab
from stepwell.lab.series import paper_cell
from stepwell.mechanism import Chain

CELL = paper_cell()
MM, MB = (CELL.with_anchors(q=q) for q in ((0.010, 0.0), (0.0, 0.0)))


def soft(cell, factor):
    bands = [replace(band, stiffness=factor * band.stiffness) for band in cell.bands]
    return replace(cell, band=bands)


def with_count(cell, count):
    return replace(cell, band=list(cell.bands) * count)


def runs(factor, first=1, folder="data", code="MB", cell=MB):
    return [
        unit(
            f"{folder}/1unit_{code}_{k}.txt", soft(cell, factor), friction=0.0, noise=0.002, seed=k
        )
        for k in range(first, first + 3)
    ]


def compared(recordings, designs=()):
    return {
        test.series.name: [run.source for run in test.series.recordings]
        for test in lab.compare(recordings, designs, baseline=[]).tests
    }


@pytest.mark.parametrize("strength", [0.75, 1.0, 1.2])
def test_tests_of_two_bands_are_not_sorted_among_those_of_one(strength):
    found = compared(runs(strength) + runs(2 * strength, first=4))
    assert [len(sources) for sources in found.values()] == [3, 3]
    assert [name.split(", ")[1] for name in found] == ["1 band", "2 bands"]


@pytest.mark.parametrize("strength", [0.62, 0.9])
def test_a_number_of_bands_in_a_name_comes_before_the_force(strength):
    found = compared(runs(2 * strength, folder="data/2 bands"))
    assert [name.split(", ")[1] for name in found] == ["2 bands"]


@pytest.mark.parametrize("count", [1, 2])
def test_a_design_counts_its_own_bands(count):
    design = Chain([with_count(soft(MB, 0.8), count)])
    found = compared(runs(0.8) + runs(1.6, first=4), [design])
    assert [name.split(", ")[1] for name in found] == ["1 band", "2 bands"]


def test_repeats_of_other_names_with_clearly_other_forces_are_series_apart():
    data = [
        replace(run, source=run.source.replace("1unit_MB", "pull"))
        for run in (*runs(1.0), *runs(2.0, first=4))
    ]
    found = lab.compare(data, [Chain([MB])], baseline=[])
    one, two = found.cells
    assert (len(one.series.recordings), len(two.series.recordings)) == (3, 3)
    assert one.agrees and not two.agrees
    says(two.series.notes, "1.99", "times the force", "number of bands")


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, 2])
def test_the_pair_of_a_calibration_has_its_bands_one_by_one(count):
    names = {"MMB": (0.0, 0.0), "MML": (0.010, 0.015), "MMT": (0.020, 0.0), "MMR": (0.01, -0.015)}
    data = [
        pair(
            f"{count} bands/2unit_{code}_{k}.txt",
            Chain([soft(MM, 0.9 * count), soft(CELL.with_anchors(q=q), 0.9 * count)]),
            friction=(0.0, 0.0),
            seed=k,
        )
        for code, q in names.items()
        for k in (1, 2)
    ]
    prepared = lab.prepare(lab.sort_series(data, baseline=[]).series)
    fit = lab.calibrate(prepared, "linear")
    written = files.loads(files.dumps(fit.pair())).chain
    assert [len(cell.bands) for cell in written.levers] == [count, count]
    k = np.array([band.stiffness for cell in written.levers for band in cell.bands])
    assert k == pytest.approx(0.9 * MM.bands[0].stiffness, rel=0.1)
    again = lab.compare(data, [written], baseline=[])
    assert {test.series.bands for test in again.pairs} == {count}
