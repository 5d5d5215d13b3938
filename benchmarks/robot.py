"""Speed of the simulated robot, beside MuJoCo stepping the exported file, also made of parts."""

import statistics
import time
from collections.abc import Callable
from typing import Any, NamedTuple

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
            f"{steps / ours.wall:,.0f} steps per second, {ratio(stepped, ours)}",
            "at least 0.95 times",
        )
    )
    found.append(("walk, against mujoco.rollout on that file", ratio(rolled, ours), "-"))
    found.append(("walk on one core", real_time(robot, ours), "at least 30 times"))
    explorer = sw.preset("robot-explorer")
    hinges = Settings(linkage=Linkage.HINGES)
    antennas, bodies = in_turns(
        lambda: walk(explorer, CYCLES), lambda: walk(robot, CYCLES, settings=hinges)
    )
    found.append(("the same with antennas", real_time(explorer, antennas), "-"))
    found.append(("the same with every lever a hinged body", real_time(robot, bodies), "-"))
    found += made_of_parts()
    alone, together = in_turns(lambda: many(robot, 1), lambda: many(robot, CORES))
    found.append(
        (
            f"sweep of {SWEPT} robots on {CORES} cores",
            f"{alone.wall / together.wall:.2f} times as fast as on one, "
            f"{100 * alone.wall / together.wall / CORES:.0f} % of {CORES}",
            "at least 85 %",
        )
    )
    return found


def made_of_parts() -> list[tuple[str, str, str]]:
    """The robots as they can be cut, beside MuJoCo on the same model; one between walls."""
    found: list[tuple[str, str, str]] = []
    for name, arena in (("forward", None), ("antennas", sw.load_arena("corridor"))):
        robot = buildable(name)
        ours, stepped = in_turns(
            lambda robot=robot, arena=arena: walk(robot, CYCLES, arena=arena),
            lambda robot=robot, arena=arena: stepped_alone(robot, arena),
        )
        label = f"robot-{name} made of parts{', between walls' if arena else ''}"
        found += [
            (f"{label}, against mj_step", ratio(stepped, ours), "at least 0.95 times"),
            (f"{label}, on one core", real_time(robot, ours), "at least 30 times"),
        ]
    return found


def stepped_alone(robot: Robot, arena: Arena | None) -> None:
    """Step the same model with the same command and nothing more."""
    model = spec(robot, arena, drawn=False).compile()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    for one in command(robot):
        data.ctrl[0] = one
        mujoco.mj_step(model, data)


def many(robot: Robot, threads: int) -> None:
    sweep([robot] * SWEPT, cycles=4, threads=threads)


class Taken(NamedTuple):
    """Median time of a call on the clock and of all its threads [s]."""

    wall: float
    cpu: float


def ratio(other: Taken, ours: Taken) -> str:
    return (
        f"{other.cpu / ours.cpu:.2f} times in CPU time, {other.wall / ours.wall:.2f} on the clock"
    )


def real_time(robot: Robot, taken: Taken) -> str:
    simulated = CYCLES * robot.drive.period
    return (
        f"{simulated / taken.cpu:.0f} times real time in CPU time, "
        f"{simulated / taken.wall:.0f} on the clock"
    )


def in_turns(*runs: Callable[[], Any]) -> list[Taken]:
    """Median times of each; the first round only warms up."""
    taken: list[list[Taken]] = [[] for _ in runs]
    for _ in range(TIMES + 1):
        for times, run in zip(taken, runs, strict=True):
            wall, cpu = time.perf_counter(), time.process_time()
            run()
            times.append(Taken(time.perf_counter() - wall, time.process_time() - cpu))
    return [
        Taken(*(statistics.median(column) for column in zip(*times[1:], strict=True)))
        for times in taken
    ]


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


if __name__ == "__main__":
    for row in rows():
        print(" | ".join(row), flush=True)
