"""Robots in worlds of MuJoCo Warp: each does what it does alone on the processor.

Warp makes its kernels anew for every shape of a model, so that all tests use one.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from importlib.util import find_spec
from typing import Any

import numpy as np
import pytest

import stepwell as sw
from facts import refuses
from simulation.robots import cell, explorer, leg_of_three
from stepwell.base import ExtraError
from stepwell.robot import Arena, Goal, Robot, Wall
from stepwell.simulation import Outcome, Settings, mazes, screen_mazes, screen_walks, sweep
from stepwell.simulation.engine import SimulatedRun

# Looked for and not imported: that takes seconds, of every process that collects the tests.
if find_spec("mujoco_warp") is None:
    pytest.skip("worlds are not tested: mujoco-warp is not installed", allow_module_level=True)

from stepwell.simulation import worlds

pytestmark = pytest.mark.slow

# Coarse and short: what is compared is that both do the same.
QUICK = Settings(time_step=2e-3, contact_time=4e-3, settle=0.02)
BASE = explorer()


@pytest.fixture(scope="module", autouse=True)
def quickly_made() -> Iterator[None]:
    """Kernels that are made in half the time and take three times as long: here that is less."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("warp.config.optimization_level", 0)
        yield


def varied(**numbers: float) -> Robot:
    return sw.files.vary(BASE, {name.replace("__", "."): value for name, value in numbers.items()})


def hurried(robot: Robot, **more: Any) -> Robot:
    return replace(robot, drive=replace(robot.drive, period=0.5), **more)


def broken(robot: Robot) -> Robot:
    """A robot that a band tears apart."""
    cells = [cell("inner", 0.010, -0.007, 58.75, 0.022), cell("outer", 0.014, k=1e6)]
    return replace(robot, legs=tuple(replace(leg, chain=sw.Chain(cells)) for leg in robot.legs))


def loaded(robot: Robot) -> Robot:
    """A robot whose simulation is refused."""
    cells = [replace(cell("inner", 0.010), load=sw.Load.constant(0.1)), cell("outer", 0.014)]
    return replace(
        robot, antennas=(), legs=tuple(replace(leg, chain=sw.Chain(cells)) for leg in robot.legs)
    )


def yard(distance: float, goal: Goal | None = None) -> Arena:
    """A wall across the way at a distance [m], a little slanted."""
    return Arena([Wall((distance, -0.3), (distance + 0.05, 0.3))], goal=goal)


ROBOTS = [
    BASE,
    varied(
        chain__cell__inner__band__stiffness_N_per_m=70, body__mass_g=220, floor__foot_friction=0.4
    ),
    varied(foot__below_mm=0.8, foot__radius_mm=3.5, foot__link_mm=36),
]
HURRIED = [hurried(robot) for robot in ROBOTS]
YARDS = [yard(0.1635), yard(0.165), yard(2.0)]
MOON = replace(BASE.floor, gravity=1.6)


@pytest.fixture(scope="module")
def runs() -> list[tuple[SimulatedRun, SimulatedRun]]:
    """Robots in worlds of their own, the first of which is left behind half way; and alone."""
    both = [
        (SimulatedRun(robot, arena, QUICK), SimulatedRun(robot, arena, QUICK))
        for robot, arena in zip(ROBOTS, YARDS, strict=True)
    ]
    together = [one for one, _ in both]
    worlds.Worlds(together).advance(0.13)
    worlds.Worlds(together[1:]).advance(0.26)
    for run, alone in both:
        alone.advance(run.now)
    return both


def read(run: SimulatedRun, name: str) -> np.ndarray:
    samples = run.samples()
    return samples.data[:, samples.where[name]]


def test_designs_in_one_batch_do_what_each_does_alone(runs):
    assert [run.now for run, _ in runs] == pytest.approx([0.13, 0.26, 0.26])
    for run, alone in runs:
        assert not run.stopped and len(run.samples().time) == len(alone.samples().time)
        for name in ("body.position", "left.tip.position", "left.antenna", "right.antenna"):
            assert np.abs(read(run, name) - read(alone, name)).max() < 2e-5, name
    # By far less than they differ from each other.
    ends = [read(run, "body.position")[-1, 0] for run, _ in runs]
    assert np.min(np.abs(np.diff(ends))) > 5e-4


def test_each_world_has_its_own_walls(runs):
    touched = [[float(read(run, "wall 1").max()) > 1e-3 for run in pair] for pair in runs]
    assert touched == [[True, True], [True, True], [False, False]]


def test_what_differs_in_structure_is_stepped_apart():
    three = Robot([leg_of_three("left"), leg_of_three("right")])
    robots = [*ROBOTS, explorer(connected=False), three, replace(BASE, floor=MOON)]
    groups = worlds.alike([SimulatedRun(robot, None, QUICK) for robot in robots])
    assert [len(group) for group in groups] == [3, 1, 1, 1]


def test_screened_walks_have_the_gaits_of_walks_and_one_that_breaks_spoils_no_other():
    robots = [HURRIED[0], broken(HURRIED[0]), HURRIED[2]]
    screened = screen_walks([*robots, loaded(BASE)], cycles=1, settings=QUICK)
    assert screened[-1] is None  # the simulator has no term for it
    screened = screened[:-1]
    alone = sweep(robots, cycles=1, settings=QUICK, threads=1).trials
    assert [one and one.gaits for one in screened] == [one.gaits for one in alone]
    assert [bool(one and one.stopped) for one in screened] == [False, True, False]
    assert [bool(one.stopped) for one in alone] == [False, True, False]


def test_screened_ways_end_as_ways_do():
    here, far = Goal((0.0, 0.0)), Goal((3.0, 0.0))
    ends = [yard(0.17, here), yard(0.2, far), yard(2.0), yard(2.0, here)]
    entries = list(zip([*HURRIED, BASE], ends, strict=True))
    outcomes = screen_mazes(entries, limit=0.06, settings=QUICK)
    assert outcomes == tuple(way.outcome for way in mazes(entries, limit=0.06, settings=QUICK))
    assert set(outcomes) == {Outcome.REACHED, Outcome.TIMED_OUT}


def test_a_world_without_room_for_its_contacts_tells_nothing(monkeypatch):
    import mujoco_warp

    known: Callable[..., Any] = mujoco_warp.put_data

    def cramped(*args: Any, **more: Any) -> Any:
        return known(*args, **(more | {"nconmax": 1}))

    monkeypatch.setattr(mujoco_warp, "put_data", cramped)
    assert screen_mazes([(BASE, YARDS[2])], limit=0.02, settings=QUICK) == (None,)


def test_another_release_than_that_of_mujoco_is_refused(monkeypatch):
    monkeypatch.setattr("mujoco_warp.__version__", "3.9.0")
    worlds.opened.cache_clear()
    with refuses(ExtraError, "MuJoCo Warp", "3.9.0", "MuJoCo", "Install"):
        screen_walks([BASE], cycles=1)
    monkeypatch.undo()
    worlds.opened.cache_clear()


def test_nothing_is_asked_of_no_cycles_and_no_time():
    with pytest.raises(ValueError, match="cycles = 0: must be >= 1"):
        screen_walks([BASE], cycles=0)
    with pytest.raises(ValueError, match="limit = 0"):
        screen_mazes([(BASE, YARDS[0])], limit=0)
