"""One damaged repeat among good ones spoils no mean, and is named."""

import re
from dataclasses import replace

import numpy as np
import pytest

from facts import refuses
from lab.machine import unit
from stepwell import lab
from stepwell.lab.series import paper_cell

CELL = paper_cell().with_anchors(q=(0.020, 0.0))
GOOD = [unit(f"1unit_MT_{k}.txt", CELL, friction=0.0, noise=0.002, seed=k) for k in (1, 2, 3)]


def slipped(run):
    """The band slips off its peg half way."""
    force = run.force.copy()
    force[len(force) // 2 :] *= 0.2
    return force


def jammed(run):
    """A block jams and comes free again."""
    force = run.force.copy()
    some = slice(len(force) // 3, len(force) // 2)
    force[some] += np.linspace(0.0, 1.5, len(force[some]))
    return force


def touched(run):
    """Somebody leans on the machine."""
    return run.force + 0.3 * np.sin(np.linspace(0.0, 9.0, len(run.force)))


@pytest.mark.parametrize("damage", [slipped, jammed, touched])
def test_a_damaged_repeat_is_left_out_of_the_mean_and_named(damage):
    bad = replace(GOOD[1], force=damage(GOOD[1]))
    (cell,) = lab.compare([GOOD[0], bad, GOOD[2]]).cells
    assert cell.agrees and cell.rmse < 0.01
    assert len(cell.series.curve.runs) == 2
    (told,) = [line for line in cell.series.notes if "not in the mean" in line]
    assert re.match(r"1unit_MT_2: .* [\d.]+ N .*median .* [\d.]+ N", told)


def test_repeats_that_scatter_alike_all_count():
    runs = [unit(f"1unit_MT_{k}.txt", CELL, friction=0.0, noise=0.02, seed=k) for k in (1, 2, 3, 4)]
    (cell,) = lab.compare(runs).cells
    assert len(cell.series.curve.runs) == 4


def test_of_two_repeats_none_is_called_damaged():
    bad = replace(GOOD[1], force=touched(GOOD[1]))
    (cell,) = lab.compare([GOOD[0], bad]).cells
    assert len(cell.series.curve.runs) == 2


@pytest.mark.parametrize("name", ["stroke", "force"])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_recording_of_what_is_no_number_is_refused(name, value):
    values = getattr(GOOD[0], name).copy()
    values[7] = value
    with refuses(ValueError, f"{name}[7] = {value}", "finite"):
        replace(GOOD[0], **{name: values})
