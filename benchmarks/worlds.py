"""Robots by the thousand: MuJoCo Warp on a GPU, beside MuJoCo on one core and on all.

`python benchmarks/worlds.py` measures 4,096 robots where there is a GPU, and says so where there is
none. `python benchmarks/worlds.py 48` takes so many on whatever there is, a processor too.
"""

import sys
import time
from collections.abc import Sequence

import numpy as np

import stepwell as sw
from stepwell.base import have
from stepwell.design import share_of
from stepwell.kernels import cores
from stepwell.robot import Robot
from stepwell.simulation import Settings, device, screen_walks, sweep

MANY, ALONE, CYCLES, SEED = 4096, 32, 2, 3
# Anchors, stiffness, friction and weights, between which the gait changes.
VARIED = {
    "foot.below_mm": (0.2, 1.4),
    "chain.cell.outer.q_mm[0]": (4.0, 20.0),
    "chain.cell.inner.band.stiffness_N_per_m": (25.0, 35.0),
    "body.mass_g": (200.0, 320.0),
    "floor.foot_friction": (0.3, 0.8),
}
WHAT = f"{MANY:,} robots at once on a GPU, beside MuJoCo on one core and on all"


def rows(count: int | None = None) -> list[tuple[str, str, str]]:
    """What was timed, what came out, what is wanted."""
    if not have("gpu"):
        return [(WHAT, "not measured: the extra gpu is not installed", "-")]
    name, is_gpu = device()
    if count is None and not is_gpu:
        return [(WHAT, "not measured: no GPU here", "-")]
    robots = drawn(count or MANY)
    return measured(robots, name)


def drawn(count: int) -> list[Robot]:
    """Robots that differ from the one that walks forward."""
    dice, base = np.random.default_rng(SEED), sw.preset("robot-forward")
    return [
        sw.files.vary(base, {key: dice.uniform(*ends) for key, ends in VARIED.items()})
        for _ in range(count)
    ]


def measured(robots: Sequence[Robot], name: str) -> list[tuple[str, str, str]]:
    """Speeds, and how often both say the same."""
    from stepwell.simulation.engine import SimulatedRun
    from stepwell.simulation.worlds import Worlds, alike

    few = robots[:ALONE]
    one = stepped(len(few)) / timed(lambda: sweep(few, cycles=CYCLES, threads=1))
    some = robots[: ALONE * cores()]
    every = stepped(len(some)) / timed(lambda: sweep(some, cycles=CYCLES))
    begin = time.perf_counter()
    runs = [SimulatedRun(robot, None, Settings(), record=False) for robot in robots]
    (group,) = alike(runs)
    worlds = Worlds(group)
    made = time.perf_counter() - begin
    worlds.advance(-0.4)  # kernels are made
    took = timed(lambda: worlds.advance(1.6))
    warp = len(robots) * 2.0 / Settings().time_step / took
    screened = screen_walks(robots, cycles=CYCLES)
    computed = sweep(robots, cycles=CYCLES).trials
    told = [(a, b) for a, b in zip(screened, computed, strict=True) if a is not None]
    same = share_of(sum(a.gaits == b.gaits for a, b in told), len(told))
    off = max(abs(a.advance - b.advance) for a, b in told if a.gaits == b.gaits)
    return [
        (f"{len(robots):,} robots on {name}", f"{warp:,.0f} steps a second", "-"),
        (
            "MuJoCo on one core",
            f"{one:,.0f} steps a second; Warp takes {warp / one:.3g} times as many",
            "-",
        ),
        (
            f"mujoco.rollout on {cores()} cores",
            f"{every:,.0f} steps a second; Warp takes {warp / every:.3g} times as many",
            "-",
        ),
        ("to make their models and worlds", f"{made:.1f} s", "-"),
        (
            "gaits alike, of those of which Warp says something",
            f"{same.times} of {same.of}, 95 %: {same.low:.3f} to {same.high:.3f}",
            "-",
        ),
        ("and of these the advance apart by", f"at most {off:.1e} u_max a cycle", "-"),
    ]


def stepped(robots: int) -> float:
    """Steps that so many robots take in a walk."""
    settings = Settings()
    period = sw.preset("robot-forward").drive.period
    return robots * (settings.settle + CYCLES * period) / settings.time_step


def timed(call) -> float:
    """How long a call takes [s]."""
    begin = time.perf_counter()
    call()
    return time.perf_counter() - begin


if __name__ == "__main__":
    for row in rows(int(sys.argv[1]) if len(sys.argv) > 1 else None):
        print(": ".join(row[:2]))
