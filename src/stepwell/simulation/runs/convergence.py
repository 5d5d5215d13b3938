"""How far a walk depends on the time step: displacement, turn and what the floor carries."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from stepwell.base import ByValue, Floats, InputError, brief
from stepwell.robot import Robot
from stepwell.simulation.model import Settings
from stepwell.simulation.runs.walk import LOADED, Walk, walk

STEPS = (1e-3, 5e-4, 2.5e-4)
JUMP = 0.2  # a floor force that changes by more than this share in one step jumps


class Resolution(NamedTuple):
    """A walk at one time step.

    Attributes:
        time_step: [s].
        advance: displacement forward a cycle over u_max [1], after the first cycle.
        turn: rotation to the left a cycle [rad], after the first cycle.
        off: root mean square, over samples and contacts, of the difference of the floor's forces
            from those at the finest time step, over the robot's weight [1].
        jumps: share of the steps in which the force under a foot or support changes by more
            than a fifth [1].
    """

    time_step: float
    advance: float
    turn: float
    off: float
    jumps: float

    def __repr__(self):
        return brief(self)


@dataclass(frozen=True, slots=True, eq=False)
class Convergence(ByValue):
    """A robot's walk at several time steps.

    Attributes:
        robot: which walked.
        rows: a walk at each time step, coarsest first.
    """

    robot: Robot
    rows: tuple[Resolution, ...]

    def __repr__(self):
        most = max(row.off for row in self.rows)
        steps = ", ".join(f"{row.time_step * 1e3:g}" for row in self.rows)
        advance = [row.advance for row in self.rows]
        return (
            f"Convergence(time steps {steps} ms: d/u_max {min(advance):.3f} to "
            f"{max(advance):.3f}, floor forces off by up to {most * 100:.2f} % of the weight)"
        )


def convergence(
    robot: Robot,
    time_steps: Sequence[float] = STEPS,
    *,
    cycles: int = 2,
    settings: Settings | None = None,
    progress: Callable[[float, float], None] | None = None,
) -> Convergence:
    """Walk a robot at several time steps.

    Args:
        robot: any robot.
        time_steps: two or more [s]; the settings' sample is a multiple of each.
        cycles: of each walk, two or more, since the first is left out.
        settings: of the simulation; their time step is replaced, the time constant of contacts
            kept.
        progress: called with (done, total), in parts of the work.

    Returns:
        What came out at each.

    Raises:
        ValueError: fewer than two time steps or cycles, a time step that does not divide the
            sample, or a walk that ended early.
        ModuleNotFoundError: MuJoCo is not installed.
    """
    settings = settings or Settings()
    steps = sorted({float(step) for step in time_steps}, reverse=True)
    if len(steps) < 2:
        raise InputError(f"time_steps = {tuple(time_steps)}: must be two or more different ones.")
    if cycles < 2:
        raise InputError(f"cycles = {cycles}: must be >= 2; the first is left out.")
    for step in steps:
        count = settings.sample / step
        if abs(count - round(count)) > 1e-6:
            raise InputError(
                f"time_steps: {step:g} s does not divide the sample of {settings.sample:g} s."
            )
    costs = [1 / step for step in steps]
    walks: list[Walk] = []
    forces: list[Floats] = []  # (n, contacts) of the floor in every step [N]
    means: list[Floats] = []  # (samples, contacts) over each sample [N]
    for i, step in enumerate(steps):

        def tell(done: float, of: float, i: int = i) -> None:
            if progress is not None:
                progress(sum(costs[:i]) + done / of * costs[i], sum(costs))

        fine = replace(settings, time_step=step, sample=step)
        one = walk(robot, cycles, settings=fine, progress=tell)
        if one.stopped:
            text = f"time_steps: at {step:g} s it does not walk to the end. {one.stopped}"
            raise InputError(text)
        walks.append(one)
        forces.append(np.concatenate([one.foot_force, one.support_force], axis=1))
        every = round(settings.sample / step)
        whole = len(forces[i]) // every
        means.append(forces[i][: whole * every].reshape(whole, every, -1).mean(axis=1))
    rows = tuple(
        Resolution(
            step,
            float(one.advance[1:].mean()),
            float(one.turn[1:].mean()),
            float(np.sqrt(np.mean((mean - means[-1]) ** 2))) / robot.weight,
            _jumps(force),
        )
        for step, one, force, mean in zip(steps, walks, forces, means, strict=True)
    )
    return Convergence(robot, rows)


def _jumps(forces: Floats) -> float:
    larger = np.maximum(np.maximum(forces[1:], forces[:-1]), LOADED)
    return float((np.abs(np.diff(forces, axis=0)) > JUMP * larger).any(axis=1).mean())
