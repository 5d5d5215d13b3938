"""What the floor carries does not depend on the time step, and no more does the walk."""

import numpy as np
import pytest

from simulation.robots import robot, walked
from stepwell.simulation import Settings, convergence, walk
from stepwell.simulation.model import sampled

pytestmark = pytest.mark.slow

REPORTED: list[tuple[float, float]] = []


@pytest.fixture(scope="module")
def forward():
    def tell(done, total):
        REPORTED.append((done, total))

    return convergence(robot(), (1e-3, 5e-4, 2.5e-4), progress=tell)


def test_its_progress_counts_the_steps_of_all_walks(forward):
    done, total = np.array(REPORTED).T
    assert np.all(np.diff(done) > 0)
    assert set(total) == {7000.0}  # steps in a second, of all three
    # The first walk is a seventh of the work, and looked at as often as the others.
    assert done[len(done) // 3 - 1] == pytest.approx(1000.0)
    assert done[-1] == pytest.approx(7000.0)


def test_the_forces_of_the_floor_converge_with_the_time_step(forward):
    assert [row.time_step for row in forward.rows] == [1e-3, 5e-4, 2.5e-4]
    off = [row.off for row in forward.rows]
    # Of a robot of 3 N: 5 mN.
    assert off[0] < 2e-3
    assert off[0] > 1.5 * off[1] > 0.0
    assert off[2] == 0.0


def test_feet_that_stand_do_not_chatter(forward):
    # What is left are the steps in which a foot lands, lifts or snaps.
    jumps = [row.jumps for row in forward.rows]
    assert jumps[0] < 0.05
    assert jumps[0] > jumps[1] > jumps[2]


def test_the_walk_converges_with_the_time_step(forward):
    assert np.ptp([row.advance for row in forward.rows]) < 0.01
    assert np.degrees(np.ptp([row.turn for row in forward.rows])) < 0.1


def test_a_samples_forces_are_means_and_its_places_are_not():
    coarse = walked(0.020, 0.020)
    fine = walk(coarse.robot, 1, settings=Settings(sample=1e-3))
    n = len(fine.time) // 20
    for name in ("foot_force", "support_force"):
        wanted = getattr(fine, name)[: n * 20].reshape(n, 20, -1).mean(axis=1)
        assert getattr(coarse, name)[:n] == pytest.approx(wanted, abs=1e-12), name
    for name in ("x", "stroke", "travel", "actuator_force"):
        assert np.array_equal(getattr(coarse, name)[:n], getattr(fine, name)[19 : n * 20 : 20])


def test_sampling_in_pieces_gives_what_sampling_at_once_gives():
    readings = np.random.default_rng(0).normal(size=(2, 47, 3))
    columns = np.array([1])
    whole, left = sampled(readings, np.empty((2, 0, 3)), 5, columns)
    assert whole.shape == (2, 9, 3)
    assert left.shape == (2, 2, 3)
    pieces, pending = [], np.empty((2, 0, 3))
    for first in range(0, 47, 7):
        samples, pending = sampled(readings[:, first : first + 7], pending, 5, columns)
        pieces.append(samples)
    assert np.array_equal(np.concatenate(pieces, axis=1), whole)
    assert np.array_equal(pending, left)


def test_a_walk_with_another_sample_goes_on_from_the_first_whole_one():
    begun = walk(robot(), 0.1053)
    rest = walk(robot(), 0.2, start=begun, settings=Settings(sample=0.05))
    assert np.diff(rest.time) == pytest.approx(0.05)
    assert rest.time[0] == pytest.approx(0.1053 * 2.0 + 0.05, abs=1e-3)
    assert np.isfinite(rest.foot_force).all()


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"time_steps": (1e-3,)}, "must be two or more different ones"),
        ({"time_steps": (1e-3, 7e-4)}, "0.0007 s does not divide the sample of 0.02 s"),
        ({"cycles": 1}, "cycles = 1: must be >= 2"),
        ({"time_steps": (1e-2, 1e-3), "settings": Settings(contact_time=0.02)}, "ended early"),
    ],
)
def test_what_cannot_be_compared_is_refused(wrong, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError, match=message):
        convergence(robot(), **wrong)
