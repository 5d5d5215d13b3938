"""Time stepping: a command in, samples out, and an early end if a run goes wrong."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from stepwell.base import Bools, Floats, InputError, require
from stepwell.robot import Arena, Robot
from stepwell.simulation.model import columns, contacts, rod_names, sampled, spec
from stepwell.simulation.simulator import Settings, mujoco, quietly, rollout

STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS
STRETCHED = 1e-3  # a rod that is off its length by this [m] has come apart
FALLEN = math.radians(45.0)  # a body that leans by this has fallen
CHUNK = 0.5  # time between two checks of a run [s]


@dataclass(frozen=True)
class RunSamples:
    """Samples of a run, and its state at the end."""

    time: Floats  # (n,) from the start of the first cycle [s]
    data: Floats  # (n, sensors) readings, contact forces as means since the previous sample
    positions: Floats  # (n, nq) joint positions, in MuJoCo's order
    where: dict[str, slice]  # the columns of each sensor
    stopped: str  # why it ended early, or ""
    state: Floats  # (states,) MuJoCo's full state at the end, to continue from it
    steps: int  # taken since `begin`
    begin: float  # time at which steps were first counted [s]
    time_step: float  # [s]
    every: int  # steps to a sample
    warm: Floats  # (nv,) accelerations from which the solver's next search starts
    pending: Floats  # (m, sensors) readings of the steps since the last sample

    @property
    def end(self) -> float:
        """Time of the last step [s]."""
        return self.begin + self.steps * self.time_step


class SimulatedRun:
    """A run in progress, stepped in chunks; its samples are recorded, or only checked."""

    def __init__(
        self,
        robot: Robot,
        arena: Arena | None,
        settings: Settings,
        start: RunSamples | None = None,
        *,
        record: bool = True,
    ):
        self.robot, self.arena, self.settings, self.record = robot, arena, settings, record
        self.model = spec(robot, arena, settings, drawn=False).compile()
        # A run that diverges is stopped and reported, not reset to its start.
        self.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
        self.data = mujoco.MjData(self.model)
        self.where, self.touching = columns(self.model), contacts(self.model)
        self.every = max(1, round(settings.sample / settings.time_step))
        self.state = np.empty(mujoco.mj_stateSize(self.model, STATE))
        self.begin, self.steps = -settings.settle, 0
        self.pending = np.empty((0, self.model.nsensordata))
        if start is None:
            self.data.qpos[:] = self.model.key_qpos[0]
        else:
            if start.state.size != self.state.size:
                raise InputError(
                    "start: it ended with a robot of other parts; continue with the same robot, or "
                    "with one of other numbers only."
                )
            mujoco.mj_setState(self.model, self.data, start.state, STATE)
            if (start.time_step, start.every) == (settings.time_step, self.every):
                # Counting steps from the same beginning reproduces the numbers of one long run.
                self.begin, self.steps, self.pending = start.begin, start.steps, start.pending
            else:
                self.begin = start.end
        mujoco.mj_forward(self.model, self.data)
        mujoco.mj_getState(self.model, self.data, self.state, STATE)
        self.stopped = ""
        self._times = [np.empty(0)]
        self._data = [np.empty((0, self.model.nsensordata))]
        self._positions = [np.empty((0, self.model.nq))]
        self._warm = (self.data.qacc_warmstart if start is None else start.warm).copy()
        # For every rod the column of its length, and its nominal length [m].
        lengths = self.model.tendon_length0
        self.rods = {
            name: (self.where[f"{name}.length"].start, float(lengths[self.model.tendon(name).id]))
            for name in rod_names(robot)
        }

    @property
    def now(self) -> float:
        """Time from the start of the first cycle [s]."""
        return self.begin + self.steps * self.settings.time_step

    def require_affordable(self, end: float) -> None:
        """Raise ValueError if a run to this time [s] takes more steps or readings than allowed."""
        seconds, step = end - self.now, self.settings.time_step
        require("steps", round(seconds / step), f"{seconds:.6g} s in steps of {step:g} s are")
        width = self.model.nsensordata + self.model.nq
        kept = seconds / (self.every * step)
        require("readings", round(kept * width), f"{kept:.0f} samples of {width} numbers are")

    def chunks(self, end: float) -> Iterator[float]:
        """Advance to this time [s], or to an error, and yield the time after each chunk."""
        for until in self.looks(end):
            self.advance(until)
            yield self.now
            if self.stopped:
                return

    def looks(self, end: float) -> list[float]:
        """Times [s] at which a run to this time [s] is checked."""
        self.require_affordable(end)
        begin = self.now
        count = max(1, math.ceil((end - begin) / CHUNK - 1e-9))
        return [begin + (end - begin) * (i + 1) / count for i in range(count)]

    def advance(self, until: float, command: Floats | None = None) -> None:
        """Step to this time [s], or until the run goes wrong.

        `command` (steps,) [m] is the stroke of each step, that of the robot's drive by default.
        """
        steps = round((until - self.now) / self.settings.time_step)
        if steps <= 0 or self.stopped:
            return
        control = (self.command(steps) if command is None else command)[None, :, None]
        given = self.model, self.data, self.state
        with quietly():
            states, readings = rollout.rollout(*given, control, initial_warmstart=self._warm)
        self._warm = self.data.qacc_warmstart.copy()
        self.take(states[0], readings[0])

    def command(self, steps: int) -> Floats:
        """(steps,) commanded stroke of the next steps [m]."""
        # The command of a step is the one at its beginning.
        return self.robot.drive.stroke(self._after(steps) - self.settings.time_step)

    def take(self, states: Floats, readings: Floats) -> None:
        """Record the next steps, until the run goes wrong.

        `states` are MuJoCo's full states (steps, states), `readings` are (steps, sensors).
        """
        if self.stopped:
            return
        steps = len(states)
        time = self._after(steps)
        keep = (self.steps + np.arange(1, steps + 1)) % self.every == 0
        data, self.pending = sampled(readings, self.pending, self.every, self.touching)
        self.state = states[-1].copy()
        self.steps += steps
        sound, self.stopped = stopped_at(time[keep], data, self.where, self.rods)
        if not self.stopped and not np.isfinite(self.state).all():
            self.stopped = f"Stopped at {self.now:.3f} s: a number overflowed."
        if not self.record:
            return
        self._times.append(time[keep][:sound])
        self._data.append(data[:sound])
        # The full state begins with the time and the joint positions.
        self._positions.append(states[keep, 1 : 1 + self.model.nq][:sound])

    def samples(self) -> RunSamples:
        """All samples so far, and the present state."""
        return RunSamples(
            *map(np.concatenate, (self._times, self._data, self._positions)),
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

    def _after(self, steps: int) -> Floats:
        """(steps,) time after each of the next steps [s]."""
        count = self.steps + np.arange(1, steps + 1)
        return self.begin + self.settings.time_step * count.astype(float)


def stopped_at(
    time: Floats, data: Floats, where: dict[str, slice], rods: dict[str, tuple[int, float]]
) -> tuple[int, str]:
    """Number of valid samples, and the error in the next one, "" without an error.

    Arguments: times (n,) [s], readings (n, sensors), the columns of each sensor, and the column and
    length [m] of each rod.
    """
    wrong: list[tuple[int, str]] = []

    def check(bad: Bools, why: str) -> None:
        if bad.any():
            wrong.append((int(bad.argmax()), why))

    check(np.asarray(~np.isfinite(data).all(axis=1)), "a number overflowed")
    for name, (column, length) in rods.items():
        off = np.abs(data[:, column] - length)
        check(off > STRETCHED, f"the rod {name!r} came off its length")
    _, x, y, _ = data[:, where["body.attitude"]].T
    # Between the body's upward axis and the vertical, from the attitude as a quaternion.
    lean = np.arccos(np.clip(1.0 - 2.0 * (x**2 + y**2), -1.0, 1.0))
    check(np.asarray(lean > FALLEN), "the robot fell over")
    if not wrong:
        return len(time), ""
    # Of several errors in the same sample, the first check is the most specific.
    first, why = min(wrong, key=lambda one: one[0])
    return first, f"Stopped at {time[first]:.3f} s: {why}."
