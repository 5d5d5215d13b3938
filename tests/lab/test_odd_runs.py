"""Odd files beside good ones, and jumps that are no snaps: verdicts are right or not given."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from functools import cache
from itertools import product

import numpy as np
import pytest

from facts import says
from lab.machine import SPEED, pair
from sizes import cases, examples
from stepwell import lab
from stepwell.lab import Recording
from stepwell.mechanism import Band, Cell, Chain

pytestmark = pytest.mark.slow

MM = Cell(Band((-0.010, 0.0), (0.010, 0.0)))
MT, MB = MM.with_anchors(q=(0.020, 0.0)), MM.with_anchors(q=(0.0, 0.0))
CHAINS = {"MMT": Chain([MM, MT]), "MMB": Chain([MM, MB])}
# Each chain and each way, which the quick run has once.
BOTH_WAYS = cases(product(CHAINS, (False, True)), [("MMT", False), ("MMB", True)])


@cache
def runs(code: str, unloading: bool) -> tuple[Recording, ...]:
    """Three repeats and their baseline, by a machine whose friction holds little."""
    friction = 0.02, 0.02
    found = [
        pair(f"2unit_x/x/2unit_{code}_{k}.txt", CHAINS[code], friction=friction,
             unloading=unloading, noise=0.002, seed=k)
        for k in (1, 2, 3)
    ]  # fmt: skip
    name = f"2unit_x/f/2unit_friction_{1 + unloading}.txt"
    return *found, pair(name, None, friction=friction, unloading=unloading)


@cache
def compared(code: str, unloading: bool, repeats: tuple[int, ...] = (1, 2, 3)) -> lab.PairTest:
    """What is said of such repeats, undamaged."""
    *found, base = runs(code, unloading)
    (test,) = lab.compare([*(found[k - 1] for k in repeats), base]).pairs
    return test


def taken(run: Recording, rows, stroke: float = 1.0) -> Recording:
    return replace(
        run, time=run.time[rows], stroke=run.stroke[rows] * stroke, force=run.force[rows]
    )


def shuffled(run: Recording) -> Recording:
    return taken(run, np.random.default_rng(0).permutation(len(run)))


def two_in_one(run: Recording) -> Recording:
    time = np.concatenate([run.time, run.time + run.time[-1] + 0.04])
    return replace(run, time=time, stroke=np.tile(run.stroke, 2), force=np.tile(run.force, 2))


# What happens to files, and the word by which it is told.
DAMAGES: dict[str, tuple[Callable[[Recording], Recording], str]] = {
    "cut in half": (lambda run: taken(run, slice(0, len(run) // 2)), "left out, its stroke goes"),
    "cut short": (lambda run: taken(run, slice(0, len(run) * 7 // 10)), "left out, it covers"),
    "two runs in one": (two_in_one, "jumps"),
    "metres labelled mm": (lambda run: taken(run, slice(None), 1e-3), "check the unit"),
    "mm labelled metres": (lambda run: taken(run, slice(None), 1e3), "check the unit"),
    "constant stroke": (lambda run: taken(run, slice(None), 0.0), "constant"),
    "reversed time": (lambda run: replace(run, time=run.time[::-1]), "decreases"),
    "shuffled rows": (shuffled, "decreases"),
    "3 % of a run": (lambda run: taken(run, slice(0, len(run) * 3 // 100)), "check the unit"),
}


# The quick run has every damage one way, and each way with every second damage.
@pytest.mark.parametrize(
    ("damage", "unloading"),
    cases(
        product(DAMAGES, (False, True)), [(damage, bool(k % 2)) for k, damage in enumerate(DAMAGES)]
    ),
)
def test_one_odd_file_gets_a_line_and_stops_no_other(damage, unloading):
    damaged, word = DAMAGES[damage]
    first, *others = runs("MMT", unloading)
    found = lab.compare([damaged(first), *others])
    assert [line for line in found.notes if first.source in line and word in line], found.notes
    (test,) = found.pairs
    assert len(test.series.recordings) == 2
    assert test.right_order and test.right_snaps
    # And the others are read as if it had not been there.
    assert test.snaps == compared("MMT", unloading, (2, 3)).snaps


def with_hole(run: Recording, rng: np.random.Generator) -> Recording:
    """A piece of it is lost."""
    first, gone = int(rng.integers(len(run))), int(rng.integers(10, len(run) // 4))
    return taken(run, np.r_[0:first, min(first + gone, len(run)) : len(run)])


def spiked(run: Recording, rng: np.random.Generator) -> Recording:
    """Single samples are far off."""
    force = run.force.copy()
    at = rng.choice(len(run), int(rng.integers(1, 12)), replace=False)
    force[at] += rng.choice([-1.0, 1.0], len(at)) * rng.uniform(0.5, 8.0, len(at))
    return replace(run, force=force)


def at_another_rate(run: Recording, rng: np.random.Generator) -> Recording:
    return sampled(run, float(np.exp(rng.uniform(np.log(2.0), np.log(5000.0)))))


def cut_short(run: Recording, rng: np.random.Generator) -> Recording:
    return taken(run, slice(0, int(rng.uniform(0.02, 1.0) * len(run))))


SPOILT: tuple[Callable[[Recording, np.random.Generator], Recording], ...] = (
    *(lambda run, rng, damage=damage: damage(run) for damage, _ in DAMAGES.values()),
    cut_short,
    with_hole,
    spiked,
    at_another_rate,
    lambda run, rng: spiked(with_hole(run, rng), rng),
)


@pytest.mark.parametrize(("code", "unloading"), BOTH_WAYS)
def test_verdicts_on_randomly_damaged_files_are_right_or_undecided(code, unloading):
    rng = np.random.default_rng(4)
    *whole, base = runs(code, unloading)
    judged, tried = 0, examples(6, full=240)
    for _ in range(tried):
        often = rng.uniform(0.2, 1.0)
        odd = [
            SPOILT[int(rng.integers(len(SPOILT)))](run, rng) if rng.random() < often else run
            for run in whole
        ]
        with suppress(lab.LabError):
            (test,) = lab.compare([*odd, base]).pairs
            judged += 1
            assert test.right_order is not False, test.verdict
            assert test.right_snaps is not False, test.verdict
    assert judged > tried / 2


def test_one_spike_hides_no_snap_and_turns_no_order():
    """The same in all three, so that no other run helps: it is told, and nothing else changes."""
    *whole, base = runs("MMB", True)
    truth = compared("MMB", True)
    odd = []
    for run in whole:
        force = run.force.copy()
        force[len(force) // 3] += 5.0
        odd.append(replace(run, force=force))
    (test,) = lab.compare([*odd, base]).pairs
    assert test.snaps == truth.snaps
    assert test.ratio == pytest.approx(truth.ratio, rel=0.05)
    (told,) = [line for line in test.series.notes if "spikes" in line]
    says(told, "2unit_MMB_1, 2unit_MMB_2, 2unit_MMB_3", "1 sample", "-13.", "mm")


def test_a_force_of_the_other_sign_is_said_to_be_one():
    *whole, base = runs("MMT", False)
    (test,) = lab.compare([*(replace(r, force=-r.force) for r in whole), base]).pairs
    says(test.series.notes, "pushes", "pulls", "sign", "force")
    # One of three does not change what the others say.
    (test,) = lab.compare([*whole[:2], replace(whole[2], force=-whole[2].force), base]).pairs
    says(test.series.notes, "1 band", "1.0")
    assert test.right_order and test.right_snaps


def slipping(run: Recording, rng: np.random.Generator, size: float) -> Recording:
    """The same run with stick-slips of both signs: a sudden fall or rise that creeps back."""
    force = run.force.copy()
    n = len(run)
    for sign in (-1.0, 1.0, -1.0):
        at = int(rng.integers(n // 10, 9 * n // 10))
        force[at:] += sign * size * np.exp(-np.arange(n - at) / (0.06 * n))
    return replace(run, force=force)


@pytest.mark.parametrize(("code", "unloading"), BOTH_WAYS)
def test_slips_of_both_signs_are_not_taken_for_the_snap(code, unloading):
    rng = np.random.default_rng(8)
    clean = runs(code, unloading)
    truth = compared(code, unloading)
    ((stroke,), *_) = truth.snaps
    snap = abs(max((e.force_after - e.force_before for e in truth.series.path.events), key=abs))
    found = wrong = 0
    tried = examples(2, full=100)
    for _ in range(tried):
        odd = [slipping(run, rng, 0.25 * snap) for run in clean[:3]]
        (test,) = lab.compare([*odd, clean[3]]).pairs
        for snaps in test.snaps:
            found += any(abs(u - stroke) < 0.3e-3 for u in snaps)
            wrong += sum(abs(u - stroke) >= 0.3e-3 for u in snaps)
    assert found >= 0.95 * 3 * tried
    assert wrong <= max(1, 0.01 * 3 * tried)


def sampled(run: Recording, rate: float) -> Recording:
    """The same run at so many samples a second."""
    time = np.arange(0.0, run.time[-1], 1.0 / rate)
    stroke, force = (np.interp(time, run.time, values) for values in (run.stroke, run.force))
    return replace(run, time=time, stroke=stroke, force=force)


@pytest.mark.parametrize(
    ("rate", "unloading"),
    cases(
        product((2.0, 5.0, 10.0, 200.0, 2000.0, 5000.0), (False, True)),
        [(2.0, False), (10.0, False), (10.0, True), (5000.0, True)],
    ),
)
def test_snaps_are_where_they_are_at_any_rate_or_none_is_invented(rate, unloading):
    base = runs("MMT", unloading)
    truth = compared("MMT", unloading)
    (test,) = lab.compare([sampled(run, rate) for run in base]).pairs
    step = SPEED / rate
    for known, snaps in zip(truth.snaps, test.snaps, strict=True):
        assert len(snaps) <= 1
        assert all(abs(u - known[0]) < 0.2e-3 + 2 * step for u in snaps)
        assert snaps or rate < 10
    assert test.right_order


def test_two_million_rows_say_what_a_thousand_say():
    *whole, base = runs("MMT", False)
    long = sampled(whole[0], 2_000_000 / whole[0].time[-1])
    assert len(long) >= 2_000_000
    ((known,),) = compared("MMT", False, (1,)).snaps
    (test,) = lab.compare([long, base]).pairs
    ((found,),) = test.snaps
    assert found == pytest.approx(known, abs=0.2e-3)
    assert test.right_order and test.right_snaps


def test_a_hole_invents_no_snap_and_hides_none_without_a_word():
    first, second, third, base = runs("MMT", False)
    truth = compared("MMT", False)
    at = int(np.searchsorted(first.stroke, truth.snaps[0][0]))
    for rows in (np.r_[0 : at - 40, at + 40 : len(first)], np.r_[0 : at - 40]):
        hidden = [taken(run, rows) for run in (first, second, third)]
        (test,) = lab.compare([*hidden, base]).pairs
        assert test.snaps == ((), (), ())
        assert test.right_snaps is None and "snaps undecided" in test.verdict
    elsewhere = [taken(run, np.r_[0:300, 550 : len(run)]) for run in (first, second, third)]
    (test,) = lab.compare([*elsewhere, base]).pairs
    assert [len(snaps) for snaps in test.snaps] == [1, 1, 1]
    assert test.right_snaps


def test_a_snap_far_from_the_prediction_does_not_agree():
    """Cells with another stiffness snap elsewhere; counts alone would agree."""
    stiff = replace(MM, band=replace(MM.bands[0], stiffness=14.0))
    other = Chain([stiff, MT])
    little = (0.005, 0.005)
    data = [pair(f"2unit_x/x/2unit_MMT_{k}.txt", other, friction=little, seed=k) for k in (1, 2)]
    data.append(pair("2unit_x/f/2unit_friction_1.txt", None, friction=little))
    (test,) = lab.compare(data, [CHAINS["MMT"]], as_designed=True).pairs
    assert all(len(snaps) == len(test.snaps_predicted) for snaps in test.snaps)
    assert test.right_snaps is False and "snaps differ" in test.verdict
    assert abs(test.snap_strokes[0] - test.snaps_predicted[0]) > 2 * test.doubt


def test_repeats_that_differ_warn_by_themselves():
    first, second, third, base = runs("MMT", False)
    later = replace(third, stroke=np.clip(third.stroke - 0.002, 0.0, None))
    (test,) = lab.compare([first, second, later, base]).pairs
    assert "repeats differ by" in test.warning and third.name in test.warning
    assert compared("MMT", False).warning == ""


def test_the_count_of_bands_of_a_run_does_not_depend_on_other_files():
    first, second, third, base = runs("MMT", False)
    double = Chain([replace(c, band=replace(c.bands[0], stiffness=57.0)) for c in (MM, MT)])
    strong = pair("2unit_x/x/2unit_MMT_4.txt", double, friction=(0.02, 0.02), noise=0.002)
    alone = lab.compare([strong, base]).pairs
    together = lab.compare([first, second, third, strong, base]).pairs
    assert [test.series.bands for test in alone] == [2]
    assert [test.series.bands for test in together] == [1, 2]
