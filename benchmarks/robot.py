"""Speed of the simulated robot, beside MuJoCo stepping the exported file, also made of parts."""

import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import stepwell as sw
from stepwell.paper.buildable import buildable
from stepwell.robot import Arena, Robot
from stepwell.simulation import Linkage, Settings, mjcf, spec, sweep, walk
from stepwell.simulation.simulator import mujoco, rollout

CYCLES = 20
TIMES = 5
SWEPT = 32
CORES = 2


def rows() -> list[tuple[str, str, str]]:
    """What was timed, what came out, what is wanted."""
    robot = sw.preset("robot-forward")
    found: list[tuple[str, str, str]] = []
    # Taken in turns, so that a busy machine slows all alike.
    ours, stepped, rolled = in_turns(
        lambda: walk(robot, CYCLES),
        lambda: bare(robot, in_one_call=False),
        lambda: bare(robot, in_one_call=True),
    )
    steps = len(command(robot))
    found.append(
        (
            "walk, against a loop of mj_step on the exported file",
            f"{steps / ours:,.0f} steps per second, {stepped / ours:.2f} times as many",
            "at least 0.90 times",
        )
    )
    found.append(("walk, against mujoco.rollout on that file", f"{rolled / ours:.2f} times", "-"))
    found.append(("walk on one core", real_time(robot, ours), "at least 20 times"))
    explorer = sw.preset("robot-explorer")
    found += made_of_parts()
    hinges = Settings(linkage=Linkage.HINGES)
    antennas, bodies = in_turns(
        lambda: walk(explorer, CYCLES), lambda: walk(robot, CYCLES, settings=hinges)
    )
    found.append(("the same with antennas", real_time(explorer, antennas), "-"))
    found.append(("the same with every lever a hinged body", real_time(robot, bodies), "-"))
    alone, together = in_turns(lambda: many(robot, 1), lambda: many(robot, CORES))
    found.append(
        (
            f"sweep of {SWEPT} robots on {CORES} cores",
            f"{alone / together:.2f} times as fast as on one, "
            f"{100 * alone / together / CORES:.0f} % of {CORES}",
            "at least 85 %",
        )
    )
    return found


def made_of_parts() -> list[tuple[str, str, str]]:
    """The robot with antennas as it can be cut, between walls, beside MuJoCo on the same model."""
    robot, arena = buildable("antennas"), sw.load_arena("corridor")
    ours, stepped = in_turns(
        lambda: walk(robot, CYCLES, arena=arena), lambda: stepped_alone(robot, arena)
    )
    label = "robot with antennas made of parts, between walls"
    return [
        (f"{label}, against mj_step", f"{stepped / ours:.2f} times", "at least 0.95 times"),
        (f"{label}, on one core", real_time(robot, ours), "at least 30 times"),
    ]


def stepped_alone(robot: Robot, arena: Arena) -> None:
    """Step the same model with the same command and nothing more."""
    model = spec(robot, arena, drawn=False).compile()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    for one in command(robot):
        data.ctrl[0] = one
        mujoco.mj_step(model, data)


def many(robot: Robot, threads: int) -> None:
    sweep([robot] * SWEPT, cycles=4, threads=threads)


def real_time(robot: Robot, seconds: float) -> str:
    return f"{CYCLES * robot.drive.period / seconds:.0f} times real time"


def in_turns(*runs: Callable[[], Any]) -> list[float]:
    """Median time of each [s]; the first round only warms up."""
    taken: list[list[float]] = [[] for _ in runs]
    for _ in range(TIMES + 1):
        for times, run in zip(taken, runs, strict=True):
            start = time.perf_counter()
            run()
            times.append(time.perf_counter() - start)
    return [statistics.median(times[1:]) for times in taken]


def command(robot: Robot) -> np.ndarray:
    """(steps,) the stroke wanted at the beginning of each step [m]."""
    settings = Settings()
    steps = round((settings.settle + CYCLES * robot.drive.period) / settings.time_step)
    return robot.drive.stroke(np.arange(steps) * settings.time_step - settings.settle)


def bare(robot: Robot, in_one_call: bool) -> None:
    """Step the exported file with the same command and nothing more."""
    model = mujoco.MjModel.from_xml_string(mjcf(robot))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    wanted = command(robot)
    if in_one_call:
        state = np.empty(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
        mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        rollout.rollout(model, data, state, wanted[None, :, None])
        return
    for one in wanted:
        data.ctrl[0] = one
        mujoco.mj_step(model, data)
