"""A built copy is judged from its own recording: sequence, switches, parts, wrong holes."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import stepwell as sw
from accounts.schemas import violations
from facts import refuses, says
from stepwell import lab
from stepwell.accounts import account, terminal
from stepwell.design import DEFAULT_TOLERANCES, Draws
from stepwell.lab import CopyVerdict, copy_test
from stepwell.lab.rig import on_path, path_of

FORWARD, HOLE = "00>10>11>01>00", 0.005


@cache
def designed() -> sw.Chain:
    return sw.design(FORWARD, holes=HOLE, samples=50).chain


def copies(number: int) -> sw.Chain:
    """A copy within the default tolerances."""
    return Draws(designed(), DEFAULT_TOLERANCES, 7).sample(number)


def displaced(chain: sw.Chain, cell: int, x: float, y: float, k: float = 1.0) -> sw.Chain:
    """The chain with a band of one cell in another hole, or of another stiffness."""
    cells = list(chain.levers)
    band = cells[cell].bands[0]
    q = band.q[0] + x, band.q[1] + y
    cells[cell] = replace(cells[cell], band=replace(band, q=q, stiffness=k * band.stiffness))
    return replace(chain, cells=tuple(cells))


def recorded(chain: sw.Chain, seed: int = 0, **rig: float) -> lab.Recording:
    """A whole cycle of a copy on a rig with noise, friction, a zero error and loss of rubber."""
    how = {"step": 1e-4, "noise": 0.005, "friction": 0.03, "loss": 0.15, "zero": 0.005, **rig}
    rng, parts = np.random.default_rng(seed), []
    for unloading in (False, True):
        u = np.arange(0.0, how.get("reach", chain.full_stroke), how["step"])
        u = u[::-1] if unloading else u
        force = on_path(path_of(chain, unloading), u)
        force = (
            force * (1 - how["loss"]) - how["friction"] if unloading else force + how["friction"]
        )
        parts.append((u, force + how["zero"] + rng.normal(0.0, how["noise"], len(u))))
    stroke, force = (np.concatenate(one) for one in zip(*parts, strict=True))
    time = np.linspace(0.0, 0.02 * (len(stroke) - 1), len(stroke))
    return lab.Recording("copy.csv", time, stroke, force)


@pytest.mark.parametrize("number", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_a_copy_within_the_tolerances_is_good_whatever_friction_and_loss(number):
    rig = {"friction": 0.0, "loss": 0.0} if number else {"step": 5e-4, "loss": 0.25}
    found = copy_test(designed(), recorded(copies(number), number, **rig))
    assert found.verdict is CopyVerdict.GOOD, found
    assert not found.corrections and found.right == 1.0
    assert found.sequence == str(copies(number).cycle().sequence)
    assert found.loss == pytest.approx(rig["loss"], abs=0.1)
    # The truth lies within the doubt of the fit.
    for one in found.parts:
        truth = {"q.x": 0, "q.y": 1}.get(one.name.partition(".")[2])
        if truth is not None:
            cell = copies(number).levers[designed().names.index(one.name.partition(".")[0])]
            nominal = designed().levers[designed().names.index(one.name.partition(".")[0])]
            there = cell.bands[0].d[truth] + nominal.bands[0].p[truth]
            assert abs(one.value - there) < 4.0 * one.doubt


@pytest.mark.parametrize(
    ("cell", "x", "y"),
    [
        (1, -HOLE, 0.0),
        pytest.param(0, HOLE, 0.0, marks=pytest.mark.slow),
        # Without a second state of the inner cell, the reader turns the sign of the force.
        pytest.param(0, 0.0, -HOLE, marks=pytest.mark.slow),
    ],
)
def test_the_band_in_a_wrong_hole_is_named_with_its_hole(cell, x, y):
    found = copy_test(designed(), recorded(displaced(copies(3), cell, x, y), cell))
    assert found.verdict is CopyVerdict.DIFFERS
    assert found.wrong is not None and found.wrong.anchor.name == f"{designed().names[cell]}.q"
    assert np.subtract(found.wrong.to, found.wrong.was) == pytest.approx((x, y), abs=1e-12)
    says(found.corrections, designed().names[cell], "move it to")


@pytest.mark.slow
def test_another_sequence_fails_and_another_band_is_named():
    aimed = copy_test(designed(), recorded(copies(4)), target="00>01>11>10>00")
    assert aimed.verdict is CopyVerdict.FAILS and aimed.right == 0.0
    strong = copy_test(designed(), recorded(displaced(copies(5), 1, 0.0, 0.0, 1.6)))
    assert strong.verdict is not CopyVerdict.GOOD
    says(strong.corrections, "outer")


def test_a_recording_that_does_not_decide_is_not_decided():
    part = copy_test(designed(), recorded(copies(0), reach=0.7 * designed().full_stroke))
    assert part.verdict is CopyVerdict.UNDECIDED and part.covered == pytest.approx(0.7, abs=0.01)
    says(part.reason, "a whole cycle")
    strange = recorded(copies(0))
    force = np.sin(strange.stroke / 1e-3)
    other = copy_test(designed(), replace(strange, force=force))
    assert other.verdict is CopyVerdict.UNDECIDED and other.error > 0.1 * other.range
    for hole in (0.0, math.nan):
        with refuses(sw.InputError, "hole ="):
            copy_test(designed(), strange, hole=hole)


@pytest.mark.slow
def test_the_record_of_a_copy_keeps_to_its_schema():
    found = account(copy_test(designed(), recorded(displaced(copies(3), 0, HOLE, 0.0))))
    assert violations(found.record) == []
    text = "\n".join(line.text for line in terminal(found, full=True))
    assert all(one["name"] in text for one in found.record["parts"])
