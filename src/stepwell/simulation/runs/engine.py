"""The stepping: a command in, samples out, and an early end where a run goes wrong."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepwell.base import InputError, require
from stepwell.robot import Arena, Robot
from stepwell.simulation.model import (
    Settings,
    columns,
    contacts,
    mujoco,
    quietly,
    rod_names,
    rollout,
    sampled,
    spec,
    start_position,
)

Array = NDArray[np.float64]

STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS
STRETCHED = 1e-3  # a rod that is off its length by this [m] has come apart
FALLEN = math.radians(45.0)  # a body that leans by this will not get up
CHUNK = 0.5  # time between two looks at a run [s]


@dataclass(frozen=True)
class RunSamples:
    """What came out of a run.

    Attributes:
        time: (n,) from the start of the first cycle [s].
        data: (n, sensors) readings, forces of what touches as means since the sample before.
        positions: (n, nq) joint positions, in MuJoCo's order.
        where: sensor name to its columns.
        stopped: why it ended early, or "".
        state: (states,) MuJoCo's full state at the end, for going on from it.
        steps: how many steps were taken since `begin`.
        begin: time at which steps were first counted [s].
        time_step: [s].
        every: steps to a sample.
        warm: (nv,) accelerations from which the solver's next search starts.
        pending: (m, sensors) readings of the steps since the last sample.
    """

    time: Array
    data: Array
    positions: Array
    where: dict[str, slice]
    stopped: str
    state: Array
    steps: int
    begin: float
    time_step: float
    every: int
    warm: Array
    pending: Array


class Run:
    """A run in progress, a chunk at a time."""

    def __init__(
        self,
        robot: Robot,
        arena: Arena | None,
        settings: Settings,
        start: RunSamples | None = None,
    ):
        self.robot, self.settings = robot, settings
        self.model = spec(robot, arena, settings).compile()
        # A run that diverges is stopped and told, not put back to its start.
        self.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
        self.data = mujoco.MjData(self.model)
        self.where, self.touching = columns(self.model), contacts(self.model)
        self.every = max(1, round(settings.sample / settings.time_step))
        self.state = np.empty(mujoco.mj_stateSize(self.model, STATE))
        self.begin, self.steps = -settings.settle, 0
        self.pending = np.empty((0, self.model.nsensordata))
        if start is None:
            self.data.qpos[:] = start_position(self.model, robot, arena)
        else:
            if start.state.size != self.state.size:
                raise InputError(
                    "start: the robot that it ended with has other parts; go on with the same "
                    "robot, or one whose numbers alone have changed."
                )
            mujoco.mj_setState(self.model, self.data, start.state, STATE)
            # Counting on from the same beginning keeps every number what it would have been.
            same = (start.time_step, start.every) == (settings.time_step, self.every)
            now = start.begin + start.steps * start.time_step
            self.begin, self.steps = (start.begin, start.steps) if same else (now, 0)
            if same:
                self.pending = start.pending
        mujoco.mj_forward(self.model, self.data)
        mujoco.mj_getState(self.model, self.data, self.state, STATE)
        self.stopped = ""
        self._times: list[Array] = []
        self._data: list[Array] = []
        self._positions: list[Array] = []
        self._warm = (self.data.qacc_warmstart if start is None else start.warm).copy()
        self.rods = self._lengths()

    @property
    def now(self) -> float:
        """Time from the start of the first cycle [s]."""
        return self.begin + self.steps * self.settings.time_step

    def advance(self, until: float) -> None:
        """Step to this time [s], or to where the run goes wrong."""
        steps = round((until - self.now) / self.settings.time_step)
        if steps <= 0 or self.stopped:
            return
        after = self.steps + np.arange(1, steps + 1)
        time = self.begin + self.settings.time_step * after.astype(float)
        # The command of a step is the one that stands at its beginning.
        command = self.robot.drive.stroke(time - self.settings.time_step)
        with quietly():
            states, readings = rollout.rollout(
                self.model,
                self.data,
                self.state,
                command[None, :, None],
                initial_warmstart=self._warm,
            )
        keep = after % self.every == 0
        self._times.append(time[keep])
        found, self.pending = sampled(readings[0], self.pending, self.every, self.touching)
        self._data.append(found)
        # The full state begins with the time and the joint positions.
        self._positions.append(states[0, keep, 1 : 1 + self.model.nq])
        self.state = states[0, -1].copy()
        self._warm = self.data.qacc_warmstart.copy()
        self.steps += steps
        self._look()

    def samples(self) -> RunSamples:
        """Everything so far."""
        width = self.model.nsensordata
        time = np.concatenate([np.empty(0), *self._times])
        data = np.concatenate([np.empty((0, width)), *self._data])
        positions = np.concatenate([np.empty((0, self.model.nq)), *self._positions])
        return RunSamples(
            time=time,
            data=data,
            positions=positions,
            where=self.where,
            stopped=self.stopped,
            state=self.state,
            steps=self.steps,
            begin=self.begin,
            time_step=self.settings.time_step,
            every=self.every,
            warm=self._warm,
            pending=self.pending,
        )

    @property
    def last(self) -> Array:
        """(m, sensors) readings of the newest chunk."""
        return self._data[-1]

    def _look(self) -> None:
        time, data = self._times[-1], self._data[-1]
        first, self.stopped = stopped_at(time, data, self.where, self.rods)
        if not self.stopped and not np.isfinite(self.state).all():
            self.stopped = f"Stopped at {self.now:.3f} s: a number overflowed."
        self._times[-1], self._data[-1] = time[:first], data[:first]
        self._positions[-1] = self._positions[-1][:first]

    def _lengths(self) -> dict[str, tuple[int, float]]:
        rods: dict[str, tuple[int, float]] = {}
        for name in rod_names(self.robot):
            column = self.where.get(f"{name}.length")
            if column is not None:
                length = float(self.model.tendon_length0[self.model.tendon(name).id])
                rods[name] = (column.start, length)
        return rods


def stopped_at(
    time: Array, data: Array, where: dict[str, slice], rods: dict[str, tuple[int, float]]
) -> tuple[int, str]:
    """How many samples are sound, and what is wrong with the next one.

    Args:
        time: (n,) [s].
        data: (n, sensors) readings.
        where: sensor name to its columns.
        rods: rod name to its column and its length [m].

    Returns:
        The number n and "", or the number of the first bad sample and a sentence.
    """
    wrong: list[tuple[int, str]] = []

    def check(bad: NDArray[np.bool_], why: str) -> None:
        if bad.any():
            wrong.append((int(bad.argmax()), why))

    check(np.asarray(~np.isfinite(data).all(axis=1)), "a number overflowed")
    for name, (column, length) in rods.items():
        off = np.abs(data[:, column] - length)
        check(off > STRETCHED, f"the rod {name!r} came off its length")
    check(np.asarray(_lean(data[:, where["body.attitude"]]) > FALLEN), "the robot fell over")
    if not wrong:
        return len(time), ""
    # Of what is found in the same sample, the first check says most.
    first, why = min(wrong, key=lambda one: one[0])
    return first, f"Stopped at {time[first]:.3f} s: {why}."


def _lean(attitude: Array) -> Array:
    """Angle [rad] between the body's upward axis and the vertical, for (n, 4) quaternions."""
    upward = 1.0 - 2.0 * (attitude[:, 1] ** 2 + attitude[:, 2] ** 2)
    return np.arccos(np.clip(upward, -1.0, 1.0))


def affordable(run: Run, seconds: float) -> None:
    """Refuse a run of more time steps, or of more readings, than the limits.

    Args:
        run: not yet begun.
        seconds: how long it is to go on [s].
    """
    step = run.settings.time_step
    require("steps", round(seconds / step), f"{seconds:.6g} s in steps of {step:g} s are")
    width = run.model.nsensordata + run.model.nq
    kept = seconds / (run.every * step)
    require("readings", round(kept * width), f"{kept:.0f} samples of {width} numbers are")


def chunks(begin: float, end: float) -> Iterator[float]:
    """Times at which a run from `begin` to `end` [s] is looked at."""
    count = max(1, math.ceil((end - begin) / CHUNK - 1e-9))
    yield from (begin + (end - begin) * (i + 1) / count for i in range(count))


Progress = Callable[[float, float], None]
